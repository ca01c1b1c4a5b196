"""Numbers of buildings, their heights, the share built on, and a park in the middle."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.building.design import design
from cityx.checks.predicates.places import places_of
from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed, UsageError
from cityx.town.town import town
from cityx.town.wishes.counting import buildings_count
from cityx.town.wishes.covering import cover
from cityx.town.wishes.elements import elements
from cityx.town.wishes.green import green_share
from cityx.town.wishes.limits import building_limits
from cityx.town.wishes.park import central_park
from cityx.town.wishes.places import places
from cityx.town.wishes.towers import towers
from cityx.town.wishes.uses import use_share


def site(seed=3, size=200.0, **plan):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=seed)
    return town(city, width=size, depth=size, **plan)


def overlap(city):
    houses = city.layout.buildings.geometry.to_numpy()
    return shapely.area(houses).sum() - shapely.union_all(houses).area


@pytest.mark.parametrize("count", [0, 1, 12, 30, 60])
def test_there_are_exactly_so_many_buildings(count, check_goals):
    city = buildings_count(site(pattern="grid", zone="core"), count=count)
    layout = city.layout
    assert len(layout.buildings) == count
    assert set(layout.parts["building"]) == set(layout.buildings["id"])
    assert overlap(city) < 0.05
    check_goals(city)
    again = buildings_count(site(pattern="grid", zone="core"), count=count).layout
    assert again.buildings.equals(layout.buildings)


def test_more_buildings_than_fit_are_refused_with_what_fits():
    with pytest.raises(ActionFailed, match=r"5000 buildings cannot be had: .* gives \d\d+"):
        buildings_count(site(zone="core"), count=5000)
    with pytest.raises(ActionFailed, match="2 buildings are fewer than the 3 that were asked for"):
        buildings_count(towers(site(size=400.0), count=3), count=2)


def test_storeys_and_heights_stay_within_limits(check_goals):
    city = building_limits(site(zone="core"), most_floors=5)
    assert city.layout.buildings["levels"].max() == 5
    assert city.layout.parts["levels"].max() <= 5
    check_goals(city)
    city = building_limits(site(zone="midrise"), lowest=20.0, highest=24.0)
    height = city.layout.buildings["height"]
    assert (height.min(), height.max()) >= (20.0, 20.0)
    assert height.max() <= 24.0
    top = city.layout.parts.groupby("building")["top"].max().to_numpy()
    assert top.min() > 19.0
    check_goals(city)


def test_limits_that_contradict_each_other_are_refused():
    with pytest.raises(UsageError, match="least_floors = 9 is more than most_floors = 3"):
        building_limits(site(), least_floors=9, most_floors=3)
    with pytest.raises(ActionFailed, match=r"buildings would get storeys of \d\d\.\d m; between"):
        building_limits(site(), most_floors=2, lowest=60.0)


def test_a_share_of_the_site_is_built_on(check_goals):
    built = site(zone="row", pattern="grid", plazas=0.0, parks=0.0)
    less = cover(built, most=0.2)
    share = shapely.area(less.layout.buildings.geometry.to_numpy()).sum() / 200.0**2
    assert 0.12 < share <= 0.2
    check_goals(less)
    check_goals(cover(built, least=0.22))
    with pytest.raises(ActionFailed, match=r"Buildings take 0\.\d+ of the site, 0\.7 are asked"):
        cover(built, least=0.7)


def test_nothing_but_towers_stand_around_a_plaza_in_the_middle():
    city = towers(site(size=500.0, pattern="grid", density=0.9), count=20, alone=True)
    assert len(city.layout.buildings) == 20
    height = city.layout.buildings["height"]
    assert height.between(80.0, 150.0).all()
    plaza = places_of(city, "plaza")
    assert shapely.distance(plaza, shapely.Point(0, 0)).min() <= 0.15 * 500.0
    assert set(city.layout.areas["kind"]) <= {"grass", "park", "pedestrian"}


def test_a_plaza_lies_in_the_middle(check_goals):
    city = places(site(size=600.0, zone="suburb", plazas=0.0), kind="plaza", count=2, central=True)
    assert len(places_of(city, "plaza")) == 2
    check_goals(city)


@pytest.mark.sweep(1)
@pytest.mark.parametrize("pattern", ["grid", "organic", "mixed"])
def test_a_large_park_holds_a_lake(pattern, check_goals):
    city = central_park(site(size=500.0, pattern=pattern, zone="row"), share=0.15)
    park = city.layout.areas[city.layout.areas["source"] == "made/park/central"].geometry.iloc[0]
    lake = city.layout.areas[city.layout.areas["kind"] == "water"].geometry.iloc[0]
    assert 0.1 <= park.area / 500.0**2 <= 0.3
    assert lake.within(park)
    assert lake.area > 0.15 * park.area
    assert park.distance(shapely.Point(0, 0)) < 60.0
    assert not shapely.intersects(city.layout.buildings.geometry.to_numpy(), park).any()
    assert not city.layout.roads.geometry.intersects(park.buffer(-0.5)).any()
    check_goals(city)


def test_roads_that_led_into_the_park_end_at_junctions():
    city = central_park(site(size=500.0, pattern="grid"), share=0.2, lake=False)
    lines = city.layout.roads.geometry.to_numpy()
    tips = np.concatenate([shapely.get_point(lines, 0), shapely.get_point(lines, -1)])
    border = shapely.box(*city.layout.extent).exterior
    inner = tips[shapely.distance(tips, border) > 1.0]
    touched = shapely.STRtree(lines).query(inner, predicate="dwithin", distance=0.01)[0]
    assert np.bincount(touched, minlength=len(inner)).min() >= 2


def test_a_share_of_the_site_is_green(check_goals):
    built = site(size=300.0, zone="core", parks=0.0, plazas=0.0, pattern="grid")
    check_goals(green_share(built, share=0.3))
    unchanged = green_share(site(size=300.0, zone="row"), share=0.05)
    assert len(unchanged.layout.buildings) == len(site(size=300.0, zone="row").layout.buildings)
    with pytest.raises(ActionFailed, match=r"0\.9 of green cannot be had: .* a park it is 0\.\d+"):
        green_share(built, share=0.9)


def designed(city):
    return design(city).layout


@pytest.mark.parametrize(("zone", "highest"), [("midrise", 12.0), ("suburb", 6.5), ("core", 21.0)])
def test_designs_stay_below_a_height_that_is_asked(zone, highest):
    city = building_limits(site(zone=zone), highest=highest)
    layout = designed(city)
    assert layout.buildings["height"].max() <= highest + 1e-6
    assert layout.parts["top"].max() <= highest + 1e-6
    storey = (layout.buildings["height"] / layout.buildings["levels"]).to_numpy()
    assert np.median(storey) < 6.0
    assert layout.buildings["height"].nunique() > 3


@pytest.mark.parametrize(("zone", "lowest"), [("suburb", 9.0), ("midrise", 25.0), ("core", 40.0)])
def test_designs_reach_a_height_that_is_asked(zone, lowest):
    layout = designed(building_limits(site(zone=zone), lowest=lowest))
    assert layout.buildings["height"].min() >= lowest - 1e-6


@pytest.mark.parametrize(("least", "most"), [(8, 8), (1, 3), (5, 200)])
def test_no_part_of_a_design_has_more_floors_than_asked(least, most):
    layout = designed(building_limits(site(zone="core"), least_floors=least, most_floors=most))
    assert layout.buildings["levels"].between(least, most).all()
    assert layout.parts["levels"].max() <= most


def test_limits_of_a_kind_leave_the_others():
    city = use_share(site(zone="midrise"), use="office", least=0.4)
    before = city.layout.buildings
    limited = building_limits(city, kind="office", highest=9.0).layout.buildings
    office = (before["use"] == "office").to_numpy()
    assert 0.4 <= office.mean() < 1.0
    assert limited["height"][office].max() <= 9.0
    assert limited["height"][~office].equals(before["height"][~office])


def test_a_church_is_as_high_as_asked(check_goals):
    city = elements(site(zone="midrise", size=300.0), kind="church", least=1)
    for highest in (12.0, 40.0):
        lower = building_limits(city, kind="church", lowest=highest - 1.0, highest=highest)
        church = lower.layout.buildings["use"].isin(["church", "chapel"])
        assert lower.layout.buildings["height"][church].between(highest - 1.0, highest).all()
        check_goals(lower)


def test_what_a_map_states_stands_and_the_contradiction_is_named():
    city = site(zone="midrise")
    table = city.layout.buildings.copy()
    table["source"] = table["source"].mask(table.index < 3, "osm/way/7")
    tags = table["tags"].where(table.index >= 3, '{"height": "15"}')
    table = table.assign(tags=tags, height=table["height"].mask(table.index < 3, 15.0))
    mapped = replace(city, layout=replace(city.layout, buildings=table))
    limited = building_limits(mapped, highest=9.0)
    assert (limited.layout.buildings["height"][:3] == 15.0).all()
    assert limited.layout.buildings["height"][3:].max() <= 9.0
    note = "at most 9 m are asked, but the map states 15 to 15 m for 3 buildings; what it states"
    assert any(note in text for text in limited.notes)


@pytest.mark.parametrize(
    ("asked", "low", "high"),
    [({"most": 20}, 0, 20), ({"least": 70}, 70, 1000), ({"least": 30, "most": 33}, 30, 33)],
)
def test_numbers_of_buildings_have_bounds(asked, low, high, check_goals):
    city = buildings_count(site(pattern="grid", zone="core", size=300.0), **asked)
    assert low <= len(city.layout.buildings) <= high
    check_goals(city)


@pytest.mark.parametrize("most", [0, 2, 5])
def test_too_many_towers_are_lowered(most, check_goals):
    city = buildings_count(site(zone="core", density=1.0, size=300.0), kind="tower", most=most)
    layout = city.layout
    slender = layout.buildings["height"] / np.sqrt(layout.buildings.area)
    assert ((layout.buildings["height"] >= 50.0) & (slender >= 1.5)).sum() <= most
    check_goals(city)


@pytest.mark.parametrize(
    "plan",
    [
        {"local_most": 7.0}, {"local_least": 11.0}, {"main_least": 16.0, "main_most": 18.0},
        {"local_least": 6.0, "local_most": 6.5, "main_most": 9.0},
    ],
)  # fmt: skip
def test_carriageways_are_as_wide_as_asked(plan):
    roads = site(size=400.0, zone="midrise", **plan).layout.roads
    main = roads["kind"].isin(["primary", "secondary"])
    for of, rows in (("main", main), ("local", ~main & (roads["kind"] != "service"))):
        width = roads["width"][rows]
        assert width.between(plan.get(f"{of}_least", 0.0), plan.get(f"{of}_most", 99.0)).all()


@pytest.mark.parametrize("plan", [
    {"main_least_lanes": 4}, {"main_most_lanes": 2, "local_most_lanes": 1},
    {"local_least_lanes": 2, "local_most_lanes": 2},
])  # fmt: skip
def test_streets_have_as_many_lanes_as_asked(plan):
    roads = site(size=400.0, zone="midrise", **plan).layout.roads
    main = roads["kind"].isin(["primary", "secondary"])
    for of, rows in (("main", main), ("local", ~main)):
        low, high = plan.get(f"{of}_least_lanes", 1), plan.get(f"{of}_most_lanes", 12)
        assert roads["lanes"][rows].between(low, high).all()


@pytest.mark.parametrize(("least", "most"), [(0.5, None), (None, 0.2), (0.3, 0.4)])
def test_a_use_has_its_share_of_the_number_of_buildings(least, most):
    city = use_share(site(zone="midrise", size=300.0), use="office", share=0.3)
    city = use_share(city, use="office", least=least, most=most)
    share = (city.layout.buildings["use"] == "office").mean()
    assert (least or 0.0) <= share <= (1.0 if most is None else most)


@pytest.mark.parametrize("most", [0.05, 0.15, 0.3])
def test_no_more_of_a_site_is_green_than_asked(most, check_goals):
    check_goals(green_share(site(size=300.0, zone="suburb"), share=0.0, most=most))
