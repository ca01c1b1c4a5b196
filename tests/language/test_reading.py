import socket
import subprocess
import sys

import pytest

from cityx.language import read_brief


def slots(text, **how):
    return {(key, value) for key, value in read_brief(text, **how).items()}


def value(text, key):
    return read_brief(text).value(key)


@pytest.mark.parametrize(
    ("text", "key", "wanted"),
    [
        ("a city of 2.5 square miles", "size.area", 6474970),
        ("a town of half a hectare", "size.area", 5000),
        ("houses at most thirty-five feet high", "building.height.max", 10.668),
        ("a river 1,200 cm wide", "river.width", 12),
        ("exactly one hundred and five buildings", "building.count", 105),
        ("two dozen houses", "building.count", 24),
        ("half a dozen towers", "building.count", 6),
        ("between eighty and one hundred and fifty buildings", "building.count.max", 150),
        ("not fewer than 3 floors", "building.floors.min", 3),
        ("maximum building height 20 m", "building.height.max", 20),
        ("at a quarter to seven in the evening", "time", "18:45"),
        ("a grid town, 9:05", "time", "09:05"),
    ],
)
def test_measures_come_in_si_units(text, key, wanted):
    assert value(text, key) == wanted


def test_both_sides_of_a_size_share_their_unit():
    for text in ("600x400 m", "600 by 400 metres", "0.6 km x 0.4 km", "600 m × 400 m"):
        assert slots(text) >= {("size.x", 600), ("size.y", 400)}, text


def test_two_types_are_counted_apart():
    brief = read_brief("80 houses and 20 towers")
    assert set(brief.items()) >= {("house.count", 80), ("tower.count", 20)}
    assert brief.conflicts == ()


def test_lanes_in_each_direction_count_twice():
    assert ("roads.main.lanes", 6) in slots("a main road with three lanes each way")
    assert ("roads.main.lanes", 3) in slots("a main road with three lanes")


@pytest.mark.parametrize(
    ("text", "denied"),
    [
        ("no cars, trees or people", {"vehicle", "tree", "pedestrian"}),
        ("neither cars nor people, wide roads", {"vehicle", "pedestrian"}),
        ("without any cars, but with plenty of trees", {"vehicle"}),
        ("free of traffic and pedestrians", {"vehicle", "pedestrian"}),
        ("trams and buses are not needed", {"tram", "bus"}),
        ("no rain", {"rain"}),
        ("no trees and wide roads", {"tree"}),
    ],
)
def test_a_no_reaches_to_the_end_of_its_list(text, denied):
    assert {slot.value for slot in read_brief(text).negated} == denied


def test_a_bound_is_no_denial_and_no_need_is_neither():
    brief = read_brief("No building may be taller than 12 m.")
    assert (brief.items(), brief.negated) == ([("building.height.max", 12)], ())
    assert read_brief("No need for a park.").items() == []
    assert read_brief("brick instead of concrete").items() == [("building.material", "brick")]


def test_a_misspelt_word_is_mended_with_a_note_and_never_far():
    brief = read_brief("a mediteranean town with pedestrains")
    assert ("style", "mediterranean") in brief.items()
    assert [note.code for note in brief.notes].count("spelling") == 2
    assert ("weather", "rain") not in brief.items()


def test_words_nobody_understands_are_listed():
    brief = read_brief("A frobnicated city with quux and a park.")
    assert brief.words_unread == ("frobnicated", "quux")
    assert ("element", "park") in brief.items()


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("buildings at least 50 m and at most 20 m tall", "min_over_max:building.height"),
        ("A city at noon, at night.", "two_values:time"),
        (
            "A city without buildings but with exactly ten skyscrapers.",
            "denied_and_wanted:building",
        ),
        ("A block of 100 by 100 m with 500 houses", "too_many:building"),
        ("Snow at 35 degrees celsius", "snow_in_the_heat"),
        ("two floors at most, at least 60 m tall", "floors_against_height"),
        (
            "single-storey bungalows, the shortest house is at least 20 m high",
            "floors_against_height",
        ),
        ("a village of cottages, each at least 25 m tall", "floors_against_height"),
        ("a square of 200 m x 200 m in a town 150 m across", "too_large:plaza"),
        ("a river 300 m wide on a site of 200 by 200 m", "too_large:river"),
        ("no trees, lots of trees", "denied_and_wanted:tree"),
        ("a church spire of 40 m and no building over 12 m", "above_all:church"),
        ("a mosque at least 30 m high, all buildings below 20 m", "above_all:mosque"),
        ("a church of 25 m; no building may exceed 15 m", "above_all:church"),
        ("ten towers but no building above 30 m", "low_towers:tower"),
        ("streets at most 6 m wide with 4 lanes", "narrow_lanes:roads"),
        ("sunny, pouring rain", "two_values:weather"),
    ],
)
def test_contradictions_are_found_with_both_places(text, code):
    found = {conflict.code: conflict for conflict in read_brief(text).conflicts}
    assert code in found
    assert len(found[code].spans) == 2
    assert all(text[first:last].strip() for first, last in found[code].spans)


def test_words_that_go_together_are_no_contradiction():
    for text in (
        "an overcast, rainy evening at dusk",
        "heavy clouds and light snow",
        "a foggy morning at sunrise",
        "a city of towers and houses with a park and a lake",
        "a church up to 30 m high and no building above 12 m",
        "towers between 60 and 90 m",
        "streets at least 9 m wide with 2 lanes",
    ):
        assert read_brief(text).conflicts == (), text


def test_a_contradiction_says_what_would_be_right():
    conflict = read_brief("A block of 100 by 100 m with 500 houses").conflicts[0]
    assert conflict.text == (
        "500 buildings of at least 50 m2 do not fit on 10000 m2; at most 150 do, or the city "
        "must be larger."
    )


def test_two_wishes_that_fight_are_both_named():
    conflict = read_brief("a church spire of 40 m and no building over 12 m").conflicts[0]
    assert conflict.text == (
        '"40 m" asks for a church of 40 m, but "over 12 m" allows no building above 12 m; '
        "change one."
    )


def test_an_option_holds_against_the_text_and_says_so():
    brief = read_brief("a foggy city of 400x400 m", options={"weather": "rain", "size": "600x400"})
    assert set(brief.items()) == {("weather", "rain"), ("size.x", 600.0), ("size.y", 400)}
    assert [conflict.code for conflict in brief.conflicts] == [
        "option_against_text:weather",
        "option_against_text:size.x",
    ]
    assert read_brief("a foggy city", options={"weather": "fog"}).conflicts == ()


def test_a_file_is_a_source_whether_or_not_it_is_named():
    assert slots("a modern town", inputs=[("a.osm", "osm")]) == {
        ("source", "osm"),
        ("style", "modern"),
    }
    brief = read_brief("Rebuild the OSM file.")
    assert [note.code for note in brief.notes if note.code == "no_such_input"] == ["no_such_input"]


def test_the_export_is_plain_and_names_what_was_not_read():
    record = read_brief("A frobnicated city at night, no cars.").to_json()
    assert record["unread"] == [{"text": "frobnicated", "span": [2, 13]}]
    assert record["negated"][0]["value"] == "vehicle"
    assert {type(item) for item in record.values()} <= {str, list}


def test_reading_imports_no_heavy_library_and_opens_no_socket(monkeypatch):
    def refused(*_: object, **__: object):
        raise AssertionError("a socket was opened")

    monkeypatch.setattr(socket, "socket", refused)
    read_brief("Make b01 red.", base=True)
    code = (
        "import sys; from cityx.language import read_brief; "
        "read_brief('a foggy city of ten houses'); "
        "print([n for n in ('lark', 'numpy', 'pandas', 'shapely', 'bpy') if n in sys.modules])"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"


def test_a_motorway_is_asked_for_with_its_lanes_and_where_it_leads():
    brief = read_brief("An elevated freeway with six lanes runs east to west across a city.")
    assert dict(brief.items()) == {
        "roads.motorways": 1, "roads.motorway.lanes": 6, "roads.motorway.axis": "east_west",
    }  # fmt: skip
    assert {"n(road, class=motorway, lanes=3) >= 1", "n(road, class=motorway) == 1"} <= {
        goal.predicate for goal in brief.goals
    }


def test_a_length_of_a_place_is_its_size_but_for_what_stands_behind_it():
    town = read_brief("a town of 600 m with a motorway")
    assert dict(town.items()) == {"size.x": 600, "size.y": 600, "roads.motorways": 1}
    towers = read_brief("a city of 300 m skyscrapers")
    assert dict(towers.items()) == {"building.height": 300, "building.type": "tower"}
