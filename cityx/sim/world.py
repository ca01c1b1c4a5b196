"""The world: what a simulator knows of a city, as arrays that kernels read.

A world is compiled once from a city and kept in the cache folder, by the city's hash and the
version of the compiler; it is mapped into memory, so that processes share it. `docs/simulator.md`
lists its arrays in a table that is made of this module.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any, TypeVar
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.sim.blocks import Blocks
from cityx.sim.dynamics import VEHICLES
from cityx.sim.scenery import SCENERY_VERSION, Scenery
from cityx.sim.walks import VERSION as WALKS_VERSION
from cityx.sim.walks import Walks
from cityx.system.atomic import replaced
from cityx.system.cache import cache_folder
from cityx.system.packed import read_arrays, write_arrays

T = TypeVar("T")
VERSION = 6  # of the compiler; rises whenever a city gives another world
POINT = ("x", "y", "z", "heading", "along", "lift")  # columns of points
SEGMENT = ("x0", "y0", "x1", "y1", "low", "high")  # columns of segments
NOTHING, OFF_ROADWAY, TOO_TIGHT = 0, 1, 2  # why a vehicle does not fit where no object is named


@dataclass(frozen=True)
class World:
    """A city as a simulator reads it.

    Pieces are lanes that cars drive along, then the ways across junctions that join them.

    Attributes
    ----------
    piece_lane
        (n,) uint64, lane by `LaneGraph.lane_id`; of a way across the one it comes from.
    piece_onto
        (n,) uint64, of a way across the lane it leads into; 0 of lanes.
    piece_junction
        (n,) int32, of a way across; -1 of lanes.
    piece_speed
        (n,) float64, m/s that may be driven; less in bends.
    piece_half
        (n,) float64, metres, half its width.
    piece_public
        (n,) bool, whether any car may drive there.
    piece_narrow
        (n,) bool, whether others who come against it, or over it, have the same ground.
    piece_vehicle
        (n,) int64, how many of `VEHICLES`, from the smallest on, fit along the whole piece.
    piece_block
        (n, v) uint64, object that is in the way of each kind of vehicle; `NOTHING`, `OFF_ROADWAY`
        (two wheels would leave the roadway) or `TOO_TIGHT` where none is.
    piece_signal
        (n,) int32, signal program that rules a way across, -1 for none.
    point_start
        (n + 1,) int64; piece i has the points ``point[point_start[i]:point_start[i + 1]]``.
    point
        (p, 6) float64, columns `POINT`: metres, radians unwrapped along a piece, metres from the
        start of the piece, metres above the ground.
    next_start
        (n + 1,) int32 into `next`.
    next
        (m,) int32, pieces that follow each one.
    piece_beside
        (n, 2) int32, of a lane those to the left and to the right of it that one may change to, -1
        for none.
    conflict_start
        (n + 1,) int32 into `conflict`.
    conflict
        (k,) int32, ways across that cannot be used together with each one.
    conflict_yields
        (k,) bool, whether it gives way to that one.
    signal_cycle
        (h,) float64, seconds after which a program begins anew.
    signal_start
        (h + 1,) int64 into the changes.
    signal_time
        (c,) float64, seconds, ascending from 0 within a program.
    signal_state
        (c,) uint8 into `cityx.city.signals.STATES`, from then on.
    raster_frame
        (5,) float64: west, south, metres of a cell, columns and rows of the rasters.
    flags_table
        (r, c) int32 into `flags_block`, by squares of 64 x 64 cells, row 0 in the south.
    flags_block
        (k, 64, 64) uint8, bits of `cityx.sim.compile.rasters.FLAGS`; squares that are the same all
        over are there once for each value.
    clear_table
        (r, c) int32 into `clear_block`, as `flags_table`.
    clear_block
        (k, 64, 64) uint8, decimetres from any place of a cell to the nearest segment, at least.
    segment
        (s, 6) float32, columns `SEGMENT`: sides of all that is solid, metres.
    segment_object
        (s,) uint64, whose side it is.
    cell_frame
        (5,) float64, as `raster_frame`, of the cells of segments.
    cell_start
        (cells + 1,) int32 into `cell_segment`.
    cell_segment
        (q,) int32, segments whose bounds reach into each cell, row by row.
    about
        Text (JSON) with "name", "hash", "version", "lod", "attribution" and "frame".
    """

    piece_lane: NDArray[np.uint64]
    piece_onto: NDArray[np.uint64]
    piece_junction: NDArray[np.int32]
    piece_speed: FloatArray
    piece_half: FloatArray
    piece_public: BoolArray
    piece_narrow: BoolArray
    piece_vehicle: IntArray
    piece_block: NDArray[np.uint64]
    piece_signal: NDArray[np.int32]
    point_start: IntArray
    point: FloatArray
    next_start: NDArray[np.int32]
    next: NDArray[np.int32]
    piece_beside: NDArray[np.int32]
    conflict_start: NDArray[np.int32]
    conflict: NDArray[np.int32]
    conflict_yields: BoolArray
    signal_cycle: FloatArray
    signal_start: IntArray
    signal_time: FloatArray
    signal_state: NDArray[np.uint8]
    raster_frame: FloatArray
    flags_table: NDArray[np.int32]
    flags_block: NDArray[np.uint8]
    clear_table: NDArray[np.int32]
    clear_block: NDArray[np.uint8]
    segment: NDArray[np.float32]
    segment_object: NDArray[np.uint64]
    cell_frame: FloatArray
    cell_start: NDArray[np.int32]
    cell_segment: NDArray[np.int32]
    about: NDArray[np.str_]

    @property
    def count(self) -> int:
        """Number of pieces."""
        return len(self.piece_lane)

    @property
    def flags(self) -> Blocks:
        """What each cell of the raster lies on."""
        return Blocks(self.flags_table, self.flags_block)

    @property
    def clear(self) -> Blocks:
        """How far each cell of the raster is from what is solid."""
        return Blocks(self.clear_table, self.clear_block)

    @cached_property
    def facts(self) -> dict[str, Any]:
        """What `about` says."""
        found: dict[str, Any] = json.loads(str(self.about[0]))
        return found

    @property
    def hash(self) -> str:
        """Hash of the city that it was compiled from."""
        return str(self.facts["hash"])

    @property
    def across(self) -> BoolArray:
        """(n,) whether a piece is a way across a junction."""
        return np.asarray(self.piece_junction >= 0)

    @cached_property
    def piece_length(self) -> FloatArray:
        """(n,) metres."""
        return np.asarray(self.point[self.point_start[1:] - 1, 4])

    def fits(self, vehicle: int) -> BoolArray:
        """(n,) whether a vehicle, a number among `VEHICLES`, fits along each piece."""
        return np.asarray(self.piece_vehicle > vehicle)


@dataclass(frozen=True)
class Certificate:
    """How much of a city can be driven by whom.

    Attributes
    ----------
    metres
        Of lanes for cars.
    by_vehicle
        Metres along which each vehicle fits, by name.
    across, across_by_vehicle
        Number of ways across junctions, and of those along which each vehicle fits.
    blocks
        Objects that are in the way of cars, and metres of lanes that each of them closes.
    """

    metres: float
    by_vehicle: dict[str, float]
    across: int
    across_by_vehicle: dict[str, int]
    blocks: dict[int, float]


def certificate(world: World) -> Certificate:
    """Measure what can be driven by whom."""
    lane, length = ~world.across, world.piece_length
    fits = {vehicle.name: world.fits(number) for number, vehicle in enumerate(VEHICLES)}
    car = world.piece_block[:, 1]
    blocks = {int(block): float(length[lane & (car == block)].sum())
              for block in np.unique(car[lane & (car > TOO_TIGHT)])}  # fmt: skip
    return Certificate(
        float(length[lane].sum()),
        {name: float(length[lane & own].sum()) for name, own in fits.items()},
        int((~lane).sum()), {name: int((own & ~lane).sum()) for name, own in fits.items()},
        dict(sorted(blocks.items(), key=lambda item: (-item[1], item[0]))),
    )  # fmt: skip


def write_kept(value: Any, path: Path) -> None:
    """Write a world, its walks or its scenery; what stood there stays until the file is whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        write_arrays(temporary, {each.name: getattr(value, each.name) for each in fields(value)})


def read_world(path: Path) -> World:
    """Read a world; its arrays stay in the file until they are looked at.

    Raises
    ------
    InputError
        If the file is no world of this version.
    """
    return _read(World, path, "world")


def read_walks(path: Path) -> Walks:
    """Read walks; their arrays stay in the file until they are looked at.

    Raises
    ------
    InputError
        If the file holds no walks of this version.
    """
    return _read(Walks, path, "file of walks")


def read_scenery(path: Path) -> Scenery:
    """Read a scenery; its arrays stay in the file until they are looked at.

    Raises
    ------
    InputError
        If the file holds no scenery of this version.
    """
    return _read(Scenery, path, "file of scenery")


def _read(kind: type[T], path: Path, what: str) -> T:
    try:
        arrays = read_arrays(path, mapped=True)
        return kind(**{each.name: arrays[each.name] for each in fields(kind)})  # type: ignore[arg-type]
    except (KeyError, ValueError, OSError, BadZipFile) as error:
        raise InputError(f"{path} is no {what} of this version of CityX.") from error


def kept_path(city_hash: str, name: str, ending: str = f"{VERSION}.npz") -> Path | None:
    """Return where the world of a city is kept; None where the user wants no cache.

    Its name is no part of the hash of a city, and the world bears it.
    """
    folder = cache_folder()
    key = blake2b(f"{city_hash} {name}".encode(), digest_size=16).hexdigest()
    return folder / "worlds" / f"{key}-{ending}" if folder else None


def kept_walks_path(city_hash: str, name: str) -> Path | None:
    """Return where the walks of a city are kept, as `kept_path` does."""
    return kept_path(city_hash, name, f"{VERSION}-walks-{WALKS_VERSION}.npz")


def kept_scenery_path(city_hash: str, name: str) -> Path | None:
    """Return where the scenery of a city is kept, as `kept_path` does."""
    return kept_path(city_hash, name, f"scenery-{SCENERY_VERSION}.npz")


def kept_scenery(city_hash: str, name: str) -> Scenery | None:
    """Return the scenery of a city that was compiled before."""
    return _kept(kept_scenery_path(city_hash, name), read_scenery)


def kept_world(city_hash: str, name: str) -> World | None:
    """Return the world of a city that was compiled before."""
    return _kept(kept_path(city_hash, name), read_world)


def kept_walks(city_hash: str, name: str) -> Walks | None:
    """Return the walks of a city that were compiled before."""
    return _kept(kept_walks_path(city_hash, name), read_walks)


def _kept(path: Path | None, read: Callable[[Path], T]) -> T | None:
    if path is None or not path.is_file():
        return None
    try:
        return read(path)
    except InputError:
        return None
