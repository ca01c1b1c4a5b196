"""Height files: every form becomes a grid of metres, read in windows."""

from __future__ import annotations

import re
import warnings
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cityx.errors import InputError, UsageError
from cityx.geometry.arrays import FloatArray

Cells = tuple[slice, slice]

FORMS = "GeoTIFF or TIFF (.tif), SRTM tile (.hgt, .hgt.zip), ESRI grid (.asc), 16-bit PNG, .npy"
LOWEST, HIGHEST = -12_000.0, 9_000.0  # metres; other values are markers of voids
MAX_CELLS = 100_000_000  # of a file that cannot be read in windows, 800 MB
MAX_READ = 25_000_000  # cells held at once; a larger window is read as means of blocks
NORMAL = 1.0  # values from 0 to 1 are shares of a range, not metres
FINE_DEGREES = 0.1  # a grid whose cells are smaller, within the numbers of degrees, is in degrees
SRTM_VOID = -32768
SRTM_DATUM = "EGM96 (that of SRTM)"
_FEET = {"ft": 0.3048, "foot": 0.3048, "feet": 0.3048, "us-ft": 1200 / 3937,
         "us survey foot": 1200 / 3937, "ftus": 1200 / 3937}  # fmt: skip
_TILE = re.compile(r"([NS])(\d{2})([EW])(\d{3})", re.IGNORECASE)
_TILE_SIDES = {1201 * 1201 * 2: 1201, 3601 * 3601 * 2: 3601}


@dataclass(frozen=True)
class HeightOptions:
    """What a caller says about height files that do not say it themselves.

    Attributes
    ----------
    span
        (low, high): metres that the lowest and the highest value of a file mean, or None.
    pixel
        Metres of a cell of files without a georeference, or None to fit them to the site.
    crs
        Coordinate system of files that name none, anything pyproj reads, or "".
    """

    span: tuple[float, float] | None = None
    pixel: float | None = None
    crs: str = ""

    def __post_init__(self) -> None:
        """Refuse what means nothing."""
        faults = []
        if self.span is not None and not (LOWEST < self.span[0] < self.span[1] < HIGHEST):
            faults.append(
                f"--height-range {self.span[0]:g},{self.span[1]:g}: give the lowest and the "
                f"highest height in metres, such as 0,120."
            )
        if self.pixel is not None and not 0 < self.pixel < np.inf:
            faults.append(f"--pixel {self.pixel:g}: a cell of heights has more than 0 m.")
        if faults:
            raise UsageError(" ".join(faults))


@dataclass(frozen=True)
class HeightFile:
    """A height file that was opened; its cells are read when asked for.

    Attributes
    ----------
    shape
        (rows, columns); row 0 is the first of the file.
    to_cell
        Affine coefficients (a, b, c, d, e, f): column = a x + b y + c, row = d x + e y + f, counted
        from the centre of the first cell. None when the file does not say where it lies.
    crs
        Whatever pyproj reads, or None when the file does not name it.
    load
        Returns the numbers of some cells as they stand in the file, at a stride (rows, columns) of
        which blocks are averaged, NaN where void.
    whole
        Whether the numbers are integers.
    unit, zero
        Metres per number, and of number 0.
    datum
        Name of the vertical datum, "" when unknown.
    """

    path: Path
    shape: tuple[int, int]
    to_cell: tuple[float, float, float, float, float, float] | None
    crs: Any
    load: Callable[[Cells, int], FloatArray]
    whole: bool
    unit: float = 1.0
    zero: float = 0.0
    datum: str = ""

    @property
    def located(self) -> bool:
        """Whether the file says where on Earth it lies."""
        return self.crs is not None and self.to_cell is not None

    def read(self, cells: Cells | None = None, stride: int = 1) -> FloatArray:
        """Return metres of some cells, NaN where void.

        Parameters
        ----------
        cells
            Rows and columns, each a slice with start and stop; all by default.
        stride
            Cells of a side of the blocks whose mean is returned.
        """
        rows, columns = self.shape
        heights = self.load(cells or (slice(0, rows), slice(0, columns)), stride)
        heights = heights * self.unit + self.zero
        heights[~((heights > LOWEST) & (heights < HIGHEST))] = np.nan
        return heights


def open_height(path: Path, options: HeightOptions | None = None) -> HeightFile:
    """Open a height file of any form.

    Parameters
    ----------
    path
        GeoTIFF or plain TIFF, SRTM tile, ESRI grid, PNG or .npy array.
    options
        What the file does not say itself.

    Raises
    ------
    InputError
        If the file is no height file or larger than can be read.
    UsageError
        If its numbers are no metres and the caller does not say what they mean.
    """
    path, options = Path(path), options or HeightOptions()
    if not path.is_file():
        raise InputError(f"{path} does not exist.")
    name = path.name.lower()
    opener = next((open_ for ends, open_ in _OPENERS.items() if name.endswith(ends)), _open_image)
    file = opener(path)
    if min(file.shape) < 2:
        raise InputError(
            f"{path} has {file.shape[1]} x {file.shape[0]} cells; heights need 2 x 2 at least."
        )
    return _measured(_referenced(file, options), options)


def _referenced(file: HeightFile, options: HeightOptions) -> HeightFile:
    """Find the coordinate system of a file that does not name one."""
    if file.crs is not None:
        return file
    beside = file.path.with_suffix(".prj")
    if file.to_cell is not None and beside.is_file():
        text = beside.read_text(errors="replace").strip()
        return replace(file, crs=_crs(text, f"{beside} names no coordinate system"))
    if file.to_cell is not None and options.crs:
        return replace(file, crs=_crs(options.crs, "--height-crs is no coordinate system"))
    return replace(file, crs="EPSG:4326") if _in_degrees(file) else file


def _crs(text: str, fault: str) -> Any:
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        return CRS.from_user_input(text)
    except CRSError as error:
        raise InputError(f"{fault}: {error}.") from error


def _in_degrees(file: HeightFile) -> bool:
    if file.to_cell is None:
        return False
    rows, columns = file.shape
    a, _, c, _, e, f = file.to_cell
    if a == 0 or e == 0:
        return False
    west, east = sorted((-c / a, (columns - 1 - c) / a))
    south, north = sorted((-f / e, (rows - 1 - f) / e))
    return -180 <= west < east <= 180 and -90 <= south < north <= 90 and 1 / abs(a) < FINE_DEGREES


def _measured(file: HeightFile, options: HeightOptions) -> HeightFile:
    """Return how many metres one unit of a file's numbers is."""
    if options.span is None and (file.located or file.to_cell is not None):
        return file
    low, high = _reach(file)
    if not np.isfinite([low, high]).all():
        raise InputError(f"{file.path} holds no height: every cell is void.")
    if options.span is None:
        if file.whole or (low >= 0 and high <= NORMAL):
            kind = "whole numbers" if file.whole else "numbers"
            raise UsageError(
                f"{file.path} holds {kind} from {low:g} to {high:g} that are no metres; say what "
                "the lowest and the highest mean with --height-range LOW,HIGH (metres)."
            )
        return file
    if high == low:
        return replace(file, unit=1.0, zero=options.span[0] - low)
    unit = (options.span[1] - options.span[0]) / (high - low)
    return replace(file, unit=unit, zero=options.span[0] - unit * low)


def _reach(file: HeightFile) -> tuple[float, float]:
    """Return the lowest and the highest number of a file, read in strips."""
    rows, columns = file.shape
    strip = max(1, MAX_READ // columns)
    low, high = np.inf, -np.inf
    for first in range(0, rows, strip):
        numbers = file.load((slice(first, min(first + strip, rows)), slice(0, columns)), 1)
        known = numbers[np.isfinite(numbers)]
        low, high = min(low, known.min(initial=np.inf)), max(high, known.max(initial=-np.inf))
    return float(low), float(high)


def _held(numbers: FloatArray) -> Callable[[Cells, int], FloatArray]:
    """Return the reader of numbers that lie in memory or in a mapped file."""

    def load(cells: Cells, stride: int) -> FloatArray:
        return _block_means(np.array(numbers[cells], dtype=float), stride)

    return load


def _block_means(numbers: FloatArray, stride: int) -> FloatArray:
    """Average whole blocks; those at the end of the window are dropped when cut."""
    if stride == 1:
        return numbers
    rows, columns = (max(size // stride, 1) for size in numbers.shape)
    whole = numbers[: rows * stride, : columns * stride]
    if whole.shape != (rows * stride, columns * stride):
        return numbers[::stride, ::stride]
    return np.asarray(whole.reshape(rows, stride, columns, stride).mean(axis=(1, 3)))


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Open a raster; a file that is none is named in the caller's words."""
    import rasterio
    from rasterio.errors import NotGeoreferencedWarning, RasterioError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(path) as dataset:
                yield dataset
    except (RasterioError, ValueError) as error:
        raise InputError(
            f"{path} is no height file that can be read ({str(error).rstrip('.')})."
        ) from error


def _open_image(path: Path) -> HeightFile:
    """Open a TIFF, a PNG or what else is a raster."""
    with _opened(path) as dataset:
        if dataset.count > 2:
            raise InputError(
                f"{path} is an image of {dataset.count} bands; a height file has one. Give an "
                "image of a place as a semantic map or a satellite image."
            )
        dtype, inverse = np.dtype(dataset.dtypes[0]), None
        if dtype.kind not in "iuf":
            raise InputError(f"{path} holds {dtype} numbers; heights are integers or floats.")
        if not dataset.transform.is_identity:
            inverse = ~dataset.transform
        if inverse is None and dataset.width * dataset.height > MAX_CELLS:
            raise InputError(_too_large(path, dataset.height, dataset.width))
        crs = dataset.crs.to_wkt() if dataset.crs else None
        unit = (dataset.units[0] or "").strip().lower() if dataset.units else ""
        scale, offset = dataset.scales[0], dataset.offsets[0]
        shape = (dataset.height, dataset.width)
    datum, metres = _vertical(crs)
    metres = _FEET.get(unit, metres)
    return HeightFile(
        path,
        shape,
        None if inverse is None else (
            inverse.a, inverse.b, inverse.c - 0.5, inverse.d, inverse.e, inverse.f - 0.5,
        ),
        crs if inverse is not None else None,
        lambda cells, stride: _load_image(path, cells, stride),
        whole=dtype.kind in "iu",
        unit=scale * metres,
        zero=offset * metres,
        datum=datum,
    )  # fmt: skip


def _load_image(path: Path, cells: Cells, stride: int) -> FloatArray:
    from rasterio.enums import Resampling
    from rasterio.windows import Window

    (rows, columns) = cells
    size = (rows.stop - rows.start, columns.stop - columns.start)
    # Whole blocks, so that what is read lies where it is said to lie.
    out = tuple(max(length // stride, 1) for length in size)
    window = Window(columns.start, rows.start, *(out[k] * min(stride, size[k]) for k in (1, 0)))
    with _opened(path) as dataset:
        read = dataset.read(
            1, window=window, out_shape=out, masked=True, out_dtype=float,
            resampling=Resampling.average if stride > 1 else Resampling.nearest,
        )  # fmt: skip
    return np.asarray(read.filled(np.nan))


def _vertical(crs: Any) -> tuple[str, float]:
    """Return the name of the vertical part of a coordinate system and its unit in metres."""
    from pyproj import CRS

    if crs is None:
        return "", 1.0
    for part in CRS.from_user_input(crs).sub_crs_list:
        if part.is_vertical:
            return part.name, float(part.axis_info[0].unit_conversion_factor)
    return "", 1.0


def _too_large(path: Path, rows: int, columns: int) -> str:
    return (
        f"{path} has {columns:,} x {rows:,} cells; a file of its form can have {MAX_CELLS:,} at "
        "most. Give a smaller one, or a GeoTIFF, of which only the site is read."
    )


def _open_array(path: Path) -> HeightFile:
    """Open a .npy array; objects in it are never made."""
    try:
        numbers = np.load(path, mmap_mode="r", allow_pickle=False)
    except (ValueError, OSError, EOFError) as error:
        raise InputError(
            f"{path} is no array of numbers ({str(error).rstrip('.')}); write it with "
            "numpy.save, (rows, columns) of floats or integers, first row north."
        ) from error
    if numbers.ndim != 2 or numbers.dtype.kind not in "iuf":
        raise InputError(
            f"{path} is an array of shape {numbers.shape} and type {numbers.dtype}; heights are "
            "(rows, columns) of floats or integers, first row north."
        )
    return HeightFile(
        path, numbers.shape, None, None, _held(numbers), whole=numbers.dtype.kind in "iu"
    )


def _open_tile(path: Path) -> HeightFile:
    """Open an SRTM tile: big-endian 16-bit metres on the nodes of a degree square."""
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
    values = np.frombuffer(content, ">i2").reshape(side, side).astype(float)
    values[values == SRTM_VOID] = np.nan
    scale = float(side - 1)
    to_cell = (scale, 0.0, -west * scale, 0.0, -scale, (south + 1) * scale)
    return HeightFile(
        path, (side, side), to_cell, "EPSG:4326", _held(values), whole=True, datum=SRTM_DATUM
    )


def _open_grid(path: Path) -> HeightFile:
    """Open an ESRI grid: a header of words, then rows from north to south."""
    if path.stat().st_size > MAX_CELLS * 2:  # a digit and a blank at least
        raise InputError(
            f"{path} has {path.stat().st_size:,} bytes, more than {MAX_CELLS:,} cells can take; "
            "give a GeoTIFF, of which only the site is read."
        )
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
    if "nodata_value" in header:
        values[values == header["nodata_value"]] = np.nan
    to_cell = (1 / cell, 0.0, -west / cell, 0.0, -1 / cell, south / cell + rows - 1)
    return HeightFile(path, (rows, columns), to_cell, None, _held(values), whole=False)


_OPENERS: dict[str, Callable[[Path], HeightFile]] = {
    ".hgt": _open_tile, ".hgt.zip": _open_tile, ".asc": _open_grid, ".npy": _open_array,
}  # fmt: skip
