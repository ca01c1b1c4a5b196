from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.furniture import street_furniture as furniture
from cityx.city import Frame, Instances, Terrain, make_table
from cityx.city.ground import LABEL
from cityx.city.layout import joined_tables
from cityx.city.rows import without_objects
from cityx.city.store import view_of
from cityx.dataset.classes import CLASS
from cityx.dataset.stage import stage_of
from cityx.geometry.scatter import near_pairs
from cityx.places.profiles import profile_named
from cityx.road.ground.ground_surface import ground
from cityx.road.ground.yards import yard_patches
from cityx.road.parking.parked_cars import VAN_LEFT, parked_cars

LAND = profile_named("world").land


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


def test_cars_beside_one_another_are_seldom_alike(parked):
    rows = parked.scene.instances["vehicles"]
    pairs = near_pairs(rows.position[:, :2], 6.5)
    assert len(pairs) > 100
    first, second = rows.prototype[pairs].T
    share = np.bincount(rows.prototype) / rows.count
    assert np.mean(first == second) < 0.5 * np.sum(share**2)  # of what chance would give


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


def test_cars_stand_on_the_ground_where_its_faces_leave_the_terrain(crossroads):
    built = ground(replace(crossroads, ground=None, heights=None))
    lowered = Terrain((-500.0, -500.0), 1000.0, np.full((2, 2), -0.7))  # as below a wall
    position = parked_cars(replace(built, terrain=lowered)).scene.instances["vehicles"].position
    inside = np.abs(position[:, :2]).max(axis=1) < 85.0
    assert inside.sum() > 40
    assert np.abs(position[inside, 2]).max() < 0.01


def test_yards_have_cars_in_their_bays_and_nowhere_else(crossroads):
    yards = [(x, y) for x in (-94, 12) for y in (-94, 12)]
    wings = [shapely.box(x, y, x + 82, y + 82) for x, y in yards]
    walls = shapely.buffer(wings, -16, join_style="mitre")  # behind forecourts
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
    patches = yard_patches(town.layout, town.network, LAND)
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


def with_shops(city):
    """Shops at both sides of the eastern arm."""
    spots = np.array([(x, y, 0.0) for x in range(20, 95, 15) for y in (-10.0, 10.0)])
    count = len(spots)
    ones = np.ones((count, 3), np.float32)
    ids = np.arange(count, dtype=np.uint64) + np.uint64(7)
    fronts = Instances(np.zeros(count, np.int32), ids, ids, spots, 0 * ones, ones, ones)
    prototypes = [furniture.furniture("bench")]
    return replace(city, scene=city.scene.with_instances("shopfronts", prototypes, fronts))


def vans_of(city):
    """Places of the vans among the cars along kerbs when every bay is taken."""
    found = parked_cars(city, occupancy=1.0, lots=0.0)
    rows = found.scene.instances["vehicles"]
    # Small vans stand where cars do.
    names = [found.scene.prototypes[i].name for i in rows.prototype]
    van = np.array([name.startswith(("car_van", "car_delivery_van")) for name in names])
    return rows.position[van, :2]


def test_vans_unload_before_shops(crossroads):
    usual, shopping = vans_of(crossroads), vans_of(with_shops(crossroads))
    arm = [np.sum(np.abs(vans[:, 1]) < 6.0) for vans in (usual, shopping)]
    assert arm[1] > arm[0]
    east = [vans[vans[:, 0] < 6.0] for vans in (usual, shopping)]
    assert np.array_equal(*east)  # the other arms keep theirs


def test_no_van_parks_where_it_would_leave_no_way_for_a_fire_engine(crossroads):
    network = crossroads.network
    tight = replace(network, half_width=np.full(4, (4.0 + VAN_LEFT) / 2 - 0.1))
    assert len(vans_of(crossroads)) > 0
    assert len(vans_of(with_shops(replace(crossroads, network=tight)))) == 0


def test_a_bridge_has_no_parked_cars(crossroads):
    roads = crossroads.layout.roads.assign(bridge=True)
    city = replace(crossroads, layout=replace(crossroads.layout, roads=roads))
    assert len(kerbside(parked_cars(city))[0]) == 0


def test_no_car_parks_where_the_ground_opens_for_a_ramp(crossroads):
    built = ground(crossroads)
    whole = parked_cars(built).scene.instances["vehicles"].position
    west = built.ground.vertices[built.ground.triangles][:, :, 0].mean(axis=1) < 0
    label = built.ground.face_label.copy()
    label[built.ground.triangle_face[west]] = LABEL["void"]
    opened = replace(built, ground=replace(built.ground, face_label=label))
    left = parked_cars(opened).scene.instances["vehicles"].position
    assert not opened.ground.on(left[:, :2], "void").any()
    assert 0 < len(left) < len(whole)


def test_occupancy_none_means_no_cars(crossroads):
    assert "vehicles" not in parked_cars(crossroads, occupancy=0.0, lots=0.0).scene.instances or (
        parked_cars(crossroads, occupancy=0.0, lots=0.0).scene.instances["vehicles"].count == 0
    )


def test_near_cars_share_bodies_and_own_faces_and_plates(crossroads):
    near = parked_cars(replace(crossroads, lod=3))
    cars, parts = (near.scene.instances[layer] for layer in ("vehicles", "vehicle_parts"))
    names = np.array([prototype.name for prototype in near.scene.prototypes])
    assert len(np.unique(cars.prototype)) < 14
    assert np.array_equal(np.unique(parts.owner), cars.object_id)
    assert parts.count == 3 * cars.count
    assert not np.isin(parts.object_id, cars.object_id).any()
    plates = parts.prototype[np.char.startswith(names[parts.prototype], "number_plate")]
    assert len(np.unique(plates)) > 24
    again = parked_cars(replace(crossroads, lod=3)).scene.instances["vehicle_parts"]
    assert again.position.tobytes() == parts.position.tobytes()
    assert again.prototype.tobytes() == parts.prototype.tobytes()
    without = without_objects(near.scene, cars.object_id[:1].tolist())
    assert without.instances["vehicle_parts"].count == parts.count - 3


def test_plates_of_a_car_are_the_car_in_truth(crossroads):
    near = parked_cars(replace(crossroads, lod=3))
    stage = stage_of(view_of(near))
    part = np.flatnonzero(np.isin(stage.piece, near.scene.instances["vehicle_parts"].object_id))
    owners = stage.object_id[part]
    assert np.isin(owners, near.scene.instances["vehicles"].object_id).all()
    assert set(stage.semantic[stage.whole[part]].tolist()) == {CLASS["car"]}


def test_nobody_parks_where_people_get_into_a_tram(crossroads, parked):
    stop = shapely.Point(kerbside(parked)[0][0])
    points = make_table("points", [stop], id=[7], kind=["tram_stop"])
    city = parked_cars(replace(crossroads, layout=replace(crossroads.layout, points=points)))
    spots = [shapely.points(one.scene.instances["vehicles"].position[:, :2])
             for one in (parked, city)]  # fmt: skip
    near, left = (int(shapely.dwithin(each, stop, 15.0).sum()) for each in spots)
    assert near > 2
    assert left == 0
    assert len(spots[1]) > 0.8 * len(spots[0])


def test_nobody_parks_on_a_level_crossing(crossroads, parked):
    at = kerbside(parked)[0][0]
    across = at[::-1] / np.hypot(*at) * [1.0, -1.0]
    rail = shapely.LineString([at - 30.0 * across, at + 30.0 * across])
    layout = crossroads.layout
    row = layout.roads.iloc[[0]].assign(id=[77], kind=["rail"]).set_geometry([rail])
    roads = joined_tables(layout.roads, row)
    city = parked_cars(replace(crossroads, layout=replace(layout, roads=roads)))
    xy = city.scene.instances["vehicles"].position[:, :2]
    assert shapely.distance(shapely.points(kerbside(parked)[0]), rail).min() < 1.5
    assert shapely.distance(shapely.points(xy), rail).min() > 6.5
