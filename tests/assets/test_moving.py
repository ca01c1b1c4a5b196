import numpy as np
import pytest
from moving_city import BIKE, CAR, MAN, moving

from cityx.assets.vehicles.movers import vehicle
from cityx.assets.vehicles.moving import PEOPLE, TRAFFIC, mover_counts, with_movers
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash


def prototypes(city, layer):
    rows = city.scene.instances[layer]
    return rows, [city.scene.prototypes[index] for index in rows.prototype]


def test_movers_are_rows_under_their_own_ids():
    city = with_movers(moving(CAR, MAN), 2.0)
    rows, kinds = prototypes(city, TRAFFIC)
    body = rows.object_id.tolist().index(8)
    assert kinds[body].kind == "vehicle"
    assert rows.position[body].tolist() == [10, 0, 0]
    assert sorted(rows.owner.tolist()) == [0, 8, 8, 8, 8]
    people, kinds = prototypes(city, PEOPLE)
    assert people.object_id.tolist() == [9]
    assert kinds[0].kind == "person"
    assert people.position[0] == pytest.approx([3, 6.8, 0.12])


def test_a_mover_looks_the_way_it_goes():
    rows, _ = prototypes(with_movers(moving(CAR, MAN)), TRAFFIC)
    yaw = rows.rotation[rows.object_id.tolist().index(8), 2]
    assert (np.sin(yaw), -np.cos(yaw)) == pytest.approx((1, 0), abs=1e-6)  # -y of the prototype
    rows, _ = prototypes(with_movers(moving(CAR, MAN)), PEOPLE)
    yaw = rows.rotation[0, 2]
    assert (np.sin(yaw), -np.cos(yaw)) == pytest.approx((0, 1), abs=1e-6)


def test_wheels_touch_the_ground_and_turn_by_the_metres_gone():
    model = vehicle("car_sedan")
    radius = model.wheels[0].radius
    gone = radius * np.pi / 2 / 5.0  # seconds for a quarter turn at 5 m/s
    rows, kinds = prototypes(with_movers(moving(CAR), gone), TRAFFIC)
    wheels = [i for i, kind in enumerate(kinds) if kind.kind == "wheel"]
    assert len(wheels) == 4
    assert rows.position[wheels, 2] == pytest.approx(radius)
    x, y = rows.position[wheels, :2].T
    assert np.ptp(x) == pytest.approx(model.wheelbase)
    assert np.ptp(y) == pytest.approx(1.82, abs=0.05)
    for row in wheels:
        a, _, c = rows.rotation[row].astype(float)
        top = np.array([np.sin(c) * np.sin(a), -np.cos(c) * np.sin(a), np.cos(a)])  # of local z
        assert top == pytest.approx([1, 0, 0], abs=1e-6)  # what was on top is in front


def test_a_climbing_car_has_its_nose_up():
    from dataclasses import replace

    city = moving(CAR)
    risen = city.tracks.position.copy()
    risen[1, 2] = 5.0  # 5 m over 50 m
    city = replace(city, tracks=replace(city.tracks, position=risen))
    rows, kinds = prototypes(with_movers(city, 5.0), TRAFFIC)
    body = [k.kind for k in kinds].index("vehicle")
    assert rows.rotation[body, 0] == pytest.approx(-np.arctan(0.1), rel=1e-3)
    front = max((i for i, k in enumerate(kinds) if k.kind == "wheel"),
                key=lambda i: rows.position[i, 0])  # fmt: skip
    assert rows.position[front, 2] > rows.position[body, 2] + vehicle("car_sedan").wheels[0].radius


def test_legs_follow_the_metres_gone():
    names = {
        prototypes(with_movers(moving(MAN), t), PEOPLE)[1][0].name for t in np.linspace(0, 1, 30)
    }
    assert len(names) > 10


def test_a_bicycle_has_a_rider_who_is_no_pedestrian():
    city = with_movers(moving(BIKE, MAN))
    rows, kinds = prototypes(city, TRAFFIC)
    rider = [kind.kind for kind in kinds].index("rider")
    assert rows.owner[rider] == 10
    top = kinds[rider].mesh.vertices[:, 2].max()
    assert 1.5 < top < 2.0
    assert mover_counts(city.tracks, 0.0) == {"vehicles": 1, "pedestrians": 1}


def test_nothing_is_stored_and_the_moment_changes_only_what_moves():
    city = moving(CAR, MAN)
    before = content_hash(city).total
    first, later = with_movers(city, 1.0), with_movers(city, 3.0)
    assert content_hash(city).total == before
    assert TRAFFIC not in city.scene.instances
    assert (first.moment, later.moment) == (1.0, 3.0)
    assert first.scene.instances[TRAFFIC].position.tobytes() != (
        later.scene.instances[TRAFFIC].position.tobytes()
    )


def test_a_city_in_which_nothing_moves_is_returned_as_it_is():
    city = City("Still", Frame(52.0, 13.0), Layout((-50, -50, 50, 50)))
    assert with_movers(city) is city


def test_the_same_moment_gives_the_same_bytes():
    made = [with_movers(moving(CAR, MAN, BIKE), 4.2).scene.instances for _ in range(2)]
    for layer in (TRAFFIC, PEOPLE):
        first, second = (vars(held[layer]) for held in made)
        assert all(first[name].tobytes() == second[name].tobytes() for name in first)
