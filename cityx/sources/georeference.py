"""Georeferences: rasters that say where they lie are laid into a local frame."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city import Frame
from cityx.errors import InputError
from cityx.geometry.raster.grid import Grid

LARGEST = 60_000.0  # metres; a site is a city, no country
EDGE = 17  # points on each side of a raster at which its place is computed


@dataclass(frozen=True)
class Said:
    """What a raster's file, or one beside it, says of its place.

    Attributes
    ----------
    crs, transform
        Coordinate system and affine transform (a, b, c, d, e, f) from (column, row), or None; a
        transform alone places nothing, but may tell the scale.
    doubt
        What is missing for them to be of use, "" where nothing is.
    """

    crs: Any = None
    transform: tuple[float, ...] | None = None
    doubt: str = ""


def georeference_of(path: Path) -> Said:
    """Return the georeference of an image: its own, GDAL's .aux.xml, or a world file with .prj.

    A transform without a coordinate system places nothing, and is a doubt.
    """
    import rasterio
    from rasterio.errors import NotGeoreferencedWarning, RasterioError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(path) as dataset:
                crs, affine = dataset.crs, dataset.transform
                files = [Path(name).name for name in dataset.files if Path(name) != path]
    except RasterioError:  # an image that Pillow reads and GDAL does not has no georeference
        return Said()
    if affine.is_identity:
        return Said()
    crs = crs or _projection_beside(path)
    if crs:
        return Said(crs, tuple(affine)[:6])
    where = " and ".join(files) or path.name
    return Said(transform=tuple(affine)[:6], doubt=(
        f"{where} says where the pixels lie but not in which coordinate system, so it is not used; "
        f"give {path.stem}.prj or {path.name}.aux.xml with the system"
    ))  # fmt: skip


def _projection_beside(path: Path) -> Any:
    """Return the coordinate system of a .prj file of the same name, or None."""
    from rasterio.crs import CRS
    from rasterio.errors import CRSError

    beside = path.with_suffix(".prj")
    if not beside.exists():
        return None
    try:
        return CRS.from_wkt(beside.read_text(errors="replace"))
    except CRSError as error:
        raise InputError(f"{beside} is no coordinate system in WKT: {error}.") from error


def laid_on_ground(
    raster: NDArray[Any], crs: Any, transform: Sequence[float], *, void: int
) -> tuple[NDArray[Any], Grid, Frame]:
    """Lay a raster of labels north-up, with square pixels, into a frame about its middle.

    Parameters
    ----------
    raster
        (rows, columns); each new pixel takes the value of the nearest old one.
    crs
        Whatever rasterio reads.
    transform
        (a, b, c, d, e, f): x = a column + b row + c, y = d column + e row + f, from the corner.
    void
        Value beyond the raster.

    Raises
    ------
    InputError
        If the raster lies nowhere on Earth or reaches over more than a region.
    """
    from rasterio.transform import Affine
    from rasterio.warp import Resampling, reproject

    rows, columns = raster.shape
    grid, frame = ground_of((rows, columns), crs, transform)
    laid = np.full((grid.rows, grid.columns), void, raster.dtype)
    reproject(
        raster, laid, src_transform=Affine(*transform[:6]), src_crs=crs,
        dst_crs=frame.projection,
        dst_transform=Affine(grid.pixel, 0.0, grid.west, 0.0, -grid.pixel, grid.north),
        resampling=Resampling.nearest, init_dest_nodata=False,
    )  # fmt: skip
    return laid, grid, frame


def ground_of(shape: tuple[int, int], crs: Any, transform: Sequence[float]) -> tuple[Grid, Frame]:
    """Return the north-up grid, and the frame about its middle, that hold a raster.

    Parameters
    ----------
    shape
        Rows and columns of the raster.
    crs, transform
        As in `laid_on_ground`.

    Raises
    ------
    InputError
        If the raster lies nowhere on Earth or reaches over more than a region.
    """
    from rasterio.transform import Affine

    affine = Affine(*transform[:6])
    lonlat = _border(shape, affine, crs)
    middle = (lonlat.min(axis=0) + lonlat.max(axis=0)) / 2
    frame = Frame(round(float(middle[1]), 6) + 0.0, round(float(middle[0]), 6) + 0.0)
    border = frame.to_local(lonlat)
    low, high = border.min(axis=0), border.max(axis=0)
    if not np.isfinite(border).all() or (high - low).max() > LARGEST:
        raise InputError(
            f"The map reaches over {(high - low).max() / 1000:,.0f} km; a site measures at most "
            f"{LARGEST / 1000:.0f} km. Is its coordinate system ({crs}) right?"
        )
    rows, columns = shape
    outline = np.abs(np.cross(*(border[[EDGE - 1, 2 * EDGE - 2]] - border[0])))
    pixel = float(np.sqrt(outline / (rows * columns)))
    size = np.maximum(np.ceil((high - low) / pixel - 1e-6).astype(int), 1)
    return Grid(int(size[1]), int(size[0]), pixel, float(low[0]), float(high[1])), frame


def _border(shape: tuple[int, ...], affine: Any, crs: Any) -> NDArray[np.float64]:
    """Return longitude and latitude around a raster, clockwise from its north-west corner."""
    from rasterio.warp import transform as to_crs

    rows, columns = shape[:2]
    step = np.linspace(0, 1, EDGE)[:-1]
    column = np.concatenate([step, np.ones_like(step), 1 - step, np.zeros_like(step)]) * columns
    row = np.concatenate([np.zeros_like(step), step, np.ones_like(step), 1 - step]) * rows
    x = affine.a * column + affine.b * row + affine.c
    y = affine.d * column + affine.e * row + affine.f
    try:
        lon, lat = to_crs(crs, "EPSG:4326", x.tolist(), y.tolist())
    except Exception as error:  # rasterio has no common base for errors of projection
        raise InputError(f"The map's coordinate system ({crs}) is of no use: {error}.") from error
    lonlat = np.column_stack([lon, lat])
    if not np.isfinite(lonlat).all():
        raise InputError(f"The map lies nowhere on Earth by its coordinate system ({crs}).")
    return lonlat
