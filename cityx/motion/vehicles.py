"""Vehicles that SUMO drives: looks of each kind with their shares, paint by identity."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cityx.assets.vehicles.car_parts import REGISTRATIONS
from cityx.assets.vehicles.movers import kind_of, looks_of, paints_of, registered, size_of
from cityx.ids import choose
from cityx.traffic.kinds import DRIVING
from cityx.traffic.recording import Mover
from cityx.traffic.simulation import Look, Trip


def looks_of_kinds(
    place: str = "", speed: float | None = None
) -> dict[str, tuple[tuple[Look, float], ...]]:
    """Return the looks of each kind of vehicle, with their shares.

    Parameters
    ----------
    place
        As of `cityx.ground.street_rules.place_of`.
    speed
        Metres per second that drivers want whatever is allowed, None for what is allowed.
    """
    return {
        kind: tuple((Look(name, kind, size_of(name), speed), share)
                    for name, share in looks_of(kind, place))
        for kind in DRIVING
    }  # fmt: skip


def movers_of(
    trips: Sequence[Trip], looks: Sequence[Look], seed: int, place: str = ""
) -> dict[str, Mover]:
    """Return what tracks say of the vehicles of trips, by name; `place` is that of their plates."""
    found = {}
    for trip in trips:
        name = looks[trip.look].name
        number = [np.uint64(int(trip.name, 16))]
        colors, shares = paints_of(name)
        paint = choose(seed, "traffic/paint", number, shares)[0]
        plate = choose(seed, "traffic/registration", number, [1.0] * REGISTRATIONS)[0]
        look = registered(name, place, int(plate))
        found[trip.name] = Mover(kind_of(name), look, size_of(name), colors[paint])
    return found
