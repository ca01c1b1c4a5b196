"""Heights of ways: grades, clearances, ramps; where the terrain is cut and filled for them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from cityx.city.city import City
from cityx.city.heights import WayHeights, no_heights
from cityx.city.terrain import Profile
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components, interpolate
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import locate, values_along
from cityx.geometry.ranges import counted
from cityx.ground.grades import (
    Gaps,
    Slopes,
    evened,
    fall_to,
    graded,
    parted,
    rise_to,
    slopes_of,
)
from cityx.ground.grading import grade_terrain
from cityx.protocol import Port, action, has_network
from cityx.road.heights.crossings import (
    PARTING,
    Crossings,
    find_crossings,
    over_streets,
    pairs_among,
    parting,
    same_level,
    stacked,
)
from cityx.road.network.contradictions import crossing_notes, notes_on
from cityx.road.network.stations import EDGE, Ways, collect_ways, nearest_station, stations_around
from cityx.system.remembered import Remembered

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork
    from cityx.city.terrain import Terrain


WATER = ("water", "sea", "river", "pool", "wetland")
OVER_WATER = 0.6  # metres above the bank that a deck over water rises
COVER = 0.5  # metres of structure and soil over the clear height of a tunnel
PARTS_BELOW = np.radians(35.0)  # angle between streets that stay one surface for a while
ABREAST = 15.0  # metres over which that angle is taken
CROSSFALL = 0.05  # of the surface between such streets
ROUNDS = 4  # of evening the profile out
KEPT = 0.6  # of the reach over and under other ways in which evening takes nothing
GROUNDED = 0.03  # metres; nearer to the ground a way lies on it
SHORT = 0.05  # metres of clearance, or of a bend, that nobody misses
TOGETHER = 250.0  # metres round a crossing that is too low within which all ways are moved
STAYS = 8.0  # times as much as a path a street keeps its height
WALKS_UNDER = 2.0  # metres of free height; where less would be left, two ways meet instead
STEEPEST = 2.5  # times the grade
STAIRS = 0.6  # grade of what is walked where a path has no room for its grade
EXACT, DIGITS = 1e-4, 4  # metres to which heights are kept, and the digits of that
RELIEF = "terrain/relief-v"  # action that makes land, without its version
ON_MADE_LAND = 0.92  # of the greatest grades


def way_heights(
    layout: Layout, network: RoadNetwork, terrain: Terrain, *, share: float = 1.0
) -> tuple[RoadNetwork, WayHeights, Terrain, tuple[str, ...]]:
    """Give every way a height: within its grade, clear of what it crosses, near the ground.

    The ground's own ways follow the terrain, cut and fill in balance where it is too steep for
    them. Ways of a higher level rise, with their neighbours as far as the grades ask, until they
    clear what they pass over; those of a lower level sink likewise. Of all profiles that keep the
    grades these move least. Where the map leaves no room for one way to pass over another, they
    meet at one height.

    Parameters
    ----------
    share
        Of the greatest grade of each way, that it keeps.

    Returns
    -------
    network
        The same graph with heights; stations are added where it leaves the ground.
    heights
        All pieces of ways off the ground, paths and tracks among them.
    terrain
        The terrain with the cut and fill of its roads.
    notes
        Where the map contradicts itself, and what was built there.
    """
    ways = collect_ways(layout, network, everywhere=not terrain.is_flat)
    if ways is None:
        return network, no_heights(), terrain, notes_on(layout, network)
    ways = _one_surface(replace(ways, grade=share * ways.grade))
    crossing = find_crossings(ways)
    z, soil, lift, graded_terrain = _solved(layout, ways, crossing, terrain)
    gap = _gaps(ways, crossing, z)
    short, closed = gap < -SHORT, gap + ways.clear[crossing.lower] < WALKS_UNDER
    closed &= short
    short &= ~crossing.between(crossing.pairs[closed])
    told = notes_on(layout, network, ways, crossing, np.where(short, gap, 0.0), closed)
    if closed.any():
        ways, crossing = _meeting(ways, crossing, closed)
        z, soil, lift, graded_terrain = _solved(layout, ways, crossing, terrain)
    heights = _pieces(ways, z, soil, lift)
    network = _with_heights(network, ways, graded_terrain, z, lift)
    return network, heights, graded_terrain, told


def kept_share(city: City) -> float:
    """Return the share of their greatest grades that streets keep: less on land that was made.

    Cut and fill smooth a profile; where the land was asked for, no map says that it is steeper.
    """
    made = any(action.startswith(RELIEF) for action in city.made)
    return ON_MADE_LAND if made else 1.0


@dataclass(frozen=True)
class _Steps:
    """Pairs of stations that bear on each other's height, k of them."""

    pairs: IntArray  # (k, 2)
    run: FloatArray  # (k,) metres
    rise: FloatArray  # (k,) metres at the grade of the way
    way: IntArray  # (k,)


def _steps(ways: Ways, crossing: Crossings) -> _Steps:
    """List the stations that follow each other, and those side by side on one surface."""
    owner = ways.owner
    first = np.flatnonzero(owner[1:] == owner[:-1])
    run = ways.along[first + 1] - ways.along[first]
    across, across_run = _across(ways)
    meet, meet_run = _overlapping(ways, crossing)
    return _Steps(
        ways.node[np.concatenate([np.column_stack([first, first + 1]), across, meet])],
        np.concatenate([run, across_run, meet_run]),
        np.concatenate([run * ways.grade[owner[first]], CROSSFALL * across_run,
                        meet_run * ways.grade[owner[meet[:, 1]]]]),
        np.concatenate([owner[first], owner[across[:, 0]], owner[meet[:, 0]]]),
    )  # fmt: skip


def _solved(
    layout: Layout, ways: Ways, crossing: Crossings, terrain: Terrain
) -> tuple[FloatArray, FloatArray, FloatArray, Terrain]:
    """Find the height of each node, that of the ground there, the difference; grade the terrain."""
    steps, place = _steps(ways, crossing), ways.place
    on_ground = _grounded(ways)
    soil = terrain.height_at(place)
    base = soil
    if not terrain.is_flat:
        steps, base = _on_land(ways, steps, on_ground, soil, terrain.streets)
        terrain = grade_terrain(terrain, *_profiles(ways, base), layout.extent)
        soil = terrain.height_at(place)
        base = np.where(on_ground, soil, _spanned(steps, on_ground, base))
    z = _cleared(layout, ways, crossing, steps, base, soil, on_ground)
    lift = np.where(on_ground & (np.abs(z - base) < EXACT), 0.0, z - soil)
    return np.round(soil + lift, DIGITS), soil, lift, terrain


def _on_land(
    ways: Ways, steps: _Steps, on_ground: BoolArray, soil: FloatArray, streets: Profile | None
) -> tuple[_Steps, FloatArray]:
    """Return how steep ways may be on a terrain, and the height of each node within that.

    Where heights of streets are known they stay as they are.
    """
    steps = replace(steps, rise=np.maximum(steps.rise, _climbed(ways, soil, steps)))
    land = np.where(on_ground, soil, np.nan)
    if streets is None:
        return steps, graded(slopes_of(steps.pairs, steps.rise), land)
    given = np.where(on_ground, streets.at(ways.place), np.nan)
    piece = components(steps.pairs, ways.count)
    held = np.bincount(piece, np.isfinite(given), minlength=ways.count) > 0
    # What is known was rounded, so its grades are kept but for that.
    slopes = slopes_of(steps.pairs, steps.rise + 2 * EXACT)
    return steps, np.round(graded(slopes, np.where(held[piece], given, land)), DIGITS)


def street_profile(
    layout: Layout, network: RoadNetwork, height_at: Callable[[FloatArray], FloatArray]
) -> Profile:
    """Return the heights on the ground of all streets, paths and railways of a map.

    They keep the grade of each, which asks for land and streets however far away. Tiles of the map
    that are given them (`Terrain.streets`) have the same heights, whatever they see of it.

    Parameters
    ----------
    layout, network
        Of the whole map.
    height_at
        Returns the (n,) heights of the land at (n, 2) places, metres.
    """
    ways = collect_ways(layout, network, everywhere=True)
    if ways is None:
        return Profile.of(np.zeros((0, 2)), np.zeros(0))
    ways = _one_surface(ways)
    on_ground = _grounded(ways)
    soil = height_at(ways.place)
    _, base = _on_land(ways, _steps(ways, find_crossings(ways)), on_ground, soil, None)
    return Profile.of(ways.place[on_ground], np.round(base[on_ground], DIGITS))


def _grounded(ways: Ways) -> BoolArray:
    """(n,) whether nodes belong to a way on the ground."""
    on_ground = np.zeros(ways.count, bool)
    on_ground[ways.node[(ways.level == 0)[ways.owner]]] = True
    return on_ground


def _climbed(ways: Ways, soil: FloatArray, steps: _Steps) -> FloatArray:
    """(k,) what paths on the ground climb with it, metres: nobody cuts a hill for a path."""
    path = (ways.light & (ways.level == 0))[steps.way]
    return np.where(path, np.abs(soil[steps.pairs[:, 1]] - soil[steps.pairs[:, 0]]), 0.0)


def _one_surface(ways: Ways) -> Ways:
    """Make streets of one level off the ground that cross without a node meet at one height."""
    _, _, here, there = same_level(ways, off=True)
    if not len(here):
        return ways
    node = components(ways.node[np.column_stack([here, there])], ways.count)[ways.node]
    return replace(ways, node=node)


def _meeting(ways: Ways, crossing: Crossings, closed: BoolArray) -> tuple[Ways, Crossings]:
    """Make the ways of some crossings meet at one height instead.

    Where one goes on lying under the other they are one surface until grades have parted them.
    """
    lower, pairs = crossing.lower[closed], crossing.pairs[closed]
    stations = np.column_stack([crossing.upper_node[closed], crossing.lower_node[closed]])
    beside = over_streets(ways)[0].T
    beside = beside[pairs_among(beside[:, :2], pairs)]
    same = (beside[:, None, :2] == pairs).all(axis=2)
    spots = ways.lines.points[beside[:, 3]][:, None] - ways.lines.points[stations[:, 1]]
    near = np.hypot(*np.moveaxis(spots, 2, 0)) < crossing.need[closed] / ways.grade[lower]
    stations = np.concatenate([stations, beside[(same & near).any(axis=1), 2:]])
    node = components(ways.node[stations], ways.count)[ways.node]
    return replace(ways, node=node), crossing.take(~crossing.between(pairs))


def _profiles(
    ways: Ways, base: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return places, heights, slopes and half widths of the stations of ways on the ground."""
    own = np.flatnonzero((ways.level == 0)[ways.owner])
    points, z, owner = ways.lines.points, base[ways.node], ways.owner[own]
    before = np.maximum(own - 1, ways.lines.start[owner])
    after = np.minimum(own + 1, ways.lines.start[owner + 1] - 1)
    step = points[after] - points[before]
    square = np.maximum((step**2).sum(axis=1), EXACT)
    climb = step * ((z[after] - z[before]) / square)[:, None]
    return points[own], z[own], climb, ways.half[owner]


def _across(ways: Ways) -> tuple[IntArray, FloatArray]:
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
    ahead = np.where(side == 0, 1.0, -1.0) * np.minimum(ABREAST, ways.length[way])
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
    station, row = stations_around(ways, foot[flat], np.full(len(flat), PARTING))
    one, other = one[row], other[row]
    spots = shapely.points(lines.points[station])
    far = shapely.distance(ways.shapes[other], spots)
    close = far < ways.reach[one] + ways.half[other] + 0.5
    # Where they come near again, once apart, each has its own height.
    walked = np.abs(ways.along[station] - ways.along[foot[flat]][row])
    apart = np.full(len(flat), np.inf)
    np.minimum.at(apart, row[~close], walked[~close])
    near = close & (far > 0.0) & (walked < apart[row])
    station, other, far = station[near], other[near], far[near]
    facing = nearest_station(ways, other, lines.points[station])
    return np.column_stack([station, facing]), np.maximum(far, 0.5)


def _overlapping(ways: Ways, crossing: Crossings) -> tuple[IntArray, FloatArray]:
    """Pair stations of streets and rails, not on bridges, with ways in whose width they lie too.

    Ways of which one, or what it goes on as, passes over the other are left out, and those that
    part there from a node they share: `_across` knows how far they are one surface.

    Returns
    -------
    pairs, run
        (k, 2) stations, and (k,) metres between them.
    """
    way, station = _LYING.get(
        lambda: _lying_in(ways), [ways.lines, ways.half, ways.level, ways.light]
    )
    other = ways.owner[station]
    near = ~parting(ways, way, station)
    near &= ~np.isin(way * ways.lines.count + other, _passing(ways, crossing))
    way, station = way[near], station[near]
    facing = nearest_station(ways, way, ways.lines.points[station])
    run = np.hypot(*(ways.lines.points[station] - ways.lines.points[facing]).T)
    return np.column_stack([station, facing]), np.maximum(run, 0.5)


_LYING: Remembered[tuple[IntArray, IntArray]] = Remembered()


def _lying_in(ways: Ways) -> tuple[IntArray, IntArray]:
    """Return ways, and stations of others of their level that lie in their width."""
    flat = ~ways.light & (ways.level <= 0)
    street, station = np.flatnonzero(flat), np.flatnonzero(flat[ways.owner])
    spots = shapely.points(ways.lines.points[station])
    half = ways.half / 2
    way, spot = shapely.STRtree(spots).query(
        ways.shapes[street], predicate="dwithin", distance=ways.half[street] + half.max(initial=0)
    )
    way, station, spots = street[way], station[spot], spots[spot]
    other = ways.owner[station]
    near = shapely.distance(ways.shapes[way], spots) < ways.half[way] + half[other]
    near &= (way != other) & (ways.level[way] == ways.level[other])
    return way[near], station[near]


def _passing(ways: Ways, crossing: Crossings) -> IntArray:
    """Return the pairs of ways, as numbers, of which one or what it goes on as crosses the other.

    A street that sinks to a tunnel, or comes down from a bridge, is on its way to another level
    where the map does not say so yet; what only meets the corner of that tunnel or bridge is not.
    """
    lines, count = ways.lines, ways.lines.count
    ends = ways.node[np.concatenate([lines.start[:-1], lines.start[1:] - 1])]
    way = np.tile(np.arange(count), 2)
    order = np.argsort(ends, kind="stable")
    begin, end = (np.searchsorted(ends[order], ends, side) for side in ("left", "right"))
    row, number = counted(end - begin)
    onward = np.unique(np.column_stack([way[row], way[order[begin[row] + number]]]), axis=0)
    first = np.searchsorted(onward[:, 0], np.arange(count + 1))
    direct = np.unique(np.column_stack([crossing.upper, crossing.lower]), axis=0)
    wide = ways.half[direct].sum(axis=1)
    upper, lower = ways.shapes[direct].T
    along = shapely.length(shapely.intersection(lower, shapely.buffer(upper, wide)))
    crossed = direct[along > 2 * wide]
    one, other = np.concatenate([crossed, crossed[:, ::-1]]).T
    row, number = counted(np.diff(first)[one])
    by_end = np.column_stack([onward[first[one[row]] + number, 1], other[row]])
    pairs = np.concatenate([direct, by_end])
    keys = np.concatenate([pairs @ [count, 1], pairs @ [1, count]])
    return np.asarray(np.unique(keys), np.int64)


def _spanned(steps: _Steps, on_ground: BoolArray, base: FloatArray) -> FloatArray:
    """Make bridges and tunnels run evenly from one place on the ground to the next."""
    piece = components(steps.pairs, len(base))
    held = np.bincount(piece, on_ground, minlength=len(base)) > 0
    rise = np.maximum(steps.rise, 1e-3)
    return interpolate(steps.pairs, rise, on_ground | ~held[piece], base)


def _cleared(
    layout: Layout,
    ways: Ways,
    crossing: Crossings,
    steps: _Steps,
    base: FloatArray,
    soil: FloatArray,
    on_ground: BoolArray,
) -> FloatArray:
    """Raise and sink ways until each clears what it crosses.

    Where moving one level after the other leaves a crossing too low, all ways about it are moved
    together, as little as can be, and only where that is not enough they are steeper than usual.
    """
    wet, street = _over_water(layout, ways), _in_streets(ways)
    slopes = slopes_of(steps.pairs, steps.rise)
    z = _swept(ways, crossing, slopes, base, soil, on_ground, wet, street)
    short = np.flatnonzero(_gaps(ways, crossing, z) < -SHORT)
    if not len(short):
        return z
    middle = ways.place[ways.node[crossing.upper_node[short]]]
    free = near_any(ways.place, shapely.points(middle), TOGETHER)
    most = np.where(
        ways.light[steps.way], np.maximum(STAIRS * steps.run, steps.rise), STEEPEST * steps.rise
    )
    # A path in a carriageway goes on lying in it.
    pairs = np.concatenate([steps.pairs, _on_streets(ways, street)])
    level = np.abs(np.diff(z[pairs[len(most) :]], axis=1)[:, 0]) + GROUNDED
    slopes = slopes_of(pairs, np.concatenate([steps.rise, level]))
    steepest = slopes_of(pairs, np.concatenate([most, level]))
    weight = np.ones(ways.count)
    weight[ways.node[~ways.light[ways.owner]]] = STAYS
    floor = np.full(ways.count, -np.inf)
    floor[ways.node[wet]] = soil[ways.node[wet]] + OVER_WATER
    gaps = _all_gaps(ways, crossing).and_those(stacked(ways, z))
    return parted(slopes, z, gaps, more=steepest.rise - slopes.rise,
                  weight=weight, floor=floor, free=free)  # fmt: skip


def _all_gaps(ways: Ways, crossing: Crossings) -> Gaps:
    """List the stations of which one must lie above the other, about all crossings."""
    over, under = crossing.upper_node, crossing.lower_node
    wide, row = stations_around(ways, over, crossing.wide)
    deep, line = stations_around(ways, under, crossing.under)
    return Gaps(
        ways.node[np.concatenate([wide, over[line]])],
        ways.node[np.concatenate([under[row], deep])],
        crossing.need[np.concatenate([row, line])],
    )


def _gaps(ways: Ways, crossing: Crossings, z: FloatArray) -> FloatArray:
    """(c,) metres from the lower surface to the upper, less what is needed."""
    upper, lower = ways.node[crossing.upper_node], ways.node[crossing.lower_node]
    return np.asarray(z[upper] - z[lower] - crossing.need)


def _swept(
    ways: Ways,
    crossing: Crossings,
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
    z = _sunk(ways, slopes, z, soil, on_ground, tunnels)
    upper, lower = crossing.high, crossing.low
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
        # A mouth that sank for a crossing near it lets its tunnel go down sooner.
        own = ways.node[(ways.tunnel & (ways.level == level))[ways.owner]]
        z = _sunk(ways, slopes, z, soil, on_ground, own)
    for level in np.unique(np.concatenate([upper[upper > 0], ways.level[ways.level > 0]])):
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
    ways: Ways, slopes: Slopes, z: FloatArray, soil: FloatArray,
    on_ground: BoolArray, tunnels: IntArray,
) -> FloatArray:  # fmt: skip
    """Lower tunnels from their mouths until the ground closes over them."""
    inside = np.zeros(ways.count, bool)
    inside[tunnels] = True
    mouth = inside & on_ground
    depth = np.full(ways.count, -np.inf)
    np.maximum.at(depth, ways.node, (ways.clear + COVER)[ways.owner])
    own = slopes.take(inside[slopes.pairs].all(axis=1))
    lowest = rise_to(own, np.where(mouth, z, -np.inf))
    closed = np.minimum(z, np.maximum(soil - depth, lowest))
    return np.asarray(np.where(inside & ~mouth, closed, z))


def _in_streets(ways: Ways) -> IntArray:
    """Return the stations of paths on the ground that lie in a carriageway: they stay there."""
    owner = ways.owner
    cars = np.flatnonzero((ways.edge >= 0) & (ways.level == 0))
    paths = np.flatnonzero((ways.light & (ways.level == 0))[owner])
    shapes = ways.shapes[cars]
    tree = shapely.STRtree(shapely.points(ways.lines.points[paths]))
    near = tree.query(shapes, predicate="dwithin", distance=ways.half[cars] + EDGE)[1]
    return np.asarray(paths[np.unique(near)])


def _on_streets(ways: Ways, station: IntArray) -> IntArray:
    """(k, 2) nodes of stations of paths, and of those of the carriageways in which they lie."""
    cars = np.flatnonzero((ways.edge >= 0) & (ways.level == 0))
    spots = ways.lines.points[station]
    far = ways.half[cars] + EDGE
    way, row = shapely.STRtree(shapely.points(spots)).query(ways.shapes[cars], "dwithin", far)
    facing = nearest_station(ways, cars[way], spots[row])
    return np.column_stack([ways.node[station[row]], ways.node[facing]])


def _over_water(layout: Layout, ways: Ways) -> IntArray:
    """Return the stations of bridges that stand in water."""
    wet = layout.areas["kind"].isin(WATER).to_numpy()
    high = np.flatnonzero((ways.level > 0)[ways.owner])
    if not wet.any() or not len(high):
        return np.zeros(0, np.int64)
    tree = shapely.STRtree(layout.areas.geometry.to_numpy()[wet])
    found = tree.query(shapely.points(ways.lines.points[high]), predicate="intersects")[0]
    return np.asarray(np.unique(high[found]))


def _asked(
    ways: Ways, crossing: Crossings, rows: BoolArray, z: FloatArray, spread: float
) -> FloatArray:
    """(n,) height that stations over other ways must reach."""
    pick = np.flatnonzero(rows)
    need = z[ways.node[crossing.lower_node[pick]]] + crossing.need[pick]
    return _highest(ways, crossing.upper_node[pick], spread * crossing.wide[pick], need)


def _asked_below(
    ways: Ways, crossing: Crossings, rows: BoolArray, z: FloatArray, spread: float
) -> FloatArray:
    """(n,) height that stations under other ways must not exceed."""
    pick = np.flatnonzero(rows)
    need = z[ways.node[crossing.upper_node[pick]]] - crossing.need[pick]
    return -_highest(ways, crossing.lower_node[pick], spread * crossing.under[pick], -need)


def _highest(ways: Ways, station: IntArray, reach: FloatArray, height: FloatArray) -> FloatArray:
    """(n,) the highest of what is asked about stations at each node; minus infinity for nothing."""
    wanted = np.full(ways.count, -np.inf)
    near, which = stations_around(ways, station, reach)
    np.maximum.at(wanted, ways.node[near], height[which])
    return wanted


def _off(ways: Ways, lift: FloatArray) -> BoolArray:
    """(p,) whether each station belongs to a structure: off the ground, or next to such a one."""
    high = np.abs(lift[ways.node]) > GROUNDED
    off = high.copy()
    owner = ways.owner
    same = owner[1:] == owner[:-1]
    off[1:] |= high[:-1] & same
    off[:-1] |= high[1:] & same
    return np.asarray(off)


def _with_heights(
    network: RoadNetwork, ways: Ways, terrain: Terrain, z: FloatArray, lift: FloatArray
) -> RoadNetwork:
    """Return the network with heights, and stations on edges that bend or leave the ground."""
    edge_of = ways.edge[ways.owner]
    moved = np.zeros(network.edge_count, bool)
    station = np.flatnonzero(edge_of >= 0)
    straight = values_along(
        network.lines, terrain.height_at(network.points), edge_of[station], ways.along[station]
    )
    bent = np.abs(z[ways.node[station]] - straight) > SHORT
    moved[edge_of[station[bent | _off(ways, lift)[station]]]] = True
    old = np.repeat(np.arange(network.edge_count), np.diff(network.point_start))
    new = station[moved[edge_of[station]]]
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


def _pieces(ways: Ways, z: FloatArray, soil: FloatArray, lift: FloatArray) -> WayHeights:
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
        "What is crossed sinks only where the way above has no room to rise.",
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
        return replace(city, terrain=replace(city.terrain, streets=None))
    network, found, terrain, told = way_heights(
        city.layout, city.network, city.terrain, share=kept_share(city)
    )
    notes = city.notes + told + crossing_notes(city.layout, network, found)
    terrain = replace(terrain, streets=None)  # the network has them now
    return replace(city, network=network, heights=found, terrain=terrain, notes=notes)
