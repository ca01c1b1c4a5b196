"""Kinds of vehicles as SUMO drives them: class, driver, size; and how many there are of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cityx.system.tables import load, table


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


DRIVING = table("traffic/kinds", Driving, "driving")
LARGE = ("bus", "truck")  # need wide lanes and gentle corners
# Class of road -> shares of the kinds, in the order of `DRIVING`.
_SHARES: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        road: tuple(shares.get(kind, 0.0) for kind in DRIVING)
        for road, shares in load("traffic/kinds", dict[str, dict[str, float]], "shares").items()
    }
)
_BUSY = ("trunk", "primary", "secondary", "tertiary")


def shares_on(
    road: str, cyclists: tuple[float, ...] = (), mix: Mapping[str, float] = MappingProxyType({})
) -> tuple[float, ...]:
    """Return the shares of the kinds of `DRIVING` on a class of road.

    `cyclists` are those of main and of minor streets, () for what is usual. `mix` says the share
    of some kinds, whatever the road; the others keep theirs of the rest.
    """
    own = _usual_on(road, cyclists)
    told = min(sum(mix.values()), 1.0)
    rest = sum(share for kind, share in zip(DRIVING, own, strict=True) if kind not in mix)
    left = (1.0 - told) / max(rest, 1e-9)
    scale = max(sum(mix.values()), 1.0)
    return (
        tuple(
            mix[kind] / scale if kind in mix else share * left
            for kind, share in zip(DRIVING, own, strict=True)
        )
        if mix
        else own
    )


def _usual_on(road: str, cyclists: tuple[float, ...]) -> tuple[float, ...]:
    plain = road.removesuffix("_link")
    if plain == "motorway":
        return _SHARES["motorway"]
    busy = plain in _BUSY
    *driven, usual = _SHARES["main" if busy else "minor"]
    cycle = cyclists[not busy] if cyclists else usual
    rest = (1.0 - cycle) / sum(driven)
    return (*(share * rest for share in driven), cycle)
