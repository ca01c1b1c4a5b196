"""What "it", "those", "the rest" and "the others" stand for, and what is left out of a change."""

import pytest

from cityx.language import Reference, Selector, read_brief


def targets(text):
    brief = read_brief(text, base=True)
    assert not brief.questions, brief.questions
    return [edit.target for edit in brief.edits]


@pytest.mark.parametrize(
    "text",
    [
        "Paint all houses red except those along the river.",
        "All houses should be red, apart from the ones along the river.",
        "Except for those along the river, every house must be red.",
        "Make the houses red but leave those along the river as they are.",
        "Leave the houses along the river alone. Paint the other houses red.",
    ],
)
def test_what_is_told_by_its_place_is_left_out(text):
    (target,) = targets(text)
    assert target.kind == "house"
    assert target.but == (Selector("house", along="river"),)


@pytest.mark.parametrize(
    ("text", "filters"),
    [
        ("Remove every house that isn't brick.", ("material!=brick",)),
        ("All houses which are not red should be removed.", ("color!=red",)),
        ("Knock down the non-brick houses.", ("material!=brick",)),
        ("Any house taller than 8 m that is red must be gone.", ("height>8", "color=red")),
    ],
)
def test_what_things_are_not_chooses_them(text, filters):
    (target,) = targets(text)
    assert set(target.filters) == set(filters)


@pytest.mark.parametrize(
    "text",
    [
        "Paint half of the houses red and the rest blue.",
        "Paint half of the houses red. The others should be blue.",
        "Half of the houses become red, and paint the other houses blue.",
    ],
)
def test_the_rest_is_what_was_not_changed_before(text):
    first, second = targets(text)
    assert first.share == 0.5
    assert second == Selector("house", but=(first,))


@pytest.mark.parametrize(
    ("text", "spot"),
    [
        ("Make the houses next to the church as tall as it.", Selector("church", alone=True)),
        ("Make b07 as tall as b05.", Selector(ids=("b05",))),
        ("I'd like b07 to have the same height as the tallest building.",
         Selector("building", rank="tallest", k=1)),
    ],
)  # fmt: skip
def test_a_measure_is_taken_over_from_another_object(text, spot):
    (edit,) = read_brief(text, base=True).edits
    assert edit.verb == "set_height"
    (one,) = edit.refs
    assert (one.key, one.spots[0].kind, one.spots[0].ids) == ("height", spot.kind, spot.ids)


def test_each_of_several_is_compared_with_its_own_neighbours():
    (edit,) = read_brief("Make every house one floor taller than its neighbours.", base=True).edits
    (one,) = edit.refs
    assert (one.key, one.amount) == ("floors", 1.0)
    (near,) = one.spots[0].where
    assert near == Reference("near", (edit.target,), 15.0)


def test_two_of_a_kind_change_in_one_sentence_each_as_it_was():
    first, second = targets("Paint the red houses blue and the blue ones red.")
    assert (first.filters, second.filters) == (("color=red",), ("color=blue",))


def test_it_is_the_place_where_several_things_were_named():
    plant = read_brief(
        "Remove the cars from the main street and plant lime trees along it.", base=True
    ).edits[-1]
    assert [(one.key, one.spots[0].kind) for one in plant.refs] == [("along", "main_street")]


@pytest.mark.parametrize(
    "text",
    [
        "Take the spire off the church and paint it red.",
        "Build a bench within earshot of the church.",
        "Paint the others red.",
    ],
)
def test_words_that_nobody_reads_are_asked_about(text):
    assert read_brief(text, base=True).questions


@pytest.mark.parametrize(
    ("text", "change"),
    [
        ("A statue in the park, please, with four benches around it.",
         {"element": "bench", "count": 4, "last": "statue"}),
        ("Put a bus stop near the church and a bench beside it.",
         {"element": "bench", "last": "bus_stop"}),
        ("Put cones around the church, and a bench beside it.",
         {"element": "bench", "around": "church"}),
    ],
)  # fmt: skip
def test_it_is_what_was_added_before_or_where_several_were(text, change):
    brief = read_brief(text, base=True)
    assert not brief.questions, brief.questions
    assert dict(brief.edits[-1].change) == change
