"""The command `cityx dataset`; heavy modules are imported when it runs."""

from __future__ import annotations

import shlex
import sys
from math import radians
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cityx.cli.comma_lists import words_of
from cityx.errors import UsageError

if TYPE_CHECKING:
    from cityx.dataset.making import Summary

FAILED = 1
QUIET_S = 10.0  # between lines of progress where no terminal shows a bar


def dataset(
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the dataset.")],
    folders: Annotated[
        list[Path] | None, typer.Argument(metavar="[DIR]...", help="Folders of built cities.")
    ] = None,
    cities: Annotated[
        str,
        typer.Option(help="Seeds of towns, 1-20,35; a list in a file; folders and maps: A,B.osm."),
    ] = "",
    views: Annotated[
        int | None, typer.Option(min=1, help="Shots of each city; 100, or all of a file.")
    ] = None,
    plan: Annotated[
        str, typer.Option(help="street, drive, aerial, orbit, walk or FILE.json.")
    ] = "street",
    rig: Annotated[str, typer.Option(help="mono, stereo, surround or FILE.json.")] = "mono",
    size: Annotated[str | None, typer.Option(help="Size in pixels, WxH.")] = None,
    channels: Annotated[
        str, typer.Option(help="Comma-separated names, or truth, paper, all; none for no pictures.")
    ] = "rgb,depth,normal,semantic,instance",
    formats: Annotated[
        str,
        typer.Option("--format", help="raw, coco, kitti, nuscenes, nerf, colmap, webdataset."),
    ] = "raw",
    quality: Annotated[str, typer.Option(help="draft, standard or paper.")] = "standard",
    samples: Annotated[
        int | None, typer.Option(min=1, max=65536, help="Samples per pixel, at most.")
    ] = None,
    lidar: Annotated[str, typer.Option(help="Pattern of a LiDAR on the rig.")] = "",
    boxes: Annotated[bool, typer.Option("--boxes", help="Keep 2D and 3D boxes.")] = False,
    weather: Annotated[str, typer.Option(help="Words that vary by sequence: clear,rain.")] = "",
    time: Annotated[str, typer.Option(help="Times that vary by sequence: 08:00,dusk.")] = "",
    length: Annotated[int | None, typer.Option(min=1, help="Frames of a sequence.")] = None,
    rate: Annotated[float, typer.Option(help="Frames a second of sequences.")] = 10.0,
    fov: Annotated[
        float | None, typer.Option(min=1, max=175, help="Horizontal field of view, degrees.")
    ] = None,
    target: Annotated[
        str, typer.Option(help="What orbits go round: tallest, middle, a name or an id.")
    ] = "tallest",
    seed: Annotated[int, typer.Option(min=0, max=2**63 - 1, help="Key of the plan.")] = 0,
    town: Annotated[str, typer.Option(help="Words for towns of --cities SEEDS.")] = "",
    town_size: Annotated[str, typer.Option(help="WxH of these towns, metres.")] = "400x400",
    lod: Annotated[int, typer.Option(min=0, max=3, help="Level of detail of built ones.")] = 2,
    workers: Annotated[int, typer.Option(min=1, max=256, help="Worker processes.")] = 1,
    cluster: Annotated[
        str, typer.Option(help="Workers of dask instead: address of a scheduler, or local:N.")
    ] = "",
    disk_budget: Annotated[float | None, typer.Option(help="GB that the dataset may take.")] = None,
    skip_failed: Annotated[
        bool, typer.Option("--skip-failed", help="Finish without shots that cannot be taken.")
    ] = False,
) -> None:
    """Take pictures of cities with ground truth for every pixel; a killed run goes on."""
    from cityx.dataset.making import Running, make_dataset
    from cityx.dataset.order import Faults, Order, sources_of
    from cityx.dataset.pictures import QUALITIES

    faults = Faults()
    sources = sources_of(folders or [], cities, faults)
    given = faults.of(lambda: _pair(size, "--size", "1920x1080", 16, 16384)) if size else None
    metres = faults.of(lambda: _pair(town_size, "--town-size", "400x400", 50, 20000))
    if disk_budget is not None and disk_budget <= 0:
        faults.say(f"--disk-budget {disk_budget:g} is no room for a dataset.")
    usual = QUALITIES[quality if quality in QUALITIES else "standard"].size
    width, height = (round(value) for value in given or usual)
    order = Order(
        views=views if views is not None or Path(plan).is_file() else 100,
        plan=plan, rig=rig, size=(width, height), channels=_words(channels),
        formats=_words(formats), quality=quality, samples=samples, lidar=lidar, boxes=boxes,
        weather=_words(weather), time=_words(time), seed=seed, length=length, rate=rate,
        hfov=None if fov is None else radians(fov), target=target, town=town,
        town_size=metres or (400.0, 400.0), lod=lod,
    )  # fmt: skip
    running = Running(
        workers, cluster, None if disk_budget is None else int(disk_budget * 1e9),
        skip_failed=skip_failed, command=shlex.join(["cityx", *sys.argv[1:]]), faults=faults,
    )  # fmt: skip
    with _Progress() as progress:
        summary = make_dataset(order, sources, out, running, progress)
    _told(summary, out)


def _words(text: str) -> tuple[str, ...]:
    return tuple(word for word in words_of(text) if word != "none")


def _pair(text: str, option: str, example: str, low: int, high: int) -> tuple[float, float]:
    first, _, second = text.lower().partition("x")
    if not (first.isdecimal() and second.isdecimal()):
        raise UsageError(f'{option} "{text}" is not of the form {example}.')
    if not all(low <= int(word) <= high for word in (first, second)):
        raise UsageError(f'{option} "{text}" is outside {low}x{low} to {high}x{high}.')
    return float(first), float(second)


class _Progress:
    """A bar with rate and time left on a terminal, a line now and then elsewhere."""

    def __enter__(self) -> _Progress:
        from time import monotonic

        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

        self._clock = monotonic
        self._console = Console(stderr=True)
        self._bar: Any = None
        self._last = monotonic()
        if self._console.is_terminal:
            columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
                       TextColumn("{task.fields[pace]}"))  # fmt: skip
            self._bar = Progress(*columns, console=self._console)
            self._task = self._bar.add_task("starting", total=None, pace="")
            self._bar.start()
        return self

    def say(self, line: str) -> None:
        if self._bar is not None:
            self._bar.update(self._task, description=line)
        else:
            self._console.print(line, markup=False, highlight=False)

    def shots(self, done: int, total: int, rate: float) -> None:
        pace = f"{rate:.2g} a second, {_time((total - done) / rate)} left" if rate else ""
        if self._bar is not None:
            self._bar.update(self._task, description="shots", completed=done, total=total,
                             pace=pace)  # fmt: skip
        elif done == total or self._clock() - self._last >= QUIET_S:
            self._last = self._clock()
            self.say(f"{done} of {total} shots, {pace}")

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:  # fmt: skip
        if self._bar is not None:
            self._bar.stop()


def _time(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s"


def _told(summary: Summary, out: Path) -> None:
    """Print what came of it; end with exit code 1 if a shot or a file is not as it should be."""
    if summary.made:
        pace = summary.made / max(summary.seconds, 1e-9)
        spent = ", ".join(f"{what} {value:.1f} s" for what, value in summary.spent.items())
        typer.echo(f"{summary.made} shots in {_time(summary.seconds)}, {pace:.2f} a second "
                   f"({spent} of the workers)")  # fmt: skip
    typer.echo(f"{summary.total} shots in all, {summary.size / 1e6:.1f} MB")
    for name, cause in list(summary.failed.items())[:10]:
        typer.echo(f"failed: {name}: {cause}")
    if summary.failed:
        typer.echo(f"{len(summary.failed)} shots failed; the same command tries them again, "
                   "--skip-failed finishes without them")  # fmt: skip
    for fault in summary.faults[:10]:
        typer.echo(f"fault: {fault}")
    if summary.faults:
        typer.echo(f"{len(summary.faults)} files are not as they were written; make the dataset "
                   "anew in another folder")  # fmt: skip
    elif (out / "index.html").is_file():
        typer.echo(str(out / "index.html"))
    if summary.failed or summary.faults:
        raise typer.Exit(FAILED)
