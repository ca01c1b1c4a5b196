"""The commands of `cityx bench`; heavy modules are imported by the commands that need them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cityx.errors import UsageError
from cityx.options import words_of
from cityx_bench.survey.commands import survey

if TYPE_CHECKING:
    from cityx_bench.scoring import Sample

bench = typer.Typer(help="Measure how often what is asked for comes about.", no_args_is_help=True)
bench.add_typer(survey, name="survey")


@bench.callback()
def _root() -> None:
    """Keep the names of commands, even while there is but one."""


def _say(line: str) -> None:
    """Print progress, apart from the results."""
    typer.echo(line, err=True)


def _tell(samples: Sequence[Sample], command: str, out: Path, title: str) -> None:
    """Write the results of samples and print what a reader wants first."""
    from cityx_bench.report import summary, write_results

    for line in summary(write_results(samples, command, out, title=title)):
        typer.echo(line)
    typer.echo(str(out / "results.md"))


@bench.command()
def agents(
    driver: Annotated[
        str, typer.Option(help="offline, null, random, oracle, llm:SPEC, replay:FILE, export:FILE.")
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
    arm: Annotated[
        str,
        typer.Option(help="Parts of the records that the offline planner reads: D,I,L, -, or all."),
    ] = "",
) -> None:
    """Let a driver solve tasks in words, measure each, and write rates with their counts."""
    from cityx.agents.ablation import ARMS, arm_of
    from cityx_bench.arms import driver_of, write_ablation
    from cityx_bench.drivers import EXPORT
    from cityx_bench.runner import Bench, export_prompts, numbers_of, run_bench
    from cityx_bench.tasks import PUBLIC, read_tasks

    if arm and driver != "offline":
        raise UsageError("--arm is of the offline driver alone.")
    arms = ARMS if arm == "all" else (arm_of(arm),) if arm else ()
    names = words_of(only)
    chosen = read_tasks(tasks or PUBLIC, names)
    word, _, file = driver.partition(":")
    if word == EXPORT:
        waiting = export_prompts(
            Bench(chosen, driver, out, numbers_of(seeds, "--seeds"), lod), _say
        )
        again = "answer them and run this again" if waiting else f"now --driver replay:{file}"
        typer.echo(f"{waiting} prompts wait for answers in {file}; {again}")
        return
    found = {
        each: run_bench(
            Bench(chosen, driver_of(each) if arms else driver, out, numbers_of(seeds, "--seeds"),
                  lod, jobs),
            _say,
        )
        for each in arms or ARMS[:1]
    }  # fmt: skip
    samples = next(iter(found.values()))
    command = f"cityx bench agents --driver {driver} --seeds {seeds} --lod {lod}"
    command += f" --tasks {tasks}" if tasks else ""
    command += f" --only {only}" if only else ""
    command += f" --arm {arm}" if arm else ""
    if len(found) > 1:
        for line in write_ablation(found, command, out):
            typer.echo(line)
    _tell(samples, command, out, "Agents")


@bench.command()
def inputs(
    kinds: Annotated[
        str, typer.Option(help="osm, semantic, height, text; comma-separated, all when left out.")
    ] = "osm,semantic,height,text",
    count: Annotated[int, typer.Option(min=1, max=1000, help="Inputs of each kind.")] = 50,
    maps: Annotated[
        Path | None, typer.Option(help="Folder of real .osm files that are taken first.")
    ] = None,
    driver: Annotated[str, typer.Option(help="As of `cityx bench agents`.")] = "offline",
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of inputs and results.")] = Path(
        "bench-inputs"
    ),
    lod: Annotated[int, typer.Option(min=0, max=3, help="Level of detail.")] = 1,
    jobs: Annotated[int, typer.Option(min=1, max=64, help="Processes.")] = 1,
) -> None:
    """Build maps, semantic maps, height fields and words, and compare each city with its input."""
    from cityx_bench.battery import write_battery
    from cityx_bench.runner import Bench, run_bench

    chosen = words_of(kinds)
    battery = write_battery(out / "files", kinds=chosen, count=count, maps=maps)
    samples = run_bench(
        Bench(battery.tasks, driver, out, lod=lod, jobs=jobs, inputs=battery.inputs),
        _say,
    )
    command = f"cityx bench inputs --kinds {','.join(chosen)} --count {count} --lod {lod}"
    command += f" --driver {driver}" if driver != "offline" else ""
    command += " --maps FOLDER" if maps else ""
    _tell(samples, command, out, "Inputs")


@bench.command()
def quality(
    cities: Annotated[
        list[Path] | None, typer.Argument(help="Built cities; towns of ours when left out.")
    ] = None,
    maps: Annotated[
        Path | None, typer.Option(help="Folder of the maps that cities were built of.")
    ] = None,
    towns: Annotated[int, typer.Option(min=1, max=100, help="Towns that are built.")] = 10,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of results.")] = Path(
        "bench-quality"
    ),
) -> None:
    """Measure what makes a city right, on every city: a table and a plot."""
    from cityx_bench.quality import build_towns, quality_of, table_of, write_quality

    folders = cities or build_towns(out / "towns", towns, _say)
    files = () if maps is None else tuple(path for path in maps.iterdir() if path.is_file())
    rows = {folder.name: quality_of(folder, files) for folder in folders}
    command = f"cityx bench quality{' CITY...' if cities else f' --towns {towns}'}"
    write_quality(rows, command, out)
    typer.echo(table_of(rows))


@bench.command()
def speed(
    maps: Annotated[list[Path] | None, typer.Argument(help="Maps, or folders of maps.")] = None,
    lod: Annotated[str, typer.Option(help="Levels of detail, comma-separated.")] = "2",
    builds: Annotated[
        str, typer.Option(help="cold, warm caches, and warm with pictures; comma-separated.")
    ] = "cold,warm",
    repeat: Annotated[int, typer.Option(min=1, max=99, help="Builds of each; medians.")] = 1,
    longest: Annotated[float, typer.Option(help="Seconds after which one is given up.")] = 1800.0,
    workers: Annotated[int, typer.Option(min=0, max=64, help="Processes; 0: as usual.")] = 0,
    peers: Annotated[
        str,
        typer.Option(
            help="osmium, trimesh, osmnx, netconvert, blosm, osm2streets, installed; "
            "comma-separated."
        ),
    ] = "",
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the log.")] = Path(
        "bench-speed"
    ),
    write: Annotated[
        Path | None, typer.Option(help="Page that holds the table between its marks.")
    ] = None,
) -> None:
    """Build maps as a user does and print what phases take, beside what peers take.

    Two made maps are built besides: a village, and the same in 100 km2 of empty ground. What the
    log holds is not measured again.
    """
    from cityx_bench.peers import peers_named
    from cityx_bench.runner import numbers_of
    from cityx_bench.speed import (
        BUILDS,
        Wanted,
        made_maps,
        maps_in,
        measure_speed,
    )
    from cityx_bench.speed_tables import text_of, write_into

    found, absent = maps_in(maps or [])
    if any(path.is_dir() for path in maps or []):
        found = [*made_maps(out / "maps"), *found]
    words = words_of(builds)
    if not words or not set(words) <= set(BUILDS):
        raise UsageError(f'--builds "{builds}" is not of {", ".join(BUILDS)}.')
    others, skipped = peers_named(words_of(peers))
    named = " ".join(path.name for path in maps or [])
    command = f"cityx bench speed {named} --lod {lod} --builds {builds} --repeat {repeat}"
    command += f" --workers {workers}" if workers else ""
    command += f" --peers {peers}" if peers else ""
    wanted = Wanted(
        found, numbers_of(lod, "--lod"), words, repeat, longest, workers, others,
        {**absent, **skipped}, command,
    )  # fmt: skip
    record = measure_speed(wanted, out, _say)
    text = text_of(record)
    typer.echo(text)
    if write is not None:
        write_into(write, text)


@bench.command()
def guard(
    renew: Annotated[bool, typer.Option("--renew", help="Record what is measured now.")] = False,
) -> None:
    """Build three small cities and fail if one takes a fifth more than is recorded."""
    from cityx_bench.guard import CASES, LIMIT, grown, kept_ratios, renew_ratios

    if renew:
        renew_ratios(_say)
        return
    kept = kept_ratios()
    found = {name: grown(name, kept[name], _say) for name in CASES}
    slower = [f"{name}: {kind} x{factor:.2f}" for name, factors in found.items()
              for kind, factor in factors.items() if factor >= LIMIT]  # fmt: skip
    if slower:
        typer.echo(f"Slower than recorded: {', '.join(slower)}.")
        raise typer.Exit(1)


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
    from cityx_bench.edits import run_edits, sentences, write_edits

    names = words_of(only)
    chosen = sentences(held=held, unseen=unseen, only=names)
    out.mkdir(parents=True, exist_ok=True)
    results = run_edits(chosen, out, _say)
    command = "cityx bench edits" + (" --unseen" if unseen else " --held" if held else "")
    command += f" --only {only}" if only else ""
    for line in write_edits(results, command, out):
        typer.echo(line)


@bench.command()
def sim(
    places: Annotated[
        list[Path] | None,
        typer.Argument(metavar="PLACE", help="Built cities or maps; a town when left out."),
    ] = None,
    bars: Annotated[str, typer.Option(help="Numbers of bars, comma-separated; else all.")] = "",
    maps: Annotated[
        list[Path] | None,
        typer.Option(help="Map, or folder of maps, that is stepped by chance; may come again."),
    ] = None,
    limit: Annotated[
        int, typer.Option(min=10, help="CPU seconds of each process that such a map takes.")
    ] = 90,
    learn: Annotated[
        float, typer.Option(min=0.0, help="CPU seconds that a policy learns for, three times.")
    ] = 0.0,
    quick: Annotated[bool, typer.Option("--quick", help="A tenth of the steps.")] = False,
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Folder of recordings that are driven again.")
    ] = Path("bench-sim"),
) -> None:
    """Measure the simulator against its fourteen bars: rates, arrivals, the same bytes, checkers.

    Rates are steps per second of one thread's processor time, in the first place.
    """
    from cityx_bench.runner import numbers_of
    from cityx_bench.sim_bars import Asked, measured
    from cityx_bench.sim_maps import maps_of
    from cityx_bench.sim_measures import MEASURES, placed

    only = numbers_of(bars, "--bars") if bars else ()
    if not set(only) <= set(MEASURES):
        raise UsageError(f'--bars "{bars}" has a number that is none of 1 to {len(MEASURES)}.')
    swept = maps_of(maps) if maps else ()
    asked = Asked(placed(places or []), quick, swept, limit, learn, out)
    measured(asked, MEASURES, typer.echo, only)


@bench.command()
def results(
    logs: Annotated[Path, typer.Option(help="Folder of the logs: inputs, agents, ...")] = Path(
        "bench"
    ),
    out: Annotated[Path, typer.Option("-o", "--out", help="The page.")] = Path("docs/results.md"),
) -> None:
    """Write the page of results from the logs of all benchmarks."""
    from cityx_bench.results import write_page

    write_page(logs, out)
    typer.echo(str(out))
