"""Trips of pedestrians: between doors, stops and the borders of a city, by the hour."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.palette_tables import GROUPS
from cityx.assets.styles.palettes import groups_of
from cityx.city import City
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths
from cityx.geometry.ranges import numbered, ranges
from cityx.ground.walking.walkable import CELL, Walkable
from cityx.ground.walking.walks import SPACING, WalkGraph, walk_graph, walks_between
from cityx.ids import choose, hash_ids, uniform
from cityx.system.tables import table

# Bottleneck capacity: how many people narrow places let through; fuller ways are not taken.

TILE = 2.0  # metres along an edge of the places in which people are counted
WIDE = 1.5  # metres of clearance from which a place takes everybody
# People a minute and metre of clearance, both directions together: per metre of width half of it,
# which is Fruin's level of service D.
FLOW = 100.0
LEAST = 8.0  # people a minute that get through any place
SPELLS = 1 << 16  # more than there are in any run
SPELL = 30.0  # seconds in which people at a place are counted together


class Room:
    """What is left of the room of narrow places; a class because each way takes some of it.

    Parameters
    ----------
    walkable
        The area.
    seconds
        How long people walk.
    """

    def __init__(self, walkable: Walkable, seconds: float) -> None:
        self.walkable, self.seconds = walkable, seconds
        self.taken: dict[int, int] = {}

    def admitted(
        self, walks: Polylines, rows: IntArray, place: IntArray, clock: FloatArray,
        pace: FloatArray, begun: FloatArray,
    ) -> IntArray:  # fmt: skip
        """Take room for ways one after the other, and return the rows that find some.

        Only what is walked before the end counts, and each place at the time when one comes there:
        who is out at the beginning takes nothing from those who come later.

        Parameters
        ----------
        walks
            The ways, w of them.
        rows
            (r,) those that are wished for, in order.
        place
            (w,) number of the place in the crowd of who walks them.
        clock
            Seconds at which each place in the crowd is free; it is written to.
        pace, begun
            (w,) metres per second, and the share of a way that lies behind its walker.
        """
        points = walks.points
        room = self.walkable.at(self.walkable.clearance, points).astype(float)
        west, south, _, _ = self.walkable.grid.extent
        tile = np.floor((points - (west, south)) / TILE).astype(np.int64)
        key = tile[:, 0] * (1 << 24) + tile[:, 1]
        found = []
        for row in rows.tolist():
            own = slice(walks.start[row], walks.start[row + 1])
            gone = np.r_[0.0, np.cumsum(np.hypot(*np.diff(points[own], axis=0).T))]
            start = clock[place[row]]
            time = start + (gone - begun[row] * gone[-1]) / pace[row]
            narrow = (room[own] < WIDE) & (time >= start) & (time < self.seconds)
            spell = np.floor(time[narrow] / SPELL).astype(np.int64)
            places, number = np.unique(key[own][narrow] * SPELLS + spell, return_inverse=True)
            least = np.full(len(places), WIDE)
            np.minimum.at(least, number, room[own][narrow])
            most = np.maximum(FLOW * least, LEAST) * SPELL / 60.0
            held = [self.taken.get(place, 0) for place in places.tolist()]
            if (np.array(held) < most).all():
                found.append(row)
                clock[place[row]] = time[-1]
                self.taken.update(zip(places.tolist(), [n + 1 for n in held], strict=True))
        return np.array(found, np.int64)


UInt64Array = NDArray[np.uint64]

DOORSTEP = 6.0  # metres from a door to the walk that people step onto
SPREAD = 1.5  # metres between two places where people come in over a border
STOPS = ("bus_stop",)
GOALS = 60  # places that people of one run go to; each costs a search of the whole area
NEAR_GOALS = 180  # more of them that people go to who are near; each costs a search about it
NEAR_WAY = 260.0  # metres of way to one of those, as walkers feel them, and at most
NEAR = 150.0  # metres from them within which people go there
USUAL_WAY = 180.0  # metres; a way twice as long is e times rarer
FARTHEST = 900.0  # metres of way, as walkers feel them, that nobody exceeds
SHORTEST = 15.0  # metres
TRIES = 6  # draws of a goal before somebody stays at home
SHORT_TIME = 110.0  # seconds, less than of most walks
ROUNDS = 4  # of draws, after which who found no room in the streets stays at home
MOST_WALKS = 400  # one after the other, of one place in the crowd
SMALLEST = 60  # nodes of a piece of the walkable area that is worth a walk, some 10 m2
# Paces on level ground of grown people, of children and of the old (Bohannon 1997), and of runners.
PACES = (1.0, 1.7)
RUN = (2.4, 3.6)

# Use of a building -> how many at any hour, and peaks as (hour, width in hours, height).
DAYS = table("motion/days", tuple[float, tuple[tuple[float, float, float], ...]])


def activity(kind: str, hour: float) -> float:
    """Return how much a place of a kind draws people at an hour, 0 to 24."""
    base, peaks = DAYS[kind]
    far = [(abs(hour - at + 12.0) % 24.0 - 12.0, wide, high) for at, wide, high in peaks]
    awake = 0.05 if 1.0 <= hour < 5.0 else 1.0
    return awake * base + sum(high * float(np.exp(-((d / w) ** 2))) for d, w, high in far)


@dataclass(frozen=True)
class Ports:
    """Places where people come into sight and go out of it, p of them.

    Attributes
    ----------
    id
        (p,) uint64, stable.
    node
        (p,) int64 of the walk graph.
    weight
        (p,) float, how much each draws at the hour.
    snapped
        Metres that they lie off the walkable area, at most.
    lost
        Doors from which no walk was near enough.
    """

    id: UInt64Array
    node: IntArray
    weight: FloatArray
    snapped: float
    lost: int


@dataclass(frozen=True)
class Trips:
    """Walks of people, t of them.

    Attributes
    ----------
    id
        (t,) uint64, stable.
    place
        (t,) int64, number of the place in the crowd that its walker takes when the one before, of
        the same number, has arrived; ascending.
    walks
        Their ways.
    pace
        (t,) float, metres per second.
    begun
        (t,) float, share of the way that lies behind the walker when the tracks begin.
    """

    id: UInt64Array
    place: IntArray
    walks: Polylines
    pace: FloatArray
    begun: FloatArray


def ports_of(city: City, walkable: Walkable, hour: float) -> Ports:
    """Find where people come from and go to.

    Parameters
    ----------
    city
        The city; doors are those of its scene, or places before its buildings where it has none.
    walkable
        Its walkable area.
    hour
        0 to 24.
    """
    graph = walk_graph(walkable)
    kinds, places, ids = _doors(city)
    spots, found = walkable.snapped(places, DOORSTEP)
    moved = np.hypot(*(spots - places).T)[found]
    border = _border(walkable, graph)
    node = np.concatenate([graph.nearest(spots[found]), border])
    key = np.concatenate([ids[found], hash_ids(0, "walks/border", np.arange(len(border)))])
    kind = np.concatenate([kinds[found], np.full(len(border), "border")])
    words, row = np.unique(kind.astype(str), return_inverse=True)
    weight = np.array([activity(word, hour) for word in words.tolist()] or [0.0])[row]
    useful = (node >= 0) & (weight > 0)
    useful[useful] &= graph.size[graph.component[node[useful]]] >= SMALLEST
    order = np.flatnonzero(useful)[np.argsort(key[useful], kind="stable")]
    return Ports(key[order], node[order], weight[order], float(moved.max(initial=0.0)),
                 int((~found).sum()))  # fmt: skip


def _doors(city: City) -> tuple[NDArray[np.str_], FloatArray, UInt64Array]:
    """Kinds, places and ids of doors, shopfronts and stops."""
    uses = _uses(city)
    kinds, places, ids = [np.zeros(0, "<U8")], [np.zeros((0, 2))], [np.zeros(0, np.uint64)]
    for layer in ("doors", "shopfronts"):
        rows = city.scene.instances.get(layer)
        if rows is None or not rows.count:
            continue
        own = [uses.get(owner, "shed") for owner in rows.owner.tolist()]
        kinds.append(np.array(["retail"] * rows.count if layer == "shopfronts" else own))
        places.append(rows.position[:, :2])
        ids.append(rows.object_id)
    points = city.layout.points
    stops = points[points["kind"].isin(STOPS).to_numpy()]
    if len(stops):
        at = np.array([(p.x, p.y) for p in stops.geometry])
        kinds.append(np.full(len(stops), "stop"))
        places.append(at)
        ids.append(stops["id"].to_numpy(np.uint64))
    return np.concatenate(kinds), np.concatenate(places), np.concatenate(ids)


def _uses(city: City) -> dict[int, str]:
    """Use of each building, by its id."""
    if not len(city.layout.parts):
        return {}
    group = groups_of(city.layout, city.seed)
    owner = city.layout.parts["building"].to_numpy(np.uint64)
    return {int(own): GROUPS[number] for own, number in zip(owner, group, strict=True)}


def _border(walkable: Walkable, graph: WalkGraph) -> IntArray:
    """Nodes where walks leave the site, `SPREAD` apart."""
    west, south, east, north = walkable.grid.extent
    x, y = graph.places.T if len(graph.places) else np.zeros((2, 0))
    reach = 5 * CELL
    near = (x < west + reach) | (x > east - reach) | (y < south + reach) | (y > north - reach)
    rows = np.flatnonzero(near)
    tile = np.floor(graph.places[rows] / SPREAD).astype(np.int64)
    return rows[np.sort(np.unique(tile, axis=0, return_index=True)[1])] if len(rows) else rows


def drawn_trips(
    city: City, walkable: Walkable, ports: Ports, count: int, duration: float, purpose: str
) -> Trips:
    """Draw walks so that a number of people is under way all the time.

    Parameters
    ----------
    city
        Whose seed is drawn by.
    walkable, ports
        Where they walk.
    count
        People at a time.
    duration
        Seconds.
    purpose
        Key of the draws.
    """
    goals, reach = _goals(city, ports, purpose)
    clock, drawn = np.zeros(count), np.zeros(count, np.int64)
    room = Room(walkable, duration)
    parts: list[Trips] = []
    while (clock < duration).any() and drawn.max(initial=0) < MOST_WALKS and len(parts) < ROUNDS:
        # Several walks of each at once: every look at the area costs a search from each goal.
        left = np.maximum(duration - clock, 0.0)
        more = np.where(left > 0, np.ceil(left / SHORT_TIME) + 1, 0).astype(np.int64)
        place = np.repeat(np.arange(count), more)
        number = drawn[place] + numbered(more)
        drawn += more
        key = hash_ids(city.seed, f"{purpose}/walk", place, number)
        walks, found = _walks(city, walkable, ports, (goals, reach), key, purpose)
        pace = paces_of(city.seed, purpose, key)
        begun = np.where(number == 0, uniform(city.seed, f"{purpose}/begun", key), 0.0)
        rows = room.admitted(walks, np.flatnonzero(found), place, clock, pace, begun)
        parts.append(Trips(key[rows], place[rows], _taken(walks, rows), pace[rows], begun[rows]))
        if not len(rows):
            break
    return _in_turn(parts)


def _in_turn(parts: list[Trips]) -> Trips:
    """Join walks, those of one place in the crowd after each other."""
    place = np.concatenate([part.place for part in parts])
    walks = _joined([part.walks for part in parts])
    order = np.argsort(place, kind="stable")
    return Trips(
        np.concatenate([part.id for part in parts])[order],
        place[order],
        _taken(walks, order),
        np.concatenate([part.pace for part in parts])[order],
        np.concatenate([part.begun for part in parts])[order],
    )


def paces_of(seed: int, purpose: str, person: UInt64Array) -> FloatArray:
    """Draw how fast people walk, (n,) metres per second; most at some 1.35, one in 40 runs."""
    draws = [uniform(seed, f"{purpose}/pace", person, k) for k in range(3)]
    low, high = PACES
    pace = low + (high - low) * sum(draws) / len(draws)
    runs = uniform(seed, f"{purpose}/runs", person) < 1 / 40
    fast = RUN[0] + (RUN[1] - RUN[0]) * draws[0]
    return np.asarray(np.where(runs, fast, pace))


def running_paces(seed: int, purpose: str, person: UInt64Array) -> FloatArray:
    """Draw how fast people run, (n,) metres per second."""
    return np.asarray(RUN[0] + (RUN[1] - RUN[0]) * uniform(seed, f"{purpose}/run", person))


def at_pace(seed: int, purpose: str, trips: Trips, speed: float | None, *, runs: bool) -> Trips:
    """Return trips of people who all go at a speed, metres per second, or run, if that is asked."""
    if speed is not None:
        return replace(trips, pace=np.full(len(trips.id), speed))
    return replace(trips, pace=running_paces(seed, purpose, trips.id)) if runs else trips


def _goals(city: City, ports: Ports, purpose: str) -> tuple[IntArray, FloatArray]:
    """Rows of the ports that people of this run go to, and how far one walks to each.

    Those that draw most are more likely. The first attract people from far away.
    """
    if not len(ports.id):
        return np.zeros(0, np.int64), np.zeros(0)
    share = uniform(city.seed, f"{purpose}/goals", ports.id)
    # The keys of a weighted sample without replacement (Efraimidis and Spirakis 2006).
    key = np.log(np.maximum(share, 1e-12)) / np.maximum(ports.weight, 1e-9)
    goals = np.argsort(-key, kind="stable")[: GOALS + NEAR_GOALS]
    order = np.argsort(goals)
    return goals[order], np.where(order < GOALS, FARTHEST, NEAR_WAY)


def _walks(
    city: City, walkable: Walkable, ports: Ports, known_goals: tuple[IntArray, FloatArray],
    key: UInt64Array, purpose: str,
) -> tuple[Polylines, NDArray[np.bool_]]:  # fmt: skip
    """Find the walks of some keys, and tell which have a way."""
    graph = walk_graph(walkable)
    goals, reach = known_goals
    count = len(key)
    origin, goal = np.full(count, -1, np.int64), np.full(count, -1, np.int64)
    longest = np.zeros(count)
    for k in range(TRIES):
        open_ = np.flatnonzero(goal < 0)
        if not len(open_) or not len(goals):
            break
        start = choose(city.seed, f"{purpose}/from", key[open_], ports.weight, k)
        far = np.hypot(*(graph.places[ports.node[start]][:, None]
                         - graph.places[ports.node[goals]][None]).transpose(2, 0, 1))  # fmt: skip
        weight = ports.weight[goals] * np.exp(-far / USUAL_WAY)
        weight *= (far > SHORTEST) & (far < np.where(reach < FARTHEST, NEAR, np.inf))
        same = graph.component[ports.node[start]][:, None] == graph.component[ports.node[goals]]
        edges = np.cumsum(weight * same, axis=1)
        drawn = uniform(city.seed, f"{purpose}/to", key[open_], k) * edges[:, -1]
        end = np.minimum((edges <= drawn[:, None]).sum(axis=1), len(goals) - 1)
        able = edges[:, -1] > 0
        origin[open_[able]] = ports.node[start[able]]
        goal[open_[able]] = ports.node[goals[end[able]]]
        longest[open_[able]] = reach[end[able]]
    known = np.flatnonzero(goal >= 0)
    walks, found = walks_between(walkable, origin[known], goal[known], longest[known])
    whole = np.zeros(count, bool)
    whole[known] = found & (arc_lengths(walks)[1] > SHORTEST)
    # Those without a way are empty lines of two points, so that rows stay in step.
    place = np.zeros(count, np.int64)
    place[known] = np.arange(len(known))
    if not len(known):
        empty = np.zeros((2 * count, 2))
        return Polylines(empty, np.arange(0, 2 * count + 1, 2)), whole
    return _taken(walks, place), whole


def _taken(lines: Polylines, rows: IntArray) -> Polylines:
    index, start = ranges(lines.start, rows)
    return Polylines(lines.points[index], start)


def _joined(parts: list[Polylines]) -> Polylines:
    points = [np.zeros((0, 2)), *(part.points for part in parts)]
    sizes = [np.zeros(0, np.int64), *(np.diff(part.start) for part in parts)]
    start = np.concatenate([[0], np.cumsum(np.concatenate(sizes))]).astype(np.int64)
    return Polylines(np.concatenate(points), start)


__all__ = ["SPACING", "Ports", "Trips", "activity", "drawn_trips", "paces_of", "ports_of"]
