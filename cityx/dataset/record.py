"""What one shot gives: the value that makers fill and writers store."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.dataset.shots import Shot


@dataclass(frozen=True)
class Boxes:
    """Objects of which a shot shows at least one pixel, n of them, things and movers alone.

    Attributes
    ----------
    object_id
        (n,) uint64, ascending.
    semantic
        (n,) uint8, class.
    centre
        (n, 3) float64, middle of the box in the frame of the city, metres.
    size
        (n, 3) float64, length (along its heading), width, height, metres.
    heading
        (n,) float64, radians counter-clockwise from east.
    seen
        (n, 4) float64, x0, y0, x1, y1 in pixels: the box about the visible pixels.
    full
        (n, 4) float64, the box about the whole object as projected, cut by the picture.
    visibility
        (n,) float32, visible pixels by those that the object would cover if it stood alone.
    truncation
        (n,) float32, share of its projection that lies outside of the picture.
    pixels
        (n,) int64, visible pixels.
    """

    object_id: NDArray[np.uint64]
    semantic: NDArray[np.uint8]
    centre: NDArray[np.float64]
    size: NDArray[np.float64]
    heading: NDArray[np.float64]
    seen: NDArray[np.float64]
    full: NDArray[np.float64]
    visibility: NDArray[np.float32]
    truncation: NDArray[np.float32]
    pixels: NDArray[np.int64]

    @property
    def count(self) -> int:
        """Number of boxes."""
        return len(self.object_id)


@dataclass(frozen=True)
class Sweep:
    """Points of a LiDAR, n of them, in the order in which the beams were sent.

    Attributes
    ----------
    points
        (n, 3) float32, metres, in the sensor's frame: x ahead, y left, z up.
    beam
        (n,) uint16, ring or channel of the beam.
    time
        (n,) float32, seconds since the sweep began.
    object_id
        (n,) uint64.
    semantic
        (n,) uint8.
    intensity
        (n,) float32, 0 to 1: cosine of incidence times reflectance.
    """

    points: NDArray[np.float32]
    beam: NDArray[np.uint16]
    time: NDArray[np.float32]
    object_id: NDArray[np.uint64]
    semantic: NDArray[np.uint8]
    intensity: NDArray[np.float32]


@dataclass(frozen=True)
class Segment:
    """One segment of the panoptic channel: its number in the picture and what it is."""

    number: int
    object_id: int
    semantic: int
    pixels: int


@dataclass(frozen=True)
class Record:
    """All that was made of one shot.

    Attributes
    ----------
    shot
        The shot.
    channels
        Channel name to its array, (h, w) or (h, w, c).
    segments
        Of the panoptic channel; their pixels cover the picture.
    boxes
        When asked for.
    sweep
        When asked for.
    facts
        What else is kept with the picture: samples, seconds, versions.
    """

    shot: Shot
    channels: Mapping[str, NDArray[Any]]
    segments: tuple[Segment, ...] = ()
    boxes: Boxes | None = None
    sweep: Sweep | None = None
    facts: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
