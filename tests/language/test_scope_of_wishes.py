"""What is said of some, denied, or only spoken of is no wish for all: made sentences and kinds."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cityx.language import read_brief
from cityx.language.scene import pairs_of, scene_of

QUICK = settings(
    max_examples=80, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True
)
# Wishes of a town with what they say alone.
WISHES = {
    "30 houses": {("building.count", 30)},
    "a church": {("element", "church")},
    "two fountains": {("fountain.count", 2)},
    "a river 20 m wide": {("river.width", 20)},
    "a tram line": {("element", "tram_line")},
    "three bakeries": {("bakery.count", 3)},
}
SOME = st.tuples(
    st.sampled_from(["Buildings", "The buildings", "Every building", "Roofs", "All buildings"]),
    st.sampled_from(
        ["without a garden", "near the tannery", "that face the quay", "taller than 9 m",
         "along the avenue", "within 40 m of the gasworks", "with a flurb", "behind the church",
         "on corners", "between the church and the tannery", "whose owners are away"]
    ),
    st.sampled_from(
        ["are red", "should be red", "get a flat roof", "have four floors", "are of glass",
         "must be white and of timber", "have solar panels", "are 12 m high", "stay low"]
    ),
)  # fmt: skip
LOOKS = (
    "building.color", "roof.color", "building.roof", "building.floors", "building.material",
    "building.feature", "building.height", "roof.material",
)  # fmt: skip
THINGS = {
    "windmills": "windmill", "lighthouses": "lighthouse", "playgrounds": "playground",
    "trams": "tram", "cranes": "harbour_crane", "children": "child", "lorries": "truck",
}  # fmt: skip
MENTIONS = (
    "We photograph {}.", "My students learn about {}.", "I study {} and their noise.",
    "There were {} here before the war.", "If there are {}, that is fine with me.",
    "There used to be {} at this place.", "Our team draws {} in summer.",
)  # fmt: skip


def town(wishes, sentence, *, first):
    body = f"A town with {' and '.join(wishes)}."
    return f"{sentence} {body}" if first else f"{body} {sentence}"


def told(brief):
    return {(slot.key, slot.value) for slot in brief.slots}


def wished(brief, thing):
    """Return whether something of a thing is asked for."""
    return any(
        slot.key.partition(".")[0] == thing or (slot.key in ("element", "agent", "building.type")
                                                and slot.value == thing)
        for slot in brief.slots
    )  # fmt: skip


SETS = st.lists(st.sampled_from(sorted(WISHES)), min_size=1, max_size=3, unique=True)


@QUICK
@given(SETS, SOME, st.booleans())
def test_what_is_said_of_some_is_not_said_of_all(wishes, statement, first):
    sentence = " ".join(statement) + "."
    brief = read_brief(town(wishes, sentence, first=first))
    assert not [slot for slot in brief.slots if slot.key.startswith(LOOKS)], brief.text
    said = [brief.text[slice(*note.span)] for note in brief.notes] + list(brief.words_unread)
    said += [one.text for one in brief.then]  # a change of those alone
    assert any(statement[2].split()[-1] in one for one in said), brief.text
    assert set().union(*(WISHES[one] for one in wishes)) <= told(brief), brief.text


@QUICK
@given(
    SETS,
    st.sampled_from(sorted(THINGS)),
    st.sampled_from(["No {}.", "There should be no {}.", "Leave out {}.", "It is free of {}."]),
    st.booleans(),
)
def test_what_is_denied_is_not_wished(wishes, thing, denial, first):
    brief = read_brief(town(wishes, denial.format(thing), first=first))
    assert not wished(brief, THINGS[thing]), brief.text
    assert set().union(*(WISHES[one] for one in wishes)) <= told(brief), brief.text


@QUICK
@given(SETS, st.sampled_from(sorted(THINGS)), st.sampled_from(MENTIONS), st.booleans())
def test_what_is_only_spoken_of_is_not_wished(wishes, thing, mention, first):
    brief = read_brief(town(wishes, mention.format(thing), first=first))
    assert not wished(brief, THINGS[thing]), brief.text
    assert set().union(*(WISHES[one] for one in wishes)) <= told(brief), brief.text


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A town with flat roofs in the north", "building.roof"),
        ("A small city. In the west, gabled houses of two floors.", "building.roof"),
        ("In the northern part the streets are cobbled and the houses low", "roads.surface"),
        ("A town with no buildings higher than 9 m within 50 m of the road", "building.height.max"),
        ("Old roofs are slate and new roofs are metal; a town with a church", "building.roof"),
        ("Hotels on the slope are white, those in the valley are stone", "building.material"),
        ("Four of the ten villas have red roofs; a village", "roof.color"),
        ("Add a landing pad on the flat roof of the five largest buildings", "building.roof"),
        ("A city with pads, marked with a big yellow H", "building.color"),
        ("A town with trees along the streets that are wider than 12 m", "roads.width.min"),
        ("A village of sixty houses, none on slopes steeper than 15 percent", "roads.slope.max"),
        ("A city at night; the shops are closed", "building.type"),
        ("A ghost town, its shops boarded up", "building.material"),
        ("Three bridges: one for trains, one for cars, in a town", "traffic"),
        ("Close the roads around the square to cars", "traffic"),
        ("A town with nothing to be hit by cars", "traffic"),
        ("The park is where people used to sit; a village", "pedestrians"),
        ("A town whose church bells ring at noon", "roads.rings"),
        ("A park that is empty today, in a town", "style"),
        ("A town with buses on the wide roads", "roads.width"),
        ("A village, vans outside the shops", "building.type"),
        ("A town; colour each building, red for under 20 metres", "building.height.max"),
        ("A town for training a segmentation network", "source"),
        ("Make every street touching the square narrow; a town", "roads.width"),
    ],
)
def test_no_scope_is_lost(text, key):
    brief = read_brief(text)
    assert key not in {slot.key for slot in brief.slots}
    assert brief.notes or brief.unread or brief.then


@pytest.mark.parametrize(
    ("text", "denied"),
    [
        ("A robot must keep away from ponds and dogs; a suburb with a park", set()),
        ("Keep it free of drones and power lines; a lake", {"drone", "power_line"}),
        ("Two rows of lime trees along the main street, no oaks", set()),
        ("Not a single car inside the city wall", set()),
        ("Leave out trees, furniture and people; a town", {"tree", "pedestrian"}),
        ("Cyclists should be able to avoid cars: a town with a park", set()),
        ("Everyone leaves the park; a town at night", set()),
    ],
)
def test_denials_reach_as_far_as_they_are_said(text, denied):
    brief = read_brief(text)
    assert {slot.value for slot in brief.negated} == denied
    assert not brief.kept
    assert not brief.conflicts


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ("A town with two shops and a church", {("shop.count", 2), ("element", "church")}),
        ("A town with 40 houses and a church", {("building.count", 40), ("element", "church")}),
        ("Leave a strip of meadow; 25 houses", {("element", "meadow"), ("building.count", 25)}),
        ("The streets are narrow and the houses are red, a village",
         {("roads.width", "narrow"), ("building.color", "red")}),
        ("In the village the houses are of stone", {("building.material", "stone")}),
        ("Flat-roofed white houses above the sea", {("building.color", "white")}),
    ],
)  # fmt: skip
def test_what_is_said_of_all_or_of_a_few_is_read_as_that(text, pairs):
    assert pairs <= told(read_brief(text))


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ("Friday evening, half past six", {("time", "18:30")}),
        ("A town at four in the afternoon", {("time", "16:00")}),
        ("At 7 o'clock in the morning trucks arrive and by evening they are gone",
         {("time", "07:00")}),
        ("A town at 2 at night", {("time", "02:00")}),
        ("A town at 11 at night", {("time", "23:00")}),
        ("A town, 07:30, evening papers on the street", {("time", "07:30")}),
        ("A town in the late morning", {("time", "11:00")}),
        ("A town, early on a summer morning", {("time", "07:00"), ("season", "summer")}),
        ("A town in late afternoon light", {("time", "golden_hour")}),
        ("A town early in the winter", {("season", "winter"), ("date", "12-10")}),
        ("A town in late October", {("season", "autumn"), ("date", "10-25")}),
    ],
)  # fmt: skip
def test_hours_and_days_are_in_their_part_of_the_day_and_the_year(text, pairs):
    brief = read_brief(text)
    keys = {key for key, _ in pairs}
    assert {pair for pair in told(brief) if pair[0] in keys} == pairs


def test_streets_across_avenues_contradict_nothing():
    brief = read_brief("Avenues run north to south and streets run east to west, a town")
    assert ("roads.main.axis", "north_south") in told(brief)
    assert not brief.conflicts


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ("A town with a plot ratio of at least 1.5 and a mean height of 18 m",
         {("plot.ratio.min", 1.5), ("height.mean", 18)}),
        ("A village, poplars along the river, lime trees in the streets",
         {("poplar.by", "river"), ("nature.species.streets", "lime")}),
        ("A town with trees around the pond", {("tree.by", "pond")}),
    ],
)  # fmt: skip
def test_a_scene_has_fields_for_ratios_means_and_rows(text, pairs):
    scene = scene_of(read_brief(text))
    said = {pair for item in scene.items() for pair in pairs_of(item)}
    assert pairs <= said


@pytest.mark.parametrize("place", ["Lagos", "the delta", ""])
def test_a_bound_before_how_things_look_says_which_and_is_no_limit(place):
    start = f"A town by {place} with" if place else "A town with"
    brief = read_brief(f"{start} every barn over 9 m in red brick and all houses below 8 m high")
    assert {key for key, _ in brief.items()} >= {"house.height.max"}
    assert not any(key in ("building.material", "barn.height.min") for key, _ in brief.items())


def test_a_number_takes_the_unit_of_the_one_before_or_none():
    found = read_brief("Buildings get lower, from 12 floors down to 2").items()
    assert {("building.floors.min", 2), ("building.floors.max", 12)} <= {*found}
    found = read_brief("A town with houses of 2 floors, up to 5 at the square").items()
    assert not any("count" in key for key, _ in found)
    found = read_brief("A village with houses of 2 to 4 floors, at most 30 of them").items()
    assert ("building.count.max", 30) in found


def test_a_skip_is_a_thing_behind_an_article_and_an_order_at_the_beginning():
    thing = [goal.predicate for goal in read_brief("A town with a skip outside the school").goals]
    assert "n(skip) >= 1" in thing
    assert "n(building, tag=school) == 0" not in thing
    order = [goal.predicate for goal in read_brief("A town, skip the trees").goals]
    assert order == ["n(tree) == 0"]
