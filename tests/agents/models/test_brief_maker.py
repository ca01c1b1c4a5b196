import pytest
from talk import channel_of

from cityx.agents.models.brief_maker import ModelBriefMaker, brief_vocabulary, told
from cityx.agents.roles import OfflineBriefMaker
from cityx.language import Brief, read_brief
from cityx.language.brief import GoalText

# "Big Apple feel" and "drizzling mood" are in no phrase book.
TEXT = "A quarter with a Big Apple feel,\nwhite walls and 12 houses."


def read(*answers, text=TEXT, seen=None, base=False, options=None):
    channel = channel_of(*answers, seen=seen)
    maker = ModelBriefMaker(channel, OfflineBriefMaker())
    return maker.read(text, base=base, options=options), channel


def wish(key, value, quote):
    return {"key": key, "value": value, "quote": quote}


def test_the_model_reads_what_the_rules_did_not():
    brief, channel = read({"wishes": [wish("style", "american", "Big Apple feel")]})
    assert brief.value("style") == "american"
    (slot,) = [slot for slot in brief.slots if slot.key == "style"]
    assert slot.text == "Big Apple feel"
    assert TEXT[slice(*slot.span)] == slot.text
    assert all(isinstance(goal, GoalText) for goal in brief.goals)
    assert len(brief.goals) > len(read_brief(TEXT).goals)
    assert not any("Apple" in word for word in brief.words_unread)
    assert channel.notes == []


def test_a_number_that_the_quoted_words_do_not_say_goes_back():
    seen = []
    wrong = {"wishes": [wish("building.count", 99, "12 houses")]}
    brief, _ = read(wrong, {"wishes": []}, seen=seen)
    assert '"12 houses" does not say 99.' in str(seen[1][0])
    assert brief.value("building.count") == 12


@pytest.mark.parametrize(
    ("text", "quote", "key", "value"),
    [
        ("A vineyard town, 2 ha", "2 ha", "size.area", 20_000),
        ("Half a kilometre of main street", "Half a kilometre", "size.x", 500),
        ("Two dozen Alpine huts", "Two dozen", "building.count", 24),
        ("Streets at 30 km/h", "30 km/h", "roads.speed", 30 / 3.6),
    ],
)
def test_numbers_are_said_in_any_unit(text, quote, key, value):
    brief, _ = read({"wishes": [wish(key, value, quote)]}, text=text)
    assert brief.value(key) == pytest.approx(value)


def test_a_model_takes_back_what_the_rules_misread_and_says_it_right():
    text = "Offices by the river, at least five floors, no glass."
    lines = [slot.key for slot in read_brief(text).slots]
    answer = {
        "wrong": [lines.index("element") + 1],
        "wishes": [
            {**wish("building.floors", 5, "at least five floors"), "bound": "at_least"},
            {**wish("building.material", "glass", "no glass"), "denied": True},
        ],
    }
    brief, channel = read(answer, text=text)
    assert brief.values("element") == ()
    assert brief.value("building.floors.min") == 5
    assert [slot.value for slot in brief.negated] == ["glass"]
    assert 'The model took back element = river ("river").' in channel.notes
    assert not any("river" in goal.predicate for goal in brief.goals)


def test_a_contradiction_of_the_rules_is_gone_with_the_line_that_made_it():
    text = "Snow at 20 degrees Celsius"
    rules = read_brief(text)
    assert rules.conflicts
    line = [slot.key for slot in rules.slots].index("temperature") + 1
    brief, _ = read({"wishes": [], "wrong": [line]}, text=text)
    assert not brief.conflicts
    assert "contradiction" in told(rules)


def test_a_line_that_is_none_goes_back():
    seen = []
    brief, _ = read({"wishes": [], "wrong": [40]}, {"wishes": []}, seen=seen)
    assert "There is no line 40." in str(seen[1][0])
    assert brief.slots == read_brief(TEXT).slots


def test_goals_of_files_stay():
    channel = channel_of({"wishes": [wish("style", "american", "Big Apple feel")]})
    maker = ModelBriefMaker(channel, OfflineBriefMaker())
    brief = maker.read(f"{TEXT} As in the map.", inputs=[("town.osm", "osm")])
    assert any("town.osm" in goal.predicate for goal in brief.goals)


def test_elements_are_counted_and_placed_by_a_model():
    text = "Worship for the faithful at three places up north"
    wishes = [wish("church.count", 3, "three places"), wish("church.side", "north", "up north")]
    brief, _ = read({"wishes": wishes}, text=text)
    assert brief.value("church.count") == 3
    assert brief.value("church.side") == "north"


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (wish("colour_scheme", "american", "Big Apple"), 'There is no key "colour_scheme"'),
        (wish("style", "new_york", "Big Apple"), "is none of"),
        (wish("style", "american", "Manhattan"), "The text does not say"),
        (wish("population", "many", "Big Apple"), "is no number"),
    ],
)
def test_what_is_not_of_the_vocabulary_or_the_text_goes_back(wrong, said):
    seen = []
    right = {"wishes": [wish("style", "american", "big apple")]}
    brief, _ = read({"wishes": [wrong]}, right, seen=seen)
    assert said in str(seen[1][0])
    assert brief.value("style") == "american"


def test_a_model_that_will_not_learn_leaves_the_rules():
    wrong = {"wishes": [wish("run_python", "import os", "Big Apple")]}
    brief, channel = read(wrong)
    assert brief == read_brief(TEXT)
    assert "Done offline instead." in channel.notes[0]


def test_what_the_text_denies_is_not_wanted():
    text = "A town without rivers."
    brief, channel = read({"wishes": [wish("element", "river", "rivers")]}, text=text)
    assert brief.values("element") == read_brief(text).values("element")
    assert "not to have" in channel.notes[0]


def test_options_hold_against_a_model():
    brief, _ = read(
        {"wishes": [wish("style", "american", "Big Apple")]}, options={"style": "japanese"}
    )
    assert brief.value("style") == "japanese"


def test_changes_of_a_city_are_read_by_rules_alone():
    seen = []
    brief, _ = read({"wishes": []}, text="Remove the tallest building.", base=True, seen=seen)
    assert isinstance(brief, Brief)
    assert seen == []


def test_the_schema_lists_the_keys():
    seen = []
    read({"wishes": []}, seen=seen)
    schema = seen[0][1].model_request_parameters.output_object.json_schema
    keys = schema["$defs"]["Wish"]["properties"]["key"]["enum"]
    assert {"style", "weather", "building.count"} <= set(keys)
    assert "source" not in keys


def test_words_of_every_key_are_closed():
    vocabulary = brief_vocabulary()
    assert "river" in vocabulary.words["element"]
    assert "tower" in vocabulary.words["building.type"]
    assert vocabulary.fault("building.height", "tall") == ""
    assert vocabulary.fault("building.height", 30.0) == ""
    assert vocabulary.fault("size.x", "wide").endswith("is no number.")
    assert vocabulary.fault("population", True) != ""


def test_a_word_of_the_model_holds_where_a_key_has_one_value():
    brief, channel = read({"wishes": [wish("time", "night", "dark")]}, text="Noon, but dark")
    assert brief.values("time") == ("night",)
    assert channel.notes == [
        'time was read as noon by rules and night by the model ("dark"); night holds.'
    ]
