"""What every writer of a format is given and gives back."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.dataset.record import Record
from cityx.dataset.writers.files import Files
from cityx.errors import EngineError

if TYPE_CHECKING:
    from cityx.city.store import View
    from cityx.dataset.classes import Class

Part = Mapping[str, Any]  # what a format keeps of a shot until all are there; JSON


@dataclass(frozen=True)
class Place:
    """Where a shot stands in its dataset.

    Attributes
    ----------
    number
        Of the shot, from 0.
    moment
        Of its moment, from 0: the cameras of a rig share it.
    city
        Name of its city in the dataset.
    """

    number: int
    moment: int
    city: str


@dataclass(frozen=True)
class Kept:
    """What is known of a shot when all are taken: its place, its name and a format's part."""

    place: Place
    name: str
    part: Part


@dataclass(frozen=True)
class Whole:
    """The dataset as its formats finish it.

    Attributes
    ----------
    classes
        Every class.
    cities
        Names of the cities.
    parts
        Gives what a format kept of every shot, in the order of the shots, again at every call.
    """

    classes: Sequence[Class]
    cities: Sequence[str]
    parts: Callable[[], Iterator[Kept]]


@dataclass(frozen=True)
class Format:
    """A format that datasets are written in.

    Attributes
    ----------
    name
        As in ``--format``, and the folder of its files.
    meaning
        In a few words.
    shot
        Writes the files of one shot and returns what `finish` needs of it.
    finish
        Writes the files that speak of all shots; None when there are none.
    city
        Writes what is known of a city before its shots; None when there is nothing.
    channels
        What it cannot do without besides what the user asks for; truth channels alone.
    shows
        Whether it is made of pictures in colour.
    boxes
        Whether it needs boxes.
    sensors
        Cameras of a rig that it knows; None for any.
    """

    name: str
    meaning: str
    shot: Callable[[Record, Place, Sequence[Class], Files], Part]
    finish: Callable[[Whole, Files], None] | None = None
    city: Callable[[View, str, Files], None] | None = None
    channels: tuple[str, ...] = ()
    shows: bool = True
    boxes: bool = False
    sensors: frozenset[str] | None = None


def picture_of(record: Record) -> NDArray[np.uint8]:
    """Return the picture of a shot as people see it, (h, w, 3): exposed and in sRGB.

    The maker's own, with the view transform of `cityx render`, when there is one.
    """
    own = record.channels.get("picture")
    if own is not None:
        return np.ascontiguousarray(own, np.uint8)
    linear = record.channels.get("rgb")
    if linear is None:
        raise EngineError(f"shot {record.shot.name} has no channel rgb to make a picture of.")
    exposure = record.shot.environment.exposure if record.shot.environment else 0.0
    light = np.clip(linear.astype(np.float64) * 2.0**exposure, 0.0, 1.0)
    # IEC 61966-2-1
    bent = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(bent * 255), np.uint8)


def by_city(kept: Iterable[Kept]) -> Iterator[tuple[str, list[Kept]]]:
    """Group what is kept by city; shots of a city are in a row."""
    from itertools import groupby

    for city, items in groupby(kept, lambda item: item.place.city):
        yield city, list(items)
