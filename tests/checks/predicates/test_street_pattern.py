"""Patterns of streets, told by their geometry alone."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.checks.predicates.street_pattern import orientation_order, pattern_of, pieces_of
from cityx.city import City, Frame, Layout
from cityx.city.layout import make_table
from cityx.ids import stable_id

SIDE = 800.0


def city_of(lines, kinds=None, *, plaza=None):
    count = len(lines)
    roads = make_table(
        "roads", np.array([shapely.LineString(line) for line in lines], object),
        id=np.array([stable_id("street", k) for k in range(count)], np.uint64),
        kind=kinds or ["residential"] * count, width=np.full(count, 8.0), lanes=np.full(count, 2),
    )  # fmt: skip
    layout = Layout((0.0, 0.0, SIDE, SIDE), roads=roads)
    if plaza is not None:
        areas = make_table("areas", [plaza], id=[5], kind=["pedestrian"])
        layout = Layout(layout.extent, roads=roads, areas=areas)
    return City("Streets", Frame(50.0, 10.0), layout)


def grid(turn=0.0, step=100.0):
    at = np.arange(0.0, SIDE + 1, step)
    lines = [[(x, 0.0), (x, SIDE)] for x in at] + [[(0.0, y), (SIDE, y)] for y in at]
    middle = np.full(2, SIDE / 2)
    spin = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return [((np.array(line) - middle) @ spin.T + middle).tolist() for line in lines]


def wheel(spokes=8, radii=(150.0, 280.0), reach=390.0, inner=30.0):
    """Spokes that leave a square and rings round it, cut where they meet."""
    middle = np.full(2, SIDE / 2)
    angles = 2 * np.pi * np.arange(spokes) / spokes + 0.1
    way = np.column_stack([np.cos(angles), np.sin(angles)])
    stops = [inner, *radii, reach]
    lines = [
        [tuple(middle + a * w), tuple(middle + b * w)]
        for w in way for a, b in pairwise(stops)
    ]  # fmt: skip
    for radius in radii:
        for k in range(spokes):
            span = np.linspace(angles[k], angles[k] + 2 * np.pi / spokes, 7)
            lines.append((middle + radius * np.column_stack([np.cos(span), np.sin(span)])).tolist())
    return lines


def bent(count=30, seed=5):
    rng = np.random.default_rng(seed)
    lines = []
    for _ in range(count):
        start, turn = rng.uniform(0, SIDE, 2), rng.uniform(0, 2 * np.pi)
        turns = turn + np.cumsum(rng.normal(0.0, 0.35, 12))
        lines.append(start + 25.0 * np.cumsum(np.column_stack([np.cos(turns), np.sin(turns)]), 0))
    return lines


def pattern(lines):
    return pattern_of(np.array([shapely.LineString(line) for line in lines], object))


@pytest.mark.parametrize("turn", [0.0, 0.3, 0.7])
def test_a_grid_is_one_whichever_way_it_is_turned(turn):
    found = pattern(grid(turn))
    assert found.word == "grid"
    assert found.grid > 0.95


def test_spokes_and_rings_are_radial():
    assert pattern(wheel()).word == "radial"
    assert pattern(wheel(spokes=6, radii=(200.0,))).word == "radial"


def test_winding_streets_are_organic():
    assert pattern(bent()).word == "organic"


def test_no_street_has_no_pattern():
    assert pattern([]).word == ""
    assert measure("road.pattern == grid", city_of([])).met is False


def test_orientation_order_is_1_for_one_grid_and_0_for_all_directions():
    _, bearing, length = pieces_of(np.array([shapely.LineString(g) for g in grid()], object))
    assert orientation_order(bearing, length) == pytest.approx(1.0)
    every = np.linspace(0, np.pi, 360, endpoint=False)
    assert orientation_order(every, np.ones(360)) == pytest.approx(0.0, abs=0.01)


def test_avenues_and_rings_are_counted_by_their_shape():
    plaza = shapely.Point(SIDE / 2, SIDE / 2).buffer(30.0)
    city = city_of(wheel(), plaza=plaza)
    for asked in ("road.pattern == radial", "n(road, class=avenue) == 8",
                  "n(road, class=ring) == 2", "dist(plaza, center) <= 20"):  # fmt: skip
        found = measure(asked, city)
        assert found.met, found
    assert not measure("n(road, class=ring) == 2", city_of(wheel(radii=(200.0,)), plaza=plaza)).met
    assert not measure("n(road, class=avenue) == 8", city_of(wheel(spokes=7), plaza=plaza)).met
    assert not measure("n(road, class=ring) >= 1", city_of(grid(), plaza=plaza)).met


def test_an_open_ring_is_none():
    lines = wheel(radii=(250.0,))
    cut = [line for line in lines if len(line) == 2] + [line for line in lines if len(line) > 2][:5]
    plaza = shapely.Point(SIDE / 2, SIDE / 2).buffer(30.0)
    assert measure("n(road, class=ring) == 0", city_of(cut, plaza=plaza)).met


def test_a_street_of_many_ways_counts_once():
    straight = [[(x, 50.0), (x + 100.0, 50.0)] for x in np.arange(0.0, 700.0, 100.0)]
    assert measure("n(road) == 1", city_of(straight)).met
    corner = [*straight, [(700.0, 50.0), (700.0, 300.0)]]
    assert measure("n(road) == 2", city_of(corner)).met


@pytest.mark.slow
@pytest.mark.parametrize(("asked", "word"), [
    ("grid", "grid"), ("superblock", "grid"), ("radial", "radial"), ("organic", "organic"),
    ("cul_de_sac", "organic"),
])  # fmt: skip
def test_towns_are_told_by_the_pattern_they_were_laid_out_with(asked, word):
    from cityx.town.town import town

    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=1)
    city = town(city, width=1000.0, depth=1000.0, pattern=asked, density=0.6)
    found = measure(f"road.pattern == {word}", city)
    assert found.met, found
