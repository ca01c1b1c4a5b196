"""Commands that make a city or measure it: build, explain, fetch, check."""
# Annotations stay values here: `with_flags` and typer read them at every start.

from pathlib import Path
from typing import Annotated, Any

import typer

from cityx.cli.flags import with_flags
from cityx.cli.terminal import (
    CHECK_FAILED,
    ENGINE_FAILED,
    Progress,
    echo_some,
    please_report,
)
from cityx.options import BuildOptions


@with_flags
def build(
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the results.")],
    inputs: Annotated[
        list[str] | None,
        typer.Argument(
            help='Maps, drawings, images and heights of one place, and "TEXT"; none for a town.'
        ),
    ] = None,
    *,
    options: BuildOptions,
) -> None:
    """Build a city from words, a map, a drawing, an image, from several, or from nothing."""
    from dataclasses import replace

    from cityx.system.allocator import keep_freed_memory, rare_collection

    keep_freed_memory()
    with rare_collection():  # modules that are imported are no garbage either
        from cityx.agents.briefs import IN_PART
        from cityx.projects.build import build as build_city
        from cityx.projects.inputs import files_and_text
        from cityx.system.stopwatch import Stopwatch

        watch = Stopwatch.of_process("start")
        paths, text = files_and_text(inputs or [])
        with Progress() as say:
            report = build_city(paths, out, replace(options, text=text), say=say, watch=watch)
    summary(report, out, in_part=report["brief"].get("reply") == IN_PART)


def explain(
    words: Annotated[list[str], typer.Argument(help='"TEXT", and files if there are any.')],
    as_json: Annotated[bool, typer.Option("--json", help="Print it as JSON.")] = False,
) -> None:
    """Show how an instruction is understood and what would be done; nothing is run."""
    import json

    from cityx.agents.explain import explain as explain_text
    from cityx.agents.explain import explanation
    from cityx.projects.inputs import files_and_text

    paths, text = files_and_text(words)
    found = explain_text(text, paths)
    typer.echo(json.dumps(found, indent=2) if as_json else explanation(found))


def fetch(
    place: Annotated[str, typer.Argument(help="Name, or WEST,SOUTH,EAST,NORTH in degrees.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to keep the map in.")],
) -> None:
    """Fetch the OpenStreetMap data of a place from the network into a file."""
    from cityx.sources.osm.retrieval import retrieve

    with Progress() as say:
        path = retrieve(place, out, say=say)
    typer.echo(str(path))


def check(folder: Annotated[Path, typer.Argument(help="Folder of a built city.")]) -> None:
    """Measure a built city again and renew its report."""
    from cityx.projects.build import recheck

    summary(recheck(folder), folder)


def _of_a_map(told: dict[str, Any]) -> str:
    """Say how much of what a map states is kept."""
    if "error" in told:
        return f"note: {told['map']} could not be held against the city: {told['error']}"
    counted = (("departed", "departed"), ("lost", "lost"), ("unexplained", "of these unexplained"),
               ("unreadable", "unreadable"))  # fmt: skip
    ends = {words: sum(row[name] for row in told["tags"].values()) for name, words in counted}
    others = ", ".join(f"{number} {words}" for words, number in ends.items() if number)
    share = f"{100 * told['share']:.1f} % of {told['stated']} stated facts kept"
    return f"{told['map']}: {share}{f', {others}' if others else ''}"


def summary(report: dict[str, Any], out: Path, *, in_part: bool = False) -> None:
    """Print counts and failed checks; end with an exit code other than 0 if not all is done.

    Parameters
    ----------
    in_part
        Whether a part of what was asked was left out, as notes of the report name.
    """
    from cityx.checks.report import report_passed
    from cityx.projects.results import FAULTS

    counts, triangles = report["counts"], report["triangles"]
    typer.echo(
        f"{report['name']}: {counts['buildings']} buildings, {counts['road_km']:.1f} km of ways, "
        f"{counts['trees']} trees, {counts['instances']} instances, "
        f"{triangles['instanced']} triangles ({triangles['unique']} unique), "
        f"{report['area_km2']:.2f} km2"
    )
    for text in report["attribution"]:
        typer.echo(text)
    for told in report.get("fidelity", ()):
        typer.echo(_of_a_map(told))
    failed = {name: item for name, item in report["checks"].items() if not item["ok"]}
    echo_some([f"check failed: {name} = {item['value']}, {item['bound']} {item['limit']}"
               for name, item in failed.items()])  # fmt: skip
    missed = [goal for goal in report["goals"] if goal["met"] is False and goal.get("hard", True)]
    echo_some([f"missed: {goal['goal']} ({goal['evidence']})" for goal in missed])
    # Doubts of images and heights are among the first.
    echo_some([f"note: {note}" for note in report["notes"]])
    if report["failures"]:
        typer.echo(f"{len(report['failures'])} objects needed a fallback; ids in report.json")
    typer.echo(f"hash {report['hash']}")
    typer.echo(f"{out / 'report.html'}")
    for fault in report.get("faults", ()):
        typer.echo(f"error: CityX itself failed in a step that was left out: {fault}.", err=True)
    if report.get("faults"):
        typer.echo(f"All else is saved. {please_report(out / FAULTS)}", err=True)
        raise typer.Exit(ENGINE_FAILED)
    if in_part:
        typer.echo("Done in part: the notes name what was not understood or is left open.")
    if in_part or not report_passed(report):
        raise typer.Exit(CHECK_FAILED)
