import sys
import time

import numpy as np
import pytest

from cityx.assets.library.encoding import unit
from cityx.assets.library.index import BruteForceIndex, GraphIndex, open_index, write_index
from cityx.errors import InputError, MissingDependency, UsageError


def made(folder, count, seed=0):
    vectors = unit(np.random.default_rng(seed).standard_normal((count, 768)))
    write_index(folder / "index", vectors, "one")
    return open_index(folder / "index"), vectors


def test_the_scan_of_bytes_finds_exactly_what_half_floats_hold(tmp_path):
    index, vectors = made(tmp_path, 3000)
    near = unit(vectors[:40] + 0.5 * np.random.default_rng(1).standard_normal((40, 768)) / 27)
    rows, cosines = index.search(near, 10, encoder="one")
    exact = np.asarray(index.vectors, np.float32) @ near.T
    wanted = np.argsort(-exact, axis=0, kind="stable")[:10].T
    assert np.array_equal(rows, wanted)
    assert np.allclose(cosines, np.take_along_axis(exact.T, wanted, 1), atol=1e-6)


def test_equal_vectors_come_in_the_order_of_rows(tmp_path):
    write_index(tmp_path / "index", unit(np.ones((5, 768))), "one")
    rows, _ = open_index(tmp_path / "index").search(unit(np.ones((1, 768))), 3, encoder="one")
    assert rows.tolist() == [[0, 1, 2]]


def test_a_search_among_some_finds_those_alone(tmp_path):
    index, vectors = made(tmp_path, 50)
    among = np.arange(50) % 2 == 1
    rows, _ = index.search(vectors[:1], 40, encoder="one", among=among)
    assert sorted(rows[0].tolist()) == list(range(1, 50, 2))


def test_vectors_of_another_encoder_are_refused(tmp_path):
    index, vectors = made(tmp_path, 3)
    with pytest.raises(UsageError, match='made with "one"; vectors of "two" cannot be compared'):
        index.search(vectors[:1], 1, encoder="two")


def test_a_cut_index_is_refused(tmp_path):
    made(tmp_path, 20)
    path = tmp_path / "index" / "vectors.f16"
    path.write_bytes(path.read_bytes()[:-5])
    with pytest.raises(InputError, match=r"vectors\.f16 has 30715 bytes, not 30720"):
        open_index(tmp_path / "index")


def test_an_empty_index_finds_nothing(tmp_path):
    write_index(tmp_path / "index", np.zeros((0, 768), np.float32), "one")
    rows, _ = open_index(tmp_path / "index").search(unit(np.ones((1, 768))), 5, encoder="one")
    assert rows.shape == (1, 0)


def test_a_hundred_thousand_vectors_are_searched_quickly():
    some = 2 * np.random.default_rng(2).integers(0, 2, (1000, 768), np.int8) - 1
    signs = np.tile(some, (100, 1))  # 100,000 vectors
    half = np.tile((some / np.sqrt(768)).astype(np.float16), (100, 1))
    scale = np.full(len(half), half.max() / 127.0, np.float32)
    error = np.full(len(half), 1e-4, np.float32)
    index = BruteForceIndex("one", half, signs * np.int8(127), scale, error)
    spent = []
    for _ in range(4):
        begin = time.process_time()
        rows, _ = index.search(unit(half[77:78]), 10, encoder="one")
        spent.append(time.process_time() - begin)
    assert rows[0, 0] == 77
    assert min(spent) < 1.0  # 0.05 s on an idle machine; a busy one must not fail the test


def test_the_graph_index_agrees_with_the_exact_one(tmp_path):
    pytest.importorskip("usearch", reason="usearch is not installed")
    index, vectors = made(tmp_path, 200)
    rows, _ = GraphIndex(index).search(vectors[:20], 1, encoder="one")
    assert (rows[:, 0] == np.arange(20)).mean() > 0.9


def test_the_graph_index_names_its_extra(tmp_path, monkeypatch):
    index, _ = made(tmp_path, 2)
    monkeypatch.setitem(sys.modules, "usearch.index", None)
    with pytest.raises(MissingDependency, match=r"cityx\[ann\]"):
        GraphIndex(index)
