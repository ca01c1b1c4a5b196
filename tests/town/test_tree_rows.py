"""Trees along rivers, around squares and beside railways stand there, of the kind that is asked."""

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed
from cityx.town.town import town
from cityx.town.wishes.places import places
from cityx.town.wishes.river import river
from cityx.town.wishes.tree_rows import tree_row


@pytest.fixture(scope="module")
def city():
    bare = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=5)
    return places(river(town(bare, width=400.0, depth=400.0)), kind="plaza", central=True)


@pytest.mark.parametrize("near", ["river", "plaza"])
@pytest.mark.parametrize("species", ["", "poplar"])
def test_trees_stand_free_along_a_place(city, near, species):
    changed = tree_row(city, near=near, species=species)
    added = len(changed.layout.points) - len(city.layout.points)
    assert added >= 6
    assert changed.layout.points.equals(tree_row(city, near=near, species=species).layout.points)
    made = changed.layout.points["source"].str.startswith("made/tree_row/").to_numpy(bool)
    spots = changed.layout.points.geometry.to_numpy()[made]
    stand = shapely.union_all(changed.layout.buildings.geometry.to_numpy())
    assert not shapely.intersects(spots, shapely.buffer(stand, 2.0)).any()
    apart = shapely.distance(spots[:, None], spots[None]) + 100.0 * np.eye(len(spots))
    assert apart.min() > 3.0


def test_trees_along_what_is_not_there_are_refused(city):
    with pytest.raises(ActionFailed, match="no canal"):
        tree_row(city, near="canal")


def test_the_goal_is_measured_on_the_trees_that_grow(city):
    changed = tree_row(city, near="river", species="poplar")
    assert changed.goals[-1].predicate == "near(tree, species=poplar, river, within=20) >= 6"
    assert not measure(changed.goals[-1].predicate, changed).met  # none has grown yet
