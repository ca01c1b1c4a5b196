"""Crowd dynamics: the collision-free speed model; steps that would touch somebody are taken back.

Everybody heads for a place ahead, bends away from neighbours, and goes as fast as the gap ahead
allows. Who waits makes room for those who come towards them, and who is in the way of a vehicle
gets out of it. A step that would bring two people nearer than they keep apart, or lead where nobody
may stand, is turned aside or not taken, so that who stood apart stays apart.

References
----------
Tordeux, Chraibi and Seyfried, "Collision-free speed model for pedestrian dynamics", 2016.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray

APART = 0.5  # metres between the middles of two people, shoulders and what sways
SQUEEZED = 0.36  # metres, of two who turn their shoulders to get past each other
CREEP = 0.3  # of the pace at which somebody who is hindered steps aside
NO_BOXES = np.zeros((0, 6))
NO_ZONES = np.zeros(0, bool)


@dataclass(frozen=True)
class Floor:
    """Where people may be, as rasters of square cells; the rim holds for all that is beyond.

    Attributes
    ----------
    free
        (rows, columns) bool, where the middle of a person may be.
    zone
        (rows, columns) int16, numbers of what may be stepped onto with leave alone, 0 elsewhere.
    rim
        (rows, columns) int16, the same with the cells that zones merely reach into; who is in one
        of these has not entered the zone yet.
    west, north
        Metres of the corner of the first cell.
    cell
        Metres of an edge of a cell.
    """

    free: BoolArray
    zone: NDArray[np.int16]
    rim: NDArray[np.int16]
    west: float
    north: float
    cell: float

    @property
    def place(self) -> tuple[Any, ...]:
        """What kernels need to look up where one may be."""
        return self.free, self.zone, self.west, self.north, self.cell


@dataclass(frozen=True)
class Crowd:
    """n pedestrians at one moment.

    Attributes
    ----------
    position, target
        (n, 2) float64, metres: where they are, and a place ahead that they head for.
    pace
        (n,) float64, metres per second they would like to walk, 0 for those who wait.
    stride
        (n,) float64, metres per second at which they step aside, those who wait as well.
    side
        (n,) float64, 1 for those who step aside to the right, -1 to the left.
    apart
        (n,) float64, metres that each keeps to the middle of others; the less of two counts.
    leave
        (n,) int64, zone of the floor that each may step onto.
    awaits
        (n,) int64, zone that each is going to; its rim is kept clear until there is leave.
    """

    position: FloatArray
    target: FloatArray
    pace: FloatArray
    stride: FloatArray
    side: FloatArray
    apart: FloatArray
    leave: IntArray
    awaits: IntArray


def stepped(
    crowd: Crowd, others: FloatArray, seconds: float, floor: Floor, boxes: FloatArray = NO_BOXES,
    shut: BoolArray = NO_ZONES,
) -> FloatArray:  # fmt: skip
    """Move a crowd by one step.

    Parameters
    ----------
    crowd
        The people.
    others
        (m, 2) metres, people who do not heed this crowd, where they are after the step.
    seconds
        Length of the step; short, so that nobody goes farther than people are wide.
    floor
        Where people may be.
    boxes
        (b, 6) where vehicles are going to be soon, with what people keep from them: middle in
        metres, direction as a unit vector, half of length and width in metres. Nobody steps into
        one, and who is in one leaves it.
    shut
        (zones + 1,) by number, zones onto whose rims nobody steps who has no leave, not even in
        passing; who is on one already steps off it alone. None are if this is empty.

    Returns
    -------
    position
        (n, 2). No two people, and nobody and one of the others, have come nearer than what they
        keep apart.
    """
    if not len(crowd.position):
        return crowd.position.copy()
    from cityx.motion import crowd_kernel

    moved = crowd_kernel.step(
        crowd.position, others, crowd.target, crowd.pace, crowd.stride, crowd.side, crowd.apart,
        APART, crowd.leave, crowd.awaits, floor.free, floor.zone, floor.rim, floor.west,
        floor.north, floor.cell, boxes, shut, seconds,
    )  # fmt: skip
    return np.asarray(moved)
