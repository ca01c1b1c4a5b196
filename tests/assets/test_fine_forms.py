import numpy as np
import pytest

from cityx.assets.openings.doors import DOORS, FINE_DOORS, door
from cityx.assets.openings.frames import NICHE_DEPTH, rim_of
from cityx.assets.openings.windows import PATTERNS, WINDOWS, window
from cityx.assets.shapes import bevelled, fine_shapes, leaf_blades
from cityx.assets.shops.shopfronts import FINE_FITTINGS, FINE_SHOPFRONTS, fitting, shopfront
from cityx.assets.styles.materials import MATERIALS
from cityx.assets.trees import tree
from cityx.assets.trims.mouldings import frame, ledge, rectangle, ring_moulding
from cityx.assets.trims.trims import FINE_TRIMS, trim
from cityx.assets.vehicles.car_bodies import BODIES
from cityx.assets.vehicles.vehicles import car
from cityx.city.mesh_measures import check_closed, degenerate_faces, volume
from cityx.geometry.solids import area_vectors

MADE = [
    *((window, name, 2) for name in [*PATTERNS, "window_arched"]),
    *((door, name) for name in FINE_DOORS),
    *((shopfront, name) for name in FINE_SHOPFRONTS),
]
ORNAMENT = [
    *((window, name, 2) for name in WINDOWS if name not in PATTERNS),
    *((door, name) for name in DOORS if name not in FINE_DOORS),
    *((trim, name) for name in FINE_TRIMS),
    *((fitting, name) for name in FINE_FITTINGS),
]


def name_of(form):
    return "-".join(map(str, form[1:]))


@pytest.mark.parametrize("form", [*MADE, *ORNAMENT], ids=name_of)
def test_fine_forms_are_sound_and_of_known_materials(form):
    made = form[0](*form[1:], detail=3)
    assert set(made.mesh.materials) <= set(MATERIALS)
    assert np.isfinite(made.mesh.vertices).all()
    assert np.isfinite(made.mesh.uv).all()
    assert degenerate_faces(made.mesh, smallest=1e-12).mean() < 0.02
    assert made.mesh.triangle_count < 40_000


@pytest.mark.parametrize("form", MADE, ids=name_of)
def test_what_fills_a_niche_stays_before_its_back(form):
    made = form[0](*form[1:], detail=3)
    assert made.mesh.vertices[:, 1].max() <= NICHE_DEPTH + 1e-9


@pytest.mark.parametrize("name", PATTERNS)
@pytest.mark.parametrize("dressing", range(4))
def test_a_fine_window_is_as_large_as_the_plain_one(name, dressing):
    _, width, height = WINDOWS[name]
    points = window(name, dressing, detail=3).mesh.vertices
    inside = points[points[:, 1] > 0.001]
    assert np.ptp(inside[:, 0]) == pytest.approx(width, abs=0.02)
    assert inside[:, 2].max() == pytest.approx(height, abs=0.02)
    assert inside[:, 2].min() > -1e-9


@pytest.mark.parametrize("name", [*PATTERNS, *FINE_DOORS, "window_arched", "shop"])
def test_rims_are_convex_and_within_the_opening(name):
    rim = rim_of(name)
    edge = np.roll(rim, -1, axis=0) - rim
    after = np.roll(edge, -1, axis=0)
    assert (edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0] > -1e-12).all()
    assert np.abs(rim[:, 0]).max() <= 0.5
    assert rim[:, 1].min() == 0.0
    assert rim[:, 1].max() <= 1.0


def test_fine_forms_have_many_times_the_triangles():
    for name in PATTERNS:
        plain, fine = window(name, 2), window(name, 2, detail=3)
        assert fine.mesh.triangle_count > 8 * plain.mesh.triangle_count
    for body in BODIES:
        assert car(body, detail=3).mesh.triangle_count > 4 * car(body).mesh.triangle_count
    fine, near = tree("lime", 0, "fine"), tree("lime", 0, "near")
    assert fine.mesh.triangle_count > 1.5 * near.mesh.triangle_count


@pytest.mark.parametrize("hidden", [(), ("+y",), ("+y", "-z")])
def test_a_bevelled_box_faces_outward(hidden):
    mesh = bevelled((0, 0, 0), (1, 2, 3), "trim", hidden=hidden)
    corner = mesh.vertices[mesh.faces[:, 0]]
    outward = (area_vectors(mesh.vertices, mesh.faces) * (corner - [0.5, 1.0, 1.5])).sum(axis=1)
    assert (outward > 0).all()
    assert check_closed(mesh)[0] == (not hidden)


def test_a_frame_covers_the_border_it_is_swept_over():
    mesh = frame(0, 2, 0, 3, [(0, 0.05), (0.1, 0.05)], "trim")
    vector = area_vectors(mesh.vertices, mesh.faces)
    assert np.allclose(vector[:, [0, 2]], 0)
    assert -vector[:, 1].sum() == pytest.approx(2 * 3 - 1.8 * 2.8)


def test_a_moulding_runs_round_a_polygon_with_mitres():
    angle = np.linspace(0, 2 * np.pi, 9)[:-1]
    octagon = np.column_stack([np.cos(angle), np.sin(angle)])
    mesh = ring_moulding(octagon, [(0, 0), (0.1, 0)], "trim")
    apothem = np.cos(np.pi / 8)
    shares = 1 - ((apothem - 0.1) / apothem) ** 2
    area = -area_vectors(mesh.vertices, mesh.faces)[:, 1].sum()
    assert area == pytest.approx(shares * 8 * apothem * np.sin(np.pi / 8))


def test_a_ledge_is_a_closed_prism():
    mesh = ledge(rectangle(-0.1, 0.0, 0.0, 0.2), -1, 1, "trim")
    assert check_closed(mesh)[0]
    assert volume(mesh)[0] == pytest.approx(0.04)


def test_fine_shapes_end_with_their_block():
    from cityx.assets.shapes import box

    with fine_shapes():
        assert box((0, 0, 0), (1, 1, 1), "trim").triangle_count == 44
    assert box((0, 0, 0), (1, 1, 1), "trim").triangle_count == 12


def test_leaves_have_four_triangles_each():
    ones = np.ones((5, 1))
    made = leaf_blades(np.zeros((5, 3)), ones * [1, 0, 0], ones * [0, 1, 0], "leaf", (1, 1, 1))
    assert made.triangle_count == 20
    assert (area_vectors(made.vertices, made.faces)[:, 2] < 0).all()
