import numpy as np
import pytest

from cityx.assets.styles.materials import MATERIALS
from cityx.assets.trees import (
    PARK_FORMS,
    SEASONS,
    SPECIES,
    STREET_FORMS,
    TREES,
    WALLED,
    WALLED_FORMS,
    crown_radius,
    habit,
    individuals,
    plant,
    size_of,
    tree,
    wall_reach,
)
from cityx.assets.trees.plants import _grown, individual


def leaves_of(mesh):
    faces = mesh.faces[mesh.material == mesh.materials.index("foliage")]
    return mesh.vertices[np.unique(faces[faces >= 0])]


def leaf_tint(prototype):
    mesh = prototype.mesh
    return mesh.tint[mesh.material == mesh.materials.index("foliage")]


def test_there_are_sixteen_species_and_more():
    assert len(SPECIES) + len({"palm", "shrub", "boxwood"}) >= 16


@pytest.mark.parametrize("species", SPECIES)
def test_a_tree_has_the_height_crown_and_clear_stem_of_its_habit(species):
    grown = habit(species, 0)
    vertices = tree(species).mesh.vertices
    assert vertices[:, 2].max() == pytest.approx(grown.height, rel=0.12)
    assert vertices[:, 2].min() == pytest.approx(-0.4, abs=0.05)
    reach = np.quantile(np.hypot(*vertices[:, :2].T), 0.98)
    assert 0.7 * grown.radius < reach < 1.35 * grown.radius + 0.3
    if not grown.strands:
        assert np.quantile(leaves_of(tree(species).mesh)[:, 2], 0.02) > 0.6 * grown.clear


@pytest.mark.parametrize("species", SPECIES)
def test_street_trees_leave_headroom(species):
    first, count = individuals(species, street=True)
    if TREES[species].street:
        assert (first, count) == (PARK_FORMS, STREET_FORMS)
        low = np.quantile(leaves_of(tree(species, first).mesh)[:, 2], 0.01)
        assert low > 4.5
        assert size_of(species, first)[1] < size_of(species, 0)[1]
    else:
        assert (first, count) == (0, PARK_FORMS)


@pytest.mark.parametrize("form", ["fine", "light", "far"])
def test_a_crown_beside_a_wall_is_flat_on_that_side_alone(form):
    for variant in range(WALLED, WALLED + WALLED_FORMS):
        beside = leaves_of(tree("lime", variant, form).mesh)[:, 0]
        free = leaves_of(tree("lime", variant - STREET_FORMS, form).mesh)[:, 0]
        assert beside.max() < 0.6 * free.max()
        assert beside.min() == pytest.approx(free.min(), rel=0.1)
        assert wall_reach("lime", variant) < 0.5 * size_of("lime", variant)[1]


@pytest.mark.parametrize("species", SPECIES)
def test_forms_have_their_share_of_triangles(species):
    fine, near, light, far = (
        tree(species, 0, form).mesh.triangle_count for form in ("fine", "near", "light", "far")
    )
    assert 12_000 < near < 40_000
    assert 1.4 * near < fine < 160_000
    assert 900 < light < 3_000
    assert far < 60
    assert tree(species, 0, "far", "winter").mesh.triangle_count < 60
    assert set(tree(species).mesh.materials) <= set(MATERIALS)


@pytest.mark.parametrize("species", SPECIES)
def test_no_leaf_floats_far_from_wood(species):
    from scipy.spatial import cKDTree

    grown = individual(species, 0)
    gap, _ = cKDTree(grown.skeleton.position).query(grown.leaves.centre)
    assert gap.max() < 3.2 * habit(species, 0).spread + 0.6
    assert np.quantile(gap, 0.95) < 1.7 * habit(species, 0).spread + 0.25


@pytest.mark.parametrize("species", SPECIES)
def test_leaves_look_outward(species):
    cards = individual(species, 0).leaves
    grown = habit(species, 0)
    middle = [0, 0, grown.clear + 0.42 * (grown.height - grown.clear)]
    outward = cards.centre - middle
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    assert (outward * cards.normal).sum(axis=1).mean() > 0.3


@pytest.mark.parametrize("species", SPECIES)
def test_a_limb_is_never_thicker_than_what_bears_it(species):
    skeleton = individual(species, 0).skeleton
    assert (np.diff(skeleton.parent[1:].astype(float)) >= -len(skeleton.parent)).all()
    assert (skeleton.parent[1:] < np.arange(1, len(skeleton.parent))).all()
    bearer = skeleton.radius[skeleton.parent[1:]]
    assert (skeleton.radius[1:] <= 1.13 * bearer).all()
    assert skeleton.radius[0] == pytest.approx(TREES[species].trunk, rel=0.05)


def test_the_roots_flare():
    vertices = tree("oak").mesh.vertices
    reach = np.hypot(*vertices[:, :2].T)
    foot = reach[np.abs(vertices[:, 2]) < 0.3].max()
    breast = reach[np.abs(vertices[:, 2] - 1.3) < 0.4].max()
    assert foot > 1.3 * breast


def test_variants_differ_and_repeat_exactly():
    meshes = [tree("maple", variant).mesh.vertices for variant in range(9)]
    for i in range(9):
        for j in range(i):
            assert not np.array_equal(meshes[i][:500], meshes[j][:500])
    again = tree.__wrapped__("maple", 0, "near").mesh
    assert np.array_equal(again.vertices, meshes[0])


def test_a_tree_grows_to_the_same_numbers_again():
    first, second = _grown("zelkova", 4), _grown("zelkova", 4)
    assert first
    for name, array in first.items():
        assert array.dtype.kind in "iub"  # whole numbers, so that machines agree
        assert np.array_equal(array, second[name])


def test_a_tree_from_the_cache_is_the_tree_that_was_grown(tmp_path, monkeypatch):
    monkeypatch.setenv("CITYX_CACHE", str(tmp_path))
    grown = individual.__wrapped__("lime", 1)
    assert list(tmp_path.rglob("lime-1.npz"))
    held = individual.__wrapped__("lime", 1)
    assert np.array_equal(grown.leaves.centre, held.leaves.centre)
    assert np.array_equal(grown.skeleton.position, held.skeleton.position)


def test_only_deciduous_trees_lose_their_leaves():
    assert "foliage" not in tree("lime", 0, "near", "winter").mesh.materials
    assert tree("lime", 0, "near", "winter").name.endswith("bare")
    assert "foliage" in tree("spruce", 0, "near", "winter").mesh.materials


@pytest.mark.parametrize("species", SPECIES)
@pytest.mark.parametrize("season", SEASONS)
def test_no_leaf_is_black_or_brighter_than_paint(species, season):
    made = tree(species, 0, "light", season)
    if "foliage" in made.mesh.materials:
        tint = leaf_tint(made)
        assert (tint.max(axis=1) > 0.02).all()
        assert tint.max() <= 1.0


def test_colours_follow_species_and_season():
    def mean(species, season):
        return leaf_tint(tree(species, 0, "light", season)).mean(axis=0)

    red, green, blue = mean("cherry", "spring")
    assert min(red, green, blue) > 0.25  # blossom is pale
    red, green, blue = mean("ginkgo", "autumn")
    assert red > green > 8 * blue  # gold
    assert mean("maple", "autumn")[0] > 3 * mean("maple", "autumn")[1]  # red
    red, green, blue = mean("jacaranda", "spring")
    assert blue > red > green  # violet
    assert np.allclose(mean("camphor", "autumn"), mean("camphor", "summer"))
    assert mean("lime", "spring")[1] > mean("lime", "summer")[1]


def test_leaves_are_darker_within_than_without():
    cards = individual("lime", 0).leaves
    grown = habit("lime", 0)
    middle = np.array([0, 0, grown.clear + 0.42 * (grown.height - grown.clear)])
    half = 0.5 * (grown.height - grown.clear)
    depth = np.linalg.norm((cards.centre - middle) / [grown.radius, grown.radius, half], axis=1)
    assert cards.light[depth > 0.9].mean() > 1.3 * cards.light[depth < 0.5].mean()


def test_the_crown_is_empty_above_and_below():
    grown = habit("oak", 0)
    assert crown_radius(grown, np.array([0.0, grown.height + 1])).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("name", ["shrub", "boxwood", "palm", "grove"])
@pytest.mark.parametrize("season", SEASONS)
def test_other_plants_have_the_size_they_state(name, season):
    for form in ("near", "light"):
        vertices = plant(name, 1, form, season).mesh.vertices
        height, radius, _ = size_of(name)
        assert vertices[:, 2].max() == pytest.approx(height, rel=0.40)
        assert np.quantile(np.hypot(*vertices[:, :2].T), 0.98) < 1.4 * radius


@pytest.mark.parametrize("species", ["lime", "spruce", "willow"])
def test_the_last_bits_of_the_maths_library_change_nothing(species, monkeypatch):
    expected = _grown(species, 1)
    for name in ("sin", "cos", "tan", "exp", "arctan2", "hypot", "log"):
        exact = getattr(np, name)
        monkeypatch.setattr(np, name, lambda *args, exact=exact: np.nextafter(exact(*args), np.inf))
    grown = _grown(species, 1)
    assert expected
    for name, array in expected.items():
        assert np.array_equal(array, grown[name]), name


def test_the_library_grows_in_a_few_seconds():
    import time

    start = time.process_time()
    for species in SPECIES:
        _grown(species, 2)
    # 120 individuals take 6 s here; these 18 about 1 s; a wide margin for slow machines.
    assert time.process_time() - start < 6.0
