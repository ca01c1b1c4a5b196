"""People who stay at a place, and vehicles that stand at one."""

import numpy as np
import pytest
import shapely

from cityx.checks.movement_checks import check_movement
from cityx.checks.predicates import measure
from cityx.city.content import content_hash
from cityx.city.ground import ON_ROADWAY, ROADWAY
from cityx.edit.life.gatherings import gathering
from cityx.edit.life.stopped import stopped_vehicles
from cityx.errors import ActionFailed
from cityx.geometry.polygons import corners_of
from cityx.ids import id_text


def ids_of(city, kind, table="areas"):
    rows = getattr(city.layout, table)
    return tuple(id_text(int(one)) for one in rows.loc[rows["kind"] == kind, "id"])


def bodies(city):
    position = city.tracks.position[city.tracks.sample_start[:-1], :2]
    away = np.hypot(*(position[:, None] - position[None]).transpose(2, 0, 1))
    return away[np.triu_indices(len(position), 1)]


@pytest.mark.parametrize("count", [1, 8])
@pytest.mark.parametrize("doing", ["stand", "wait"])
def test_as_many_as_asked_stand_on_the_square_and_none_in_another(park, doing, count):
    city = gathering(park, within=ids_of(park, "pedestrian"), doing=doing, count=count)
    assert measure(f"n(pedestrian, mode=stand, in=plaza) == {count}", city).met
    assert not count > 1 or bodies(city).min() > 0.6
    assert not any(check.value for check in check_movement(city))


def test_who_talks_faces_somebody(park):
    city = gathering(park, within=ids_of(park, "pedestrian"), doing="talk", count=9)
    assert measure("n(pedestrian, mode=talk) == 9", city).met
    alone = gathering(park, within=ids_of(park, "pedestrian"), doing="stand", count=1)
    assert measure("n(pedestrian, mode=talk) == 0", alone).met


@pytest.mark.parametrize(
    ("who", "told"),
    [("wheelchair", "gear=wheelchair"), ("pram", "gear=pram"), ("child", "age=child"),
     ("elder", "age=elder"), ("woman", "gender=female")],
)  # fmt: skip
def test_all_are_of_the_kind_that_is_asked_for(park, who, told):
    city = gathering(park, within=ids_of(park, "park"), who=who, count=4)
    assert measure(f"n(pedestrian, {told}, at=park) == 4", city).met


def test_children_play_within_the_park_and_a_pram_is_pushed(park):
    city = gathering(park, within=ids_of(park, "park"), doing="play", who="child", count=3)
    city = gathering(city, within=ids_of(park, "park"), doing="walk", who="pram", count=1)
    assert measure("n(pedestrian, age=child, at=park) == 3", city).met
    assert measure("n(pedestrian, gear=pram, mode=walk) == 1", city).met
    assert not any(check.value > check.limit for check in check_movement(city))


def test_the_same_call_gives_the_same_bytes_and_once_more_other_people(park):
    once, again = (gathering(park, within=ids_of(park, "park"), count=5) for _ in range(2))
    assert content_hash(once).total == content_hash(again).total
    both = gathering(once, within=ids_of(park, "park"), count=5)
    assert both.tracks.count == 10


def test_more_than_there_are_seats_for_are_refused_with_how_many_there_are(park):
    with pytest.raises(ActionFailed, match="free seats, 900 are asked for"):
        gathering(park, within=ids_of(park, "pedestrian"), doing="sit", count=900)


@pytest.mark.parametrize(
    "kind", ["taxi", "police", "ambulance", "fire_engine", "snow_plough", "van"]
)
def test_vehicles_of_a_kind_stand_on_the_street_and_touch_nothing(grid, kind):
    city = stopped_vehicles(grid, kind=kind, count=2)
    assert measure(f"n(vehicle, type={kind}, moves=false) == 2", city).met
    assert measure(f"n(parked_vehicle, type={kind}, at=road) == 2", city).met
    assert measure(f"gained(vehicle, type={kind}) == 2", city, before=grid).met
    assert (
        content_hash(stopped_vehicles(grid, kind=kind, count=2)).total == content_hash(city).total
    )


def test_vehicles_keep_to_the_streets_that_are_named(grid):
    main = ids_of(grid, "primary", "roads") or ids_of(grid, "secondary", "roads")
    city = stopped_vehicles(grid, kind="van", how="double_park", count=1, within=main)
    assert measure("n(vehicle, type=van, at=road) >= 1", city).met


def test_more_vehicles_than_there_is_room_for_are_refused(grid):
    with pytest.raises(ActionFailed, match=r"There is room for \d+ of 500 there\."):
        stopped_vehicles(grid, kind="bus", count=500)


def test_a_queue_stands_in_the_lanes_one_behind_the_other(grid):
    lights = ids_of(grid, "primary", "roads") or ids_of(grid, "secondary", "roads")
    city = stopped_vehicles(grid, how="queue", within=lights)
    rows = city.scene.instances["stopped_vehicles"]
    assert len(rows.object_id) >= 4
    assert city.ground.on(rows.position[:, :2], *ROADWAY, *ON_ROADWAY).all()
    assert measure("n(vehicle, moves=false, at=road) >= 4", city).met
    assert content_hash(stopped_vehicles(grid, how="queue", within=lights)).total == (
        content_hash(city).total
    )


@pytest.mark.parametrize(("who", "worn"), [("steward", "hi_vis"), ("officer", "uniform")])
def test_people_of_a_role_are_told_by_what_they_have_on(park, who, worn):
    city = gathering(park, within=ids_of(park, "park"), count=3, who=who)
    assert measure(f"gained(pedestrian, wears={worn}) == 3", city, before=park).met


def test_people_stay_on_ground_that_corners_tell(park):
    x, y = shapely.get_coordinates(park.layout.areas.geometry.iloc[0].centroid)[0]
    box = corners_of(shapely.box(x - 12, y - 12, x + 12, y + 12))
    city = gathering(park, ground=box, count=4)
    at = city.tracks.position[city.tracks.sample_start[:-1], :2]
    assert len(at) == 4
    assert (np.abs(at - [x, y]) <= 12 + 10).all()
