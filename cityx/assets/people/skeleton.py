"""The skeleton of people: named joints, weights of vertices, and bending.

Frame of a figure: x to its left, y to its back, z up, metres; it faces -y as every asset does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray

JointArray = NDArray[np.int8]

# Every joint after its parent. Three have no bone: the lap turns by the mean of both hips and
# carries what hangs over both thighs, such as a skirt; a grip carries a bag, which hangs plumb.
PARENTS: dict[str, str] = {
    "pelvis": "", "spine": "pelvis", "chest": "spine", "neck": "chest", "head": "neck",
    "left_shoulder": "chest", "left_elbow": "left_shoulder", "left_wrist": "left_elbow",
    "right_shoulder": "chest", "right_elbow": "right_shoulder", "right_wrist": "right_elbow",
    "left_hip": "pelvis", "left_knee": "left_hip", "left_ankle": "left_knee",
    "left_toes": "left_ankle",
    "right_hip": "pelvis", "right_knee": "right_hip", "right_ankle": "right_knee",
    "right_toes": "right_ankle", "lap": "pelvis",
    "left_grip": "left_wrist", "right_grip": "right_wrist",
}  # fmt: skip
JOINTS = tuple(PARENTS)
NUMBER = {name: number for number, name in enumerate(JOINTS)}
PARENT = np.array([NUMBER.get(parent, -1) for parent in PARENTS.values()])
# Places in body units (see `cityx.assets.people.body`), of the left side where there are two.
_MIDDLE = {
    "pelvis": (0.0, 0.005, 0.535), "spine": (0.0, 0.010, 0.600), "chest": (0.0, 0.012, 0.680),
    "neck": (0.0, 0.018, 0.835), "head": (0.0, 0.004, 0.885), "lap": (0.0, 0.0, 0.525),
}  # fmt: skip
_LEFT = {
    "shoulder": (0.098, 0.012, 0.792), "elbow": (0.121, 0.018, 0.628),
    "wrist": (0.133, -0.010, 0.481), "hip": (0.050, 0.0, 0.525), "knee": (0.049, -0.003, 0.285),
    "ankle": (0.047, 0.008, 0.048), "toes": (0.051, -0.070, 0.012),
    "grip": (0.123, -0.010, 0.408),
}  # fmt: skip


class Weights(NamedTuple):
    """Joints that move each of n vertices: numbers (n, 2), and their shares (n, 2), sum 1."""

    joints: JointArray
    shares: FloatArray


Binding = Callable[[FloatArray], Weights]


def rest_joints(unit: float, *, shoulder: float = 1.0, hip: float = 1.0) -> FloatArray:
    """Place the joints of a figure at rest, arms hanging.

    Parameters
    ----------
    unit
        Metres of a body unit.
    shoulder, hip
        Breadth of the shoulders and hips, relative to the tables.

    Returns
    -------
    joints
        (j, 3) float, in the order of `JOINTS`.
    """
    out = np.zeros((len(JOINTS), 3))
    wider = {"shoulder": shoulder, "hip": hip}
    for name, number in NUMBER.items():
        if name in _MIDDLE:
            out[number] = _MIDDLE[name]
            continue
        side, part = name.split("_")
        x, y, z = _LEFT[part]
        chain = "shoulder" if part in ("shoulder", "elbow", "wrist", "grip") else "hip"
        x += (wider[chain] - 1.0) * _LEFT[chain][0]  # an arm or leg moves as a whole
        out[number] = (x if side == "left" else -x, y, z)
    return out * unit


def rigid(joint: str) -> Binding:
    """Bind every vertex to one joint."""

    def bind(points: FloatArray) -> Weights:
        joints = np.full((len(points), 2), NUMBER[joint], np.int8)
        return Weights(joints, np.tile([1.0, 0.0], (len(points), 1)))

    return bind


def chained(
    joints: Sequence[str], breaks: Sequence[tuple[float, float]], *, axis: int = 2
) -> Binding:
    """Bind vertices to the joints of a chain by their place along an axis.

    Parameters
    ----------
    joints
        From the far end of the axis, such as the head, towards its origin.
    breaks
        (place, half width) of the blend between each joint and the next, falling; blends must not
        overlap, so that no vertex has more than two joints.
    axis
        0, 1 or 2; values are in the units of the points.
    """
    numbers = np.array([NUMBER[name] for name in joints])

    def bind(points: FloatArray) -> Weights:
        return _between(numbers, _stage(points[:, axis], breaks))

    return bind


def hanging(breaks: Sequence[tuple[float, float]], gap: float) -> Binding:
    """Bind what hangs over the thighs: the chest down to the lap, then the hip of its side.

    Parameters
    ----------
    breaks
        As of `chained`, for chest, spine, pelvis, lap and hip.
    gap
        Half width of the blend between left and right, in which the cloth stays with the lap.
    """
    upper = [NUMBER[name] for name in ("chest", "spine", "pelvis", "lap")]

    def bind(points: FloatArray) -> Weights:
        stage = _stage(points[:, 2], breaks)
        beside = _smooth(np.abs(points[:, 0]) / gap)
        stage = np.where(stage > 3.0, 3.0 + (stage - 3.0) * beside, stage)
        left = _between(np.array([*upper, NUMBER["left_hip"]]), stage)
        right = _between(np.array([*upper, NUMBER["right_hip"]]), stage)
        joints = np.where(points[:, :1] > 0, left.joints, right.joints)
        return Weights(joints.astype(np.int8), left.shares)

    return bind


def mirrored_weights(weights: Weights) -> Weights:
    """Exchange left and right."""
    other = [NUMBER[_other_side(name)] for name in JOINTS]
    return Weights(np.array(other, np.int8)[weights.joints], weights.shares)


def _other_side(name: str) -> str:
    side, _, part = name.partition("_")
    return {"left": f"right_{part}", "right": f"left_{part}"}.get(side, name)


def _smooth(value: FloatArray) -> FloatArray:
    t = np.clip(value, 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def _stage(value: FloatArray, breaks: Sequence[tuple[float, float]]) -> FloatArray:
    """Count the breaks above each value, in part within a blend."""
    stage = np.zeros(len(value))
    for place, half in breaks:
        stage += _smooth((place + half - value) / (2.0 * half))
    return stage


def _between(numbers: NDArray[np.int64], stage: FloatArray) -> Weights:
    first = np.clip(np.floor(stage).astype(np.int64), 0, len(numbers) - 2)
    share = stage - first
    joints = np.column_stack([numbers[first], numbers[first + 1]]).astype(np.int8)
    return Weights(joints, np.column_stack([1.0 - share, share]))


def joint_motions(joints: FloatArray, rotations: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Chain the rotations of joints into motions of their bones.

    Parameters
    ----------
    joints
        (j, 3) places at rest.
    rotations
        (j, 3) rotation vectors, radians, about the axes of the figure's frame, each relative to
        the parent. Those of the lap and the grips are not read.

    Returns
    -------
    turn, shift
        (j, 3, 3) and (j, 3): a point p of a bone at rest goes to ``turn @ p + shift``.
    """
    vectors = np.array(rotations, float)
    vectors[NUMBER["lap"]] = (vectors[NUMBER["left_hip"]] + vectors[NUMBER["right_hip"]]) / 2
    local = _rotation_matrices(vectors)
    turn, shift = np.empty((len(JOINTS), 3, 3)), np.empty((len(JOINTS), 3))
    for number, parent in enumerate(PARENT.tolist()):
        own = joints[number] - local[number] @ joints[number]
        if parent < 0:
            turn[number], shift[number] = local[number], own
        else:
            turn[number] = turn[parent] @ local[number]
            shift[number] = turn[parent] @ own + shift[parent]
    for grip in (NUMBER["left_grip"], NUMBER["right_grip"]):
        held = turn[grip] @ joints[grip] + shift[grip]
        turn[grip] = local[NUMBER["pelvis"]]
        shift[grip] = held - turn[grip] @ joints[grip]
    return turn, shift


def relative_turns(rotations: FloatArray) -> FloatArray:
    """Return (j, 3, 3) turns of bones, each relative to its parent's.

    Parameters
    ----------
    rotations
        As of `joint_motions`; the lap and the grips turn as they do there.
    """
    turn, _ = joint_motions(np.zeros((len(JOINTS), 3)), rotations)
    base = np.where((PARENT >= 0)[:, None, None], turn[PARENT], np.eye(3))
    return np.asarray(base.transpose(0, 2, 1) @ turn)


def bent(points: FloatArray, weights: Weights, turn: FloatArray, shift: FloatArray) -> FloatArray:
    """Move vertices, (n, 3), with the bones they are bound to (linear blend skinning)."""
    moved = np.einsum("nkij,nj->nki", turn[weights.joints], points) + shift[weights.joints]
    return np.asarray((moved * weights.shares[:, :, None]).sum(axis=1))


def _rotation_matrices(vectors: FloatArray) -> FloatArray:
    """(n, 3) rotation vectors to (n, 3, 3) matrices (Rodrigues)."""
    angle = np.linalg.norm(vectors, axis=1)
    x, y, z = (vectors / np.maximum(angle, 1e-12)[:, None]).T
    zero = np.zeros(len(angle))
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    sine, cosine = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.asarray(np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross))
