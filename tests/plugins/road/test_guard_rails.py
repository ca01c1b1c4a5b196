from dataclasses import replace

import numpy as np

from cityx.city.mesh import NO_VERTEX
from cityx.plugins.road.guard_rails import guard_rails
from cityx.plugins.road.network import network

FAST = {"kind": "motorway", "oneway": True, "width": 11.0, "sidewalk_left": 0.0,
        "sidewalk_right": 0.0}  # fmt: skip


def rails(layout, city_of):
    city = replace(network(city_of(layout)), lod=2)
    return guard_rails(city).scene.meshes.get("guard_rails")


def test_a_motorway_has_a_beam_on_either_side(layout_of, city_of):
    mesh = rails(layout_of([([(-90, 0), (90, 0)], FAST)]), city_of)
    assert mesh.count == 2
    aside = np.abs(mesh.vertices[:, 1])
    assert aside.min() > 5.5 + 0.6
    assert aside.max() < 5.5 + 0.8
    assert 0.8 < mesh.vertices[:, 2].max() < 0.95  # above the ground, which is a kerb high


def test_no_beam_lies_across_a_road_that_joins(layout_of, city_of):
    streets = [([(-90, 0), (0, 0), (90, 0)], FAST), ([(0, 0), (0, 90)], {})]
    mesh = rails(layout_of(streets), city_of)
    north = mesh.vertices[mesh.vertices[:, 1] > 0]
    assert (np.abs(north[:, 0]) > 3.5).all()


def test_beams_are_closed_solids(layout_of, city_of):
    mesh = rails(layout_of([([(-90, 0), (0, 20), (90, 0)], FAST)]), city_of)
    quad = mesh.faces[:, 3] != NO_VERTEX
    f = mesh.faces.astype(np.int64)
    last = np.where(quad, f[:, 3], f[:, 0])
    pairs = np.concatenate([f[:, [0, 1]], f[:, [1, 2]], np.column_stack([f[:, 2], last]),
                            f[quad][:, [3, 0]]])  # fmt: skip
    # Vertices of one object count from its start.
    owner = np.repeat(np.arange(mesh.count), np.diff(mesh.face_start))
    key = np.concatenate([owner, owner, owner, owner[quad]])
    there = {(k, *p) for k, p in zip(key.tolist(), pairs.tolist(), strict=True)}
    assert all((k, b, a) in there for k, a, b in there)


def test_streets_with_walks_have_none(layout_of, city_of):
    assert rails(layout_of([([(-90, 0), (90, 0)], {})]), city_of) is None
