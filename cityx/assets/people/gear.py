"""What people have with them: wheelchairs that they sit in and prams that they push.

Gear is bound to the pelvis. It is made as it stands when the person sits or walks with it, in
metres about the ground below the pelvis, and turned back to where that is at rest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from cityx.assets.people.body import Body, Part, bound
from cityx.assets.people.poses import push, sit
from cityx.assets.people.skeleton import NUMBER, rigid
from cityx.assets.shapes import Color, box, cylinder, loft, ring, tube
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.geometry.turns import matrices

WHEELCHAIR, PRAM = "wheelchair", "pram"
GEAR = (WHEELCHAIR, PRAM)
FOOTREST = 0.10  # metres of a footrest above the ground
DARK: Color = (0.03, 0.03, 0.034)
_WHEEL, _CASTER = 0.305, 0.085  # metres, radii of a wheelchair's wheels
_HANDLE = 0.60  # of the height of a body, at which a pram is pushed


def gear(body: Body, kind: str, color: Color) -> list[Part]:
    """Make gear, one of `GEAR`, in the colour of its cloth."""
    shapes, pose, foot = _MAKERS[kind](body, color)
    pelvis = body.joints()[NUMBER["pelvis"]] * body.unit
    turn = matrices(-pose[[NUMBER["pelvis"]]])[0]
    parts = []
    for shape in shapes:
        stands = shape.vertices - [0.0, pelvis[1], foot]
        rest = stands @ turn.T + pelvis
        mesh = replace(shape, vertices=rest / body.unit)
        parts.append(bound(mesh, rigid("pelvis")))
    return parts


def _wheelchair(body: Body, color: Color) -> tuple[list[MeshBatch], FloatArray, float]:
    """Return a wheelchair on the ground, the pose in it, and the height of the pelvis, metres."""
    joints = body.joints() * body.unit
    knee, hip = joints[NUMBER["left_knee"]], joints[NUMBER["left_hip"]]
    thigh = float(hip[2] - knee[2])
    high = float(knee[2]) + FOOTREST + 0.01  # of the pelvis
    seat = high - 0.060 * body.unit - 0.02
    half = 0.150 * body.unit * body.hip + 0.02
    front, back, toes = -0.82 * thigh, 0.092 * body.unit, -thigh - 0.02
    arm = seat + 0.21
    found = [
        box((-half, front, seat - 0.035), (half, back + 0.02, seat), "cloth", color),
        box((-half, back + 0.02, seat + 0.03), (half, back + 0.05, seat + 0.40), "cloth", color),
        box((-0.13, toes - 0.16, FOOTREST - 0.022), (-0.015, toes + 0.06, FOOTREST), "metal_dark"),
        box((0.015, toes - 0.16, FOOTREST - 0.022), (0.13, toes + 0.06, FOOTREST), "metal_dark"),
        tube([(-half, back + 0.04, seat - 0.06), (half, back + 0.04, seat - 0.06)], 0.012,
             "metal_grey", sides=6),
    ]  # fmt: skip
    for side in (-1.0, 1.0):
        x, out = side * (half + 0.012), side * (half + 0.05)
        found += [
            tube([(x, back + 0.20, seat + 0.47), (x, back + 0.06, seat + 0.46),
                  (x, back + 0.035, seat + 0.38), (x, back + 0.035, seat - 0.10)], 0.012,
                 "metal_grey", sides=6),
            tube([(x, back + 0.035, seat - 0.025), (x, front, seat - 0.025),
                  (side * 0.09, toes - 0.02, FOOTREST)], 0.012, "metal_grey", sides=6),
            tube([(x, front + 0.10, seat - 0.03), (x, front + 0.06, 2.0 * _CASTER)], 0.012,
                 "metal_grey", sides=6),
            tube([(x, back - 0.02, seat), (x, back - 0.04, arm - 0.02),
                  (x, front + 0.12, arm - 0.02), (x, front + 0.08, seat)], 0.010,
                 "metal_grey", sides=6),
            box((min(x, x + side * 0.05), front + 0.14, arm - 0.02),
                (max(x, x + side * 0.05), back - 0.06, arm + 0.01), "plastic", DARK),
            *_wheel(out, back - 0.01, _WHEEL, 0.017),
            cylinder((x - 0.014, front + 0.06, _CASTER), (x + 0.014, front + 0.06, _CASTER),
                     _CASTER, "rubber", sides=14),
        ]  # fmt: skip
        found.append(_placed(ring(0.80 * _WHEEL, 0.008, "metal_grey"),
                             out + side * 0.035, back - 0.01, _WHEEL))  # fmt: skip
    return found, sit(), high


def _wheel(x: float, y: float, radius: float, tyre: float) -> list[MeshBatch]:
    """Make an upright wheel about a place: tyre, rim, hub, spokes."""
    found = [
        _placed(ring(radius - tyre, tyre, "rubber"), x, y, radius),
        _placed(ring(radius - 2.2 * tyre, 0.5 * tyre, "metal_grey"), x, y, radius),
        cylinder((x - 0.03, y, radius), (x + 0.03, y, radius), 0.022, "metal_grey", sides=8),
    ]
    for spoke in range(10):
        angle = 2 * np.pi * spoke / 10
        way = np.array([0.0, np.cos(angle), np.sin(angle)])
        middle = np.array([x, y, radius])
        ends = [middle + 0.018 * way, middle + (radius - 2.2 * tyre) * way]
        found.append(tube(ends, 0.0022, "metal_grey", sides=4))
    return found


def _placed(shape: MeshBatch, x: float, y: float, z: float) -> MeshBatch:
    return replace(shape, vertices=np.add(shape.vertices, (x, y, z)))


def _pram(body: Body, color: Color) -> tuple[list[MeshBatch], FloatArray, float]:
    """Return a pram before somebody who pushes it."""
    high = float(body.joints()[NUMBER["pelvis"], 2] * body.unit)
    grip = -0.235 * body.unit  # metres ahead of the pelvis
    top = _HANDLE * body.unit
    low, rear = 0.52, grip - 0.16
    found: list[MeshBatch] = [
        _tub(rear - 0.76, rear, low, 0.26, color),
        _hood(rear - 0.02, low + 0.24, color),
        tube([(-0.20, grip, top), (0.20, grip, top)], 0.016, "rubber", sides=8),
        box((-0.17, rear - 0.62, 0.26), (0.17, rear - 0.14, 0.29), "plastic", DARK),
    ]
    for side in (-1.0, 1.0):
        x = side * 0.20
        found += [
            tube([(x, grip, top), (x, rear - 0.30, low - 0.04), (x, rear - 0.72, 0.16)], 0.012,
                 "metal_grey", sides=6),
            tube([(x, rear - 0.26, low), (x, rear - 0.02, 0.15)], 0.012, "metal_grey", sides=6),
            *_wheel(side * 0.24, rear - 0.02, 0.15, 0.018),
            *_wheel(side * 0.24, rear - 0.72, 0.15, 0.018),
        ]  # fmt: skip
    return found, push(0.0), high


def _tub(front: float, rear: float, low: float, deep: float, color: Color) -> MeshBatch:
    """Skin the tub of a pram, wider above and rounded at its ends."""
    turn = np.arange(16) * (2 * np.pi / 16)
    middle, half = (front + rear) / 2, (rear - front) / 2
    rings = []
    for share, wide in ((0.0, 0.72), (0.25, 0.90), (0.6, 0.98), (1.0, 1.0)):
        x = 0.215 * wide * np.sign(np.cos(turn)) * np.abs(np.cos(turn)) ** 0.6
        y = middle + half * (0.80 + 0.20 * wide) * np.sin(turn)
        rings.append(np.column_stack([x, y, np.full(16, low + share * deep)]))
    return loft(np.array(rings), "cloth", color)


def _hood(rear: float, low: float, color: Color) -> MeshBatch:
    """Arch the hood of a pram over its rear."""
    across = np.linspace(0.14, np.pi - 0.14, 9)
    rings = []
    for angle in np.radians([20.0, 45.0, 70.0, 95.0]):
        outer = np.column_stack([
            0.215 * np.cos(across), rear - 0.04 - 0.30 * np.sin(across) * np.cos(angle),
            low + 0.30 * np.sin(across) * np.sin(angle),
        ])  # fmt: skip
        inner = outer * [0.94, 1.0, 1.0] + [0.0, 0.0, -0.018]
        rings.append(np.concatenate([outer, inner[::-1]]))
    return loft(np.array(rings)[::-1], "cloth", tuple(0.8 * c for c in color))


_Maker = Callable[[Body, Color], tuple[list[MeshBatch], FloatArray, float]]
_MAKERS: Mapping[str, _Maker] = MappingProxyType({WHEELCHAIR: _wheelchair, PRAM: _pram})
