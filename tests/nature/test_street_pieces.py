from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.furniture.street_furniture import furniture as piece
from cityx.building.shops.shop_names import shop_names
from cityx.checks.furniture_checks import check_furniture
from cityx.city import Frame, make_table
from cityx.city.ground import KERB_WIDTH
from cityx.city.scene import Instances, Prototype
from cityx.city.thing_outlines import placed_outlines
from cityx.ground.pieces import (
    front,
    join_pieces,
    pieces,
    room_along,
    walk_rims,
    with_pieces,
)
from cityx.ground.standing import WALKED, stand_on
from cityx.ground.street_rules import KERB_RULES, SCOOTERS, WALL_GAP, rates
from cityx.ground.walking.passage import crowding, in_lanes
from cityx.nature.furniture.corner_kerbs import FROM_CORNER
from cityx.nature.furniture.furnishing import furniture
from cityx.nature.furniture.street_pieces import GOODS, LAYER, _free, _site, street_pieces
from cityx.places.profiles import profile_named
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes


@pytest.fixture(scope="module")
def avenue(crossroads):
    """The crossroads with walks of 5 m, laid out as ground."""
    roads = crossroads.layout.roads.assign(
        sidewalk_left=5.0, sidewalk_right=5.0, kind="primary", parking_left=False,
        parking_right=False,
    )  # fmt: skip
    buildings = crossroads.layout.buildings.assign(place="core")
    city = replace(crossroads, layout=replace(crossroads.layout, roads=roads, buildings=buildings))
    return ground(lanes(replace(city, stages_done=frozenset({"layout", "terrain"}))))


@pytest.fixture(scope="module")
def furnished(avenue):
    return street_pieces(avenue, density=2.0)


def names_of(city):
    rows = city.scene.instances[LAYER]
    return np.array([city.scene.prototypes[i].name for i in rows.prototype])


def test_wide_walks_of_a_town_get_benches_bins_and_tubs(furnished):
    assert {"bench", "planter", "waste_basket"} <= set(names_of(furnished))


def test_every_piece_leaves_room_and_none_stands_in_a_lane(furnished):
    values = {check.name: check.value for check in check_furniture(furnished)}
    assert values == {"furniture_in_lanes": 0.0, "furniture_on_walkway": 0.0}


def test_narrow_walks_get_nothing_but_where_a_yard_widens_them(avenue):
    roads = avenue.layout.roads.assign(sidewalk_left=1.6, sidewalk_right=1.6)
    narrow = ground(replace(avenue, layout=replace(avenue.layout, roads=roads)))
    rows = street_pieces(narrow, density=3.0).scene.instances.get(LAYER)
    xy = rows.position[:, :2]
    kerbside = np.abs(xy).min(axis=1) < 6.8  # the walks end there
    across = np.abs(xy[kerbside]).argmin(axis=1)
    beyond = xy[kerbside].copy()
    beyond[np.arange(len(beyond)), across] = np.sign(beyond[np.arange(len(beyond)), across]) * 7.1
    assert kerbside.sum() < 3
    assert narrow.ground.on(beyond, *WALKED).all()


def test_pieces_stand_on_the_ground(furnished):
    rows = furnished.scene.instances[LAYER]
    z = stand_on(furnished.scene.meshes["ground"], rows.position[:, :2]).z
    assert rows.position[:, 2] == pytest.approx(z)


def test_the_same_seed_gives_the_same_pieces(avenue, furnished):
    a, b = furnished.scene.instances[LAYER], street_pieces(avenue, density=2.0)
    for name in ("object_id", "position", "rotation", "prototype"):
        assert getattr(a, name).tobytes() == getattr(b.scene.instances[LAYER], name).tobytes()


def trading(avenue, latitude, longitude):
    """The avenue with twenty shops along the northern walks, at a place on Earth."""
    x = np.concatenate([np.linspace(-54, -16, 10), np.linspace(16, 54, 10)])
    one = np.ones((20, 3), np.float32)
    shops = Instances(
        np.zeros(20, np.int32), np.arange(900, 920, dtype=np.uint64), np.zeros(20, np.uint64),
        np.column_stack([x, np.full(20, 10.0), np.full(20, 0.1)]), 0 * one, one, one,
    )  # fmt: skip
    scene = avenue.scene.with_instances(
        "shopfronts", [Prototype("shop_modern", "shopfront", piece("bench").mesh)], shops
    )
    return replace(avenue, scene=scene, frame=Frame(latitude, longitude))


def test_shops_put_wares_out_and_in_japan_banners(avenue):
    wares, banners = {"fruit_stand", "flower_stand", "clothes_rail"}, {"banner_red", "banner_blue"}
    found = {}
    for place, at in {"japan": (35.69, 139.77), "europe": (52.5, 13.4)}.items():
        made = street_pieces(trading(avenue, *at))
        again = street_pieces(trading(avenue, *at)).scene.instances[LAYER]
        rows = made.scene.instances[LAYER]
        assert np.array_equal(rows.object_id, again.object_id)
        assert np.array_equal(rows.position, again.position)
        values = {check.name: check.value for check in check_furniture(made)}
        assert values == {"furniture_in_lanes": 0.0, "furniture_on_walkway": 0.0}
        found[place] = set(names_of(made))
    assert wares & (found["europe"] | found["japan"])
    assert banners <= found["japan"]
    assert not banners & found["europe"]


def test_goods_stand_before_shops_that_sell_them(avenue):
    city = trading(avenue, 52.5, 13.4)
    made = street_pieces(city, density=3.0)
    rows, names = made.scene.instances[LAYER], names_of(made)
    shops = city.scene.instances["shopfronts"]
    foot = shops.position[:, :2]
    trade = shop_names(city, shops.object_id, shops.owner, foot)[1]
    seen = 0
    for word, name in GOODS.items():
        at = rows.position[names == name, :2]
        near = np.hypot(*(at[:, None] - foot).transpose(2, 0, 1)).argmin(axis=1)
        assert set(trade[near].tolist()) <= {word}
        seen += len(at)
    assert seen


def test_more_scooters_stand_where_it_is_warm():
    scooter = next(rule for rule in KERB_RULES if rule.piece == SCOOTERS[0])
    town = [rates(scooter, profile_named(place).furniture)[1] for place in ("it", "gb")]
    assert town[0] == pytest.approx(4 * town[1])


def test_nothing_stands_before_a_door(avenue, furnished):
    rows = furnished.scene.instances[LAYER]
    tub = names_of(furnished) == "planter"
    at, out = rows.position[tub][:1], front(rows.rotation[tub, 2])[:1]
    door = Instances(
        np.zeros(1, np.int32), np.array([7], np.uint64), np.zeros(1, np.uint64),
        at + np.column_stack([1.2 * out, [[0.0]]]),
        np.array([[0, 0, np.arctan2(-out[0, 0], out[0, 1])]], np.float32),
        np.ones((1, 3), np.float32), np.ones((1, 3), np.float32),
    )  # fmt: skip
    doors = avenue.scene.with_instances("doors", [furnished.scene.prototypes[0]], door)
    left = street_pieces(replace(avenue, scene=doors), density=2.0).scene.instances[LAYER].position
    assert np.hypot(*(left - at)[:, :2].T).min() > 0.3


def test_the_checks_find_a_bench_in_a_lane_and_one_that_blocks_a_walk(avenue):
    put = pieces("bench", np.array([[50.0, 2.0], [50.0, 7.4], [50.0, -40.0]]),
                 np.arange(1, 4, dtype=np.uint64), np.zeros(3))  # fmt: skip
    kiosk = pieces("kiosk", np.array([[70.0, 7.0]]), np.array([9], np.uint64), np.zeros(1))
    city = with_pieces(avenue, LAYER, join_pieces([put, kiosk]))
    outlines, xy, _ = placed_outlines(city.scene)
    assert in_lanes(city, outlines, xy).tolist() == [True, False, False, False]
    roads = avenue.layout.roads.assign(sidewalk_left=3.2, sidewalk_right=3.2)
    narrow = ground(replace(avenue, layout=replace(avenue.layout, roads=roads)))
    city = with_pieces(narrow, LAYER, join_pieces([put, kiosk]))
    outlines, xy, _ = placed_outlines(city.scene)
    rows, tight = crowding(city, outlines, xy)
    assert np.round(xy[rows[tight], 0]).tolist() == [70.0]


def test_the_room_before_a_point_ends_at_the_first_rim():
    rims = np.array([shapely.LineString([(3, -1), (3, 1)]), shapely.LineString([(5, -1), (5, 1)])])
    room = room_along(np.zeros((2, 2)), np.array([[1.0, 0.0], [0.0, 1.0]]), rims, 9.0)
    assert room.tolist() == [3.0, 9.0]


def test_things_at_the_walls_of_wide_walks_touch_them_and_leave_the_walk(avenue):
    found = street_pieces(avenue, density=3.0)
    rows, names = found.scene.instances[LAYER], names_of(found)
    houses = shapely.union_all(avenue.layout.buildings.geometry.to_numpy())
    gap = shapely.distance(houses, shapely.points(rows.position[:, :2]))
    at_wall = (gap < 0.46) & avenue.ground.on(rows.position[:, :2], "sidewalk")
    leaning = at_wall & (names == "bicycle")
    assert leaning.any()
    assert gap[leaning] == pytest.approx(WALL_GAP["bicycle"], abs=0.01)
    # The houses' walls run east and north, and so do the bicycles.
    assert np.abs(np.sin(2 * rows.rotation[leaning, 2])).max() < 1e-5
    assert {check.name: check.value for check in check_furniture(found)}[
        "furniture_on_walkway"
    ] == 0.0


def lamps_beside_houses(avenue, walk):
    """Lamps of the avenue with rows of houses that leave walks of so many metres."""
    near = 5.0 + walk
    rows = [shapely.box(x, y, x + 80, y + 5) for x in (-95, 15) for y in (near, -near - 5)]
    houses = avenue.layout.buildings.assign(geometry=rows)
    parts = make_table("parts", rows, id=np.arange(71, 75), building=houses["id"].to_numpy(),
                       base=np.zeros(4), walls=np.ones(4, bool))  # fmt: skip
    points = avenue.layout.points.iloc[:0]
    layout = replace(avenue.layout, buildings=houses, parts=parts, points=points)
    built = furniture(ground(replace(avenue, layout=layout)))
    position = built.scene.instances["street_furniture"].position
    before = (np.abs(position[:, 0]) > 16) & (np.abs(position[:, 0]) < 94)
    return built, np.abs(position[before & (np.abs(position[:, 1]) < 8), 1])


def test_lamps_on_narrow_walks_stand_at_the_wall_and_let_people_pass(avenue):
    built, across = lamps_beside_houses(avenue, 1.9)
    assert across == pytest.approx(np.full(len(across), 6.9 - 0.32), abs=0.02)
    assert len(across) >= 8
    assert {check.value for check in check_furniture(built)} == {0.0}


def test_walks_that_no_lamp_lets_anybody_pass_on_get_none(avenue):
    assert not len(lamps_beside_houses(avenue, 1.4)[1])


def corner_bollards(city):
    """Places of the bollards near the middle of the crossroads."""
    rows = city.scene.instances[LAYER]
    post = np.char.startswith(names_of(city).astype(str), "bollard")
    xy = rows.position[post, :2]
    return xy[(np.abs(xy) < 12.0).all(axis=1)]


def test_bollards_follow_the_kerb_of_corners_and_leave_the_walk(avenue, monkeypatch):
    # Between two lowered kerbs little would be left of the curves.
    monkeypatch.setattr("cityx.road.markings.zebras.MOUTH", np.inf)
    network = replace(avenue.network, crossing=np.zeros_like(avenue.network.crossing))
    whole = ground(replace(avenue, network=network, ground=None))
    guarded = '{"inherits": "jp", "furniture": {"corner_bollards": 1.0}}'
    tokyo = replace(whole, frame=Frame(35.69, 139.78, guarded))
    found = corner_bollards(street_pieces(tokyo))
    assert len(found) >= 4
    kerbs = shapely.union_all(walk_rims(whole.ground))
    gap = shapely.distance(shapely.points(found), kerbs)
    assert np.allclose(gap, KERB_WIDTH + FROM_CORNER, atol=0.05)
    apart = np.hypot(*(found[:, None] - found).T) + 99.0 * np.eye(len(found))
    assert apart.min() > 1.2


def test_tall_things_keep_farther_from_trunks_than_others(avenue):
    trunk = Prototype("tree", "tree", piece("bollard").mesh)
    spot = np.array([[40.0, 8.0, 0.0]])
    one = np.ones((1, 3), np.float32)
    trunks = Instances(np.zeros(1, np.int32), np.ones(1, np.uint64), np.zeros(1, np.uint64), spot,
                       0 * one, one, one)  # fmt: skip
    scene = avenue.scene.with_instances("trees", [trunk], trunks)
    site = _site(replace(avenue, scene=scene))
    names = ["telephone", "bench", "telephone"]
    given = pieces(np.array(names, object), spot[:, :2] + [[2.5, 0.0], [2.5, 0.0], [3.5, 0.0]],
                   np.arange(1, 4, dtype=np.uint64), np.zeros(3))  # fmt: skip
    alone = [_free(avenue, site, given.take(np.array([row])), np.full((1, 2), 0.5), given.id[:1])[0]
             for row in range(3)]  # fmt: skip
    assert alone == [False, True, True]
