"""A flow of pedestrians: so many people from one place to another."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.tracks import no_tracks
from cityx.errors import ActionFailed
from cityx.geometry.polylines import Polylines
from cityx.ground.walking.walkable import Walkable
from cityx.ground.walking.walks import walk_graph, walks_between
from cityx.ids import hash_ids, stable_id
from cityx.motion.crowds import among, area_of, check_room, with_crowd
from cityx.motion.people_trips import Trips, at_pace, drawn_trips, paces_of, ports_of
from cityx.protocol import Choice, Points, Port, Range, Serves, action, has_ground, has_network

ACTION = "dynamic/pedestrian_flow-v1"
FARTHEST = 1e6  # metres from the origin that a coordinate may be
NEAR = 15.0  # metres from a place that is asked for to the walk nearest to it


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
    labels=("pedestrians", "people", "flow", "procession", "from", "to", "walk"),
    serves=(
        Serves(
            "edit=add_agent",
            "agent=pedestrian",
            "!path",
            "!at",
            "!ground",
            "!to",
            "!from",
            "!who",
            "!gender",
        ),
    ),
    binds={"count": "count", "gait": "mode", "speed": "speed"},
)
def pedestrian_flow(
    city: City,
    *,
    count: Annotated[int, Range(1, 1_000_000_000)] = 20,
    places: Annotated[
        tuple[tuple[float, ...], ...] | None, Points(2, 50), Range(-FARTHEST, FARTHEST)
    ] = None,
    gait: Annotated[str, Choice("walk", "run")] = "walk",
    speed: Annotated[float | None, Range(0.3, 6.0)] = None,
    duration: Annotated[float, Range(1.0, 3600.0)] = 60.0,
) -> City:
    """Add people who walk from one place to another, by the shortest comfortable way.

    Parameters
    ----------
    city
        City with its ground.
    count
        People; without `places` so many are about at a time.
    places
        Where they come from, what they pass, and where they go to, metres east and north of the
        origin; from doors and borders to others when left out.
    gait
        How all of them go.
    speed
        Metres per second of all of them; each has an own when left out.
    duration
        Seconds of the tracks.
    """
    walkable = area_of(city)
    check_room(walkable, count)
    held = city.tracks if city.tracks is not None else no_tracks()
    walkable, gates = among(city, walkable, duration, held)
    if places is None:
        ports = ports_of(city, walkable, city.environment.hour)
        trips = drawn_trips(city, walkable, ports, count, duration, _purpose(city))
        if not len(trips.id):
            raise ActionFailed("Nobody has anywhere to walk: no two doors or borders are joined.")
    else:
        trips = _between(city, walkable, np.array(places, float)[:, :2], count)
    trips = at_pace(city.seed, ACTION, trips, speed, runs=gait == "run")
    return with_crowd(city, walkable, gates, trips, duration, ACTION, held)


def _purpose(city: City) -> str:
    """Key of the draws, another for every flow that is added."""
    flows = 0 if city.tracks is None else int((city.tracks.origin == ACTION).sum())
    return f"{ACTION}/{flows}"


def _between(city: City, walkable: Walkable, places: NDArray[np.float64], count: int) -> Trips:
    """Return walks of people through places, evenly spread.

    Raises
    ------
    ActionFailed
        With every place that is off the walks, and every pair that no way joins.
    """
    graph = walk_graph(walkable)
    spots, found = walkable.snapped(places, NEAR)
    faults = [
        f"({x:.1f}, {y:.1f}) is more than {NEAR:g} m from any sidewalk, path or plaza"
        for x, y in places[~found].tolist()
    ]
    node = graph.nearest(spots)
    if not faults:
        walks, joined = walks_between(walkable, node[:-1], node[1:])
        faults = [
            f"no way on foot leads from ({a:.1f}, {b:.1f}) to ({c:.1f}, {d:.1f})"
            for a, b, c, d in np.column_stack([places[:-1], places[1:]])[~joined].tolist()
        ]
    if faults:
        raise ActionFailed(
            f"The flow cannot walk: {'; '.join(faults)}. Right would be places on sidewalks, paths "
            "or plazas that crosswalks join."
        )
    purpose = _purpose(city)
    key = np.uint64(stable_id(purpose, *np.round(places, 2).ravel().tolist()))
    ids = hash_ids(city.seed, purpose, key, np.arange(count))
    # Evenly spread over the way when the tracks begin; who finds no room there sets out later.
    points = walks.points
    whole = Polylines(np.tile(points, (count, 1)), np.arange(count + 1) * len(points))
    begun = np.arange(count) / count
    return Trips(ids, np.arange(count), whole, paces_of(city.seed, purpose, ids), begun)
