"""Streets, blocks and water of procedural towns, over several windows."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from cityx.town.blocks import blocks_of
from cityx.town.districts import Districts
from cityx.town.plane import Plan, Plane
from cityx.town.window import with_places

WINDOW = (-450.0, -450.0, 450.0, 450.0)


def dry_districts(plan, seed):
    plane = Plane(plan, seed)
    districts = Districts(plane)
    keys = [key for key in plane.lattice.keys_near(WINDOW, 0.0) if not plane.is_wet(key)]
    return plane, [districts.district(key) for key in keys], districts


def neighbours(districts, found):
    """Every place of the street net to the places next to it."""
    net = {}
    for district in found:
        sketch = district.sketch
        lines = [district.places[link] for link in district.links]
        for m, side in enumerate(sketch.rim.sides):
            lines.append(with_places(side.line, districts.rim_places(sketch, side, m)))
        for line in lines:
            points = [tuple(place) for place in line.tolist()]
            for a, b in pairwise(points):
                net.setdefault(a, set()).add(b)
                net.setdefault(b, set()).add(a)
    return net


@pytest.mark.parametrize(
    ("plan", "seed"),
    [
        (Plan(), 1),
        (Plan(river=True), 2),
        (Plan(pattern="grid", river=True), 12),
        (Plan(pattern="organic"), 3),
        (Plan(pattern="radial", river=True), 4),
        (Plan(pattern="superblock"), 5),
    ],
)
def test_streets_keep_the_measures_of_real_towns(plan, seed):
    plane, found, districts = dry_districts(plan, seed)
    town = [district for district in found if district.sketch.zone != "rural"]
    net = neighbours(districts, town)
    degree = np.array([len(near) for near in net.values()])
    junctions = degree[degree >= 3]
    dead = (degree == 1).sum() / ((degree == 1).sum() + len(junctions))
    assert 3.0 <= junctions.mean() <= 3.5
    assert 0.01 <= dead <= 0.2
    angles = []
    for place, near in net.items():
        if len(near) >= 3:
            away = np.array(sorted(near), float) - place
            turn = np.sort(np.arctan2(away[:, 1], away[:, 0]))
            angles.append(np.diff(np.append(turn, turn[0] + 2 * np.pi)).min())
    assert np.degrees(min(angles)) > 40.0
    blocks = [blocks_of(plane, district) for district in town]
    area = np.concatenate([shapely.area(some.shapes) for some in blocks])
    kind = np.concatenate([some.kind for some in blocks])
    assert 0.4e4 <= np.median(area[area > 300.0]) <= 2e4
    assert 0.06 <= area[kind == "park"].sum() / area.sum() <= 0.17


def test_parks_and_zones_follow_the_plan():
    plane, found, _ = dry_districts(Plan(zone="row", parks=0.3, plazas=0.0), 7)
    blocks = [blocks_of(plane, district) for district in found]
    area = np.concatenate([shapely.area(some.shapes) for some in blocks])
    kind = np.concatenate([some.kind for some in blocks])
    zone = np.concatenate([some.zone for some in blocks])
    assert set(zone) == {"row", ""}
    assert 0.2 <= area[kind == "park"].sum() / area.sum() <= 0.4
    assert not (kind == "pedestrian").any()


def test_the_sea_lies_where_the_plan_says():
    plane = Plane(Plan(coast="east", shore=300.0), 5)
    far_east = plane.lattice.nearest([[3_000_000, 0]])[0]
    far_west = plane.lattice.nearest([[-3_000_000, 0]])[0]
    assert plane.water_kind(tuple(far_east.tolist())) == "sea"
    assert plane.water_kind(tuple(far_west.tolist())) == ""


@pytest.mark.parametrize("seed", [2, 5, 9, 18])
def test_rims_by_rivers_and_lakes_are_sound(seed):
    for plan in (Plan(river=True), Plan(pattern="grid", river=True, lakes=0.2)):
        plane = Plane(plan, seed)
        rims = Districts(plane).rims
        for key in plane.lattice.keys_near(WINDOW, 0.0):
            if not plane.is_wet(key):
                outline = rims.rim(key).polygon()
                assert outline.is_valid
                assert outline.exterior.is_ccw
