"""Vehicles that SUMO drives: looks of each kind with their shares, paint by identity."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cityx.assets.movers import VEHICLE_LOOKS, kind_of, paints_of, size_of
from cityx.geometry.identity import choose
from cityx.traffic.kinds import DRIVING
from cityx.traffic.recording import Mover
from cityx.traffic.simulation import Look, Trip


def looks_of_kinds(speed: float | None = None) -> dict[str, tuple[tuple[Look, float], ...]]:
    """Return the looks of each kind of vehicle, with their shares.

    Parameters
    ----------
    speed
        Metres per second that drivers want whatever is allowed, None for what is allowed.
    """
    return {
        kind: tuple((Look(name, kind, size_of(name), speed), share)
                    for name, share in VEHICLE_LOOKS[kind])
        for kind in DRIVING
    }  # fmt: skip


def movers_of(trips: Sequence[Trip], looks: Sequence[Look], seed: int) -> dict[str, Mover]:
    """Return what tracks say of the vehicles of trips, by name."""
    found = {}
    for trip in trips:
        name = looks[trip.look].name
        colors, shares = paints_of(name)
        paint = choose(seed, "traffic/paint", [np.uint64(int(trip.name, 16))], shares)[0]
        found[trip.name] = Mover(kind_of(name), name, size_of(name), colors[paint])
    return found
