"""Crosswalks: where people cross roadways, with bars, along footways, or at corners without."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import ROADWAY, Ground
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.signals import Signals
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import (
    Polylines,
    arc_lengths,
    locate,
    pack,
    segment_bounds,
    segments,
    to_linestrings,
)
from cityx.geometry.triangle_cells import near_boxes
from cityx.ground.drape import LOWERED
from cityx.ground.walking.mapped_crossings import barred_crossings, mapped_crossings
from cityx.ids import hash_ids
from cityx.system.remembered import Remembered

FOOTWAYS = (
    "sidewalk", "furnishing", "edging", "ramp", "kerb", "kerb_dropped", "tactile", "tactile_pale",
    "tactile_buff", "tactile_red", "landing", "guide_strip", "plaza", "path", "trail", "frontage",
)  # fmt: skip
# Land beside a roadway that people walk on where there is no pavement.
VERGES = ("block", "courtyard", "gravel", "grass", "meadow", "park", "bare", "sand", "farmland",
          "wood")  # fmt: skip
PATHS = ("footway", "path", "pedestrian", "cycleway", "steps")
FAST = ("motorway", "trunk", "motorway_link", "trunk_link")  # crossed by bars and paths alone
BAR = (0.35, 0.7)  # metres of the width of a bar of a zebra
BAR_LENGTH = (2.0, 4.6)  # metres, along the road
APART = 3.0  # metres along a street between two crosswalks
ASIDE = 6.0  # metres from an end of bars, or lowered kerbs, within which people walk there
CORNER = 1.5  # metres from a junction's mouth to the middle of a crosswalk without bars
INWARD, LOOK = (-4.0, 7.0), 0.4  # metres from there on that lowered kerbs are looked for, and steps
LONGER = 1e6  # metres; than any edge
AT_ONCE = 9  # places on a way out of a roadway that are looked at together; most rims lie there
NEAR_ENOUGH = 0.01  # metres, more than rounding moves a place
FINER = 0.1  # metres between the places looked at there; a kerb is wider
NEARER = 0.1  # metres by which a kerb may be nearer to the rim of another street
FLARED = 3.0  # metres by which kerbs curve away there at most
USUAL_DEPTH = 2.4  # metres along the road that such a one takes
WIDEST_BARE = 12.0  # metres of roadway that are crossed without bars or lowered kerbs
ROW_DEPTH = (1.5, 5.5)  # metres along the road between the two rows of marks beside a crossing
ROW_SPACE = 4.5  # metres along the road from one mark to the next of the same crossing at most
LEAST_MARKS = 6
BEYOND = 5.0  # metres past the rim of the roadway that the other side is looked for
FAR_BEYOND = 16.0  # the same where a crossing leads onto another roadway
STEP = 0.2  # metres between the places looked at
INTO = 0.4  # metres that a crosswalk reaches into the walks it joins
LONGEST = 18.0  # metres; a path that runs longer on a roadway shares it
HEAD_REACH = 4.0  # metres from the middle of a crosswalk to that of what a head rules
NEARBY = 8.0  # metres, of the cells by which faces of a roadway near a path are found
ON_GROUND = 0.05  # metres by which an edge of the ground may be off it


@dataclass(frozen=True)
class Crosswalks:
    """Places where people cross, c of them.

    Attributes
    ----------
    id
        (c,) uint64, stable.
    ends
        (c, 2, 2) float64, metres: where the crosswalk begins and ends, on the walks it joins.
    depth
        (c,) float64, metres across the way that people go.
    edge
        (c,) int64, edge of the road network that is crossed, -1 where a path tells of it alone.
    marked
        (c,) bool, whether it has bars.
    lowered
        (c,) bool, whether it has none but lies where kerbs are lowered on both sides.
    """

    id: NDArray[np.uint64]
    ends: FloatArray
    depth: FloatArray
    edge: IntArray
    marked: BoolArray
    lowered: BoolArray

    @property
    def count(self) -> int:
        """Number of crosswalks."""
        return len(self.depth)

    @property
    def length(self) -> FloatArray:
        """(c,) metres from end to end."""
        return np.asarray(np.hypot(*(self.ends[:, 1] - self.ends[:, 0]).T))

    @property
    def standing(self) -> IntArray:
        """(c,) the higher the better known: guesses 0, paths of the map 1, kerbs 2, bars 3."""
        return np.where(self.marked, 3, np.where(self.lowered, 2, self.edge < 0)).astype(np.int64)

    def regions(self) -> NDArray[Any]:
        """(c,) polygons."""
        ahead = (self.ends[:, 1] - self.ends[:, 0]) / np.maximum(self.length, 1e-9)[:, None]
        side = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * (self.depth / 2)[:, None]
        a, b = self.ends[:, 0], self.ends[:, 1]
        return np.asarray(
            shapely.polygons(np.stack([a - side, b - side, b + side, a + side], axis=1)), object
        )

    def take(self, rows: BoolArray | IntArray) -> Crosswalks:
        """Return some of them."""
        return Crosswalks(**{name: getattr(self, name)[rows] for name in self.__annotations__})


@dataclass(frozen=True)
class _Candidates:
    """Lines across edges along which the walks on both sides are looked for."""

    edge: IntArray
    along: FloatArray
    depth: FloatArray
    marked: BoolArray
    lowered: BoolArray
    told: BoolArray  # by bars or by the map

    def take(self, rows: IntArray) -> _Candidates:
        """Return some of them."""
        return _Candidates(**{name: getattr(self, name)[rows] for name in self.__annotations__})


def crosswalks_of(ground: Ground, layout: Layout, network: RoadNetwork) -> Crosswalks:
    """Find the crosswalks of a city on its finished ground.

    Parameters
    ----------
    ground
        The ground; bars of zebras are found among its faces.
    layout
        Paths that cross roadways.
    network
        The streets.

    Returns
    -------
    crosswalks
        Those with bars, those of paths, and at junctions some without: over streets whose kerbs are
        lowered on both sides, and over narrow ones, and those without kerbs, in any case. Where two
        would lie within `APART` metres, or their ends within `ASIDE` of those of one with bars or
        lowered kerbs, the better known is kept. Those of the last city are remembered.
    """
    return _LAST.get(lambda: _found(ground, layout, network), [ground, layout, network])


_LAST: Remembered[Crosswalks] = Remembered()


def _found(ground: Ground, layout: Layout, network: RoadNetwork) -> Crosswalks:
    parts = [_across(_candidates(ground, layout, network), ground, network)]
    parts.append(_along_paths(ground, layout))
    joined = Crosswalks(
        *(np.concatenate([getattr(p, name) for p in parts]) for name in Crosswalks.__annotations__)
    )
    joined = joined.take(~_barred(joined, layout, network))
    return joined.take(_apart(joined))


def _barred(found: Crosswalks, layout: Layout, network: RoadNetwork) -> BoolArray:
    """(c,) whether a crosswalk lies where the map says that nobody may cross."""
    barred = barred_crossings(layout, network.lines)
    middle = shapely.points(found.ends.mean(axis=1))
    there = shapely.points(locate(network.lines, barred.edge, barred.along)[0])
    near = np.zeros(found.count, bool)
    near[shapely.STRtree(there).query(middle, "dwithin", APART)[0]] = True
    own = np.flatnonzero(found.edge >= 0)
    at = shapely.line_locate_point(to_linestrings(network.lines)[found.edge[own]], middle[own])
    near[own] |= _near(barred.edge, barred.along, found.edge[own], at)
    return near


def _candidates(ground: Ground, layout: Layout, network: RoadNetwork) -> _Candidates:
    lines = network.lines
    level, grounded = _on_ground(network), _grounded_parts(network)
    edge, along, depth = (
        np.concatenate(columns)
        for columns in zip(
            _zebras(ground, network, lines, grounded), _rows(ground, lines, grounded),
            strict=True,
        )
    )  # fmt: skip
    kind = layout.roads["kind"].to_numpy().astype(str)[network.edge_road]
    slow = ~np.isin(kind, FAST) & level
    length = arc_lengths(lines)[1]
    room = length - network.trim.sum(axis=1) > 2 * (CORNER + USUAL_DEPTH)
    joint = network.node_degree[network.edge_nodes] >= 3
    corner, end = np.nonzero(joint & (slow & room)[:, None])
    back = network.trim[corner, end] + CORNER
    inward = np.where(end == 0, -1.0, 1.0)
    there = np.where(end == 0, back, length[corner] - back)
    told = _near(edge, along, corner, there)
    corner, there, inward = corner[~told], there[~told], inward[~told]
    shift = _to_lowered(ground, network, lines, corner, there, inward)
    flush = not any(len(ground.triangles_of(stone)) for stone in ("kerb", "kerb_dropped"))
    narrow = 2 * network.half_width[corner] <= WIDEST_BARE
    kept = narrow | np.isfinite(shift) | flush
    corner, there, inward, shift = corner[kept], there[kept], inward[kept], shift[kept]
    there += inward * np.nan_to_num(shift)
    sure = np.isfinite(shift)
    seen = np.concatenate([edge, corner[sure]]), np.concatenate([along, there[sure]])
    more, at = _unpainted(layout, network, *seen, grounded)
    kept = sure | ~_near(more, at, corner, there)  # what the map tells goes before a guess
    corner, there, sure = corner[kept], there[kept], sure[kept]
    painted, lowered = len(edge), np.r_[np.zeros(len(edge), bool), sure]
    edge, along = np.concatenate([edge, corner, more]), np.concatenate([along, there, at])
    count = len(edge)
    return _Candidates(
        edge, along, np.concatenate([depth, np.full(count - painted, USUAL_DEPTH)]),
        np.arange(count) < painted, np.concatenate([lowered, np.zeros(len(more), bool)]),
        (np.arange(count) < painted) | (np.arange(count) >= count - len(more)),
    )  # fmt: skip


def _unpainted(
    layout: Layout, network: RoadNetwork, edge: IntArray, along: FloatArray, grounded: NDArray[Any]
) -> tuple[IntArray, FloatArray]:
    """Return the crossings of the map at which there are none yet: edge, and metres along it."""
    mapped = mapped_crossings(layout, network.lines)
    middle = shapely.points(locate(network.lines, mapped.edge, mapped.along)[0])
    kept = shapely.dwithin(grounded[mapped.edge], middle, NEAR_ENOUGH)
    kept &= ~_near(edge, along, mapped.edge, mapped.along)
    # One within a junction is where its arm is crossed.
    length = arc_lengths(network.lines)[1][mapped.edge]
    back = np.column_stack([mapped.along, length - mapped.along])
    kept &= ~((back < network.trim[mapped.edge]) & network.crossing[mapped.edge]).any(axis=1)
    return mapped.edge[kept], mapped.along[kept]


def _near(edge: IntArray, along: FloatArray, other: IntArray, there: FloatArray) -> BoolArray:
    """(n,) whether others, places on edges as well, have one of places within `ASIDE` metres."""
    found = np.zeros(len(other), bool)
    if not len(edge):
        return found
    axis = np.sort(edge * LONGER + along)  # edges one behind the other
    wanted = other * LONGER + there
    at = np.searchsorted(axis, wanted)
    for beside in (np.maximum(at - 1, 0), np.minimum(at, len(axis) - 1)):
        found |= np.abs(axis[beside] - wanted) <= ASIDE
    return found


def _to_lowered(
    ground: Ground, network: RoadNetwork, lines: Polylines, edge: IntArray, along: FloatArray,
    inward: FloatArray,
) -> FloatArray:  # fmt: skip
    """Return metres towards junctions to where kerbs are lowered on both sides, NaN for nowhere."""
    from scipy.spatial import cKDTree

    shift = np.full(len(edge), np.nan)
    stones = ground.vertices[ground.triangles_of("kerb_dropped")]
    if not len(stones) or not len(edge):
        return shift
    reach = float(network.half_width.max()) + INWARD[1]
    # The nearest stone tells it; there are hundreds within reach.
    nearest = cKDTree(stones.mean(axis=1)).query(
        locate(lines, edge, along)[0], distance_upper_bound=np.nextafter(reach, np.inf)
    )[0]
    near = np.flatnonzero(np.isfinite(nearest))
    half = network.half_width[edge[near]]
    ways = np.arange(INWARD[0], INWARD[1] + LOOK, LOOK)
    row, way = (each.ravel() for each in np.indices((len(near), len(ways))))
    spot, ahead = locate(lines, edge[near][row], along[near][row] + inward[near][row] * ways[way])
    across = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    steps = np.arange(-0.6, FLARED, FINER)
    found = np.full((len(near), len(ways)), np.nan)
    some = np.flatnonzero(_have_beside(ground, spot, across, half[row], (steps[0], steps[-1])))
    row, way, spot, across = row[some], way[some], spot[some], across[some]
    for side in (1.0, -1.0):
        beyond, lowered = _rims(ground, spot, side * across, half[row], steps)
        row, way, spot, across = row[lowered], way[lowered], spot[lowered], across[lowered]
        lateral = half[row] + steps[beyond[lowered]]
        rim = spot + side * lateral[:, None] * across
        own = (lateral - half[row]) - NEARER <= _off_others(network, lines, edge[near][row], rim)
        row, way, spot, across = row[own], way[own], spot[own], across[own]
    found[row, way] = ways[way]
    some = np.isfinite(found).any(axis=1)
    found, near = found[some], near[some]
    closest = found[np.arange(len(near)), np.nanargmin(np.abs(found), axis=1)]
    found[np.abs(found - closest[:, None]) > USUAL_DEPTH] = np.nan
    shift[near] = np.nanmean(found, axis=1)
    return shift


def _rims(
    ground: Ground, spot: FloatArray, out: FloatArray, half: FloatArray, steps: FloatArray
) -> tuple[IntArray, BoolArray]:
    """Find the first place off the roadway on each of r ways out of it.

    Parameters
    ----------
    spot, out, half
        (r, 2) where the ways begin, (r, 2) where they lead, and (r,) metres to the rim.
    steps
        (k,) metres from there that are looked at, rising.

    Returns
    -------
    step, lowered
        (r,) which of them it is, 0 for none, and whether a lowered kerb lies there.
    """
    step, lowered = np.zeros(len(spot), np.int64), np.zeros(len(spot), bool)
    rows = np.arange(len(spot))
    for begin in range(0, len(steps), AT_ONCE):
        lateral = half[rows, None] + steps[begin : begin + AT_ONCE]
        places = spot[rows, None] + lateral[:, :, None] * out[rows, None]
        first = ground.first_of(places.reshape(-1, 2), *ROADWAY, *LOWERED).reshape(lateral.shape)
        off = (first < 0) | (first >= len(ROADWAY))
        at, met = np.argmax(off, axis=1), off.any(axis=1)
        step[rows[met]] = begin + at[met]
        lowered[rows[met]] = first[met, at[met]] >= len(ROADWAY)
        rows = rows[~met]
    return step, lowered


def _have_beside(
    ground: Ground, spot: FloatArray, across: FloatArray, half: FloatArray,
    reach: tuple[float, float],
) -> BoolArray:  # fmt: skip
    """(r,) whether a lowered kerb lies on both sides of a street, within reach of its rim."""
    stones = shapely.STRtree(shapely.polygons(ground.vertices[ground.triangles_of(*LOWERED)]))
    beside = np.ones(len(spot), bool)
    for side in (1.0, -1.0):
        rows = np.flatnonzero(beside)
        ends = [spot[rows] + side * (half[rows] + far)[:, None] * across[rows] for far in reach]
        lines = shapely.linestrings(np.stack(ends, axis=1))
        hit = stones.query(lines, "dwithin", NEAR_ENOUGH)[0]
        beside[:] = False
        beside[rows[hit]] = True
    return beside


def _off_others(
    network: RoadNetwork, lines: Polylines, edge: IntArray, spots: FloatArray
) -> FloatArray:
    """(k,) metres from spots to the rim of any other street on the ground, infinity if far off.

    At a corner the kerbs of both streets are lowered; each belongs to the street it is nearer to.
    """
    found = np.full(len(spots), np.inf)
    points, shapes = shapely.points(spots), to_linestrings(lines)
    reach = float(network.half_width.max()) + FLARED
    spot, other = shapely.STRtree(shapes).query(points, predicate="dwithin", distance=reach)
    kept = (other != edge[spot]) & _on_ground(network)[other]
    spot, other = spot[kept], other[kept]
    off = shapely.distance(shapes[other], points[spot]) - network.half_width[other]
    np.minimum.at(found, spot, off)
    return found


def _on_ground(network: RoadNetwork) -> BoolArray:
    """(e,) whether an edge lies on the ground from end to end."""
    if not network.edge_count:
        return np.zeros(0, bool)
    off = np.maximum.reduceat(np.abs(network.lift), network.point_start[:-1])
    return np.asarray(off <= ON_GROUND)


def _grounded_parts(network: RoadNetwork) -> NDArray[Any]:
    """(e,) the parts of edges that lie on the ground: lines, or several, or empty ones."""
    lines, low = network.lines, np.abs(network.lift) <= ON_GROUND
    found, owner = to_linestrings(lines), lines.line_of_point()
    parted = np.flatnonzero(~_on_ground(network))
    first = np.flatnonzero((owner[1:] == owner[:-1]) & low[1:] & low[:-1])
    first = first[np.isin(owner[first], parted)]
    runs = shapely.linestrings(np.stack([lines.points[first], lines.points[first + 1]], axis=1))
    found[parted] = shapely.MultiLineString()
    row, number = np.unique(owner[first], return_inverse=True)
    found[row] = shapely.multilinestrings(runs, indices=number) if len(row) else found[row]
    return found


def _zebras(
    ground: Ground, network: RoadNetwork, lines: Polylines, grounded: NDArray[Any]
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Find crossings by their bars: edge, metres along it, and metres along the road."""
    none = np.zeros(0, np.int64), np.zeros(0), np.zeros(0)
    bars = _bars(ground)
    edges = np.flatnonzero(~shapely.is_empty(grounded))
    if not len(bars) or not len(edges):
        return none
    middle = bars.mean(axis=1)
    side = np.diff(bars, axis=1)[:, :2]  # (b, 2, 2)
    size = np.hypot(side[:, :, 0], side[:, :, 1])
    longer = np.argmax(size, axis=1)
    row = np.arange(len(bars))
    shapes = grounded[edges]
    tree = shapely.STRtree(shapes)
    spot, near = tree.query_nearest(shapely.points(middle), max_distance=25.0, all_matches=False)
    edge = edges[near]
    along = shapely.line_locate_point(to_linestrings(lines)[edge], shapely.points(middle[spot]))
    ahead = side[row, longer][spot] / size[row, longer][spot][:, None]
    within = shapely.distance(shapes[near], shapely.points(middle[spot]))
    straight = np.abs((ahead * locate(lines, edge, along)[1]).sum(axis=1)) > 0.9
    kept = straight & (within <= network.half_width[edge])
    edge, along, depth = edge[kept], along[kept], size[row, longer][spot][kept]
    order = np.lexsort((along, edge))
    edge, along, depth = edge[order], along[order], depth[order]
    group = np.cumsum(np.r_[True, (np.diff(edge) != 0) | (np.diff(along) > 1.0)][: len(edge)]) - 1
    if not len(group):
        return none
    count = np.bincount(group)
    several = count >= 2  # one bar alone is some other mark
    at = np.bincount(group, along) / count
    first = np.searchsorted(group, np.arange(len(count)))
    return edge[first][several], at[several], (np.bincount(group, depth) / count)[several]


def _rows(
    ground: Ground, lines: Polylines, grounded: NDArray[Any]
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Find crossings by the two rows of marks beside them, as `_zebras` does."""
    none = np.zeros(0, np.int64), np.zeros(0), np.zeros(0)
    of = ground.labelled("crossing_row")[ground.triangle_face]
    edges = np.flatnonzero(~shapely.is_empty(grounded))
    if not of.any() or not len(edges):
        return none
    face, row = np.unique(ground.triangle_face[of], return_inverse=True)
    middle = ground.vertices[ground.triangles[of]].mean(axis=1)
    count = np.bincount(row)[:, None]
    spots = shapely.points(
        np.column_stack([np.bincount(row, middle[:, axis], len(face)) for axis in (0, 1)]) / count
    )
    near_to = shapely.STRtree(grounded[edges])
    spot, near = near_to.query_nearest(spots, max_distance=25.0, all_matches=False)
    edge = edges[near]
    along = shapely.line_locate_point(to_linestrings(lines)[edge], spots[spot])
    order = np.lexsort((along, edge))
    edge, along = edge[order], along[order]
    begins = np.r_[True, (np.diff(edge) != 0) | (np.diff(along) > ROW_SPACE)][: len(edge)]
    group = np.cumsum(begins) - 1
    first = np.flatnonzero(begins)
    last = np.r_[first[1:], len(edge)] - 1
    depth = along[last] - along[first]
    kept = (np.bincount(group) >= LEAST_MARKS) & (depth > ROW_DEPTH[0]) & (depth < ROW_DEPTH[1])
    return edge[first][kept], ((along[first] + along[last]) / 2)[kept], depth[kept]


def _bars(ground: Ground) -> FloatArray:
    """(b, 4, 2) corners of the rectangles of paint that measure as bars of a zebra."""
    painted = ground.labelled("marking", "marking_yellow")
    of = painted[ground.triangle_face]
    triangles, face = ground.triangles[of], ground.triangle_face[of]
    if not len(triangles):
        return np.zeros((0, 4, 2))
    mark = _marks(ground, painted)[face]
    order = np.argsort(mark, kind="stable")
    number = np.unique(mark[order], return_inverse=True)[1]
    corners = ground.vertices[triangles[order]].reshape(-1, 2)
    points = shapely.multipoints(corners, indices=np.repeat(number, 3))
    boxes = shapely.oriented_envelope(points)
    boxes = boxes[shapely.get_type_id(boxes) == shapely.GeometryType.POLYGON]
    corners = shapely.get_coordinates(boxes).reshape(-1, 5, 2)[:, :4]
    size = np.sort(np.hypot(*np.diff(corners, axis=1)[:, :2].transpose(2, 0, 1)), axis=1)
    full = (size[:, 0] >= BAR[0]) & (size[:, 0] <= BAR[1])
    full &= (size[:, 1] >= BAR_LENGTH[0]) & (size[:, 1] <= BAR_LENGTH[1])
    return np.asarray(corners[full])


def _marks(ground: Ground, painted: BoolArray) -> IntArray:
    """(f,) the mark that each face belongs to; where a street meets a junction marks are cut."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    sides = ground.edge_faces
    both = (sides >= 0).all(axis=1) & painted[sides].all(axis=1)
    one, other = sides[both].T
    graph = csr_array((np.ones(len(one), bool), (one, other)), shape=(len(painted),) * 2)
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def _across(found: _Candidates, ground: Ground, network: RoadNetwork) -> Crosswalks:
    """Draw lines square to streets from walk to walk; those that meet none are left out.

    Where one that bars or the map tell of leads onto another roadway, of the junction or of a
    carriageway alongside, people go on to the walk beyond it.
    """
    ends, met = _walks_beside(found, ground, network, BEYOND)
    far = np.flatnonzero(~met & found.told)
    if len(far):
        ends[far], met[far] = _walks_beside(found.take(far), ground, network, FAR_BEYOND)
    key = hash_ids(0, "crosswalk", network.edge_id[found.edge], np.rint(10 * found.along))
    return Crosswalks(
        key, ends, found.depth, found.edge, found.marked, found.lowered
    ).take(met)  # fmt: skip


def _walks_beside(
    found: _Candidates, ground: Ground, network: RoadNetwork, beyond: float
) -> tuple[FloatArray, BoolArray]:
    """(c, 2, 2) where people step on and off the walks on both sides, and whether there are any."""
    middle, ahead = locate(network.lines, found.edge, found.along)
    across = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    half = network.half_width[found.edge]
    reach = float(half.max(initial=0.0)) + beyond
    steps = np.arange(0.0, reach + STEP, STEP)
    ends, met = [], np.ones(len(half), bool)
    near = steps <= half[:, None] + beyond  # (c, k)
    for side in (1.0, -1.0):
        spots = (middle[:, None] + side * steps[:, None] * across[:, None])[near]
        walk, road = np.zeros((2, *near.shape), bool)
        walk[near], road[near] = ground.on_each(spots, (*FOOTWAYS, *VERGES), ROADWAY)
        # The far rim is where the walk begins for good: islands lie nearer than the rim.
        walk &= steps >= half[:, None] - 1.0
        first = np.argmax(walk, axis=1)
        before = np.arange(len(steps)) < first[:, None]
        # Of the way of each street itself: how far the widest reaches says nothing of the others.
        trodden = ((road | walk | ~before) & near).sum(axis=1)
        met &= walk.any(axis=1) & (trodden > 0.9 * near.sum(axis=1))
        ends.append(middle + side * (steps[first] + INTO)[:, None] * across)
    return np.stack(ends, axis=1), met


def _along_paths(ground: Ground, layout: Layout) -> Crosswalks:
    """Return where footways lead over roadways."""
    roads = layout.roads
    level = ~roads["bridge"].to_numpy() & ~roads["tunnel"].to_numpy()
    level &= (roads["layer"].to_numpy() == 0) & roads["kind"].isin(PATHS).to_numpy()
    shapes, ids = roads.geometry.to_numpy()[level], roads["id"].to_numpy(np.uint64)[level]
    paved = ground.triangles_of(*ROADWAY)
    near = near_boxes(ground.vertices, paved, segment_bounds(shapes), NEARBY)
    way, found = _stretches_over(shapes, shapely.polygons(ground.vertices[paved[near]]))
    length = np.hypot(*(found[:, 1] - found[:, 0]).T)
    crossing = (length > 2 * STEP) & (length < LONGEST)
    way, found, length = way[crossing], found[crossing], length[crossing]
    if not len(found):
        return no_crosswalks()
    key = hash_ids(0, "crosswalk", ids[way], np.rint(10 * found[:, 0, 0]))
    into = (found[:, 1] - found[:, 0]) / length[:, None] * INTO
    found = np.stack([found[:, 0] - into, found[:, 1] + into], axis=1)
    walked = ground.on(found.reshape(-1, 2), *FOOTWAYS, *VERGES).reshape(-1, 2).all(axis=1)
    count = len(found)
    return Crosswalks(
        key, found, np.full(count, USUAL_DEPTH), np.full(count, -1, np.int64),
        np.zeros(count, bool), np.zeros(count, bool),
    ).take(walked)  # fmt: skip


def _stretches_over(ways: NDArray[Any], faces: NDArray[Any]) -> tuple[IntArray, FloatArray]:
    """Find the stretches of ways that lie on faces: (k,) ways, and (k, 2, 2) where each ends."""
    lines = pack(ways)
    first, way = segments(lines)
    pieces = shapely.linestrings(lines.points[np.stack([first, first + 1], axis=1)])
    piece, face = shapely.STRtree(faces).query(pieces, predicate="intersects")
    over = shapely.intersection(pieces[piece], faces[face])
    kept = shapely.get_type_id(over) == shapely.GeometryType.LINESTRING
    kept &= shapely.length(over) > 0
    piece, over = piece[kept], over[kept]
    if not len(piece):
        return piece, np.zeros((0, 2, 2))
    ends = np.stack([shapely.get_coordinates(shapely.get_point(over, k)) for k in (0, -1)], axis=1)
    at = arc_lengths(lines)[0][first[piece], None] + np.hypot(
        *(ends - lines.points[first[piece], None]).transpose(2, 0, 1)
    )  # (k, 2)
    turned = at[:, 0] > at[:, 1]
    at[turned], ends[turned] = at[turned, ::-1], ends[turned, ::-1]
    way = way[piece]
    order = np.lexsort((at[:, 0], way))
    way, at, ends = way[order], at[order], ends[order]
    # Ways lie one behind the other on one axis, so that the farthest end so far is of the same.
    reached = np.maximum.accumulate(way * LONGER + at[:, 1])
    begins = np.flatnonzero(np.r_[True, (way * LONGER + at[:, 0])[1:] > reached[:-1] + NEAR_ENOUGH])
    number = np.repeat(np.arange(len(begins)), np.diff(np.r_[begins, len(way)]))
    farthest = np.lexsort((at[:, 1], number))[np.r_[begins[1:], len(way)] - 1]
    found = np.stack([ends[begins, 0], ends[farthest, 1]], axis=1)
    return _joined_round(ways, way[begins], found)


def _joined_round(
    ways: NDArray[Any], way: IntArray, found: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Join the last stretch of closed ways to the first one where they begin on a face."""
    first = np.flatnonzero(np.r_[True, way[1:] != way[:-1]])
    last = np.r_[first[1:], len(way)] - 1
    joined = (first < last) & (found[first, 0] == found[last, 1]).all(axis=1)
    joined &= shapely.is_closed(ways[way[first]])
    found[first[joined], 0] = found[last[joined], 0]
    kept = np.ones(len(way), bool)
    kept[last[joined]] = False
    return way[kept], found[kept]


def no_crosswalks() -> Crosswalks:
    """Return none."""
    return Crosswalks(np.zeros(0, np.uint64), np.zeros((0, 2, 2)), np.zeros(0),
                      np.zeros(0, np.int64), np.zeros(0, bool), np.zeros(0, bool))  # fmt: skip


def _apart(found: Crosswalks) -> BoolArray:
    """(c,) those that lie apart from each other, the better known before the others.

    Beside bars and lowered kerbs nobody crosses from the same walk to the same walk elsewhere.
    """
    middle = shapely.points(found.ends.mean(axis=1))
    one, other = shapely.STRtree(middle).query(middle, predicate="dwithin", distance=ASIDE)
    same = np.hypot(*(found.ends[one] - found.ends[other]).T).max(axis=0)
    turned = np.hypot(*(found.ends[one] - found.ends[other, ::-1]).T).max(axis=0)
    known = found.standing
    doubled = (known[one] >= 2) & (known[other] < 2) & (np.minimum(same, turned) < ASIDE)
    doubled |= shapely.distance(middle[one], middle[other]) <= APART
    one, other = one[doubled], other[doubled]
    order = np.argsort(one, kind="stable")
    other, start = other[order], np.searchsorted(one[order], np.arange(found.count + 1))
    rank = np.lexsort((found.id, -known))
    place = np.empty(len(rank), np.int64)
    place[rank] = np.arange(len(rank))
    kept = np.ones(found.count, bool)
    for row in rank.tolist():
        if kept[row]:
            near = other[start[row] : start[row + 1]]
            kept[near[place[near] > place[row]]] = False
    return kept


def heads_of(crosswalks: Crosswalks, signals: Signals | None) -> IntArray:
    """Return (c,) the head of signals that rules each crosswalk for people, -1 for none."""
    found = np.full(crosswalks.count, -1, np.int64)
    if signals is None or not crosswalks.count:
        return found
    rows = np.flatnonzero(signals.crossing > 0)
    if len(rows):
        middle = shapely.points(crosswalks.ends.mean(axis=1))
        heads = shapely.points(signals.position[rows, :2])
        near = shapely.STRtree(heads).query_nearest(
            middle, max_distance=HEAD_REACH, all_matches=False
        )
        found[near[0]] = rows[near[1]]
    return found
