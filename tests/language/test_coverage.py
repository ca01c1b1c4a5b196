"""Words that nothing of a reading stands for, things counted in parts, what holds of some alone."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cityx.agents.explain import explain
from cityx.errors import CityxError
from cityx.language.lexicon.phrases import entries
from cityx.language.reading import read_brief

PHRASES = sorted({one for *_, triggers in entries() for one in triggers.split(", ")})
FRAMES = ("every", "each", "all", "no", "only", "at least 3", "exactly", "anything", "keep the",
          "except", "10 m", "half of the", "and", ",", ".", "with", "a", "two", "the")  # fmt: skip


def told(text, **given):
    return " ".join(read_brief(text, **given).told)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("A grid of one-way streets alternating direction", ("alternating", "direction")),
        ("A hospital with an entrance that ambulances can reach", ("reach",)),
        ("A downtown with an alley running behind every block", ("alley", "running")),
        ("Two towns, make that one the same height as the second.", ("second",)),
        ("A harbour with stacks of containers in mixed colours", ("mixed",)),
        ("A suburb, roads around the school closed to cars", ("roads",)),
        ("A village where all can see the church from the street", ("street",)),
        ("A town at noon, cars held at the lights while they cross", ("held",)),
    ],
)
def test_what_a_rule_takes_and_makes_nothing_of_is_named(text, words):
    for word in words:
        assert word in told(text)


@pytest.mark.parametrize(
    "text",
    [
        "A beach town with palm trees along the streets",
        "Two rivers that meet in the middle",
        "sunny, with snow on the roofs",
        "buses make up 20 % of the traffic",
        "12 motorcycles driving along the road at 15 m/s",
        "A town of brick houses, each with two floors, on a rainy evening",
    ],
)
def test_words_that_a_reading_stands_for_are_not_named(text):
    assert not read_brief(text).words_unread


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ("two primary schools and a high school", {("school.count", 3)}),
        ("three road bridges and two footbridges", {("bridge.count", 5)}),
        ("20 detached houses and 30 semis", {("house.count", 50)}),
        ("120 semis, 4 shops and 30 detached houses", {("house.count", 150), ("shop.count", 4)}),
        ("a church and a chapel", {("church.count", 2)}),
    ],
)
def test_one_kind_of_things_that_is_counted_in_parts_is_summed_up(text, pairs):
    slots = {(slot.key, slot.value) for slot in read_brief(text).slots}
    assert pairs <= slots
    assert sum(key.endswith(".count") for key, _ in slots) == len(pairs)


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A hospital campus with a main building of 7 floors", "building.floors"),
        ("A village with cars honking outside the school", "traffic"),
        ("A city, towers near the biggest junctions", "building.type"),
    ],
)
def test_what_is_said_of_some_alone_is_not_put_on_all(text, key):
    brief = read_brief(text)
    assert all(not slot.key.startswith(key) for slot in brief.slots)
    assert "of some alone" in " ".join(brief.told)


@pytest.mark.parametrize(
    "text",
    ["Low white houses above the sea", "villas by a lake", "brick houses on a suburban estate"],
)
def test_where_a_town_lies_does_not_narrow_its_buildings(text):
    assert "of some alone" not in told(text)


@pytest.mark.parametrize("name", ["a primary school", "a corner shop", "a footbridge"])
def test_names_that_say_more_than_what_is_built_are_told(name):
    assert f'"{name.removeprefix("a ")}" is built as any' in told(f"A suburb with {name}")


def test_an_exact_measure_of_each_binds_on_both_sides():
    brief = read_brief("Every building is exactly 12 m tall, the tallest one is the 40 m town hall")
    values = {slot.key: slot.value for slot in brief.slots}
    assert values["building.height.min"] == values["building.height.max"] == 12
    assert values["town_hall.height"] == 40
    assert [one.code for one in brief.conflicts] == ["above_all:town_hall"]


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(st.lists(st.one_of(st.sampled_from(FRAMES), st.sampled_from(PHRASES)), max_size=14))
def test_any_words_are_explained_or_refused_in_a_sentence(words):
    text = " ".join(words)
    try:
        found = explain(text, [])
    except CityxError as error:
        found = {"text": text, "brief": str(error)}
    assert found["text"] == text
    assert found["brief"]


@pytest.mark.parametrize(
    "text",
    [
        "Strip out anything modern and surround the mount with water",
        "Each building under 3 floors is replaced by a pocket park",
        "everything european, every quarter industrial",
    ],
)
def test_what_is_said_of_everything_fits_the_schema(text):
    assert explain(text, [])["scene"] is not None


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("A resort, the promenade is packed, sunny", "density"),
        ("A town at dusk, bumper to bumper from the bridge to the edge of town", "traffic"),
    ],
)
def test_what_is_told_of_one_place_is_not_put_on_all(text, key):
    brief = read_brief(text)
    assert all(slot.key != key for slot in (*brief.slots, *brief.negated))
    assert "in one place alone" in " ".join(brief.told)


def test_the_storeys_of_one_building_are_its_own():
    slots = {slot.key: slot.value for slot in read_brief("office block 10 floors").slots}
    assert slots == {"office.floors": 10, "office.count.min": 1}


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("only the 500 x 400 metres around the middle of the map", (500, 400)),
        ("Just the central 300 by 300 m please", (300, 300)),
        ("only what lies within 250 m of the centre", (500, 500)),
        ("I only need a 400 m square around the middle", (400, 400)),
        ("Take the map and limit it to the inner 600 x 400 m", (600, 400)),
        ("just add a park of 40 x 40 m in the centre", None),
        ("Only show buildings within 100 m of the church", None),
        ("keep only the trees within 20 m of the river", None),
    ],
)
def test_what_of_a_map_is_built_is_read(text, size):
    slots = {slot.key: slot.value for slot in read_brief(text, inputs=[("m.osm", "osm")]).slots}
    assert (size or (None, None)) == (slots.get("size.x"), slots.get("size.y"))


@pytest.mark.parametrize(
    ("text", "denied"),
    [
        ("A town of houses, no house sharing a wall with another", ()),
        ("A town, no street may run south", ()),
        ("A town, no cars may be parked on the pavement", ()),
        ("A campus. No cars inside; two car parks at the edge", ()),
        ("A town, no cars should be visible", ("vehicle",)),
        ("A town without cars", ("vehicle",)),
    ],
)
def test_what_things_are_not_to_do_does_not_deny_them(text, denied):
    assert tuple(slot.value for slot in read_brief(text).negated) == denied


@pytest.mark.parametrize(
    ("text", "key", "word"),
    [
        ("There are no buildings in it, fill it with houses", "not", "buildings"),
        ("Vineyards on the slopes if the map has them", "element", "Vineyards"),
        ("Don't touch anything south of the river", "keep", "anything"),
        ("Raise each block of flats by two floors and put a green roof on it", "building.roof",
         "green roof"),
    ],
)  # fmt: skip
def test_what_a_map_shows_or_may_have_is_no_wish(text, key, word):
    brief = read_brief(text, inputs=[("m.osm", "osm")])
    slots = [slot for slot in (*brief.slots, *brief.negated, *brief.kept) if slot.key == key]
    assert all(slot.value in ("river", "house") for slot in slots)
    assert f'"{word}' in " ".join(brief.told)


def test_names_inside_a_sentence_are_not_mended():
    assert "port" not in {slot.value for slot in read_brief("An extract of Porto Alegre").slots}
    assert "Porto" in " ".join(read_brief("An extract of Porto Alegre").told)


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ("Delivery vans only between 5 and 7 am", "time", "between 5 and 7 am"),
        ("A square, no vehicles until 4 pm", "time", "4 pm"),
        ("A city, outer ring 2, middle ring 4", "roads.rings", "2"),
        ("Hong Kong streets and a green mountain behind", "building.color", "green"),
        ("A logistics park with truck parking", "agent", "truck"),
        ("A highway and a motel with a neon sign", "lights", "neon sign"),
        ("A blizzard, snow on roofs and cars", "traffic", "cars"),
        ("A campus, no cars inside the campus", "not", "cars"),
    ],
)
def test_what_words_say_of_something_else_is_left_open(text, key, words):
    brief = read_brief(text)
    values = [slot.value for slot in (*brief.slots, *brief.negated) if slot.key == key]
    assert values in ([], [1])
    assert f"{words}" in " ".join(brief.told)


def test_one_thing_each_so_many_metres_is_no_single_one():
    slots = {slot.key for slot in read_brief("One plane tree every 12 m along the streets").slots}
    assert "nature.spacing" in slots
    assert not any(key.startswith("tree.count") for key in slots)


def test_a_list_of_what_is_to_be_left_alone_is_kept_whole():
    brief = read_brief("Leave schools, churches and parks alone", inputs=[("m.osm", "osm")])
    assert [slot.value for slot in brief.kept] == ["school", "church", "park"]


def test_a_plot_for_houses_is_the_site():
    brief = read_brief("100 houses on a plot 50 m by 50 m")
    assert "too_many:building" in {one.code for one in brief.conflicts}


def test_what_somebody_does_is_no_command():
    brief = read_brief("A man waits for the green man at each crossing, overcast")
    assert not brief.then


@pytest.mark.parametrize(
    ("text", "pair", "word"),
    [
        ("A village with every second street one-way", ("oneway.share", 0.5), ""),
        ("A park with exactly 14 lime trees", ("tree.count", 14), "lime trees"),
        ("Two bakeries opposite a small round park", ("bakery.count", 2), "round"),
        ("A pier 40 m long and no cars", ("not", "vehicle"), ""),
    ],
)
def test_kinds_and_shapes_beside_a_number_are_read_or_named(text, pair, word):
    brief = read_brief(text)
    pairs = {(slot.key, slot.value) for slot in (*brief.slots, *brief.negated)}
    assert pair is None or pair in pairs
    assert "bakery.relation" not in {key for key, _ in pairs}
    assert word in " ".join(brief.told)


def test_what_lies_on_one_side_is_not_all_that_goes():
    brief = read_brief("leave out everything west of Wardour Street", inputs=[("m.osm", "osm")])
    assert not brief.negated
    assert '"everything" (denied in one part alone)' in " ".join(brief.told)


@pytest.mark.parametrize(
    ("text", "denied", "asked"),
    [
        ("The abbey stays. Take away all car parks and buses, sea all round",
         ("parking_lot", "bus"), "sea"),
        ("Clear all trees and benches, a fountain", ("tree", "bench"), "fountain"),
        ("Drop all trees and cars and people, a pond", ("tree", "vehicle", "pedestrian"), "pond"),
    ],
)  # fmt: skip
def test_orders_to_take_away_deny_what_they_list(text, denied, asked):
    brief = read_brief(text, inputs=[("m.osm", "osm")])
    assert tuple(slot.value for slot in brief.negated) == denied
    assert asked in {slot.value for slot in brief.slots}


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("Crash barriers on both sides of the main roads, 1 m high", "building.height"),
        ("A roundabout, traffic keeps left", "traffic"),
        ("A town, every third house is red", "building.color"),
        ("A town. No lamp posts blocking the walkways", "not"),
    ],
)
def test_what_is_said_of_no_building_is_not_put_on_buildings(text, key):
    brief = read_brief(text)
    assert all(slot.key != key for slot in (*brief.slots, *brief.negated))


@pytest.mark.parametrize(
    ("text", "slots"),
    [
        ("Protected bike lanes on the main streets", {"cycle_track.main.share": 1}),
        ("Cycle tracks on all streets", {"cycle_track.share": 1}),
    ],
)
def test_cycle_tracks_are_those_of_streets_and_no_later_command(text, slots):
    brief = read_brief(text)
    assert {slot.key: slot.value for slot in brief.slots} == slots
    assert not brief.then
    assert not brief.told
