"""Every form holds of the made city, and no more when what it speaks of is changed."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from made import (
    BUS,
    HOUSES,
    NEON,
    PERSON,
    SHRUB,
    TREE,
    edited,
    houses,
    made_city,
    moved,
    row_of,
    shell,
    with_air,
    with_layout,
    with_shells,
    with_things,
    without,
)

from cityx.checks.predicates import Reply, clean, measure, measure_all
from cityx.city import Ground, RoadNetwork
from cityx.city.ground import LABEL


@pytest.fixture(scope="module")
def city():
    return made_city()


def shells_with(**changes):
    """All shells, some of them otherwise: b04={"wall": "brick"}."""
    return [
        shell(k, row, **changes.get(f"b{k + 1:02d}", {})) for k, row in enumerate(HOUSES)
    ]  # fmt: skip


def no(table, *sources):
    return lambda c: without(c, table, [row_of(c, table, source) for source in sources])


def air(**values):
    return lambda c: with_air(c, **values)


def shells(**changes):
    return lambda c: with_shells(c, shells_with(**changes))


def shift(table, source, x, y):
    return lambda c: moved(c, table, source, x, y)


def edit(table, column, source, value):
    return lambda c: edited(c, table, column, row_of(c, table, source), value)


def things(layer, prototype, *places, owner=0):
    return lambda c: with_things(c, layer, prototype, places, owner=owner)


def wider(c):
    xmin, ymin, xmax, ymax = c.layout.extent
    return replace(c, layout=replace(c.layout, extent=(xmin, ymin, xmax + 100, ymax + 100)))


def turned(c):
    roads = c.layout.roads
    spun = shapely.transform(roads.geometry.to_numpy(), lambda p: p[:, ::-1])
    return with_layout(c, roads=roads.set_geometry(spun))


# A predicate that holds of the made city, and a change after which it does not.
CASES = [
    ("n(building) == 7", no("buildings", "made/b01")),
    ("n(building, id=b02) == 1", no("buildings", "made/b02")),
    ("n(building, height in [80, 150]) == 2", shells(b04={"top": 70.0})),
    ("n(building, type=tower) == 3", shells(b04={"top": 30.0})),
    ("n(tower) == 3", shells(b04={"top": 30.0})),
    ("n(house) == 3", shells(b01={"top": 40.0})),
    ("n(warehouse) == 1", edit("buildings", "levels", "made/b07", 9)),
    ("n(building, tag=office) == 3", edit("buildings", "use", "made/b04", "hotel")),
    ("n(building, floors=2) == 2", edit("buildings", "levels", "made/b02", 5)),
    ("n(building, on=garden) == 0", shift("areas", "made/a06", 0.0, -18.0)),
    ("share(building, material=glass) >= 0.4", shells(b04={"wall": "brick"})),
    ("share(building, material=brick, floors=2) in [0.1, 0.2]", shells(b02={"wall": "plaster"})),
    ("share(building, roof=bitumen) == 1", lambda c: with_shells(c, [
        replace(each, materials=("plaster", "slate")) for each in shells_with()])),
    ("share(building, style=modern) >= 0.4", edit("buildings", "generator", "made/b04", "palazzo")),
    ("share(building, tag=office, by=area) >= 0.35", edit("buildings", "use", "made/b04", "hotel")),
    ("share(road, class=local, lanes=2) == 1", edit("roads", "lanes", "made/r02", 4)),
    ("share(top(building, height, 3), material=glass) == 1", shells(b04={"wall": "concrete"})),
    ("cover(building) >= 0.02", no("buildings", "made/b07")),
    ("cover(green) >= 0.05", no("areas", "made/a03")),
    ("stat(building, height, min) >= 6", shells(b03={"top": 4.0})),
    ("stat(building, height, max) in [119, 121]", shells(b05={"top": 140.0})),
    ("stat(building, floors, p50) <= 3", edit("buildings", "levels", "made/b01", 20)),
    ("stat(building, height, mean) ~ 43", shells(b05={"top": 300.0})),
    ("stat(road, width, p50) <= 7", edit("roads", "width", "made/r02", 40.0)),
    ("stat(river, width, mean) in [27, 33]", lambda c: with_layout(
        c, areas=c.layout.areas.set_geometry(shapely.transform(
            c.layout.areas.geometry.to_numpy(), lambda p: p * [1.0, 2.0])))),
    ("stat(road, lanes, max) == 8", edit("roads", "lanes", "made/r01", 4)),
    ("density(tree, road.class=primary) >= 30", things("trees", TREE, (185.0, 20.0))),
    ("spacing(tree, road.class=primary) in [9, 11]",
     things("trees", TREE, *[(185.0, float(y)) for y in range(5, 150, 20)])),
    ("dist(plaza, center) <= 0.15 * min(size.x, size.y)", shift("areas", "made/a02", 150.0, 100.0)),
    ("dist(tree, building) >= 5", things("trees", TREE, (190.0, 20.0), (30.0, 25.0))),
    ("overlap(building, river) == 0", shift("buildings", "made/b01", 0.0, 140.0)),
    ("inside(lake, park)", shift("areas", "made/a04", 0.0, 80.0)),
    ("crosses(bridge, river)", shift("areas", "made/a01", 0.0, -60.0)),
    ("n(bridge) == 1", edit("roads", "bridge", "made/c02", False)),
    ("n(bridge, over=water) >= 1", shift("areas", "made/a01", 0.0, -60.0)),
    ("axis(road, class=primary) == north_south", turned),
    ("spans(road, class=primary, dir=y) >= 0.95", turned),
    ("side(beach) == south", shift("areas", "made/a05", 0.0, 390.0)),
    ("n(beach) == 1", no("areas", "made/a07", "made/a01")),
    ("n(river) == 1", no("areas", "made/a01")),
    ("n(lake) == 1", no("areas", "made/a04")),
    ("n(park) == 1", no("areas", "made/a03")),
    ("n(plaza) >= 1", no("areas", "made/a02")),
    ("n(sea) >= 1", no("areas", "made/a07")),
    ("n(garden) >= 1", no("areas", "made/a06")),
    ("n(tree) >= 15", things("trees", SHRUB, *[(185.0, float(y)) for y in range(5, 150, 10)])),
    ("n(shrub) == 0", things("more", SHRUB, (5.0, 60.0))),
    ("n(streetlight, on=false) >= 5", air(lamps=1.0)),
    ("n(light, type=neon) == 0", things("signs", NEON, (20.0, 20.0), owner=5)),
    ("n(vehicle) == 2", things("buses", BUS, (140.0, 96.0))),
    ("n(vehicle, type=bus) == 0", things("buses", BUS, (140.0, 96.0))),
    ("n(pedestrian) == 0", things("people", PERSON, (140.0, 90.0))),
    ("n(road, class=primary, lanes=8) >= 1", edit("roads", "lanes", "made/r01", 6)),
    ("n(road, class=primary) == 1", edit("roads", "kind", "made/r02", "primary")),
    ("color(b02) ~ red", shells(b02={"tint": (0.1, 0.2, 0.9)})),
    ("road.pattern == grid", lambda c: with_layout(c, roads=c.layout.roads.set_geometry(
        shapely.transform(c.layout.roads.geometry.to_numpy(), _bent)))),
    ("env.weather == clear", air(rain=5.0, cloud_cover=0.9)),
    ("env.time == afternoon", air(sun_elevation=-0.4)),
    ("env.time != night", air(sun_elevation=-0.4)),
    ("env.sun_elev in [15, 55]", air(sun_elevation=0.1)),
    ("sun_azimuth in [190, 210]", air(sun_azimuth=1.0)),
    ("env.fog <= 0.1", air(visibility=300.0)),
    ("env.wetness < 0.1", air(wetness=0.5)),
    ("env.snow_cover == 0", air(snow=0.3)),
    ("env.cloud <= 0.2", air(cloud_cover=0.9)),
    ("size.x in [396, 404]", wider),
    ("size.area <= 160000", wider),
]  # fmt: skip


def _bent(points):
    x, y = points.T
    turn = 0.004 * np.hypot(x - 100, y - 50)
    return np.column_stack(
        [x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)]
    )


def base(predicate, city):
    """The made city, with what one predicate needs besides."""
    if "color(b02)" in predicate:
        return with_shells(city, shells_with(b02={"tint": (0.6, 0.05, 0.03)}))
    if "pattern" in predicate:
        dense = [shapely.segmentize(line, 10.0) for line in city.layout.roads.geometry]
        return with_layout(city, roads=city.layout.roads.set_geometry(dense))
    return city


@pytest.mark.parametrize(("predicate", "change"), CASES, ids=[case[0] for case in CASES])
def test_a_predicate_turns_false_when_its_condition_is_flipped(city, predicate, change):
    before = base(predicate, city)
    found = measure(predicate, before)
    assert found.met is True, found
    changed = measure(predicate, change(before))
    assert changed.met is False, changed
    assert changed.evidence


def test_things_stand_around_a_place_only_if_near_and_on_all_sides(city):
    asked = "around(house, plaza)"
    ring = [(150.0, 150.0), (240.0, 170.0), (190.0, 260.0)]
    rows = [(x, y, 14.0, 12.0, 9.0, 3, "house", "cottage", "brick") for x, y in ring]
    near = with_houses(city, rows)
    assert measure(asked, near).met
    assert not measure(asked, without(near, "areas", [row_of(near, "areas", "made/a02")])).met
    aside = [(x - 100.0, y, *rest) for x, y, *rest in rows]
    assert not measure(asked, with_houses(city, aside)).met


def with_houses(city, rows):
    buildings, parts = houses(rows)
    changed = with_layout(city, buildings=buildings, parts=parts)
    return with_shells(changed, [shell(k, row) for k, row in enumerate(rows)])


def test_each_wants_its_predicate_at_every_one(city):
    asked = "each(river, n(vehicle) >= 1)"
    assert not measure(asked, city).met
    assert measure(asked, with_things(city, "buses", BUS, [(100.0, 170.0)])).met


def test_a_slope_is_that_of_the_streets_heights(city):
    points = np.array([(0.0, 100.0), (50.0, 100.0), (100.0, 100.0)])
    network = RoadNetwork(
        points[[0, 2]], np.array([1, 1], np.int32), np.array([[0, 1]], np.int32),
        np.array([row_of(city, "roads", "made/r02")], np.int32), np.array([9], np.uint64),
        np.array([0, 3]), points, np.array([3.0]), np.zeros((1, 2)), np.zeros((1, 2), bool),
        np.zeros(1, bool), np.array([0.0, 4.0, 5.0]), np.zeros(3),
    )  # fmt: skip
    asked = "stat(road, slope, max) <= 0.12"
    assert measure(asked, replace(city, network=network)).met
    steep = replace(network, z=np.array([0.0, 9.0, 5.0]))
    assert not measure(asked, replace(city, network=steep)).met
    assert measure(asked, city).met is None  # no network, no heights


def test_the_nearest_tree_and_carriageway_are_measured_on_the_ground(city):
    assert measure("dist(tree, carriageway) >= 0.3", city).met is None
    corners = np.array([(186.0, 0.0), (214.0, 0.0), (214.0, 400.0), (186.0, 400.0)])
    ground = Ground(
        corners, np.array([(0, 1, 2), (0, 2, 3)], np.int32), np.zeros(2, np.int32),
        np.array([LABEL["carriageway"]], np.uint8), np.zeros(1, np.uint64),
        np.zeros((0, 2), np.int32), np.zeros((0, 2), np.int32),
    )  # fmt: skip
    laid = replace(city, ground=ground)
    assert measure("dist(tree, carriageway) >= 0.3", laid).met
    planted = with_things(laid, "trees", TREE, [(186.1, 50.0)])
    assert not measure("dist(tree, carriageway) >= 0.3", planted).met


def test_what_moves_cannot_be_told_of_a_city_in_which_nothing_does(city):
    for asked in (
        "density(vehicle, road.class=primary) >= 25", "follows(pedestrian, r01, dev=0.5)",
        "stat(vehicle, speed, mean) in [16, 20]",
    ):  # fmt: skip
        found = measure(asked, city)
        assert found.met is None
        assert "moves" in found.evidence
    assert measure("n(pedestrian, mode=run) == 1", city).met is False  # nobody is there


def test_parked_cars_are_vehicles(city):
    assert not measure("n(vehicle) == 0", city).met
    assert measure("n(car) == 2", city).met


def test_a_tag_alone_changes_nothing(city):
    tagged = edited(city, "buildings", "name", row_of(city, "buildings", "made/b01"), "tower")
    assert measure("n(tower) == 3", tagged).met
    assert measure("share(building, material=glass) >= 0.4", tagged).met
    called = with_air(city, weather="storm")
    assert measure("env.weather == clear", called).met


def test_what_is_not_there_is_not_met_rather_than_unknown(city):
    bare = without(city, "areas", slice(None))
    for asked in ("stat(river, width, mean) >= 1", "side(beach) == south", "color(b99) ~ red"):
        assert measure(asked, bare).met is False


def test_an_answer_is_asked_by_its_typed_fields(city):
    reply = Reply("clarify", frozenset({"conflict:building"}), ("layout/town-v1",), 1)
    asked = ["reply(clarify)", "mentions(conflict:building)", "used(town)", "unused(run_python)",
             "journal.mutations == 1"]  # fmt: skip
    assert [each.met for each in measure_all(asked, city, reply=reply)] == [True] * 5
    other = Reply("done", frozenset(), ("run_python",), 0)
    assert [each.met for each in measure_all(asked, city, reply=other)] == [False] * 5
    assert [each.met for each in measure_all(asked, city)] == [None] * 5


def test_a_city_is_clean_until_something_is_wrong(city):
    assert all(each.met for each in clean(city))
    assert measure("clean()", city).met
    home = shapely.box(20.0, 20.0, 40.0, 40.0)
    parts = city.layout.parts.set_geometry([home] * len(HOUSES))
    shared = with_layout(city, parts=parts)
    found = {each.evidence.partition(":")[0]: each.met for each in clean(shared)}
    assert found["no two buildings share ground"] is False
    out = with_things(city, "trees", TREE, [(900.0, 900.0)])
    assert not measure("clean()", out).met
    nan = with_things(city, "trees", TREE, [(np.nan, 50.0)])
    assert not measure("clean()", nan).met
