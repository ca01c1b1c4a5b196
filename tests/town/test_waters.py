"""Rivers and canals that are asked for: how many, where, how wide, under how many bridges."""

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed
from cityx.town.coast import coast
from cityx.town.ponds import GREENS
from cityx.town.town import town
from cityx.town.wishes.places import places
from cityx.town.wishes.ponds import ponds
from cityx.town.wishes.river import river


@pytest.fixture(scope="module")
def bare():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(start, width=480.0, depth=480.0)


def water_of(city):
    """Return the joined water of a layout."""
    areas = city.layout.areas
    return shapely.union_all(areas.geometry.to_numpy()[(areas["kind"] == "river").to_numpy()])


def bridges_of(city):
    """Count the bridges by the streets of a higher level that cross water."""
    roads = city.layout.roads
    high = roads.geometry.to_numpy()[(roads["layer"] > 0).to_numpy()]
    return int(shapely.intersects(high, water_of(city)).sum())


@pytest.mark.parametrize("axis", ["west_east", "north_south"])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_rivers_are_counted(bare, count, axis):
    city = river(bare, count=count, width=16.0, bridges=2 * count, axis=axis)
    assert len(shapely.get_parts(water_of(city))) == count
    assert bridges_of(city) == 2 * count
    for goal in city.goals[len(bare.goals) :]:
        assert measure(goal.predicate, city).met, goal


@pytest.mark.parametrize("count", [2, 3])
def test_rivers_that_meet_are_one_water_with_an_end_more(bare, count):
    city = river(bare, count=count, meet=True, width=20.0, bridges=count)
    water = water_of(city)
    border = shapely.box(*city.layout.extent).exterior.buffer(0.5)
    assert len(shapely.get_parts(water)) == 1
    assert len(shapely.get_parts(water.intersection(border))) == count + 1
    assert bridges_of(city) == count
    for goal in city.goals[len(bare.goals) :]:
        assert measure(goal.predicate, city).met, goal


@pytest.mark.parametrize("side", ["north", "east", "south", "west"])
def test_a_river_flows_along_its_side(bare, side):
    city = river(bare, side=side, width=24.0)
    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = water_of(city).centroid.coords[0]
    share = {"north": (y - ymin) / (ymax - ymin), "east": (x - xmin) / (xmax - xmin)}
    far = share.get(side, 1 - share[{"south": "north", "west": "east"}.get(side, side)])
    assert far > 0.7


@pytest.mark.parametrize("width", [12.0, 40.0, 70.0])
def test_a_river_has_its_width(bare, width):
    city = river(bare, width=width, bridges=1)
    middle = water_of(city).intersection(shapely.box(-1.0, -1e3, 1.0, 1e3))
    assert middle.area / 2.0 == pytest.approx(width, rel=0.1)


@pytest.mark.parametrize("axis", ["west_east", "north_south"])
def test_a_canal_is_straight_and_paved_beside_the_water(bare, axis):
    city = river(bare, kind="canal", width=12.0, axis=axis)
    water = water_of(city)
    assert water.area == pytest.approx(shapely.oriented_envelope(water).area, rel=0.01)
    beside = water.buffer(1.0).difference(water).intersection(shapely.box(*city.layout.extent))
    paved = city.layout.areas[city.layout.areas["kind"] == "pedestrian"].geometry.union_all()
    assert beside.intersection(paved).area > 0.9 * beside.area
    assert [measure(f"n({kind}) >= 0", city).value for kind in ("river", "canal")] == [0, 1]


def test_a_canal_beside_a_river_adds_its_bridges(bare):
    city = river(river(bare, width=16.0, side="north"), kind="canal", side="south", width=10.0)
    assert [measure(f"n({kind}) >= 0", city).value for kind in ("river", "canal")] == [1, 1]
    assert bridges_of(city) == 4
    assert all(measure(goal.predicate, city).met for goal in city.goals[len(bare.goals) :])


def test_no_river_is_asked_for(bare):
    city = river(bare, count=0)
    assert water_of(city).is_empty
    assert np.array_equal(city.layout.roads["id"], bare.layout.roads["id"])


def test_rivers_without_room_are_refused_by_name(bare):
    with pytest.raises(ActionFailed, match="3 rivers 90 m wide with their quays need"):
        river(bare, count=3, width=90.0)
    with pytest.raises(ActionFailed, match="40 bridges do not fit"):
        river(bare, bridges=40)


def islands_of(city):
    """Return the land that is not joined to the border of the site, by flooding the water."""
    areas = city.layout.areas
    wet = areas["kind"].isin(["river", "water", "sea"]).to_numpy()
    site = shapely.box(*city.layout.extent)
    land = site.difference(shapely.union_all(areas.geometry.to_numpy()[wet]).buffer(0.3))
    parts = shapely.get_parts(land)
    return parts[(shapely.distance(parts, site.exterior) > 1.0) & (shapely.area(parts) > 20.0)]


@pytest.mark.parametrize("count", [1, 3])
def test_islands_lie_in_a_river_and_bridges_pass_them_by(bare, count):
    city = river(bare, width=30.0, bridges=2, islands=count)
    found = islands_of(city)
    assert len(found) == count
    roads = city.layout.roads.geometry.to_numpy()
    assert not shapely.STRtree(roads).query(found, "intersects").size
    assert bridges_of(city) == 2
    for goal in city.goals[len(bare.goals) :]:
        assert measure(goal.predicate, city).met, goal


def test_islands_that_do_not_fit_in_a_river_are_refused(bare):
    with pytest.raises(ActionFailed, match=r"8 islands do not fit .* there is room for"):
        river(bare, width=30.0, islands=8)
    with pytest.raises(ActionFailed, match="Islands lie in rivers of 14 m and more"):
        river(bare, width=8.0, islands=1)


@pytest.mark.parametrize("beach", [0.0, 30.0])
def test_a_town_on_an_island_has_the_sea_all_round(bare, beach):
    city = coast(bare, side="all", share=0.35, beach=beach)
    (land,) = islands_of(city)
    houses = city.layout.buildings.geometry.to_numpy()
    roads = city.layout.roads.geometry.to_numpy()
    assert len(houses) > 20
    assert shapely.covered_by(houses, land).all()
    assert shapely.covered_by(roads, land).all()
    for goal in city.goals[len(bare.goals) :]:
        assert measure(goal.predicate, city).met, goal
    with pytest.raises(ActionFailed, match="round an island leave"):
        coast(bare, side="all", share=0.7, beach=100.0)


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("a town on an island, 420 m by 420 m", 1), ("a village on an island", 1),
        ("an island in the river, 480 m by 480 m", 1), ("a river with three islands", 3),
        ("a lake with an island", 1), ("three islands in the lake", 3),
        ("a town with a river and no islands, 420 m by 420 m", 0),
    ],
)  # fmt: skip
@pytest.mark.sweep(3)
def test_islands_of_sentences_stand(text, count, check_sentence):
    assert len(islands_of(check_sentence(text))) == count


@pytest.mark.parametrize("count", [1, 3])
def test_as_many_ponds_as_asked_lie_in_greens(count):
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    city = ponds(places(town(start, width=300.0, depth=300.0), kind="park", count=1), least=count)
    assert measure(f"n(pond) == {count}", city).met
    areas = city.layout.areas
    water = areas.geometry[areas["kind"] == "water"]
    greens = areas.geometry[areas["kind"].isin(GREENS)].union_all()
    assert all(greens.buffer(1.0).contains(pond) for pond in water)
    assert not any(city.layout.buildings.intersects(pond).any() for pond in water)


def test_ponds_lie_on_the_side_that_is_asked():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    city = ponds(town(start, width=300.0, depth=300.0), least=1, side="north")
    assert measure("side(pond) == north", city).met
