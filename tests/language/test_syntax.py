"""Words belong to the noun phrase they stand in: three sentences of each kind."""

import time

import pytest

from cityx.language import read_brief


def keys(text):
    return {slot.key for slot in read_brief(text).slots}


def values(text):
    return {str(slot.value) for slot in read_brief(text).slots}


def told(text):
    """Return what a text leaves unread or open, as one string."""
    brief = read_brief(text)
    left = [note.text for note in brief.notes if note.code == "left_open"]
    return " ".join((*brief.words_unread, *left))


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("A motorway with 4 m high noise barriers", "4 m"),
        ("A district with an evacuation route 10 m wide", "10 m"),
        ("Offices, a causeway 200 m long and a park", "200 m"),
        ("A settlement of houses with a chimney 60 m high", "60 m"),
        ("A street with speed bumps every 50 m", "50 m"),
        ("Snow 10 cm deep on the roofs", "10 cm"),
        ("A village with mud walls 2.5 m high", "2.5 m"),
    ],
)
def test_a_measure_of_an_unknown_thing_is_of_nothing_else(text, number):
    ends = ("height", "width", "length", "spacing", "size.x", "size.y", ".min", ".max")
    assert not any(key.endswith(ends) for key in keys(text))
    assert number in told(text)


@pytest.mark.parametrize(
    "text",
    [
        "An empty plot of 40 x 60 m between two office blocks",
        "An industrial estate: six sheds of 40 x 20 m",
        "Villas on plots of 1000 m2",
    ],
)
def test_the_size_of_a_plot_or_a_shed_is_not_that_of_the_site(text):
    assert not any(key.startswith("size") for key in keys(text))


@pytest.mark.parametrize(
    "text",
    [
        "A village of 300 x 300 m with a church",
        "Houses and gardens, 300 x 300 m",
        "A 300 x 300 m site with towers",
    ],
)
def test_a_measure_of_the_town_or_alone_is_the_size_of_the_site(text):
    assert {"size.x", "size.y"} <= keys(text)


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("A village with less than 40 houses", "building.count.max", 39),
        ("More than 200 trees", "tree.count.min", 201),
        ("Houses under four floors", "building.floors.max", 3),
    ],
)
def test_less_than_a_number_does_not_reach_it(text, key, value):
    assert read_brief(text).value(key) == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("Church bells ring in an old town", "church"),
        ("A village where bridge players meet", "bridge"),
        ("A town with park rangers", "park"),
        ("School buses in the streets", "school"),
        ("A training set for drones in a town", "train"),
        ("A town where a hotel lobby burns", "hotel"),
    ],
)
def test_what_modifies_another_noun_is_no_thing_of_its_own(text, value):
    assert value not in values(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("A town with a pumping station", "station"),
        ("Houses and an ambulance bay", "sea"),
        ("A quarter with swimming pools", "pond"),
        ("A stop sign at the corner", "billboard"),
    ],
)
def test_a_noun_of_many_meanings_is_not_claimed_behind_an_unknown_word(text, value):
    assert value not in values(text)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("Dark red houses", "dark"),
        ("A quarter of mostly two floors", "mostly"),
        ("Old stone houses", "Old"),
        ("Towers above a shopping arcade", "above"),
        ("Bikes parked in a village", "parked"),
    ],
)
def test_what_is_said_and_not_built_is_told(text, word):
    assert word in told(text)


@pytest.mark.parametrize(
    "text",
    [
        "Low houses in front and towers of 40 floors behind",
        "Brick warehouses on one bank, white flats on the other",
        "A village with a farm and a hotel of 15 floors",
    ],
)
def test_what_is_said_of_one_type_is_not_said_of_all(text):
    wrong = ("building.floors", "building.material", "building.color", "building.height")
    assert not any(key.startswith(wrong) for key in keys(text))


@pytest.mark.parametrize(
    "text",
    [
        "At least 80 buildings, a third of them taller than 15 m",
        "The tallest building is in the middle, no other over 40 m",
        "Houses, half of them up to 9 m high",
    ],
)
def test_a_height_of_some_is_no_height_of_all(text):
    assert not any(key.startswith("building.height") for key in keys(text))


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("Houses of two or three floors", "building.floors.max", 3),
        ("Towers of 200 m and more", "building.height.min", 200),
        ("A village in the rain at 8 in the morning", "time", "08:00"),
    ],
)
def test_bounds_and_hours_in_other_wordings(text, key, value):
    assert read_brief(text).value(key) == value


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A business park with offices on the east side", "park.side"),
        ("A river town, warehouses on the south bank", "river.side"),
        ("A square and north winds", "plaza.side"),
    ],
)
def test_a_side_places_what_it_stands_with(text, key):
    assert key not in keys(text)


@pytest.mark.parametrize(
    "text",
    ["40 houses, at most 30 buildings", "Houses of 12 floors, at most 5 floors, brick",
     "Streets 10 m wide, streets at most 8 m wide"],
)  # fmt: skip
def test_an_exact_number_above_a_bound_is_a_contradiction(text):
    assert read_brief(text).conflicts


def test_reading_stays_linear():
    text = "A village of 300 houses with a saloon 12 m high, church bells and a river 20 m wide. "
    took = []
    for times in (10, 60):
        begun = time.process_time()
        read_brief(text * times)
        took.append(time.process_time() - begun)
    assert took[1] < 20 * max(took[0], 0.01)


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("70 % houses, 20 % shops and 10 % offices", "office.share", 0.1),
        ("Half of the houses of brick, a church", "brick.share", 0.5),
        ("A third of the buildings are shops", "shop.share", 0.3333),
    ],
)
def test_a_share_is_of_what_stands_behind_it(text, key, value):
    assert read_brief(text).value(key) == value


@pytest.mark.parametrize(
    "text",
    [
        "Two thirds of the houses have flat roofs",
        "Half of the houses with shops at street level",
        "A third of the houses are red",
    ],
)
def test_what_is_said_of_a_part_is_not_said_of_all(text):
    assert not keys(text) & {"building.roof", "building.feature", "building.color"}


@pytest.mark.parametrize(
    ("text", "denied"),
    [
        ("Floodplains without houses along a river", "house"),
        ("A town with a park without trees", "tree"),
        ("Two squares without fountains", "fountain"),
    ],
)
def test_what_one_thing_is_to_be_without_is_not_denied_everywhere(text, denied):
    assert denied not in {slot.value for slot in read_brief(text).negated}


@pytest.mark.parametrize(
    ("text", "people"),
    [
        ("A town for 5000 people", 5000),
        ("A village of 300 people with a church", 300),
        ("A city for 20,000 people, dense", 20000),
    ],
)
def test_people_that_a_town_is_for_live_there(text, people):
    assert read_brief(text).value("population") == people


@pytest.mark.parametrize(
    "text",
    [
        "A baroque church with two towers in a village",
        "A mosque with four minarets in a town",
        "A castle with three towers above a village",
    ],
)
def test_towers_of_one_building_are_no_buildings(text):
    counts = {key for key in keys(text) if key.endswith("count")}
    assert counts <= {"church.tower.count", "mosque.minaret.count", "castle.tower.count"}
    assert "tower" not in values(text)


def test_minarets_of_a_mosque_are_counted_as_its_parts():
    brief = read_brief("A mosque with four minarets in a town")
    assert brief.value("mosque.minaret.count") == 4
    assert not {"building.count", "tower.count"} & set(keys(brief.text))


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("Houses with stepped gables", "stepped"),
        ("A town with an elevated railway", "elevated"),
        ("A street with balloon stops", "stops"),
        ("A mining settlement", "mining"),
        ("A rail siding behind the station", "siding"),
        ("Kerbside parking in a village", "parking"),
        ("Bus lanes in both directions", "both directions"),
    ],
)
def test_words_for_commands_and_forms_of_others_are_told(text, word):
    assert word in told(text)


@pytest.mark.parametrize(
    "text",
    [
        "No house taller than the church, narrow lanes",
        "No tower higher than the cathedral",
        "No road wider than the river",
    ],
)
def test_what_is_compared_is_not_denied(text):
    brief = read_brief(text)
    assert not brief.negated
    assert not brief.conflicts


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("Two villages 500 m apart", "500 m"),
        ("Stilt houses 3 m above the water", "3 m"),
        ("1 km of river bank with cafes", "1 km"),
        ("Light rail with stops every 400 m", "400 m"),
    ],
)
def test_distances_and_lengths_of_others_are_left_open(text, number):
    ends = ("height", "width", "spacing", "size.x", "size.y")
    assert not any(key.endswith(ends) for key in keys(text))
    assert number in told(text)


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("Row houses with red, yellow and green doors", "building.color"),
        ("Villas with blue and white gates", "building.color"),
        ("Terraced houses with brick and stone archways", "building.material"),
    ],
)
def test_looks_in_a_row_are_of_the_noun_behind_the_last(text, key):
    assert key not in keys(text)
    assert "look of the" in told(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("A car-sharing station in a village", "medium"),
        ("A town with an industrial canal", "industrial"),
        ("A bicycle highway 4 m wide", "bicycle"),
    ],
)
def test_words_before_another_noun_say_nothing_of_the_town(text, value):
    assert value not in values(text)


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("the minaret, which is 22 m", "mosque.height", 22),
        ("quarter past three on a drizzly afternoon", "time", "15:15"),
        ("a town with churches and museums", "church.count.min", 2),
        ("lanes should be narrow, maximum 4 m", "roads.width.max", 4),
        ("houses: narrow, gabled, 3 to 5 floors", "building.floors.max", 5),
        ("hills: none", "terrain", "flat"),
    ],
)
def test_what_a_word_belongs_to_is_told_by_its_sentence(text, key, value):
    assert (key, value) in read_brief(text).items()


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("a levee, 3 m, along the river", "building.height"),
        ("Airstrip, 1200 m", "building.height"),
        ("A town square at eight", "plaza.count"),
        ("30 cars on 23rd Avenue", "roads.avenues"),
        ("canals: 4, parallel, north-south", "roads.main.axis"),
        ("600 vehicles an hour", "vehicle.count"),
        ("a bus with hazard lights on", "lights"),
        ("50 people carrying lanterns go to the square", "element=streetlight"),
        ("Cars should not drive in the lanes", "traffic"),
        ("no house is nearer than 50 metres to the lake", "not=house"),
        ("no roof that isn't flat", "not=apartment"),
    ],
)
def test_what_belongs_to_something_else_is_left_open(text, key):
    brief = read_brief(text)
    told = {one for pair in brief.items() for one in (pair[0], f"{pair[0]}={pair[1]}")}
    assert key not in told
    assert brief.words_unread or brief.notes


@pytest.mark.parametrize(
    "text", ["Number of trees: zero", "Trees: none", "no trees are wanted", "trees nowhere"]
)
def test_denials_may_stand_behind(text):
    assert ("not", "tree") in read_brief(text).items()


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("No office above 11 m", "office.height.max", 11),
        ("All towers between 60 and 90 m", "tower.height.min", 60),
        ("No house taller than two storeys", "house.floors.max", 2),
        ("every house has at most 2 floors", "house.floors.max", 2),
    ],
)
def test_a_bound_of_all_of_a_kind_is_of_that_kind_alone(text, key, value):
    brief = read_brief(text)
    assert (key, value) in brief.items()
    assert not any(name.startswith("building.height") for name, _ in brief.items())
    assert brief.words_unread == ()


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("No two houses of the same colour", "houses"),
        ("no two towers alike", "towers"),
    ],
)
def test_what_several_share_or_some_look_like_is_left_open(text, word):
    brief = read_brief(text)
    assert any(word in note.text for note in brief.notes)
    assert not any(key == "not" for key, _ in brief.items())


@pytest.mark.parametrize(
    ("text", "denied"),
    [
        ("nothing on the squares", "plaza"),
        ("nobody on the pavements", "sidewalk"),
        ("no building more high than 12 m", "building"),
        ("no trees within 30 m of the runway", "tree"),
        ("none of the houses is tall", "house"),
    ],
)
def test_a_denial_of_some_denies_not_all(text, denied):
    brief = read_brief(text)
    assert ("not", denied) not in brief.items()
    assert brief.words_unread or brief.notes


@pytest.mark.parametrize("text", ["two disabled parking bays", "6) a supermarket", "3) a pond"])
def test_numbers_of_lists_and_of_what_nobody_counts_count_nothing(text):
    assert not any(key.endswith(".count") for key, _ in read_brief(text).items())
