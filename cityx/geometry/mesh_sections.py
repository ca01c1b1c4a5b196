"""Sections: a closed mesh as upright slabs, the volumes between its levels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.solids import NO_VERTEX, area_vectors

LEVEL = 0.01  # metres; heights closer than this are one level
UPRIGHT = 0.02  # vertical part of a normal below which a face is a wall
SAME = 0.01  # of the area of a section, by which the next may differ and be the same
THINNEST = 0.6  # metres; a thinner slab belongs to the one below it
LEAST_AREA = 0.01  # square metres of a section
OVER = 0.3  # metres by which a roof may reach over the walls that bear it


@dataclass(frozen=True)
class Slab:
    """A volume between two levels.

    Attributes
    ----------
    plan
        Its section, a polygon, metres.
    low, high
        Metres.
    rise
        Metres below `high` that slope, as of a roof; the rest has upright walls.
    """

    plan: Any
    low: float
    high: float
    rise: float = 0.0


def slabs_of(vertices: FloatArray, faces: IntArray | NDArray[np.int32]) -> list[Slab]:
    """Cut a closed mesh into slabs, from the lowest to the highest.

    Where all faces between two levels are upright the section is the same at every height and the
    slab has walls. What slopes becomes the roof of the slab below where that bears it, else a slab
    that is all roof, on the widest of its sections.

    Parameters
    ----------
    vertices, faces
        (n, 3) metres and (f, 4), counter-clockwise from outside, triangles with -1; one or more
        closed solids, which may touch or overlap.
    """
    triangles = np.concatenate(
        [faces[:, :3], faces[faces[:, 3] != NO_VERTEX][:, [0, 2, 3]]]
    ).astype(np.int64)
    z = vertices[:, 2]
    levels = np.sort(z)
    levels = levels[np.concatenate([[True], np.diff(levels) > LEVEL])]
    low, high = z[triangles].min(axis=1), z[triangles].max(axis=1)
    normal = area_vectors(vertices, np.column_stack([triangles, np.full(len(triangles), -1)]))
    sloping = np.abs(normal[:, 2]) > UPRIGHT * np.linalg.norm(normal, axis=1)
    solid = _solids(triangles, len(vertices))
    runs: list[tuple[Any, float, float, bool]] = []
    for foot, top in zip(levels[:-1].tolist(), levels[1:].tolist(), strict=True):
        middle = (foot + top) / 2
        across = (low < middle) & (high > middle)
        slopes = bool((sloping & across).any())
        near = min(LEVEL / 4, (top - foot) / 4)
        cuts = (foot + near, top - near) if slopes else (middle,)
        plan = shapely.union_all([_section(vertices, triangles, solid, at) for at in cuts])
        if runs and runs[-1][3] == slopes and (slopes or _alike(runs[-1][0], plan)):
            before = runs.pop()
            plan = shapely.union_all([before[0], plan]) if slopes else before[0]
            foot = before[1]
        runs.append((plan, foot, top, slopes))
    slabs = [
        Slab(piece, foot, top, top - foot if slopes else 0.0)
        for plan, foot, top, slopes in runs
        for piece in shapely.get_parts(plan)
        if shapely.get_type_id(piece) == 3 and piece.area > LEAST_AREA
    ]
    return _roofed(_thick(slabs))


def _solids(triangles: IntArray, count: int) -> IntArray:
    """Return the number of the solid of each triangle, (t,): those that share vertices."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    start, end = triangles.ravel(), np.roll(triangles, 1, axis=1).ravel()
    graph = coo_matrix((np.ones(len(start)), (start, end)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1][triangles[:, 0]], np.int64)


def _section(vertices: FloatArray, triangles: IntArray, solid: IntArray, height: float) -> Any:
    """Return the section of solids at a height that is no vertex's, a polygon or several."""
    above = vertices[:, 2][triangles] > height
    cut = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    ends = []
    for one, two in ((0, 1), (1, 2), (2, 0)):
        # An edge is cut at one place, whichever of its two triangles asks.
        pair = np.sort(triangles[cut][:, [one, two]], axis=1)
        a, b = vertices[pair[:, 0]], vertices[pair[:, 1]]
        crossed = above[cut, one] != above[cut, two]
        rise = np.where(crossed, b[:, 2] - a[:, 2], 1.0)
        share = (height - a[:, 2]) / rise
        point = a[:, :2] + share[:, None] * (b - a)[:, :2]
        ends.append(np.where(crossed[:, None], point, np.nan))
    points = np.stack(ends, axis=1)  # (c, 3, 2), of which two are known
    known = np.argsort(np.isnan(points[:, :, 0]), axis=1, kind="stable")[:, :2]
    lines = shapely.linestrings(np.take_along_axis(points, known[:, :, None], axis=1))
    pieces = [
        shapely.build_area(shapely.multilinestrings(lines[solid[cut] == number]))
        for number in np.unique(solid[cut]).tolist()
    ]
    return shapely.union_all(pieces, grid_size=1e-4)


def _alike(one: Any, two: Any) -> bool:
    least = SAME * min(one.area, two.area) + LEAST_AREA
    return bool(shapely.symmetric_difference(one, two).area < least)


def _thick(slabs: list[Slab]) -> list[Slab]:
    """Let thin slabs become part of those below them, or of those above where there are none."""
    kept: list[Slab] = []
    waiting: list[Slab] = []
    for slab in slabs:
        if slab.high - slab.low >= THINNEST:
            under = [one for one in waiting if _over(slab, one)]
            kept.append(replace(slab, low=min([slab.low, *(one.low for one in under)])))
            waiting = [one for one in waiting if one not in under]
            continue
        below = [at for at, one in enumerate(kept) if _over(slab, one)]
        for at in below:
            kept[at] = replace(kept[at], high=slab.high, rise=kept[at].rise and slab.rise)
        if not below:
            waiting.append(slab)
    return sorted([*kept, *(replace(one, high=one.low + THINNEST) for one in waiting)],
                  key=lambda one: (one.low, one.high))  # fmt: skip


def _over(upper: Slab, lower: Slab) -> bool:
    near = abs(upper.low - lower.high) <= LEVEL or upper.low == lower.low
    return near and shapely.intersection(upper.plan, lower.plan).area > LEAST_AREA


def _roofed(slabs: list[Slab]) -> list[Slab]:
    """Put slopes on the walls that bear them."""
    walls = [one for one in slabs if not one.rise]
    found = []
    for roof in (one for one in slabs if one.rise):
        for at, wall in enumerate(walls):
            same = abs(wall.high - roof.low) <= LEVEL and not wall.rise
            if same and wall.plan.buffer(OVER).covers(roof.plan) and (
                roof.plan.area > 0.9 * wall.plan.area
            ):  # fmt: skip
                walls[at] = replace(wall, high=roof.high, rise=roof.high - roof.low)
                break
        else:
            found.append(roof)
    return sorted([*walls, *found], key=lambda one: (one.low, one.high, one.plan.bounds))
