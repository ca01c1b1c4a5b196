"""Looks and measures of one kind of building are of that kind alone."""

import pytest

from cityx.language import read_brief


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("A town of brick houses with a white church", ("church.color", "white")),
        ("Houses and a mosque with a red roof", ("mosque.roof_color", "red")),
        ("Villas and grand hotels in yellow stucco", ("hotel.color", "yellow")),
        ("Villas and grand hotels in yellow stucco", ("hotel.material", "plaster")),
        ("Houses with red roofs and warehouses with blue roofs", ("warehouse.roof_color", "blue")),
        ("glass-fronted offices and whitewashed cottages", ("office.material", "glass")),
        ("Houses of 2 floors and offices of 8 floors", ("office.floors", 8)),
    ],
)
def test_a_look_is_of_its_kind_alone(text, told):
    brief = read_brief(text)
    assert told in brief.items()
    assert not any(key == f"building.{told[0].partition('.')[2]}" and value == told[1]
                   for key, value in brief.items())  # fmt: skip
    kind, look = told[0].split(".")
    assert any(("building" in one.predicate and str(told[1]) in one.predicate) or look == "floors"
               for one in brief.goals), kind  # fmt: skip


@pytest.mark.parametrize("text", ["The tower gets a red roof", "the house is red"])
def test_a_look_of_one_that_is_not_built_is_left_open(text):
    brief = read_brief(text)
    assert brief.items() == []
    assert any("red" in note.text for note in brief.notes)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("about fifty two-storey houses", {"building.count": 50, "building.floors": 2}),
        ("two hundred fifty-storey towers", {"building.count": 200, "building.floors": 50}),
        ("thirty-one three-storey houses", {"building.count": 31, "building.floors": 3}),
        ("apartments to be G+7", {"building.floors": 8}),
        ("offices of G+11 floors", {"building.floors": 12}),
        ("seven out of ten houses of brick", {"brick.share": 0.7}),
        ("1 in 4 houses of wood", {"timber.share": 0.25}),
        ("nine in every ten buildings of stone", {"stone.share": 0.9}),
        ("Quarter past three, school's out", {"time": "15:15"}),
        ("Half past two in the night", {"time": "02:30"}),
    ],
)
def test_numbers_are_read_with_what_they_are_of(text, told):
    items = dict(read_brief(text).items())
    assert {key: items.get(key) for key in told} == told


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("a nine-hole golf course", "golf_course.count"),
        ("Half a metre to the pixel", "building.height"),
        ("a south-westerly wind of 12 m/s", "vehicle.speed"),
        ("rubble blocking six streets", "roads.count"),
        ("a village, one farmhouse on fire", "building.count"),
        ("villas, each on a plot of 800 m2", "size.area"),
        ("three mineral springs", "season"),
        ("a car park below ground", "element"),
        ("a ring wall", "roads.rings"),
        ("Navy day on the river", "building.color"),
        ("The parade walks along the English Embankment in the town", "style"),
        ("a town with a convenience store on a corner", "building.use"),
        ("nine lorries, lights off", "lights"),
        ("a bridge closed to cars", "not"),
        ("a harbour cleared of boats", "agent"),
    ],
)
def test_words_of_something_else_say_nothing_of_the_city(text, key):
    brief = read_brief(text)
    assert not any(one == key for one, _ in brief.items())
    assert not (key == "not" and brief.negated)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("nothing moving on the streets", "nothing"),
        ("zero asphalt", "asphalt"),
        ("One sauna shall stand at the centre", "sauna"),
        ("rusty red roofs", "rusty"),
        ("three hundred people on it, the bridge", "on"),
    ],
)
def test_no_word_is_lost(text, word):
    brief = read_brief(text)
    assert word in " ".join((*brief.words_unread, *(note.text for note in brief.notes)))


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("student dorms for 500, a campus with houses", "building.count"),
        ("six lecture buildings around a lawn", "building.count"),
        ("a town, EPSG:25832", "building.count"),
        ("houses, ten centimetres on the roofs", "building.height"),
        ("a crossing where two main roads meet", "roads.main.count"),
        ("the main road has been cleared", "weather"),
        ("a map with a 1 m grid", "roads.pattern"),
        ("villages on the flood plain", "terrain"),
        ("one winding road to the church", "roads.pattern"),
        ("The wall has four gates and eight round towers", "building.count"),
        ("leave anything above 600 m as forest", "size.x"),
        ("land where nobody has built any houses", "not"),
        ("in the file red is shops, green is park", "building.color"),
    ],
)
def test_what_is_of_a_part_or_another_kind_is_not_of_the_town(text, key):
    brief = read_brief(text)
    assert not any(one.startswith(key) for one, _ in brief.items())
    assert not (key == "not" and brief.negated)


def test_a_colour_is_of_its_own_noun():
    items = read_brief("the walls are white and the roofs are red").items()
    assert ("building.color", "white") in items
    assert ("roof.color", "red") in items
    assert ("roof.color", "white") not in items


def test_a_number_is_of_its_own_kind_where_several_are_named():
    assert ("house.count", 40) in read_brief("40 houses in all and some garages").items()


@pytest.mark.parametrize(
    ("text", "form"),
    [
        ("Make all roofs flat.", "flat"),
        ("A village. Roofs should be flat.", "flat"),
        ("The roofs are flat and the walls white.", "flat"),
        ("Every roof is gabled.", "gabled"),
        ("Roofs must be pitched.", "gabled"),
    ],
)
def test_what_is_said_of_the_roofs_is_of_all_buildings(text, form):
    brief = read_brief(text)
    assert brief.value("building.roof") == form
    assert not brief.unread


@pytest.mark.parametrize(
    ("said", "count"),
    [("Forty-ish", 40), ("40ish", 40), ("A couple of dozen", 24), ("A couple of hundred", 200)],
)
def test_rounded_counts_are_numbers(said, count):
    assert read_brief(f"{said} cottages.").value("building.count") == count


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("Six office blocks (5 to 7 floors) and one hotel of 12 floors.",
         {"office.floors.min": 5, "office.floors.max": 7, "hotel.floors": 12}),
        ("Ten villas of at most 2 floors, a castle 25 m high.",
         {"villa.floors.max": 2, "castle.height": 25}),
        ("Avenues lined with plane trees.", {"nature.species.streets": "plane"}),
        ("Cyclists outnumber cars three to one.", {"bicycle.share": 0.75}),
    ],
)  # fmt: skip
def test_what_is_said_of_one_kind_is_not_of_all(text, told):
    brief = read_brief(text)
    assert told.items() <= dict(brief.items()).items()
    assert not brief.conflicts
