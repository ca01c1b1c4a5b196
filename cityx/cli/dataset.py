"""The command `cityx dataset`; heavy modules are imported when it runs."""
# Annotations stay values here: `with_flags` and typer read them at every start.

import shlex
import sys
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cityx.cli.flags import with_flags
from cityx.cli.terminal import echo_some
from cityx.dataset.order import SIZE, Faults, Order, sources_of

if TYPE_CHECKING:
    from cityx.dataset.making import Summary
    from cityx.dataset.order import Source

FAILED = 1
QUIET_S = 10.0  # between lines of progress where no terminal shows a bar


@with_flags
def dataset(
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the dataset.")],
    folders: Annotated[
        list[Path] | None, typer.Argument(metavar="[DIR]...", help="Folders of built cities.")
    ] = None,
    cities: Annotated[
        str,
        typer.Option(help="Seeds of towns, 1-20,35; a list in a file; folders and maps: A,B.osm."),
    ] = "",
    tiles: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Tiles: each is a city, loaded with those about it."),
    ] = None,
    at: Annotated[
        str, typer.Option(help="Middle of the tiles that are meant: LAT,LON or X,Y in metres.")
    ] = "",
    area: Annotated[str, typer.Option(help="Their size in metres, WxH; 1000x1000.")] = "",
    views: Annotated[
        int | None, typer.Option(min=1, help="Shots of each city; 100, or all of a file.")
    ] = None,
    size: Annotated[str | None, typer.Option(help="Size in pixels, WxH.")] = None,
    fov: Annotated[
        float | None, typer.Option(min=1, max=175, help="Horizontal field of view, degrees.")
    ] = None,
    *,
    order: Order,
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
    from cityx.dataset.making import Hands, Running, make_dataset

    faults, hands = Faults(), Hands()
    if tiles is not None:
        from cityx.tiles import stops

        hands = stops.HANDS
        if folders or cities:
            faults.say("--tiles names all cities of a dataset; leave out DIR and --cities.")
        sources = faults.of(lambda: _stops(tiles, at, area, order.plan)) or ()
    else:
        if at or area:
            faults.say("--at and --area say which tiles are meant; give --tiles.")
        sources = sources_of(folders or [], cities, faults)
    given = faults.of(lambda: SIZE.read(size, "--size")) if size else None
    if disk_budget is not None and disk_budget <= 0:
        faults.say(f"--disk-budget {disk_budget:g} is no room for a dataset.")
    running = Running(
        workers, cluster, None if disk_budget is None else int(disk_budget * 1e9),
        skip_failed=skip_failed, command=shlex.join(["cityx", *sys.argv[1:]]), faults=faults,
        hands=hands,
    )  # fmt: skip
    with _Progress() as progress:
        summary = make_dataset(order.completed(views, given, fov), sources, out, running, progress)
    _told(summary, out)


def _stops(tiles: Path, at: str, area: str, plan: str) -> "tuple[Source, ...]":
    """Return the tiles that are meant, as cities."""
    from cityx.cli.tiles import area_of
    from cityx.tiles.order import read_order
    from cityx.tiles.stops import stops_in

    box = area_of(read_order(tiles)[0], at, area) if at or area else None
    return stops_in(tiles, box, plan)


class _Progress:
    """A bar with rate and time left on a terminal, a line now and then elsewhere."""

    def __enter__(self) -> "_Progress":
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


def _told(summary: "Summary", out: Path) -> None:
    """Print what came of it; end with exit code 1 if a shot or a file is not as it should be."""
    if summary.made:
        pace = summary.made / max(summary.seconds, 1e-9)
        spent = ", ".join(f"{what} {value:.1f} s" for what, value in summary.spent.items())
        typer.echo(f"{summary.made} shots in {_time(summary.seconds)}, {pace:.2f} a second "
                   f"({spent} of the workers)")  # fmt: skip
    typer.echo(f"{summary.total} shots in all, {summary.size / 1e6:.1f} MB")
    echo_some([f"failed: {name}: {cause}" for name, cause in summary.failed.items()],
              "see the dataset's README.md", most=10)  # fmt: skip
    if summary.failed:
        typer.echo(f"{len(summary.failed)} shots failed; the same command tries them again, "
                   "--skip-failed finishes without them")  # fmt: skip
    echo_some([f"fault: {fault}" for fault in summary.faults], "of the files", most=10)
    if summary.faults:
        typer.echo(f"{len(summary.faults)} files are not as they were written; make the dataset "
                   "anew in another folder")  # fmt: skip
    elif (out / "index.html").is_file():
        typer.echo(str(out / "index.html"))
    if summary.failed or summary.faults:
        raise typer.Exit(FAILED)
