from dataclasses import replace

import numpy as np

from cityx.checks.conformance import check_action
from cityx.city import City
from cityx.protocol import Registry, action


def failed(function):
    results = check_action(function.encapsulation.id, Registry.of([function]))
    return {result.test for result in results if result.passed is False}


@action("nature/dice-v1", limits=["None known."])
def dice(city: City) -> City:
    """Draw a number from nowhere."""
    return replace(city, notes=(str(np.random.default_rng().random()),))


@action("terrain/dig-v1", limits=["None known."])
def dig(city: City) -> City:
    """Dig in the terrain that was given."""
    city.terrain.heights[0, 0] -= 1
    return city


@action("nature/wrong-v1", limits=["None known."])
def wrong(city: City) -> City:
    """Return a word."""
    return city.name


@action("nature/right-v1", limits=["None known."])
def right(city: City) -> City:
    """Keep the city."""
    return city


@action("convert/silent-v1", limits=["None known."], lossy=0.5)
def silent(city: City) -> str:
    """Say nothing of what is lost."""
    return city.name


def test_a_good_action_passes():
    assert failed(right) == set()


def test_an_action_that_is_not_reproducible_fails():
    assert failed(dice) == {"same seed gives the same result"}


def test_an_action_that_writes_into_its_inputs_fails():
    assert "inputs stay untouched" in failed(dig)


def test_an_action_that_returns_another_type_fails():
    assert "runs and returns its type" in failed(wrong)


def test_a_conversion_that_hides_its_loss_fails():
    assert failed(silent) == {"record is complete"}
