import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from cityx.geometry.scatter import (
    cells_of_boxes,
    cells_of_polygons,
    cells_of_triangles,
    near_pairs,
    nearby_order,
    poisson_disk,
    poisson_in,
    spread,
    thinned,
)

WHOLE = (-200.0, -200.0, 200.0, 200.0)


def test_no_two_points_are_closer_than_the_radius():
    points = poisson_disk(WHOLE, 4.0, seed=1, purpose="t")
    assert cKDTree(points.xy).query(points.xy, k=2)[0][:, 1].min() >= 4.0


def test_the_set_is_nearly_full():
    points = poisson_disk(WHOLE, 4.0, seed=1, purpose="t")
    assert 0.48 < len(points.id) * 16.0 / 160_000.0 < 0.60
    grid = np.stack(np.meshgrid(*[np.linspace(-190, 190, 96)] * 2), -1).reshape(-1, 2)
    gap, _ = cKDTree(points.xy).query(grid)
    assert np.mean(gap > 6.0) < 0.01  # hardly a hole where another point would fit twice


@settings(max_examples=15, deadline=None, derandomize=True)
@given(st.floats(-190, 100), st.floats(-190, 100), st.floats(5, 90), st.floats(5, 90))
def test_a_window_holds_exactly_the_points_of_the_whole(x, y, width, depth):
    whole = poisson_disk(WHOLE, 4.0, seed=3, purpose="t")
    part = poisson_disk((x, y, x + width, y + depth), 4.0, seed=3, purpose="t")
    inside = (whole.xy >= [x, y]).all(axis=1) & (whole.xy < [x + width, y + depth]).all(axis=1)
    assert np.array_equal(whole.xy[inside], part.xy)
    assert np.array_equal(whole.id[inside], part.id)


def test_36_tiles_made_apart_equal_the_single_run():
    whole = poisson_disk((0, 0, 600, 600), 4.0, seed=3, purpose="t")
    tiles = [
        poisson_disk((x, y, x + 100, y + 100), 4.0, seed=3, purpose="t")
        for x in range(0, 600, 100)
        for y in range(0, 600, 100)
    ]
    ids = np.concatenate([tile.id for tile in tiles])
    order = np.argsort(ids)
    assert np.array_equal(ids[order], whole.id)
    assert np.array_equal(np.concatenate([tile.xy for tile in tiles])[order], whole.xy)


def test_density_varies_over_the_plane_and_tiles_agree_on_it():
    def density(xy):
        return np.clip(xy[:, 0] / 600.0, 0, 1)

    def made(bounds):
        points = poisson_disk(bounds, 4.0, seed=3, purpose="t")
        return thinned(points, density(points.xy), seed=3, purpose="t")

    whole = made((0, 0, 600, 600))
    share = np.histogram(whole.xy[:, 0], bins=3, range=(0, 600))[0]
    assert share / share.sum() == pytest.approx([1 / 9, 3 / 9, 5 / 9], abs=0.02)
    halves = [made((0, 0, 300, 600)), made((300, 0, 600, 600))]
    assert np.array_equal(np.sort(np.concatenate([h.id for h in halves])), whole.id)


SHAPES = [shapely.Point(-90, 40).buffer(60), shapely.box(100, -150, 180, -20)]


def test_points_in_polygons_keep_inside_and_apart():
    points = poisson_in(SHAPES, 4.0, seed=3, purpose="t")
    assert shapely.contains(shapely.union_all(SHAPES), shapely.points(points.xy)).all()
    assert cKDTree(points.xy).query(points.xy, k=2)[0][:, 1].min() >= 4.0
    area = shapely.area(SHAPES).sum()
    assert 0.48 < len(points.id) * 16.0 / area < 0.65


@settings(max_examples=15, deadline=None, derandomize=True)
@given(st.floats(-150, 100), st.floats(-190, 50), st.floats(20, 150), st.floats(20, 150))
def test_a_window_on_polygons_holds_exactly_the_points_of_the_whole(x, y, width, depth):
    window = (x, y, x + width, y + depth)
    whole = poisson_in(SHAPES, 4.0, seed=3, purpose="t")
    part = poisson_in(SHAPES, 4.0, seed=3, purpose="t", bounds=window)
    inside = (whole.xy >= window[:2]).all(axis=1) & (whole.xy < window[2:]).all(axis=1)
    assert np.array_equal(whole.id[inside], part.id)


def test_the_order_of_polygons_changes_nothing():
    one = poisson_in(SHAPES, 4.0, seed=3, purpose="t")
    assert np.array_equal(one.xy, poisson_in(SHAPES[::-1], 4.0, seed=3, purpose="t").xy)


def test_seed_and_purpose_give_other_points():
    one = poisson_disk(WHOLE, 8.0, seed=3, purpose="t")
    for other in (poisson_disk(WHOLE, 8.0, seed=4, purpose="t"),
                  poisson_disk(WHOLE, 8.0, seed=3, purpose="u")):  # fmt: skip
        assert not np.isin(one.id, other.id).any()


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.integers(1, 120), st.floats(0.5, 30))
def test_near_pairs_are_those_of_a_brute_force_search(seed, count, radius):
    xy = np.random.default_rng(seed).uniform(-20, 20, (count, 2))
    distance = np.linalg.norm(xy[:, None] - xy[None], axis=2)
    expected = {(i, j) for i, j in np.argwhere(distance < radius).tolist() if i < j}
    found = [tuple(sorted(pair)) for pair in near_pairs(xy, radius).tolist()]
    assert set(found) == expected
    assert len(found) == len(expected)


def test_nothing_comes_of_no_polygon():
    assert len(poisson_in([], 4.0, seed=0, purpose="t").id) == 0
    assert len(poisson_in([shapely.Polygon()], 4.0, seed=0, purpose="t").id) == 0


def test_a_square_kilometre_takes_little_time():
    import time

    start = time.process_time()
    count = len(poisson_disk((0, 0, 1000, 1000), 3.0, seed=0, purpose="t").id)
    assert count > 50_000
    assert time.process_time() - start == pytest.approx(0, abs=6.0)  # 1 s here; a wide margin


def test_cells_of_triangles_are_those_that_hold_a_point_of_one():
    rng = np.random.default_rng(5)
    corners = rng.uniform(-40, 40, (60, 1, 2)) + rng.uniform(-15, 15, (60, 3, 2))
    a, b, c = corners.transpose(1, 0, 2)
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    corners[turned] = corners[turned][:, ::-1]
    found = cells_of_triangles(corners, 4.0)
    assert np.array_equal(found, cells_of_polygons(shapely.polygons(corners), 4.0))
    assert len(cells_of_triangles(np.zeros((0, 3, 2)), 4.0)) == 0


def test_cells_of_polygons_are_those_a_search_of_all_finds():
    rng = np.random.default_rng(7)
    lines = [shapely.LineString(rng.uniform(-300, 300, (9, 2))) for _ in range(4)]
    shapes = [
        *shapely.buffer(lines, 3.0),
        shapely.Point(30, 40).buffer(170),
        shapely.MultiPoint([(-250, -250), (250, 270)]).buffer(9),
        shapely.box(3, 4, 5, 190),
    ]
    i, j = np.meshgrid(np.arange(-110, 110), np.arange(-110, 110), indexing="ij")
    every = np.column_stack([i.ravel(), j.ravel()])
    boxes = shapely.box(*(every * 3.0).T, *((every + 1) * 3.0).T)
    met = np.unique(shapely.STRtree(boxes).query(shapes, predicate="intersects")[1])
    assert np.array_equal(cells_of_polygons(shapes, 3.0), every[met])


def test_cells_along_a_line_cost_by_its_length_and_not_by_its_bounds(monkeypatch):
    asked = []
    box = shapely.box
    monkeypatch.setattr(shapely, "box", lambda *a: (asked.append(len(a[0])), box(*a))[1])
    counts = []
    for size in (1000.0, 4000.0):
        asked.clear()
        cells_of_polygons([shapely.LineString([(0, 0), (size, size)]).buffer(0.5)], 1.1)
        counts.append(sum(asked))
    assert counts[1] / counts[0] == pytest.approx(4.0, abs=0.3)  # of all cells it would be 16


def test_cells_of_boxes_hold_all_their_points():
    boxes = np.array([[-0.5, 0.2, 1.5, 0.8], [7.0, 7.0, 7.5, 9.5], [0.1, 0.1, 0.2, 0.2]])
    assert cells_of_boxes(boxes, 1.0).tolist() == [[-1, 0], [0, 0], [1, 0], [7, 7], [7, 8], [7, 9]]


@pytest.mark.parametrize("count", [16, 100, 1000])
def test_any_beginning_of_a_sequence_fills_the_interval(count):
    gaps = np.diff(np.sort(spread(3, "test", np.arange(count))[:, 0]), prepend=0.0, append=1.0)
    assert gaps.max() < 3.0 / count


def test_points_of_a_square_are_spread_better_than_by_chance():
    points = spread(1, "test", np.arange(256), 2)
    cell = (points * 8).astype(int) @ [8, 1]
    assert np.bincount(cell, minlength=64).min() >= 2  # 4 on average; by chance 1 or 0
    assert np.bincount(cell, minlength=64).max() <= 6


def test_a_point_depends_on_its_number_alone():
    whole = spread(2, "test", np.arange(50), 3)
    assert spread(2, "test", [7, 41], 3) == pytest.approx(whole[[7, 41]], abs=0)
    assert not np.allclose(spread(3, "test", [7, 41], 3), whole[[7, 41]])


def test_neighbours_stay_together():
    x, y = np.meshgrid(np.arange(16.0), np.arange(16.0))
    places = np.column_stack([x.ravel(), y.ravel()])
    order = nearby_order(places)
    assert sorted(order) == list(range(256))
    steps = np.linalg.norm(np.diff(places[order], axis=0), axis=1)
    rows = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert np.median(steps) == 1.0
    assert steps.max() <= rows.max()
    four = places[order].reshape(-1, 4, 2)
    assert np.ptp(four, axis=1).max() == 1.0  # every four lie in a square


def test_no_points_have_no_order():
    assert len(nearby_order(np.zeros((0, 2)))) == 0
