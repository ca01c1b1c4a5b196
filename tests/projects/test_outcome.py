"""What an edit tells that it did, and that one which changes nothing makes no revision."""

import json
from shutil import copytree

import numpy as np
import pytest
from typer.testing import CliRunner

from cityx.cli.main import app
from cityx.projects.build import since_edits
from cityx.projects.desk import Desk
from cityx.projects.edit import edit_city


@pytest.fixture
def folder(scene_folder, tmp_path):
    copytree(scene_folder("park_s"), tmp_path / "city")
    return tmp_path / "city"


def done(report):
    return {(one["how"], one["kind"]): one for one in report["done_of_change"]}


def test_what_is_added_removed_and_changed_is_told_by_its_ids(folder):
    with Desk(folder) as desk:
        before = desk.city
    report = edit_city(folder, "Paint the two tallest buildings red and put three benches in the "
                       "park.")  # fmt: skip
    with Desk(folder) as desk:
        after = desk.city
    told = done(report)
    assert set(told) == {("added", "bench"), ("changed", "building")}
    assert told["added", "bench"]["count"] == 3
    ids = {int(one["id"], 16) for one in told["added", "bench"]["objects"]}
    known, now = (np.concatenate([rows.object_id for rows in city.scene.instances.values()])
                  for city in (before, after))  # fmt: skip
    assert ids == set(np.setdiff1d(now, known).tolist())
    tallest = after.layout.buildings.nlargest(2, "height")["id"]
    painted = {int(one["id"], 16) for one in told["changed", "building"]["objects"]}
    assert painted == set(tallest.tolist())
    (chosen,) = report["chosen_of_change"]
    assert chosen.startswith('"tallest building" is taken to be b')
    assert chosen.endswith("m high.")


def test_the_command_line_prints_it(folder):
    said = CliRunner().invoke(app, ["edit", str(folder), "Remove the two lowest buildings."]).output
    assert '"lowest building" is taken to be' in said
    assert "removed 2 x building: " in said


def test_an_edit_that_changes_nothing_makes_no_revision(folder):
    first = edit_city(folder, "Paint b01 red.")
    again = edit_city(folder, "Paint b01 red.")
    assert (first["revision"], again["revision"]) == (2, 2)
    assert not first["same_of_change"]
    assert again["same_of_change"]
    assert not again["done_of_change"]
    said = CliRunner().invoke(app, ["edit", str(folder), "Paint b01 red."])
    assert "Nothing was changed" in said.output
    assert said.exit_code == 0
    with Desk(folder) as desk:
        assert [one.number for one in desk.revisions()] == [1, 2]


def test_a_change_after_one_of_nothing_can_be_undone(folder):
    edit_city(folder, "Paint b01 red.")
    edit_city(folder, "Paint b01 red.")
    report = edit_city(folder, "Paint b01 blue.")
    assert report["revision"] > 2
    back = edit_city(folder, "Undo that.")
    assert done(back)["changed", "building"]["count"] == 1


def test_what_held_before_an_edit_and_not_after_is_no_miss_of_the_build():
    bridges, park = {"predicate": "n(bridge) == 2"}, {"predicate": "n(park) == 1"}
    known = [bridges | {"met": True}, park | {"met": False}]
    goals = [bridges | {"met": False, "evidence": "there are 3 bridge"},
             park | {"met": False, "evidence": "there are 0 park"}]  # fmt: skip
    bridges, park = since_edits(goals, known)
    assert (bridges["met"], park["met"]) == (None, False)
    assert "before the city was edited" in bridges["evidence"]
    assert since_edits([goals[0]], [bridges])[0]["met"] is None


def test_a_check_measures_what_the_last_edit_asked_for(folder):
    edit_city(folder, "Put three benches in the park and paint b01 red.")
    CliRunner().invoke(app, ["check", str(folder)])
    report = json.loads((folder / "report.json").read_text())
    held = [one for one in report["goals"] if "b01" in one.get("predicate", "")]
    assert [one["met"] for one in held] == [True]
    assert report["revision"] == 2
