"""Data sets over tiles: each is loaded when its turn comes, and sees what lies about it."""

import json
import shutil
import sys

import numpy as np
import pytest
from copies import copy_of

from cityx.cli.main import main
from cityx.dataset.cities import read_shots
from cityx.dataset.writers.exr import read_exr
from cityx.errors import InputError
from cityx.tiles.region import region_about, write_region
from cityx.tiles.run import TILES, records
from cityx.tiles.stops import stops_in

PIXELS = ("--size", "48x32", "--channels", "depth,instance,semantic")


def run(monkeypatch, *words):
    monkeypatch.setattr(sys, "argv", ["cityx", "dataset", *map(str, words)])
    with pytest.raises(SystemExit) as stop:
        main()
    return stop.value.code


def lines_of(out):
    return [json.loads(line) for line in (out / "manifest.jsonl").read_text().splitlines()]


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """A flight from one tile over the corner of four into another, 20 m a frame."""
    path = tmp_path_factory.mktemp("plan") / "flight.json"
    keys = [{"t": 0, "position": [-90, -30, 60], "heading_deg": 70},
            {"t": 0.9, "position": [90, 30, 60], "heading_deg": 70}]  # fmt: skip
    path.write_text(json.dumps({"trajectories": [{"name": "flight", "keys": keys}]}))
    return path


@pytest.fixture(scope="module")
def flown(built_tiles, flight, tmp_path_factory):
    """The data set of the flight over a copy of the tiles of which one is not built yet."""
    folder = tmp_path_factory.mktemp("flown")
    tiles, out = copy_of(built_tiles, folder / "tiles"), folder / "out"
    shutil.rmtree(tiles / TILES / "0_0")
    with pytest.MonkeyPatch.context() as patch:
        assert run(patch, "--tiles", tiles, "--plan", flight, *PIXELS, "-o", out) == 0
    assert len(records(tiles)) == 4
    return out


def test_each_frame_of_a_flight_is_taken_once_in_the_tile_that_it_is_over(flown):
    lines = lines_of(flown)
    shots = {name: read_shots(flown / "cities" / name / "shots.jsonl")
             for name in ("tile_-1_-1", "tile_0_0")}  # fmt: skip
    x = {shot.frame: shot.camera.position[0] for own in shots.values() for shot in own}
    assert sorted(x) == list(range(10))
    assert [shot.frame for shot in shots["tile_-1_-1"]] == [k for k in range(10) if x[k] < 0]
    assert sum("number" in line for line in lines) == 10
    assert not (flown / ".work").exists()


def test_frames_of_tiles_are_those_of_one_city(flown, flight, built_tiles, monkeypatch, tmp_path):
    write_region(region_about(built_tiles, (0.0, 0.0), (900.0, 900.0)), tmp_path / "whole")
    code = run(monkeypatch, tmp_path / "whole", "--plan", flight, *PIXELS, "-o", tmp_path / "out")
    assert code == 0
    ours, theirs = ({path.name: path for path in folder.rglob("*.exr")}
                    for folder in (flown, tmp_path / "out"))  # fmt: skip
    assert len(ours) >= 10
    assert set(ours) == set(theirs)
    for name, path in ours.items():
        one, other = read_exr(path), read_exr(theirs[name])
        for channel in one:
            assert np.array_equal(one[channel], other[channel], equal_nan=True), (name, channel)
    tables = [json.loads((folder / "cities" / city / "objects.json").read_text())["objects"]
              for folder, city in ((flown, "tile_0_0"), (tmp_path / "out", "whole"))]  # fmt: skip
    known = {record["id"]: record for record in tables[1]}
    assert all(known[record["id"]]["class"] == record["class"] for record in tables[0])


def test_drawn_views_are_in_their_tile_and_the_same_whichever_tiles_are_asked_for(
    built_tiles, monkeypatch, tmp_path
):
    words = ("--tiles", built_tiles, "--views", 2, *PIXELS)
    for name, area in (("two", "0,250"), ("one", "250,250")):
        spot = ("--at", area, "--area", "9x9", "-o", tmp_path / name)
        assert run(monkeypatch, *words, *spot) == 0
    shots = {path.parent.name: read_shots(path) for path in tmp_path.glob("two/cities/*/*.jsonl")}
    assert {name: len(own) for name, own in shots.items()} == {"tile_-1_0": 2, "tile_0_0": 2}
    for name, own in shots.items():
        west, south = (500 * int(part) for part in name.split("_")[1:])
        for shot in own:
            x, y, _ = shot.camera.position
            assert west <= x <= west + 500
            assert south <= y <= south + 500
    (alone,) = (tmp_path / "one" / "cities").iterdir()
    assert alone.name == "tile_0_0"
    assert read_shots(alone / "shots.jsonl") == shots["tile_0_0"]


def test_what_is_asked_of_tiles_is_checked(built_tiles, monkeypatch, capsys, tmp_path):
    assert run(monkeypatch, built_tiles, "--at", "0,0", "-o", tmp_path / "out") == 2
    assert "give --tiles" in capsys.readouterr().err
    words = ("--tiles", built_tiles, "--cities", "1-2", "-o", tmp_path / "out")
    assert run(monkeypatch, *words) == 2
    assert "leave out DIR and --cities" in capsys.readouterr().err
    with pytest.raises(InputError, match="No tile lies in the area"):
        stops_in(built_tiles, (9e4, 9e4, 9.1e4, 9.1e4))
