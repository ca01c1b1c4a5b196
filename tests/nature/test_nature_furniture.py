from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.furniture_checks import check_furniture
from cityx.city import City, Frame, Layout, make_table, one_mesh
from cityx.city.ground import KERB_HEIGHT
from cityx.ground.pieces import heights, may_stand, pieces, with_pieces
from cityx.ground.standing import WALKED
from cityx.ids import stable_id
from cityx.nature.furniture.furnishing import furniture
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes


@pytest.fixture(scope="module")
def placed(crossroads):
    return furniture(crossroads)


def named(city, prefix):
    rows = city.scene.instances["street_furniture"]
    names = np.array([city.scene.prototypes[i].name for i in rows.prototype])
    pick = np.char.startswith(names, prefix)
    return rows.position[pick], rows.rotation[pick, 2]


def facing(yaw):
    return np.column_stack([np.sin(yaw), -np.cos(yaw)])


def test_nothing_stands_on_a_carriageway(placed):
    xy = placed.scene.instances["street_furniture"].position[:, :2]
    assert (np.abs(xy).min(axis=1) > 5.3).all()


def test_a_bench_turns_to_the_road(placed):
    position, yaw = named(placed, "bench")
    assert len(position) == 1
    assert facing(yaw)[0] == pytest.approx([0.0, 1.0], abs=1e-6)


def test_lamps_stand_behind_the_kerb_and_lean_to_the_road(placed):
    position, yaw = named(placed, "street_lamp")
    kerbside = np.abs(np.abs(position[:, :2]).min(axis=1) - 5.6) < 1e-6
    assert kerbside.sum() >= 20
    inward = facing(yaw)[kerbside]
    near = position[kerbside, :2].copy()
    far = np.abs(near).argmax(axis=1)
    near[np.arange(len(near)), far] = 0.0
    assert (np.sum(inward * near, axis=1) < -5.0).all()


def test_no_lamps_are_invented_where_the_map_has_them(crossroads):
    points = crossroads.layout.points
    lit = replace(crossroads, layout=replace(crossroads.layout,
                  points=points.assign(kind="street_lamp")))  # fmt: skip
    assert len(named(furniture(lit), "street_lamp")[0]) <= len(points)


def test_what_stands_beside_a_ramp_stands_on_its_walk(crossroads):
    lawn = one_mesh(stable_id("ground", "grass"), [(-9, -9, 0.12), (0, -9, 0.12), (0, 9, 0.12)],
                    [[0, 1, 2]])  # fmt: skip
    ramp = [(0, -9, 2.6), (9, -9, 2.6), (9, 9, 2.6), (0, 9, 2.6)]
    over = [(x, y, 9.0) for x, y, _ in ramp]
    decks = one_mesh(5, [*ramp, *over], [[0, 1, 2, 3], [4, 5, 6, 7]])
    scene = crossroads.scene.with_mesh("ground", lawn).with_mesh("decks", decks)
    found = heights(replace(crossroads, scene=scene), np.array([(-2, -7), (5, 1), (50, 50.0)]))
    assert found == pytest.approx([0.12, 2.6, KERB_HEIGHT])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_signals_stand_on_the_driving_side_and_face_the_traffic(crossroads, side):
    network = replace(crossroads.network, left_hand=np.full(4, side < 0))
    position, yaw = named(furniture(replace(crossroads, network=network)), "traffic_signal")
    before = []
    for xy, look in zip(position[:, :2], facing(yaw), strict=True):
        travel = -look
        right = np.array([travel[1], -travel[0]])
        assert xy @ right * side > 5.0  # kerb of the side one drives on
        before.append(xy @ look > 0)
    assert sum(before) == 4
    # Where one drives on the left they are repeated behind the junction.
    assert len(before) == (4 if side > 0 else 8)


def test_a_hydrant_on_the_carriageway_moves_to_the_kerb(placed):
    position, _ = named(placed, "fire_hydrant")
    assert position[0, :2] == pytest.approx([-30.0, -5.36], abs=0.02)


def test_the_order_of_rows_changes_nothing(placed, shuffled):
    a = placed.scene.instances["street_furniture"]
    b = furniture(shuffled).scene.instances["street_furniture"]
    for name in ("object_id", "position", "rotation", "prototype"):
        assert np.array_equal(getattr(a, name), getattr(b, name))


def test_a_city_without_roads_gets_its_mapped_things(crossroads):
    layout = crossroads.layout
    bare = replace(crossroads, network=None, layout=replace(layout, roads=layout.roads.iloc[:0]))
    assert len(named(furniture(bare), "bench")[0]) == 1


def test_a_mast_at_the_kerb_stands_whatever_its_arm_reaches_over(crossroads):
    xy = np.array([[30.0, 5.6], [30.0, 4.0]])
    masts = pieces("traffic_signal_mast", xy, np.arange(1, 3, dtype=np.uint64), np.zeros(2))
    assert may_stand(crossroads, masts).tolist() == [True, False]


def test_what_may_stand_at_a_bend_is_what_the_check_lets_stand():
    # A drive that turns back on itself: its lane has a mitre far outside of its centreline.
    way = shapely.LineString([(-40, 0), (0, 0), (-32, 16)])
    roads = make_table(
        "roads", [way], id=[1], kind=["service"], width=[6.0], lanes=[1], oneway=[True]
    )
    layout = Layout((-60.0, -60.0, 60.0, 60.0), roads=roads)
    city = City("bend", Frame(52.5, 13.4), layout, stages_done=frozenset({"layout", "terrain"}))
    city = ground(lanes(city))
    xy = np.stack(np.meshgrid(np.arange(0.0, 9.0, 0.25), np.arange(-6.0, 6.0, 0.25)), axis=2)
    xy = xy.reshape(-1, 2)
    sheds = pieces("garden_shed", xy, np.arange(1, len(xy) + 1, dtype=np.uint64), np.zeros(len(xy)))
    free = may_stand(city, sheds)
    assert 0 < free.sum() < len(free)
    standing = with_pieces(city, "street_pieces", sheds.take(free))
    found = {check.name: check.value for check in check_furniture(standing)}
    assert found["furniture_in_lanes"] == 0
    all_of_them = with_pieces(city, "street_pieces", sheds)
    found = {check.name: check.value for check in check_furniture(all_of_them)}
    assert found["furniture_in_lanes"] <= (~free).sum()
    assert found["furniture_in_lanes"] > 0.8 * (~free).sum()


def test_lamps_also_light_paving_that_is_no_walk_of_the_street(crossroads):
    roads = crossroads.layout.roads.assign(sidewalk_left=0.0, sidewalk_right=0.0)
    areas = make_table("areas", [shapely.box(-90, -9, 90, 9)], id=[31], kind=["pedestrian"])
    bare = replace(crossroads.layout, roads=roads)
    counts = []
    for layout in (bare, replace(bare, areas=areas)):
        city = ground(replace(crossroads, layout=layout))
        xy = named(furniture(city), "street_lamp")[0][:, :2]
        counts.append(len(xy) - 1)  # one is of the map
        assert city.ground.on(xy, *WALKED).sum() == counts[-1]
    assert counts[0] < 3 < counts[1]
