import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from town import small_town

from cityx.agents import step_runner
from cityx.agents.journal import Journal
from cityx.city.content import content_hash
from cityx.city.store import read_city
from cityx.errors import InputError, UsageError
from cityx.options import BuildOptions
from cityx.projects.build import build, recheck
from cityx.protocol.running import run_action

OPTIONS = BuildOptions(formats=("glb",), render=False, seed=5)


@pytest.fixture(scope="module")
def built(town_map, tmp_path_factory):
    out = tmp_path_factory.mktemp("built") / "city"
    return out, build([town_map], out, OPTIONS)


def test_a_town_builds_with_every_check_kept(built):
    _, report = built
    assert {name for name, check in report["checks"].items() if not check["ok"]} == set()
    assert report["counts"]["buildings"] == 11
    assert report["counts"]["junctions"] >= 1
    assert report["counts"]["windows"] > 50


def test_the_folder_holds_every_product_and_nothing_else(built):
    out, _ = built
    assert sorted(path.name for path in out.iterdir()) == [
        "city", "city.glb", "report.html", "report.json", "views.json",
    ]  # fmt: skip
    assert [path.name for path in out.parent.iterdir()] == [out.name]


def test_the_report_has_the_documented_keys(built):
    out, report = built
    wanted = {
        "cityx", "seed", "hash", "area_km2", "inputs", "brief", "goals", "counts", "triangles",
        "timings_s", "peak_rss_mb", "checks", "failures", "notes", "attribution",
    }  # fmt: skip
    assert wanted <= set(report)
    assert json.loads((out / "report.json").read_text()) == json.loads(json.dumps(report))
    assert "OpenStreetMap" in (out / "report.html").read_text()


def test_the_report_tells_the_seconds_of_every_phase(built):
    _, report = built
    phases = {"import", "layout/inputs", "store", "glb", "store hash", "checks", "fidelity"}
    for times in (report["timings_s"], report["cpu_s"]):
        assert phases <= times.keys()
        assert min(times.values()) >= 0.0


def test_the_store_gives_the_same_hash_back(built):
    out, report = built
    assert content_hash(read_city(out / "city")).total == report["hash"]


def test_checking_again_finds_the_same(built):
    out, report = built
    again = recheck(out)
    assert again["checks"] == report["checks"]
    assert again["hash"] == report["hash"]
    assert again["timings_s"] == report["timings_s"]


def test_every_step_is_in_the_journal(built):
    out, _ = built
    with Journal(out / "city" / "journal.sqlite") as journal:
        steps = journal.steps()
    assert [step.status for step in steps] == ["done"] * len(steps)
    assert "building/shell-v1" in [step.action for step in steps]


def test_the_same_seed_gives_the_same_bytes_twice(built, town_map, tmp_path):
    out, report = built
    again = build([town_map], tmp_path / "again", OPTIONS)
    assert again["hash"] == report["hash"]
    assert (tmp_path / "again/city.glb").read_bytes() == (out / "city.glb").read_bytes()


def test_another_seed_gives_another_city(built, town_map, tmp_path):
    _, report = built
    other = build([town_map], tmp_path / "other", replace(OPTIONS, seed=6))
    assert other["hash"] != report["hash"]


def test_the_order_of_elements_in_the_file_does_not_count(built, tmp_path):
    _, report = built
    shuffled = small_town().write(tmp_path / "town.osm", shuffle=1)
    assert build([shuffled], tmp_path / "out", OPTIONS)["hash"] == report["hash"]


def test_two_workers_build_what_one_builds(town_map, tmp_path):
    one, two = (
        build([town_map], tmp_path / f"{number}", replace(OPTIONS, workers=number))
        for number in (1, 2)
    )
    timed = ("timings_s", "cpu_s", "peak_rss_mb")
    assert {**one, **dict.fromkeys(timed)} == {**two, **dict.fromkeys(timed)}
    assert one["timings_s"].keys() == two["timings_s"].keys()
    assert (tmp_path / "1/city.glb").read_bytes() == (tmp_path / "2/city.glb").read_bytes()


def test_houses_are_raised_by_a_copy_of_the_process(town_map, tmp_path, monkeypatch):
    here = []

    def noted(city, call, *rest, **more):
        here.append(call.action)
        return run_action(city, call, *rest, **more)

    monkeypatch.setattr(step_runner, "run_action", noted)
    build([town_map], tmp_path / "two", replace(OPTIONS, formats=(), workers=2))
    assert "road/ground-v1" in here
    assert not [action for action in here if action.startswith("building/")]


def test_another_process_with_other_string_hashes_builds_the_same(built, town_map, tmp_path):
    _, report = built
    out = tmp_path / "other"
    subprocess.run(
        [sys.executable, "-m", "cityx.cli", "build", str(town_map), "-o", str(out), "--seed",
         "5", "--formats", "glb", "--no-render"],
        check=True, capture_output=True, env={**os.environ, "PYTHONHASHSEED": "77"},
    )  # fmt: skip
    assert json.loads((out / "report.json").read_text())["hash"] == report["hash"]


@pytest.mark.parametrize("lod", [0, 1, 3])
def test_every_level_of_detail_keeps_the_checks(town_map, tmp_path, lod):
    report = build([town_map], tmp_path / "city", replace(OPTIONS, lod=lod))
    assert {name for name, check in report["checks"].items() if not check["ok"]} == set()
    assert (report["counts"]["instances"] > 0) == (lod > 0)


def test_a_window_holds_less_and_is_checked_too(town_map, tmp_path):
    report = build([town_map], tmp_path / "cut", replace(OPTIONS, size=(80.0, 100.0)))
    assert 0 < report["counts"]["buildings"] < 11
    assert all(check["ok"] for check in report["checks"].values())


def test_a_window_beside_the_map_is_refused(town_map, tmp_path):
    with pytest.raises(UsageError, match="lies outside the map, which covers latitude 60"):
        build([town_map], tmp_path / "cut", replace(OPTIONS, at=(10.0, 10.0)))
    assert list(tmp_path.iterdir()) == []


def test_a_failed_build_leaves_the_older_city_as_it_was(built, tmp_path):
    out, _ = built
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*")}
    broken = tmp_path / "broken.osm"
    broken.write_text("<osm><node id='1'")
    with pytest.raises(InputError):
        build([broken], out, OPTIONS)
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*")} == before


def test_two_maps_are_refused(town_map, tmp_path):
    with pytest.raises(UsageError, match="given: 2 maps"):
        build([town_map, town_map], tmp_path / "x", OPTIONS)


def test_terrain_from_a_height_file_carries_the_city(town_map, tmp_path):
    import numpy as np
    import rasterio
    from affine import Affine

    path = tmp_path / "hill.tif"
    rows, columns = np.mgrid[0:60, 0:60]
    heights = (100 + 0.25 * columns + 4 * np.sin(rows / 7)).astype(np.float32)
    transform = Affine(1e-4, 0, 24.937, 0, -1e-4, 60.173)
    profile = {"driver": "GTiff", "width": 60, "height": 60, "count": 1, "dtype": "float32"}
    with rasterio.open(path, "w", crs="EPSG:4326", transform=transform, **profile) as dataset:
        dataset.write(heights, 1)
    report = build([town_map, path], tmp_path / "hilly", OPTIONS)
    assert {name for name, check in report["checks"].items() if not check["ok"]} == set()
    city = read_city(tmp_path / "hilly" / "city")
    assert np.ptp(city.scene.meshes["ground"].vertices[:, 2]) > 3


SHARED = Path(__file__).parents[2] / ".." / "shared" / "data" / "osm"


@pytest.mark.shared
@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared real maps are absent")
@pytest.mark.parametrize("name", ["bristol_degenerate.osm", "saint_petersburg_clip.osm"])
def test_dirty_real_maps_build_with_every_check_kept(tmp_path, name):
    report = build([SHARED / name], tmp_path / "city", OPTIONS)
    assert {name for name, check in report["checks"].items() if not check["ok"]} == set()
