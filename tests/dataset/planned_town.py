"""A crossroads with a plaza, two houses and traffic, made by code, to plan pictures in."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from crossing_town import crossing_town
from moving_city import moving

from cityx.building.shell import prism
from cityx.city import City
from cityx.city.store import view_of
from cityx.dataset.plans.planning import plan
from cityx.dataset.stage import Stage, stage_of

SECONDS = 10.0
# Cars that go east and west, one behind the other, and two people on the pavements.
CARS = [(100 + k, "car_sedan", "car", "ride", (-60 + 18 * k, -1.5, 0.0), 0.0, 5.0)
        for k in range(3)]  # fmt: skip
WALKER = ("person_male_casual_2", "pedestrian", "walk")
PEOPLE = [(200 + k, *WALKER, (-40 + 30 * k, 4.2, 0.12), 0.0, 1.4) for k in range(2)]


@cache
def town() -> City:
    """Return the place with all that moves in it."""
    tracks = moving(*CARS, *PEOPLE, seconds=SECONDS).tracks
    return replace(prism(crossing_town()), tracks=tracks)


@cache
def stage() -> Stage:
    """Return its scene without what moves."""
    return stage_of(view_of(replace(town(), tracks=None)))


def planned(name, count, *, size=(160, 120), city=None, **options):
    """Return the plan of the place, or of a place like it."""
    return plan(city or town(), name, count, size, stage=stage(), **options)


def eyes(shots):
    """(n, 3) where shots are taken from."""
    return np.array([shot.camera.position for shot in shots])
