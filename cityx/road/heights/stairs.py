"""Stairs: ways of steps as treads with landings and handrails, wherever they climb."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.heights import WayHeights
from cityx.city.layout import Layout
from cityx.city.mesh import MeshBatch, concatenate, empty_batch
from cityx.city.terrain import Terrain
from cityx.geometry.polylines import Polylines, locate, pack, pieces, values_along
from cityx.geometry.treads import Treads, climbs_of, treads_of
from cityx.ground.structures import Bodies, beams
from cityx.road.heights.structures import body_batch, grounded_lines

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

EVERY = 1.5  # metres between the heights of stairs that lie on the ground
DEEP = 0.3  # metres that the foot of a tread reaches below its slope
SOLE = 0.02  # metres of the first tread above what it stands on, so that they never flicker
RAIL, RAIL_THICK = 0.9, 0.05  # metres from a tread up to the handrail; metres
RAIL_FREE = 0.06  # metres between the handrail and the side of the stairs, for the hand
POST_EVERY = 5  # steps
METAL = "metal_dark"


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
