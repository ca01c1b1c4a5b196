import itertools
import random

import pytest

from cityx.agents.planning.planner import OfflinePlanner, Situation, arguments
from cityx.agents.planning.workflow import PARTS, Workflow
from cityx.protocol import registry
from cityx.protocol.catalogue import known_records
from cityx.protocol.serving import DO, Serves
from cityx.protocol.stages import is_linear_extension

ACTIONS = registry(outside=False)
PLANNER = OfflinePlanner(known_records(ACTIONS))
FINE = [
    "background/sun-v1", "background/weather-v1", "road/drawn_streets-v1", "road/network-v1",
    "road/heights-v1", "road/lanes-v1", "road/ground-v1", "road/surface_material-v1",
    "building/design-v1", "building/shell-v1", "building/facade-v1", "nature/trees-v2",
    "nature/barriers-v1", "nature/shores-v1", "nature/furniture-v1", "nature/street_pieces-v1",
    "nature/parks-v1", "nature/gardens-v1", "road/covers-v1", "road/guard_rails-v1",
    "road/parked_cars-v1",
]  # fmt: skip


def plan(*kinds, lod=2, slots=None, **more):
    return PLANNER.workflow(slots or {}, Situation(lod, kinds), **more)


def names(found):
    return [item.action for item in found.items]


def test_a_map_becomes_a_city_with_all_its_parts():
    assert names(plan("osm")) == ["layout/inputs-v1", *FINE]
    assert plan("osm").missing == ()


def test_coarser_levels_leave_out_what_they_do_not_show():
    assert names(plan("osm", lod=0))[-1] == "building/prism-v1"
    assert set(names(plan("osm", lod=1))) < set(names(plan("osm")))
    assert len(plan("osm", lod=0).items) == 1 + sum(0 in part.lods for part in PARTS)


def test_nothing_becomes_a_town_and_heights_a_terrain():
    assert names(plan())[0] == "layout/town-v1"
    assert names(plan("osm", "height"))[:2] == ["layout/inputs-v1", "terrain/height_field-v1"]


def test_without_direct_tools_a_semantic_map_goes_through_points_and_faces():
    direct = frozenset({"layout/inputs-v1", "layout/semantic_map-v1"})
    found = plan("semantic", avoid=direct)
    assert found.items[0].action == "convert/face_to_layout_conversion-v1"
    assert dict(found.items[0].bind) == {"surfaces": "semantic_map"}
    assert names(found)[1:] == FINE


def test_what_nothing_can_read_is_missing_and_not_made_up():
    found = plan("osm", avoid=frozenset({"layout/inputs-v1"}))
    assert found.missing == ("no action makes a layout of input 1",)
    found = plan(avoid=frozenset({"road/ground-v1"}))
    assert "no action makes the ground" in found.missing


KINDS = ("drawn", "osm", "semantic", "satellite", "height")


@pytest.mark.parametrize(
    "kinds", [found for n in range(4) for found in itertools.combinations(KINDS, n)]
)
@pytest.mark.parametrize("lod", [0, 2])
def test_every_plan_keeps_the_order_of_stages(kinds, lod):
    found = plan(*kinds, lod=lod)
    assert is_linear_extension(names(found))
    assert found.missing == ()
    assert Workflow.from_json(found.to_json()) == found


def test_a_brief_gives_arguments_and_calls_for_actions():
    found = plan(slots={"time": ("dusk",), "weather": ("snow",)})
    args = {item.action: dict(item.args) for item in found.items}
    assert args["background/sun-v1"] == {"time": "dusk"}
    assert args["background/weather-v1"] == {"preset": "snow"}


def test_slots_are_asked_for_by_key_or_by_value():
    slots = {"building.count": (25,), "building.type": ("tower",)}
    assert Serves("building.count", "building.type=tower").asked(slots)
    assert not Serves("building.type=house").asked(slots)
    assert not Serves("building.height.min").asked(slots)
    assert Serves.from_json(Serves("a=1", kind="plaza").to_json()) == Serves("a=1", kind="plaza")


def test_a_value_that_a_parameter_refuses_leaves_its_default():
    record = ACTIONS["layout/inputs-v1"]
    assert arguments(record, {"size.x": (-4.0,), "size.y": (-1, 300.0)}) == {"depth": 300.0}


@pytest.mark.parametrize("seed", range(4))
def test_what_comes_first_is_told_by_the_records_and_not_by_the_list_of_parts(seed, monkeypatch):
    listed = list(PARTS)
    random.Random(seed).shuffle(listed)
    monkeypatch.setattr("cityx.agents.planning.planner.PARTS", tuple(listed))
    wishes = (("layout/cover-v1", {"most": 0.2}), ("layout/coast-v1", {}))
    found = names(plan("height", slots={DO: wishes}))
    assert is_linear_extension(found)
    pairs = [
        ("layout/coast-v1", "layout/cover-v1"), ("background/weather-v1", "nature/trees-v2"),
        ("road/heights-v1", "road/ground-v1"), ("nature/trees-v2", "nature/street_pieces-v1"),
        ("building/facade-v1", "road/parked_cars-v1"), ("layout/cover-v1", "background/sun-v1"),
    ]  # fmt: skip
    assert [pair for pair in pairs if found.index(pair[0]) > found.index(pair[1])] == []
