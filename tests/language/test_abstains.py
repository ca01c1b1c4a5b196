"""What is not understood is listed, not bent into something else: three sentences of each kind."""

import pytest

from cityx.language import read_brief


def keys(text):
    return {slot.key for slot in read_brief(text).slots}


@pytest.mark.parametrize(
    "word", ["steam", "sidings", "scraps", "parts", "vents", "holographic", "stoops", "heath"]
)
def test_an_english_word_is_not_mended_to_another(word):
    brief = read_brief(f"A town with {word}")
    assert not [note for note in brief.notes if note.code == "spelling"]


@pytest.mark.parametrize(
    ("slip", "meant"),
    [("skyscarpers", "skyscrapers"), ("weathr", "weather"), ("bridgge", "bridge")],
)
def test_what_is_no_word_is_mended_with_a_note(slip, meant):
    notes = read_brief(f"A town, {slip}").notes
    assert f'"{slip}" was read as "{meant}".' in [note.text for note in notes]


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A long straight avenue, at least 1.5 km, at night", "roads.main.length.min"),
        ("A motorway, no less than 900 m, and a few farms", "roads.motorway.length.min"),
        ("One main street, at most 400 m, no trees", "roads.main.length.max"),
    ],
)
def test_a_length_behind_a_street_is_that_of_the_street(text, key):
    assert key in keys(text)
    assert not any(one.startswith("building.height") for one in keys(text))


@pytest.mark.parametrize(
    "text", ["113 m blocks", "Blocks of 80 m, 5 floors", "A grid of 120 m blocks with courtyards"]
)
def test_the_size_of_blocks_is_not_that_of_the_site(text):
    assert not any(key.startswith("size") for key in keys(text))


@pytest.mark.parametrize(
    "text",
    [
        "Streets under half a metre of water",
        "A quarter with 2 m of water in the streets",
        "The square lies under 40 cm of water",
    ],
)
def test_a_depth_of_water_is_no_width(text):
    assert not any("width" in key or "height" in key for key in keys(text))


@pytest.mark.parametrize(
    "text", ["lamps every 25 m", "A bench every 20 m along the river", "bollards every 3 m"]
)
def test_only_trees_are_spaced_as_trees(text):
    assert "nature.spacing" not in keys(text)


@pytest.mark.parametrize(
    "text",
    [
        "A street with abandoned cars",
        "Abandoned houses and one taxi",
        "A town with abandoned buses in the streets",
    ],
)
def test_a_state_of_things_denies_nothing(text):
    brief = read_brief(text)
    assert not brief.conflicts
    assert not brief.negated


@pytest.mark.parametrize(
    ("text", "wet"),
    [
        ("It has just stopped raining", "high"),
        ("A town after the rain", "high"),
        ("The storm has passed", None),  # of which rain is no part that was told
        ("The morning after the hurricane", None),
    ],
)
def test_weather_that_is_over_is_not_there(text, wet):
    brief = read_brief(text)
    assert brief.value("weather") is None
    assert brief.value("wetness") == wet


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A site for a heat-island study", "element"),
        ("A zorb-park test area", "element"),
        ("A qubit-bridge demo", "element"),
    ],
)
def test_the_end_of_an_unknown_compound_is_no_thing(text, key):
    assert key not in keys(text)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("Two parallel rivers", "parallel"),
        ("A long avenue with shops", "long"),
        ("Slender villas on a slope", "Slender"),
        ("Towers behind the houses", "behind"),
    ],
)
def test_words_that_carry_a_meaning_are_read_or_listed(text, word):
    brief = read_brief(text)
    left = " ".join(note.text for note in brief.notes if note.code == "left_open")
    assert word in (*brief.words_unread, *left.replace('"', " ").split())


@pytest.mark.parametrize(
    "text",
    [
        "12 by 8 blocks, every block 100 m x 60 m",
        "A foggy street in the 1890s",
        "A parking lot for 200 cars",
        "Fewer than 5 buildings over 50 m tall",
        "An avenue with two rows of trees",
        "A square at the corner of the two biggest streets",
        "50 plots of 400 m2 each",
        "One tree per house",
        "A street past a school, speed limit 30",
    ],
)
def test_numbers_of_other_things_are_no_measures_of_the_city(text):
    ends = ("count", "height", "size", "min", "max", ".x", ".y")
    assert not any(key.endswith(ends) for key in keys(text))


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("A cathedral 60 m high", "cathedral"),
        ("Two water towers 35 m high", "water_tower"),
        ("A lighthouse of 30 m", "lighthouse"),
    ],
)
def test_the_height_of_one_thing_is_that_of_no_other(text, kind):
    assert f"{kind}.height" in keys(text)
    assert "building.height" not in keys(text)


@pytest.mark.parametrize(
    "text",
    [
        "A quarter north of the river",
        "The market is east of the railway",
        "South of the park: towers",
    ],
)
def test_a_side_of_one_thing_moves_it_not(text):
    assert not any(key.endswith(".side") for key in keys(text))


@pytest.mark.parametrize(
    "text",
    [
        "A fountain in the middle",
        "One castle in the center",
        "a church at the centre of the village",
    ],
)
def test_elements_may_stand_in_the_middle(text):
    assert "middle" in [slot.value for slot in read_brief(text).slots]


@pytest.mark.parametrize(
    "text",
    ["No through traffic", "No shops in the residential area"],
)
def test_a_denial_of_some_is_no_denial_of_all(text):
    assert not read_brief(text).negated


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("Red doors", "building.color"),
        ("Around a green quad", "building.color"),
        ("Gabled roofs and blue gates", "roof.color"),
        ("A river from east to west", "roads.main.axis"),
    ],
)
def test_a_look_goes_to_its_own_thing(text, key):
    assert key not in keys(text)


def test_from_so_many_up_is_a_least_number():
    brief = read_brief("40 houses from 2 floors up")
    assert brief.value("building.floors.min") == 2
    assert brief.value("building.floors") is None


@pytest.mark.parametrize(
    "text",
    [
        "The park wants 8 benches and a path round the pond",
        "In front of the supermarket: solar roofs above the parking bays",
        "Third bridge, footbridge only, halfway between the existing two",
        "Swap the roof of the town hall for a dome and stand a clock tower beside it",
    ],
)
def test_a_command_about_objects_that_is_not_taken_whole_is_asked_about(text):
    brief = read_brief(text, base=True)
    assert brief.questions
    assert not any(key.startswith(("element", "building.")) for key, _ in brief.items())
