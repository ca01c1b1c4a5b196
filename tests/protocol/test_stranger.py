"""A package from elsewhere adds an action without any change here."""

import ast
import importlib
import tomllib
from pathlib import Path

import pytest

from cityx.checks.conformance import check_action
from cityx.city.mesh_measures import check_closed
from cityx.protocol import registry
from cityx.protocol.example_city import example_city
from cityx.protocol.running import Call, run_step

EXAMPLE = Path(__file__).parents[2] / "examples" / "plugin"


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """The example as an installer would leave it: a module on the path and its metadata."""
    project = tomllib.loads((EXAMPLE / "pyproject.toml").read_text())["project"]
    info = tmp_path / "cityx_pagoda-0.1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: cityx-pagoda\nVersion: 0.1.0\n")
    points = project["entry-points"]["cityx.actions"]
    lines = [f"{name} = {run}" for name, run in points.items()]
    (info / "entry_points.txt").write_text("[cityx.actions]\n" + "\n".join(lines) + "\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.syspath_prepend(str(EXAMPLE))
    importlib.invalidate_caches()
    return registry()


def test_a_strangers_action_is_listed_checked_and_run(installed):
    assert installed.entry("building/pagoda-v1").package == "cityx-pagoda"
    results = check_action("building/pagoda-v1", installed)
    assert [r for r in results if r.passed is not True] == []
    city = run_step(example_city(), Call("pagoda", {"tiers": 3}), installed)
    batch = city.scene.meshes["buildings"]
    assert batch.count == 4
    assert check_closed(batch).all()


def test_the_action_takes_at_most_fifteen_lines():
    tree = ast.parse((EXAMPLE / "pagoda.py").read_text())
    (function,) = (node for node in tree.body if isinstance(node, ast.FunctionDef))
    doc = function.body[0]
    lines = function.end_lineno - function.decorator_list[0].lineno + 1
    assert lines - (doc.end_lineno - doc.lineno + 1) <= 15
