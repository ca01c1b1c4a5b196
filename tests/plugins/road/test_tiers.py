import numpy as np
import pytest

from cityx.city.terrain import flat_terrain
from cityx.geometry.polylines import arc_lengths
from cityx.plugins.road.heights import way_heights
from cityx.plugins.road.network import road_network
from cityx.plugins.road.tiers import level_network, spans_of
from cityx.plugins.road.yards import grounds_digest

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
