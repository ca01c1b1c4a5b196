"""Instances and the sun as glTF wants them: quaternions, few colours, a directional light."""

from __future__ import annotations

from math import cos, degrees, exp, pi, sin
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.city.environment import Environment

EXTENSION = "KHR_lights_punctual"
# Illuminance of the sun before the air, and what one thickness of clear air takes (CIE 1989).
SOLAR_LUX, CLEAR_AIR = 128_000.0, 0.21
# glTF means lux, but most viewers take the number as it is beside an exposure of one: a light of pi
# makes a white surface white. The lux are in the extras.
LUX_TO_INTENSITY = pi / 100_000.0
_NOON, _LOW = (1.0, 0.96, 0.90), (1.0, 0.58, 0.30)  # linear colour of sunlight, high and at sunset


def quaternions(euler: ArrayLike) -> NDArray[np.float64]:
    """Turn (n, 3) XYZ Euler angles to (n, 4) x, y, z, w quaternions in the same frame."""
    half = np.asarray(euler, dtype=np.float64).reshape(-1, 3) / 2
    (cx, cy, cz), (sx, sy, sz) = np.cos(half).T, np.sin(half).T
    x = sx * cy * cz - cx * sy * sz
    y = cx * sy * cz + sx * cy * sz
    z = cx * cy * sz - sx * sy * cz
    w = cx * cy * cz + sx * sy * sz
    quaternion = np.column_stack([x, y, z, w])
    length = np.linalg.norm(quaternion, axis=1, keepdims=True)
    return np.asarray(quaternion / np.maximum(length, 1e-12), np.float64)


def y_up_quaternions(euler: ArrayLike) -> NDArray[np.float32]:
    """Turn (n, 3) XYZ Euler angles in the scene frame to (n, 4) x, y, z, w quaternions, y up."""
    x, y, z, w = quaternions(euler).T
    return np.column_stack([x, z, -y, w]).astype(np.float32)


def tint_groups(tint: ArrayLike, most: int = 8) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Reduce colours to at most `most` by cutting the widest box at its median.

    glTF instances carry no colour of their own that viewers heed, so each colour is a mesh node.

    Parameters
    ----------
    tint
        (n, 3) linear RGB.

    Returns
    -------
    group
        (n,) the colour of each row.
    color
        (g, 3) mean colour of each group.
    """
    steps = np.round(np.clip(np.nan_to_num(np.asarray(tint, np.float64), nan=1.0), 0, 1) * 255)
    packed = steps.reshape(-1, 3).astype(np.int64) @ [1 << 16, 1 << 8, 1]
    packed, inverse, counts = np.unique(packed, return_inverse=True, return_counts=True)
    colors = packed[:, None] >> [16, 8, 0] & 255
    boxes = [np.arange(len(colors))]
    spans = [np.ptp(colors, axis=0).tolist()]
    while len(boxes) < min(most, len(colors)):
        widest = max(range(len(boxes)), key=lambda number: max(spans[number]))
        box, span = boxes.pop(widest), spans.pop(widest)
        box = box[np.argsort(colors[box, span.index(max(span))], kind="stable")]
        middle = np.cumsum(counts[box]) - counts[box] / 2
        cut = int(np.clip(np.searchsorted(middle, counts[box].sum() / 2), 1, len(box) - 1))
        boxes += [box[:cut], box[cut:]]
        spans += [np.ptp(colors[part], axis=0).tolist() for part in boxes[-2:]]
    group = np.zeros(len(colors), np.int64)
    for number, box in enumerate(boxes):
        group[box] = number
    share = np.equal.outer(np.arange(len(boxes)), group) * counts  # (g, colors)
    means = share @ colors / share.sum(axis=1, keepdims=True) / 255
    return group[inverse], means.astype(np.float32)


def id_words(ids: ArrayLike) -> NDArray[np.uint16]:
    """(n, 4) the ids in 16-bit words, lowest first: the widest integers glTF lets through."""
    return np.asarray(ids, dtype="<u8").reshape(-1, 1).view("<u2").astype(np.uint16)


def illuminance_of(environment: Environment) -> float:
    """Return the illuminance of a surface that faces the sun, lux; 0 when it is down or hidden."""
    height = degrees(environment.sun_elevation)
    if height <= 0:
        return 0.0
    # Thickness of the air towards the sun, after Kasten and Young 1989.
    air = 1 / (sin(environment.sun_elevation) + 0.50572 * (height + 6.07995) ** -1.6364)
    return SOLAR_LUX * exp(-CLEAR_AIR * air) * (1 - environment.cloud_cover) ** 2


def sun_light(environment: Environment) -> dict[str, Any]:
    """Return the light as an item of the extension's list."""
    low = max(0.0, 1 - degrees(environment.sun_elevation) / 20.0)
    color = [round(a * (1 - low) + b * low, 4) for a, b in zip(_NOON, _LOW, strict=True)]
    lux = illuminance_of(environment)
    return {
        "name": "sun",
        "type": "directional",
        "color": color,
        "intensity": round(lux * LUX_TO_INTENSITY, 4),
        "extras": {"illuminance_lux": round(lux, 1)},
    }


def sun_rotation(environment: Environment) -> list[float]:
    """Return the quaternion (x, y, z, w) of a node, y up, that shines along its own -z."""
    half_turn = (pi - environment.sun_azimuth) / 2
    half_lift = environment.sun_elevation / 2
    sy, cy, sx, cx = sin(half_turn), cos(half_turn), sin(half_lift), cos(half_lift)
    return [round(value, 7) for value in (-cy * sx, sy * cx, sy * sx, cy * cx)]
