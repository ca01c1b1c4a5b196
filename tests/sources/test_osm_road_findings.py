import pytest

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
