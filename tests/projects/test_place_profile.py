"""A city has the profile that its user asked for, and keeps it."""

import json

import pytest
from town import small_town
from typer.testing import CliRunner

from cityx.city.store import read_city
from cityx.cli.main import app
from cityx.errors import UsageError
from cityx.language.options import BuildOptions
from cityx.places.profiles import profile_of
from cityx.projects.build import build
from cityx.projects.edit import edit_city

OWN = 'inherits = "jp"\n[streets.lane_widths]\nsecondary = 3.75\n'


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("profile")
    town = small_town().write(folder / "town.osm")
    (folder / "own.toml").write_text(OWN)
    options = BuildOptions(
        lod=1, seed=5, formats=(), render=False, place_profile=str(folder / "own.toml")
    )
    return folder / "city", build([town], folder / "city", options)


def test_the_report_tells_the_country_and_the_profile(built):
    _, report = built
    assert report["place"] == {
        "country": "FI", "profile": ["own", "jp", "east_asia", "world"], "drive": "left",
    }  # fmt: skip
    assert {name for name, check in report["checks"].items() if not check["ok"]} == set()


def test_a_map_is_built_with_the_lanes_and_the_side_of_the_profile(built):
    city = read_city(built[0] / "city")
    roads = city.layout.roads
    assert set(roads["lane_width"][roads["kind"] == "secondary"]) == {3.75}
    assert city.network.left_hand.all()


def test_an_edit_keeps_the_profile(built):
    folder, _ = built
    edit_city(folder, "make the tallest building 40 m tall")
    city = read_city(folder / "city")
    assert profile_of(city.frame).lineage[:2] == ("own", "jp")
    assert json.loads((folder / "report.json").read_text())["place"]["drive"] == "left"


def test_a_profile_that_cannot_be_used_leaves_nothing(tmp_path):
    asked = CliRunner().invoke(app, ["build", "-o", str(tmp_path / "city"),
                                     "--place-profile", "jpn"])  # fmt: skip
    assert asked.exit_code != 0
    assert 'There is no profile of a place "jpn". Did you mean' in str(asked.exception)
    (tmp_path / "own.toml").write_text('[vehicles]\nplates = "uk"\n')
    options = BuildOptions(place_profile=str(tmp_path / "own.toml"))
    with pytest.raises(UsageError, match=r'vehicles\.plates knows no "uk"'):
        build([], tmp_path / "city", options)
    assert [path.name for path in tmp_path.iterdir()] == ["own.toml"]
