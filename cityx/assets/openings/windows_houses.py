"""Windows and doors of houses, farms, temples and sheds.

They lie on the wall plane as those of `openings.frames`, which lists them: x along the wall,
-y outward, z up, bottom centre at the origin.
"""

from __future__ import annotations

import numpy as np

from cityx.assets.openings.frames import (
    GLASS,
    PALE,
    PANE,
    SASH,
    Shapes,
    glazing,
    pane,
    slab,
    surround,
)
from cityx.assets.shapes import Color, disc, loft
from cityx.city.mesh import MeshBatch

SHADE: Color = (0.74, 0.74, 0.74)
DEEP: Color = (0.5, 0.5, 0.5)
BRIGHT: Color = (2.4, 2.4, 2.4)  # of battens, whatever the colour of their boards


def strut(x0: float, z0: float, x1: float, z1: float, breadth: float, front: float, material: str,
          tint: Color = (1.0, 1.0, 1.0), *, back: float = 0.0) -> MeshBatch:  # fmt: skip
    """Make a flat member between two points of the wall."""
    line = np.array([x1 - x0, z1 - z0])
    side = 0.5 * breadth * np.array([-line[1], line[0]]) / max(float(np.hypot(*line)), 1e-9)
    corners = np.array([[x0, z0], [x0, z0], [x1, z1], [x1, z1]])
    corners = corners + side * np.array([[1.0], [-1.0], [-1.0], [1.0]])
    rings = [np.column_stack([corners[:, 0], np.full(4, y), corners[:, 1]]) for y in (back, front)]
    return loft(np.stack(rings), material, tint, caps=(False, True))


# --- windows --------------------------------------------------------------------------------------


def window_picture(glass: str, blind: float, curtain: float) -> Shapes:
    """Picture window: one wide pane between two narrow casements."""
    return glazing(2.7, 1.55, glass, columns=(0.24, 0.76), frame=0.07, bar=0.085,
                   blind=blind, curtain=curtain)  # fmt: skip


def window_grid(glass: str, blind: float, curtain: float) -> Shapes:
    """Sash of six panes over one, between boarded shutters."""
    shapes = glazing(0.95, 1.5, glass, columns=(), rows=(0.5,), frame=0.06, bar=0.06, blind=blind,
                     curtain=curtain)  # fmt: skip
    for x in (-0.14, 0.14):
        shapes.append(slab(x - 0.013, x + 0.013, 0.78, 1.44, SASH, "frame_paint", back=PANE))
    shapes.append(slab(-0.41, 0.41, 1.09, 1.115, SASH, "frame_paint", back=PANE))
    for side in (-1, 1):
        for k in range(3):
            x0 = side * (0.52 + 0.125 * k)
            x1 = side * (0.52 + 0.125 * k + 0.115)
            shapes.append(slab(min(x0, x1), max(x0, x1), -0.02, 1.52, -0.035, "door_paint"))
        for z in (0.25, 1.2):
            x0, x1 = sorted((side * 0.52, side * 0.885))
            shapes.append(slab(x0, x1, z, z + 0.11, -0.055, "door_paint", SHADE, back=-0.035))
    return shapes


def window_leaded(glass: str, blind: float, curtain: float) -> Shapes:
    """Small casement of three lights with leaded panes, under a timber lintel."""
    shapes = glazing(1.3, 1.0, glass, columns=(1 / 3, 2 / 3), frame=0.06, bar=0.06,
                     blind=blind, curtain=curtain)  # fmt: skip
    for light in range(3):
        middle = -0.65 + 1.3 * (light + 0.5) / 3
        shapes.append(slab(middle - 0.008, middle + 0.008, 0.06, 0.94, -0.032, "metal_dark",
                           back=PANE))  # fmt: skip
    for z in (0.28, 0.5, 0.72):
        shapes.append(slab(-0.59, 0.59, z - 0.008, z + 0.008, -0.032, "metal_dark", back=PANE))
    shapes.append(slab(-0.85, 0.85, 1.0, 1.2, -0.06, "bench_wood", DEEP))
    return shapes


def window_terrace(glass: str, blind: float, curtain: float) -> Shapes:
    """Sliding glass doors to a balcony, with the box of a rolling shutter above."""
    shapes = glazing(1.75, 1.95, glass, frame=0.045, bottom=True, blind=blind, curtain=curtain)
    shapes += [
        slab(-0.035, 0.035, 0.045, 1.905, SASH - 0.015, "frame_paint", back=PANE),
        slab(-0.83, 0.0, 0.045, 0.12, SASH - 0.01, "frame_paint", back=PANE),
        slab(0.0, 0.83, 0.045, 0.12, SASH, "frame_paint", back=PANE),
        slab(-0.95, 0.95, 1.95, 2.16, -0.17, "frame_paint", PALE),
        slab(-0.95, -0.875, 0.0, 1.95, -0.08, "frame_paint", PALE),
        slab(0.875, 0.95, 0.0, 1.95, -0.08, "frame_paint", PALE),
    ]
    return shapes


def window_prow(glass: str, blind: float, curtain: float) -> Shapes:
    """Bay window of a high block: a shallow glazed box on a ledge, with a hood above."""
    del blind
    shapes: Shapes = [
        slab(-0.98, 0.98, -0.16, 0.0, -0.5, "trim"),
        slab(-0.98, 0.98, 1.6, 1.74, -0.5, "trim"),
        pane(-0.9, 0.9, 0.0, 1.6, glass, y=-0.42),
    ]
    for side in (-1, 1):
        x0, x1 = sorted((side * 0.94, side * 0.89))
        shapes.append(slab(x0, x1, 0.0, 1.6, -0.44, "frame_paint"))
    for x in (-0.3, 0.3):
        shapes.append(slab(x - 0.03, x + 0.03, 0.0, 1.6, -0.45, "frame_paint", back=-0.42))
    shapes.append(slab(-0.9, 0.9, 0.42, 0.47, -0.45, "frame_paint", back=-0.42))
    if curtain:
        for x0, x1 in ((-0.88, -0.45), (0.45, 0.88)):
            shapes.append(pane(x0, x1, 0.0, 1.6, "curtain", PALE, y=-0.425))
    return shapes


def window_temple(glass: str, blind: float, curtain: float) -> Shapes:
    """Four latticed leaves of a temple front, paper behind fine squares over solid panels."""
    del glass, blind, curtain
    shapes: Shapes = [
        slab(-1.15, 1.15, 0.0, 0.14, -0.1, "frame_paint"),
        slab(-1.15, 1.15, 2.3, 2.5, -0.1, "frame_paint"),
        slab(-1.15, -1.04, 0.14, 2.3, -0.1, "frame_paint"),
        slab(1.04, 1.15, 0.14, 2.3, -0.1, "frame_paint"),
        pane(-1.04, 1.04, 0.8, 2.3, "curtain", (0.85, 0.78, 0.62)),
        slab(-1.04, 1.04, 0.14, 0.8, -0.03, "frame_paint", SHADE),
    ]
    for leaf in range(4):
        x0 = -1.04 + 0.52 * leaf
        for x in (x0, x0 + 0.46):
            shapes.append(slab(x, x + 0.06, 0.14, 2.3, -0.07, "frame_paint", back=PANE))
        for x in (x0 + 0.16, x0 + 0.26, x0 + 0.36):
            shapes.append(slab(x - 0.011, x + 0.011, 0.86, 2.24, -0.05, "frame_paint", back=PANE))
        for z in (0.14, 0.8, 2.22):
            shapes.append(slab(x0, x0 + 0.52, z, z + 0.07, -0.066, "frame_paint", back=PANE))
    for z in np.linspace(0.95, 2.15, 9):
        shapes.append(slab(-1.04, 1.04, z - 0.011, z + 0.011, -0.046, "frame_paint", back=PANE))
    return shapes


def window_barn(glass: str, blind: float, curtain: float) -> Shapes:
    """Small barn window of four panes in a broad white frame."""
    del blind, curtain
    return [
        *glazing(0.8, 0.8, glass, columns=(0.5,), rows=(0.5,), frame=0.05, bar=0.04),
        *surround(1.04, 0.92, 0.12, -0.05, "trim", bottom=False),
        slab(-0.58, 0.58, -0.12, 0.0, -0.09, "trim"),
    ]


# --- doors ----------------------------------------------------------------------------------------


def door_sidelight() -> Shapes:
    """Front door of a family house with a glazed side light, on a step."""
    shapes = surround(1.66, 2.25, 0.08, -0.06, "frame_paint", bottom=False)
    shapes += [
        slab(-0.75, 0.22, 0.04, 2.16, -0.035, "door_paint"),
        slab(-0.64, 0.11, 0.18, 0.62, -0.05, "door_paint", SHADE, back=-0.035),
        slab(-0.64, 0.11, 0.75, 1.2, -0.05, "door_paint", SHADE, back=-0.035),
        pane(-0.62, 0.09, 1.4, 2.0, GLASS, y=-0.04),
        slab(0.22, 0.30, 0.0, 2.17, -0.06, "frame_paint"),
        pane(0.30, 0.75, 0.04, 2.17, GLASS),
        slab(0.30, 0.75, 0.7, 0.75, -0.05, "frame_paint", back=PANE),
        slab(0.30, 0.75, 1.4, 1.45, -0.05, "frame_paint", back=PANE),
        slab(0.12, 0.17, 0.95, 1.25, -0.09, "metal_grey", back=-0.035),
        slab(-1.05, 1.05, -0.35, 0.04, -1.1, "step_stone"),
    ]
    return shapes


def door_boards() -> Shapes:
    """Ledged door of upright boards with iron straps."""
    shapes = surround(1.1, 2.1, 0.1, -0.06, "frame_paint", bottom=False)
    for k in range(6):
        x = -0.45 + 0.15 * k
        shapes.append(slab(x + 0.004, x + 0.146, 0.02, 2.0, -0.035, "door_paint"))
    shapes.append(pane(-0.45, 0.45, 0.0, 2.0, "metal_dark", y=-0.012))
    for z in (0.3, 1.6):
        shapes.append(slab(-0.45, 0.2, z, z + 0.05, -0.045, "metal_dark", back=-0.035))
    shapes += [
        slab(0.32, 0.36, 0.95, 1.08, -0.07, "metal_dark", back=-0.035),
        slab(-0.6, 0.6, -0.35, 0.02, -0.45, "step_stone"),
    ]
    return shapes


def door_carriage() -> Shapes:
    """Pair of boarded garage leaves with braces and small lights."""
    shapes = surround(2.55, 2.3, 0.1, -0.06, "frame_paint", bottom=False)
    shapes.append(pane(-1.2, 1.2, 0.0, 2.2, "metal_dark", y=-0.012))
    for side in (-1, 1):
        x0, x1 = sorted((side * 0.01, side * 1.16))
        shapes.append(slab(x0, x1, 0.03, 2.18, -0.03, "door_paint"))
        for z0, z1 in ((0.03, 0.2), (1.35, 1.48), (2.02, 2.18)):
            shapes.append(slab(x0, x1, z0, z1, -0.055, "door_paint", SHADE, back=-0.03))
        for x in (x0, x1 - 0.13):
            shapes.append(slab(x, x + 0.13, 0.03, 2.18, -0.055, "door_paint", SHADE, back=-0.03))
        shapes.append(strut(side * 0.1, 0.2, side * 1.05, 1.35, 0.11, -0.05, "door_paint", SHADE,
                            back=-0.03))  # fmt: skip
        for k in range(3):
            low = x0 + 0.17 + 0.28 * k
            shapes.append(pane(low, low + 0.23, 1.53, 1.97, GLASS, y=-0.035))
        shapes.append(slab(side * 0.09 - 0.02, side * 0.09 + 0.02, 1.0, 1.25, -0.09, "metal_dark",
                           back=-0.055))  # fmt: skip
    return shapes


def door_barn() -> Shapes:
    """Pair of sliding barn doors with crossed braces, hung from a rail."""
    shapes: Shapes = [pane(-1.8, 1.8, 0.0, 3.3, "metal_dark", y=-0.012)]
    for side in (-1, 1):
        for k in range(7):
            x0, x1 = sorted((side * (0.02 + 0.26 * k), side * (0.02 + 0.26 * k + 0.25)))
            shapes.append(slab(x0, x1, 0.06, 3.2, -0.06, "door_paint"))
        a, b = side * 0.1, side * 1.75
        for z in (0.16, 1.62, 3.1):
            x0, x1 = sorted((side * 0.02, side * 1.84))
            shapes.append(slab(x0, x1, z - 0.1, z + 0.1, -0.1, "trim", BRIGHT, back=-0.06))
        for x in (a, b):
            shapes.append(slab(x - 0.09, x + 0.09, 0.06, 3.2, -0.1, "trim", BRIGHT, back=-0.06))
        for z0, z1 in ((0.26, 1.52), (1.72, 3.0)):
            shapes.append(strut(a, z0, b, z1, 0.15, -0.092, "trim", BRIGHT, back=-0.06))
            shapes.append(strut(a, z1, b, z0, 0.15, -0.09, "trim", BRIGHT, back=-0.06))
        for x in (side * 0.45, side * 1.4):
            shapes.append(slab(x - 0.04, x + 0.04, 3.05, 3.38, -0.12, "metal_dark", back=-0.1))
    shapes += [
        slab(-2.3, 2.3, 3.3, 3.42, -0.14, "metal_dark"),
        slab(-2.4, 2.4, 3.42, 3.52, -0.26, "trim"),
    ]
    return shapes


def door_flat() -> Shapes:
    """Aluminium entrance of a small block of flats: door, letter boxes, bell panel, a lamp."""
    shapes = surround(1.9, 2.3, 0.06, -0.07, "frame_paint", bottom=False)
    shapes += [
        slab(-0.9, -0.02, 0.03, 2.24, -0.04, "door_paint"),
        pane(-0.3, -0.14, 0.3, 2.0, GLASS, y=-0.05),
        slab(-0.78, -0.72, 0.8, 1.5, -0.1, "metal_grey", back=-0.04),
        slab(-0.02, 0.05, 0.0, 2.24, -0.07, "frame_paint"),
        slab(0.05, 0.9, 0.0, 2.24, -0.03, "frame_paint", SHADE),
        slab(0.5, 0.75, 1.72, 1.92, -0.06, "metal_dark", back=-0.03),
        disc((0.62, -0.075, 2.08), 0.07, "plastic", sides=8, thickness=0.04),
        slab(-1.1, 1.1, -0.35, 0.03, -0.6, "step_stone"),
        slab(-1.15, 1.15, 2.38, 2.5, -0.9, "frame_paint"),
    ]
    for row in range(3):
        for column in range(2):
            x, z = 0.14 + 0.36 * column, 0.75 + 0.27 * row
            shapes.append(slab(x, x + 0.34, z, z + 0.25, -0.12, "metal_grey", back=-0.03))
            shapes.append(slab(x + 0.05, x + 0.29, z + 0.15, z + 0.18, -0.125, "metal_dark",
                               back=-0.12))  # fmt: skip
    return shapes


def door_greenhouse() -> Shapes:
    """Sliding glazed door of a greenhouse."""
    shapes = surround(2.2, 2.3, 0.07, -0.08, "frame_paint", bottom=False)
    shapes.append(pane(-1.05, 1.05, 0.0, 2.24, GLASS, y=-0.03))
    for x in (-1.05, -0.03, 0.97):
        shapes.append(slab(x, x + 0.07, 0.0, 2.24, -0.07, "frame_paint", back=-0.03))
    for z in (0.0, 0.75, 2.17):
        shapes.append(slab(-1.05, 1.05, z, z + 0.08, -0.065, "frame_paint", back=-0.03))
    shapes.append(slab(-1.3, 2.3, 2.3, 2.4, -0.1, "metal_grey"))
    return shapes
