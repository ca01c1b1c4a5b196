"""What is ordered away is denied; questions, purposes and parts of things are left by name."""

import pytest

from cityx.language import read_brief


def read(text, **more):
    return read_brief(text, **more)


def left(brief):
    return " ".join(note.text for note in brief.notes if note.code == "left_open")


def keys(brief):
    return {slot.key for slot in brief.slots}


@pytest.mark.parametrize(
    "text",
    [
        "Build the map, drop all trees and benches.",
        "Use the extract but leave out the trees and the benches",
        "Ignore trees and benches of the map, at dusk",
    ],
)
def test_an_order_to_leave_something_out_denies_it(text):
    brief = read(text, inputs=[("a.osm", "osm")])
    assert {slot.value for slot in brief.negated} == {"tree", "bench"}
    assert "nature.trees" not in keys(brief)


@pytest.mark.parametrize(
    ("text", "quote"),
    [
        ("A town, and show me which pavements are narrower than 1.5 m",
         "show me which pavements are narrower than 1.5 m"),
        ("Tell me how many houses get wet at the river. A village in fog",
         "Tell me how many houses get wet at the river"),
        ("A village with benches, so that people can rest", "so that people can rest"),
        ("Paint the roofs by height, a village at noon", "Paint the roofs by height"),
    ],
)  # fmt: skip
def test_a_clause_that_asks_for_no_thing_is_left_as_a_whole(text, quote):
    brief = read(text)
    assert any(text[slice(*note.span)] == quote for note in brief.notes)
    assert not keys(brief) & {"sidewalk.width.max", "pedestrians", "building.count", "river"}


@pytest.mark.parametrize(
    "text",
    [
        "One of the streets is closed to cars",
        "A town where half of the streets are free of cars",
        "A town with a motorway, the others without cars",
    ],
)
def test_what_is_denied_of_some_is_not_denied_of_all(text):
    assert not read(text).negated


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("Cars on two of the busier streets of a town", "roads.count"),
        ("A roundabout, four roads leading away from it", "roads.count"),
        ("Streets that get steeper from west to east", "roads.main.axis"),
        ("A town with side streets every 80 m", "nature.spacing"),
        ("A river, twelve metres lower than the town", "river.width"),
        ("A harbour with one motorway slip road", "roads.motorways"),
        ("A city with a clear business district", "weather"),
        ("Land use changing in rings", "roads.rings"),
        ("A flat test area with a 6 % ramp street", "apartment.share"),
        ("Turn a quarter of the green into allotments", "green.share"),
        ("A town with a square and a town hall on its north side", "town_hall.side"),
        ("A village where some houses are white and the rest are brick", "brick.share"),
        ("A town with a square where only shops stand", "building.type"),
        ("Half of the roofs should be green, at noon", "green.share"),
        ("Half of the roofs are red and the other half dark grey", "roof.color"),
        ("A hospital with wide access roads", "roads.width"),
        ("120 dwellings, two thirds of them in terraces", "terrain"),
        ("80 houses, the rest in blocks of at most four storeys", "building.floors.max"),
        ("Give the kids a village with a castle", "pedestrians"),
    ],
)  # fmt: skip
def test_what_is_said_of_a_part_or_another_thing_is_not_bent(text, key):
    brief = read(text)
    assert key not in keys(brief)
    assert left(brief) or brief.words_unread


def test_what_is_near_what_is_denied_is_not_denied():
    denied = {
        "A hospital, no steep streets nearby": set(),
        "A school street, closed to cars between two bollards": {"vehicle"},
        "Some trees, but none within 10 m of the road": set(),
    }
    for text, words in denied.items():
        assert {slot.value for slot in read(text).negated} == words


def test_a_place_that_is_left_open_tells_of_what_it_is():
    text = "A park with six towers around the pond"
    note = next(note for note in read(text).notes if note.of is not None)
    assert text[slice(*note.span)] == "around the pond"
    assert text[slice(*note.of)] == "six towers"


@pytest.mark.parametrize(
    ("text", "denied"),
    [
        ("A square with bicycles instead of cars", "vehicle"),
        ("A quay with palms rather than people", "pedestrian"),
        ("A village with carriages in place of cars", "vehicle"),
    ],
)
def test_what_gives_way_to_another_is_denied(text, denied):
    assert denied in [slot.value for slot in read(text).negated]


@pytest.mark.parametrize(
    "text",
    ["A square with a fountain in the middle", "A plaza that has a statue in its centre",
     "A park with a fountain in the middle, at noon"],
)  # fmt: skip
def test_the_middle_of_a_place_is_not_that_of_the_town(text):
    found = {(slot.key.partition(".")[2], slot.value) for slot in read(text).slots}
    assert ("relation", "in") in found
    assert ("side", "middle") not in found


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("A village with a pub at the end of the lane", "at the end of the lane"),
        ("A path from the bridge to the church", "from the bridge"),
        ("A town with a school. Put a zebra crossing there.", "there"),
        ("A street with one neon-lit boutique at night", "one"),
    ],
)
def test_no_place_is_lost_in_silence(text, word):
    brief = read(text)
    said = [text[slice(*note.span)] for note in brief.notes] + list(brief.words_unread)
    assert any(one in word or word in one for one in said), said


def test_the_place_of_a_map_is_no_style():
    text = "Here is central London, at noon"
    assert "style" not in keys(read(text, inputs=[("a.osm", "osm")]))
    assert "style" in keys(read("English houses, at noon", inputs=[("a.osm", "osm")]))


def test_lanes_are_those_of_the_street_that_is_told_of():
    assert "roads.main.lanes" in keys(read("An avenue with a tram, two lanes each way"))


@pytest.mark.parametrize(
    "text", ["Only the streets, please", "The extract at dusk, just the roads of it",
             "Build the map, but only the streets."],
)  # fmt: skip
def test_only_the_streets_of_a_map_are_no_buildings(text):
    assert "building" in [s.value for s in read(text, inputs=[("a.osm", "osm")]).negated]
    assert "building" not in [s.value for s in read(text).negated]
    mapped = read(text, inputs=[("a.osm", "osm")])
    assert not any("iou(building" in goal.predicate for goal in mapped.goals)


@pytest.mark.parametrize(
    "text",
    ["Make the residential parts two-storey row houses",
     "Turn the built areas into two-storey houses", "The painted areas become two-storey houses"],
)  # fmt: skip
def test_storeys_before_houses_are_those_of_the_houses(text):
    floors = {slot.key: slot.value for slot in read(text, inputs=[("a.png", "semantic")]).slots}
    assert 2 in [value for key, value in floors.items() if key.endswith("floors")]


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("Brick houses by the water; behind them, plain white two-storey houses", "terrain"),
        ("Villas by the river. Around them, houses of two floors", "building.floors"),
        ("I need streets of three kinds", "roads.count"),
        ("Boulevards, 10 m side streets and 4 m lanes", "roads.width"),
        ("Mountains, green in the valley", "building.color"),
        ("A village with a road winding down to a lake", "roads.pattern"),
        ("Small plots with hedges", "size"),
        ("A square with two boutiques and a town hall", "building.count"),
        ("The northern half is a forest, the rest houses", "green.share"),
        ("One skyscraper surrounded by low shops", "building.height"),
        ("Factories along the railway, workers' houses, villas on the hill", "villa.count"),
    ],
)
def test_what_stands_in_one_place_says_nothing_of_the_whole(text, key):
    brief = read(text)
    assert key not in keys(brief)
    assert left(brief) or brief.words_unread


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("35 % of the ground built on, at least a quarter green", "building.color"),
        ("A monastery reached by a winding track", "roads.pattern"),
        ("Three skyscrapers, everything around them at most five floors", "building.floors.max"),
        ("Half the shops are closed", "shop.share"),
        ("A pond with two benches under an old oak", "nature.species"),
    ],
)
def test_a_share_a_track_an_oak_are_not_all_there_is(text, key):
    brief = read(text)
    assert key not in keys(brief)
    assert left(brief)


def test_a_place_where_something_is_not_to_be_is_there():
    brief = read("A town with a school near the park, not near the main road")
    assert not brief.negated
    assert "where something is not to be" in left(brief)


@pytest.mark.parametrize(
    ("text", "never"),
    [
        ("A town, no car traffic within fifty metres of the water", "water"),
        ("A town, no trees within 30 m of the station", "station"),
        ("A town, no houses closer than 50 m to the lake", "house"),
        ("A town, no houses or shops near the river", "house"),
        ("A town with no kiosks or benches along the canal", "bench"),
    ],
)
def test_what_is_denied_in_one_place_is_not_denied_everywhere(text, never):
    brief = read(text)
    assert never not in {slot.value for slot in brief.negated}
    assert not any(key.endswith(".by") for key in keys(brief))
    assert left(brief) or brief.words_unread


@pytest.mark.parametrize(
    "text",
    ["Rain and fog in a town", "A snowy, misty village", "A rain-soaked grey town in low fog"],
)
def test_fog_beside_rain_or_snow_says_how_far_one_sees(text):
    brief = read(text)
    assert not brief.conflicts
    assert brief.value("visibility.max") == 1000
    assert brief.value("weather") in ("rain", "snow")


@pytest.mark.parametrize(
    "text", ["Outskirts: strip malls and parking lots", "A street, drop kerbs", "A yard; skip hire"]
)
def test_a_strip_a_drop_and_a_skip_are_also_things(text):
    assert not read(text).negated


@pytest.mark.parametrize("text", ["Strip the trees", "drop all trees", "skip the trees"])
def test_what_is_ordered_away_is_denied(text):
    assert [slot.value for slot in read(f"A town; {text}").negated] == ["tree"]


@pytest.mark.parametrize(
    ("text", "removed", "kept"),
    [
        ("No parked cars, lamps and trees stay", {"parked_vehicle"}, {"streetlight", "tree"}),
        ("Remove the benches, the bins remain", {"bench"}, {"waste_basket"}),
        ("Remove the trees; the church stays", {"tree"}, {"church"}),
    ],
)
def test_what_stays_is_not_changed(text, removed, kept):
    brief = read_brief(text, base=True)
    assert {edit.target.kind for edit in brief.edits} == removed
    assert {slot.value for slot in brief.kept} == kept


@pytest.mark.parametrize(
    ("text", "time"),
    [
        ("Friday evening, half past six, drizzle", "18:30"),
        ("a market at half past four in the afternoon", "16:30"),
        ("half past six in the morning", "06:30"),
    ],
)
def test_clocks_are_of_the_part_of_the_day_that_is_said(text, time):
    assert read(text).value("time") == time


@pytest.mark.parametrize(
    "text",
    ["A deserted town with two people", "An empty street, three pedestrians", "Deserted, 5 people"],
)
def test_a_deserted_town_may_have_the_people_that_are_counted(text):
    brief = read(text)
    assert not brief.conflicts
    assert brief.value("pedestrian.count")


@pytest.mark.parametrize(
    "text",
    ["Children in groups of two to five by the school", "Cars in pairs of two, a church",
     "Trees in rows of eight at the church"],
)  # fmt: skip
def test_the_size_of_groups_counts_nothing_else(text):
    brief = read(text)
    assert not any(".count" in key for key in keys(brief))
    assert left(brief)


def test_what_replaces_a_surface_is_no_tree():
    brief = read("A street with cobbles instead of asphalt and plane trees down the middle")
    assert "tree" not in {slot.value for slot in brief.negated}
