"""Bodies of cars and vans at real size, their faces, and how many of each a place has."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.places.profile import Vehicles
from cityx.system.tables import table

Stations = tuple[tuple[float, float], ...]
Roof = tuple[tuple[float, float, float], ...]
Shares = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Face:
    """What distinguishes makes of cars, in front and behind.

    Attributes
    ----------
    lamps
        Headlights: "slit", "block" or "round".
    grille
        "bars", "wide" (from lamp to lamp), "shield", "slots" or "closed".
    rear
        Rear lights: "block", "tall" (beside the tailgate) or "band" (from side to side).
    trims
        Whether bumpers and flanks have strips of rubber.
    """

    lamps: str
    grille: str
    rear: str
    trims: bool = False


@dataclass(frozen=True)
class Body:
    """Stations of a car body from front (-y) to rear.

    Attributes
    ----------
    length, width
        Metres.
    hood
        (y share, z) of the lower body's upper edge, metres.
    roof
        (y share, z, width share) of the cabin from foot of the windscreen to foot of the rear
        window.
    wheel
        Metres, radius.
    axles
        (front, rear) shares of the length.
    faces
        What its makes look like, by number of its variants.
    kind
        "car" or "van".
    cargo
        Whether there are no windows beside its load.
    rails
        Whether it has rails on the roof.
    kei
        Whether it is of the small class of Japan, which has plates of its own.
    sign
        What the lamp on its roof says, or "".
    service
        "police", "ambulance", "taxi" or "".
    """

    length: float
    width: float
    hood: Stations
    roof: Roof
    wheel: float
    axles: tuple[float, float]
    faces: tuple[Face, ...]
    kind: str = "car"
    cargo: bool = False
    rails: bool = False
    kei: bool = False
    sign: str = ""
    service: str = ""


_PLAIN = table("assets/cars", Body, "bodies")
_TAXI = "taxi"
# Vehicles of services; no place has them among the cars of its people.
SERVICES: Mapping[str, Body] = MappingProxyType(
    {
        name: replace(_PLAIN[body], service=name, sign="TAXI" if name == _TAXI else "")
        for name, body in table("assets/cars", str, "services").items()
    }
)
BODIES: Mapping[str, Body] = MappingProxyType({**_PLAIN, **SERVICES})
TAXIS = tuple(name for name, body in BODIES.items() if body.sign)


@lru_cache(maxsize=64)
def _waist(hood: Stations) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    from scipy.interpolate import PchipInterpolator  # slow to import, and kept cars need it not

    share, height = np.array(hood).T
    line: Callable[[NDArray[np.float64]], NDArray[np.float64]] = PchipInterpolator(share, height)
    return line


def waist_of(body: Body, share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Height of the lower body's upper edge at shares of the length, as fine cars have it."""
    return np.asarray(_waist(body.hood)(share))


def shares_of(kind: str, vehicles: Vehicles) -> Shares:
    """Return the bodies of a kind, "car" or "van", that a place has, and the share of each."""
    return tuple((vehicles.vans if kind == "van" else vehicles.cars).items())
