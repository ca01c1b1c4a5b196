"""Junctions with more turns than SUMO rules at one, such as a bus station with many bays."""

from importlib.util import find_spec

import numpy as np
import pytest
from lxml import etree
from made_streets import MIDDLE, city_of

from cityx.motion.vehicles import halts_of
from cityx.traffic.laying import MOST_LINKS, streets_of, with_room_for_links
from cityx.traffic.network import make_network
from cityx.traffic.streets import Lane, Link, Streets, Way


def meeting(count, lanes, ranks):
    """Streets that meet in one junction, 0, and lead to each other, without a turn on the spot."""
    ways, links = [], []
    turns = np.arange(count) * 2 * np.pi / count
    for number, turn in enumerate(turns.tolist()):
        out = np.array([np.cos(turn), np.sin(turn), 0.0])
        for sign in (-1, 1):
            row = tuple(
                Lane(0, "drive", 3.0, 10.0, np.stack([30 * out, 10 * out])[::-sign], False)
                for _ in range(lanes)
            )
            ends = (number + 1, 0) if sign < 0 else (0, number + 1)
            rank = ranks[number % len(ranks)]
            ways.append(Way(f"{sign}{number}", number, *ends, rank, row, ()))
    for one in range(0, 2 * count, 2):
        for other in range(1, 2 * count, 2):
            if other != one + 1:
                shape = np.stack([ways[one].lanes[0].shape[1], ways[other].lanes[0].shape[0]])
                shape = np.insert(shape, 1, shape.mean(axis=0) / 2, axis=0)
                links += [Link((one, lane), (other, lane), shape) for lane in range(lanes)]
    return Streets(
        tuple(ways), tuple(links), (), np.zeros((count + 1, 3)), np.zeros(count + 1, bool), False
    )


@pytest.mark.parametrize(
    ("count", "lanes", "ranks"), [(30, 1, (0, 0, 0, 0, 5)), (14, 3, (2, 1)), (60, 2, (1,))]
)
def test_a_crowded_junction_keeps_its_streets_and_loses_the_least_turns(count, lanes, ranks):
    full = meeting(count, lanes, ranks)
    kept = with_room_for_links(full)
    assert len(kept.links) == MOST_LINKS
    assert kept.undriven == len(full.links) - MOST_LINKS
    assert {link.source for link in kept.links} == {link.source for link in full.links}
    assert {link.target for link in kept.links} == {link.target for link in full.links}
    best = max(ranks)
    between = [
        link
        for link in full.links
        if {full.ways[way].rank for way in (link.source[0], link.target[0])} == {best}
    ]
    if len(between) < MOST_LINKS / 2:
        assert {id(link) for link in between} <= {id(link) for link in kept.links}


def test_a_usual_junction_keeps_every_turn():
    streets = meeting(12, 1, (1, 2))
    assert with_room_for_links(streets) is streets


@pytest.mark.sumo
@pytest.mark.skipif(
    find_spec("libsumo") is None, reason='SUMO is not installed: pip install "cityx[traffic]"'
)
def test_every_turn_of_a_crowded_junction_has_its_place_in_the_right_of_way(tmp_path):
    turns = np.radians(np.arange(17) * 360 / 17)
    ends = [(float(140 * np.cos(turn)), float(140 * np.sin(turn))) for turn in turns]
    city = city_of([([end, MIDDLE], {}) for end in ends])
    streets = streets_of(city, halts_of(city))
    assert streets.undriven > 0
    root = etree.parse(make_network(streets, city.frame, tmp_path).file).getroot()
    ruled = [len(junction.findall("request")) for junction in root.iter("junction")]
    assert max(ruled) == len(streets.links)
    assert not root.findall("junction[@type='unregulated']")
