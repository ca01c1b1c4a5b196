"""The cache: what it holds is what would be made; harm to it does none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cityx.assets import textures
from cityx.system import cache
from cityx.system.cache import VARIABLE, cache_folder, cached_arrays


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    return tmp_path


def counted():
    calls = []

    def make():
        calls.append(1)
        return {"a": np.arange(6.0).reshape(2, 3), "b": np.array([1, 2], np.uint8)}

    return calls, make


def test_arrays_are_made_once_and_come_back_as_they_were(folder):
    calls, make = counted()
    first, second = cached_arrays("kind/one", make), cached_arrays("kind/one", make)
    assert len(calls) == 1
    for name in first:
        assert first[name].dtype == second[name].dtype
        assert np.array_equal(first[name], second[name])
    assert [path.name for path in folder.rglob("*") if path.is_file()] == ["one.npz"]


@pytest.mark.parametrize("harm", [b"", b"PK\x03\x04", b"no archive at all" * 9])
def test_a_broken_file_is_made_anew(folder, harm):
    calls, make = counted()
    cached_arrays("one", make)
    (folder / "one.npz").write_bytes(harm)
    assert np.array_equal(cached_arrays("one", make)["b"], [1, 2])
    cached_arrays("one", make)
    assert len(calls) == 2


def test_a_truncated_file_is_made_anew(folder):
    _, make = counted()
    cached_arrays("one", make)
    whole = (folder / "one.npz").read_bytes()
    for size in range(0, len(whole), 37):
        (folder / "one.npz").write_bytes(whole[:size])
        assert np.array_equal(cached_arrays("one", make)["a"], np.arange(6.0).reshape(2, 3))


def test_a_folder_that_cannot_be_written_is_passed_over(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(VARIABLE, str(tmp_path / "file"))
    calls, make = counted()
    cached_arrays("one", make)
    assert cached_arrays("one", make)["b"].tolist() == [1, 2]
    assert len(calls) == 2


def test_an_empty_variable_turns_it_off(monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    assert cache_folder() is None
    calls, make = counted()
    cached_arrays("one", make)
    cached_arrays("one", make)
    assert len(calls) == 2


def test_without_the_variable_it_lies_where_the_system_keeps_such_things(tmp_path, monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr(cache.sys, "platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "cityx"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert cache_folder() == Path.home() / ".cache" / "cityx"


def test_a_texture_from_the_cache_is_the_one_that_was_drawn(folder):
    textures.texture.cache_clear()
    drawn = textures.texture("brick", 64)
    textures.texture.cache_clear()
    assert list(folder.rglob("brick-64.npz"))
    held = textures.texture("brick", 64)
    textures.texture.cache_clear()
    for part in ("color", "normal", "roughness"):
        assert np.array_equal(getattr(drawn, part), getattr(held, part))
        assert not getattr(held, part).flags.writeable
    facts = ("name", "tile", "mean", "roughness_mean")
    assert [getattr(drawn, k) for k in facts] == [getattr(held, k) for k in facts]
