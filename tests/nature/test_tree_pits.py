from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.furniture.tree_pits import HALF, PITS, pit
from cityx.city import City, Frame, Layout, make_table
from cityx.nature.trees.planting import trees
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network


@pytest.fixture(scope="module")
def street():
    """A street that runs 30 degrees off east, with a tree on its walk and one on the lawn."""
    way = np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)])
    roads = make_table(
        "roads", [shapely.LineString([-80 * way, 80 * way])], id=[1], kind=["residential"],
        name=["A"], width=[8.0], sidewalk_left=[3.0], sidewalk_right=[3.0], lanes=[2],
    )  # fmt: skip
    aside = np.array([-way[1], way[0]])
    areas = make_table("areas", [shapely.box(-20, 30, 20, 60)], id=[5], kind=["grass"])
    points = make_table("points", [shapely.Point(5.2 * aside), shapely.Point(0, 45)], id=[7, 8],
                        kind=["tree", "tree"])  # fmt: skip
    layout = Layout((-60.0, -60.0, 60.0, 60.0), roads=roads, areas=areas, points=points)
    return ground(lanes(network(City("street", Frame(50.0, 8.0), layout))))


def test_a_tree_on_paving_gets_a_pit_and_one_on_a_lawn_none(street):
    made = trees(street, budget=0, street_trees=False).scene.instances
    assert sorted(made["trees"].object_id.tolist()) == [7, 8]
    pits = made["tree_pits"]
    assert pits.owner.tolist() == [7]
    trunk = made["trees"].position[made["trees"].object_id == 7]
    assert np.array_equal(pits.position, trunk)


def test_a_pit_lies_square_to_the_street(street):
    pits = trees(street, budget=0, street_trees=False).scene.instances["tree_pits"]
    assert pits.rotation[0, 2] % (np.pi / 2) == pytest.approx(np.pi / 6, abs=0.02)


def test_the_same_seed_gives_the_same_pits(street):
    first, second = (trees(street).scene.instances["tree_pits"] for _ in range(2))
    for name in ("object_id", "position", "rotation"):
        assert np.array_equal(getattr(first, name), getattr(second, name))


def test_the_lower_levels_have_no_pits(street):
    assert "tree_pits" not in trees(replace(street, lod=1)).scene.instances


@pytest.mark.parametrize("name", PITS)
def test_pits_are_flat_and_leave_the_trunk_free(name):
    mesh = pit(name).mesh
    assert mesh.vertices[:, 2].max() < 0.07
    assert np.abs(mesh.vertices[:, :2]).max() < HALF + 0.1
    iron = "metal_dark" in mesh.materials
    if iron:
        corners = mesh.faces[mesh.material == mesh.materials.index("metal_dark")]
        middle = mesh.vertices[corners[:, :3]].mean(axis=1)
        assert np.abs(middle[:, :2]).max(axis=1).min() > 0.3
