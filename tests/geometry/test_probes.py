"""Ways to segments: where they end, beside shapely."""

import numpy as np
import pytest
import shapely

from cityx.geometry.probes import FIRST, nearest_on, segments_of, way_to


@pytest.mark.parametrize("reach", [0.8 * FIRST, 12.0])
@pytest.mark.parametrize("seed", range(5))
def test_ways_end_where_shapely_says(seed, reach):
    rng = np.random.default_rng(seed)
    lines = shapely.linestrings(rng.uniform(-30, 30, (60, 3, 2)))
    start, turn = rng.uniform(-30, 30, (400, 2)), rng.uniform(0, 2 * np.pi, 400)
    way = np.column_stack([np.cos(turn), np.sin(turn)])
    probes = shapely.linestrings(np.stack([start, start + reach * way], axis=1))
    met = shapely.intersection(probes, shapely.union_all(lines))
    gap = shapely.distance(shapely.points(start), met)  # NaN where nothing is met
    room = way_to(segments_of(lines), start, way, reach)
    assert np.isfinite(gap).sum() > 20
    assert np.allclose(room, np.where(np.isnan(gap), reach, gap), atol=1e-9)


def test_ways_along_through_and_from_segments():
    bars = segments_of([shapely.LineString([(3, 0), (7, 0)]), shapely.LineString([(0, 2), (0, 4)])])
    start = np.array([[0.0, 0.0], [5.0, 0.0], [9.0, 0.0], [0.0, 0.0], [0.0, 5.0], [0.0, 3.0]])
    way = np.array([[1.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 0.0]])
    room = way_to(bars, start, way, 9.0)
    assert np.allclose(room, [3.0, 0.0, 2.0, 2.0, 1.0, 0.0])


def test_nothing_bars_a_way_where_nothing_is():
    start = np.zeros((3, 2))
    way = np.tile([1.0, 0.0], (3, 1))
    assert (way_to(segments_of([]), start, way, 4.0) == 4.0).all()
    assert way_to(
        segments_of([shapely.LineString([(0, 0), (1, 1)])]), start[:0], way[:0], 4.0
    ).shape == (0,)


def test_nearest_points_are_those_of_shapely():
    rng = np.random.default_rng(3)
    ends, xy = rng.uniform(-5, 5, (300, 2, 2)), rng.uniform(-8, 8, (300, 2))
    ends[0, 1] = ends[0, 0]  # of no length
    xy[1] = [40.0, 3.0]  # far from all
    lines = shapely.linestrings(ends)
    foot = nearest_on(segments_of(lines), xy)
    assert np.allclose(
        np.hypot(*(foot - xy).T), shapely.distance(shapely.points(xy), shapely.union_all(lines))
    )
