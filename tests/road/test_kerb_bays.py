"""Lanes of parked cars: where they begin, what is painted and laid, and what stands in them."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.vehicles.car_bodies import BODIES
from cityx.city import Frame
from cityx.city.ground import LABEL
from cityx.road.ground.ground_surface import ground_of
from cityx.road.network.network import road_network
from cityx.road.network.sections import bands_of
from cityx.road.parking.kerb_bays import BAY, FROM_CROSSING, FROM_JUNCTION, bay_marks, runs_of
from cityx.road.parking.parked_cars import parked_cars

BOTH = {"width": 9.4, "parking_left": True, "parking_right": True}
ALONG = [(-90, 0), (90, 0)]
TEE = [[(-90, 0), (0, 0)], [(0, 0), (90, 0)], [(0, 0), (0, -90)]]


def runs(layout):
    network = road_network(layout)
    return network, runs_of(network, bands_of(layout, network))


def test_cars_keep_off_junctions_and_crossings_but_not_off_mere_joints(layout_of):
    layout = layout_of([(line, BOTH) for line in TEE])
    network, found = runs(layout)
    assert len(found.edge) == 6
    gap = np.where(network.crossing[0, 1], FROM_CROSSING, FROM_JUNCTION)
    rows = found.edge == 0
    length = 90.0
    assert found.high[rows] == pytest.approx(length - network.trim[0, 1] - gap)
    halves = layout_of([([(-90, 0), (0, 0)], BOTH), ([(0, 0), (90, 0)], BOTH | {"width": 9.6})])
    network, found = runs(halves)
    assert network.edge_count == 2
    assert (length - found.high[found.edge == 0]).max() < 1.0


def test_lanes_lie_at_the_kerbs_and_bays_fill_them(layout_of):
    _, found = runs(layout_of([(ALONG, BOTH)]))
    assert sorted(found.side.tolist()) == [-1, 1]
    assert np.abs(found.kerb) == pytest.approx(4.7)
    assert np.abs(found.road) == pytest.approx(2.6)
    run, number, middle = found.bays()
    for row in range(2):
        place = middle[run == row]
        assert np.diff(place) == pytest.approx(BAY)
        assert place[0] - BAY / 2 >= found.low[row] - 1e-6
        assert place[-1] + BAY / 2 <= found.high[row] + 1e-6
        assert found.high[row] - found.low[row] - len(place) * BAY < BAY
        assert number[run == row].tolist() == list(range(len(place)))


@pytest.mark.parametrize("style", ["stalls", "outline", "line"])
def test_paint_stays_in_the_lane_and_says_what_the_country_says(layout_of, style):
    network, found = runs(layout_of([(ALONG, BOTH)]))
    marks, edge = bay_marks(network.lines, found, style)
    assert len(marks) == len(edge)
    low, high = shapely.bounds(marks)[:, [1, 3]].T
    away = np.maximum(np.abs(low), np.abs(high))
    assert away.max() <= 4.7
    assert np.minimum(np.abs(low), np.abs(high)).min() >= 2.6 - 0.06
    bays = len(found.bays()[0])
    along = shapely.bounds(marks)[:, 2] - shapely.bounds(marks)[:, 0]
    if style == "stalls":
        assert len(marks) == bays + 2
        assert along.max() == pytest.approx(0.12, abs=1e-6)
    if style == "line":
        assert len(marks) == 2
        assert along.sum() == pytest.approx(bays * BAY)
    if style == "outline":  # broken: two thirds are painted, and nothing from car to car
        row = along > 0.3
        assert along[row].sum() == pytest.approx(bays * BAY * 2 / 3, rel=0.03)
        assert (~row).sum() == 2 * 2 * 2


def test_beside_setts_cars_stand_on_small_stones_behind_a_gutter_of_large_ones(layout_of):
    found = ground_of(layout_of([(ALONG, BOTH | {"surface": "sett"})]))
    size = {name: area(found, name) for name in ("parking_lane", "gutter")}
    length = 180 - 2 * FROM_JUNCTION
    assert size["parking_lane"] == pytest.approx(2 * (2.1 - 0.32 - 0.32) * length, rel=0.03)
    plain = ground_of(layout_of([(ALONG, BOTH)]))
    more = size["gutter"] - area(plain, "gutter")  # than those along the kerbs
    assert more == pytest.approx(2 * 0.32 * length, rel=0.03)
    assert not plain.labelled("parking_lane").any()


def area(ground, name):
    corner = ground.vertices[ground.triangles]
    one, other = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    size = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2
    return size[ground.face_label[ground.triangle_face] == LABEL[name]].sum()


def test_cars_stand_within_their_lane_and_fill_it_as_asked(layout_of, city_of):
    layout = layout_of([(ALONG, BOTH)])
    city = replace(city_of(layout, lod=2), network=road_network(layout))
    count = [parked_cars(city, occupancy=share).scene.instances["vehicles"].count
             for share in (0.4, 1.0)]  # fmt: skip
    assert count[1] == len(runs(layout)[1].bays()[0])
    assert 0.2 * count[1] < count[0] < 0.6 * count[1]
    usual = parked_cars(city)
    rows = usual.scene.instances["vehicles"]
    assert 0.75 * count[1] < rows.count <= count[1]
    names = [usual.scene.prototypes[i].name for i in rows.prototype]
    assert all("_eu" in name for name in names)
    assert len(set(names)) > 6
    width = np.array([BODIES[name[4:].rpartition("_")[0]].width for name in names])
    off = np.abs(rows.position[:, 1])
    assert (4.7 - off - width / 2 > 0.03).all()  # from the kerb
    assert (off - width / 2 > 2.6 - 0.12).all()  # wheels in the lane
    again = parked_cars(city).scene.instances["vehicles"]
    assert again.position.tobytes() == rows.position.tobytes()
    assert again.prototype.tobytes() == rows.prototype.tobytes()


def test_small_vans_deliver_at_the_left_of_one_way_streets_of_japan(layout_of, city_of):
    layout = layout_of([(ALONG, {"width": 6.4, "oneway": True, "lanes": 1, "lanes_forward": 1})])
    network = road_network(layout, left_hand=True)
    city = replace(city_of(layout, lod=2), network=network)
    assert not parked_cars(city).scene.instances.get("vehicles")
    count = 0
    for seed in range(6):
        tokyo = parked_cars(replace(city, frame=Frame(35.69, 139.78), seed=seed))
        rows = tokyo.scene.instances.get("vehicles")
        if rows is None:
            continue
        count += rows.count
        names = {tokyo.scene.prototypes[i].name for i in rows.prototype}
        assert names == {"car_kei_van_jp"}
        free = rows.position[:, 1] - BODIES["kei_van"].width / 2  # the left of a street to the east
        assert (free > 1.25).all()  # half a lorry in the middle of the street
    assert 6 <= count <= 48  # one in 45 m, of 6 streets of 180 m
