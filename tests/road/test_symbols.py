import numpy as np
import pytest
import shapely

from cityx.city.section import TURN
from cityx.road.markings.arrows import LIMITS
from cityx.road.markings.symbols import (
    LENGTH,
    arrow,
    bicycle,
    figures,
    give_way_triangle,
    placed,
    word,
)

WORDS = ("BUS", "STOP", "止まれ", "PARE", "ALTO")
ARROWS = [arrow(bits) for bits in range(1, 16)]
OUTLINES = [*ARROWS, *map(word, WORDS), *map(figures, LIMITS), bicycle(), give_way_triangle()]


@pytest.mark.parametrize("outline", OUTLINES)
def test_outlines_are_sound_and_fit_a_lane(outline):
    assert outline.is_valid
    xmin, ymin, xmax, ymax = outline.bounds
    assert ymax - ymin < 2.4
    assert xmax - xmin <= LENGTH + 0.2


@pytest.mark.parametrize("outline", OUTLINES)
def test_placed_outlines_keep_size_and_holes(outline):
    ahead = np.array([[1.0, 0.0], [0.0, 1.0], [-0.6, 0.8]])
    made = placed(outline, np.zeros((3, 2)), ahead, np.zeros(3))
    assert shapely.is_valid(made).all()
    assert shapely.area(made).sum() == pytest.approx(3 * outline.area)
    parts = len(made) // 3
    assert shapely.equals_exact(
        shapely.normalize(shapely.multipolygons(made[:parts])),
        shapely.normalize(shapely.multipolygons(shapely.get_parts(outline))), 1e-9,
    )  # fmt: skip


def test_arrows_point_where_they_say():
    left, right = arrow(TURN["left"]), arrow(TURN["right"])
    assert left.bounds[3] > 0.8 > -left.bounds[1]
    assert -right.bounds[1] > 0.8 > right.bounds[3]
    both = arrow(TURN["left"] | TURN["through"])
    assert both.bounds[2] == pytest.approx(LENGTH)
    assert placed(word("BUS"), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0)).tolist() == []


def test_letters_stand_beside_each_other_and_japanese_signs_in_a_column():
    long, wide = np.ptp(np.reshape(word("STOP").bounds, (2, 2)), axis=0)
    assert long < 2.6
    assert wide > 1.8
    long, wide = np.ptp(np.reshape(word("止まれ").bounds, (2, 2)), axis=0)
    assert long > 4.0
    assert wide < 1.6
    assert abs(np.sum(np.array(word("止まれ").bounds)[[1, 3]])) < 0.2  # in the middle of its lane
