"""Where traffic halts: before zebras, under signals, for streets of a higher class."""

from __future__ import annotations

import numpy as np

from cityx.city import City
from cityx.places.profiles import profile_of
from cityx.road.markings.marks import RANK, street_of
from cityx.road.network.sections import bands_of
from cityx.traffic.streets import Halts


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
    )  # fmt: skip
