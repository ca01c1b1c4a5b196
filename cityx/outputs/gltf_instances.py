"""Rows of instances as glTF wants them: quaternions, and few colours."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


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
    colors, inverse, counts = np.unique(
        steps.reshape(-1, 3).astype(np.int64), axis=0, return_inverse=True, return_counts=True
    )
    boxes = [np.arange(len(colors))]
    while len(boxes) < min(most, len(colors)):
        widths = [np.ptp(colors[box], axis=0).max() for box in boxes]
        box = boxes.pop(int(np.argmax(widths)))
        axis = int(np.argmax(np.ptp(colors[box], axis=0)))
        box = box[np.argsort(colors[box, axis], kind="stable")]
        middle = np.cumsum(counts[box]) - counts[box] / 2
        cut = int(np.clip(np.searchsorted(middle, counts[box].sum() / 2), 1, len(box) - 1))
        boxes += [box[:cut], box[cut:]]
    group = np.zeros(len(colors), np.int64)
    means = np.zeros((len(boxes), 3))
    for number, box in enumerate(boxes):
        group[box] = number
        means[number] = np.average(colors[box], axis=0, weights=counts[box]) / 255
    return group[inverse.reshape(-1)], means.astype(np.float32)


def id_words(ids: ArrayLike) -> NDArray[np.uint16]:
    """(n, 4) the ids in 16-bit words, lowest first: the widest integers glTF lets through."""
    return np.asarray(ids, dtype="<u8").reshape(-1, 1).view("<u2").astype(np.uint16)
