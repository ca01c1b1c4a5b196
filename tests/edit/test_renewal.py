from dataclasses import replace

import numpy as np
import pytest

from cityx.checks.predicates.change_predicates import changed_ids
from cityx.city.rows import take_rows
from cityx.city.store import read_city, write_city
from cityx.edit.land.street_edits import streets
from cityx.edit.renewal import renewed


def widened(city, name, metres=2.0):
    roads = city.layout.roads.copy()
    roads.loc[(roads["name"] == name).to_numpy(), "width"] += metres
    return replace(city.layout, roads=roads)


def test_the_same_layout_leaves_every_layer_as_the_very_same_value(grid, objects):
    same = renewed(grid, grid.layout)
    assert objects(same) == objects(grid)
    assert all(same.scene.instances[k] is rows for k, rows in grid.scene.instances.items())


def test_a_wider_street_leaves_buildings_trees_and_what_stands_far_away(grid):
    wider = renewed(grid, widened(grid, "x1"))
    changed = changed_ids(grid, wider)
    assert len(changed)
    for layer in ("trees", "windows", "doors", "roof_furniture"):
        assert wider.scene.instances[layer] is grid.scene.instances[layer]
    assert wider.scene.meshes["buildings"] is grid.scene.meshes["buildings"]
    for layer in ("street_furniture", "street_pieces", "street_covers"):
        rows = grid.scene.instances[layer]
        moved = rows.position[np.isin(rows.object_id, changed), 0]
        assert np.all(np.abs(moved + 192.0) < 17.0), layer  # x1 runs at x = -192


def test_a_wider_street_moves_its_kerbs_and_its_network(grid):
    wider = renewed(grid, widened(grid, "x1"))
    row = int(np.flatnonzero(grid.layout.roads["name"] == "x1")[0])
    was, now = (c.network.half_width[c.network.edge_road == row] for c in (grid, wider))
    assert now == pytest.approx(was + 1.0)
    inside = np.array([[-192.0 + 3.3, -150.0]])  # 0.55 m beyond the kerb as it was
    assert not grid.ground.on(inside, "carriageway").any()
    assert wider.ground.on(inside, "carriageway").all()


def test_a_street_changes_after_traffic_was_planned(grid):
    moving = replace(grid, stages_done=grid.stages_done | {"dynamic"})
    wider = renewed(moving, widened(grid, "x1"))
    assert wider.network.half_width.max() > grid.network.half_width.max() - 1e-9
    assert wider.stages_done == moving.stages_done


def test_widened_and_narrowed_again_all_objects_are_the_same(river, objects):
    there = streets(river, streets=("south street",), widen_by=2.0)
    back = renewed(there, river.layout)
    assert objects(back) == objects(river)


def test_what_was_moved_or_removed_by_hand_stays_so(grid):
    rows = grid.scene.instances["street_pieces"]
    near = np.flatnonzero(np.abs(rows.position[:, 0] + 192.0) < 12.0)
    moved, gone = near[0], near[1]
    position = rows.position.copy()
    position[moved, :2] = [-150.0, -150.0]
    touched = take_rows(replace(rows, position=position), np.arange(rows.count) != gone)
    scene = grid.scene.with_instances("street_pieces", grid.scene.prototypes, touched)
    after = renewed(replace(grid, scene=scene), widened(grid, "x1"))
    found = after.scene.instances["street_pieces"]
    assert rows.object_id[gone] not in found.object_id
    at = np.flatnonzero(found.object_id == rows.object_id[moved])
    assert found.position[at, :2] == pytest.approx(np.array([[-150.0, -150.0]]))


def test_what_was_put_where_the_carriageway_comes_makes_way(grid):
    rows = grid.scene.instances["trees"]
    position = rows.position.copy()
    position[0, :2] = [-192.0 + 3.3, -150.0]
    scene = grid.scene.with_instances(
        "trees", grid.scene.prototypes, replace(rows, position=position)
    )
    after = renewed(replace(grid, scene=scene), widened(grid, "x1"))
    assert rows.object_id[0] not in after.scene.instances["trees"].object_id


def test_how_a_city_was_made_survives_the_store(grid, tmp_path):
    write_city(grid, tmp_path / "city")
    assert read_city(tmp_path / "city").made == grid.made
    assert grid.made["nature/trees-v2"] == {"budget": 0, "street_trees": False}
