"""A house on a plain, and its shell put elsewhere than its layout says."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.report import run_checks
from cityx.checks.shell_checks import check_shells
from cityx.city import City, Frame, Layout, Scene, make_table, one_mesh
from cityx.city.city import Failure
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import empty_batch
from cityx.city.mesh_measures import plan_middle
from cityx.city.terrain import Terrain
from cityx.ids import id_text

HOUSE, OTHER = 7, 9
SIDES = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
RING = np.array([(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0)])
PLINTH = -0.5


def house(*, top=9.0, bottom=PLINTH, x=0.0, number=HOUSE):
    corners = [np.column_stack([RING + np.array([x, 0.0]), np.full(4, z)]) for z in (bottom, top)]
    return one_mesh(number, np.concatenate(corners) + np.array([0.0, 0.0, KERB_HEIGHT]), SIDES)


def city_of(shell, slope=0.0):
    shapes = [shapely.Polygon(RING)]
    buildings = make_table("buildings", shapes, id=[HOUSE], levels=[3], height=[9.0])
    parts = make_table("parts", shapes, id=[1], building=[HOUSE], base=[0.0], top=[9.0],
                       walls=[True])  # fmt: skip
    x = np.meshgrid(np.linspace(-40, 40, 9), np.linspace(-40, 40, 9))[0]
    layout = Layout((-40.0, -40.0, 40.0, 40.0), buildings, parts)
    return City("one", Frame(50.0, 8.0), layout, terrain=Terrain((-40.0, -40.0), 10.0, slope * x),
                scene=Scene().with_mesh("buildings", shell))  # fmt: skip


def failing(city):
    return {check.name: check.ids for check in check_shells(city) if not check.ok}


def test_a_shell_as_its_layout_asks_passes():
    assert failing(city_of(house())) == {}
    # On a slope a house may stand half a storey in the ground, and reaches as far down as needed.
    assert failing(city_of(house(), slope=0.1)) == {}


@pytest.mark.parametrize(
    ("shell", "name"),
    [(house(top=9.0 * 1.3), "building_height_off"), (house(top=6.3), "building_height_off"),
     (house(bottom=-1.5), "building_buried"), (house(x=1.0), "building_displaced")],
)  # fmt: skip
def test_a_shell_elsewhere_is_named(shell, name):
    assert failing(city_of(shell)) == {name: (id_text(HOUSE),)}


def test_a_parapet_and_a_plinth_are_let_pass():
    assert failing(city_of(house(top=9.2, bottom=-0.6, x=0.3))) == {}


def test_shells_that_the_layout_does_not_know_are_left_to_others():
    assert failing(city_of(house(top=20.0, number=OTHER))) == {}
    assert check_shells(city_of(empty_batch())) == []


def test_a_building_that_is_not_there_must_have_a_reason():
    city = city_of(house(number=OTHER))
    found = {check.name: check for check in run_checks(city)}["buildings_vanished"]
    assert (found.value, found.ids) == (1, (id_text(HOUSE),))
    told = replace(city, failures=(Failure(HOUSE, "building/shell-v1", "no area"),))
    assert {check.name: check for check in run_checks(told)}["buildings_vanished"].ok


def test_the_middle_of_a_plan_is_that_of_its_undersides():
    assert plan_middle(house()) == pytest.approx(np.array([[6.0, 4.0]]))
    nothing = replace(house(), material=np.zeros(6, np.int16), materials=("trim",))
    assert np.isnan(plan_middle(nothing)).all()
