"""Requests in parts: headings, places that a heading names, bounds, lists and reports."""

import pytest

from cityx.language.brief import Reference, Selector
from cityx.language.reading import read_brief

NAMES = ("High Street", "Mill Lane")
PARK, SQUARE = (Selector(kind, alone=True) for kind in ("park", "plaza"))


def read(text):
    return read_brief(text, base=True, names=NAMES)


def edits(text):
    brief = read(text)
    assert not brief.questions, brief.questions
    assert not brief.left, brief.left
    return [(edit.verb, edit.target, edit.change, edit.refs) for edit in brief.edits]


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("Security planning: put 12 bollards on the square.", "Put 12 bollards on the square."),
        ("Night market: 15 stalls on the square.", "Put 15 stalls on the square."),
        ("Audit mock-up. Put a bench near the church.", "Put a bench near the church."),
        ("Pop a bench by the church if you can, please.", "Put a bench by the church."),
        ("Plant oaks along the river so that walkers get shade.", "Plant oaks along the river."),
    ],
)
def test_what_orders_nothing_holds_nothing_up(text, plain):
    assert edits(text) == edits(plain)


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("Security planning: put a bench on the square.", '"Security planning" is taken as a'),
        ("Plant oaks along the river so walkers get shade.", '"so walkers get shade" is taken as'),
    ],
)
def test_a_heading_and_a_reason_are_named(text, named):
    assert any(note.text.startswith(named) for note in read(text).notes)


def test_a_reason_that_tells_an_amount_is_none():
    assert "12 m" in " ".join(one.text for one in read("Widen b1 so that it is 12 m.").questions)


def test_what_a_heading_is_about_is_where_things_are():
    found = edits(
        "The park needs work: put a kiosk in the north corner, a pond in the middle, benches "
        "around the pond, and a fence all the way round with two gates."
    )
    kiosk, pond, benches, fence = found
    assert kiosk[3] == (Reference("corner", (PARK,), side="north"),)
    assert pond[3] == (Reference("middle", (PARK,)),)
    assert ("last", "pond") in benches[2]
    assert ("gates", 2) in fence[2]


@pytest.mark.parametrize(
    ("text", "refs"),
    [
        ("In the square: a fountain in the centre.", (Reference("middle", (SQUARE,)),)),
        ("The square looks dull. Put a kiosk in each corner.", (Reference("corner", (SQUARE,)),)),
        ("Put a kiosk at the north corner of the town.", (Reference("corner", (), side="north"),)),
    ],
)
def test_a_corner_is_that_of_what_was_spoken_of(text, refs):
    ((_verb, _target, _change, found),) = edits(text)
    assert found == refs


def test_the_middle_of_nothing_is_asked():
    assert read("Put a statue in the middle.").questions


@pytest.mark.parametrize(
    ("text", "change"),
    [
        ("Put a pond in the park, 20 m across.", ("area", 314)),
        ("Build a hedge around the park with three entrances.", ("gates", 3)),
        ("Put picnic tables outside at least five shops.", ("each", "yes")),
        ("Put a bench in all four corners of the square.", ("each", "yes")),
        ("Lay a 3 m wide gravel path through the park.", ("width", 3)),
        ("Add a path along the river made of gravel.", ("surface", "gravel")),
        ("Pop a footbridge over the river, right by the church, 4 m wide.", ("width", 4)),
        ("Add a bridge over the river for pedestrians only.", ("over", "river")),
        ("Make all pavements at least 2 m wide.", ("walk.min", 2)),
        ("No pavement narrower than 1.8 m.", ("walk.min", 1.8)),
        ("Widen the pavements of Mill Lane to 4 m.", ("walk", 4)),
        ("Swap the church's roof for copper green.", ("roof.color", "green")),
        ("Give the church a green copper roof.", ("roof", "metal")),
        ("20 mph on every residential street.", ("speed_kmh", 32.1869)),
    ],
)
def test_a_change_says_what_the_words_do(text, change):
    assert change in [pair for _, _, pairs, _ in edits(text) for pair in pairs]


def test_a_green_copper_roof_paints_no_wall():
    assert {verb for verb, *_ in edits("Give the church a green copper roof.")} == {"set_roof"}


def test_each_of_several_things_is_a_wish_of_its_own():
    text = "Put a fountain on the square, two benches in the park and a kiosk by the church."
    assert len(read(text).wishes) == 3


def test_what_stands_by_something_new_waits_for_it():
    brief = read("Dig a pond in the park and put two benches by it.")
    assert brief.wishes[1].needs == (0,)


def test_houses_on_corners_are_those_where_streets_meet():
    ((_, target, _, _),) = edits("Raise all houses along Mill Lane by one floor, but not those at "
                                 "corners.")  # fmt: skip
    assert target.but[0].where == (Reference("corner"),)
    ((_, target, _, _),) = edits("Paint the corner houses red.")
    assert target.where == (Reference("corner"),)


def test_the_street_of_a_building_is_that_before_it():
    assert edits("Close the street the church is on to cars.") == edits(
        "Close the street in front of the church to cars."
    )


def test_a_list_changes_nothing():
    brief = read("Put three benches in the park and list where they ended up.")
    assert [edit.verb for edit in brief.edits] == ["add", "list"]
    assert brief.edits[1].target.kind == "bench"
    assert [goal.predicate for goal in brief.goals] == ["gained(bench) == 3"]


@pytest.mark.parametrize(
    ("text", "kept", "goal"),
    [
        ("Paint the church red. Don't touch anything else.", "everything", "same(others)"),
        ("Paint the church red and nothing else.", "everything", "same(others)"),
        ("Paint the church red. Keep the layout.", "layout", "same(road)"),
    ],
)
def test_what_is_protected_is_measured(text, kept, goal):
    brief = read(text)
    assert [slot.value for slot in brief.kept] == [kept]
    assert goal in [one.predicate for one in brief.goals]
    assert any("tag=church" in one.predicate for one in brief.goals)  # what may change is named


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("Make the tower of the church twice as high.", "tower"),
        ("Paint the church red and make its tower twice as high.", "tower"),
        ("Raise the river by 2 m.", "level of a river"),
        ("Add a supermarket with 60 spaces near the park.", "60"),
        ("Add a helipad on the roof of the hospital.", "roof"),
        ("Put a bench in the park and a bin by each of them.", "each"),
        ("Add a bridge over the river.", "footbridge"),
        ("Tell me which buildings got them.", "got"),
        ("Put a statue in the park 3 m wide, and floodlight the church.", "floodlight"),
    ],
)
def test_what_is_not_understood_changes_nothing_else(text, word):
    brief = read(text)
    said = [*brief.questions, *(one for left in brief.left for one in left.questions)]
    assert any(word in one.text for one in said)


def test_a_bound_in_a_list_is_done_or_named():
    text = "Put a bench in the park, no pavement narrower than 1.8 m, and put a kiosk by the pond."
    assert [edit.verb for edit in read(text).edits] == ["add", "set_walks", "add"]
    (left,) = read("Put a bench in the park, no pavement narrower than 1.8 m, a frob.").left
    assert "pavement" in left.text


@pytest.mark.parametrize(
    ("text", "verb", "change"),
    [
        ("take the church up to 52 m", "set_height", ("height", 52)),
        ("take b03 up to six floors", "set_floors", ("floors", 6)),
        ("lower the kerbs at every crossing", "add", ("element", "curb_ramp")),
        ("put a bench at each bus stop", "add", ("each", "yes")),
        ("put a bench in every park", "add", ("each", "yes")),
    ],
)
def test_what_is_to_be_at_each_or_so_high_is_read(text, verb, change):
    (edit,) = read_brief(text, base=True).edits
    assert edit.verb == verb
    assert change in edit.change


def test_a_numbered_list_is_read_line_by_line():
    brief = read_brief("1. remove the park\n2. paint the church red\n3) close b03", base=True)
    assert [wish.text for wish in brief.wishes][:2] == ["remove the park", "paint the church red"]
    assert not any(word.strip() in "123" for word in brief.words_unread)


def test_one_bench_in_the_park_is_no_bench_in_each():
    (edit,) = read_brief("put a bench in the park", base=True).edits
    assert "each" not in dict(edit.change)


@pytest.mark.parametrize(
    "text",
    [
        "Make the church red. If there isn't the room, tell me where.",
        "Make the church red; where that's not possible say so.",
    ],
)
def test_a_wish_to_be_told_what_cannot_be_done_holds_nothing_up(text):
    brief = read_brief(text, base=True)
    assert [edit.verb for edit in brief.edits] == ["set_color"]
    assert not brief.questions
    assert not brief.left
    assert any("named in any case" in note.text for note in brief.notes)


@pytest.mark.parametrize(
    ("text", "verb", "change"),
    [
        ("Every building near the park loses its top floor.", "raise_floors", ("by", -1)),
        ("The houses should be no taller than 9 m.", "set_height", ("height.max", 9)),
        ("The houses must be at most two storeys high.", "set_floors", ("floors.max", 2)),
        ("Add a second bridge over the river, pedestrians only.", "add_bridge", ("over", "river")),
    ],
)
def test_what_things_should_be_is_an_order(text, verb, change):
    (edit,) = read_brief(text, base=True).edits
    assert edit.verb == verb
    assert change in edit.change
