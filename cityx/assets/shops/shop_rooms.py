"""Rooms behind shopfronts, by trade: what is seen through the panes, a metre deep.

Each is drawn for a shopfront of `WIDTH` by `HEIGHT`: x along the wall, y from the panes, 0, to the
back wall, 1, z up from the floor. Walls take the tint of the instance, goods do not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets.kept_prototypes import kept
from cityx.assets.openings.frames import Shapes, pane
from cityx.assets.shapes import Color, box, cylinder, lathe, moved, prototype
from cityx.assets.shops.shopfronts import HEIGHT, WIDTH
from cityx.city.mesh import one_mesh
from cityx.city.scene import Prototype
from cityx.ids import rng_for, stable_id

VARIANTS = 2  # arrangements of each trade
_X, _TOP = WIDTH / 2 - 0.08, HEIGHT - 0.06
_WARES = ("ware_cream", "ware_red", "ware_ochre", "ware_blue", "ware_green")
_WALL = "room_wall"
SHADE: Color = (0.7, 0.7, 0.7)
Rng = np.random.Generator


def _shell(floor: str = "bench_wood") -> Shapes:
    """Back wall, sides, floor, ceiling, and the lamps under it."""
    a, b, t = _X, 1.0, _TOP
    sides = [
        ([[-a, b, 0], [-a, 0, 0], [-a, 0, t], [-a, b, t]], _WALL),
        ([[a, 0, 0], [a, b, 0], [a, b, t], [a, 0, t]], _WALL),
        ([[-a, 0, 0.01], [a, 0, 0.01], [a, b, 0.01], [-a, b, 0.01]], floor),
        ([[-a, b, t], [a, b, t], [a, 0, t], [-a, 0, t]], _WALL),
    ]
    shapes: Shapes = [pane(-a, a, 0.0, t, _WALL, (0.9, 0.9, 0.9), y=b)]
    for corners, material in sides:
        flat = np.array(corners, float)
        flat_uv = flat[:, [0, 1]] + flat[:, [2, 2]] * [0.0, 1.0]
        shapes.append(one_mesh(0, flat, [[0, 1, 2, 3]], materials=(material,), uv=flat_uv[None]))
    for x in (-0.8, 0.8):
        shapes.append(box((x - 0.5, 0.4, t - 0.05), (x + 0.5, 0.47, t - 0.015), "lamp_glow"))
    return shapes


def _shelves(rng: Rng, x0: float, x1: float, levels: tuple[float, ...], goods: str) -> Shapes:
    """Shelves on the back wall, full of one kind of goods."""
    shapes: Shapes = []
    for x in (x0, x1):
        shapes.append(box((x - 0.02, 0.68, 0.0), (x + 0.02, 1.0, levels[-1] + 0.4), "bench_wood"))
    for z in levels:
        shapes.append(box((x0, 0.68, z - 0.03), (x1, 1.0, z), "bench_wood"))
        shapes += _row(rng, x0 + 0.04, x1 - 0.04, z, goods)
    return shapes


def _row(rng: Rng, x0: float, x1: float, z: float, goods: str, y: float = 0.74) -> Shapes:
    """Goods side by side on a shelf: books, bottles, boxes or loaves."""
    shapes: Shapes = []
    x = x0
    while x < x1 - 0.05:
        material = _WARES[int(rng.integers(len(_WARES)))]
        if goods == "books":
            wide, tall = float(rng.uniform(0.03, 0.11)), float(rng.uniform(0.22, 0.32))
            shapes.append(box((x, y, z), (x + wide, y + 0.2, z + tall), material, bottom=False))
            x += wide + (0.12 if rng.uniform() < 0.06 else 0.004)
        elif goods == "bottles":
            tall = float(rng.uniform(0.27, 0.33))
            line = np.array([(0.036, 0.0), (0.036, 0.6), (0.012, 0.75), (0.012, 1.0), (0.0, 1.0)])
            body = lathe(line * [1.0, tall], ("ware_green", "ware_red", "ware_ochre")
                         [int(rng.integers(3))], sides=6)  # fmt: skip
            shapes.append(moved(body, (x + 0.04, y + 0.06, z)))
            x += float(rng.uniform(0.085, 0.12))
        elif goods == "boxes":
            wide, tall = float(rng.uniform(0.07, 0.2)), float(rng.uniform(0.1, 0.3))
            shapes.append(box((x, y, z), (x + wide, y + 0.16, z + tall), material, bottom=False))
            x += wide + float(rng.uniform(0.01, 0.05))
        else:
            wide = float(rng.uniform(0.12, 0.26))
            loaf = [(0.0, 0.0), (0.5 * wide, 0.03), (0.42 * wide, 0.09), (0.0, 0.12)]
            shapes.append(moved(lathe(loaf, "ware_ochre", sides=7), (x + wide / 2, y + 0.1, z)))
            x += wide + 0.02
    return shapes


def _counter(x0: float, x1: float, y: float = 0.45) -> Shapes:
    return [
        box((x0, y, 0.0), (x1, y + 0.3, 0.95), "bench_wood"),
        box((x0 - 0.03, y - 0.03, 0.95), (x1 + 0.03, y + 0.33, 1.0), "ware_cream"),
    ]


def _figure(x: float, y: float, coat: str, skirt: str) -> Shapes:
    """Dressed mannequin of a shop window."""
    body = [(0.0, 0.85), (0.17, 0.86), (0.13, 1.06), (0.19, 1.3), (0.2, 1.42), (0.06, 1.5),
            (0.05, 1.56), (0.0, 1.56)]  # fmt: skip
    legs = [(0.05, 0.06), (0.2, 0.45), (0.18, 0.88), (0.0, 0.9)]
    head = [(0.0, 1.55), (0.08, 1.6), (0.1, 1.69), (0.06, 1.78), (0.0, 1.79)]
    shapes: Shapes = []
    for line, material in ((body, coat), (legs, skirt), (head, "ware_cream")):
        part = lathe(line, material, sides=9)
        shapes.append(moved(part, (x, y, 0.0)))
    shapes.append(cylinder((x, y, 0.0), (x, y, 0.06), 0.2, "metal_grey", sides=10))
    return shapes


def _table(x: float, y: float, cloth: str) -> Shapes:
    """Small round table with two chairs and something on it."""
    shapes: Shapes = [
        cylinder((x, y, 0.0), (x, y, 0.72), 0.03, "metal_dark", sides=6),
        cylinder((x, y, 0.72), (x, y, 0.75), 0.32, cloth, sides=14),
        cylinder((x + 0.08, y, 0.75), (x + 0.08, y, 0.86), 0.04, "ware_cream", sides=8),
    ]
    for side in (-1.0, 1.0):
        at = x + side * 0.52
        shapes.append(box((at - 0.19, y - 0.19, 0.44), (at + 0.19, y + 0.19, 0.48), "bench_wood"))
        back = at + side * 0.18
        shapes.append(box((back - 0.02, y - 0.19, 0.48), (back + 0.02, y + 0.19, 0.9),
                          "bench_wood"))  # fmt: skip
        for dx in (-0.17, 0.14):
            for dy in (-0.17, 0.14):
                shapes.append(box((at + dx, y + dy, 0.0), (at + dx + 0.03, y + dy + 0.03, 0.44),
                                  "bench_wood", bottom=False))  # fmt: skip
    return shapes


def _books(rng: Rng) -> Shapes:
    shapes = _shelves(rng, -_X + 0.05, -0.1, (0.3, 0.7, 1.1, 1.5, 1.9), "books")
    shapes += _shelves(rng, 0.1, _X - 0.05, (0.3, 0.7, 1.1, 1.5, 1.9), "books")
    shapes += _counter(-0.9, 0.9, 0.12)
    for x in np.linspace(-0.8, 0.6, 5):
        for k in range(int(rng.integers(1, 5))):
            shapes.append(box((x, 0.16, 1.0 + 0.045 * k), (x + 0.2, 0.4, 1.043 + 0.045 * k),
                              _WARES[int(rng.integers(5))]))  # fmt: skip
    return shapes


def _bakery(rng: Rng) -> Shapes:
    shapes = _counter(-_X + 0.1, 0.9)
    shapes.append(box((-_X + 0.1, 0.45, 1.0), (0.9, 0.73, 1.35), "pane"))
    shapes += _shelves(rng, -1.3, 1.3, (1.2, 1.55, 1.9), "loaves")
    shapes += _row(rng, -_X + 0.2, 0.8, 1.01, "loaves", 0.5)
    shapes += _row(rng, -1.2, 1.2, 0.55, "loaves", 0.06)
    return [*shapes, box((-1.3, 0.04, 0.5), (1.3, 0.3, 0.55), "bench_wood")]


def _clothes(rng: Rng) -> Shapes:
    shapes: Shapes = []
    wares = [_WARES[int(rng.integers(5))] for _ in range(6)]
    shapes += _figure(-1.15, 0.25, wares[0], wares[1]) + _figure(0.2, 0.2, wares[2], "metal_dark")
    if rng.uniform() < 0.7:
        shapes += _figure(1.2, 0.3, wares[3], wares[4])
    for x0, x1 in ((-1.6, -0.3), (0.3, 1.6)):
        shapes.append(box((x0, 0.72, 1.6), (x1, 0.75, 1.63), "metal_grey"))
        x = x0 + 0.05
        while x < x1 - 0.06:
            long = float(rng.uniform(0.6, 1.05))
            shapes.append(box((x, 0.56, 1.58 - long), (x + 0.04, 0.94, 1.57),
                              _WARES[int(rng.integers(5))], bottom=False))  # fmt: skip
            x += float(rng.uniform(0.06, 0.1))
    return shapes


def _bottles(rng: Rng) -> Shapes:
    shapes = _shelves(rng, -1.55, 0.0, (0.4, 0.85, 1.3, 1.75), "bottles")
    shapes += _shelves(rng, 0.1, 1.55, (0.4, 0.85, 1.3, 1.75), "bottles")
    for x in (-1.1, 0.3, 1.0):
        shapes.append(box((x, 0.08, 0.0), (x + 0.5, 0.38, 0.32), "bench_wood", SHADE))
        shapes += _row(rng, x + 0.03, x + 0.48, 0.32, "bottles", 0.15)
    return shapes


def _grocer(rng: Rng) -> Shapes:
    shapes = _shelves(rng, -1.6, 1.6, (0.9, 1.25, 1.6, 1.95), "boxes")
    for step in range(2):
        for k, x in enumerate(np.linspace(-1.6, 1.05, 5)):
            y, z = 0.06 + 0.3 * step, 0.45 + 0.25 * step
            shapes.append(box((x, y, z - 0.2), (x + 0.56, y + 0.28, z), "bench_wood"))
            material = _WARES[1:][(k + step + int(rng.integers(2))) % 4]
            for fruit in range(12):
                at = (x + 0.06 + 0.088 * (fruit % 6), y + 0.08 + 0.12 * (fruit // 6), z - 0.03)
                shapes.append(moved(lathe([(0.0, 0.0), (0.05, 0.05), (0.0, 0.1)], material,
                                          sides=6), at))  # fmt: skip
    return shapes


def _cafe(rng: Rng) -> Shapes:
    shapes = _table(-0.95, 0.4, "bench_wood") + _table(0.85, 0.36, "ware_cream")
    shapes += _shelves(rng, -0.9, 0.9, (1.35, 1.7), "bottles")
    shapes.append(box((-1.0, 0.72, 0.0), (1.0, 0.95, 1.05), "bench_wood", SHADE))
    for x in (-0.95, 0.0, 0.85):
        shapes.append(box((x - 0.004, 0.4, 1.95), (x + 0.004, 0.408, _TOP), "metal_dark"))
        shade = lathe([(0.16, 0.0), (0.05, 0.16), (0.0, 0.16)], "metal_dark", sides=10)
        bulb = lathe([(0.0, 0.0), (0.05, 0.04), (0.0, 0.09)], "lamp_glow", sides=6)
        shapes += [moved(part, (x, 0.4, 1.85)) for part in (shade, bulb)]
    for x, wide in ((-1.5, 0.45), (1.1, 0.5)):
        shapes.append(pane(x, x + wide, 1.2, 1.9, _WARES[int(rng.integers(1, 5))], y=0.985))
    return shapes


def _barber(rng: Rng) -> Shapes:
    shapes: Shapes = []
    for x in (-1.05, 0.15, 1.2):
        shapes.append(box((x - 0.35, 0.96, 0.95), (x + 0.35, 0.985, 1.95), "metal_grey"))
        shapes.append(box((x - 0.4, 0.75, 0.85), (x + 0.4, 0.98, 0.9), "ware_cream"))
        shapes.append(cylinder((x, 0.42, 0.0), (x, 0.42, 0.45), 0.09, "metal_grey", sides=8))
        leather = ("ware_red", "metal_dark")[int(rng.integers(2))]
        shapes.append(box((x - 0.26, 0.2, 0.45), (x + 0.26, 0.66, 0.57), leather))
        shapes.append(box((x - 0.24, 0.18, 0.57), (x + 0.24, 0.27, 1.15), leather))
        for side in (-0.3, 0.26):
            shapes.append(box((x + side, 0.22, 0.68), (x + side + 0.05, 0.6, 0.73), "metal_grey"))
    return shapes + _row(rng, -1.4, 1.4, 0.9, "bottles", 0.82)


def _pharmacy(rng: Rng) -> Shapes:
    shapes = _shelves(rng, -1.6, 1.6, (0.5, 0.85, 1.2, 1.55, 1.9), "boxes")
    shapes += _counter(-0.4, 1.3)
    for wide, tall in ((0.32, 0.11), (0.11, 0.32)):
        shapes.append(box((-1.0 - wide, 0.1, 1.75 - tall), (-1.0 + wide, 0.14, 1.75 + tall),
                          "neon_green"))  # fmt: skip
    return shapes + _row(rng, -0.3, 1.2, 1.0, "boxes", 0.5)


def _phones(rng: Rng) -> Shapes:
    shapes: Shapes = []
    for x in (-1.45, 0.25):
        shapes.append(box((x, 0.18, 0.86), (x + 1.2, 0.6, 0.92), "ware_cream"))
        shapes.append(box((x + 0.1, 0.28, 0.0), (x + 1.1, 0.5, 0.86), "ware_cream"))
        for k in range(6):
            shapes.append(box((x + 0.08 + 0.19 * k, 0.26, 0.93), (x + 0.17 + 0.19 * k, 0.42, 0.95),
                              "metal_dark"))  # fmt: skip
    for k, x in enumerate((-1.55, -0.5, 0.55)):
        material = _WARES[(k + int(rng.integers(5))) % 5]
        shapes.append(pane(x, x + 0.95, 1.15, 2.1, material, y=0.98))
        shapes.append(pane(x + 0.34, x + 0.6, 1.3, 1.85, "metal_dark", y=0.97))
    return shapes


def _flowers(rng: Rng) -> Shapes:
    shapes: Shapes = []
    for step in range(3):
        y = 0.08 + 0.28 * step
        shapes.append(box((-1.6, y, 0.0), (1.6, y + 0.26, 0.12 + 0.28 * step), "bench_wood"))
        for x in np.linspace(-1.45, 1.45, 9):
            z = 0.12 + 0.28 * step
            tall = float(rng.uniform(0.35, 0.6))
            shapes.append(cylinder((x, y + 0.12, z), (x, y + 0.12, z + 0.22), 0.08, "metal_grey",
                                   top=0.1, sides=7))  # fmt: skip
            shapes.append(cylinder((x, y + 0.12, z + 0.2), (x, y + 0.12, z + tall), 0.06, "leaf",
                                   top=0.15, sides=7))  # fmt: skip
            bloom = lathe([(0.15, 0.0), (0.12, 0.07), (0.0, 0.1)],
                          _WARES[int(rng.integers(4))], sides=7)  # fmt: skip
            shapes.append(moved(bloom, (x, y + 0.12, z + tall)))
    return shapes


def _office(rng: Rng) -> Shapes:
    shapes: Shapes = []
    for row in range(2):
        for x in np.linspace(-1.45, 1.15, 6):
            if rng.uniform() < 0.8:
                z = 1.0 + 0.45 * row
                shapes.append(pane(x, x + 0.3, z, z + 0.38, "ware_cream", y=0.05))
                shapes.append(pane(x + 0.03, x + 0.27, z + 0.16, z + 0.35,
                                   _WARES[int(rng.integers(1, 5))], y=0.045))  # fmt: skip
    for x in (-0.9, 0.7):
        shapes.append(box((x - 0.55, 0.5, 0.7), (x + 0.55, 0.95, 0.74), "bench_wood"))
        shapes.append(box((x - 0.2, 0.7, 0.8), (x + 0.25, 0.73, 1.1), "metal_dark"))
        shapes.append(box((x - 0.5, 0.55, 0.0), (x + 0.5, 0.6, 0.7), "bench_wood", SHADE))
    return [*shapes, pane(-0.7, 0.8, 1.5, 2.2, "ware_blue", y=0.985)]


def _gallery(rng: Rng) -> Shapes:
    shapes: Shapes = []
    pictures = ((-1.3, 1.55, 0.4, 0.5), (-0.45, 1.5, 0.3, 0.35), (0.45, 1.6, 0.42, 0.3),
                (1.25, 1.5, 0.32, 0.45))  # fmt: skip
    for x, z, wide, tall in pictures:
        shapes.append(box((x - wide, 0.96, z - tall), (x + wide, 0.985, z + tall), "bench_wood"))
        inside = _WARES[int(rng.integers(5))]
        shapes.append(pane(x - wide + 0.06, x + wide - 0.06, z - tall + 0.06, z + tall - 0.06,
                           inside, y=0.955))  # fmt: skip
    for x in (-0.9, 0.95):
        shapes.append(box((x - 0.17, 0.25, 0.0), (x + 0.17, 0.6, 0.9), "ware_cream"))
        vase = lathe([(0.08, 0.9), (0.15, 1.05), (0.13, 1.2), (0.06, 1.28), (0.09, 1.35),
                      (0.0, 1.35)], _WARES[int(rng.integers(1, 5))], sides=10)  # fmt: skip
        shapes.append(moved(vase, (x, 0.42, 0.0)))
    return shapes


def _empty(rng: Rng) -> Shapes:
    shapes: Shapes = [
        box((-1.2, 0.45, 0.0), (-0.7, 0.85, 0.4), "bench_wood", SHADE),
        box((-1.05, 0.5, 0.4), (-0.7, 0.8, 0.7), "ware_ochre"),
    ]
    for x, high in ((0.6, 2.0), (0.95, 2.0)):
        shapes.append(box((x, 0.7, 0.0), (x + 0.04, 0.74, high), "bench_wood"))
    for z in np.arange(0.3, 2.0, 0.3):
        shapes.append(box((0.6, 0.7, z), (0.99, 0.74, z + 0.03), "bench_wood"))
    for x in np.linspace(-1.6, 0.9, 4):
        if rng.uniform() < 0.75:
            shapes.append(pane(x, x + float(rng.uniform(0.5, 0.7)), 0.5, 2.0, "ware_cream",
                               y=0.012))  # fmt: skip
    return shapes


ROOMS: Mapping[str, Callable[[Rng], Shapes]] = MappingProxyType(
    {
        "books": _books, "bakery": _bakery, "clothes": _clothes, "bottles": _bottles,
        "grocer": _grocer, "cafe": _cafe, "barber": _barber, "pharmacy": _pharmacy,
        "phones": _phones, "flowers": _flowers, "office": _office, "gallery": _gallery,
        "empty": _empty,
    }
)  # fmt: skip
# Kind of shop, as of `cityx.building.shops.shop_names` -> the room that it has.
ROOM_OF: Mapping[str, str] = MappingProxyType(
    {
        "bakery": "bakery", "butcher": "bakery", "cafe": "cafe", "restaurant": "cafe",
        "quick": "cafe", "bar": "bottles", "wine": "bottles", "pharmacy": "pharmacy",
        "optician": "phones", "jeweller": "phones", "phones": "phones", "grocer": "grocer",
        "kiosk": "grocer", "clothes": "clothes", "cleaner": "clothes", "hair": "barber",
        "books": "books", "flowers": "flowers", "bank": "office", "travel": "office",
        "bicycles": "gallery", "furniture": "gallery",
    }
)  # fmt: skip


@lru_cache(maxsize=64)
@kept("shop room", least=0)
def shop_room(trade: str, variant: int, *, detail: int = 3) -> Prototype:
    """Make the room of a trade, a key of `ROOMS`, in one of `VARIANTS` arrangements."""
    del detail
    rng = rng_for(0, "assets/shop room", stable_id(trade, variant))
    shapes = _shell("ware_cream" if trade in ("pharmacy", "phones") else "bench_wood")
    return prototype(f"room_{trade}_{variant}", "trim", shapes + ROOMS[trade](rng))
