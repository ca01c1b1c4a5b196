from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets import furniture
from cityx.city import Frame, Instances, Terrain, make_table
from cityx.city.ground import LABEL
from cityx.plugins.road.ground import ground
from cityx.plugins.road.parked_cars import parked_cars
from cityx.plugins.road.yards import yard_patches


@pytest.fixture(scope="module")
def parked(crossroads):
    return parked_cars(crossroads)


def kerbside(city):
    rows = city.scene.instances["vehicles"]
    xy = rows.position[:, :2]
    pick = np.abs(xy).min(axis=1) < 6.0
    return xy[pick], rows.rotation[pick]


def test_cars_stand_a_metre_from_the_kerb_and_six_from_the_junction(parked):
    xy, _ = kerbside(parked)
    assert len(xy) > 50
    assert np.abs(np.abs(xy).min(axis=1) - 4.0).max() < 0.15
    assert np.abs(xy).max(axis=1).min() > 9.0 + 6.0 - 0.5


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_cars_face_the_way_their_side_drives(crossroads, side):
    network = replace(crossroads.network, left_hand=np.full(4, side < 0))
    xy, turn = kerbside(parked_cars(replace(crossroads, network=network)))
    ahead = np.column_stack([np.sin(turn[:, 2]), -np.cos(turn[:, 2])])
    right = np.column_stack([ahead[:, 1], -ahead[:, 0]])
    assert (np.sum(xy * right, axis=1) * side > 1.5).all()


def test_no_two_cars_overlap(parked):
    from scipy.spatial import cKDTree

    xy = parked.scene.instances["vehicles"].position[:, :2]
    assert cKDTree(xy).query(xy, k=2)[0][:, 1].min() > 2.2


def test_a_car_park_is_about_half_full_and_keeps_its_cars(parked):
    xy = parked.scene.instances["vehicles"].position[:, :2]
    lot = shapely.box(20, -90, 90, -40)
    inside = shapely.contains(lot, shapely.points(xy))
    assert 40 < inside.sum() < 160
    assert (inside | (np.abs(xy).min(axis=1) < 6.0)).all()


def test_a_car_on_a_slope_leans_with_it(crossroads):
    slope = Terrain((-100.0, -100.0), 200.0, np.array([[0.0, 20.0], [0.0, 20.0]]))  # 10 % to east
    xy, turn = kerbside(parked_cars(replace(crossroads, terrain=slope), lots=0.0))
    east = np.abs(xy[:, 1]) < 5
    pitch, roll, yaw = turn.T
    uphill = np.sin(yaw) > 0.9  # front -y faces east, so the nose goes up: a negative turn about x
    assert pitch[east & uphill] == pytest.approx(-np.arctan(0.1), abs=2e-3)
    downhill = np.sin(yaw) < -0.9
    assert pitch[east & downhill] == pytest.approx(np.arctan(0.1), abs=2e-3)
    assert np.abs(roll[east]).max() < 5e-3


def test_yards_have_cars_in_their_bays_and_nowhere_else(crossroads):
    yards = [(x, y) for x in (-94, 12) for y in (-94, 12)]
    wings = [shapely.box(x, y, x + 82, y + 82) for x, y in yards]
    walls = shapely.difference(wings, shapely.buffer(wings, -8, join_style="mitre"))
    ids = np.arange(21, 25)
    houses = make_table("buildings", walls, id=ids, place=["core"] * 4)
    parts = make_table("parts", walls, id=ids, building=ids, base=[0.0] * 4, top=[9.0] * 4,
                       walls=[True] * 4)  # fmt: skip
    layout = replace(crossroads.layout, buildings=houses, parts=parts,
                     areas=crossroads.layout.areas[:0])  # fmt: skip
    town = replace(crossroads, layout=layout)
    town = ground(replace(town, heights=None, stages_done=frozenset({"layout", "terrain"})))
    without = parked_cars(town, lots=0.0).scene.instances["vehicles"]
    full = parked_cars(town, lots=1.0).scene.instances["vehicles"]
    patches = yard_patches(town.layout, town.network)
    bays = patches.shapes[patches.label == LABEL["parking"]]
    new = full.position[~np.isin(full.object_id, without.object_id), :2]
    assert len(new) > 3
    assert shapely.covers(shapely.union_all(bays), shapely.points(new)).all()
    again = parked_cars(town, lots=1.0).scene.instances["vehicles"]
    assert again.position.tobytes() == full.position.tobytes()


def test_few_keep_a_car_in_the_streets_of_japan(crossroads):
    tokyo = replace(crossroads, frame=Frame(35.69, 139.78))
    count = [len(kerbside(parked_cars(city))[0]) for city in (crossroads, tokyo)]
    assert 0.1 * count[0] < count[1] < 0.6 * count[0]


def test_vans_unload_before_shops(crossroads):
    shops = np.array([[x, 10.0, 0.0] for x in (-60.0, -40.0, 30.0, 50.0, 70.0)])
    count = len(shops)
    front = Instances(
        np.zeros(count, np.int32), np.arange(7, 7 + count, dtype=np.uint64),
        np.zeros(count, np.uint64), shops, np.zeros((count, 3), np.float32),
        np.ones((count, 3), np.float32), np.ones((count, 3), np.float32),
    )  # fmt: skip
    shopping = replace(crossroads, scene=crossroads.scene.with_instances(
        "shopfronts", [furniture.furniture("bench")], front))  # fmt: skip
    vans = []
    for city in (crossroads, shopping):
        found = parked_cars(city, occupancy=1.0)
        rows = found.scene.instances["vehicles"]
        names = [found.scene.prototypes[i].name for i in rows.prototype]
        far = np.linalg.norm(rows.position[:, None, :2] - shops[:, :2], axis=2).min(axis=1)
        vans.append((sum("van" in name for name in names), (far < 12.0).sum()))
    assert vans[1][0] > vans[0][0]
    assert vans[1][0] - vans[0][0] <= vans[1][1]


def test_a_bridge_has_no_parked_cars(crossroads):
    roads = crossroads.layout.roads.assign(bridge=True)
    city = replace(crossroads, layout=replace(crossroads.layout, roads=roads))
    assert len(kerbside(parked_cars(city))[0]) == 0


def test_occupancy_none_means_no_cars(crossroads):
    assert "vehicles" not in parked_cars(crossroads, occupancy=0.0, lots=0.0).scene.instances or (
        parked_cars(crossroads, occupancy=0.0, lots=0.0).scene.instances["vehicles"].count == 0
    )
