"""What only a change of the finished city brings about is done before the city is kept."""

import json

import pytest

from cityx.city.store import read_city
from cityx.options import BuildOptions
from cityx.projects.build import build, recheck

TEXT = (
    "A village with six benches beside the fountain. Line the river with poplars. Put eight people "
    "on the square. Make the doors of the houses blue. Tell me how many trees there are."
)


def options(text):
    return BuildOptions(text=text, lod=2, size=(300, 300), render=False, formats=())


@pytest.fixture(scope="module")
def folder(made_once):
    return made_once("town-that-is-finished", lambda out: build([], out, options(TEXT)))


def rows(folder):
    report = json.loads((folder / "report.json").read_text())
    return [goal for goal in report["goals"] if goal.get("then")]


def test_commands_are_carried_out_and_measured(folder):
    told = rows(folder)
    assert {goal["goal"].split()[0].lower() for goal in told} == {"put", "line", "make", "list"}
    assert all(goal["met"] for goal in told)
    assert [g["predicate"] for g in told if "bench" in g["goal"]] == ["gained(bench) == 6"]


def test_no_check_is_broken(folder):
    report = json.loads((folder / "report.json").read_text())
    assert not [name for name, check in report["checks"].items() if not check["ok"]]


def test_trees_along_a_water_stand_on_its_banks(folder):
    city = read_city(folder / "city")
    trees = city.scene.instances["trees"]
    areas = city.layout.areas
    river = areas.geometry[areas["kind"] == "river"].union_all()
    poplars = [city.scene.prototypes[one].name for one in trees.prototype]
    from shapely import distance, points

    near = distance(points(trees.position[:, :2]), river) < 3
    assert sum(near & ["poplar" in name for name in poplars]) > 20


def test_what_the_text_asks_to_be_told_is_counted_in_the_city(folder):
    (told,) = (goal["evidence"] for goal in rows(folder) if goal["goal"] == "List the trees")
    scene = read_city(folder / "city").scene
    names = [scene.prototypes[one].name for one in scene.instances["trees"].prototype]
    assert int(told.partition(":")[0]) == sum(name.startswith("tree_") for name in names)


def test_what_cannot_be_done_is_missed_with_its_reason(tmp_path):
    text = "A village with 4000 benches beside the fountain."
    report = build([], tmp_path / "city", options(text))
    (told,) = (goal for goal in report["goals"] if goal.get("then"))
    assert told["met"] is False
    assert told["evidence"].startswith("left out: ")


def test_measuring_again_keeps_what_came_of_commands(folder):
    before = rows(folder)
    recheck(folder)
    assert rows(folder) == before
