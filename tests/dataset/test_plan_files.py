import json

import numpy as np
import pytest
from planned_town import eyes, planned

from cityx.errors import InputError

CAMERA = {"name": "Main street", "position": [-20.0, 4.3, 1.7], "heading_deg": 90}
FLIGHT = {
    "name": "over", "rate": 5, "moment": 2.0, "weather": "rain", "time": "dusk",
    "keys": [
        {"t": 0, "position": [-40, -40, 50], "heading_deg": 350, "pitch_deg": -30},
        {"t": 2, "position": [0, -40, 60], "heading_deg": 10, "pitch_deg": -40},
        {"t": 4, "position": [0, 0, 60], "heading_deg": 40, "pitch_deg": -90},
    ],
}  # fmt: skip


def plan_of(folder, content, count=None, **options):
    path = folder / "plan.json"
    path.write_text(json.dumps(content))
    return planned(str(path), count, **options)


def test_cameras_and_trajectories_are_taken_as_they_are_written(tmp_path):
    other = {**CAMERA, "name": "b", "moment": 3.5, "weather": "snow", "position": [20, -4.3, 1.7]}
    shots = plan_of(tmp_path, {"cameras": [CAMERA, other], "trajectories": [FLIGHT]}).shots
    assert len(shots) == 2 + 21
    assert [shot.name for shot in shots[:3]] == [
        "custom_0000_main-street", "custom_0001_b", "custom_0002_over_0000",
    ]  # fmt: skip
    assert [shot.name for shot in shots] == sorted(shot.name for shot in shots)
    assert shots[0].environment is None
    assert (shots[1].moment, shots[1].environment.weather) == (3.5, "snow")
    assert (shots[0].camera.width, shots[0].camera.height) == (160, 120)
    flight = shots[2:]
    assert flight[-1].moment == pytest.approx(6.0)
    assert flight[0].environment.weather == "rain"
    places = eyes(flight)
    assert places[[0, 10, 20]] == pytest.approx(
        np.array([[-40, -40, 50], [0, -40, 60], [0, 0, 60.0]])
    )
    heading = np.unwrap([shot.camera.heading for shot in flight])
    assert np.ptp(heading) == pytest.approx(np.radians(50))  # through north, not round by south


def test_a_trajectory_may_look_at_a_place(tmp_path):
    keys = [{"t": t, "position": [x, -40, 50]} for t, x in ((0, -30), (3, 30))]
    shots = plan_of(tmp_path, {"trajectories": [{"keys": keys, "look_at": [0, 0, 0]}]}).shots
    assert len(shots) == 31
    assert shots[15].camera.heading == pytest.approx(0.0, abs=1e-6)
    assert shots[15].camera.pitch == pytest.approx(-np.arctan2(50, 40))


def test_a_count_cuts_a_file_off(tmp_path):
    few = plan_of(tmp_path, {"cameras": [CAMERA], "trajectories": [FLIGHT]}, 5).shots
    whole = plan_of(tmp_path, {"cameras": [CAMERA], "trajectories": [FLIGHT]}).shots
    assert few == whole[:5]


def test_a_file_gives_places_in_the_frame_that_all_cities_of_it_share(tmp_path):
    far = {**CAMERA, "position": [1_536_000.0 - 20.0, 4.3 - 3_072_000.0, 1.7]}
    here = plan_of(tmp_path, {"cameras": [CAMERA]}).shots
    box = (-100.0, -100.0, 100.0, 100.0)
    there = plan_of(tmp_path, {"cameras": [far]}, within=box, origin=(1_536_000.0, -3_072_000.0))
    assert there.shots[0].camera.position == pytest.approx(here[0].camera.position, abs=1e-6)
    assert plan_of(tmp_path, {"cameras": [far]}, within=box).shots == ()


def test_places_of_a_camera_file_are_read(tmp_path):
    here = {"lat": 52.0, "lon": 13.0, "height_m": 60, "heading_deg": 0, "pitch_deg": -60}
    content = {"places": {"x": {"cameras": {"top": here}}}, "render": {"sun_elevation_deg": 10}}
    (shot,) = plan_of(tmp_path, content).shots
    assert shot.camera.position == pytest.approx((0, 0, 60), abs=0.01)
    assert shot.environment.sun_elevation == pytest.approx(np.radians(10))


def test_all_views_that_may_not_be_are_named(tmp_path):
    wrong = [
        {"name": "cellar", "position": [0, 0, -2], "heading_deg": 0},
        {"name": "room", "position": [-20, 14, 2], "heading_deg": 0},
        CAMERA,
        {"name": "wall", "position": [-20, 7.8, 2], "heading_deg": 0},
    ]
    with pytest.raises(InputError) as error:
        plan_of(tmp_path, {"cameras": wrong})
    text = str(error.value)
    assert "has views that may not be: cellar: underground, the eye is under the ground at" in text
    assert "room: inside something, the eye is inside building 000000000000000b at" in text
    assert "wall: too near to something, 0.20 m from building 000000000000000b at" in text
    assert "main-street" not in text


def test_all_faults_of_a_file_are_told_at_once(tmp_path):
    content = {
        "cameras": [{"name": "a", "position": [0, 0], "heading_deg": 0, "moment": -1},
                    {"name": "b", "position": [0, 0, 2], "heading_deg": 0, "weather": "rainn"}],
        "trajectories": [{"name": "c", "keys": []},
                         {"name": "d", "keys": [{"t": 1, "position": [0, 0, 5], "heading_deg": 0},
                                                {"t": 0, "position": [0, 0, 6], "heading_deg": 0}]},
                         {"name": "e", "rate": 0, "keys": [{"t": 0, "position": [0, 0, 5]},
                                                           {"position": [0, 0, 5]}]}],
    }  # fmt: skip
    with pytest.raises(InputError) as error:
        plan_of(tmp_path, content)
    for words in (
        "cameras.a: position is [0, 0], three numbers are needed.",
        "cameras.a: moment is -1, allowed is 0 to 1e+06.",
        'cameras.b: "rainn" is no weather',
        "trajectories.c: keys are [], two or more are needed.",
        "trajectories.d: t of the keys is not ascending: [1.0, 0.0].",
        "trajectories.e: rate is 0, allowed is 0.01 to 1000.",
        "trajectories.e.keys[0]: heading_deg is missing.",
        "trajectories.e.keys[1]: t is missing.",
    ):
        assert words in str(error.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "is not JSON"),
        ("[]", "the file is list, an object is needed."),
        ("{}", 'none of "cameras", "places" and "trajectories" is given.'),
        ('{"cameras": []}', "has neither a camera nor a trajectory."),
    ],
)
def test_files_without_a_plan_are_refused(tmp_path, text, words):
    path = tmp_path / "plan.json"
    path.write_text(text)
    with pytest.raises(InputError) as error:
        planned(str(path), None)
    assert words in str(error.value)


def test_a_file_that_is_not_there_is_told(tmp_path):
    with pytest.raises(InputError, match=r"cannot read a plan from .*: No such file"):
        planned(str(tmp_path / "none.json"), None)
