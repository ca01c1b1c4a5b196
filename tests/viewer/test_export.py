"""A static site holds all that its page asks for, by relative names."""

import json
import sys

import pytest

from cityx.agents.loop import quiet
from cityx.cli.main import main
from cityx.errors import InputError, UsageError
from cityx.viewer.export import export_site


@pytest.fixture(scope="module")
def site(built_town, tmp_path_factory, page):  # noqa: ARG001
    folder = tmp_path_factory.mktemp("site") / "site"
    told = export_site(built_town(lod=2), folder, quiet)
    assert told["files"] == sum(path.is_file() for path in folder.rglob("*"))
    return folder


def test_every_file_that_the_scene_names_is_there(site):
    scene = json.loads((site / "scene.json").read_text())
    assert scene["live"] is False
    for kind in ("chunks", "packs"):
        names = {f"{item['name']}.glb" for item in scene[kind]}
        assert names == {path.name for path in (site / kind).iterdir()}
    assert (site / "paints" / f"{scene['paints']}.glb").is_file()


def test_the_page_names_nothing_outside_its_folder(site):
    text = (site / "index.html").read_text()
    assert 'src="app.js"' in text
    assert 'href="style.css"' in text
    assert "http" not in text
    assert 'src="/' not in text


def test_objects_are_told_of_in_the_bucket_of_their_id(site):
    buckets = [json.loads(path.read_text()) for path in sorted((site / "objects").iterdir())]
    assert len(buckets) == 256
    told = {name: item for bucket in buckets for name, item in bucket.items()}
    houses = [item for item in told.values() if "layout/buildings" in item["layers"]]
    assert len(houses) >= 11
    assert all(item["source"].startswith("osm/way/") for item in houses)
    for number, bucket in enumerate(buckets):
        assert {name[:2] for name in bucket} <= {f"{number:02x}"}


def test_a_site_takes_the_place_of_an_older_one_and_of_nothing_else(built_town, tmp_path, site):
    del site
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "letter.txt").write_text("dear")
    with pytest.raises(UsageError, match="holds other files"):
        export_site(built_town(lod=2), mine, quiet)
    assert (mine / "letter.txt").read_text() == "dear"
    with pytest.raises(InputError, match="holds no city"):
        export_site(mine, tmp_path / "site", quiet)


def test_the_command_says_how_to_show_a_site(built_town, tmp_path, page, monkeypatch, capsys):
    del page
    words = ["cityx", "view", str(built_town(lod=2)), "--export", str(tmp_path / "site")]
    for _ in range(2):  # the second takes the place of the first
        monkeypatch.setattr(sys, "argv", words)
        with pytest.raises(SystemExit) as stop:
            main()
        assert stop.value.code == 0
    assert f"python3 -m http.server -d {tmp_path / 'site'}" in capsys.readouterr().out
