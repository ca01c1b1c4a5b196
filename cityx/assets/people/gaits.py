"""How people go: the pose of every moment of a gait, and how far a cycle of it takes them.

A foot on the ground stays where it is: the stride of a figure is what its foot goes back under it
from heel to toe, so that legs that follow the metres gone never slide.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from cityx.assets.people.people import Figure, posed
from cityx.assets.people.poses import push, ride, run, sit, stand, walk
from cityx.assets.people.skeleton import NUMBER, bent, joint_motions
from cityx.assets.shapes import moved
from cityx.city.mesh import MeshBatch
from cityx.city.tracks import GAIT
from cityx.geometry.arrays import FloatArray

PHASES = 16  # poses of a cycle that are shown at a standstill
TOE_OFF = 0.36  # of a cycle of running, when the foot that bears leaves the ground
FLIGHT = 0.02  # metres that a runner rises between two steps: g t^2 / 8 for 0.13 s
# Share of a cycle in which the left foot bears, without the roll onto heel and off the toes.
_STANCE = {"walk": (0.08, 0.48), "run": (0.06, 0.26)}
_CYCLES = {GAIT["walk"]: walk, GAIT["run"]: run, GAIT["push"]: push}
_NAMES = {GAIT["walk"]: "walk", GAIT["run"]: "run"}


@lru_cache(maxsize=1024)  # a crowd is in few poses
def pose_of(gait: int, phase: float) -> FloatArray:
    """Return the (j, 3) rotations of joints of a gait of `GAITS`, phase 0 to 1 and around.

    Who stands still shifts the weight with the phase, who rides turns the pedals.
    """
    if gait in _CYCLES:
        pose = _CYCLES[gait](phase)
    elif gait == GAIT["ride"]:
        pose = ride(phase)
    elif gait == GAIT["sit"]:
        pose = sit()
    else:
        pose = stand(np.sin(2 * np.pi * phase))
    pose.setflags(write=False)  # it is shared
    return pose


def stride_of(figure: Figure, gait: int) -> float:
    """Return the metres that a figure goes in a cycle of two steps of a gait."""
    name = _NAMES.get(gait, "walk")
    return _stride(figure.joints.tobytes(), name)


@lru_cache(maxsize=4096)
def _stride(held: bytes, name: str) -> float:
    joints = np.frombuffer(held).reshape(-1, 3)
    low, high = _STANCE[name]
    phase = np.linspace(low, high, 9)
    cycle = walk if name == "walk" else run
    back = np.array([_foot(joints, cycle(float(t))) for t in phase])
    return float(np.polyfit(phase, back, 1)[0])


def _foot(joints: FloatArray, rotations: FloatArray) -> float:
    """Return how far behind the pelvis the ball of the left foot is, metres."""
    turn, shift = joint_motions(joints, rotations)
    toes = NUMBER["left_toes"]
    return float((turn[toes] @ joints[toes] + shift[toes])[1])


def lift_at(figure: Figure, gait: int, phase: float) -> float:
    """Return the metres by which a figure is raised at a moment of a gait.

    Its lower foot is on the ground, but in the flight between two steps of a run.
    """
    own = phase % 0.5  # both steps are alike
    if gait != GAIT["run"] or own < TOE_OFF:
        return _lift(figure, pose_of(gait, phase))
    share = (own - TOE_OFF) / (0.5 - TOE_OFF)
    begin, end = (_lift(figure, pose_of(gait, at)) for at in (TOE_OFF, 0.5))
    return (1 - share) * begin + share * end + 4 * share * (1 - share) * FLIGHT


def _lift(figure: Figure, rotations: FloatArray) -> float:
    turn, shift = joint_motions(figure.joints, rotations)
    points = bent(figure.mesh.vertices, figure.weights, turn, shift)
    return -float(points[: figure.bearing, 2].min())


def going(figure: Figure, gait: int, phase: float) -> MeshBatch:
    """Return a figure at a moment of a gait, on the ground."""
    mesh = posed(figure, pose_of(gait, phase), grounded=False)
    return moved(mesh, (0.0, 0.0, lift_at(figure, gait, phase)))


def riding(figure: Figure, seat: tuple[float, float], phase: float, *, pedals: bool) -> MeshBatch:
    """Return a figure on a vehicle.

    Parameters
    ----------
    figure
        The figure.
    seat
        (y, z) of its pelvis, metres.
    phase
        Turns of the pedals.
    pedals
        Whether there are any.
    """
    y, z = seat
    pelvis = figure.joints[NUMBER["pelvis"]]
    mesh = posed(figure, ride(phase, pedals=pedals), grounded=False)
    return moved(mesh, (0.0, y - pelvis[1], z - pelvis[2]))
