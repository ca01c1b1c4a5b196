"""Which vehicles fit along a lane: bends that bodies follow, and ends that others look at."""

import numpy as np
import pytest

from cityx.sim.blocks import Gathered
from cityx.sim.compile.feasible import kinked
from cityx.sim.compile.lanes import Pieces
from cityx.sim.compile.rasters import BIT, CELL
from cityx.sim.dynamics import VEHICLE, vehicle_table
from cityx.sim.kernels import fits

CAR = VEHICLE["car"]
SPAN = 48.0  # metres from the middle of the site to its border


def line_of(xy):
    """Return the points of a lane on level ground, as worlds have them, and where it starts."""
    point = np.zeros((len(xy), 6))
    point[:, :2] = xy
    fits.measure(point)
    return point, np.array([0, len(xy)])


def blocks(values):
    found = Gathered(*values.shape)
    found.add(0, 0, values)
    return found.blocks()


def stopped_by(point, start, roadway):
    """Return what stops a car on a roadway from one x to another, between y -1.2 and 1.2."""
    count = int(2 * SPAN / CELL)
    middle = -SPAN + (np.arange(count) + 0.5) * CELL
    along = (middle > roadway[0]) & (middle < roadway[1])
    flags = np.where((np.abs(middle) < 1.2)[:, None] & along, BIT["roadway"], 0).astype(np.uint8)
    frame = np.array([-SPAN, -SPAN, CELL, count, count])
    clear = np.full((count, count), 255, np.uint8)
    none = np.zeros(0, np.int32)
    found = fits.sweep(
        point, start, vehicle_table(), blocks(flags), blocks(clear), frame,
        np.zeros((0, 6), np.float32), np.zeros(2, np.int32), none,
        np.array([-SPAN, -SPAN, 2 * SPAN, 1.0, 1.0]),
    )  # fmt: skip
    return int(found[0, CAR])


@pytest.mark.parametrize("turn", [0.8, 1.2, 2.0])
def test_a_kink_is_rounded_until_the_body_of_a_car_can_follow(turn):
    along = np.arange(16.0)
    xy = np.concatenate([
        np.column_stack([along - 15.0, np.zeros(16)]),
        along[1:, None] * [np.cos(turn), np.sin(turn)],
    ])  # fmt: skip
    point, start = line_of(xy)
    car = vehicle_table()[CAR]
    assert fits.slipping(point, car) >= 0
    rounded, changed = fits.softened(point, start, car, 60)
    assert changed.all()
    assert fits.slipping(line_of(rounded)[0], car) < 0
    assert np.array_equal(rounded[[0, -1]], xy[[0, -1]])


def test_the_ends_of_a_lane_are_looked_at_along_the_pieces_that_join_it():
    point, start = line_of(np.column_stack([np.arange(11.0), np.zeros(11)]))
    assert stopped_by(point, start, (-0.5, 10.5)) == fits.FREE
    assert stopped_by(point, start, (1.5, 10.5)) == fits.OFF


def test_a_cell_of_the_raster_that_rounds_does_not_close_a_lane():
    xy = np.column_stack([np.arange(11.0), np.full(11, 0.25)])
    assert stopped_by(*line_of(xy), (-5.0, 15.0)) == fits.FREE
    beside = np.column_stack([np.arange(11.0), np.full(11, 0.6)])
    assert stopped_by(*line_of(beside), (-5.0, 15.0)) == fits.OFF


def street_with_a_kink(turn):
    """Two lanes of 20 m that meet in one place at an angle, and the way across of no length."""
    along = np.linspace(0.0, 20.0, 21)[:, None]
    lanes = [along * [1.0, 0.0] + [-20.0, 0.0], along * [np.cos(turn), np.sin(turn)]]
    lines = [line_of(xy)[0] for xy in (*lanes, np.zeros((2, 2)))]
    start = np.cumsum([0, *map(len, lines)])
    none = np.zeros(3, np.uint64)
    return Pieces(
        none, none, np.array([-1, -1, 0]), np.array([-1, -1, 0]), np.full(3, 10.0),
        np.full(3, 1.5), np.ones(3, bool),
        np.zeros(3, bool), start, np.concatenate(lines), np.array([0, 1, 1, 2]), np.array([2, 1]),
        np.full((3, 2), -1),
    )  # fmt: skip


@pytest.mark.parametrize(("turn", "fit"), [(20, True), (45, True), (100, False), (155, False)])
def test_a_way_across_is_too_tight_where_it_meets_its_lanes_at_a_sharp_angle(turn, fit):
    pieces = street_with_a_kink(np.radians(turn))
    free = np.full((3, len(vehicle_table())), fits.FREE, np.int32)
    found = kinked(pieces, free)
    assert (found[:2] == fits.FREE).all()
    assert (found[2, CAR] == fits.FREE) == fit
    assert set(found[2].tolist()) <= {fits.FREE, fits.BEND}
    assert (free == fits.FREE).all()
