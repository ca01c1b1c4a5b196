"""Streets closed to cars, maps that stay as they are, and people on their way."""

import pytest

from cityx.language import read_brief

MAP = (("m.osm", "osm"),)


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("The map with the high street closed to cars.", "close the high street to cars"),
        ("A village where the main street is closed to traffic.", "close the main street to cars"),
        ("The map, but the longest street is car-free.", "close the longest street to cars"),
        ("A town with a car-free main street.", "close the main street to cars"),
        ("Use the map, and close all streets to cars.", "close all streets to cars"),
    ],
)
def test_a_street_that_is_told_to_be_closed_is_closed_alone(text, command):
    brief = read_brief(text, inputs=MAP)
    assert [one.text for one in brief.then] == [command]
    assert not brief.negated


def test_what_follows_cars_is_not_barred():
    brief = read_brief("A town with streets closed to cars and lorries, and a fountain.")
    assert {slot.value for slot in brief.negated} == {"vehicle", "truck"}
    assert brief.value("element") == "fountain"


@pytest.mark.parametrize(
    "text", ["Build this exactly as mapped.", "Use the map as it is.", "The map unchanged."]
)
def test_a_map_as_it_is_leaves_nothing_open(text):
    brief = read_brief(text, inputs=MAP)
    assert not brief.words_unread
    assert not brief.kept
    assert [value for key, value in brief.items() if key == "source"] == ["osm"]


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("A town. Everybody walks to the park.", "put Everybody walks to the park"),
        ("200 people leave the church and walk to the park at dusk.",
         "put 200 people leave the church and walk to the park"),
        ("A village; everyone leaves the school and walks to the square.",
         "put everyone leaves the school and walks to the square"),
    ],
)  # fmt: skip
def test_people_on_their_way_are_sent_once(text, command):
    assert [one.text for one in read_brief(text).then] == [command]
