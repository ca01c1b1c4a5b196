"""Streets without a surface, junctions nobody can drive over, things off the ground."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

import cityx
from cityx.assets.trees import tree
from cityx.checks.building_checks import check_buildings
from cityx.checks.furniture_checks import check_standing, ground_gaps
from cityx.checks.street_checks import bare_places, check_lanes, check_streets
from cityx.city import City, Frame, Instances, Layout, make_table, one_mesh
from cityx.city.ground import KERB_HEIGHT, LABEL, ON_ROADWAY
from cityx.city.routes import stranded
from cityx.ids import id_text
from cityx.road.ground.ground_surface import ground
from cityx.road.heights.way_heights import heights
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network

ARMS = [[(-90, 0), (0, 0), (90, 0)], [(0, -90), (0, 0), (0, 90)]]


@pytest.fixture(scope="module")
def cross():
    roads = make_table(
        "roads", [shapely.LineString(arm) for arm in ARMS], id=[1, 2], kind=["residential"] * 2,
        lanes=[2] * 2, lanes_forward=[1] * 2, lane_width=[3.0] * 2, width=[6.0] * 2,
        sidewalk_left=[2.0] * 2, sidewalk_right=[2.0] * 2,
    )  # fmt: skip
    layout = Layout((-80.0, -80.0, 80.0, 80.0), roads=roads)
    return ground(lanes(network(City("cross", Frame(52.0, 13.0), layout, lod=2))))


def stranded_share(city):
    return {check.name: check.value for check in check_lanes(city)}["lanes_stranded"]


def failing(checks):
    return {check.name: check.ids for check in checks if not check.ok}


def test_a_plain_crossroads_passes(cross):
    assert {check.name for check in check_streets(cross)} == {
        "streets_without_surface", "junctions_closed", "junctions_covered",
    }  # fmt: skip
    assert failing(check_streets(cross)) == {}


def test_a_street_off_its_surface_is_named_by_its_places(cross):
    net = cross.network
    raised = replace(net, z=net.z + np.where(net.points[:, 0] > 60.0, 1.0, 0.0))
    found = failing(check_streets(replace(cross, network=raised)))
    assert set(found) == {"streets_without_surface"}
    deck = one_mesh(5, [(0, -9, 1), (80, -9, 1), (80, 9, 1), (0, 9, 1)], [[0, 1, 2, 3]])
    places = np.array([(70.0, 0.0, 1.0), (70.0, 0.0, 0.0), (70.0, 0.0, 2.0)])
    carried = replace(cross, scene=cross.scene.with_mesh("decks", deck))
    assert ground_gaps(carried, places) == pytest.approx([0.0, 0.0, 1.0])


def test_what_stands_in_a_house_stands_on_its_floor_not_on_that_of_a_tunnel_below(cross):
    house = make_table(
        "parts", [shapely.box(20, 20, 50, 50)], building=[7], walls=[True], base=[0.0]
    )
    city = ground(replace(cross, layout=replace(cross.layout, parts=house)))
    tunnel = SimpleNamespace(z_at=lambda xy: np.full(len(xy), -0.5))
    places = np.array([(35.0, 35.0, KERB_HEIGHT), (35.0, 35.0, 1.0), (35.0, 35.0, -0.5)])
    assert np.isnan(ground_gaps(replace(city, heights=None), places)).all()
    found = ground_gaps(replace(city, heights=tunnel), places)
    assert found == pytest.approx([0.0, 1.0 - KERB_HEIGHT, 0.0])


@pytest.mark.parametrize(
    ("kind", "tags"),
    [("footway", {"bridge": [False, True], "layer": [0, 2]}),
     ("footway", {"tunnel": [False, True], "layer": [0, -1]}),
     ("subway", {"tunnel": [False, True], "layer": [0, -2]})],
)  # fmt: skip
def test_what_passes_over_or_below_a_street_in_a_house_is_no_surface_that_it_misses(kind, tags):
    lines = [shapely.LineString(arm) for arm in ([(-90, 0), (90, 0)], [(1, -90), (1, 90)])]
    roads = make_table("roads", lines, id=[1, 2], kind=["service", kind], width=[3.0, 3.0], **tags)
    house = shapely.box(-60, -15, 60, 15)
    houses = make_table("buildings", [house], id=[7], use=["retail"], levels=[2], height=[7.0])
    parts = make_table("parts", [house], id=[8], building=[7], base=[0.0], top=[7.0], walls=[True])
    extent = (-80.0, -80.0, 80.0, 80.0)
    layout = Layout(extent, roads=roads, buildings=houses, parts=parts)
    city = ground(heights(network(City("house", Frame(52.0, 13.0), layout, lod=0))))
    assert city.ground.on([(0.0, 0.0)], "building").all()
    assert not len(bare_places(city))


@pytest.mark.parametrize(
    ("kind", "lod", "few"), [("track", 0, 0), ("track", 1, 0), ("service", 0, 0)]
)
def test_tracks_through_a_stream_miss_no_surface_where_none_is_laid(kind, lod, few):
    lines = [shapely.LineString(arm) for arm in ([(-90, 0), (90, 0)], [(0, -90), (0, 0)])]
    roads = make_table("roads", lines, id=[1, 2], kind=["residential", kind], width=[6.0, 3.0])
    stream = shapely.box(-80, -44, 80, -38)
    layout = Layout((-80.0, -80.0, 80.0, 80.0), roads=roads,
                    areas=make_table("areas", [stream], id=[3], kind=["river"]))  # fmt: skip
    city = ground(heights(network(City("ford", Frame(52.0, 13.0), layout, lod=lod))))
    assert len(bare_places(city)) == few


def test_a_junction_that_no_lane_leads_over_is_named(cross):
    graph = cross.lanes
    shut = replace(
        graph, connection=graph.connection[:0], movement=graph.movement[:0],
        curve_start=graph.curve_start[:1], curve=graph.curve[:0],
    )  # fmt: skip
    found = failing(check_streets(replace(cross, lanes=shut)))
    assert found == {"junctions_closed": ("(0.0, 0.0)",)}


def test_lanes_that_the_map_itself_strands_are_not_counted(cross):
    # A one-way street leaves the inner end of a street: nothing leads back into that.
    arms = [[(-70, 0), (0, 0)], [(0, 0), (0, 60)]]
    roads = make_table(
        "roads", [shapely.LineString(arm) for arm in arms], id=[1, 2], kind=["residential"] * 2,
        lanes=[2, 1], lanes_forward=[1, 1], oneway=[False, True], lane_width=[3.0] * 2,
        width=[6.0, 3.0],
    )  # fmt: skip
    layout = Layout((-80.0, -80.0, 80.0, 80.0), roads=roads)
    city = ground(lanes(network(City("arms", Frame(52.0, 13.0), layout, lod=1))))
    graph = city.lanes
    assert graph.count == 3
    exits = np.flatnonzero((graph.edge == 1) | (graph.direction > 0))
    assert len(stranded(graph, np.zeros(0, np.int64), exits))
    assert stranded_share(city) == 0.0
    assert stranded_share(cross) == 0.0


@pytest.mark.parametrize("end", [0, 1])
def test_lanes_that_lost_their_turns_are_counted(cross, end):
    within = [shapely.LineString(arm).intersection(shapely.box(-60, -60, 60, 60)) for arm in ARMS]
    roads = cross.layout.roads.set_geometry(within)
    city = lanes(network(replace(cross, layout=replace(cross.layout, roads=roads), network=None)))
    graph = city.lanes
    own = graph.edge[graph.connection] == 0  # of its turns those at its dead end alone are kept
    kept = np.flatnonzero(~own[:, end] | own.all(axis=1))
    curves = [graph.curve[a:b] for a, b in pairwise(graph.curve_start.tolist())]
    curve = [curves[row] for row in kept.tolist()]
    cut = replace(
        graph, connection=graph.connection[kept], movement=graph.movement[kept],
        curve_start=np.cumsum([0, *map(len, curve)]), curve=np.concatenate(curve),
    )  # fmt: skip
    assert stranded_share(city) == 0.0
    assert stranded_share(replace(city, lanes=cut)) == pytest.approx(1 / 8)


def test_a_junction_paved_as_a_walk_is_named(cross):
    paved = relabelled(cross, "junction", "sidewalk")
    assert failing(check_streets(paved)) == {"junctions_covered": ("(0.0, 0.0)",)}


def relabelled(city, name, other):
    surface = city.ground
    mine = surface.labelled(name, *ON_ROADWAY)
    label = np.where(mine, LABEL[other], surface.face_label).astype(np.uint8)
    return replace(city, ground=replace(surface, face_label=label))


@pytest.mark.parametrize("other", ["void", "building"])
def test_a_junction_on_a_ramp_or_in_a_building_is_left_to_other_checks(cross, other):
    assert failing(check_streets(relabelled(cross, "junction", other))) == {}


def test_what_stands_on_a_slope_of_earth_stands_on_the_ground(cross):
    heap = one_mesh(5, [(10, 10, 1), (30, 10, 1), (30, 30, 1), (10, 30, 1)], [[0, 1, 2, 3]])
    for material, named in (("grass", {}), ("concrete", {"things_off_ground": (id_text(8),)})):
        scene = cross.scene.with_mesh("structures", replace(heap, materials=(material,)))
        assert failing(check_standing(with_tree(replace(cross, scene=scene), 1.0))) == named


def with_tree(city, z):
    one = np.ones((1, 3), np.float32)
    rows = Instances(np.zeros(1, np.int32), np.array([8], np.uint64), np.zeros(1, np.uint64),
                     np.array([[20.0, 20.0, z]]), 0 * one, one, one)  # fmt: skip
    return replace(city, scene=city.scene.with_instances("trees", [tree("lime", 0, "light")], rows))


@pytest.mark.parametrize(("z", "ok"), [(0.12, True), (0.0, True), (1.12, False), (-0.88, False)])
def test_a_tree_stands_neither_over_nor_under_the_ground(cross, z, ok):
    assert KERB_HEIGHT == 0.12
    found = failing(check_standing(with_tree(cross, z)))
    assert found == ({} if ok else {"things_off_ground": (id_text(8),)})


def test_where_nothing_stands_there_is_no_such_check(cross):
    assert check_standing(cross) == []


@pytest.mark.parametrize(("x", "named"), [(40.0, True), (4.0, False)])
def test_a_house_in_a_street_is_named_one_at_its_kerb_is_not(cross, x, named):
    house = shapely.box(x, -4.0, x + 10.0, 4.0) if named else shapely.box(20.0, 3.0, 30.0, 12.0)
    houses = make_table("buildings", [house], id=[6])
    parts = make_table("parts", [house], id=[1], building=[6], base=[0.0], top=[6.0], walls=[True])
    built = replace(cross, layout=replace(cross.layout, buildings=houses, parts=parts))
    found = {check.name: check for check in check_buildings(built)}["building_in_street"]
    assert found.ids == ((id_text(6),) if named else ())
    assert found.ok is not named


@pytest.mark.parametrize(
    ("street", "arriving"),
    [
        ({"highway": "service", "lanes": "4"}, {"highway": "living_street", "oneway": "-1"}),
        ({"highway": "residential", "lanes": "6"}, {"highway": "residential", "oneway": "-1"}),
        ({"highway": "tertiary", "lanes": "5", "lanes:forward": "3", "lanes:backward": "2"},
         {"highway": "service", "oneway": "-1"}),
    ],
)  # fmt: skip
def test_where_the_map_lets_nobody_on_lanes_need_no_exit(street, arriving, tmp_path):
    nodes = {1: (0, 0), 2: (80, 40), 3: (160, 120)}
    lines = [f'<node id="{n}" version="1" lat="{47 + y / 111200}" lon="{8 + x / 75900}"/>'
             for n, (x, y) in nodes.items()]  # fmt: skip
    for number, (ends, tags) in enumerate((((1, 2), street), ((2, 3), arriving)), 1):
        told = "".join(f'<tag k="{key}" v="{value}"/>' for key, value in tags.items())
        refs = "".join(f'<nd ref="{end}"/>' for end in ends)
        lines.append(f'<way id="{number}" version="1">{refs}{told}</way>')
    path = tmp_path / "street.osm"
    path.write_text(f'<osm version="0.6">{"".join(lines)}</osm>')
    checks = cityx.build(path, lod=0).report["checks"]
    assert checks["lanes_without_exit"]["value"] == 0.0
