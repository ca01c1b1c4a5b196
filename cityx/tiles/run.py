"""Building tiles: the map is split once, workers build, what is there already is left as it is."""

from __future__ import annotations

import json
import sqlite3
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from cityx.city.store import forget_prototypes
from cityx.dataset.workers import Cluster, Died, Pool, check_cluster, share_threads
from cityx.errors import CityxError, DiskError, InputError, UsageError
from cityx.sources.osm import coverage_of
from cityx.system.allocator import forget_peak, peak_and_held, return_freed_memory
from cityx.system.atomic import disk_fault, replaced
from cityx.tiles.edits import Edits, read_edits
from cityx.tiles.grid import Box, Tile, in_order, tile_named, tiles_of
from cityx.tiles.order import NAME, Order, check_worker, read_order, write_order
from cityx.tiles.plane import tiles_in
from cityx.tiles.relief import Relief, streets_on
from cityx.tiles.split import (
    Survey,
    fragment_of,
    is_empty,
    surveyed,
    write_fragment,
)
from cityx.tiles.tile import land_of, make_tile, read_record, write_tile
from cityx.tiles.tileset import NAME as TILESET
from cityx.tiles.tileset import merged_tileset, plane_tileset, write_tileset

TILES, FRAGMENTS, FAILED, PROTOTYPES = "tiles", "fragments", "failed", "prototypes"
INDEX, RUNS, LOCK = "index.json", "runs.jsonl", ".lock.sqlite"
FULL = 8  # tiles in a row without room on the disk, after which no more are tried
RENEW = 50  # tiles after which a worker is replaced, so that what libraries leak is given back
Say = Callable[[str], None]


@dataclass(frozen=True)
class Job:
    """What a worker needs for any tile."""

    folder: Path
    order: Order
    store: bool = True
    edits: Edits = field(default_factory=Edits)


@dataclass(frozen=True)
class Built:
    """A tile that was built, and what it took.

    Attributes
    ----------
    cpu_s
        Seconds of the processor.
    rss_mb, held_mb
        Memory of its worker at most, and after it.
    """

    tile: Tile
    cpu_s: float
    rss_mb: float
    held_mb: float


@dataclass(frozen=True)
class Failed:
    """A tile that could not be built, and whether that was for want of room on the disk."""

    tile: Tile
    cause: str
    full: bool = False


@dataclass
class Summary:
    """What a run did.

    Attributes
    ----------
    built, kept
        Tiles of this run, and those that were there already.
    failed
        Cause by the name of the tile.
    cpu_s, rss_mb
        Of all tiles of this run, and the greatest of a worker.
    """

    built: int = 0
    kept: int = 0
    failed: dict[str, str] = field(default_factory=dict)
    cpu_s: float = 0.0
    rss_mb: float = 0.0

    def plus(self, other: Summary) -> Summary:
        """Return what two runs did together."""
        return Summary(
            self.built + other.built, self.kept + other.kept, self.failed | other.failed,
            self.cpu_s + other.cpu_s, max(self.rss_mb, other.rss_mb),
        )  # fmt: skip


def build_one(job: Job, chunk: Sequence[Tile]) -> Iterator[Built | Failed]:
    """Build tiles; one that fails does not keep the others from being built."""
    for tile in chunk:
        began = process_time()
        forget_peak()
        try:
            check_worker(job.order)
            fragment = job.folder / FRAGMENTS / f"{tile.name}.npz"
            edits = job.edits.of(tile)
            key = job.order.key(tile, fragment, edits)
            made = make_tile(job.order, tile, fragment, edits)
            out, kept = job.folder / TILES / tile.name, job.folder / PROTOTYPES
            write_tile(job.order, tile, made, key, out, kept=kept, store=job.store)
        except Exception as error:  # noqa: BLE001  whatever one tile brings up, the others go on
            _log(job.folder, tile)
            told = str(error) if isinstance(error, CityxError) else (
                f"{type(error).__name__}: {error}"
            )  # fmt: skip
            fault = disk_fault(error, job.folder)
            yield Failed(tile, fault or told, fault is not None)
            continue
        del made
        peak, _ = peak_and_held()
        return_freed_memory()
        yield Built(tile, process_time() - began, peak, peak_and_held()[1])


def _log(folder: Path, tile: Tile) -> None:
    """Keep the trace of what went wrong."""
    with suppress(OSError):  # what cannot be written is told all the same
        (folder / FAILED).mkdir(exist_ok=True)
        (folder / FAILED / f"{tile.name}.txt").write_text(traceback.format_exc())


def split(
    survey: Survey, order: Order, folder: Path, say: Say, relief: Relief | None = None
) -> list[Tile]:
    """Write the fragment of each tile of a map and return the tiles that hold anything."""
    (folder / FRAGMENTS).mkdir(parents=True, exist_ok=True)
    found = []
    tiles = in_order(tiles_of(order.site, order.size))
    site = around(order, tiles)
    coverage = coverage_of(survey.osm, order.frame, site)
    streets = None
    if relief is not None:
        say("heights of streets")
        land = land_of(order, survey.osm, coverage, site, str(folder))
        streets = streets_on(land, order.items, relief)
    for tile in tiles:
        window = tile.box(order.size, order.margin)
        part = fragment_of(survey, window)
        if is_empty(part):
            continue
        with replaced(folder / FRAGMENTS / f"{tile.name}.npz") as temporary:
            terrain = None
            if relief is not None and streets is not None:
                terrain = replace(relief.over(window), streets=streets.within(window))
            write_fragment(part, coverage, temporary, terrain)
        found.append(tile)
    say(f"{len(found)} tiles")
    return found


def around(order: Order, tiles: Sequence[Tile]) -> Box:
    """Return the rectangle that holds the windows of some tiles."""
    boxes = np.array([tile.box(order.size, order.margin) for tile in tiles])
    low, high = boxes[:, :2].min(axis=0).tolist(), boxes[:, 2:].max(axis=0).tolist()
    return low[0], low[1], high[0], high[1]


def prepared(
    order: Order, source: Path | None, folder: Path, say: Say, *, heights: Sequence[Path] = ()
) -> list[Tile]:
    """Split a map, and its height files, into a folder, or find it split there already.

    The plane, whose source is None, has nothing to split and no list of tiles.

    Raises
    ------
    UsageError
        If the folder holds something else.
    """
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"{folder} is a file; give a folder for the tiles.")
    if (folder / NAME).exists():
        there, tiles = read_order(folder)
        if there == order:
            return tiles
        differing = [
            key for key, value in there.to_json().items() if order.to_json().get(key) != value
        ]
        raise UsageError(
            f"{folder} holds tiles of another order ({', '.join(sorted(differing))} differ); give "
            "another folder."
        )
    if folder.is_dir() and any(entry.name not in (FRAGMENTS, LOCK) for entry in folder.iterdir()):
        raise UsageError(f"{folder} is not empty and holds no tiles; give another folder.")
    if source is None:
        folder.mkdir(parents=True, exist_ok=True)
        write_order(order, [], folder)
        return []
    from cityx.sources.osm.reader import read_elements

    say("splitting the map")
    folder.mkdir(parents=True, exist_ok=True)
    survey = surveyed(read_elements(source), order.frame)
    relief = None if order.relief is None else Relief(heights, order.frame, order.relief)
    tiles = split(survey, order, folder, say, relief)
    write_order(order, tiles, folder)
    return tiles


def chosen(tiles: Iterable[Tile], order: Order, area: Box | None) -> list[Tile]:
    """Return the tiles that reach into an area of the frame, all without one.

    Raises
    ------
    InputError, UsageError
        If that is none, or of the plane without an area all.
    """
    if order.plane is not None:
        return in_order(tiles_in(order, area))
    known = set(tiles)
    wanted = known if area is None else known & set(tiles_of(area, order.size))
    if not wanted:
        raise InputError("No tile lies in the area; cityx tiles plan shows where they lie.")
    return in_order(wanted)


def build_tiles(
    folder: Path, order: Order, tiles: Sequence[Tile], *, workers: int = 1, cluster: str = "",
    store: bool = True, say: Say,
) -> Summary:  # fmt: skip
    """Build tiles of a split map, those that are there already left out.

    Raises
    ------
    UsageError, MissingExtra
        If the address of the cluster is of no use.
    DiskError
        If there was no room for `FULL` tiles in a row, or none for the index; what is done stays
        done. A tile that alone found no room is one that failed.
    """
    if cluster:
        check_cluster(cluster)
    summary = Summary()
    with alone(folder):
        (folder / TILES).mkdir(exist_ok=True)
        _sweep(folder)
        edits = read_edits(folder)
        job = Job(folder.resolve(), order, store, edits)
        left = [tile for tile in tiles if not is_done(folder, order, tile, edits)]
        summary.kept = len(tiles) - len(left)
        try:
            if left:
                _run(job, left, workers, cluster, summary, say)
        except BaseException:
            with suppress(OSError):  # what ended the run is told
                merge(folder, order)
            raise
        try:
            merge(folder, order)
        except OSError as error:
            fault = disk_fault(error, folder)
            if fault is None:
                raise
            raise DiskError(f"{fault}. {_resumable(folder, summary)}") from error
    return summary


def _resumable(folder: Path, summary: Summary) -> str:
    return (
        f"{summary.built + summary.kept} tiles are done and stay in {folder}; the same command "
        "goes on where this one stopped."
    )


def is_done(folder: Path, order: Order, tile: Tile, edits: Edits) -> bool:
    """Return whether a tile is there as the order and its edits have it."""
    fragment = folder / FRAGMENTS / f"{tile.name}.npz"
    record = read_record(folder / TILES / tile.name)
    if not record or (order.plane is None and not fragment.is_file()):
        return False
    return bool(record.get("key") == order.key(tile, fragment, edits.of(tile)))


def _run(
    job: Job, left: Sequence[Tile], workers: int, cluster: str, summary: Summary, say: Say
) -> None:
    share_threads(1)
    chunks = [[tile] for tile in left]
    hands = (
        Cluster(build_one, job, cluster) if cluster
        else Pool(build_one, job, workers, renew=RENEW)
    )  # fmt: skip
    in_a_row: list[str] = []  # tiles for which there was no room
    with closing(hands):
        for result in hands.run(chunks):
            match result:
                case Built(tile, cpu_s, rss_mb, _):
                    in_a_row.clear()
                    summary.built += 1
                    summary.cpu_s += cpu_s
                    summary.rss_mb = max(summary.rss_mb, rss_mb)
                    _note(job.folder, result)
                    say(f"{summary.built} of {len(left)} tiles, {tile.name} took {cpu_s:.1f} s")
                case Failed(tile=tile, cause=cause) | Died(item=tile, cause=cause):
                    summary.failed[tile.name] = cause
                    say(f"{tile.name} failed: {cause}")
                    if not (isinstance(result, Failed) and result.full):
                        continue
                    in_a_row.append(tile.name)
                    if len(in_a_row) == FULL:
                        raise DiskError(
                            f"{cause}. So {FULL} tiles in a row failed: {', '.join(in_a_row)}. "
                            f"{_resumable(job.folder, summary)}"
                        )


def _note(folder: Path, built: Built) -> None:
    """Keep what a tile took, if there is room for it."""
    told = {"tile": built.tile.name, "cpu_s": round(built.cpu_s, 2),
            "rss_mb": round(built.rss_mb), "held_mb": round(built.held_mb)}  # fmt: skip
    with suppress(OSError), (folder / RUNS).open("ab", buffering=0) as runs:
        runs.write((json.dumps(told) + "\n").encode())


def _sweep(folder: Path) -> None:
    """Take away what killed workers left half written."""
    import shutil

    for entry in (folder / TILES).glob(".*.partial"):
        shutil.rmtree(entry, ignore_errors=True)
    forget_prototypes(folder / PROTOTYPES)


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Keep other runs away from a folder; the lock goes with the process, however that ends.

    Raises
    ------
    UsageError
        If another process is building there.
    """
    with closing(sqlite3.connect(folder / LOCK, timeout=0)) as lock:
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError as error:
            raise UsageError(f"{folder} is being built by another process.") from error
        yield


def records(folder: Path) -> dict[Tile, Mapping[str, Any]]:
    """Return the records of the tiles that are built, in the order of their names."""
    found = {}
    for entry in sorted((folder / TILES).iterdir()) if (folder / TILES).is_dir() else []:
        record = {} if entry.name.startswith(".") else read_record(entry)
        if record:
            found[tile_named(entry.name)] = record
    return dict(sorted(found.items()))


def merge(folder: Path, order: Order) -> None:
    """Write the tileset and the index of the tiles that are built."""
    known = records(folder)
    shown = {tile: record for tile, record in known.items() if record["box"]}
    index = {
        "tiles": {
            tile.name: {key: record[key] for key in ("hash", "key", "extent", "counts")}
            for tile, record in known.items()
        }
    }
    with replaced(folder / INDEX) as temporary:
        temporary.write_text(json.dumps(index, indent=1) + "\n")
    if shown and order.plane is not None:
        with replaced(folder / TILESET) as temporary:
            write_tileset(plane_tileset(order.frame, shown, order.size), temporary)
    elif shown:
        credits_ = [text for record in shown.values() for text in record["attribution"]]
        with replaced(folder / TILESET) as temporary:
            document = merged_tileset(order.frame, shown, credits_, order.size, datum=order.datum)
            write_tileset(document, temporary)
