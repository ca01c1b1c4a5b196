"""Windows and doors of old towns, of tenements and of slabs of panels.

They lie on the wall plane as those of `cityx.assets.openings.frames`, which lists them.
"""

from __future__ import annotations

import numpy as np

from cityx.assets.openings.frames import (
    GLASS,
    PALE,
    PANE,
    SASH,
    Shapes,
    arch,
    glazing,
    pane,
    slab,
    surround,
)
from cityx.assets.shapes import Color, box, disc, prism
from cityx.city.mesh import MeshBatch

SHADE: Color = (0.78, 0.78, 0.78)
DEEP: Color = (0.55, 0.55, 0.55)
IRON = "metal_dark"


def _lines(xs: list[float], x0: float, x1: float, zs: list[float], z0: float, z1: float,
           bar: float = 0.022) -> Shapes:  # fmt: skip
    """Make glazing bars: upright ones at `xs` from z0 to z1, level ones at `zs` from x0 to x1."""
    upright: Shapes = [
        slab(x - bar / 2, x + bar / 2, z0, z1, SASH + 0.012, "frame_paint", back=PANE) for x in xs
    ]
    level = [
        slab(x0, x1, z - bar / 2, z + bar / 2, SASH + 0.014, "frame_paint", back=PANE) for z in zs
    ]
    return upright + level


def _shutter(x0: float, x1: float, z0: float, z1: float, front: float) -> Shapes:
    """Make one leaf of a louvred shutter."""
    shapes = [slab(x0, x1, z0, z1, front, "door_paint")]
    for z in np.linspace(z0 + 0.1, z1 - 0.1, 9)[:-1]:
        shapes.append(slab(x0 + 0.05, x1 - 0.05, z, z + (z1 - z0 - 0.2) / 8 - 0.05, front - 0.012,
                           "door_paint", SHADE, back=front))  # fmt: skip
    return shapes


# --- windows --------------------------------------------------------------------------------------


def window_parisian(glass: str, blind: float, curtain: float) -> Shapes:
    """French window that opens inwards, behind an iron guard at its foot."""
    shapes = glazing(1.15, 2.3, glass, columns=(0.5,), rows=(0.34, 0.67), frame=0.06, bar=0.06,
                     blind=blind, curtain=curtain)  # fmt: skip
    shapes += [
        slab(-0.56, 0.56, 0.84, 0.88, -0.14, IRON, back=-0.10),
        slab(-0.56, 0.56, 0.06, 0.085, -0.135, IRON, back=-0.105),
    ]
    for x in np.linspace(-0.54, 0.52, 9):
        shapes.append(slab(x, x + 0.016, 0.085, 0.84, -0.128, IRON, back=-0.112))
    return shapes


def window_persiana(glass: str, blind: float, curtain: float) -> Shapes:
    """Tall casement with louvred shutters: open, one closed, or both, as they happen to be."""
    shapes = glazing(1.0, 1.7, glass, columns=(0.5,), rows=(0.62,), bar=0.05, curtain=curtain)
    for side in (-1, 1):
        closed = blind > 0.5 or (blind > 0.0 and side < 0)
        near, far = (0.0, 0.5) if closed else (0.53, 1.03)
        x0, x1 = sorted((side * near, side * far))
        shapes += _shutter(x0, x1, -0.02, 1.72, -0.09 if closed else -0.045)
    return shapes


def window_georgian(glass: str, blind: float, curtain: float) -> Shapes:
    """Sash window of six panes over six."""
    shapes = glazing(1.05, 1.95, glass, frame=0.05, blind=blind, curtain=curtain)
    shapes += _lines([-0.165, 0.165], -0.475, 0.475, [0.5, 1.46], 0.05, 1.9)
    shapes.append(slab(-0.475, 0.475, 0.955, 1.005, SASH - 0.012, "frame_paint", back=PANE))
    return shapes


def window_tenement(glass: str, blind: float, curtain: float) -> Shapes:
    """Sash of one pane over one; now and then with a cooling unit in its lower half."""
    shapes = glazing(1.0, 1.75, glass, frame=0.06, blind=min(blind, 0.45), curtain=curtain)
    shapes.append(slab(-0.44, 0.44, 0.86, 0.93, SASH - 0.012, "frame_paint", back=PANE))
    if blind > 0.5:
        shapes += [
            box((-0.32, -0.42, 0.06), (0.32, 0.0, 0.46), "plastic", PALE),
            slab(-0.28, 0.28, 0.1, 0.42, -0.43, "metal_dark", back=-0.42),
            slab(-0.44, 0.44, 0.46, 0.52, -0.06, "frame_paint", back=PANE),
        ]
    return shapes


def window_block(glass: str, blind: float, curtain: float) -> Shapes:
    """Window of three casements under small-paned top lights, of about 1910."""
    shapes = glazing(1.7, 1.75, glass, columns=(1 / 3, 2 / 3), rows=(0.68,), frame=0.06, bar=0.06,
                     blind=blind, curtain=curtain)  # fmt: skip
    xs = [-0.57, 0.0, 0.57]
    shapes += _lines(xs, -0.79, 0.79, [1.44], 1.22, 1.69)
    return shapes


def window_cross(glass: str, blind: float, curtain: float) -> Shapes:
    """Cross window of a shop house: small panes above, a shutter beside the lower lights."""
    shapes = glazing(1.1, 1.9, glass, columns=(0.5,), rows=(0.56,), frame=0.08, bar=0.1,
                     blind=blind, curtain=curtain)  # fmt: skip
    shapes += _lines([-0.27, 0.27], -0.47, 0.47, [1.33, 1.58], 1.12, 1.82)
    shapes += _lines([-0.27, 0.27], -0.47, 0.47, [0.4, 0.7], 0.08, 1.01)
    return shapes


def window_mullioned(glass: str, blind: float, curtain: float) -> Shapes:
    """Tall window of a public hall with a cross of stone and a label mould."""
    shapes = glazing(1.5, 2.6, glass, frame=0.05, blind=blind, curtain=curtain)
    shapes += [
        slab(-0.07, 0.07, 0.0, 2.6, -0.12, "trim"),
        slab(-0.75, 0.75, 1.68, 1.82, -0.115, "trim"),
        slab(-1.0, 1.0, 2.68, 2.82, -0.16, "trim"),
        slab(-1.0, -0.9, 2.3, 2.68, -0.14, "trim"),
        slab(0.9, 1.0, 2.3, 2.68, -0.14, "trim"),
        slab(-0.95, 0.95, -0.16, 0.0, -0.16, "trim"),
    ]
    for side in (-1, 1):
        x0, x1 = sorted((side * 0.75, side * 0.9))
        shapes.append(slab(x0, x1, 0.0, 2.68, -0.09, "trim"))
    shapes += _lines([-0.4, 0.4], -0.68, 0.68, [0.56, 1.12], 0.05, 2.55, 0.016)
    return shapes


def window_panel(glass: str, blind: float, curtain: float) -> Shapes:
    """Window of a large panel: a wide light, a narrow one, and a flap in the concrete's rebate."""
    shapes = glazing(1.8, 1.4, glass, columns=(0.62,), frame=0.055, bar=0.07, blind=blind,
                     curtain=curtain)  # fmt: skip
    shapes.append(slab(0.24, 0.83, 1.0, 1.05, SASH, "frame_paint", back=PANE))
    shapes += surround(1.98, 1.52, 0.09, -0.03, "concrete", bottom=False)
    return shapes


# --- doors ----------------------------------------------------------------------------------------


def _panels(x0: float, x1: float, z0: float, z1: float, rows: int, columns: int = 2,
            front: float = -0.035) -> Shapes:  # fmt: skip
    """Make a panelled leaf."""
    shapes: list[MeshBatch] = [slab(x0, x1, z0, z1, front, "door_paint")]
    wide, tall = (x1 - x0 - 0.1) / columns, (z1 - z0 - 0.12) / rows
    for i in range(columns):
        for j in range(rows):
            a, b = x0 + 0.1 + i * wide, z0 + 0.12 + j * tall
            shapes.append(slab(a, a + wide - 0.1, b, b + tall - 0.12, front - 0.014, "door_paint",
                               SHADE, back=front))  # fmt: skip
    return shapes


def door_fanlight() -> Shapes:
    """Six-panelled door under a fanlight with spokes; `fanlight_frame` stands about it."""
    shapes: Shapes = [
        prism(arch(1.12, 2.73, 12), -0.02, 0.0, GLASS),
        *_panels(-0.52, 0.52, 0.05, 2.15, 3, front=-0.05),
        slab(-0.56, 0.56, 2.12, 2.2, -0.08, "frame_paint"),
        disc((0.0, -0.1, 1.25), 0.045, "metal_grey", sides=8, thickness=0.04),
        disc((0.0, -0.09, 1.62), 0.06, IRON, sides=8, thickness=0.03),
    ]
    for angle in np.linspace(0.0, np.pi, 7)[1:-1]:
        c, s = 0.5 * np.cos(angle), 0.5 * np.sin(angle)
        points = [(-0.012, 2.18), (0.012, 2.18), (c + 0.012, 2.18 + s), (c - 0.012, 2.18 + s)]
        shapes.append(prism(points, -0.045, -0.02, "frame_paint", PALE))
    return shapes


def door_gateway() -> Shapes:
    """Two tall leaves of a carriage gate under a grille; `gateway_frame` is the arch about it."""
    shapes: Shapes = [
        prism(arch(2.4, 3.42, 14), -0.02, 0.0, "metal_dark"),
        *_panels(-1.2, -0.015, 0.05, 2.3, 3, front=-0.05),
        *_panels(0.015, 1.2, 0.05, 2.3, 3, front=-0.05),
        slab(-1.2, 1.2, 2.3, 2.44, -0.08, "door_paint"),
    ]
    for x in np.linspace(-1.0, 1.0, 9):
        top = 2.22 + float(np.sqrt(1.2**2 - x**2)) * 0.98
        shapes.append(slab(x - 0.015, x + 0.015, 2.44, top, -0.05, "door_paint", back=-0.02))
    for side in (-1, 1):
        shapes.append(disc((side * 0.16, -0.12, 1.2), 0.07, "metal_grey", sides=8, thickness=0.06))
    return shapes


def door_stoop() -> Shapes:
    """Door of a raised ground floor; `stoop_steps` lead up to it, `stoop_frame` stands about it."""
    floor = 1.2
    return [
        slab(-0.6, 0.6, 0.0, floor, -0.02, "door_paint", DEEP),
        *_panels(-0.5, 0.5, floor, floor + 2.1, 3),
        slab(-0.56, 0.56, floor + 2.1, floor + 2.2, -0.07, "door_paint"),
        pane(-0.5, 0.5, floor + 2.2, floor + 2.55, GLASS),
        pane(-0.34, 0.34, floor + 1.25, floor + 1.9, GLASS, y=-0.052),
    ]


def door_planks() -> Shapes:
    """Arched double door of planks with iron studs; `planks_frame` is the stone about it."""
    shapes: Shapes = [
        prism(arch(1.52, 2.63, 12), -0.03, 0.0, "door_paint"),
        slab(-0.012, 0.012, 0.05, 2.6, -0.05, IRON, back=-0.03),
    ]
    for x in (-0.56, -0.38, -0.2, 0.2, 0.38, 0.56):
        shapes.append(slab(x - 0.006, x + 0.006, 0.05, 1.95, -0.038, "door_paint", DEEP,
                           back=-0.03))  # fmt: skip
    for z in (0.35, 1.05, 1.75):
        shapes.append(slab(-0.72, 0.72, z, z + 0.07, -0.05, "door_paint", SHADE, back=-0.03))
    for x in (-0.1, 0.1):
        shapes.append(disc((x, -0.09, 1.15), 0.06, IRON, sides=8, thickness=0.05))
    return shapes


def door_council() -> Shapes:
    """Leaves of a town hall's great door under glass; frame and steps are fixtures."""
    shapes: Shapes = [
        prism(arch(2.52, 4.06, 16), -0.02, 0.0, GLASS),
        *_panels(-1.25, -0.02, 0.5, 2.75, 4, front=-0.06),
        *_panels(0.02, 1.25, 0.5, 2.75, 4, front=-0.06),
        slab(-1.25, 1.25, 2.75, 2.92, -0.1, "door_paint"),
    ]
    for x in (-0.62, 0.0, 0.62):
        shapes.append(slab(x - 0.025, x + 0.025, 2.92, 3.6 if x else 4.0, -0.05, "frame_paint",
                           back=-0.02))  # fmt: skip
    return shapes


def door_stairwell() -> Shapes:
    """Entrance of a slab of flats: a steel door beside glass blocks; its roof is a fixture."""
    shapes: Shapes = [
        slab(-1.1, -0.1, 0.03, 2.1, -0.045, "door_paint"),
        pane(-0.9, -0.3, 1.05, 1.9, GLASS, y=-0.05),
        slab(-1.1, 1.1, 2.1, 2.2, -0.06, "frame_paint"),
        pane(-1.1, 1.1, 2.2, 2.5, GLASS),
        slab(-0.1, 0.0, 0.0, 2.1, -0.06, "frame_paint"),
        pane(0.0, 1.1, 0.0, 2.1, GLASS),
        slab(0.25, 0.62, 1.2, 1.7, -0.08, "metal_grey", back=-0.02),
    ]
    shapes += _lines([0.22, 0.44, 0.66, 0.88], 0.0, 1.1, [0.35, 0.7, 1.05, 1.4, 1.75], 0.0, 2.1)
    return shapes
