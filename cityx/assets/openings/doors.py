"""Doors as things that sit on a wall; see `cityx.assets.openings.frames`.

`DOORS` gives the opening each was drawn for. The forms for near views, of the same sizes, have
mouldings, panels, hinges, handles, letter boxes and gates of slats.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets.kept_prototypes import kept
from cityx.assets.openings import windows_houses as houses
from cityx.assets.openings import windows_old_town as old_town
from cityx.assets.openings import windows_towers as towers
from cityx.assets.openings.frames import (
    BACKING,
    FINE,
    FRAME,
    GLASS,
    PANE,
    PANE_MATERIAL,
    Shapes,
    arch,
    pane,
    plate,
    set_back,
    slab,
    surround,
)
from cityx.assets.openings.windows_halls import HALL_DOORS
from cityx.assets.shapes import bevelled, disc, fine_shapes, prism, prototype, tube
from cityx.assets.trims.mouldings import (
    bar,
    frame,
    hinge,
    knob,
    ledge,
    lever,
    portal,
    raised_panel,
    rectangle,
    ring_moulding,
    scroll,
    soft,
)
from cityx.city.scene import Prototype

LEAF = 0.075  # metres the face of a leaf lies behind the wall
_LINING = ((0.0, 0.0), (0.0, -0.012), (0.012, -0.020), (0.022, -0.018), (0.03, -0.008),
           (0.05, -0.006), (0.06, 0.004), (0.066, 0.02), (0.07, 0.06), (0.085, 0.064),
           (0.085, 0.135))  # fmt: skip


def _plain_leaf(x0: float, x1: float, z0: float, z1: float, panels: int) -> Shapes:
    """Make a panelled door leaf."""
    shapes = [slab(x0, x1, z0, z1, -0.035, "door_paint")]
    step = (z1 - z0 - 0.12) / panels
    for row in range(panels):
        low = z0 + 0.12 + row * step
        shapes.append(
            slab(x0 + 0.11, x1 - 0.11, low, low + step - 0.12, -0.048, "door_paint",
                 (0.82, 0.82, 0.82), back=-0.035)
        )  # fmt: skip
    return shapes


def door_panel() -> Shapes:
    """Panelled door with a transom light, on a step."""
    shapes = [
        slab(-0.60, 0.60, 2.62, 2.75, -0.06, "frame_paint"),
        pane(-0.58, 0.58, 2.2, 2.62, GLASS),
        slab(-0.60, 0.60, 2.12, 2.2, -0.07, "frame_paint"),
        slab(-0.80, 0.80, -0.35, 0.05, -0.42, "step_stone"),
    ]
    shapes += _plain_leaf(-0.60, 0.60, 0.05, 2.12, 3)
    shapes.append(disc((0.45, -0.07, 1.1), 0.035, "metal_grey", sides=6, thickness=0.03))
    return shapes


def door_double() -> Shapes:
    """Tall double door of a tenement, with a glazed transom."""
    shapes = _plain_leaf(-0.84, -0.01, 0.04, 2.3, 3) + _plain_leaf(0.01, 0.84, 0.04, 2.3, 3)
    shapes += [
        slab(-0.84, 0.84, 2.3, 2.4, -0.07, "door_paint"),
        pane(-0.84, 0.84, 2.4, 2.94, GLASS),
        slab(-0.03, 0.03, 2.4, 2.94, -0.05, "door_paint"),
        slab(-0.95, 0.95, -0.35, 0.04, -0.30, "step_stone"),
        slab(-0.025, 0.025, 0.04, 2.3, -0.06, "door_paint"),
    ]
    return shapes


def door_glass() -> Shapes:
    """Glazed entrance with a canopy."""
    shapes = surround(2.0, 2.7, 0.07, FRAME, "frame_paint", bottom=False)
    shapes += [
        pane(-0.95, 0.95, 0.0, 2.66, GLASS),
        slab(-0.035, 0.035, 0.0, 2.2, -0.06, "frame_paint", back=PANE),
        slab(-0.95, 0.95, 2.2, 2.26, -0.06, "frame_paint", back=PANE),
        slab(-0.95, 0.95, 0.0, 0.12, -0.05, "frame_paint", back=PANE),
        slab(-1.35, 1.35, 2.78, 2.92, -1.25, "frame_paint"),
        slab(0.10, 0.13, 0.9, 1.5, -0.11, "metal_grey", back=-0.06),
        slab(-0.13, -0.10, 0.9, 1.5, -0.11, "metal_grey", back=-0.06),
        slab(-1.05, 1.05, -0.35, 0.02, -0.5, "step_stone"),
    ]
    return shapes


def door_house() -> Shapes:
    """Front door of a house, on a step."""
    shapes = surround(1.16, 2.2, 0.09, -0.06, "frame_paint", bottom=False)
    shapes += _plain_leaf(-0.49, 0.49, 0.05, 2.11, 2)
    shapes += [
        pane(-0.22, 0.22, 1.35, 1.85, GLASS, y=-0.052),
        slab(-0.8, 0.8, -0.35, 0.05, -0.9, "step_stone"),
    ]
    return shapes


def door_service() -> Shapes:
    """Plain steel door of a yard or a shed."""
    return [
        *surround(1.06, 2.12, 0.07, -0.05, "frame_paint", bottom=False),
        slab(-0.46, 0.46, 0.0, 2.05, -0.03, "door_paint"),
        slab(0.32, 0.40, 1.0, 1.06, -0.08, "metal_grey", back=-0.03),
    ]


def door_garage() -> Shapes:
    """Sectional garage door."""
    shapes = surround(2.6, 2.25, 0.08, -0.06, "frame_paint", bottom=False)
    for row in range(5):
        z = 0.435 * row
        shapes.append(slab(-1.22, 1.22, z + 0.012, z + 0.425, -0.035, "door_paint"))
    shapes.append(pane(-1.22, 1.22, 0.0, 2.17, "metal_dark", y=-0.012))
    return shapes


def door_roller() -> Shapes:
    """Roller gate of a hall, with guards."""
    shapes = surround(4.0, 4.2, 0.14, -0.10, "metal_grey", bottom=False)
    for row in range(11):
        z = 0.37 * row
        shapes.append(slab(-1.86, 1.86, z + 0.02, z + 0.36, -0.045, "door_paint"))
    shapes.append(pane(-1.86, 1.86, 0.0, 4.06, "metal_dark", y=-0.015))
    shapes.append(slab(-2.1, 2.1, 4.2, 4.6, -0.40, "metal_grey"))
    return shapes


def door_portal() -> Shapes:
    """Arched portal of a church."""
    return [
        prism(arch(1.8, 3.45), -0.28, 0.0, "door_paint"),
        slab(-0.02, 0.02, 0.0, 3.4, -0.30, "metal_dark", back=-0.28),
        slab(-1.5, 1.5, -0.35, 0.06, -0.8, "step_stone"),
    ]


def lining(x0: float, x1: float, z0: float, z1: float, material: str = "frame_paint") -> Shapes:
    """Make the moulded frame that a door hangs in, with its rebate."""
    return [portal(x0, x1, z0, z1, soft(_LINING, 0.006, 3), material)]


def leaf(x0: float, x1: float, z0: float, z1: float, rows: int, *, columns: int = 1,
         y: float = LEAF, hung: float = -1.0, glazed: int = 0) -> Shapes:  # fmt: skip
    """Make a framed leaf with raised panels and its hinges; the upper `glazed` rows are panes."""
    shapes: Shapes = [bevelled((x0, y, z0), (x1, y + 0.045, z1), "door_paint")]
    stile, rail = 0.11, 0.10
    wide = (x1 - x0 - stile * (columns + 1)) / columns
    foot = z0 + 0.18
    tall = (z1 - rail - foot - rail * (rows - 1)) / rows
    for row in range(rows):
        low = foot + row * (tall + rail)
        for column in range(columns):
            a = x0 + stile + column * (wide + stile)
            if row >= rows - glazed:
                line = [(0.0, y), (0.0, y - 0.012), (0.012, y - 0.016), (0.026, y - 0.006),
                        (0.03, y - 0.001)]  # fmt: skip
                shapes.append(frame(a, a + wide, low, low + tall, soft(line, 0.003, 3),
                                    "door_paint"))  # fmt: skip
                inside = rectangle(a + 0.028, a + wide - 0.028, low + 0.028, low + tall - 0.028)
                shapes.append(plate(inside, y - 0.002, GLASS))
            else:
                shapes += raised_panel(a, a + wide, low, low + tall, y, "door_paint")
    edge = x0 if hung < 0 else x1
    for share in (0.1, 0.5, 0.9):
        shapes += hinge(edge, z0 + share * (z1 - z0), y - 0.004)
    kick = [(0.0, y), (0.0, y - 0.003), (0.003, y - 0.004), (0.01, y - 0.004)]
    shapes.append(frame(x0 + 0.03, x1 - 0.03, z0 + 0.02, z0 + 0.15, kick, "metal_grey"))
    shapes.append(plate(rectangle(x0 + 0.04, x1 - 0.04, z0 + 0.03, z0 + 0.14), y - 0.004,
                         "metal_grey"))  # fmt: skip
    return shapes


def letter_box(x: float, z: float, y: float) -> Shapes:
    """Make a letter plate with its flap."""
    line = soft([(0.0, y), (0.0, y - 0.006), (0.006, y - 0.010), (0.018, y - 0.008)], 0.002, 3)
    flap = [(y - 0.011, -0.018), (y - 0.006, -0.018), (y - 0.006, 0.018), (y - 0.013, 0.014)]
    return [
        frame(x - 0.13, x + 0.13, z - 0.038, z + 0.038, line, "metal_grey"),
        ledge(np.array(flap) + np.array([0.0, z]), x - 0.112, x + 0.112, "metal_grey"),
        tube([[x - 0.11, y - 0.009, z + 0.02], [x + 0.11, y - 0.009, z + 0.02]], 0.004,
             "metal_grey", sides=8),
    ]  # fmt: skip


def knocker(x: float, z: float, y: float) -> Shapes:
    """Make a ring knocker on a boss."""
    angle = np.linspace(0.15, 2 * np.pi - 0.15, 22) + np.pi / 2
    ring = np.column_stack(
        [x + 0.045 * np.cos(angle), np.full(22, y - 0.022), z - 0.045 + 0.045 * np.sin(angle)]
    )
    return [knob(x, z, y, 0.026), tube(ring, 0.008, "metal_grey", sides=10),
            knob(x, z - 0.092, y, 0.012)]  # fmt: skip


def bell(x: float, z: float, y: float, rows: int) -> Shapes:
    """Make a plate of door bells with a speaker."""
    shapes: Shapes = [bevelled((x - 0.06, y - 0.014, z), (x + 0.06, y, z + 0.06 + 0.032 * rows),
                               "metal_grey", bevel=0.004)]  # fmt: skip
    for row in range(rows):
        low = z + 0.03 + 0.032 * row
        shapes.append(bevelled((x - 0.05, y - 0.016, low), (x + 0.012, y - 0.013, low + 0.022),
                               "sign", bevel=0.001))  # fmt: skip
        shapes.append(tube([[x + 0.034, y - 0.012, low + 0.011], [x + 0.034, y - 0.019,
            low + 0.011]],
                           0.009, "metal_dark", sides=12))  # fmt: skip
    return shapes


def steps(half: float, top: float, reach: float, material: str) -> Shapes:
    """Make a block of one or two steps with rounded nosings."""
    shapes: Shapes = []
    for number, (out, z) in enumerate(((reach, top), (reach + 0.28, top - 0.17))):
        wide = half + 0.14 * number
        line = soft([(0.02, z - 0.6), (0.02, z), (-out, z), (-out, z - 0.035), (-out + 0.025,
            z - 0.04),
                     (-out + 0.025, z - 0.6)], 0.018, 4)  # fmt: skip
        shapes.append(ledge(line, -wide, wide, material))
    return shapes[:1] if reach > 0.4 else shapes


def _transom(x0: float, x1: float, z0: float, z1: float, bars: int, material: str) -> Shapes:
    """Make a glazed light over a door, with bars that rise from the middle."""
    y = LEAF - 0.01
    line = soft([(0.0, y + 0.03), (0.0, y), (0.03, y), (0.04, y + 0.010), (0.045, y + 0.016)],
                0.004, 3)  # fmt: skip
    shapes: Shapes = [
        plate(rectangle(x0, x1, z0, z1), BACKING, GLASS),
        plate(rectangle(x0 + 0.03, x1 - 0.03, z0 + 0.03, z1 - 0.03), y + 0.018, PANE_MATERIAL),
        frame(x0, x1, z0, z1, line, material),
    ]
    middle, low = (x0 + x1) / 2, z0 + 0.04
    for angle in np.linspace(0.0, np.pi, bars + 2)[1:-1]:
        way = np.array([np.cos(angle), np.sin(angle)])
        reach = min((z1 - 0.04 - low) / max(way[1], 1e-6), (x1 - 0.04 - middle) / abs(way[0] + 1e-9)
                    if abs(way[0]) > 1e-6 else np.inf)  # fmt: skip
        end = np.array([middle, low]) + way * reach
        shapes.append(bar((middle, low), (end[0], end[1]), 0.010, y + 0.006, material))
    arc = np.linspace(0.0, np.pi, 17)
    radius = 0.32 * (z1 - z0)
    hub = np.column_stack([middle + radius * np.cos(arc), np.full(17, y + 0.008),
                           low + radius * np.sin(arc)])  # fmt: skip
    shapes.append(tube(hub, 0.010, material, sides=8))
    return shapes


def _head(x0: float, x1: float, z: float, material: str) -> Shapes:
    """Make the moulded rail between door and transom."""
    line = soft([(0.13, -0.045), (LEAF - 0.02, -0.045), (LEAF - 0.032, -0.03), (LEAF - 0.03, 0.0),
                 (LEAF - 0.045, 0.012), (LEAF - 0.045, 0.03), (0.13, 0.03)][::-1], 0.006,
                     3)  # fmt: skip
    return [ledge(np.asarray(line) + np.array([0.0, z]), x0, x1, material)]


def fine_door_panel() -> Shapes:
    """Panelled door with a fanlight in a moulded frame, on its step."""
    shapes = lining(-0.60, 0.60, 0.05, 2.75)
    shapes += leaf(-0.52, 0.52, 0.05, 2.08, 3, columns=2)
    shapes += _head(-0.52, 0.52, 2.13, "frame_paint")
    shapes += _transom(-0.52, 0.52, 2.16, 2.67, 5, "frame_paint")
    shapes += [knob(0.40, 1.05, LEAF, 0.032)]
    shapes += (
        letter_box(0.0, 0.97, LEAF)
        + knocker(0.0, 1.52, LEAF)
        + steps(0.72, 0.05, 0.34, "step_stone")
    )
    return shapes


def fine_door_double() -> Shapes:
    """Tall double door of a tenement with a glazed transom."""
    shapes = lining(-0.84, 0.84, 0.04, 2.94)
    shapes += leaf(-0.76, -0.012, 0.04, 2.28, 3, glazed=1)
    shapes += leaf(0.012, 0.76, 0.04, 2.28, 3, hung=1.0, glazed=1)
    shapes += [bar((0.0, 0.06), (0.0, 2.27), 0.03, LEAF - 0.022, "door_paint", depth=0.03)]
    shapes += _head(-0.76, 0.76, 2.33, "door_paint")
    shapes += _transom(-0.76, 0.76, 2.36, 2.86, 7, "door_paint")
    for side in (-1.0, 1.0):
        for z in (1.72, 1.98):
            shapes.append(scroll(side * 0.385, z, LEAF - 0.014, 0.10, side, radius=0.007))
    shapes += [*lever(0.07, 1.08, LEAF, 1.0), knob(-0.07, 1.08, LEAF, 0.034)]
    shapes += letter_box(-0.39, 0.98, LEAF) + steps(0.95, 0.04, 0.28, "step_stone")
    return shapes


def fine_door_glass() -> Shapes:
    """Glazed entrance of metal sections under a canopy, with pull handles and bells."""
    section = soft([(0.0, 0.135), (0.0, 0.03), (0.055, 0.03), (0.062, 0.036), (0.062, 0.06),
                    (0.07, 0.062), (0.07, 0.135)], 0.003, 3)  # fmt: skip
    shapes: Shapes = [
        plate(rectangle(-0.95, 0.95, 0.0, 2.66), BACKING, GLASS),
        portal(-1.0, 1.0, 0.0, 2.7, section, "frame_paint"),
    ]
    sash = soft([(0.0, 0.10), (0.0, 0.045), (0.06, 0.045), (0.068, 0.052), (0.07, 0.072)],
                0.003, 3)  # fmt: skip
    for x0, x1 in ((-0.93, -0.004), (0.004, 0.93)):
        shapes.append(frame(x0, x1, 0.012, 2.2, sash, "frame_paint"))
        shapes.append(plate(rectangle(x0 + 0.06, x1 - 0.06, 0.07, 2.14), 0.066, PANE_MATERIAL))
        kick = bevelled((x0 + 0.06, 0.05, 0.07), (x1 - 0.06, 0.07, 0.22), "metal_grey")
        shapes.append(kick)
        shapes.append(frame(x0, x1, 2.22, 2.63, sash, "frame_paint"))
        shapes.append(plate(rectangle(x0 + 0.06, x1 - 0.06, 2.28, 2.57), 0.066, PANE_MATERIAL))
        x = -0.10 if x1 < 0.5 else 0.10
        grip = [[x, 0.045, 0.78], [x, -0.015, 0.78], [x, -0.02, 0.82], [x, -0.02, 1.58],
                [x, -0.015, 1.62], [x, 0.045, 1.62]]  # fmt: skip
        shapes.append(tube(grip, 0.014, "metal_grey", sides=14))
        for z in (0.25, 1.1, 1.95):
            shapes += hinge(x0 if x1 < 0.5 else x1, z, 0.04)
        for mark in (0.95, 1.45):
            for k in range(6):
                a = x0 + 0.12 + 0.125 * k
                shapes.append(plate(rectangle(a, a + 0.05, mark, mark + 0.05), 0.064, "sign"))
    edge = soft([(0.0, 0.0), (0.0, 0.12), (-1.2, 0.14), (-1.25, 0.12), (-1.25, 0.02), (-1.22,
        0.0)][::-1],
                0.012, 3)  # fmt: skip
    shapes.append(
        ledge(np.asarray(edge)[::-1] * [1, 1] + np.array([0.0, 2.78]), -1.35, 1.35, "frame_paint")
    )
    for x in (-1.1, 1.1):
        shapes.append(tube([[x, -1.1, 2.9], [x, 0.0, 3.55]], 0.010, "metal_grey", sides=10))
        shapes.append(knob(x, 3.55, 0.0, 0.035))
    for x in (-0.6, 0.0, 0.6):
        shapes.append(tube([[x, -0.6, 2.772], [x, -0.6, 2.79]], 0.06, "lamp_glow", sides=18))
    shapes += bell(1.15, 1.25, 0.0, 6)
    mat = bevelled((-0.9, -0.6, 0.02), (0.9, 0.02, 0.028), "rubber", bevel=0.002)
    return [*shapes, mat, *steps(1.05, 0.02, 0.5, "step_stone")]


def fine_door_house() -> Shapes:
    """Front door of a house: boarded leaf with lights, letter box, lantern and step."""
    shapes = lining(-0.58, 0.58, 0.05, 2.2)
    shapes += leaf(-0.50, 0.50, 0.05, 2.11, 3, columns=2, glazed=1)
    shapes += lever(0.42, 1.03, LEAF, -1.0) + letter_box(0.0, 0.86, LEAF)
    shapes += bell(0.72, 1.2, 0.0, 1)
    lamp = [[0.0, 0.0, 0.0], [0.0, -0.05, 0.0], [0.0, -0.10, 0.02], [0.0, -0.12, 0.0]]
    shapes.append(tube(np.array(lamp) + np.array([0.78, 0.0, 1.98]), 0.010, "metal_dark", sides=10))
    shapes.append(tube([[0.78, -0.12, 1.78], [0.78, -0.12, 1.80], [0.78, -0.12, 1.92]],
                       [0.035, 0.045, 0.06], "lamp_glow", sides=16))  # fmt: skip
    shapes.append(tube([[0.78, -0.12, 1.92], [0.78, -0.12, 1.93], [0.78, -0.12, 1.99]],
                       [0.085, 0.08, 0.01], "metal_dark", sides=16))  # fmt: skip
    shapes.append(bevelled((-0.42, -0.52, 0.05), (0.42, -0.06, 0.062), "rubber", bevel=0.004))
    return shapes + steps(0.8, 0.05, 0.9, "step_stone")


def fine_door_service() -> Shapes:
    """Steel door with a louvre, a kick plate, hinges and a lever."""
    section = soft(
        [(0.0, 0.0), (0.0, -0.008), (0.055, -0.008), (0.06, 0.0), (0.06, 0.07)], 0.004, 3
    )
    shapes: Shapes = [portal(-0.53, 0.53, 0.0, 2.12, section, "frame_paint")]
    shapes.append(bevelled((-0.47, 0.06, 0.0), (0.47, 0.11, 2.06), "door_paint"))
    rim = soft([(0.0, 0.06), (0.0, 0.052), (0.02, 0.052), (0.025, 0.058)], 0.003, 3)
    shapes.append(frame(-0.25, 0.25, 0.28, 0.72, rim, "door_paint"))
    for z in np.arange(0.32, 0.68, 0.035):
        blade = np.array([(0.040, -0.012), (0.044, -0.014), (0.062, 0.012), (0.058, 0.014)])
        shapes.append(ledge(blade + np.array([0.0, z]), -0.23, 0.23, "door_paint", (0.8, 0.8, 0.8)))
    for z in (0.22, 1.05, 1.88):
        shapes += hinge(-0.46, z, 0.056)
    shapes += lever(0.40, 1.05, 0.06, -1.0)
    shapes.append(bevelled((-0.44, 0.056, 0.03), (0.44, 0.06, 0.20), "metal_grey", bevel=0.001))
    return shapes


def fine_door_garage() -> Shapes:
    """Sectional garage door with pressed ribs, a handle and seals."""
    section = soft([(0.0, 0.0), (0.0, -0.01), (0.06, -0.01), (0.07, 0.0), (0.08, 0.05), (0.08,
        0.13)],
                   0.005, 3)  # fmt: skip
    shapes: Shapes = [portal(-1.3, 1.3, 0.0, 2.25, section, "frame_paint")]
    y = 0.08
    for row in range(5):
        z = 0.435 * row
        for x0, x1 in ((-1.22, -0.62), (-0.61, -0.005), (0.005, 0.61), (0.62, 1.22)):
            shapes += raised_panel(x0 + 0.02, x1 - 0.02, z + 0.04, z + 0.40, y, "door_paint")
        line = soft([(y + 0.03, 0.005), (y, 0.008), (y, 0.424), (y + 0.03, 0.432)][::-1], 0.004, 3)
        shapes.append(ledge(np.asarray(line) + np.array([0.0, z]), -1.22, 1.22, "door_paint"))
    shapes.append(plate(rectangle(-1.22, 1.22, 0.0, 2.17), y + 0.03, "metal_dark"))
    shapes += lever(0.0, 0.75, y - 0.012, 1.0)
    return shapes


def fine_door_roller() -> Shapes:
    """Roller gate of a hall: interlocked slats in channels, box, guards and a push button."""
    section = soft([(0.0, 0.0), (0.0, -0.10), (0.14, -0.10), (0.14, 0.02), (0.12, 0.02), (0.12,
        0.09)],
                   0.008, 3)  # fmt: skip
    shapes: Shapes = [portal(-2.0, 2.0, 0.0, 4.2, section, "metal_grey")]
    bow = np.array([(0.09, 0.0), (0.072, 0.004), (0.06, 0.024), (0.056, 0.05), (0.060, 0.076),
                    (0.072, 0.096), (0.09, 0.1)])[::-1]  # fmt: skip
    for row in range(41):
        shapes.append(ledge(bow + np.array([0.0, 0.1 * row]), -1.88, 1.88, "door_paint"))
    shapes.append(bevelled((-1.88, 0.04, 0.0), (1.88, 0.10, 0.06), "rubber"))
    shapes.append(bevelled((-2.1, -0.40, 4.2), (2.1, 0.0, 4.6), "metal_grey", bevel=0.02,
                           hidden=("+y",)))  # fmt: skip
    for x in (-2.25, 2.25):
        shapes.append(tube([[x, -0.35, -0.2], [x, -0.35, 1.05], [x, -0.35, 1.1]],
                           [0.085, 0.085, 0.04], "metal_dark", sides=16))  # fmt: skip
        shapes.append(tube([[x, -0.35, 0.75], [x, -0.35, 0.92]], 0.088, "marking_yellow", sides=16))
    shapes += bell(2.35, 1.1, 0.0, 2)
    return shapes


def fine_door_portal() -> Shapes:
    """Arched portal of a church: two boarded leaves with iron straps, ring and studs."""
    outline = arch(1.8, 3.45, 20)
    jamb = [(0.0, 0.0), (0.02, -0.01), (0.04, 0.0), (0.05, 0.02), (0.07, 0.03), (0.09, 0.03),
            (0.11, 0.06), (0.12, 0.09)]  # fmt: skip
    path = np.vstack([outline[1:], outline[:1]])
    shapes: Shapes = [ring_moulding(path, soft(jamb, 0.012, 3), "step_stone", closed=False)]
    shapes.append(plate(outline, 0.10, "door_paint"))
    radius, spring = 0.78, 3.45 - 0.9
    for x in np.arange(-0.72, 0.73, 0.12):
        top = spring + np.sqrt(max(radius**2 - x**2, 0.0))
        shapes.append(bevelled((x - 0.056, 0.075, 0.06), (x + 0.056, 0.10, top), "door_paint",
                               bevel=0.008, hidden=("+y",)))  # fmt: skip
    for side in (-1.0, 1.0):
        for z in (0.55, 1.45, 2.35):
            ends = sorted((side * 0.78, side * 0.12))
            shapes.append(bevelled((ends[0], 0.066, z - 0.028), (ends[1], 0.076, z + 0.028),
                                   "metal_dark"))  # fmt: skip
            for turn in (-1.0, 1.0):
                shapes.append(scroll(side * 0.30, z + turn * 0.10, 0.07, 0.075, side,
                                     start=turn * np.pi / 2))  # fmt: skip
            for x in np.arange(0.18, 0.76, 0.11):
                shapes.append(knob(side * x, z, 0.07, 0.013, "metal_dark"))
        shapes += knocker(side * 0.12, 1.2, 0.074)
    shapes += steps(1.3, 0.06, 0.45, "step_stone")
    return shapes


FINE_DOORS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__.removeprefix("fine_"): maker
        for maker in (
            fine_door_panel, fine_door_double, fine_door_glass, fine_door_house,
            fine_door_service, fine_door_garage, fine_door_roller, fine_door_portal,
        )
    }
)  # fmt: skip
DOORS: Mapping[str, tuple[Callable[[], Shapes], float, float]] = MappingProxyType(
    {
        "door_panel": (door_panel, 1.7, 3.0),
        "door_double": (door_double, 2.0, 3.1),
        "door_glass": (door_glass, 2.0, 2.7),
        "door_house": (door_house, 1.16, 2.2),
        "door_service": (door_service, 1.06, 2.12),
        "door_garage": (door_garage, 2.6, 2.25),
        "door_roller": (door_roller, 4.0, 4.2),
        "door_portal": (door_portal, 2.7, 4.0),
        "door_lobby": (towers.door_lobby, 5.2, 3.5),
        "door_parking": (towers.door_parking, 7.8, 3.05),
        "door_bronze": (towers.door_bronze, 8.3, 8.3),
        "door_deco": (towers.door_deco, 2.0, 2.85),
        "door_sidelight": (houses.door_sidelight, 1.66, 2.25),
        "door_boards": (houses.door_boards, 1.1, 2.1),
        "door_carriage": (houses.door_carriage, 2.55, 2.3),
        "door_barn": (houses.door_barn, 3.7, 3.3),
        "door_flat": (houses.door_flat, 1.9, 2.3),
        "door_greenhouse": (houses.door_greenhouse, 2.2, 2.3),
        "door_fanlight": (old_town.door_fanlight, 2.2, 2.95),
        "door_gateway": (old_town.door_gateway, 2.9, 3.7),
        "door_stoop": (old_town.door_stoop, 2.2, 4.1),
        "door_planks": (old_town.door_planks, 2.0, 2.9),
        "door_council": (old_town.door_council, 3.4, 4.4),
        "door_stairwell": (old_town.door_stairwell, 2.4, 2.6),
        **HALL_DOORS,
    }
)


@lru_cache(maxsize=32)
@kept("door", least=FINE)
def door(name: str, *, detail: int = 2) -> Prototype:
    """Make a door prototype; `name` is a key of `DOORS`, `detail` as of `window`."""
    if detail >= FINE:
        if name in FINE_DOORS:
            shapes = FINE_DOORS[name]()
        else:
            with fine_shapes():
                shapes = set_back(DOORS[name][0]())
        return prototype(f"{name}_fine", "door", shapes)
    return prototype(name, "door", DOORS[name][0]())
