from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.furniture.covers import MAKERS, cover
from cityx.city.ground import LABEL
from cityx.ground.standing import stand_on
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network
from cityx.road.surface.covers import covers
from cityx.road.surface.walk_covers import HALF, WALKS, with_walk_covers

STREETS = [([(-90, 0), (0, 0), (90, 0)], {"kind": "secondary", "width": 8.0}),
           ([(0, -90), (0, 0), (0, 90)], {})]  # fmt: skip


def made(city):
    rows = city.scene.instances["street_covers"]
    names = [city.scene.prototypes[number].name for number in rows.prototype.tolist()]
    return rows, np.array(names)


def test_gullies_lie_at_the_kerb_and_manholes_in_the_lanes(layout_of, city_of):
    city = covers(ground(network(city_of(layout_of(STREETS)))))
    rows, names = made(city)
    assert (names == "gully").sum() > 10
    assert (names == "manhole").sum() > 5
    found = city.ground
    labels = ("carriageway", "junction", "marking", "gutter")
    road = np.isin(found.face_label, [LABEL[name] for name in labels])
    triangles = found.triangles[road[found.triangle_face]]
    surface = shapely.union_all(shapely.polygons(found.vertices[triangles][..., :2]))
    spots = shapely.points(rows.position[:, :2])
    assert shapely.intersects(surface, spots).all()
    rim = shapely.distance(surface.boundary, spots)
    assert np.allclose(rim[names == "gully"], 0.2, atol=0.06)
    assert (rim[names == "manhole"] > 1.0).all()


def test_covers_do_not_depend_on_the_order_of_the_streets(layout_of, city_of):
    layout = layout_of(STREETS)
    mixed = replace(layout, roads=layout.roads.iloc[::-1].reset_index(drop=True))
    one, other = (made(covers(network(city_of(each))))[0] for each in (layout, mixed))
    assert np.array_equal(one.object_id, other.object_id)
    assert np.allclose(one.position, other.position)


def test_below_level_two_there_are_none(layout_of, city_of):
    city = network(city_of(layout_of(STREETS), lod=1))
    assert "street_covers" not in covers(city).scene.instances


def test_spacing_is_kept(layout_of, city_of):
    city = network(city_of(layout_of([([(-90, 0), (90, 0)], {"width": 8.0})])))
    few, many = ((made(covers(city, gullies=gap))[1] == "gully").sum() for gap in (60.0, 20.0))
    assert many > 2 * few


@pytest.mark.parametrize("name", list(MAKERS))
def test_covers_are_flush(name):
    vertices = cover(name).mesh.vertices
    assert vertices[:, 2].max() < 0.02
    assert np.abs(vertices[:, :2]).max() < 0.45


RING = [(14 * np.cos(a), 14 * np.sin(a)) for a in np.arange(8) * np.pi / 4]
ROUNDABOUT = [
    ([*RING, RING[0]], {"oneway": True, "roundabout": True, "lanes": 1}),
    *(([RING[k], (6 * RING[k][0], 6 * RING[k][1])], {"width": 7.0}) for k in (0, 2, 4, 6)),
]


def test_a_roundabout_has_gullies_on_the_outside_alone(layout_of, city_of):
    rows, names = made(covers(ground(network(city_of(layout_of(ROUNDABOUT)))), gullies=8.0))
    reach = np.hypot(*rows.position[names == "gully", :2].T)
    assert (reach < 20.0).any()
    assert reach.min() > 14.0


def test_gullies_follow_the_kerb_round_corners(layout_of, city_of):
    city = covers(ground(network(city_of(layout_of(ROUNDABOUT)))), gullies=8.0)
    rows, names = made(city)
    found = city.ground
    stones = found.triangles_of("kerb")
    kerb = shapely.union_all(shapely.polygons(found.vertices[stones][..., :2]))
    gap = shapely.distance(kerb, shapely.points(rows.position[names == "gully", :2]))
    assert np.allclose(gap, 0.2, atol=0.02)


def test_a_junction_has_manholes_where_its_sewers_meet(layout_of, city_of):
    rows, names = made(covers(ground(network(city_of(layout_of(STREETS))))))
    amid = rows.position[(names == "manhole") & (np.hypot(*rows.position[:, :2].T) < 5.5), :2]
    assert 1 <= len(amid) <= 2
    assert len(amid) == 1 or np.hypot(*(amid[0] - amid[1])) >= 8.0
    single = layout_of([([(-90, 0), (90, 0)], {"kind": "secondary", "width": 8.0})])
    rows, names = made(covers(ground(network(city_of(single)))))
    assert not np.isin(names[np.hypot(*rows.position[:, :2].T) < 1.2], "manhole").any()


def test_lids_in_walks_lie_within_one_surface_and_flush_with_it(layout_of, city_of):
    city = covers(ground(network(city_of(layout_of(STREETS)))))
    rows = city.scene.instances["walk_covers"]
    assert rows.count > 8
    mesh = city.scene.meshes["ground"]
    names = [city.scene.prototypes[number].name for number in rows.prototype.tolist()]
    for row, name in enumerate(names):
        half = np.array(HALF[name]) - 0.01
        turn = rows.rotation[row, 2]
        axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        at = rows.position[row, :2] + (np.array([(1, 1), (1, -1), (-1, 1), (-1, -1)]) * half) @ axes
        under = stand_on(mesh, at)
        assert set(under.label.tolist()) <= {LABEL[word] for word in WALKS}
        assert len(set(under.label.tolist())) == 1
        assert np.allclose(under.z, rows.position[row, 2], atol=0.01)
    again = covers(ground(network(city_of(layout_of(STREETS))))).scene.instances["walk_covers"]
    assert again.position.tobytes() == rows.position.tobytes()


def test_lids_follow_the_slope_of_their_walk(layout_of, city_of):
    flat = covers(ground(network(city_of(layout_of(STREETS)))))
    tilted = replace(flat, scene=flat.scene.with_mesh("ground", _tilted(flat, 0.05, 0.02)))
    rows = with_walk_covers(tilted, np.arange(flat.network.edge_count)).scene.instances
    rows = rows["walk_covers"]
    x, y, z = rows.rotation.astype(float).T
    up = np.stack([np.cos(x) * np.sin(y) * np.cos(z) + np.sin(x) * np.sin(z),
                   np.cos(x) * np.sin(y) * np.sin(z) - np.sin(x) * np.cos(z),
                   np.cos(x) * np.cos(y)], axis=1)  # fmt: skip
    normal = np.array([-0.05, -0.02, 1.0]) / np.linalg.norm([0.05, 0.02, 1.0])
    assert rows.count > 8
    assert np.abs(up - normal).max() < 2e-3


def _tilted(city, east, north):
    mesh = city.scene.meshes["ground"]
    vertices = mesh.vertices.copy()
    vertices[:, 2] += east * vertices[:, 0] + north * vertices[:, 1]
    return replace(mesh, vertices=vertices)
