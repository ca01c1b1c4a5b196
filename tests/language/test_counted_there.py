"""A number of things in one place is not the number of all such things in a city."""

import pytest

from cityx.language import read_brief


def predicates(text):
    return [goal.predicate for goal in read_brief(text).goals]


@pytest.mark.parametrize(
    ("text", "least"),
    [
        ("A town with a fountain in the square and four lamps around it", "n(streetlight) >= 4"),
        ("Five delivery riders outside the restaurant", "n(vehicle, type=bicycle) >= 5"),
    ],
)
def test_a_number_whose_place_is_open_is_the_least_there_is(text, least):
    assert least in predicates(text)
    assert least.replace(">=", "==") not in predicates(text)


@pytest.mark.parametrize(
    ("text", "commands"),
    [
        ("A town with six benches on the square and two in the park",
         ["put six benches on the square", "put two benches in the park"]),
        ("A statue in the park and another in front of the town hall",
         ["put a statue in front of the town hall"]),
        ("A bus stop in front of the school and one at the hospital",
         ["put a bus stop at the hospital"]),
    ],
)  # fmt: skip
def test_a_number_without_a_thing_is_of_the_thing_before(text, commands):
    assert sorted(one.text for one in read_brief(text).then) == sorted(commands)


def test_one_on_each_side_are_no_more():
    brief = read_brief("A town with three pubs, two by the river and one on the square")
    assert "n(building, tag=bar) == 3" in [goal.predicate for goal in brief.goals]
    assert not brief.then
    assert sum("(how many pubs)" in note.text for note in brief.notes) == 2


@pytest.mark.parametrize(
    ("text", "command", "unread"),
    [
        ("300 people on the square listening to a concert", "put 300 people on the square",
         ["listening", "concert"]),
        ("Tourists taking photos in front of the cathedral",
         "put Tourists in front of the cathedral", ["taking", "photos"]),
    ],
)  # fmt: skip
def test_people_are_put_where_they_do_what_nobody_can_do(text, command, unread):
    brief = read_brief(text)
    assert [one.text for one in brief.then] == [command]
    assert [text[slice(*span)] for span in brief.unread] == unread


@pytest.mark.parametrize(
    ("text", "predicate"),
    [
        ("A town with fountains", "n(fountain) >= 2"),
        ("A seaside town with piers", "n(pier) >= 2"),
        ("A town with parks", "n(park) >= 2"),
        ("A town with allotments", "n(allotments) >= 1"),
        ("A harbour with containers", "n(container) >= 1"),
    ],
)
def test_the_plural_of_a_thing_is_several(text, predicate):
    assert predicate in predicates(text)


def test_one_main_street_with_its_looks_is_the_only_one():
    assert "n(road, class=primary) == 1" in predicates("A suburb with one four-lane arterial")
    assert "n(road, class=primary) == 1" not in predicates("A suburb with a four-lane arterial")


@pytest.mark.parametrize(
    "text",
    [
        "A village with cottages, a chimney on every one",
        "A village of cottages, each with a chimney",
        "Every house has a chimney",
    ],
)
def test_a_part_of_every_house_is_on_nearly_each(text):
    assert "share(building, has=chimney) >= 0.95" in predicates(text)


def test_a_part_of_houses_is_on_most():
    assert "share(building, has=chimney) >= 0.5" in predicates("Houses with chimneys")


def test_another_kind_of_station_is_no_railway_station():
    brief = read_brief("A marathon with four water stations along the main street")
    assert not [slot for slot in brief.slots if slot.key.startswith("station")]
    assert any('"four"' in note.text for note in brief.notes)


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("A town with benches and lamps along the river.", "put benches and lamps along the river"),
        ("A village with lamps, benches and bins on the square.",
         "put lamps, benches and bins on the square"),
        ("A town with a church and six benches on the square.", "put six benches on the square"),
        ("A town with ten oaks and five limes in the park.",
         "put ten oaks and five limes in the park"),
    ],
)  # fmt: skip
def test_furniture_that_is_listed_stands_at_one_place(text, command):
    assert [one.text for one in read_brief(text).then] == [command]


@pytest.mark.parametrize(
    ("text", "key", "word"),
    [
        ("A town with houses on three sides of the square.", "house.count", "three"),
        ("A village with three taller houses by the river.", "", "taller"),
        ("A town with two wider streets.", "roads.count", "wider"),
        ("A town with a park larger than the square.", "", "larger than"),
        ("A town where cars park along the street.", "element", "cars park"),
    ],
)
def test_what_is_no_number_or_has_no_measure_is_named(text, key, word):
    brief = read_brief(text)
    assert key not in {slot.key for slot in brief.slots}
    assert not [goal for goal in brief.goals if "house" in goal.predicate and "== 3" in
                goal.predicate]  # fmt: skip
    assert any(word in one for one in [*brief.words_unread, *(note.text for note in brief.notes)])
