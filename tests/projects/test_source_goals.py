"""Goals on the files of a build are measured with these files, whatever they are called."""

import json
import shutil

import numpy as np
import pytest
from PIL import Image
from town import Town

from cityx.options import BuildOptions, HowToRead
from cityx.projects.build import build, recheck


def goals_on_sources(report):
    return {g["predicate"]: g["met"] for g in report["goals"] if g["goal"].startswith("source")}


@pytest.fixture(scope="module")
def town_map(tmp_path_factory):
    town = Town()
    town.way([town.node(x, 0) for x in (-150, 0, 150)], highway="residential", lanes="2")
    for x in range(-140, 140, 28):
        town.box(x, 10, 20, 14, building="yes")
        town.box(x, -24, 20, 14, building="yes")
    return town.write(tmp_path_factory.mktemp("map") / "town.osm")


def made(path, out, text="a town", **options):
    chosen = BuildOptions(text=text, lod=0, render=False, formats=(), **options)
    return build([path], out, chosen)


@pytest.mark.parametrize("name", ["town.osm", "My old-town (2).osm"])
@pytest.mark.parametrize("size", [None, (150.0, 150.0)])
def test_a_build_from_words_and_a_map_keeps_the_map(town_map, tmp_path, name, size):
    path = tmp_path / name
    shutil.copy(town_map, path)
    found = goals_on_sources(made(path, tmp_path / "out", size=size))
    assert set(found.values()) == {True}
    assert len(found) == 2


def test_a_check_without_the_files_keeps_what_was_measured(town_map, tmp_path):
    path = tmp_path / "town.osm"
    shutil.copy(town_map, path)
    before = goals_on_sources(made(path, tmp_path / "out"))
    path.unlink()
    assert goals_on_sources(recheck(tmp_path / "out")) == before
    written = json.loads((tmp_path / "out" / "report.json").read_text())
    assert set(goals_on_sources(written).values()) == {True}


def test_a_picture_of_classes_is_measured_as_the_user_says_to_read_it(tmp_path):
    picture = np.full((200, 200, 3), (70, 110, 60), np.uint8)
    picture[95:105] = (128, 128, 128)
    for y, x in ((30, 30), (30, 70), (30, 130), (130, 30), (140, 90)):
        picture[y : y + 20, x : x + 25] = (200, 40, 40)
    picture[130:180, 130:190] = (40, 80, 200)
    path = tmp_path / "Plan 1.png"
    Image.fromarray(picture).save(path)
    read = HowToRead(kinds=("Plan 1.png=semantic",), pixel=1.0, confirm_legend=True)
    found = goals_on_sources(made(path, tmp_path / "out", read=read))
    assert found == {
        'iou(building, "plan 1.png") >= 0.85': True, 'iou(water, "plan 1.png") >= 0.8': True,
    }  # fmt: skip
