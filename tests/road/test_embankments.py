import numpy as np
import pytest

from cityx.city.mesh_measures import check_closed
from cityx.city.terrain import flat_terrain
from cityx.ground.standing import earth_over
from cityx.road.heights.structures import build_structures
from cityx.road.heights.way_heights import way_heights
from cityx.road.network.network import road_network

BRIDGE = {"bridge": True, "layer": 1}
LONG = (-400, -400, 400, 400)
RAMP = [([(-20, 0), (20, 0)], BRIDGE), ([(-390, 0), (-20, 0)], {}), ([(20, 0), (390, 0)], {}),
        ([(0, -400), (0, 400)], {})]  # fmt: skip


@pytest.fixture
def structures_of(layout_of):
    """The bodies of a bridge and its ramps."""

    def build(streets=(), **options):
        layout = layout_of([*RAMP, *streets], extent=LONG, **options)
        net, off, terrain, _ = way_heights(layout, road_network(layout), flat_terrain())
        return build_structures(layout, net, off, terrain).bodies

    return build


@pytest.fixture
def banks_of(structures_of):
    """Corners of the slopes of earth beside the ramps of a bridge, (n, 3)."""

    def find(streets=(), **options):
        bodies = structures_of(streets, **options)
        assert check_closed(bodies).all()
        earth = np.flatnonzero(np.array(bodies.materials)[bodies.material] == "grass")
        corners = bodies.faces[earth]
        return bodies.vertices[np.unique(corners[corners >= 0])]

    return find


def test_earth_slopes_one_in_one_and_a_half_on_both_sides_of_both_ramps(banks_of):
    found = banks_of()
    for x in (-1, 1):
        for y in (-1, 1):
            here = found[(found[:, 0] * x > 0) & (found[:, 1] * y > 0)]
            out = np.abs(here[:, 1])
            assert 3.0 < here[:, 2].max() < 5.6
            assert np.ptp(out) == pytest.approx(1.5 * here[:, 2].max(), rel=0.15)


def test_no_earth_lies_on_a_street_beside_the_ramp_nor_in_a_house(banks_of):
    street = ([(-390, 10), (-30, 10)], {})
    house = (30, -60, 90, -7)
    found = banks_of([street], houses=[house])
    west_north = (found[:, 0] < -30) & (found[:, 1] > 0)
    assert not west_north.any() or found[west_north, 1].max() < 10 - 3
    x, y = found[:, 0], found[:, 1]
    assert not ((x > house[0]) & (x < house[2]) & (y > house[1]) & (y < house[3])).any()
    # The sides with room keep theirs.
    assert ((x < -30) & (y < 0)).any()
    assert ((x > 30) & (y > 0)).any()


def test_the_height_of_the_earth_is_known_on_slopes_and_nowhere_else(structures_of):
    bodies = structures_of()
    xy = np.array([[-50.0, y] for y in np.linspace(-30, 30, 601)])
    found = earth_over(bodies, xy)
    on = np.isfinite(found)
    north = on & (xy[:, 1] > 0)
    assert north.any()
    assert (on & (xy[:, 1] < 0)).any()
    assert not on[np.abs(xy[:, 1]) < 2].any()  # the ramp lies there
    fall = np.diff(found[north]) / np.diff(xy[north, 1])
    assert np.median(fall) == pytest.approx(-1 / 1.5, rel=0.05)
    assert np.isnan(earth_over(None, xy)).all()
