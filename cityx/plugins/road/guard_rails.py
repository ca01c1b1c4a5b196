"""Guard rails along motorways and fast roads: beams of steel on posts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import MeshBatch
from cityx.geometry.identity import hash_ids
from cityx.geometry.polylines import (
    Polylines,
    arc_lengths,
    bends,
    every,
    locate,
    pack,
    to_linestrings,
)
from cityx.geometry.polylines import pieces as cut_out
from cityx.plugins.nature.barriers import joined_by_id, sweep
from cityx.plugins.nature.pieces import Pieces, pieces, with_pieces
from cityx.protocol import Port, action, has_network

ACTION = "road/guard_rails-v1"
KINDS = ("motorway", "motorway_link", "trunk", "trunk_link")
BEYOND = 0.7  # metres from the carriageway to the beam
CLEAR = 0.5  # metres that other carriageways keep free of beams
END = 4.0  # metres from a junction at which a beam begins
SHORTEST = 8.0  # metres
STEP = 4.0  # metres; beams follow the terrain by pieces of this length at most
POSTS = 4.0  # metres between posts (EN 1317 systems stand at 2 to 4 m)
SLACK = 0.02  # metres by which a beam may leave its line
# Two ridges, their lower and upper edges in metres above the ground: the W of the beam.
RIDGES = ((0.44, 0.60), (0.60, 0.76))
HALF_BEAM = 0.045  # metres
FINE = 3  # level of detail from which ridges have flanks and a back; below they are wedges
LAYER = "guard_rail_posts"


@action(
    ACTION,
    limits=["Beams end without a terminal.", "Runs at level of detail 2 and above."],
    requires=("layout", has_network()),
    takes=(Port("network", "line", role="road_network"),),
    gives=(Port("guard_rails", "complex_geometry", "guard_rails"),),
    labels=("guard rail", "crash barrier"),
)
def guard_rails(city: City) -> City:
    """Set guard rails along both sides of motorways and other fast roads without walks."""
    network = city.network
    if city.lod < 2 or network is None or not network.edge_count:
        return city
    table = city.layout.roads.iloc[network.edge_road]
    walked = table["sidewalk_left"].to_numpy() + table["sidewalk_right"].to_numpy() > 0
    deck = table["bridge"].to_numpy(bool) | table["tunnel"].to_numpy(bool)
    fast = table["kind"].isin(KINDS).to_numpy() & ~walked & ~deck
    lines = Polylines(network.points, network.point_start)
    begin = network.trim[:, 0] + END
    end = arc_lengths(lines)[1] - network.trim[:, 1] - END
    edge = np.flatnonzero(fast & (end - begin > SHORTEST))
    if not len(edge):
        return city
    middle = to_linestrings(cut_out(lines, edge, begin[edge], end[edge]))
    offset = network.half_width[edge] + BEYOND
    beams = np.concatenate([shapely.offset_curve(middle, side * offset) for side in (1.0, -1.0)])
    beams, row = _free_of_roads(city, lines, beams)
    if not len(beams):
        return city
    both = np.concatenate([edge, edge])[row]
    ids = hash_ids(0, ACTION, network.edge_id[both], np.arange(len(both)))
    order = np.argsort(ids, kind="stable")
    lines, ids = pack(shapely.segmentize(beams[order], STEP)), ids[order]
    city = with_pieces(city, LAYER, *_posts(city, lines, ids))
    return replace(city, scene=city.scene.with_mesh("guard_rails", _mesh(city, lines, ids)))


def _free_of_roads(
    city: City, lines: Polylines, beams: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Cut beams where another carriageway passes, and at the site."""
    network = city.network
    assert network is not None
    centre = to_linestrings(lines)
    beam, other = shapely.STRtree(centre).query(
        beams, predicate="dwithin", distance=float(network.half_width.max()) + CLEAR
    )
    strips = shapely.buffer(centre, network.half_width + CLEAR, cap_style="square")
    cut = shapely.intersection(beams, shapely.box(*city.layout.extent))
    used, first = np.unique(beam, return_index=True)
    groups = np.split(strips[other], first[1:]) if len(used) else []
    for number, group in zip(used.tolist(), groups, strict=True):
        cut[number] = shapely.difference(cut[number], shapely.union_all(group))
    parts, row = shapely.get_parts(shapely.line_merge(cut), return_index=True)
    kept = (shapely.get_type_id(parts) == 1) & (shapely.length(parts) > SHORTEST)
    return parts[kept], row[kept]


def _mesh(city: City, lines: Polylines, ids: NDArray[np.uint64]) -> MeshBatch:
    """Sweep the ridges of the beams: one object per beam."""
    ground = city.terrain.height_at(lines.points) + KERB_HEIGHT
    kept = bends(lines, np.column_stack([lines.points, ground]), SLACK)
    start = np.concatenate([[0], np.cumsum(kept)])[lines.start]
    lines, ground = Polylines(lines.points[kept], start), ground[kept]
    white = np.ones((lines.count, 3))
    size = np.column_stack([np.full(lines.count, HALF_BEAM), np.ones(lines.count)])
    parts = [
        sweep(lines, ids, ground, _ridge(low, high, city.lod), size, "metal_grey", white)
        for low, high in RIDGES
    ]
    return joined_by_id(parts)


def _ridge(low: float, high: float, lod: int) -> NDArray[np.float64]:
    """Profile of a ridge from its lower to its upper edge, metres above the ground."""
    bulge = (high - low) / 4
    if lod < FINE:
        return np.array([[-0.2, low], [1.0, low + 2 * bulge], [-0.2, high]])
    return np.array([[0.2, low], [1.0, low + bulge], [1.0, high - bulge], [0.2, high],
                     [-0.2, high], [-0.2, low]])  # fmt: skip


def _posts(
    city: City, lines: Polylines, ids: NDArray[np.uint64]
) -> tuple[Pieces, NDArray[np.float64]]:
    """Stand posts under the beams; returns them with the heights of their feet."""
    line, along = every(arc_lengths(lines)[1], POSTS, 0.5)
    foot, ahead = locate(lines, line, along)
    own = hash_ids(0, LAYER, ids[line], np.arange(len(line)) - np.searchsorted(line, line))
    posts = pieces("guard_rail_post", foot, own, np.arctan2(ahead[:, 1], ahead[:, 0]))
    order = np.argsort(own, kind="stable")
    return posts.take(order), city.terrain.height_at(foot[order]) + KERB_HEIGHT
