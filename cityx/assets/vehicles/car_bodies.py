"""Bodies of cars and vans at real size, their faces, and how many of each a place has."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.system.tables import table

Stations = tuple[tuple[float, float], ...]
Roof = tuple[tuple[float, float, float], ...]
Shares = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Face:
    """What tells makes apart from before and behind.

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


BODIES = table("assets/cars", Body, "bodies")
TAXIS = tuple(name for name, body in BODIES.items() if body.sign)

# Kind of vehicle -> (body, share) by place, after registrations and what taxi ranks have; the
# entry "" stands for places that are not named.
CAR_SHARES: Mapping[str, Shares] = MappingProxyType(
    {
        "": (("hatchback", 0.31), ("sedan", 0.22), ("suv", 0.26), ("estate", 0.09),
             ("city_car", 0.07), ("mpv", 0.05)),
        "british isles": (("hatchback", 0.31), ("suv", 0.26), ("black_cab", 0.13),
                          ("city_car", 0.09), ("sedan", 0.08), ("estate", 0.08),
                          ("mpv", 0.05)),
        "northern/central europe": (("hatchback", 0.27), ("estate", 0.20), ("suv", 0.24),
                                    ("sedan", 0.11), ("city_car", 0.10), ("mpv", 0.08)),
        "mediterranean": (("hatchback", 0.36), ("city_car", 0.22), ("suv", 0.22), ("sedan", 0.09),
                          ("estate", 0.06), ("mpv", 0.05)),
        "north america": (("suv", 0.47), ("sedan", 0.33), ("hatchback", 0.09), ("mpv", 0.09),
                          ("estate", 0.02)),
        "japan": (("kei_car", 0.25), ("mpv", 0.18), ("hatchback", 0.18), ("tall_taxi", 0.16),
                  ("sedan", 0.12), ("suv", 0.11)),
    }
)  # fmt: skip
VAN_SHARES: Mapping[str, Shares] = MappingProxyType(
    {
        "": (("van", 0.45), ("small_van", 0.30), ("delivery_van", 0.25)),
        "north america": (("delivery_van", 0.55), ("van", 0.35), ("small_van", 0.10)),
        "japan": (("kei_van", 0.60), ("van", 0.40)),
    }
)


@lru_cache(maxsize=64)
def _waist(hood: Stations) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    from scipy.interpolate import PchipInterpolator  # slow to import, and kept cars need it not

    share, height = np.array(hood).T
    line: Callable[[NDArray[np.float64]], NDArray[np.float64]] = PchipInterpolator(share, height)
    return line


def waist_of(body: Body, share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Height of the lower body's upper edge at shares of the length, as fine cars have it."""
    return np.asarray(_waist(body.hood)(share))


def shares_of(kind: str, place: str = "") -> Shares:
    """Return the bodies of a kind that a place has, "car" or "van", and the share of each.

    Parameters
    ----------
    kind
        Of `Body.kind`.
    place
        As of `cityx.ground.street_rules.place_of`; others have what is usual.
    """
    table = VAN_SHARES if kind == "van" else CAR_SHARES
    return table.get(place, table[""])
