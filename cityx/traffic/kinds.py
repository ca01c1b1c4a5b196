"""Kinds of vehicles as SUMO drives them: class, driver, size; and how many there are of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class Driving:
    """How vehicles of a kind are driven.

    Attributes
    ----------
    sumo_class
        Class of SUMO, by which lanes are open to them.
    accel, decel
        Usual acceleration and braking, m/s².
    top
        Greatest speed, m/s.
    gap
        Metres kept to a standing vehicle ahead.
    lane
        That they set out in, as SUMO's ``departLane``.
    eager
        How early they get into the lane from which they turn, as SUMO's ``lcStrategic``; those who
        never do go where their lane leads.
    """

    sumo_class: str
    accel: float
    decel: float
    top: float
    gap: float
    lane: str = "best"
    eager: float = 10.0


# Usual values of SUMO's classes; vehicles in streets accelerate less than they could.
DRIVING: Mapping[str, Driving] = MappingProxyType(
    {
        "car": Driving("passenger", 2.4, 4.5, 50.0, 2.5),
        "van": Driving("delivery", 2.2, 4.5, 45.0, 2.5),
        "truck": Driving("truck", 1.3, 4.0, 25.0, 2.5),
        "bus": Driving("bus", 1.2, 4.0, 24.0, 2.5),
        "motorcycle": Driving("motorcycle", 3.5, 6.0, 45.0, 2.0),
        "bicycle": Driving("bicycle", 1.2, 3.0, 5.6, 1.0, "first", -1.0),
    }
)
LARGE = ("bus", "truck")  # need wide lanes and gentle corners

# Class of road -> shares of the kinds, in the order of `DRIVING`.
_SHARES: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        "motorway": (0.78, 0.09, 0.11, 0.01, 0.01, 0.0),
        "main": (0.75, 0.09, 0.05, 0.04, 0.03, 0.04),
        "minor": (0.78, 0.11, 0.015, 0.0, 0.03, 0.065),
    }
)
_BUSY = ("trunk", "primary", "secondary", "tertiary")


def shares_on(road: str, cyclists: tuple[float, ...] = ()) -> tuple[float, ...]:
    """Return the shares of the kinds of `DRIVING` on a class of road.

    `cyclists` are those of main and of minor streets, () for what is usual.
    """
    plain = road.removesuffix("_link")
    if plain == "motorway":
        return _SHARES["motorway"]
    busy = plain in _BUSY
    *driven, usual = _SHARES["main" if busy else "minor"]
    cycle = cyclists[not busy] if cyclists else usual
    rest = (1.0 - cycle) / sum(driven)
    return (*(share * rest for share in driven), cycle)
