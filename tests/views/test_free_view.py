"""Moments with nothing before the lens, and parked cars that would fill a picture."""

from dataclasses import replace

import numpy as np
import pytest
from crossing_town import crossing_town
from moving_city import CAR, MAN, moving

from cityx.assets.vehicles.movers import size_of
from cityx.city.camera import Camera
from cityx.city.mesh import one_mesh
from cityx.city.moments import moments_of
from cityx.city.rows import without_objects
from cityx.city.scene import Instances, Prototype
from cityx.city.store import view_of
from cityx.city.tracks import join_tracks
from cityx.views.free_view import (
    AT_EDGE,
    NEAR,
    ROOM,
    _abreast,
    _alike,
    _along_roadway,
    _amid,
    _framed,
    _stands,
    _turns,
    _unhidden,
    free_moment,
    in_the_way,
)

EAST, WEST = np.pi / 2, -np.pi / 2


def lens(x, y, heading=EAST, height=1.7):
    return Camera("street", (x, y, height), heading, 0.0)


def at(city, moment):
    return view_of(replace(city, moment=moment))


def test_a_picture_waits_until_a_car_is_so_far_ahead():
    view = at(moving(CAR), 1.0)  # its middle is 5 m before the lens, its rear less
    moment = free_moment(view, lens(0.0, 0.0))
    rear = 5.0 * moment - size_of("car_sedan")[0] / 2
    assert NEAR <= rear < NEAR + 0.5 * 5.0
    assert free_moment(view, lens(0.0, 0.0)) == moment


@pytest.mark.parametrize(
    "camera", [lens(0.0, 0.0, WEST), lens(0.0, 9.0), lens(0.0, 0.0, height=30.0)]
)
def test_what_is_not_before_the_lens_changes_nothing(camera):
    assert free_moment(at(moving(CAR), 1.0), camera) == 1.0


def test_where_something_always_stands_it_is_as_far_as_it_gets():
    slow = (*MAN[:4], (2.0, 0.0, 0.0), 0.0, 0.2)  # walks from 2 m to 4 m ahead
    assert free_moment(at(moving(slow), 0.0), lens(0.0, 0.0)) == 10.0


def test_the_busiest_moment_shows_most_that_moves_and_keeps_the_lens_free():
    view = at(moving(CAR), 9.0)  # far ahead by then
    moment = free_moment(view, lens(0.0, 0.0), busiest=True)
    rear = 5.0 * moment - size_of("car_sedan")[0] / 2
    assert ROOM <= rear < ROOM + 0.5 * 5.0  # as near as may be
    assert free_moment(view, lens(0.0, 0.0)) == 9.0
    assert free_moment(view, lens(0.0, 0.0, WEST), busiest=True) == 9.0


def test_a_moment_with_a_vehicle_and_a_person_is_busier_than_one_with_more_people():
    people = [(100 + n, *MAN[1:4], (20.0 + n, 3.0, 0.0), 0.0, 0.0) for n in range(6)]
    alone = moving(*people, seconds=20.0)
    car = moving((*CAR[:4], (-60.0, 0.0, 0.0), 0.0, 7.5), *people, seconds=20.0)
    assert free_moment(at(alone, 1.0), lens(0.0, 0.0), busiest=True) == 1.0
    moment = free_moment(at(car, 1.0), lens(0.0, 0.0), busiest=True)
    assert -60.0 + 7.5 * moment > ROOM


def test_people_behind_a_van_do_not_make_a_moment_busy():
    man = (*MAN[:4], (24.0, 0.0, 0.0), 0.0, 0.0)
    late = (*CAR[:4], (12.0, 0.0, 0.0), 0.0, 0.0)
    aside = (*CAR[:4], (12.0, -3.5, 0.0), 0.0, 0.0)
    hidden, seen = (moving(each, man, seconds=10.0) for each in (late, aside))
    shares = [shown_of(city) for city in (hidden, seen)]
    assert shares[0] < 0.4
    assert shares[1] == 1.0


def test_of_cars_painted_alike_the_nearer_one_counts_whole():
    cars = [(100 + n, *CAR[1:4], (12.0 + 6.0 * n, 0.0, 0.0), 0.0, 0.0) for n in range(3)]
    tracks = moving(*cars, MAN, seconds=10.0).tracks
    tracks = replace(
        tracks, tint=np.array([[1, 1, 1], [1, 1, 1], [0, 0, 1], [1, 1, 1]], np.float32)
    )
    found = moments_of(tracks, [0.0, 1.0])
    rank = _alike(tracks, found, found.number, np.hypot(*found.position[:, :2].T))
    assert rank.tolist() == [0, 0, 1, 1, 0, 0, 0, 0]


def test_people_who_walk_make_a_moment_busier_than_people_who_wait():
    waiting = (*MAN[:4], (20.0, 3.0, 0.0), 0.0, 0.0)
    walking = (101, *MAN[1:4], (20.0, -30.0, 0.0), np.pi / 2, 1.4)
    tracks = moving(waiting, walking, seconds=10.0).tracks
    found = moments_of(tracks, [0.0, 1.0, 2.0])
    assert _stands(found).tolist() == [True] * 3 + [False] * 3


def test_what_is_amid_the_picture_counts_for_more_than_what_its_edge_cuts():
    cars = [(100 + n, *CAR[1:4], (20.0, y, 0.0), 0.0, 0.0) for n, y in enumerate((0.0, 6.0, 11.0))]
    tracks = moving(*cars, seconds=10.0).tracks
    found = moments_of(tracks, [0.0])
    size = tracks.size[found.mover].astype(float)
    weight = _amid(lens(0.0, 0.0), _framed(lens(0.0, 0.0), found, size))
    assert weight[0] > 0.95
    assert weight[0] > weight[1] > weight[2] >= AT_EDGE


def shown_of(city):
    """Return how much of its second mover a lens 1.2 m above the ground sees."""
    found = moments_of(city.tracks, [0.0])
    size = city.tracks.size[found.mover].astype(float)
    far = np.hypot(*found.position[:, :2].T)
    camera = lens(0.0, 0.0, height=1.2)
    return _unhidden(camera, found, _framed(camera, found, size), found.number, far)[1]


def wall(city, x, height):
    """Return a view of a city with a wall across the east-west axis."""
    corners = [(x, -20.0, 0.0), (x, 20.0, 0.0), (x, 20.0, height), (x, -20.0, height)]
    mesh = one_mesh(1, corners, [[0, 1, 2, 3]])
    return view_of(replace(city, scene=city.scene.with_mesh("buildings", mesh)))


def test_what_a_house_hides_does_not_make_a_moment_busy():
    car = moving((*CAR[:4], (20.0, -60.0, 0.0), np.pi / 2, 6.0), seconds=20.0)  # past at ten
    moment = free_moment(at(car, 1.0), lens(0.0, 0.0), busiest=True)
    assert abs(6.0 * moment - 60.0) < 8.0
    assert free_moment(replace(wall(car, 15.0, 9.0), moment=1.0), lens(0.0, 0.0), busiest=True) == 1
    assert free_moment(replace(wall(car, 15.0, 0.2), moment=1.0), lens(0.0, 0.0), busiest=True) == (
        moment
    )


def test_a_high_lens_sees_farther_for_its_busiest_moment():
    car = moving((*CAR[:4], (150.0, -60.0, 0.0), np.pi / 2, 6.0), seconds=20.0)
    above = Camera("aerial", (0.0, 0.0, 120.0), EAST, -0.6)
    moment = free_moment(at(car, 1.0), above, busiest=True)
    assert abs(6.0 * moment - 60.0) < 20.0  # amid the picture
    assert free_moment(at(car, 1.0), above) == 1.0


def test_a_city_where_nothing_moves_keeps_its_moment():
    still = replace(moving(CAR), tracks=None)
    assert free_moment(at(still, 3.0), lens(0.0, 0.0)) == 3.0


def parked(*places):
    """Return a view with cars, boxes of 4 by 1.8 m."""
    corners = [(-2.0, -0.9), (2.0, -0.9), (2.0, 0.9), (-2.0, 0.9)]
    mesh = one_mesh(1, [(x, y, z) for z in (0.0, 0.8, 1.4) for x, y in corners], [[8, 9, 10, 11]])
    n = len(places)
    rows = Instances(
        np.zeros(n, np.int32), np.arange(1, n + 1, dtype=np.uint64), np.zeros(n, np.uint64),
        np.array(places, float), np.zeros((n, 3), np.float32), np.ones((n, 3), np.float32),
        np.ones((n, 3), np.float32),
    )  # fmt: skip
    city = replace(moving(CAR), tracks=None)
    prototype = Prototype("car", "vehicle", mesh)
    return view_of(replace(city, scene=city.scene.with_instances("vehicles", [prototype], rows)))


def test_parked_cars_about_the_lens_or_right_before_it_are_left_out():
    view = parked((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (12.0, 0.0, 0.0), (-5.0, 0.0, 0.0))
    found = in_the_way(view, lens(0.0, 0.0))
    assert found.tolist() == [1, 2]
    left = without_objects(view.scene, found.tolist())
    assert left.instances["vehicles"].object_id.tolist() == [3, 4]
    assert not len(in_the_way(view, lens(0.0, 0.0, height=40.0)))


def test_cars_that_pass_each_other_make_a_moment_less_busy_than_cars_apart():
    there = (100, *CAR[1:4], (12.0, -1.6, 0.0), 0.0, 5.0)
    back = (101, *CAR[1:4], (52.0, 1.6, 0.0), np.pi, 5.0)
    tracks = moving(there, back, MAN, seconds=10.0).tracks
    found = moments_of(tracks, [0.0, 4.0])
    abreast = _abreast(found, tracks.size[found.mover].astype(float), found.number)
    assert abreast.tolist() == [False, True, False, True, False, False]


def test_a_car_across_the_view_makes_a_moment_less_busy_than_one_along_it():
    along = (100, *CAR[1:4], (14.0, 0.0, 0.0), 0.0, 10.0)  # next to the lens at once
    across = (101, *CAR[1:4], (10.5, -40.0, 0.0), np.pi / 2, 5.0)  # a little nearer after 8 s
    view = at(moving(along, across), 5.0)
    assert free_moment(view, lens(0.0, 0.0), busiest=True) < 2.0
    alone = free_moment(at(moving(across), 5.0), lens(0.0, 0.0), busiest=True)
    assert abs(alone - 8.0) < 1.0  # better than an empty street


def test_a_car_that_turns_makes_a_moment_less_busy_than_one_that_goes_straight_on():
    far = (100, *CAR[1:4], (40.0, 2.0, 0.0), 0.0, 0.0)
    city = moving(far, CAR, seconds=8.0)
    tracks = city.tracks
    # The other comes towards the lens and turns off before it.
    time = np.arange(0.0, 8.5, 0.5)
    turn = np.clip((time - 4.0) / 4.0, 0.0, 1.0) * np.pi / 2
    gone = 5.0 * time
    xy = np.column_stack([46.0 - gone, 0.0 * gone, 0.0 * gone])
    first = tracks.take(np.array([0]))
    place = np.zeros(len(time), np.uint64)
    turner = replace(
        tracks.take(np.array([1])), time=time, position=xy, heading=np.pi - turn,
        speed=np.full(len(time), 5.0, np.float32), sample_start=np.array([0, len(time)]),
        gait=np.full(len(time), tracks.gait[-1]), place=place,
    )  # fmt: skip
    found = moments_of(turner, time)
    assert _turns(found).tolist() == (time >= 4.0).tolist()
    view = at(replace(city, tracks=join_tracks([first, turner])), 0.0)
    assert free_moment(view, lens(0.0, 0.0), busiest=True) < 4.0
    straight = replace(turner, heading=np.full(len(time), np.pi))
    view = at(replace(city, tracks=join_tracks([first, straight])), 0.0)
    assert free_moment(view, lens(0.0, 0.0), busiest=True) > 5.0


def walker(number, start, heading, speed):
    return (number, *MAN[1:4], start, heading, speed)


def test_people_walk_along_a_roadway_who_neither_cross_it_nor_keep_to_its_pavement():
    tracks = moving(
        walker(1, (-40.0, 1.5, 0.0), 0.0, 1.4), walker(2, (-30.0, 1.5, 0.0), np.pi / 2, 1.4),
        walker(3, (-20.0, 4.4, 0.12), 0.0, 1.4), walker(4, (-20.0, 30.0, 0.0), 0.0, 1.4),
    ).tracks  # fmt: skip
    town = view_of(replace(crossing_town(plaza=False), tracks=tracks))
    found = moments_of(tracks, [0.0])
    assert _along_roadway(town, found).tolist() == [True, False, False, False]
    assert not _along_roadway(replace(town, network=None), found).any()


def test_a_moment_with_somebody_on_the_roadway_is_not_the_busiest():
    there = walker(1, (-35.0, 4.4, 0.12), 0.0, 0.5)

    def busiest(y, z):
        passing = walker(2, (-40.0, y, z), np.pi, 3.0)  # towards the lens and out of its view
        city = replace(crossing_town(plaza=False), tracks=moving(there, passing).tracks)
        return free_moment(at(city, 0.0), lens(-60.0, 0.0), busiest=True)

    assert busiest(4.4, 0.12) < 4.0
    assert busiest(1.5, 0.0) >= 4.0
