from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city import Environment
from cityx.plugins.nature.trees import species_of_tags, trees


def rows_of(city):
    rows = city.scene.instances["trees"]
    names = [city.scene.prototypes[i].name for i in rows.prototype]
    return rows, names


@pytest.fixture(scope="module")
def planted(crossroads):
    return trees(crossroads)


def test_no_trunk_stands_in_a_house_a_road_or_a_pond(planted):
    xy = planted.scene.instances["trees"].position[:, :2]
    spots = shapely.points(xy)
    for house in planted.layout.buildings.geometry:
        assert (shapely.distance(spots, house) > 0.5).all()
    assert (np.abs(xy).min(axis=1) > 5.7).all()
    assert (shapely.distance(spots, shapely.box(-60, 50, -40, 70)) > 0).all()


def test_a_mapped_tree_stands_where_it_is_mapped_and_keeps_its_genus(planted):
    rows, names = rows_of(planted)
    found = np.flatnonzero(rows.object_id == 41)
    assert len(found) == 1
    assert rows.position[found[0], :2] == pytest.approx([-60.0, -60.0], abs=0.01)
    assert names[found[0]].startswith("tree_birch")


def test_a_wood_has_more_trees_than_a_park_of_its_size(planted):
    xy = planted.scene.instances["trees"].position[:, :2]
    wood = ((xy[:, 0] < -20) & (xy[:, 1] > 30)).sum()
    park = ((xy[:, 0] > 20) & (xy[:, 1] > 30)).sum()
    assert wood > 2 * park > 10


def test_a_row_has_a_tree_every_eight_metres(planted):
    xy = planted.scene.instances["trees"].position[:, :2]
    row = np.sort(xy[np.abs(xy[:, 1] + 80) < 0.1, 0])
    assert np.diff(row).max() < 17.0
    assert len(row) >= 9


def test_the_order_of_rows_changes_nothing(planted, shuffled):
    a, b = planted.scene.instances["trees"], trees(shuffled).scene.instances["trees"]
    for name in ("object_id", "position", "scale", "tint", "rotation"):
        assert np.array_equal(getattr(a, name), getattr(b, name))


def test_ids_are_unique_and_sorted(planted):
    ids = planted.scene.instances["trees"].object_id
    assert (np.diff(ids.astype(object)) > 0).all()


def test_deciduous_trees_are_bare_under_snow(crossroads):
    _, names = rows_of(trees(replace(crossroads, environment=Environment(snow=0.8))))
    limes = [n for n in names if "lime" in n]
    assert limes
    assert all("bare" in n for n in limes)


def test_the_lowest_detail_has_no_trees_and_the_next_has_light_ones(crossroads):
    assert "trees" not in trees(replace(crossroads, lod=0)).scene.instances
    _, names = rows_of(trees(replace(crossroads, lod=1)))
    assert all("near" not in n for n in names)


def test_a_budget_widens_woods_instead_of_overrunning(crossroads):
    few = trees(crossroads, budget=40, street_trees=False).scene.instances["trees"].count
    assert few < 150


def test_tags_that_are_no_json_name_no_species():
    assert species_of_tags("{broken") == ""
    assert species_of_tags('{"species": "Quercus robur"}') == "oak"
    assert species_of_tags('{"leaf_type": "needleleaved"}') == "spruce"
