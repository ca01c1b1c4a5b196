"""KITTI's object benchmark: image_2 (and image_3), velodyne, label_2, calib.

Cameras look along z with x right and y down; the middle of the pixel at the upper left is (0, 0).
A label has the middle of the box's bottom in the axes of camera 2, and its turn about y, which is
that of a level camera: for one that looks up or down it is the turn of the box's heading as seen.

References
----------
Geiger, Lenz, Stiller, Urtasun, "Vision meets robotics: the KITTI dataset", IJRR 2013, and the
readme of the object development kit.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import Camera, axes, intrinsics
from cityx.dataset.record import Boxes, Record
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import Format, Kept, Part, Place, Whole, picture_of
from cityx.dataset.writers.poses import camera_to_world, inverse, lidar_to_world

if TYPE_CHECKING:
    from cityx.dataset.classes import Class

TRAINING = "kitti/training"
# Our classes that have a type of KITTI's; what else moves is Misc, what stands has no label.
TYPES = {
    "car": "Car", "truck": "Truck", "bus": "Misc", "tram": "Tram", "pedestrian": "Pedestrian",
    "rider": "Cyclist", "bicycle": "Misc", "motorcycle": "Misc", "vehicle": "Misc",
}  # fmt: skip
CLEAR, PARTLY = 0.9, 0.5  # visibility from which an object is "fully visible", "partly occluded"
MIDDLE = 0.5  # KITTI counts from the middle of the first pixel, CityX from its corner


def _shot(record: Record, place: Place, classes: Sequence[Class], files: Files) -> Part:
    shot = record.shot
    stem = f"{place.moment:06d}"
    right = shot.sensor == "right"
    folder = "image_3" if right else "image_2"
    files.picture(f"{TRAINING}/{folder}/{stem}.png", picture_of(record))
    if not right:
        boxes = record.boxes
        lines = [] if boxes is None else list(labels(shot.camera, boxes, classes))
        files.text(f"{TRAINING}/label_2/{stem}.txt", "".join(line + "\n" for line in lines))
        if record.sweep is not None:
            sweep = record.sweep
            cloud = np.column_stack([sweep.points, sweep.intensity]).astype("<f4")
            files.data(f"{TRAINING}/velodyne/{stem}.bin", cloud.tobytes())
    camera = shot.camera
    velodyne = inverse(camera_to_world(camera)) @ lidar_to_world(camera)
    return {
        "sensor": shot.sensor,
        "intrinsics": intrinsics(camera).tolist(),
        "pose": camera_to_world(camera).tolist(),
        "velodyne": velodyne.tolist(),
    }


def labels(camera: Camera, boxes: Boxes, classes: Sequence[Class]) -> Iterator[str]:
    """Yield the line of every box whose class has a type of KITTI's."""
    types = {held.number: TYPES[held.name] for held in classes if held.name in TYPES}
    to_camera = axes(camera)
    foot = boxes.centre - np.array([0.0, 0.0, 0.5]) * boxes.size
    places = (foot - np.array(camera.position)) @ to_camera.T
    along = np.column_stack([np.cos(boxes.heading), np.sin(boxes.heading), np.zeros(boxes.count)])
    ahead = along @ to_camera.T
    turn = np.arctan2(-ahead[:, 2], ahead[:, 0])
    alpha = _wrapped(turn - np.arctan2(places[:, 0], places[:, 2]))
    for row in range(boxes.count):
        name = types.get(int(boxes.semantic[row]))
        if name is None:
            continue
        seen = float(boxes.visibility[row])
        hidden = 0 if seen >= CLEAR else 1 if seen >= PARTLY else 2
        x0, y0, x1, y1 = boxes.full[row]
        length, width, height = boxes.size[row]
        numbers = (alpha[row], x0, y0, x1 - 1, y1 - 1, height, width, length,
                   *places[row], turn[row])  # fmt: skip
        words = " ".join(f"{number:.4f}" for number in numbers)
        yield f"{name} {boxes.truncation[row]:.2f} {hidden} {words}"


def _wrapped(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.remainder(angle + np.pi, 2 * np.pi) - np.pi)


def _finish(whole: Whole, files: Files) -> None:
    names = []
    for moment, items in groupby(whole.parts(), lambda kept: kept.place.moment):
        cameras = {kept.part["sensor"]: kept for kept in items}
        left = next((kept for sensor, kept in cameras.items() if sensor != "right"), None)
        if left is None:  # it could not be taken
            continue
        text = calibration(left, cameras.get("right"))
        files.text(f"{TRAINING}/calib/{moment:06d}.txt", text)
        names.append(f"{moment:06d} {left.place.city} {left.name}\n")
    files.text("kitti/names.txt", "".join(names))


def calibration(left: Kept, right: Kept | None) -> str:
    """Return the text of a file of calib: cameras 0 and 2 are the left one, 1 and 3 the right."""
    first = projection(left, left)
    second = first if right is None else projection(right, left)
    velodyne = np.array(left.part["velodyne"])[:3]
    rows = {
        "P0": first, "P1": second, "P2": first, "P3": second, "R0_rect": np.eye(3),
        "Tr_velo_to_cam": velodyne, "Tr_imu_to_velo": np.eye(4)[:3],
    }  # fmt: skip
    return "".join(
        f"{name}: {' '.join(f'{value:.12e}' for value in matrix.ravel())}\n"
        for name, matrix in rows.items()
    )


def projection(camera: Kept, reference: Kept) -> NDArray[np.float64]:
    """Return the (3, 4) matrix from the axes of the reference camera to pixels of another."""
    matrix = np.array(camera.part["intrinsics"])
    matrix[:2, 2] -= MIDDLE
    moved = inverse(np.array(camera.part["pose"])) @ np.array(reference.part["pose"])
    found: NDArray[np.float64] = matrix @ moved[:3]
    return found


KITTI = Format(
    "kitti", "image_2, velodyne, label_2, calib", _shot, _finish, boxes=True,
    sensors=frozenset({"mono", "left", "right"}),
)  # fmt: skip
