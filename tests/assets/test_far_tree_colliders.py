"""Trees drawn for the distance are stems with crowns to whoever drives past, as near ones are."""

import pytest

from cityx.assets.colliders import collider_of
from cityx.assets.trees.plants import tree
from cityx.geometry.convex import Cylinder


@pytest.mark.parametrize("species", ["oak", "spruce", "lime"])
def test_a_tree_far_off_is_a_stem_below_its_crown(species):
    stem, crown = collider_of(tree(species, form="far"))
    assert isinstance(stem, Cylinder)
    assert stem.radius < 0.6
    assert stem.half_height > 0.5
    assert crown.points[:, 2].min() >= 2 * stem.half_height - 1e-6


@pytest.mark.parametrize("species", ["acacia", "jacaranda", "cherry"])
def test_boughs_that_leave_the_trunk_below_the_leaves_belong_to_the_crown(species):
    stem, crown = collider_of(tree(species, 2, "light"))
    assert stem.radius < 0.55
    assert crown.points[:, 2].min() == pytest.approx(2 * stem.half_height, abs=1e-6)
