"""Travellers: who goes about on walks, and what of a step in the ground stops them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cityx.geometry.arrays import FloatArray


@dataclass(frozen=True)
class Traveller:
    """A kind of traveller on walks.

    Attributes
    ----------
    name
        Of the kind.
    length, width, height
        Metres.
    step
        Metres of a step in the ground that it gets over; from there on it is a wall, or a fall.
    top
        m/s at most.
    accel
        m/s2, of speed and of braking.
    turn
        Radians per second that it turns at most.
    wheels
        Metres from its middle to each of four wheels ahead and aside; 0 on foot.
    """

    name: str
    length: float
    width: float
    height: float
    step: float
    top: float
    accel: float
    turn: float
    wheels: float

    @property
    def radius(self) -> float:
        """Metres about its middle that nothing solid may reach into, however it is turned."""
        return float(np.hypot(self.length, self.width) / 2) if self.wheels else self.length / 2


# From who gets everywhere to who gets over the least step.
TRAVELLERS = (
    Traveller("person", 0.46, 0.34, 1.75, 0.30, 1.8, 3.0, 3.0, 0.0),
    Traveller("robot", 0.68, 0.56, 0.60, 0.06, 1.7, 2.0, 1.8, 0.20),
    Traveller("wheelchair", 1.05, 0.65, 1.30, 0.04, 1.5, 1.5, 1.2, 0.24),
)
TRAVELLER = {each.name: number for number, each in enumerate(TRAVELLERS)}
LENGTH, WIDTH, HEIGHT, STEP, TOP, ACCEL, TURN, WHEELS = range(8)  # columns of the table


def traveller_table() -> FloatArray:
    """Return the travellers as kernels take them, (t, 8)."""
    return np.array([[t.length, t.width, t.height, t.step, t.top, t.accel, t.turn, t.wheels]
                     for t in TRAVELLERS])  # fmt: skip
