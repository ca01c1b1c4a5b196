"""Streets by the land: a pattern slides along slopes, what would still cut the hill is left out.

What is left is joined again by ramps that wind up the hill within their grade.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import Layout, Terrain
from cityx.city.sites import pieces_of
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.parcels.street_patterns import Pattern
from cityx.ground.grades import graded, slopes_of
from cityx.road.network.stations import GRADE, STATION, USUAL_GRADE
from cityx.sources.features.tagged import KIND, Owner
from cityx.town.rebuilding import cleared, with_area

MOVED, MOST = 3.0, 8.0  # metres of earth, 95 % of all and at most, that streets may move
CUT = 2.5  # metres of earth from which a stretch of street is left out
KEPT = 0.9  # of the greatest grade; junctions and curves take the rest
ROUNDS = 60  # of sliding
STRIDE = 3.0  # metres that a point slides at most in one of them
SLID = 0.3  # of a block, that it slides at most in all
EVEN = 0.5  # share of the mean of its neighbours that each point takes over
GENTLE = 0.02  # rise over run below which nothing slides: there is no slope to slide along
SLOPE = 10.0  # metres on both sides over which a slope is taken
STEEP = 0.30  # rise over run, the mean of a block, from which it is left green
SHORE = 14.0  # metres from water, or from where nothing is known, to the middle of a street
SOME = 200  # places of a block at most at which its slope is taken
DIRECTIONS = 6  # of a pattern that are tried, over a right angle


@dataclass(frozen=True)
class Land:
    """What is known of the land before a town is laid on it.

    Attributes
    ----------
    terrain
        Its heights.
    taken
        (k,) polygons on which no town stands, and (k,) what each is: "sea", "void".
    """

    terrain: Terrain
    taken: tuple[tuple[Any, str], ...] = ()

    def about(self, place: FloatArray) -> Land:
        """Return the same land in a frame whose origin is a place."""
        x, y = self.terrain.origin
        terrain = replace(self.terrain, origin=(x - float(place[0]), y - float(place[1])))
        moved = tuple((shapely.transform(shape, lambda p: p - place), kind)
                      for shape, kind in self.taken)  # fmt: skip
        return Land(terrain, moved)

    def within(self, box: tuple[float, float, float, float]) -> Land:
        """Return the same land with what is taken in a box only."""
        site = shapely.box(*box)
        parts = [(part, kind) for shape, kind in self.taken
                 for part in shapely.get_parts(shapely.intersection(shape, site))
                 if part.area > 0]  # fmt: skip
        return replace(self, taken=tuple(parts))

    @property
    def out(self) -> Any:
        """All that is taken, one shape."""
        return shapely.union_all([shape for shape, _ in self.taken])

    def takes(self, links: FloatArray) -> BoolArray:
        """Return which of (m, 2, 2) links come nearer than `SHORE` to what is taken."""
        if not self.taken:
            return np.zeros(len(links), bool)
        return np.asarray(shapely.dwithin(shapely.linestrings(links), self.out, SHORE))


@dataclass(frozen=True)
class Links:
    """Streets as links between nodes, with the greatest grade of each."""

    nodes: FloatArray  # (n, 2)
    links: IntArray  # (m, 2)
    grade: FloatArray  # (m,)


def grade_of(highway: str) -> float:
    """Return the greatest rise over run of a kind of street in a made town."""
    return KEPT * GRADE.get(highway, USUAL_GRADE)


def streets_of(layout: Layout) -> Links:
    """Return the streets of a layout as links between the points of their lines."""
    roads = layout.roads
    lines = shapely.segmentize(roads.geometry.to_numpy(), STATION)
    points, line = shapely.get_coordinates(lines, return_index=True)
    nodes, node = np.unique(np.round(points, 2), axis=0, return_inverse=True)
    first = np.flatnonzero(line[1:] == line[:-1])
    node = node.ravel()
    grade = np.array([grade_of(kind) for kind in roads["kind"]])[line[first]]
    return Links(nodes, np.column_stack([node[first], node[first + 1]]), grade)


def cuts_the_hill(layout: Layout, land: Land) -> bool:
    """Return whether the streets of a layout move more earth than they may."""
    if not len(layout.roads):
        return False
    moved = earth_moved(land.terrain, streets_of(layout))
    return bool(np.percentile(moved, 95) > MOVED or moved.max() > MOST)


def earth_moved(land: Terrain, net: Links) -> FloatArray:
    """Return the metres of cut or fill along links, the most on each, (m,)."""
    _, owner, _, moved = _profile(land, net)
    most = np.zeros(len(net.links))
    np.maximum.at(most, owner, moved)
    return most


def _profile(land: Terrain, net: Links) -> tuple[FloatArray, IntArray, FloatArray, FloatArray]:
    """Return stations along links, the link of each, their graded heights, and metres of earth."""
    a, b = net.nodes[net.links[:, 0]], net.nodes[net.links[:, 1]]
    length = np.hypot(*(b - a).T)
    pieces = np.maximum(np.ceil(length / STATION).astype(np.int64), 1)
    owner = np.repeat(np.arange(len(pieces)), pieces + 1)
    first = np.concatenate([[0], np.cumsum(pieces + 1)[:-1]])
    k = np.arange(len(owner)) - first[owner]
    at = a[owner] + (k / pieces[owner])[:, None] * (b - a)[owner]
    inner = (k > 0) & (k < pieces[owner])
    node = np.where(k == 0, net.links[owner, 0], net.links[owner, 1])
    node = np.where(inner, len(net.nodes) + np.cumsum(inner) - 1, node)
    step = np.flatnonzero(owner[1:] == owner[:-1])
    rise = (length / pieces * net.grade)[owner[step]]
    pairs = np.column_stack([node[step], node[step + 1]])
    soil = np.full(len(net.nodes) + int(inner.sum()), np.nan)
    soil[node] = land.height_at(at)
    z = graded(slopes_of(pairs, rise), soil)
    return at, owner, z[node], np.abs(z - soil)[node]


def slid(pattern: Pattern, land: Terrain, grade: FloatArray, reach: float) -> Pattern:
    """Slide the points of a pattern up and down the land until its streets keep their grades.

    Parameters
    ----------
    pattern
        Links of some metres each.
    grade
        (m,) rise over run that each link may have.
    reach
        Metres that a point may slide in all.
    """
    start, nodes = pattern.nodes, pattern.nodes.copy()
    links = pattern.links
    used = np.unique(links)
    a, b = links.T
    near = np.bincount(a, minlength=len(nodes)) + np.bincount(b, minlength=len(nodes))
    for _ in range(ROUNDS):
        length = np.hypot(*(nodes[a] - nodes[b]).T)
        soil = np.full(len(nodes), np.nan)
        soil[used] = land.height_at(nodes[used])
        wanted = graded(slopes_of(links, length * grade), soil)
        slope = slope_at(land, nodes)
        steep = (slope**2).sum(axis=1)
        move = slope * (np.nan_to_num(wanted - soil) / np.maximum(steep, GENTLE**2))[:, None]
        move[steep < GENTLE**2] = 0.0
        size = np.hypot(*move.T)
        move *= np.minimum(1.0, STRIDE / np.maximum(size, 1e-9))[:, None]
        gone = nodes + move - start
        # Neighbours slide together, or a street would get kinks.
        total = np.column_stack([
            np.bincount(a, gone[b, k], len(nodes)) + np.bincount(b, gone[a, k], len(nodes))
            for k in (0, 1)
        ])  # fmt: skip
        gone = (1 - EVEN) * gone + EVEN * total / np.maximum(near, 1)[:, None]
        far = np.hypot(*gone.T)
        nodes = start + gone * np.minimum(1.0, reach / np.maximum(far, 1e-9))[:, None]
    return replace(pattern, nodes=nodes)


def slope_at(land: Terrain, points: FloatArray, step: float = SLOPE) -> FloatArray:
    """Return (n, 2) rise over run to the east and to the north at some points."""
    found = []
    for way in ((step, 0.0), (0.0, step)):
        rise = land.height_at(points + np.array(way)) - land.height_at(points - np.array(way))
        found.append(rise / (2 * step))
    return np.stack(found, axis=1)


def without_cuts(pattern: Pattern, land: Terrain, grade: FloatArray) -> BoolArray:
    """Choose the links of a pattern that stay, (m,): of those that cut the hill the worst go first.

    Whole stretches between junctions go, and each time the rest is graded anew.
    """
    kept = np.ones(len(pattern.links), bool)
    stretch = stretches_of(pattern.links, len(pattern.nodes))
    while kept.any():
        rows = np.flatnonzero(kept)
        net = Links(pattern.nodes, pattern.links[rows], grade[rows])
        moved = earth_moved(land, net)
        if moved.max() <= CUT:
            break
        # By how much the land under a stretch is steeper than its street may be.
        a, b = pattern.links[rows].T
        run = np.hypot(*(pattern.nodes[a] - pattern.nodes[b]).T)
        z = land.height_at(pattern.nodes[pattern.links[rows].ravel()]).reshape(-1, 2)
        over = np.maximum(np.abs(z[:, 0] - z[:, 1]) - grade[rows] * run, 0.0)
        count = stretch.max() + 1
        excess = np.bincount(stretch[rows], over, minlength=count)
        most = np.zeros(count)
        np.maximum.at(most, stretch[rows], moved)
        bad = np.flatnonzero((most > CUT) & (excess > 0))
        if not len(bad):
            break
        worst = bad[np.argsort(-excess[bad], kind="stable")][: max(1, len(bad) // 8)]
        kept &= ~np.isin(stretch, worst)
    return kept


def stretches_of(links: IntArray, count: int) -> IntArray:
    """Return the stretch between junctions that each link is of, (m,)."""
    degree = np.bincount(links.ravel(), minlength=count)
    end = np.concatenate([links[:, 0], links[:, 1]])
    link = np.tile(np.arange(len(links)), 2)
    order = np.argsort(end, kind="stable")
    end, link = end[order], link[order]
    same = np.flatnonzero((end[1:] == end[:-1]) & (degree[end[1:]] == 2))
    pairs = np.column_stack([link[same], link[same + 1]])
    return np.asarray(np.unique(components(pairs, len(links)), return_inverse=True)[1], np.int64)


def without_taken(layout: Layout, land: Land) -> Layout:
    """Take off a layout what lies on land that is taken, and say there what it is."""
    if not land.taken:
        return layout
    out = land.out
    layout = cleared(layout, out)
    roads = shapely.difference(layout.roads.geometry.to_numpy(), out)
    layout = replace(layout, roads=pieces_of(layout.roads, roads, 1))
    for k, (shape, kind) in enumerate(land.taken):
        owner = Owner(("heights", kind, k), {KIND: kind})
        layout = with_area(layout, kind, shapely.orient_polygons(shape), owner)
    return layout


def along_contours(land: Terrain, half: FloatArray) -> float:
    """Return the direction in which the contours of a site run on the whole, radians."""
    x, y = np.meshgrid(*(np.linspace(-size, size, DIRECTIONS**2) for size in half))
    rise = slope_at(land, np.column_stack([x.ravel(), y.ravel()]))
    # A slope and its opposite are the same direction: twice the angle is summed.
    turn, size = 2 * np.arctan2(rise[:, 1], rise[:, 0]), np.hypot(*rise.T)
    up = 0.5 * np.arctan2((size * np.sin(turn)).sum(), (size * np.cos(turn)).sum())
    return float(up + np.pi / 2)


def is_steep(land: Terrain, shapes: NDArray[Any]) -> BoolArray:
    """Return which polygons are too steep for houses, by the mean slope on them."""
    found = np.zeros(len(shapes), bool)
    for k, shape in enumerate(shapes):
        low_x, low_y, high_x, high_y = shape.bounds
        step = max(SLOPE / 2, float(np.sqrt(shape.area / SOME)))
        x, y = np.meshgrid(np.arange(low_x, high_x + step, step),
                           np.arange(low_y, high_y + step, step))  # fmt: skip
        points = np.column_stack([x.ravel(), y.ravel()])
        points = points[shapely.contains_xy(shape, points)]
        if len(points):
            found[k] = np.hypot(*slope_at(land, points).T).mean() > STEEP
    return found


# The sixteen directions of a ramp on a lattice, counter-clockwise, as steps of columns and rows.
WAYS = np.array([
    (1, 0), (2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1),
    (-1, 0), (-2, -1), (-1, -1), (-1, -2), (0, -1), (1, -2), (1, -1), (2, -1),
])  # fmt: skip
PITCH, ACROSS = 12.0, 160  # metres between the places of a lattice; places along a site at most
TURNS = 3  # of the directions that a ramp may turn by at one place
TURN_COST = 5.0  # metres that a turn by one direction counts for
CLIMB_COST = 1.5  # times the length that a climb of the greatest grade counts for
STEEPER = 1.35  # times its grade that a ramp climbs at most, between places: earth makes it even
BESIDE, BESIDE_COST = 17.0, 4.0  # metres to another street, and times the length counts there
LANDING = (9.0, 27.0)  # metres from a street to the first place of a ramp
SQUARE = np.radians(38.0)  # least angle between a ramp and its street
LONGEST = 1500.0  # metres of a ramp, with what turns and climbs count for
RAMPS = 12  # ramps of a site
LEAST_PART = 90.0  # metres of streets that are worth a ramp
RAMP = 3  # family of streets


def joined_by_ramps(pattern: Pattern, land: Land, grade: float, half: FloatArray) -> Pattern:
    """Join the parts of a net by ramps, each the cheapest way from the largest part to another.

    Parameters
    ----------
    pattern
        Streets about the middle of a site, all of which keep their grades.
    land
        In the same frame.
    grade
        Rise over run of a ramp.
    half
        (2,) metres from the middle of the site to its border.
    """
    refused: set[int] = set()
    for number in range(RAMPS):
        part = components(pattern.links, len(pattern.nodes))
        length = _lengths(pattern.nodes, pattern.links)
        size = np.bincount(part[pattern.links[:, 0]], length, minlength=len(pattern.nodes))
        others = [p for p in np.flatnonzero(size >= LEAST_PART).tolist() if p not in refused]
        if len(others) < 2:
            break
        main = max(others, key=lambda p: size[p])
        inside = (np.abs(pattern.nodes) < half - LANDING[0]).all(axis=1)
        used = np.bincount(pattern.links.ravel(), minlength=len(pattern.nodes)) > 0
        start = np.flatnonzero((part == main) & inside & used)
        goal = np.flatnonzero((part != main) & np.isin(part, others) & inside & used)
        way = _ramp(pattern, land, grade, half, start, goal)
        if way is None:
            refused.add(main)
            continue
        first, points, last = way
        longer = _with_ramp(pattern, first, points, last, number)
        grades = np.full(len(longer.links), grade)
        moved = earth_moved(land.terrain, Links(longer.nodes, longer.links, grades))
        if moved.max(initial=0.0) <= MOVED and _is_clear(pattern, points):
            pattern = longer
        else:
            refused.add(int(part[last]))
    return pattern


def _lengths(nodes: FloatArray, links: IntArray) -> FloatArray:
    return np.asarray(np.hypot(*(nodes[links[:, 0]] - nodes[links[:, 1]]).T))


def _with_ramp(pattern: Pattern, first: int, points: FloatArray, last: int, number: int) -> Pattern:
    count = len(pattern.nodes)
    chain = np.concatenate([[first], count + np.arange(len(points)), [last]])
    links = np.column_stack([chain[:-1], chain[1:]])
    street = np.tile([RAMP, number], (len(links), 1))
    return Pattern(
        np.concatenate([pattern.nodes, points]), np.concatenate([pattern.links, links]),
        np.concatenate([pattern.street, street]),
        np.concatenate([pattern.name, np.column_stack([street[:, 1], np.arange(len(links))])]),
    )  # fmt: skip


def _is_clear(pattern: Pattern, points: FloatArray) -> bool:
    """Return whether a ramp, without its landings, crosses no street."""
    lines = shapely.linestrings(pattern.nodes[pattern.links])
    return not shapely.intersects(lines, shapely.LineString(points)).any()


def _ramp(
    pattern: Pattern, land: Land, grade: float, half: FloatArray, start: IntArray, goal: IntArray
) -> tuple[int, FloatArray, int] | None:
    """Find the cheapest ramp between two sets of nodes: its ends, and the points between them.

    What is searched is the graph of the places of a lattice by the direction in which a ramp
    comes to them, so that turns have their cost and none is sharper than a street can be.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    if not len(start) or not len(goal):
        return None
    lattice = _Lattice.over(pattern, land, half)
    moves = lattice.moves(grade)
    out = _landings(pattern, lattice, start, grade, leaving=True)
    back = _landings(pattern, lattice, goal, grade, leaving=False)
    if not len(out[0]) or not len(back[0]):
        return None
    count = len(lattice.places) * len(WAYS)
    source, sink = count, count + 1
    rows = np.concatenate([moves[0], np.full(len(out[0]), source), back[1]])
    columns = np.concatenate([moves[1], out[1], np.full(len(back[0]), sink)])
    cost = np.concatenate([moves[2], out[2], back[2]])
    # Of parallel links the cheapest counts.
    order = np.lexsort((cost, columns, rows))
    rows, columns, cost = rows[order], columns[order], cost[order]
    new = np.r_[True, (np.diff(rows) != 0) | (np.diff(columns) != 0)]
    graph = coo_array((cost[new], (rows[new], columns[new])), shape=(count + 2, count + 2))
    far, before = dijkstra(graph.tocsr(), indices=source, limit=LONGEST, return_predecessors=True)
    if not np.isfinite(far[sink]):
        return None
    states: list[int] = []
    state = int(before[sink])
    while state != source:
        states.append(state)
        state = int(before[state])
    states.reverse()
    first = _cheapest(out, states[0])
    last = _cheapest(back, states[-1])
    places = lattice.places[np.array(states) // len(WAYS)]
    ends = pattern.nodes[[first, last]]
    return first, _rounded(np.concatenate([ends[:1], places, ends[1:]])), last


def _cheapest(landings: tuple[IntArray, IntArray, FloatArray], state: int) -> int:
    rows = np.flatnonzero(landings[1] == state)
    return int(landings[0][rows[np.argmin(landings[2][rows])]])


def _rounded(points: FloatArray) -> FloatArray:
    """Cut the corners of a line off once; return the points between its ends."""
    a, b = points[:-1], points[1:]
    return np.stack([0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b], axis=1).reshape(-1, 2)[1:-1]


@dataclass(frozen=True)
class _Lattice:
    """Places of a site in rows and columns, their heights, and what going there costs."""

    places: FloatArray  # (p, 2)
    shape: tuple[int, int]
    z: FloatArray  # (p,)
    factor: FloatArray  # (p,), infinite where nothing may lead

    @classmethod
    def over(cls, pattern: Pattern, land: Land, half: FloatArray) -> _Lattice:
        """Lay a lattice over a site."""
        pitch = max(PITCH, 2 * float(half.max()) / ACROSS)
        count = (2 * half / pitch).astype(np.int64) + 1
        x, y = (pitch * (np.arange(n) - (n - 1) / 2) for n in count.tolist())
        grid = np.meshgrid(x, y)
        places = np.column_stack([axis.ravel() for axis in grid])
        points = shapely.points(places)
        streets = shapely.multilinestrings(shapely.linestrings(pattern.nodes[pattern.links]))
        shapely.prepare(streets)
        factor = np.where(shapely.dwithin(points, streets, BESIDE), BESIDE_COST, 1.0)
        if land.taken:
            factor[shapely.dwithin(points, land.out, SHORE)] = np.inf
        z = land.terrain.height_at(places)
        return cls(places, (len(y), len(x)), z, factor)

    def moves(self, grade: float) -> tuple[IntArray, IntArray, FloatArray]:
        """Return how a ramp may go on: states, the states after them, and what each costs."""
        rows, columns = self.shape
        number = np.arange(rows * columns).reshape(rows, columns)
        found: list[tuple[IntArray, IntArray, FloatArray]] = []
        for way, (right, up) in enumerate(WAYS.tolist()):
            here = number[max(-up, 0) : rows - max(up, 0), max(-right, 0) : columns - max(right, 0)]
            here = here.ravel()
            there = here + up * columns + right
            cost, fine = self.cost(here, there, grade)
            here, there, cost = here[fine], there[fine], cost[fine]
            for turn in range(-TURNS, TURNS + 1):
                come = (way - turn) % len(WAYS)
                found.append((here * len(WAYS) + come, there * len(WAYS) + way,
                              cost + TURN_COST * abs(turn)))  # fmt: skip
        a, b, cost = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return a, b, cost

    def cost(self, here: IntArray, there: IntArray, grade: float) -> tuple[FloatArray, BoolArray]:
        """Return what it costs to go from places to others, and whether that may be."""
        run = np.hypot(*(self.places[there] - self.places[here]).T)
        steep = np.abs(self.z[there] - self.z[here]) / run / grade
        factor = np.maximum(self.factor[here], self.factor[there])
        cost = run * factor * (1 + CLIMB_COST * steep**2)
        return cost, np.isfinite(factor) & (steep <= STEEPER)


def _landings(
    pattern: Pattern, lattice: _Lattice, nodes: IntArray, grade: float, *, leaving: bool
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return how ramps may leave streets or come to them: nodes, states and costs."""
    from scipy.spatial import cKDTree

    own = cKDTree(lattice.places)
    near = own.query_ball_point(pattern.nodes[nodes], LANDING[1])
    of = np.repeat(np.arange(len(nodes)), [len(places) for places in near])
    place = np.concatenate([np.array(places, np.int64) for places in near]).astype(np.int64)
    node = nodes[of]
    way = lattice.places[place] - pattern.nodes[node]
    run = np.hypot(*way.T)
    heading = np.arctan2(way[:, 1], way[:, 0])
    fine = (run >= LANDING[0]) & np.isfinite(lattice.factor[place])
    fine &= _apart(pattern, node, heading) >= SQUARE
    z = lattice.z[own.query(pattern.nodes[node])[1]]
    steep = np.abs(lattice.z[place] - z) / np.maximum(run, 1e-9) / grade
    fine &= steep <= 2 * STEEPER
    angle = heading if leaving else heading + np.pi
    turns = np.arctan2(WAYS[:, 1], WAYS[:, 0])
    apart = np.abs((angle[:, None] - turns + np.pi) % (2 * np.pi) - np.pi)
    state = place * len(WAYS) + apart.argmin(axis=1)
    cost = run * (1 + CLIMB_COST * steep**2)
    return node[fine], state[fine], cost[fine]


def _apart(pattern: Pattern, node: IntArray, heading: FloatArray) -> FloatArray:
    """Return the least angle between headings and the links at their nodes, (k,) radians."""
    end = np.concatenate([pattern.links[:, 0], pattern.links[:, 1]])
    other = np.concatenate([pattern.links[:, 1], pattern.links[:, 0]])
    step = pattern.nodes[other] - pattern.nodes[end]
    bearing = np.arctan2(step[:, 1], step[:, 0])
    order = np.argsort(end, kind="stable")
    end, bearing = end[order], bearing[order]
    least = np.full(len(node), np.pi)
    begin, stop = np.searchsorted(end, node), np.searchsorted(end, node, side="right")
    for k in range(int((stop - begin).max(initial=0))):
        rows = np.flatnonzero(begin + k < stop)
        turn = heading[rows] - bearing[begin[rows] + k]
        least[rows] = np.minimum(least[rows], np.abs((turn + np.pi) % (2 * np.pi) - np.pi))
    return least


def stubs_gone(links: IntArray, nodes: FloatArray, free: BoolArray, least: float) -> BoolArray:
    """Choose the links that stay when short stretches with a blind end go, (m,).

    Parameters
    ----------
    free
        (n,) whether a street may end at a node however short it is.
    least
        Metres of a blind street.
    """
    kept = np.ones(len(links), bool)
    length = _lengths(nodes, links)
    while kept.any():
        rows = np.flatnonzero(kept)
        degree = np.bincount(links[rows].ravel(), minlength=len(nodes))
        stretch = stretches_of(links[rows], len(nodes))
        size = np.bincount(stretch, length[rows])
        blind = ((degree == 1) & ~free)[links[rows]].any(axis=1)
        short = np.unique(stretch[blind & (size[stretch] < least)])
        if not len(short):
            break
        kept[rows[np.isin(stretch, short)]] = False
    return kept
