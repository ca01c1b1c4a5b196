"""Vehicles that SUMO drives: looks and paint of each kind, and where all of them halt."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cityx.assets.vehicles.car_parts import REGISTRATIONS
from cityx.assets.vehicles.movers import kind_of, looks_of, paints_of, registered, size_of
from cityx.city import City
from cityx.ids import choose
from cityx.places.profile import Vehicles
from cityx.places.profiles import profile_of
from cityx.road.markings.marks import PLAIN, RANK, street_of
from cityx.road.network.sections import bands_of
from cityx.system.remembered import Remembered
from cityx.traffic.kinds import DRIVING
from cityx.traffic.laying import streets_of
from cityx.traffic.recording import Mover
from cityx.traffic.simulation import Look, Trip
from cityx.traffic.streets import Halts, Streets


def looks_of_kinds(
    vehicles: Vehicles, speed: float | None = None
) -> dict[str, tuple[tuple[Look, float], ...]]:
    """Return the looks of each kind of vehicle, with their shares.

    Parameters
    ----------
    vehicles
        Of the profile of the place.
    speed
        Metres per second that drivers want whatever is allowed, None for what is allowed.
    """
    return {
        kind: tuple((Look(name, kind, size_of(name), speed), share)
                    for name, share in looks_of(kind, vehicles))
        for kind in DRIVING
    }  # fmt: skip


def movers_of(
    trips: Sequence[Trip], looks: Sequence[Look], seed: int, plates: str = ""
) -> dict[str, Mover]:
    """Return what tracks say of the vehicles of trips, by name; `plates` are those of cars."""
    found = {}
    for trip in trips:
        name = looks[trip.look].name
        number = [np.uint64(int(trip.name, 16))]
        colors, shares = paints_of(name)
        paint = choose(seed, "traffic/paint", number, shares)[0]
        plate = choose(seed, "traffic/registration", number, [1.0] * REGISTRATIONS)[0]
        look = registered(name, plates, int(plate))
        found[trip.name] = Mover(kind_of(name), look, size_of(name), colors[paint])
    return found


_DRIVEN: Remembered[Streets] = Remembered()


def driven_streets(city: City) -> Streets:
    """Return the streets that traffic drives on in a city with lanes; the last are remembered."""
    parts = [city.network, city.lanes, city.layout, city.terrain]
    return _DRIVEN.get(
        lambda: streets_of(city, halts_of(city)), parts, city.frame, city.frame.place
    )


def halts_of(city: City) -> Halts:
    """Return where traffic halts in a city that has a network."""
    network = city.network
    assert network is not None
    bands = bands_of(city.layout, network)
    street = street_of(city.layout, network, bands, profile_of(city.frame).painting)
    return Halts(
        np.where(street.marked, np.maximum(street.halt, 0.0), 0.0), street.signalled,
        len(RANK) - street.rank, street.marked,
        network.trim + street.setback + street.depth[:, None] / 2, street.depth,
        street.crossing == PLAIN, np.maximum(street.halt, 0.0), street.mapped,
    )  # fmt: skip
