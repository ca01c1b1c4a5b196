"""Turning objects."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.scene import Instances
from cityx.edit.buildings.resettling import about, middle_of, reshaped
from cityx.edit.objects.footing import moved_pieces
from cityx.edit.targets import targets_of
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.serving import Serves


@action(
    "edit/rotate-v1",
    limits=[
        "Each object turns about the middle of its foot and stays upright.",
        "A building is refused that would reach into another or onto a carriageway.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("rotate", "turn", "spin", "face"),
    serves=(Serves("edit=rotate", "angle"),),
    binds={"objects": "objects", "angle": "angle"},
)
def rotate(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    angle: Annotated[float, Range(-2 * np.pi, 2 * np.pi)],
) -> City:
    """Turn objects where they stand.

    Parameters
    ----------
    city
        The city.
    objects
        Buildings, and things that stand about.
    angle
        Radians counter-clockwise, seen from above.
    """
    found = targets_of(city, objects)
    for building in found.buildings.tolist():
        moved = about(middle_of(city, building), _turn(angle))
        city = reshaped(city, np.array([building], np.uint64), moved, turn=angle)
    if len(found.pieces):
        city = moved_pieces(city, found.pieces, lambda rows: _turned(rows, angle), anywhere=True)
    return city


def _turn(angle: float) -> NDArray[np.float64]:
    """Return the matrix that turns rows of points, (2, 2)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, sin], [-sin, cos]])


def _turned(rows: Instances, angle: float) -> Instances:
    rotation = rows.rotation.copy()
    rotation[:, 2] += np.float32(angle)
    return replace(rows, rotation=rotation)
