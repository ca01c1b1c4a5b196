"""Guard rails along motorways and fast roads: beams of steel on posts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import MeshBatch, concatenate
from cityx.geometry.identity import hash_ids
from cityx.geometry.polylines import (
    Polylines,
    arc_lengths,
    every,
    locate,
    pack,
    pieces,
    to_linestrings,
)
from cityx.plugins.nature.barriers import sweep
from cityx.protocol import Port, action, has_network

ACTION = "road/guard_rails-v1"
KINDS = ("motorway", "motorway_link", "trunk", "trunk_link")
BEYOND = 0.7  # metres from the carriageway to the beam
CLEAR = 0.5  # metres that other carriageways keep free of beams
END = 4.0  # metres from a junction at which a beam begins
SHORTEST = 8.0  # metres
STEP = 4.0  # metres; beams follow the terrain by pieces of this length at most
POSTS = 4.0  # metres between posts (EN 1317 systems stand at 2 to 4 m)
DEEP = 0.4  # metres a post reaches into the ground
# Two ridges, their lower and upper edges in metres above the ground: the W of the beam.
RIDGES = ((0.44, 0.60), (0.60, 0.76))
HALF_BEAM, HALF_POST = 0.045, 0.05  # metres
_POST = np.array([[1.0, -DEEP], [1.0, 1.0], [-1.0, 1.0], [-1.0, -DEEP]])[::-1]


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
    middle = to_linestrings(pieces(lines, edge, begin[edge], end[edge]))
    offset = network.half_width[edge] + BEYOND
    beams = np.concatenate([shapely.offset_curve(middle, side * offset) for side in (1.0, -1.0)])
    beams, row = _free_of_roads(city, lines, beams)
    if not len(beams):
        return city
    both = np.concatenate([edge, edge])[row]
    ids = hash_ids(0, ACTION, network.edge_id[both], np.arange(len(both)))
    order = np.argsort(ids, kind="stable")
    mesh = _mesh(city, pack(shapely.segmentize(beams[order], STEP)), ids[order])
    return replace(city, scene=city.scene.with_mesh("guard_rails", mesh))


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
    """Sweep the ridges of the beams and stand posts under them: one object per beam."""
    ground = city.terrain.height_at(lines.points) + KERB_HEIGHT
    white = np.ones((lines.count, 3))
    size = np.column_stack([np.full(lines.count, HALF_BEAM), np.ones(lines.count)])
    parts = []
    for low, high in RIDGES:
        bulge = (high - low) / 4
        ridge = np.array([[0.2, low], [1.0, low + bulge], [1.0, high - bulge], [0.2, high],
                          [-0.2, high], [-0.2, low]])  # fmt: skip
        parts.append(sweep(lines, ids, ground, ridge, size, "metal_grey", white))
    line, along = every(arc_lengths(lines)[1], POSTS, 0.5)
    foot, ahead = locate(lines, line, along)
    ends = np.stack([foot - HALF_POST * ahead, foot + HALF_POST * ahead], axis=1).reshape(-1, 2)
    short = Polylines(ends, np.arange(0, len(ends) + 1, 2))
    under = np.repeat(city.terrain.height_at(foot) + KERB_HEIGHT, 2)
    tall = np.column_stack([np.full(len(line), HALF_POST), np.full(len(line), RIDGES[1][0])])
    parts.append(sweep(short, ids[line], under, _POST, tall, "metal_grey", np.ones((len(line), 3))))
    joined = concatenate(parts)
    joined = joined.take(np.argsort(joined.object_id, kind="stable"))
    own, first = np.unique(joined.object_id, return_index=True)
    return replace(
        joined, object_id=own,
        vertex_start=np.append(joined.vertex_start[first], joined.vertex_start[-1]),
        face_start=np.append(joined.face_start[first], joined.face_start[-1]),
    )  # fmt: skip
