"""The command line. Heavy modules are imported by the commands that need them."""

from __future__ import annotations

import os
import sys
import traceback
from math import isfinite
from pathlib import Path
from tempfile import gettempdir
from typing import Annotated, Any

import typer

from cityx import __version__
from cityx.cli.assets import assets
from cityx.cli.comma_lists import words_of
from cityx.cli.dataset import dataset
from cityx.errors import ActionFailed, CityxError, UsageError
from cityx.system.allocator import rare_collection
from cityx.system.extensions import points_of

# Two threaded libraries on few cores spin against each other unless they sleep while they wait.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

CHECK_FAILED = 1
ENGINE_FAILED = 3
NOTES = 6  # shown after a build; doubts of images and heights are among the first

app = typer.Typer(
    name="cityx",
    help="Maps, images, heights and drawings become explicit, editable 3D cities.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
plugins = typer.Typer(help="List, show, check and make plugins.", no_args_is_help=True)
app.add_typer(plugins, name="plugins")
app.add_typer(assets, name="assets")
for _package, _point in points_of("cityx.commands"):  # commands of other packages
    try:
        app.add_typer(_point.load(), name=_point.name)
    except Exception as error:  # noqa: BLE001  a package may raise anything when imported
        _why = f"{type(error).__name__}: {error}"
        typer.echo(f"Command {_point.name} of package {_package} is left out: {_why}", err=True)
app.command()(dataset)


# Who plays the roles of the agents.
Planner = Annotated[
    str, typer.Option(help="offline, or openai:MODEL, anthropic:MODEL, ollama:MODEL, ...")
]
BaseUrl = Annotated[
    str, typer.Option("--base-url", help="Server of the model, for openai-chat:MODEL.")
]
Record = Annotated[str, typer.Option(help="File to add the model's decisions to.")]
Replay = Annotated[str, typer.Option(help="File of decisions to play, asking nobody.")]
BudgetTokens = Annotated[
    int, typer.Option("--budget-tokens", min=0, help="Tokens that models may use.")
]


def _version(value: bool) -> None:
    if value:
        typer.echo(f"cityx {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    del version


def _numbers(
    text: str | None, separator: str, option: str, example: str
) -> Any:  # a tuple as long as the example, or None
    """Read as many numbers as an example has: "AxB", "A,B" or "A,B,C,D"."""
    if text is None:
        return None
    words = text.lower().split(separator)
    try:
        numbers = tuple(float(word) for word in words)
        if len(numbers) != len(example.split(separator)) or not all(map(isfinite, numbers)):
            raise ValueError(text)
    except ValueError:
        raise UsageError(f'{option} "{text}" is not of the form {example}.') from None
    return numbers


def _files_and_text(words: list[str]) -> tuple[list[Path], str]:
    """Tell the files from the instruction: what has a blank and is no file is in words."""
    paths, texts = [], []
    for word in words:
        path = Path(word)
        try:
            is_file = path.exists()
        except OSError:  # a text may be longer than any name
            is_file = False
        if is_file or (not any(map(str.isspace, word)) and (path.suffix or len(path.parts) > 1)):
            paths.append(path)
        else:
            texts.append(word)
    return paths, " ".join(texts)


def _pixels(text: str) -> tuple[int, int]:
    pair = _numbers(text, "x", "Picture size", "960x540") or (0, 0)
    width, height = int(pair[0]), int(pair[1])
    if not (16 <= width <= 16384 and 16 <= height <= 16384):
        raise UsageError(f'Picture size "{text}" is outside 16x16 to 16384x16384.')
    return width, height


@app.command()
def build(
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the results.")],
    inputs: Annotated[
        list[str] | None,
        typer.Argument(
            help='Maps, drawings, images and heights of one place, and "TEXT"; none for a town.'
        ),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, max=2**63 - 1, help="Key of all draws.")] = 0,
    workers: Annotated[int, typer.Option(min=1, max=64, help="Worker processes.")] = 1,
    lod: Annotated[int, typer.Option(min=0, max=3, help="Level of detail.")] = 2,
    style: Annotated[str, typer.Option(help="Style of buildings, e.g. european, brick.")] = "",
    time: Annotated[
        str | None,
        typer.Option(help="HH:MM, dusk, 2026-12-21 16:00, ...; midsummer without a date."),
    ] = None,
    weather: Annotated[str | None, typer.Option(help="clear, fog, rain, storm dusk, ...")] = None,
    size: Annotated[str | None, typer.Option(help="WxH of a window to cut out, metres.")] = None,
    at: Annotated[str | None, typer.Option(help="LAT,LON of the window's centre.")] = None,
    window: Annotated[
        str | None, typer.Option(help="X,Y,W,H of the plane of towns, metres, without a map.")
    ] = None,
    formats: Annotated[
        str, typer.Option(help="Comma-separated: blend, glb, usd, bodies, sumo, mjcf, of plugins.")
    ] = "blend,glb",
    render: Annotated[bool, typer.Option("--render/--no-render", help="Make pictures.")] = True,
    samples: Annotated[int, typer.Option(min=1, max=65536, help="Samples per pixel.")] = 48,
    picture: Annotated[str, typer.Option(help="Size of the pictures, pixels.")] = "960x540",
    kinds: Annotated[
        list[str] | None, typer.Option("--as", help="NAME=KIND: osm, semantic, satellite, ...")
    ] = None,
    legend: Annotated[str, typer.Option(help="Classes of a semantic map: preset or file.")] = "",
    confirm_legend: Annotated[
        bool, typer.Option("--confirm-legend", help="Take the classes proposed.")
    ] = False,
    pixel: Annotated[float | None, typer.Option(help="Metres of an image's pixel.")] = None,
    fidelity: Annotated[str, typer.Option(help="Of images: exact, plausible.")] = "exact",
    segmenter: Annotated[
        str, typer.Option(help='Of aerial images: ONNX file, or "none" for colours alone.')
    ] = "",
    height_range: Annotated[
        str | None, typer.Option(help="LOW,HIGH: metres of heights in other numbers.")
    ] = None,
    height_crs: Annotated[str, typer.Option(help="Coordinate system of heights: EPSG:3067.")] = "",
    place: Annotated[
        str, typer.Option(help="Place whose map is fetched: a name, or WEST,SOUTH,EAST,NORTH.")
    ] = "",
    planner: Planner = "offline",
    base_url: BaseUrl = "",
    record: Record = "",
    replay: Replay = "",
    budget_tokens: BudgetTokens = 400_000,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", help="[ACTION.]NAME=VALUE of an action of the build; may repeat."),
    ] = None,
    wishes: Annotated[
        list[str] | None,
        typer.Option("--do", help='"ACTION NAME=VALUE ...", an action to add; may repeat.'),
    ] = None,
) -> None:
    """Build a city from words, a map, a drawing, an image, from several, or from nothing."""
    from cityx.language.options import BuildOptions, PlannerChoice
    from cityx.projects.build import build as build_city
    from cityx.sources.intake import HowToRead
    from cityx.system.allocator import keep_freed_memory

    keep_freed_memory()
    paths, text = _files_and_text(inputs or [])
    options = BuildOptions(
        text=text,
        seed=seed,
        workers=workers,
        lod=lod,
        style=style,
        time=time,
        weather=weather,
        size=_numbers(size, "x", "--size", "800x600"),
        at=_numbers(at, ",", "--at", "60.17,24.94"),
        window=_numbers(window, ",", "--window", "-300,-300,600,600"),
        formats=words_of(formats),
        render=render,
        samples=samples,
        picture=_pixels(picture),
        place=place,
        choice=PlannerChoice(planner, base_url, record, replay, budget_tokens),
        read=HowToRead(
            kinds=tuple(kinds or ()),
            legend=legend,
            confirm_legend=confirm_legend,
            pixel=pixel,
            fidelity=fidelity,
            segmenter=segmenter,
            height_range=_numbers(height_range, ",", "--height-range", "0,120"),
            height_crs=height_crs,
        ),
        settings=tuple(settings or ()),
        wishes=tuple(wishes or ()),
    )
    with _progress() as say:
        report = build_city(paths, out, options, say=say)
    _summary(report, out)


@app.command()
def edit(
    folder: Annotated[Path, typer.Argument(help="Folder of a built city.")],
    text: Annotated[str, typer.Argument(help="What is to change, in words.")],
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="Texts with more wishes, .blend files with curves to go along."),
    ] = None,
    planner: Planner = "offline",
    base_url: BaseUrl = "",
    record: Record = "",
    replay: Replay = "",
    budget_tokens: BudgetTokens = 400_000,
) -> None:
    """Change a built city as a sentence says, whole or not at all."""
    with rare_collection():  # while libraries are imported
        from cityx.language.options import PlannerChoice
        from cityx.projects.edit import edit_city

    choice = PlannerChoice(planner, base_url, record, replay, budget_tokens)
    try:
        with _progress() as say:
            report = edit_city(folder, text, files=files or (), say=say, choice=choice)
    except ActionFailed as error:
        if isinstance(error.__cause__, ActionFailed):  # it said why, and broke nothing
            raise UsageError(f"{error.__cause__} Nothing was changed.") from error
        raise
    for note in report["notes_of_change"]:
        typer.echo(f"note: {note}")
    _changed(report)


@app.command()
def undo(
    folder: Annotated[Path, typer.Argument(help="Folder of a built city.")],
    to: Annotated[int | None, typer.Option(min=1, help="A revision; see --list.")] = None,
    show: Annotated[bool, typer.Option("--list", help="Show the revisions, change none.")] = False,
) -> None:
    """Go back to the city before the last change, or to any revision it had."""
    from cityx.projects.desk import Desk
    from cityx.projects.edit import undo as undo_change

    if show:
        with Desk(folder) as desk:
            for item in desk.revisions():
                what = item.text or ", ".join(item.actions[:3])
                typer.echo(f"{item.number:4d}  {item.content[:12]}  {what}")
        return
    with _progress() as say:
        report = undo_change(folder, to, say=say)
    _changed(report)


@app.command()
def pull(
    folder: Annotated[Path, typer.Argument(help="Folder of a built city.")],
    blend: Annotated[
        Path | None, typer.Option(help="The file that was changed; city.blend of the folder.")
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Show, change nothing.")] = False,
    removals: Annotated[
        bool, typer.Option("--removals", help="More than a fifth of a layer may go.")
    ] = False,
) -> None:
    """Take what an artist moved, deleted, copied or recoloured in Blender into the city."""
    from cityx.projects.pull import pull as pull_changes

    with _progress() as say:
        found, report = pull_changes(
            folder, blend=blend, dry_run=dry_run, removals=removals, say=say
        )
    for line in found.lines():
        typer.echo(line)
    if report is not None:
        _changed(report)
    elif found.empty:
        typer.echo("nothing changed")


def _changed(report: dict) -> None:  # type: ignore[type-arg]
    """Print what a change came to; end with exit code 1 if a goal is missed."""
    typer.echo(f"revision {report['revision']}, hash {report['hash']}")
    missed = [goal for goal in report["goals_of_change"] if goal["met"] is False]
    for goal in missed:
        typer.echo(f"missed: {goal['goal']} ({goal['evidence']})")
    if missed:
        raise typer.Exit(CHECK_FAILED)


@app.command()
def explain(
    words: Annotated[list[str], typer.Argument(help='"TEXT", and files if there are any.')],
    as_json: Annotated[bool, typer.Option("--json", help="Print it as JSON.")] = False,
) -> None:
    """Show how an instruction is understood and what would be done; nothing is run."""
    import json

    from cityx.agents.explain import explain as explain_text
    from cityx.agents.explain import explanation

    paths, text = _files_and_text(words)
    found = explain_text(text, paths)
    typer.echo(json.dumps(found, indent=2) if as_json else explanation(found))


@app.command()
def fetch(
    place: Annotated[str, typer.Argument(help="Name, or WEST,SOUTH,EAST,NORTH in degrees.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to keep the map in.")],
) -> None:
    """Fetch the OpenStreetMap data of a place from the network into a file."""
    from cityx.sources.osm.retrieval import retrieve

    with _progress() as say:
        path = retrieve(place, out, say=say)
    typer.echo(str(path))


def _moment(word: str | None) -> float | str | None:
    try:
        return None if word is None else float(word)
    except ValueError:
        return word  # refused where it means nothing


@app.command()
def render(
    folder: Annotated[Path, typer.Argument(help="Folder of a built city.")],
    camera: Annotated[str, typer.Option(help="street, aerial, top or FILE.json.")] = "street",
    samples: Annotated[int | None, typer.Option(min=1, help="Samples per pixel.")] = None,
    size: Annotated[str | None, typer.Option(help="Size in pixels, WxH.")] = None,
    time: Annotated[str | None, typer.Option(help="As of build; the city stays as it is.")] = None,
    weather: Annotated[str | None, typer.Option(help="As of build, or two: storm dusk.")] = None,
    moment: Annotated[
        str | None, typer.Option(help='Seconds into what moves, or "busiest" of each picture.')
    ] = None,
    frames: Annotated[
        str | None, typer.Option(help="A picture per frame, FROM:TO[:STEP], 25 a second.")
    ] = None,
    exact: Annotated[
        bool, typer.Option("--exact", help="Show nothing beyond the site that no file holds.")
    ] = False,
) -> None:
    """Render pictures of a built city, under another weather or at another time if asked for."""
    from cityx.projects.views import render_views

    with _progress() as say:
        paths = render_views(
            folder,
            camera,
            samples=samples,
            size=_pixels(size) if size else None,
            time=time or "",
            weather=weather or "",
            moment=_moment(moment),
            frames=frames or "",
            exact=exact,
            say=say,
        )
    for path in paths:
        typer.echo(str(path))


@app.command()
def check(folder: Annotated[Path, typer.Argument(help="Folder of a built city.")]) -> None:
    """Measure a built city again and renew its report."""
    from cityx.projects.build import recheck

    _summary(recheck(folder), folder)


@app.command()
def serve(
    folder: Annotated[Path, typer.Argument(help="Folder of a city, or of one to be built.")],
    http: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Port of HTTP on this machine; 0 for any.")
    ] = None,
    profile: Annotated[str, typer.Option(help="core, or full: a tool for every action.")] = "core",
    planner: Planner = "offline",
    base_url: BaseUrl = "",
    record: Record = "",
    replay: Replay = "",
    budget_tokens: BudgetTokens = 400_000,
) -> None:
    """Let language models and other programs use a city, by the Model Context Protocol."""
    from cityx.language.options import PlannerChoice
    from cityx.server.serve import serve as serve_city

    choice = PlannerChoice(planner, base_url, record, replay, budget_tokens)
    serve_city(
        folder,
        port=http,
        profile=profile,
        say=lambda line: typer.echo(line, err=True),
        choice=choice,
    )


@plugins.command("list")
def plugins_list() -> None:
    """List every action by stage."""
    from cityx.cli import plugins as commands

    _show(commands.list_actions())


@plugins.command("show")
def plugins_show(name: Annotated[str, typer.Argument(help="Id or name of an action.")]) -> None:
    """Show the record of one action as JSON."""
    from cityx.cli import plugins as commands

    _show(commands.show_action(name))


@plugins.command("check")
def plugins_check(
    name: Annotated[
        str | None, typer.Argument(help="One action, or a plugin's folder; all when left out.")
    ] = None,
) -> None:
    """Run the conformance suite."""
    from cityx.cli import plugins as commands

    text, passed = commands.check_actions(name)
    _show(text)
    if not passed:
        raise typer.Exit(CHECK_FAILED)


@plugins.command("new")
def plugins_new(
    name: Annotated[str, typer.Argument(help='Id such as "building/bell_tower-v1".')],
    folder: Annotated[Path, typer.Option("-o", "--out", help="Where to write it.")] = Path(),
    install: Annotated[bool, typer.Option("--install", help="Install it for this Python.")] = False,
) -> None:
    """Write a scaffold of a plugin that works."""
    from cityx.cli import plugins as commands

    for path in commands.new_action(name, folder, installed=install):
        typer.echo(str(path))
    ready = f'cityx build -o town --do "{name}"' if install else f"pip install {folder}"
    typer.echo(f"next: {ready}")


@plugins.command("formats")
def plugins_formats() -> None:
    """Show the share of each format over all ports, beside the paper's."""
    from cityx.cli import plugins as commands

    _show(commands.format_statistics())


def _show(renderable: object) -> None:
    from rich.console import Console

    Console(soft_wrap=isinstance(renderable, str)).print(renderable, markup=False)


class _progress:  # noqa: N801  used like a function
    """A spinner with the current step on a terminal; plain lines elsewhere."""

    def __enter__(self) -> _progress:
        from rich.console import Console

        self._console = Console(stderr=True)
        self._status = self._console.status("starting") if self._console.is_terminal else None
        if self._status:
            self._status.start()
        return self

    def __call__(self, line: str) -> None:
        if self._status:
            self._status.update(line)
        else:
            self._console.print(line, markup=False, highlight=False)

    def __exit__(self, *_: object) -> None:
        if self._status:
            self._status.stop()


def _summary(report: dict, out: Path) -> None:  # type: ignore[type-arg]
    """Print counts and failed checks; end with exit code 1 if a check failed."""
    from cityx.checks.report import report_passed

    counts, triangles = report["counts"], report["triangles"]
    typer.echo(
        f"{report['name']}: {counts['buildings']} buildings, {counts['road_km']:.1f} km of ways, "
        f"{counts['trees']} trees, {counts['instances']} instances, "
        f"{triangles['instanced']} triangles ({triangles['unique']} unique), "
        f"{report['area_km2']:.2f} km2"
    )
    for text in report["attribution"]:
        typer.echo(text)
    for name, item in report["checks"].items():
        if not item["ok"]:
            typer.echo(f"check failed: {name} = {item['value']}, {item['bound']} {item['limit']}")
    for note in report["notes"][:NOTES]:
        typer.echo(f"note: {note}")
    if len(report["notes"]) > NOTES:
        typer.echo(f"{len(report['notes']) - NOTES} more notes in report.json")
    if report["failures"]:
        typer.echo(f"{len(report['failures'])} objects needed a fallback; ids in report.json")
    typer.echo(f"hash {report['hash']}")
    typer.echo(f"{out / 'report.html'}")
    if not report_passed(report):
        raise typer.Exit(CHECK_FAILED)


def main() -> None:
    """Run the command line and end with the documented exit codes."""
    try:
        app()
    except CityxError as error:
        typer.echo(f"error: {error}", err=True)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        typer.echo("interrupted", err=True)
        sys.exit(130)
    except Exception as error:  # noqa: BLE001  the last door before a user
        log = Path(gettempdir()) / f"cityx-{os.getpid()}.log"
        log.write_text(traceback.format_exc())
        typer.echo(f"error: CityX itself failed ({type(error).__name__}: {error}).", err=True)
        typer.echo(f"The trace is in {log}; please report it with the input.", err=True)
        sys.exit(ENGINE_FAILED)
