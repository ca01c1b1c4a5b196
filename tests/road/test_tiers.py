import numpy as np
import pytest

from cityx.city.terrain import flat_terrain
from cityx.geometry.polylines import arc_lengths
from cityx.places.profiles import profile_named
from cityx.road.ground.beds import bed_slots
from cityx.road.ground.yards import grounds_digest, yard_patches
from cityx.road.heights.tiers import Spans, cut_network, level_network, spans_of
from cityx.road.heights.way_heights import way_heights
from cityx.road.network.network import road_network

LAND = profile_named("world").land

LONG = (-400, -400, 400, 400)
BRIDGE = [([(-20, 0), (20, 0)], {"bridge": True, "layer": 1}), ([(-390, 0), (-20, 0)], {}),
          ([(20, 0), (390, 0)], {}), ([(0, -400), (0, 400)], {})]  # fmt: skip


@pytest.fixture
def solved(layout_of):
    layout = layout_of(BRIDGE, extent=LONG)
    network, heights, _, _ = way_heights(layout, road_network(layout), flat_terrain())
    return layout, network, heights


def test_the_pieces_on_the_ground_are_what_is_left_of_bridge_and_ramps(solved):
    _, network, heights = solved
    level = level_network(network, heights)
    spans = spans_of(network, heights)
    size = (spans.end - spans.begin)[~spans.off].sum()
    assert arc_lengths(level.lines)[1].sum() == pytest.approx(size)
    assert size < arc_lengths(network.lines)[1].sum() - 40.0
    assert np.abs(level.lift).max() < 0.5


def test_they_are_one_network_for_all_who_ask(solved):
    layout, network, heights = solved
    level = level_network(network, heights)
    assert level_network(network, heights) is level
    assert grounds_digest(layout, level) != grounds_digest(layout, network)


def test_without_heights_all_lies_on_the_ground(solved):
    assert level_network(solved[1], None) is solved[1]


def test_what_stands_beside_both_pieces_of_a_cut_street_has_ids_of_its_own(layout_of):
    houses = [(x, y, x + 14, y + 8) for x in range(-290, 280, 40) for y in (32, -40)]
    layout = layout_of([([(-300, 0), (300, 0)], {})], houses=houses, extent=(-320, -90, 320, 90))
    network = road_network(layout)
    assert network.edge_count == 1
    off = np.array([False, True, False])
    spans = Spans(
        np.zeros(3, np.int64), np.array([0.0, 240, 360]), np.array([240.0, 360, 600]), off
    )
    level = cut_network(network, spans, np.flatnonzero(~off))
    beds, yards = bed_slots(layout, level), yard_patches(layout, level, LAND)
    for middle, ids in ((beds.middle, beds.id), (yards.middle, yards.id)):
        assert len(np.unique(ids)) == len(ids)
        assert (np.abs(middle[:, 0]) > 55.0).all()
        assert np.sign(middle[:, 0]).min() == -1
        assert np.sign(middle[:, 0]).max() == 1
    whole = bed_slots(layout, network)
    west = whole.middle[:, 0] < -70.0
    assert np.isin(whole.id[west], beds.id).all()  # what does not change keeps its id
