"""Necks and heads of people: skull, nose, ears, and what suggests a face.

The skull is told in its own height: 0 is the chin and 1 the crown.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cityx.assets.people.body import (
    CHIN,
    Body,
    Part,
    ball,
    bound,
    curve,
    heights,
    level,
    ring_angles,
    stacked,
)
from cityx.assets.people.skeleton import chained, rigid
from cityx.assets.shapes import Color, is_fine, loft
from cityx.city.mesh import MeshBatch

FloatArray = NDArray[np.float64]

# (z, half width, front, back) of the skull, in its height above the chin.
_SKULL = np.array([
    (-0.010, 0.060, 0.370, -0.250), (0.015, 0.120, 0.405, -0.160), (0.060, 0.180, 0.415, -0.030),
    (0.120, 0.225, 0.405, 0.080), (0.200, 0.258, 0.400, 0.190), (0.280, 0.280, 0.395, 0.290),
    (0.360, 0.298, 0.395, 0.365), (0.440, 0.310, 0.385, 0.410), (0.500, 0.314, 0.382, 0.432),
    (0.570, 0.322, 0.405, 0.450), (0.660, 0.330, 0.405, 0.460), (0.750, 0.328, 0.385, 0.450),
    (0.840, 0.300, 0.335, 0.405), (0.920, 0.238, 0.250, 0.318), (0.972, 0.145, 0.145, 0.195),
    (1.000, 0.0, 0.0, 0.0),
])  # fmt: skip
_CROWN = 0.03  # y of the crown above the axis of the head, in heights of the skull
HEAD_Y = -0.006  # axis of the head before that of the body
NECK_BINDING = chained(("head", "neck", "chest"), ((0.886, 0.016), (0.838, 0.014)))


def neck(body: Body, skin: Color) -> list[Part]:
    """Neck with the top of the chest, which an open collar shows."""
    wide = (0.0370 - 0.0060 * body.female) * (1 + 0.12 * body.build - 0.08 * body.child)
    z = heights(0.795, CHIN + 0.35 * body.skull, 3, 8)
    share = (z - z[0]) / (z[-1] - z[0])
    flare = 1.0 + 1.1 * np.exp(-((share / 0.22) ** 2))
    reach = np.column_stack([wide * flare, wide * 0.98 * (1 + 0.1 * (flare - 1)),
                             wide * 1.06 * (1 - 0.1 * (flare - 1))])  # fmt: skip
    centre = np.column_stack([np.zeros(len(z)), 0.016 - 0.014 * share])
    rings = stacked(z, centre, reach, level(7, 18), power=2.0)
    return [bound(loft(rings, "skin", skin), NECK_BINDING)]


def skull_points(body: Body, z: FloatArray, angle: FloatArray) -> FloatArray:
    """Points of the skull at heights (0 chin, 1 crown) and angles, broadcast, (..., 3)."""
    height, turn = np.broadcast_arrays(z, angle)
    reach = curve(_SKULL, height.ravel()).reshape(*height.shape, 3)
    broad = 1.0 + 0.05 * body.build - 0.02 * body.female + 0.04 * body.child
    face = np.clip(1.0 - height / 0.45, 0.0, 1.0)  # a woman's jaw and a child's are narrower
    wide = broad * (1.0 - 0.10 * body.female * face + 0.05 * body.child * face)
    c, s = np.cos(turn), np.sin(turn)
    x = reach[..., 0] * wide * np.sign(c) * np.abs(c) ** 0.9
    along = np.sign(s) * np.abs(s) ** 0.9
    y = _CROWN * np.clip(height, 0, 1) ** 4
    y = y + np.where(along < 0, reach[..., 1], reach[..., 2]) * along
    if is_fine():  # sockets of the eyes, hollows beside the mouth
        front = np.clip(-along, 0.0, 1.0)
        for px, pz, rx, rz, deep in ((0.15, 0.495, 0.085, 0.050, 0.030),
                                     (0.17, 0.27, 0.07, 0.07, 0.010)):  # fmt: skip
            gap = ((np.abs(x) - px) / rx) ** 2 + ((height - pz) / rz) ** 2
            y = y + deep * np.exp(-gap) * front
    return np.stack([x, y, height], axis=-1)


def on_head(body: Body, points: FloatArray) -> FloatArray:
    """Move points from heights of the skull to the body's frame, (..., 3)."""
    return np.asarray(points * body.skull + np.array([0.0, HEAD_Y, CHIN]))


def head(body: Body, skin: Color, brow: Color) -> list[Part]:
    """Skull, nose and ears; eyes, brows and a mouth at the fine level."""
    ends = (
        ([-0.01, 0.015, 0.06], [0.90, 0.945, 0.98, 1.0])
        if is_fine()
        else ([-0.01, 0.05], [0.93, 1.0])
    )
    z = np.concatenate([ends[0], np.linspace(0.12, 0.84, level(4, 15)), ends[1]])
    points = skull_points(body, z[:, None], ring_angles(level(10, 28))[None, :])
    solids = [loft(points, "skin", skin)]
    nose_rows = np.array([
        (0.315, 0.018, 0.050, 0.02), (0.335, 0.050, 0.105, 0.02), (0.365, 0.052, 0.142, 0.02),
        (0.395, 0.040, 0.135, 0.02), (0.450, 0.030, 0.100, 0.02), (0.510, 0.026, 0.066, 0.02),
        (0.565, 0.030, 0.040, 0.02),
    ])  # fmt: skip
    height = heights(0.315, 0.565, 4, 9)
    reach = curve(nose_rows, height) * [1.0, 1.0 - 0.25 * body.child, 1.0]
    nose = stacked(height, np.array([0.0, -0.345]), reach, level(5, 10), power=2.0)
    solids.append(loft(nose, "skin", skin))
    for side in (1.0, -1.0):
        solids.append(ball((0.318 * side, 0.045, 0.455), (0.030, 0.055, 0.070, 0.110), "skin", skin,
                           plain=(3, 5)))  # fmt: skip
    if is_fine():
        solids += _features(skin, brow)
    nod = rigid("head")
    return [bound(replace(solid, vertices=on_head(body, solid.vertices)), nod) for solid in solids]


def _features(skin: Color, brow: Color) -> list[MeshBatch]:
    """Eyes, brows and lips, in heights of the skull."""
    red, green, blue = skin
    lips = (0.80 * red, 0.55 * green, 0.52 * blue)
    solids = []
    for side in (1.0, -1.0):
        solids.append(ball((0.150 * side, -0.318, 0.492), (0.058, 0.045, 0.02, 0.021), "skin",
                           (0.05, 0.035, 0.03), fine=(4, 10)))  # fmt: skip
        path = np.array([(0.065, 0.555), (0.13, 0.580), (0.20, 0.578), (0.26, 0.545)])
        rings = []
        for x, z in path:
            y = -0.392 + 0.42 * max(x - 0.06, 0.0) ** 1.4
            thick = 0.012 if 0.1 < x < 0.22 else 0.008
            rings.append([(x * side, y - 0.020, z), (x * side, y, z + thick),
                          (x * side, y + 0.02, z), (x * side, y, z - thick)])  # fmt: skip
        order = slice(None) if side < 0 else slice(None, None, -1)
        solids.append(loft(np.array(rings)[order], "hair", brow))
    solids.append(ball((0.0, -0.352, 0.205), (0.105, 0.062, 0.02, 0.026), "skin", lips,
                       fine=(4, 12)))  # fmt: skip
    return solids
