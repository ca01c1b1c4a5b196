"""Small pictures of the channels of a shot, as people look at them on the page."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.dataset.record import Record, Sweep
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import Place, picture_of
from cityx.ids import hash_ids

if TYPE_CHECKING:
    from cityx.dataset.classes import Class

Pixels = NDArray[np.uint8]
WIDTH = 320  # pixels of a panel
NEAREST, FARTHEST = 1.0, 500.0  # metres, the ends of the colours of depth
# Viridis at even steps: even to the eye, and in grey too.
_VIRIDIS = np.array([
    (68, 1, 84), (72, 40, 120), (62, 74, 137), (49, 104, 142), (38, 130, 142), (31, 158, 137),
    (53, 183, 121), (110, 206, 88), (181, 222, 43), (253, 231, 37),
], float)  # fmt: skip
SKY = (222, 232, 240)
BOX_ALPHA = 0.45  # of the picture under the frames of boxes
AROUND = 60.0  # metres about a LiDAR that its panel shows
FOLDER = ".work/panels"
MEANING = {
    "depth": f"{NEAREST:g} m violet to {FARTHEST:g} m yellow, sky pale",
    "normal": "east red, north green, up blue",
    "lidar": f"from above, {AROUND:g} m around, by class",
}


def panels(record: Record, classes: Sequence[Class]) -> dict[str, Pixels]:
    """Return a picture per channel that has one to show, (h, w, 3), by the channel's name."""
    channels = record.channels
    found: dict[str, Pixels] = {}
    if "rgb" in channels:
        found["rgb"] = picture_of(record)
    if "depth" in channels:
        found["depth"] = depth_colours(channels["depth"])
    if "normal" in channels:
        found["normal"] = normal_colours(channels["normal"])
    if "semantic" in channels:
        found["semantic"] = class_colours(channels["semantic"], classes)
    if "instance" in channels:
        found["instance"] = id_colours(channels["instance"])
    elif "panoptic" in channels:
        found["panoptic"] = id_colours(channels["panoptic"].astype(np.uint64))
    if record.boxes is not None:
        found["boxes"] = _boxes(record, classes, found)
    if record.sweep is not None:
        found["lidar"] = _sweep(record.sweep, classes, record.shot.camera.height)
    return found


def _boxes(record: Record, classes: Sequence[Class], made: Mapping[str, Pixels]) -> Pixels:
    """Return the picture, or its normals, faded under the frames of the visible boxes."""
    from PIL import Image, ImageDraw

    boxes, camera = record.boxes, record.shot.camera
    assert boxes is not None
    under = made.get("rgb", made.get("normal"))
    if under is None:
        under = np.full((camera.height, camera.width, 3), SKY, np.uint8)
    faded = Image.fromarray(np.asarray(255 - (255 - under) * BOX_ALPHA, np.uint8))
    pen = ImageDraw.Draw(faded)
    width = max(1, round(camera.width / WIDTH))
    for row in range(boxes.count):
        color = classes[int(boxes.semantic[row])].color
        pen.rectangle([*boxes.seen[row, :2], *(boxes.seen[row, 2:] - 1)], None, color, width)
    return np.asarray(faded)


def _sweep(sweep: Sweep, classes: Sequence[Class], size: int) -> Pixels:
    """Return the points of a sweep from above, ahead upwards, in the colours of their classes."""
    found = np.full((size, size, 3), 255, np.uint8)
    spots = (size * (0.5 - sweep.points[:, 1::-1] / (2 * AROUND))).astype(int)  # across, down
    inside = ((spots >= 0) & (spots < size)).all(axis=1)
    table = np.array([held.color for held in classes], np.uint8)
    found[spots[inside, 1], spots[inside, 0]] = table[sweep.semantic[inside]]
    return found


def depth_colours(depth: NDArray[np.float32]) -> Pixels:
    """Return depth in colours by its logarithm: violet is near, yellow far, pale the sky."""
    with np.errstate(divide="ignore"):
        share = np.log(np.maximum(depth, 1e-6) / NEAREST) / np.log(FARTHEST / NEAREST)
    spot = np.clip(np.nan_to_num(share, posinf=1.0), 0, 1) * (len(_VIRIDIS) - 1)
    steps = np.arange(len(_VIRIDIS))
    found = np.stack([np.interp(spot, steps, _VIRIDIS[:, axis]) for axis in range(3)], axis=-1)
    found[~np.isfinite(depth)] = SKY
    return np.asarray(np.rint(found), np.uint8)


def normal_colours(normal: NDArray[np.float32]) -> Pixels:
    """Return normals as colours: east in red, north in green, up in blue."""
    found = np.rint((normal * 0.5 + 0.5) * 255)
    found[~normal.any(axis=-1)] = SKY
    return np.asarray(found, np.uint8)


def class_colours(semantic: NDArray[np.uint8], classes: Sequence[Class]) -> Pixels:
    """Return classes in the colours of their table."""
    table = np.zeros((256, 3), np.uint8)
    for held in classes:
        table[held.number] = held.color
    found: Pixels = table[semantic]
    return found


def id_colours(ids: NDArray[np.uint64]) -> Pixels:
    """Return ids in colours of their own, drawn from the id; 0 is pale."""
    unique, where = np.unique(ids, return_inverse=True)
    bits = hash_ids(0, "panel", unique)
    hue = (bits >> np.uint64(40)).astype(float) / 2**24
    value = 0.55 + 0.4 * (bits & np.uint64(255)).astype(float) / 255
    wheel = np.abs((hue[:, None] * 6 - np.array([3.0, 2.0, 4.0])) % 6 - 3) - 1
    table = np.rint(255 * value[:, None] * (0.4 + 0.6 * np.clip(wheel, 0, 1))).astype(np.uint8)
    table[unique == 0] = SKY
    found: Pixels = table[where.reshape(ids.shape)]
    return found


def write_panels(record: Record, place: Place, classes: Sequence[Class], files: Files) -> None:
    """Write the panels of a shot that the page shows, small."""
    for name, pixels in panels(record, classes).items():
        smooth = name in ("rgb", "depth", "normal", "boxes")
        files.data(f"{FOLDER}/{place.number:09d}.{name}", _small(pixels, smooth))


def _small(pixels: Pixels, smooth: bool) -> bytes:
    from PIL import Image

    height = max(1, round(WIDTH * pixels.shape[0] / pixels.shape[1]))
    way = Image.Resampling.BOX if smooth else Image.Resampling.NEAREST
    picture = Image.fromarray(pixels)
    if pixels.shape[1] > WIDTH:
        picture = picture.resize((WIDTH, height), way)
    buffer = io.BytesIO()
    options: dict[str, Any] = (
        {"format": "JPEG", "quality": 86} if smooth else {"format": "PNG", "optimize": True}
    )
    picture.save(buffer, **options)
    return buffer.getvalue()
