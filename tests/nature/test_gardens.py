from dataclasses import replace

import numpy as np
import pytest

from cityx.assets.furniture.street_furniture import furniture
from cityx.city.ground import LABEL
from cityx.city.scene import Instances
from cityx.ground.standing import stand_on
from cityx.nature.land.gardens import LAYER, gardens
from cityx.road.ground.ground_surface import ground


def with_door(city, x, y, yaw):
    door = Instances(
        np.zeros(1, np.int32), np.array([7], np.uint64), np.array([21], np.uint64),
        np.array([[x, y, 0.12]]), np.array([[0, 0, yaw]], np.float32), np.ones((1, 3), np.float32),
        np.ones((1, 3), np.float32),
    )  # fmt: skip
    return replace(city, scene=city.scene.with_instances("doors", [furniture("bench")], door))


@pytest.fixture(scope="module")
def village(crossroads):
    """The crossroads with walks of 2 m and nothing but lawns behind them."""
    layout = crossroads.layout
    roads = layout.roads.assign(sidewalk_left=2.0, sidewalk_right=2.0)
    houses = layout.buildings.assign(place="low")
    return ground(
        replace(crossroads, layout=replace(layout, roads=roads, buildings=houses,
                                           areas=layout.areas.iloc[:0]))
    )  # fmt: skip


def test_a_path_leads_from_the_door_to_the_walk_and_lies_on_the_lawn(village):
    city = gardens(with_door(village, 80.0, 20.0, 0.0))  # looks south, the walk ends at y = 7.15
    mesh = city.scene.meshes[LAYER]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    assert low[1] == pytest.approx(7.15, abs=0.1)
    assert high[1] == pytest.approx(19.88, abs=0.05)
    assert high[0] - low[0] == pytest.approx(1.2, abs=0.02)
    on_lawn = mesh.vertices[:, 1] > 7.3
    under = stand_on(village.scene.meshes["ground"], mesh.vertices[on_lawn, :2])
    assert set(under.label.tolist()) == {LABEL["block"]}
    assert (mesh.vertices[on_lawn, 2] - under.z) == pytest.approx(0.015, abs=1e-6)


def test_no_path_runs_through_a_house(village):
    # Behind the house at (15..55, 10..24) a door looks through it to the street.
    city = gardens(with_door(village, 35.0, 26.0, 0.0))
    mesh = city.scene.meshes.get(LAYER)
    assert mesh is None or not (
        (mesh.vertices[:, 0] > 15) & (mesh.vertices[:, 0] < 55)
        & (mesh.vertices[:, 1] > 10) & (mesh.vertices[:, 1] < 24)
    ).any()  # fmt: skip
