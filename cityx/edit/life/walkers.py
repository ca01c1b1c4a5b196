"""Walkers: people who go to a place, leave it, or go from one to another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.tracks import no_tracks
from cityx.edit.life.places import ground_of
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ground.walking.walkable import Walkable
from cityx.ground.walking.walks import (
    REACHES,
    WalkGraph,
    nodes_by,
    walk_graph,
    walks_between,
    ways_to,
)
from cityx.ids import hash_ids, stable_id, uniform
from cityx.motion.crowds import LOOKS, among, area_of, check_room, dressed, with_crowd
from cityx.motion.kinds_of_people import KINDS, RUNNER, WEARS, looks_of_kinds
from cityx.motion.people_trips import Trips, at_pace, paces_of, ports_of
from cityx.protocol import Choice, ObjectName, Port, Range, Serves, action, has_ground, has_network

ACTION = "dynamic/walkers-v1"
USUAL = 12  # people whom nobody counted
MOST = 5000
FEW = 8  # places at an object that people go to or leave; each takes a search
APART = 60.0  # metres from there that they come from, or go to, at least, where there is as much
MORE = 0.2  # share of the people who set out besides, in place of those who find no room
GETS_ON = 3.0  # metres of way
CLOSE = 0.1  # metres from objects to their ground
BEGUN = 0.5  # share of the way, at most, that lies behind who comes when the tracks begin


@action(
    ACTION,
    limits=[
        "People give way to vehicles and to others that move already; those do not give way.",
        "They walk on the ground, not on bridges nor in tunnels.",
    ],
    requires=("layout", has_network(), has_ground()),
    takes=(
        Port("doors", "point", role="door", optional=True),
        Port("traffic", "line", role="vehicle_tracks", optional=True),  # people wait for it
    ),
    gives=(Port("pedestrians", "line", role="pedestrian_tracks"),),
    labels=("people", "walking to", "leaving", "school run", "commuters", "from", "to"),
    serves=(
        Serves("edit=add_agent", "agent=pedestrian", "to"),
        Serves("edit=add_agent", "agent=pedestrian", "from", "!to"),
    ),
    binds={
        "count": "count",
        "gait": "mode",
        "speed": "speed",
        "goal": "walk.goal",
        "origin": "walk.origin",
        "who": "who",
        "wears": "wears",
    },
)
def walkers(
    city: City,
    *,
    origin: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    goal: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    count: Annotated[int, Range(1, MOST)] = USUAL,
    who: Annotated[str | None, Choice(*KINDS)] = None,
    wears: Annotated[str | None, Choice(*WEARS)] = None,
    gait: Annotated[str, Choice("walk", "run")] = "walk",
    speed: Annotated[float | None, Range(0.3, 6.0)] = None,
    duration: Annotated[float, Range(1.0, 3600.0)] = 60.0,
) -> City:
    """Let people walk to some objects, from some, or from these to those.

    Parameters
    ----------
    city
        City with its ground.
    origin, goal
        Squares, streets, buildings and other objects that they leave, and that they go to; from or
        to doors and borders of the site where one is left out, from these to others without both.
    count
        People.
    who
        Of which kind all of them are; mixed when left out.
    wears
        What all of them have on, such as jackets in warning colours; their own clothes when left
        out.
    gait
        How all of them go.
    speed
        Metres per second of all of them; each has an own when left out.
    duration
        Seconds, where nothing moves yet.
    """
    walkable = area_of(city)
    check_room(walkable, count)
    held = city.tracks if city.tracks is not None else no_tracks()
    duration = max(duration, held.duration)
    walkable, gates = among(city, walkable, duration, held)
    trips = _trips(city, walkable, origin, goal, count + max(round(MORE * count), 2))
    trips = at_pace(city.seed, ACTION, trips, speed, runs=gait == "run" or who == RUNNER)
    changed = with_crowd(city, walkable, gates, trips, duration, ACTION, held)
    graph = walk_graph(walkable)
    ends = [(ways_to(graph, ground_of(city, names, around=CLOSE)), way)
            for names, way in ((goal, 1.0), (origin, -1.0)) if names]  # fmt: skip
    changed = _of_whom(changed, trips.id, count, graph, ends)
    number = (hash_ids(city.seed, "people/look", trips.id) % np.uint64(LOOKS)).astype(np.int64)
    kinds = np.full(len(number), who or "", "<U12")
    return dressed(changed, trips.id, looks_of_kinds(number, kinds, wears=wears or ""))


def _of_whom(
    city: City,
    ids: NDArray[np.uint64],
    count: int,
    graph: WalkGraph,
    ends: list[tuple[FloatArray, float]],
) -> City:
    """Keep so many of some people: those who get on rather than those who find no room.

    `ends` are the metres of way from each node to what they go to (1) or leave (-1).
    """
    tracks = city.tracks
    if tracks is None:
        return city
    rows = np.flatnonzero(np.isin(tracks.object_id, ids))
    first, last = tracks.sample_start[rows], tracks.sample_start[rows + 1] - 1
    begin, end = (graph.tree.query(tracks.position[at, :2])[1] for at in (first, last))
    gets_on = np.ones(len(rows), bool)
    for far, way in ends:
        with np.errstate(invalid="ignore"):  # nobody gets nearer where no way leads
            gets_on &= way * (far[begin] - far[end]) >= GETS_ON
    order = np.lexsort((tracks.object_id[rows], ~gets_on, tracks.time[first] > 0))
    kept = np.ones(tracks.count, bool)
    kept[rows[order[count:]]] = False
    return replace(city, tracks=tracks.take(kept))


def _trips(
    city: City,
    walkable: Walkable,
    origin: tuple[str, ...] | None,
    goal: tuple[str, ...] | None,
    count: int,
) -> Trips:
    """Return walks of people from some objects to others, or to doors and borders.

    Raises
    ------
    ActionFailed
        If no way on foot leads there.
    """
    graph = walk_graph(walkable)
    earlier = 0 if city.tracks is None else int((city.tracks.origin == ACTION).sum())
    purpose = f"{ACTION}/{earlier}/{','.join(origin or ())}>{','.join(goal or ())}"
    key = np.uint64(stable_id(purpose))
    ids = np.sort(hash_ids(city.seed, "walkers", key, np.arange(count)))
    ends = [None if names is None else _nodes_at(city, graph, names) for names in (origin, goal)]
    far = _far(graph, ports_of(city, walkable, city.environment.hour).node, ends)
    start, stop = (far if nodes is None else nodes for nodes in ends)
    start, stop = _joined(graph, start, stop)
    if not origin and goal:
        start = _apart(graph, start, stop)
    elif not goal and origin:
        stop = _apart(graph, stop, start)
    few = stop[np.linspace(0, len(stop) - 1, min(FEW, len(stop))).astype(int)]
    order = np.argsort(hash_ids(city.seed, f"{ACTION}/start", start.astype(np.uint64)))
    first = start[order[np.arange(count) % len(start)]]
    last = few[(uniform(city.seed, f"{ACTION}/end", ids) * len(few)).astype(int)]
    first = np.where(first == last, np.roll(first, 1), first)
    same = first == last
    walks, joined = walks_between(walkable, first[~same], last[~same])
    if same.any() or not joined.all():
        lost = int(same.sum() + (~joined).sum())
        raise ActionFailed(f"{lost} of {count} people find no way there.")
    begun = np.zeros(count) if origin else BEGUN * uniform(city.seed, f"{ACTION}/begun", ids)
    return Trips(ids, np.arange(count), walks, paces_of(city.seed, ACTION, ids), begun)


def _far(graph: WalkGraph, ports: IntArray, ends: Sequence[IntArray | None]) -> IntArray:
    """Return doors and borders from which one comes to some nodes, all others if there are none."""
    given = np.concatenate([np.zeros(0, np.int64), *(one for one in ends if one is not None)])
    if not len(given):
        return ports
    reached = np.isin(graph.component[ports], graph.component[given])
    others = np.setdiff1d(np.arange(len(graph.places)), given)
    return ports[reached] if reached.any() else others


def _apart(
    graph: WalkGraph, nodes: NDArray[np.int64], here: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the nodes that lie farther than others from the middle of where people go or begin."""
    away = np.hypot(*(graph.places[nodes] - graph.places[here].mean(axis=0)).T)
    return np.asarray(nodes[away >= min(APART, float(np.median(away)))], np.int64)


def _nodes_at(city: City, graph: WalkGraph, names: tuple[str, ...]) -> IntArray:
    """(k,) nodes of the walks in, at and along some objects, or the nearest to them.

    Raises
    ------
    ActionFailed
        If no walk leads by.
    """
    found = nodes_by(graph, ground_of(city, names, around=CLOSE))
    if not len(found):
        raise ActionFailed(
            f"No sidewalk, path or square is within {REACHES[-1]:g} m of {', '.join(names)}."
        )
    return found


def _joined(
    graph: WalkGraph, here: NDArray[np.int64], others: NDArray[np.int64]
) -> tuple[IntArray, IntArray]:
    """Return those nodes of both ends that lie in the largest piece which has some of each.

    Raises
    ------
    ActionFailed
        If there is none.
    """
    pieces = np.intersect1d(graph.component[here], graph.component[others])
    if not len(pieces):
        raise ActionFailed("No way on foot leads there.")
    piece = pieces[int(np.argmax(graph.size[pieces]))]
    return here[graph.component[here] == piece], others[graph.component[others] == piece]
