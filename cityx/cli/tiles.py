"""The commands of `cityx tiles`; heavy modules are imported by the commands that need them."""
# Annotations stay values here: typer reads them at every start.

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cityx.cli.changes import is_whole
from cityx.cli.flags import with_flags
from cityx.cli.terminal import CHECK_FAILED, Progress, echo_some
from cityx.errors import UsageError
from cityx.options import PlannerChoice

if TYPE_CHECKING:
    from cityx.tiles.grid import Box
    from cityx.tiles.order import Order
    from cityx.tiles.run import Summary

tiles = typer.Typer(
    help="Countries and endless towns tile by tile, each built alone.", no_args_is_help=True
)

Inputs = Annotated[
    list[Path] | None,
    typer.Argument(metavar="INPUT...", help="Map of the region, and heights of its ground."),
]
OfPlane = Annotated[bool, typer.Option("--plane", help="No map: towns and country without end.")]
Text = Annotated[str, typer.Option(help="Of the plane: what its towns are like, in words.")]
Style = Annotated[str, typer.Option(help="Of the plane: style of buildings, e.g. brick.")]
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Folder of tiles.")]
Seed = Annotated[int, typer.Option(help="Seed of all draws.")]
Lod = Annotated[int, typer.Option(min=0, max=3, help="Level of detail.")]
Side = Annotated[float, typer.Option(help="Side of a tile, m, a multiple of 500.")]
Margin = Annotated[
    float | None,
    typer.Option(
        help="What is built round a tile and thrown away, m: 200, with heights 400, plane 350."
    ),
]
Place = Annotated[str, typer.Option(help="Profile of the place; that of the country otherwise.")]
At = Annotated[str, typer.Option(help="Middle of the area to build: LAT,LON or X,Y in metres.")]
Area = Annotated[str, typer.Option(help="Its size in metres, WxH; 1000x1000 with --at.")]
Workers = Annotated[int, typer.Option(min=1, max=256, help="Worker processes.")]
ClusterOf = Annotated[
    str, typer.Option(help="Workers of dask instead: address of a scheduler, or local:N.")
]
Store = Annotated[bool, typer.Option("--store/--no-store", help="Write the city of each tile.")]
_SIZE = re.compile(r"(\d+(?:\.\d+)?)x(\d+(?:\.\d+)?)")
LAID_OUT = 16  # tiles of a plane that an estimate lays out


@tiles.command()
def plan(
    inputs: Inputs = None,
    plane: OfPlane = False,
    text: Text = "",
    style: Style = "",
    seed: Seed = 0,
    lod: Lod = 2,
    size: Side = 1000.0,
    margin: Margin = None,
    at: At = "",
    area: Area = "",
) -> None:
    """Estimate what tiles take, before anything is built."""
    from cityx.tiles.plane import spread_over, tiles_in
    from cityx.tiles.planning import estimate, plane_sizes, sizes_of, survey_of, times

    order, source = _order(inputs, plane, text, style, seed=seed, lod=lod, size=size, margin=margin)
    box = area_of(order, at, area)
    if source is None:
        every = tiles_in(order, box)
        some = spread_over(every, LAID_OUT)
        told = times(estimate(plane_sizes(order, some), order), len(every), order)
        typer.echo(f"plane: {len(some)} of {len(every):,} tiles laid out")
    else:
        told = estimate(sizes_of(survey_of(order, source), order, box), order)
        west, south, east, north = order.site
        typer.echo(f"{order.name}: {east - west:,.0f} x {north - south:,.0f} m")
    typer.echo(f"{told.tiles:,} tiles of {order.size:g} m, {told.km2:,.1f} km2, "
               f"{told.buildings:,} buildings")  # fmt: skip
    typer.echo(f"{_hours(told.cpu_s)} of one processor at level of detail {order.lod}")
    typer.echo(f"{told.memory_mb:,.0f} MB of memory for each worker")
    typer.echo(f"{told.disk_mb / 1e3:,.1f} GB on the disk")


@tiles.command()
def build(
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the tiles.")],
    inputs: Inputs = None,
    plane: OfPlane = False,
    text: Text = "",
    style: Style = "",
    seed: Seed = 0,
    lod: Lod = 2,
    size: Side = 1000.0,
    margin: Margin = None,
    at: At = "",
    area: Area = "",
    place_profile: Place = "",
    workers: Workers = 1,
    cluster: ClusterOf = "",
    store: Store = True,
) -> None:
    """Build tiles of a map or a plane; a killed run goes on, tiles that are there are left."""
    from cityx.dataset.workers import check_cluster
    from cityx.tiles.run import build_tiles, chosen, prepared

    order, source = _order(
        inputs, plane, text, style, seed=seed, lod=lod, size=size, margin=margin,
        place=place_profile,
    )  # fmt: skip
    box = area_of(order, at, area)
    if cluster:
        check_cluster(cluster)
    with Progress() as say:
        heights = [path for path in inputs or [] if path != source]
        known = prepared(order, source, out, say, heights=heights)
        wanted = chosen(known, order, box)
        summary = build_tiles(
            out, order, wanted, workers=workers, cluster=cluster, store=store, say=say
        )
    _told(summary, out)


@tiles.command()
def extend(
    folder: Folder,
    at: At = "",
    area: Area = "",
    workers: Workers = 1,
    cluster: ClusterOf = "",
    store: Store = True,
) -> None:
    """Build more tiles of a folder; of a map all of them without --at."""
    from cityx.tiles.order import read_order
    from cityx.tiles.run import build_tiles, chosen

    order, known = read_order(folder)
    wanted = chosen(known, order, area_of(order, at, area, extended=True))
    with Progress() as say:
        summary = build_tiles(
            folder, order, wanted, workers=workers, cluster=cluster, store=store, say=say
        )
    _told(summary, folder)


@tiles.command(context_settings={"ignore_unknown_options": True})
def get(
    folder: Folder,
    place: Annotated[str, typer.Argument(metavar="PLACE", help="LAT,LON or X,Y in metres.")],
    store: Store = True,
) -> None:
    """Print the folder of the tile at a place; it is built if it is missing."""
    from cityx.tiles.grid import tile_at
    from cityx.tiles.order import read_order
    from cityx.tiles.plane import tiles_in
    from cityx.tiles.run import TILES, build_tiles

    order, known = read_order(folder)
    x, y = _place(order, place, "PLACE")
    tile = tile_at(x, y, order.size)
    if order.plane is not None:
        tiles_in(order, (x, y, x, y))
    if order.plane is None and tile not in known:
        raise UsageError(f"{place} lies in tile {tile.name}, in which the map has nothing.")
    with Progress() as say:
        summary = build_tiles(folder, order, [tile], store=store, say=say)
    if summary.failed:
        _told(summary, folder)
    typer.echo(str(folder / TILES / tile.name))


@tiles.command()
@with_flags
def edit(
    folder: Folder,
    text: Annotated[str, typer.Argument(help="What is to change, in words; undo takes it back.")],
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="Texts with more wishes, .blend files with curves to go along."),
    ] = None,
    at: Annotated[
        str, typer.Option(help="Place in the tile that is meant: LAT,LON or X,Y in metres.")
    ] = "",
    workers: Workers = 1,
    cluster: ClusterOf = "",
    *,
    choice: PlannerChoice,
) -> None:
    """Change tiles as a sentence says; only those that it touches are built anew."""
    from cityx.dataset.workers import check_cluster
    from cityx.tiles.editing import edit_tiles
    from cityx.tiles.grid import tile_at
    from cityx.tiles.order import read_order

    order, _ = read_order(folder)
    if cluster:
        check_cluster(cluster)
    with Progress() as say:
        done = edit_tiles(
            folder, text, at=tile_at(*_place(order, at, "--at"), order.size) if at else None,
            files=files or (), choice=choice, workers=workers, cluster=cluster, say=say,
        )  # fmt: skip
    whole = True
    for tile, report in done.reports.items():
        notes = [f"{tile.name}: note: {note}" for note in report["notes_of_change"]]
        echo_some(notes)
        whole &= is_whole(report, f"{tile.name}: ")
    built = done.summary.built
    typer.echo(f"edit {done.number}: {built} tiles built anew"
               f"{_waiting(len(done.tiles) - built - len(done.summary.failed))}")  # fmt: skip
    if done.summary.failed:
        _told(done.summary, folder)
    if not whole:
        raise typer.Exit(CHECK_FAILED)


def _waiting(count: int) -> str:
    return f", {count} that are not built yet have it when they are" if count else ""


@tiles.command()
def join(
    folder: Folder,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the city.")],
    at: Annotated[str, typer.Option(help="Its middle: LAT,LON or X,Y in metres.")],
    area: Annotated[str, typer.Option(help="Its size in metres, WxH.")] = "1000x1000",
) -> None:
    """Write the tiles about a place as one city for cityx view, sim, dataset; builds what lacks."""
    from cityx.tiles.order import read_order
    from cityx.tiles.region import region_about, write_region

    order, _ = read_order(folder)
    region = region_about(folder, _place(order, at, "--at"), size_of(area))
    with Progress() as say:
        city = write_region(region, out, say)
    typer.echo(f"{len(region.tiles)} tiles, {len(city.layout.buildings):,} buildings")
    typer.echo(str(out))


@tiles.command()
def check(
    folder: Folder,
    sample: Annotated[int, typer.Option(min=0, help="Tiles that are built again, alone.")] = 3,
    seed: Annotated[int, typer.Option(help="Which those are.")] = 0,
    source: Annotated[
        Path | None, typer.Option("--map", help="The map, of which no building may be missing.")
    ] = None,
) -> None:
    """Check files, seams and ids of tiles, and build some of them again."""
    from cityx.tiles.check import checked

    with Progress() as say:
        found = checked(folder, sample=sample, seed=seed, source=source, say=say)
    for check_ in found:
        verdict = "ok" if check_.ok else "FAILED"
        typer.echo(f"{verdict:6}  {check_.name}: {check_.told}")
        echo_some([f"        {fault}" for fault in check_.faults], "more of the kind")
    if not all(check_.ok for check_ in found):
        raise typer.Exit(CHECK_FAILED)


def _order(
    inputs: list[Path] | None,
    plane: bool,
    text: str,
    style: str,
    *,
    margin: float | None,
    **asked: Any,
) -> "tuple[Order, Path | None]":
    """Return what all tiles have in common, and their map, None of the plane."""
    if margin is not None:
        asked["margin"] = margin
    if plane == bool(inputs):
        raise UsageError(
            "Tiles are made of one OpenStreetMap file, or with --plane of no map"
            f"; {'both' if plane else 'neither'} given."
        )
    if not plane and (text or style):
        raise UsageError("--text and --style say what a plane is like; a map says that itself.")
    if not plane:
        from cityx.tiles.planning import order_of

        return order_of(inputs or [], **asked)
    from cityx.tiles.plane import plane_order

    order = plane_order(text, style, **asked)
    echo_some([f"note: {left}, and is left out" for left in (order.plane or {})["left_out"]])
    return order, None


def _told(summary: "Summary", folder: Path) -> None:
    """Print what came of it; end with exit code 1 if a tile failed."""
    rest = f", {summary.kept} were there already" if summary.kept else ""
    typer.echo(f"{summary.built} tiles built{rest}; {summary.cpu_s:.0f} s of processors, "
               f"{summary.rss_mb:.0f} MB at most")  # fmt: skip
    echo_some([f"failed: {name}: {why}" for name, why in summary.failed.items()],
              f"see {folder / 'failed'}")  # fmt: skip
    if summary.failed:
        typer.echo(f"{len(summary.failed)} tiles failed; the same command tries them again")
        raise typer.Exit(CHECK_FAILED)
    typer.echo(str(folder / "tileset.json"))


def _place(order: "Order", text: str, option: str) -> tuple[float, float]:
    """Return a place of the frame in metres."""
    from cityx.tiles.region import place_of

    return place_of(order, text, option)


def area_of(order: "Order", at: str, area: str, *, extended: bool = False) -> "Box | None":
    """Return the area to build in metres of the frame, None for all.

    A plane is begun about its origin.
    """
    if not at and not area and (order.plane is None or extended):
        return None
    size = size_of(area or "1000x1000")
    west, south, east, north = order.site
    x, y = _place(order, at, "--at") if at else ((west + east) / 2, (south + north) / 2)
    wide, deep = size[0] / 2, size[1] / 2
    return x - wide, y - deep, x + wide, y + deep


def size_of(area: str) -> tuple[float, float]:
    """Return width and depth of a text such as 3000x2000, metres."""
    found = _SIZE.fullmatch(area)
    if found is None or min(float(found[1]), float(found[2])) <= 0:
        raise UsageError(f'--area is "{area}"; it takes a size in metres, such as 3000x2000.')
    return float(found[1]), float(found[2])


def _hours(seconds: float) -> str:
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} minutes" if seconds < 7200 else f"{seconds / 3600:.1f} hours"
