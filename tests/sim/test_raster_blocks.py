"""Rasters in blocks say what whole ones would, whatever lies in how many windows."""

import numpy as np

from cityx.sim.blocks import SIDE, WINDOW, Gathered, windows_of
from cityx.sim.compile.rasters import clearance_of, clearance_to
from cityx.sim.kernels import rasters as kernels

SIZE = (SIDE * WINDOW + 300, SIDE * WINDOW + 90)  # cells, over two windows each way
FRAME = np.array([-40.0, 7.0, 0.25, SIZE[1], SIZE[0]])


def gathered(whole):
    found = Gathered(*whole.shape)
    for row, column, height, width in windows_of(*whole.shape):
        found.add(row, column, whole[row : row + height, column : column + width])
    return found.blocks()


def test_every_cell_is_kept_and_even_squares_once():
    rng = np.random.default_rng(0)
    whole = np.full(SIZE, 4, np.uint8)
    whole[:SIDE] = 9
    whole[2000:2100, 2030:2100] = rng.integers(0, 255, (100, 70))
    blocks = gathered(whole)
    assert np.array_equal(blocks.within(0, 0, *SIZE), whole)
    assert np.array_equal(blocks.within(1990, 2020, 150, 110), whole[1990:2140, 2020:2130])
    row, column = rng.integers(SIZE[0], size=500), rng.integers(SIZE[1], size=500)
    assert np.array_equal(blocks.at(row, column), whole[row, column])
    assert len(blocks.block) < 12  # two values, and the squares with more


def test_clearance_in_windows_is_that_of_the_whole_raster():
    rng = np.random.default_rng(1)
    ends = rng.uniform(0, 1, (40, 2)) * [SIZE[1] * 0.25, SIZE[0] * 0.25] + FRAME[:2]
    turn = rng.uniform(0, 2 * np.pi, 40)
    far = ends + 9.0 * np.column_stack([np.cos(turn), np.sin(turn)])
    segment = np.column_stack([ends, far, np.zeros((40, 2))]).astype(np.float32)
    mask = np.zeros(SIZE, bool)
    kernels.draw_segments(mask, FRAME, segment, 0, 0)
    whole = kernels.clearance(mask, 0.25)
    assert np.array_equal(clearance_of(FRAME, segment).within(0, 0, *SIZE), whole)
    flags = gathered(mask.astype(np.uint8) * 2)
    assert np.array_equal(clearance_to(FRAME, flags, 2).within(0, 0, *SIZE), whole)
    assert (clearance_to(FRAME, flags, 1).within(0, 0, *SIZE) == kernels.FARTHEST).all()
