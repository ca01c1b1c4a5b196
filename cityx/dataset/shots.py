"""Shots: where, when and in which light each picture of a dataset is taken."""

from __future__ import annotations

from dataclasses import dataclass

from cityx.city.camera import Camera
from cityx.city.environment import Environment


@dataclass(frozen=True)
class Shot:
    """One picture to be taken.

    Attributes
    ----------
    name
        Unique in its city and sorted like the shots: ``street_000042``, ``drive_0003_0017_left``.
    camera
        Eye, direction and size, in the city's frame.
    sequence
        Trajectory that the shot is part of; a shot by itself is a sequence of one.
    frame
        Number of the moment in its sequence, from 0.
    sensor
        Which camera of the rig: "mono", "left", "right", "front", "front_left", ...
    moment
        Seconds since the city's tracks begin.
    environment
        Light and weather; None is the city's own.
    """

    name: str
    camera: Camera
    sequence: str
    frame: int = 0
    sensor: str = "mono"
    moment: float = 0.0
    environment: Environment | None = None
