"""Truth: channels without noise, from one ray through the middle of each pixel.

Depth, distance, normals and positions are computed in float64 and stored as float32. Points nearer
than the clip of the pictures' camera are not seen, as in the pictures.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.dataset.channels import CHANNELS, TRUTH, chosen
from cityx.dataset.classes import SKY, THING
from cityx.dataset.record import Record, Segment
from cityx.dataset.shots import Shot, rays
from cityx.dataset.stage import Stage
from cityx.geometry.raycast import Hits, normals

FloatArray = NDArray[np.float64]
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
    """Cast the rays of a shot."""
    directions = rays(shot.camera).reshape(-1, 3)
    eye = np.array(shot.camera.position)
    hits = stage.cast(eye + NEAR * directions, directions, threads=threads)
    hits.distance[:] += NEAR
    return Sight(stage, shot, directions, hits)


def truth(
    stage: Stage,
    shot: Shot,
    channels: Iterable[str],
    *,
    after: Shot | None = None,
    later: Stage | None = None,
    threads: int | None = None,
) -> Record:
    """Make the channels of a shot that rays can tell.

    Parameters
    ----------
    stage
        The city at the moment of the shot.
    shot
        The shot.
    channels
        Names of channels or of sets of them; those of other makers are left out.
    after
        Next frame of the sequence; without one there is no flow and no motion.
    later
        The city at its moment; the same stage where nothing moves.
    threads
        That share the work; what is found is the same for any number.
    """
    wanted = [channel.name for channel in chosen(channels) if channel.maker == TRUTH]
    seen = sight(stage, shot, threads=threads)
    size = (shot.camera.height, shot.camera.width)
    made: dict[str, NDArray[Any]] = {}
    segments: tuple[Segment, ...] = ()
    for name in wanted:
        if name == "panoptic":
            values, segments = _panoptic(seen)
        elif name in _MAKERS:
            values = _MAKERS[name](seen)
        else:
            continue
        channel = CHANNELS[name]
        shape = size if channel.depth == 1 else (*size, channel.depth)
        made[name] = values.astype(channel.dtype, copy=False).reshape(shape)
    return Record(shot, made, segments)


def _distance(seen: Sight) -> FloatArray:
    return np.asarray(seen.hits.distance * np.linalg.norm(seen.directions, axis=1))


def _semantic(seen: Sight) -> NDArray[np.uint8]:
    return np.where(seen.met, seen.stage.semantic[seen.rows], SKY).astype(np.uint8)


def _instance(seen: Sight) -> NDArray[np.uint64]:
    return np.where(seen.met, seen.stage.object_id[seen.rows], np.uint64(0))


def _panoptic(seen: Sight) -> tuple[NDArray[np.uint32], tuple[Segment, ...]]:
    """Return the (p,) segments: one per thing, one per class of stuff, numbered from 1.

    Stuff comes first by class, things follow by the rows of the stage.
    """
    stage = seen.stage
    semantic = _semantic(seen)
    thing = THING[semantic]
    count = len(THING)
    key = np.where(thing, count + stage.whole[seen.rows], semantic)  # (p,)
    pixels = np.bincount(key)
    present = np.flatnonzero(pixels)
    number = np.zeros(len(pixels), np.uint32)
    number[present] = np.arange(1, len(present) + 1)
    segments = []
    for at, found in enumerate(present.tolist()):
        if found < count:
            segments.append(Segment(at + 1, 0, found, int(pixels[found])))
        else:
            row = found - count
            segments.append(
                Segment(
                    at + 1, int(stage.object_id[row]), int(stage.semantic[row]), int(pixels[found])
                )
            )
    return number[key], tuple(segments)


_MAKERS: Mapping[str, Callable[[Sight], NDArray[Any]]] = {
    "depth": lambda seen: seen.hits.distance,
    "distance": _distance,
    "normal": lambda seen: normals(seen.stage.rays, seen.hits, seen.directions),
    "position": lambda seen: seen.position,
    "semantic": _semantic,
    "instance": _instance,
    "material": lambda seen: seen.stage.materials_at(seen.hits),
}
