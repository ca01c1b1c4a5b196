"""Kept colliders: what comes from the cache is what would be found."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from cityx.assets.colliders import _collider, collider_of
from cityx.assets.furniture.street_furniture import furniture
from cityx.assets.trees import plant
from cityx.assets.vehicles.vehicles import car
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
