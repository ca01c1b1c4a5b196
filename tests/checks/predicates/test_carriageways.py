"""The two carriageways of one street are one street."""

import numpy as np
import shapely

from cityx.checks.predicates.street_predicates import carriageways

EAST = shapely.linestrings([[0, 0], [300, 0]])
BACK = shapely.linestrings([[300, 12], [0, 12]])


def pairs(lines, names=("A1", "A1"), kinds=("motorway", "motorway"), oneway=(True, True)):
    table = (np.array(kinds), np.array(names), np.array(oneway))
    return carriageways(np.array(lines), *table).tolist()


def test_ways_side_by_side_that_lead_opposite_ways_are_one_street():
    assert pairs([EAST, BACK]) == [[0, 1]]


def test_other_names_classes_and_directions_are_other_streets():
    assert pairs([EAST, BACK], names=("A1", "A2")) == []
    assert pairs([EAST, BACK], names=("", "")) == []
    assert pairs([EAST, BACK], kinds=("motorway", "trunk")) == []
    assert pairs([EAST, BACK], oneway=(True, False)) == []
    assert pairs([EAST, shapely.reverse(BACK)]) == []


def test_streets_far_apart_are_two():
    far = shapely.linestrings([[300, 80], [0, 80]])
    assert pairs([EAST, far]) == []
