"""A town that ends at its border."""

import numpy as np
import pytest
import shapely

from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed
from cityx.sources.features.tagged import tags_text
from cityx.town.procedural_streets import ROLE
from cityx.town.town import town


def site(width=400.0, depth=300.0, seed=3, **plan):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=seed)
    return town(city, width=width, depth=depth, **plan).layout


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_small_site_is_built_on_and_has_streets_all_round(seed):
    layout = site(200.0, 250.0, seed=seed, pattern="grid", plazas=0.0)
    assert len(layout.buildings) > 10
    box = layout.roads.total_bounds
    assert (np.abs(np.abs(box) - [100.0, 125.0, 100.0, 125.0]) < 10.0).all()


def roads_with(layout, part):
    role = tags_text({ROLE: part})[1:-1]
    return layout.roads[[role in text for text in layout.roads["tags"]]]


@pytest.mark.parametrize("pattern", ["mixed", "grid", "radial", "organic"])
def test_a_site_is_exactly_its_window_and_cuts_no_building(pattern):
    layout = site(pattern=pattern)
    assert layout.extent == (-200.0, -150.0, 200.0, 150.0)
    frame = shapely.box(*layout.extent)
    houses = layout.buildings.geometry.to_numpy()
    assert len(houses) > 20
    assert shapely.within(houses, frame).all()
    roads = shapely.buffer(
        layout.roads.geometry.to_numpy(), layout.roads["width"].to_numpy() / 2, cap_style="flat"
    )
    assert shapely.area(shapely.intersection(shapely.union_all(houses), roads)).max() < 1e-6
    again = site(pattern=pattern)
    assert layout.buildings.equals(again.buildings)
    assert layout.roads.equals(again.roads)


def test_a_grid_is_one_over_all_of_the_site():
    layout = site(pattern="grid")
    step = np.concatenate([np.diff(line.coords, axis=0) for line in layout.roads.geometry])
    assert np.abs(step).min(axis=1).max() < 0.01


@pytest.mark.parametrize(("avenues", "rings"), [(8, 2), (5, 1), (6, 3)])
def test_avenues_leave_the_square_and_rings_join_them(avenues, rings):
    layout = site(700.0, 600.0, pattern="radial", avenues=avenues, rings=rings)
    leaving, round_it = roads_with(layout, "avenue"), roads_with(layout, "ring")
    assert len(leaving) == avenues == leaving["name"].nunique()
    assert len(round_it) == rings
    assert shapely.is_closed(round_it.geometry.to_numpy()).all()
    plaza = layout.areas.geometry[layout.areas["kind"] == "pedestrian"].union_all()
    assert plaza.distance(shapely.Point(0, 0)) == 0.0
    assert (leaving.geometry.distance(plaza) < 30.0).all()
    assert (leaving.geometry.distance(shapely.box(*layout.extent).exterior) < 0.01).all()
    middle = shapely.Polygon(round_it.geometry.iloc[0]).centroid
    assert middle.distance(shapely.Point(0, 0)) < 0.5


@pytest.mark.parametrize(("streets", "low", "high"), [("narrow", 3.0, 7.0), ("wide", 12.0, 30.0)])
def test_streets_are_as_wide_as_asked(streets, low, high):
    for pattern in ("organic", "mixed"):
        layout = site(pattern=pattern, streets=streets, zone="midrise")
        width = np.median(layout.roads["width"])
        assert low <= width <= high


@pytest.mark.parametrize(
    ("reach", "size"),
    [((-150, -100, 150, 120), (300, 200)), ((-900, -900, 900, 900), (600, 600)),
     ((-400, -80, 380, 80), (600, 160))],
)  # fmt: skip
def test_height_files_smaller_than_a_usual_town_set_its_size(reach, size):
    start = City("Town", Frame(50.0, 10.0), Layout(tuple(map(float, reach))), seed=3)
    xmin, ymin, xmax, ymax = town(start).layout.extent
    assert (xmax - xmin, ymax - ymin) == size
    assert town(start, width=100.0, depth=90.0).layout.extent == (-50.0, -45.0, 50.0, 45.0)


def test_height_files_too_small_for_a_town_are_refused():
    start = City("Town", Frame(50.0, 10.0), Layout((-20.0, -20.0, 20.0, 20.0)), seed=3)
    with pytest.raises(ActionFailed, match="reach over 40 m; a town takes at least 50 m"):
        town(start)
