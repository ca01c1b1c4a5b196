from dataclasses import replace

import numpy as np
import pytest

from cityx.agents.planning.planner import OfflinePlanner, arguments, in_order
from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout, Scene, one_mesh
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import concatenate
from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol import registry
from cityx.protocol.running import Call, run_action


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


@pytest.fixture(scope="session")
def laid_out():
    """Makes the layout that a sentence asks for."""
    actions = registry(outside=False)
    planner = OfflinePlanner(actions.records())

    def build(text, seed=3):
        slots = slots_of_brief(read_brief(text))
        city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=seed)
        given = arguments(planner.records["layout/town-v1"], slots)
        city = run_action(city, Call("layout/town-v1", given), actions).city
        for item in in_order(planner.answers(slots), planner.records):
            if item.action.startswith("layout/"):
                city = run_action(city, item.call, actions).city
        return city

    return build


@pytest.fixture(scope="session")
def check_sentence(laid_out):
    """Asserts that the layout of a sentence meets what it asks for, and returns it."""

    def check(text, *, but=()):
        brief = read_brief(text)
        assert brief.words_unread == tuple(but), brief.words_unread
        assert brief.goals
        city = laid_out(text)
        built = _as_built(city)
        for predicate in [g.predicate for g in brief.goals] + [g.predicate for g in city.goals]:
            found = measure(predicate, built)
            assert found.met, (predicate, found.evidence)
        return city

    return check
