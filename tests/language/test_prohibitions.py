"""What may not change is protected, and never what is to go; what is off is denied."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.language import read_brief

SUBJECTS = st.sampled_from([
    "nothing north of the church", "no house", "no building by the park", "none of the trees",
    "nothing on the main street", "nothing else", "none of the houses near the river",
    "not a single tree", "make sure no house", "ensure that none of the trees",
])  # fmt: skip
MODALS = st.sampled_from(["may", "should", "must", "can", "shall"])
CHANGES = st.sampled_from([
    "move", "change", "be moved", "be changed", "be touched", "be altered", "be lost",
    "be removed", "be moved or removed", "be disturbed",
])  # fmt: skip


@settings(deadline=None, max_examples=60)
@given(SUBJECTS, MODALS, CHANGES)
def test_what_may_not_change_is_not_removed(subject, modal, change):
    text = f"{subject} {modal} {change}"
    assert read_brief(text, base=True).edits == ()
    both = read_brief(f"Paint the tallest house red. {text.capitalize()}.", base=True)
    assert [edit.verb for edit in both.edits] == ["set_color"]


@pytest.mark.parametrize(
    "text",
    ["Never touch the park", "Under no circumstances remove the church", "Avoid removing trees",
     "Make sure no tree goes missing"],
)  # fmt: skip
def test_what_must_never_be_touched_stays(text):
    brief = read_brief(text, base=True)
    assert brief.edits == ()
    assert all(goal.predicate.startswith("same(") for goal in brief.goals)


@pytest.mark.parametrize(
    ("text", "verbs"),
    [
        ("No house may be taller than 9 m.", ["set_height"]),
        ("No cars on the main street.", ["remove"]),
        ("Remove five houses. No tree may be lost.", ["remove"]),
    ],
)
def test_bounds_and_wishes_that_nothing_were_there_stay_what_they_are(text, verbs):
    assert [edit.verb for edit in read_brief(text, base=True).edits] == verbs


@pytest.mark.parametrize(
    ("text", "denied"),
    [
        ("Trees and cars off", {"tree", "vehicle"}),
        ("A village with people off", {"pedestrian"}),
        ("Switch the trees off", {"tree"}),
        ("Turn off the cars", {"vehicle"}),
        ("A town with no on-street parking", {"parked_vehicle"}),
        ("A town without parking lanes", {"parked_vehicle"}),
    ],
)
def test_what_is_off_is_denied(text, denied):
    brief = read_brief(text)
    assert {slot.value for slot in brief.negated} == denied
    assert brief.value("traffic") is None
    assert brief.value("nature.trees") is None


@pytest.mark.parametrize(
    "text",
    ["Keep it dead flat", "The ground is flat", "A village, completely level", "Keep the site flat",
     "A town of flats. Make it flat"],
)  # fmt: skip
def test_flat_is_said_of_the_ground(text):
    brief = read_brief(text)
    assert brief.value("terrain") == "flat"
    assert not brief.kept


@pytest.mark.parametrize("text", ["A town with a flat", "Two houses and a flat", "Brick flats"])
def test_a_flat_is_a_home_elsewhere(text):
    assert read_brief(text).value("terrain") is None


@pytest.mark.parametrize(
    ("text", "cut"),
    [
        ("Close the middle 300 x 300 m to motor traffic.", False),
        ("Pedestrianise the middle 400 x 400 m.", False),
        ("Remove the trees in the middle 200 x 200 m.", False),
        ("Only the middle 400 x 400 m.", True),
        ("Build the middle 400 x 400 m with snow.", True),
        ("Remove everything outside the middle 400 x 400 m.", True),
    ],
)
def test_a_map_is_cut_only_where_that_is_said(text, cut):
    brief = read_brief(text, inputs=[("m.osm", "osm")])
    assert (brief.value("size.x") is not None) == cut


@pytest.mark.parametrize(
    ("text", "fights"),
    [
        ("A town of single-storey bungalows, each at least 20 m high.", True),
        ("A village of two-storey houses, every house at least 15 m high.", True),
        ("A town of two-storey houses at least 6 m high.", False),
        ("Two-storey houses and a tower of 60 m.", False),
    ],
)
def test_storeys_of_the_only_kind_are_held_against_its_height(text, fights):
    codes = [one.code for one in read_brief(text).conflicts]
    assert ("floors_against_height" in codes) == fights


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A village whose road climbs 60 m", "roads.slope"),
        ("A town with land-use rings", "roads.rings"),
    ],
)
def test_a_rise_in_metres_is_no_slope_and_rings_of_land_use_are_no_roads(text, key):
    brief = read_brief(text)
    assert brief.value(key) is None
    assert brief.notes


@pytest.mark.parametrize(
    "text",
    [
        "Lower all towers by 10 m, but nothing goes below two floors.",
        "Remove the three tallest buildings, but no house goes below 9 m.",
        "Paint the church and the school red and blue respectively.",
        "Paint several red houses blue.",
    ],
)
def test_what_a_change_does_not_heed_is_asked_about(text):
    brief = read_brief(text, base=True)
    assert brief.questions or brief.left or brief.words_unread


def test_a_garden_wall_is_no_city_wall():
    assert read_brief("A town with a garden wall around it").value("element") is None
    assert read_brief("A town with a ring wall").value("element") == "city_wall"


def test_cars_that_may_not_go_are_not_kept():
    assert read_brief("No cars may go.", inputs=[("m.osm", "osm")]).kept == ()
