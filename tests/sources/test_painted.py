import numpy as np
import pytest
from PIL import Image

from cityx.sources.satellite.painted import painted_segmenter
from cityx.sources.satellite.segmented import segment
from cityx.sources.semantic_map.picture import Picture

# Classes of a plan: 0 ground, 1 street, 2 house, 3 park, 4 pond.
WORDS = ("ground", "road", "building", "vegetation", "water")
PAINTS = {
    "earthy": [(122, 105, 84), (84, 84, 88), (168, 100, 80), (80, 102, 52), (36, 60, 66)],
    "pale": [(214, 206, 188), (120, 120, 124), (190, 70, 60), (120, 170, 90), (90, 140, 200)],
}


def plan():
    """Return (400, 400) classes: four streets, a park, a pond, thirty houses."""
    classes = np.zeros((400, 400), int)
    for at in (90, 260):
        classes[at : at + 14] = 1
        classes[:, at : at + 14] = 1
    classes[120:240, 120:240] = 3
    classes[300:380, 300:380] = 4
    for row in (20, 55, 290, 330, 365):
        for column in (10, 50, 115, 160, 205, 225):
            if column + 30 < 260 or row < 60:
                classes[row : row + 18, column : column + 16 + row % 7] = 2
    return classes


def painted(paints, grain=8, shades=0.0):
    classes = plan()
    image = np.array(paints, float)[classes]
    rng = np.random.default_rng(0)
    if shades:
        row, column = np.indices(classes.shape)
        tone = 1 + shades * np.sin(row // 20 + 3.0 * (column // 22))
        image *= np.where(classes == 2, tone, 1.0)[..., None]
    image += rng.uniform(-grain, grain, (*classes.shape, 1))
    colors = np.clip(image, 0, 255).astype(np.uint8)
    return classes, Picture(None, colors, np.zeros(classes.shape, bool))


@pytest.mark.parametrize(("name", "shades"), [("earthy", 0.0), ("pale", 0.0), ("earthy", 0.2)])
def test_paintings_are_read_by_their_colours(name, shades):
    classes, picture = painted(PAINTS[name], shades=shades)
    segmenter = painted_segmenter(picture)
    found = segment(picture.colors, segmenter)
    words = np.array([item.word for item in segmenter.classes])[found.labels]
    for number, word in enumerate(WORDS):
        if word != "ground":
            assert (words[classes == number] == word).mean() > 0.9, word
    assert segment(picture.colors, segmenter).labels.tobytes() == found.labels.tobytes()


@pytest.mark.parametrize("cells", [40, 5])
def test_what_changes_everywhere_is_no_painting(cells):
    rough = np.random.default_rng(1).uniform(0, 255, (cells, cells, 3)).astype(np.uint8)
    colors = np.asarray(Image.fromarray(rough).resize((400, 400), Image.Resampling.BICUBIC))
    assert painted_segmenter(Picture(None, colors, np.zeros((400, 400), bool))) is None


def test_a_painting_without_streets_or_houses_is_left_to_others():
    colors = np.full((200, 200, 3), (80, 102, 52), np.uint8)
    assert painted_segmenter(Picture(None, colors, np.zeros((200, 200), bool))) is None
