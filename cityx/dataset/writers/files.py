"""Files of a dataset: each appears complete or not at all, with its checksum known."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import file_digest
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.system.atomic import replaced


@dataclass(frozen=True)
class Written:
    """A file that is complete.

    Attributes
    ----------
    path
        Relative to the dataset, with slashes.
    sha256
        64 hexadecimal digits.
    size
        Bytes.
    """

    path: str
    sha256: str
    size: int


class Files:
    """Writes files below one folder and remembers them; a class because the list grows.

    Parameters
    ----------
    folder
        Of the dataset.
    aside
        Folder on the same disk for what is half written.
    """

    def __init__(self, folder: Path, aside: Path) -> None:
        self.folder = folder
        self.aside = aside
        self.written: list[Written] = []

    @contextmanager
    def file(self, name: str) -> Iterator[Path]:
        """Give a temporary name; the file stands under its own when the block ends well."""
        self.aside.mkdir(parents=True, exist_ok=True)
        with replaced(self.folder / name, aside=self.aside) as temporary:
            yield temporary
            record = _written(temporary, name)
        self.written.append(record)

    def again(self, name: str) -> None:
        """Remember a file that an earlier process completed."""
        self.written.append(_written(self.folder / name, name))

    def data(self, name: str, content: bytes) -> None:
        """Write a file of bytes."""
        with self.file(name) as temporary:
            temporary.write_bytes(content)

    def text(self, name: str, content: str) -> None:
        """Write a file of text."""
        self.data(name, content.encode())

    def json(self, name: str, value: Any) -> None:
        """Write a value as JSON; what is not a finite number is refused."""
        self.text(name, json.dumps(value, indent=1, allow_nan=False) + "\n")

    def picture(self, name: str, pixels: NDArray[np.uint8] | NDArray[np.uint16]) -> None:
        """Write a picture of 8 or 16 bits as PNG."""
        from PIL import Image

        with self.file(name) as temporary:
            # Level 4 is within a few per cent of the best and takes a third of its time.
            Image.fromarray(pixels).save(temporary, format="PNG", compress_level=4)


def _written(path: Path, name: str) -> Written:
    with path.open("rb") as file:
        digest = file_digest(file, "sha256").hexdigest()
    return Written(name, digest, path.stat().st_size)


def stream_json(path: Path, head: Mapping[str, Any], lists: Mapping[str, Iterable[Any]]) -> None:
    """Write an object: small values first, then long lists with one element per line."""
    with path.open("w", encoding="utf-8") as file:
        file.write("{")
        separator = "\n"
        for key, value in head.items():
            file.write(f"{separator}{json.dumps(key)}: {json.dumps(value, allow_nan=False)}")
            separator = ",\n"
        for key, items in lists.items():
            file.write(f"{separator}{json.dumps(key)}: [")
            _elements(file, items)
            separator = ",\n"
        file.write("\n}\n")


def stream_list(path: Path, items: Iterable[Any]) -> None:
    """Write a list with one element per line."""
    with path.open("w", encoding="utf-8") as file:
        file.write("[")
        _elements(file, items)
        file.write("\n")


def _elements(file: Any, items: Iterable[Any]) -> None:
    separator = "\n"
    for item in items:
        file.write(separator + json.dumps(item, allow_nan=False))
        separator = ",\n"
    file.write("\n]")
