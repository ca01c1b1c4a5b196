"""Kinds of input files, recognised by first bytes and name."""

from __future__ import annotations

import gzip
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from warnings import catch_warnings, simplefilter

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError
from cityx.system.digests import file_sha256

_HEIGHT_SUFFIXES = (".hgt", ".hgt.zip", ".asc", ".npy")
_IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".bmp", ".tif", ".tiff")
OSM_SUFFIXES = (".osm", ".osm.gz", ".osm.bz2", ".osm.pbf", ".pbf", ".xml")
_DRAWN_SUFFIXES = (".geojson", ".json", ".gpx", ".blend")
_TEXT_SUFFIXES = (".txt", ".md")
KINDS = (
    "OpenStreetMap (.osm, .osm.gz, .osm.bz2, .osm.pbf), semantic maps and aerial images (.png, "
    ".tif, .jpg), heights (.tif, .hgt, .hgt.zip, .asc, .png of 16 bits, .npy) or drawings "
    "(.geojson, .json, .gpx, curves of a .blend) or wishes (.txt, .md)"
)
LOOK = 400  # cells of a side that are looked at
SLOW = 0.06  # of the spread of all values; measured: heights of 8 bits 0.03, photographs above 0.1
CLASSES = 24  # values; a raster of classes has no more, heights have hundreds
WORDS = ("osm", "semantic", "satellite", "height", "drawn", "text")  # kinds of inputs


@dataclass(frozen=True)
class Input:
    """A file given to a build.

    Attributes
    ----------
    kind
        One of `WORDS`.
    size, sha256
        Of its content; 0 and "" where nobody asked.
    why
        What showed the kind where the name does not, "" otherwise.
    """

    path: Path
    kind: str
    size: int = 0
    sha256: str = ""
    why: str = ""

    def record(self) -> dict[str, Any]:
        """Return what the report says about the file."""
        return {
            "name": self.path.name, "kind": self.kind, "bytes": self.size, "sha256": self.sha256,
            **({"why": self.why} if self.why else {}),
        }  # fmt: skip


def classify(path: Path, kind: str = "") -> Input:
    """Return the kind of a file.

    Parameters
    ----------
    kind
        What the user says it is, or "".

    Raises
    ------
    InputError
        If the file is missing, empty or of no kind that can be read.
    """
    try:
        if not path.exists():
            raise InputError(f"{path} does not exist.")
        if path.is_dir():
            raise InputError(f"{path} is a folder; give a file: {KINDS}.")
        size = path.stat().st_size
        if size == 0:
            raise InputError(f"{path} is empty.")
        found, why = (kind, "") if kind else _kind(path)
        return Input(path, found, size, file_sha256(path), why)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}.") from error


def is_map(path: Path) -> bool:
    """Return whether a file is a map of OpenStreetMap, by its name or how it begins."""
    if path.name.lower().endswith(OSM_SUFFIXES):
        return True
    if path.name.lower().endswith(_IMAGE_SUFFIXES) or not path.is_file():
        return False
    head = _head(path)
    return b"<osm" in head or b"OSMHeader" in head


def place_name(file: str) -> str:
    """Return what a city is called that is read from a file of this name."""
    return file.split(".")[0].replace("_", " ")


def _kind(path: Path) -> tuple[str, str]:
    """Return the kind of a file, and what showed it where its name does not."""
    name = path.name.lower()
    if name.endswith(_HEIGHT_SUFFIXES):
        return "height", ""
    if name.endswith(_DRAWN_SUFFIXES):
        return "drawn", ""
    if name.endswith(_TEXT_SUFFIXES):
        return "text", ""
    if name.endswith(_IMAGE_SUFFIXES):
        return _image_kind(path)
    if is_map(path):
        return "osm", ""
    raise InputError(f"{path} is of no known kind; give {KINDS}.")


def _image_kind(path: Path) -> tuple[str, str]:
    """Classify an image as heights, semantic map or photograph by its pixels."""
    from cityx.sources.semantic_map.picture import read_picture
    from cityx.sources.semantic_map.proposal import is_semantic

    band = _only_band(path)
    if band is not None and band.dtype != np.uint8 and len(np.unique(band)) > CLASSES:
        return ("height", "one band of more than 8 bits; --as NAME=satellite for a photograph")
    evidence = is_semantic(read_picture(path))
    if evidence.semantic:
        return "semantic", evidence.text
    if band is not None and _smooth(band):
        return "height", "one band that changes slowly; --as NAME=satellite for a photograph"
    return "satellite", evidence.text


def _only_band(path: Path) -> NDArray[Any] | None:
    """Return the numbers of an image that has one band, coarser where it is large, else None."""
    import rasterio
    from rasterio.errors import RasterioError

    try:
        with catch_warnings():
            simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
            with rasterio.open(path) as dataset:
                if dataset.count != 1 or dataset.colorinterp[0].name == "palette":
                    return None
                share = min(LOOK / max(dataset.height, dataset.width), 1.0)
                shape = tuple(max(round(side * share), 1) for side in dataset.shape)
                return np.asarray(dataset.read(1, out_shape=shape))
    except RasterioError:
        return None  # whoever reads it says what is wrong


def _smooth(band: NDArray[Any]) -> bool:
    """Return whether neighbours differ as little as heights of a grid do, unlike a picture."""
    values = band.astype(float)
    spread = values.std()
    return bool(spread > 0 and np.abs(np.diff(values, axis=1)).mean() < SLOW * spread)


def _head(path: Path) -> bytes:
    """Return the first kilobyte, unpacked when it is gzip."""
    with path.open("rb") as file:
        head = file.read(1024)
    if head[:2] == b"\x1f\x8b":
        try:
            with gzip.open(path) as file:
                return file.read(1024)
        except (OSError, EOFError, zlib.error):
            return head
    return head
