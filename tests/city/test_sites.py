import numpy as np
import shapely

from cityx.city.layout import Layout, make_table
from cityx.city.sites import cut, left_at_border, merged


def layout():
    house = shapely.box(8, 8, 14, 14)
    return Layout(
        (-50.0, -50.0, 50.0, 50.0),
        buildings=make_table("buildings", [house], id=[7]),
        parts=make_table("parts", [house], id=[8], building=[7]),
        roads=make_table(
            "roads",
            [shapely.LineString([(-50, 0), (50, 0), (50, 5), (-50, 5)])],
            id=[1],
            source=["osm/way/1"],
        ),
        areas=make_table("areas", [shapely.box(-40, -40, 40, 40)], id=[2]),
        points=make_table("points", shapely.points([[1, 1], [30, 1]]), id=[3, 4]),
        restrictions=make_table("restrictions", shapely.points([[0, 0], [40, 0]]), id=[5, 6]),
    )


def test_a_window_keeps_whole_buildings_and_cuts_the_rest():
    found = cut(layout(), (-10.0, -10.0, 12.0, 12.0))
    assert found.extent == (-10.0, -10.0, 29.0, 29.0)  # grown by the house and its margin
    assert found.buildings["id"].tolist() == [7]
    assert found.parts["building"].tolist() == [7]
    assert found.roads.geometry.length.tolist() == [39.0, 39.0]
    assert found.roads["id"].nunique() == 2
    assert found.roads["source"].tolist() == ["osm/way/1"] * 2
    assert found.areas.geometry.area.tolist() == [39.0**2]
    assert found.points["id"].tolist() == [3]
    assert found.restrictions["id"].tolist() == [5]


def test_a_building_whose_middle_lies_outside_is_dropped_with_its_parts():
    found = cut(layout(), (-10.0, -10.0, 10.0, 10.0))
    assert not len(found.buildings)
    assert not len(found.parts)
    assert found.extent == (-10.0, -10.0, 10.0, 10.0)


def test_a_site_that_grew_keeps_what_it_has_room_for_and_names_what_its_border_cuts():
    row = [shapely.box(x, 0, x + 8, 8) for x in (0, 10, 20, 30, 40, 50)]
    whole = Layout(
        (-90.0, -90.0, 90.0, 90.0),
        buildings=make_table(
            "buildings", row, id=range(1, 7), source=[f"way/{k}" for k in range(6)]
        ),
    )
    found = cut(whole, (-20.0, -20.0, 15.0, 20.0))
    assert found.extent == (-20.0, -20.0, 33.0, 23.0)
    assert found.buildings["id"].tolist() == [1, 2]
    assert left_at_border(whole, found) == ["way/2", "way/3"]


def test_a_small_building_beside_one_that_makes_the_site_grow_is_kept():
    hall, shed = shapely.box(0, 0, 60, 20), shapely.box(40, 30, 44, 34)
    beside = Layout(
        (-90.0, -90.0, 90.0, 90.0),
        buildings=make_table("buildings", [hall, shed], id=[1, 2], source=["way/1", "way/2"]),
    )
    found = cut(beside, (-50.0, -50.0, 35.0, 50.0))
    assert found.buildings["id"].tolist() == [1, 2]
    assert not left_at_border(beside, found)


def test_rows_of_the_same_id_are_replaced():
    old, new = layout(), layout()
    new.roads["name"] = "New Street"
    both = merged(old, new)
    assert both.roads["name"].tolist() == ["New Street"]
    assert len(both.restrictions) == 2
    assert np.array_equal(both.extent, old.extent)
