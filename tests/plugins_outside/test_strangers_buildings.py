"""A stranger's generator stands in a city: by command, words, style and edit, at every LOD."""

import json

import numpy as np
import pytest
from strangers import built, cityx, failed_checks

from cityx.city.mesh_measures import check_closed
from cityx.city.store import read_city

DO = ("--do", "building/ziggurat-v1 terraces=3")


def generators_of(out):
    return read_city(out / "city").layout.buildings["generator"].tolist()


def window_gaps(city):
    """Metres from the foot of each window to the upright faces of its building's shell."""
    batch = city.scene.meshes["buildings"]
    windows = city.scene.instances["windows"]
    gaps = np.full(windows.count, np.inf)
    for row, owner in enumerate(batch.object_id.tolist()):
        shell = batch.take([row])
        triangles = shell.vertices[shell.triangles()[0]]
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        wall = np.abs(normal[:, 2]) < 0.05 * np.linalg.norm(normal, axis=1)
        mine = np.flatnonzero(windows.owner == np.uint64(owner))
        for corner, unit in zip(triangles[wall], normal[wall], strict=True):
            unit = unit / np.linalg.norm(unit)
            away = np.abs((windows.position[mine] - corner[0]) @ unit)
            low, high = corner.min(axis=0) - 0.3, corner.max(axis=0) + 0.3
            beside = ((windows.position[mine] > low) & (windows.position[mine] < high)).all(axis=1)
            gaps[mine[beside]] = np.minimum(gaps[mine[beside]], away[beside])
    return gaps


@pytest.fixture(scope="module")
def by_command(strangers, town, tmp_path_factory):
    out = tmp_path_factory.mktemp("by_command") / "out"
    return out, built(strangers, town, out, "--lod", 2, *DO)


def test_the_city_differs_and_its_checks_hold(by_command, nobody, town, tmp_path):
    report = by_command[1]
    assert failed_checks(report) == {}
    assert report["failures"] == []
    said = {"buildings": 4, "action": "building/ziggurat-v1", "package": "cityx-guide"}
    assert report["generators"] == {"ziggurat": said}
    assert report["made"]["building/ziggurat-v1"]["terraces"] == 3
    assert report["hash"] != built(nobody, town, tmp_path / "out", "--lod", 2)["hash"]


def test_its_shells_are_closed_and_no_window_floats(by_command):
    city = read_city(by_command[0] / "city")
    assert check_closed(city.scene.meshes["buildings"]).all()
    gaps = window_gaps(city)
    assert len(gaps) > 40
    assert gaps.max() < 0.1


@pytest.mark.parametrize("lod", [0, 1])
def test_it_stands_at_coarse_levels_of_detail(strangers, town, tmp_path, lod):
    report = built(strangers, town, tmp_path / "out", "--lod", lod, *DO)
    assert failed_checks(report) == {}
    tops = read_city(tmp_path / "out" / "city").layout.buildings["height"]
    assert tops.tolist() == pytest.approx([10.5] * 4)


@pytest.mark.slow
def test_it_stands_at_the_finest_level_of_detail(strangers, town, tmp_path):
    report = built(strangers, town, tmp_path / "out", "--lod", 3, *DO)
    assert failed_checks(report) == {}
    assert window_gaps(read_city(tmp_path / "out" / "city")).max() < 0.35  # set back into walls


def test_a_setting_chooses_it_for_all(strangers, town, tmp_path):
    built(strangers, town, tmp_path / "out", "--lod", 1, "--set", "design.generator=ziggurat")
    assert generators_of(tmp_path / "out") == ["ziggurat"] * 4


def test_a_sentence_that_names_it_builds_a_town_of_it(strangers, tmp_path):
    out = tmp_path / "out"
    cityx(strangers, "build", "a town of stepped temples", "-o", out, "--lod", 1, "--size",
          "160x160", "--no-render", "--formats", "")  # fmt: skip
    report = json.loads((out / "report.json").read_text())
    goal = next(goal for goal in report["goals"] if "ziggurat" in goal["goal"])
    assert goal["met"] is True
    assert failed_checks(report) == {}


def test_a_style_of_its_own_chooses_it(strangers, town, tmp_path):
    built(strangers, town, tmp_path / "out", "--lod", 1, "--style", "mesopotamian")
    assert generators_of(tmp_path / "out").count("ziggurat") >= 3


def test_an_edit_turns_one_building_into_it_and_changes_it(strangers, nobody, town, tmp_path):
    out = tmp_path / "out"
    built(nobody, town, out, "--lod", 2)
    cityx(strangers, "edit", out, "turn the largest building into a ziggurat")
    cityx(strangers, "edit", out, "make the ziggurat 30 m tall")
    city = read_city(out / "city")
    rows = city.layout.buildings
    mine = rows[rows["generator"] == "ziggurat"]
    assert mine["height"].tolist() == pytest.approx([30.0])
    own = np.isin(city.scene.instances["windows"].owner, mine["id"].to_numpy(np.uint64))
    assert own.sum() > 10
    assert window_gaps(city)[own].max() < 0.1  # those of others hang on gables and dormers, too
    cityx(strangers, "check", out)
    assert failed_checks(json.loads((out / "report.json").read_text())) == {}
