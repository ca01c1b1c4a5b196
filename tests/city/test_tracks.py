from dataclasses import replace

import numpy as np
import pytest

from cityx.city.content import content_hash
from cityx.city.store import read_city, read_view, write_city
from cityx.city.tracks import GAIT, MOVER, Tracks, join_tracks, no_tracks, poses_at


def one(object_id, times, xs, headings=None):
    count = len(times)
    position = np.column_stack([xs, np.zeros(count), np.zeros(count)]).astype(float)
    return Tracks(
        np.array([object_id], np.uint64), np.array([MOVER["car"]], np.uint8),
        np.array(["car_hatchback"]), np.array(["dynamic/traffic-v1"]),
        np.ones((1, 3), np.float32), np.array([[4.2, 1.8, 1.5]], np.float32),
        np.array([0, count]), np.asarray(times, float), position,
        np.zeros(count) if headings is None else np.asarray(headings, float),
        np.full(count, 5, np.float32), np.full(count, GAIT["ride"], np.uint8),
        np.full(count, 9, np.uint64),
    )  # fmt: skip


def test_a_mover_is_between_its_samples():
    poses = poses_at(one(3, [1, 2, 4], [0, 10, 10]), 1.25)
    assert poses.position.tolist() == [[2.5, 0, 0]]
    assert poses.travelled.tolist() == [2.5]


def test_a_mover_turns_the_shorter_way():
    poses = poses_at(one(3, [0, 1], [0, 1], headings=[3.0, -3.0]), 0.5)
    assert np.cos(poses.heading[0]) == pytest.approx(-1.0, abs=1e-9)


@pytest.mark.parametrize("moment", [0.9, 4.1])
def test_a_mover_is_absent_before_and_after_its_samples(moment):
    assert len(poses_at(one(3, [1, 2, 4], [0, 10, 10]), moment).row) == 0


@pytest.mark.parametrize(("moment", "x"), [(1.0, 0), (4.0, 20)])
def test_a_mover_is_there_at_its_first_and_last_sample(moment, x):
    poses = poses_at(one(3, [1, 2, 4], [0, 10, 20]), moment)
    assert poses.position[:, 0].tolist() == [x]
    assert poses.travelled.tolist() == [x]


def test_the_way_of_each_mover_is_measured_from_its_own_beginning():
    both = join_tracks([one(8, [0, 2], [100, 104]), one(3, [0, 2], [0, 20])])
    assert both.object_id.tolist() == [3, 8]
    assert poses_at(both, 1.0).travelled.tolist() == [10, 2]


def test_an_object_moves_on_one_track_alone():
    with pytest.raises(ValueError, match="an object moves on two tracks"):
        join_tracks([one(3, [0], [0]), one(3, [0], [5])])


def test_some_movers_are_taken_with_their_samples():
    both = join_tracks([one(3, [0, 2], [0, 20]), one(8, [0, 1, 2], [1, 2, 3])])
    taken = both.take(np.array([False, True]))
    assert taken.position[:, 0].tolist() == [1, 2, 3]
    assert taken.sample_start.tolist() == [0, 3]


def test_nothing_moves_without_tracks():
    assert no_tracks().duration == 0
    assert len(poses_at(no_tracks(), 0.0).row) == 0


def test_tracks_are_stored_whole(small_city, tmp_path):
    tracks = join_tracks([one(3, [0, 2], [0, 20]), one(8, [0, 1, 2], [1, 2, 3])])
    city = replace(small_city, tracks=tracks, moment=1.5)
    write_city(city, tmp_path / "city")
    again = read_city(tmp_path / "city")
    assert again.moment == read_view(tmp_path / "city").moment == 1.5
    assert content_hash(again).total == content_hash(city).total
    assert again.tracks.look.tolist() == tracks.look.tolist()


def test_the_hash_of_a_mover_follows_its_own_way_alone(small_city):
    before = replace(small_city, tracks=join_tracks([one(3, [0, 2], [0, 20]), one(8, [0], [1])]))
    after = replace(small_city, tracks=join_tracks([one(3, [0, 2], [0, 21]), one(8, [0], [1])]))
    first, second = content_hash(before), content_hash(after)
    assert first.of_object(8) == second.of_object(8)
    assert first.of_object(3) != second.of_object(3)
