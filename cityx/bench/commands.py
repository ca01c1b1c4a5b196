"""The commands of `cityx bench`; heavy modules are imported by the commands that need them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

bench = typer.Typer(help="Measure how often what is asked for comes about.", no_args_is_help=True)


@bench.callback()
def _root() -> None:
    """Keep the names of commands, even while there is but one."""


@bench.command()
def agents(
    driver: Annotated[
        str, typer.Option(help="offline, null, random, oracle, llm:SPEC or replay:FILE.")
    ] = "offline",
    tasks: Annotated[
        Path | None, typer.Option(help="Tasks (.json, .md); the public ones when left out.")
    ] = None,
    only: Annotated[str, typer.Option(help="Ids of tasks, comma-separated: P01,P02.")] = "",
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of log and results.")] = Path(
        "bench"
    ),
    seeds: Annotated[str, typer.Option(help="Seeds, comma-separated.")] = "0",
    lod: Annotated[int, typer.Option(min=0, max=3, help="Level of detail.")] = 2,
    jobs: Annotated[int, typer.Option(min=1, max=64, help="Processes.")] = 1,
) -> None:
    """Let a driver solve tasks in words, measure each, and write rates with their counts."""
    from cityx.bench.report import summary, write_results
    from cityx.bench.runner import Bench, run_bench, seeds_of
    from cityx.bench.tasks import PUBLIC, read_tasks

    names = [word.strip() for word in only.split(",") if word.strip()]
    chosen = read_tasks(tasks or PUBLIC, names)
    samples = run_bench(
        Bench(chosen, driver, out, seeds_of(seeds), lod, jobs),
        lambda line: typer.echo(line, err=True),
    )
    command = f"cityx bench agents --driver {driver} --seeds {seeds} --lod {lod}"
    command += f" --tasks {tasks}" if tasks else ""
    command += f" --only {only}" if only else ""
    for line in summary(write_results(samples, command, out)):
        typer.echo(line)
    typer.echo(str(out / "results.md"))


@bench.command()
def edits(
    held: Annotated[
        bool,
        typer.Option("--held", help="The set that was run before the program was tuned to it."),
    ] = False,
    unseen: Annotated[
        bool, typer.Option("--unseen", help="The set that nobody tunes the program to.")
    ] = False,
    only: Annotated[str, typer.Option(help="Ids, comma-separated: asset01,style05.")] = "",
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of scenes and results.")] = Path(
        "bench"
    ),
) -> None:
    """Change base scenes by sentences, measure each, and count what is right by class."""
    from cityx.bench.edits import run_edits, sentences, write_edits

    names = [word.strip() for word in only.split(",") if word.strip()]
    chosen = sentences(held=held, unseen=unseen, only=names)
    out.mkdir(parents=True, exist_ok=True)
    results = run_edits(chosen, out, lambda line: typer.echo(line, err=True))
    command = "cityx bench edits" + (" --unseen" if unseen else " --held" if held else "")
    command += f" --only {only}" if only else ""
    for line in write_edits(results, command, out):
        typer.echo(line)
