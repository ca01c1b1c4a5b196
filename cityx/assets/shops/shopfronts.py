"""Shopfronts, with their awnings and signs; see `cityx.assets.openings.openings` for the frame."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from cityx.assets.kept_prototypes import kept
from cityx.assets.openings.openings import FINE, GLASS, Shapes, pane, slab, surround
from cityx.assets.shapes import Color, prototype
from cityx.city.mesh import one_mesh
from cityx.city.scene import Prototype
from cityx.ids import rng_for

WIDTH, HEIGHT = 3.6, 3.0  # metres, of every shopfront
_W = WIDTH / 2
STALL = -0.11  # how far the stallriser stands out
_CARDS: tuple[Color, ...] = ((0.9, 0.9, 0.88), (0.9, 0.35, 0.2), (0.95, 0.8, 0.3), (0.3, 0.5, 0.7))


def _goods(purpose: str, x0: float, x1: float, floor: float, count: int) -> Shapes:
    """Put posters and goods low behind the glass, so that a shop window is not empty."""
    rng = rng_for(0, "assets/goods", len(purpose))
    shapes: Shapes = []
    for x in np.linspace(x0, x1, count + 1)[:-1]:
        step = (x1 - x0) / count
        width, height = step * rng.uniform(0.45, 0.8), rng.uniform(0.3, 0.9)
        left = x + rng.uniform(0.05, 0.2) * step
        color = _CARDS[int(rng.integers(len(_CARDS)))]
        shapes.append(pane(left, left + width, floor, floor + height, "marking_white", color,
                           y=-0.028))  # fmt: skip
    return shapes


def shop_classic(glass: str) -> Shapes:
    """Painted timber shopfront: pilasters, stallriser, three lights and a door in the middle."""
    shapes = [
        slab(-_W, -_W + 0.22, -0.3, HEIGHT, -0.14, "door_paint"),
        slab(_W - 0.22, _W, -0.3, HEIGHT, -0.14, "door_paint"),
        slab(-_W + 0.22, _W - 0.22, HEIGHT - 0.1, HEIGHT, -0.13, "door_paint"),
        pane(-_W + 0.2, _W - 0.2, 0.0, HEIGHT - 0.08, glass),
        slab(-_W + 0.22, _W - 0.22, 2.28, 2.36, -0.08, "door_paint", back=-0.02),
        slab(-0.5, -0.42, 0.0, HEIGHT - 0.1, -0.08, "door_paint", back=-0.02),
        slab(0.42, 0.5, 0.0, HEIGHT - 0.1, -0.08, "door_paint", back=-0.02),
        slab(-0.42, 0.42, 0.0, 0.75, -0.05, "door_paint", (0.85, 0.85, 0.85)),
        slab(-0.42, -0.32, 0.75, 2.28, -0.05, "door_paint", (0.85, 0.85, 0.85), back=-0.02),
        slab(0.32, 0.42, 0.75, 2.28, -0.05, "door_paint", (0.85, 0.85, 0.85), back=-0.02),
        slab(-0.6, 0.6, -0.3, 0.02, -0.2, "step_stone"),
    ]
    for x0, x1 in ((-_W + 0.22, -0.5), (0.5, _W - 0.22)):
        shapes.append(slab(x0, x1, -0.3, 0.55, STALL, "door_paint"))
        shapes.append(slab(x0 + 0.1, x1 - 0.1, 0.1, 0.45, STALL - 0.015, "door_paint",
                           (0.8, 0.8, 0.8), back=STALL))  # fmt: skip
        shapes.append(slab((x0 + x1) / 2 - 0.02, (x0 + x1) / 2 + 0.02, 0.55, 2.28, -0.07,
                           "door_paint", back=-0.02))  # fmt: skip
        shapes += _goods("classic" + str(x0 > 0), x0 + 0.05, x1 - 0.05, 0.58, 3)
    return shapes


def shop_modern(glass: str) -> Shapes:
    """Frameless front: large panes, a glass door at the right."""
    shapes = surround(WIDTH, HEIGHT, 0.06, -0.08, "frame_paint")
    shapes += [
        pane(-_W + 0.04, _W - 0.04, 0.0, HEIGHT - 0.04, glass),
        slab(-_W + 0.06, 0.62, 0.0, 0.18, -0.07, "frame_paint", back=-0.02),
        slab(0.62, 0.67, 0.0, HEIGHT - 0.06, -0.07, "frame_paint", back=-0.02),
        slab(0.67, _W - 0.06, 2.3, 2.35, -0.06, "frame_paint", back=-0.02),
        slab(-0.6, -0.56, 0.18, HEIGHT - 0.06, -0.055, "frame_paint", back=-0.02),
        slab(0.80, 0.83, 0.8, 1.5, -0.10, "metal_grey", back=-0.04),
        slab(-_W, _W, -0.3, 0.0, -0.08, "step_stone"),
    ]
    return shapes + _goods("modern", -_W + 0.1, 0.55, 0.2, 4)


def shop_window(glass: str) -> Shapes:
    """Display window without a door, over a low wall."""
    shapes = [
        *surround(WIDTH, HEIGHT, 0.09, -0.09, "frame_paint", bottom=False),
        slab(-_W, _W, -0.3, 0.42, -0.10, "trim"),
        pane(-_W + 0.06, _W - 0.06, 0.4, HEIGHT - 0.05, glass),
        slab(-0.62, -0.57, 0.42, HEIGHT - 0.09, -0.07, "frame_paint", back=-0.02),
        slab(0.57, 0.62, 0.42, HEIGHT - 0.09, -0.07, "frame_paint", back=-0.02),
        slab(-_W + 0.09, _W - 0.09, 2.35, 2.41, -0.07, "frame_paint", back=-0.02),
        slab(-_W, _W, 0.42, 0.47, -0.16, "trim"),
    ]
    return shapes + _goods("display window", -_W + 0.15, _W - 0.15, 0.48, 6)


def shop_cafe(glass: str) -> Shapes:
    """Folding doors of four leaves with solid feet."""
    shapes = surround(WIDTH, HEIGHT, 0.1, -0.10, "door_paint", bottom=False)
    shapes.append(pane(-_W + 0.05, _W - 0.05, 0.0, HEIGHT - 0.05, glass))
    edges = np.linspace(-_W + 0.1, _W - 0.1, 5)
    for x0, x1 in pairwise(edges):
        shapes.append(slab(x0 + 0.01, x0 + 0.07, 0.0, 2.4, -0.07, "door_paint", back=-0.02))
        shapes.append(slab(x1 - 0.07, x1 - 0.01, 0.0, 2.4, -0.07, "door_paint", back=-0.02))
        shapes.append(slab(x0 + 0.07, x1 - 0.07, 0.0, 0.45, -0.065, "door_paint", back=-0.02))
    shapes.append(slab(-_W + 0.1, _W - 0.1, 2.4, 2.5, -0.08, "door_paint", back=-0.02))
    shapes.append(slab(-_W, _W, -0.3, 0.0, -0.12, "step_stone"))
    return shapes


def shop_shutter(glass: str) -> Shapes:
    """Shop with its roller shutter down."""
    del glass
    shapes = surround(WIDTH, HEIGHT, 0.12, -0.10, "frame_paint", bottom=False)
    for row in range(14):
        z = 0.2 * row
        shapes.append(slab(-_W + 0.12, _W - 0.12, z + 0.012, z + 0.19, -0.045, "door_paint",
                           (0.9, 0.9, 0.9)))  # fmt: skip
    shapes.append(pane(-_W + 0.1, _W - 0.1, 0.0, HEIGHT - 0.1, "metal_dark", y=-0.012))
    return shapes


SHOPFRONTS: Mapping[str, Callable[[str], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (shop_classic, shop_modern, shop_window, shop_cafe, shop_shutter)
    }
)


@lru_cache(maxsize=32)
@kept("shopfront", least=FINE)
def shopfront(name: str, *, detail: int = 2) -> Prototype:
    """Make a shopfront prototype; `name` is a key of `SHOPFRONTS`, `detail` as of windows."""
    if detail >= FINE:
        from cityx.assets.shops.fine_shopfronts import FINE_SHOPFRONTS

        shapes = FINE_SHOPFRONTS[name]()
        return prototype(f"{name}_fine", "shopfront", shapes)
    return prototype(name, "shopfront", SHOPFRONTS[name](GLASS))


# --- awnings and signs ----------------------------------------------------------------------------


def awning() -> Shapes:
    """Sloping awning of striped cloth, 3.4 m wide, its upper edge at z = 0."""
    shapes: Shapes = []
    edges = np.linspace(-1.7, 1.7, 13)
    for number, (x0, x1) in enumerate(pairwise(edges)):
        tint: Color = (1.0, 1.0, 1.0) if number % 2 else (0.62, 0.62, 0.62)
        corners = [[x0, -1.25, -0.62], [x1, -1.25, -0.62], [x1, 0.0, 0.0], [x0, 0.0, 0.0]]
        faces = [[0, 1, 2, 3], [3, 2, 1, 0]]
        shapes.append(one_mesh(0, corners, faces, materials=("cloth",), tint=tint))
        shapes.append(pane(x0, x1, -0.84, -0.62, "cloth", tint, y=-1.25))
    for side in (-1.7, 1.7):
        cheek = [[side, -1.25, -0.62], [side, 0.0, -0.62], [side, 0.0, 0.0]]
        shapes.append(one_mesh(0, cheek, [[0, 1, 2], [2, 1, 0]], materials=("cloth",)))
    return shapes


def box_awning() -> Shapes:
    """Flat canopy on brackets."""
    return [
        slab(-1.7, 1.7, -0.10, 0.04, -1.1, "door_paint"),
        slab(-1.5, -1.44, -0.35, -0.10, -0.6, "metal_dark"),
        slab(1.44, 1.5, -0.35, -0.10, -0.6, "metal_dark"),
    ]


def sign_fascia() -> Shapes:
    """Name board over a shop, 3.4 m wide, its lower edge at z = 0."""
    return [
        slab(-1.7, 1.7, 0.0, 0.5, -0.16, "door_paint"),
        slab(-1.75, 1.75, 0.5, 0.57, -0.24, "trim"),
    ]


def sign_box() -> Shapes:
    """Light box over a shop."""
    return [slab(-1.7, 1.7, 0.02, 0.58, -0.24, "sign")]


def sign_letters() -> Shapes:
    """Thin rails for letters."""
    return [slab(-1.1, 1.1, z, z + 0.03, -0.06, "metal_dark") for z in (0.16, 0.34)]


def sign_blade() -> Shapes:
    """Small sign that hangs out over the pavement."""
    return [
        slab(-0.02, 0.02, 0.62, 0.66, -0.95, "metal_dark"),
        slab(-0.03, 0.03, 0.0, 0.60, -0.90, "sign", back=-0.22),
    ]


def sign_tower() -> Shapes:
    """Upright stack of tenants' signs, 4.2 m high, standing out from the wall."""
    shapes: Shapes = [
        slab(-0.06, 0.06, 0.0, 4.2, -0.26, "metal_grey", back=-0.20),
        slab(-0.03, 0.03, 0.5, 0.55, -0.22, "metal_grey"),
        slab(-0.03, 0.03, 3.6, 3.65, -0.22, "metal_grey"),
    ]
    for row, tint in enumerate(
        ((1.0, 1.0, 1.0), (0.93, 0.93, 0.94), (1.0, 1.0, 1.0), (0.93, 0.93, 0.94))
    ):
        z = 0.04 + 1.04 * row
        shapes.append(slab(-0.09, 0.09, z, z + 1.0, -0.98, "sign", tint, back=-0.26))
    return shapes


FITTINGS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            awning, box_awning, sign_fascia, sign_box, sign_letters, sign_blade, sign_tower,
        )
    }
)  # fmt: skip


@lru_cache(maxsize=32)
@kept("fitting", least=FINE)
def fitting(name: str, *, detail: int = 2) -> Prototype:
    """Make an awning or a sign; `name` is a key of `FITTINGS`, `detail` as of windows."""
    if detail >= FINE:
        from cityx.assets.shops.fine_shopfronts import FINE_FITTINGS

        return prototype(f"{name}_fine", "trim", FINE_FITTINGS[name]())
    return prototype(name, "trim", FITTINGS[name]())
