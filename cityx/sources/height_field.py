"""Height fields: GeoTIFF, SRTM tiles and ESRI grids become the terrain of a site."""

from __future__ import annotations

import logging
import re
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.frame import Frame
from cityx.city.terrain import Survey, Terrain
from cityx.errors import InputError

FloatArray = NDArray[np.float64]
Box = tuple[float, float, float, float]

MAX_NODES = 4_000_000  # of the terrain's grid, 32 MB
COARSE = 25.0  # metres; from this resolution on whole-metre steps show and are smoothed away
SMOOTHED = 0.5  # metres by which smoothing moves a height at most: what rounding to metres took
SMOOTHINGS = 8  # rounds; more change little
RESAMPLED = 0.1  # metres by which straight lines between nodes may miss the file's surface
FINEST, COARSEST = 1.0, 30.0  # metres between terrain nodes unless asked otherwise
SLACK = 1.5  # cells of the file that the site may reach beyond it
SURROUNDINGS = 3000.0  # metres round the site that are read for the view
SAMPLES = 50_000  # cells of the file that a survey keeps; more say nothing new
EDGE = 4  # cells read around the site, for the cubic kernel and the filter
CONTROL = 65  # nodes per side at which projections are computed; between them they are smooth
RELAX = 200  # sweeps that smooth filled voids
MIN_COVER = 0.7  # share of the site that the file must cover; beyond it the border goes on level
MAX_VOID = 0.6  # share of the site without a height that can be filled with sense
LOWEST, HIGHEST = -12_000.0, 9_000.0  # metres; other values are markers of voids
_LOG = logging.getLogger(__name__)
_TILE = re.compile(r"([NS])(\d{2})([EW])(\d{3})", re.IGNORECASE)
_TILE_SIDES = {1201 * 1201 * 2: 1201, 3601 * 3601 * 2: 3601}


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
    """

    values: FloatArray
    to_cell: tuple[float, float, float, float, float, float]
    crs: Any

    def cells(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return column and row of places."""
        a, b, c, d, e, f = self.to_cell
        return a * x + b * y + c, d * x + e * y + f

    def places(self, column: Any, row: Any) -> tuple[FloatArray, FloatArray]:
        """Return the places of columns and rows."""
        a, b, c, d, e, f = self.to_cell
        x, y = np.linalg.solve([[a, b], [d, e]], [np.subtract(column, c), np.subtract(row, f)])
        return x, y


def read_height(path: Path, frame: Frame, extent: Box, *, cell: float | None = None) -> Terrain:
    """Read the terrain of a site from a height file.

    Voids are filled from their borders. The heights are resampled by cubic splines; grids of 25 m
    and coarser in whole metres are smoothed first, each height by half a metre at most, else their
    steps would show.

    Parameters
    ----------
    path
        GeoTIFF, .hgt, .hgt.zip or .asc.
    frame, extent
        Of the site, metres.
    cell
        Metres between the nodes of the terrain; by default a third of the file's own, within 1 and
        30 m, and less where straight lines between them would miss the file by more than 0.1 m.

    Returns
    -------
    terrain
        Heights above the lowest point of the site, whose height above sea level is the datum.

    Raises
    ------
    InputError
        If the file cannot be read, does not say where it lies or does not cover the site.
    """
    path = Path(path)
    return _terrain(path, _read(path), frame, extent, cell)[0]


def survey_site(path: Path, frame: Frame, extent: Box) -> tuple[Terrain, Survey]:
    """Read the terrain of a site, and what its height file says of the site and the land round it.

    Parameters
    ----------
    path, frame, extent
        As of `read_height`.

    Returns
    -------
    terrain
        As of `read_height`.
    survey
        The same heights before any change; the land round the site is level where the file ends.

    Raises
    ------
    InputError
        As of `read_height`.
    """
    path = Path(path)
    raster = _read(path)
    terrain, bound = _terrain(path, raster, frame, extent)
    wide = (
        extent[0] - SURROUNDINGS, extent[1] - SURROUNDINGS,
        extent[2] + SURROUNDINGS, extent[3] + SURROUNDINGS,
    )  # fmt: skip
    x, y, step = _nodes(wide, COARSEST)
    column, row = _places(raster, frame, x, y)
    coarse = _resolution(raster, frame, extent) >= COARSE
    heights = _sample(raster, column, row, smooth=coarse)[0]
    around = Terrain(wide[:2], step, np.round(heights - terrain.datum, 3), terrain.datum)
    points = _cells(raster, frame, extent)
    points[:, 2] -= terrain.datum
    return terrain, Survey(np.round(points, 3), around, bound)


def _terrain(
    path: Path, raster: Raster, frame: Frame, extent: Box, cell: float | None = None
) -> tuple[Terrain, float]:
    """Return the terrain of a site, and the metres by which it misses the file at most."""
    native = _resolution(raster, frame, extent)
    wanted = cell or float(np.clip(native / 3, FINEST, COARSEST))
    x, y, step = _nodes(extent, wanted)
    column, row = _places(raster, frame, x, y)
    _check_cover(path, raster, frame, extent, column, row)
    _check_voids(path, raster, column, row)
    while True:
        heights, moved = _sample(raster, column, row, smooth=native >= COARSE)
        bend = _bend(heights)
        if cell or bend <= RESAMPLED or wanted <= FINEST or step > wanted:
            break
        wanted = max(wanted / 2, FINEST)
        x, y, step = _nodes(extent, wanted)
        column, row = _places(raster, frame, x, y)
    datum = round(float(heights.min()), 3)
    terrain = Terrain(extent[:2], step, np.round(heights - datum, 3), datum)
    return terrain, round(moved + max(bend, RESAMPLED), 3)


def _bend(heights: FloatArray) -> float:
    """Return by how much straight lines between the nodes of a grid miss a smooth surface at most.

    The middle of an arc lies an eighth of its second difference off the chord.
    """
    return sum(float(np.abs(np.diff(heights, 2, axis=k)).max(initial=0.0)) for k in (0, 1)) / 8


def _nodes(extent: Box, step: float) -> tuple[FloatArray, FloatArray, float]:
    """Return the places of the nodes of a grid over an extent, and the metres between them."""
    size = np.array([extent[2] - extent[0], extent[3] - extent[1]])
    step = max(step, float(np.sqrt(size.prod() / MAX_NODES)))
    columns, rows = (np.maximum(np.ceil(size / step), 1).astype(int) + 1).tolist()
    return extent[0] + step * np.arange(columns), extent[1] + step * np.arange(rows), step


def _places(
    raster: Raster, frame: Frame, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return column and row in the raster of the nodes of a grid, (rows, columns) each."""
    from scipy.interpolate import RectBivariateSpline

    if len(x) * len(y) <= CONTROL**2:
        return _exact_places(raster, frame, x, y)
    # Projections are smooth: computed at some nodes, interpolated between, error below a mm.
    u, v = np.linspace(x[0], x[-1], CONTROL), np.linspace(y[0], y[-1], CONTROL)
    column, row = _exact_places(raster, frame, u, v)
    return (
        RectBivariateSpline(v, u, column)(y, x),
        RectBivariateSpline(v, u, row)(y, x),
    )


def _exact_places(
    raster: Raster, frame: Frame, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray]:
    from pyproj import Transformer

    grid = np.meshgrid(x, y)
    lonlat = frame.to_geographic(np.column_stack([axis.ravel() for axis in grid]))
    change = Transformer.from_crs("EPSG:4326", raster.crs, always_xy=True)
    east, north = change.transform(lonlat[:, 0], lonlat[:, 1])
    column, row = raster.cells(np.asarray(east), np.asarray(north))
    return column.reshape(grid[0].shape), row.reshape(grid[0].shape)


def _resolution(raster: Raster, frame: Frame, extent: Box) -> float:
    """Return the metres between the cells of a raster at the site."""
    middle = np.array([(extent[0] + extent[2]) / 2, (extent[1] + extent[3]) / 2])
    column, row = _exact_places(
        raster, frame, middle[0] + np.array([-50.0, 50.0]), middle[1] + np.array([-50.0, 50.0])
    )
    cells = np.hypot(column[1, 1] - column[0, 0], row[1, 1] - row[0, 0])
    return float(np.hypot(100.0, 100.0) / cells) if np.isfinite(cells) and cells > 0 else COARSE


def _check_cover(
    path: Path, raster: Raster, frame: Frame, extent: Box, column: FloatArray, row: FloatArray
) -> None:
    rows, columns = raster.values.shape
    # Cells are areas: half a cell beyond the outer centres still belongs to the file.
    inside = (
        (column >= -SLACK) & (column <= columns - 1 + SLACK)
        & (row >= -SLACK) & (row <= rows - 1 + SLACK)
    )  # fmt: skip
    if inside.all():
        return
    if inside.mean() >= MIN_COVER:
        _LOG.warning("%s covers %.0f %% of the site; beyond it is level", path, 100 * inside.mean())
        return
    corners = [(x, y) for x in (extent[0], extent[2]) for y in (extent[1], extent[3])]
    site = _box_text(frame.to_geographic(corners))
    raise InputError(
        f"{path} does not cover the site: the file lies at {_box_text(_corners(raster))}, the site "
        f"at {site} (west, south, east, north in degrees); give a height file of the same place."
    )


def _corners(raster: Raster) -> FloatArray:
    """Return longitude and latitude of the corners of a raster."""
    from pyproj import Transformer

    rows, columns = raster.values.shape
    cells = np.array([(i, j) for i in (-0.5, columns - 0.5) for j in (-0.5, rows - 0.5)])
    change = Transformer.from_crs(raster.crs, "EPSG:4326", always_xy=True)
    return np.column_stack(change.transform(*raster.places(*cells.T)))


def _box_text(places: Any) -> str:
    low, high = np.min(places, axis=0), np.max(places, axis=0)
    return ", ".join(f"{value:.4f}" for value in (*low, *high))


def _check_voids(path: Path, raster: Raster, column: FloatArray, row: FloatArray) -> None:
    void = np.isnan(_window(raster, column, row)[0])
    if void.mean() > MAX_VOID:
        raise InputError(
            f"{path} has no heights for {void.mean():.0%} of the site; give one without such gaps."
        )


def _window(
    raster: Raster, column: FloatArray, row: FloatArray
) -> tuple[FloatArray, tuple[int, int]]:
    """Return the cells of a raster around some places, and the row and column of the first."""
    rows, columns = raster.values.shape
    top, bottom = _span(row, rows)
    left, right = _span(column, columns)
    return raster.values[top:bottom, left:right], (top, left)


def _sample(
    raster: Raster, column: FloatArray, row: FloatArray, *, smooth: bool
) -> tuple[FloatArray, float]:
    """Return heights at some places, and the metres by which smoothing moved any at most."""
    from scipy.ndimage import map_coordinates

    values, (top, left) = _window(raster, column, row)
    void = np.isnan(values)
    values = _filled(values, void)
    stepped = smooth and bool((values[~void] == np.rint(values[~void])).all())
    if stepped:
        values = _smoothed(values)
    rows, columns = values.shape
    place = [np.clip(row - top, 0, rows - 1), np.clip(column - left, 0, columns - 1)]
    heights = np.asarray(map_coordinates(values, place, order=3, mode="nearest"), float)
    return heights, SMOOTHED if stepped else 0.0


def _smoothed(values: FloatArray) -> FloatArray:
    """Even out steps and noise; no height moves by more than `SMOOTHED`."""
    from scipy.ndimage import gaussian_filter

    even = values
    for _ in range(SMOOTHINGS):
        even = gaussian_filter(even, 1.0, mode="nearest")
        even = np.clip(even, values - SMOOTHED, values + SMOOTHED)
    return even


def _cells(raster: Raster, frame: Frame, extent: Box) -> FloatArray:
    """(k, 3) cells of a raster on a site, at most `SAMPLES`, with heights above sea level."""
    from pyproj import Transformer

    x, y = np.array([extent[0], extent[2]]), np.array([extent[1], extent[3]])
    column, row = _exact_places(raster, frame, x, y)
    top, bottom = _span(row, raster.values.shape[0])
    left, right = _span(column, raster.values.shape[1])
    stride = int(np.ceil(np.sqrt((bottom - top) * (right - left) / SAMPLES)))
    i, j = (axis.ravel() for axis in np.mgrid[top:bottom:stride, left:right:stride])
    known = np.isfinite(raster.values[i, j])
    i, j = i[known], j[known]
    east, north = raster.places(j, i)
    change = Transformer.from_crs(raster.crs, "EPSG:4326", always_xy=True)
    xy: FloatArray = frame.to_local(np.column_stack(change.transform(east, north)))
    low, high = np.array(extent[:2]), np.array(extent[2:])
    inside = ((xy >= low) & (xy <= high)).all(axis=1)
    return np.asarray(np.column_stack([xy, raster.values[i, j]])[inside])


def _span(index: FloatArray, size: int) -> tuple[int, int]:
    low = int(np.clip(np.floor(index.min()) - EDGE, 0, size - 1))
    return low, int(np.clip(np.ceil(index.max()) + EDGE + 1, low + 1, size))


def _filled(values: FloatArray, void: NDArray[np.bool_]) -> FloatArray:
    """Fill voids with the nearest heights, then relax them to a smooth surface."""
    if not void.any():
        return values
    from scipy.ndimage import distance_transform_edt

    nearest = distance_transform_edt(void, return_distances=False, return_indices=True)
    filled = np.asarray(values[tuple(nearest)])
    for _ in range(RELAX):
        around = np.pad(filled, 1, mode="edge")
        mean = (around[:-2, 1:-1] + around[2:, 1:-1] + around[1:-1, :-2] + around[1:-1, 2:]) / 4
        filled = np.where(void, mean, filled)
    return filled


def _read(path: Path) -> Raster:
    name = path.name.lower()
    if not path.is_file():
        raise InputError(f"{path} does not exist.")
    if name.endswith((".hgt", ".hgt.zip")):
        return _read_tile(path)
    if name.endswith(".asc"):
        return _read_grid(path)
    return _read_geotiff(path)


def _cleaned(values: Any, nodata: float | None) -> FloatArray:
    heights = np.asarray(values, dtype=float).copy()
    if nodata is not None:
        heights[heights == nodata] = np.nan
    heights[~((heights > LOWEST) & (heights < HIGHEST))] = np.nan
    return heights


def _read_geotiff(path: Path) -> Raster:
    import rasterio
    from rasterio.errors import RasterioError

    try:
        with rasterio.open(path) as dataset:
            if dataset.count > 2:
                raise InputError(
                    f"{path} is an image of {dataset.count} bands; a height file has one."
                )
            crs = dataset.crs
            inverse = ~dataset.transform
            values = _cleaned(dataset.read(1), dataset.nodata)
    except RasterioError as error:
        raise InputError(
            f"{path} is no height file that can be read ({str(error).rstrip('.')})."
        ) from error
    coefficients = (
        inverse.a, inverse.b, inverse.c - 0.5, inverse.d, inverse.e, inverse.f - 0.5,
    )  # fmt: skip
    raster = Raster(values, coefficients, crs.to_wkt() if crs else None)
    return raster if crs else _placed(path, raster)


def _read_tile(path: Path) -> Raster:
    """Read an SRTM tile: big-endian 16-bit metres on the nodes of a degree square."""
    name, content = path.name, b""
    if zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as archive:
            inside = [item for item in archive.infolist() if item.filename.lower().endswith(".hgt")]
            if not inside or inside[0].file_size not in _TILE_SIDES:
                raise InputError(f"{path} holds no SRTM tile (.hgt of 1201 or 3601 lines).")
            name = inside[0].filename if _TILE.search(inside[0].filename) else name
            try:
                content = archive.read(inside[0])
            except (zipfile.BadZipFile, OSError, EOFError, RuntimeError) as error:
                raise InputError(f"{path} cannot be unpacked: {error}.") from error
    else:
        content = path.read_bytes()
    side = _TILE_SIDES.get(len(content))
    if side is None:
        raise InputError(
            f"{path} has {len(content):,} bytes; an SRTM tile has {min(_TILE_SIDES):,} or "
            f"{max(_TILE_SIDES):,}."
        )
    corner = _TILE.search(name)
    if corner is None:
        raise InputError(
            f"{path} does not say where it lies; an SRTM tile is named for its south-west corner, "
            "such as N52E013.hgt."
        )
    south = int(corner[2]) * (1 if corner[1].upper() == "N" else -1)
    west = int(corner[4]) * (1 if corner[3].upper() == "E" else -1)
    values = _cleaned(np.frombuffer(content, ">i2").reshape(side, side), -32768.0)
    scale = float(side - 1)
    coefficients = (scale, 0.0, -west * scale, 0.0, -scale, (south + 1) * scale)
    return Raster(values, coefficients, "EPSG:4326")


def _read_grid(path: Path) -> Raster:
    """Read an ESRI grid: a header of words, then rows from north to south."""
    words = path.read_text(encoding="ascii", errors="replace").split()
    header: dict[str, float] = {}
    start = 0
    try:
        while (
            start + 1 < len(words) and words[start][0].isalpha() and words[start].lower() != "nan"
        ):
            header[words[start].lower()] = float(words[start + 1])
            start += 2
        columns, rows = int(header["ncols"]), int(header["nrows"])
        cell = header["cellsize"]
        half = 0.0 if "xllcenter" in header else cell / 2
        west = header.get("xllcorner", header.get("xllcenter", np.nan)) + half
        south = header.get("yllcorner", header.get("yllcenter", np.nan)) + half
        values = np.array(words[start:], dtype=float).reshape(rows, columns)
    except (KeyError, ValueError, OverflowError) as error:
        raise InputError(
            f"{path} is no ESRI grid: it needs ncols, nrows, xllcorner, yllcorner, cellsize and "
            f"nrows times ncols numbers ({error})."
        ) from error
    if not (cell > 0 and np.isfinite([west, south]).all()):
        raise InputError(f"{path} does not say where it lies: xllcorner or yllcorner is missing.")
    coefficients = (1 / cell, 0.0, -west / cell, 0.0, -1 / cell, south / cell + rows - 1)
    cleaned = _cleaned(values, header.get("nodata_value"))
    return _placed(path, Raster(cleaned, coefficients, None))


def _placed(path: Path, raster: Raster) -> Raster:
    """Find the coordinate system of a file that does not name one: a .prj beside it, or degrees."""
    beside = path.with_suffix(".prj")
    if beside.is_file():
        from pyproj import CRS
        from pyproj.exceptions import CRSError

        try:
            crs = CRS.from_user_input(beside.read_text(errors="replace").strip())
        except CRSError as error:
            raise InputError(f"{beside} names no coordinate system: {error}.") from error
        return Raster(raster.values, raster.to_cell, crs)
    rows, columns = raster.values.shape
    a, _, c, _, e, f = raster.to_cell
    west, east = sorted((-c / a, (columns - 1 - c) / a))
    south, north = sorted((-f / e, (rows - 1 - f) / e))
    fine = 1 / abs(a) < 0.1
    if -180 <= west < east <= 180 and -90 <= south < north <= 90 and fine:
        return Raster(raster.values, raster.to_cell, "EPSG:4326")
    raise InputError(
        f"{path} does not say in which coordinate system it lies (x {west:.0f} to {east:.0f}, "
        f"y {south:.0f} to {north:.0f}); put its .prj file beside it or give a GeoTIFF."
    )
