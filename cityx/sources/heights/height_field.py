"""Height fields: the terrain of a site from the height files of its place."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from cityx.city.frame import Frame
from cityx.city.sites import MARGIN, Box
from cityx.city.terrain import Survey, Terrain
from cityx.errors import InputError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.sources.heights.height_files import HeightFile, HeightOptions
from cityx.sources.heights.height_mosaic import (
    Paths,
    Raster,
    corners,
    crs_name,
    grid_points,
    laid,
    open_heights,
    raster_of,
    spacing,
)

MAX_NODES = 4_000_000  # of the terrain's grid, 32 MB
SMOOTHED = 0.5  # of a step of rounded heights: what rounding took, and smoothing moves at most
FINE_STEP = 0.05  # metres; smaller steps do not show
SMOOTHINGS = 8  # rounds over neighbouring cells; more change little
# Cells read beyond a site for the filter: what lies farther off moves no height by a millimetre.
FILTERED = 96
WIDEST = 32.0  # cells over which long terraces are evened out at most
RESAMPLED = 0.1  # metres by which straight lines between nodes may miss the file's surface
UNSEEN = 3.0  # times the second difference of its nodes that a cubic spline curves at most
FINEST, COARSEST = 1.0, 32.0  # metres between terrain nodes unless asked otherwise, powers of 2
SLACK = 1.5  # cells of the file that the site may reach beyond it
SURROUNDINGS = 3000.0  # metres round the site that are read for the view
SAMPLES = 50_000  # cells of the file that a survey keeps; more say nothing new
CONTROL = 16  # cells between nodes at which projections are computed; they bend by 5 mm at most
RELAX = 200  # sweeps that smooth filled voids
MIN_COVER = 0.7  # share of the site that the file must cover; beyond it the border goes on level
MAX_VOID = 0.6  # share of the site without a height that can be filled with sense
MOST_OF_LAND = 1_000_000  # nodes of the land that a town is laid on
MIDDLE = 3000.0  # metres of the middle of a map that say how fine the grid of its windows is
SEEN = 4_000_000  # cells of a file that are looked at for voids; of a larger one means of blocks
TOLD = 0.05  # share of the cells of a file that are void, from which it is said
_LOG = logging.getLogger(__name__)


def read_height(
    paths: Paths,
    frame: Frame,
    extent: Box,
    *,
    cell: float | None = None,
    datum: float | None = None,
    options: HeightOptions | None = None,
) -> Terrain:
    """Read the terrain of a site from one height file or from several that lie side by side.

    Voids are filled from their borders. The heights are resampled by cubic splines; heights that
    are whole numbers of some unit are smoothed first, each by half of it at most, else their steps
    would show.

    Parameters
    ----------
    paths
        One file or several; see `cityx.sources.heights.height_files.FORMS`.
    frame, extent
        Of the site, metres.
    cell
        Metres between the nodes of the terrain, which lie at multiples of it; by default the power
        of two below a third of the file's own, within 1 and 32 m, and less where straight lines
        between them would miss the file by more than 0.1 m.
    datum
        Metres above sea level that heights are counted from; those of the lowest point of the site
        by default. Windows that are to agree share it and the cell.
    options
        What the files do not say themselves.

    Returns
    -------
    terrain
        Heights above the datum.

    Raises
    ------
    InputError
        If a file cannot be read, does not say where it lies or the site is not covered.
    UsageError
        If the numbers of a file are no metres and the options do not say what they mean.
    """
    files = [laid(file, frame, extent, options) for file in open_heights(paths, options)]
    return _terrain(files, raster_of(files, frame, extent), frame, extent, cell, datum)[0]


def survey_site(
    paths: Paths, frame: Frame, extent: Box, *, options: HeightOptions | None = None
) -> tuple[Terrain, Survey]:
    """Read the terrain of a site, and what its height files say of it and of the land round it.

    Parameters
    ----------
    paths, frame, extent, options
        As of `read_height`.

    Returns
    -------
    terrain
        As of `read_height`.
    survey
        The same heights before any change; the land round the site is level where the files end.

    Raises
    ------
    InputError, UsageError
        As of `read_height`.
    """
    files = [laid(file, frame, extent, options) for file in open_heights(paths, options)]
    return survey_files(files, frame, extent)


def survey_files(
    files: list[HeightFile],
    frame: Frame,
    extent: Box,
    out: Any = None,
    *,
    cell: float | None = None,
    datum: float | None = None,
) -> tuple[Terrain, Survey]:
    """Do as `survey_site` with files that are open and say where they lie.

    Parameters
    ----------
    out
        A shape of the site that needs no heights, such as the sea, or None.
    cell, datum
        As of `read_height`.
    """
    raster = raster_of(files, frame, extent)
    terrain, bound = _terrain(files, raster, frame, extent, cell, datum, out)
    wide = (
        extent[0] - SURROUNDINGS, extent[1] - SURROUNDINGS,
        extent[2] + SURROUNDINGS, extent[3] + SURROUNDINGS,
    )  # fmt: skip
    x, y, step = _nodes(wide, COARSEST)
    land = raster_of(files, frame, wide)
    heights = _sample(land, *_places(land, frame, x, y))[0]
    around = _above(terrain.datum, x, y, step, heights)
    points = _cells(raster, frame, extent)
    points[:, 2] -= terrain.datum
    return terrain, Survey(np.round(points, 3), around, bound)


@dataclass(frozen=True)
class HeightGrid:
    """What the windows of one map share, so that each has the same height at the same place.

    Attributes
    ----------
    cell
        Metres between the nodes, which lie at multiples of it: a power of two.
    datum
        Metres above sea level that heights are counted from.
    terrace
        Cells over which rounded heights are evened out, as of the middle of the map.
    """

    cell: float
    datum: float
    terrace: float


def grid_of(files: list[HeightFile], frame: Frame, site: Box) -> HeightGrid:
    """Return what all windows of a site share: the cell of a city in its middle, a datum.

    Raises
    ------
    InputError
        If the files do not cover the site.
    """
    _check_cover(files, frame, site)
    whole = raster_of(files, frame, site)
    _check_voids(files, np.isnan(whole.values))
    lowest = float(np.floor(np.nanmin(whole.values))) + 0.0
    x, y = (site[0] + site[2]) / 2, (site[1] + site[3]) / 2
    wide, deep = (min(MIDDLE, site[k + 2] - site[k]) / 2 for k in (0, 1))
    middle = (x - wide, y - deep, x + wide, y + deep)
    raster = raster_of(files, frame, middle, edge=FILTERED)
    if np.isnan(raster.values).all():
        raise InputError(f"{_names(files)} has no heights in the middle of the site.")
    terrain, _ = _terrain(files, raster, frame, middle)
    return HeightGrid(terrain.cell, lowest, _terrace(filled_voids(raster.values)))


def terrain_on(files: list[HeightFile], frame: Frame, box: Box, grid: HeightGrid) -> Terrain:
    """Return the terrain of a window on the grid of its map; where nothing is known, at the datum.

    Parameters
    ----------
    box
        Of the nodes, metres; a block of the plane, so that windows that share a node share what
        decides it.
    """
    raster = raster_of(files, frame, box, edge=FILTERED)
    x, y, step = _nodes(box, grid.cell)
    if np.isnan(raster.values).all():
        heights = np.full((len(y), len(x)), grid.datum)
    else:
        heights, _ = _sample(raster, *_places(raster, frame, x, y), terrace=grid.terrace)
    return _above(grid.datum, x, y, step, heights)


def land_of(raster: Raster, frame: Frame, box: Box) -> Terrain:
    """Return the heights of a raster over a box as a terrain of few nodes, its voids filled."""
    known = replace(raster, values=filled_voids(raster.values, rounds=0))
    area = (box[2] - box[0]) * (box[3] - box[1])
    step = max(spacing(raster, frame, box) / 3, FINEST, float(np.sqrt(area / MOST_OF_LAND)))
    x, y, step = _nodes(box, step)
    heights = _sample(known, *_places(known, frame, x, y))[0]
    return _above(0.0, x, y, step, heights)


def void_notes(
    files: list[HeightFile], frame: Frame, extent: Box, out: Any = None
) -> tuple[str, ...]:
    """Say what has no height on a site, and which values of the files count as none.

    Parameters
    ----------
    files, frame, extent, out
        As of `survey_files`.
    """
    raster = raster_of(files, frame, extent)
    notes = []
    for low, high, count in raster.strays:
        value = f"{low:g}" if low == high else f"{low:g} to {high:g}"
        notes.append(
            f"heights: {count:,} cells of {value} m lie far outside the rest; they count as void"
        )
    void = int(_voids(raster, frame, out).sum())
    if void:
        share = void / raster.values.size
        notes.append(
            f"heights: {void:,} cells ({share:.1%}) on and beside the site are void; they are "
            "filled from their borders"
        )
    return (*notes, *(note for file in files for note in _whole_notes(file)))


def _whole_notes(file: HeightFile) -> tuple[str, ...]:
    """Say how much of a file is void, wherever the site lies in it."""
    stride = max(1, int(np.ceil(np.sqrt(file.shape[0] * file.shape[1] / SEEN))))
    share = float(np.isnan(file.read(stride=stride)).mean())
    if share < TOLD:
        return ()
    return (f"heights: {share:.0%} of all cells of {file.path.name} are void",)


def _voids(raster: Raster, frame: Frame, out: Any) -> BoolArray:
    """Return the cells of a raster that are void, but for those in a shape that needs none."""
    void = np.isnan(raster.values)
    if out is None or out.is_empty or not void.any():
        return void
    from pyproj import Transformer

    row, column = np.nonzero(void)
    change = Transformer.from_crs(raster.crs, frame.projection, always_xy=True)
    x, y = change.transform(*raster.places(column, row))
    # Beyond the site nothing is known of its shape: what goes on there is of it.
    low_x, low_y, high_x, high_y = out.bounds
    shapely.prepare(out)
    inside = shapely.contains_xy(out, np.clip(x, low_x, high_x), np.clip(y, low_y, high_y))
    void[row[inside], column[inside]] = False
    return void


def _terrain(
    files: list[HeightFile], raster: Raster, frame: Frame, extent: Box, cell: float | None = None,
    datum: float | None = None, out: Any = None,
) -> tuple[Terrain, float]:  # fmt: skip
    """Return the terrain of a site, and the metres by which it misses the files at most."""
    _check_cover(files, frame, extent)
    _check_voids(files, _voids(raster, frame, out))
    raster = raster_of(files, frame, extent, edge=FILTERED)
    third = float(np.clip(spacing(raster, frame, extent) / 3, FINEST, COARSEST))
    wanted = cell or 2.0 ** np.floor(np.log2(third))
    while True:
        x, y, step = _nodes(extent, wanted)
        heights, moved = _sample(raster, *_places(raster, frame, x, y))
        bend = _bend(heights)
        if cell or bend <= RESAMPLED or wanted <= FINEST or step > wanted:
            break
        wanted = max(wanted / 2, FINEST)
    datum = round(float(heights.min()), 3) if datum is None else datum
    terrain = _above(datum, x, y, step, heights)
    return terrain, round(moved + max(UNSEEN * bend, RESAMPLED), 3)


def _above(datum: float, x: FloatArray, y: FloatArray, step: float, heights: FloatArray) -> Terrain:
    """Count heights above sea level from a datum; rounded before, they are the same from any."""
    return Terrain(
        (float(x[0]), float(y[0])), step, np.round(np.round(heights, 3) - datum, 3), datum
    )


def _bend(heights: FloatArray) -> float:
    """Return by how much straight lines between the nodes of a grid miss a smooth surface at most.

    The middle of an arc lies an eighth of its second difference off the chord.
    """
    return sum(float(np.abs(np.diff(heights, 2, axis=k)).max(initial=0.0)) for k in (0, 1)) / 8


def _nodes(extent: Box, step: float) -> tuple[FloatArray, FloatArray, float]:
    """Return the places of the nodes of a grid over an extent, and the metres between them.

    They are multiples of these metres, so that grids of other extents have them as well.
    """
    size = np.array([extent[2] - extent[0], extent[3] - extent[1]])
    while size.prod() > MAX_NODES * step**2:
        step *= 2
    first = np.floor(np.array(extent[:2]) / step).astype(int)
    last = np.maximum(np.ceil(np.array(extent[2:]) / step).astype(int), first + 1)
    x, y = (step * np.arange(low, high + 1) for low, high in zip(first, last, strict=True))
    return x, y, step


def _places(
    raster: Raster, frame: Frame, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return column and row in the raster of the nodes of a grid, (rows, columns) each."""
    # Projections are smooth: computed at some nodes of the plane, straight between them.
    (u, i, du), (v, j, dv) = (_control(axis) for axis in (x, y))
    found = []
    for exact in _exact_places(raster, frame, u, v):
        along = exact[:, i] * (1 - du) + exact[:, i + 1] * du  # (controls, columns)
        found.append(along[j] * (1 - dv)[:, None] + along[j + 1] * dv[:, None])
    return found[0], found[1]


def _control(places: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
    """Return places around those of a grid, which of them lies before each, and the share beyond.

    They are multiples of their distance, wherever the grid begins.
    """
    wide = CONTROL * float(places[1] - places[0])
    at = np.floor(places / wide).astype(np.int64)
    control = wide * np.arange(at[0], at[-1] + 2)
    return control, at - at[0], places / wide - at


def _exact_places(
    raster: Raster, frame: Frame, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray]:
    grid = np.meshgrid(x, y)
    column, row = raster.at(frame, np.column_stack([axis.ravel() for axis in grid]))
    return column.reshape(grid[0].shape), row.reshape(grid[0].shape)


def _check_cover(files: list[HeightFile], frame: Frame, extent: Box) -> None:
    width, depth = extent[2] - extent[0], extent[3] - extent[1]
    edge = min(MARGIN, width / 4, depth / 4)  # the site grew by so much round its houses
    spots = grid_points((extent[0] + edge, extent[1] + edge, extent[2] - edge, extent[3] - edge))
    inside = np.zeros(len(spots), bool)
    for file in files:
        assert file.to_cell is not None
        column, row = Raster(np.zeros((0, 0)), file.to_cell, file.crs).at(frame, spots)
        rows, columns = file.shape
        # Cells are areas: half a cell beyond the outer centres still belongs to the file.
        inside |= (
            (column >= -SLACK) & (column <= columns - 1 + SLACK)
            & (row >= -SLACK) & (row <= rows - 1 + SLACK)
        )  # fmt: skip
    if inside.all():
        return
    names = _names(files)
    if inside.mean() >= MIN_COVER:
        _LOG.warning(
            "%s covers %.0f %% of the site; beyond it is level", names, 100 * inside.mean()
        )
        return
    lies = ", ".join(_place(file) for file in files)
    site = _box_text(frame.to_geographic(spots))
    raise InputError(
        f"{names} does not cover the site: the file lies at {lies}, the site at {site} (west, "
        "south, east, north in degrees); give a height file of the same place."
    )


def _names(files: list[HeightFile]) -> str:
    return ", ".join(str(file.path) for file in files)


def _place(file: HeightFile) -> str:
    lonlat = corners(file)
    if not np.isfinite(lonlat).all() or (np.abs(lonlat) > (360.0, 90.0)).any():
        return f"no place on Earth by its coordinate system ({crs_name(file.crs)})"
    return _box_text(lonlat)


def _box_text(places: Any) -> str:
    low, high = np.min(places, axis=0), np.max(places, axis=0)
    return ", ".join(f"{value:.4f}" for value in (*low, *high))


def _check_voids(files: list[HeightFile], void: BoolArray) -> None:
    if void.mean() > MAX_VOID:
        raise InputError(
            f"{_names(files)} has no heights for {void.mean():.0%} of the site; give one without "
            "such gaps."
        )


def _sample(
    raster: Raster, column: FloatArray, row: FloatArray, *, terrace: float | None = None
) -> tuple[FloatArray, float]:
    """Return heights at some places, and the metres by which smoothing moved any at most."""
    from scipy.ndimage import map_coordinates

    values = filled_voids(raster.values)
    stepped = raster.step >= FINE_STEP
    if stepped:
        wide = _terrace(values) if terrace is None else terrace
        values = _smoothed(values, SMOOTHED * raster.step, wide)
    rows, columns = values.shape
    place = [np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]
    heights = np.asarray(map_coordinates(values, place, order=3, mode="nearest"), float)
    return heights, SMOOTHED * raster.step if stepped else 0.0


def _smoothed(values: FloatArray, most: float, terrace: float) -> FloatArray:
    """Even out steps and noise; no height moves by more than `most` metres."""
    from scipy.ndimage import gaussian_filter

    # A terrace of k cells wants a filter of its own width first, then of half of it, ...
    wide = min(terrace, WIDEST)
    widths = [2.0**k for k in range(int(np.log2(wide)), 0, -1)] if wide >= 2 else []
    even = values
    for width in [*widths, *([1.0] * SMOOTHINGS)]:
        even = gaussian_filter(even, width, mode="nearest")
        even = np.clip(even, values - most, values + most)
    return even


def _terrace(values: FloatArray) -> float:
    """Return how many cells of one height follow each other on average."""
    changes = sum(int((np.diff(values, axis=k) != 0).sum()) for k in (0, 1))
    return 2 * values.size / max(changes, 1)


def _cells(raster: Raster, frame: Frame, extent: Box) -> FloatArray:
    """(k, 3) cells of a raster on a site, at most `SAMPLES`, with heights above sea level."""
    from pyproj import Transformer

    stride = int(np.ceil(np.sqrt(raster.values.size / SAMPLES)))
    rows, columns = raster.values.shape
    i, j = (axis.ravel() for axis in np.mgrid[0:rows:stride, 0:columns:stride])
    known = np.isfinite(raster.values[i, j])
    i, j = i[known], j[known]
    east, north = raster.places(j, i)
    change = Transformer.from_crs(raster.crs, frame.projection, always_xy=True)
    xy: FloatArray = np.round(np.column_stack(change.transform(east, north)), 4)
    low, high = np.array(extent[:2]), np.array(extent[2:])
    inside = ((xy >= low) & (xy <= high)).all(axis=1)
    return np.asarray(np.column_stack([xy, raster.values[i, j]])[inside])


def filled_voids(values: FloatArray, rounds: int = RELAX) -> FloatArray:
    """Fill voids with the nearest heights, then relax them to a smooth surface."""
    from scipy.ndimage import distance_transform_edt

    void = np.isnan(values)
    if not void.any():
        return values
    nearest = distance_transform_edt(void, return_distances=False, return_indices=True)
    filled = np.asarray(values[tuple(nearest)])
    for _ in range(rounds):
        around = np.pad(filled, 1, mode="edge")
        mean = (around[:-2, 1:-1] + around[2:, 1:-1] + around[1:-1, :-2] + around[1:-1, 2:]) / 4
        filled = np.where(void, mean, filled)
    return filled
