"""Bodies of cars and vans at real size, their faces, and how many of each a place has."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.places.profile import Vehicles

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


_SALOON = (Face("slit", "wide", "band"), Face("block", "shield", "block"),
           Face("slit", "closed", "band"))  # fmt: skip
_SMALL = (Face("block", "closed", "tall"), Face("slit", "wide", "block"),
          Face("block", "bars", "block"))  # fmt: skip
_TALL = (Face("block", "shield", "tall"), Face("slit", "closed", "band"),
         Face("slit", "slots", "block"))  # fmt: skip
_ROUND = (Face("round", "closed", "tall"), Face("block", "closed", "block"),
          Face("round", "bars", "block"))  # fmt: skip
_WORK = (Face("block", "wide", "tall", trims=True), Face("block", "bars", "tall", trims=True),
         Face("slit", "closed", "tall", trims=True))  # fmt: skip
_CAB = (Face("round", "shield", "tall"),)


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


BODIES: Mapping[str, Body] = MappingProxyType(
    {
        "hatchback": Body(
            4.05, 1.76,
            ((0.0, 0.67), (0.02, 0.77), (0.08, 0.86), (0.24, 0.95), (0.32, 0.97), (0.93, 0.99),
             (0.985, 0.91), (1.0, 0.72)),
            ((0.22, 0.94, 0.90), (0.40, 1.42, 0.74), (0.55, 1.49, 0.73), (0.80, 1.45, 0.71),
             (0.98, 0.98, 0.84)),
            0.31, (0.185, 0.81), _SMALL),
        "sedan": Body(
            4.65, 1.82,
            ((0.0, 0.65), (0.02, 0.74), (0.08, 0.82), (0.26, 0.93), (0.34, 0.95), (0.84, 0.99),
             (0.975, 0.95), (1.0, 0.74)),
            ((0.25, 0.92, 0.90), (0.42, 1.38, 0.74), (0.54, 1.45, 0.72), (0.70, 1.41, 0.71),
             (0.87, 0.99, 0.84)),
            0.33, (0.185, 0.80), _SALOON),
        "estate": Body(
            4.72, 1.83,
            ((0.0, 0.65), (0.02, 0.75), (0.08, 0.83), (0.25, 0.94), (0.33, 0.96), (0.94, 1.00),
             (0.985, 0.93), (1.0, 0.72)),
            ((0.24, 0.93, 0.90), (0.41, 1.39, 0.74), (0.54, 1.47, 0.73), (0.87, 1.44, 0.71),
             (0.985, 1.00, 0.84)),
            0.33, (0.185, 0.79), _SALOON, rails=True),
        "suv": Body(
            4.55, 1.88,
            ((0.0, 0.80), (0.02, 0.92), (0.08, 1.00), (0.24, 1.08), (0.32, 1.10), (0.94, 1.12),
             (0.99, 1.02), (1.0, 0.82)),
            ((0.23, 1.07, 0.92), (0.38, 1.58, 0.78), (0.54, 1.67, 0.77), (0.86, 1.63, 0.75),
             (0.985, 1.11, 0.86)),
            0.37, (0.19, 0.80), _TALL, rails=True),
        "city_car": Body(
            3.56, 1.63,
            ((0.0, 0.69), (0.025, 0.81), (0.10, 0.91), (0.21, 0.98), (0.28, 1.00), (0.94, 1.02),
             (0.985, 0.94), (1.0, 0.74)),
            ((0.18, 0.97, 0.90), (0.37, 1.43, 0.75), (0.53, 1.51, 0.74), (0.83, 1.47, 0.72),
             (0.985, 1.00, 0.85)),
            0.29, (0.17, 0.84), _ROUND),
        "mpv": Body(
            4.45, 1.78,
            ((0.0, 0.75), (0.02, 0.88), (0.09, 0.97), (0.19, 1.03), (0.27, 1.06), (0.95, 1.08),
             (0.99, 0.98), (1.0, 0.79)),
            ((0.15, 1.01, 0.92), (0.36, 1.58, 0.80), (0.52, 1.69, 0.79), (0.90, 1.66, 0.77),
             (0.985, 1.07, 0.87)),
            0.32, (0.18, 0.81), _TALL),
        "black_cab": Body(
            4.58, 1.80,
            ((0.0, 0.78), (0.02, 0.90), (0.09, 0.98), (0.22, 1.03), (0.28, 1.06), (0.90, 1.08),
             (0.985, 1.00), (1.0, 0.80)),
            ((0.25, 1.02, 0.90), (0.37, 1.66, 0.81), (0.52, 1.79, 0.80), (0.86, 1.75, 0.78),
             (0.97, 1.06, 0.87)),
            0.33, (0.17, 0.80), _CAB, sign="TAXI"),
        "tall_taxi": Body(
            4.40, 1.70,
            ((0.0, 0.74), (0.02, 0.87), (0.09, 0.96), (0.20, 1.01), (0.28, 1.04), (0.95, 1.07),
             (0.99, 0.98), (1.0, 0.78)),
            ((0.18, 1.00, 0.91), (0.36, 1.61, 0.80), (0.50, 1.72, 0.79), (0.88, 1.69, 0.77),
             (0.985, 1.06, 0.86)),
            0.32, (0.18, 0.81), (Face("block", "wide", "tall"),), sign="タクシー"),
        "kei_car": Body(
            3.39, 1.475,
            ((0.0, 0.74), (0.025, 0.88), (0.09, 0.98), (0.15, 1.01), (0.22, 1.04), (0.95, 1.06),
             (0.99, 0.98), (1.0, 0.76)),
            ((0.11, 1.00, 0.93), (0.31, 1.61, 0.83), (0.48, 1.73, 0.82), (0.93, 1.70, 0.81),
             (0.99, 1.05, 0.90)),
            0.28, (0.15, 0.87), _ROUND, kei=True),
        "van": Body(
            5.05, 1.96,
            ((0.0, 0.80), (0.02, 0.97), (0.08, 1.08), (0.14, 1.15), (0.20, 1.18), (0.97, 1.20),
             (0.99, 1.18), (1.0, 0.85)),
            ((0.12, 1.13, 0.94), (0.27, 1.84, 0.86), (0.36, 1.95, 0.85), (0.95, 1.95, 0.85),
             (0.99, 1.19, 0.92)),
            0.34, (0.18, 0.80), _WORK, kind="van", cargo=True),
        "small_van": Body(
            4.40, 1.82,
            ((0.0, 0.74), (0.025, 0.89), (0.10, 0.99), (0.18, 1.05), (0.26, 1.08), (0.96, 1.10),
             (0.99, 1.08), (1.0, 0.82)),
            ((0.16, 1.03, 0.93), (0.35, 1.69, 0.84), (0.46, 1.80, 0.83), (0.94, 1.80, 0.82),
             (0.99, 1.09, 0.91)),
            0.31, (0.18, 0.80), _WORK, kind="van", cargo=True),
        "delivery_van": Body(
            5.45, 1.99,
            ((0.0, 0.86), (0.02, 1.04), (0.07, 1.16), (0.12, 1.24), (0.18, 1.29), (0.97, 1.33),
             (0.99, 1.30), (1.0, 0.92)),
            ((0.11, 1.23, 0.94), (0.26, 2.26, 0.87), (0.34, 2.56, 0.86), (0.96, 2.56, 0.86),
             (0.99, 1.31, 0.93)),
            0.35, (0.17, 0.79), _WORK, kind="van", cargo=True),
        "kei_van": Body(
            3.39, 1.475,
            ((0.0, 0.78), (0.02, 0.95), (0.06, 1.03), (0.10, 1.06), (0.16, 1.08), (0.97, 1.09),
             (0.99, 1.07), (1.0, 0.82)),
            ((0.075, 1.03, 0.95), (0.225, 1.78, 0.89), (0.28, 1.87, 0.885), (0.955, 1.87, 0.88),
             (0.99, 1.08, 0.93)),
            0.28, (0.16, 0.83), _WORK, kind="van", kei=True),
    }
)  # fmt: skip
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
