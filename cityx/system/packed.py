"""Arrays in one file (.npz), written and read in one go.

NumPy copies arrays to and from archives in small pieces, which takes three times as long. Its own
`numpy.load` reads these files as well.
"""

from __future__ import annotations

import io
import mmap
import os
import re
import struct
import zipfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError

LOCAL_NAME = 26  # bytes from the start of an entry of an archive to the lengths of its name
LOCAL_HEADER, LARGE_FILE = 30, 20  # bytes before the name, and after it for sizes of 64 bits
ALIGNED = 64  # bytes; arrays that start at multiples of it may be used where they lie in the file
PADDING, PADDING_HEAD = 0xD935, 4  # the archive's word for padding, and the bytes that say so
# The header of an array as `write_arrays` writes it; NumPy asks a parser of Python, which takes
# longer than to read a small array.
USUAL_HEADER = 128
_USUAL = re.compile(
    rb"\x93NUMPY\x01\x00v\x00\{'descr': '([<|][bfiuU]\d+)', 'fortran_order': False, "
    rb"'shape': \(([\d, ]*)\), \} *\n\Z"
)
_HEADERS: Mapping[tuple[int, int], Callable[..., Any]] = MappingProxyType(
    {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
)


def write_arrays(path: Path, arrays: Mapping[str, NDArray[Any] | Sequence[NDArray[Any]]]) -> None:
    """Write arrays.

    Parameters
    ----------
    path
        The file.
    arrays
        Array by name; several that follow each other along the first axis are written as one,
        without a copy of the whole.
    """
    with zipfile.ZipFile(path, "w") as archive:
        for name, given in arrays.items():
            parts = [given] if isinstance(given, np.ndarray) else list(given)
            kind = np.result_type(*parts)
            shape = parts[0].shape
            if not isinstance(given, np.ndarray):
                shape = (sum(len(part) for part in parts), *shape[1:])
            with archive.open(_entry(archive, f"{name}.npy"), "w", force_zip64=True) as file:
                file.write(_header(kind, shape))
                for part in parts:
                    flat = np.ascontiguousarray(part, kind).reshape(-1)
                    file.write(flat.view(np.uint8).data)


def _header(kind: np.dtype[Any], shape: tuple[int, ...]) -> bytes:
    text = io.BytesIO()
    descr = np.lib.format.dtype_to_descr(kind)  # type: ignore[no-untyped-call]
    record = {"descr": descr, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(text, record)  # type: ignore[no-untyped-call]
    return text.getvalue()


def _entry(archive: zipfile.ZipFile, name: str) -> zipfile.ZipInfo:
    """Return the next entry of an archive, padded so that its content starts aligned."""
    entry = zipfile.ZipInfo(name)
    assert archive.fp is not None
    begin = archive.fp.tell() + LOCAL_HEADER + len(name.encode()) + LARGE_FILE + PADDING_HEAD
    missing = -begin % ALIGNED
    entry.extra = struct.pack("<HH", PADDING, missing) + bytes(missing)
    return entry


def read_arrays(
    path: Path, *, mapped: bool = False, checked: bool = False
) -> dict[str, NDArray[Any]]:
    """Read arrays.

    Parameters
    ----------
    path
        A file of `write_arrays`, or of `numpy.savez`.
    mapped
        Whether arrays may stay in the file until they are looked at. What is written to them does
        not reach it. Windows does not let go of such a file: there, they are read.
    checked
        Whether the checksums of the archive are compared. Whether a file of a store is whole is
        told by the hash of the city.

    Raises
    ------
    InputError
        If an array is compressed, holds Python objects or is not what was written.
    """
    found: dict[str, NDArray[Any]] = {}
    with path.open("rb") as file, zipfile.ZipFile(file) as archive:
        held = _content(file, mapped=mapped, checked=checked)
        for entry in archive.infolist():
            kind, shape = _found_header(file, entry, path)
            count = int(np.prod(shape, dtype=np.int64))
            name, begin = entry.filename.removesuffix(".npy"), file.tell()
            if checked and held is not None:
                end = begin + count * kind.itemsize
                if crc32(memoryview(held)[end - entry.file_size : end]) != entry.CRC:
                    raise InputError(f"{path} is damaged: {entry.filename} is not as written.")
            if held is not None and begin % kind.alignment == 0 and count:
                found[name] = np.ndarray(shape, kind, held, begin)
            else:
                found[name] = np.fromfile(file, kind, count).reshape(shape)
    return found


def _content(
    file: io.BufferedReader, *, mapped: bool, checked: bool
) -> mmap.mmap | bytearray | None:
    """Return all bytes of a file, None where its arrays are to be read one by one."""
    if checked:
        held = bytearray(os.fstat(file.fileno()).st_size)
        file.seek(0)
        file.readinto(held)
        return held
    if mapped and os.name == "posix":
        return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_COPY)
    return None


def _found_header(
    file: io.BufferedReader, entry: zipfile.ZipInfo, path: Path
) -> tuple[np.dtype[Any], tuple[int, ...]]:
    """Go to the content of an array and return its type and shape."""
    file.seek(entry.header_offset + LOCAL_NAME)
    name, extra = struct.unpack("<HH", file.read(4))
    file.seek(name + extra, os.SEEK_CUR)
    fault = InputError(f"{path} holds {entry.filename} in a form of no store of CityX.")
    if entry.compress_type != zipfile.ZIP_STORED:
        raise fault
    begin = file.tell()
    usual = _USUAL.match(file.read(USUAL_HEADER))
    if usual is not None:
        return np.dtype(usual[1].decode()), tuple(map(int, usual[2].replace(b",", b" ").split()))
    file.seek(begin)
    version = np.lib.format.read_magic(file)  # type: ignore[no-untyped-call]
    shape, fortran, kind = _HEADERS[version](file)
    if fortran or kind.hasobject:
        raise fault
    return kind, shape
