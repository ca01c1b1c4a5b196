"""Houses that stand alone, in pairs or in rows, with gardens and drives beside them."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.checks.predicates.building_predicates import attached
from cityx.city import City, Frame, Layout, Terrain
from cityx.town.part_kinds import built_as, counted
from cityx.town.town import town
from cityx.town.wishes.counting import buildings_count


def made(zone, density=0.0):
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(start, width=220.0, depth=220.0, zone=zone, density=density)


@pytest.mark.parametrize(
    ("zone", "walls"), [("semi", "semi"), ("suburb", "detached"), ("row", "terraced")]
)
def test_a_zone_has_the_houses_of_its_kind_and_no_others(zone, walls):
    city = made(zone, density=0.2)
    others = {"semi", "detached", "terraced"} - {walls}
    assert measure(built_as(walls), city).met
    assert not any(measure(built_as(one), city).met for one in others)


def test_pairs_have_drives_and_gardens():
    city = made("semi")
    for part in ("garden", "driveway"):
        (told,) = counted("house", part, 1, None)
        assert measure(told, city).met
    areas = city.layout.areas
    drives = areas.geometry.to_numpy()[(areas["kind"] == "road_area").to_numpy()]
    assert not shapely.intersects(
        shapely.union_all(shapely.buffer(drives, -0.1)),
        shapely.union_all(city.layout.buildings.geometry.to_numpy()),
    )


def test_garages_stay_beside_houses_that_are_counted():
    city = buildings_count(made("suburb"), count=20, with_sheds=False)
    area = shapely.area(city.layout.buildings.geometry.to_numpy())
    assert (area >= 45.0).sum() == 20
    (told,) = counted("house", "garage", 1, None)
    assert measure(told, city).met


def test_walls_are_counted_by_those_that_touch_along_them():
    boxes = [(0, 0, 8, 9), (8, 0, 16, 9), (16, 0, 24, 9), (24, 9, 32, 18), (40, 0, 48, 9)]
    shapes = np.array([shapely.box(*one) for one in boxes])
    assert attached(shapes).tolist() == [1.0, 2.0, 1.0, 0.0, 0.0]


def test_a_rise_is_measured_from_the_lowest_land_to_the_top():
    city = made("suburb")
    y = np.arange(-150.0, 151.0, 10.0)
    heights = np.repeat(0.1 * (y + 150.0)[:, None], len(y), axis=1)
    sloping = replace(city, terrain=Terrain((-150.0, -150.0), 10.0, heights))
    rise = measure("stat(building, rise, max) >= 0", sloping).value
    assert 0.85 < rise <= 1.0
    assert measure("stat(building, rise, min) >= 0", sloping).value < 0.15
    assert measure("stat(building, rise, max) >= 0", city).value == 0.0
