import json

import numpy as np
import pytest
import shapely

from cityx.assets.styles.materials import AGEING, MATERIALS, material_named, state_of
from cityx.assets.textures import PATTERNS
from cityx.city.environment import Environment
from cityx.city.mesh import one_mesh
from cityx.errors import UsageError
from cityx.outputs.gltf_material import weather_look
from cityx.road.ground.ground_surface import ground
from cityx.road.surface.surface_material import FAMILIES, WORDS, surface_material, surfaced

STREETS = [
    ([(-90, 0), (0, 0)], {"surface": "asphalt", "tags": json.dumps({"smoothness": "very_bad"})}),
    ([(0, 0), (90, 0)], {"surface": "concrete", "tags": json.dumps({"surface": "concrete"})}),
    ([(0, 0), (0, 90)], {"surface": "sett", "tags": json.dumps({"surface": "cobblestone"})}),
    ([(0, -90), (0, 0)], {"surface": "asphalt", "tags": "{}"}),
]


@pytest.fixture
def city(layout_of, city_of):
    return ground(city_of(layout_of(STREETS)))


def material_at(city, x, y, layer="ground"):
    """Material of the ground at a point."""
    mesh = city.scene.meshes[layer]
    with np.errstate(invalid="ignore"):
        faces = shapely.polygons(mesh.vertices[mesh.faces[:, :3], :2])
    (face,) = np.flatnonzero(shapely.contains_properly(faces, shapely.Point(x, y)))
    return mesh.materials[mesh.material[face]]


def test_tags_of_streets_decide_their_materials(city):
    made = surface_material(city)
    assert material_at(made, -45.2, 1.37) == "asphalt_a2w4r0"
    assert material_named(material_at(made, 45.2, 1.37)).root == "road_concrete"
    assert material_named(material_at(made, 1.37, 45.2)).root == "cobbles"
    assert material_at(made, 1.37, -45.2) == "asphalt"


def test_only_carriageways_change_and_no_vertex_moves(city):
    before, after = city.scene.meshes["ground"], surface_material(city).scene.meshes["ground"]
    np.testing.assert_array_equal(before.vertices, after.vertices)
    np.testing.assert_array_equal(before.uv, after.uv)
    names = [np.array(mesh.materials, object)[mesh.material] for mesh in (before, after)]
    changed = names[0] != names[1]
    assert changed.any()
    assert set(names[0][changed]) <= {"asphalt", "setts", "gravel"}


def test_one_street_gets_a_surface_and_the_others_stay(city):
    made = surface_material(city, street="0" * 15 + "2", surface="bricks", age=1.0)
    assert material_named(material_at(made, 45.2, 1.37)).root == "clinker"
    assert material_at(made, -45.2, 1.37) == "asphalt"


@pytest.mark.parametrize("word", WORDS)
def test_every_surface_is_made_everywhere(city, word):
    made = surface_material(city, surface=word, wear=1.0)
    for place in ((-45.2, 1.37), (45.2, 1.37), (0.53, 0.31)):
        assert material_named(material_at(made, *place)).root == FAMILIES[word]


def test_a_users_own_mesh_gets_the_surface_on_top_alone(city):
    corners = [[0, 0, 0], [9, 0, 0], [9, 4, 0], [0, 4, 0], [0, 0, -1], [9, 0, -1]]
    mesh = one_mesh(7, corners, [[0, 1, 2, 3], [4, 5, 1, 0]], materials=("concrete",))
    scene = city.scene.with_mesh("ramp", mesh)
    made = surface_material(
        type(city)(**{**vars(city), "scene": scene}), layer="ramp", surface="sett"
    ).scene.meshes["ramp"]
    assert [made.materials[m] for m in made.material] == ["setts_a2w0r0", "concrete"]
    assert made.uv[0].tolist() == [[0, 0], [9, 0], [9, 4], [0, 4]]
    assert not surfaced(mesh, np.array([0]), [""]).material.any()


def test_a_surface_is_not_made_in_every_style(city):
    assert material_at(
        surface_material(city, surface="asphalt", style="red"), 45.2, 1.37
    ).startswith("asphalt_red")
    with pytest.raises(UsageError, match='no surface "gravel" in style "red"'):
        surface_material(city, surface="gravel", style="red")


def test_an_unknown_layer_is_named(city):
    with pytest.raises(UsageError, match='no layer "roof"'):
        surface_material(city, layer="roof", surface="sett")


@pytest.mark.parametrize("family", AGEING)
def test_states_are_materials_of_their_family(family):
    for name in (state_of(family, age=0, wear=0), state_of(family, age=1, wear=1, wetness=1)):
        made = material_named(name)
        assert (made.name, made.root) == (name, family)
        assert made.texture in PATTERNS
        assert all(0 < channel <= 1 for channel in made.color)
        assert 0 < made.roughness <= 1


def test_asphalt_bleaches_concrete_darkens_and_water_darkens_and_polishes():
    def look(name, **state):
        made = material_named(state_of(name, **({"age": 0.5, "wear": 0.0} | state)))
        return sum(made.color), made.roughness

    assert look("asphalt", age=1.0)[0] > look("asphalt", age=0.0)[0]
    assert look("road_concrete", age=1.0)[0] < look("road_concrete", age=0.0)[0]
    assert look("setts", wear=1.0)[1] < look("setts", wear=0.0)[1]
    wet, dry = look("asphalt", wetness=1.0), look("asphalt")
    assert wet[0] < dry[0]
    assert wet[1] < dry[1]


def test_a_wet_state_looks_like_the_surface_in_the_rain():
    dry, wet = (material_named(state_of("asphalt", age=0.5, wear=0.25, wetness=w)) for w in (0, 1))
    color, roughness = weather_look(dry, Environment(wetness=1.0))
    assert tuple(color) == pytest.approx(wet.color)
    assert roughness == pytest.approx(wet.roughness)


def test_an_unknown_name_is_grey_and_a_known_one_the_tables():
    assert material_named("asphalt") is MATERIALS["asphalt"]
    assert material_named("cheese_a2w2r2").color == (0.5, 0.5, 0.5)


def test_the_same_city_gets_the_same_bytes(city):
    first, second = (surface_material(city).scene.meshes["ground"] for _ in range(2))
    assert first.materials == second.materials
    assert first.material.tobytes() == second.material.tobytes()
