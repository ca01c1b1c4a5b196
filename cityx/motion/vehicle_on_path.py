"""A vehicle, or several, that drive along a path, wheels turning."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.assets.vehicles.car_parts import REGISTRATIONS
from cityx.assets.vehicles.movers import looks_of, paints_of, registered, size_of
from cityx.city.city import City
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ids import choose
from cityx.motion.character import AT_MOST, MOST, spread, with_curve
from cityx.motion.courses import course, paces
from cityx.motion.feasible import check_drive
from cityx.motion.paths import find_path
from cityx.motion.processions import Cast, new_ids, procession
from cityx.motion.walkways import drivable
from cityx.places.profiles import profile_of
from cityx.protocol import Choice, Points, Port, Range, Way, action, has_ground
from cityx.road.network.curves import FARTHEST

ACTION = "dynamic/vehicle_on_path-v1"

# Metres per second where nothing else is asked for: 30 km/h is what streets of towns allow.
SPEEDS = {"car": 8.3, "van": 8.3, "truck": 7.0, "bus": 7.5, "tram": 7.0, "bicycle": 4.5,
          "motorcycle": 8.3}  # fmt: skip
SIDEWAYS = 2.0  # metres per second squared that passengers bear in a bend
PULL = 1.2  # metres per second squared of starting and braking
SLACK = 0.8  # metres by which a corner of the path is cut
SPACING = 2.0  # metres between samples at most
HEADWAY = 1.4  # seconds behind the one in front, on top of its length


@action(
    ACTION,
    limits=[
        "Vehicles follow the path and one another; they heed no signals and no other traffic.",
        "On an open path they leave the city at its end.",
    ],
    requires=("layout", has_ground()),
    takes=(Port("curve", "line", role="curve", optional=True),),
    labels=("car", "bus", "truck", "tram", "bicycle", "motorcycle", "drive", "traffic"),
    # Sentences about streets are answered by `dynamic/vehicle_flow`, which heeds the rules there.
    binds={"path": "path", "count": "count", "speed": "speed"},
)
def vehicle_on_path(
    city: City,
    *,
    path: Annotated[str, Way()],
    kind: Annotated[str, Choice(*SPEEDS)] = "car",
    count: Annotated[int, Range(1, AT_MOST)] = 1,
    speed: Annotated[float | None, Range(0.5, 40.0)] = None,
    seconds: Annotated[float, Range(1.0, 3600.0)] = 60.0,
    points: Annotated[
        tuple[tuple[float, ...], ...] | None, Points(), Range(-FARTHEST, FARTHEST)
    ] = None,
) -> City:
    """Let a vehicle or several drive along a path.

    Parameters
    ----------
    city
        City with its ground.
    path
        Name of a curve or a street, or words such as "along the main street".
    kind
        What drives.
    count
        How many, behind one another.
    speed
        Metres per second along the path; usual for the kind when left out.
    seconds
        How long they go around a closed path.
    points
        Draw the curve named `path` through these first, metres east and north of the origin.
    """
    return add_vehicles(
        city, path=path, kind=kind, count=count, speed=speed, seconds=seconds, points=points
    )[0]


def add_vehicles(
    city: City,
    *,
    path: str,
    kind: str = "car",
    count: int = 1,
    speed: float | None = None,
    seconds: float = 60.0,
    points: tuple[tuple[float, ...], ...] | None = None,
) -> tuple[City, tuple[int, ...]]:
    """Do what `vehicle_on_path` does, and return the ids of the vehicles with the city.

    Raises
    ------
    ActionFailed
        If the path names nothing or cannot be driven, or more are asked for than fit.
    """
    if points is not None:
        city = with_curve(city, path, points)
    line = drivable(city, find_path(city, path))
    check_drive(city, line.line, line.name)
    pace = SPEEDS[kind] if speed is None else speed
    own = profile_of(city.frame).vehicles
    looks, shares = zip(*looks_of(kind, own), strict=True)
    apart = max(size_of(look)[0] for look in looks) + HEADWAY * pace
    most = min(max(1, int(line.line.length / apart)), MOST)
    if count > most:
        raise ActionFailed(
            f'{count:,} vehicles do not fit on the path "{line.name}", which is '
            f"{line.line.length:.0f} m long: {most} fit, {apart:.1f} m apart at "
            f"{3.6 * pace:.0f} km/h. Ask for {most} at most."
        )
    way = course(line.points, closed=line.closed, slack=SLACK, spacing=SPACING)
    ids = np.array(new_ids(city, ACTION, line.name, count), np.uint64)
    plate = choose(city.seed, f"{ACTION}/registration", ids, [1.0] * REGISTRATIONS).tolist()
    look = [
        registered(looks[chosen], own.plates, number)
        for chosen, number in zip(
            choose(city.seed, f"{ACTION}/look", ids, shares).tolist(), plate, strict=True
        )
    ]
    begins = spread(city.seed, line, count, apart, ACTION) * way.length / line.line.length
    cast = Cast(
        tuple(look), _paints(city, ids, look), begins, "ride", ACTION, line.name, line.roads
    )
    going = paces(way, pace, sideways=SIDEWAYS, pull=PULL)
    return procession(city, way, going, cast, seconds)


def _paints(city: City, ids: NDArray[np.uint64], look: list[str]) -> FloatArray:
    """(n, 3) linear colours of paint."""
    found = np.zeros((len(ids), 3))
    for name in sorted(set(look)):
        at = np.array([word == name for word in look])
        colors, shares = paints_of(name)
        found[at] = colors[choose(city.seed, f"{ACTION}/paint", ids[at], shares)]
    return found
