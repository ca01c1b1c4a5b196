from collections import Counter

from planned_town import planned, town


def test_weathers_and_times_come_up_equally_often():
    shots = planned("street", 24, weathers=["clear", "rain", "snow"], times=["noon", "22:00"]).shots
    words = Counter((shot.environment.weather, shot.environment.hour) for shot in shots)
    assert len(words) == 6
    assert set(words.values()) == {4}


def test_the_light_of_a_sequence_stays():
    shots = planned("drive", 40, length=10, weathers=["clear", "rain"]).shots
    lights = {}
    for shot in shots:
        assert lights.setdefault(shot.sequence, shot.environment) == shot.environment
    assert {light.weather for light in lights.values()} == {"clear", "rain"}


def test_without_words_the_light_is_the_citys_own():
    assert planned("street", 1).shots[0].environment is None


def test_a_time_alone_keeps_the_weather():
    (shot,) = planned("street", 1, times=["dusk"]).shots
    assert shot.environment.weather == town().environment.weather
    assert shot.environment.sun_elevation < 0


def test_cameras_of_a_rig_share_sequence_frame_and_moment():
    shots = planned("drive", 20, rig="surround", length=10).shots
    assert len(shots) == 120
    for first in range(0, len(shots), 6):
        group = shots[first : first + 6]
        assert len({(s.sequence, s.frame, s.moment) for s in group}) == 1
        assert [s.sensor for s in group] == [
            "back", "back_left", "back_right", "front", "front_left", "front_right",
        ]  # fmt: skip
    assert [shot.name for shot in shots] == sorted(shot.name for shot in shots)
    assert shots[6].name == "drive_0000_0001_back"
