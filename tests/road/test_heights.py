from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely

import cityx
from cityx.checks.height_checks import check_heights
from cityx.checks.street_checks import bare_places
from cityx.city.ground import LABEL
from cityx.city.layout import make_table
from cityx.city.mesh_measures import check_closed, volume
from cityx.city.terrain import Terrain, flat_terrain
from cityx.geometry.polylines import values_along
from cityx.ground.standing import surfaces_at
from cityx.road.ground.ground_surface import ground
from cityx.road.heights.way_heights import heights, way_heights
from cityx.road.network.network import network, road_network
from cityx.road.network.stations import DECK, OVER_CARS
from tests.town import Town

BRIDGE = {"bridge": True, "layer": 1}
TUNNEL = {"tunnel": True, "layer": -1}
UNDER = ([(0, -400), (0, 400)], {})
LONG = (-400, -400, 400, 400)


def crossed_streets(middle=BRIDGE, half=60):
    ends = [([(-390, 0), (-half, 0)], {}), ([(half, 0), (390, 0)], {})]
    return [([(-half, 0), (half, 0)], middle), *ends, UNDER]


def crossed(layout_of, middle=BRIDGE, half=60, **options):
    return layout_of(crossed_streets(middle | options, half), extent=LONG)


def solved(layout, terrain=None):
    terrain = terrain or flat_terrain()
    return way_heights(layout, road_network(layout), terrain)[:3]


def lift_at(net, x, y):
    lines = net.lines
    shapes = np.array([shapely.LineString(net.edge_points(i)) for i in range(net.edge_count)])
    spot = shapely.Point(x, y)
    near = np.flatnonzero(shapely.distance(shapes, spot) < 0.01)
    along = shapely.line_locate_point(shapes[near], spot)
    return values_along(lines, net.lift, near, along)


def built(city_of, layout, **options):
    return ground(heights(network(city_of(layout, **options))))


def test_without_bridges_nothing_moves(layout_of):
    layout = layout_of([([(-90, 0), (90, 0)], {}), ([(0, -90), (0, 90)], {})])
    net, off, terrain = solved(layout)
    assert off.count == 0
    assert not net.z.any()
    assert terrain.is_flat


def test_a_bridge_over_nothing_stays_on_the_ground(layout_of):
    _, off, _ = solved(layout_of([([(-90, 0), (90, 0)], BRIDGE)]))
    assert off.count == 0


@pytest.mark.parametrize("half", [10, 60, 200])
def test_a_bridge_clears_the_street_and_its_ramps_keep_the_grade(layout_of, half):
    net, off, _ = solved(crossed(layout_of, half=half))
    above, below = sorted(lift_at(net, 0, 0))[::-1]
    assert above >= OVER_CARS + DECK - 0.05
    assert below == 0.0
    for i in range(off.count):
        rows = slice(off.point_start[i], off.point_start[i + 1])
        run = np.hypot(*np.diff(off.points[rows], axis=0).T)
        assert (np.abs(np.diff(off.z[rows])) <= 0.121 * run + 1e-3).all()
    assert np.allclose(lift_at(net, 380, 0), 0.0)


def test_a_tunnel_sinks_under_the_street_and_the_street_stays(layout_of):
    net, off, _ = solved(crossed(layout_of, TUNNEL))
    above, below = sorted(lift_at(net, 0, 0))[::-1]
    assert above == 0.0
    assert below <= -(OVER_CARS + DECK) + 0.05
    assert off.lift.max() < 0.1


def test_a_tunnel_that_dives_under_a_street_at_its_mouth_does_not_come_up_again(layout_of):
    street = ([(-190, -400), (-190, 400)], {})
    tunnel = ([(-200, 0), (200, 0)], TUNNEL)
    net, _, _ = solved(layout_of([([(-390, 0), (-200, 0)], {}), tunnel, street], extent=LONG))
    deep = [float(lift_at(net, x, 0).min()) for x in range(-185, 150, 5)]
    assert deep[0] <= -(OVER_CARS + DECK) + 0.05
    # It eases from under the street up to the depth that a tunnel has, and stays there.
    assert (np.diff(deep) > -0.01).all()
    assert max(deep) < -OVER_CARS


def test_a_bridge_over_water_rises_a_little(layout_of):
    river = layout_of([([(-90, 0), (90, 0)], BRIDGE)], areas=[((-10, -90, 10, 90), "river")])
    net, _, _ = solved(river)
    assert 0.4 < lift_at(net, 0, 0)[0] < 1.5


def test_a_ramp_that_winds_over_itself_still_clears(layout_of):
    # A loop that passes over its own start, too short for the usual grade.
    loop = [(0, -40), (40, -40), (40, 0), (20, 0)]
    layout = layout_of(
        [([(0, 60), (0, -40)], {}), (loop, {}), ([(20, 0), (-20, 0)], BRIDGE),
         ([(-20, 0), (-90, 0)], {})]
    )  # fmt: skip
    net, _, _ = solved(layout)
    above, below = sorted(lift_at(net, 0, 0))[::-1]
    assert above - below >= OVER_CARS + DECK - 0.1


def test_a_footbridge_leaves_the_streets_on_the_ground(layout_of):
    path = {"kind": "footway", "width": 2.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    layout = layout_of(
        [UNDER, ([(-12, 0), (12, 0)], BRIDGE | path), ([(-12, 0), (-12, 300)], path),
         ([(12, 0), (12, 300)], path)], extent=LONG,
    )  # fmt: skip
    net, off, _ = solved(layout)
    assert not net.lift.any()
    assert off.lift.max() > OVER_CARS


def test_hill_streets_keep_their_grade_and_the_terrain_follows(layout_of):
    steep = 0.3 * np.arange(-450.0, 451.0, 10.0)[None, :] * np.ones((91, 1))
    hill = Terrain((-450.0, -450.0), 10.0, np.abs(steep))
    layout = layout_of([([(-390, 0), (390, 0)], {})], extent=LONG)
    net, _, terrain = solved(layout, hill)
    run = np.hypot(*np.diff(net.points, axis=0).T)
    assert (np.abs(np.diff(net.z)) <= 0.12 * run + 0.05).all()
    assert np.abs(terrain.height_at(net.points) - net.z).max() < 0.2
    across = terrain.height_at([[150.0, 3.0], [150.0, -3.0]])
    assert abs(across[0] - across[1]) < 0.05
    far = [[150.0, 300.0]]
    assert np.allclose(terrain.height_at(far), hill.height_at(far), atol=0.05)


def test_a_street_over_a_hill_follows_it_between_the_nodes_of_the_map(layout_of):
    crest = np.tile(20.0 - 20.0 * np.cos(np.arange(-450, 451, 10) / 143.0), (91, 1))
    hill = Terrain((-450.0, -450.0), 10.0, crest)
    net, _, terrain = solved(layout_of([([(-390, 0), (390, 0)], {})], extent=LONG), hill)
    x = np.linspace(-380, 380, 77)
    z = values_along(net.lines, net.z, np.zeros(77, int), x + 390)
    assert np.abs(z - terrain.height_at(np.column_stack([x, 0 * x]))).max() < 0.1


def test_a_tram_between_carriageways_lies_at_their_height(layout_of):
    hill = Terrain((-450.0, -450.0), 10.0, np.tile(np.arange(91.0) * 0.6, (91, 1)))
    side = {"oneway": True, "lanes": 1, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    streets = [([(-390, y), (390, y)], side) for y in (-3.5, 3.5)]
    tram = ([(-390, 0), (390, 0)], {"kind": "tram", "width": 2.6})
    _, _, terrain = solved(layout_of([*streets, tram], extent=LONG), hill)
    x = np.linspace(-300, 300, 61)
    middle, beside = (terrain.height_at(np.column_stack([x, y + 0 * x])) for y in (0.0, 3.5))
    assert np.abs(middle - beside).max() < 0.25


def test_a_street_that_ends_on_another_without_a_node_meets_its_height(layout_of):
    hill = Terrain((-200.0, -200.0), 10.0, np.tile(np.arange(41.0)[:, None] * 3.0, (1, 41)))
    uphill = [(0, 1.0), *[(0, y) for y in range(5, 95, 5)]]
    layout = layout_of([([(-90, 0), (90, 0)], {}), (uphill, {})])
    net = solved(layout, hill)[0]
    climbs = int(np.searchsorted(net.point_start, net.points[:, 1].argmax(), side="right")) - 1
    rows = slice(*net.point_start[climbs : climbs + 2].tolist())
    z, y = net.z[rows], net.points[rows, 1]
    assert y.max() == 90
    assert (np.abs(np.diff(z)) / np.abs(np.diff(y))).max() < 0.14


def test_a_street_drawn_on_the_ramp_of_a_bridge_rises_with_it(layout_of):
    beside = ([(-200, 3), (-26, 3), (-22, 60)], {"kind": "service"})
    net = solved(layout_of([*crossed_streets(half=20), beside], extent=LONG))[0]
    for x in (-150, -45, -30):
        assert lift_at(net, x, 3) == pytest.approx(lift_at(net, x, 0), abs=0.5)
    assert lift_at(net, -30, 3).max() > 1.5


@pytest.mark.parametrize("middle", [BRIDGE, TUNNEL])
def test_structures_are_closed_and_leave_the_streets_free(layout_of, city_of, middle):
    city = built(city_of, crossed(layout_of, middle), lod=2)
    bodies = city.scene.meshes["structures"]
    assert check_closed(bodies).all()
    assert (volume(bodies) > 0).all()
    assert len(np.unique(bodies.object_id)) == bodies.count
    checks = {check.name: check for check in check_heights(city)}
    assert {"grades_exceeded", "streets_blocked", "clearance_short"} <= set(checks)
    assert all(check.ok for check in checks.values())


@pytest.mark.parametrize(("grade", "found"), [(0.12, False), (0.13, True)])
def test_a_grade_is_measured_over_ten_metres_whatever_the_bumps(layout_of, city_of, grade, found):
    line = [(x, 0) for x in range(-100, 101, 5)]
    city = network(city_of(layout_of([(line, {})]), lod=2))
    net = city.network
    bumps = 0.05 * (np.arange(len(net.points)) % 2)
    hilly = replace(net, z=grade * net.points[:, 0] + bumps)
    checks = {check.name: check for check in check_heights(replace(city, network=hilly))}
    assert checks["grades_exceeded"].ok is not found


def test_a_wall_in_a_street_is_found(layout_of, city_of):
    city = built(city_of, crossed(layout_of), lod=2)
    bodies = city.scene.meshes["structures"]
    bodies.vertices[:, 2] -= 3.0
    checks = {check.name: check for check in check_heights(city)}
    assert not checks["streets_blocked"].ok or not checks["clearance_short"].ok


def test_the_ground_is_open_where_a_ramp_stands_and_closed_under_the_deck(layout_of, city_of):
    city = built(city_of, crossed(layout_of, half=20), lod=2)
    corners = shapely.polygons(city.ground.vertices[city.ground.triangles])
    label = city.ground.face_label[city.ground.triangle_face]
    foot = label[shapely.contains(corners, shapely.Point(-45.5, 0.4))]
    under = label[shapely.contains(corners, shapely.Point(0.5, 0.4))]
    assert foot.tolist() == [LABEL["void"]]
    assert LABEL["void"] not in under.tolist()
    assert "decks" in city.scene.meshes


def test_a_ramp_opens_a_marsh_as_it_opens_any_land(layout_of, city_of):
    layout = crossed(layout_of, half=20)
    marsh = make_table("areas", [shapely.box(-390, -40, -22, 40)], id=[9], kind=["wetland"])
    ground = built(city_of, replace(layout, areas=marsh), lod=2).ground
    ramp = np.column_stack([np.arange(-55.0, -30.0, 5.0), np.full(5, 0.4)])
    assert ground.on(ramp, "void").all()


def test_a_median_over_a_street_leaves_the_bridges_beside_it_whole(layout_of, city_of):
    options = {"oneway": True, "lanes": 1, "lanes_forward": 1, "name": "A", "width": 3.25}
    streets = []
    for y, there in ((8, 1), (-8, -1)):
        line = [(-390, y), (-40, y), (40, y), (390, y)][::there]
        kinds = ({}, BRIDGE, {})
        streets += [(list(piece), options | kind)
                    for piece, kind in zip(pairwise(line), kinds, strict=True)]  # fmt: skip
    city = built(city_of, layout_of([*streets, UNDER], extent=LONG), lod=2)
    assert not len(bare_places(city))


def test_a_tunnel_without_a_mouth_carries_its_traffic_and_a_subway_ends_unseen(layout_of, city_of):
    rails = {"kind": "subway", "width": 3.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    streets = [([(-90, 30), (90, 30)], {}), ([(-90, 0), (90, 0)], TUNNEL),
               ([(-90, -30), (90, -30)], rails | TUNNEL)]  # fmt: skip
    city = built(city_of, layout_of(streets), lod=2)
    deck = city.scene.meshes["decks"].vertices
    assert deck[:, 2].max() < -4.0
    assert deck[:, 1].min() > -15.0
    assert not len(bare_places(city))


def test_a_carriageway_keeps_its_height_beside_a_cutting(layout_of, city_of):
    bare = {"sidewalk_left": 0.0, "sidewalk_right": 0.0}
    wide, link = bare | {"width": 9.75}, bare | {"kind": "motorway_link", "width": 4.0}
    along = pairwise([(-390, 0), (-60, 0), (0, 0), (390, 0)])
    streets = [*((list(piece), wide) for piece in along),
               ([(0, -390), (0, 0)], {}), ([(0, 0), (0, 390)], {}),
               ([(-60, 0), (-35, 8.1), (-20, 8.1)], link), ([(-20, 8.1), (20, 8.1)], link | TUNNEL),
               ([(20, 8.1), (390, 40)], link)]  # fmt: skip
    city = built(city_of, layout_of(streets, extent=LONG), lod=2)
    assert not len(bare_places(city))


def test_a_street_at_the_rim_of_a_cutting_keeps_its_ground(layout_of, city_of):
    bare = {"sidewalk_left": 0.0, "sidewalk_right": 0.0, "width": 3.0}
    walks = {"sidewalk_left": 3.0, "sidewalk_right": 3.0}
    streets = [(street, options | walks) for street, options in crossed_streets(TUNNEL, 20)]
    city = built(city_of, layout_of([*streets, ([(30, -6), (200, -6)], bare)], extent=LONG), lod=2)
    assert city.network.lift.min() < -4.0
    assert not len(bare_places(city))


def subway(layout_of):
    path = {"kind": "footway", "width": 2.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    ways = [([(-90, 0), (90, 0)], {}), ([(0, -24), (0, 24)], path | TUNNEL)]
    for side in (-1, 1):
        ways.append(([(0, side * 30), (0, side * 24)], path | TUNNEL | {"kind": "steps"}))
        ways.append(([(0, side * 30), (0, side * 60)], path))
    return layout_of(ways)


def test_detail_level_0_has_neither_paths_nor_subways(layout_of, city_of):
    city = built(city_of, subway(layout_of), lod=0)
    assert LABEL["void"] not in city.ground.face_label
    assert "decks" not in city.scene.meshes


def test_a_subway_opens_the_ground_at_its_stairs_alone(layout_of, city_of):
    city = built(city_of, subway(layout_of), lod=2)
    void = shapely.union_all(shapely.polygons(
        city.ground.vertices[city.ground.triangles[
            city.ground.face_label[city.ground.triangle_face] == LABEL["void"]
        ]]
    ))  # fmt: skip
    assert shapely.contains(void, shapely.points([[0, -28], [0, 28]])).all()
    assert shapely.distance(void, shapely.box(-90, -10, 90, 10)) > 5.0
    assert city.scene.meshes["decks"].vertices[:, 2].min() < -3.0


def test_heights_do_not_depend_on_the_order_of_ways(layout_of):
    layout = crossed(layout_of)
    net, _, _ = solved(layout)
    flipped = layout_of(
        [UNDER, ([(60, 0), (390, 0)], {}), ([(-390, 0), (-60, 0)], {}),
         ([(-60, 0), (60, 0)], BRIDGE)], extent=LONG,
    )  # fmt: skip
    other, _, _ = solved(flipped)
    assert np.allclose(np.sort(net.z), np.sort(other.z))


def steepest(off):
    owner = np.repeat(np.arange(off.count), np.diff(off.point_start))
    first = np.flatnonzero(owner[1:] == owner[:-1])
    run = np.hypot(*(off.points[first + 1] - off.points[first]).T)
    return (np.abs(off.z[first + 1] - off.z[first]) / run).max()


def test_a_ramp_goes_on_past_a_short_piece_between_it_and_the_bridge(layout_of):
    # The side of the bridge reaches over the way that goes on from it: that is not under it.
    over, on = [(-60, 0), (12, 0)], [(14, 2), (390, 60)]
    streets = [(over, BRIDGE), ([(-390, 0), (-60, 0)], {}), ([(12, 0), (14, 2)], {}), (on, {}),
               ([(14, 2), (14, -90)], {})]  # fmt: skip
    streets = [(line, options | {"width": 14.0}) for line, options in streets]
    _, off, _ = solved(layout_of([*streets, UNDER], extent=LONG))
    assert steepest(off) < 0.15


def test_a_bridge_drawn_too_short_still_passes_over(layout_of):
    streets = [
        ([(-390, 0), (-40, 0)], {}),
        ([(-40, 0), (-8, 0)], BRIDGE),
        ([(-8, 0), (390, 0)], {}),
    ]
    net, _, _ = solved(layout_of([*streets, UNDER], extent=LONG))
    below, above = sorted(lift_at(net, 0, 0))
    assert below == 0.0
    assert above >= OVER_CARS + DECK - 0.15


def test_a_path_sinks_where_the_bridge_over_it_has_no_room_to_rise(layout_of):
    path = {"kind": "footway", "width": 2.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    # Its street passes under other bridges on both sides.
    streets = [([(-9, 0), (9, 0)], BRIDGE), ([(-390, 0), (-9, 0)], {}), ([(9, 0), (390, 0)], {})]
    streets += [([(x, -300), (x, 300)], BRIDGE) for x in (-11, 11)]
    layout = layout_of([*streets, ([(0, -300), (0, 300)], path)], extent=LONG)
    net, off, _ = solved(layout)
    assert off.lift.min() < -0.2
    assert lift_at(net, 0, 0)[0] - off.lift.min() >= 2.7 + DECK - 0.05
    assert steepest(off.take(np.flatnonzero(off.edge >= 0))) <= 2.5 * 0.12 + 1e-3


def contradictory(layout_of, streets):
    layout = layout_of(streets, extent=LONG)
    return way_heights(layout, road_network(layout), flat_terrain())[3], layout


def test_ways_without_room_to_pass_meet_at_one_height_and_are_named(layout_of, city_of):
    # The bridge and the street below it end in one node, eight metres past the crossing.
    streets = [([(-60, 0), (8, 0)], BRIDGE), ([(-390, 0), (-60, 0)], {}), ([(8, 0), (390, 0)], {}),
               ([(0, -60), (0, 4), (8, 0)], {})]  # fmt: skip
    notes, layout = contradictory(layout_of, streets)
    assert len(notes) == 1
    assert "1 pairs of ways without room" in notes[0]
    assert f"{1:016x} x {4:016x}" in notes[0]
    city = built(city_of, layout, lod=2)
    assert city.notes == notes
    assert np.ptp(lift_at(city.network, 0, 0)) < 0.01
    assert all(check.ok for check in check_heights(city))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"bridge": True, "layer": -1}, "1 bridges with a layer below the ground pass over it"),
        ({"tunnel": True, "layer": 1}, "1 tunnels with a layer above the ground run below it"),
        ({}, "1 pairs of streets of one level that cross without a node are one surface"),
    ],
)
def test_contradictory_layers_are_built_and_named(layout_of, city_of, options, text):
    over = [(-60, 0), (60, 0)]
    ends = [([(-390, 0), (-60, 0)], {}), ([(60, 0), (390, 0)], {})]
    notes, layout = contradictory(layout_of, [(over, options), *ends, UNDER])
    assert [note.split(": ")[1] for note in notes] == [text]
    assert f"{4 if not options else 1:016x}" in notes[0]
    assert all(check.ok for check in check_heights(built(city_of, layout, lod=2)))


def test_a_bridge_under_a_way_that_is_none_is_named(layout_of):
    ends = [([(-390, 0), (-60, 0)], {}), ([(60, 0), (390, 0)], {})]
    high = ([(-60, 0), (60, 0)], {"layer": 2})
    notes, _ = contradictory(layout_of, [high, *ends, (UNDER[0], BRIDGE)])
    assert notes == (f"map: 1 ways that are no bridges pass over bridges, as their layers say: "
                     f"{1:016x} x {4:016x}",)  # fmt: skip


PATH = {"kind": "footway", "width": 2.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}


@pytest.mark.parametrize(
    ("path", "named"), [([(0, -90), (0, 90)], 1), ([(0, -90), (0, 0), (0, 90)], 0)]
)
def test_a_path_that_crosses_a_street_without_a_node_is_named(layout_of, path, named):
    notes, _ = contradictory(layout_of, [([(-90, 0), (0, 0), (90, 0)], {}), (path, PATH)])
    text = "map: 1 paths and tracks cross streets of their level without a node and lie level there"
    assert notes == (f"{text}: {1:016x} x {2:016x}",) * named


def test_a_footbridge_of_the_layer_of_the_bridge_below_is_named(layout_of):
    notes, _ = contradictory(
        layout_of, [*crossed_streets(), ([(21.3, -90), (21.3, 90)], PATH | BRIDGE)]
    )
    assert notes == ("map: 1 pairs of ways have one layer and cross; the path passes farther from "
                     f"the ground: {5:016x} x {1:016x}",)  # fmt: skip


def test_a_bridge_drawn_too_short_is_named(layout_of):
    streets = [
        ([(-390, 0), (-40, 0)], {}),
        ([(-40, 0), (-8, 0)], BRIDGE),
        ([(-8, 0), (390, 0)], {}),
    ]
    notes, _ = contradictory(layout_of, [*streets, UNDER])
    assert notes == ("map: 1 ways pass over others past the end of their bridge or tunnel: "
                     f"{3:016x} x {4:016x}",)  # fmt: skip


def test_a_roundabout_on_a_bridge_is_open_over_the_street_below(layout_of, city_of):
    turn = np.arange(25) * np.pi / 12
    ring = np.column_stack([30 * np.cos(turn), 30 * np.sin(turn)]).round(3)
    ring[-1] = ring[0]
    ring = [tuple(point) for point in ring.tolist()]
    options = BRIDGE | {"roundabout": True, "oneway": True}
    streets = [(ring, options), (([(30, 0), (390, 0)]), {}), ([(-30, 0), (-390, 0)], {}), UNDER]
    city = built(city_of, layout_of(streets, extent=LONG), lod=2)
    bodies = city.scene.meshes["structures"]
    over = shapely.polygons(bodies.vertices[bodies.triangles()[0]][:, :, :2])
    assert not shapely.intersects(over, shapely.Point(0.3, 0.2).buffer(15.0)).any()
    checks = {check.name: check for check in check_heights(city)}
    assert checks["clearance_short"].ok
    assert checks["streets_blocked"].ok


def rays(city):
    """Return the least free height over carriageways by rays of our own, and the count of rays."""
    net, mesh = city.network, city.scene.meshes["structures"]
    spots, z = [], []
    for row in range(net.edge_count):
        line = shapely.LineString(net.edge_points(row))
        along = np.arange(1.3, line.length, 3.1)
        spots.append(shapely.get_coordinates(shapely.line_interpolate_point(line, along)))
        z.append(values_along(net.lines, net.z, np.full(len(along), row), along))
    spots, z = np.concatenate(spots), np.concatenate(z)
    spot, height = surfaces_at(mesh, spots + np.array([3.1e-4, 1.7e-4]))
    above = height - z[spot]
    return float(above[above > 0.8].min(initial=99.0)), len(spots)


@pytest.mark.parametrize("angle", [35, 60, 90, 130])
@pytest.mark.parametrize("levels", [(-1, -2), (-1, -2, -3), (1, 2, -1), (2, 1), (-3, 2)])
def test_stacked_levels_that_cross_at_odd_angles_clear_each_other(
    layout_of, city_of, levels, angle
):
    streets = [([(-390, 0), (390, 0)], {})]
    for number, level in enumerate(levels):
        turn = np.radians(angle + 23 * number)
        ahead = np.array([np.cos(turn), np.sin(turn)])
        tags = {"layer": level, "bridge": level > 0, "tunnel": level < 0}
        at = [tuple(np.round(ahead * far, 3)) for far in (-390, -200, 200, 390)]
        streets += [(at[:2], {}), (at[1:3], tags), (at[2:], {})]
    city = built(city_of, layout_of(streets, extent=LONG))
    least, count = rays(city)
    assert count > 500
    assert least > 4.45
    assert len(bare_places(city)) == 0


def test_a_tunnel_that_a_house_stands_over_near_its_mouth_is_roofed_and_carries_cars(
    layout_of, city_of
):
    layout = layout_of(crossed_streets(TUNNEL), houses=[(-45, -8, -30, 9)], extent=LONG)
    city = built(city_of, layout)
    assert len(bare_places(city)) == 0
    assert rays(city)[0] > 4.45


@pytest.mark.parametrize("first", [-1, -2])
def test_tunnels_of_one_layer_that_cross_without_a_node_are_one_surface(layout_of, first):
    tags = {"tunnel": True, "layer": first}
    streets = [([(-390, 0), (-150, 0)], {}), ([(-150, 0), (150, 0)], tags),
               ([(150, 0), (390, 0)], {}), ([(0, -390), (0, -80)], {}),
               ([(0, -80), (0, 200)], tags), ([(0, 200), (0, 390)], {})]  # fmt: skip
    net, _, _ = solved(layout_of(streets, extent=LONG))
    assert np.ptp(lift_at(net, 0, 0)) < 0.01


@pytest.mark.parametrize(
    "tags",
    [{"railway": "rail", "tunnel": "yes", "layer": "-2"},
     {"railway": "rail", "bridge": "yes", "layer": "1"},
     {"railway": "subway", "tunnel": "yes", "layer": "-1"}],
)  # fmt: skip
def test_a_map_of_one_railway_off_the_ground_is_built(tmp_path, tags):
    town = Town()
    town.way([town.node(60.0 * k, 20.0 * k) for k in range(5)], **tags)
    city = cityx.build(town.write(tmp_path / "rail.osm"), lod=0).city
    assert not [failure for failure in city.failures if "failed" in failure.error]
