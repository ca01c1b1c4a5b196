"""Rasters of a world: what lies under a place, and how far it is to anything solid."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import LABEL, ON_ROADWAY, ROADWAY
from cityx.errors import InputError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ground.standing import WALKED
from cityx.sim.blocks import SIDE, WINDOW, Blocks, Gathered, Place, windows_of
from cityx.sim.kernels import rasters as kernels

CELL = 0.25  # metres
MARGIN = 128  # cells about a window in which what counts for its clearance lies
LARGEST = 2500  # km2 of a site: its tables have 0.5 GB then, whatever is built
FLAGS = ("roadway", "deck", "walk", "kerb", "green", "water", "rail", "building")
BIT = {name: 1 << number for number, name in enumerate(FLAGS)}
_KERB = ("kerb", "kerb_dropped")
_SURFACES: dict[str, tuple[str, ...]] = {
    "roadway": (*ROADWAY, *ON_ROADWAY, "parking", "apron"),
    "walk": (*WALKED, "kerb_dropped", "tactile", "tactile_pale", "tactile_buff", "tactile_red",
             "ramp", "guide_strip", "landing"),
    "kerb": _KERB,
    "green": ("grass", "meadow", "wood", "park", "farmland", "block", "bed", "sand", "bare",
              "pitch", "playground"),
    "deck": ("void",),  # what is built there stands on no ground
    "water": ("water",),
    "rail": ("railway", "rail"),
    "building": ("building",),
}  # fmt: skip


def frame_of(city: City) -> FloatArray:
    """(5,) west, south, metres of a cell, columns and rows of the rasters of a city.

    Raises
    ------
    InputError
        If they would be larger than `LARGEST`.
    """
    west, south, east, north = city.layout.extent
    columns, rows = (max(int(np.ceil(span / CELL)), 1) for span in (east - west, north - south))
    if columns * rows * CELL**2 > LARGEST * 1e6:
        raise InputError(
            f'The city "{city.name}" is too large to be driven in as a whole: its site has '
            f"{columns * rows * CELL**2 / 1e6:.0f} km2, {LARGEST} are not. Build a part of the map "
            "(cityx build MAP --at LAT,LON --size WxH), or tiles (cityx tiles build MAP), and give "
            "that folder."
        )
    return np.array([west, south, CELL, columns, rows], float)


def flags_of(city: City, frame: FloatArray) -> Blocks:
    """Bits of `FLAGS`: what the middle of each cell lies on."""
    ground, ways = city.ground, city.heights
    vertices, triangles, bits = np.zeros((0, 2)), np.zeros((0, 3), np.int32), np.zeros(0, np.uint8)
    if ground is not None:
        of = np.zeros(len(LABEL), np.uint8)
        for flag, names in _SURFACES.items():
            for name in names:
                of[LABEL[name]] |= BIT[flag]
        vertices, triangles = np.asarray(ground.vertices), np.asarray(ground.triangles)
        bits = of[ground.face_label[ground.triangle_face]]
    line, half = np.zeros((0, 4)), np.zeros(0)
    if ways is not None and ways.count:
        owner = np.repeat(np.arange(ways.count), np.diff(ways.point_start))
        first = np.flatnonzero((owner[1:] == owner[:-1]) & (ways.edge[owner[1:]] >= 0))
        line = np.column_stack([ways.points[first], ways.points[first + 1]])
        half = np.asarray(ways.half_width[owner[first]])
    corner = vertices[:, :2][triangles]  # (t, 3, 2)
    faces = _by_window(frame, np.concatenate([corner.min(axis=1), corner.max(axis=1)], axis=1), 0.0)
    strips = _by_window(frame, line, half)
    found = Gathered(int(frame[4]), int(frame[3]))
    for number, (row, column, height, width) in enumerate(_windows(frame)):
        own, ways_there = faces(number), strips(number)
        if not len(own) and not len(ways_there):
            found.add(row, column, 0)
            continue
        drawn = np.zeros((height, width), np.uint8)
        kernels.draw_triangles(drawn, frame, vertices, triangles[own], bits[own], row, column)
        kernels.draw_strips(drawn, frame, line[ways_there], half[ways_there], BIT["deck"], row,
                            column)  # fmt: skip
        found.add(row, column, drawn)
    return found.blocks()


def clearance_of(frame: FloatArray, segment: NDArray[np.float32]) -> Blocks:
    """Decimetres from any place of a cell to the nearest segment, at least, up to 25.5 m."""
    own = _by_window(frame, np.asarray(segment[:, :4], float), MARGIN * frame[2])

    def drawn(number: int, place: Place) -> BoolArray | None:
        rows = own(number)
        if not len(rows):
            return None
        row, column, height, width = place
        mask = np.zeros((height, width), bool)
        kernels.draw_segments(mask, frame, segment[rows], row, column)
        return mask

    return _cleared(frame, drawn)


def clearance_to(frame: FloatArray, flags: Blocks, bits: int) -> Blocks:
    """Decimetres from any place of a cell to the nearest cell that has one of some bits."""
    has = ((flags.block & bits) != 0).any(axis=(1, 2))

    def drawn(_: int, place: Place) -> BoolArray | None:
        if not has[flags.table_within(*place)].any():
            return None
        return np.asarray((flags.within(*place) & bits) != 0)

    return _cleared(frame, drawn)


def _cleared(frame: FloatArray, drawn: Callable[[int, Place], BoolArray | None]) -> Blocks:
    """Return clearance to what is drawn, window by window; what lies farther off changes nothing.

    Parameters
    ----------
    frame
        Of the raster.
    drawn
        Returns the cells of a window that are set, None for none, by its number and place.
    """
    height, width = int(frame[4]), int(frame[3])
    found = Gathered(height, width)
    for number, (row, column, high, wide) in enumerate(_windows(frame)):
        first, left = max(row - MARGIN, 0), max(column - MARGIN, 0)
        last, right = min(row + high + MARGIN, height), min(column + wide + MARGIN, width)
        mask = drawn(number, (first, left, last - first, right - left))
        if mask is None:
            found.add(row, column, kernels.FARTHEST)
            continue
        away = np.asarray(kernels.clearance(mask, float(frame[2])))
        inner = away[row - first :, column - left :][:high, :wide]
        found.add(row, column, inner)
    return found.blocks()


def _windows(frame: FloatArray) -> Iterator[Place]:
    return windows_of(int(frame[4]), int(frame[3]))


def _by_window(
    frame: FloatArray, ends: FloatArray, reach: FloatArray | float
) -> Callable[[int], IntArray]:
    """Return a function of the number of a window: the rows whose bounds come near it.

    Parameters
    ----------
    ends
        (n, 4) two corners, metres.
    reach
        Metres that each row is larger on all sides, one for all or (n,).
    """
    side = SIDE * WINDOW * frame[2]
    grid = np.array([*frame[:2], side, np.ceil(frame[3] * frame[2] / side - 1e-9),
                     np.ceil(frame[4] * frame[2] / side - 1e-9)])  # fmt: skip
    more = np.asarray(reach + frame[2])[..., None]
    low = np.minimum(ends[:, :2], ends[:, 2:]) - more
    high = np.maximum(ends[:, :2], ends[:, 2:]) + more
    start, row = kernels.grid_cells(np.concatenate([low, high], axis=1), grid)
    return lambda number: np.asarray(row[start[number] : start[number + 1]], np.int64)
