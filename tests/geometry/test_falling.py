import numpy as np

from cityx.geometry.falling import NEAR, flakes, places, streaks

HALF = (0.7, 0.45)
PIXEL = 0.001


def test_places_fill_the_view_evenly_and_again_the_same():
    at, draws = places(20_000, 16.0, HALF, 3, "rain")
    again, _ = places(20_000, 16.0, HALF, 3, "rain")
    assert np.array_equal(at, again)
    assert at[:, 2].min() >= NEAR
    assert at[:, 2].max() <= 16.0
    assert (np.abs(at[:, 0]) <= at[:, 2] * HALF[0] * 1.08 + 1e-9).all()
    # Half of a pyramid's volume lies beyond 79 % of its height.
    assert abs((at[:, 2] > 16.0 * 0.5 ** (1 / 3)).mean() - 0.5) < 0.02
    assert draws.shape == (20_000, 4)


def test_streaks_point_along_the_fall_and_lean_with_the_wind():
    at, draws = places(500, 16.0, HALF, 0, "rain")
    down = np.array([0.0, -1.0, 0.0])
    for wind in (0.0, 9.0):
        points, faces = streaks(at, draws, down, np.array([wind, 0.0, 0.0]), PIXEL)
        corners = points[faces]
        way = corners[:, 2:].mean(axis=1) - corners[:, :2].mean(axis=1)
        assert (way[:, 1] < 0).all()
        lean = np.degrees(np.arctan2(way[:, 0], -way[:, 1]))
        assert (np.abs(lean) < 1e-6).all() if wind == 0 else 35 < np.median(lean) < 60
        size = np.linalg.norm(way, axis=1)
        assert 0.05 < size.min() < size.max() < 0.5


def test_gusts_drive_the_rain_in_sheets():
    at = np.column_stack([np.linspace(-6.0, 6.0, 600), np.zeros(600), np.full(600, 8.0)])
    points, faces = streaks(at, np.full((600, 4), 0.5), np.array([0.0, -1.0, 0.0]),
                            np.array([12.0, 0.0, 0.0]), PIXEL)  # fmt: skip
    corners = points[faces]
    way = corners[:, 2:].mean(axis=1) - corners[:, :2].mean(axis=1)
    lean = np.degrees(np.arctan2(way[:, 0], -way[:, 1]))
    assert np.ptp(lean) > 25
    assert np.abs(np.diff(lean)).max() < 2  # neighbours lean alike


def test_flakes_face_the_camera_and_are_millimetres_wide_nearby():
    at, draws = places(300, 2.0, HALF, 0, "snow")
    points, faces = flakes(at, draws, PIXEL)
    ring = points[faces]
    assert np.allclose(np.ptp(ring[:, :, 2], axis=1), 0.0)
    width = np.ptp(ring[:, :, 0], axis=1)
    assert 0.001 < width.min() < width.max() < 0.02
