from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from shapely import LineString, MultiPoint

from cityx.checks.predicates import measure
from cityx.city import Terrain
from cityx.city.ground import KERB_HEIGHT
from cityx.geometry.polylines import pack
from cityx.nature.land.barriers import barriers, sweep


@pytest.fixture(scope="module")
def raised(crossroads):
    return barriers(crossroads)


def open_edges(mesh):
    triangles, _ = mesh.triangles()
    edges = Counter()
    for a, b, c in triangles.tolist():
        for edge in ((a, b), (b, c), (c, a)):
            edges[edge] += 1
    return [e for e, n in edges.items() if edges[e[::-1]] != n]


def volume(mesh):
    triangles, _ = mesh.triangles()
    p = mesh.vertices[triangles]
    return np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6


def test_every_barrier_is_closed_and_faces_outwards(raised):
    batch = raised.scene.meshes["barriers"]
    assert open_edges(batch) == []
    for row in range(batch.count):
        assert volume(batch.take([row])) > 0.01


def test_a_swept_box_has_the_volume_of_length_width_and_height():
    line = pack(np.array([LineString([(0, 0), (10, 0)])], dtype=object))
    profile = np.array([[1.0, 0.0], [-1.0, 0.0], [-1.0, 1.0], [1.0, 1.0]])
    size, tint = np.array([[0.5, 2.0]]), np.ones((1, 3))
    mesh = sweep(line, np.array([7], np.uint64), np.zeros(2), profile, size, "brick", tint)
    assert volume(mesh) == pytest.approx(20.0)


def test_a_hedge_leaves_the_road_open(raised):
    batch = raised.scene.meshes["barriers"]
    hedge = batch.take(np.flatnonzero(batch.object_id == 52))
    assert len(hedge.vertices)
    assert np.abs(hedge.vertices[:, 0]).min() > 5.0


def test_ids_are_those_of_the_lines(raised):
    assert raised.scene.meshes["barriers"].object_id.tolist() == [51, 52, 53]


def test_fences_and_walls_are_of_the_colour_that_a_map_tells(crossroads):
    lines = crossroads.layout.lines
    rows = lines["kind"].isin(("fence", "wall")).to_numpy()
    told = lines.assign(tags=np.where(rows, '{"colour": "white"}', lines["tags"]))
    made = barriers(replace(crossroads, layout=replace(crossroads.layout, lines=told)))
    assert rows.any()
    for kind in lines["kind"][rows].unique():
        assert measure(f"share({kind}, color=white) == 1.0", made).met
        assert not measure(f"share({kind}, color=white) == 1.0", barriers(crossroads)).met


def test_barriers_follow_the_terrain(crossroads):
    from dataclasses import replace

    slope = Terrain((-100.0, -100.0), 200.0, np.array([[0.0, 20.0], [0.0, 20.0]]))
    batch = barriers(replace(crossroads, terrain=slope)).scene.meshes["barriers"]
    wall = batch.take(np.flatnonzero(batch.object_id == 51)).vertices
    ground = slope.height_at(wall[:, :2]) + KERB_HEIGHT
    assert (wall[:, 2] - ground).max() == pytest.approx(1.6, abs=0.05)
    assert MultiPoint(wall[:, :2]).bounds[2] < -59.0


def test_a_hedge_near_by_swells_and_sinks_and_stays_closed(crossroads):
    from dataclasses import replace

    fine = [barriers(replace(crossroads, lod=3)).scene.meshes["barriers"] for _ in range(2)]
    hedge = fine[0].take(np.flatnonzero(fine[0].object_id == 52))
    assert open_edges(fine[0]) == []
    assert volume(hedge) > 0.01
    assert len(np.unique(hedge.tint[:, 1])) > 0.4 * len(hedge.faces)  # two pieces, one pattern
    assert np.array_equal(fine[0].vertices, fine[1].vertices)
