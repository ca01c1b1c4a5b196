"""COLMAP's text model, one folder per city: cameras, images, and points from the depth.

A pose leads from the world to the camera (x right, y down, z ahead), its quaternion has w first;
the middle of the pixel at the upper left is (0.5, 0.5), as in CityX.

References
----------
https://colmap.github.io/format.html
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import intrinsics, rays
from cityx.dataset.record import Record
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import (
    Format,
    Kept,
    Part,
    Place,
    Whole,
    by_city,
    picture_of,
)
from cityx.dataset.writers.poses import camera_to_world, inverse, quaternion
from cityx.ids import stable_id, uniform

if TYPE_CHECKING:
    from cityx.dataset.classes import Class

POINTS = 256  # of each picture, spread over its pixels; enough to begin splats or fields with
FARTHEST = 500.0  # metres; what lies beyond is background


def _shot(record: Record, place: Place, classes: Sequence[Class], files: Files) -> Part:
    del classes
    shot = record.shot
    name = f"{shot.name}.png"
    picture = picture_of(record)
    files.picture(f"colmap/{place.city}/images/{name}", picture)
    pose = inverse(camera_to_world(shot.camera))
    k = intrinsics(shot.camera)
    lens = [shot.camera.width, shot.camera.height, k[0, 0], k[1, 1], k[0, 2], k[1, 2]]
    rows, columns = _chosen(record.channels["depth"], shot.name)
    directions = rays(shot.camera)[rows, columns]
    depth = record.channels["depth"][rows, columns].astype(np.float64)
    points = np.array(shot.camera.position) + directions * depth[:, None]
    return {
        "lens": lens,
        "pose": [*quaternion(pose[:3, :3]), *pose[:3, 3].tolist()],
        "name": name,
        "pixels": np.column_stack([columns + 0.5, rows + 0.5]).tolist(),
        "points": np.round(points, 4).tolist(),
        "colours": picture[rows, columns].tolist(),
    }


def _chosen(depth: NDArray[np.float32], name: str) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Choose pixels that are not sky, at places drawn from the name of the shot."""
    ids = np.arange(POINTS, dtype=np.uint64)
    key = stable_id(name)
    height, width = depth.shape
    rows = (uniform(key, "colmap row", ids) * height).astype(np.int64)
    columns = (uniform(key, "colmap column", ids) * width).astype(np.int64)
    near = depth[rows, columns] < FARTHEST
    return rows[near], columns[near]


def _finish(whole: Whole, files: Files) -> None:
    for city, kept in by_city(whole.parts()):
        folder = f"colmap/{city}/sparse/0"
        lenses = list(dict.fromkeys(tuple(item.part["lens"]) for item in kept))
        cameras = ["# CAMERA_ID, MODEL, WIDTH, HEIGHT, fx, fy, cx, cy\n"]
        for number, (width, height, *values) in enumerate(lenses, 1):
            words = " ".join(f"{value:.12g}" for value in values)
            cameras.append(f"{number} PINHOLE {int(width)} {int(height)} {words}\n")
        files.text(f"{folder}/cameras.txt", "".join(cameras))
        images, points = _rows(kept, lenses)
        files.text(f"{folder}/images.txt", images)
        files.text(f"{folder}/points3D.txt", points)


def _rows(kept: Sequence[Kept], lenses: Sequence[tuple[float, ...]]) -> tuple[str, str]:
    """Return the text of images.txt and of points3D.txt; each point is seen by its picture."""
    images = ["# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[]\n"]
    points = ["# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[]\n"]
    point = 0
    for number, item in enumerate(kept, 1):
        part = item.part
        pose = " ".join(f"{value:.17g}" for value in part["pose"])
        camera = lenses.index(tuple(part["lens"])) + 1
        images.append(f"{number} {pose} {camera} {part['name']}\n")
        spots = []
        for index, (pixel, spot, colour) in enumerate(
            zip(part["pixels"], part["points"], part["colours"], strict=True)
        ):
            point += 1
            spots.append(f"{pixel[0]:g} {pixel[1]:g} {point}")
            words = " ".join(f"{value:.4f}" for value in spot)
            points.append(f"{point} {words} {colour[0]} {colour[1]} {colour[2]} 0 "
                          f"{number} {index}\n")  # fmt: skip
        images.append(" ".join(spots) + "\n")
    return "".join(images), "".join(points)


COLMAP = Format("colmap", "cameras, images and points as text", _shot, _finish,
                channels=("depth",))  # fmt: skip
