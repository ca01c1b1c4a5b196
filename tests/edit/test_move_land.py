"""Land that is moved: it lies where there is room, in what held it, and all else stays."""

import pytest
import shapely

from cityx.checks.predicates import clean
from cityx.edit.land.add_element import add_element
from cityx.edit.land.move_land import move_land
from cityx.errors import ActionFailed


@pytest.fixture(scope="module")
def played(park):
    return add_element(park, kind="playground", near=("park1",))


def own(city):
    (row,) = city.layout.areas[city.layout.areas["kind"] == "playground"].itertuples()
    return row


def test_a_playground_is_moved_within_its_park(played):
    made = move_land(played, objects=(f"{int(own(played).id):016x}",), offset=(-25.0, 0.0))
    park = played.layout.areas.set_index("name").loc["park1", "geometry"]
    assert own(made).geometry.centroid.x < own(played).geometry.centroid.x - 10.0
    assert own(made).geometry.area == pytest.approx(own(played).geometry.area, rel=1e-3)
    assert shapely.Polygon(park.exterior).buffer(0.1).covers(own(made).geometry)
    assert all(rule.met for rule in clean(made))


def test_land_without_room_stays(played):
    with pytest.raises(ActionFailed, match="There is no room within 40 m"):
        move_land(played, objects=(f"{int(own(played).id):016x}",), offset=(900.0, 0.0))
