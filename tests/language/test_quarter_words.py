"""Buildings of a kind in a part of a town, or beside something in it, as sentences say it."""

import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.language.scene import pairs_of, scene_of
from cityx.protocol.serving import DO


def quarters(text):
    brief = read_brief(text)
    done = [args for action, args in slots_of_brief(brief)[DO] if action == "layout/quarter-v1"]
    return {(args["kind"], args.get("part", args.get("near"))) for args in done}, brief


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("A town with shops around the square", {("shop", "plaza")}),
        ("Terraced houses line up along the river", {("terrace", "river")}),
        ("A town whose square is surrounded by shops and offices",
         {("shop", "plaza"), ("office", "plaza")}),
        ("Warehouses by the railway and a station", {("warehouse", "railway")}),
        ("Offices in the north, houses in the south", {("office", "north"), ("house", "south")}),
        ("In the east stand factories, in the west bungalows",
         {("factory", "east"), ("bungalow", "west")}),
        ("Villas on the outskirts and flats in the middle of the town",
         {("villa", "edge"), ("apartment", "center")}),
        ("Bungalows at the edge of town", {("bungalow", "edge")}),
        ("A main street lined with shops", {("shop", "main_street")}),
    ],
)  # fmt: skip
def test_a_kind_in_a_place_becomes_a_quarter(text, found):
    got, brief = quarters(text)
    named = {(kind, "center" if place == "center" else place) for kind, place in found}
    assert got == named
    assert "building.type" not in {slot.key for slot in brief.slots}
    shares = [g for g in brief.goals if g.predicate.startswith(("part_share(", "near_share("))]
    assert len(shares) == len(found)
    told = {pair for item in scene_of(brief).items() for pair in pairs_of(item)}
    assert {(s.key, s.value) for s in brief.slots if s.key.endswith((".by", ".part"))} <= told


@pytest.mark.parametrize(
    "text",
    [
        "A town with houses behind the church", "A town, no shops around the square",
        "A house by the river", "A town with houses between the park and the lake",
    ],
)  # fmt: skip
def test_what_is_more_than_a_quarter_is_left_open_or_denied(text):
    got, brief = quarters(text)
    assert not got
    assert brief.negated or any(note.code == "left_open" for note in brief.notes)


@pytest.mark.parametrize(
    ("text", "predicate"),
    [
        ("Tall offices in the north, low houses in the south",
         "stat(building, use=office, floors, p50) >= 8"),
        ("A town with low houses and tall flats", "stat(building, use=flats, floors, p50) >= 8"),
        ("Low offices in the middle, tall flats at the edge",
         "stat(building, use=office, floors, p50) <= 3"),
    ],
)  # fmt: skip
def test_how_high_a_kind_is_is_measured_of_it_alone(text, predicate):
    _, brief = quarters(text)
    assert predicate in [goal.predicate for goal in brief.goals]


@pytest.mark.parametrize(
    ("text", "predicate"),
    [
        ("A town with two playgrounds near the school",
         "near(playground, building, tag=school) >= 2"),
        ("Three fountains next to the park", "near(fountain, park) >= 3"),
        ("A resort with hotels along the beach", "near(building, tag=hotel, beach) >= 2"),
    ],
)  # fmt: skip
def test_several_things_near_another_are_counted(text, predicate):
    _, brief = quarters(text)
    assert predicate in [goal.predicate for goal in brief.goals]


@pytest.mark.parametrize(
    ("text", "args", "predicate"),
    [
        ("Poplars along the river of a village", {"near": "river", "species": "poplar"},
         "near(tree, species=poplar, river, within=20) >= 6"),
        ("A town with trees around the square", {"near": "plaza"},
         "near(tree, plaza, within=20) >= 6"),
        ("A village with a row of willows along the canal", {"near": "canal", "species": "willow"},
         "near(tree, species=willow, canal, within=20) >= 6"),
        ("Limes around the pond of a village", {"near": "pond", "species": "lime"},
         "near(tree, species=lime, pond, within=20) >= 6"),
    ],
)  # fmt: skip
def test_trees_along_something_are_a_row(text, args, predicate):
    _, brief = quarters(text)
    assert ("layout/tree_row-v1", args) in slots_of_brief(brief)[DO]
    assert predicate in [goal.predicate for goal in brief.goals]
    assert "nature.species" not in {slot.key for slot in brief.slots}


def test_how_far_apart_the_trees_of_a_row_stand_is_left_open():
    _, brief = quarters("A town with cypresses lining the railway, every 8 m")
    assert "nature.spacing" not in {slot.key for slot in brief.slots}
    assert any("spacing of the row" in note.text for note in brief.notes)
