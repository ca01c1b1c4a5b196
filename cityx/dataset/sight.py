"""Sight: what the pixels of a shot meet, once for all channels that are made of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cityx.assets.trees.seasons import SNOWED
from cityx.city.camera import rays
from cityx.dataset.shots import Shot
from cityx.dataset.stage import Stage
from cityx.errors import UsageError
from cityx.geometry.arrays import FloatArray
from cityx.geometry.raycast import Hits

NEAR = 0.1  # metres of depth nearer than which nothing is seen, `cityx.blender.render.CLIP`


@dataclass(frozen=True)
class Sight:
    """What the pixels of a shot meet, p of them, row by row.

    Attributes
    ----------
    stage
        The city.
    shot
        The shot.
    directions
        (p, 3), of depth 1.
    hits
        What is met; its distance is the depth.
    """

    stage: Stage
    shot: Shot
    directions: FloatArray
    hits: Hits

    @cached_property
    def rows(self) -> NDArray[np.int64]:
        """(p,) row of the object seen, -1 for the sky."""
        return self.stage.rows(self.hits)

    @cached_property
    def met(self) -> NDArray[np.bool_]:
        """(p,) whether anything is seen but the sky."""
        return self.hits.instance >= 0

    @cached_property
    def position(self) -> FloatArray:
        """(p, 3) points seen, relative to the eye; 0 in the sky."""
        depth = np.where(self.met, self.hits.distance, 0.0)
        return np.asarray(self.directions * depth[:, None])


def sight(stage: Stage, shot: Shot, *, threads: int | None = None) -> Sight:
    """Cast the rays of a shot.

    Raises
    ------
    UsageError
        If the shot is under snow and the stage is not, or the other way round: their trees differ.
    """
    own = stage.view.environment
    wanted = shot.environment or own
    if (wanted.snow > SNOWED) != (own.snow > SNOWED):
        raise UsageError(
            f"Shot {shot.name} has a snow cover of {wanted.snow:g}, its stage one of {own.snow:g}: "
            "trees have leaves in one of them alone. Make the stage of the city in the light of "
            "the shot."
        )
    directions = rays(shot.camera).reshape(-1, 3)
    eye = np.array(shot.camera.position)
    hits = stage.cast(eye + NEAR * directions, directions, threads=threads)
    hits.distance[:] += NEAR
    return Sight(stage, shot, directions, hits)
