"""What README and docs show is run, or at least read as the program reads it."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer.main

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
# What neither fetches, renders nor builds.
QUICK = ("explain", "plugins list", "plugins show", "plugins formats")


def _blocks(page, *languages):
    return [text for language, text in BLOCK.findall(page.read_text()) if language in languages]


def _commands(page):
    """Return the commands of a page as lists of words."""
    text = "".join(_blocks(page, "", "sh", "bash", "console", "shell")).replace("\\\n", " ")
    lines = [line.removeprefix("$ ").strip() for line in text.splitlines()]
    return [shlex.split(line, comments=True)[1:] for line in lines if line.startswith("cityx ")]


COMMANDS = [pytest.param(words, id=f"{page.name}: {' '.join(words)[:60]}")
            for page in PAGES for words in _commands(page)]  # fmt: skip


@pytest.fixture(scope="session")
def commands():
    from cityx.cli.main import app

    return typer.main.get_command(app)


@pytest.mark.parametrize("words", COMMANDS)
def test_every_command_of_the_pages_is_one_that_the_program_knows(commands, words):
    command, rest = commands, list(words)
    while hasattr(command, "commands"):
        if rest[0] == "bench" and rest[0] not in command.commands:
            pytest.skip("the benchmarks are not installed")
        assert rest[0] in command.commands
        command = command.commands[rest.pop(0)]
    command.make_context(command.name, rest)  # refuses what it does not know


@pytest.mark.parametrize(
    "words", [one for one in COMMANDS if " ".join(one.values[0]).startswith(QUICK)]
)
def test_quick_commands_run(monkeypatch, capsys, words):
    from cityx.cli.main import main

    monkeypatch.setattr(sys, "argv", ["cityx", *words])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 0, capsys.readouterr().err
    assert capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", [pytest.param(page, id=page.name) for page in PAGES if _blocks(page, "python")]
)
def test_python_of_the_pages_runs(page, town_map, tmp_path):
    code = "\n".join(_blocks(page, "python"))
    if "plot(" in code or "explore(" in code:
        pytest.importorskip("matplotlib")
    (tmp_path / "MAP.osm").write_bytes(town_map.read_bytes())
    (tmp_path / "robot.xml").write_bytes((ROOT / "examples/contact/robot.xml").read_bytes())
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    commands = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    env = {**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": path, "PATH": commands}
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path,
                         env=env)  # fmt: skip
    assert run.returncode == 0, run.stderr
