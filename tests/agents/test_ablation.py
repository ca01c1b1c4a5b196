"""Less of the records is planned by less well, and the gate still knows everything."""

import pytest
from cityx_bench.arms import ablation_of, chance, driver_of, name_of, write_ablation
from cityx_bench.drivers import driver_named
from cityx_bench.scoring import Sample

from cityx.agents.ablation import ARMS, UNSAID, arm_of, shown_records
from cityx.agents.journal import JOURNAL, Journal
from cityx.agents.planning.planner import OfflinePlanner, Situation
from cityx.errors import UsageError
from cityx.options import BuildOptions, PlannerChoice
from cityx.projects.build import build
from cityx.protocol.catalogue import known_records
from cityx.protocol.registry import registry
from cityx.protocol.serving import DO


@pytest.fixture(scope="module")
def records():
    return known_records(registry())


def test_there_are_eight_arms_and_letters_in_any_order_name_them():
    assert ARMS == ("DIL", "DI", "DL", "IL", "D", "I", "L", "")
    assert [arm_of(text) for text in ("D,I,L", "ld", "i", "-", "")] == ["DIL", "DL", "I", "", ""]
    with pytest.raises(UsageError, match='"DX" names X'):
        arm_of("DX")
    assert [name_of(arm) for arm in ("DL", "")] == ["D + L", "none"]
    assert [driver_of(arm) for arm in ("DIL", "DL", "")] == ["offline", "offline:DL", "offline:-"]
    for arm in ARMS:
        driver_named(driver_of(arm))


@pytest.mark.parametrize("arm", ARMS)
def test_only_the_parts_of_an_arm_are_shown(records, arm):
    shown = shown_records(records, arm)
    assert [record.id for record in shown] == [record.id for record in records]
    assert all((r.description != UNSAID) == ("D" in arm) for r in shown)
    assert any(r.parameters for r in shown) == ("I" in arm)
    assert any(r.takes for r in shown) == ("I" in arm)
    assert any(r.requires or r.after for r in shown) == ("L" in arm)
    assert any(p.interval for r in shown for p in r.parameters) == (arm in ("DIL", "IL"))
    assert any(r.serves for r in shown) == ("D" in arm)
    if arm == "DIL":
        assert shown == tuple(records)


def plan(records, arm, slots):
    planner = OfflinePlanner(shown_records(records, arm))
    return [item.call for item in planner.workflow(slots, Situation(2, ())).items]


def test_each_part_changes_the_plan(records):
    slots = {"weather": ("snow",), DO: (("layout/river-v1", {"width": 30.0}),)}
    plans = {arm: plan(records, arm, slots) for arm in ARMS}
    names = {arm: [call.action for call in calls] for arm, calls in plans.items()}
    full = {call.action: call.args for call in plans["DIL"]}
    assert full["layout/river-v1"] == {"width": 30.0}
    assert "layout/river-v1" not in names["IL"]
    assert {call.action: call.args for call in plans["DL"]}["layout/river-v1"] == {}
    # Without limitations nobody knows that a river comes before the streets that cross it.
    assert names["DIL"].index("layout/river-v1") == 1
    assert names["DI"][-1] == "layout/river-v1"
    assert len(names["DI"]) == len(names["DIL"])  # of two makers of parked cars either may do


def test_order_and_ranges_are_known_by_the_limitation_alone(records):
    slots = {"town.width": (1e9,), "town.zone": ("core",)}
    args = {arm: plan(records, arm, slots)[0].args for arm in ("DIL", "DI", "IL")}
    assert args["DIL"] == {"zone": "core"}
    assert args["DI"] == {"width": 1e9, "zone": "core"}
    assert args["IL"] == {}  # "town.zone" says by its name what the action does


def test_what_is_planned_without_limitations_is_refused_by_the_gate(tmp_path):
    options = BuildOptions(
        text="Put a river through the town.", lod=0, formats=(), render=False,
        choice=PlannerChoice(shown="DI"),
    )  # fmt: skip
    build([], tmp_path / "city", options)
    with Journal(tmp_path / "city" / "city" / JOURNAL) as journal:
        said = [(step.action, step.error) for step in journal.steps(1) if step.status == "rejected"]
    assert [action for action, _ in said] == ["layout/river-v1"]
    assert "STAGE_ORDER: layout/river-v1 is too late" in said[0][1]


def sample(task, right, executed=True):
    return Sample(task, "", "generate", "offline", 0, 1, "", True, executed, right, (), (), (), (),
                  {}, {}, {}, 0.0, 0.0)  # fmt: skip


def test_pairs_are_compared_by_mcnemars_exact_test(tmp_path):
    full = [sample(f"T{k}", k < 9) for k in range(10)]
    less = [sample(f"T{k}", k < 3, executed=k < 5) for k in range(10)]
    assert chance(full, less) == pytest.approx(2 * 0.5**6)
    assert chance(full, full) == 1.0
    records = ablation_of({"DIL": full, "D": less})
    assert [record["right"]["hits"] for record in records] == [9, 3]
    assert "p" not in records[0]
    lines = write_ablation({"DIL": full, "D": less}, "cityx bench agents --arm all", tmp_path)
    assert lines[-1].startswith("| D | 5/10 = 50.00 %")
    assert lines[-1].endswith("| 0.0312 |")
    assert "McNemar" in (tmp_path / "ablation.md").read_text()


def test_a_layout_that_cannot_be_varied_is_not_tried_again(tmp_path):
    options = BuildOptions(
        text="A sparse suburb of 150 m by 150 m.", lod=0, formats=(), render=False,
        choice=PlannerChoice(shown="IL"),
    )  # fmt: skip
    build([], tmp_path / "city", options)
    with Journal(tmp_path / "city" / "city" / JOURNAL) as journal:
        assert [step.error for step in journal.steps(1) if step.status == "rejected"] == []
