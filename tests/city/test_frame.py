import numpy as np

from cityx.city import Frame

HELSINKI = Frame(60.17, 24.94)


def test_the_origin_projects_to_zero_and_north_is_up():
    points = HELSINKI.to_local([[24.94, 60.17], [24.94, 60.18], [24.95, 60.17]])
    assert np.allclose(points[0], 0, atol=1e-3)
    assert points[1, 1] > 1000
    assert abs(points[1, 0]) < 0.01
    assert points[2, 0] > 500


def test_points_come_back_to_a_tenth_of_a_millimetre():
    points = np.array([[0.0, 0.0], [12_345.6789, -9_876.5432]])
    assert np.allclose(HELSINKI.to_local(HELSINKI.to_geographic(points)), points, atol=1.1e-4)


def test_distances_agree_with_the_ellipsoid_within_four_centimetres_at_20_km():
    from pyproj import Geod

    lon, lat = HELSINKI.to_geographic([[14_000.0, 14_000.0]])[0]
    true = Geod(ellps="WGS84").inv(24.94, 60.17, lon, lat)[2]
    assert abs(true - np.hypot(14_000, 14_000)) < 0.04
