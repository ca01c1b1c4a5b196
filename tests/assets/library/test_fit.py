from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from shapely.affinity import rotate

from cityx.assets.library.fit import (
    OVERLAP,
    PLACED,
    REASONS,
    SHAPE,
    SIZE,
    Assets,
    Lots,
    place,
    targets_of,
)


def lots_at(shapes, *, street=-np.pi / 2, use="", height=np.nan):
    count = len(shapes)
    return Lots(
        np.arange(1, count + 1, dtype=np.uint64) * np.uint64(7919), np.array(shapes, object),
        np.broadcast_to(np.asarray(street, float), (count,)).copy(),
        np.full(count, use), np.full(count, height), np.zeros(count, np.int64),
    )  # fmt: skip


def boxes(sizes, **more):
    """Assets whose front, to the south, is the first side."""
    front, depth = np.array(sizes, float).T
    count = len(front)
    words = np.full(count, "")
    made = Assets(
        front, depth, np.zeros((count, 2)), np.full(count, -np.pi / 2),
        shapely.box(-front / 2, -depth / 2, front / 2, depth / 2), np.full(count, 9.0),
        np.full(count, 3.0), words, words, np.zeros(count, np.int64), np.zeros(count),
    )  # fmt: skip
    return replace(made, **more)


def many_boxes(count, seed=0):
    rng = np.random.default_rng(seed)
    return boxes(np.exp(rng.normal(2.4, 0.4, (count, 2))))


def test_the_scale_keeps_both_sides_within_the_lot():
    found = place(lots_at([shapely.box(0, 0, 10, 20)]), boxes([(11, 20), (10, 25)]))
    assert found.asset.tolist() == [0]
    assert found.scale[0] == pytest.approx(10 / 11)


def test_the_asset_nearest_in_size_wins():
    found = place(lots_at([shapely.box(0, 0, 10, 10)]), boxes([(11.5, 11.5), (10.2, 10.2), (9, 9)]))
    assert found.asset.tolist() == [1]


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.floats(0, 360), st.floats(6, 30), st.floats(6, 30), st.floats(-np.pi, np.pi))
def test_centres_meet_fronts_face_the_street_and_the_outline_stays_inside(turn, x, y, street):
    lot = rotate(shapely.box(100, 50, 100 + x, 50 + y), turn)
    found = place(lots_at([lot], street=street), boxes([(x, y), (y, x)]))
    assert found.reason.tolist() == [PLACED]
    outline = found.outline[0]
    assert outline.centroid.distance(lot.centroid) < 1e-6
    assert outline.difference(lot.buffer(0.3)).area < 1e-9
    front = found.theta[0] - np.pi / 2
    assert np.cos(front - street) > np.cos(np.pi / 4) - 1e-6


def test_outlines_far_from_a_rectangle_are_left_to_the_generator():
    tee = shapely.Polygon([(0, 0), (30, 0), (30, 6), (18, 6), (18, 30), (12, 30), (12, 6), (0, 6)])
    found = place(lots_at([tee]), many_boxes(400))
    assert found.reason.tolist() == [SHAPE]
    assert found.counts() == {REASONS[SHAPE]: 1}


def test_a_small_notch_is_built_beside():
    notched = shapely.box(0, 0, 20, 12).difference(shapely.box(18, 0, 20, 6))
    found = place(lots_at([notched]), many_boxes(3000))
    assert found.reason.tolist() == [PLACED]
    assert found.outline[0].difference(notched.buffer(0.3)).area < 1e-9


def test_no_asset_of_another_use_or_size_is_taken():
    assets = boxes([(10, 10), (60, 60)], use=np.array(["worship", "house"]))
    found = place(lots_at([shapely.box(0, 0, 10, 10)], use="house"), assets)
    assert found.reason.tolist() == [SIZE]


def test_a_known_height_is_kept_within_half():
    assets = boxes([(10, 10), (9.2, 9.2)], height=np.array([30.0, 10.0]))
    found = place(lots_at([shapely.box(0, 0, 10, 10)], height=9.0), assets)
    assert found.asset.tolist() == [1]


def test_a_style_asked_for_is_taken_before_any_other():
    assets = boxes([(10, 10), (9, 9)], style=np.array(["modern", "brick"]))
    found = place(lots_at([shapely.box(0, 0, 10, 10)]), assets, style="brick")
    assert found.asset.tolist() == [1]


def test_a_description_breaks_ties():
    assets = boxes([(10, 10), (10, 10), (10, 10)], score=np.array([0.1, 0.8, 0.2]))
    assert place(lots_at([shapely.box(0, 0, 10, 10)]), assets).asset.tolist() == [1]


def test_lots_that_overlap_get_one_asset():
    lots = lots_at([shapely.box(0, 0, 10, 10), shapely.box(5, 0, 15, 10)])
    found = place(lots, boxes([(10, 10), (9.5, 9.5)]))
    assert sorted(found.reason.tolist()) == [PLACED, OVERLAP]


def test_an_asset_does_not_reach_further_into_a_carriageway_than_its_lot():
    strip = shapely.box(9.8, -50, 30, 5)
    lot = shapely.box(0, 0, 10, 10).difference(strip)
    free = place(lots_at([lot]), boxes([(10, 10)]))
    kept = place(lots_at([lot]), boxes([(10, 10)]), obstacles=np.array([strip], object))
    assert free.outline[0].intersection(strip).area > 0.5
    assert kept.outline[0].intersection(strip).area < 1e-6
    assert kept.scale[0] < free.scale[0]


def street_of(count, step=10.5):
    rng = np.random.default_rng(4)
    side = int(np.sqrt(count))
    size = rng.uniform(8, 10.4, (count, 2))
    x, y = (np.arange(count) % side) * step, (np.arange(count) // side) * step
    return lots_at(list(shapely.box(x, y, x + size[:, 0], y + size[:, 1])))


def test_no_overlap_no_twin_among_eight_neighbours_and_scales_in_the_band():
    lots = street_of(900)
    found = place(lots, many_boxes(4000))
    placed = found.asset >= 0
    assert placed.mean() > 0.98
    assert ((found.scale[placed] >= 0.85) & (found.scale[placed] <= 1.18)).all()
    shapes = found.outline[placed]
    first, second = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    pair = first < second
    assert shapely.area(shapely.intersection(shapes[first[pair]], shapes[second[pair]])).sum() == 0
    middle = shapely.get_coordinates(shapely.centroid(lots.polygon))
    near = cKDTree(middle).query(middle, k=9)[1][:, 1:]
    assert not ((found.asset[near] == found.asset[:, None]) & placed[:, None]).any()


def test_the_order_of_lots_changes_nothing():
    lots, assets = street_of(400), many_boxes(60)
    order = np.random.default_rng(1).permutation(400)
    other = Lots(**{n: getattr(lots, n)[order] for n in lots.__dataclass_fields__})
    first, second = place(lots, assets), place(other, assets)
    assert np.array_equal(first.asset[order], second.asset)
    assert np.array_equal(first.scale[order], second.scale, equal_nan=True)


def test_a_small_library_repeats_only_beyond_the_next_houses():
    lots = street_of(225)
    found = place(lots, boxes([(9 + 0.1 * i, 9) for i in range(12)]))
    middle = shapely.get_coordinates(shapely.centroid(lots.polygon))
    near = cKDTree(middle).query(middle, k=9)[1][:, 1:]
    placed = found.asset >= 0
    assert placed.mean() > 0.7
    assert not ((found.asset[near] == found.asset[:, None]) & placed[:, None]).any()


def test_a_lot_without_a_street_faces_with_a_long_side():
    target = targets_of(lots_at([shapely.box(0, 0, 30, 10)], street=np.nan))
    assert target.front.tolist() == [30.0]
    assert target.depth.tolist() == [10.0]


def test_nothing_to_place_is_no_error():
    assert len(place(lots_at([]), boxes([(1, 1)])).asset) == 0
    empty = boxes([(1, 1)])
    none = Assets(**{n: getattr(empty, n)[:0] for n in empty.__dataclass_fields__})
    assert place(lots_at([shapely.box(0, 0, 5, 5)]), none).reason.tolist() == [SIZE]
