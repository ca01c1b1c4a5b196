"""What windows, doors and shopfronts are made of: slabs, panes, frames with bars, arches.

Every prototype stands with its bottom centre at the origin on the wall plane: x along the wall (to
the right seen from outside), -y outward, z up. Walls have no holes, so frames stand out from the
wall and panes lie a finger's breadth before it. At the finest level of detail they fill niches: y
runs from the wall plane, 0, to the back of the niche, `NICHE_DEPTH`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cityx.assets.openings.windows_halls import OUTLINES
from cityx.assets.shapes import WHITE, Color, bevelled, box, is_fine, moved
from cityx.assets.trims.mouldings import bar, curtain, frame, portal, rectangle, slats, soft
from cityx.city.mesh import MeshBatch, one_mesh

Shapes = list[MeshBatch]
PANE = -0.022  # metres before the wall; enough for the depth buffers of viewers 500 m away
FRAME = -0.075  # how far the fixed frame stands out
SASH = -0.050  # how far sashes and bars stand out
NICHE_DEPTH = 0.15  # metres, of the niche that fine windows, doors and shopfronts are drawn for
FINE = 3  # level of detail from which fine forms are made
GLASS = "glass"
PALE: Color = (0.92, 0.91, 0.88)
LINEN: Color = (0.80, 0.77, 0.70)
BACKING = 0.136  # metres; the dark of the room
PANE_MATERIAL = "pane"
DWELLING = 2.45  # metres; no window of a dwelling is wider or taller
# Outlines of niches as shares of the opening's width and height, where they are not all of it:
# portals and pilasters stand on the wall beside the door.
_FULL = ((-0.5, 0.0), (0.5, 0.0), (0.5, 1.0), (-0.5, 1.0))
_LEAVES = {"door_panel": (1.2 / 1.7, 2.75 / 3.0), "door_double": (1.68 / 2.0, 2.94 / 3.1)}


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


def plate(outline: object, y: float, material: str) -> MeshBatch:
    """Make a flat face on a convex outline that faces outward."""
    ring = np.asarray(outline, float)
    corners = np.column_stack([ring[:, 0], np.full(len(ring), y), ring[:, 1]])
    fan = [[0, i, i + 1] for i in range(1, len(ring) - 1)]
    faces = [[0, 1, 2, 3]] if len(ring) == 4 else fan
    uv = np.zeros((len(faces), 4, 2))
    for row, face in enumerate(faces):
        uv[row, : len(face)] = ring[face]
    return one_mesh(0, corners, faces, materials=(material,), uv=uv)


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
        return _fine_glazing(width, height, glass, columns=columns, rows=rows, frame_width=frame,
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


def _fine_glazing(
    width: float,
    height: float,
    glass: str,
    *,
    columns: Sequence[float],
    rows: Sequence[float],
    frame_width: float,
    bar_width: float,
    bottom: bool,
    blind: float,
    drawn: float,
) -> Shapes:
    """Make frame, panes, bars and dressing of a window that has only a plain form.

    Arguments are those of `glazing`; like there, all of it stands before the plane y = 0.
    """
    w = width / 2
    line = [(0.0, 0.0), (0.0, -0.075), (0.6 * frame_width, -0.075), (0.75 * frame_width, -0.068),
            (0.9 * frame_width, -0.060), (frame_width, -0.056), (frame_width, -0.012)]  # fmt: skip
    sweep = frame if bottom else portal
    shapes: Shapes = [sweep(-w, w, 0.0, height, soft(line, 0.004, 3), "frame_paint")]
    inside = w - 0.8 * frame_width
    low = 0.8 * frame_width if bottom else 0.0
    top = height - 0.8 * frame_width
    opening = rectangle(-inside, inside, low, top)
    shapes += [plate(opening, -0.012, glass), plate(opening, -0.050, PANE_MATERIAL)]
    for share in columns:
        x = -w + share * width
        shapes.append(bar((x, low), (x, top), bar_width / 2, -0.062, "frame_paint"))
    for share in rows:
        z = share * height
        shapes.append(bar((-inside, z), (inside, z), bar_width / 2, -0.064, "frame_paint"))
    folds = max(2, round(inside * 0.6 / 0.075))
    if blind:
        shapes += slats(-inside, inside, top - blind * (top - low), top, -0.030, tint=PALE)
        return shapes
    # Rooms that one lives in have drapes at least; halls and works have large or barred windows.
    lived_in = max(width, height) < DWELLING and len(columns) * len(rows) < 6
    if drawn or lived_in:
        reach = (1.4 * drawn if drawn else 0.15) * 2 * inside
        tied, tint = (0.2, PALE) if drawn else (0.35, LINEN)
        for edge, end in ((-inside, -inside + reach), (inside, inside - reach)):
            shapes.append(curtain(edge, end, low, top, -0.030, folds=folds, tied=tied, tint=tint))
    return shapes


def arch(width: float, height: float, sides: int = 8) -> NDArray[np.float64]:
    """Outline (k, 2) of x and z of an opening with a round head, counter-clockwise."""
    radius = width / 2
    angle = np.linspace(0.0, np.pi, sides + 1)
    head = np.column_stack([radius * np.cos(angle), height - radius + radius * np.sin(angle)])
    return np.vstack([[[-radius, 0.0], [radius, 0.0]], head])


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
