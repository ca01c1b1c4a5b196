from dataclasses import replace

import numpy as np

from cityx.city.frame import Frame
from cityx.city.mesh import NO_VERTEX
from cityx.nature.furniture.guard_rails import ZEBRA, guard_rails
from cityx.road.network.network import network

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


def test_pipes_stand_between_kerb_and_walk_in_japan_where_the_walk_is_wide(layout_of, city_of):
    def pipes(place, walk):
        main = {"kind": "secondary", "width": 8.0, "sidewalk_left": walk, "sidewalk_right": walk}
        city = replace(network(city_of(layout_of([([(-90, 0), (90, 0)], main)]))), lod=2)
        city = replace(city, frame=Frame(*place))
        return guard_rails(city).scene.meshes.get("guard_rails")

    tokyo = (35.69, 139.78)
    mesh = pipes(tokyo, 3.0)
    aside = np.abs(mesh.vertices[:, 1])
    assert 4.25 < aside.min() < aside.max() < 4.0 + 3.0 - 1.5
    starts = np.array([mesh.vertices[a:b, 0].min() for a, b in
                       zip(mesh.vertex_start, mesh.vertex_start[1:], strict=False)])  # fmt: skip
    assert np.diff(np.unique(np.round(starts))).min() > 13.0  # openings of 2 m between pieces
    assert pipes(tokyo, 1.5) is None
    assert pipes((52.5, 13.4), 3.0) is None


def test_pipes_leave_crossings_open(layout_of, city_of):
    streets = [
        ([(-90, 0), (0, 0), (90, 0)], {"kind": "secondary", "width": 8.0}),
        ([(0, -90), (0, 0), (0, 90)], {"sidewalk_left": 2.5, "sidewalk_right": 2.5}),
    ]
    made = network(city_of(layout_of(streets, points=[((0, 0), "traffic_signals")])))
    city = replace(
        made,
        lod=2,
        frame=Frame(35.69, 139.78),
        network=replace(made.network, crossing=np.ones_like(made.network.crossing)),
    )
    mesh = guard_rails(city).scene.meshes["guard_rails"]
    reach = np.abs(mesh.vertices[:, :2]).max(axis=1).min()
    assert reach >= made.network.trim.max(axis=1).min() + ZEBRA - 0.01


def test_a_rail_keeps_its_id_when_others_come_or_go(layout_of, city_of):
    far, near = ([(-90, 60), (90, 60)], FAST), ([(-90, 0), (90, 0)], FAST)
    alone = rails(layout_of([near]), city_of)
    both = rails(layout_of([near, far]), city_of)
    split = rails(
        layout_of([([(-90, 0), (0, 0), (90, 0)], FAST), ([(0, -30), (0, -90)], {})]), city_of
    )
    assert len(np.intersect1d(alone.object_id, both.object_id)) == alone.count == 2
    assert len(np.unique(split.object_id)) == split.count
