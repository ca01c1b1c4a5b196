import numpy as np
import pytest
from made_view import box, pane, plate, rows, shot, view

from cityx.city.scene import Prototype, Scene
from cityx.dataset.classes import CLASS
from cityx.dataset.stage import CutOut, stage_of
from cityx.dataset.truth import truth

WALL = box(2, (-8.0, 10.0, 0.0), (8.0, 11.0, 6.0))


def seen(prototype, cut_outs=None, ids=(5,)):
    """Ids of a picture of a thing of 4 x 3 m at 5 m, before a wall."""
    scene = Scene().with_mesh("ground", plate(1, 40.0)).with_mesh("buildings", WALL)
    scene = scene.with_instances(
        "street_furniture", [prototype], rows((0.0, 5.0, 0.0), ids=list(ids))
    )
    one = shot((0.0, 0.0, 1.5), width=400, height=300, hfov=2 * np.arctan(2.0 / 5.0))
    return truth(stage_of(view(scene), cut_outs=cut_outs), one, ["instance", "semantic", "depth"])


def test_a_fence_with_holes_shows_the_wall_behind_in_known_pixels():
    fence = Prototype("fence_segment", "furniture", pane(0, 4.0, 3.0, "metal_dark"))
    # A mesh of wires: of each cell of 0.5 m the left and the upper fifth are wire.
    wires = np.zeros((10, 10), bool)
    wires[:2, :], wires[:, :2] = True, True
    made = seen(fence, {"metal_dark": CutOut(wires, 0.5)}).channels
    # The fence fills the picture exactly; a pixel is 1 cm on it.
    x, height = np.meshgrid(
        np.arange(400) * 0.01 - 2.0 + 0.005, 3.0 - np.arange(300) * 0.01 - 0.005
    )
    wired = (x % 0.5 < 0.1) | (height % 0.5 >= 0.4)
    np.testing.assert_array_equal(made["instance"] == 5, wired)
    assert (made["instance"] == 5).mean() == pytest.approx(1 - 0.8 * 0.8)
    behind = made["depth"][(made["instance"] == 2)]
    np.testing.assert_allclose(behind, 10.0, rtol=1e-6)
    assert set(np.unique(made["instance"])) == {1, 2, 5}
    assert set(made["semantic"][wired]) == {CLASS["fence"]}


def test_leaves_cut_out_of_cards_let_the_wall_through():
    crown = Prototype("tree_lime_0_near", "tree", pane(0, 4.0, 3.0, "foliage"))
    y, x = np.mgrid[:64, :64]
    leaf = (x - 31.5) ** 2 + (y - 31.5) ** 2 < 26.0**2  # a disc on a card of 1 m
    made = seen(crown, {"foliage": CutOut(leaf, 1.0)}).channels
    share = (made["instance"] == 5).mean()
    assert share == pytest.approx(np.pi * (26 / 64) ** 2, abs=0.01)


def test_without_a_cut_out_the_card_is_solid():
    fence = Prototype("fence_segment", "furniture", pane(0, 4.0, 3.0, "metal_dark"))
    assert (seen(fence).channels["instance"] == 5).all()


def test_a_translucent_pane_counts_as_the_pane():
    shop = Prototype("kiosk", "furniture", pane(0, 4.0, 3.0, "pane"))
    record = seen(shop)
    assert (record.channels["instance"] == 5).all()
    np.testing.assert_allclose(record.channels["depth"], 5.0, rtol=1e-6)


def test_of_two_leaves_behind_each_other_the_nearer_solid_part_is_seen():
    card = Prototype("tree_lime_0_near", "tree", pane(0, 4.0, 3.0, "foliage"))
    left = np.zeros((1, 2), bool)
    left[0, 0] = True  # the left half of each metre
    scene = Scene().with_instances(
        "trees", [card], rows((0.0, 5.0, 0.0), (0.5, 5.01, 0.0), ids=[5, 6])
    )
    one = shot((0.0, 0.0, 1.5), width=400, height=300, hfov=2 * np.arctan(2.0 / 5.0))
    stage = stage_of(view(scene), cut_outs={"foliage": CutOut(left, 1.0)})
    made = truth(stage, one, ["instance"]).channels["instance"]
    shares = [np.mean(made[:, 50:350] == k) for k in (5, 6)]
    assert shares == pytest.approx([0.5, 0.5], abs=0.02)
