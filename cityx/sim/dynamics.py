"""Dynamics: the vehicles of the simulator and how they move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cityx.geometry.arrays import FloatArray


@dataclass(frozen=True)
class Vehicle:
    """A kind of vehicle.

    Attributes
    ----------
    name
        Of the kind.
    length, width, height
        Metres.
    wheelbase, track
        Metres between its axles, and between its wheels from middle to middle.
    steer
        Radians that its front wheels turn at most.
    accel, brake, top
        m/s2, m/s2 and m/s.
    """

    name: str
    length: float
    width: float
    height: float
    wheelbase: float
    track: float
    steer: float
    accel: float
    brake: float
    top: float


# From small to large: where one fits, all before it do.
VEHICLES = (
    Vehicle("small_car", 3.6, 1.65, 1.5, 2.35, 1.40, 0.62, 3.0, 6.0, 30.0),
    Vehicle("car", 4.5, 1.80, 1.5, 2.70, 1.55, 0.60, 3.0, 6.0, 30.0),
    Vehicle("van", 5.6, 2.05, 2.6, 3.45, 1.75, 0.62, 2.5, 6.0, 28.0),
    Vehicle("lorry", 9.0, 2.50, 3.6, 5.20, 2.10, 0.72, 1.2, 5.0, 22.0),
    Vehicle("bus", 12.0, 2.55, 3.2, 5.90, 2.10, 0.80, 1.2, 5.0, 22.0),
)
# Its rider goes wherever a small car fits; no track means two wheels, one behind the other.
BICYCLE = Vehicle("bicycle", 1.8, 0.60, 1.75, 1.10, 0.0, 0.70, 1.2, 3.5, 7.0)
DRIVEN = (*VEHICLES, BICYCLE)
VEHICLE = {vehicle.name: number for number, vehicle in enumerate(DRIVEN)}
# Columns of the table of vehicles, in the order of the fields above.
LENGTH, WIDTH, HEIGHT, WHEELBASE, TRACK, STEER, ACCEL, BRAKE, TOP = range(9)


def fits_as(number: int) -> int:
    """Return the number among `VEHICLES` of the one that fits where one of `DRIVEN` is led."""
    return number if number < len(VEHICLES) else 0


def vehicle_table(vehicles: tuple[Vehicle, ...] = VEHICLES) -> FloatArray:
    """(v, 9) what kernels know of vehicles, by the columns above."""
    fields = ("length", "width", "height", "wheelbase", "track", "steer", "accel", "brake", "top")
    return np.array([[getattr(vehicle, name) for name in fields] for vehicle in vehicles])
