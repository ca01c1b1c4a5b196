"""Arrays in one file: what is read is what was written, wherever it lies."""

from __future__ import annotations

import numpy as np
import pytest

from cityx.errors import InputError
from cityx.system.packed import read_arrays, write_arrays

ARRAYS = {
    "numbers": np.arange(12.0).reshape(4, 3),
    "turned": np.arange(12, dtype=np.int32).reshape(3, 4).T,
    "none": np.zeros((0, 2), np.float32),
    "one": np.array(7, np.uint64),
    "words": np.array(["kerb", "eave"]),
    "flags": np.array([True, False, True]),
}


@pytest.fixture
def path(tmp_path):
    write_arrays(tmp_path / "arrays.npz", ARRAYS)
    return tmp_path / "arrays.npz"


@pytest.mark.parametrize("how", [{}, {"mapped": True}, {"checked": True}])
def test_arrays_come_back_as_they_were(path, how):
    found = read_arrays(path, **how)
    assert list(found) == list(ARRAYS)
    for name, array in ARRAYS.items():
        assert found[name].dtype == array.dtype
        assert found[name].shape == array.shape
        assert np.array_equal(found[name], array)


def test_numpy_reads_the_file(path):
    with np.load(path) as held:
        assert np.array_equal(held["numbers"], ARRAYS["numbers"])


def test_a_file_of_numpy_is_read(tmp_path):
    np.savez(tmp_path / "theirs.npz", numbers=ARRAYS["numbers"])
    assert np.array_equal(read_arrays(tmp_path / "theirs.npz")["numbers"], ARRAYS["numbers"])


def test_mapped_arrays_are_aligned_and_keep_what_is_written_to_them(path):
    found = read_arrays(path, mapped=True)
    assert all(array.flags.aligned for array in found.values())
    found["numbers"][0] = 99.0
    assert read_arrays(path)["numbers"][0, 0] == 0.0


def test_pieces_are_written_as_one_array(tmp_path):
    pieces = [np.arange(4).reshape(2, 2), np.zeros((0, 2), np.int64), np.arange(4, 6).reshape(1, 2)]
    write_arrays(tmp_path / "joined.npz", {"rows": pieces})
    assert np.array_equal(read_arrays(tmp_path / "joined.npz")["rows"], np.concatenate(pieces))


def test_a_changed_byte_is_found_where_it_is_looked_for(path):
    content = bytearray(path.read_bytes())
    at = content.index(np.float64(5.0).tobytes())
    content[at] ^= 1
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"is damaged: numbers\.npy is not as written"):
        read_arrays(path, checked=True)


def test_compressed_arrays_are_refused_by_name(tmp_path):
    path = tmp_path / "small.npz"
    np.savez_compressed(path, numbers=ARRAYS["numbers"])
    with pytest.raises(InputError, match=r"small\.npz holds numbers\.npy in a form of no store"):
        read_arrays(path)
