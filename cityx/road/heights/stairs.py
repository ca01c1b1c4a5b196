"""Stairs: ways of steps as treads with landings and handrails, wherever they climb."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.heights import WayHeights
from cityx.city.layout import Layout
from cityx.city.mesh import MeshBatch, concatenate, empty_batch
from cityx.city.terrain import Terrain
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths, locate, pack, pieces, values_along
from cityx.ground.structures import Bodies, beams
from cityx.road.heights.structures import body_batch, grounded_lines

EVERY = 1.5  # metres between the heights of stairs that lie on the ground
DEEP = 0.3  # metres that the foot of a tread reaches below its slope
SOLE = 0.02  # metres of the first tread above what it stands on, so that they never flicker
RAIL, RAIL_THICK = 0.9, 0.05  # metres from a tread up to the handrail; metres
RAIL_FREE = 0.06  # metres between the handrail and the side of the stairs, for the hand
POST_EVERY = 5  # steps
METAL = "metal_dark"

RISE = 0.16  # metres of a step outdoors; BS 8300 and DIN 18065 have 0.15 to 0.17
GOING = 0.32  # metres of a tread where the slope leaves the choice: 2 rises and a going are 0.64
FLIGHT = 16  # steps between landings, DIN 18065 has 18 at most
LEAST = 0.3  # metres of climb; less is a ramp


def build_stairs(layout: Layout, heights: WayHeights, terrain: Terrain) -> MeshBatch:
    """Build the stairs of all ways of steps.

    Parameters
    ----------
    layout, heights, terrain
        The city's, with heights solved.

    Returns
    -------
    stairs
        Closed bodies: treads of concrete, handrails of metal.
    """
    steps = (layout.roads["kind"] == "steps").to_numpy()
    lines, z, road = _profiles(layout, heights, terrain, steps)
    half = np.maximum(layout.roads["width"].to_numpy(float)[road], 1.2) / 2
    climbs, z, line = climbs_of(lines, z)
    treads = treads_of(climbs, z)
    if not len(treads.climb):
        return empty_batch()
    half = half[line][treads.climb]
    foot = values_along(climbs, z, treads.climb, treads.begin)
    return concatenate([
        body_batch(_treads(treads, foot, half), "treads"), *_handrails(treads, half)
    ])  # fmt: skip


def _profiles(
    layout: Layout, heights: WayHeights, terrain: Terrain, steps: NDArray[np.bool_]
) -> tuple[Polylines, FloatArray, IntArray]:
    """Return the pieces of the chosen ways off the ground and on it, heights, rows of the ways."""
    off = heights.take(np.flatnonzero((heights.edge < 0) & steps[heights.road]))
    rows = np.flatnonzero(steps)
    flat, own = shapely.get_parts(grounded_lines(layout, heights)[rows], return_index=True)
    good = shapely.length(flat) > 0
    low = pack(shapely.segmentize(shapely.force_2d(flat[good]), EVERY))
    start = np.concatenate([off.point_start, off.point_start[-1] + low.start[1:]])
    return (
        Polylines(np.concatenate([off.points, low.points]), start),
        np.concatenate([off.z, terrain.height_at(low.points)]),
        np.concatenate([off.road.astype(np.int64), rows[own[good]]]),
    )


def _treads(treads: Treads, foot: FloatArray, half: FloatArray) -> Bodies:
    """Raise a block under each tread from below the slope, (t,), at its riser."""
    lines = pieces(treads.climbs, treads.climb, treads.begin, treads.end)
    owner = lines.line_of_point()
    return beams(lines, foot[owner] - DEEP, treads.top[owner] + SOLE, -half, half)


def _handrails(treads: Treads, half: FloatArray) -> list[MeshBatch]:
    """Lead a rail up on both sides over the noses of the treads, on posts."""
    last = np.flatnonzero(np.r_[treads.climb[1:] != treads.climb[:-1], True])
    # The noses of each climb, and its upper end.
    climb = np.insert(treads.climb, last + 1, treads.climb[last])
    along = np.insert(treads.begin, last + 1, treads.end[last])
    nose = np.insert(treads.top, last + 1, treads.top[last]) + SOLE
    at, ahead = locate(treads.climbs, climb, along)
    start = np.searchsorted(climb, np.arange(treads.climbs.count + 1)).astype(np.int64)
    rails, wide = Polylines(at, start), half[last] - RAIL_FREE
    post = np.flatnonzero((np.arange(len(climb)) - start[climb]) % POST_EVERY == 0)
    ends = np.stack([at[post], at[post] + RAIL_THICK * ahead[post]], axis=1).reshape(-1, 2)
    posts, stand = Polylines(ends, 2 * np.arange(len(post) + 1)), np.repeat(nose[post], 2)
    made = []
    for name, near, far in (("left", -wide, RAIL_THICK - wide), ("right", wide - RAIL_THICK, wide)):
        rail = beams(rails, nose + RAIL - RAIL_THICK, nose + RAIL, near, far)
        leg = beams(posts, stand - DEEP, stand + RAIL - RAIL_THICK,
                    near[climb[post]], far[climb[post]])  # fmt: skip
        made += [
            body_batch(rail, f"handrail {name}", METAL),
            body_batch(leg, f"post {name}", METAL),
        ]
    return made


@dataclass(frozen=True)
class Treads:
    """Treads of stairs, t of them, in the order in which one climbs each of c climbs.

    Attributes
    ----------
    climbs
        The lines of the climbs, upwards.
    climb
        (t,) int64, the climb of each tread.
    begin, end
        (t,) float64, metres along the climb from the riser to the next one.
    top
        (t,) float64, height of the tread, metres.
    """

    climbs: Polylines
    climb: IntArray
    begin: FloatArray
    end: FloatArray
    top: FloatArray


def climbs_of(lines: Polylines, z: FloatArray) -> tuple[Polylines, FloatArray, IntArray]:
    """Cut lines where they turn from up to down, and turn all pieces upwards.

    Returns
    -------
    climbs, z, line
        The pieces that climb at least `LEAST`, heights at their points, the line of each.
    """
    owner, z = lines.line_of_point(), np.round(z, 3)
    first = np.flatnonzero(owner[1:] == owner[:-1])
    slope = np.sign(z[first + 1] - z[first])
    steep = np.flatnonzero(slope)
    first, slope = first[steep], slope[steep]
    turns = (owner[first][1:] != owner[first][:-1]) | (slope[1:] != slope[:-1])
    starts, ends = (np.ones(len(first), bool) for _ in range(2))
    starts[1:] = ends[:-1] = turns
    begin, end = first[starts], first[ends] + 1
    high = np.abs(z[end] - z[begin]) >= LEAST
    begin, end, up = begin[high], end[high], slope[starts][high] > 0
    size = end - begin + 1
    start = np.concatenate([[0], np.cumsum(size)]).astype(np.int64)
    rank = np.arange(int(start[-1])) - np.repeat(start[:-1], size)
    row = np.where(np.repeat(up, size), np.repeat(begin, size) + rank, np.repeat(end, size) - rank)
    return Polylines(lines.points[row], start), z[row], owner[begin]


def treads_of(climbs: Polylines, z: FloatArray) -> Treads:
    """Divide climbs into equal steps, with a landing after each flight where there is room.

    Parameters
    ----------
    climbs, z
        Lines that climb, and the (p,) heights of their points, never falling; see `climbs_of`.

    Returns
    -------
    treads
        They lie on the slope or above it.
    """
    along, length = arc_lengths(climbs)
    low = z[climbs.start[:-1]]
    rise = z[climbs.start[1:] - 1] - low
    count = np.maximum(np.rint(rise / RISE), 1).astype(np.int64)
    first = np.concatenate([[0], np.cumsum(count)])
    climb = np.repeat(np.arange(climbs.count), count)
    number = np.arange(len(climb)) - first[climb]
    step = (rise / count)[climb]
    riser = _where_at(climbs, z, along, climb, low[climb] + number * step)
    # A flight keeps together at its foot; what is left of its length is the landing.
    flight = first[climb] + number // FLIGHT * FLIGHT
    after = np.minimum(flight + FLIGHT, first[climb + 1])
    last = after == first[climb + 1]
    beyond = np.where(last, length[climb], riser[np.minimum(after, len(riser) - 1)])
    going = np.minimum((beyond - riser[flight]) / (after - flight), GOING)
    begin = riser[flight] + (np.arange(len(climb)) - flight) * going
    ends = np.r_[climb[1:] != climb[:-1], True] if len(climb) else np.zeros(0, bool)
    end = np.where(ends, length[climb], np.r_[begin[1:], 0.0])
    return Treads(climbs, climb, begin, end, low[climb] + (number + 1) * step)


def _where_at(
    climbs: Polylines, z: FloatArray, along: FloatArray, climb: IntArray, height: FloatArray
) -> FloatArray:
    """(k,) metres along climbs at which they reach heights."""
    # One sorted key over all climbs: heights of each are moved above those of the one before.
    low, high = z[climbs.start[:-1]], z[climbs.start[1:] - 1]
    shift = np.concatenate([[0.0], np.cumsum(high - low + 1.0)])[:-1] - low
    owner = climbs.line_of_point()
    key = z + shift[owner]
    wanted = height + shift[climb]
    after = np.clip(np.searchsorted(key, wanted, side="right"), climbs.start[climb] + 1,
                    climbs.start[climb + 1] - 1)  # fmt: skip
    gap = key[after] - key[after - 1]
    share = np.clip((wanted - key[after - 1]) / np.where(gap > 0, gap, 1.0), 0.0, 1.0)
    return np.asarray(along[after - 1] + share * (along[after] - along[after - 1]))
