import numpy as np
import pytest
from made_view import HOUSE, POST, box, plate, shot, street, view

from cityx.assets.styles.materials import MATERIALS
from cityx.city.scene import Scene
from cityx.city.store import read_view
from cityx.dataset.classes import CLASS
from cityx.dataset.lidar import LIDARS, Spinning, lidar_named, sensor_axes, sweep_of
from cityx.dataset.stage import stage_of
from cityx.errors import UsageError
from cityx.geometry.raycast import corners_at


def to_city(one, sweep):
    return np.array(one.camera.position) + sweep.points.astype(float) @ sensor_axes(one.camera)


def away(points, corners):
    """Distance of (n, 3) points from (n, 3, 3) triangles in which their feet lie."""
    a, e, f = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(e, f)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.abs(((points - a) * normal).sum(axis=1))


@pytest.mark.parametrize("name", LIDARS)
def test_points_lie_on_the_surfaces_of_their_ids(name, scene_folder):
    stage = stage_of(read_view(scene_folder("grid_s") / "city"))
    one = shot((0.0, 0.0, 2.0), 0.4, 0.03, moment=3.0)
    sweep = sweep_of(stage, one, LIDARS[name])
    assert len(sweep.points) > 1000
    points, eye = to_city(one, sweep), np.array(one.camera.position)
    # Each point is on a triangle of its object: found by a ray of its own through it.
    hits = stage.cast(eye, points - eye, reach=1 + 1e-4)
    met = hits.instance >= 0
    assert met.mean() > 0.999  # a point on a rim may be missed by float32
    rows = stage.rows(hits)[met]
    assert (stage.object_id[rows] == sweep.object_id[met]).mean() > 0.999
    off = away(points[met], corners_at(stage.rays, hits.instance[met], hits.triangle[met]))
    own = stage.object_id[rows] == sweep.object_id[met]
    assert np.quantile(off[own], 0.999) < 1e-3
    ranges = np.linalg.norm(points - eye, axis=1)
    assert ranges.max() <= LIDARS[name].reach
    assert ranges.min() >= LIDARS[name].near
    classes = dict(zip(stage.object_id.tolist(), stage.semantic.tolist(), strict=True))
    assert all(classes[i] == c for i, c in zip(sweep.object_id.tolist(), sweep.semantic.tolist(),
                                                strict=True))  # fmt: skip
    assert (np.diff(sweep.time) >= 0).all()
    assert sweep.time.max() < 1 / LIDARS[name].rate
    assert ((sweep.intensity >= 0) & (sweep.intensity <= 1)).all()


def test_rings_have_their_elevations_and_level_ground_its_circles():
    flat = stage_of(view(Scene().with_mesh("ground", plate(1, 400.0))))
    lidar = LIDARS["spinning_16"]
    sweep = sweep_of(flat, shot((0.0, 0.0, 2.0)), lidar)
    rise = np.arctan2(sweep.points[:, 2], np.hypot(*sweep.points[:, :2].T))
    np.testing.assert_allclose(np.degrees(rise), np.take(lidar.elevations, sweep.beam), atol=1e-3)
    assert set(np.unique(sweep.beam)) == set(range(7))  # below -1 degree within 100 m
    np.testing.assert_allclose(sweep.points[:, 2], -2.0, atol=1e-5)
    assert (sweep.semantic == CLASS["road"]).all()
    steep = sweep.beam == 0
    luminance = np.dot(MATERIALS["asphalt"].color, (0.2126, 0.7152, 0.0722))
    expected = np.sin(np.radians(15.0)) * luminance  # the sine is the cosine of incidence
    np.testing.assert_allclose(sweep.intensity[steep], expected, rtol=0.01)


def test_the_sensor_looks_along_the_camera_and_turns_clockwise():
    stage = stage_of(view(street()))
    one = shot((0.0, 0.0, 0.8), np.pi / 2)  # to the east; the house is to the left, in the north
    sweep = sweep_of(stage, one, Spinning((0.0,), 3600))
    house = sweep.points[sweep.object_id == HOUSE]
    assert (house[:, 1] > 9.9).all()
    assert (sweep.object_id == POST).any()
    angle = np.remainder(-np.arctan2(sweep.points[:, 1], sweep.points[:, 0]), 2 * np.pi)
    np.testing.assert_allclose(sweep.time * 10.0, angle / (2 * np.pi), atol=1e-3)


def test_a_sweep_on_the_move_is_given_from_where_it_began():
    wall = stage_of(view(Scene().with_mesh("buildings", box(2, (-30, 10, 0), (30, 11, 8)))))
    now = shot((0.0, 0.0, 1.0), moment=0.0)
    after = shot((0.0, 1.5, 1.0), 0.02, moment=0.1)
    still, moved = (sweep_of(wall, now, LIDARS["spinning_16"], after=a) for a in (None, after))
    for sweep in (still, moved):
        face = sweep.points[np.abs(to_city(now, sweep)[:, 1] - 10.0) < 0.2]
        np.testing.assert_allclose(face[:, 0], 10.0, atol=1e-4)
    assert still.points.shape != moved.points.shape or not np.allclose(still.points, moved.points)


def test_a_rosette_never_comes_again():
    one, two = (LIDARS["solid_rosette"].beams(moment) for moment in (0.0, 0.1))
    assert len(one.time) == 10_000
    assert np.abs(one.azimuth - two.azimuth).max() > 0.1
    wide = np.hypot(one.azimuth, one.elevation)
    assert np.degrees(wide.max()) == pytest.approx(19.2, abs=0.01)


def test_an_unknown_sensor_is_named_with_those_that_there_are():
    with pytest.raises(UsageError, match=r'There is no LiDAR "spinning_46"\. Did you mean "spin'):
        lidar_named("spinning_46")
