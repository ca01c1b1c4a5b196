import random
from math import isnan, radians

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.places.profiles import profile_named
from cityx.sources.features import measures
from cityx.sources.features.kinds import (
    building_kind,
    line_kind,
    point_kind,
    road_kind,
    type_word,
    use_of,
)
from cityx.sources.features.road_features import cross_section
from cityx.sources.features.vertical import read_vertical
from cityx.sources.features.vocabulary import area_kind, closed_is_area, is_underground


@pytest.mark.parametrize(
    ("text", "metres"),
    [
        ("12", 12.0), ("12 m", 12.0), ("12.5m", 12.5), ("3,5", 3.5), ("3;4", 3.0), ("~20", 20.0),
        ("ca. 8", 8.0), ("39'6\"", 12.0396), ("6'", 1.8288), ("25 ft", 7.62), ('18"', 0.4572),
        ("1,200", 1.2), ("1,200.5", 1200.5), ("12,345,678", 12345678.0), ("150 cm", 1.5),
        ("2 km", 2000.0), ("1e1", 10.0), ("+4", 4.0), ("3-4", 3.0), ("2.5 x 4", 2.5),
        ("many", None), ("", None), (None, None), ("nan", None), ("inf", None), ("1e999", None),
        ("12 apples", None), ("--3", None), ("٣", 3.0),
    ],
)  # fmt: skip
def test_measures_are_read_as_mappers_write_them(text, metres):
    assert measures.measure(text) == (None if metres is None else pytest.approx(metres))


def test_measures_out_of_range_count_as_unknown():
    assert measures.measure("5000", 0, 1000) is None
    assert measures.count("999999", 0, 200) is None
    assert measures.count("4 storeys", 0, 200) is None


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("#a52", 0xAA5522), ("#AA5522", 0xAA5522), ("aa5522", 0xAA5522), ("red", 0xFF0000),
        ("Dark Red", 0x8B0000), ("light_grey", 0xD3D3D3), ("lightgray", 0xD3D3D3),
        ("#DDB692;#fff", 0xDDB692), ("cream", 0xF3E7C4), ("transparent", -1), ("#ggg", -1),
        ("", -1), (None, -1), ("yes", -1),
    ],
)  # fmt: skip
def test_colours_are_read_by_name_and_number(text, value):
    assert measures.color(text) == value


def test_directions_are_compass_radians():
    assert measures.direction("NNE") == pytest.approx(radians(22.5))
    assert measures.direction("south-west") == pytest.approx(radians(225))
    assert measures.direction("450°") == pytest.approx(radians(90))
    assert isnan(measures.direction("uphill"))


def test_speeds_are_kilometres_per_hour():
    assert measures.speed_kmh("30 mph") == pytest.approx(48.28, abs=0.01)
    assert measures.speed_kmh("50") == 50
    assert isnan(measures.speed_kmh("walk"))


KEYS = (
    "building", "building:part", "height", "min_height", "building:levels", "building:min_level",
    "roof:shape", "roof:height", "roof:levels", "roof:angle", "roof:direction", "building:colour",
    "roof:colour", "building:material", "highway", "railway", "lanes", "lanes:forward", "width",
    "sidewalk", "sidewalk:left", "oneway", "parking:lane:both", "layer", "level", "location",
    "tunnel", "bridge", "covered", "surface", "maxspeed", "lit", "natural", "water", "waterway",
    "landuse", "leisure", "amenity", "area", "man_made", "barrier", "junction", "place", "type",
)  # fmt: skip
VALUES = (
    "yes", "no", "-1", "1;2", "9.0", "flat", "residential", "steps", "rail", "roof", "tower",
    "water", "platform", "underground", "building_passage", "1e308", "-3", "0", "nan", "inf", "4,5",
    "12'6\"", "#fff", "both", "left", "separate", "coastline", "", ";", " ", "1" * 400, "½", "٣",
)  # fmt: skip


def random_tags(rng):
    def value():
        if rng.random() < 0.6:
            return rng.choice(VALUES)
        if rng.random() < 0.5:
            return repr(rng.uniform(-1, 1) * 10 ** rng.randrange(-3, 12))
        return "".join(chr(rng.choice((rng.randrange(32, 127), rng.randrange(1, 0xD000))))
                       for _ in range(rng.randrange(8)))  # fmt: skip

    return {rng.choice(KEYS): value() for _ in range(rng.randrange(10))}


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.integers(0, 2**32))
def test_no_tags_break_the_reading(seed):
    rng = random.Random(seed)
    several = [random_tags(rng) for _ in range(200)]
    read_vertical(several)
    for tags in several:
        for kind in (building_kind, use_of, type_word, line_kind, point_kind, area_kind):
            assert isinstance(kind(tags), str)
        closed_is_area(tags), is_underground(tags)
        if road_kind(tags):
            section = cross_section(tags, profile_named("world").streets, town=True, dense=True)
            lanes, forward, lane_width, width = section[2:6]
            assert 1 <= lanes <= 12
            assert 1 <= forward <= lanes
            assert 0 < lane_width <= width <= 60
