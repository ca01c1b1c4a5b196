from dataclasses import replace

import numpy as np
import pytest

from cityx.checks.predicates import measure
from cityx.city import Scene, one_mesh
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import concatenate


def _as_built(city):
    """The city with an upright triangle for every building, as if its shells stood."""
    corner = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
    face = np.array([(0, 1, 2)])
    table = city.layout.buildings
    if not len(table):
        return city
    batch = concatenate(
        one_mesh(int(key), corner * [1.0, 1.0, height + KERB_HEIGHT], face)
        for key, height in zip(table["id"], table["height"], strict=True)
    )
    return replace(city, scene=Scene(meshes={"buildings": batch}))


@pytest.fixture(scope="session")
def as_built():
    return _as_built


@pytest.fixture(scope="session")
def check_goals():
    """Asserts that a city meets all of its goals, of which it has some."""

    def check(city):
        assert city.goals
        built = _as_built(city)
        for goal in city.goals:
            found = measure(goal.predicate, built)
            assert found.met, (goal, found.evidence)

    return check
