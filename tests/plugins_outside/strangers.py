"""Packages of strangers, left as an installer would leave them: the plugin guide's examples."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GUIDE = ROOT / "docs" / "plugin_guide.md"


def guide_files():
    """Return the example files of the guide by name, and its entry points."""
    text = GUIDE.read_text()
    blocks = re.findall(r"```\w+\n# ([\w/]+\.(?:py|toml))\n(.*?)```", text, re.DOTALL)
    (entries,) = re.findall(r"```toml\n(\[project.*?)```", text, re.DOTALL)
    return dict(blocks), tomllib.loads(entries)["project"]["entry-points"]


def put_package(folder, name, files, entries):
    """Leave modules and the metadata of a package in a folder."""
    for file, text in files.items():
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_text(text)
    info = folder / f"{name.replace('-', '_')}-0.1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 0.1.0\n")
    lines = []
    for group, points in entries.items():
        lines += [f"[{group}]", *(f"{key} = {run}" for key, run in points.items())]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    return folder


def run_python(folder, *words):
    """Run Python with the packages of a folder installed; returns code, output and errors."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(folder)])}
    done = subprocess.run(
        [sys.executable, *map(str, words)], env=environment, capture_output=True, text=True,
        timeout=600, check=False,
    )  # fmt: skip
    return done.returncode, done.stdout, done.stderr


def cityx(folder, *words):
    """Run the command line; fail the test if it does not succeed."""
    code, said, wrong = run_python(folder, "-m", "cityx.cli", *words)
    assert code == 0, said + wrong
    return said + wrong


def built(folder, town, out, *options):
    """Build a map without pictures and return the report."""
    cityx(folder, "build", town, "-o", out, "--no-render", "--formats", "", *options)
    return json.loads((out / "report.json").read_text())


def failed_checks(report):
    return {name: check for name, check in report["checks"].items() if not check["ok"]}


@pytest.fixture(scope="session")
def strangers(tmp_path_factory):
    """A folder on the path that holds every package of the guide."""
    files, entries = guide_files()
    return put_package(tmp_path_factory.mktemp("installed"), "cityx-guide", files, entries)


@pytest.fixture(scope="session")
def nobody(tmp_path_factory):
    """The same without a package."""
    return tmp_path_factory.mktemp("empty")


@pytest.fixture(scope="session")
def town(tmp_path_factory):
    """Four houses at a living street, one of them wall to wall with the next; a park; a hive."""
    sys.path.insert(0, str(ROOT / "tests"))
    from town import Town

    made = Town()
    street = [made.node(x, 0) for x in (-60, 0, 60)]
    made.way(street, highway="woonerf", name="Short Street")
    for x, y, width, depth in (
        (-50, 6, 22, 16),
        (-28, 6, 18, 16),
        (8, 7, 24, 20),
        (-40, -28, 26, 20),
    ):
        made.box(x, y, width, depth, building="yes", building__levels="3")
    made.box(5, -45, 45, 37, leisure="park", name="The Park")
    made.node(30, -30, man_made="beehive")
    return made.write(tmp_path_factory.mktemp("map") / "town.osm")
