import numpy as np
import pytest

from cityx.assets.materials import MATERIALS
from cityx.assets.trees import HABITS, SPECIES, VARIANTS, crown_radius, plant, size_of, tree


def leaves_of(mesh):
    faces = mesh.faces[mesh.material == mesh.materials.index("leaf")]
    return mesh.vertices[np.unique(faces[faces >= 0])]


@pytest.mark.parametrize("species", SPECIES)
def test_a_tree_has_the_height_crown_and_clear_stem_of_its_habit(species):
    habit = HABITS[species]
    vertices = tree(species).mesh.vertices
    assert vertices[:, 2].max() == pytest.approx(habit.height, rel=0.12)
    assert vertices[:, 2].min() == pytest.approx(-0.4, abs=0.01)
    reach = np.quantile(np.hypot(*vertices[:, :2].T), 0.98)
    assert 0.75 * habit.radius < reach < 1.35 * habit.radius + 0.3
    crown = leaves_of(tree(species).mesh)
    assert np.quantile(crown[:, 2], 0.02) > 0.6 * habit.clear


@pytest.mark.parametrize("species", SPECIES)
def test_forms_have_their_share_of_triangles(species):
    near = tree(species, 0, "near").mesh.triangle_count
    light = tree(species, 0, "light").mesh.triangle_count
    assert 4_000 < near < 18_000
    assert light < 0.35 * near
    assert set(tree(species).mesh.materials) <= set(MATERIALS)


def test_variants_differ_and_repeat_exactly():
    meshes = [tree("maple", variant).mesh.vertices for variant in range(VARIANTS)]
    assert not np.array_equal(meshes[0][:500], meshes[1][:500])
    again = tree.__wrapped__("maple", 0, "near").mesh
    assert np.array_equal(again.vertices, meshes[0])


def test_only_deciduous_trees_lose_their_leaves():
    assert "leaf" not in tree("lime", 0, "bare").mesh.materials
    assert "leaf" in tree("spruce", 0, "bare").mesh.materials


def test_leaves_are_darker_within_than_without():
    mesh = tree("lime").mesh
    leaf = mesh.material == mesh.materials.index("leaf")
    centre = mesh.vertices[mesh.faces[leaf, :3]].mean(axis=1)
    middle = np.array([0, 0, 0.55 * HABITS["lime"].height])
    depth = np.linalg.norm((centre - middle) / [3.7, 3.7, 5.2], axis=1)
    green = mesh.tint[leaf, 1]
    assert green[depth > 0.9].mean() > 1.4 * green[depth < 0.5].mean()


def test_the_crown_is_empty_above_and_below():
    habit = HABITS["oak"]
    assert crown_radius(habit, np.array([0.0, habit.height + 1])).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("name", ["shrub", "palm", "grove"])
def test_other_plants_have_the_size_they_state(name):
    for form in ("near", "light", "bare", "bare_light"):
        vertices = plant(name, 1, form).mesh.vertices
        height, radius = size_of(name)
        assert vertices[:, 2].max() == pytest.approx(height, rel=0.35)
        assert np.quantile(np.hypot(*vertices[:, :2].T), 0.98) < 1.4 * radius
