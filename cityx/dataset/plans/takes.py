"""Takes: what one camera does in one go, before anything checked whether it may."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cityx.city.camera import Camera
from cityx.geometry.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class Take:
    """Poses of a camera one after the other, f of them.

    Attributes
    ----------
    position
        (f, 3) float64, metres.
    heading
        (f,) float64, radians clockwise from north.
    pitch
        (f,) float64, radians, positive up.
    moment
        (f,) float64, seconds since the city's tracks begin.
    hfov
        Horizontal field of view, radians.
    target, target_id
        (k, 3) float64, points of what must be seen, if anything, and the id of what they lie in.
    clearance
        Metres that must be free round the eye; 0 takes the usual.
    foot
        Metres that the eye is above what it stands on; 0 where it hangs in the air.
    way
        (w, 3) float64, places between the poses that must be as free as they.
    """

    position: FloatArray
    heading: FloatArray
    pitch: FloatArray
    moment: FloatArray
    hfov: float
    target: FloatArray | None = None
    target_id: int = 0
    clearance: float = 0.0
    foot: float = 0.0
    way: FloatArray | None = None

    @property
    def count(self) -> int:
        """Number of poses."""
        return len(self.position)

    def at(self, frames: IntArray) -> Take:
        """Return some of the poses, without the way between them unless they are all."""
        way = self.way if len(frames) == self.count else None
        return replace(self, position=self.position[frames], heading=self.heading[frames],
                       pitch=self.pitch[frames], moment=self.moment[frames], way=way)  # fmt: skip

    def camera(self, frame: int, size: tuple[int, int]) -> Camera:
        """Return the camera of one pose."""
        x, y, z = (float(value) for value in self.position[frame])
        return Camera("", (x, y, z), float(self.heading[frame] % (2 * np.pi)),
                      float(self.pitch[frame]), self.hfov, *size)  # fmt: skip


@dataclass(frozen=True)
class Refusal:
    """Why a take is not taken.

    Attributes
    ----------
    reason
        Words that many refusals share: "underground", "too near to something", ...
    detail
        What was found, and where.
    """

    reason: str
    detail: str


# Makes the takes of candidate numbers, or says why one cannot be; each depends on its number alone.
Source = Callable[[IntArray], list[Take | Refusal]]


def still(
    eye: FloatArray, heading: float, pitch: float, moment: float, hfov: float,
    *, clearance: float = 0.0, foot: float = 0.0,
) -> Take:  # fmt: skip
    """Return a take of one pose."""
    return Take(eye.reshape(1, 3), np.array([heading]), np.array([pitch]), np.array([moment]), hfov,
                clearance=clearance, foot=foot)  # fmt: skip
