"""Requests of several wishes: one revision, what is left out in the report, exit code 1."""

import json

import pytest
from copies import copy_of
from typer.testing import CliRunner

from cityx.cli.main import app
from cityx.errors import ActionFailed, UsageError
from cityx.language.brief import Clarify
from cityx.projects.edit import edit_city, undo


@pytest.fixture
def folder(scene_folder, tmp_path):
    copy_of(scene_folder("park_s"), tmp_path / "city")
    return tmp_path / "city"


def test_what_is_understood_is_one_revision_and_the_rest_is_told(folder):
    text = "Make it rain, add a pergola to the yurt, and put two benches in the park."
    before = json.loads((folder / "report.json").read_text())["hash"]
    report = edit_city(folder, text)
    assert report["reply_of_change"] == "partial"
    assert [one["text"] for one in report["left_of_change"]] == ["add a pergola to the yurt"]
    assert any("add a pergola to the yurt" in note for note in report["notes_of_change"])
    assert report["revision"] == 2
    assert all(goal["met"] for goal in report["goals_of_change"])
    assert undo(folder)["hash"] == before


def test_what_the_city_lacks_leaves_out_its_wish_alone(folder):
    report = edit_city(folder, "Paint the lighthouse red and make it snow.")
    (left,) = report["left_of_change"]
    assert left["text"] == "Paint the lighthouse red"
    assert any("env.weather == snow" in goal["predicate"] for goal in report["goals_of_change"])


def test_wishes_against_each_other_are_both_left_out(folder):
    text = "Paint all buildings red. Paint all buildings blue. Make it snow."
    assert len(edit_city(folder, text)["left_of_change"]) == 2


def test_a_condition_is_asked_of_the_city(folder):
    report = edit_city(folder, "If there is a lighthouse, make it snow. Make it evening.")
    assert [one["text"] for one in report["left_of_change"]] == ["make it snow"]


def test_where_nothing_can_be_done_nothing_changes(folder):
    with pytest.raises((Clarify, UsageError), match="frobnicated"):
        edit_city(folder, "Paint the frobnicated houses red and the lighthouse blue.")


def test_the_command_line_tells_it_and_ends_with_one(folder):
    text = "Make it rain and paint the frobnicated houses red."
    done = CliRunner().invoke(app, ["edit", str(folder), text])
    assert done.exit_code == 1
    assert 'left out: "paint the frobnicated houses red"' in done.output


def test_what_has_no_room_leaves_out_its_wish_alone(folder):
    report = edit_city(folder, "Make it snow and add a stadium.")
    (left,) = report["left_of_change"]
    assert left["text"] == "add a stadium"
    assert "room" in " ".join(left["questions"])
    assert all(goal["met"] for goal in report["goals_of_change"])
    with pytest.raises((ActionFailed, UsageError), match="room"):
        edit_city(folder, "Add a stadium.")


def test_what_is_not_there_is_gone_already_and_a_list_is_told(folder):
    text = "Put two benches in the park and list where they ended up. Remove all bus stops."
    report = edit_city(folder, text)
    assert report["revision"] == 2
    assert not report["left_of_change"]
    assert any('nothing to do for "Remove all bus stops"' in one
               for one in report["notes_of_change"])  # fmt: skip
    (told,) = report["listed_of_change"]
    assert len(told["objects"]) == 2
    assert all(one["kind"] == "bench" and len(one["id"]) == 16 for one in told["objects"])
    assert edit_city(folder, "List the benches.")["revision"] == 2


def test_what_changes_is_no_part_of_all_else(folder):
    report = edit_city(folder, "Paint b03 red. Don't touch anything else please.")
    assert {"goal": "keep everything", "met": True} in [
        {"goal": one["goal"], "met": one["met"]} for one in report["goals_of_change"]
    ]


def test_a_thing_of_another_name_is_measured_by_its_id(folder):
    report = edit_city(folder, "Rename x1 to King Street and replace all trees with birches.")
    assert all(goal["met"] for goal in report["goals_of_change"])
    assert edit_city(folder, "Close King Street to cars.")["done_of_change"]


def test_where_what_is_left_fails_all_that_was_left_out_is_named(folder):
    with pytest.raises(UsageError, match="pergola") as raised:
        edit_city(folder, "Add a pergola to the yurt and add a stadium.")
    assert "Nothing was changed." in str(raised.value)
