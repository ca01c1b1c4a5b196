import numpy as np
import pytest
import shapely

from cityx.places.profiles import profile_named
from cityx.sources.features.clipping import clip_lines
from cityx.sources.features.kinds import road_kind
from cityx.sources.features.road_features import cross_section

NAMES = (
    "section", "kind", "lanes", "lanes_forward", "lane_width", "width", "left", "right",
    "park_left", "park_right", "oneway", "layer", "bridge", "tunnel", "passage", "roundabout",
    "surface", "lit", "speed", "backward",
)  # fmt: skip


def section(*, town=False, dense=False, left_hand=False, place="world", **tags):
    tags = {key.replace("__", ":"): value for key, value in tags.items()}
    streets = profile_named(place).streets
    found = cross_section(tags, streets, town=town, dense=dense, left_hand=left_hand)
    return dict(zip(NAMES, found, strict=True))


def test_streets_have_sidewalks_in_town_and_none_in_the_country():
    assert section(highway="residential", town=True)["left"] == 1.8
    assert section(highway="residential")["left"] == 0
    assert section(highway="motorway", town=True)["left"] == 0
    assert section(highway="primary", sidewalk="right")["right"] == 3.0
    assert section(highway="primary", sidewalk="no", town=True)["right"] == 0
    assert section(highway="primary", sidewalk__left="yes")["left"] == 3.0


def test_cars_park_along_residential_streets_where_it_is_dense():
    street = section(highway="residential", town=True, dense=True)
    assert street["park_left"]
    assert street["width"] == pytest.approx(2 * 2.75 + 2 * 2.1)
    told = section(highway="residential", dense=True, parking__both="no")
    assert not told["park_left"]
    assert section(highway="tertiary", parking__lane__right="parallel")["park_right"]


def test_nobody_parks_in_streets_of_japan_unless_the_map_says_so():
    place = {"town": True, "dense": True, "left_hand": True, "place": "jp"}
    street = section(highway="residential", oneway="yes", **place)
    assert (street["park_left"], street["park_right"]) == (False, False)
    assert street["width"] == pytest.approx(5.0)
    assert street["section"] == "shoulder 1.125 | drive 2.75 + | shoulder 1.125"
    assert street["left"] == street["right"] == 2.0
    assert section(highway="residential", **place)["width"] == pytest.approx(2 * 2.75)
    told = section(highway="residential", oneway="yes", parking__left="lane", **place)
    assert told["park_left"]
    assert told["width"] == pytest.approx(2.75 + 2.1)
    assert section(highway="residential", oneway="yes", width="4", **place)["width"] == 4.0
    assert section(highway="primary", oneway="yes", lanes="1", **place)["width"] == 3.25


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize("oneway", ["yes", "-1"])
def test_cars_park_beside_one_way_streets_on_the_side_one_drives_on(left_hand, oneway):
    street = section(highway="unclassified", dense=True, oneway=oneway, left_hand=left_hand)
    assert (street["park_left"], street["park_right"]) == (left_hand, not left_hand)
    assert street["width"] == pytest.approx(2.75 + 2.1)
    options = {"highway": "tertiary", "dense": True, "oneway": oneway, "left_hand": left_hand}
    assert section(lanes="1", **options)["park_left"] == left_hand
    assert section(lanes="2", **options)["park_left"] is False
    both_ways = section(highway="unclassified", dense=True)
    assert not both_ways["park_left"]
    assert not both_ways["park_right"]


def test_a_tagged_width_holds_the_lanes():
    street = section(highway="primary", width="5 m", lanes="2")
    assert (street["width"], street["lane_width"], street["lanes"]) == (5, 2.5, 2)
    assert section(highway="secondary", width="3")["lanes"] == 1


def test_oneway_halves_the_lanes_and_can_be_turned_round():
    street = section(highway="residential", oneway="yes")
    assert (street["lanes"], street["lanes_forward"], street["oneway"]) == (1, 1, True)
    turned = section(highway="residential", oneway="-1", sidewalk="left")
    assert turned["backward"]
    assert (turned["left"], turned["right"]) == (0, 1.8)
    assert section(highway="motorway")["oneway"]
    assert section(highway="tertiary", junction="roundabout")["oneway"]


def test_lanes_by_direction_are_respected():
    assert section(highway="primary", lanes="3", lanes__forward="1")["lanes_forward"] == 1
    assert section(highway="primary", lanes="3", lanes__backward="1")["lanes_forward"] == 2
    assert section(highway="primary", lanes="500")["lanes"] == 2


def test_bridges_tunnels_and_passages_are_told_apart():
    assert section(highway="path", bridge="viaduct")["layer"] == 1
    tunnel = section(highway="path", tunnel="yes")
    assert (tunnel["layer"], tunnel["tunnel"]) == (-1, True)
    passage = section(highway="service", tunnel="building_passage")
    assert (passage["layer"], passage["tunnel"], passage["passage"]) == (0, False, True)


@pytest.mark.parametrize(
    "tags",
    [
        {"highway": "proposed"}, {"highway": "construction"}, {"highway": "corridor"},
        {"highway": "footway", "indoor": "yes"}, {"highway": "pedestrian", "area": "yes"},
        {"railway": "abandoned"}, {"railway": "platform"}, {"waterway": "river"},
    ],
)  # fmt: skip
def test_what_carries_no_movement_is_no_road(tags):
    assert road_kind(tags) == ""


def test_roads_that_meet_share_their_point_exactly(drawing):
    drawing.way([(0, 0), (50, 3), (100, 0)], highway="residential")
    drawing.way([(50, 3), (50, 90)], highway="service", oneway="-1")
    lines = drawing.city().layout.roads.set_index("kind").geometry
    first, second = (shapely.get_coordinates(lines[k]) for k in ("residential", "service"))
    assert (first[1] == second[-1]).all()


def test_a_road_is_broken_where_the_file_lacks_a_node(drawing):
    drawing.way([(0, 0), (50, 0), (70, 0), (100, 0), (150, 0)], highway="residential")
    missing = drawing.nodes.pop(2)
    assert "node" in missing
    roads = drawing.city().layout.roads
    assert sorted(roads.geometry.length.round()) == [50, 50]
    assert roads["id"].is_unique


def test_clipping_keeps_direction_and_inner_points():
    line = shapely.LineString([(-5, 5), (5, 5), (5, 15), (7, 15), (7, 5), (20, 5)])
    pieces, row = clip_lines(np.array([line, shapely.LineString([(1, 1), (2, 2)])]), (0, 0, 10, 10))
    assert [shapely.get_coordinates(piece).tolist() for piece in pieces] == [
        [[0, 5], [5, 5], [5, 10]], [[7, 10], [7, 5], [10, 5]], [[1, 1], [2, 2]],
    ]  # fmt: skip
    assert row.tolist() == [0, 0, 1]


def test_a_square_is_an_area_and_not_a_road(drawing):
    drawing.way([(0, 0), (100, 0)], highway="residential")
    drawing.box(10, 10, 20, 20, highway="pedestrian", area="yes")
    drawing.box(40, 10, 20, 20, highway="pedestrian")
    layout = drawing.city().layout
    assert layout.areas["kind"].tolist() == ["pedestrian"]
    assert sorted(layout.roads["kind"]) == ["pedestrian", "residential"]
