"""Heights of ways: grades, clearances, ramps; where the terrain is cut and filled for them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.heights import WayHeights, no_heights
from cityx.geometry.chains import components, interpolate
from cityx.geometry.grades import Slopes, evened, fall_to, graded, rise_to, slopes_of
from cityx.geometry.grading import grade_terrain
from cityx.geometry.polylines import Polylines, arc_lengths, locate, pack, to_linestrings
from cityx.plugins.road.kerbs import edge_lines
from cityx.plugins.road.network import DRIVABLE, clip_lines, shared_nodes
from cityx.protocol import Port, action, has_network

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork
    from cityx.city.terrain import Terrain

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

RAILS = ("rail", "light_rail", "subway", "tram", "narrow_gauge", "monorail")
ON_FOOT = ("footway", "path", "cycleway", "pedestrian", "bridleway", "corridor")
WATER = ("water", "sea", "river", "pool", "wetland")
STATION = 5.0  # metres between the heights of a way
# Steepest climb by kind of way, rise over run. Streets of hill towns exceed what one would build.
GRADE = {"motorway": 0.06, "trunk": 0.07, "primary": 0.08, "secondary": 0.09, "tertiary": 0.10,
         "service": 0.15, "track": 0.18, "steps": 0.6}  # fmt: skip
USUAL_GRADE = 0.12
LINK_GRADE = 0.01  # more on ramps between roads
FOOT_GRADE = 0.12
RAIL_GRADE = 0.035
# Free height over a way by what moves on it, metres, with a little more than the least required.
OVER_CARS, OVER_RAILS, OVER_FEET = 4.8, 5.2, 2.7
DECK = 0.8  # metres of structure under a deck that carries traffic
FOOT_DECK = 0.5
OVER_WATER = 0.6  # metres above the bank that a deck over water rises
COVER = 0.5  # metres of structure and soil over the clear height of a tunnel
EDGE = 0.5  # metres of kerb and parapet at the side of a deck
BESIDE = 4.0  # metres past the edge of what is crossed over which a deck keeps its height
PARTING = 80.0  # metres from where two ways part within which one does not pass over the other
PARTS_BELOW = np.radians(35.0)  # angle between streets that stay one surface for a while
ABREAST = 15.0  # metres over which that angle is taken
CROSSFALL = 0.05  # of the surface between such streets
REACH = 400.0  # metres; a flat site needs no heights farther from every bridge and tunnel
ROUNDS = 4  # of evening the profile out
KEPT = 0.6  # of the reach over and under other ways in which evening takes nothing
GROUNDED = 0.03  # metres; nearer to the ground a way lies on it
PASSES = 16  # attempts at all clearances
SHORT = 0.05  # metres of clearance that nobody misses
STEEPER = 80.0  # metres round a crossing without room within which ways may be steeper
MORE = 1.15  # times the grade, at each attempt
STAIRS = 0.6  # grade of what is walked where a path has no room for its grade
EXACT = 1e-4  # metres to which heights are kept


@dataclass(frozen=True)
class _Ways:
    """Centrelines in stations, with what bears on their heights; w ways, p stations."""

    lines: Polylines
    node: IntArray  # (p,)
    road: IntArray  # (w,) row of the layout
    edge: IntArray  # (w,) edge of the network or -1
    level: IntArray  # (w,)
    grade: FloatArray  # (w,)
    clear: FloatArray  # (w,) free height that a way over this one leaves
    deck: FloatArray  # (w,) structure under this one
    half: FloatArray  # (w,)
    reach: FloatArray  # (w,) half the width with walks
    tunnel: BoolArray  # (w,)
    light: BoolArray  # (w,) on foot, or rails below: no street makes way for it
    along: FloatArray  # (p,)
    count: int  # of nodes

    @cached_property
    def owner(self) -> IntArray:
        return self.lines.line_of_point()

    @property
    def rank(self) -> IntArray:
        """(w,) order of what passes over what: of one level, paths are farther from the ground."""
        return np.asarray(2 * self.level + np.sign(self.level) * self.light)


def way_levels(layout: Layout) -> IntArray:
    """(n,) level of each way: 0 on the ground, a bridge at least 1, a tunnel at most -1."""
    roads = layout.roads
    level = roads["layer"].to_numpy().astype(np.int64)
    passage = roads["passage"].to_numpy()
    level = np.where(roads["bridge"].to_numpy(), np.maximum(level, 1), level)
    below = roads["tunnel"].to_numpy() & ~passage
    level = np.where(below, np.minimum(level, -1), level)
    return np.asarray(np.where(passage, 0, level))


def way_heights(
    layout: Layout, network: RoadNetwork, terrain: Terrain
) -> tuple[RoadNetwork, WayHeights, Terrain]:
    """Give every way a height: within its grade, clear of what it crosses, near the ground.

    The ground's own ways follow the terrain, cut and fill in balance where it is too steep for
    them. Ways of a higher level rise, with their neighbours as far as the grades ask, until they
    clear what they pass over; those of a lower level sink likewise. Of all profiles that keep the
    grades these move least.

    Returns
    -------
    network
        The same graph with heights; stations are added where it leaves the ground.
    heights
        All pieces of ways off the ground, paths and tracks among them.
    terrain
        The terrain with the cut and fill of its roads.
    """
    ways = _ways(layout, network, everywhere=not terrain.is_flat)
    if ways is None:
        return network, no_heights(), terrain
    place, owner = _places(ways), ways.owner
    first = np.flatnonzero(owner[1:] == owner[:-1])
    pairs = ways.node[np.column_stack([first, first + 1])]
    run = ways.along[first + 1] - ways.along[first]
    rise = run * ways.grade[owner[first]]
    of_pair = owner[first]
    across, across_run = _across(ways)
    if len(across):
        pairs = np.concatenate([pairs, ways.node[across]])
        run = np.concatenate([run, across_run])
        rise = np.concatenate([rise, CROSSFALL * across_run])
        of_pair = np.concatenate([of_pair, owner[across[:, 0]]])
    on_ground = np.zeros(ways.count, bool)
    on_ground[ways.node[(ways.level == 0)[owner]]] = True
    soil = terrain.height_at(place)
    base = soil
    if not terrain.is_flat:
        rise = np.maximum(rise, _climbed(ways, soil, pairs, of_pair))
        base = graded(slopes_of(pairs, rise), np.where(on_ground, soil, np.nan))
        terrain = grade_terrain(terrain, *_profiles(ways, base), layout.extent)
        soil = terrain.height_at(place)
        base = np.where(on_ground, soil, _spanned(pairs, rise, on_ground, base))
    z = _cleared(layout, ways, pairs, of_pair, run, rise, base, soil, on_ground)
    lift = np.where(on_ground & (np.abs(z - base) < EXACT), 0.0, z - soil)
    z = np.round(soil + lift, 4)
    heights = _pieces(ways, z, soil, lift)
    return _with_heights(network, ways, terrain, z, lift), heights, terrain


def _climbed(ways: _Ways, soil: FloatArray, pairs: IntArray, of_pair: IntArray) -> FloatArray:
    """(m,) what paths on the ground climb with it, metres: nobody cuts a hill for a path."""
    path = (ways.light & (ways.level == 0))[of_pair]
    return np.where(path, np.abs(soil[pairs[:, 1]] - soil[pairs[:, 0]]), 0.0)


def _ways(layout: Layout, network: RoadNetwork, *, everywhere: bool) -> _Ways | None:
    """Collect the centrelines that need heights, with a station every few metres."""
    roads = layout.roads
    kind = roads["kind"].to_numpy().astype(str)
    others = np.flatnonzero(
        ~np.isin(kind, DRIVABLE) & (shapely.length(roads.geometry.to_numpy()) > 0)
    )
    shapes, rows = clip_lines(shapely.force_2d(roads.geometry.to_numpy()[others]), others,
                              layout.extent)  # fmt: skip
    cars = to_linestrings(edge_lines(network))
    shapes = np.concatenate([cars, shapes])
    road = np.concatenate([network.edge_road.astype(np.int64), rows])
    edge = np.concatenate([np.arange(len(cars)), np.full(len(rows), -1)])
    level = way_levels(layout)[road]
    if not len(shapes) or not (everywhere or level.any()):
        return None
    if not everywhere:
        near = shapely.STRtree(shapes[level != 0]).query(shapes, "dwithin", distance=REACH)[0]
        chosen = np.unique(near)
        shapes, road, edge, level = shapes[chosen], road[chosen], edge[chosen], level[chosen]
    lines = pack(shapely.segmentize(shapes, STATION))
    node = shared_nodes(lines, level - level.min())[0]
    kind = kind[road]
    feet, rails = np.isin(kind, (*ON_FOOT, "steps")), np.isin(kind, RAILS)
    # Platforms join streets and the railway below them in one graph; no train climbs the stairs.
    deep = np.zeros(int(node.max()) + 1, bool)
    deep[node[(rails & (level < 0))[lines.line_of_point()]]] = True
    node = np.where(deep[node] & rails[lines.line_of_point()], node + len(deep), node)
    node = np.unique(node, return_inverse=True)[1]
    link = np.char.endswith(kind, "_link")
    grade = np.array([GRADE.get(word.removesuffix("_link"), USUAL_GRADE) for word in kind])
    grade = np.where(link, grade + LINK_GRADE, grade)
    grade = np.select([rails, feet & (kind != "steps")], [RAIL_GRADE, FOOT_GRADE], grade)
    half = np.maximum(roads["width"].to_numpy(float)[road], 1.5) / 2
    half[edge >= 0] = network.half_width[edge[edge >= 0]]
    half = np.where(rails, 2.25, half)
    walk = roads[["sidewalk_left", "sidewalk_right"]].to_numpy(float).max(axis=1)[road]
    return _Ways(
        lines, node, road, edge, level, grade,
        np.select([rails, feet], [OVER_RAILS, OVER_FEET], OVER_CARS),
        np.where(feet, FOOT_DECK, DECK), half, half + walk + EDGE,
        roads["tunnel"].to_numpy()[road] & (level < 0), feet | (rails & (level < 0)),
        arc_lengths(lines)[0], int(node.max()) + 1,
    )  # fmt: skip


def _places(ways: _Ways) -> FloatArray:
    place = np.zeros((ways.count, 2))
    place[ways.node] = ways.lines.points
    return place


def _profiles(ways: _Ways, base: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return places, heights and half widths of the stations of ways on the ground."""
    own = np.flatnonzero((ways.level == 0)[ways.owner])
    return ways.lines.points[own], base[ways.node[own]], ways.half[ways.owner[own]]


def _across(ways: _Ways) -> tuple[IntArray, FloatArray]:
    """Pair stations of streets that part from each other while they are one surface.

    Returns
    -------
    pairs, run
        (k, 2) stations, and (k,) metres between them.
    """
    lines = ways.lines
    cars = np.flatnonzero(ways.edge >= 0)
    way, side = np.tile(cars, 2), np.repeat([0, 1], len(cars))
    foot = np.where(side == 0, lines.start[way], lines.start[way + 1] - 1)
    ahead = np.where(side == 0, 1.0, -1.0) * np.minimum(ABREAST, _lengths(ways)[way])
    at = ways.along[foot]
    reach = locate(lines, way, at + ahead)[0] - lines.points[foot]
    bearing = np.arctan2(reach[:, 1], reach[:, 0])
    order = np.lexsort((bearing, ways.node[foot]))
    way, foot, bearing = way[order], foot[order], bearing[order]
    node = ways.node[foot]
    # Only neighbours round a node can be one surface; the last is the first one's neighbour too.
    begin, count = np.searchsorted(node, node), np.bincount(node, minlength=ways.count)[node]
    following = begin + (np.arange(len(node)) - begin + 1) % np.maximum(count, 1)
    turn = np.mod(bearing[following] - bearing, 2 * np.pi)
    flat = np.flatnonzero((turn < PARTS_BELOW) & (way[following] != way))
    one, other = way[flat], way[following[flat]]
    station, row = _around(ways, foot[flat], np.full(len(flat), PARTING))
    one, other = one[row], other[row]
    shapes = to_linestrings(lines)
    spots = shapely.points(lines.points[station])
    far = shapely.distance(shapes[other], spots)
    near = (far < ways.reach[one] + ways.half[other] + 0.5) & (far > 0.0)
    station, other, far = station[near], other[near], far[near]
    facing = _nearest(ways, shapes, other, lines.points[station])
    return np.column_stack([station, facing]), np.maximum(far, 0.5)


def _spanned(
    pairs: IntArray, rise: FloatArray, on_ground: BoolArray, base: FloatArray
) -> FloatArray:
    """Let bridges and tunnels run evenly from one place on the ground to the next."""
    piece = components(pairs, len(base))
    held = np.bincount(piece, on_ground, minlength=len(base)) > 0
    return interpolate(pairs, np.maximum(rise, 1e-3), on_ground | ~held[piece], base)


@dataclass(frozen=True)
class _Crossings:
    """Places where one way passes over another, c of them."""

    upper: IntArray  # (c,) way
    lower: IntArray
    upper_node: IntArray  # (c,) nearest station
    lower_node: IntArray
    need: FloatArray  # (c,) metres from the lower surface to the upper
    wide: FloatArray  # (c,) metres along the upper way that are over the lower
    under: FloatArray  # (c,) metres along the lower way that are under the upper


def _crossings(ways: _Ways) -> _Crossings:
    """Find where centrelines cross, and where one way runs under another along its side."""
    shapes = to_linestrings(ways.lines)
    off = np.flatnonzero(ways.level)
    one, other = shapely.STRtree(shapes).query(shapes[off], predicate="crosses")
    pair = np.unique(np.sort(np.column_stack([off[one], other]), axis=1), axis=0)
    upper, lower = _upper_first(ways, pair)
    spots = shapely.intersection(shapes[upper], shapes[lower])
    points, row = shapely.get_coordinates(spots, return_index=True)
    upper, lower = upper[row], lower[row]
    over, under = (_nearest(ways, shapes, way, points) for way in (upper, lower))
    beside = _beside(ways, shapes)
    upper = np.concatenate([upper, beside[0]])
    lower = np.concatenate([lower, beside[1]])
    over = np.concatenate([over, beside[2]])
    under = np.concatenate([under, beside[3]])
    # Ways that share the very place meet there, whatever their levels say.
    apart = ways.node[over] != ways.node[under]
    upper, lower, over, under = upper[apart], lower[apart], over[apart], under[apart]
    spread = np.arange(len(apart))[apart] < len(apart) - len(beside[0])
    return _Crossings(
        upper, lower, over, under,
        ways.clear[lower] + ways.deck[upper],
        np.where(spread, ways.half[lower] + BESIDE, 2 * STATION),
        np.where(spread, ways.half[upper] + BESIDE, 2 * STATION),
    )  # fmt: skip


def _upper_first(ways: _Ways, pair: IntArray) -> tuple[IntArray, IntArray]:
    """Return the pairs of ways on different levels, (k,) the upper and (k,) the lower of each."""
    rank = ways.rank
    pair = pair[rank[pair[:, 0]] != rank[pair[:, 1]]]
    high = rank[pair[:, 0]] > rank[pair[:, 1]]
    return np.where(high, pair[:, 0], pair[:, 1]), np.where(high, pair[:, 1], pair[:, 0])


def _beside(ways: _Ways, shapes: Any) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Find stations of streets that lie under the side of a bridge, or over that of a cutting.

    Returns
    -------
    upper, lower, over, under
        (k,) ways, and the station of each.
    """
    off = np.flatnonzero((ways.level > 0) | ((ways.level < 0) & ~ways.light))
    owner = ways.owner
    street = np.flatnonzero((ways.edge >= 0)[owner])
    spots = shapely.points(ways.lines.points[street])
    tree = shapely.STRtree(spots)
    widest = ways.half[ways.edge >= 0].max(initial=0.0) / 2
    way, spot = tree.query(shapes[off], predicate="dwithin", distance=ways.reach[off] + widest)
    way, station = off[way], street[spot]
    other = owner[station]
    near = shapely.distance(shapes[way], spots[spot]) < ways.reach[way] + ways.half[other] / 2
    near &= ways.rank[way] != ways.rank[other]
    way, station, other = way[near], station[near], other[near]
    # Ways that part from each other are one surface until they are apart.
    ends = np.concatenate([ways.lines.start[:-1], ways.lines.start[1:] - 1])
    place = ways.node[ends].reshape(2, -1)
    at = ways.lines.points[ends].reshape(2, -1, 2)
    parting = np.zeros(len(way), bool)
    for mine in (0, 1):
        for theirs in (0, 1):
            meet = place[mine, way] == place[theirs, other]
            far = np.hypot(*(ways.lines.points[station] - at[mine, way]).T)
            parting |= meet & (far < PARTING)
    way, station, other = way[~parting], station[~parting], other[~parting]
    facing = _nearest(ways, shapes, way, ways.lines.points[station])
    above = ways.rank[way] > ways.rank[other]
    return (
        np.where(above, way, other), np.where(above, other, way),
        np.where(above, facing, station), np.where(above, station, facing),
    )  # fmt: skip


def _nearest(ways: _Ways, shapes: Any, way: IntArray, points: FloatArray) -> IntArray:
    """(k,) station of each way nearest to each place, as an index of stations."""
    at = shapely.line_locate_point(shapes[way], shapely.points(points))
    start, end = ways.lines.start[way], ways.lines.start[way + 1]
    shift = np.concatenate([[0.0], np.cumsum(_lengths(ways) + 1.0)])[:-1]
    keys = ways.along + shift[ways.owner]
    after = np.clip(np.searchsorted(keys, at + shift[way]), start + 1, end - 1)
    nearer = at - ways.along[after - 1] < ways.along[after] - at
    return np.asarray(np.where(nearer, after - 1, after))


def _lengths(ways: _Ways) -> FloatArray:
    return np.asarray(ways.along[ways.lines.start[1:] - 1])


def _cleared(
    layout: Layout,
    ways: _Ways,
    pairs: IntArray,
    of_pair: IntArray,
    run: FloatArray,
    rise: FloatArray,
    base: FloatArray,
    soil: FloatArray,
    on_ground: BoolArray,
) -> FloatArray:
    """Raise and sink ways until each clears what it crosses.

    Where the grades leave no room for that, as on a ramp that winds over itself, the ways about
    the place are allowed to be steeper, and all heights are found anew.
    """
    crossing = _crossings(ways)
    wet, street = _over_water(layout, ways), _in_streets(ways)
    middle = _places(ways)[ways.node[crossing.upper_node]]
    centre = (_places(ways)[pairs[:, 0]] + _places(ways)[pairs[:, 1]]) / 2
    tree = shapely.STRtree(shapely.points(centre))
    free = rise.copy()
    walked, class_of_pair = ways.light[of_pair], ways.clear[of_pair]
    best, fewest = base, len(crossing.upper) + 1
    for _ in range(PASSES):
        z = _swept(ways, crossing, slopes_of(pairs, free), base, soil, on_ground, wet, street)
        gap = z[ways.node[crossing.upper_node]] - z[ways.node[crossing.lower_node]]
        short = np.flatnonzero(gap < crossing.need - SHORT)
        if len(short) < fewest:
            best, fewest = z, len(short)
        if not len(short):
            break
        moves = np.where(ways.level[crossing.upper] > 0, crossing.upper, crossing.lower)[short]
        row, near = tree.query(shapely.points(middle[short]), "dwithin", distance=STEEPER)
        # Where stairs have no other place, they stand in the street.
        spots = shapely.points(ways.lines.points[street])
        beside = shapely.STRtree(spots).query(shapely.points(middle[short]), "dwithin",
                                              distance=STEEPER)[1]  # fmt: skip
        street = np.delete(street, np.unique(beside))
        # Only what moves for the crossing, and what it runs into, may be steeper for it.
        near = np.unique(near[class_of_pair[near] == ways.clear[moves[row]]])
        free[near] = np.where(walked[near], STAIRS * run[near], MORE * free[near])
    return best


def _swept(
    ways: _Ways,
    crossing: _Crossings,
    slopes: Slopes,
    base: FloatArray,
    soil: FloatArray,
    on_ground: BoolArray,
    wet: IntArray,
    in_street: IntArray,
) -> FloatArray:
    """Sink the lower levels from the ground down, then raise the upper ones from the ground up.

    What is crossed stays where it is while a level moves. Streets stay for paths, and for railways
    below them.
    """
    z = base.copy()
    tunnels = ways.node[ways.tunnel[ways.owner]]
    if len(tunnels):
        z = _sunk(ways, slopes, z, soil, on_ground, tunnels)
    upper, lower = ways.level[crossing.upper], ways.level[crossing.lower]
    must_up, must_down = np.full(ways.count, -np.inf), np.full(ways.count, np.inf)
    street = np.zeros(ways.count, bool)
    street[ways.node[((ways.level == 0) & ~ways.light)[ways.owner]]] = True
    street[ways.node[in_street]] = True
    for level in np.unique(lower[lower < 0])[::-1]:
        for light in (False, True):
            pick = (lower == level) & (upper <= 0) & (ways.light[crossing.lower] == light)
            held = np.where(street & light, z, -np.inf)
            node = ways.node[crossing.upper_node[pick]]
            held[node] = z[node]
            wanted = _asked_below(ways, crossing, pick, z, 1.0)
            wanted[wanted >= z - EXACT] = np.inf
            np.minimum(must_down, _asked_below(ways, crossing, pick, z, KEPT), out=must_down)
            z = -_moved(slopes, -z, -wanted, -held)
    for level in np.unique(ways.level[ways.level > 0]):
        for light in (False, True):
            pick = (upper == level) & (ways.light[crossing.upper] == light)
            held = np.where(street & light, z, np.inf)
            node = ways.node[crossing.lower_node[pick]]
            held[node] = z[node]
            wanted = _asked(ways, crossing, pick, z, 1.0)
            way = ways.owner[wet]
            over = ways.node[wet[(ways.level[way] == level) & (ways.light[way] == light)]]
            np.maximum.at(wanted, over, soil[over] + OVER_WATER)
            wanted[wanted <= z + EXACT] = -np.inf
            np.maximum(must_up, _asked(ways, crossing, pick, z, KEPT), out=must_up)
            z = _moved(slopes, z, wanted, held)
    moved = np.abs(z - base) > GROUNDED
    even = evened(slopes, z, moved, ROUNDS)
    # Evening takes a little off crests and sags; what a crossing asks for stays.
    even = np.maximum(even, np.minimum(must_up, z))
    even = np.minimum(even, np.maximum(must_down, z))
    return np.asarray(np.where(moved, even, base))


def _moved(slopes: Slopes, z: FloatArray, wanted: FloatArray, held: FloatArray) -> FloatArray:
    """Raise heights to what is wanted as far as the held ones, and the grades, let them."""
    high = rise_to(slopes, wanted, float(z.min()))
    above = high > z
    if not above.any():
        return z
    # A held station that nothing reaches holds nothing back.
    inside = slopes.take(above[slopes.pairs].all(axis=1))
    held = np.where(above, held, np.inf)
    top = fall_to(inside, held, float(high[above].max()))
    return np.maximum(z, np.minimum(high, top))


def _sunk(
    ways: _Ways, slopes: Slopes, z: FloatArray, soil: FloatArray,
    on_ground: BoolArray, tunnels: IntArray,
) -> FloatArray:  # fmt: skip
    """Let tunnels fall away from their mouths until the ground closes over them."""
    inside = np.zeros(ways.count, bool)
    inside[tunnels] = True
    mouth = inside & on_ground
    depth = np.full(ways.count, -np.inf)
    np.maximum.at(depth, ways.node, (ways.clear + COVER)[ways.owner])
    own = slopes.take(inside[slopes.pairs].all(axis=1))
    fall = -rise_to(own, np.where(mouth, 0.0, -np.inf))
    room = np.where(np.isfinite(fall), fall, np.inf)
    return np.asarray(np.where(inside & ~mouth, np.minimum(z, soil - np.minimum(depth, room)), z))


def _in_streets(ways: _Ways) -> IntArray:
    """Return the stations of paths on the ground that lie in a carriageway: they stay there."""
    owner = ways.owner
    cars = np.flatnonzero((ways.edge >= 0) & (ways.level == 0))
    paths = np.flatnonzero((ways.light & (ways.level == 0))[owner])
    shapes = to_linestrings(ways.lines)[cars]
    tree = shapely.STRtree(shapely.points(ways.lines.points[paths]))
    near = tree.query(shapes, predicate="dwithin", distance=ways.half[cars] + EDGE)[1]
    return np.asarray(paths[np.unique(near)])


def _over_water(layout: Layout, ways: _Ways) -> IntArray:
    """Return the stations of bridges that stand in water."""
    wet = layout.areas["kind"].isin(WATER).to_numpy()
    high = np.flatnonzero((ways.level > 0)[ways.owner])
    if not wet.any() or not len(high):
        return np.zeros(0, np.int64)
    tree = shapely.STRtree(layout.areas.geometry.to_numpy()[wet])
    found = tree.query(shapely.points(ways.lines.points[high]), predicate="intersects")[0]
    return np.asarray(np.unique(high[found]))


def _asked(
    ways: _Ways, crossing: _Crossings, rows: BoolArray, z: FloatArray, spread: float
) -> FloatArray:
    """(n,) height that stations over other ways must reach."""
    pick = np.flatnonzero(rows)
    need = z[ways.node[crossing.lower_node[pick]]] + crossing.need[pick]
    return _highest(ways, crossing.upper_node[pick], spread * crossing.wide[pick], need)


def _asked_below(
    ways: _Ways, crossing: _Crossings, rows: BoolArray, z: FloatArray, spread: float
) -> FloatArray:
    """(n,) height that stations under other ways must not exceed."""
    pick = np.flatnonzero(rows)
    need = z[ways.node[crossing.upper_node[pick]]] - crossing.need[pick]
    return -_highest(ways, crossing.lower_node[pick], spread * crossing.under[pick], -need)


def _highest(ways: _Ways, station: IntArray, reach: FloatArray, height: FloatArray) -> FloatArray:
    """(n,) the highest of what is asked about stations at each node; minus infinity for nothing."""
    wanted = np.full(ways.count, -np.inf)
    near, which = _around(ways, station, reach)
    np.maximum.at(wanted, ways.node[near], height[which])
    return wanted


def _around(ways: _Ways, station: IntArray, reach: FloatArray) -> tuple[IntArray, IntArray]:
    """List the stations of a way within `reach` metres along it, and the row each belongs to."""
    way = ways.owner[station]
    shift = np.concatenate([[0.0], np.cumsum(_lengths(ways) + 1000.0)])[:-1]
    keys = ways.along + shift[ways.owner]
    low = np.searchsorted(keys, keys[station] - reach, side="left")
    high = np.searchsorted(keys, keys[station] + reach, side="right")
    low, high = np.maximum(low, ways.lines.start[way]), np.minimum(high, ways.lines.start[way + 1])
    size = np.maximum(high - low, 0)
    which = np.repeat(np.arange(len(station)), size)
    first = np.concatenate([[0], np.cumsum(size)])[:-1]
    return np.arange(len(which)) - first[which] + low[which], which


def _off(ways: _Ways, lift: FloatArray) -> BoolArray:
    """(p,) whether each station belongs to a structure: off the ground, or next to such a one."""
    high = np.abs(lift[ways.node]) > GROUNDED
    off = high.copy()
    owner = ways.owner
    same = owner[1:] == owner[:-1]
    off[1:] |= high[:-1] & same
    off[:-1] |= high[1:] & same
    return np.asarray(off)


def _with_heights(
    network: RoadNetwork, ways: _Ways, terrain: Terrain, z: FloatArray, lift: FloatArray
) -> RoadNetwork:
    """Return the network with heights, and stations on the edges that leave the ground."""
    edge_of = ways.edge[ways.owner]
    moved = np.zeros(network.edge_count, bool)
    moved[edge_of[_off(ways, lift) & (edge_of >= 0)]] = True
    old = np.repeat(np.arange(network.edge_count), np.diff(network.point_start))
    new = np.flatnonzero((edge_of >= 0) & moved[edge_of])
    rest = np.flatnonzero(~moved[old])
    edge = np.concatenate([edge_of[new], old[rest]])
    order = np.argsort(edge, kind="stable")
    points = np.concatenate([ways.lines.points[new], network.points[rest]])
    height = np.concatenate([z[ways.node[new]], terrain.height_at(network.points[rest])])
    raised = np.concatenate([lift[ways.node[new]], np.zeros(len(rest))])
    start = np.searchsorted(edge[order], np.arange(network.edge_count + 1)).astype(np.int64)
    return replace(
        network, points=points[order], point_start=start, z=height[order], lift=raised[order]
    )


def _pieces(ways: _Ways, z: FloatArray, soil: FloatArray, lift: FloatArray) -> WayHeights:
    """Cut the pieces of ways that leave the ground out of them."""
    owner, off = ways.owner, _off(ways, lift)
    begins = off & np.r_[True, ~off[:-1] | (owner[1:] != owner[:-1])]
    station = np.flatnonzero(off)
    piece = np.cumsum(begins)[station] - 1
    count = int(begins.sum())
    size = np.bincount(piece, minlength=count)
    # A lone station makes no piece.
    station = station[size[piece] >= 2]
    piece = np.unique(piece[size[piece] >= 2], return_inverse=True)[1]
    start = np.searchsorted(piece, np.arange(int(piece.max(initial=-1)) + 2)).astype(np.int64)
    way = owner[station[start[:-1]]]
    node = ways.node[station]
    return WayHeights(
        ways.road[way].astype(np.int32), ways.edge[way].astype(np.int32),
        ways.along[station[start[:-1]]], ways.along[station[start[1:] - 1]],
        ways.level[way].astype(np.int16), start, ways.lines.points[station],
        z[node], soil[node], ways.half[way],
    )  # fmt: skip


@action(
    "road/heights-v1",
    limits=[
        "Service roads and tracks in tunnels are left out.",
        "Ways rise over what they cross; the ways below never sink for them, except tunnels.",
    ],
    requires=("layout", has_network()),
    takes=(Port("network", "line", role="road_network"),),
    gives=(Port("heights", "line", role="way_heights"),),
    labels=("bridges", "tunnels", "ramps", "grades", "cut and fill"),
)
def heights(city: City) -> City:
    """Give all ways heights within their grades and clear of each other; grade the terrain.

    A city without bridges, tunnels and relief stays as it is.
    """
    if city.network is None:
        return city
    network, found, terrain = way_heights(city.layout, city.network, city.terrain)
    return replace(city, network=network, heights=found, terrain=terrain)
