"""What is said of some buildings alone: those of a kind in one place, or added to a map."""

import pytest

from cityx.agents.models.brief_maker import corrected, faults_in
from cityx.checks.predicates.parser import parse
from cityx.language.reading import read_brief
from cityx.language.scene import Buildings, Scene, pairs_of, scene_of

RIVER = 'building, type=house, near="50 m of river"'


def said(text, **more):
    return {slot.key: slot.value for slot in read_brief(text, **more).slots}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "A river valley town in which exactly 30 houses stand within 50 m of the bank.",
            {"house within 50 m of river.count": 30},
        ),
        (
            "Ten villas (two storeys, slate roofs) within 90 m of the lake.",
            {
                "villa within 90 m of lake.count": 10, "villa within 90 m of lake.floors": 2,
                "villa within 90 m of lake.roof": "slate",
            },
        ),
        (
            "In the south there are 14 blocks of flats.",
            {"apartment in south.count": 14},
        ),
        (
            "The western half has 30 white bungalows.",
            {"bungalow in west_half.count": 30, "bungalow in west_half.color": "white"},
        ),
        (
            "A suburb: the west half has only bungalows, the east half only slab blocks of 8 "
            "storeys.",
            {
                "bungalow.part": "west_half", "apartment.part": "east_half",
                "apartment in east_half.floors": 8,
            },
        ),
        (
            "A town of houses with six glass office blocks of 5 to 7 floors.",
            {
                "office.count": 6, "office.material": "glass", "office.floors.min": 5,
                "office.floors.max": 7,
            },
        ),
        (
            "40 houses, ten of them within 50 m of the river.",
            {"building.count": 40, "house within 50 m of river.count.min": 10},
        ),
        (
            "White houses in the east, yellow houses in the west.",
            {"house in east.color": "white", "house in west.color": "yellow"},
        ),
    ],
)  # fmt: skip
def test_what_is_said_of_some_is_of_these_alone(text, told):
    found = said(text)
    assert told.items() <= found.items()
    others = ("building.floors", "building.material", "building.roof", "building.color")
    assert not [key for key in found if key.startswith(others)]


def test_buildings_are_added_to_a_map_and_those_of_the_map_stay():
    brief = read_brief(
        "Keep the mapped houses and add 25 houses in a row along the main road, one or two "
        "storeys, with clay tile roofs.", inputs=[("m.osm", "osm")],
    )  # fmt: skip
    group = "added house within 60 m of main_street"
    assert {(s.key, s.value) for s in brief.slots if s.key.startswith(group)} == {
        (f"{group}.count", 25), (f"{group}.floors.min", 1), (f"{group}.floors.max", 2),
        (f"{group}.roof", "tile"),
    }  # fmt: skip
    assert "row" in brief.words_unread


def test_a_group_is_measured_on_its_buildings_alone():
    brief = read_brief("12 houses of two floors with red roofs within 50 m of the river.")
    goals = {goal.predicate for goal in brief.goals}
    assert goals >= {
        f"n({RIVER}) == 12", f"stat({RIVER}, floors, min) >= 2", f"stat({RIVER}, floors, max) <= 2",
        f"share({RIVER}, roof_color=red) >= 0.95",
    }  # fmt: skip
    assert all(parse(goal) for goal in goals)


@pytest.mark.parametrize(
    "text",
    ["A town with 20 cottages along the river.", "A town with five brick factories in the east."],
)
def test_a_group_goes_through_a_scene(text):
    brief = read_brief(text)
    told = {pair for item in scene_of(brief).items() for pair in pairs_of(item)}
    assert {(slot.key, slot.value) for slot in brief.slots} <= told


def test_a_model_says_a_group_in_one_item():
    text = "Six glass offices within 40 m of the square and a hotel of 12 floors."
    one = Buildings(
        said=["Six glass offices within 40 m of the square"], kind="office", count=6,
        material="glass", by="plaza", within=40,
    )  # fmt: skip
    brief = read_brief(text)
    assert not faults_in(Scene(buildings=[one]), brief, text)
    found, _ = corrected(brief, Scene(buildings=[one]), {})
    assert {(slot.key, slot.value) for slot in found.slots} == {
        ("office within 40 m of plaza.count", 6), ("office within 40 m of plaza.material", "glass"),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("item", "fault"),
    [
        (
            Buildings(said=["30 houses within 50 m"], kind="house", count=30, within=50),
            'buildings: "within" needs a place, in by.',
        ),
        (
            Buildings(said=["towers within 50 m"], kind="tower", by="river", within=50),
            'buildings: nothing measures "within" or "added" of tower; of apartment, bungalow, '
            "cottage, factory, house, office, shop, terrace, villa, warehouse it does.",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_said_of_a_group_is_refused_by_name(item, fault):
    text = "30 houses within 50 m and towers within 50 m of the river."
    assert fault in faults_in(Scene(buildings=[item]), read_brief(text), text)


def test_bounds_of_a_group_and_of_all_must_go_together():
    brief = read_brief(
        "Nothing taller than five floors. In the east stand four blocks of flats of nine storeys."
    )
    assert [one.code for one in brief.conflicts] == ["above_all:apartment in east"]


def groups_in(text, **more):
    """Return what was read of some buildings alone."""
    told = said(text, **more)
    return {key: value for key, value in told.items() if " " in key or key.endswith(".part")}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        # What stands in the place that follows is not what stands before it.
        ("A village with 40 houses, in the north a park.", {"park.side": "north"}),
        ("50 houses with red roofs, and in the south a lake.", {"lake.side": "south"}),
        ("A village of 40 houses, near the church a school.", {"building.count": 40}),
        ("60 houses, at the edge a factory", {"building.count": 60}),
        ("Five shops, near the station a hotel", {"building.count": 5}),
        ("Forty houses (in the middle a church)", {"building.count": 40}),
        ("40 houses, by the lake a chapel", {"building.count": 40}),
        ("40 houses, along the river, and a church.", {"building.count": 40}),
        # What is no part of the town.
        ("A hamlet of 12 houses in the middle of a forest.", {"building.count": 12}),
        ("15 villas in the middle of the park.", {"building.count": 15}),
        ("20 houses in the centre of the island.", {"building.count": 20}),
        ("20 shops in the middle of the bridge.", {"shop.count": 20}),
        ("30 houses in the northern half of the park.", {"building.count": 30}),
        ("12 shops in the west wing of the station.", {"building.count": 12}),
        ("40 houses on the south coast.", {"building.count": 40}),
        ("12 cottages on the north bank of the river.", {"building.count": 12}),
        ("20 villas at the edge of the forest.", {"building.count": 20}),
        ("12 villas in the eastern hills.", {"building.count": 12}),
        ("In the middle of the park stand five shops.", {"building.count": 5}),
        # What is only spoken of.
        ("If there were 30 houses near the river, they would be flooded.", {}),
        ("I want to know how a village of 40 houses by a river looks.", {}),
        ("60 houses where 20 houses near the river burned down.", {"building.count": 60}),
        ("I live in one of 20 houses near the river.", {}),
        ("20 houses near the lake were flooded.", {"building.count": 20}),
        ("I photographed 20 houses near the river.", {"building.count": 20}),
        ("We once had 20 houses near the river.", {"building.count": 20}),
        ("My 20 houses near the river look old.", {"building.count": 20}),
        ("A path from the 20 houses near the river to the park.", {"building.count": 20}),
        ("A bridge for 20 houses near the river.", {"building.count": 20}),
        # A look that is not measured of some, or all of several kinds.
        ("20 tall houses along the river.", {"building.count": 20}),
        ("20 low white houses along the river.", {"building.count": 20}),
        (
            "60 houses and 20 villas, all within 100 m of the lake.",
            {"house.count": 60, "villa.count": 20},
        ),
        # A place of its own, or more than one.
        ("10 houses on stilts near the beach.", {"building.count": 10}),
        ("20 houses near the church and the school.", {"building.count": 20}),
        ("40 houses near a church and a school.", {"building.count": 40}),
        ("40 houses near the lake and near the school.", {"building.count": 40}),
        ("10 houses near St Mary's church.", {"building.count": 10}),
        ("Five bungalows next to the big church.", {"building.count": 5}),
        # Those of a place are not said to be most of their kind.
        ("The houses in the east half are of brick.", {}),
        ("The houses in the north half have red roofs.", {}),
    ],
)  # fmt: skip
def test_where_it_is_not_certain_no_place_is_asked_of_some(text, told):
    found = said(text)
    assert not groups_in(text)
    assert told.items() <= found.items()
    looks = ("building.height", "building.color", "building.material")
    assert not [key for key in found if key.startswith(looks)]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "In the east half of the town 40 houses, in the west half a factory.",
            {"house in east_half.count": 40},
        ),
        (
            "In the north of the town 30 houses and in the south 10 villas.",
            {"house in north.count": 30, "villa in south.count": 10},
        ),
        (
            "In the centre of the town 12 shops, at the edge 30 houses.",
            {"shop in center.count": 12, "house in edge.count": 30},
        ),
        (
            "Thirty houses and near the lake five villas.",
            {"villa within 60 m of lake.count": 5},
        ),
        ("In the middle of the village stand five shops.", {"shop in center.count": 5}),
        ("Exactly 30 houses in the western half.", {"house in west_half.count": 30}),
        ("20 cottages at the edge of town.", {"cottage in edge.count": 20}),
        (
            "20 houses in the north near the river.",
            {"house in north within 60 m of river.count": 20},
        ),
        (
            "In the west 40 houses along the canal.",
            {"house in west within 60 m of canal.count": 40},
        ),
        ("30 houses near the station in the north.", {"house within 60 m of station.count": 30}),
        ("40 houses along the river and a church.", {"house within 60 m of river.count": 40}),
        ("A town of 40 houses, near the river.", {"house within 60 m of river.count": 40}),
        (
            "A town where 30 houses stand within 50 m of the river.",
            {"house within 50 m of river.count": 30},
        ),
        (
            "White houses within 80 m of the beach.",
            {"house within 80 m of beach.color": "white"},
        ),
    ],
)  # fmt: skip
def test_a_place_before_or_behind_is_that_of_its_clause(text, told):
    brief = read_brief(text)
    assert groups_in(text) == told
    assert not brief.words_unread


@pytest.mark.parametrize(
    ("text", "left", "count"),
    [
        ("20 houses along the river, five of them white.", "five of them white", 20),
        ("20 houses near the lake, two of them of timber.", "two of them of timber", 20),
        ("12 offices in the centre, three of them towers.", "three of them towers", 12),
        ("20 houses along the river, 10 along the canal.", "10 along the canal", 20),
        ("20 houses in the north, 20 in the south.", "20 in the south", 20),
        ("30 houses by the lake, ten with red roofs.", "ten with red roofs", 30),
    ],
)
def test_what_is_said_of_some_of_a_group_is_left_open_by_name(text, left, count):
    brief = read_brief(text)
    assert list(groups_in(text).values()) == [count]
    assert not [one for one in brief.slots if one.key.startswith(("building.", "roof."))]
    assert any(note.text.startswith(f'"{left}" (some of the') for note in brief.notes)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("At most ten houses; 20 houses near the river.", "min_over_max:building.count"),
        (
            "A village of 20 houses, 30 of them within 50 m of the river.",
            "min_over_max:building.count",
        ),
        ("A town of at most 50 buildings, 60 villas by the lake.", "min_over_max:building.count"),
        ("No shops. 20 shops in the north.", "denied_and_wanted:shop"),
        ("No buildings, but 20 shops in the north.", "denied_and_wanted:building"),
    ],
)
def test_a_group_goes_together_with_all_there_may_be(text, code):
    assert [one.code for one in read_brief(text).conflicts] == [code]


def test_all_of_a_kind_beside_a_group_of_another_are_counted_by_their_kind():
    found = said("A village of 20 houses and 30 villas along the river.")
    assert found["house.count"] == 20
    assert found["villa within 60 m of river.count"] == 30
    assert "building.count" not in found
    found = said("100 houses, all within 300 m of a school.")
    assert found["house within 300 m of school.count"] == found["house.count"] == 100


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("The 30 houses near the river get new roofs.", {}),
        ("Show the 12 houses near the river, and place benches.", {}),
        ("Add a school for the 12 houses near the river.", {}),
        ("Where 12 houses near the river stood, build a park.", {}),
        ("New trees in front of 12 houses near the river.", {}),
        ("The map with the 12 houses near the lake in winter, plus snow.", {}),
        ("A school near 20 new houses.", {}),
        ("Build a fence around 12 houses near the river.", {}),
        ("The market place: 12 shops near the church.", {}),
        (
            "25 houses added along the main road.",
            {"added house within 60 m of main_street.count": 25},
        ),
        (
            "The map plus 15 cottages at the edge of town.",
            {"added cottage in edge.count": 15},
        ),
        ("In the north add 12 houses.", {"added house in north.count": 12}),
        (
            "20 new houses near the river and a school.",
            {"added house within 60 m of river.count": 20},
        ),
        (
            "Please place 12 cottages by the lake.",
            {"added cottage within 60 m of lake.count": 12},
        ),
    ],
)  # fmt: skip
def test_on_a_map_only_what_is_said_to_be_added_is(text, told):
    assert groups_in(text, inputs=[("m.osm", "osm")]) == told
