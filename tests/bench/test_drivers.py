"""Drivers on cheap tasks: what nothing and chance achieve, what is written down, what is asked."""

import json
import os
from dataclasses import replace

import pytest
from cityx_bench import runner
from cityx_bench.drivers import GOLD, Oracle, driver_named, planner_choice
from cityx_bench.outcome import CRASH, Workplace, fault_of, faults_of
from cityx_bench.report import results_of, summary, write_results
from cityx_bench.runner import LOG, Bench, numbers_of, read_log, run_bench
from cityx_bench.scenes import SCENES
from cityx_bench.scoring import judged, rates_of
from cityx_bench.tasks import Task, read_tasks
from copies import copy_of

from cityx.errors import UsageError

CHEAP = ("P04", "P09", "P18", "P28", "P29", "P30")


def quiet(_):
    """Say nothing."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory, scene_folder):
    """Where scenes and inputs are shared by the drivers of this file."""
    out = tmp_path_factory.mktemp("bench")
    for name in SCENES:
        copy_of(scene_folder(name), runner.scene_folder(out, name))
    return out


def run(folder, driver, *only, lod=1, seeds=(0,)):
    bench = Bench(read_tasks(only=only or CHEAP), driver, folder, seeds, lod)
    return {sample.task: sample for sample in run_bench(bench, quiet)}


def test_every_public_task_has_a_gold_plan():
    assert set(json.loads(GOLD.read_text())) == {task.id for task in read_tasks()}


def test_gold_plans_name_things_by_their_kind_too(folder):
    samples = run(folder, "oracle", "P20", "P21")
    assert {name: sample.right for name, sample in samples.items()} == {"P20": True, "P21": True}


def test_nothing_is_never_right(folder):
    assert rates_of(run(folder, "null", lod=0).values()).right.hits == 0


@pytest.mark.slow
@pytest.mark.sweep(1)
@pytest.mark.parametrize("seed", range(2))
def test_chance_is_never_right(folder, seed):
    assert rates_of(run(folder, "random", lod=0, seeds=(seed,)).values()).right.hits == 0


@pytest.mark.slow
def test_nothing_meets_no_task_of_all(folder):
    samples = run(folder, "null", *(task.id for task in read_tasks()), lod=0)
    assert len(samples) == 50
    assert [name for name, sample in samples.items() if sample.right] == []


def test_what_is_written_down_is_always_right(folder):
    samples = run(folder, "oracle")
    assert all(sample.scored for sample in samples.values())
    wrong = [(s.task, s.goals, s.faults) for s in samples.values() if s.scored and not s.right]
    assert wrong == []


def test_every_plan_is_for_a_task():
    assert set(Oracle()._plans) <= {task.id for task in read_tasks()}


@pytest.mark.slow
@pytest.mark.sumo
def test_offline_asks_back_reports_and_lets_buses_drive(folder):
    pytest.importorskip("libsumo")
    samples = run(folder, "offline", "P18", "P22", "P28", "P29", "P30")
    assert [name for name, s in samples.items() if s.right] == [*samples]
    assert samples["P28"].reply["mentions"] == ["conflict:building"]
    assert samples["P30"].reply["kind"] == "clarify"
    assert samples["P22"].unsupported == []
    assert samples["P29"].reply["kind"] == "partial"
    assert "ignored_untrusted_instruction" in samples["P29"].reply["mentions"]
    assert all(sample.planning_s < 1.0 for sample in samples.values())


def test_a_sample_in_the_log_is_not_made_again(folder, monkeypatch):
    first = run(folder, "null", "P28")

    def fail(*_):
        raise AssertionError("it was run again")

    monkeypatch.setattr("cityx_bench.runner.judged", fail)
    assert run(folder, "null", "P28") == first
    with pytest.raises(AssertionError, match="run again"):
        run(folder, "null", "P28", seeds=(7,))


def test_half_a_line_of_a_killed_process_is_no_sample(folder, tmp_path):
    run(folder, "null", "P28")
    whole = (folder / LOG).read_text().splitlines()[-1]
    (tmp_path / LOG).write_text(f"{whole}\n{whole[:80]}")
    assert len(list(read_log(tmp_path / LOG))) == 1


class Deadly:
    """Ends the process that reads it."""

    def __reduce__(self):
        return os._exit, (9,)


def test_a_process_that_dies_is_a_crash_of_its_task_alone(tmp_path):
    tasks = read_tasks(only=["P28", "P30"])
    deadly = Bench(tasks[:1], "null", tmp_path / "a", jobs=2, inputs={"x": Deadly()})
    (sample,) = run_bench(deadly, quiet)
    assert (sample.scored, sample.executed) == (True, False)
    assert [fault["code"] for fault in sample.faults] == [CRASH]
    assert list(read_log(tmp_path / "a" / LOG)) == [replace(sample, faults=[*sample.faults],
        goals=[], clean=[], unsupported=[])]  # fmt: skip


@pytest.fixture(scope="module")
def river(scene):
    """A town with a river, and the task that asked for it."""
    task = Task("R1", "x", expect=("n(river) >= 1", "n(bridge) == 2", "crosses(bridge, river)"))
    return task, scene("river_s")


class Hands:
    """A driver that hands over a city."""

    def __init__(self, city):
        self.city = city

    def propose(self, place):
        from cityx_bench.drivers import Null

        return replace(Null().propose(place), city=self.city)


def test_a_city_whose_river_is_deleted_fails_the_task(river, tmp_path):
    task, city = river
    areas = city.layout.areas
    dry = replace(city, layout=replace(city.layout, areas=areas[areas["kind"] != "river"]))
    place = Workplace.opened(task, tmp_path, {}, seed=0, lod=0)
    assert judged(place, Hands(city), "hands", "").right
    sample = judged(place, Hands(dry), "hands", "")
    assert sample.executed
    assert [goal["met"] for goal in sample.goals] == [False, True, False]


def test_what_is_not_clean_is_not_right(river, tmp_path):
    task, city = river
    tables = {name: getattr(city.layout, name).copy() for name in ("buildings", "parts")}
    for table in tables.values():
        table.loc[table.index[0], "geometry"] = table.geometry.iloc[1]
    heaped = replace(city, layout=replace(city.layout, **tables))
    place = Workplace.opened(task, tmp_path, {}, seed=0, lod=0)
    sample = judged(place, Hands(heaped), "hands", "")
    assert all(goal["met"] for goal in sample.goals)
    assert not sample.right


def test_a_question_that_no_task_asks_for_is_no_execution(tmp_path):
    task = replace(read_tasks(only=["P28"])[0], expect=("n(building) == 0",))
    place = Workplace.opened(task, tmp_path, {}, seed=0, lod=0)
    sample = judged(place, driver_named("offline"), "offline", "")
    assert not sample.executed
    assert [fault["code"] for fault in sample.faults] == ["CLARIFY"]


def test_the_setup_of_a_task_runs_before_it(folder):
    task = Task("S1", "x", base="grid_s", setup=("background/weather preset=rain",),
                expect=("env.weather == rain", "same(building)"))  # fmt: skip
    (sample,) = run_bench(Bench((task,), "null", folder, lod=1), quiet)
    assert sample.right
    assert sample.reply["mutations"] == 0


def test_a_rejected_call_is_told_by_its_code(scene_folder, tmp_path):
    task = Task("S2", "x", base="grid_s", expect=("same(building)",))
    plans = {"S2": {"calls": [["edit/scale_object-v1", {"scaled_obj_name": "b99"}]]}}
    copy_of(scene_folder("grid_s"), tmp_path / "grid")
    place = Workplace.opened(task, tmp_path / "grid", {}, seed=0, lod=0)
    sample = judged(place, Oracle(plans), "oracle", "")
    assert not sample.executed
    assert [fault["code"] for fault in sample.faults] == ["BAD_ARGS"]
    assert faults_of(place.steps())[0].action == "edit/scale_object-v1"


def test_what_breaks_in_cityx_itself_is_counted_as_a_crash():
    assert fault_of(ZeroDivisionError("x")).code == CRASH


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("offlin", 'There is no driver "offlin"; one of offline, null, random, oracle'),
        ("llm:", "llm:openai-chat:MODEL"),
        ("replay:", "replay:FILE"),
    ],
)
def test_drivers_that_do_not_exist_are_refused(name, said):
    with pytest.raises(UsageError, match=said):
        driver_named(name)


def test_models_are_handed_to_the_build():
    choice = planner_choice("llm", "openai-chat:m@http://127.0.0.1:1")
    assert (choice.planner, choice.base_url) == ("openai-chat:m", "http://127.0.0.1:1")
    assert planner_choice("replay", "a.jsonl").replay == "a.jsonl"


def test_seeds_are_whole_numbers():
    assert numbers_of("0,3", "--seeds") == (0, 3)
    with pytest.raises(UsageError, match='"a" is not of the form'):
        numbers_of("a", "--seeds")


def test_results_are_written_as_numbers_and_as_tables(folder, tmp_path):
    samples = list(run(folder, "offline", "P18", "P28").values())
    found = write_results(samples, "cityx bench agents", tmp_path)
    assert json.loads((tmp_path / "results.json").read_text()) == found
    assert found["rates"]["executed"] == {
        "hits": 2, "of": 2, "percent": 100.0, "interval": [34.24, 100.0]
    }  # fmt: skip
    table = (tmp_path / "results.md").read_text()
    assert "| all | 2/2 = 100.00 % (34-100) |" in table
    assert "level of detail 1" in table
    assert any("2/2" in line for line in summary(results_of(samples, "")))
