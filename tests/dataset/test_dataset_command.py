"""The command `cityx dataset`, from words to files, on a small town."""

import json
import re
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from cityx.cli.main import main
from cityx.dataset.cities import build_source, read_shots
from cityx.dataset.classes import CLASSES
from cityx.dataset.order import SEED, Order, Source, differences, identity_of
from cityx.dataset.writers.exr import read_exr


def run(monkeypatch, capsys, *words):
    monkeypatch.setattr(sys, "argv", ["cityx", "dataset", *map(str, words)])
    with pytest.raises(SystemExit) as stop:
        main()
    return stop.value.code, capsys.readouterr()


@pytest.fixture
def town(built_town):
    return built_town(lod=1)


def test_all_faults_are_told_at_once_before_any_work(monkeypatch, capsys, tmp_path):
    code, said = run(
        monkeypatch, capsys, tmp_path / "lost", "--plan", "stret", "--rig", "stero", "--size",
        "10by20", "--channels", "depht", "--format", "koko", "--quality", "papr", "--lidar",
        "velo", "--disk-budget", "-1", "--place-profile", "jpn", "-o", tmp_path / "out",
    )  # fmt: skip
    assert code == 2
    text = " ".join(said.err.split())
    for words in (
        f"{tmp_path / 'lost'} does not exist.", '--size "10by20" is not of the form 1920x1080.',
        'There is no plan "stret"', 'There is no rig "stero"', 'There is no channel "depht"',
        'There is no format "koko"', 'There is no quality "papr"', 'There is no LiDAR "velo"',
        "--disk-budget -1 is no room for a dataset.",
        'There is no profile of a place "jpn".',
    ):  # fmt: skip
        assert words in text, words
    assert list(tmp_path.iterdir()) == []


def test_a_folder_without_a_city_is_named(monkeypatch, capsys, tmp_path):
    (tmp_path / "empty").mkdir()
    code, said = run(monkeypatch, capsys, tmp_path / "empty", "--channels", "depth",
                     "-o", tmp_path / "out")  # fmt: skip
    assert code == 2
    assert f"{tmp_path / 'empty'} holds no city" in said.err


def test_formats_of_pictures_ask_for_rgb(monkeypatch, capsys, tmp_path):
    code, said = run(monkeypatch, capsys, tmp_path / "lost", "--channels", "depth", "--format",
                     "coco,kitti", "--rig", "surround", "-o", tmp_path / "out")  # fmt: skip
    assert code == 2
    assert "coco, kitti is made of pictures: add rgb to --channels." in said.err
    assert "kitti knows the cameras left, mono, right" in said.err


@pytest.mark.slow
def test_a_camera_underground_is_refused_before_any_work(monkeypatch, capsys, tmp_path, town):
    file = tmp_path / "cameras.json"
    view = {"name": "mole", "position": [0, 0, -20], "heading_deg": 0}
    file.write_text(json.dumps({"cameras": [view]}))
    code, said = run(monkeypatch, capsys, town, "--plan", file, "--channels", "depth",
                     "-o", tmp_path / "out")  # fmt: skip
    assert code == 2
    assert "mole" in said.err
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_town_becomes_a_dataset_whose_ids_link_to_objects(monkeypatch, capsys, tmp_path, town):
    out = tmp_path / "out"
    words = (town, "--views", 4, "--size", "96x64", "--channels", "truth", "--boxes", "--format",
             "raw", "--lidar", "spinning_16", "--workers", 2, "-o", out)  # fmt: skip
    monkeypatch.setattr(sys, "argv", ["cityx", "dataset", *map(str, words)])
    with suppress(SystemExit):
        main()
    said = capsys.readouterr()
    assert re.search(r"4 shots in .*, [0-9.]+ a second \(truth [0-9.]+ s, files", said.out)
    objects = json.loads((out / "cities" / town.name / "objects.json").read_text())["objects"]
    known = {int(record["id"], 16): record for record in objects}
    materials = json.loads((out / "cities" / town.name / "materials.json").read_text())
    shots = read_shots(out / "cities" / town.name / "shots.jsonl")
    assert len(shots) == 4
    seen = set()
    for shot in shots:
        found = read_exr(out / "raw" / town.name / f"{shot.name}.exr")
        ids, rows = np.unique(found["instance"], return_index=True)
        for object_id, number in zip(
            ids.tolist(), found["semantic"].ravel()[rows].tolist(), strict=True
        ):
            if object_id:
                assert known[object_id]["class"] == number
                assert known[object_id]["name"] == CLASSES[number].name
                seen.add(object_id)
        assert {str(number) for number in np.unique(found["material"]).tolist()} <= set(materials)
        sweep = np.load(out / "raw" / town.name / f"{shot.name}_lidar.npy")
        assert set(sweep["object_id"].tolist()) <= set(known)
    sources = {known[object_id]["source"].split("/")[0] for object_id in seen}
    assert {"osm", "rule"} & sources
    assert any("OpenStreetMap" in record["licence"] for record in objects)
    card = (out / "README.md").read_text()
    assert "© OpenStreetMap contributors" in card
    assert "shots a second" in card
    page = (out / "index.html").read_text()
    assert not re.findall(r'(?:src|href)="(?!data:|README\.md)[^"]+"', page)
    assert page.count("data:image/") >= 4 * 5
    assert len(json.loads((out / "classes.json").read_text())) == len(CLASSES)


@pytest.mark.slow
def test_towns_of_seeds_become_one_dataset(tmp_path):
    command = [sys.executable, "-m", "cityx.cli", "dataset", "--cities", "3-4", "--town-size",
               "100x100", "--lod", "0", "--views", "1", "--size", "32x24", "--channels",
               "semantic", "-o", tmp_path / "out"]  # fmt: skip
    first = subprocess.run(command, capture_output=True, text=True)
    assert first.returncode == 0, first.stderr
    cities = [path.parent.name for path in sorted((tmp_path / "out").glob("cities/*/city.json"))]
    assert cities == ["town_000003", "town_000004"]
    hashes = {(tmp_path / "out" / "cities" / c / "objects.json").read_text() for c in cities}
    assert len(hashes) == 2
    again = subprocess.run(command, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    assert "its files are checked" in again.stderr


def test_cities_of_an_order_are_built_as_its_place_builds(tmp_path):
    profile = tmp_path / "own.toml"
    profile.write_text('inherits = "jp"\n')
    order = Order(lod=0, town_size=(100.0, 100.0), place_profile=str(profile))
    source = Source("town", SEED, seed=3)
    before = identity_of(order, [source])
    build_source(source, order, tmp_path, print)
    report = json.loads((tmp_path / "cities" / "town" / "report.json").read_text())
    assert (report["place"]["profile"][:2], report["place"]["drive"]) == (["own", "jp"], "left")
    profile.write_text('inherits = "kr"\n')
    assert len(differences(before, identity_of(order, [source]))) == 1  # of the file's content
    assert "place_profile" not in identity_of(Order(), [source])["order"]


def test_cities_that_are_built_already_keep_their_place(monkeypatch, capsys, tmp_path):
    (tmp_path / "built" / "city").mkdir(parents=True)
    (tmp_path / "built" / "city" / "city.json").write_text("{}")
    code, said = run(monkeypatch, capsys, tmp_path / "built", "--channels", "depth",
                     "--place-profile", "jp", "-o", tmp_path / "out")  # fmt: skip
    assert code == 2
    assert "--place-profile is for cities that are built here" in said.err


MEMORY = """
import sys, psutil
from dataclasses import replace
from pathlib import Path
from cityx.dataset.cities import open_site, plan_shots
from cityx.dataset.makers import Wanted, open_city
from cityx.dataset.order import FOLDER, Order, Source

if __name__ == "__main__":
    store = Path(sys.argv[1]) / "city"
    order = Order(views=40, size=(64, 48), channels=("truth",), boxes=True, lidar="spinning_16")
    shots = plan_shots(open_site(Source("town", FOLDER, store.parent), store), order)
    maker = open_city(store, order, 1)
    process = psutil.Process()
    held = []
    for _ in range(6):
        for record in maker([Wanted(shot, None, True) for shot in shots]):
            held.append(process.memory_info().rss)
    print(len(held), max(held[40:80]), max(held[-40:]))
"""


@pytest.mark.slow
def test_two_hundred_frames_in_a_row_keep_the_memory_flat(town, tmp_path):
    script = tmp_path / "memory.py"
    script.write_text(MEMORY)
    said = subprocess.run([sys.executable, script, town], check=True, capture_output=True,
                          text=True).stdout  # fmt: skip
    frames, warm, last = map(int, said.split())
    assert frames == 240  # the first 40 warm it up
    assert last < 1.05 * warm
    assert Path(script).exists()
