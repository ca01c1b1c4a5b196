"""Ways across junctions are looked at with the ends of the lanes that they join."""

import numpy as np
import pytest

from cityx.sim.blocks import Gathered
from cityx.sim.compile.feasible import Surroundings, blocked_by
from cityx.sim.compile.lanes import Pieces
from cityx.sim.compile.obstacles import Obstacles
from cityx.sim.compile.rasters import BIT, CELL
from cityx.sim.dynamics import VEHICLE, vehicle_table
from cityx.sim.kernels import fits

CAR = VEHICLE["car"]
SPAN = 48.0  # metres from the middle of the site to its border
LANES = 30.0  # metres of each lane


def joined(*shapes):
    """Return two lanes and the way across that joins the first to the second, (k, 2) each."""
    order = [shapes[0], shapes[2], shapes[1]]  # lanes first
    points = []
    for shape in order:
        point = np.zeros((len(shape), 6))
        point[:, :2] = shape
        fits.measure(point)
        points.append(point)
    yes, size = np.ones(3, bool), [len(each) for each in points]
    return Pieces(
        np.arange(3, dtype=np.uint64), np.array([0, 0, 2], np.uint64), np.array([-1, -1, 0]),
        np.array([-1, -1, 0], np.int32), np.full(3, 8.0), np.full(3, 1.5), yes, ~yes,
        np.concatenate([[0], np.cumsum(size)]), np.concatenate(points),
        np.array([0, 1, 1, 2], np.int32), np.array([2, 1], np.int32), np.full((3, 2), -1, np.int32),
    )  # fmt: skip


def around(holes=()):
    """Return a plain of asphalt without the cells of some places."""
    count = int(2 * SPAN / CELL)
    middle = -SPAN + (np.arange(count) + 0.5) * CELL
    road = np.ones((count, count), bool)
    for x, y in holes:
        road &= ~((np.abs(middle - x) <= CELL / 2) & (np.abs(middle - y) <= CELL / 2)[:, None])
    held = []
    for values in (np.where(road, BIT["roadway"], 0), np.full((count, count), 255)):
        blocks = Gathered(count, count)
        blocks.add(0, 0, values.astype(np.uint8))
        held.append(blocks.blocks())
    none = Obstacles(
        np.zeros((0, 6), np.float32), np.zeros(0, np.uint64),
        np.array([-SPAN, -SPAN, 2 * SPAN, 1.0, 1.0]), np.zeros(2, np.int32), np.zeros(0, np.int32),
    )  # fmt: skip
    return Surroundings(held[0], held[1], np.array([-SPAN, -SPAN, CELL, count, count]), none)


def line(one, other):
    count = int(np.hypot(*np.subtract(other, one))) + 1
    return np.linspace(one, other, max(count, 2))


def turn(radius, angle):
    """Lanes from the west and to where the angle says, and the arc from the one to the other."""
    at = np.linspace(0.0, angle, 12)
    arc = radius * np.column_stack([np.sin(at), 1 - np.cos(at)])
    way = np.array([np.cos(angle), np.sin(angle)])
    return line((-LANES, 0.0), (0.0, 0.0)), arc, line(arc[-1], arc[-1] + LANES * way)


@pytest.mark.parametrize("angle", [1.2, 1.57, -1.57])
def test_a_corner_between_a_lane_and_a_way_across_is_no_way_for_a_car(angle):
    before, _, after = turn(0.0, angle)
    short = 1.7 * np.array([np.cos(angle), np.sin(angle)])
    hit = blocked_by(joined(before, line((0.0, 0.0), short), after + short), around())
    assert hit[2, CAR] == fits.BEND
    assert (hit[:2, CAR] == fits.FREE).all()


@pytest.mark.parametrize("angle", [1.2, 1.57, -1.57])
def test_a_bend_that_a_car_can_follow_stays_open(angle):
    hit = blocked_by(joined(*turn(np.copysign(6.0, angle), angle)), around())
    assert (hit[:, CAR] == fits.FREE).all()


def test_what_lies_between_two_points_of_a_line_is_looked_at():
    straight = (line((-LANES, 0.0), (0.0, 0.0)), line((0.0, 0.0), (8.0, 0.0)),
                line((8.0, 0.0), (38.0, 0.0)))  # fmt: skip
    assert (blocked_by(joined(*straight), around())[:, CAR] == fits.FREE).all()
    car = vehicle_table()[CAR]
    base, track = car[fits.WHEELBASE] / 2, car[fits.TRACK] / 2 + fits.BESIDE
    holes = [(-15.5 + base, track), (-15.5 + base, -track)]
    assert blocked_by(joined(*straight), around(holes))[0, CAR] == fits.OFF


@pytest.mark.parametrize(("degrees", "fit"), [(20, True), (45, True), (100, False), (155, False)])
def test_lanes_that_meet_in_one_point_are_joined_by_no_sharp_angle(degrees, fit):
    angle = np.radians(degrees)
    before, _, after = turn(0.0, angle)
    hit = blocked_by(joined(before, np.zeros((2, 2)), after), around())
    assert (hit[2, CAR] == fits.FREE) == fit
