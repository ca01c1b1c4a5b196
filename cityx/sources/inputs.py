"""What kind of input a file is, told from its first bytes and its name."""

from __future__ import annotations

import gzip
import zlib
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from cityx.errors import InputError

_HEIGHT_SUFFIXES = (".tif", ".tiff", ".hgt", ".hgt.zip", ".asc")
_IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".bmp")
_OSM_SUFFIXES = (".osm", ".osm.gz", ".osm.bz2", ".osm.pbf", ".pbf", ".xml")
_DRAWN_SUFFIXES = (".geojson", ".json", ".gpx")
KINDS = (
    "OpenStreetMap (.osm, .osm.gz, .osm.bz2, .osm.pbf), heights (.tif, .hgt, .hgt.zip, .asc) or "
    "drawings (.geojson, .json, .gpx)"
)


@dataclass(frozen=True)
class Input:
    """A file given to a build.

    Attributes
    ----------
    kind
        "osm", "height" or "drawn".
    """

    path: Path
    kind: str
    size: int
    sha256: str

    def record(self) -> dict[str, Any]:
        """Return what the report says about the file."""
        return {
            "name": self.path.name, "kind": self.kind, "bytes": self.size, "sha256": self.sha256,
        }  # fmt: skip


def classify(path: Path) -> Input:
    """Tell what a file is.

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
        return Input(path, _kind(path), size, _digest(path))
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}.") from error


def _kind(path: Path) -> str:
    name = path.name.lower()
    if name.endswith(_HEIGHT_SUFFIXES):
        return "height"
    if name.endswith(_DRAWN_SUFFIXES):
        return "drawn"
    head = _head(path)
    if name.endswith(_OSM_SUFFIXES) or b"<osm" in head or b"OSMHeader" in head:
        return "osm"
    if name.endswith(_IMAGE_SUFFIXES):
        raise InputError(
            f"{path} is an image. Semantic maps and satellite images are no input of this version; "
            f"give {KINDS}."
        )
    raise InputError(f"{path} is of no known kind; give {KINDS}.")


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


def _digest(path: Path) -> str:
    hasher = sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            hasher.update(block)
    return hasher.hexdigest()
