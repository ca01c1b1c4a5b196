"""CityX's own format: per shot an EXR of all channels, a PNG of what people see, and a JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import Camera, intrinsics
from cityx.dataset.channels import CHANNELS
from cityx.dataset.record import Boxes, Record, Sweep
from cityx.dataset.shots import Shot
from cityx.dataset.writers.exr import write_exr
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import Format, Part, Place, picture_of
from cityx.dataset.writers.poses import camera_to_world, lidar_to_world
from cityx.ids import id_text
from cityx.outputs.cryptomatte import header

if TYPE_CHECKING:
    from cityx.dataset.classes import Class


MANIFESTS = "manifests"  # among the facts of a record: matte to its names


def _shot(record: Record, place: Place, classes: Sequence[Class], files: Files) -> Part:
    del classes
    stem = f"raw/{place.city}/{record.shot.name}"
    arrays = {name: record.channels[name] for name in CHANNELS if name in record.channels}
    if arrays:
        notes: dict[str, str] = {}
        for name, names in record.facts.get(MANIFESTS, {}).items():
            notes |= header(name, names)
        with files.file(f"{stem}.exr") as path:
            write_exr(path, arrays, notes)
    if "rgb" in record.channels:
        files.picture(f"{stem}.png", picture_of(record))
    if record.sweep is not None:
        with files.file(f"{stem}_lidar.npy") as path, path.open("wb") as file:
            np.save(file, table_of(record.sweep))
    files.json(f"{stem}.json", description(record, place))
    return {}


def description(record: Record, place: Place) -> dict[str, Any]:
    """Return all that is known of a shot but its pixels, as JSON."""
    shot = record.shot
    environment = None if shot.environment is None else asdict(shot.environment)
    found = {
        "city": place.city,
        **describe_shot(shot),
        "environment": environment,
        "facts": {key: value for key, value in record.facts.items() if key != MANIFESTS},
        "segments": [
            {"number": s.number, "id": id_text(s.object_id), "class": s.semantic,
             "pixels": s.pixels}
            for s in record.segments
        ],
    }  # fmt: skip
    if record.boxes is not None:
        found["boxes"] = boxes_json(record.boxes)
    if record.sweep is not None:
        found["lidar_to_world"] = lidar_to_world(shot.camera).tolist()
    return found


def describe_shot(shot: Shot) -> dict[str, Any]:
    """Return where and when a shot is taken, as JSON."""
    return {
        "shot": shot.name,
        "sequence": shot.sequence,
        "frame": shot.frame,
        "sensor": shot.sensor,
        "moment": shot.moment,
        "camera": describe_camera(shot.camera),
    }


def describe_camera(camera: Camera) -> dict[str, Any]:
    """Return a camera with its matrices: pixels of x right, y down; the camera looks along z."""
    return {
        "width": camera.width,
        "height": camera.height,
        "hfov": camera.hfov,
        "position": list(camera.position),
        "heading": camera.heading,
        "pitch": camera.pitch,
        "intrinsics": intrinsics(camera).tolist(),
        "camera_to_world": camera_to_world(camera).tolist(),
    }


def boxes_json(boxes: Boxes) -> list[dict[str, Any]]:
    """Return boxes as JSON, one object per box."""
    found = []
    for row in range(boxes.count):
        values = {key.name: getattr(boxes, key.name)[row].tolist() for key in fields(boxes)}
        values["id"] = id_text(values.pop("object_id"))
        values["class"] = values.pop("semantic")
        found.append(values)
    return found


def table_of(sweep: Sweep) -> NDArray[np.void]:
    """Return a sweep as one table of named columns."""
    columns: Mapping[str, NDArray[Any]] = {
        "x": sweep.points[:, 0], "y": sweep.points[:, 1], "z": sweep.points[:, 2],
        "beam": sweep.beam, "time": sweep.time, "object_id": sweep.object_id,
        "semantic": sweep.semantic, "intensity": sweep.intensity,
    }  # fmt: skip
    table = np.zeros(len(sweep.beam), [(key, value.dtype) for key, value in columns.items()])
    for key, value in columns.items():
        table[key] = value
    return table


RAW = Format(
    "raw", "EXR of every channel, PNG, JSON of camera, boxes and light", _shot, shows=False
)
