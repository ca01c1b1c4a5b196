"""What stands on roofs. Origins lie on the roof; feet reach below it, against gaps."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.street_pieces import leaf_mound
from cityx.assets.openings.frames import Shapes, pane
from cityx.assets.shapes import box, cylinder, disc, loft, moved, prototype
from cityx.city.scene import Prototype
from cityx.ids import rng_for

SUNK = -0.35  # metres below the roof to which feet reach


def hvac_unit() -> Shapes:
    """Air handling unit with two fans."""
    shapes: Shapes = [
        box((-1.3, -0.75, 0.15), (1.3, 0.75, 1.35), "plastic", (0.66, 0.67, 0.68)),
        box((-1.2, -0.65, SUNK), (1.2, 0.65, 0.15), "metal_dark"),
        box((-1.31, -0.5, 0.4), (-1.3, 0.5, 1.1), "metal_dark"),
    ]
    for x in (-0.62, 0.62):
        shapes.append(cylinder((x, 0, 1.35), (x, 0, 1.5), 0.48, "metal_grey", sides=10))
        shapes.append(cylinder((x, 0, 1.5), (x, 0, 1.505), 0.42, "metal_dark", sides=10))
    return shapes


def condenser() -> Shapes:
    """Small cooling unit."""
    return [
        box((-0.45, -0.2, SUNK), (0.45, 0.2, 0.75), "plastic", (0.85, 0.85, 0.82)),
        disc((0.05, -0.215, 0.4), 0.26, "metal_dark", sides=10, thickness=0.01),
    ]


def stair_head() -> Shapes:
    """Head of a staircase with a door."""
    return [
        box((-1.5, -2.0, SUNK), (1.5, 2.0, 2.5), "plaster"),
        box((-1.65, -2.15, 2.5), (1.65, 2.15, 2.65), "concrete"),
        box((-0.45, -2.03, 0.0), (0.45, -2.0, 2.0), "metal_dark"),
    ]


def lift_house() -> Shapes:
    """Lift overrun with louvres."""
    shapes: Shapes = [
        box((-1.9, -1.6, SUNK), (1.9, 1.6, 3.2), "plaster"),
        box((-2.0, -1.7, 3.2), (2.0, 1.7, 3.35), "concrete"),
    ]
    for row in range(5):
        shapes.append(pane(-1.2, 1.2, 1.2 + 0.3 * row, 1.42 + 0.3 * row, "metal_dark", y=-1.61))
    return shapes


def antenna() -> Shapes:
    """Television aerial on a mast."""
    shapes: Shapes = [cylinder((0, 0, SUNK - 0.6), (0, 0, 3.2), 0.03, "metal_grey", sides=5)]
    for row, half in enumerate((0.5, 0.45, 0.4, 0.35, 0.3)):
        y = -0.6 + 0.28 * row
        shapes.append(box((-half, y - 0.012, 2.9), (half, y + 0.012, 2.924), "metal_grey"))
    shapes.append(box((-0.015, -0.7, 2.88), (0.015, 0.6, 2.91), "metal_grey"))
    return shapes


def dish() -> Shapes:
    """Satellite dish."""
    return [
        cylinder((0, 0.1, SUNK), (0, 0.1, 0.9), 0.03, "metal_grey", sides=5),
        disc((0, 0.0, 1.0), 0.4, "plastic", (0.8, 0.8, 0.8), sides=12, thickness=0.05),
        box((-0.015, -0.4, 0.95), (0.015, 0.0, 0.98), "metal_grey"),
    ]


def solar_panels() -> Shapes:
    """Two rows of three solar panels, tilted towards -y."""
    shapes: Shapes = []
    for y in (-1.3, 0.6):
        for x in (-1.75, -0.55, 0.65):
            ring = np.array([[x, y, 0.15], [x + 1.1, y, 0.15], [x + 1.1, y + 1.4, 0.62],
                             [x, y + 1.4, 0.62]])  # fmt: skip
            panel = loft(np.stack([ring - [0, 0, 0.04], ring]), "car_glass")
            shapes.append(panel)
            for dx in (0.1, 1.0):
                shapes.append(box((x + dx, y + 1.2, SUNK), (x + dx + 0.05, y + 1.25, 0.52),
                                  "metal_grey", bottom=False))  # fmt: skip
                shapes.append(box((x + dx, y + 0.1, SUNK), (x + dx + 0.05, y + 0.15, 0.18),
                                  "metal_grey", bottom=False))  # fmt: skip
    return shapes


def solar_flush() -> Shapes:
    """Two rows of three panels that lie on a slope, whose lower edge is towards -y."""
    shapes: Shapes = []
    for y in (-1.5, 0.05):
        for x in (-1.72, -0.55, 0.62):
            ring = np.array([[x, y, 0.10], [x + 1.1, y, 0.10], [x + 1.1, y + 1.45, 0.10],
                             [x, y + 1.45, 0.10]])  # fmt: skip
            shapes.append(loft(np.stack([ring - [0, 0, 0.04], ring]), "car_glass"))
    for y in (-1.2, -0.4, 0.4, 1.2):
        shapes.append(box((-1.72, y - 0.02, 0.0), (1.72, y + 0.02, 0.06), "metal_grey"))
    return shapes


def vent() -> Shapes:
    """Ventilation pipe with a hood."""
    return [
        cylinder((0, 0, SUNK), (0, 0, 0.9), 0.16, "metal_grey", sides=8),
        cylinder((0, 0, 0.9), (0, 0, 1.1), 0.28, "metal_grey", top=0.1, sides=8),
    ]


def water_tank() -> Shapes:
    """Wooden water tank on legs."""
    shapes: Shapes = [
        cylinder((0, 0, 1.8), (0, 0, 4.4), 1.3, "wood", (0.36, 0.27, 0.2), sides=12),
        cylinder((0, 0, 4.4), (0, 0, 5.2), 1.4, "metal_dark", top=0.05, sides=12),
        box((-1.15, -1.15, 1.65), (1.15, 1.15, 1.8), "metal_dark"),
    ]
    for x in (-1.0, 1.0):
        for y in (-1.0, 1.0):
            shapes.append(box((x - 0.08, y - 0.08, SUNK), (x + 0.08, y + 0.08, 1.65), "metal_dark"))
    return shapes


def water_cistern() -> Shapes:
    """Steel cistern on a frame."""
    return [
        box((-0.9, -0.9, SUNK), (0.9, 0.9, 0.3), "concrete"),
        box((-0.8, -0.8, 0.3), (0.8, 0.8, 1.9), "plastic", (0.82, 0.83, 0.8)),
    ]


def skylight() -> Shapes:
    """Ridge light on an upstand."""
    ring = np.array([[-0.8, -1.2, 0.35], [0.8, -1.2, 0.35], [0.8, 1.2, 0.35], [-0.8, 1.2, 0.35]])
    top = np.array([[-0.1, -1.0, 0.75], [0.1, -1.0, 0.75], [0.1, 1.0, 0.75], [-0.1, 1.0, 0.75]])
    return [box((-0.9, -1.3, SUNK), (0.9, 1.3, 0.35), "trim"), loft(np.stack([ring, top]), "glass")]


def ac_row() -> Shapes:
    """Row of four cooling units on rails, their pipes in a tray."""
    shapes: Shapes = [
        box((-1.75, -0.32, SUNK), (1.75, -0.26, 0.16), "metal_grey"),
        box((-1.75, 0.26, SUNK), (1.75, 0.32, 0.16), "metal_grey"),
        box((-1.85, 0.5, 0.12), (1.85, 0.68, 0.2), "metal_grey"),
    ]
    for k, x in enumerate((-1.3, -0.43, 0.43, 1.3)):
        tall = (1.0, 1.0, 0.78, 1.0)[k]
        shapes.append(box((x - 0.38, -0.28, 0.16), (x + 0.38, 0.22, 0.16 + tall), "plastic",
                          (0.6, 0.6, 0.57)))  # fmt: skip
        shapes.append(disc((x, -0.29, 0.16 + 0.5 * tall), 0.27, "metal_dark", sides=10,
                           thickness=0.01))  # fmt: skip
        shapes.append(box((x + 0.2, 0.2, 0.16), (x + 0.26, 0.6, 0.22), "plastic"))
    return shapes


def roof_patch() -> Shapes:
    """Mended sheet of a roof, welded on in two strips, a finger high."""
    return [
        box((-1.2, -0.8, SUNK), (1.25, 0.05, 0.02), "bitumen"),
        box((-1.3, -0.02, SUNK), (1.1, 0.85, 0.028), "bitumen", (0.86, 0.86, 0.86)),
    ]


def roof_hatch() -> Shapes:
    """Hatch with its lid ajar and the top of the ladder."""
    shapes: Shapes = [
        box((-0.55, -0.55, SUNK), (0.55, 0.55, 0.38), "metal_grey"),
        loft(np.array([[(-0.6, -0.6, 0.38), (0.6, -0.6, 0.38), (0.6, 0.6, 0.52), (-0.6, 0.6, 0.52)],
                       [(-0.6, -0.6, 0.44), (0.6, -0.6, 0.44), (0.6, 0.6, 0.58),
                        (-0.6, 0.6, 0.58)]]), "metal_panel"),
    ]  # fmt: skip
    for x in (-0.24, 0.2):
        shapes.append(box((x, -0.66, SUNK), (x + 0.04, -0.62, 1.3), "metal_dark"))
    return shapes


def roof_pipes() -> Shapes:
    """Pipes and a duct on sleepers."""
    shapes: Shapes = [
        box((-1.9, 0.05, 0.12), (1.3, 0.45, 0.5), "metal_panel", (0.85, 0.86, 0.87)),
        box((0.9, 0.05, SUNK), (1.3, 0.45, 0.12), "metal_panel", (0.85, 0.86, 0.87)),
    ]
    for y, radius in ((-0.15, 0.07), (-0.35, 0.05), (-0.5, 0.05)):
        shapes.append(cylinder((-1.9, y, 0.2), (1.9, y, 0.2), radius, "metal_grey", sides=6))
    for x in (-1.6, -0.4, 0.8, 1.7):
        shapes.append(box((x, -0.6, SUNK), (x + 0.12, 0.5, 0.12), "concrete"))
    return shapes


def roof_planters() -> Shapes:
    """Trough of shrubs with a bench, as on terraced roofs."""
    shapes: Shapes = [
        box((-1.3, -0.3, SUNK), (1.3, 0.3, 0.5), "wood", (0.55, 0.5, 0.45)),
        box((-1.0, -0.95, 0.38), (1.0, -0.55, 0.45), "bench_wood"),
        box((-0.9, -0.9, SUNK), (-0.8, -0.6, 0.38), "metal_dark"),
        box((0.8, -0.9, SUNK), (0.9, -0.6, 0.38), "metal_dark"),
    ]
    for k, x in enumerate((-1.0, -0.5, 0.0, 0.5, 1.0)):
        high = (0.75, 0.5, 0.9, 0.6, 0.8)[k]
        shapes.append(cylinder((x, 0.0, 0.42), (x, 0.0, 0.5 + high), 0.32, "hedge", top=0.06,
                               sides=7))  # fmt: skip
    return shapes


def roof_lawn() -> Shapes:
    """Garden on a roof, 5.4 m by 3.8 m: a lawn in a kerb, shrubs about it and a bench on slabs."""
    shapes: Shapes = [
        box((-2.7, -1.9, SUNK), (2.7, 1.9, 0.3), "concrete", (1.1, 1.08, 1.04)),
        box((-2.55, -1.75, 0.2), (2.55, 1.75, 0.34), "grass"),
        box((-0.9, -1.75, 0.2), (0.9, -0.5, 0.36), "paving"),
        box((-0.8, -0.95, 0.68), (0.8, -0.6, 0.74), "bench_wood"),
        *(box((x, -0.9, 0.3), (x + 0.08, -0.65, 0.68), "metal_dark") for x in (-0.7, 0.62)),
    ]
    for number, (x, y, wide, high) in enumerate(
        ((-2.0, 1.1, 0.55, 1.7), (-0.8, 1.2, 0.5, 0.9), (0.5, 1.15, 0.55, 1.3),
         (1.9, 1.0, 0.6, 1.9), (2.1, -0.3, 0.45, 0.8), (-2.1, -0.5, 0.45, 1.0),
         (1.9, -1.3, 0.4, 0.6), (-1.9, -1.35, 0.4, 0.7))
    ):  # fmt: skip
        shapes.append(leaf_mound(f"roof lawn {number}", (x - wide, y - wide, 0.3),
                                 (x + wide, y + wide, 0.3 + high), 36, size=0.16))  # fmt: skip
    return shapes


def roof_meadow() -> Shapes:
    """Stonecrop and grasses on 6.2 m by 4.4 m of a roof, thin and never mown, in an edge of gravel.

    A strip of gravel keeps the edge dry, and no way leads over it.
    """
    shapes: Shapes = [
        box((-3.1, -2.2, SUNK), (3.1, 2.2, 0.07), "gravel"),
        box((-2.75, -1.85, SUNK), (2.75, 1.85, 0.12), "meadow"),
        box((-2.4, -1.7, SUNK), (-0.3, 0.2, 0.135), "grass", (0.95, 0.85, 0.6)),
        box((0.5, -0.4, SUNK), (2.6, 1.6, 0.135), "grass", (0.8, 0.75, 0.7)),
    ]
    for number, (x, y, wide, high) in enumerate(
        ((-1.9, 1.0, 0.7, 0.4), (-0.4, 1.3, 0.5, 0.3), (0.6, -1.2, 0.8, 0.35),
         (2.1, -1.3, 0.5, 0.5), (1.4, 0.5, 0.6, 0.3))
    ):  # fmt: skip
        shapes.append(leaf_mound(f"roof meadow {number}", (x - wide, y - wide, 0.08),
                                 (x + wide, y + wide, 0.1 + high), 30, size=0.12))  # fmt: skip
    return shapes


def roof_beds() -> Shapes:
    """Terrace of boards, 5.6 m by 4 m, with troughs on three sides and a table with benches."""
    wood, board = (0.75, 0.66, 0.55), (0.9, 0.82, 0.7)
    shapes: Shapes = [
        box((-2.8, -2.0, SUNK), (2.8, 2.0, 0.1), "wood", board),
        box((-2.8, 1.3, SUNK), (2.8, 2.0, 0.6), "wood", wood),
        box((-2.8, -2.0, SUNK), (-2.1, 1.3, 0.6), "wood", wood),
        box((2.1, -0.6, SUNK), (2.8, 1.3, 0.6), "wood", wood),
        box((-0.9, -0.9, 0.76), (0.9, -0.1, 0.82), "bench_wood"),
        *(box((x, -0.8, 0.1), (x + 0.1, -0.2, 0.76), "metal_dark") for x in (-0.7, 0.6)),
        *(box((-0.9, y, 0.45), (0.9, y + 0.35, 0.52), "bench_wood") for y in (-1.45, 0.15)),
        *(box((x, y + 0.05, 0.1), (x + 0.1, y + 0.3, 0.45), "metal_dark")
          for x in (-0.7, 0.6) for y in (-1.45, 0.15)),
    ]  # fmt: skip
    rows = [(x, 1.65) for x in (-2.3, -1.2, -0.1, 1.0, 2.2)]
    rows += [(-2.45, y) for y in (-1.5, -0.5, 0.5)] + [(2.45, y) for y in (0.0, 0.8)]
    for number, (x, y) in enumerate(rows):
        high = (0.7, 0.5, 1.1, 0.6, 1.5)[number % 5]
        shapes.append(leaf_mound(f"roof beds {number}", (x - 0.5, y - 0.32, 0.55),
                                 (x + 0.5, y + 0.32, 0.6 + high), 26, size=0.14))  # fmt: skip
    return shapes


def _stain(number: int) -> Shapes:
    """Dirt that a puddle left: an irregular patch, a finger high, 3 m across."""
    rng = rng_for(number, "assets/roof_stain", 1)
    angle = 2 * np.pi * np.arange(11) / 11
    radius = rng.uniform(0.75, 1.45, 11)
    x, y = radius * np.cos(angle), 0.75 * radius * np.sin(angle)
    rings = [np.column_stack([x, y, np.full(11, z)]) for z in (-0.1, 0.012)]
    return [loft(np.stack(rings), "bitumen")]


def roof_sheet() -> Shapes:
    """Make a repaired part of a roof, 6.4 m by 4.4 m: four strips of felt and their laps."""
    strips: Shapes = []
    for number in range(4):
        y, shade = -2.2 + 1.1 * number, (1.0, 0.93, 1.05, 0.97)[number]
        strips.append(
            box(
                (-3.2 + 0.1 * (number % 2), y, -0.1),
                (3.2, y + 1.12, 0.008 + 0.004 * (number % 2)),
                "bitumen",
                (shade, shade, shade),
                bottom=False,
            )
        )
    return strips  # fmt: skip


def roof_duct() -> Shapes:
    """Duct of 5 m with a bend, a branch and a cowl, on legs."""
    steel = (0.85, 0.86, 0.87)
    shapes: Shapes = [
        box((-2.5, -0.3, 0.3), (2.0, 0.3, 0.8), "metal_panel", steel),
        box((2.0, -0.3, SUNK), (2.5, 0.3, 0.8), "metal_panel", steel),
        box((-0.9, 0.3, 0.35), (-0.5, 1.0, 0.75), "metal_panel", steel),
        box((-0.95, 1.0, SUNK), (-0.45, 1.45, 1.0), "metal_panel", steel),
        cylinder((-2.1, 0.0, 0.8), (-2.1, 0.0, 1.3), 0.2, "metal_grey", top=0.3, sides=8),
    ]
    for x in (-2.2, -0.8, 0.6):
        shapes.append(box((x, -0.34, SUNK), (x + 0.06, 0.34, 0.3), "metal_dark", bottom=False))
    return shapes


def roof_walkway() -> Shapes:
    """Slabs on which one walks to the plant, 5 m."""
    return [
        box((x - 0.58, -0.3, SUNK), (x + 0.58, 0.3, 0.05), "concrete", (1.1, 1.1, 1.08))
        for x in (-1.8, -0.6, 0.6, 1.8)
    ]


def roof_railing() -> Shapes:
    """Bay of a railing behind a parapet, 3 m long and 1.1 m high; it is scaled along x."""
    rails = [box((-1.5, -0.02, z), (1.5, 0.02, z + 0.04), "metal_grey") for z in (0.62, 1.06)]
    return [*rails, *(box((x, -0.02, SUNK), (x + 0.04, 0.02, 1.06), "metal_grey", bottom=False)
                      for x in (-1.5, -0.02))]  # fmt: skip


def deck_parapet() -> Shapes:
    """Bay of the parapet about a parking deck, as `roof_railing`."""
    return [
        box((-1.5, -0.08, SUNK), (1.5, 0.08, 0.95), "concrete", bottom=False),
        box((-1.5, -0.11, 0.95), (1.5, 0.11, 1.02), "concrete", (1.1, 1.1, 1.08)),
    ]


def chimney() -> Shapes:
    """Chimney of brick with three pots, 3 m high, its foot at the origin, its top at z = 3."""
    shapes: Shapes = [
        box((-0.55, -0.32, 0.0), (0.55, 0.32, 2.55), "brick"),
        box((-0.62, -0.39, 2.55), (0.62, 0.39, 2.68), "concrete", (0.8, 0.8, 0.78)),
    ]
    for x in (-0.34, 0.0, 0.34):
        shapes.append(
            cylinder(
                (x, 0, 2.68), (x, 0, 3.0), 0.11, "roof_tiles", (0.55, 0.28, 0.18), top=0.09, sides=7
            )
        )
    return shapes


def chimney_small() -> Shapes:
    """Make a rendered chimney with a cover plate, 3 m high."""
    return [
        box((-0.28, -0.28, 0.0), (0.28, 0.28, 2.7), "plaster"),
        box((-0.36, -0.36, 2.7), (0.36, 0.36, 2.78), "concrete"),
        box((-0.16, -0.16, 2.78), (0.16, 0.16, 2.9), "metal_dark"),
        moved(box((-0.34, -0.34, 2.9), (0.34, 0.34, 2.95), "concrete")),
    ]


DECK_BAY, DECK_STALL = 2.5, 5.0  # metres, width and length of a bay of a parking deck
# Cars in the four bays of a row: which body stands in each, and which paint it has.
_PARKED = {
    "deck_bays": (("hatchback", 0), ("", 0), ("sedan", 2), ("", 0)),
    "deck_bays_full": (("sedan", 4), ("suv", 1), ("", 0), ("hatchback", 6)),
    "deck_bays_free": (("", 0), ("", 0), ("", 0), ("suv", 3)),
}


def _deck_row(cars: Sequence[tuple[str, int]]) -> Shapes:
    """Four marked bays of a parking deck, open towards -y, with the cars that stand in them."""
    from cityx.assets.vehicles.vehicles import PAINTS
    from cityx.assets.vehicles.vehicles import car as made

    half, deep = 2 * DECK_BAY, DECK_STALL / 2
    shapes: Shapes = [box((-half, deep - 0.1, SUNK), (half, deep, 0.012), "marking_white")]
    for number in range(5):
        x = -half + number * DECK_BAY
        shapes.append(box((x - 0.05, -deep, SUNK), (x + 0.05, deep, 0.012), "marking_white"))
    for number, (body, paint) in enumerate(cars):
        if not body:
            continue
        mesh = made(body).mesh
        painted = np.array([name == "car_paint" for name in mesh.materials])[mesh.material]
        tint = np.where(painted[:, None], mesh.tint * PAINTS[paint], mesh.tint)
        place = (-half + (number + 0.5) * DECK_BAY, 0.0, 0.0)
        parked = replace(mesh, tint=tint.astype(np.float32))
        shapes.append(moved(parked, place, yaw=np.pi * (number % 2)))
    return shapes


def deck_ramp() -> Shapes:
    """Head of the ramp to a parking deck in the place of four bays, under a roof at its far end."""
    half, deep, roof = 2 * DECK_BAY, DECK_STALL / 2, 2.5
    under = -0.1 * half  # where the roof ends, along x
    shapes: Shapes = [
        box((-half, -deep, SUNK), (-half + 0.2, deep, roof), "concrete"),
        box((-half, -deep, roof), (under, deep, roof + 0.22), "concrete"),
        box((under - 0.02, -0.45, 0.9 * roof), (under + 0.02, 0.45, 0.98 * roof), "sign"),
        box((-half, -0.06, SUNK), (half, 0.06, 0.16), "kerb_stone"),
    ]
    for side in (-1, 1):
        y, middle = side * (deep - 0.1), side * deep / 2
        shapes += [
            box((-half, y - 0.1, SUNK), (under, y + 0.1, roof), "concrete"),
            box((under, y - 0.1, SUNK), (half, y + 0.1, 1.0), "concrete"),
            box((half - 0.1, y - 0.12, SUNK), (half, y + 0.12, 1.15), "marking_yellow"),
            # The way down, dark below the roof, and the way up beside it.
            box((-half + 0.2, middle - 1.0, 0.0), (0.75 * half, middle + 1.0, 0.012), "asphalt",
                (0.45, 0.45, 0.45)),
        ]  # fmt: skip
    return shapes


DECK_ROWS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {name: partial(_deck_row, cars) for name, cars in _PARKED.items()}
)
STAINS = ("roof_stain_a", "roof_stain_b", "roof_stain_c")
ROOF_FURNITURE: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            hvac_unit, condenser, stair_head, lift_house, antenna, dish, solar_panels, solar_flush,
            vent,
            water_tank, water_cistern, skylight, chimney, chimney_small, ac_row, roof_patch,
            roof_hatch, roof_pipes, roof_planters, roof_lawn, roof_duct, roof_walkway, roof_railing,
            deck_parapet, roof_sheet, deck_ramp, roof_meadow, roof_beds,
        )
    }
    | {name: partial(_stain, number) for number, name in enumerate(STAINS)}
    | dict(DECK_ROWS)
)  # fmt: skip
# Half diagonal of the plan of each piece, metres, for keeping it on its roof.
REACH: Mapping[str, float] = MappingProxyType(
    {
        "hvac_unit": 1.6, "condenser": 0.6, "stair_head": 2.7, "lift_house": 2.7, "antenna": 0.8,
        "dish": 0.6, "solar_panels": 2.6, "vent": 0.4, "water_tank": 1.9, "water_cistern": 1.3,
        "skylight": 1.6, "chimney": 0.75, "chimney_small": 0.55, "ac_row": 1.95,
        "roof_patch": 1.55, "roof_hatch": 0.9, "roof_pipes": 2.0, "roof_planters": 1.6,
        "roof_lawn": 3.4, "deck_bays": 5.6, "deck_bays_full": 5.6, "deck_bays_free": 5.6,
        "deck_ramp": 5.6, "roof_duct": 2.9, "roof_walkway": 2.5, "roof_railing": 1.6,
        "deck_parapet": 1.6, "roof_sheet": 3.9, **dict.fromkeys(STAINS, 1.45),
        "roof_meadow": 3.9, "roof_beds": 3.5,
    }
)  # fmt: skip


@lru_cache(maxsize=32)
def roof_furniture(name: str) -> Prototype:
    """Make a piece of roof furniture; `name` is a key of `ROOF_FURNITURE`."""
    return prototype(name, "roof_furniture", ROOF_FURNITURE[name]())
