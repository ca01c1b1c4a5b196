import numpy as np
import pytest

from cityx.assets.furniture.landmark_pieces import LANDMARK_MAKERS
from cityx.assets.furniture.potted_plants import POT_ROWS
from cityx.assets.furniture.shore_pieces import SHORE_MAKERS
from cityx.assets.furniture.street_furniture import MAKERS, furniture
from cityx.assets.styles.materials import MATERIALS
from cityx.checks.body_checks import DEEP
from cityx.ground.street_rules import WALL_GAP

HEIGHTS = {
    "street_lamp_mast": 8.2, "street_lamp_post": 4.55, "bench": 0.87, "bollard": 0.96,
    "bus_stop": 2.8, "traffic_signal": 3.5, "sign_stop": 2.75, "post_box": 1.4, "flagpole": 9.1,
    "power_pole": 9.0, "telephone": 2.56, "fire_hydrant": 0.79, "bus": 3.2,
}  # fmt: skip
LARGEST = ("pylon", "tower_crane", "yard_container_pair", "yard_container_stack")  # lattices, ribs
TREES = ("pot_row_maple", "pot_row_olive")


@pytest.mark.parametrize("name", MAKERS)
def test_a_piece_is_small_named_and_of_known_materials(name):
    piece = furniture(name)
    assert piece.name == name
    # The one bears its word four times, the next is 17 m long, then trees; the others have wheels.
    large = name in ("telephone_kiosk", "barge", *TREES) or name.startswith("motor_scooter")
    most = 3500 if name in LARGEST else 2500 if large else 1200
    most = 5000 if name in LANDMARK_MAKERS else most  # a town has one of each
    assert 20 <= piece.mesh.triangle_count <= most
    assert set(piece.mesh.materials) <= set(MATERIALS)
    assert np.isfinite(piece.mesh.vertices).all()


_JIBS = {"tower_crane": 8.0, "border_post": 3.0}  # metres that reach to one side


@pytest.mark.parametrize("name", MAKERS)
def test_a_piece_stands_on_the_ground_at_its_origin(name):
    vertices = furniture(name).mesh.vertices
    deepest = -1.5 if name in SHORE_MAKERS else -0.5  # steps and hulls go down into the water
    if name == "hanging_basket":  # over the heads of those who pass
        assert 2.1 < vertices[:, 2].min() < 2.4
    else:
        assert deepest < vertices[:, 2].min() <= 0.1
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    assert np.hypot(*middle[:2]) < _JIBS.get(name, 2.0)


@pytest.mark.parametrize("name", HEIGHTS)
def test_a_piece_has_its_real_height(name):
    assert furniture(name).mesh.vertices[:, 2].max() == pytest.approx(HEIGHTS[name], abs=0.06)


@pytest.mark.parametrize("name", ["street_lamp_mast", "street_lamp_post"])
def test_a_lamp_has_a_head_that_glows_over_the_road(name):
    mesh = furniture(name).mesh
    glow = mesh.faces[mesh.material == mesh.materials.index("lamp_glow")]
    spots = mesh.vertices[glow[glow >= 0]]
    assert spots[:, 2].min() > 3.5
    assert spots[:, 1].mean() < 0.01


@pytest.mark.parametrize("detail", [2, 3])
@pytest.mark.parametrize("name", POT_ROWS)
def test_a_row_of_pots_keeps_off_its_wall_and_trees_alone_rise_above_sills(name, detail):
    vertices = furniture(name, detail=detail).mesh.vertices
    tree = name in TREES
    assert vertices[:, 1].max() < WALL_GAP["pot_row"] + DEEP
    assert -vertices[:, 1].min() < (0.5 if tree else WALL_GAP["pot_row"] + DEEP)
    assert np.abs(vertices[:, 0]).max() < 0.9
    low, high = (1.8, 2.3) if tree else (0.5, 1.3)
    assert low < vertices[:, 2].max() < high
