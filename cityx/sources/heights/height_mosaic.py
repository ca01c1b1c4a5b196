"""Height files of one site are joined to one grid of cells around it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from cityx.city.frame import Frame
from cityx.city.sites import Box
from cityx.errors import InputError, UsageError
from cityx.geometry.arrays import FloatArray
from cityx.sources.heights.height_files import MAX_READ, HeightFile, HeightOptions, open_height

Paths = Path | Sequence[Path]
Strays = tuple[tuple[float, float, int], ...]

EDGE = 4  # cells read around the site, for the cubic kernel and the filter
SIDE = 17  # points per side of a site at which its place in a file is computed
SAME = 0.01  # cells by which the lattices of two files may differ and be one
BIN = 25.0  # metres in which heights are counted
GAP = 100.0  # metres without a height that land hardly has
MARKER_GAP = 500.0  # metres without a height that no land and no tower has
FEW_MARKS = 0.05  # share of the cells that a marker not far below the land takes at most
FEW = 0.01  # share of the cells that broken ones of several values take at most
ALIKE = 1e-6  # share by which the cells of two files may differ in size and be equal


@dataclass(frozen=True)
class Raster:
    """Heights in the coordinate system of their file.

    Attributes
    ----------
    values
        (rows, columns) float64, NaN where void; row 0 is the first of the file.
    to_cell
        Affine coefficients (a, b, c, d, e, f): column = a x + b y + c, row = d x + e y + f, counted
        from the centre of the first cell.
    crs
        Whatever pyproj reads.
    step
        Metres between heights that are whole numbers of some unit; 0 when they are not.
    strays
        Values far outside the rest, which count as void: (lowest, highest, cells) of each group.
    """

    values: FloatArray
    to_cell: tuple[float, float, float, float, float, float]
    crs: Any
    step: float = 0.0
    strays: Strays = ()

    def cells(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return column and row of places."""
        a, b, c, d, e, f = self.to_cell
        return a * x + b * y + c, d * x + e * y + f

    def places(self, column: Any, row: Any) -> tuple[FloatArray, FloatArray]:
        """Return the places of columns and rows."""
        a, b, c, d, e, f = self.to_cell
        x, y = np.linalg.solve([[a, b], [d, e]], [np.subtract(column, c), np.subtract(row, f)])
        return x, y

    def at(self, frame: Frame, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return column and row of (n, 2) points of a frame."""
        from pyproj import Transformer

        change = Transformer.from_crs(frame.projection, self.crs, always_xy=True)
        points = np.asarray(points, float).reshape(-1, 2)
        x, y = change.transform(points[:, 0], points[:, 1])
        return self.cells(np.asarray(x), np.asarray(y))


def open_heights(paths: Paths, options: HeightOptions | None = None) -> list[HeightFile]:
    """Open the height files of one site.

    A grid that does not name its coordinate system takes that of another file with the same number
    and place of cells.

    Raises
    ------
    InputError, UsageError
        With every fault, if a file cannot be read.
    """
    files, faults = [], []
    for path in [paths] if isinstance(paths, str | Path) else paths:
        try:
            files.append(open_height(path, options))
        except (InputError, UsageError) as error:
            faults.append(error)
    if faults:
        raise type(faults[0])(" ".join(map(str, faults)))
    return [_like_another(file, files) for file in files]


def _like_another(file: HeightFile, files: list[HeightFile]) -> HeightFile:
    """Take the coordinate system of a file on the same cells."""
    if file.located or file.to_cell is None:
        return file
    for other in files:
        if (
            other.located
            and other.shape == file.shape
            and np.allclose(other.to_cell or (), file.to_cell, atol=SAME, rtol=ALIKE)
        ):
            return replace(file, crs=other.crs)
    return file


def laid(
    file: HeightFile, frame: Frame, site: Box, options: HeightOptions | None = None
) -> HeightFile:
    """Lay a file that does not say where it lies over a site, its middle on that of the site.

    Raises
    ------
    InputError
        If the file has a place in a coordinate system that nobody names.
    """
    if file.located:
        return file
    if file.to_cell is not None:
        a, e = file.to_cell[0], file.to_cell[4]
        raise InputError(
            f"{file.path} does not say in which coordinate system it lies (its cells measure "
            f"{abs(1 / a):g} x {abs(1 / e):g}); put its .prj file beside it, name it with "
            "--height-crs, such as EPSG:25833, or give a GeoTIFF."
        )
    rows, columns = file.shape
    pixel = options.pixel if options else None
    size = pixel or max((site[2] - site[0]) / columns, (site[3] - site[1]) / rows)
    middle = ((site[0] + site[2]) / 2, (site[1] + site[3]) / 2)
    to_cell = (
        1 / size, 0.0, (columns - 1) / 2 - middle[0] / size,
        0.0, -1 / size, (rows - 1) / 2 + middle[1] / size,
    )  # fmt: skip
    return replace(file, to_cell=to_cell, crs=frame.projection)


def raster_of(files: Sequence[HeightFile], frame: Frame, box: Box, *, edge: int = EDGE) -> Raster:
    """Read the cells of some files around a box and join them.

    Where files overlap the finer one is taken, among equals the first; where it is void the next.

    Parameters
    ----------
    files
        One or more that say where they lie.
    frame, box
        Of what is read, metres.
    edge
        Cells that are read beyond the box.

    Raises
    ------
    InputError
        If a file lies nowhere on Earth.
    """
    parts = [_window(file, frame, box, edge) for file in files]
    parts.sort(key=lambda part: spacing(part, frame, box))
    return parts[0] if len(parts) == 1 else _joined(parts, frame, box, edge)


def corners(file: HeightFile) -> FloatArray:
    """Return (4, 2) longitude and latitude of the corners of a file that says where it lies."""
    from pyproj import Transformer

    assert file.to_cell is not None
    rows, columns = file.shape
    cells = np.array([(i, j) for i in (-0.5, columns - 0.5) for j in (-0.5, rows - 0.5)])
    places = Raster(np.zeros((0, 0)), file.to_cell, file.crs).places(*cells.T)
    change = Transformer.from_crs(file.crs, "EPSG:4326", always_xy=True)
    return np.column_stack(change.transform(*places))


def grid_points(box: Box) -> FloatArray:
    """Return (n, 2) points on the border of a box and within it."""
    x, y = np.linspace(box[0], box[2], SIDE), np.linspace(box[1], box[3], SIDE)
    return np.column_stack([axis.ravel() for axis in np.meshgrid(x, y)])


def _window(file: HeightFile, frame: Frame, box: Box, edge: int) -> Raster:
    """Read the cells around a box; of a larger window the means of blocks."""
    assert file.to_cell is not None
    whole = Raster(np.zeros((0, 0)), file.to_cell, file.crs)
    column, row = whole.at(frame, grid_points(box))
    if not (np.isfinite(column).all() and np.isfinite(row).all()):
        raise InputError(
            f"{file.path} lies nowhere near the site: its coordinate system ({crs_name(file.crs)}) "
            "holds no such place. Is it the right one?"
        )
    rows, columns = _span(row, file.shape[0], edge), _span(column, file.shape[1], edge)
    cells = (rows.stop - rows.start) * (columns.stop - columns.start)
    stride = max(1, int(np.ceil(np.sqrt(cells / MAX_READ))))
    values = file.read((rows, columns), stride)
    strays = strays_of(values)
    values = without(values, strays)
    a, b, c, d, e, f = file.to_cell
    # The first block's middle lies (stride - 1) / 2 cells beyond the middle of its first cell.
    c, f = (
        (offset - first - (stride - 1) / 2) / stride
        for offset, first in ((c, columns.start), (f, rows.start))
    )
    to_cell = (a / stride, b / stride, c, d / stride, e / stride, f)
    return Raster(values, to_cell, file.crs, _step(file, values) if stride == 1 else 0.0, strays)


def strays_of(heights: FloatArray) -> Strays:
    """Find values that lie so far outside the rest that they are no heights.

    Land takes the heights between its lowest and its highest point; markers of voids that a file
    does not declare, and broken cells, leave a gap. A tower in a surface leaves one too, but not
    of that size.

    Parameters
    ----------
    heights
        (rows, columns) metres, NaN where void.

    Returns
    -------
    strays
        (lowest, highest, number of cells) of each group of such values, ascending.
    """
    known = heights[np.isfinite(heights)]
    if not len(known) or known.max() - known.min() < GAP:
        return ()
    first = np.floor(known.min() / BIN)
    taken = np.flatnonzero(np.bincount((np.floor(known / BIN) - first).astype(np.int64)))
    starts = taken[np.flatnonzero(np.diff(taken, prepend=-np.inf) * BIN > GAP)]
    edges = [*((starts + first) * BIN).tolist(), np.inf]
    groups = []
    for low, high in pairwise(edges):
        own = known[(known >= low) & (known < high)]
        groups.append((float(own.min()), float(own.max()), len(own)))
    rest = max(range(len(groups)), key=lambda k: (groups[k][0] < groups[k][1], groups[k][2]))
    found = []
    for way in (range(rest - 1, -1, -1), range(rest + 1, len(groups))):
        inner = groups[rest]
        for k in way:
            if _astray(groups[k], inner, groups[rest], len(known)) or inner in found:
                found.append(groups[k])
            inner = groups[k]
    return tuple(sorted(found))


def without(heights: FloatArray, strays: Strays) -> FloatArray:
    """Return heights of which some groups of values are void; see `strays_of`."""
    left = heights.copy()
    for low, high, _ in strays:
        left[(heights >= low) & (heights <= high)] = np.nan
    return left


def _astray(
    group: tuple[float, float, int],
    inner: tuple[float, float, int],
    rest: tuple[float, float, int],
    count: int,
) -> bool:
    """Return whether a group of values is no height; `inner` lies next to it towards the rest."""
    gap = max(inner[0] - group[1], group[0] - inner[1])
    share = group[2] / count
    if group[0] == group[1] and gap > MARKER_GAP:
        return True
    below = group[1] < rest[0] and group[0] == group[1]
    if below and share < FEW_MARKS:
        return gap > max(GAP, rest[1] - rest[0])
    return share < FEW and gap > max(MARKER_GAP, 2 * (rest[1] - rest[0]))


def crs_name(crs: Any) -> str:
    """Return the name of a coordinate system."""
    from pyproj import CRS

    return str(CRS.from_user_input(crs).name)


def _span(index: FloatArray, size: int, edge: int) -> slice:
    low = int(np.clip(np.floor(index.min()) - edge, 0, size - 1))
    return slice(low, int(np.clip(np.ceil(index.max()) + edge + 1, low + 1, size)))


def _step(file: HeightFile, values: FloatArray) -> float:
    """Return the metres between heights that were rounded, 0 when they were not."""
    known = values[np.isfinite(values)]
    if file.whole:
        return file.unit
    return 1.0 if len(known) and bool((known == np.rint(known)).all()) else 0.0


def spacing(raster: Raster, frame: Frame, box: Box) -> float:
    """Return the metres between the cells of a raster in the middle of a box."""
    x, y = (box[0] + box[2]) / 2, (box[1] + box[3]) / 2
    column, row = raster.at(frame, np.array([[x - 50, y - 50], [x + 50, y + 50]]))
    cells = float(np.hypot(*np.diff([column, row], axis=1)).item())
    return float(np.hypot(100.0, 100.0)) / cells if cells > 0 else np.inf


def _joined(parts: list[Raster], frame: Frame, box: Box, edge: int) -> Raster:
    """Join rasters on the lattice of the first, over the box that all were read around."""
    first = parts[0]
    column, row = first.at(frame, grid_points(box))
    left, top = np.floor([column.min(), row.min()]).astype(int) - edge
    columns, rows = np.ceil([column.max(), row.max()]).astype(int) + edge + 1 - (left, top)
    stride = max(1, int(np.ceil(np.sqrt(rows * columns / MAX_READ))))
    j, i = left + stride * np.arange(columns // stride), top + stride * np.arange(rows // stride)
    values = np.full((len(i), len(j)), np.nan)
    for part in parts:
        open_ = np.isnan(values)
        if open_.any():
            values[open_] = _carried(part, first, i, j)[open_]
    a, b, c, d, e, f = first.to_cell
    to_cell = (
        a / stride, b / stride, (c - left) / stride, d / stride, e / stride, (f - top) / stride,
    )  # fmt: skip
    strays = tuple(one for part in parts for one in part.strays)
    return Raster(values, to_cell, first.crs, max(part.step for part in parts), strays)


def _carried(part: Raster, lattice: Raster, i: Any, j: Any) -> FloatArray:
    """Return the heights of a raster on rows and columns of another's lattice, NaN beyond it."""
    from pyproj import CRS, Transformer
    from scipy.ndimage import map_coordinates

    column, row = (axis.ravel().astype(float) for axis in np.meshgrid(j, i))
    x, y = lattice.places(column, row)
    if CRS.from_user_input(part.crs) != CRS.from_user_input(lattice.crs):
        change = Transformer.from_crs(lattice.crs, part.crs, always_xy=True)
        x, y = change.transform(x, y)
    own = np.array(part.cells(np.asarray(x), np.asarray(y)))[::-1]
    limit = np.array(part.values.shape)[:, None] - 1
    inside = ((own >= -0.5) & (own <= limit + 0.5)).all(axis=0)
    place = np.clip(own[:, inside], 0, limit)
    near = np.rint(place)
    found = np.full(len(column), np.nan)
    if (np.abs(place - near) < SAME).all():  # one lattice: values are taken as they are
        found[inside] = part.values[tuple(near.astype(int))]
    else:
        found[inside] = map_coordinates(part.values, place, order=1)
    return found.reshape(len(i), len(j))
