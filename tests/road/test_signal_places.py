from dataclasses import replace

import numpy as np

from cityx.road.network.network import road_network
from cityx.road.network.signal_places import signal_places, signal_rows

CROSS = [([(-90, 0), (0, 0), (90, 0)], {}), ([(0, -90), (0, 0), (0, 90)], {})]


def with_crossings(layout_of, at, tags):
    layout = layout_of(CROSS, points=[(place, "crossing") for place in at])
    return replace(layout, points=layout.points.assign(tags=tags))


def test_crossings_under_signals_rule_their_junction(layout_of):
    tags = [
        '{"crossing": "traffic_signals"}',
        '{"crossing:signals": "yes"}',
        '{"crossing": "zebra"}',
    ]
    layout = with_crossings(layout_of, [(9, 0), (-9, 0), (0, 9)], tags)
    rows, ruling = signal_rows(layout)
    assert rows.tolist() == [0, 1]
    assert ruling.all()
    # No arm of a junction under signals is without a crossing where houses stand round it.
    houses = [(x, y, x + 12, y + 12) for x in (-20, 8) for y in (-20, 8)]
    dense = layout_of(CROSS, houses=houses)
    assert not road_network(dense).crossing.any()
    assert road_network(replace(dense, points=layout.points)).crossing.sum() == 4


def test_a_crossing_under_signals_far_from_others_rules_itself_alone(layout_of):
    layout = with_crossings(layout_of, [(20, 0)], ['{"crossing": "traffic_signals"}'])
    rows, ruling = signal_rows(layout)
    assert rows.tolist() == [0]
    assert not ruling.any()
    assert len(signal_places(layout)) == 0


def test_a_map_without_signals_has_none(layout_of):
    rows, ruling = signal_rows(layout_of(CROSS))
    assert len(rows) == 0
    assert ruling.dtype == np.bool_
