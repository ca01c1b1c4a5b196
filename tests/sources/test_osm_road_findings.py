import pytest

from cityx.road.network.contradictions import notes_on
from cityx.road.network.network import road_network

NAMED = {
    "has lanes=64": ([(0, 0), (90, 0)], {"lanes": "64"}),
    "has width=400": ([(0, 20), (90, 20)], {"width": "400 m"}),
    "crosses itself": ([(0, 40), (60, 40), (60, 60), (30, 30)], {}),
    "is a bridge that ends": ([(0, 80), (90, 80)], {"bridge": "yes"}),
    "has no length": ([(10, 90), (10, 90)], {}),
}


@pytest.fixture
def found(drawing):
    for points, tags in NAMED.values():
        drawing.way(points, highway="residential", **tags)
    drawing.way([(-50, -50), (50, -50)], highway="residential", lanes="2", width="7")
    drawing.way([(50, -50), (90, -50)], highway="residential", bridge="yes")
    drawing.way([(90, -50), (140, -50)], highway="residential")
    # A lane with a loop at its end meets itself at a node, and makes a junction there.
    loop = [(-50, -30), (0, -30), (20, -35), (20, -25), (0, -30)]
    drawing.way(loop, highway="service")
    drawing.way([(-60, -60), (150, -60), (150, 120), (-60, 120), (-60, -60)], landuse="residential")
    drawing.box(-40, 30, 12, 12, building="yes")
    return drawing.city()


@pytest.mark.parametrize("text", NAMED)
def test_what_was_ignored_or_repaired_of_a_street_is_named_with_its_way(found, text):
    (failure,) = [failure for failure in found.failures if text in failure.error]
    assert failure.error.startswith("osm/way/")
    assert failure.object_id


def test_sound_streets_and_bridges_between_streets_are_not_named(found):
    assert len([one for one in found.failures if one.error.startswith("osm/way")]) == len(NAMED)


def test_streets_with_ignored_numbers_are_built_as_usual(found):
    roads = found.layout.roads
    assert roads["lanes"].max() == 2
    assert roads["width"].max() < 20


@pytest.mark.parametrize(
    ("tags", "named"),
    [
        ({"lanes": "6", "width": "3"}, True), ({"lanes": "2", "width": "4"}, True),
        ({"lanes": "1", "width": "7"}, True), ({"lanes": "3", "width": "5", "oneway": "yes"}, True),
        ({"lanes": "2", "width": "6"}, False), ({"lanes": "1", "width": "3.5"}, False),
        ({"lanes": "1", "width": "7", "oneway": "yes"}, False), ({"width": "4"}, False),
        ({"lanes": "4"}, False),
    ],
)  # fmt: skip
def test_widths_that_decide_over_stated_lanes_are_named(drawing, tags, named):
    drawing.way([(0, 0), (90, 0)], highway="residential", **tags)
    drawing.box(0, 20, 10, 10, building="yes")
    layout = drawing.city().layout
    notes = notes_on(layout, road_network(layout, left_hand=False))
    assert [note for note in notes if "for the lanes they state" in note] == (
        ["map: 1 streets are too narrow or too wide for the lanes they state; widths decide: "
         f"{layout.roads['source'].iloc[0]}"] if named else []
    )  # fmt: skip


@pytest.mark.parametrize("kind", ["service", "track", "residential"])
@pytest.mark.parametrize("tunnel", ["yes", "building_passage", "no"])
def test_tunnels_that_are_left_out_are_named(drawing, kind, tunnel):
    way = drawing.way([(0, 0), (90, 0)], highway=kind, tunnel=tunnel)
    drawing.box(0, 20, 10, 10, building="yes")
    layout = drawing.city().layout
    net = road_network(layout, left_hand=False)
    named = [note for note in notes_on(layout, net) if "are left out" in note]
    assert [note.endswith(f": osm/way/{way}") for note in named] == [True] * (not net.edge_count)
    assert bool(named) == (kind != "residential" and tunnel == "yes")


@pytest.mark.parametrize("tags", [{}, {"lanes": "1"}, {"oneway": "yes", "surface": "asphalt"}])
def test_a_street_through_a_house_without_a_passage_is_named(drawing, tags):
    inside = drawing.way([(-60, 0), (60, 0)], highway="service", **tags)
    drawing.way([(-60, 30), (60, 30)], highway="service", tunnel="building_passage")
    drawing.way([(-60, 60), (60, 60)], highway="residential", bridge="yes", layer="1")
    drawing.way([(-60, 16), (60, 16)], highway="residential")  # touches the corner of the house
    for y in (-8, 24, 54):
        drawing.box(-10, y, 20, 14, building="yes")
    drawing.box(3, 14, 4, 4, building="yes")
    layout = drawing.city().layout
    (note,) = [note for note in notes_on(layout, road_network(layout, left_hand=False))
               if "through houses" in note]  # fmt: skip
    assert note.endswith(f": osm/way/{inside}")


@pytest.mark.parametrize(
    "tags", [{"covered": "yes"}, {"tunnel": "building_passage"}, {"covered": "arcade"}]
)
def test_a_covered_way_without_a_house_over_it_is_named(drawing, tags):
    bare = drawing.way([(-60, 0), (60, 0)], highway="residential", **tags)
    drawing.way([(-60, 30), (60, 30)], highway="residential", **tags)
    drawing.box(-50, 25, 100, 10, building="yes")
    drawing.way([(-60, 60), (60, 60)], highway="footway", **tags)
    drawing.box(-50, 55, 100, 10, building="roof")
    layout = drawing.city().layout
    (note,) = [note for note in notes_on(layout, road_network(layout, left_hand=False))
               if "have no roof" in note]  # fmt: skip
    assert note.endswith(f": osm/way/{bare}")
