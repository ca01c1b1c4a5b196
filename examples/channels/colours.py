"""How numbers of a picture are shown to people: scales, wheels and colours by hash."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from cityx.city.camera import Camera, axes, project
from cityx.dataset.classes import CLASSES
from cityx.dataset.record import Boxes, Sweep
from cityx.ids import hash_ids

Picture = NDArray[np.uint8]
FloatArray = NDArray[np.float64]
# Even steps of lightness from dark violet to yellow, so that equal steps look equal.
SCALE = np.array(
    [(68, 1, 84), (72, 40, 120), (62, 74, 137), (49, 104, 142), (38, 130, 142), (31, 158, 137),
     (53, 183, 121), (109, 205, 89), (180, 222, 44), (253, 231, 37)], float,
)  # fmt: skip
EMPTY = (24, 24, 28)
NEAR = 0.3  # metres before the eye at which the edges of boxes are cut


def scaled(values: FloatArray, low: float, high: float, *, log: bool = False) -> Picture:
    """Colour (h, w) values on the scale; what is not finite is empty."""
    known = np.isfinite(values)
    shown = np.where(known, values, low)
    if log:
        shown, low, high = np.log(np.maximum(shown, low)), np.log(low), np.log(high)
    at = np.clip((shown - low) / (high - low), 0, 1) * (len(SCALE) - 1)
    rows = np.arange(len(SCALE))
    made = np.stack([np.interp(at, rows, SCALE[:, part]) for part in range(3)], axis=-1)
    made[~known] = EMPTY
    return made.astype(np.uint8)


def directions(values: FloatArray) -> Picture:
    """Colour (h, w, 3) unit vectors: each axis from -1 to 1 is a primary; none is empty."""
    made = (values * 0.5 + 0.5) * 255
    made[(values == 0).all(axis=-1)] = EMPTY
    return made.astype(np.uint8)


def tiles(values: FloatArray, step: float) -> Picture:
    """Colour (h, w, 3) places: each axis repeats after `step` metres, up and down again."""
    turn = np.abs(np.remainder(values / step, 2.0) - 1.0)
    made = turn * 215 + 20
    made[(values == 0).all(axis=-1)] = EMPTY
    return made.astype(np.uint8)


def wheel(values: FloatArray, most: float) -> Picture:
    """Colour (h, w, 2) vectors: their direction is the hue, their length the strength."""
    size = np.clip(np.linalg.norm(values, axis=-1) / most, 0, 1) ** 0.7
    hue = (np.arctan2(values[..., 1], values[..., 0]) / (2 * np.pi)) % 1.0
    phase = np.abs((hue[..., None] * 6 + np.array([0.0, 4.0, 2.0])) % 6 - 3) - 1
    made = 1 - size[..., None] * (1 - np.clip(phase, 0, 1))
    return (made * 255).astype(np.uint8)


def hashed(ids: NDArray[np.uint64]) -> Picture:
    """Colour ids so that no two neighbours are likely to look alike; 0 is empty."""
    bits = hash_ids(0, "example/colour", ids)
    parts = [(bits >> np.uint64(shift) & np.uint64(0xFF)).astype(np.uint8) for shift in (8, 24, 40)]
    made = np.stack(parts, axis=-1) // 4 * 3 + 56
    made[ids == 0] = EMPTY
    return made


def classes(numbers: NDArray[np.uint8]) -> Picture:
    """Colour classes as their table does."""
    table = np.array([each.color for each in CLASSES], np.uint8)
    return table[numbers]


def shown(values: FloatArray, exposure: float = 0.0) -> Picture:
    """Show linear colour or light: exposed, rolled off, with the curve of a screen."""
    light = np.maximum(values, 0) * 2.0**exposure
    return (np.clip(light / (1 + 0.25 * light), 0, 1) ** (1 / 2.2) * 255).astype(np.uint8)


def matted(layers: NDArray[np.float32]) -> Picture:
    """Mix the colours of the first things of a matte by how much of a pixel each covers."""
    ids = np.ascontiguousarray(layers[..., 0::2]).view(np.uint32).astype(np.uint64)
    share = layers[..., 1::2, None]
    mixed = (hashed(ids) * share).sum(axis=-2) + np.array(EMPTY) * (1 - share.sum(axis=-2))
    return np.clip(mixed, 0, 255).astype(np.uint8)


def with_boxes(picture: Picture, camera: Camera, boxes: Boxes, least: int) -> Picture:
    """Draw the boxes of things of at least so many pixels: flat ones thin, solid ones bright."""
    page = Image.fromarray(picture // 2 + 20)
    draw = ImageDraw.Draw(page)
    spots = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    edges = [(a, b) for a in range(8) for b in range(a) if bin(a ^ b).count("1") == 1]
    for row in np.flatnonzero(boxes.pixels >= least).tolist():
        color = CLASSES[boxes.semantic[row]].color
        bright = tuple(min(255, 90 + part) for part in color)
        draw.rectangle([float(v) for v in boxes.seen[row]], outline=color)
        cos, sin = np.cos(boxes.heading[row]), np.sin(boxes.heading[row])
        local = np.array(spots) * boxes.size[row]
        turned = local @ np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])
        _frame(draw, camera, turned + boxes.centre[row], edges, bright)
    return np.asarray(page)


def _frame(
    draw: ImageDraw.ImageDraw, camera: Camera, corners: FloatArray, edges: list[tuple[int, int]],
    color: tuple[int, ...],
) -> None:  # fmt: skip
    ahead, eye = axes(camera)[2], np.array(camera.position)
    depth = (corners - eye) @ ahead
    for a, b in edges:
        near, far = (a, b) if depth[a] < depth[b] else (b, a)
        if depth[far] <= NEAR:
            continue
        start = corners[near]
        if depth[near] < NEAR:
            share = (NEAR - depth[near]) / (depth[far] - depth[near])
            start = start + share * (corners[far] - corners[near])
        ends, _ = project(camera, np.array([start, corners[far]]))
        draw.line([tuple(end) for end in ends.tolist()], fill=color)


def points(sweep: Sweep, eye: Camera, ways: FloatArray, place: FloatArray) -> Picture:
    """Show the points of a sweep in the colours of their classes, seen by another eye.

    Parameters
    ----------
    sweep
        The points, in the frame of the sensor.
    eye
        What looks at them.
    ways, place
        Axes (3, 3) and place (3,) of the sensor in the city.
    """
    there = sweep.points @ ways + place
    spots, depth = project(eye, there)
    page = np.full((eye.height, eye.width, 3), EMPTY, np.uint8)
    order = np.argsort(-depth)
    column, line = np.floor(spots[order]).astype(int).T
    inside = (depth[order] > 0) & (column >= 0) & (column < eye.width - 1)
    inside &= (line >= 0) & (line < eye.height - 1)
    color = classes(sweep.semantic[order]).astype(float) * 0.8 + 51
    for right, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
        page[line[inside] + down, column[inside] + right] = color[inside]
    return page
