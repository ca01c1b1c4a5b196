"""Houses on free land, with the storeys, walls and roofs that were asked for."""

import numpy as np
import pytest

from cityx.checks.predicates import clean, measure
from cityx.city.content import content_hash
from cityx.edit.buildings.add_parts import add_parts
from cityx.edit.buildings.roof_planes import planes_of
from cityx.edit.buildings.set_roof import set_roof
from cityx.edit.land.add_element import add_element
from cityx.edit.land.add_house import add_house
from cityx.edit.land.turf import turf
from cityx.errors import ActionFailed
from cityx.language.brief import Selector
from cityx.language.references.selecting import choose

ASKED = {"floors": 3, "color": 0xD8B040, "shape": "hipped", "roof_color": 0xA03028}


def test_a_house_is_built_as_it_is_asked_for_and_nothing_else_changes(river):
    made = add_house(river, kind="villa", **ASKED)
    assert measure("gained(building) == 1", made, before=river).met
    known = set(river.layout.buildings["id"])
    (own,) = made.layout.buildings.loc[~made.layout.buildings["id"].isin(known)].itertuples()
    assert own.levels == 3
    parts = made.layout.parts[made.layout.parts["building"] == own.id]
    assert set(parts["wall_color"]) == {0xD8B040}
    assert 0xA03028 in set(parts["roof_color"])
    old = made.layout.parts[made.layout.parts["building"].isin(known)].reset_index(drop=True)
    assert old.equals(river.layout.parts.reset_index(drop=True))
    assert all(rule.met for rule in clean(made))
    assert content_hash(add_house(river, kind="villa", **ASKED)).total == content_hash(made).total


def test_an_element_takes_the_traits_of_its_building_and_land_has_none(river):
    made = add_element(river, kind="hotel", floors=4)
    new = made.layout.buildings[~made.layout.buildings["id"].isin(river.layout.buildings["id"])]
    assert set(new["levels"]) == {4}
    with pytest.raises(ActionFailed, match="A playground has no walls, storeys or roof"):
        add_element(river, kind="playground", floors=2)


def test_grass_grows_on_ground_that_is_told(grid):
    corners = ((-60.0, -60.0, 0.0), (60.0, -60.0, 0.0), (60.0, 60.0, 0.0), (-60.0, 60.0, 0.0))
    made = turf(grid, ground=corners, kind="meadow")
    new = made.layout.areas[~made.layout.areas["id"].isin(grid.layout.areas["id"])]
    assert set(new["kind"]) == {"meadow"}
    assert new.geometry.bounds.abs().to_numpy().max() <= 60.001


def test_panels_lie_on_roofs_of_the_side_that_is_told(grid):
    ids = np.sort(grid.layout.buildings["id"].to_numpy(np.uint64))[:4]
    names = tuple(f"{one:016x}" for one in ids.tolist())
    gabled = set_roof(grid, objects=names, shape="hipped")
    city = add_parts(gabled, part="solar", objects=names, facing="south")
    planes = dict(planes_of(gabled, ids))
    rows = city.scene.instances["added_parts"]
    assert rows.count
    for own, at in zip(rows.owner.tolist(), rows.position, strict=True):
        plane = min(planes[own], key=lambda one, at=at: abs((at - one.origin) @ one.normal))
        assert plane.normal[1] < 0.0
    with pytest.raises(ActionFailed, match="A chimney is not put on roofs by the side"):
        add_parts(grid, part="chimney", facing="south")


def test_houses_along_a_street_by_its_name_are_those_along_the_street(grid):
    name = next(str(one) for one in grid.layout.roads["name"] if one)
    street = grid.layout.roads.loc[grid.layout.roads["name"] == name].geometry.union_all()
    chosen = choose(Selector("building", along=name), grid)
    assert max(shape.distance(street) for shape in chosen.shapes) <= 35.0
