"""Parts that distinguish cars of one body: the face of their make and their number plates.

The body is one prototype, and these are small ones of their own that belong to its rows, so that
dozens of registrations cost no second body. Only the fine form has them: from afar a plate is blank
and part of the body.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from cityx.assets.shapes import fine_shapes, moved, prototype
from cityx.assets.vehicles.car_bodies import BODIES
from cityx.assets.vehicles.car_faces import front, plate_places, rear
from cityx.assets.vehicles.car_flanks import DRIVEN_FROM_RIGHT, driver
from cityx.assets.vehicles.number_plates import PLATES, number_plate
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.geometry.arrays import FloatArray
from cityx.geometry.turns import euler_of, matrices

PART = "vehicle_part"  # kind of the prototypes of parts
REGISTRATIONS = 36  # plates of a country that are seen; a multiple of the makes of every body
DRIVERS = 6  # people who are seen at the wheel of a body


@dataclass(frozen=True)
class Part:
    """A part that is fixed to a car.

    Attributes
    ----------
    prototype
        Its form.
    place
        (x, y, z) of its origin in the car, metres.
    about
        Whether it is turned about there, as a plate that looks to the rear.
    """

    prototype: Prototype
    place: tuple[float, float, float]
    about: bool = False


@lru_cache(maxsize=1024)
def car_parts(body: str, country: str, number: int) -> tuple[Part, ...]:
    """Return the face and the plates of the fine form of a car.

    Parameters
    ----------
    body
        A key of `BODIES`.
    country
        A key of `PLATES`.
    number
        Of the registration, which says the make as well.
    """
    shape = BODIES[body]
    make = number % len(shape.faces)
    ahead, behind = plate_places(shape, shape.faces[make])
    key = "jk" if shape.kei and country == "jp" else country
    return (
        Part(_face(body, make), (0.0, 0.0, 0.0)),
        Part(_plate(key, number, rear=False), (0.0, *ahead)),
        Part(_plate(key, number, rear=True), (0.0, *behind), about=True),
    )


def driver_part(body: str, country: str, number: int) -> Part:
    """Return who drives the fine form of a car with plates of a country.

    Parameters
    ----------
    body, country
        As of `car_parts`.
    number
        Of the registration, which says who drives as well.
    """
    return Part(_driver(body, country in DRIVEN_FROM_RIGHT, number % DRIVERS), (0.0, 0.0, 0.0))


@lru_cache(maxsize=256)
def _driver(body: str, right: bool, number: int) -> Prototype:
    side, word = (-1.0, "right") if right else (1.0, "left")
    with fine_shapes():
        parts = driver(BODIES[body], side, number)
    return prototype(f"driver_{body}_{word}_{number}", PART, parts)


def meshes_of(parts: tuple[Part, ...]) -> list[MeshBatch]:
    """Return the meshes of parts where they are on the car."""
    return [moved(part.prototype.mesh, part.place, yaw=np.pi * part.about) for part in parts]


@lru_cache(maxsize=256)
def _face(body: str, make: int) -> Prototype:
    shape = BODIES[body]
    face = shape.faces[make]
    with fine_shapes():
        return prototype(f"face_{body}_{make}", PART, [*front(shape, face), *rear(shape, face)])


@lru_cache(maxsize=1024)
def _plate(key: str, number: int, *, rear: bool) -> Prototype:
    """Make a plate about the middle of its back, which looks to -y."""
    style = PLATES[key]
    own = rear and style.rear != style.front
    with fine_shapes():
        parts = number_plate(key, number, 0.0, 0.0, rear=own)
    if own:  # turned back: its place says where it looks
        parts = [moved(part, yaw=np.pi) for part in parts]
    return prototype(f"number_plate_{key or 'any'}_{number}{'_rear' * own}", PART, parts)


def fixed_to(part: Part, position: ArrayLike, rotation: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return where a part of n cars is, (n, 3) metres, and its (n, 3) XYZ Euler angles.

    Parameters
    ----------
    part
        The part.
    position, rotation
        (n, 3) float, of the cars.
    """
    turn = matrices(rotation)
    place = np.asarray(position, float) + turn @ np.array(part.place)
    if not part.about:
        return place, np.asarray(rotation, float)
    return place, euler_of(turn @ np.diag([-1.0, -1.0, 1.0]))
