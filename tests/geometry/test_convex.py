import numpy as np
import pytest

from cityx.geometry.convex import (
    THIN,
    Box,
    Cylinder,
    Hull,
    box_round,
    fewer_corners,
    hull_of,
    hulls_round,
    simplest,
)

CUBE = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], float)


def turned(points, angle):
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def ring(sides, radius, height):
    angle = np.arange(sides) * 2 * np.pi / sides
    flat = radius * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    return np.concatenate([flat, flat + np.array([0, 0, height])])


def ball(count):
    points = np.random.default_rng(3).normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


def test_a_hull_holds_its_points_and_tells_what_is_outside():
    hull = hull_of([*CUBE, (0.5, 0.5, 0.5)])
    assert len(hull.points) == 8
    assert hull.volume == pytest.approx(1.0)
    np.testing.assert_allclose(
        hull.outside(np.array([(0.5, 0.5, 0.9), (0.5, 0.5, 3.0)])), [-0.1, 2.0], atol=1e-9
    )


@pytest.mark.parametrize("flat", [CUBE[:1], CUBE[:2], CUBE[CUBE[:, 2] == 0]])
def test_what_is_flat_gets_a_thickness(flat):
    hull = hull_of(flat)
    assert hull.volume > 0
    assert np.ptp(hull.points[:, 2]).min() >= THIN - 1e-9
    assert hull.outside(flat).max() < 0


@pytest.mark.parametrize("size", [(1, 1, 1), (0.2, 12, 3)])
def test_a_hull_in_few_corners_holds_the_one_of_many(size):
    points = ball(600) * size
    hull = hull_of(points)
    few = fewer_corners(hull)
    assert len(few.points) < len(hull.points) / 3
    assert few.outside(points).max() < 1e-5
    assert few.volume < 1.25 * hull.volume


def test_a_turned_beam_is_taken_for_a_box_of_its_size():
    box = simplest(hull_of(turned(CUBE * (6, 2, 1), 0.3)))
    assert isinstance(box, Box)
    np.testing.assert_allclose(box.half, (3, 1, 0.5))
    assert box.yaw == pytest.approx(0.3)
    assert hull_of(box.corners()).outside(turned(CUBE * (6, 2, 1), 0.3)).max() < 1e-6


def test_a_box_needs_no_turn_where_its_sides_lie_along_the_axes():
    box = box_round(CUBE * (2, 5, 1))
    assert box.yaw == pytest.approx(0.0)
    np.testing.assert_allclose(box.half, (1, 2.5, 0.5))


def test_a_post_of_eight_sides_is_taken_for_a_cylinder_and_a_square_one_for_a_box():
    post = simplest(hull_of(ring(8, 0.1, 4)))
    assert isinstance(post, Cylinder)
    assert (post.radius, post.half_height) == (pytest.approx(0.1), 2.0)
    assert isinstance(simplest(hull_of(ring(4, 0.1, 4))), Box)


def test_a_wedge_stays_a_hull():
    wedge = hull_of(CUBE[[0, 1, 2, 4, 5, 6]])
    assert isinstance(simplest(wedge), Hull)


def test_a_mast_and_its_arm_stay_apart_and_the_planks_of_a_seat_become_one():
    mast, arm = CUBE * (0.2, 0.2, 8), CUBE * (3, 0.1, 0.1) + (0, 0, 7.9)
    assert len(hulls_round([mast, arm], most=4, slack=0.04)) == 2
    planks = [CUBE * (1.8, 0.1, 0.04) + (0, 0.12 * row, 0.4) for row in range(4)]
    (seat,) = hulls_round(planks, most=4, slack=0.2)
    assert seat.volume == pytest.approx(1.8 * 0.46 * 0.04)


def test_no_more_hulls_are_made_than_asked_and_they_hold_every_piece():
    pieces = [CUBE + np.array([3 * i, 5 * (i % 2), 0]) for i in range(6)]
    hulls = hulls_round(pieces, most=2, slack=0.0)
    assert len(hulls) == 2
    outside = np.min([hull.outside(np.concatenate(pieces)) for hull in hulls], axis=0)
    assert outside.max() < 1e-9
