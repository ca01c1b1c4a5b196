"""Truth: channels without noise, from one ray through the middle of each pixel.

Depth, distance, normals and positions are computed in float64 and stored as float32. Points nearer
than the clip of the pictures' camera are not seen, as in the pictures.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import Camera, axes, project
from cityx.dataset.boxes import boxes_of
from cityx.dataset.channels import CHANNELS, TRUTH, chosen
from cityx.dataset.classes import SKY, THING
from cityx.dataset.record import Record, Segment
from cityx.dataset.shots import Shot
from cityx.dataset.sight import Sight, sight
from cityx.dataset.stage import Stage
from cityx.geometry.arrays import FloatArray
from cityx.geometry.raycast import corners_at, normals, ways_at

# Flow and motion: where the points seen in a shot are in the next frame of its sequence.


def motion_of(seen: Sight, later: Stage) -> FloatArray:
    """Return how far each point seen moves, (p, 3) metres.

    Movers that have left the city by then count as standing still.

    Parameters
    ----------
    seen
        What the pixels meet.
    later
        The city at the moment of the next frame.
    """
    moved = np.zeros((len(seen.rows), 3))
    stage = seen.stage
    pixel = np.flatnonzero(seen.hits.instance >= stage.first_mover)
    pieces = later.piece[later.instance_object[later.first_mover :]]
    if not len(pixel) or not len(pieces):
        return moved
    order = np.argsort(pieces, kind="stable")
    wanted = stage.piece[seen.rows[pixel]]
    at = np.minimum(np.searchsorted(pieces[order], wanted), len(order) - 1)
    known = pieces[order][at] == wanted
    pixel, then = pixel[known], later.first_mover + order[at[known]]
    now, triangle = seen.hits.instance[pixel], seen.hits.triangle[pixel]
    _, back, count = ways_at(stage.rays, now)
    ways, _, count_then = ways_at(later.rays, then)
    eye = np.array(seen.shot.camera.position)
    local = _along(back, seen.position[pixel] + eye)
    moved[pixel] = _along(ways, local) - seen.position[pixel] - eye
    same = count == count_then
    bent, shape = pixel[same], triangle[same]
    step = corners_at(later.rays, then[same], shape) - corners_at(stage.rays, now[same], shape)
    u, v = seen.hits.u[bent, None].astype(float), seen.hits.v[bent, None].astype(float)
    moved[bent] = (1 - u - v) * step[:, 0] + u * step[:, 1] + v * step[:, 2]
    return moved


def _along(ways: FloatArray, points: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("nij,nj->ni", ways[:, :, :3], points) + ways[:, :, 3])


def flow_of(seen: Sight, motion: FloatArray, camera: Camera) -> FloatArray:
    """Return the flow, (p, 2) pixels right and down; NaN of what is behind the next camera.

    The sky is infinitely far: it moves by the turn of the camera alone.

    Parameters
    ----------
    seen
        What the pixels meet.
    motion
        (p, 3) metres that the points seen move.
    camera
        Of the next frame.
    """
    own = seen.shot.camera
    points = seen.position + motion + np.array(own.position)
    place, depth = project(camera, points)
    sky = ~seen.met
    far = seen.directions[sky] @ axes(camera).T
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        spot = far[:, :2] / far[:, 2:] * focal
    place[sky] = spot + np.array([camera.width / 2, camera.height / 2])
    depth[sky] = far[:, 2]
    x, y = np.meshgrid(np.arange(own.width) + 0.5, np.arange(own.height) + 0.5)
    flow = place - np.column_stack([x.ravel(), y.ravel()])
    return np.where(depth[:, None] > 0, flow, np.nan)


def truth(
    stage: Stage,
    shot: Shot,
    channels: Iterable[str],
    *,
    after: Shot | None = None,
    later: Stage | None = None,
    boxes: bool = False,
    threads: int | None = None,
) -> Record:
    """Make the channels of a shot that rays give.

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
        The city at its moment; `stage` itself where nothing moves or when left out.
    boxes
        Whether boxes are wanted too.
    threads
        That share the work; what is found is the same for any number.
    """
    wanted = [channel.name for channel in chosen(channels) if channel.maker == TRUTH]
    seen = sight(stage, shot, threads=threads)
    size = (shot.camera.height, shot.camera.width)
    made: dict[str, NDArray[Any]] = {}
    segments: tuple[Segment, ...] = ()
    motion = None
    if after is not None and {"flow", "motion"} & set(wanted):
        motion = motion_of(seen, stage if later is None else later)
    values: NDArray[Any]
    for name in wanted:
        if name == "panoptic":
            values, segments = _panoptic(seen)
        elif name in _MAKERS:
            values = _MAKERS[name](seen)
        elif motion is None or after is None:
            continue
        else:
            values = motion if name == "motion" else flow_of(seen, motion, after.camera)
        channel = CHANNELS[name]
        shape = size if channel.depth == 1 else (*size, channel.depth)
        made[name] = values.astype(channel.dtype, copy=False).reshape(shape)
    found = boxes_of(seen, threads=threads) if boxes else None
    return Record(shot, made, segments, found)


def _distance(seen: Sight) -> FloatArray:
    return np.asarray(seen.hits.distance * np.linalg.norm(seen.directions, axis=1))


def _semantic(seen: Sight) -> NDArray[np.uint8]:
    return np.where(seen.met, seen.stage.semantic[seen.rows], SKY).astype(np.uint8)


def _instance(seen: Sight) -> NDArray[np.uint64]:
    return np.where(seen.met, seen.stage.object_id[seen.rows], np.uint64(0))


def _panoptic(seen: Sight) -> tuple[NDArray[np.uint32], tuple[Segment, ...]]:
    """Return the (p,) segments: one per thing, one per class of stuff, numbered from 1.

    Stuff comes first by class, its object id is 0; things follow by the rows of the stage.
    """
    stage = seen.stage
    semantic = _semantic(seen)
    count = len(THING)
    key = np.where(THING[semantic], count + stage.whole[seen.rows], semantic)  # (p,)
    pixels = np.bincount(key)
    present = np.flatnonzero(pixels)
    number = np.zeros(len(pixels), np.uint32)
    number[present] = np.arange(1, len(present) + 1)
    segments = []
    for at, found in enumerate(present.tolist(), start=1):
        row = found - count
        object_id = int(stage.object_id[row]) if row >= 0 else 0
        held = int(stage.semantic[row]) if row >= 0 else found
        segments.append(Segment(at, object_id, held, int(pixels[found])))
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
