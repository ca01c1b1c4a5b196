"""Poses of people: rotations of joints when they stand, walk, run, push, ride and sit.

Every pose is (j, 3) float in the order of `people_skeleton.JOINTS`: rotation vectors in radians
about x (to the figure's left), y (to its back) and z (up). About x, a negative angle swings what
hangs forward and a positive one bends the knee or leans the back forward.

References
----------
Winter, "Biomechanics and Motor Control of Human Movement", 4th ed., Wiley 2009: joint angles of
walking. Novacheck, "The biomechanics of running", Gait and Posture 7, 1998: those of running.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from cityx.assets.people.skeleton import JOINTS, NUMBER
from cityx.geometry.arrays import FloatArray

# Angles of the left leg every twentieth of a cycle that begins when its heel meets the ground:
# flexion of hip and knee, raising of the foot, bending of the toes.
_WALK_DEG = {
    "hip": (24, 23, 20, 16, 10, 4, -1, -6, -10, -12, -11, -4, 5, 15, 22, 26, 28, 28, 27, 25),
    "knee": (4, 9, 14, 16, 14, 10, 7, 6, 9, 17, 29, 42, 54, 60, 59, 51, 38, 22, 9, 3),
    "ankle": (0, -4, -3, 1, 4, 6, 8, 10, 10, 7, -1, -10, -14, -10, -4, 0, 2, 3, 3, 2),
    "toes": (6, 0, 0, 0, 0, 0, 0, 0, 8, 20, 30, 26, 10, 2, 0, 2, 6, 9, 10, 9),
}
_RUN_DEG = {
    "hip": (36, 33, 27, 20, 11, 2, -6, -11, -11, -6, 3, 15, 28, 39, 46, 50, 51, 48, 43, 39),
    "knee": (18, 32, 40, 40, 34, 25, 19, 18, 26, 45, 68, 88, 98, 97, 86, 68, 48, 29, 16, 13),
    "ankle": (6, 14, 20, 21, 16, 6, -9, -20, -22, -16, -9, -3, 0, 2, 4, 5, 5, 5, 5, 5),
    "toes": (0, 0, 0, 0, 4, 14, 22, 16, 6, 0, 0, 0, 0, 0, 0, 0, 4, 6, 6, 3),
}


def stand(shift: float = 0.0) -> FloatArray:
    """Stand at ease.

    Parameters
    ----------
    shift
        -1 to 1: 0 stands straight, 1 rests on the left leg with the right knee loose, -1 on the
        right leg.
    """
    s = float(np.clip(shift, -1.0, 1.0))
    loose_left, loose_right = max(-s, 0.0), max(s, 0.0)
    return _pose(
        {
            "pelvis": (0, -3 * s, 0), "spine": (1, 3 * s, 0), "chest": (0, 1.5 * s, 0),
            "head": (1, -1 * s, 8 * s),
            "left_hip": (-12 * loose_left, 3 * s - 2, 6), "right_hip": (-12 * loose_right,
                                                                     3 * s + 2, -6),
            "left_knee": (20 * loose_left + 1, 0, 0), "right_knee": (20 * loose_right + 1, 0, 0),
            "left_ankle": (-8 * loose_left, -1, 0), "right_ankle": (-8 * loose_right, 1, 0),
            "left_shoulder": (1, -3, 0), "right_shoulder": (-2, 3, 0),
            "left_elbow": (-9 - 4 * s, 0, 0), "right_elbow": (-11 + 4 * s, 0, 0),
        }
    )  # fmt: skip


def walk(phase: float) -> FloatArray:
    """Walk: one cycle of two steps.

    Parameters
    ----------
    phase
        0 to 1 and around; at 0 the left heel meets the ground, at 0.5 the right one.
    """
    return _gait(_WALK_DEG, phase, lean=2.0, swing=(19.0, -2.0), elbow=(-17.0, -8.0), yaw=5.0)


def run(phase: float) -> FloatArray:
    """Run: one cycle of two steps; arguments are those of `walk`."""
    return _gait(_RUN_DEG, phase, lean=8.0, swing=(36.0, 8.0), elbow=(-88.0, -10.0), yaw=8.0)


def push(phase: float) -> FloatArray:
    """Walk with both hands on the bar of a pram; the pelvis goes straight on, as the pram does."""
    pose = walk(phase)
    found = {
        "pelvis": (0.0, 0.0, 0.0), "spine": (3.0, 0.0, 0.0), "chest": (2.0, 0.0, 0.0),
        "left_shoulder": (-36.0, -3.0, 0.0), "right_shoulder": (-36.0, 3.0, 0.0),
        "left_elbow": (-34.0, 0.0, -6.0), "right_elbow": (-34.0, 0.0, 6.0),
    }  # fmt: skip
    for name, angle in found.items():
        pose[NUMBER[name]] = np.radians(angle)
    return pose


def sit() -> FloatArray:
    """Sit upright on a seat at the height of the knees, hands on the thighs."""
    return _pose(
        {
            "pelvis": (-6, 0, 0), "spine": (4, 0, 0), "chest": (4, 0, 0), "head": (3, 0, 0),
            "left_hip": (-84, -4, 4), "right_hip": (-84, 4, -4),
            "left_knee": (86, 0, 0), "right_knee": (86, 0, 0),
            "left_ankle": (4, 0, 0), "right_ankle": (4, 0, 0),
            "left_shoulder": (-24, -2, 0), "right_shoulder": (-24, 2, 0),
            "left_elbow": (-52, 0, -12), "right_elbow": (-52, 0, 12),
        }
    )  # fmt: skip


def ride(phase: float, *, pedals: bool = True) -> FloatArray:
    """Sit on a bicycle and turn the pedals, or on a motorcycle with still feet.

    Parameters
    ----------
    phase
        Turns of the pedals, 0 to 1 and around; at 0 the left one is at the top.
    pedals
        Whether there are any.
    """
    found: dict[str, tuple[float, float, float]] = {
        "pelvis": (14, 0, 0), "spine": (12, 0, 0), "chest": (8, 0, 0), "head": (-26, 0, 0),
    } if pedals else {
        "pelvis": (2, 0, 0), "spine": (10, 0, 0), "chest": (6, 0, 0), "head": (-14, 0, 0),
    }  # fmt: skip
    lean = sum(found[name][0] for name in ("pelvis", "spine", "chest"))
    for side, offset, sign in (("left", 0.0, 1.0), ("right", 0.5, -1.0)):
        turn = 2 * np.pi * (float(phase) + offset)
        up, ahead = float(np.cos(turn)), float(np.sin(turn))
        hip, knee = (58 + 24 * up + 4 * ahead, 66 + 36 * up - 10 * ahead) if pedals else (72, 84)
        tilt = found["pelvis"][0]
        found[f"{side}_hip"] = (-hip - tilt, 0.0, (0.0 if pedals else 8.0) * sign)
        found[f"{side}_knee"] = (knee, 0.0, 0.0)
        found[f"{side}_ankle"] = (hip - knee if pedals else -4.0, 0.0, 0.0)
        found[f"{side}_shoulder"] = (-lean - (40.0 if pedals else 34.0), -10.0 * sign, 0.0)
        found[f"{side}_elbow"] = (-22.0 if pedals else -30.0, 0.0, -8.0 * sign)
    return _pose(found)


def _gait(
    angles_deg: Mapping[str, Sequence[float]],
    phase: float,
    *,
    lean: float,
    swing: tuple[float, float],
    elbow: tuple[float, float],
    yaw: float,
) -> FloatArray:
    """Compose a cycle; `swing` and `elbow` are (amplitude, mean) and (mean, amplitude), degrees."""
    found: dict[str, tuple[float, float, float]] = {}
    t = float(phase) % 1.0
    for side, offset, sign in (("left", 0.0, 1.0), ("right", 0.5, -1.0)):
        own = (t + offset) % 1.0
        hip, knee, ankle, toes = (_periodic(angles_deg[part], own) for part in angles_deg)
        forward = -float(np.cos(2 * np.pi * own))  # an arm swings against the leg of its side
        found[f"{side}_hip"] = (-hip, -1.0 * sign, 3.0 * sign)
        found[f"{side}_knee"] = (knee, 0.0, 0.0)
        found[f"{side}_ankle"] = (-ankle, 0.0, 0.0)
        found[f"{side}_toes"] = (-toes, 0.0, 0.0)
        found[f"{side}_shoulder"] = (-swing[0] * forward - swing[1], -4.0 * sign, 0.0)
        found[f"{side}_elbow"] = (elbow[0] + elbow[1] * forward, 0.0, -9.0 * sign)
    # The side of the pelvis whose leg is in front goes with it, the chest turns against it.
    turn = float(np.cos(2 * np.pi * t))
    drop = float(np.sin(2 * np.pi * t))
    found["pelvis"] = (0.4 * lean, -2.0 * drop, -yaw * turn)
    found["spine"] = (0.3 * lean, 2.0 * drop, 1.0 * yaw * turn)
    found["chest"] = (0.3 * lean, 0.5 * drop, 1.0 * yaw * turn)
    found["head"] = (-0.6 * lean, 0.0, -1.0 * yaw * turn)
    return _pose(found)


def _periodic(samples: Sequence[float], phase: float) -> float:
    """Read a smooth periodic curve between samples that are equally far apart."""
    waves = np.fft.rfft(np.asarray(samples, float)) / len(samples)
    angle = 2 * np.pi * phase * np.arange(len(waves))
    factor = np.full(len(waves), 2.0)
    factor[0] = 1.0
    if len(samples) % 2 == 0:
        factor[-1] = 1.0
    return float((factor * (waves.real * np.cos(angle) - waves.imag * np.sin(angle))).sum())


def _pose(angles_deg: Mapping[str, tuple[float, float, float]]) -> FloatArray:
    out = np.zeros((len(JOINTS), 3))
    for name, angle in angles_deg.items():
        out[NUMBER[name]] = np.radians(angle)
    return out
