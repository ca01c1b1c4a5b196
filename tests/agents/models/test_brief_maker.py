import json
from pathlib import Path

import pytest
from talk import channel_of

from cityx.agents.models.brief_maker import (
    ModelBriefMaker,
    counted_together,
    is_of_unnamed_few,
    told,
)
from cityx.agents.roles import OfflineBriefMaker
from cityx.language import read_brief
from cityx.language.brief import GoalText
from cityx.language.scene import Scene, kinds_of, pairs_of, scene_of

# Sentences of people who had read the README alone, and scenes that were answered by hand from the
# prompts alone.
RECORDED = json.loads(
    (Path(__file__).parent / "recorded" / "scenes.json").read_text(encoding="utf-8")
)

# "Big Apple feel" and "drizzling mood" are in no phrase book.
TEXT = "A quarter with a Big Apple feel,\nwhite walls and 12 houses."
LIKE_NEW_YORK = {"quarters": [{"style": "american", "said": ["Big Apple feel"]}]}


def read(*answers, text=TEXT, seen=None, base=False, options=None):
    channel = channel_of(*answers, seen=seen)
    maker = ModelBriefMaker(channel, OfflineBriefMaker())
    return maker.read(text, base=base, options=options), channel


def scene(text=TEXT, **more):
    """The rules' reading of a text, with items added to it."""
    found = scene_of(read_brief(text)).told()
    quotes = " ".join(quote for items in more.values() for item in items for quote in item["said"])
    found["unread"] = [word for word in found.get("unread", ()) if word not in quotes]
    return {**found, **{group: found.get(group, []) + items for group, items in more.items()}}


def exactly(number):
    return {"at_least": number, "at_most": number}


def test_the_model_reads_what_the_rules_did_not():
    brief, channel = read(scene(**LIKE_NEW_YORK))
    assert brief.value("style") == "american"
    (slot,) = [slot for slot in brief.slots if slot.key == "style"]
    assert slot.text == "Big Apple feel"
    assert TEXT[slice(*slot.span)] == slot.text
    assert all(isinstance(goal, GoalText) for goal in brief.goals)
    assert len(brief.goals) > len(read_brief(TEXT).goals)
    assert not any("Apple" in word for word in brief.words_unread)
    assert channel.notes == []


def test_the_same_scene_changes_nothing():
    brief, channel = read(scene())
    assert brief == read_brief(TEXT)
    assert channel.notes == []


def test_what_the_model_leaves_out_is_gone_and_its_words_are_listed():
    found = scene()
    found.pop("buildings")
    brief, channel = read(found)
    assert brief.value("building.count") is None
    assert any("houses" in word for word in brief.words_unread)
    assert 'The model took back building.count = 12 ("12 houses").' in channel.notes
    assert not any("building" in goal.predicate for goal in brief.goals)


def test_a_number_that_the_quoted_words_do_not_say_goes_back():
    seen = []
    wrong = {"buildings": [{"kind": "house", "count": exactly(99), "said": ["12 houses"]}]}
    brief, _ = read(wrong, scene(), seen=seen)
    assert 'houses" does not say 99.' in str(seen[1][0])
    assert brief.value("building.count") == 12


@pytest.mark.parametrize(
    ("text", "quote", "item", "key", "value"),
    [
        ("A vineyard town, 2 ha", "2 ha", ("site", "area", 20_000), "size.area", 20_000),
        ("Half a kilometre of town", "Half a kilometre", ("site", "width", 500), "size.x", 500),
        ("Two dozen Alpine huts", "Two dozen", ("buildings", "count", 24), "building.count", 24),
        ("Streets at 30 km/h", "30 km/h", ("streets", "speed", 8.333), "roads.speed", 8.333),
    ],
)
def test_numbers_are_said_in_any_unit(text, quote, item, key, value):
    group, field, number = item
    brief, _ = read({group: [{field: exactly(number), "said": [quote]}]}, text=text)
    assert brief.value(key) == pytest.approx(value)


def test_a_model_takes_back_what_the_rules_misread_and_says_it_right():
    text = "Offices by the river, at least five floors, no glass."
    answer = {
        "buildings": [
            {"kind": "office", "floors": {"at_least": 5}, "said": ["Offices", "five floors"]},
            {"material": "glass", "denied": True, "said": ["no glass"]},
        ],
        "unread": ["by the river"],
    }
    brief, channel = read(answer, text=text)
    assert brief.values("element") == ()
    assert brief.value("office.floors.min") == 5
    assert [slot.value for slot in brief.negated] == ["glass"]
    assert 'The model took back element = river ("river").' in channel.notes
    assert "river" in brief.words_unread
    assert not any("river" in goal.predicate for goal in brief.goals)


def test_a_contradiction_of_the_rules_is_gone_with_the_item_that_made_it():
    text = "Snow at 20 degrees Celsius"
    rules = read_brief(text)
    assert rules.conflicts
    assert "contradiction" in told(rules)
    answer = {"air": [{"weather": "snow", "said": ["Snow"]}], "unread": ["20 degrees Celsius"]}
    brief, _ = read(answer, text=text)
    assert not brief.conflicts


def test_kinds_of_buildings_have_numbers_of_their_own():
    text = "Low homes of two storeys at most beside high offices of ten storeys or more"
    answer = {
        "buildings": [
            {"kind": "house", "floors": {"at_most": 2}, "said": ["homes of two storeys at most"]},
            {"kind": "office", "floors": {"at_least": 10}, "said": ["offices of ten storeys"]},
        ]
    }
    brief, _ = read(answer, text=text)
    assert brief.value("house.floors.max") == 2
    assert brief.value("office.floors.min") == 10
    assert not brief.conflicts


def test_goals_of_files_stay():
    text = f"{TEXT} As in the map."
    channel = channel_of(scene(text, **LIKE_NEW_YORK))
    maker = ModelBriefMaker(channel, OfflineBriefMaker())
    brief = maker.read(text, inputs=[("town.osm", "osm")])
    assert any("town.osm" in goal.predicate for goal in brief.goals)


def test_elements_are_counted_and_placed_by_a_model():
    text = "Worship for the faithful at three places up north"
    item = {"kind": "church", "count": exactly(3), "side": "north", "said": ["three places", "up"]}
    brief, _ = read({"things": [item]}, text=text)
    assert brief.value("church.count") == 3
    assert brief.value("church.side") == "north"


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"style": "new_york", "said": ["Big Apple"]}, "is not known"),
        ({"style": "american", "said": ["Manhattan"]}, "The text does not say"),
        ({"style": "american", "said": []}, "copy the words of the text"),
        ({"said": ["Big Apple"]}, "an item says nothing"),
        ({"style": "american", "colours": "new", "said": ["Big Apple"]}, "colours"),
    ],
)
def test_what_is_not_of_the_schema_or_the_text_goes_back(wrong, said):
    seen = []
    brief, _ = read(scene(quarters=[wrong]), scene(**LIKE_NEW_YORK), seen=seen)
    assert said in str(seen[1][0])
    assert brief.value("style") == "american"


def test_what_nothing_measures_goes_back():
    seen = []
    text = "A town with a garden, three metres"
    item = {"kind": "garden", "length": exactly(3), "said": ["three metres"]}
    read({"things": [item]}, {}, text=text, seen=seen)
    assert "Nothing measures" in str(seen[1][0])


def test_of_a_model_that_will_not_learn_what_is_right_is_taken():
    wrong = scene(
        quarters=[{"style": "import os", "said": ["Big Apple"]}],
        things=[{"kind": "plaza", "said": ["quarter"]}],
    )
    brief, _ = read(wrong)
    assert brief.value("style") is None
    assert ("element", "plaza") in brief.items()
    assert any("Apple" in word for word in brief.words_unread)


def test_an_answer_that_is_no_scene_leaves_the_rules():
    brief, channel = read({"quarters": "none"})
    assert brief == read_brief(TEXT)
    assert "Done offline instead." in channel.notes[0]


def test_what_the_text_denies_is_not_wanted():
    text = "A town without rivers."
    found = scene(text, things=[{"kind": "river", "said": ["rivers"]}])
    brief, channel = read(found, text=text)
    assert brief.values("element") == ()
    assert "not to have" in channel.notes[0]


def test_options_hold_against_a_model():
    brief, _ = read(scene(**LIKE_NEW_YORK), options={"style": "japanese"})
    assert brief.values("style") == ("japanese",)


def test_changes_of_a_city_stay_as_rules_read_them_without_an_answer():
    seen = []
    brief, _ = read({}, text="Remove the tallest building.", base=True, seen=seen)
    assert brief == read_brief("Remove the tallest building.", base=True)
    assert seen


@pytest.mark.parametrize("recorded", RECORDED, ids=range(len(RECORDED)))
def test_recorded_scenes_are_taken_as_they_are(recorded):
    seen = []
    brief, _ = read(recorded["scene"], text=recorded["text"], seen=seen)
    assert len(seen) == 1  # nothing went back
    asked = Scene(**recorded["scene"])
    alone = len(kinds_of(asked)) < 2
    items = [one for one in counted_together(list(asked.items())) if not is_of_unnamed_few(one)]
    said = {pair for item in items for pair in pairs_of(item, alone=alone)}
    denied = {value for key, value in said if key == "not"}
    wanted = {pair for pair in said if pair[0] not in ("not", "keep") and pair[1] not in denied}
    told = set(brief.items())
    for kind in kinds_of(asked):  # what rules read of all buildings stays so
        told |= {(key.replace("building.", f"{kind}."), value) for key, value in told}
    assert wanted <= told


def test_a_plural_without_a_number_may_be_at_least_two():
    text = "A quarter with sheds behind"
    answer = {"buildings": [{"kind": "shed", "count": {"at_least": 2}, "said": ["sheds"]}]}
    seen = []
    brief, _ = read(answer, text=text, seen=seen)
    assert len(seen) == 1
    assert brief.value("shed.count.min") == 2
    assert brief.values("building.type") == ()


@pytest.mark.parametrize(
    ("text", "item", "left", "taken"),
    [
        (
            "Three grey warships on the river",
            {"life": [{"said": ["Three grey warships"], "who": "boat", "count": 3}]},
            "grey",
            "warships",
        ),
        (
            "Ten courtyard houses of brick",
            {"buildings": [{"said": ["Ten courtyard houses", "brick"], "kind": "house",
                            "count": 10, "material": "brick"}]},
            "courtyard",
            "",
        ),
        (
            "A town with a ruined rotunda",
            {"things": [{"said": ["a ruined rotunda"], "kind": "temple"}]},
            "ruined",
            "rotunda",
        ),
        (
            "A town. every building 3-4 floors with a flat green roof",
            {"buildings": [{"said": ["every building 3-4 floors with a flat green roof"],
                            "floors": {"at_least": 3, "at_most": 4}, "roof": "green"}]},
            "flat",
            "",
        ),
        (
            "A town with an inn and a thatched barn",
            {"things": [{"said": ["a thatched barn"], "kind": "barn"}]},
            "thatched",
            "",
        ),
        (
            "A town where everybody walks from the church by its main door to the park",
            {"then": [{"said": ["everybody walks from the church by its main door to the park"],
                       "command": "Send people from the church to the park."}]},
            "door",
            "",
        ),
    ],
)  # fmt: skip
def test_words_that_a_model_quotes_are_meant_or_unread(text, item, left, taken):
    brief, _ = read(item, text=text)
    left_open = [note.text for note in brief.notes if note.code == "left_open"]
    assert any(left in word for word in (*brief.words_unread, *left_open))
    notes = [note.text for note in brief.notes if note.code == "taken_for"]
    assert any(taken in note for note in notes) if taken else not notes


def test_what_a_model_says_in_its_own_order_is_not_named_as_lost():
    flats = {"said": ["flats of brick with flat roofs"], "kind": "apartment", "each": True,
             "material": "brick", "roof": "flat"}  # fmt: skip
    brief, _ = read({"buildings": [flats]}, text="A street of flats of brick with flat roofs")
    assert not {"flats", "brick", "roofs"} & set(brief.words_unread)


def test_what_a_model_leaves_unread_is_unread_whatever_it_quotes():
    house = {"said": ["ruined houses"], "kind": "house"}
    brief, _ = read({"buildings": [house], "unread": ["ruined"]}, text="A few ruined houses")
    assert any("ruined" in word for word in brief.words_unread)


def test_counted_things_of_one_kind_are_counted_together():
    towers = [
        {"said": ["Towers of 22, 26 and 30 floors"], "kind": "tower", "count": 1, "floors": floors}
        for floors in (22, 26, 30)
    ]
    text = "A town of houses. Towers of 22, 26 and 30 floors"
    houses = {"said": ["houses"], "kind": "house"}
    brief, _ = read({"buildings": [houses, *towers]}, text=text)
    items = dict(brief.items())
    assert items["tower.count"] == 3
    assert (items["tower.floors.min"], items["tower.floors.max"]) == (22, 30)


def test_a_few_buildings_of_no_kind_are_not_all_buildings():
    hall = {"said": ["one in glass"], "count": 1, "material": "glass"}
    brief, _ = read({"buildings": [hall]}, text="A village, and one in glass")
    assert not any(key.startswith("building.") for key, _ in brief.items())
    assert any("glass" in word for word in brief.words_unread)


def test_a_look_of_each_of_a_kind_is_of_that_kind_alone():
    offices = {
        "said": ["glass on all offices"],
        "kind": "office",
        "material": "glass",
        "each": True,
    }
    brief, _ = read({"buildings": [offices]}, text="Downtown, glass on all offices")
    assert ("office.material", "glass") in brief.items()
    assert not any(key == "building.material" for key, _ in brief.items())


def test_what_a_model_counts_is_not_taken_back():
    parks = {"said": ["parks"], "kind": "park", "count": {"at_least": 2}}
    _, channel = read({"things": [parks]}, text="A town with parks")
    assert not any("took back element = park" in note for note in channel.notes)


COMMANDED = "A quarter of 12 houses where someone has left two bicycles by the fountain."
PUT = {"command": "Put two bicycles near the fountain", "said": ["two bicycles by the fountain"]}


def test_a_model_gives_commands_for_what_no_field_says():
    found = scene(COMMANDED)
    found["then"] = [PUT]
    brief, channel = read(found, text=COMMANDED)
    assert [one.text for one in brief.then] == [PUT["command"]]
    assert COMMANDED[slice(*brief.then[0].span)] == "two bicycles by the fountain"
    assert not {"left", "bicycles"} & {*brief.words_unread} - {"left"}
    assert channel.notes == []


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("Put two bicycles near the gargoyle", "is not understood"),
        ("Put nine bicycles near the fountain", "The text says no 9"),
        ("Remove b07", "The text names no b07"),
    ],
)
def test_a_command_that_the_text_or_the_rules_do_not_know_goes_back(command, said):
    seen = []
    wrong, right = scene(COMMANDED), scene(COMMANDED)
    wrong["then"] = [{**PUT, "command": command}]
    read(wrong, right, text=COMMANDED, seen=seen)
    assert said in str(seen[-1])


SQUARE = "A town with a square, a fountain on the square and a car park near the moonbase."


def test_where_a_thing_stands_is_measured_with_the_thing_it_stands_to():
    fountain = {"said": ["a fountain on the square"], "kind": "fountain", "near": "plaza"}
    brief, channel = read(scene(SQUARE, things=[fountain | {"relation": "on"}]), text=SQUARE)
    assert {("fountain.near", "plaza"), ("fountain.relation", "in")} <= set(brief.items())
    assert channel.notes == []


def test_a_thing_of_which_only_the_place_is_unknown_stays_and_the_place_is_unread():
    parking = {"said": ["a car park near the moonbase"], "kind": "parking_lot", "near": "moonbase"}
    answer = scene(SQUARE, things=[parking])
    brief, _ = read(answer, answer, answer, text=SQUARE)
    assert ("element", "parking_lot") in brief.items()
    assert not any(key == "parking_lot.near" for key, _ in brief.items())
    assert "moonbase" in brief.words_unread
