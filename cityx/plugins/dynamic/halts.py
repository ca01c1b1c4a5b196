"""Where traffic halts: before zebras, under signals, for streets of a higher class."""

from __future__ import annotations

import numpy as np

from cityx.city import City
from cityx.plugins.road.marks import BEFORE, RANK, street_of
from cityx.plugins.road.sections import bands_of
from cityx.traffic.streets import Halts


def halts_of(city: City) -> Halts:
    """Return where traffic halts in a city that has a network."""
    network = city.network
    assert network is not None
    street = street_of(city.layout, network, bands_of(city.layout, network))
    halt = street.setback + street.depth[:, None] + BEFORE
    return Halts(
        np.where(network.crossing, halt, 0.0), street.signalled, len(RANK) - street.rank,
        network.crossing, network.trim + street.setback + street.depth[:, None] / 2, street.depth,
    )  # fmt: skip
