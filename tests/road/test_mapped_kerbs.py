import json

import pytest
import shapely

from cityx.city.layout import Layout, make_table
from cityx.road.ground.ground_surface import ground_of
from cityx.road.surface.mapped_kerbs import kerb_notes


@pytest.fixture(scope="module")
def street():
    roads = make_table(
        "roads", [shapely.LineString([(-90, 0), (90, 0)])], id=[1], kind=["residential"],
        width=[6.0], sidewalk_left=[2.0], sidewalk_right=[2.0],
    )  # fmt: skip
    return Layout((-80.0, -40.0, 80.0, 40.0), roads=roads)


def told(street, kerbs):
    """Return the notes on kerbs, by what they say, of points (x, y, word)."""
    points = make_table(
        "points", [shapely.Point(x, y) for x, y, _ in kerbs], id=range(1, len(kerbs) + 1),
        kind=["kerb"] * len(kerbs), source=[f"osm/node/{row}" for row in range(len(kerbs))],
        tags=[json.dumps({"barrier": "kerb", "kerb": word}) for *_, word in kerbs],
    )  # fmt: skip
    return kerb_notes(Layout(street.extent, roads=street.roads, points=points), ground_of(street))


def test_kerbs_that_are_built_as_the_map_has_them_need_no_word(street):
    assert told(street, [(0, 3.1, "raised"), (10, -3.1, "regular"), (20, 3.4, "yes")]) == ()


def test_kerbs_that_are_not_there_or_of_another_height_are_named(street):
    notes = told(street, [(0, 3.1, "lowered"), (10, 12, "lowered"), (30, -20, "raised")])
    assert notes == (
        "map: 2 kerbs lie over 2.5 m from those that are built along the streets: "
        "osm/node/1, osm/node/2",
        "map: 1 kerbs that are lowered are built raised: osm/node/0",
    )


def test_a_map_without_kerbs_has_no_notes_on_them(street):
    assert kerb_notes(street, ground_of(street)) == ()
