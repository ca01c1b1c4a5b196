"""The loop with a run that is played: plans, repairs, reviews."""

from dataclasses import dataclass, field, replace

import pytest
import shapely

from cityx.agents.evaluator import judged
from cityx.agents.journal import connect
from cityx.agents.loop import Loop
from cityx.agents.planning.planner import OfflinePlanner
from cityx.agents.planning.workflow import Item
from cityx.agents.pool import Pool
from cityx.city import City, Frame, Goal, Layout
from cityx.errors import ActionFailed
from cityx.protocol import registry
from cityx.protocol.catalogue import known_records
from cityx.protocol.example_city import example_city

RECORDS = known_records(registry(outside=False))
EMPTY = City("town", Frame(50.0, 10.0), Layout((0.0, 0.0, 0.0, 0.0)), lod=0)


@dataclass
class Played:
    """A run in which layout actions give the example's layout, and some actions fail."""

    failing: tuple[str, ...] = ()
    calls: list = field(default_factory=list)
    state: str = "s0"
    first: str = "s0"
    hold: bool = False

    def resumed(self):
        return None

    def look_ahead(self, city, items, place):
        pass

    def do(self, city, call):
        if call.action in self.failing:
            raise ActionFailed(f"{call.action} failed: out of paint")
        self.calls.append(call)
        self.state = f"{self.state}/{call.action}"
        stage = call.action.partition("/")[0]
        if stage == "layout":
            city = replace(city, layout=example_city().layout)
        return replace(city, stages_done=city.stages_done | {stage})

    @property
    def names(self):
        return [call.action for call in self.calls]


def loop_of(run, tmp_path, *, slots=None, kinds=(), **more):
    database = connect(tmp_path / "journal.sqlite")
    return Loop(OfflinePlanner(RECORDS), run, Pool(database, 1), slots or {}, kinds, **more)


def test_it_does_what_is_planned_and_tells_each_step(tmp_path):
    run = Played()
    loop = loop_of(run, tmp_path)
    loop.carry_out(EMPTY)
    assert run.names[0] == "layout/town-v1"
    assert run.names[-1] == "building/prism-v1"
    told = [message.body["action"] for message in loop.pool.read("result")]
    assert told == run.names
    assert len(loop.pool.read("workflow")) == 1


def test_a_file_that_cannot_be_read_one_way_is_read_another(tmp_path):
    run = Played(failing=("layout/inputs-v1",))
    loop_of(run, tmp_path, kinds=("semantic",)).carry_out(EMPTY)
    assert run.calls[0].action == "layout/semantic_map-v1"
    run = Played(failing=("layout/inputs-v1", "layout/semantic_map-v1"))
    loop_of(run, tmp_path, kinds=("semantic",)).carry_out(EMPTY)
    assert run.calls[0].action == "convert/face_to_layout_conversion-v1"
    assert dict(run.calls[0].bind) == {"surfaces": "semantic_map"}


def test_what_a_city_cannot_be_without_ends_the_run(tmp_path):
    with pytest.raises(ActionFailed, match="out of paint"):
        loop_of(Played(failing=("road/network-v1",)), tmp_path).carry_out(EMPTY)


def test_what_nothing_else_needs_is_left_out_and_named(tmp_path):
    run = Played(failing=("nature/trees-v2",))
    loop = loop_of(run, tmp_path)
    city = loop.carry_out(replace(EMPTY, lod=1))
    assert run.names[-1] == "building/shell-v1"
    assert [failure.action for failure in city.failures] == ["nature/trees-v2"]
    assert [item.action for item, _ in loop.unmet] == ["nature/trees-v2"]


def test_a_wish_that_fails_is_left_out_one_asked_for_by_name_is_not(tmp_path):
    slots = {"do": (("layout/river-v1", {"bridges": 3}),)}
    run = Played(failing=("layout/river-v1",))
    loop = loop_of(run, tmp_path, slots=slots)
    loop.carry_out(EMPTY)
    assert [why for _, why in loop.unmet] == ["layout/river-v1 failed: out of paint"]
    assert run.names[-1] == "building/prism-v1"

    def amended(items, done):
        del done
        return [*items, Item("nature/parks-v1", firm=True)]

    with pytest.raises(ActionFailed):
        loop_of(Played(failing=("nature/parks-v1",)), tmp_path, amended=amended).carry_out(EMPTY)


def test_another_layout_is_tried_three_times_while_a_hard_goal_is_missed(tmp_path):
    goals = (Goal("nine houses", "n(building) == 9"),)
    run = Played()
    loop = loop_of(run, tmp_path, goals=goals)
    loop.carry_out(EMPTY)
    towns = [dict(call.args) for call in run.calls if call.action == "layout/town-v1"]
    assert towns == [{}, {"variant": 1}, {"variant": 2}, {"variant": 3}]
    assert run.names.count("road/network-v1") == 1
    told = [message.body for message in loop.pool.read("verdict")]
    verdicts = [body["missed"] for body in told if body["of"] == "layout"]
    assert len(verdicts) == 4
    assert verdicts[0][0].startswith("n(building) == 9 (there are 4")
    assert run.state.startswith("s0/layout/town-v1/background")


def test_a_layout_that_keeps_its_goals_is_built_at_once(tmp_path):
    run = Played()
    loop_of(run, tmp_path, goals=(Goal("four", "n(building) == 4"),)).carry_out(EMPTY)
    assert run.names.count("layout/town-v1") == 1
    assert run.hold is False


class Varied(Played):
    """A run in which each variant of a town has other buildings."""

    def __init__(self, layouts):
        super().__init__()
        self.layouts = layouts

    def do(self, city, call):
        city = super().do(city, call)
        if call.action == "layout/town-v1":
            return replace(city, layout=self.layouts[dict(call.args).get("variant", 0)])
        return city


def town_of(count, *, overlap=False):
    """The example's layout with some of its four buildings, two of them in one place."""
    layout = example_city().layout
    buildings, parts = (getattr(layout, name).head(count).copy() for name in ("buildings", "parts"))
    if overlap:
        shapes = parts.geometry.to_numpy().copy()
        shapes[1] = shapely.transform(shapes[0], lambda xy: xy + 1.0)
        parts.geometry = shapes
    return replace(layout, buildings=buildings, parts=parts)


def test_the_best_layout_is_kept_when_a_later_one_is_worse(tmp_path):
    run = Varied([town_of(1), town_of(3), town_of(2), town_of(1)])
    goals = (Goal("four", "n(building) == 4"), Goal("three", "n(building) >= 3"))
    city = loop_of(run, tmp_path, goals=goals).carry_out(EMPTY)
    assert len(city.layout.buildings) == 3
    assert run.names.count("layout/town-v1") == 4


def test_a_layout_that_fails_a_check_loses_to_one_that_misses_goals(tmp_path):
    blocked = town_of(4, overlap=True)
    run = Varied([blocked, town_of(2), blocked, blocked])
    goals = (Goal("four", "n(building) == 4"), Goal("more", "n(building) >= 3"))
    loop = loop_of(run, tmp_path, goals=goals)
    city = loop.carry_out(EMPTY)
    assert len(city.layout.buildings) == 2
    told = [message.body for message in loop.pool.read("verdict")]
    verdicts = [body["missed"] for body in told if body["of"] == "layout"]
    assert [any("building_overlap" in text for text in missed) for missed in verdicts] == [
        True, False, True, True,
    ]  # fmt: skip


def test_goals_that_are_met_do_not_excuse_a_failed_check(tmp_path):
    run = Varied([town_of(4, overlap=True), town_of(4), town_of(4), town_of(4)])
    city = loop_of(run, tmp_path, goals=(Goal("four", "n(building) == 4"),)).carry_out(EMPTY)
    assert judged(city, ()).failed == ()
    assert run.names.count("layout/town-v1") == 2


class Painted(Played):
    """A run in which heights that are set are those of another list, change after change."""

    def __init__(self, heights):
        super().__init__()
        self.heights = heights

    def do(self, city, call):
        city = super().do(city, call)
        if not call.action.startswith("edit/"):
            return city
        rounds = sum(name.startswith("edit/") for name in self.names)
        buildings = city.layout.buildings.assign(height=self.heights[rounds - 1])
        return replace(city, layout=replace(city.layout, buildings=buildings))


TALL = Goal("tall", "stat(building, height, min) >= 500")


def refined(heights, tmp_path, goals=(TALL,)):
    run = Painted(heights)
    loop = loop_of(run, tmp_path, goals=goals, kinds=("osm",))
    return run, loop, loop.carry_out(EMPTY)


def test_what_a_built_city_misses_is_brought_about_by_changes_of_objects(tmp_path):
    run, loop, city = refined([500.0], tmp_path)
    assert [name for name in run.names if name.startswith("edit/")] == ["edit/set_height-v1"]
    assert city.layout.buildings["height"].min() == 500.0
    assert loop.run.hold is False
    *_, before, after = [m.body for m in loop.pool.read("verdict") if m.body["of"] == "city"]
    assert len(before["missed"]) == 1
    assert after["missed"] == []


def test_a_city_is_refined_while_that_helps_and_the_best_is_kept(tmp_path):
    low = Goal("low", "stat(building, height, max) <= 600", hard=False)
    run, loop, city = refined([700.0, 900.0, 900.0], tmp_path, goals=(TALL, low))
    assert city.layout.buildings["height"].min() == 700.0  # the hard goal is met, the other not
    assert run.names[-1].startswith("edit/")
    assert loop.run.state.count("edit/") == 1


class Adding(Played):
    """A run whose city gains so many houses with the first step, and is never changed again."""

    def __init__(self, count):
        super().__init__()
        self.count = count

    def do(self, city, call):
        city = super().do(city, call)
        houses = example_city().layout.buildings
        rows = [*range(len(houses))][: self.count]
        return replace(city, layout=replace(city.layout, buildings=houses.iloc[rows]))


@pytest.mark.parametrize(("stood", "there", "missed"), [(0, 3, 0), (3, 3, 1), (1, 4, 0), (0, 4, 1)])
def test_what_was_to_be_added_is_missed_where_it_stood_already(tmp_path, stood, there, missed):
    houses = example_city().layout.buildings
    begun = replace(EMPTY, layout=replace(EMPTY.layout, buildings=houses.iloc[:stood]))
    loop = loop_of(Adding(there), tmp_path, goals=(Goal("add three", "gained(building) == 3"),),
                   kinds=("osm",))  # fmt: skip
    loop.carry_out(begun)
    told = [message.body["missed"] for message in loop.pool.read("verdict")]
    assert len(told[-1]) == missed
