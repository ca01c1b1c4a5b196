"""What moves, as time samples of point instancers: a place per mover and frame.

People go through the poses of their gait as prototypes, so that no program needs a skeleton to
show them; who is not in the city at a time is invisible then.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pxr import Kind, Vt

from cityx.assets.vehicles.moving import PEOPLE, TRAFFIC, with_movers
from cityx.city.scene import Instances, Scene
from cityx.city.tracks import FRAME_RATE
from cityx.geometry.arrays import FloatArray
from cityx.outputs.gltf_instances import quaternions
from cityx.outputs.usd_material import as_steps, look_name
from cityx.outputs.usd_mesh import (
    TINT_STEPS,
    Types,
    add_attribute,
    add_prim,
    integers,
    long_integers,
    move_to,
    point_at,
    tint_steps,
    vectors,
)

if TYPE_CHECKING:
    from cityx.outputs.usd_layer import UsdWriter

LONGEST = 60.0  # seconds of the tracks that are sampled at most
MOST_ROWS = 1_500_000  # places over all samples; a busier city is sampled for a shorter span
LEAST = 1.0  # seconds
NEAR_ZERO = 1e-7


@dataclass(frozen=True)
class _Sample:
    """One layer at one frame."""

    frame: int
    scene: Scene
    rows: Instances


def moving_layers(writer: UsdWriter) -> None:
    """Write an instancer with time samples for each layer of movers."""
    view = writer.view
    if view.tracks is None or not view.tracks.count:
        return
    first, last = _frames(view)
    root = writer.layer.pseudoRoot
    for key, value in (("timeCodesPerSecond", FRAME_RATE), ("framesPerSecond", FRAME_RATE),
                       ("startTimeCode", first), ("endTimeCode", last)):  # fmt: skip
        root.SetInfo(key, float(value))
    held: dict[str, list[_Sample]] = {TRAFFIC: [], PEOPLE: []}
    for frame, scene in _scenes(view, first, last):
        for layer, samples in held.items():
            samples.append(_Sample(frame, scene, scene.instances[layer]))
    for layer, samples in held.items():
        if any(sample.rows.count for sample in samples):
            _layer(writer, layer, samples)


def _frames(view: Any) -> tuple[int, int]:
    """Return the first and last frame that are sampled: from the moment on, as many as fit."""
    now = with_movers(view).scene.instances
    rows = max(1, sum(now[layer].count for layer in (TRAFFIC, PEOPLE)))
    seconds = min(LONGEST, view.tracks.duration - view.moment, MOST_ROWS / rows / FRAME_RATE)
    first = int(np.ceil(view.moment * FRAME_RATE - NEAR_ZERO))
    return first, first + int(max(seconds, min(LEAST, view.tracks.duration)) * FRAME_RATE)


def _scenes(view: Any, first: int, last: int) -> Iterator[tuple[int, Scene]]:
    from dataclasses import replace

    bare = replace(view, scene=Scene())
    for frame in range(first, last + 1):
        yield frame, with_movers(bare, frame / FRAME_RATE).scene


def _layer(writer: UsdWriter, name: str, samples: list[_Sample]) -> None:
    ids = np.unique(np.concatenate([sample.rows.object_id for sample in samples]))
    instancer = add_prim(writer.city, name, "PointInstancer")
    instancer.kind = Kind.Tokens.component
    writer.note_instancer(instancer)
    scope = add_prim(instancer, "Prototypes", "Scope")
    origin = np.round(samples[0].rows.position.mean(axis=0), 2) if samples[0].rows.count else (
        np.zeros(3)
    )  # fmt: skip
    move_to(instancer, origin)
    add_attribute(instancer, "ids", Types.Int64Array, long_integers(ids))
    kinds = {"protoIndices": Types.IntArray, "positions": Types.Point3fArray,
             "orientations": Types.QuathArray, "invisibleIds": Types.Int64Array}  # fmt: skip
    specs = {key: add_attribute(instancer, key, kind) for key, kind in kinds.items()}
    targets: dict[str, Any] = {}
    held = _Held(ids, origin)
    owners = np.zeros(len(ids), np.uint64)
    for sample in samples:
        at = np.searchsorted(ids, sample.rows.object_id)
        variant = _variants(writer, scope, sample, targets)
        held.put(at, sample.rows, variant)
        owners[at] = sample.rows.owner
        absent = np.setdiff1d(np.arange(len(ids)), at)
        values = {**held.values(), "invisibleIds": long_integers(ids[absent])}
        for key, value in values.items():
            writer.layer.SetTimeSample(specs[key].path, float(sample.frame), value)
    for key, value in held.values().items():  # for programs that show no time
        specs[key].default = value
    point_at(instancer, "prototypes", [prim.path for prim in targets.values()])
    add_attribute(instancer, "cityx:owner", Types.Int64Array, long_integers(owners))
    writer.prototypes += len(targets)
    writer.instances += len(ids)


class _Held:
    """Where all movers of a layer are; who is absent stays where it was last seen."""

    def __init__(self, ids: NDArray[np.uint64], origin: FloatArray) -> None:
        self.origin = origin
        self.variant = np.zeros(len(ids), np.int64)
        self.position = np.zeros((len(ids), 3))
        self.turn = np.tile([0.0, 0.0, 0.0, 1.0], (len(ids), 1))

    def put(self, at: NDArray[np.int64], rows: Instances, variant: NDArray[np.int64]) -> None:
        """Take in one frame."""
        self.variant[at] = variant
        self.position[at] = rows.position - self.origin
        turn = quaternions(rows.rotation)
        # The nearer of the two quaternions of a turn, since programs blend from frame to frame.
        away = (turn * self.turn[at]).sum(axis=1) < 0
        self.turn[at] = np.where(away[:, None], -turn, turn)

    def values(self) -> dict[str, Any]:
        """Return the arrays of the instancer."""
        return {
            "protoIndices": integers(self.variant),
            "positions": vectors(self.position),
            "orientations": Vt.QuathArray.FromNumpy(self.turn.astype(np.float16)),
        }


def _variants(
    writer: UsdWriter, scope: Any, sample: _Sample, targets: dict[str, Any]
) -> NDArray[np.int64]:
    """Return the (n,) numbers of the prototypes in their tints, written when first seen."""
    rows, number = sample.rows, {key: place for place, key in enumerate(targets)}
    found = np.zeros(rows.count, np.int64)
    steps = tint_steps(rows.tint)
    for row, index in enumerate(rows.prototype.tolist()):
        prototype = sample.scene.prototypes[index]
        (shape,) = writer.shapes([prototype])
        assert shape is not None
        tint = steps[row] if shape.takes_tint else np.full(3, TINT_STEPS)
        title = look_name(prototype.name, as_steps(tint))
        if title not in targets:
            number[title] = len(targets)
            targets[title] = writer.variant(scope, title, shape, tint)
        found[row] = number[title]
    return found
