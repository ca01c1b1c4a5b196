"""What vehicles look like that SUMO drives: sizes and shares of looks, paint by identity."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from cityx.assets.vehicles import BODIES, PAINT_SHARES, PAINTS
from cityx.city.tracks import MOVER
from cityx.geometry.identity import choose
from cityx.traffic.recording import Mover
from cityx.traffic.simulation import Look, Trip

# Look -> length, width and height, metres.
_LARGE = {
    "bus": (12.0, 2.55, 3.10), "truck": (8.2, 2.50, 3.45),
    "bicycle": (1.78, 0.60, 1.75), "motorcycle": (2.10, 0.75, 1.60), "scooter": (1.85, 0.70, 1.65),
}  # fmt: skip
_SHARES: Mapping[str, tuple[tuple[str, float], ...]] = {
    "car": (("car_hatchback", 0.40), ("car_sedan", 0.28), ("car_suv", 0.32)),
    "van": (("car_van", 1.0),),
    "truck": (("truck", 1.0),),
    "bus": (("bus", 1.0),),
    "motorcycle": (("motorcycle", 0.55), ("scooter", 0.45)),
    "bicycle": (("bicycle", 1.0),),
}
_PLAIN = np.ones(3)


def looks_of_kinds(speed: float | None = None) -> dict[str, tuple[tuple[Look, float], ...]]:
    """Return the looks of each kind of vehicle, with their shares.

    Parameters
    ----------
    speed
        Metres per second that drivers want whatever is allowed, None for what is allowed.
    """
    return {
        kind: tuple((Look(name, kind, _size(name), speed), share) for name, share in looks)
        for kind, looks in _SHARES.items()
    }


def _size(look: str) -> tuple[float, float, float]:
    if look in _LARGE:
        return _LARGE[look]
    body = BODIES[look.removeprefix("car_")]
    return body.length, body.width, max(z for _, z, _ in body.roof)


def movers_of(trips: tuple[Trip, ...], looks: tuple[Look, ...], seed: int) -> dict[str, Mover]:
    """Return what tracks say of the vehicles of trips, by name."""
    ids = np.array([int(trip.name, 16) for trip in trips], np.uint64)
    paint = PAINTS[choose(seed, "traffic/paint", ids, PAINT_SHARES)]
    found = {}
    for trip, colour in zip(trips, paint, strict=True):
        look = looks[trip.look]
        tint: NDArray[np.float64] = colour if look.kind != "bicycle" else _PLAIN
        found[trip.name] = Mover(MOVER[look.kind], look.name, look.size, tint)
    return found
