"""Edits in words: places of a rank, distances, shares, parts, and words that nobody reads."""

import pytest

from cityx.language.brief import Edit, Selector
from cityx.language.reading import read_brief
from cityx.language.references.resolved_changes import sizes_of

NAMES = ("High Street", "Mill Lane", "City Tower", "Green Park")


def one(text):
    brief = read_brief(text, base=True, names=NAMES)
    assert not brief.questions, brief.questions
    (edit,) = brief.edits
    return edit


@pytest.mark.parametrize(
    ("text", "change"),
    [
        ("Put three benches along the main street.", ("along", "main_street")),
        ("Place a kiosk next to the church.", ("near", "church")),
        ("Set up a bus stop beside the largest park.", ("near", "largest park")),
        ("I want a statue at the centre of the park.", ("in", "park")),
        ("Line High Street with bollards.", ("along", "High Street")),
        ("Line the main street with trees.", ("along", "main_street")),
        ("Plant trees on both sides of Mill Lane.", ("along", "Mill Lane")),
        ("Put two bins beside the school.", ("element", "waste_basket")),
    ],
)
def test_what_is_added_stands_where_the_words_say(text, change):
    edit = one(text)
    assert edit.target is None
    assert change in edit.change


@pytest.mark.parametrize(
    ("text", "verb", "change"),
    [
        ("Make the church a quarter lower.", "scale_height", ("factor", 0.75)),
        ("Narrow the main street by a fifth.", "scale_width", ("factor", 0.8)),
        ("Enlarge the biggest tree by 50 %.", "scale", ("factor", 1.5)),
        ("Shrink the largest tree to 60 %.", "scale", ("factor", 0.6)),
        ("Shrink the largest tree by a factor of 2.", "scale", ("factor", 0.5)),
        ("Make the trees in the park half as big.", "scale", ("factor", 0.5)),
        ("Make the church twice as big.", "scale", ("factor", 2)),
        ("Make the church twice as tall.", "scale_height", ("factor", 2)),
        ("Rotate the school by a quarter turn.", "rotate", ("angle", 1.5708)),
        ("Take two floors off City Tower.", "raise_floors", ("by", -2)),
        ("Take 5 m off City Tower.", "raise_height", ("by", -5)),
        ("Half an hour later.", "shift_time", ("hours", 0.5)),
        ("Turn the school into an art deco building.", "set_style", ("style", "art_deco")),
    ],
)
def test_how_much_something_changes_is_what_is_said(text, verb, change):
    edit = one(text)
    assert (edit.verb, edit.change) == (verb, (change,))


@pytest.mark.parametrize(
    ("text", "target"),
    [
        ("The three tallest towers in glass.", Selector("tower", rank="tallest", k=3)),
        ("Paint buildings taller than 20 m grey.", Selector("building", filters=("height>20",))),
        ("Colour every building within 50 m of the church red.",
         Selector("building", near="church", reach=50.0)),
        ("Paint the two buildings closest to the lake orange.",
         Selector("building", rank="nearest", k=2, near="lake")),
        ("Delete the bench nearest to City Tower.",
         Selector("bench", rank="nearest", near="City Tower", alone=True)),
        ("Remove five trees from Green Park.", Selector("tree", k=5, inside="Green Park")),
        ("Take the chimneys off the church.", Selector("church", alone=True)),
        ("Remove the antennas from City Tower.", Selector(ids=("City Tower",))),
        ("Clear the park of benches and make it rain.", Selector("bench", inside="park")),
    ],
)  # fmt: skip
def test_an_edit_is_about_what_the_words_name(text, target):
    assert read_brief(text, base=True, names=NAMES).edits[0].target == target


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("Remove the spire of the church.", "spire"),
        ("Delete the gargoyles of City Tower.", "gargoyles"),
    ],
)
def test_who_wants_an_unknown_thing_gone_is_asked(text, word):
    brief = read_brief(text, base=True, names=NAMES)
    assert f'What is meant by "{word}"' in brief.questions[0].text


@pytest.mark.parametrize(
    ("text", "kind", "rank", "near", "k"),
    [
        ("Remove the nearest bench to the church.", "bench", "nearest", "church", 1),
        ("Remove the bench closest to the church.", "bench", "nearest", "church", 0),
        ("Delete the three closest trees to the fountain.", "tree", "nearest", "fountain", 3),
        ("Raise the farthest tower from the lake by 10 m.", "tower", "farthest", "lake", 1),
        ("Rotate the bench furthest away from the church by 90 degrees.", "bench", "farthest",
         "church", 0),
        ("Move the closest tree to the town hall 3 m north.", "tree", "nearest", "town_hall", 1),
    ],
)  # fmt: skip
def test_the_nearest_to_something_may_be_named_before_or_behind(text, kind, rank, near, k):
    target = one(text).target
    assert (target.kind, target.rank, target.near, target.k) == (kind, rank, near, k)


@pytest.mark.parametrize("off", ["off", "from", "off of"])
@pytest.mark.parametrize("verb", ["Strip", "Take", "Rip"])
def test_what_is_taken_off_something_is_removed(verb, off):
    assert one(f"{verb} the benches {off} the plaza.").verb == "remove"
    assert one(f"{verb} the balconies {off} the hotel.").verb == "remove"


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("Remove all buildings except b01.", ["b01"]),
        ("Paint all buildings except b02 and b03 red.", ["b02", "b03"]),
        ("Paint everything but b01 and b02 blue.", ["b01", "b02"]),
    ],
)
def test_what_is_left_out_of_a_group_is_kept(text, kept):
    brief = read_brief(text, base=True)
    assert [slot.value for slot in brief.kept] == kept
    assert len(brief.edits) == 1
    assert not brief.questions


@pytest.mark.parametrize(
    "text",
    [
        "Change the style of the east side to brutalist.",
        "Make the cars drive slower.",
        "Please remove that ugly grey block.",
        "Ban cars from the old town.",
    ],
)
def test_what_would_become_another_change_is_asked(text):
    assert read_brief(text, base=True, names=NAMES).questions


def test_what_is_said_behind_a_colon_is_about_what_stands_before_it():
    edits = read_brief("b08: flat roof, grey.", base=True).edits
    assert {edit.verb for edit in edits} == {"set_roof", "set_color"}
    assert {edit.target.ids for edit in edits} == {("b08",)}


def test_a_building_that_stands_for_another_gets_the_size_that_is_said():
    edit = one("Make b01 a 30 storey glass tower.")
    (size,) = sizes_of(edit)
    assert (size.verb, size.target, size.change) == ("set_floors", edit.target, (("floors", 30),))
    assert sizes_of(one("Make b01 a glass tower.")) == []


def test_two_ways_are_gone_one_after_the_other():
    ways = [dict(edit.change) for edit in
            read_brief("Move b03 10 m north and 5 m east.", base=True).edits]  # fmt: skip
    assert ways == [{"by": 10, "direction": "north"}, {"by": 5, "direction": "east"}]


@pytest.mark.parametrize(
    ("text", "change"),
    [
        ("Put a bench near b05 and another behind it.",
         {"element": "bench", "near": "b05", "count": 2, "row": "behind"}),
        ("Place a statue in the park and another one in front of it.",
         {"element": "statue", "in": "park", "count": 2, "row": "before"}),
        ("Add two bins beside the school and one more next to them.",
         {"element": "waste_basket", "near": "school", "count": 3, "row": "beside"}),
        ("A statue 10 m north of b05",
         {"element": "statue", "side": "north", "of": "b05", "off": 10}),
        ("Put two benches 5 m south-west of b05.",
         {"element": "bench", "count": 2, "side": "southwest", "of": "b05", "off": 5}),
        ("Add a bench north of b05.", {"element": "bench", "side": "north", "of": "b05"}),
    ],
)  # fmt: skip
def test_what_is_added_stands_beyond_a_side_or_in_a_row(text, change):
    edit = one(text)
    assert (edit.verb, dict(edit.change)) == ("add", change)


def test_another_stands_where_its_own_words_say():
    brief = read_brief("Put two benches near b05 and another near b02.", base=True)
    assert [dict(edit.change) for edit in brief.edits] == [
        {"element": "bench", "count": 2, "near": "b05"}, {"element": "bench", "near": "b02"},
    ]  # fmt: skip


@pytest.mark.parametrize(
    "text",
    ["Remove b03 and another behind it.", "Add a bench near b05 and a statue behind it.",
     "Plant a tree near b05 and another behind it.", "Lamps off on x1."],
)  # fmt: skip
def test_a_second_clause_that_nobody_reads_is_asked_for(text):
    brief = read_brief(text, base=True)
    assert brief.questions or brief.left


def test_moved_so_far_from_something_is_no_move_by_so_much():
    assert dict(one("Move the bench 10 m north of b05.").change) == {
        "side": "north", "of": "b05", "off": 10,
    }  # fmt: skip
    assert dict(one("Move the bench 10 m north.").change) == {"by": 10, "direction": "north"}


@pytest.mark.parametrize(
    ("text", "target", "surface"),
    [
        ("Cobble the street.", "road", "cobblestone"),
        ("Cobble the main street.", "main_street", "cobblestone"),
        ("Gravel every side street.", "side_street", "gravel"),
        ("Asphalt the main street.", "main_street", "asphalt"),
    ],
)
def test_a_surface_is_a_verb_as_well(text, target, surface):
    edit = one(text)
    assert (edit.verb, edit.target.kind) == ("set_surface", target)
    assert edit.change == (("surface", surface),)


@pytest.mark.parametrize(
    "text", ["Turn the lamps off.", "Lamps off", "Switch off the street lamps.",
             "The street lamps are off."]
)  # fmt: skip
def test_lamps_go_off(text):
    assert one(text) == Edit("set_lights", None, (("lights", "off"),), one(text).span)
