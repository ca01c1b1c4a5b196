import pytest

from cityx.language import read_brief


def items(text):
    return read_brief(text, base=True).items()


def test_a_rank_is_no_count():
    assert items("Make the three tallest buildings glass.") == [
        ("edit", "set_material"), ("target", "building"), ("rank", "tallest"), ("k", 3),
        ("material", "glass"),
    ]  # fmt: skip


def test_what_stands_before_the_noun_chooses_and_what_stands_behind_changes():
    assert items("Make the red houses near park1 white.") == [
        ("edit", "set_color"), ("target", "house"), ("filter", "color=red"), ("near", "park1"),
        ("color", "white"),
    ]  # fmt: skip


@pytest.mark.parametrize("one", ["8715e0f75b7ad4b0", "b715e0f75b7ad4b0", "1234567890123456"])
def test_an_object_may_be_named_by_its_id(one):
    assert items(f"Add two storeys to {one}.") == [
        ("edit", "raise_floors"), ("target", one), ("by", 2),
    ]  # fmt: skip


def test_two_commands_in_one_sentence():
    assert items("Double the height of b07 and delete b08.") == [
        ("edit", "scale_height"), ("target", "b07"), ("factor", 2), ("edit", "remove"),
        ("target", "b08"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "verb", "change"),
    [
        ("Lower b03 by 4 m", "raise_height", ("by", -4)),
        ("Make b03 two floors higher", "raise_floors", ("by", 2)),
        ("Add two floors to b03", "raise_floors", ("by", 2)),
        ("Reduce the height of b03 by 20 %", "scale_height", ("factor", 0.8)),
        ("Reduce the height of b03 to 20 %", "scale_height", ("factor", 0.2)),
        ("Set b03 to 12 m", "set_height", ("height", 12)),
        ("Make the main street 20 m wide", "set_width", ("width", 20)),
        ("b03 shall be 10 % taller", "scale_height", ("factor", 1.1)),
        ("Put a flat roof on b03", "set_roof", ("roof", "flat")),
        ("b03 should be brick", "set_material", ("material", "brick")),
        ("b03 shall be painted red", "set_color", ("color", "red")),
    ],
)
def test_how_much_is_read_in_every_form(text, verb, change):
    found = items(text)
    assert found[0] == ("edit", verb)
    assert found[-1] == change


def test_it_is_what_was_named_last():
    found = read_brief("Move b07 5 m north. Paint it red.", base=True).edits
    assert [edit.target.ids for edit in found] == [("b07",), ("b07",)]


def test_a_range_of_ids_is_every_id_in_it():
    edit = read_brief("Buildings b08 to b11 should be white", base=True).edits[0]
    assert edit.target.ids == ("b08", "b09", "b10", "b11")


def test_what_falls_can_be_stopped():
    assert items("Stop the rain.") == [("edit", "set_weather"), ("weather", "clear")]


@pytest.mark.parametrize("text", ["Make it nicer.", "Improve the scene", "Raise b21", "Rotate it."])
def test_what_is_left_unsaid_becomes_a_question(text):
    assert read_brief(text, base=True).questions


def test_protected_things_are_no_targets():
    brief = read_brief("Remove all the cars, leave the people.", base=True)
    assert brief.items() == [("edit", "remove"), ("target", "vehicle"), ("keep", "pedestrian")]
    assert "same(pedestrian)" in [goal.predicate for goal in brief.goals]


@pytest.mark.parametrize(
    ("text", "count"), [("undo", 1), ("Undo the last two changes.", 2), ("undo everything", "all")]
)
def test_undo_says_how_far(text, count):
    assert items(text) == [("undo", count)]


def test_a_description_is_no_edit_without_a_city():
    brief = read_brief("Put a 30 m wide river through the town with three bridges.")
    assert brief.edits == ()
    assert ("river.width", 30) in brief.items()


@pytest.mark.parametrize(
    ("text", "verb", "change"),
    [
        ("Make all the trees 20 % larger.", "scale", ("factor", 1.2)),
        ("Make the trees a fifth larger.", "scale", ("factor", 1.2)),
        ("Make the tallest building a third lower.", "scale_height", ("factor", 0.6667)),
        ("Make the trees 20 % smaller.", "scale", ("factor", 0.8)),
        ("Turn the tallest tree by 90 degrees.", "rotate", ("angle", 1.5708)),
    ],
)
def test_what_is_larger_by_a_share_is_more_than_it_was(text, verb, change):
    (edit,) = read_brief(text, base=True).edits
    assert (edit.verb, edit.change) == (verb, (change,))
