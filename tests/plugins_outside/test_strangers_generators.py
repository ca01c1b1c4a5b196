"""A stranger's generator of a table stands as those of CityX do: by command, words, style, edit."""

import json

import numpy as np
import pytest
from strangers import built, cityx, failed_checks, put_package, run_python

from cityx.city.mesh_measures import check_closed
from cityx.city.store import read_city

NAMED = {"action": "building/longhouse-v1", "package": "cityx-guide"}
TABLE = """
title = "Twin hall"
labels = ["pair of halls"]
[look]
walls = [[1, "brick", ["$REDS"]]]
[look.facade]
mode = "punched"
bay = 3.0
windows = "window_small"
doors = "door_service"
[zones.link]
walls = [[1, "plaster", [0xE4D8C0]]]
"""
VOLUMES = """
from typing import Annotated

from cityx.building.massing.lots import lot_of
from cityx.building.massing.massing import Mass
from cityx.protocol import Range


def masses(plot, *, gap: Annotated[float, Range(1.0, 6.0)] = 3.0) -> tuple[Mass, ...]:
    '''Build two halls with a lower part between them.

    Parameters
    ----------
    gap
        Metres between the halls.
    '''
    lot, half = lot_of(plot), gap / 2
    sides = [(-lot.x, -lot.y, -half, lot.y), (half, -lot.y, lot.x, lot.y)]
    link = (-half, -lot.y, half, lot.y)
    return (
        *lot.masses(sides, low=0.0, high=plot.height),
        *lot.masses([link], low=0.0, high=3.0, zone="link"),
    )


def broken(plot) -> tuple[Mass, ...]:
    '''Build nothing.'''
    return {}["no key"]
"""


def package(folder, name, table, entry="", module="", **files):
    """Leave a package of one generator in a folder; None for a table leaves it out."""
    held = {f"{name}s/{name}.toml": table} if table is not None else {}
    held |= {f"{name}s/__init__.py": module} if module else {}
    entries = {"cityx.generators": {f"building/{name}-v1": entry or f"{name}s"}}
    return put_package(folder, f"cityx-{name}", held | files, entries)


def generators_of(out):
    return read_city(out / "city").layout.buildings["generator"].tolist()


@pytest.mark.parametrize("lod", [1, 2, pytest.param(3, marks=pytest.mark.slow)])
def test_a_table_alone_gives_walls_windows_doors_and_roofs(strangers, nobody, town, tmp_path, lod):
    words = ("--lod", lod, "--do", "building/longhouse-v1")
    report = built(strangers, town, tmp_path / "out", *words)
    assert (failed_checks(report), report["failures"]) == ({}, [])
    assert report["generators"] == {"longhouse": {"buildings": 4, **NAMED}}
    plain = built(nobody, town, tmp_path / "plain", "--lod", lod)
    assert report["hash"] != plain["hash"]
    city = read_city(tmp_path / "out" / "city")
    assert check_closed(city.scene.meshes["buildings"]).all()
    assert set(city.layout.parts["roof_shape"]) <= {"gabled", "gambrel"}
    if lod > 1:
        rows = city.scene.instances
        assert min(rows["windows"].count, rows["doors"].count) >= 4


def test_a_style_of_its_own_and_a_setting_choose_it(strangers, town, tmp_path):
    built(strangers, town, tmp_path / "style", "--lod", 1, "--style", "viking")
    assert generators_of(tmp_path / "style") == ["longhouse"] * 4
    built(strangers, town, tmp_path / "set", "--lod", 1, "--set", "design.generator=longhouse")
    assert generators_of(tmp_path / "set") == ["longhouse"] * 4


def test_a_sentence_that_names_it_builds_a_town_of_it(strangers, tmp_path):
    out = tmp_path / "out"
    cityx(strangers, "build", "a town of viking halls", "-o", out, "--lod", 1, "--size",
          "160x160", "--no-render", "--formats", "")  # fmt: skip
    report = json.loads((out / "report.json").read_text())
    assert next(each for each in report["goals"] if "longhouse" in each["goal"])["met"] is True
    assert failed_checks(report) == {}


def test_an_edit_turns_one_building_into_it(strangers, nobody, town, tmp_path):
    out = tmp_path / "out"
    built(nobody, town, out, "--lod", 2)
    cityx(strangers, "edit", out, "turn the largest building into a viking hall")
    city = read_city(out / "city")
    rows = city.layout.buildings
    mine = rows["id"][rows["generator"] == "longhouse"].to_numpy(np.uint64)
    assert len(mine) == 1
    assert np.isin(city.scene.instances["windows"].owner, mine).sum() >= 2
    assert failed_checks(json.loads((out / "report.json").read_text())) == {}
    # Without the package what stands keeps standing.
    cityx(nobody, "edit", out, "make the tallest building 30 m tall")


def test_a_function_of_the_package_grows_the_volumes(town, tmp_path):
    site = tmp_path / "site"
    site.mkdir()
    folder = package(site, "twin_hall", TABLE, "twin_halls:masses", VOLUMES)
    words = ("--lod", 2, "--do", "building/twin_hall-v1 gap=2")
    report = built(folder, town, tmp_path / "out", *words)
    assert (failed_checks(report), report["failures"]) == ({}, [])
    parts = read_city(tmp_path / "out" / "city").layout.parts
    assert parts["zone"].tolist().count("link") == 4
    assert len(parts) == 12
    assert "0 failed" in cityx(folder, "plugins", "check", "building/twin_hall-v1")


def test_a_folder_that_is_not_installed_is_checked(tmp_path, nobody):
    folder = package(tmp_path, "twin_hall", TABLE)
    (folder / "pyproject.toml").write_text(
        '[project]\nname = "cityx-halls"\n[project.entry-points."cityx.generators"]\n'
        '"building/twin_hall-v1" = "twin_halls"\n'
    )
    assert "7 passed, 0 failed" in cityx(nobody, "plugins", "check", folder)


def test_volumes_that_fail_leave_the_plain_block_and_are_named(town, tmp_path):
    site = tmp_path / "site"
    site.mkdir()
    folder = package(site, "twin_hall", TABLE, "twin_halls:broken", VOLUMES)
    words = ("--lod", 1, "--set", "design.generator=twin_hall")
    report = built(folder, town, tmp_path / "out", *words)
    why = "twin_hall kept its plain block: its package failed: KeyError: 'no key'"
    assert [failure["error"] for failure in report["failures"]] == [why] * 4
    assert failed_checks(report) == {}


# Name of the generator, its table, entry and module; what the report says of it.
BAD = {
    "lost": (None, "", "", "there is no module losts."),
    "bare": (None, "", "x = 1", "there is no bare.toml beside the module bares."),
    "wrong": (TABLE.replace("bay", "bey"), "", "",
              'wrong.toml, look, facade: there is no key "bey". Did you mean "bay" or "base"? '
              'wrong.toml, look, facade: the key "bay" is missing.'),
    "unseen": (TABLE.replace("window_small", "window_smal"), "", "",
               'unseen.toml, look, facade, windows: there is no "window_smal". '
               'Did you mean "window_small" or "window_slit" or "window_sash"?'),
    "sold": ("styles = {viking = -1}" + TABLE, "", "",
             'sold.toml: the weight of style "viking" is no number >= 0.'),
    "locked": (TABLE, "lockeds:masses", "raise RuntimeError('no licence')",
               "RuntimeError: no licence."),
    "church": (TABLE, "", "", 'the name "church" is taken by a building of CityX.'),
}  # fmt: skip


def test_bad_ones_are_named_in_one_sentence_and_break_no_other(nobody, town, tmp_path):
    site = tmp_path / "site"
    site.mkdir()
    for name, (table, entry, module, _) in BAD.items():
        package(site, name, table, entry, module)
    package(site, "twin_hall", TABLE)
    put_package(site, "cityx-zwei", {}, {"cityx.generators": {"building/twin_hall-v1": "zwei"}})
    report = built(site, town, tmp_path / "bad", "--lod", 1)
    said = sorted(note for note in report["notes"] if "building/" in note)
    bad = {name: why for name, (*_, why) in BAD.items() if name != "church"}
    assert said == sorted([
        *(f"Generator building/{name}-v1 of package cityx-{name} cannot be used: {why}"
          for name, why in bad.items()),
        "Action building/church-v1 is registered twice, by cityx and cityx-church.",
        "Action building/twin_hall-v1 is registered twice, by cityx-twin_hall and cityx-zwei.",
    ])  # fmt: skip
    assert report["hash"] == built(nobody, town, tmp_path / "good", "--lod", 1)["hash"]
    built(site, town, tmp_path / "out", "--lod", 1, "--set", "design.generator=twin_hall")
    assert generators_of(tmp_path / "out") == ["twin_hall"] * 4
    words = ("build", town, "-o", tmp_path / "no", "--do", "building/locked-v1")
    code, _, wrong = run_python(site, "-m", "cityx.cli", *words)
    assert (code, wrong.count("no licence")) == (2, 1)
    assert "Traceback" not in wrong
