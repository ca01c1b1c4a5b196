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
            {"bungalow in west.count": 30, "bungalow in west.color": "white"},
        ),
        (
            "A suburb: the west half has only bungalows, the east half only slab blocks of 8 "
            "storeys.",
            {"bungalow.part": "west", "apartment.part": "east", "apartment in east.floors": 8},
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
        f"share({RIVER}, roof_color=red) >= 0.6",
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
