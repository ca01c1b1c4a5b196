"""Roofs that are a profile across a ridge: gabled, skillion, gambrel, round, sawtooth and others.

The outline is cut along the lines at which the profile bends; every piece is then a plane, so any
outline, with courtyards or not, gets an exact roof.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.roofs.roof_meshes import RoofMesh
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.extrude import aligned
from cityx.geometry.polygons import Rings, locate, polygons_of, rings_of, triangulate
from cityx.geometry.solids import GLAZED, ROOF, WALL

SNAP = 5e-3  # metres; an outline's point this close to a bend of the profile lies on it
STEEP = 3.0  # rise over run above which a strip of roof is an upright wall (sawtooth glazing)
BREAK = 0.002  # share of the width taken by the upright face of a sawtooth
_ARC = np.linspace(0.0, np.pi, 9)


def _sawtooth(teeth: int) -> tuple[tuple[float, float], ...]:
    points: list[tuple[float, float]] = []
    for tooth in range(teeth):
        points += [(tooth / teeth, 0.0), ((tooth + 1) / teeth - BREAK, 1.0)]
    return (*points, (1.0, 0.0))


def _row(gables: int) -> tuple[tuple[float, float], ...]:
    """Return a row of equal gables, valleys at the height of the eaves."""
    return tuple((point / (2 * gables), float(point % 2)) for point in range(2 * gables + 1))


def _pointed() -> tuple[tuple[float, float], ...]:
    """Return two arcs that meet in a ridge, as of a lamella roof."""
    lean = 0.7  # how far, in half widths, the centre of an arc lies beyond the ridge
    x = np.array([0.0, 0.05, 0.16, 0.34, 0.62, 1.0])
    height = np.sqrt((1 + lean) ** 2 - (1 + lean - x) ** 2)
    height /= height[-1]
    half = [(round(float(a) / 2, 9), round(float(b), 9)) for a, b in zip(x, height, strict=True)]
    return (*half, *((1 - a, b) for a, b in half[-2::-1]))


# Position across the ridge (0 to 1) and height (0 to 1) where the profile bends.
PROFILES: Mapping[str, tuple[tuple[float, float], ...]] = MappingProxyType(
    {
        "gabled": ((0, 0), (0.5, 1), (1, 0)),
        "skillion": ((0, 1), (1, 0)),
        "gambrel": ((0, 0), (0.2, 0.6), (0.5, 1), (0.8, 0.6), (1, 0)),
        "saltbox": ((0, 0.4), (0.35, 1), (1, 0)),
        "double_saltbox": ((0, 0), (0.35, 1), (0.65, 1), (1, 0)),
        "butterfly": ((0, 1), (0.5, 0), (1, 1)),
        "round": tuple(
            (round(0.5 - 0.5 * float(c), 9), round(float(s), 9))
            for c, s in zip(np.cos(_ARC), np.sin(_ARC), strict=True)
        ),
        "zollinger": _pointed(),
        # Two slopes that do not meet: a wall with lights stands between them.
        "gabled_height_moved": ((0, 0.15), (0.5 - BREAK, 1), (0.5, 0.6), (1, 0)),
        **{f"sawtooth_{teeth}": _sawtooth(teeth) for teeth in range(1, 13)},
        **{f"gabled_row_{gables}": _row(gables) for gables in range(2, 13)},
    }
)
# Those whose upright faces are of glass.
GLASS = ("sawtooth", "gabled_height_moved")


@dataclass(frozen=True)
class Frames:
    """How the profiles of n outlines lie: `bends` and `heights` are (n, k), padded with inf and 0.

    Attributes
    ----------
    angle
        (n,) radians, direction of the ridge; the profile runs to its left hand.
    bends
        (n, k) metres across the ridge.
    heights
        (n, k) absolute z.
    """

    angle: FloatArray
    bends: FloatArray
    heights: FloatArray

    def z_at(self, across: FloatArray, row: IntArray) -> FloatArray:
        """Height of the profile of outline `row` at positions across; planes run on beyond."""
        bends, heights = self.bends[row], self.heights[row]
        last = np.isfinite(bends).sum(axis=1) - 2
        k = np.clip((across[:, None] >= bends).sum(axis=1) - 1, 0, last)
        at = np.arange(len(across))
        t0, t1 = bends[at, k], bends[at, k + 1]
        z0, z1 = heights[at, k], heights[at, k + 1]
        return np.asarray(z0 + (z1 - z0) * (across - t0) / (t1 - t0))


def frames_of(
    rings: Rings, count: int, names: NDArray[np.str_], angle: FloatArray, eave: FloatArray,
    rise: FloatArray,
) -> Frames:  # fmt: skip
    """Stretch profiles over the width of their outlines."""
    part = rings.polygon[rings.ring_of_point]
    across = aligned(rings.points, part, angle)[:, 1]
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, part, across)
    np.maximum.at(high, part, across)
    absent = low > high
    low[absent], high[absent] = 0.0, 1.0
    size = max((len(PROFILES[name]) for name in set(names.tolist())), default=2)
    bends = np.full((count, size), np.inf)
    heights = np.zeros((count, size))
    for name in sorted(set(names.tolist())):
        rows = np.flatnonzero(names == name)
        profile = np.array(PROFILES[name], dtype=float)
        bends[rows, : len(profile)] = low[rows, None] + profile[:, 0] * (high - low)[rows, None]
        heights[rows, : len(profile)] = eave[rows, None] + profile[:, 1] * rise[rows, None]
    return Frames(angle, bends, heights)


def profile_roofs(
    polygons: NDArray[Any],
    names: NDArray[np.str_],
    angle: FloatArray,
    eave: FloatArray,
    rise: FloatArray,
) -> RoofMesh:
    """Lay roofs with a profile across a ridge on outlines.

    Parameters
    ----------
    polygons
        (n,) valid polygons; empty ones are passed over.
    names
        (n,) keys of `PROFILES`.
    angle
        (n,) radians from east, direction of the ridge. The profile runs from the right hand of
        that direction to the left; a skillion slopes down to the left.
    eave, rise
        (n,) eave and height of the roof above it; metres.
    """
    polygons = np.asarray(polygons, dtype=object)
    count = len(polygons)
    rings = rings_of(polygons)
    frames = frames_of(rings, count, names, angle, eave, rise)
    rings, local = _with_bends(rings, frames)
    part = rings.polygon[rings.ring_of_point]
    triangles, owner, strip = _strips(Rings(local, rings.start, rings.polygon, rings.hole), frames)
    z = frames.z_at(local[:, 1], part)
    run = frames.bends[owner, strip + 1] - frames.bends[owner, strip]
    slope = np.abs(frames.heights[owner, strip + 1] - frames.heights[owner, strip]) / run
    glass = np.array([name.startswith(GLASS) for name in names.tolist()], bool)
    upright = np.where(glass, GLAZED, WALL)[owner] if count else np.zeros(0, int)
    # A slope is upright when it is steep and short; a steep roof is a roof.
    role = np.where((slope > STEEP) & (run < 0.2), upright, ROOF).astype(np.int8)
    after = rings.following()
    level = np.abs(z - z[after]) < 1e-6
    none = np.zeros(0, np.int64)
    return RoofMesh(
        rings, z, level, np.zeros((0, 3)), none, triangles, owner, role, count,
        (triangles, owner),
    )  # fmt: skip


def _with_bends(rings: Rings, frames: Frames) -> tuple[Rings, FloatArray]:
    """Add a point to every edge where its profile bends; also return (along, across) of points."""
    part = rings.polygon[rings.ring_of_point]
    local = aligned(rings.points, part, frames.angle)
    bends = frames.bends[:, 1:-1]  # the ends of the profile are the ends of the outline
    inner = np.where(np.isfinite(frames.bends[:, 2:]), bends, np.inf)[part]  # (m, k)
    gap = np.abs(local[:, 1:] - inner)
    nearest = np.argmin(gap, axis=1) if inner.shape[1] else np.zeros(len(part), np.int64)
    if inner.shape[1]:
        rows = np.flatnonzero(gap[np.arange(len(part)), nearest] < SNAP)
        local[rows, 1] = inner[rows, nearest[rows]]
    after = rings.following()
    edge, point, place = [np.arange(len(part))], [rings.points], [local]
    share = [np.zeros(len(part))]
    for k in range(inner.shape[1]):
        level = inner[:, k]
        a, b = local[:, 1], local[after, 1]
        crossing = np.flatnonzero((a - level) * (b - level) < 0)
        at = (level - a)[crossing] / (b - a)[crossing]
        edge.append(crossing)
        share.append(at)
        new = rings.points[crossing] + at[:, None] * (rings.points[after] - rings.points)[crossing]
        along = local[crossing, 0] + at * (local[after, 0] - local[:, 0])[crossing]
        point.append(new)
        place.append(np.column_stack([along, level[crossing]]))
    edges = np.concatenate(edge)
    order = np.lexsort((np.concatenate(share), edges))
    ring = rings.ring_of_point[edges]
    size = np.bincount(ring, minlength=len(rings.polygon))
    start = np.concatenate([[0], np.cumsum(size)]).astype(np.int64)
    grown = Rings(np.concatenate(point)[order], start, rings.polygon, rings.hole)
    return grown, np.concatenate(place)[order]


def _strips(local: Rings, frames: Frames) -> tuple[IntArray, IntArray, IntArray]:
    """Cut outlines between the bends of their profiles.

    Returns
    -------
    triangles, owner, strip
        (t, 3) into the points of `local`, (t,) outline, (t,) number of the strip. Outlines in which
        a cut did not meet the points it should are left out.
    """
    count = len(frames.angle)
    shapes = polygons_of(local, count)
    strips = np.isfinite(frames.bends[:, 1:])  # (n, k - 1)
    strips &= ~shapely.is_empty(shapes)[:, None]
    row, strip = np.nonzero(strips)
    alone = strips.sum(axis=1)[row] == 1
    number = strips.sum(axis=1)[row]
    bounds = shapely.bounds(shapes)[row]
    below = np.where(strip == 0, bounds[:, 1] - 1.0, frames.bends[row, strip])
    above = np.where(strip == number - 1, bounds[:, 3] + 1.0, frames.bends[row, strip + 1])
    pieces = shapes[row]
    cut = np.flatnonzero(~alone)
    boxes = shapely.box(bounds[cut, 0] - 1.0, below[cut], bounds[cut, 2] + 1.0, above[cut])
    pieces[cut] = shapely.intersection(pieces[cut], boxes)
    single, of_piece = shapely.get_parts(pieces, return_index=True)
    # A cut through a point leaves points and lines beside the polygons.
    nested = shapely.get_type_id(single) > 3
    if nested.any():
        inner, of_single = shapely.get_parts(single[nested], return_index=True)
        of_piece = np.concatenate([of_piece[~nested], of_piece[nested][of_single]])
        single = np.concatenate([single[~nested], inner])
        order = np.argsort(of_piece, kind="stable")
        single, of_piece = single[order], of_piece[order]
    solid = (shapely.get_type_id(single) == 3) & (shapely.area(single) > 0)
    single, of_piece = shapely.orient_polygons(single[solid]), of_piece[solid]
    rings = rings_of(single)
    mesh = triangulate(single, rings)
    owner = row[of_piece[mesh.polygon]]
    of_point = row[of_piece[rings.polygon[rings.ring_of_point]]]
    index, found = locate(rings.points, of_point, local)
    bad = np.zeros(count, bool)
    bad[of_point[~found]] = True
    bad[row[of_piece[mesh.failed]]] = True
    good = ~bad[owner]
    return index[mesh.triangles[good]], owner[good], strip[of_piece[mesh.polygon[good]]]
