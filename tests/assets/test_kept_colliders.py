"""Kept colliders: what comes from the cache is what would be found."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from cityx.assets import colliders
from cityx.assets.colliders import _collider, collider_of, mesh_bodies
from cityx.assets.furniture.street_furniture import furniture
from cityx.assets.trees import plant
from cityx.assets.vehicles.vehicles import car
from cityx.city.bodies import Colliders
from cityx.city.mesh import concatenate, one_mesh
from cityx.system.cache import VARIABLE


@pytest.mark.parametrize(
    "prototype", [furniture("bench"), car("sedan"), plant("maple", 3, "light")],
    ids=lambda prototype: prototype.name,
)  # fmt: skip
def test_a_kept_collider_is_the_one_that_was_found(tmp_path, monkeypatch, prototype):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    found = [collider_of(prototype) for _ in range(2)]
    assert len(list(tmp_path.rglob("*.npz"))) == 1
    for solids in found:
        for one, other in zip(solids, _collider(prototype), strict=True):
            assert type(one) is type(other)
            for column in fields(one):
                assert np.array_equal(getattr(one, column.name), getattr(other, column.name))


def test_another_name_or_shape_is_found_anew(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    for body in ("sedan", "van"):
        collider_of(car(body))
    assert len(list(tmp_path.rglob("*.npz"))) == 2


def block(number, ring, height):
    """A prism; a ring of four corners or, bent, of six."""
    count = len(ring)
    points = [(x + 30 * number, y, z) for z in (0.0, height) for x, y in ring]
    sides = [(i, (i + 1) % count, count + (i + 1) % count, count + i) for i in range(count)]
    quads = [(0, 1, 2, 3)] if count == 4 else [(0, 1, 2, 3), (0, 3, 4, 5)]
    lids = [tuple(count + i for i in quad) for quad in quads] + [quad[::-1] for quad in quads]
    return one_mesh(number, points, sides + lids)


SQUARE = [(0, 0), (10, 0), (10, 8), (0, 8)]
BENT = [(0, 0), (12, 0), (12, 4), (4, 4), (4, 12), (0, 12)]


def test_shapes_of_a_layer_are_kept_a_few_together_and_an_edit_finds_only_those_near(
    tmp_path, monkeypatch
):
    level = one_mesh(4, [(90, 0, 0), (99, 0, 0), (99, 9, 0), (90, 9, 0)], [(0, 1, 2, 3)])
    parts = [block(0, SQUARE, 9.0), block(1, BENT, 6.0), block(2, SQUARE, 3.0), level,
             block(5, BENT, 12.0)]  # fmt: skip
    monkeypatch.setenv(VARIABLE, "")
    known = mesh_bodies("buildings", concatenate(parts)).colliders
    assert known.count == 5
    assert np.diff(known.part_start).tolist() == [1, 2, 1, 1, 2]
    monkeypatch.setattr(colliders, "TOGETHER", 2)
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    for _ in range(2):
        found = mesh_bodies("buildings", concatenate(parts)).colliders
        for column in fields(Colliders):
            assert np.array_equal(getattr(found, column.name), getattr(known, column.name))
        assert len(list(tmp_path.rglob("*.npz"))) == 3
    parts[1] = block(1, BENT, 7.0)
    mesh_bodies("buildings", concatenate(parts))
    assert len(list(tmp_path.rglob("*.npz"))) == 4
