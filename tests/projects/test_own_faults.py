"""A step that breaks by a fault of this program: all else is saved and a report asked for."""

import json
import sys
from functools import wraps

import pytest
from copies import copy_of

from cityx.cli.main import main
from cityx.projects.results import FAULTS
from cityx.protocol.registry import Registry


@pytest.fixture
def breaking(monkeypatch):
    """Let an action break by an error of Python."""

    def of(action, error):
        usual = Registry.function

        def function(self, name):
            found = usual(self, name)
            if name != action:
                return found

            @wraps(found)
            def broken(*_, **__):
                raise error

            return broken

        monkeypatch.setattr(Registry, "function", function)

    return of


def run(monkeypatch, capsys, *words):
    monkeypatch.setattr(sys, "argv", ["cityx", *map(str, words)])
    with pytest.raises(SystemExit) as stop:
        main()
    return stop.value.code or 0, capsys.readouterr().err


@pytest.mark.parametrize(
    ("action", "error"),
    [
        ("nature/trees-v2", IndexError("list index out of range")),
        ("nature/furniture-v1", KeyError("a")),
        ("background/weather-v1", ZeroDivisionError("division by zero")),
    ],
)
def test_a_step_that_breaks_ends_with_3_after_all_else_is_saved(
    town_map, tmp_path, monkeypatch, capsys, breaking, action, error
):
    breaking(action, error)
    out = tmp_path / "out"
    words = ("--no-render", "--formats", "", "--lod", "2")
    code, said = run(monkeypatch, capsys, "build", town_map, "-o", out, *words)
    assert code == 3
    assert action in said
    assert "please report" in said
    assert str(out / FAULTS) in said
    assert type(error).__name__ in (out / FAULTS).read_text()
    assert "Traceback" in (out / FAULTS).read_text()
    assert "Traceback" not in said
    report = json.loads((out / "report.json").read_text())
    assert report["counts"]["buildings"] > 0
    assert any(action in fault for fault in report["faults"])
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_an_edit_that_breaks_asks_for_a_report_and_leaves_the_city(
    built_town, tmp_path, monkeypatch, capsys, breaking
):
    folder = copy_of(built_town("glb"), tmp_path / "town")
    before = (folder / "report.json").read_bytes()
    breaking("edit/set_height-v1", IndexError("list index out of range"))
    code, said = run(monkeypatch, capsys, "edit", folder, "make the tallest building 40 m tall")
    assert code == 3
    assert "please report" in said
    assert (folder / "report.json").read_bytes() == before
