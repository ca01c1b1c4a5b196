import numpy as np
import pytest

from cityx.geometry.parcels.street_patterns import Pattern
from cityx.geometry.parcels.winding_patterns import (
    AVENUE,
    RING,
    SQUARE,
    radial,
    square_radius,
    streets_of,
    winding,
    with_main_streets,
)

BOX = (-300.0, -300.0, 300.0, 300.0)


def test_junctions_have_three_or_four_arms_and_no_link_is_short():
    found = winding(BOX, 5, pitch=80.0, angle=0.3)
    inner = (np.abs(found.nodes) < 250.0).all(axis=1)
    degree = np.bincount(found.links.ravel(), minlength=len(found.nodes))[inner]
    assert degree.min() >= 3
    assert 3.0 <= degree.mean() <= 3.5
    length = np.hypot(*(found.nodes[found.links[:, 0]] - found.nodes[found.links[:, 1]]).T)
    assert np.percentile(length, 5) > 20.0


def test_a_part_of_the_plane_is_the_same_from_the_same_seed():
    first, second = (winding(BOX, 5, pitch=80.0, angle=0.3) for _ in range(2))
    assert np.array_equal(first.nodes, second.nodes)
    assert np.array_equal(first.links, second.links)
    assert not np.array_equal(first.nodes[:50], winding(BOX, 6, pitch=80.0, angle=0.3).nodes[:50])


def test_streets_run_straight_on_over_a_junction():
    nodes = np.array([(-1.0, 0.0), (0.0, 0.0), (1.0, 0.1), (0.0, 1.0)])
    links = np.array([(0, 1), (1, 2), (1, 3)])
    street = streets_of(nodes, links)
    assert street[0] == street[1] != street[2]


def test_main_streets_lead_from_the_middle_outwards():
    found = with_main_streets(winding(BOX, 5, pitch=80.0, angle=0.3), 8, count=5, reach=300.0)
    assert isinstance(found, Pattern)
    main = found.links[found.street[:, 0] == 8]
    away = np.hypot(*found.nodes[np.unique(main)].T)
    assert away.min() < 60.0
    assert away.max() > 250.0
    assert set(found.street[found.street[:, 0] == 8, 1].tolist()) <= set(range(5))


@pytest.mark.parametrize(("avenues", "rings"), [(3, 1), (8, 2), (16, 4)])
def test_avenues_are_straight_and_rings_closed(avenues, rings):
    found = radial((400.0, 300.0), (90.0, 75.0), avenues=avenues, rings=rings)
    family, line = found.street.T
    assert set(line[family == AVENUE].tolist()) == set(range(avenues))
    assert set(line[family == RING].tolist()) == set(range(1, rings + 1))
    for number in range(avenues):
        nodes = found.nodes[np.unique(found.links[(family == AVENUE) & (line == number)])]
        away = np.hypot(*nodes.T)
        assert away.min() == pytest.approx(square_radius(avenues), abs=0.01)
        turn = np.exp(1j * np.arctan2(*nodes.T[::-1]))
        assert np.abs(turn - turn[0]).max() < 1e-4
    for number in (0, *range(1, rings + 1)):
        chosen = (family == (RING if number else SQUARE)) & (line == number)
        degree = np.bincount(found.links[chosen].ravel())
        assert set(degree[degree > 0].tolist()) == {2}
        radius = np.hypot(*found.nodes[np.unique(found.links[chosen])].T)
        assert np.ptp(radius) < 0.01


def test_no_other_street_goes_all_the_way_round():
    found = radial((500.0, 500.0), (90.0, 70.0), avenues=6, rings=1)
    family, line = found.street.T
    assert (family == 0).any()
    for number in np.unique(line[family == 0]).tolist():
        nodes = found.nodes[np.unique(found.links[(family == 0) & (line == number)])]
        seen = np.sort(np.arctan2(*nodes.T[::-1]))
        gaps = np.diff(np.append(seen, seen[0] + 2 * np.pi))
        assert gaps.max() > np.pi
