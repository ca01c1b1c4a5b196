import numpy as np
import shapely

from cityx.city.terrain import Terrain, flat_terrain
from cityx.plugins.road.bridges import THICKNESS, deck_mesh, deck_rows, plan_decks
from cityx.plugins.road.ground import ground
from cityx.plugins.road.network import network

BRIDGE = {"bridge": True, "layer": 1}
UNDER = ([(0, -400), (0, 400)], {})
LONG = (-400, -400, 400, 400)


def ramped(layout_of, **options):
    over = [(-150, 0), (150, 0)]
    ends = [([(-390, 0), (-150, 0)], {}), ([(150, 0), (390, 0)], {})]
    return layout_of([(over, BRIDGE | options), *ends, UNDER], extent=LONG)


def edges_of(mesh, index):
    faces = mesh.faces[mesh.face_start[index] : mesh.face_start[index + 1]]
    ring = np.where(faces < 0, faces[:, :1], faces)
    edges = np.stack([ring, np.roll(ring, -1, axis=1)], axis=2).reshape(-1, 2)
    return edges[edges[:, 0] != edges[:, 1]]


def test_a_bridge_over_nothing_stays_on_the_ground(layout_of):
    assert not deck_rows(layout_of([([(-90, 0), (90, 0)], BRIDGE)])).any()


def test_a_bridge_over_a_street_or_over_water_has_a_deck(layout_of):
    assert deck_rows(ramped(layout_of)).tolist() == [True, False, False, False]
    river = layout_of([([(-90, 0), (90, 0)], BRIDGE)], areas=[((-10, -90, 10, 90), "river")])
    assert deck_rows(river).all()


def test_a_street_in_a_tunnel_needs_no_bridge(layout_of):
    layout = layout_of([([(-90, 0), (90, 0)], BRIDGE), ([(0, -90), (0, 90)], {"tunnel": True})])
    assert not deck_rows(layout).any()


def test_a_deck_starts_on_the_ground_clears_the_street_and_keeps_its_grade(layout_of):
    layout = ramped(layout_of)
    decks = plan_decks(layout, flat_terrain(), deck_rows(layout))
    x = decks.lines.points[:, 0]
    assert decks.climb[np.argmin(x)] < 0.05
    assert decks.climb[np.argmin(np.abs(x))] > 5.0
    order = np.argsort(x)
    grade = np.diff(decks.climb[order]) / np.maximum(np.diff(x[order]), 1e-9)
    assert np.abs(grade).max() < 0.081


def test_a_deck_spans_a_valley(layout_of):
    valley = Terrain(
        (-400.0, -400.0), 100.0, 0.2 * np.abs(np.arange(-400.0, 401.0, 100.0)) * np.ones((9, 1))
    )
    layout = ramped(layout_of)
    decks = plan_decks(layout, valley, deck_rows(layout))
    assert np.allclose(decks.z, 30.0, atol=0.1)
    assert decks.climb.max() > 29.0


def test_a_short_bridge_rises_only_as_far_as_its_grade_allows(layout_of):
    streets = [([(-30, 0), (30, 0)], BRIDGE), ([(-90, 0), (-30, 0)], {}),
               ([(30, 0), (90, 0)], {}), ([(0, -90), (0, 90)], {})]  # fmt: skip
    layout = layout_of(streets)
    decks = plan_decks(layout, flat_terrain(), deck_rows(layout))
    assert 1.0 < decks.climb.max() < 2.5


def test_a_deck_is_a_closed_solid_with_a_bend(layout_of):
    layout = layout_of([([(-90, 0), (0, 10), (90, 0)], BRIDGE), UNDER])
    mesh = deck_mesh(layout, plan_decks(layout, flat_terrain(), deck_rows(layout)))
    edges = {tuple(edge) for edge in edges_of(mesh, 0).tolist()}
    assert all((b, a) in edges for a, b in edges)
    triangles, _ = mesh.triangles()
    a, b, c = (mesh.vertices[triangles[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->i", np.cross(a, b), c).sum() / 6
    assert volume > 180 * 10 * THICKNESS


def test_the_street_below_stays_part_of_the_ground(layout_of, city_of):
    city = ground(network(city_of(ramped(layout_of))))
    assert city.scene.meshes["bridges"].object_id.tolist() == [1]
    corners = shapely.polygons(city.ground.vertices[city.ground.triangles])
    under = shapely.contains(corners, shapely.Point(0.5, 0.4))
    assert city.ground.face_object[city.ground.triangle_face[under]].tolist() == [4]
