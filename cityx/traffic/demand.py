"""Travel demand: trips between the borders of a site and buildings along its streets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.palettes import GROUPS, groups_of
from cityx.city.city import City
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths
from cityx.ids import choose, draw, hash_ids, id_text, uniform
from cityx.traffic.kinds import DRIVING, LARGE, shares_on
from cityx.traffic.simulation import Group, Look, Trip
from cityx.traffic.streets import Lane, Streets, Way

EVEN = (5.0**0.5 - 1.0) / 2.0  # steps of which numbers from 0 to 1 stay evenly spread
DENSITIES = ("none", "light", "medium", "heavy")
# Class of road -> vehicles on a kilometre of street when traffic is light, medium and heavy. Heavy
# is 12 to 15 on each of the four lanes of a main road, one every seventy metres and queues besides,
# and 8 on each of the two of a side street, as at the peaks of a large city.
PER_KM: Mapping[str, tuple[float, float, float]] = MappingProxyType(
    {
        "motorway": (8.0, 22.0, 70.0), "trunk": (8.0, 20.0, 66.0), "primary": (7.0, 18.0, 60.0),
        "secondary": (6.0, 14.0, 48.0), "tertiary": (4.5, 10.0, 32.0),
        "unclassified": (2.5, 6.0, 20.0), "residential": (2.0, 5.0, 16.0),
        "living_street": (1.0, 2.0, 6.0), "service": (0.5, 1.0, 2.5),
    }
)  # fmt: skip
OTHER_ROADS = "residential"
# Share of the busiest hour's traffic in each hour of a working day, usual counts of city streets.
BY_HOUR = (0.12, 0.08, 0.06, 0.06, 0.10, 0.25, 0.55, 0.90, 1.00, 0.80, 0.72, 0.74, 0.78, 0.78, 0.80,
           0.88, 0.98, 1.00, 0.90, 0.70, 0.52, 0.42, 0.32, 0.20)  # fmt: skip
THROUGH = 0.6  # of the trips pass the site
ALL_DAY_HOME = 0.4  # of the floor area of homes that trips start or end at in any hour
ON_AND_ON = ("motorway", "trunk", "primary", "secondary", "tertiary")  # never dead ends in truth
MOTORWAY, CYCLES = "motorway", list(DRIVING).index("bicycle")
HOMES = ("house", "flats")
NEAR = 60.0  # metres from a building to the street that its trips start from
BORDER = 12.0  # metres from the site's rectangle within which a street leaves it
WIDE_ENOUGH = 2.9  # metres of a lane for lorries and buses
LONG_ENOUGH = 12.5  # metres of a way for them: on a shorter one they would stand across a junction
PEAK = 0.45  # of what is heavy, that there is in the busiest hour of a usual day
MOST_PER_LANE = 24.0  # vehicles on a kilometre of lane; with more, signals no longer clear queues
SPARE = 1.6  # times the trips that are expected to be needed
LEAST_TRIPS = 40  # per group of streets
DRAWS = (2, 2, 2)  # times as many trips are drawn while they do not last
JITTER = 0.25  # of the time along a way by which drivers' minds differ
VARIANTS = 3  # of those minds
CORNER_S = 4.0  # seconds that a junction costs


@dataclass(frozen=True)
class Demand:
    """What is sent into the streets.

    Attributes
    ----------
    looks
        Types of vehicles.
    groups
        Streets to be kept full, and the trips for it.
    barred
        Names of ways that are not driven.
    tight
        Links that lorries and buses do not take.
    """

    looks: tuple[Look, ...]
    groups: tuple[Group, ...]
    barred: tuple[str, ...]
    tight: tuple[int, ...]


def per_km_at(density: str, hour: float) -> dict[str, float]:
    """Return vehicles per kilometre of each class of road.

    Parameters
    ----------
    density
        One of `DENSITIES`, or "usual" for what the hour brings.
    hour
        Of the day.
    """
    if density == "none":
        return dict.fromkeys(PER_KM, 0.0)
    if density == "usual":
        share = float(np.interp(hour % 24.0, np.arange(25), [*BY_HOUR, BY_HOUR[0]]))
        return {road: share * heavy * PEAK for road, (_, _, heavy) in PER_KM.items()}
    column = DENSITIES.index(density) - 1
    return {road: values[column] for road, values in PER_KM.items()}


def demand_of(
    city: City, streets: Streets, looks: Mapping[str, tuple[tuple[Look, float], ...]], *,
    per_km: Mapping[str, float], hour: float, seconds: float, purpose: str,
    cyclists: tuple[float, ...] = (), mix: Mapping[str, float] = MappingProxyType({}),
) -> Demand:  # fmt: skip
    """Draw the trips that keep the streets of a city as full as asked.

    Parameters
    ----------
    city, streets
        The city and its streets.
    looks
        Kind of vehicle to its looks and their shares.
    per_km
        Vehicles per kilometre of street by class of road.
    hour
        Of the day; in the morning trips start at homes, in the evening they end there.
    seconds
        How long the streets are to be kept full.
    purpose
        Key of all draws, the id of the action.
    cyclists
        Share of bicycles on main and on minor streets, () for what is usual.
    mix
        Shares of kinds of vehicles that are to hold whatever is usual.

    Returns
    -------
    demand
        Trips in the order in which they are sent.
    """
    net = Drivable(city, streets)
    every = tuple(look for choices in looks.values() for look, _ in choices)
    roads = sorted({net.road(way) for way in streets.ways})
    targets = {}
    for road in roads:
        asked = per_km.get(road, per_km[OTHER_ROADS]) * net.kilometres(road)
        targets[road] = round(min(asked, MOST_PER_LANE * net.lane_kilometres(road)))
    count = _needed(net, per_km, seconds)
    for more in (*DRAWS, 0):
        trips = _trips(city, net, looks, every, hour=hour, purpose=purpose, count=count,
                       cyclists=cyclists, mix=mix)  # fmt: skip
        if not more or _enough(net, trips, targets, seconds):
            break
        count *= more
    groups = []
    for road in roads:
        own = [way.name for way in streets.ways if net.road(way) == road]
        mine = tuple(trip for trip, on in trips if on == road)
        if targets[road] and mine:
            groups.append(Group(tuple(own), targets[road], mine))
    return Demand(every, tuple(groups), net.barred, net.tight)


class Drivable:
    """The streets as a graph of ways; a class for what is found once."""

    def __init__(self, city: City, streets: Streets) -> None:
        assert city.network is not None
        self.city, self.streets = city, streets
        kinds = city.layout.roads["kind"].to_numpy().astype(str)[city.network.edge_road]
        self._road = np.char.replace(kinds, "_link", "")
        self._class = np.where(np.isin(self._road, list(PER_KM)), self._road, OTHER_ROADS)
        self.length = np.array([way.length for way in streets.ways])
        points = Polylines(city.network.points[:, :2], city.network.point_start)
        self._edge_length = arc_lengths(points)[1]
        self.usable = self._usable()

    def road(self, way: Way) -> str:
        """Return the class of road of a way, a key of `PER_KM`."""
        return str(self._class[way.edge])

    def kilometres(self, road: str) -> float:
        """Return the length of the streets of a class with junctions, both directions as one."""
        edges = {way.edge for way in self.streets.ways if self.road(way) == road}
        return float(sum(self._edge_length[edge] for edge in edges)) / 1000.0

    def lane_kilometres(self, road: str) -> float:
        """Return the length of all lanes that cars use on the streets of a class."""
        ways = zip(self.streets.ways, self.usable.tolist(), strict=True)
        length = sum(
            float(self._edge_length[way.edge]) * sum(lane.public for lane in way.lanes)
            for way, usable in ways
            if usable and self.road(way) == road
        )
        return length / 1000.0

    def _usable(self) -> BoolArray:
        """(w,) whether cars drive along a way; a narrow one is driven in one direction alone.

        Passages through buildings are closed by their walls in every view.
        """
        network = self.city.network
        assert network is not None
        row = network.edge_road[[way.edge for way in self.streets.ways]]
        ids = self.city.layout.roads["id"].to_numpy(np.uint64)[row]
        onward = uniform(self.city.seed, "traffic/narrow", ids) < 0.5
        passage = self.city.layout.roads["passage"].to_numpy(bool)[row]
        open_to_cars, narrow, back = (
            np.array([test(way) for way in self.streets.ways], bool)
            for test in (
                lambda way: any(lane.public for lane in way.lanes),
                lambda way: any(lane.narrow for lane in way.lanes),
                lambda way: way.name.startswith("-"),
            )
        )
        return np.asarray(open_to_cars & ~passage & (~narrow | (back != onward)))

    @property
    def barred(self) -> tuple[str, ...]:
        """Names of the ways that no car uses."""
        ways = zip(self.streets.ways, self.usable.tolist(), strict=True)
        return tuple(way.name for way, usable in ways if not usable)

    @cached_property
    def wide(self) -> BoolArray:
        """(w,) whether lorries and buses use a way."""
        wide = [
            self.road(way) not in ("service", "living_street")
            and way.length >= LONG_ENOUGH
            and any(_for_large(lane) for lane in way.lanes)
            for way in self.streets.ways
        ]
        return np.asarray(self.usable & np.array(wide, bool))

    @cached_property
    def tight(self) -> tuple[int, ...]:
        """Links that lorries and buses do not take: tight ones, and those onto ways too narrow."""
        return tuple(
            number for number, link in enumerate(self.streets.links)
            if link.tight or not self.wide[link.target[0]]
        )  # fmt: skip

    @cached_property
    def pairs(self) -> IntArray:
        """(k, 2) ways that lead into each other for cars."""
        return self._pairs(self.usable, large=False)

    @cached_property
    def wide_pairs(self) -> IntArray:
        """(k, 2) ways that lead into each other for lorries and buses."""
        return self._pairs(self.wide, large=True)

    def _pairs(self, open_ways: BoolArray, *, large: bool) -> IntArray:
        found = {
            (link.source[0], link.target[0])
            for link in self.streets.links
            if all(self._open(end) for end in (link.source, link.target))
            and not (large and link.tight)
        }
        pairs = np.array(sorted(found), np.int64).reshape(-1, 2)
        return np.asarray(pairs[open_ways[pairs].all(axis=1)])

    def _open(self, end: tuple[int, int]) -> bool:
        return self.streets.ways[end[0]].lanes[end[1]].public

    @cached_property
    def seconds(self) -> FloatArray:
        """(w,) time along each way."""
        speed = [max(lane.speed for lane in way.lanes) for way in self.streets.ways]
        return np.asarray(self.length / np.maximum(speed, 1.0) + CORNER_S)

    def matrix(self, variant: int, *, large: bool = False) -> Any:
        """Seconds from way to way, as one kind of driver sees them."""
        from scipy.sparse import csr_array

        pairs = self.wide_pairs if large else self.pairs
        keys = np.array([way.edge for way in self.streets.ways], np.uint64)
        mind = 1.0 + JITTER * uniform(self.city.seed, "traffic/mind", keys, variant)
        weight = (self.seconds * mind)[pairs[:, 1]]
        size = len(self.streets.ways)
        return csr_array((weight, (pairs[:, 0], pairs[:, 1])), shape=(size, size))

    @cached_property
    def lines(self) -> tuple[IntArray, NDArray[Any]]:
        """(u,) ways that are used, and (u,) their lines on the ground."""
        rows = np.flatnonzero(self.usable)
        lines = [shapely.LineString(self.streets.ways[row].lanes[-1].shape[:, :2])
                 for row in rows.tolist()]  # fmt: skip
        return rows, np.array(lines, object)

    @cached_property
    def entries(self) -> BoolArray:
        """(w,) ways that nothing leads into: there one comes from beyond the site."""
        return self.usable & ~np.isin(np.arange(len(self.usable)), self.pairs[:, 1])

    @cached_property
    def exits(self) -> BoolArray:
        """(w,) ways that lead into nothing."""
        return self.usable & ~np.isin(np.arange(len(self.usable)), self.pairs[:, 0])

    def at_border(self, ways: BoolArray, end: int) -> BoolArray:
        """(w,) which of some ways begin (0) or end (-1) where the site or its map does."""
        places = np.array([way.lanes[-1].shape[end, :2] for way in self.streets.ways])
        xmin, ymin, xmax, ymax = self.city.layout.extent
        inside = np.column_stack([places - (xmin, ymin), (xmax, ymax) - places]).min(axis=1)
        onward = np.isin([self.road(way) for way in self.streets.ways], ON_AND_ON)
        return np.asarray(ways & (onward | (inside < BORDER)))

    @cached_property
    def floors(self) -> FloatArray:
        """(w, 2) square metres of homes and of all else whose traffic uses a way."""
        parts = self.city.layout.parts
        found = np.zeros((len(self.streets.ways), 2))
        if not len(parts) or not self.usable.any():
            return found
        group = groups_of(self.city.layout, self.city.seed)
        shapes = parts.geometry.to_numpy()
        area = shapely.area(shapes) * np.maximum(parts["levels"].to_numpy(float), 1.0)
        rows, lines = self.lines
        part, line = shapely.STRtree(lines).query_nearest(shapes, max_distance=NEAR,
                                                          all_matches=False)  # fmt: skip
        at_work = ~np.isin(group[part], [GROUPS.index(word) for word in HOMES])
        np.add.at(found, (rows[line], at_work.astype(int)), area[part])
        return found


def _for_large(lane: Lane) -> bool:
    """Return whether lorries and buses use a lane."""
    return lane.public and lane.width >= WIDE_ENOUGH and not lane.tight


def _needed(net: Drivable, per_km: Mapping[str, float], seconds: float) -> int:
    """Trips that keep the streets full, by how long one stays in them."""
    roads = sorted({net.road(way) for way in net.streets.ways})
    target = sum(per_km.get(road, per_km[OTHER_ROADS]) * net.kilometres(road) for road in roads)
    stay = max(30.0, 0.25 * float(net.seconds[net.usable].sum()))
    stay = min(stay, 120.0)
    return int(SPARE * target * (1.0 + seconds / stay)) + LEAST_TRIPS * len(roads)


def _enough(
    net: Drivable, trips: list[tuple[Trip, str]], targets: Mapping[str, int], seconds: float
) -> bool:
    """Return whether there are trips for as long as the streets of every class are to be full.

    In a small site one is out of it soon.
    """
    place = {way.name: number for number, way in enumerate(net.streets.ways)}
    classes = [net.road(way) for way in net.streets.ways]
    driven = net.seconds - CORNER_S
    for road, target in targets.items():
        stays = [
            sum(driven[place[name]] for name in trip.route if classes[place[name]] == road)
            for trip, on in trips
            if on == road
        ]
        if stays and len(stays) < SPARE * target * (1.0 + seconds / float(np.mean(stays))):
            return False
    return True


def _trips(
    city: City, net: Drivable, looks: Mapping[str, tuple[tuple[Look, float], ...]],
    every: tuple[Look, ...], *, hour: float, purpose: str, count: int,
    cyclists: tuple[float, ...], mix: Mapping[str, float],
) -> list[tuple[Trip, str]]:  # fmt: skip
    """Draw trips, each with the class of road that most of its way is on."""
    number = np.arange(count).astype(np.uint64)
    ids = hash_ids(city.seed, purpose, number)
    ends = _ends(city, net, ids, hour)
    kind = _kinds(city, net, ids, cyclists, mix)
    look = _looks(city, looks, every, ids, kind)
    found: list[tuple[Trip, str] | None] = [None] * count
    for large in (False, True):
        rows = np.flatnonzero(np.isin(kind, [list(DRIVING).index(k) for k in LARGE]) == large)
        for variant in range(VARIANTS):
            own = rows[rows % VARIANTS == variant]
            for row, route in _routed(city, net, variant, own, ids, ends, large=large):
                fast = any(net.road(net.streets.ways[way]) == MOTORWAY for way in route)
                if not (fast and kind[row] == CYCLES):
                    found[row] = _trip(city, net, int(ids[row]), int(look[row]), route)
    return [trip for trip in found if trip is not None]


@dataclass(frozen=True)
class _Ends:
    """Weights by which the ends of trips are drawn: (t,) which of two kinds each trip has."""

    inner_start: BoolArray
    inner_end: BoolArray
    starts: tuple[FloatArray, FloatArray]  # (w,) beyond the site, within it
    ends: tuple[FloatArray, FloatArray]


def _ends(city: City, net: Drivable, ids: NDArray[np.uint64], hour: float) -> _Ends:
    ways = net.streets.ways
    lanes = [sum(lane.kind != "walk" for lane in way.lanes) for way in ways]
    importance = np.array([PER_KM[net.road(way)][2] for way in ways]) * np.array(lanes, float)
    border_in, border_out = net.at_border(net.entries, 0), net.at_border(net.exits, -1)
    outer_start = importance * (border_in if border_in.any() else net.entries)
    outer_end = importance * (border_out if border_out.any() else net.exits)
    homes, work = net.floors.T
    leaving = float(np.clip(1.0 - abs((hour - 7.5) / 3.0), 0.0, 1.0))
    coming = float(np.clip(1.0 - abs((hour - 17.5) / 3.5), 0.0, 1.0))
    inner_start = homes * (ALL_DAY_HOME + leaving) + work * (1.0 - ALL_DAY_HOME + coming)
    inner_end = homes * (ALL_DAY_HOME + coming) + work * (1.0 - ALL_DAY_HOME + leaving)
    if not inner_start.any():
        inner_start = inner_end = net.length * net.usable
    share = uniform(city.seed, "traffic/ends", ids)
    within = (1.0 - THROUGH) / 2
    begins = (share >= THROUGH) & (share < THROUGH + within)
    finishes = share >= THROUGH + within
    if not outer_start.any():
        begins[:] = True
    if not outer_end.any():
        finishes[:] = True
    starts = np.asarray(outer_start, float), np.asarray(inner_start, float)
    goals = np.asarray(outer_end, float), np.asarray(inner_end, float)
    return _Ends(begins, finishes, starts, goals)


def _kinds(
    city: City, net: Drivable, ids: NDArray[np.uint64], cyclists: tuple[float, ...],
    mix: Mapping[str, float],
) -> IntArray:  # fmt: skip
    """(t,) index into `DRIVING`: the shares of the busiest class of street that there is."""
    roads = {net.road(way) for way in net.streets.ways}
    best = max(sorted(roads - {MOTORWAY} or roads), key=lambda road: PER_KM[road][2])
    shares = shares_on(best, cyclists, mix)
    if not mix:
        return choose(city.seed, "traffic/kind", ids, shares)
    # Of any trips in a row nearly the shares that are asked for: few are about at a time.
    draw = (0.5 + np.arange(len(ids)) * EVEN) % 1.0
    return np.searchsorted(np.cumsum(shares)[:-1], draw, side="right").astype(np.int64)


def _routed(
    city: City, net: Drivable, variant: int, rows: IntArray, ids: NDArray[np.uint64],
    ends: _Ends, *, large: bool,
) -> list[tuple[int, tuple[int, ...]]]:  # fmt: skip
    """Give trips the quickest ways between their ends; those without any are left out."""
    from scipy.sparse.csgraph import dijkstra

    open_ways = net.wide if large else net.usable
    origin = np.full(len(ids), -1, np.int64)
    for inner in (False, True):
        weight = ends.starts[int(inner)] * open_ways
        chosen = rows[ends.inner_start[rows] == inner]
        if weight.any() and len(chosen):
            origin[chosen] = choose(city.seed, "traffic/origin", ids[chosen], weight)
    rows = rows[origin[rows] >= 0]
    starts = np.unique(origin[rows])
    if not len(starts):
        return []
    matrix = net.matrix(variant, large=large)
    seconds, before = dijkstra(matrix, indices=starts, return_predecessors=True)
    found = []
    for place, start in enumerate(starts.tolist()):
        for inner in (False, True):
            own = rows[(origin[rows] == start) & (ends.inner_end[rows] == inner)]
            weight = ends.ends[int(inner)] * open_ways * np.isfinite(seconds[place])
            if not inner and weight.sum() > weight[start]:
                weight[start] = 0.0
            if not weight.any() or not len(own):
                continue
            goals = choose(city.seed, "traffic/goal", ids[own], weight)
            for row, goal in zip(own.tolist(), goals.tolist(), strict=True):
                route = [goal]
                while route[-1] != start:
                    route.append(int(before[place, route[-1]]))
                if len({net.streets.ways[way].edge for way in route}) == len(route):
                    found.append((row, tuple(route[::-1])))  # nobody drives a street up and down
    return found


def _looks(
    city: City, looks: Mapping[str, tuple[tuple[Look, float], ...]], every: tuple[Look, ...],
    ids: NDArray[np.uint64], kind: IntArray,
) -> IntArray:  # fmt: skip
    """(t,) index into all looks, of those of each kind."""
    found = np.zeros(len(ids), np.int64)
    for number, name in enumerate(DRIVING):
        rows = np.flatnonzero(kind == number)
        if len(rows):
            places = np.array([every.index(look) for look, _ in looks[name]])
            shares = [share for _, share in looks[name]]
            found[rows] = places[choose(city.seed, "traffic/look", ids[rows], shares)]
    return found


def _trip(
    city: City, net: Drivable, trip_id: int, look: int, route: tuple[int, ...]
) -> tuple[Trip, str]:
    ways = [net.streets.ways[way] for way in route]
    roads: dict[str, float] = {}
    for way in ways:
        roads[net.road(way)] = roads.get(net.road(way), 0.0) + way.length
    most = max(sorted(roads), key=lambda road: roads[road])
    inside = [place for place, way in enumerate(ways) if net.road(way) == most]
    entry = inside[int(draw(city.seed, "traffic/entry", trip_id) * len(inside))]
    rolling = bool(net.entries[route[0]])
    names = tuple(way.name for way in ways)
    trip = Trip(id_text(trip_id), look, names, entry, rolling)
    return trip, most
