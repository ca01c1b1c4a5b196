import pytest

from cityx.protocol import Format, registry
from cityx.protocol.conversions import ConversionGraph, NotConvertible, Path, reason

PAPER = {
    "Point_to_face_conversion", "Cube_generation", "Point_generation", "Line_generation",
    "Face_generation", "Line_to_face_conversion", "Asset_placement", "Point_to_line_conversion",
    "OSM_file_retrieval", "Object_meshing", "Texture_information_extraction",
    "Asset_material_retrieval", "Asset_mesh_retrieval", "Scene_object_information_extraction",
}  # fmt: skip


@pytest.fixture(scope="module")
def actions():
    return registry(outside=False)


@pytest.fixture(scope="module")
def graph(actions):
    return ConversionGraph.of(actions)


def test_the_papers_fourteen_interfaces_are_there_by_name(actions):
    records = [actions[i] for i in actions.of_stage("convert")]
    assert {r.classname for r in records if not r.extension} == PAPER
    assert all(actions[name].classname == name for name in PAPER)


def test_every_pair_of_formats_has_a_path_or_a_reason(graph):
    table = graph.table()
    assert len(table) == 196
    for (source, target), answer in table.items():
        if isinstance(answer, NotConvertible):
            assert answer.reason == reason(source, target)
            assert "lacks a role" not in answer.reason
            assert "No conversion keeps" not in answer.reason
        else:
            assert len(answer.edges) <= 4
            assert (answer.edges == ()) == (source is target)


def test_geometry_is_closed(graph):
    formats = (
        Format.SCENE_LAYOUT, Format.POINT, Format.LINE, Format.SURFACE, Format.BASIC_GEOMETRY,
        Format.COMPLEX_GEOMETRY,
    )  # fmt: skip
    table = graph.table()
    assert all(isinstance(table[a, b], Path) for a in formats for b in formats)
    sources = (Format.IMAGE, Format.GEOGRAPHIC_DATA, Format.RANDOM_NUMBER, Format.NOISE_FUNCTION)
    assert all(isinstance(table[a, b], Path) for a in sources for b in formats)


def test_a_semantic_map_becomes_faces_by_way_of_points(graph):
    path = graph.path((Format.IMAGE, "semantic_map"), (Format.SURFACE, ""))
    assert path.steps == ("Image_to_point_conversion", "Point_to_face_conversion")
    assert path.target == (Format.SURFACE, "semantic")


def test_a_line_of_one_subject_is_not_a_line_of_another(graph):
    road, barrier = (Format.LINE, "road_centerline"), (Format.LINE, "barrier")
    wanted = (Format.SURFACE, "road_surface")
    assert graph.path(road, wanted).steps == ("Line_to_face_conversion",)
    assert isinstance(graph.path(barrier, wanted), NotConvertible)


def test_the_answer_does_not_depend_on_the_order_of_sources(graph):
    sources = [((Format.LINE, "b"), 0.0), ((Format.LINE, "a"), 0.0), ((Format.POINT, "c"), 0.0)]
    target = (Format.SCENE_LAYOUT, "")
    assert graph.best(sources, target) == graph.best(sources[::-1], target)


def test_losses_multiply_along_a_path(graph):
    path = graph.path((Format.IMAGE, "semantic_map"), (Format.SURFACE, ""))
    kept = (1 - path.edges[0].lossy) * (1 - path.edges[1].lossy)
    assert path.lossy == pytest.approx(1 - kept)


def test_a_number_is_never_drawn_from_data(graph):
    answer = graph.path((Format.SCENE_LAYOUT, ""), (Format.RANDOM_NUMBER, ""))
    assert answer.reason == (
        "A random number must not depend on data; its stream is keyed by identity."
    )
