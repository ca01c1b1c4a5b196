"""Boulevards, rivers and coasts cut through a finished town."""

import numpy as np
import pytest
import shapely

from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed
from cityx.town.coast import coast
from cityx.town.cutting import with_points
from cityx.town.town import town
from cityx.town.wishes.boulevard import boulevard
from cityx.town.wishes.river import river


def site(seed=3, width=400.0, depth=400.0, **plan):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=seed)
    return town(city, width=width, depth=depth, **plan)


def land(city, *kinds):
    return city.layout.areas.geometry[city.layout.areas["kind"].isin(kinds)].union_all()


def check_sound(city, check_goals):
    """Goals are met, no house in a road or in water."""
    check_goals(city)
    layout = city.layout
    houses = layout.buildings.geometry.to_numpy()
    roads = shapely.buffer(
        layout.roads.geometry.to_numpy(), layout.roads["width"].to_numpy() / 2, cap_style="flat"
    )
    whole = shapely.union_all(houses)
    assert whole.area == pytest.approx(shapely.area(houses).sum(), abs=0.5)
    assert whole.intersection(shapely.union_all(roads)).area < 1.0
    assert whole.intersection(land(city, "river", "sea")).area == 0.0
    assert shapely.within(houses, shapely.box(*layout.extent)).all()


def test_a_boulevard_runs_straight_through_and_is_alone_of_its_rank(check_goals):
    city = boulevard(site(pattern="grid"), lanes=8, axis="north_south", others=2)
    check_sound(city, check_goals)
    roads = city.layout.roads
    main = roads[roads["kind"] == "primary"]
    assert main["lanes"].tolist() == [8]
    assert set(roads["lanes"][roads["kind"] != "primary"]) == {2}
    x, y = np.array(main.geometry.iloc[0].coords).T
    assert np.ptp(x) == 0.0
    assert (y.min(), y.max()) == (-200.0, 200.0)
    assert len(y) > 4  # streets meet it


@pytest.mark.parametrize(("pattern", "axis"), [("mixed", "west_east"), ("organic", "north_south")])
def test_a_river_has_its_width_and_its_bridges(pattern, axis, check_goals):
    city = river(site(pattern=pattern), width=30.0, bridges=3, axis=axis)
    check_sound(city, check_goals)
    water = land(city, "river")
    bridges = city.layout.roads.geometry[city.layout.roads["bridge"]]
    assert len(bridges) == 3
    assert bridges.intersects(water).all()
    ground = city.layout.roads[~city.layout.roads["bridge"]].geometry
    assert not ground.intersects(water).any()
    ends = shapely.get_point(ground.to_numpy(), 0), shapely.get_point(ground.to_numpy(), -1)
    tips = np.concatenate(ends)
    for bridge in bridges:
        for end in (0, -1):
            assert (shapely.distance(tips, shapely.get_point(bridge, end)) < 1e-6).any()


@pytest.mark.parametrize("side", ["north", "east", "south", "west"])
def test_the_sea_lies_on_its_side_behind_a_beach(side, check_goals):
    city = coast(site(pattern="grid"), side=side, share=0.25, beach=30.0)
    check_sound(city, check_goals)
    sea, sand = land(city, "sea"), land(city, "sand")
    x, y = (round(v / 150) for v in sea.centroid.coords[0])
    assert (x, y) == {"north": (0, 1), "east": (1, 0), "south": (0, -1), "west": (-1, 0)}[side]
    assert sand.distance(sea) < 0.01
    assert sea.area / 400.0**2 == pytest.approx(0.25, abs=0.02)
    assert sand.area == pytest.approx(400.0 * 30.0, rel=0.1)


def test_a_coast_and_a_river_go_together_in_order(check_goals):
    city = coast(site(width=500.0, depth=500.0), side="west", share=0.2)
    check_sound(river(city, width=20.0, bridges=2, axis="north_south"), check_goals)
    with pytest.raises(ActionFailed, match="There is water already wherever a river could flow"):
        river(city, axis="west_east")
    with pytest.raises(ActionFailed, match="A river flows to the west; a coast there has to come"):
        coast(river(site(), axis="west_east"), side="west")


def test_what_does_not_fit_is_refused_with_what_would():
    with pytest.raises(ActionFailed, match="there is room for 8"):
        river(site(), bridges=20)
    with pytest.raises(ActionFailed, match="leave 0 m of land; 60 m are needed"):
        coast(site(), share=0.5, beach=200.0)


def test_a_street_across_water_is_refused():
    with pytest.raises(ActionFailed, match="It would cross water, over which only a river's own"):
        boulevard(river(site(), axis="west_east"), axis="north_south")


def test_the_same_cut_gives_the_same_rows():
    first, second = (river(site(), bridges=2).layout for _ in range(2))
    for table in ("buildings", "parts", "roads", "areas"):
        assert getattr(first, table).equals(getattr(second, table))


def test_places_on_a_line_become_points_of_it():
    line = shapely.LineString([(0, 0), (10, 0), (10, 10)])
    found = with_points(line, np.array([(10.0, 4.0), (5.0, 0.0), (10.0, 0.0)]))
    assert list(found.coords) == [(0, 0), (5, 0), (10, 0), (10, 4), (10, 10)]


def test_a_site_without_room_for_a_river_is_refused():
    empty = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 0.0, 0.0)))
    with pytest.raises(ActionFailed, match="needs 86 m; the site has 0 m across"):
        river(empty, width=30.0)
