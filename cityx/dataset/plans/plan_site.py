"""The site of a plan: a city, its scene ready for rays, and what is asked for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import radians
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.scatter import spread
from cityx.ids import id_text

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.dataset.stage import Stage
    from cityx.geometry.raycast import Hits

GROUND = ("ground", "surroundings")  # layers of meshes


@dataclass(frozen=True)
class Wishes:
    """What a plan is asked for, besides its kind.

    Attributes
    ----------
    seed
        Of all that is drawn.
    length
        Frames of a sequence.
    rate
        Frames per second.
    hfov
        Horizontal field of view, radians; None is that of the kind.
    target
        What an orbit goes round: "tallest", "middle", the name or the id of a building.
    radius, height
        Of an orbit, metres, height above the ground; None follows from the target.
    size
        Of the pictures, pixels.
    """

    seed: int
    length: int
    rate: float
    hfov: float | None = None
    target: str = "tallest"
    radius: float | None = None
    height: float | None = None
    size: tuple[int, int] = (960, 540)

    @property
    def seconds(self) -> float:
        """From the first frame of a sequence to its last."""
        return (self.length - 1) / self.rate

    def fov(self, degrees: float) -> float:
        """Return the field of view asked for, or that of the kind in degrees; radians."""
        return radians(degrees) if self.hfov is None else self.hfov


@dataclass(frozen=True)
class Site:
    """The city that is planned in, and its scene without what moves.

    Attributes
    ----------
    city
        The city.
    wishes
        What is asked for.
    given
        The scene, if it is there already; else it is made when it is needed first.
    """

    city: City
    wishes: Wishes
    given: Stage | None = None

    @cached_property
    def stage(self) -> Stage:
        """The scene without what moves, ready for rays."""
        if self.given is not None:
            return self.given
        from cityx.city.store import view_of
        from cityx.dataset.stage import stage_of

        return stage_of(view_of(replace(self.city, tracks=None)))

    @cached_property
    def ground_ids(self) -> NDArray[np.uint64]:
        """Ids of what the ground is made of, land beyond the site included."""
        meshes = self.city.scene.meshes
        held = [meshes[name].object_id for name in GROUND if name in meshes]
        return np.concatenate([np.zeros(0, np.uint64), *held])

    def objects_at(self, hits: Hits) -> NDArray[np.uint64]:
        """Return the (r,) ids of the objects that rays met, 0 for the sky."""
        row = self.stage.rows(hits)
        return np.where(row >= 0, self.stage.object_id[np.maximum(row, 0)], np.uint64(0))

    def named(self, object_id: int) -> str:
        """Return the class and the id of an object, for people."""
        from cityx.dataset.classes import CLASSES

        row = np.flatnonzero(self.stage.object_id == np.uint64(object_id))
        name = CLASSES[int(self.stage.semantic[row[0]])].name if len(row) else "object"
        return f"{name} {id_text(object_id)}"

    def draws(self, purpose: str, numbers: IntArray, dimensions: int) -> FloatArray:
        """Return (n, dimensions) numbers in [0, 1) that fill the cube evenly."""
        return spread(self.wishes.seed, f"dataset/{purpose}", numbers, dimensions)

    def moments(self, numbers: IntArray) -> FloatArray:
        """Return (n,) seconds at which takes begin, spread over the tracks."""
        tracks = self.city.tracks
        free = max((tracks.duration if tracks else 0.0) - self.wishes.seconds, 0.0)
        return np.asarray(np.round(free * self.draws("moment", numbers, 1)[:, 0], 3))
