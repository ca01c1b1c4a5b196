"""The recipe of CONTRIBUTING works as printed, in an environment of its own and without network."""

import json
import os
import re
import shlex
import site
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def recipe():
    text = (ROOT / "CONTRIBUTING.md").read_text().partition("## Add a plugin")[2]
    return re.search(r"```\n(.*?)```", text, re.DOTALL)[1].splitlines()


@pytest.fixture
def python(tmp_path):
    """Return a Python that has what this one has, and takes packages of its own."""
    venv.create(tmp_path / "venv", with_pip=False)
    folder = tmp_path / "venv" / "lib" / f"python{sys.version_info[0]}.{sys.version_info[1]}"
    # Folders whose own .pth files count too, as they do here.
    lines = [f"import site; site.addsitedir({path!r})" for path in site.getsitepackages()]
    text = "\n".join([str(ROOT), *lines]) + "\n"
    (folder / "site-packages" / "shared.pth").write_text(text)
    return tmp_path / "venv" / "bin" / "python"


@pytest.mark.slow
def test_the_recipe_ends_in_a_city_of_the_new_building(python, tmp_path):
    environment = {key: text for key, text in os.environ.items() if key != "PYTHONPATH"}
    environment |= {"PIP_NO_INDEX": "1"}
    for line in recipe():
        program, *words = shlex.split(line)
        assert program == "cityx"
        more = ["--no-render", "--formats", "", "--lod", "1"] if words[0] == "build" else []
        done = subprocess.run(
            [python, "-m", "cityx.cli", *words, *more], cwd=tmp_path, env=environment,
            capture_output=True, text=True, timeout=300, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
    report = json.loads((tmp_path / "town" / "report.json").read_text())
    assert list(report["generators"]) == ["bell_tower"]
    assert all(check["ok"] for check in report["checks"].values())
