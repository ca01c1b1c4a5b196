"""What a change says more than is understood: named, and the rest carried out; or asked about."""

import pytest

from cityx.language.brief import Reference, Selector
from cityx.language.reading import read_brief

CHURCH, PARK, RIVER = (Selector(kind, alone=True) for kind in ("church", "park", "river"))


def read(text):
    return read_brief(text, base=True)


def edits(text):
    return [(edit.verb, edit.target, edit.change) for edit in read(text).edits]


def left(text):
    brief = read(text)
    assert not brief.questions, brief.questions
    return [one.text for one in brief.left]


@pytest.mark.parametrize(
    ("text", "plain", "named"),
    [
        ("Swap the church for a mosque with two minarets.", "Swap the church for a mosque.",
         "with two minarets"),
        ("Put a zestful market on the square.", "Put a market on the square.", "zestful"),
        ("Add a pond in the park, with a jetty.", "Add a pond in the park.", "with a jetty"),
        ("Build a villa by the river, in the style of Gaudi.", "Build a villa by the river.",
         "in the style of Gaudi"),
        ("Swap the park for a car park with 60 spaces.", "Swap the park for a car park.",
         "with 60 spaces"),
    ],
)  # fmt: skip
def test_what_tells_more_of_something_new_is_left_out_and_named(text, plain, named):
    assert edits(text) == edits(plain) != []
    assert left(text) == [named]


@pytest.mark.parametrize(
    "text",
    [
        "Put a playground near the entrance farthest from the river.",  # where
        "Remove the benches, the rumpled ones.",  # which
        "Paint the gnarly houses red.",  # which
        "Add a bench by b05, or rather by b06 and its shed.",  # taken back
        "Build a café with a terrace by the river.",  # what is by the river?
        "Remove the houses, except the zorb ones.",
        "Remove the houses with purple doors.",  # houses that are purple are others
        "It should be 4 m wide, steel, with lamps on both sides.",  # what is so wide?
    ],
)
def test_what_may_say_which_or_where_is_asked_about(text):
    brief = read(text)
    assert brief.questions
    assert not brief.wishes


def test_what_else_a_place_gets_is_added_where_it_says():
    text = "Swap the church for a mosque with a fountain in front of it and with two minarets."
    assert all(edit.verb != "remove" for edit in read(text).edits)


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("Paint all houses red. The church and the park have to survive.", ["church", "park"]),
        ("Remove the benches. If the church happens to be in that strip it stays.", ["church"]),
        ("Leave the church alone even if it counts and remove the lamps.", ["church"]),
        ("Keep the trees round the rim. Put a pond in the park.", ["tree"]),
        ("Keep as many of the trees as you can. Put a pond in the park.", ["tree"]),
    ],
)
def test_what_is_to_stay_is_kept_however_it_is_said(text, kept):
    brief = read(text)
    assert [slot.value for slot in brief.kept] == kept
    assert brief.edits
    assert not brief.questions


def test_that_the_rest_stays_asks_for_nothing():
    assert edits("Paint the church red, the rest stay as they are.") == edits(
        "Paint the church red."
    )


def test_shares_of_one_sentence_do_not_overlap():
    first, second = read("Paint a third of the houses yellow and a third light blue.").edits
    assert second.target.but == (first.target,)
    assert first.target.share == pytest.approx(1 / 3, abs=1e-3)
    assert second.target.share == pytest.approx(1 / 2, abs=1e-3)


def test_a_strip_that_is_cleared_is_what_the_removal_tells():
    text = ("Remove every building within 30 m of the river and turn that strip into a meadow with "
            "a gravel path along both banks and benches every 50 m.")  # fmt: skip
    gone, meadow, path, benches = read(text).edits
    assert gone.target.reach == 30.0
    assert meadow.refs == (Reference("near", (RIVER,), 30.0),)
    assert dict(path.change) == {"surface": "gravel", "along": "river"}
    assert dict(benches.change)["along"] == "river"


@pytest.mark.parametrize("way", ["downstream of the existing one", "away from the bridge there"])
def test_a_bridge_lies_off_the_bridges_there_are(way):
    (edit,) = read(f"Add a second bridge over the river, for walkers only, about 90 m {way}.").edits
    assert edit.verb == "add_bridge"
    assert edit.refs == (Reference("off", (Selector("bridge"),), 90.0),)


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("All the roofs slate instead of tile.", "Give all buildings slate roofs."),
        ("Lose the bus stops, there's no bus here.", "Remove the bus stops."),
        ("I don't want the kiosks any more.", "Remove the kiosks."),
        ("Give the church a fresh coat of red paint.", "Paint the church red."),
        ("Make room for a tennis court in the park.", "Add a tennis court in the park."),
        ("Lamps along the river every 20 m.", "Add lamps along the river every 20 m."),
        ("In the park we need a fountain.", "Add a fountain in the park."),
        ("Knock down a fifth of the houses at random.", "Knock down a fifth of the houses."),
        ("Swap the park's lawn for a pond.", "Add a pond in the park."),
    ],
)
def test_short_forms_are_read_in_full(text, plain):
    assert edits(text) == edits(plain) != []
    assert left(text) == []


def test_traits_behind_a_place_are_those_of_the_building():
    (edit,) = read("Add a slab of flats near the church, nine floors, grey concrete.").edits
    said = dict(edit.change)
    assert said["building.floors"] == 9
    assert (said["color"], said["material"]) == ("grey", "concrete")


def test_all_within_a_distance_of_a_church_is_not_the_church():
    (edit,) = read("Clear away every building within 70 m of the church.").edits
    assert (edit.verb, edit.target.kind, edit.target.near) == ("remove", "building", "church")


def test_roofs_are_chosen_by_the_side_they_slope_to():
    ((verb, _, change),) = edits("Put solar panels on every south-facing roof.")
    assert (verb, dict(change)) == ("add_parts", {"part": "solar", "facing": "south"})
