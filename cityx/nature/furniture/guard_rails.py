"""Guard rails: beams of steel along fast roads, pipes between kerb and walk."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray, IntArray
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
from cityx.geometry.scatter import cell_ids
from cityx.ground.pieces import Pieces, join_pieces, pieces, walk_rims, with_pieces
from cityx.ground.standing import WALKED
from cityx.ground.street_rules import CLEAR as FREE_WALK
from cityx.ids import hash_ids
from cityx.nature.furniture.corner_kerbs import behind, corner_kerbs, ids_of_kerbs
from cityx.nature.land.barriers import joined_by_id, sweep
from cityx.places.profiles import profile_of
from cityx.protocol import Port, action, has_network
from cityx.road.surface.kerbs import edge_lengths

ACTION = "road/guard_rails-v1"
KINDS = ("motorway", "motorway_link", "trunk", "trunk_link")
END = 4.0  # metres from a junction at which a beam begins
SHORTEST = 8.0  # metres
STEP = 4.0  # metres; beams follow the terrain by pieces of this length at most
PLACE = 0.1  # metres in which places name rails
SLACK = 0.02  # metres by which a beam may leave its line
FINE = 3  # level of detail from which ridges have flanks and a back; below they are wedges
LAYER = "guard_rail_posts"
MAIN = ("primary", "secondary", "tertiary")
AT_JUNCTION = 14.0  # metres of pipe on both sides of the junctions of other streets
ZEBRA = 6.0  # metres behind the junction that a crossing and its dropped kerb keep open
BEND, LEAST_CORNER = 0.5, 3.0  # metres between the points of a pipe round a corner, and of one
PIECE, OPENING = 12.0, 2.0  # metres of pipe along main roads, and between two of them


@dataclass(frozen=True)
class Rail:
    """How a rail is built, metres.

    Attributes
    ----------
    ridges
        Lower and upper edges above the ground of what runs along it.
    half
        Half its thickness.
    beyond
        From the carriageway to its middle.
    clear
        What other carriageways keep free of it.
    posts
        Between posts (EN 1317 systems stand at 2 to 4 m).
    """

    ridges: tuple[tuple[float, float], ...]
    half: float
    beyond: float
    clear: float
    posts: float


BEAM = Rail(((0.44, 0.60), (0.60, 0.76)), 0.045, 0.7, 0.5, 4.0)  # two ridges, the W of the beam
PIPE = Rail(((0.40, 0.46), (0.74, 0.80)), 0.03, 0.35, 0.25, 2.0)


@action(
    ACTION,
    limits=["Beams end without a terminal.", "Runs at level of detail 2 and above."],
    requires=("layout", has_network()),
    after=("road/ground-v1",),
    takes=(Port("network", "line", role="road_network"),),
    gives=(Port("guard_rails", "complex_geometry", "guard_rails"),),
    labels=("guard rail", "crash barrier"),
)
def guard_rails(city: City) -> City:
    """Set guard rails along fast roads without walks, and pipes along walks where a place has them.

    Pipes stand along main roads, at the junctions of other streets and round their corners, where
    the walk is wide enough, open at crossings.
    """
    network = city.network
    if city.lod < 2 or network is None or not network.edge_count:
        return city
    found = [_lines(city, BEAM, *_beams(city))]
    if profile_of(city.frame).streets.guard_pipes:
        found += [_lines(city, PIPE, *_pipes(city)), _corners(city)]
    found = [rails for rails in found if rails.lines.count]
    if not found:
        return city
    posts = join_pieces([_posts(rails) for rails in found])
    posts = posts.take(np.argsort(posts.id, kind="stable"))
    feet = city.terrain.height_at(posts.xy) + KERB_HEIGHT
    city = with_pieces(city, LAYER, posts, feet)
    ridges = [ridge for rails in found for ridge in _ridges(city, rails)]
    return replace(city, scene=city.scene.with_mesh("guard_rails", joined_by_id(ridges)))


@dataclass(frozen=True)
class _Rails:
    """Rails of one kind: their middles, and an id for each."""

    rail: Rail
    lines: Polylines
    ids: NDArray[np.uint64]


def _lines(
    city: City, rail: Rail, edge: IntArray, side: IntArray, begin: FloatArray, end: FloatArray
) -> _Rails:
    """Lead rails beside stretches of edges, on their left (side 1) or right (-1)."""
    network = city.network
    assert network is not None
    lines = network.lines
    long = end - begin > SHORTEST
    edge, side, begin, end = edge[long], side[long], begin[long], end[long]
    none = _Rails(rail, Polylines(np.zeros((0, 2)), np.zeros(1, np.int64)), np.zeros(0, np.uint64))
    if not len(edge):
        return none
    middle = to_linestrings(cut_out(lines, edge, begin, end))
    beams = shapely.offset_curve(middle, side * (network.half_width[edge] + rail.beyond))
    beams, row = _free_of_roads(city, lines, beams, rail.clear)
    if not len(beams):
        return none
    # Named by where its middle lies, a rail is the same whatever others there are.
    middles = shapely.get_coordinates(shapely.line_interpolate_point(beams, 0.5, normalized=True))
    place = cell_ids(np.rint(middles / PLACE).astype(np.int64))
    ids = hash_ids(0, ACTION, network.edge_id[edge[row]], place)
    order = np.argsort(ids, kind="stable")
    return _Rails(rail, pack(shapely.segmentize(beams[order], STEP)), ids[order])


def _beams(city: City) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """Edges of fast roads: (k,) edge, side, and metres along it where the rail begins and ends."""
    network = city.network
    assert network is not None
    table = city.layout.roads.iloc[network.edge_road]
    walked = table["sidewalk_left"].to_numpy() + table["sidewalk_right"].to_numpy() > 0
    deck = table["bridge"].to_numpy(bool) | table["tunnel"].to_numpy(bool)
    edge = np.flatnonzero(table["kind"].isin(KINDS).to_numpy() & ~walked & ~deck)
    begin = network.trim[:, 0] + END
    end = edge_lengths(network) - network.trim[:, 1] - END
    both = np.concatenate([edge, edge])
    return both, np.repeat([1, -1], len(edge)), begin[both], end[both]


def _pipes(city: City) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """Stretches of walks with pipes, as of `_beams`."""
    network = city.network
    assert network is not None
    table = city.layout.roads.iloc[network.edge_road]
    flat = ~(table["bridge"].to_numpy(bool) | table["tunnel"].to_numpy(bool))
    main = table["kind"].isin(MAIN).to_numpy()
    margin = network.trim + np.where(network.crossing, ZEBRA, END / 2)
    low, high = margin[:, 0], edge_lengths(network) - margin[:, 1]
    joint = network.node_degree[network.edge_nodes] >= 3
    found = []
    for side, column in ((1, "sidewalk_left"), (-1, "sidewalk_right")):
        wide = flat & (table[column].to_numpy(float) >= PIPE.beyond + PIPE.half + FREE_WALK)
        along = np.flatnonzero(wide & main & (high > low))
        which, middle = every((high - low)[along], PIECE + OPENING, PIECE / 2)
        along = along[which]
        place = low[along] + middle
        found.append((along, place - PIECE / 2, place + PIECE / 2, side))
        for end in (0, 1):
            near = np.flatnonzero(wide & ~main & joint[:, end] & (high - low > 2 * AT_JUNCTION))
            from_ = low[near] if end == 0 else high[near] - AT_JUNCTION
            found.append((near, from_, from_ + AT_JUNCTION, side))
    edge, begin, end_ = (np.concatenate([group[k] for group in found]) for k in range(3))
    return edge, np.concatenate([np.full(len(g[0]), g[3]) for g in found]), begin, end_


def _corners(city: City) -> _Rails:
    """Lead pipes round the corners of junctions, where their kerbs are not lowered."""
    points, start = np.zeros((0, 2)), np.zeros(1, np.int64)
    if city.ground is None:
        return _Rails(PIPE, Polylines(points, start), np.zeros(0, np.uint64))
    kerbs = corner_kerbs(city.ground)
    row, foot, out, room = behind(city.ground, kerbs, walk_rims(city.ground), BEND, BEND)
    points = foot + PIPE.beyond * out
    fits = room >= PIPE.beyond + PIPE.half + FREE_WALK
    fits &= city.ground.on(points, *WALKED)
    # Each run of places that fit is a pipe.
    run = np.cumsum(np.r_[True, (np.diff(row) != 0) | (fits[1:] != fits[:-1])][: len(row)]) - 1
    size = np.bincount(run[fits], minlength=int(run.max(initial=-1)) + 1)
    fits &= (size * BEND)[run] >= LEAST_CORNER
    rows = np.flatnonzero(fits)
    begin = np.flatnonzero(np.r_[True, np.diff(run[rows]) != 0][: len(rows)])
    first = rows[begin]
    nth = first - np.searchsorted(row, row[first])
    ids = hash_ids(0, f"{ACTION}/corner", ids_of_kerbs(kerbs)[row[first]], nth)
    return _Rails(PIPE, Polylines(points[rows], np.append(begin, len(rows))), ids)


def _free_of_roads(
    city: City, lines: Polylines, beams: NDArray[Any], clear: float
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Cut beams where another carriageway passes, and at the site."""
    network = city.network
    assert network is not None
    centre = to_linestrings(lines)
    beam, other = shapely.STRtree(centre).query(
        beams, predicate="dwithin", distance=float(network.half_width.max()) + clear
    )
    strips = shapely.buffer(centre, network.half_width + clear, cap_style="square")
    cut = shapely.intersection(beams, shapely.box(*city.layout.extent))
    used, first = np.unique(beam, return_index=True)
    groups = np.split(strips[other], first[1:]) if len(used) else []
    for number, group in zip(used.tolist(), groups, strict=True):
        cut[number] = shapely.difference(cut[number], shapely.union_all(group))
    parts, row = shapely.get_parts(shapely.line_merge(cut), return_index=True)
    kept = (shapely.get_type_id(parts) == 1) & (shapely.length(parts) > SHORTEST)
    return parts[kept], row[kept]


def _ridges(city: City, rails: _Rails) -> list[MeshBatch]:
    """Sweep the ridges of rails, one object per rail."""
    lines = rails.lines
    ground = city.terrain.height_at(lines.points) + KERB_HEIGHT
    kept = bends(lines, np.column_stack([lines.points, ground]), SLACK)
    start = np.concatenate([[0], np.cumsum(kept)])[lines.start]
    lines, ground = Polylines(lines.points[kept], start), ground[kept]
    white = np.ones((lines.count, 3))
    size = np.column_stack([np.full(lines.count, rails.rail.half), np.ones(lines.count)])
    return [
        sweep(lines, rails.ids, ground, _ridge(low, high, city.lod), size, "metal_grey", white)
        for low, high in rails.rail.ridges
    ]


def _ridge(low: float, high: float, lod: int) -> FloatArray:
    """Profile of a ridge from its lower to its upper edge, metres above the ground."""
    bulge = (high - low) / 4
    if lod < FINE:
        return np.array([[-0.2, low], [1.0, low + 2 * bulge], [-0.2, high]])
    return np.array([[0.2, low], [1.0, low + bulge], [1.0, high - bulge], [0.2, high],
                     [-0.2, high], [-0.2, low]])  # fmt: skip


def _posts(rails: _Rails) -> Pieces:
    """Stand posts under rails."""
    line, along = every(arc_lengths(rails.lines)[1], rails.rail.posts, 0.5)
    foot, ahead = locate(rails.lines, line, along)
    nth = np.arange(len(line)) - np.searchsorted(line, line)
    own = hash_ids(0, LAYER, rails.ids[line], nth)
    return pieces("guard_rail_post", foot, own, np.arctan2(ahead[:, 1], ahead[:, 0]))
