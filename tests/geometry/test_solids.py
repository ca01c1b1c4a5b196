from dataclasses import replace

import numpy as np
import pytest

from cityx.city.mesh import concatenate, one_mesh
from cityx.city.mesh_measures import check_closed, degenerate_faces, has_nan, plan_area, volume
from cityx.geometry.solids import open_groups, surely_open

CORNERS = np.array([[x, y, z] for z in (0, 2) for y in (0, 3) for x in (0, 4)], float)
SIDES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]]


def block(sides=SIDES, corners=CORNERS):
    return one_mesh(7, corners, sides)


def test_a_block_is_closed_and_has_its_volume_and_area():
    assert check_closed(block()).tolist() == [True]
    assert volume(block()) == pytest.approx([24.0])
    assert plan_area(block()) == pytest.approx([12.0])


def test_a_missing_side_opens_only_its_own_block():
    both = concatenate([block(), block(SIDES[:-1])])
    assert check_closed(both).tolist() == [True, False]


def test_a_side_turned_round_or_doubled_is_not_closed():
    turned = [SIDES[0][::-1], *SIDES[1:]]
    assert not check_closed(concatenate([block(turned), block([*SIDES, SIDES[0]])])).any()


def test_a_sheet_of_two_sides_within_a_block_is_not_closed():
    """All of its edges have reverses, but more than one each."""
    assert not check_closed(block([*SIDES, SIDES[0], SIDES[0][::-1]])).any()


def test_what_is_open_at_first_sight_is_open():
    rng = np.random.default_rng(5)
    both = concatenate([block([side for side in SIDES if rng.random() < 0.8]) for _ in range(40)])
    owner = both.face_object()
    found = open_groups(both.faces, owner, len(both.vertices), both.count)
    assert 0 < np.count_nonzero(found) < both.count
    assert np.array_equal(surely_open(both.faces, both.face_start, len(both.vertices)), found)


def test_a_block_turned_inside_out_has_negative_volume():
    inside_out = block([side[::-1] for side in SIDES])
    assert check_closed(inside_out).all()
    assert volume(inside_out) == pytest.approx([-24.0])


def test_volume_does_not_suffer_far_from_the_origin():
    assert volume(block(corners=CORNERS + np.array([3e5, 2e5, 100.0]))) == pytest.approx(
        [24.0], abs=1e-6
    )


def test_level_undersides_of_trim_do_not_count_as_plan():
    batch = one_mesh(1, CORNERS, SIDES, materials=("plaster", "trim"), material=[1, 0, 0, 0, 0, 0])
    assert plan_area(batch) == pytest.approx([0.0])


def test_slivers_and_missing_numbers_are_found():
    flat = block(corners=CORNERS * [1, 1, 0])
    assert degenerate_faces(flat).sum() == 4
    vertices = CORNERS.copy()
    vertices[3, 2] = np.nan
    assert has_nan(concatenate([block(), replace(block(), vertices=vertices)])).tolist() == [
        False,
        True,
    ]


def test_an_object_without_faces_is_not_closed():
    assert check_closed(one_mesh(1, CORNERS, np.zeros((0, 4)))).tolist() == [False]
