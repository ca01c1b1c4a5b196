import json

import numpy as np
import pytest

from cityx.city.camera import Camera
from cityx.dataset.rigs import RIGS, STEREO_BASELINE, mounted, rig_named
from cityx.errors import InputError, UsageError

EAST = Camera("c", (10.0, 20.0, 1.6), np.pi / 2, 0.1, 1.2, 64, 48)


def test_a_single_camera_is_where_the_rig_is():
    (only,) = mounted(EAST, RIGS["mono"])
    assert only.position == pytest.approx(EAST.position)
    assert (only.heading, only.pitch, only.hfov) == (EAST.heading, EAST.pitch, EAST.hfov)


def test_stereo_cameras_lie_side_by_side_on_the_left_and_right():
    left, right = mounted(EAST, RIGS["stereo"])
    assert (left.name, right.name) == ("left", "right")
    assert left.position == pytest.approx((10.0, 20.0 + STEREO_BASELINE / 2, 1.6))
    assert right.position == pytest.approx((10.0, 20.0 - STEREO_BASELINE / 2, 1.6))
    assert left.heading == right.heading == EAST.heading


def test_surround_sees_everything_round_it():
    rig = {camera.name: camera for camera in mounted(EAST, RIGS["surround"])}
    assert list(rig) == sorted(rig)
    assert rig["front_left"].heading == pytest.approx(np.pi / 2 - np.radians(55))
    assert rig["back"].heading == pytest.approx(3 * np.pi / 2)
    angle = np.radians(np.arange(360))
    seen = [np.cos(angle - c.heading) >= np.cos(c.hfov / 2) for c in rig.values()]
    assert np.any(seen, axis=0).all()
    assert rig["front"].position[0] > rig["back"].position[0]  # it looks east


def test_a_rig_of_a_file_is_read(tmp_path):
    path = tmp_path / "rig.json"
    path.write_text(json.dumps({"sensors": [
        {"sensor": "roof", "offset": [0.5, 0.2, 0.3], "yaw_deg": 90, "hfov_deg": 100},
        {"sensor": "bumper"},
    ]}))  # fmt: skip
    bumper, roof = mounted(EAST, rig_named(str(path)))
    assert (bumper.name, roof.name) == ("bumper", "roof")
    assert roof.position == pytest.approx((10.5, 20.2, 1.9))
    assert roof.heading == pytest.approx(0.0)
    assert roof.hfov == pytest.approx(np.radians(100))


def test_all_faults_of_a_rig_are_told_at_once(tmp_path):
    path = tmp_path / "rig.json"
    path.write_text(json.dumps({"sensors": [
        {"sensor": "Roof!", "offset": [1, 2]}, {"sensor": "a", "yaw_deg": "left"},
        {"sensor": "a", "hfov_deg": 200}, 3,
    ]}))  # fmt: skip
    with pytest.raises(InputError) as error:
        rig_named(str(path))
    for words in (
        "sensors[0]: sensor is 'Roof!', a word of a-z, 0-9 and _ is needed.",
        "sensors[0]: offset is [1, 2], metres ahead, left and up are needed.",
        "sensors[1]: yaw_deg is 'left', a number is needed.",
        "sensors[2]: hfov_deg is 200, allowed is 1 to 175.",
        "sensors[3] is int, an object is needed.",
        "a is there more than once.",
    ):
        assert words in str(error.value)


def test_an_unknown_rig_names_the_nearest():
    with pytest.raises(UsageError, match=r'Did you mean "stereo"\?'):
        rig_named("sterio")
