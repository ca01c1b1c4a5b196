from typing import Annotated

import pytest
import typer
from typer.testing import CliRunner

from cityx.cli.flags import with_flags
from cityx.cli.terminal import LONGEST, SHOWN, echo_some
from cityx.options import BuildOptions, PlannerChoice, declared


@pytest.fixture
def run():
    app, seen = typer.Typer(), []

    @app.command()
    @with_flags
    def command(
        name: Annotated[str, typer.Argument()], *, options: BuildOptions, loud: bool = False
    ):
        seen.append((name, options, loud))

    def called(*words):
        done = CliRunner().invoke(app, list(words))
        return done, seen

    return called


def test_without_flags_the_options_are_their_defaults(run):
    done, seen = run("a")
    assert done.exit_code == 0, done.output
    assert seen == [("a", BuildOptions(), False)]


def test_flags_become_the_values_of_the_dataclasses(run):
    done, seen = run("a", "--lod", "3", "--size", "30x20", "--no-render", "--set", "x=1", "--set",
                     "y=2", "--planner", "ollama:m", "--as", "a=osm", "--loud")  # fmt: skip
    assert done.exit_code == 0, done.output
    ((name, options, loud),) = seen
    assert (name, loud, options.lod, options.size, options.render) == (
        "a",
        True,
        3,
        (30, 20),
        False,
    )
    assert options.settings == ("x=1", "y=2")
    assert (options.choice, options.read.kinds) == (PlannerChoice("ollama:m"), ("a=osm",))


def test_the_help_shows_every_flag_with_its_text(run):
    done, _ = run("--help")
    words = " ".join(done.output.split())
    for item in declared(BuildOptions):
        assert item.flag.split("/")[0] in words
        assert item.option.help.split()[0] in words


@pytest.mark.parametrize("words", [("--lod", "4"), ("--samples", "0"), ("--budget-tokens", "-1")])
def test_bounds_are_those_of_the_declaration(run, words):
    done, seen = run("a", *words)
    assert done.exit_code == 2
    assert not seen


def test_a_long_list_ends_with_how_many_more_there_are(capsys):
    echo_some([f"note {n}" for n in range(103)])
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1] == "... and 97 more, see report.json"
    assert lines[:-1] == [f"note {n}" for n in range(SHOWN)]


def test_a_list_of_ids_in_one_line_is_cut(capsys):
    echo_some([" ".join(f"{n:016x}" for n in range(200))])
    (line,) = capsys.readouterr().out.splitlines()
    assert len(line) < LONGEST + 40
    assert line.endswith("... see report.json")
