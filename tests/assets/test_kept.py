"""Kept prototypes: what comes from the cache is what would be made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cityx.assets import kept_prototypes as kept
from cityx.assets.furniture import street_furniture
from cityx.assets.openings.doors import door
from cityx.assets.openings.windows import window
from cityx.assets.shapes import box, prototype
from cityx.assets.trees import plants
from cityx.city.content import hash_mesh
from cityx.system.cache import VARIABLE


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    return tmp_path


def files(folder):
    return sorted(path.name for path in folder.rglob("*.npz"))


@pytest.mark.parametrize("make", [window.__wrapped__, door.__wrapped__])
def test_a_kept_prototype_is_the_one_that_was_made(folder, make):
    name = "window_single" if make is window.__wrapped__ else "door_house"
    made, found = make(name, detail=3), make(name, detail=3)
    assert len(files(folder)) == 1
    assert (found.name, found.kind, found.mesh.materials) == (
        made.name, made.kind, made.mesh.materials)  # fmt: skip
    for column in ("vertices", "faces", "material", "uv", "tint"):
        one, other = getattr(made.mesh, column), getattr(found.mesh, column)
        assert one.dtype == other.dtype
        assert np.array_equal(one, other)
    assert hash_mesh(made.mesh)[1] == hash_mesh(found.mesh)[1]


@pytest.mark.parametrize(
    ("make", "asked"),
    [(street_furniture._built_in, ("bench",)), (plants.tree, ("lime", 1, "light"))],
)
def test_furniture_and_trees_are_kept_as_they_are_made(folder, make, asked):
    first, again = make.__wrapped__(*asked), make.__wrapped__(*asked)
    assert any(name.startswith(("furniture-", "tree-")) for name in files(folder))
    assert (again.name, again.kind) == (first.name, first.kind)
    assert hash_mesh(again.mesh)[1] == hash_mesh(first.mesh)[1]


def test_a_species_of_a_package_is_kept_by_what_it_is(folder, monkeypatch):
    monkeypatch.setattr(plants, "OUTSIDE_TREES", {"lime"})
    low = plants.tree.__wrapped__("lime", 1, "light")
    high = replace(plants.TREES["lime"], height=2 * plants.TREES["lime"].height)
    monkeypatch.setattr(plants, "TREES", {**plants.TREES, "lime": high})
    plants.tree.__wrapped__("lime", 1, "light")
    assert len([name for name in files(folder) if name.startswith("tree-")]) == 2
    assert low.name == "tree_lime_1_light"


def test_each_question_has_a_file_of_its_own(folder):
    for dressing in range(3):
        window.__wrapped__("window_single", dressing, detail=3)
    assert len(files(folder)) == 3


def test_what_is_made_quickly_is_not_kept(folder):
    window.__wrapped__("window_single", detail=2)
    assert files(folder) == []


@pytest.mark.usefixtures("folder")
def test_other_code_makes_prototypes_anew(monkeypatch):
    calls = []

    @kept.kept("crate", least=0)
    def crate(name: str):
        calls.append(name)
        return prototype(name, "furniture", [box((0, 0, 0), (1, 1, 1), "wood")])

    crate("a"), crate("a")
    assert calls == ["a"]
    monkeypatch.setattr(kept, "edition", lambda: "another")
    crate("a")
    assert calls == ["a", "a"]


def test_what_is_not_there_is_said_as_without_a_cache(folder):
    with pytest.raises(KeyError):
        door.__wrapped__("door_of_nowhere", detail=3)
    assert files(folder) == []
