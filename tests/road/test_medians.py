import numpy as np
import pytest
import shapely

from cityx.city.ground import LABEL
from cityx.ground.arrangement import check_arrangement, face_areas
from cityx.road.ground.ground_surface import ground_of
from cityx.road.network.medians import twins_of
from cityx.road.network.network import road_network
from cityx.road.surface.carriageway import build_carriageway

ONE = {"oneway": True, "name": "Allee", "lanes": 2}


def pair(gap, **options):
    apart = 6.0 + gap
    return [([(-90, 0), (90, 0)], ONE), ([(90, apart), (-90, apart)], ONE | options)]


def areas(found):
    total = np.bincount(found.face_label, face_areas(found), minlength=len(LABEL))
    return {name: total[label] for name, label in LABEL.items()}


def test_two_directions_of_one_road_are_twins(layout_of):
    layout = layout_of(pair(4.0))
    twins = twins_of(layout, road_network(layout))
    assert len(twins.first) == 1
    assert twins.gap == pytest.approx([4.0])
    assert twins.side.tolist() == [[1.0, 1.0]]


def test_carriageways_drawn_nearer_than_they_are_wide_share_the_room_between_them(layout_of):
    twins = twins_of(layout := layout_of(pair(-0.5)), network := road_network(layout))
    assert twins.gap == pytest.approx([0.0])
    assert network.half_width.tolist() == pytest.approx([2.75, 2.75])
    found = ground_of(layout)
    assert check_arrangement(found) == (0, 0, 0.0)
    # Two lanes of 2.4 m are the least that each of them keeps.
    assert road_network(layout_of(pair(-3.0))).half_width.tolist() == pytest.approx([2.4, 2.4])


@pytest.mark.parametrize("options", [{"name": "Gasse"}, {"oneway": False}])
def test_roads_of_other_names_or_both_directions_are_not(layout_of, options):
    layout = layout_of(pair(4.0, **options))
    assert not len(twins_of(layout, road_network(layout)).first)


def test_parallel_one_way_streets_in_one_direction_are_not(layout_of):
    streets = [([(-90, y), (90, y)], ONE) for y in (0, 10)]
    layout = layout_of(streets)
    assert not len(twins_of(layout, road_network(layout)).first)


@pytest.mark.parametrize(
    ("gap", "label"), [(0.8, "gutter"), (2.0, "plaza"), (4.0, "grass"), (12.0, "grass")]
)
def test_what_lies_between_them_follows_the_width(layout_of, gap, label):
    rungs = [([(x, 0), (x, 6.0 + gap)], {}) for x in (-90, 90)]
    found = ground_of(layout_of(pair(gap) + rungs))
    assert check_arrangement(found) == (0, 0, 0.0)
    middle = found.vertices[found.triangles].mean(axis=1)
    inside = (np.abs(middle[:, 1] - 3.0 - gap / 2) < gap / 2 - 0.2) & (np.abs(middle[:, 0]) < 60)
    labels = found.face_label[found.triangle_face[inside]]
    assert set(labels.tolist()) <= {LABEL[label]}
    if label in ("plaza", "grass"):
        assert areas(found)[label] == pytest.approx((gap - 0.3) * 160, rel=0.1)


@pytest.mark.parametrize("gap", [2.5, 4.0, 5.5])
def test_a_median_has_round_noses_as_wide_as_itself(layout_of, gap):
    apart = 6.0 + gap
    across = [(0, -90), (0, 0), (0, apart), (0, 90)]
    streets = [([(-90, 0), (0, 0), (90, 0)], ONE),
               ([(90, apart), (0, apart), (-90, apart)], ONE), (across, {})]  # fmt: skip
    layout = layout_of(streets)
    network = road_network(layout)
    road = build_carriageway(layout, network, np.ones(network.edge_count, bool))
    between = shapely.box(3, 3, 40, 3 + gap)
    median = shapely.difference(between, shapely.union_all(road.driven))
    nose = shapely.box(0, 0, median.bounds[0] + gap / 2, 90)
    half_disc = np.pi * (gap / 2) ** 2 / 2
    assert shapely.intersection(median, nose).area == pytest.approx(half_disc, rel=0.1)
    assert shapely.get_type_id(median) == 3
