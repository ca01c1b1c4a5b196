"""Elements in a city that exists: on free land, built like those of a plan, all else kept."""

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import clean, measure
from cityx.city.content import content_hash
from cityx.edit.land.add_element import add_element, replace_by_element
from cityx.edit.land.crossings import crossing
from cityx.errors import ActionFailed


@pytest.mark.parametrize(
    ("kind", "measured"),
    [("playground", "playground"), ("parking_lot", "parking"), ("hotel", "building, tag=hotel")],
)
def test_an_element_is_built_and_no_house_taken(kind, measured, river):
    made = add_element(river, kind=kind)
    assert measure(f"gained({measured}) == 1", made, before=river).met
    kept = set(river.layout.buildings["id"]) <= set(made.layout.buildings["id"])
    assert kept
    assert all(rule.met for rule in clean(made))
    assert content_hash(add_element(river, kind=kind)).total == content_hash(made).total


def test_an_element_lies_where_it_is_to(park):
    made = add_element(park, kind="playground", near=("park1",))
    (own,) = made.layout.areas.loc[made.layout.areas["kind"] == "playground"].geometry
    ground = park.layout.areas.set_index("name").loc["park1", "geometry"]
    assert ground.buffer(0.1).covers(own)


def test_no_room_is_said_so(park):
    corners = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    with pytest.raises(ActionFailed, match="No lot is free there for a stadium"):
        add_element(park, kind="stadium", ground=corners)


def test_a_house_makes_room_for_a_playground(park):
    made = replace_by_element(park, objects=("b03",), kind="playground")
    assert "b03" not in set(made.layout.buildings["name"])
    assert len(made.layout.buildings) == len(park.layout.buildings) - 1
    assert measure("n(playground) == 1", made).met
    assert all(rule.met for rule in clean(made))


def test_a_crossing_is_painted_before_a_house(grid):
    made = crossing(grid, near=("b05",))
    assert measure("gained(crosswalk) == 1", made, before=grid).met
    (spot,) = made.layout.points.loc[made.layout.points["kind"] == "crossing"].geometry
    (house,) = grid.layout.buildings.loc[grid.layout.buildings["name"] == "b05"].geometry
    assert spot.distance(house) < 60.0
    assert shapely.distance(grid.layout.roads.geometry.to_numpy(), spot).min() < 0.01
    assert np.isin(grid.layout.points["id"], made.layout.points["id"]).all()
    with pytest.raises(ActionFailed, match="There is room for"):
        crossing(grid, near=("b05",), count=50)
