"""WebDataset: shards of a hundred shots, tar files whose bytes depend on the shots alone.

References
----------
https://github.com/webdataset/webdataset
"""

from __future__ import annotations

import io
import json
import tarfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cityx.dataset.channels import CHANNELS
from cityx.dataset.record import Record
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import Format, Kept, Part, Place, Whole, picture_of
from cityx.dataset.writers.raw import description, table_of

if TYPE_CHECKING:
    from cityx.dataset.classes import Class

SHOTS = 100  # of a shard


def _shot(record: Record, place: Place, classes: Sequence[Class], files: Files) -> Part:
    """Write the members of a shot as one tar file, of which shards are put together."""
    del classes
    key = f"{place.city}-{record.shot.name}".replace(".", "_")
    members: dict[str, bytes] = {}
    if "rgb" in record.channels:
        members["rgb.png"] = _png(record)
    for name in CHANNELS:
        if name in record.channels and name != "rgb":
            members[f"{name}.npy"] = _npy(record.channels[name])
    if record.sweep is not None:
        members["lidar.npy"] = _npy(table_of(record.sweep))
    members["json"] = json.dumps(description(record, place), allow_nan=False).encode()
    name = part_name(place)
    with files.file(name) as path, tarfile.open(path, "w", format=tarfile.USTAR_FORMAT) as tar:
        for suffix, content in sorted(members.items()):
            tar.addfile(_header(f"{key}.{suffix}", len(content)), io.BytesIO(content))
    return {}


def part_name(place: Place) -> str:
    """Return the name of the members of a shot until their shard is made."""
    return f".work/webdataset/{place.number:09d}.tar"


def _header(name: str, size: int) -> tarfile.TarInfo:
    header = tarfile.TarInfo(name)  # no owner, no time: zeros
    header.size = size
    header.mode = 0o644
    return header


def _png(record: Record) -> bytes:
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(picture_of(record)).save(buffer, format="PNG", compress_level=4)
    return buffer.getvalue()


def _npy(values: Any) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, values)
    return buffer.getvalue()


def _finish(whole: Whole, files: Files) -> None:
    for number, kept in enumerate(_shards(whole.parts())):
        name = f"webdataset/{number:06d}.tar"
        parts = [files.folder / part_name(item.place) for item in kept]
        if all(part.exists() for part in parts):
            with files.file(name) as path:
                _pack(path, parts)
        else:  # packed before a kill
            files.again(name)
        for part in parts:  # at once: else all shots would lie on the disk twice
            part.unlink(missing_ok=True)


def _shards(parts: Iterator[Kept]) -> Iterator[list[Kept]]:
    shard: list[Kept] = []
    for kept in parts:
        shard.append(kept)
        if len(shard) == SHOTS:
            yield shard
            shard = []
    if shard:
        yield shard


def _pack(path: Path, parts: Sequence[Path]) -> None:
    with tarfile.open(path, "w", format=tarfile.USTAR_FORMAT) as shard:
        for part in parts:
            with tarfile.open(part) as tar:
                for member in tar:
                    shard.addfile(member, tar.extractfile(member))


WEBDATASET = Format("webdataset", "tar shards of NumPy arrays, PNG and JSON", _shot, _finish,
                    shows=False)  # fmt: skip
