"""Compressed files: Blender opens them, and any reader of Zstandard finds the same bytes."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from cityx.blender import compression
from cityx.blender.compression import compress, unfinished

zstandard = pytest.importorskip("zstandard")


@pytest.fixture
def plain(tmp_path):
    path = tmp_path / "city.blend"
    numbers = np.arange(200_000, dtype=np.int32) // 7
    path.write_bytes(b"BLENDER" + numbers.tobytes())
    return path


def test_frames_hold_the_file_in_order(tmp_path, plain, monkeypatch):
    monkeypatch.setattr(compression, "FRAME", 100_000)
    compress(plain, tmp_path / "small.blend")
    packed = (tmp_path / "small.blend").read_bytes()
    count, _, mark = struct.unpack("<IBI", packed[-9:])
    assert mark == compression.SEEKABLE
    assert count == 9  # 800,007 bytes in frames of 100,000
    begin, found = 0, b""
    table = packed[-9 - 8 * count : -9]
    for size, whole in struct.iter_unpack("<II", table):
        frame = zstandard.ZstdDecompressor().decompress(packed[begin : begin + size])
        assert len(frame) == whole
        found += frame
        begin += size
    assert found == plain.read_bytes()
    assert struct.unpack("<II", packed[begin : begin + 8]) == (
        compression.SKIPPABLE, len(table) + 9)  # fmt: skip
    assert len(packed) < len(found)


def test_unfinished_names_are_hidden_and_keep_the_suffix(tmp_path):
    names = [path.name for path in unfinished(tmp_path / "city.blend")]
    assert names == [".city.plain.blend", ".city.partial.blend"]
