"""Ways on foot: in the walkable area throughout, over crosswalks, and none where none leads."""

import numpy as np
import pytest
import shapely
from crossing_town import crossing_town, with_post

from cityx.geometry.polylines import arc_lengths, to_linestrings
from cityx.ground.walking.crosswalks import _stretches_over
from cityx.ground.walking.sight import open_between
from cityx.ground.walking.walkable import walkable_of
from cityx.ground.walking.walks import SPACING, walk_graph, walks_between


@pytest.fixture(scope="module")
def area():
    return walkable_of(crossing_town())


def way(area, a, b):
    graph = walk_graph(area)
    ends = graph.nearest([a, b])
    lines, found = walks_between(area, ends[:1], ends[1:])
    return lines, bool(found[0])


def test_a_way_over_the_plaza_is_straight(area):
    lines, found = way(area, (10.0, 10.0), (35.0, 35.0))
    assert found
    assert arc_lengths(lines)[1][0] == pytest.approx(np.hypot(25, 25), rel=0.02)


def test_a_way_across_the_street_takes_a_crosswalk(area):
    lines, found = way(area, (30.0, 4.4), (30.0, -4.4))
    assert found
    over = area.at(area.crosswalk, lines.points)
    assert len(np.unique(over[over > 0])) == 1
    assert (over > 0).sum() * SPACING == pytest.approx(6.0, abs=1.5)


def test_every_point_of_a_way_is_free_and_the_next_is_near(area):
    lines, _ = way(area, (-60.0, 4.4), (60.0, -4.4))
    assert area.holds(lines.points).all()
    assert np.hypot(*np.diff(lines.points, axis=0).T).max() <= SPACING + 0.2


def test_a_way_goes_round_what_stands_in_it():
    posted = walkable_of(with_post(crossing_town(), 22.5, 22.5, size=4.0))
    lines, found = way(posted, (10.0, 10.0), (35.0, 35.0))
    assert found
    line = to_linestrings(lines)[0]
    assert line.distance(shapely.box(20.5, 20.5, 24.5, 24.5)) > 0.2
    assert line.length < 1.2 * np.hypot(25, 25)


def test_no_way_leads_from_one_piece_to_another():
    apart = walkable_of(crossing_town(walks=0.0, plaza=False))
    graph = walk_graph(apart)
    pieces = np.unique(graph.component, return_index=True)[1]
    lines, found = walks_between(apart, pieces[:1], pieces[:1])
    assert not found[0]
    assert lines.count == 1


def test_ways_are_the_same_together_and_alone(area):
    graph = walk_graph(area)
    ends = graph.nearest([(10.0, 10.0), (-60.0, 4.4), (30.0, -4.4)])
    both, _ = walks_between(area, ends[:2], ends[[2, 2]])
    one, _ = walks_between(area, ends[1:2], ends[2:])
    assert np.array_equal(both.points[both.start[1] :], one.points)


def test_a_closed_way_that_begins_on_a_roadway_crosses_it_once():
    # A road of two faces; one ring begins in its middle, a line crosses it and ends on it.
    road = [shapely.box(0, -20, 2, 20), shapely.box(2, -20, 6, 20)]
    ring = shapely.LineString([(3, 0), (20, 0), (20, 9), (-9, 9), (-9, 0), (3, 0)])
    ways = np.array([ring, shapely.LineString([(-5, -9), (9, -9), (9, -5), (4, -5)])], object)
    way, ends = _stretches_over(ways, np.array(road, object))
    assert way.tolist() == [0, 0, 1, 1]
    assert ends.tolist() == [[[0, 0], [6, 0]], [[6, 9], [0, 9]], [[0, -9], [6, -9]],
                             [[6, -5], [4, -5]]]  # fmt: skip
    assert _stretches_over(ways[:0], np.array(road, object))[0].tolist() == []


def test_a_way_is_looked_for_near_its_ends_first(area, monkeypatch):
    from scipy.sparse import csgraph

    searched, limits = csgraph.dijkstra, []

    def watched(*args, **options):
        limits.append(options["limit"])
        return searched(*args, **options)

    monkeypatch.setattr(csgraph, "dijkstra", watched)
    assert way(area, (10.0, 10.0), (35.0, 35.0))[1]
    assert len(limits) == 1
    assert limits[0] < 2.6 * np.hypot(25, 25)
    assert way(area, (30.0, 4.4), (30.0, -4.4))[1]  # by a crosswalk far from both
    assert limits[-1] == np.inf


def test_lines_between_cells_do_not_pass_through_the_corner_of_two():
    free = np.ones((6, 6), bool)
    free[2, 3] = False
    cells = np.array([[2, 2], [3, 3], [2, 4], [0, 0], [5, 0]])
    pairs = np.array([[0, 1], [0, 2], [3, 4], [3, 0]])
    assert open_between(free, cells, pairs, 8).tolist() == [False, False, True, True]
