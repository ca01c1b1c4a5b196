import numpy as np
import pytest

from cityx.geometry.parcels.winding_patterns import AVENUE, RING, SQUARE, radial, square_radius


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
