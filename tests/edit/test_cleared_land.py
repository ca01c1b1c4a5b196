"""Meadows in the place of houses: they go, their land is green, all else stays."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import clean
from cityx.checks.predicates.change_predicates import changed_ids
from cityx.city.content import content_hash
from cityx.edit.land.cleared_land import YARD, replace_by_green
from cityx.errors import UsageError


def test_houses_become_meadow_and_nothing_else_changes(park):
    table = park.layout.buildings.set_index("name")
    made = replace_by_green(park, objects=("b01", "b02"), kind="meadow")
    assert {"b01", "b02"}.isdisjoint(made.layout.buildings["name"])
    assert len(made.layout.buildings) == len(park.layout.buildings) - 2
    known = park.layout.areas["id"]
    meadow = made.layout.areas[~made.layout.areas["id"].isin(known)]
    assert set(meadow["kind"]) == {"meadow"}
    ground = shapely.union_all(table.geometry.loc[["b01", "b02"]].to_numpy())
    laid = shapely.union_all(meadow.geometry.to_numpy())
    assert shapely.covers(shapely.buffer(ground, YARD + 0.1), laid)
    assert laid.intersection(ground).area == pytest.approx(ground.area, rel=0.02)
    others = np.setdiff1d(changed_ids(park, made), [*table["id"].loc[["b01", "b02"]],
                                                    *meadow["id"]])  # fmt: skip
    trees = park.scene.instances["trees"].object_id
    assert np.isin(others, trees).all()
    assert all(rule.met for rule in clean(made))


def test_the_same_houses_make_the_same_meadow(park):
    hashes = {content_hash(replace_by_green(park, objects=("b01",))).total for _ in range(2)}
    assert len(hashes) == 1


def test_water_does_not_become_meadow(park):
    areas = park.layout.areas.copy()
    areas["kind"] = areas["kind"].where(areas.index > 0, "water")
    wet = replace(park, layout=replace(park.layout, areas=areas))
    with pytest.raises(UsageError, match="Water does not become"):
        replace_by_green(wet, objects=(f"{int(areas['id'].iloc[0]):016x}",))
