"""Wishes: what is understood of a request is carried out, and what is not is named alone."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.language import read_brief

# Wishes that have nothing to do with each other.
WISHES = (
    "paint the church white", "put two benches by the pond", "plant ten oaks in the park",
    "close the main street to cars", "make the shops yellow", "add a fountain in the park",
    "remove the lamps along the main street", "make it snow",
)  # fmt: skip


def edits(brief):
    return [(edit.verb, edit.target, edit.change, edit.refs) for edit in brief.edits]


def of(*texts):
    return [one for text in texts for one in edits(read_brief(text, base=True))]


def left(text):
    return [one.text for one in read_brief(text, base=True).left]


@pytest.mark.parametrize(
    ("text", "done", "named"),
    [
        ("Paint the church white and add a filigree vane to it. Put two benches by the pond.",
         ["Paint the church white.", "Put two benches by the pond."],
         ["add a filigree vane to it"]),
        ("Add a bus stop on the main street and a yurt in the park; also make it evening.",
         ["Add a bus stop on the main street.", "Make it evening."], ["a yurt in the park"]),
        ("Give all offices flat roofs, the church a taller spire and the shops green awnings.",
         ["Give all offices flat roofs.", "Give the shops green awnings."],
         ["the church a taller spire"]),
        ("It should rain heavily. Ten people wait at the bus stop with umbrellas.",
         ["It should rain heavily."], ["Ten people wait at the bus stop with umbrellas"]),
        ("Remove the lamps and the yurt.", ["Remove the lamps."], ["the yurt"]),
        ("Paint the church white and the rectory red.", ["Paint the church white."],
         ["the rectory red"]),
        ("Paint the derelict houses and the shops red.", ["Paint the shops red."],
         ["Paint the derelict houses"]),
    ],
)  # fmt: skip
def test_what_is_understood_is_done_and_the_rest_is_named(text, done, named):
    brief = read_brief(text, base=True)
    assert not brief.questions
    assert edits(brief) == of(*done)
    assert left(text) == named
    assert all(one.questions for one in brief.left)


def test_an_unknown_word_leaves_out_the_wish_that_it_qualifies():
    brief = read_brief("Paint the derelict houses red and make it snow.", base=True)
    assert edits(brief) == of("Make it snow.")
    assert [one.text for one in brief.left] == ["Paint the derelict houses red"]
    assert '"derelict"' in brief.left[0].told


@pytest.mark.parametrize(
    "text",
    [
        "Paint the houses red, but not the listed ones, and plant ten oaks in the park.",
        "Paint the houses red and remove the benches, but not the vintage ones.",
        "If the mayor agrees, paint the houses red and remove the benches.",
        "Paint the houses red and the shops blue unless they are listed.",
        "Paint the houses red. Leave the vicarage alone.",
        "Remove the benches. Don't touch the pergola.",
        "Remove the lamps and the benches near the yurt.",
        "Paint the houses near the yurt and the church red.",
        "Put a yurt in the park. Plant ten oaks around it.",
        "In the derelict quarter, remove the benches and paint the houses red.",
        "Paint the houses white and frobnicated.",
        "Both the houses and the yurts should be red.",
        "Remove the three smallest houses and build a filigree school there instead.",
    ],
)
def test_an_unread_limit_leaves_out_all_that_it_may_be_about(text):
    brief = read_brief(text, base=True)
    assert brief.questions or brief.left
    assert not [edit for edit in brief.edits if edit.verb not in ("unspecified", "plant")] or (
        brief.questions
    )


def test_an_unread_protection_lets_new_things_and_weather_be():
    text = "Lower the tallest office by two floors, leave the vicarage as it is, and put a fountain in the park. Make it rain."  # noqa: E501
    assert edits(read_brief(text, base=True)) == of("Put a fountain in the park.", "Make it rain.")


def test_the_rest_needs_all_before_it():
    text = "Paint the gabled derelict houses red. Make it snow. Paint the rest blue."
    assert edits(read_brief(text, base=True)) == of("Make it snow.")


def test_going_back_is_all_or_nothing():
    brief = read_brief("Undo the last change and paint the frobs red.", base=True)
    assert brief.questions
    assert not brief.left


@settings(max_examples=40, deadline=None)
@given(
    wishes=st.lists(st.sampled_from(WISHES), min_size=2, max_size=4, unique=True),
    joined=st.sampled_from([". ", ", and ", "; ", " and then "]),
    data=st.data(),
)
def test_an_unknown_word_in_one_wish_changes_no_other_and_widens_nothing(wishes, joined, data):
    strange = data.draw(st.integers(0, len(wishes) - 1))
    words = wishes[strange].split()
    at = data.draw(st.integers(1, len(words)))
    bad = " ".join([*words[:at], "frobnicated", *words[at:]])
    text = joined.join([*wishes[:strange], bad, *wishes[strange + 1 :]])
    brief = read_brief(f"{text}.", base=True)
    others = of(*(f"{one}." for one in (*wishes[:strange], *wishes[strange + 1 :])))
    own = of(f"{wishes[strange]}.")
    assert "frobnicated" in brief.words_unread
    if brief.questions:  # all is asked about, nothing is done
        return
    done = edits(brief)
    assert [one for one in done if one in others] == [one for one in done if one not in own]
    assert set(map(str, done)) <= set(map(str, (*others, *own)))
    assert set(map(str, others)) <= set(map(str, done))
    if any(one in done for one in own):  # a word more says no other air, and only tells of the new
        assert all(one[1] is None and one[0] in ("set_weather", "add", "plant") for one in own)


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("Make the shops one storey taller.", "Make the shops one floor taller."),
        ("Paint the houses that face the park red.", "Paint the houses facing the park red."),
        (
            "Paint the church red. Double its height.",
            "Paint the church red. Double the height of the church.",
        ),
        ("Swap the tarmac of the main street for cobbles.", "Pave the main street with cobbles."),
    ],
)
def test_what_means_the_same_is_read_the_same(text, plain):
    assert of(text) == of(plain)


@pytest.mark.parametrize(
    "text", ["Paint the big houses blue.", "Make sure no house within 30 m remains."]
)
def test_what_leaves_open_which_things_are_meant_is_asked(text):
    assert read_brief(text, base=True).questions


def test_a_second_condition_binds_what_follows_it_alone():
    text = "If there are offices, paint them white, and if there is a casino, remove it."
    brief = read_brief(text, base=True)
    assert [one.text for one in brief.wishes] == ["paint them white"]
    assert [one.kind for one in brief.wishes[0].given] == ["office"]


@pytest.mark.parametrize(
    ("text", "done", "left"),
    [
        (
            "The church looks too modest. Give it a filigree 55 m high and a green roof.",
            "Give the church a green roof.",
            ["Give it a filigree 55 m high"],
        ),
        ("The chapel is dull. Paint it red.", "Paint the chapel red.", []),
        (
            "Take out every house within 30 m of the river and turn that frob into a meadow.",
            "Take out every house within 30 m of the river.",
            ["turn that frob into a meadow"],
        ),
    ],
)
def test_a_remark_names_what_it_is_and_holds_nothing_up(text, done, left):
    brief = read_brief(text, base=True)
    assert edits(brief) == of(done)
    assert [one.text for one in brief.left] == left


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("Every third house loses a floor.", "Remove one floor from every third house."),
        ("The hotel gains two storeys.", "Raise the hotel by two floors."),
        ("Take a storey off the hotel.", "Remove one floor from the hotel."),
        ("I'd like a school north of the river.", "Add a school north of the river."),
        ("No house may end up under 2 floors.", "No house may have less than 2 floors."),
    ],
)
def test_ways_to_say_a_change(text, same):
    assert edits(read_brief(text, base=True)) == of(same)


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("Add a tram line along the main street, ending at the park.", "ending"),
        ("Give it a filigree and a green roof.", "green roof"),
        ("Turn the frob into a meadow. Paint the church red, if the frob is gone.", "frob"),
    ],
)
def test_what_is_told_of_nothing_known_changes_nothing_else(text, named):
    brief = read_brief(text, base=True)
    assert any(named in one.text for one in brief.questions)
    assert not brief.wishes
