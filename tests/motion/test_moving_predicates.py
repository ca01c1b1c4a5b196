"""What is measured of characters and vehicles that an action put on a path."""

import pytest

from cityx.checks.predicates import measure, measure_all
from cityx.checks.report import counts
from cityx.motion.character import add_characters
from cityx.motion.vehicle_on_path import add_vehicles

P19 = (
    "n(pedestrian) == 1", "follows(pedestrian, loop1, dev=0.5)",
    "stat(pedestrian, speed, mean) in [2.2, 5.0]", "n(pedestrian, mode=run) == 1", "same(others)",
)  # fmt: skip


def test_the_public_task_of_a_running_man_is_met(park):
    city, _ = add_characters(park, path="around the park", walk_run="run", gender="male")
    findings = measure_all(P19[:-1], city)
    assert [finding.met for finding in findings] == [True] * 4
    assert measure("same(building)", city, before=park).met
    assert measure("n(pedestrian, gender=male) == 1", city).met
    assert measure("n(pedestrian, gender=female) == 0", city).met


@pytest.mark.parametrize(
    ("asked", "met"),
    [
        ("n(pedestrian, mode=walk) == 3", True),
        ("n(pedestrian, mode=run) == 0", True),
        ("follows(pedestrian, loop1, dev=0.5)", True),
        ("follows(pedestrian, loop1, dev=0.1)", False),  # they go two abreast
        ("follows(pedestrian, x1, dev=0.5)", False),
        ("stat(pedestrian, speed, mean) in [1.3, 1.5]", True),
        ("density(pedestrian, x1) == 0", True),
    ],
)
def test_walkers_are_measured_by_what_they_do(park, asked, met):
    city, _ = add_characters(park, path="loop1", walk_run="walk", count=3)
    assert measure(asked, city).met is met


def test_who_walks_on_the_sidewalk_of_a_street_follows_it(park):
    city, _ = add_characters(park, path="x1", count=4)
    assert measure("follows(pedestrian, x1, dev=0.5)", city).met
    assert not measure("follows(pedestrian, x2, dev=0.5)", city).met


def test_parked_cars_have_no_speed_and_moving_ones_do(park):
    city, _ = add_vehicles(park, path="y1", kind="bus", speed=8.0)
    assert measure("n(bus) == 1", city).met
    assert measure("stat(vehicle, speed, mean) in [7.9, 8.1]", city).met
    assert measure("density(vehicle, y1) >= 3", city).met
    assert counts(city)["vehicles"] == 1
    assert counts(city)["pedestrians"] == 0


def test_what_moves_is_placed_once_for_all_kinds_of_things(park, monkeypatch):
    from cityx.checks.predicates import pieces

    city, _ = add_characters(park, path="loop1", walk_run="walk", count=3)
    placed, asked = pieces.with_movers, []
    monkeypatch.setattr(pieces, "with_movers", lambda held: asked.append(held) or placed(held))
    measure_all(("n(pedestrian) == 3", "n(bench) == 0", "n(tree) == 0"), city)
    measure("n(vehicle) == 0", city)
    assert len(asked) == 1
