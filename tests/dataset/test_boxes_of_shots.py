import numpy as np
import pytest
from made_view import HOUSE, POST, box, pane, plate, rows, shot, street, view
from moving_city import BIKE, CAR, MAN, moving

from cityx.city.camera import rays
from cityx.city.scene import Prototype, Scene
from cityx.city.store import read_view, view_of
from cityx.dataset.stage import stage_of
from cityx.dataset.truth import truth

SOME = ["instance", "depth"]


def check(record):
    """What must hold of the boxes of any picture."""
    found, ids = record.boxes, record.channels["instance"]
    assert (np.diff(found.object_id.astype(object)) > 0).all()
    camera = record.shot.camera
    points = np.array(camera.position) + record.channels["depth"][..., None] * rays(camera)
    for row, own in enumerate(found.object_id):
        y, x = np.nonzero(ids == own)
        assert len(x) == found.pixels[row] > 0
        mark = [x.min(), y.min(), x.max() + 1, y.max() + 1]
        np.testing.assert_array_equal(found.seen[row], mark)
        full = found.full[row]
        assert (full[:2] <= found.seen[row, :2]).all()
        assert (full[2:] >= found.seen[row, 2:]).all()
        assert (full >= 0).all()
        assert (full <= [camera.width, camera.height] * 2).all()
        ahead = np.array([np.cos(found.heading[row]), np.sin(found.heading[row])])
        local = points[y, x] - found.centre[row]
        along = local[:, 0] * ahead[0] + local[:, 1] * ahead[1]
        aside = local[:, 1] * ahead[0] - local[:, 0] * ahead[1]
        half = found.size[row] / 2 + 1e-3
        assert (np.abs(np.column_stack([along, aside, local[:, 2]])) <= half).all()
    assert ((found.visibility > 0) & (found.visibility <= 1)).all()
    assert ((found.truncation >= 0) & (found.truncation <= 1)).all()


def test_boxes_of_a_house_and_a_post_are_known():
    record = truth(stage_of(view(street())), shot(width=320, height=240), SOME, boxes=True)
    check(record)
    found = record.boxes
    assert found.object_id.tolist() == [HOUSE, POST]
    np.testing.assert_allclose(found.centre[0], (0.0, 14.975, 4.0), atol=1e-6)
    np.testing.assert_allclose(sorted(found.size[0]), (8.0, 10.0, 10.05), atol=1e-6)
    np.testing.assert_allclose(found.centre[1], (1.5, 4.0, 0.5), atol=1e-6)
    np.testing.assert_allclose(found.size[1], (0.2, 0.2, 1.0), atol=1e-6)
    assert found.visibility[1] == 1.0
    assert 0.95 < found.visibility[0] < 1.0  # the post is before it
    above = 1 - (1.6 + 10.0 * 0.75 * np.tan(0.6)) / 8.0  # share of the front over the picture
    np.testing.assert_allclose(found.truncation, (above, 0.0), atol=0.02)


def test_visibility_and_truncation_have_known_values():
    shop = Prototype("kiosk", "furniture", pane(0, 2.0, 2.0, "plaster"))
    screen = Prototype("bench", "furniture", pane(0, 1.0, 2.0, "plaster"))
    scene = Scene().with_instances(
        "a", [shop], rows((0.0, 10.0, 0.0), (5.0, 10.0, 0.0), ids=[5, 7])
    )
    scene = scene.with_instances("b", [screen], rows((-0.25, 5.0, 0.0), ids=[6]))
    # 100 pixels per metre at 10 m; the picture reaches from -5 to 5 m there.
    one = shot((0.0, 0.0, 1.0), width=1000, height=750, hfov=2 * np.arctan(0.5))
    record = truth(stage_of(view(scene)), one, SOME, boxes=True)
    check(record)
    found = record.boxes
    assert found.object_id.tolist() == [5, 6, 7]
    # The screen hides -1.5 to 0.5 m of the first shop.
    np.testing.assert_allclose(found.visibility, (0.25, 1.0, 1.0), atol=0.02)
    np.testing.assert_allclose(found.truncation, (0.0, 0.0, 0.5), atol=0.02)
    np.testing.assert_allclose(found.full[0], (400, 275, 600, 475), atol=1e-6)
    np.testing.assert_allclose(found.full[2], (900, 275, 1000, 475), atol=1e-6)


def test_a_turned_thing_has_its_heading():
    car = Prototype("car_sedan", "vehicle", box(0, (-0.9, -2.2, 0.0), (0.9, 2.2, 1.5)))
    scene = Scene().with_mesh("ground", plate(1, 60.0))
    scene = scene.with_instances("vehicles", [car], rows((1.0, 9.0, 0.0), ids=[5], turn=0.7))
    found = truth(stage_of(view(scene)), shot(), SOME, boxes=True).boxes
    assert found.heading[0] == pytest.approx(0.7 - np.pi / 2)
    np.testing.assert_allclose(found.size[0], (4.4, 1.8, 1.5), atol=1e-6)
    np.testing.assert_allclose(found.centre[0], (1.0, 9.0, 0.75), atol=1e-6)


def test_boxes_of_movers_hold_wheels_and_riders_and_look_along_their_way():
    stage = stage_of(view_of(moving(CAR, MAN, BIKE)), 1.0)
    record = truth(stage, shot((0.0, -9.0, 1.5), width=320, height=240), SOME, boxes=True)
    check(record)
    found = record.boxes
    headings = dict(zip(found.object_id.tolist(), found.heading, strict=True))
    assert headings[8] == pytest.approx(0.0, abs=1e-6)
    assert headings[9] == pytest.approx(np.pi / 2, abs=1e-6)
    tall = dict(zip(found.object_id.tolist(), found.size[:, 2], strict=True))
    assert 1.4 < tall[9] < 2.1
    assert tall[10] > 1.5  # with who rides it


def test_what_reaches_behind_the_eye_has_a_box_that_holds_its_mask():
    scene = Scene().with_mesh("ground", plate(1, 60.0))
    scene = scene.with_mesh("buildings", box(2, (1.0, -10.0, 0.0), (4.0, 30.0, 8.0)))
    record = truth(stage_of(view(scene)), shot(), SOME, boxes=True)
    check(record)
    assert record.boxes.truncation[0] > 0.2
    assert record.boxes.full[0, 2] == 64


def test_boxes_of_a_town_hold_their_masks(scene_folder):
    stage = stage_of(read_view(scene_folder("grid_s") / "city"))
    count = 0
    for position, heading, pitch in (
        ((0.0, 0.0, 2.0), 0.4, 0.0),
        ((-30.0, 20.0, 2.0), 2.0, 0.1),
        ((0.0, -60.0, 60.0), 0.0, -0.6),
    ):
        one = shot(position, heading, pitch, width=320, height=240)
        record = truth(stage, one, SOME, boxes=True)
        check(record)
        count += record.boxes.count
    assert count > 20


def test_a_picture_of_the_sky_has_no_boxes():
    record = truth(stage_of(view(street())), shot(pitch=1.3), SOME, boxes=True)
    assert record.boxes.count == 0
    assert record.boxes.size.shape == (0, 3)
