"""Parts that are added to buildings: panels on roofs, boxes and balconies on walls."""

import numpy as np
import pytest

from cityx.checks.predicates import measure
from cityx.city.content import content_hash
from cityx.edit.buildings.add_parts import PARTS, SILL, add_parts
from cityx.edit.buildings.roof_planes import planes_of
from cityx.errors import ActionFailed
from cityx.town.part_kinds import HOSTS, looks

HAS = {"solar", "antenna", "dish", "chimney", "flower_box", "balcony"}


@pytest.mark.parametrize("part", sorted(HAS))
def test_buildings_get_the_part_and_nothing_else_changes(grid, part):
    city = add_parts(grid, part=part)
    assert measure(f"share(building, has={part}) >= 0.5", city).met
    assert content_hash(add_parts(grid, part=part)).total == content_hash(city).total
    assert city.scene.meshes is grid.scene.meshes or all(
        city.scene.meshes[name] is grid.scene.meshes[name] for name in grid.scene.meshes
    )


def test_some_get_it_and_the_others_do_not(grid):
    ids = grid.layout.buildings["id"].tolist()[:3]
    city = add_parts(grid, part="chimney", objects=tuple(f"{one:016x}" for one in ids))
    rows = city.scene.instances["added_parts"]
    assert set(rows.owner.tolist()) <= set(ids)


def test_panels_lie_in_the_plane_of_their_roof(grid):
    city = add_parts(grid, part="solar")
    rows, ids = city.scene.instances["added_parts"], grid.layout.buildings["id"].to_numpy(np.uint64)
    planes = dict(planes_of(grid, ids))
    for at in range(rows.count):
        away = [abs(float((rows.position[at] - plane.origin) @ plane.normal))
                for plane in planes[int(rows.owner[at])]]  # fmt: skip
        assert min(away) < 0.02


def test_behind_a_balcony_a_window_reaches_down_to_the_floor(grid):
    city = add_parts(grid, part="balcony")
    added = city.scene.instances["added_parts"]
    windows = city.scene.instances["windows"]
    for at in range(min(added.count, 20)):
        near = np.linalg.norm(windows.position - added.position[at], axis=1)
        assert near.min() < 0.01
        row = int(near.argmin())
        assert windows.scale[row, 2] > grid.scene.instances["windows"].scale[row, 2]
    assert SILL > 0.5


def test_the_colour_of_what_is_added_is_measured(grid):
    if not measure("n(building, has=shop) >= 1", grid).met:
        pytest.skip("the scene has no shopfront")
    city = add_parts(grid, part="awning", tint=(0.5, 0.02, 0.02))
    assert measure("n(building, awning_color=red) >= 1", city).met
    told = looks("shop", "awning", "color", "red").replace(HOSTS["shop"], "building")
    assert measure(told, city).met
    assert measure(told, grid).met is False
    owners = [f"{one:016x}" for one in np.unique(city.scene.instances["added_parts"].owner)]
    assert len(owners) > 2
    mixed = add_parts(grid, part="awning", tint=(0.5, 0.02, 0.02), objects=tuple(owners[:1]))
    mixed = add_parts(mixed, part="awning", tint=(0.02, 0.02, 0.5), objects=tuple(owners[1:]))
    assert measure("n(building, awning_color=red) >= 1", mixed).met
    assert measure(told, mixed).met is False


def test_a_part_without_room_is_refused(park):
    bare = [part for part in PARTS if part == "flower_box"]
    with pytest.raises(ActionFailed, match="None of the 0 buildings has room for a flower_box"):
        add_parts(park, part=bare[0], objects=())
