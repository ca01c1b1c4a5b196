import pytest
from talk import channel_of

from cityx.agents.models.brief_maker import ModelBriefMaker, brief_vocabulary, settled
from cityx.agents.roles import OfflineBriefMaker
from cityx.language import Brief, read_brief
from cityx.language.brief import GoalText, Slot

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


def test_numbers_of_the_rules_hold():
    brief, channel = read({"wishes": [wish("building.count", 99, "12 houses")]})
    assert brief.value("building.count") == read_brief(TEXT).value("building.count")
    assert "holds" in channel.notes[0]


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
    rules = (Slot("time", "noon", (0, 4), "noon"),)
    model = (Slot("time", "night", (5, 9), "dark"),)
    slots, notes = settled(rules, model, (), frozenset({"time"}))
    assert slots == model
    assert notes == (
        'time was read as noon by rules and night by the model ("dark"); night holds.',
    )
