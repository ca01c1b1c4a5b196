"""Windows and doors of towers, slabs and decks; see `openings.frames` for their frame.

At the finest level of detail they are moved back into the niche as they are.
"""

from __future__ import annotations

import numpy as np

from cityx.assets.openings.frames import PANE, Shapes, glazing, pane, slab, surround
from cityx.assets.shapes import box, cylinder, disc, loft, moved
from cityx.city.mesh import MeshBatch

DIM = (0.35, 0.34, 0.33)
YELLOW = (0.85, 0.60, 0.05)
BULGE = 0.3  # metres before the wall; a house has no more of the pavement


def window_pair(glass: str, blind: float, curtain: float) -> Shapes:
    """Two upright lights with a pier of stone between them and a transom in each."""
    shapes: Shapes = []
    for x in (-0.55, 0.55):
        light = glazing(0.86, 1.8, glass, rows=(0.72,), frame=0.05, bar=0.05, blind=blind,
                        curtain=curtain)  # fmt: skip
        shapes += [moved(each, (x, 0.0, 0.0)) for each in light]
    shapes.append(slab(-0.11, 0.11, -0.05, 1.85, -0.10, "trim"))
    shapes.append(slab(-1.06, 1.06, -0.12, 0.0, -0.12, "trim"))
    return shapes


def window_deep(glass: str, blind: float, curtain: float) -> Shapes:
    """Dark glazing from side to side, with one opening light beside a narrow one."""
    shapes = glazing(2.4, 2.0, glass, columns=(0.3,), frame=0.05, bar=0.06, blind=blind,
                     curtain=curtain)  # fmt: skip
    shapes.append(slab(-1.15, -0.5, 0.55, 0.60, -0.05, "frame_paint", back=PANE))
    return shapes


def window_slit(glass: str, blind: float, curtain: float) -> Shapes:
    """Narrow upright light of a staircase."""
    del blind, curtain
    shapes = surround(0.5, 2.3, 0.05, -0.06, "frame_paint")
    shapes.append(pane(-0.225, 0.225, 0.025, 2.275, glass))
    shapes.append(slab(-0.2, 0.2, 1.12, 1.17, -0.05, "frame_paint", back=PANE))
    return shapes


def window_wide(glass: str, blind: float, curtain: float) -> Shapes:
    """Sliding door from floor to ceiling beside a fixed light, of a flat of today."""
    shapes = glazing(2.6, 2.4, glass, columns=(0.36, 0.68), frame=0.06, bar=0.07, bottom=False,
                     blind=blind, curtain=curtain)  # fmt: skip
    shapes.append(slab(-1.24, -0.37, 0.0, 0.34, -0.05, "frame_paint", (0.9, 0.9, 0.9), back=PANE))
    return shapes


def window_lattice(glass: str, blind: float, curtain: float) -> Shapes:
    """Square window of four by four panes under the gable of a tower."""
    return glazing(1.9, 1.9, glass, columns=(0.25, 0.5, 0.75), rows=(0.25, 0.5, 0.75), frame=0.08,
                   bar=0.045, blind=blind, curtain=curtain)  # fmt: skip


def window_grille(glass: str, blind: float, curtain: float) -> Shapes:
    """Unglazed opening of a parking deck: darkness behind upright bars of steel."""
    del glass, blind, curtain
    shapes = [pane(-1.5, 1.5, 0.0, 1.3, "metal_dark", DIM, y=-0.012)]
    shapes += [
        slab(x - 0.02, x + 0.02, 0.0, 1.3, -0.05, "metal_grey", back=-0.02)
        for x in (-1.4, -1.2, -1.0, -0.8, -0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4)
    ]
    shapes.append(slab(-1.5, 1.5, 1.22, 1.3, -0.06, "metal_grey", back=-0.02))
    return shapes


def window_moderne(glass: str, blind: float, curtain: float) -> Shapes:
    """Steel window between two opening lights, with level bars only, of the nineteen-thirties."""
    return glazing(1.95, 1.4, glass, columns=(0.27, 0.73), rows=(0.25, 0.5, 0.75), frame=0.045,
                   bar=0.03, blind=blind, curtain=curtain)  # fmt: skip


def window_ribbon(glass: str, blind: float, curtain: float) -> Shapes:
    """Facet of a window that runs round a corner: level bars, hardly a frame."""
    return glazing(1.3, 1.4, glass, rows=(0.25, 0.5, 0.75), frame=0.04, bar=0.03, blind=blind,
                   curtain=curtain)  # fmt: skip


def window_deco(glass: str, blind: float, curtain: float) -> Shapes:
    """Tall window with narrow lights about a broad one, its corners stepped in stone."""
    shapes = glazing(1.3, 1.9, glass, columns=(0.2, 0.8), rows=(0.16, 0.84), frame=0.05, bar=0.035,
                     blind=blind, curtain=curtain)  # fmt: skip
    for side in (-1, 1):
        for reach, low in ((0.2, 1.78), (0.09, 1.64)):
            x0, x1 = sorted((side * 0.65, side * (0.65 - reach)))
            shapes.append(slab(x0, x1, low, 1.9, -0.08, "trim"))
    return shapes


def window_glass_block(glass: str, blind: float, curtain: float) -> Shapes:
    """Light of a staircase: a wall of glass blocks from floor to floor."""
    del blind, curtain
    return glazing(1.5, 2.5, glass, columns=tuple(np.arange(1, 5) / 5),
                   rows=tuple(np.arange(1, 9) / 9), frame=0.05, bar=0.045)  # fmt: skip


def _half_drum(radius: float, low: float, high: float, material: str) -> MeshBatch:
    """Make the part of a drum that stands before the wall, `BULGE` metres at most."""
    back = radius - BULGE  # metres of its middle behind the wall
    angle = np.linspace(np.pi + np.arcsin(back / radius), 2 * np.pi - np.arcsin(back / radius), 9)
    ring = np.column_stack([radius * np.cos(angle), back + radius * np.sin(angle)])
    return loft(np.stack([np.column_stack([ring, np.full(9, z)]) for z in (low, high)]), material)


def door_lobby() -> Shapes:
    """Entrance of an office tower: a revolving door between swing doors, a hung canopy."""
    shapes = surround(5.0, 3.4, 0.09, -0.10, "metal_grey", bottom=False)
    shapes += [
        pane(-2.4, 2.4, 0.0, 3.32, "glass"),
        slab(-2.4, 2.4, 2.46, 2.54, -0.08, "metal_grey", back=PANE),
        _half_drum(0.95, 0.0, 2.46, "glass"),
        _half_drum(1.02, 2.46, 2.66, "metal_grey"),
    ]
    for x in (-2.4, -1.75, -1.08, 1.08, 1.75, 2.4):
        shapes.append(slab(x - 0.04, x + 0.04, 0.0, 2.46, -0.07, "metal_grey", back=PANE))
    for x in (-1.5, 1.5):
        shapes.append(slab(x - 0.015, x + 0.015, 0.85, 1.6, -0.12, "metal_grey", back=-0.07))
    shapes += [
        slab(-3.0, 3.0, 3.4, 3.58, -1.7, "metal_grey"),
        slab(-2.9, 2.9, 3.36, 3.4, -1.6, "frame_paint"),
        slab(-2.7, 2.7, -0.35, 0.02, -BULGE, "concrete"),
    ]
    # Hung on rods: posts would stand in the street before a narrow pavement.
    for x in (-2.6, 2.6):
        shapes.append(cylinder((x, -1.5, 3.55), (x, -0.02, 4.35), 0.025, "metal_grey", sides=6))
    return shapes


def door_deco() -> Shapes:
    """Double door with stepped panes in its leaves, under a light with rays."""
    shapes = surround(2.0, 2.85, 0.07, -0.10, "metal_grey", bottom=False)
    shapes += [
        pane(-0.93, 0.93, 2.25, 2.78, "glass"),
        slab(-0.93, 0.93, 2.15, 2.25, -0.09, "metal_grey", back=PANE),
        slab(-1.25, 1.25, -0.35, 0.02, -0.55, "step_stone"),
    ]
    for side in (-1, 1):
        x0, x1 = sorted((side * 0.01, side * 0.93))
        shapes.append(slab(x0, x1, 0.02, 2.15, -0.05, "door_paint"))
        for low, high, reach in ((0.35, 1.2, 0.22), (1.2, 1.65, 0.34), (1.65, 2.0, 0.46)):
            near, far = sorted((side * 0.2, side * (0.2 + reach)))
            shapes.append(pane(near, far, low, high, "glass", y=-0.056))
        near, far = sorted((side * 0.08, side * 0.12))
        shapes.append(slab(near, far, 0.75, 1.75, -0.13, "metal_grey", back=-0.06))
    for angle in np.radians([30.0, 60.0, 90.0, 120.0, 150.0]):
        way = np.array([np.cos(angle), np.sin(angle)])
        long = min(0.5 / way[1], 0.9)
        end = 0.0 + long * way[0], -0.06, 2.27 + long * way[1]
        shapes.append(cylinder((0.0, -0.06, 2.27), end, 0.018, "metal_grey", sides=6))
    return shapes


def door_parking() -> Shapes:
    """Way into a parking deck: two lanes with barriers, a height bar, a sign, and a side door."""
    shapes: Shapes = [
        pane(-3.5, 2.1, 0.0, 2.55, "metal_dark", DIM, y=-0.015),
        slab(-3.8, 3.8, 2.55, 3.05, -0.30, "concrete", (0.9, 0.9, 0.9)),
        slab(-3.8, -3.5, -0.2, 2.55, -0.30, "concrete", (0.9, 0.9, 0.9)),
        slab(2.1, 2.4, -0.2, 2.55, -0.30, "concrete", (0.9, 0.9, 0.9)),
        slab(3.5, 3.8, -0.2, 2.55, -0.30, "concrete", (0.9, 0.9, 0.9)),
        slab(2.5, 3.4, 0.0, 2.1, -0.05, "door_paint"),
        slab(-3.9, 2.5, -0.3, 0.02, -1.0, "asphalt_light"),
    ]
    # The bar that tells the height, hung from chains.
    shapes.append(cylinder((-3.3, -0.55, 2.22), (1.9, -0.55, 2.22), 0.07, "sign", YELLOW))
    for x in (-3.0, -0.7, 1.6):
        shapes.append(box((x - 0.01, -0.56, 2.22), (x + 0.01, -0.54, 2.7), "metal_dark"))
    shapes.append(slab(-3.4, 2.0, 2.62, 2.74, -0.62, "metal_grey", back=-0.30))
    # Island with two posts, arms and a column for tickets.
    shapes.append(box((-0.95, -3.2, -0.1), (-0.45, -0.1, 0.14), "kerb_stone"))
    for x, far in ((-0.62, 1.75), (-0.78, -3.2)):
        shapes.append(box((x - 0.13, -0.95, 0.1), (x + 0.13, -0.65, 1.1), "sign", (0.9, 0.5, 0.1)))
        low, high = min(x, far), max(x, far)
        shapes.append(box((low, -0.84, 0.92), (high, -0.76, 1.02), "sign", (0.9, 0.9, 0.88)))
        for share in (0.25, 0.5, 0.75):
            middle = x + share * (far - x)
            shapes.append(
                box((middle - 0.14, -0.85, 0.915), (middle + 0.14, -0.75, 1.025), "sign",
                    (0.75, 0.06, 0.05))
            )  # fmt: skip
    shapes.append(box((-0.86, -2.7, 0.1), (-0.56, -2.4, 1.35), "plastic", (0.2, 0.25, 0.5)))
    # The blue sign with its white letter.
    shapes += [
        box((-1.25, -0.42, 3.05), (-0.05, -0.30, 4.25), "sign", (0.03, 0.18, 0.75)),
        box((-0.90, -0.44, 3.22), (-0.73, -0.42, 4.08), "sign"),
        disc((-0.60, -0.44, 3.84), 0.24, "sign", sides=10),
        disc((-0.60, -0.45, 3.84), 0.10, "sign", (0.03, 0.18, 0.75), sides=10, thickness=0.01),
    ]
    return shapes


def door_bronze() -> Shapes:
    """Portal of a masonry skyscraper: stepped stone jambs, a bronze grille and lanterns."""
    bronze = (0.7, 0.55, 0.3)
    shapes: Shapes = [
        pane(-2.3, 2.3, 0.0, 3.45, "glass"),
        slab(-2.6, 2.6, -0.35, 0.02, -0.5, "stone"),
    ]
    for x in (-2.25, -1.15, -0.05, 1.05, 2.15):
        shapes.append(slab(x, x + 0.1, 0.0, 3.45, -0.12, "metal_panel", bronze))
    for number, reach in enumerate((0.0, 0.45, 0.9)):
        depth = -0.25 - 0.17 * number
        for side in (-1, 1):
            x0, x1 = sorted((side * (2.3 + reach), side * (2.75 + reach)))
            shapes.append(slab(x0, x1, -0.2, 6.6 - 0.55 * number, depth, "stone"))
    shapes += [
        slab(-2.75, 2.75, 6.0, 7.0, -0.42, "stone"),
        slab(-1.2, 1.2, 7.0, 7.7, -0.36, "stone"),
        slab(-0.4, 0.4, 7.7, 8.3, -0.3, "stone"),
        slab(-2.3, 2.3, 3.45, 3.75, -0.3, "metal_panel", bronze),
        slab(-2.3, 2.3, 3.75, 6.0, -0.05, "metal_dark"),
    ]
    for x in (-2.1, -1.575, -1.05, -0.525, 0.0, 0.525, 1.05, 1.575, 2.1):
        shapes.append(slab(x - 0.05, x + 0.05, 3.75, 6.0, -0.14, "metal_panel", bronze))
    for x in (-3.9, 3.9):
        shapes.append(box((x - 0.16, -0.75, 2.5), (x + 0.16, -0.45, 3.4), "lamp_glow"))
        shapes.append(box((x - 0.22, -0.82, 3.4), (x + 0.22, 0.0, 3.52), "metal_dark"))
        shapes.append(box((x - 0.22, -0.82, 2.4), (x + 0.22, 0.0, 2.5), "metal_dark"))
    return shapes
