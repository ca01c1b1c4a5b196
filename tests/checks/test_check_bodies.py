"""Things that can be pushed about stand free; what is planted into a wall or a thing is named."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.assets.colliders import collider_of
from cityx.checks import body_checks
from cityx.checks.body_checks import box_of, check_bodies, outlines_of
from cityx.city.bodies import colliders_of
from cityx.ids import id_text


@pytest.fixture(scope="module")
def park(scene):
    return scene("park_s")


def with_places(city, layer, places):
    rows = city.scene.instances[layer]
    moved = rows.position.copy()
    for row, place in places.items():
        moved[row] = place
    rows = replace(rows, position=moved)
    scene = city.scene.with_instances(layer, city.scene.prototypes, rows)
    return replace(city, scene=scene)


def benches(city):
    rows, names = city.scene.instances["park_pieces"], [p.name for p in city.scene.prototypes]
    return np.flatnonzero(rows.prototype == names.index("bench"))


def test_things_of_a_base_scene_stand_free(park):
    (check,) = check_bodies(park)
    assert check.value == 0
    assert check.ids == ()
    parts = outlines_of(park)
    assert len(np.unique(parts.object_id[parts.movable])) > 10


def test_benches_in_each_other_and_in_walls_are_named(park):
    rows = park.scene.instances["park_pieces"]
    one, other, third, fourth = benches(park)[:4]
    wall = park.layout.buildings.geometry.iloc[0].centroid
    planted = with_places(
        park, "park_pieces",
        {one: rows.position[other] + (0.5, 0, 0), third: (wall.x, wall.y, 0.12),
         fourth: (wall.x, wall.y, 60.0)},
    )  # fmt: skip
    (check,) = check_bodies(planted)
    wanted = sorted(id_text(int(rows.object_id[row])) for row in (one, other, third))
    assert list(check.ids) == wanted  # the one high over the roof is free
    assert not check.ok


def test_a_bench_under_the_crown_of_a_lamp_is_free(park):
    rows = park.scene.instances["park_pieces"]
    names = [p.name for p in park.scene.prototypes]
    lamp = np.flatnonzero(rows.prototype == names.index("street_lamp_post"))[0]
    one = benches(park)[0]
    beside = with_places(park, "park_pieces", {one: rows.position[lamp] + (0, 0.45, 0)})
    through = with_places(park, "park_pieces", {one: rows.position[lamp]})
    assert check_bodies(beside)[0].ids == ()
    assert check_bodies(through)[0].ids == (id_text(int(rows.object_id[one])),)


def test_a_city_without_things_is_not_measured(park):
    assert check_bodies(replace(park, scene=replace(park.scene, instances={}))) == []


def test_what_is_caught_does_not_depend_on_which_plans_are_drawn(park, monkeypatch):
    rows = park.scene.instances["park_pieces"]
    crowd = with_places(park, "park_pieces", {row: rows.position[row - 1] + (0.9, 0.3, 0)
                                              for row in range(1, rows.count, 3)})  # fmt: skip
    few, every = check_bodies(crowd), outlines_of(crowd)
    monkeypatch.setattr(body_checks, "outlines_of", lambda *_: every)
    assert few == check_bodies(crowd)
    assert few[0].ids


def test_boxes_hold_the_colliders(park):
    outdoors = [one for one in park.scene.prototypes if one.kind in ("furniture", "vehicle")]
    assert len(outdoors) > 5
    for prototype in outdoors:
        parts = colliders_of([tuple(collider_of(prototype))])
        corners = [parts.corners(part) for part in range(len(parts.form))]
        if not corners:
            continue
        ring, low, high = box_of(prototype)
        points = np.concatenate(corners)
        inside = (points >= (*ring[0], low)) & (points <= (*ring[2], high))
        assert inside.all(), prototype.name
