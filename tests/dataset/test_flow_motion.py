import numpy as np
import pytest
from made_view import box, plate, rows, shot, view
from moving_city import BIKE, CAR, MAN, moving

from cityx.city.camera import project, rays
from cityx.city.scene import Prototype, Scene
from cityx.city.store import view_of
from cityx.dataset.classes import CLASS
from cityx.dataset.sight import sight
from cityx.dataset.stage import stage_of
from cityx.dataset.truth import truth

BOTH = ["flow", "motion", "depth", "instance", "semantic", "normal"]


def pixels(camera):
    x, y = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    return np.stack([x, y], axis=2)


def scenery():
    """Ground and a house on it."""
    house = box(2, (-5.0, 15.0, 0.0), (5.0, 20.0, 8.0))
    return Scene().with_mesh("ground", plate(1, 200.0)).with_mesh("buildings", house)


def test_flow_of_what_stands_agrees_with_reprojection():
    stage = stage_of(view(scenery()))
    now = shot((0.0, 0.0, 1.6), 0.1, -0.1, width=160, height=120)
    after = shot((0.7, 1.1, 1.8), 0.16, -0.05, width=160, height=120)
    made = truth(stage, now, BOTH, after=after).channels
    met = np.isfinite(made["depth"])
    assert 0.3 < met.mean() < 1.0
    assert not made["motion"].any()
    points = np.array(now.camera.position) + made["depth"][..., None] * rays(now.camera)
    place, _ = project(after.camera, points[met].astype(float))
    expected = place - pixels(now.camera)[met]
    assert np.abs(made["flow"][met] - expected).max() < 0.1
    # What both pictures show has the same depth in the second as the flow says.
    then = truth(stage, after, ["depth"]).channels["depth"]
    spot = np.round(pixels(now.camera)[met] + made["flow"][met] - 0.5).astype(int)
    inside = ((spot >= 0) & (spot < [160, 120])).all(axis=1)
    there = then[spot[inside, 1], spot[inside, 0]]
    _, depth = project(after.camera, points[met][inside].astype(float))
    assert np.mean(np.abs(there - depth) < 0.05 * depth) > 0.95


def test_the_sky_flows_with_the_turn_of_the_camera_alone():
    stage = stage_of(view(scenery()))
    now = shot((0.0, 0.0, 1.6), 0.0, 0.5, width=160, height=120)
    moved = truth(stage, now, BOTH, after=shot((3.0, 2.0, 4.0), 0.0, 0.5, width=160, height=120))
    sky = np.isinf(moved.channels["depth"])
    assert sky.any()
    np.testing.assert_allclose(moved.channels["flow"][sky], 0.0, atol=1e-4)
    turned = truth(stage, now, BOTH, after=shot((0.0, 0.0, 1.6), 0.05, 0.5, width=160, height=120))
    assert (turned.channels["flow"][sky][:, 0] < -1.0).all()  # to the right, so all goes left


def test_points_behind_the_next_camera_have_no_flow():
    stage = stage_of(view(scenery()))
    now = shot((0.0, 0.0, 1.6), 0.0, -0.3)
    made = truth(stage, now, BOTH, after=shot((0.0, 0.0, 1.6), np.pi, 0.3)).channels
    assert np.isnan(made["flow"][24:]).all()
    assert not np.isnan(made["motion"]).any()


def test_a_last_frame_has_no_flow():
    stage = stage_of(view(scenery()))
    assert "flow" not in truth(stage, shot(), BOTH).channels
    assert "depth" in truth(stage, shot(), BOTH).channels


def test_a_car_moves_as_its_track_says():
    held = view_of(moving(CAR))
    now, later = stage_of(held, 1.0), None
    later = stage_of(held, 1.2, still=now)
    one = shot((5.0, -8.0, 1.2), 0.0, -0.05, width=160, height=120, moment=1.0)
    after = shot((5.3, -8.0, 1.2), 0.0, -0.05, width=160, height=120, moment=1.2)
    made = truth(now, one, BOTH, after=after, later=later).channels
    car = made["instance"] == 8
    assert car.sum() > 500
    assert set(np.unique(made["semantic"][car])) == {CLASS["car"]}
    body = sight(now, one)
    wheels = now.piece[body.rows] != 8
    own = car & ~(wheels & body.met).reshape(car.shape)
    np.testing.assert_allclose(made["motion"][own], [[1.0, 0.0, 0.0]] * own.sum(), atol=1e-5)
    points = np.array(one.camera.position) + made["depth"][..., None] * rays(one.camera)
    place, _ = project(after.camera, points[car] + made["motion"][car].astype(float))
    assert np.abs(made["flow"][car] - (place - pixels(one.camera)[car])).max() < 0.1
    turning = car & ~own
    assert turning.any()
    assert np.ptp(made["motion"][turning], axis=0)[0] > 0.5  # the rim of a rolling wheel


def test_a_walking_person_is_followed_corner_by_corner():
    held = view_of(moving(MAN, BIKE))
    now = stage_of(held, 2.0)
    later = stage_of(held, 2.25, still=now)
    man = np.array([3.0, 4.0 + 1.4 * 2.0, 0.12])
    one = shot((man[0] + 4.0, man[1] + 0.2, 1.3), -np.pi / 2, -0.05, width=160, height=160,
               hfov=0.6, moment=2.0)  # fmt: skip
    made = truth(now, one, BOTH, after=one, later=later).channels
    own = made["instance"] == 9
    assert own.sum() > 1000
    step = made["motion"][own]
    assert np.median(step[:, 1]) == pytest.approx(0.35, abs=0.1)
    assert np.ptp(step[:, 1]) > 0.2  # legs and arms swing
    # Where the points went there is the person's surface.
    points = np.array(one.camera.position) + made["depth"][..., None] * rays(one.camera)
    moved = points[own] + step.astype(float)
    eye = np.array(one.camera.position)
    hits = later.cast(eye, moved - eye)
    met = hits.instance >= 0
    # Either it is seen there, or another limb hides it: nothing of it floats before the figure.
    assert (hits.distance[met] < 1 + 1e-3).mean() > 0.97
    assert (np.abs(hits.distance - 1) < 2e-3).mean() > 0.5
    assert (later.object_id[later.rows(hits)[met]] == 9).all()


def test_who_has_left_the_city_counts_as_standing():
    held = view_of(moving(CAR))
    now = stage_of(held, 9.9)
    later = stage_of(held, 10.5, still=now)
    one = shot((49.5, -8.0, 1.2), 0.0, -0.05, moment=9.9)
    made = truth(now, one, BOTH, after=one, later=later).channels
    assert (made["instance"] == 8).any()
    assert not made["motion"].any()


def test_movers_share_what_stands_still():
    held = view_of(moving(CAR, MAN))
    now = stage_of(held, 1.0)
    later = stage_of(held, 2.0, still=now)
    assert later.still is now.still
    fresh = stage_of(held, 2.0)
    one = shot((5.0, -8.0, 1.2), 0.3, width=160, height=120)
    for name in ("instance", "depth"):
        a, b = (truth(s, one, [name]).channels[name] for s in (later, fresh))
        assert a.tobytes() == b.tobytes()


def test_a_thing_that_is_placed_is_no_mover():
    post = Prototype("bollard", "furniture", box(0, (-0.1, -0.1, 0.0), (0.1, 0.1, 1.0)))
    scene = scenery().with_instances("street_furniture", [post], rows((0.0, 5.0, 0.0), ids=[4]))
    stage = stage_of(view(scene))
    assert stage.first_mover == stage.rays.count
    assert stage.still is None
