"""Windows and doors as things that sit on a wall.

Every prototype stands with its bottom centre at the origin on the wall plane: x along the wall (to
the right seen from outside), -y outward, z up. Walls have no holes, so frames stand out from the
wall and panes lie a finger's breadth before it. `WINDOWS` and `DOORS` give the opening each was
drawn for. At the finest level of detail they fill niches: y runs from the wall plane, 0, to the
back of the niche, `NICHE_DEPTH`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial
from importlib import import_module
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.kept_prototypes import kept
from cityx.assets.openings.windows_halls import HALL_DOORS, HALL_WINDOWS, OUTLINES
from cityx.assets.shapes import (
    WHITE,
    Color,
    bevelled,
    box,
    disc,
    fine_shapes,
    is_fine,
    moved,
    prism,
    prototype,
)
from cityx.city.mesh import MeshBatch, one_mesh
from cityx.city.scene import Prototype

Shapes = list[MeshBatch]
PANE = -0.022  # metres before the wall; enough for the depth buffers of viewers 500 m away
FRAME = -0.075  # how far the fixed frame stands out
SASH = -0.050  # how far sashes and bars stand out
NICHE_DEPTH = 0.15  # metres, of the niche that fine windows, doors and shopfronts are drawn for
FINE = 3  # level of detail from which fine forms are made
GLASS = "glass"
DARK: Color = (0.30, 0.30, 0.30)
PALE: Color = (0.92, 0.91, 0.88)


def slab(
    x0: float, x1: float, z0: float, z1: float, front: float, material: str,
    tint: Color = WHITE, *, back: float = 0.0,
) -> MeshBatch:  # fmt: skip
    """Make a box against the wall without its back: five faces between `back` and `front` in y."""
    low, high = (x0, front, z0), (x1, back, z1)
    if is_fine():
        return bevelled(low, high, material, tint, hidden=("+y",))
    whole = box(low, high, material, tint)
    keep = np.array([0, 1, 2, 4, 5])  # all but the face towards the wall
    return one_mesh(0, whole.vertices, whole.faces[keep], materials=(material,),
                    uv=whole.uv[keep], tint=tint)  # fmt: skip


def pane(x0: float, x1: float, z0: float, z1: float, material: str, tint: Color = WHITE,
         *, y: float = PANE) -> MeshBatch:  # fmt: skip
    """Make an upright rectangle that faces outward."""
    corners = [[x0, y, z0], [x1, y, z0], [x1, y, z1], [x0, y, z1]]
    uv = [[[x0, z0], [x1, z0], [x1, z1], [x0, z1]]]
    return one_mesh(0, corners, [[0, 1, 2, 3]], materials=(material,), uv=uv, tint=tint)


def surround(width: float, height: float, border: float, front: float, material: str,
             tint: Color = WHITE, *, bottom: bool = True) -> Shapes:  # fmt: skip
    """Make the four (or three) sides of a frame within width and height."""
    w = width / 2
    foot = border if bottom else 0.0
    sides = [
        slab(-w, -w + border, foot, height - border, front, material, tint),
        slab(w - border, w, foot, height - border, front, material, tint),
        slab(-w, w, height - border, height, front, material, tint),
    ]
    if bottom:
        sides.append(slab(-w, w, 0.0, border, front, material, tint))
    return sides


def glazing(
    width: float,
    height: float,
    glass: str,
    *,
    columns: Sequence[float] = (),
    rows: Sequence[float] = (),
    frame: float = 0.06,
    bar: float = 0.035,
    bottom: bool = True,
    blind: float = 0.0,
    curtain: float = 0.0,
) -> Shapes:
    """Make frame, pane and bars of a window.

    Parameters
    ----------
    width, height
        Of the opening, metres.
    glass
        Material of the pane.
    columns, rows
        Places of upright and level bars, as shares of width and height.
    frame, bar
        Breadth of the fixed frame and of the bars.
    bottom
        Whether the frame has a lower rail.
    blind, curtain
        Share of the height covered by a roller blind, of the width by each of two curtains.
    """
    if is_fine():
        from cityx.assets.openings.fine_windows import fine_glazing

        return fine_glazing(width, height, glass, columns=columns, rows=rows, frame_width=frame,
                            bar_width=bar, bottom=bottom, blind=blind, drawn=curtain)  # fmt: skip
    w = width / 2
    shapes = surround(width, height, frame, FRAME, "frame_paint", bottom=bottom)
    shapes.append(pane(-w + frame / 2, w - frame / 2, 0.0, height - frame / 2, glass))
    inner = width - 2 * frame
    if blind:
        low = height - frame - blind * (height - 2 * frame)
        shapes.append(
            pane(-inner / 2, inner / 2, low, height - frame, "curtain", PALE, y=PANE - 0.006)
        )
    if curtain:
        reach = curtain * inner
        for x0, x1 in ((-inner / 2, -inner / 2 + reach), (inner / 2 - reach, inner / 2)):
            shapes.append(pane(x0, x1, frame, height - frame, "curtain", PALE, y=PANE - 0.006))
    for share in columns:
        x = -w + share * width
        shapes.append(slab(x - bar / 2, x + bar / 2, frame, height - frame, SASH, "frame_paint",
                           back=PANE))  # fmt: skip
    for share in rows:
        z = share * height
        shapes.append(slab(-inner / 2, inner / 2, z - bar / 2, z + bar / 2, SASH + 0.004,
                           "frame_paint", back=PANE))  # fmt: skip
    return shapes


def _shutters(width: float, height: float, *, leaf: float = 0.5, gap: float = 0.03) -> Shapes:
    """Make two open louvred shutters beside the opening."""
    shapes: Shapes = []
    for side in (-1, 1):
        near, far = side * (width / 2 + gap), side * (width / 2 + gap + leaf)
        x0, x1 = min(near, far), max(near, far)
        shapes.append(slab(x0, x1, 0.0, height, -0.045, "door_paint"))
        for z in np.linspace(0.12, height - 0.12, 7)[:-1]:
            top = z + (height - 0.24) / 6 - 0.09
            shapes.append(
                slab(x0 + 0.06, x1 - 0.06, z, top, -0.058, "door_paint",
                     (0.8, 0.8, 0.8), back=-0.045)
            )  # fmt: skip
    return shapes


# --- windows --------------------------------------------------------------------------------------

Maker = Callable[[str, float, float], Shapes]


def window_sash(glass: str, blind: float, curtain: float) -> Shapes:
    """Sash window of two by two panes in each half, with a meeting rail."""
    shapes = glazing(1.05, 1.75, glass, columns=(0.5,), rows=(0.25, 0.75), bar=0.028,
                     blind=blind, curtain=curtain)  # fmt: skip
    shapes.append(slab(-0.47, 0.47, 0.85, 0.92, SASH - 0.012, "frame_paint", back=PANE))
    return shapes


def window_casement(glass: str, blind: float, curtain: float) -> Shapes:
    """Two casements under a two-light transom, the box window of the old quarters."""
    shapes = glazing(1.15, 1.9, glass, columns=(0.5,), frame=0.07, bar=0.075,
                     blind=blind, curtain=curtain)  # fmt: skip
    shapes.append(slab(-0.51, 0.51, 1.30, 1.38, SASH - 0.014, "frame_paint", back=PANE))
    return shapes


def window_single(glass: str, blind: float, curtain: float) -> Shapes:
    """Modern window with one fixed and one opening light."""
    return glazing(1.35, 1.5, glass, columns=(0.64,), frame=0.07, bar=0.08,
                   blind=blind, curtain=curtain)  # fmt: skip


def window_french(glass: str, blind: float, curtain: float) -> Shapes:
    """Pair of glazed doors to a balcony, with low solid panels."""
    shapes = glazing(1.3, 2.25, glass, columns=(0.5,), rows=(0.76,), frame=0.07, bar=0.07,
                     bottom=False, blind=blind, curtain=curtain)  # fmt: skip
    for x0, x1 in ((-0.57, -0.05), (0.05, 0.57)):
        shapes.append(slab(x0, x1, 0.0, 0.42, SASH + 0.008, "frame_paint", back=PANE))
    return shapes


def window_office(glass: str, blind: float, curtain: float) -> Shapes:
    """Wide office window of three lights over a panel."""
    shapes = glazing(2.2, 1.9, glass, columns=(1 / 3, 2 / 3), frame=0.06, bar=0.06,
                     blind=blind, curtain=curtain)  # fmt: skip
    shapes.append(slab(-1.04, 1.04, 0.42, 0.48, SASH, "frame_paint", back=PANE))
    return shapes


def window_strip(glass: str, blind: float, curtain: float) -> Shapes:
    """Ribbon window that meets its neighbours."""
    return glazing(3.0, 1.5, glass, columns=(0.25, 0.5, 0.75), frame=0.05, bar=0.05,
                   blind=blind, curtain=curtain)  # fmt: skip


def window_shuttered(glass: str, blind: float, curtain: float) -> Shapes:
    """Tall casement with open louvred shutters."""
    shapes = glazing(1.0, 1.6, glass, columns=(0.5,), rows=(0.36, 0.68), bar=0.04,
                     blind=blind, curtain=curtain)  # fmt: skip
    return shapes + _shutters(1.0, 1.6)


def window_small(glass: str, blind: float, curtain: float) -> Shapes:
    """Small window of a bathroom, stair or back wall."""
    return glazing(0.8, 0.95, glass, frame=0.06, blind=blind, curtain=curtain)


def window_cottage(glass: str, blind: float, curtain: float) -> Shapes:
    """Casement pair with glazing bars."""
    return glazing(1.2, 1.25, glass, columns=(0.25, 0.5, 0.75), rows=(0.34, 0.67), frame=0.06,
                   bar=0.028, blind=blind, curtain=curtain)  # fmt: skip


def window_slider(glass: str, blind: float, curtain: float) -> Shapes:
    """Aluminium sliding window of two leaves that overlap."""
    shapes = glazing(1.7, 1.2, glass, frame=0.045, blind=blind, curtain=curtain)
    shapes.append(slab(-0.03, 0.03, 0.045, 1.155, SASH - 0.015, "frame_paint", back=PANE))
    shapes.append(slab(-0.80, 0.0, 0.045, 0.085, SASH - 0.01, "frame_paint", back=PANE))
    shapes.append(slab(0.0, 0.80, 0.045, 0.085, SASH, "frame_paint", back=PANE))
    return shapes


def window_factory(glass: str, blind: float, curtain: float) -> Shapes:
    """Steel window of many small panes."""
    return glazing(2.4, 1.8, glass, columns=(1 / 6, 2 / 6, 3 / 6, 4 / 6, 5 / 6),
                   rows=(0.25, 0.5, 0.75), frame=0.05, bar=0.025,
                   blind=blind, curtain=curtain)  # fmt: skip


def arch(width: float, height: float, sides: int = 8) -> NDArray[np.float64]:
    """Outline (k, 2) of x and z of an opening with a round head, counter-clockwise."""
    radius = width / 2
    angle = np.linspace(0.0, np.pi, sides + 1)
    head = np.column_stack([radius * np.cos(angle), height - radius + radius * np.sin(angle)])
    return np.vstack([[[-radius, 0.0], [radius, 0.0]], head])


def window_arched(glass: str, blind: float, curtain: float) -> Shapes:
    """Tall window with a round head and tracery bars."""
    del blind, curtain
    shapes = [
        prism(arch(1.5, 4.0), -0.06, 0.0, "trim", (0.9, 0.88, 0.84)),
        moved(prism(arch(1.22, 3.74), -0.075, 0.0, glass), (0.0, 0.0, 0.12)),
    ]
    for x in (-0.2, 0.2):
        shapes.append(slab(x - 0.025, x + 0.025, 0.12, 3.7, -0.10, "metal_dark", back=-0.07))
    for z in (1.0, 1.9, 2.8):
        shapes.append(slab(-0.6, 0.6, z - 0.02, z + 0.02, -0.095, "metal_dark", back=-0.07))
    return shapes


def _made_in(module: str, name: str) -> Callable[..., Shapes]:
    """Return a maker of a module that builds on this one, imported when it is first used."""

    def make(*options: object) -> Shapes:
        shapes: Shapes = getattr(import_module(f"cityx.assets.openings.{module}"), name)(*options)
        return shapes

    return make


_towers = partial(_made_in, "windows_towers")
_houses = partial(_made_in, "windows_houses")
_old_town = partial(_made_in, "windows_old_town")


# Name -> maker and the width and height it was drawn for.
WINDOWS: Mapping[str, tuple[Maker, float, float]] = MappingProxyType(
    {
        "window_sash": (window_sash, 1.05, 1.75),
        "window_casement": (window_casement, 1.15, 1.9),
        "window_single": (window_single, 1.35, 1.5),
        "window_french": (window_french, 1.3, 2.25),
        "window_office": (window_office, 2.2, 1.9),
        "window_strip": (window_strip, 3.0, 1.5),
        "window_shuttered": (window_shuttered, 1.0, 1.6),
        "window_small": (window_small, 0.8, 0.95),
        "window_cottage": (window_cottage, 1.2, 1.25),
        "window_slider": (window_slider, 1.7, 1.2),
        "window_factory": (window_factory, 2.4, 1.8),
        "window_arched": (window_arched, 1.5, 4.0),
        "window_pair": (_towers("window_pair"), 2.0, 1.8),
        "window_deep": (_towers("window_deep"), 2.4, 2.0),
        "window_slit": (_towers("window_slit"), 0.5, 2.3),
        "window_wide": (_towers("window_wide"), 2.6, 2.4),
        "window_lattice": (_towers("window_lattice"), 1.9, 1.9),
        "window_grille": (_towers("window_grille"), 3.0, 1.3),
        "window_moderne": (_towers("window_moderne"), 1.95, 1.4),
        "window_ribbon": (_towers("window_ribbon"), 1.3, 1.4),
        "window_deco": (_towers("window_deco"), 1.3, 1.9),
        "window_glass_block": (_towers("window_glass_block"), 1.5, 2.5),
        "window_picture": (_houses("window_picture"), 2.7, 1.55),
        "window_grid": (_houses("window_grid"), 0.95, 1.5),
        "window_leaded": (_houses("window_leaded"), 1.3, 1.0),
        "window_terrace": (_houses("window_terrace"), 1.75, 1.95),
        "window_prow": (_houses("window_prow"), 1.8, 1.6),
        "window_temple": (_houses("window_temple"), 2.3, 2.5),
        "window_barn": (_houses("window_barn"), 0.8, 0.8),
        "window_parisian": (_old_town("window_parisian"), 1.15, 2.3),
        "window_persiana": (_old_town("window_persiana"), 1.0, 1.7),
        "window_georgian": (_old_town("window_georgian"), 1.05, 1.95),
        "window_tenement": (_old_town("window_tenement"), 1.0, 1.75),
        "window_block": (_old_town("window_block"), 1.7, 1.75),
        "window_cross": (_old_town("window_cross"), 1.1, 1.9),
        "window_mullioned": (_old_town("window_mullioned"), 1.5, 2.6),
        "window_panel": (_old_town("window_panel"), 1.8, 1.4),
        **HALL_WINDOWS,
    }
)
# What is drawn behind the pane: nothing, a blind half down, curtains, a blind nearly closed.
DRESSINGS: tuple[tuple[float, float], ...] = ((0.0, 0.0), (0.38, 0.0), (0.0, 0.22), (0.7, 0.0))


# --- doors ----------------------------------------------------------------------------------------


def _leaf(x0: float, x1: float, z0: float, z1: float, panels: int) -> Shapes:
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
    shapes += _leaf(-0.60, 0.60, 0.05, 2.12, 3)
    shapes.append(disc((0.45, -0.07, 1.1), 0.035, "metal_grey", sides=6, thickness=0.03))
    return shapes


def door_double() -> Shapes:
    """Tall double door of a tenement, with a glazed transom."""
    shapes = _leaf(-0.84, -0.01, 0.04, 2.3, 3) + _leaf(0.01, 0.84, 0.04, 2.3, 3)
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
    shapes += _leaf(-0.49, 0.49, 0.05, 2.11, 2)
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
        "door_lobby": (_towers("door_lobby"), 5.2, 3.5),
        "door_parking": (_towers("door_parking"), 7.8, 3.05),
        "door_bronze": (_towers("door_bronze"), 8.3, 8.3),
        "door_deco": (_towers("door_deco"), 2.0, 2.85),
        "door_sidelight": (_houses("door_sidelight"), 1.66, 2.25),
        "door_boards": (_houses("door_boards"), 1.1, 2.1),
        "door_carriage": (_houses("door_carriage"), 2.55, 2.3),
        "door_barn": (_houses("door_barn"), 3.7, 3.3),
        "door_flat": (_houses("door_flat"), 1.9, 2.3),
        "door_greenhouse": (_houses("door_greenhouse"), 2.2, 2.3),
        "door_fanlight": (_old_town("door_fanlight"), 2.2, 2.95),
        "door_gateway": (_old_town("door_gateway"), 2.9, 3.7),
        "door_stoop": (_old_town("door_stoop"), 2.2, 4.1),
        "door_planks": (_old_town("door_planks"), 2.0, 2.9),
        "door_council": (_old_town("door_council"), 3.4, 4.4),
        "door_stairwell": (_old_town("door_stairwell"), 2.4, 2.6),
        **HALL_DOORS,
    }
)


# Outlines of niches as shares of the opening's width and height, where they are not all of it:
# portals and pilasters stand on the wall beside the door.
_FULL = ((-0.5, 0.0), (0.5, 0.0), (0.5, 1.0), (-0.5, 1.0))
_LEAVES = {"door_panel": (1.2 / 1.7, 2.75 / 3.0), "door_double": (1.68 / 2.0, 2.94 / 3.1)}


def rim_of(name: str) -> NDArray[np.float64]:
    """Outline (p, 2) of the niche for a window, door or shopfront, in shares of the opening.

    Metres from the middle over the width, metres above the foot over the height; convex and
    counter-clockwise seen from outside.
    """
    if name == "window_arched":
        return arch(1.5, 4.0, 16) / [1.5, 4.0]
    if name == "door_portal":
        return arch(1.8, 3.45, 20) / [2.7, 4.0]
    if name in OUTLINES:
        return OUTLINES[name]
    return np.array(_FULL) * _LEAVES.get(name, (1.0, 1.0))


def set_back(shapes: Shapes) -> Shapes:
    """Move what was drawn for the wall plane to the back of a niche, where it has no fine form."""
    return [moved(shape, (0.0, NICHE_DEPTH, 0.0)) for shape in shapes]


@lru_cache(maxsize=512)
@kept("window", least=FINE)
def window(name: str, dressing: int = 0, *, detail: int = 2) -> Prototype:
    """Make a window prototype.

    Parameters
    ----------
    name
        Key of `WINDOWS`.
    dressing
        Index into `DRESSINGS`.
    detail
        Level of detail; from `FINE` on it fills a niche.

    Raises
    ------
    KeyError
        If there is no such window.
    """
    maker = WINDOWS[name][0]
    suffix = f"_{dressing}"
    if detail >= FINE:
        from cityx.assets.openings.fine_windows import PATTERNS, fine_window

        if name == "window_arched" or name in PATTERNS:
            shapes = fine_window(name, GLASS, dressing)
        else:
            with fine_shapes():
                shapes = set_back(maker(GLASS, *DRESSINGS[dressing]))
        return prototype(f"{name}{suffix}_fine", "window", shapes)
    return prototype(name + suffix, "window", maker(GLASS, *DRESSINGS[dressing]))


@lru_cache(maxsize=32)
@kept("door", least=FINE)
def door(name: str, *, detail: int = 2) -> Prototype:
    """Make a door prototype; `name` is a key of `DOORS`, `detail` as of `window`."""
    if detail >= FINE:
        from cityx.assets.openings.fine_doors import FINE_DOORS

        if name in FINE_DOORS:
            shapes = FINE_DOORS[name]()
        else:
            with fine_shapes():
                shapes = set_back(DOORS[name][0]())
        return prototype(f"{name}_fine", "door", shapes)
    return prototype(name, "door", DOORS[name][0]())
