"""Edits in words: what nothing can give to something new stops the whole change."""

from copies import copy_of

from cityx.projects.edit import edit_city


def test_what_nothing_gives_a_new_thing_is_named(scene_folder, tmp_path):
    folder = tmp_path / "city"
    copy_of(scene_folder("park_s"), folder)
    report = edit_city(folder, "Put a statue of 4 m in the park.")
    (left,) = report["left_of_change"]
    assert "Nothing gives what is new its height (4)" in left["questions"][0]
    assert [(one["how"], one["kind"]) for one in report["done_of_change"]] == [("added", "statue")]


def test_the_goals_of_a_change_name_what_it_means(scene_folder, tmp_path):
    folder = tmp_path / "city"
    copy_of(scene_folder("park_s"), folder)
    report = edit_city(folder, "Paint all buildings red except the two tallest buildings.")
    goals = report["goals_of_change"]
    assert all(goal["met"] for goal in goals)
    assert any("color=red" in goal["predicate"] and "id=" in goal["predicate"] for goal in goals)
