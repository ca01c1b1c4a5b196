import numpy as np
import pytest

from cityx.assets.openings.doors import DOORS, door
from cityx.assets.openings.windows import DRESSINGS, WINDOWS, window
from cityx.assets.shops.shopfronts import FITTINGS, HEIGHT, SHOPFRONTS, WIDTH, fitting, shopfront
from cityx.assets.styles.materials import MATERIALS
from cityx.assets.trims.roof_furniture import DECK_ROWS, REACH, ROOF_FURNITURE, roof_furniture
from cityx.assets.trims.trims import TRIMS, trim

ALL = [
    *((window, name, dressing) for name in WINDOWS for dressing in range(len(DRESSINGS))),
    *((door, name) for name in DOORS),
    *((shopfront, name) for name in SHOPFRONTS),
    *((fitting, name) for name in FITTINGS),
    *((trim, name) for name in TRIMS),
    *((roof_furniture, name) for name in ROOF_FURNITURE),
]

MOST = 900  # triangles of a window with tracery
PARKED = 4200  # the same of four bays with the cars in them


def name_of(form):
    return "-".join(map(str, form[1:]))


@pytest.mark.parametrize("form", ALL, ids=name_of)
def test_prototype_is_modest_and_of_known_materials(form):
    made = form[0](*form[1:])
    assert set(made.mesh.materials) <= set(MATERIALS)
    most = PARKED if made.name in DECK_ROWS else MOST
    assert 10 <= made.mesh.triangle_count <= most
    assert np.isfinite(made.mesh.vertices).all()


@pytest.mark.parametrize("name", WINDOWS)
def test_window_fills_the_opening_it_is_drawn_for(name):
    _, width, height = WINDOWS[name]
    points = window(name).mesh.vertices
    # Sills, hoods and shutters reach beyond the opening; nothing falls short of it.
    beyond = 0.62 if name in ("window_shuttered", "window_persiana") else 0.42
    assert -beyond <= points[:, 2].min() <= 1e-6
    assert height - 0.02 <= points[:, 2].max() <= height + beyond
    assert width - 0.02 <= np.ptp(points[:, 0]) <= width + 2 * beyond


@pytest.mark.parametrize("form", ALL, ids=name_of)
def test_nothing_on_a_wall_reaches_behind_it(form):
    made = form[0](*form[1:])
    if made.kind == "roof_furniture":
        return
    assert made.mesh.vertices[:, 1].max() <= 1e-6


def test_shopfronts_have_one_size():
    for name in SHOPFRONTS:
        points = shopfront(name).mesh.vertices
        assert np.ptp(points[:, 0]) == pytest.approx(WIDTH, abs=0.02)
        assert points[:, 2].max() == pytest.approx(HEIGHT, abs=0.02)


def test_reach_holds_every_piece_of_roof_furniture():
    for name, reach in REACH.items():
        plan = roof_furniture(name).mesh.vertices[:, :2]
        assert np.hypot(*plan.T).max() <= reach + 0.1
