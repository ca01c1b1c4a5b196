import numpy as np
import pytest
import shapely

from cityx.geometry.polylines import to_linestrings
from cityx.ground.arrangement import face_areas, inner_points
from cityx.road.ground.ground_surface import ground
from cityx.road.ground.joints import courses, seam_lines
from cityx.road.network.network import network, road_network

SLANT = np.array([np.cos(0.5), np.sin(0.5)])
ASIDE = np.array([-SLANT[1], SLANT[0]])
CROSS = [([tuple(-90 * SLANT), (0, 0), tuple(90 * SLANT)], {}),
         ([tuple(-90 * ASIDE), (0, 0), tuple(90 * ASIDE)], {})]  # fmt: skip


def test_walks_are_paved_along_their_own_street_up_to_the_corner(layout_of, city_of):
    city = ground(network(city_of(layout_of(CROSS))))
    found = city.ground
    walk = found.labelled("sidewalk") & (face_areas(found) > 0.5)
    along = courses(found, city.network).along[walk]
    at = inner_points(found)[walk]
    on_first = np.abs(at @ ASIDE) < np.abs(at @ SLANT)  # nearer to the street along the slant
    assert on_first.any()
    assert (~on_first).any()
    ahead = np.where(on_first[:, None], SLANT, ASIDE)
    assert np.abs((along * ahead).sum(axis=1)) == pytest.approx(1.0, abs=1e-4)


def test_the_pattern_of_the_mesh_follows_the_courses(layout_of, city_of):
    city = ground(network(city_of(layout_of(CROSS[:1]))))
    mesh = city.scene.meshes["ground"]
    rows = np.isin(np.array(mesh.materials)[mesh.material], ["paving"])
    corners, uv = mesh.vertices[mesh.faces[rows, :3]][..., :2], mesh.uv[rows][:, :3]
    along = (corners[:, 1] - corners[:, 0]) @ SLANT
    assert np.abs(uv[:, 1, 0] - uv[:, 0, 0]) == pytest.approx(np.abs(along), abs=2e-3)


def test_a_seam_leads_from_the_corner_of_the_kerbs_to_that_of_the_walks(layout_of):
    layout = layout_of([([(-90, 0), (0, 0), (90, 0)], {}), ([(0, 0), (0, 90)], {})])
    seams = seam_lines(layout, road_network(layout))
    ends = shapely.get_coordinates(seams).reshape(-1, 2, 2)
    assert len(ends) == 2
    assert np.abs(ends[:, 0]) == pytest.approx(3.0)
    assert np.abs(ends[:, 1]) == pytest.approx(3.0 + 0.15 + 2.0, abs=0.1)


def test_a_street_without_walks_has_no_seams(layout_of):
    bare = {"sidewalk_left": 0.0, "sidewalk_right": 0.0}
    layout = layout_of([(line, bare) for line, _ in CROSS])
    assert not len(seam_lines(layout, road_network(layout)))


def test_a_curve_has_a_seam_every_twelve_degrees(layout_of):
    angle = np.linspace(0, np.pi / 2, 31)
    line = [(60 * np.cos(a) - 30, 60 * np.sin(a) - 30) for a in angle]
    layout = layout_of([(line, {})])
    graph = road_network(layout)
    drawn = to_linestrings(graph.lines)
    seams = seam_lines(layout, graph)
    assert len(seams) == pytest.approx(2 * 90 / 12, abs=2)
    off = shapely.distance(drawn[0], shapely.get_point(seams, 0))
    assert off == pytest.approx(3.0, abs=0.02)


@pytest.mark.parametrize(("half", "name"), [(90, "slab_walk"), (6, "mosaic")])
def test_a_small_piece_of_a_walk_has_no_bands(layout_of, city_of, half, name):
    city = ground(network(city_of(layout_of([([(-half, 0), (half, 0)], {})]))))
    laid, bent = {"sidewalk": "slab_walk"}, {"slab_walk": "mosaic"}
    found = courses(city.ground, city.network, laid, bent=bent)
    largest = np.argmax(face_areas(city.ground) * city.ground.labelled("sidewalk"))
    assert found.materials[found.material[largest]] == name
