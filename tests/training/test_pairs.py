import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "training"))
from labels import ANYTHING, CLASSES, allowed, known, may_be  # noqa: E402
from pairs import DUBAI_HELD_BACK, Pair, dubai, kampala  # noqa: E402

IMAGES = ROOT.parent / "shared" / "data" / "satellite"


def test_a_label_leaves_its_own_classes_open():
    rows = allowed()
    assert rows[ANYTHING].all()
    assert not rows[0].any()
    assert [word for word, open_ in zip(CLASSES, rows[may_be("road", "bare")], strict=True)
            if open_] == ["road", "bare"]  # fmt: skip


def test_only_a_pixel_with_one_class_is_known():
    labels = np.array([may_be("road"), may_be("road", "bare"), ANYTHING], np.uint8)
    assert known(labels, "road").tolist() == [True, False, False]


def test_a_pair_keeps_its_ground_at_another_resolution():
    image = np.zeros((100, 60, 3), np.uint8)
    image[:50] = 200
    labels = np.full((100, 60), may_be("bare"), np.uint8)
    labels[:50] = may_be("building")
    found = Pair("Town", "one", image, labels, 0.3, False).at(0.6)
    assert found.labels.shape == (50, 30)
    assert (found.labels == may_be("building")).mean() == 0.5
    assert (found.image[:25] == 200).all()


def kampala_tiles(folder):
    """Two tiles of zoom 21 side by side, one of zoom 20 over both and more."""
    for kind in ("satellite", "semantic"):
        (folder / kind / "kampala").mkdir(parents=True)
    tiles = {"z20_10_20": 50, "z21_20_40": 100, "z21_21_40": 150}
    for name, value in tiles.items():
        colors = np.full((256, 256, 3), value, np.uint8)
        Image.fromarray(colors).save(folder / "satellite" / "kampala" / f"{name}.png")
        mask = np.full((256, 256), 255 if name == "z21_20_40" else 0, np.uint8)
        Image.fromarray(mask).save(folder / "semantic" / "kampala" / f"{name}.png")
    return folder / "satellite"


def test_map_tiles_of_several_zooms_become_one_ground_that_is_split_by_place(tmp_path):
    west, east = kampala(kampala_tiles(tmp_path))
    assert not west.held_back
    assert east.held_back
    whole = np.hstack([west.image, east.image])
    labels = np.hstack([west.labels, east.labels])
    assert whole.shape == (512, 512, 3)
    assert (whole[:256, :256] == 100).all()  # the finer zoom lies on top
    assert (whole[256:] == 50).all()
    assert (labels[:256, :256] == may_be("building")).all()
    assert not known(labels[256:], "building").any()
    assert west.pixel == pytest.approx(0.0746, abs=1e-4)


@pytest.mark.shared
@pytest.mark.skipif(not IMAGES.is_dir(), reason="no ../shared")
def test_whole_places_are_held_back():
    held = {pair.name.split("_")[0]: pair.held_back for pair in dubai(IMAGES)}
    assert {name for name, kept in held.items() if kept} == set(DUBAI_HELD_BACK)
