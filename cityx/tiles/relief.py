"""The relief of a run: the heights of its files on one grid, cut into the windows of tiles.

The grid is computed in blocks of the plane. A node belongs to one block, so that whichever windows
hold it have the same height there, whatever the filters and splines of a window of its own would
have made of it.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from functools import lru_cache
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.agents.planning.workflow import Item
from cityx.city import City, Frame
from cityx.city.terrain import Profile, Terrain
from cityx.errors import InputError
from cityx.road.heights.way_heights import street_profile
from cityx.sources.heights.height_field import HeightGrid, grid_of, terrain_on
from cityx.sources.heights.height_files import HeightFile
from cityx.sources.heights.height_kinds import Shows
from cityx.sources.heights.height_source import read_heights
from cityx.tiles.actions import built
from cityx.tiles.grid import Box

HEIGHTS = "road/heights-v1"  # action that gives ways their heights
BLOCK = 2048.0  # metres; a multiple of every cell, and of heights half a metre apart read at once
HELD = 64 << 20  # bytes of blocks; tiles are split along rows of blocks
PER_METRE = 1000.0  # heights are whole millimetres in a fragment
_ARRAYS = ("relief", "relief_grid")
_STREETS = "relief_streets"  # places in millimetres and heights in tenths of one
PER_HEIGHT = 1e4


def ground_files(paths: Sequence[Path]) -> list[HeightFile]:
    """Open the height files of a run.

    Raises
    ------
    InputError, UsageError
        With every file that shows more than bare ground, or does not say where it lies.
    """
    heights = read_heights(paths)
    pairs = list(zip(heights.files, heights.kinds, strict=True))
    faults = [
        f"{file.path.name} shows {kind.shows} ({kind.evidence}); tiles take heights of the bare "
        "ground."
        for file, kind in pairs if kind.shows is not Shows.TERRAIN
    ] + [
        f"{file.path.name} does not say where it lies; tiles take heights that do, such as GeoTIFF."
        for file, _ in pairs if not file.located
    ]  # fmt: skip
    if faults:
        raise InputError(" ".join(faults))
    return list(heights.files)


def relief_of(paths: Sequence[Path], frame: Frame, site: Box) -> Mapping[str, float] | None:
    """Return what all tiles share of the heights of a run, None if it has no height file.

    Raises
    ------
    InputError, UsageError
        As of `ground_files`, or if the files do not cover the site.
    """
    return asdict(grid_of(ground_files(paths), frame, site)) if paths else None


def streets_on(land: City, items: Iterable[Item], relief: Relief) -> Profile:
    """Return the heights of the streets of a whole map on the relief of a run.

    Parameters
    ----------
    land
        Layout of the map.
    items
        The actions of a tile, of which those before the heights of ways run.
    """
    city = built(replace(land, stages_done=land.stages_done | {"terrain"}),
                 takewhile(lambda item: item.action != HEIGHTS, items))  # fmt: skip
    if city.network is None:
        return Profile.of(np.zeros((0, 2)), np.zeros(0))
    return street_profile(city.layout, city.network, relief.height_at)


class Relief:
    """The heights of a run, read where they are asked for.

    Parameters
    ----------
    paths
        Its height files.
    frame
        Of the run.
    shared
        As of `relief_of`.
    """

    def __init__(self, paths: Sequence[Path], frame: Frame, shared: Mapping[str, float]) -> None:
        self._files, self._frame = ground_files(paths), frame
        self._grid = HeightGrid(**shared)
        nodes = round(BLOCK / self._grid.cell) ** 2
        self._block = lru_cache(maxsize=max(4, HELD // (8 * nodes)))(self._read)

    def over(self, box: Box) -> Terrain:
        """Return the terrain of a window."""
        cell = self._grid.cell
        first = np.floor(np.array(box[:2]) / cell).astype(int)
        last = np.ceil(np.array(box[2:]) / cell).astype(int) + 1
        heights = np.empty((last[1] - first[1], last[0] - first[0]))
        side = round(BLOCK / cell)
        low, high = first // side, (last - 1) // side
        for row in range(low[1], high[1] + 1):
            for column in range(low[0], high[0] + 1):
                corner = np.array([column, row]) * side
                start, stop = np.maximum(first, corner), np.minimum(last, corner + side)
                ours, theirs = (
                    tuple(slice(start[k] - base[k], stop[k] - base[k]) for k in (1, 0))
                    for base in (first, corner)
                )
                heights[ours] = self._block(column, row)[theirs]
        west, south = (first * cell).tolist()
        return Terrain((west, south), cell, heights, self._grid.datum)

    def height_at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (n,) heights at (n, 2) places, metres, as the terrain of any window has them."""
        found = np.zeros(len(points))
        square = np.floor(points / BLOCK).astype(int)
        each, number = np.unique(square, axis=0, return_inverse=True)
        for row, (column, line) in enumerate(each.tolist()):
            own = np.flatnonzero(number.reshape(-1) == row)
            west, south = column * BLOCK, line * BLOCK
            window = self.over((west, south, west + BLOCK, south + BLOCK))
            found[own] = window.height_at(points[own])
        return found

    def _read(self, column: int, row: int) -> NDArray[np.float64]:
        west, south = column * BLOCK, row * BLOCK
        inner = BLOCK - self._grid.cell  # the next node belongs to the next block
        box = (west, south, west + inner, south + inner)
        return terrain_on(self._files, self._frame, box, self._grid).heights


def packed(terrain: Terrain) -> dict[str, NDArray[Any]]:
    """Return the arrays of a terrain for a fragment, small: steps from node to node."""
    steps = np.rint(terrain.heights * PER_METRE).astype(np.int32)
    steps[1:] = np.diff(steps, axis=0)
    steps[:, 1:] = np.diff(steps, axis=1)
    grid = np.array([*terrain.origin, terrain.cell, *steps.shape, terrain.datum], float)
    held = zlib.compress(steps.astype("<i4").tobytes(), 6)
    found = dict(zip(_ARRAYS, (np.frombuffer(held, np.uint8), grid), strict=True))
    if terrain.streets is not None:
        place, z = terrain.streets.place, np.rint(terrain.streets.z * PER_HEIGHT).astype(np.int64)
        table = np.diff(np.column_stack([place, z]), axis=0, prepend=0)
        bytes_ = zlib.compress(np.ascontiguousarray(table.T, "<i8").tobytes(), 6)
        found[_STREETS] = np.frombuffer(bytes_, np.uint8)
    return found


def unpacked(held: Mapping[str, Any]) -> Terrain | None:
    """Return the terrain of the arrays of a fragment, None if it has none."""
    if _ARRAYS[0] not in held:
        return None
    west, south, cell, rows, columns, datum = np.asarray(held[_ARRAYS[1]]).tolist()
    steps = np.frombuffer(zlib.decompress(np.asarray(held[_ARRAYS[0]]).tobytes()), "<i4")
    steps = steps.reshape(int(rows), int(columns)).astype(np.int64)
    heights = np.cumsum(np.cumsum(steps, axis=1), axis=0) / PER_METRE
    return Terrain((west, south), cell, heights, datum, _streets_in(held))


def _streets_in(held: Mapping[str, Any]) -> Profile | None:
    if _STREETS not in held:
        return None
    table = np.frombuffer(zlib.decompress(np.asarray(held[_STREETS]).tobytes()), "<i8")
    x, y, z = np.cumsum(table.reshape(3, -1).astype(np.int64), axis=1)
    return Profile(np.column_stack([x, y]), z / PER_HEIGHT)
