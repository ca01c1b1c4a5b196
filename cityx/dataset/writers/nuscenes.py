"""Tables and files laid out as those of nuScenes: a sequence is a scene, a moment a sample.

The ego frame is the middle of the rig, level: x ahead, y left, z up. Cameras have x right, y down,
z ahead; the LiDAR has x right, y ahead, z up. Quaternions have w first. Boxes are in the frame of
the city; those of one object in several cameras are one annotation.

References
----------
Caesar et al., "nuScenes: a multimodal dataset for autonomous driving", CVPR 2020;
https://github.com/nutonomy/nuscenes-devkit/blob/master/docs/schema_nuscenes.md
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from cityx.city.camera import intrinsics
from cityx.dataset.record import Record
from cityx.dataset.writers.files import Files, stream_list
from cityx.dataset.writers.format import Format, Kept, Part, Place, Whole, picture_of
from cityx.dataset.writers.poses import (
    Matrix,
    camera_to_world,
    inverse,
    lidar_to_world,
    pose,
    quaternion,
    turned,
)
from cityx.ids import id_text

if TYPE_CHECKING:
    from cityx.city.store import View
    from cityx.dataset.classes import Class

TABLES = "nuscenes/v1.0-cityx"
Row = dict[str, Any]
# nuScenes' name of a class of ours; others keep their own below "cityx".
CATEGORIES = {
    "car": "vehicle.car", "truck": "vehicle.truck", "bus": "vehicle.bus.rigid",
    "bicycle": "vehicle.bicycle", "motorcycle": "vehicle.motorcycle",
    "pedestrian": "human.pedestrian.adult", "traffic_cone": "movable_object.trafficcone",
    "bicycle_parking": "static_object.bicycle_rack",
}  # fmt: skip
VISIBILITY = (("1", "v0-40", 0.4), ("2", "v40-60", 0.6), ("3", "v60-80", 0.8), ("4", "v80-100", 1))
FRONT = ("front", "mono", "left")  # the camera that says where ahead is, the first there is
MIDDLE = 0.5  # pixels from their corner, as CityX counts, to their middle, as nuScenes does
MAP_METRES = 0.1  # of a pixel of the map of where vehicles drive, as the devkit expects
MOST_MAP = 20_000  # pixels of a side of that map
# Columns are the axes of nuScenes' LiDAR (right, ahead, up) in those of ours (ahead, left, up).
LIDAR_AXES = turned(-np.pi / 2)


def _shot(record: Record, place: Place, classes: Sequence[Class], files: Files) -> Part:
    shot = record.shot
    channel = "CAM_" + ("FRONT" if shot.sensor == "mono" else shot.sensor.upper())
    name = f"samples/{channel}/{place.city}__{shot.name}.png"
    files.picture(f"nuscenes/{name}", picture_of(record))
    k = intrinsics(shot.camera)
    k[:2, 2] -= MIDDLE
    found: Row = {
        "sequence": shot.sequence, "sensor": shot.sensor, "channel": channel, "file": name,
        "moment": shot.moment, "intrinsics": k.tolist(),
        "size": [shot.camera.width, shot.camera.height],
        "pose": camera_to_world(shot.camera).tolist(), "boxes": [],
    }  # fmt: skip
    hits: Mapping[int, int] = {}
    if record.sweep is not None:
        sweep = record.sweep
        cloud = np.column_stack([sweep.points @ LIDAR_AXES, sweep.intensity * 255, sweep.beam])
        found["sweep"] = f"samples/LIDAR_TOP/{place.city}__{shot.name}.pcd.bin"
        files.data(f"nuscenes/{found['sweep']}", cloud.astype("<f4").tobytes())
        matrix = lidar_to_world(shot.camera) @ pose(LIDAR_AXES, (0.0, 0.0, 0.0))
        found["sweep_pose"] = matrix.tolist()
        ids, counts = np.unique(sweep.object_id, return_counts=True)
        hits = dict(zip(ids.tolist(), counts.tolist(), strict=True))
    if record.boxes is not None:
        things = {held.number for held in classes if held.thing}
        boxes = record.boxes
        found["boxes"] = [
            {
                "id": id_text(int(boxes.object_id[row])), "class": int(boxes.semantic[row]),
                "centre": boxes.centre[row].tolist(), "size": boxes.size[row].tolist(),
                "heading": float(boxes.heading[row]), "seen": float(boxes.visibility[row]),
                "hits": hits.get(int(boxes.object_id[row]), 0),
            }
            for row in range(boxes.count)
            if int(boxes.semantic[row]) in things
        ]  # fmt: skip
    return found


def token(*parts: object) -> str:
    """Return the token of an identity, 32 hexadecimal digits."""
    return blake2b("\x1f".join(map(str, parts)).encode(), digest_size=16).hexdigest()


@dataclass(frozen=True)
class _Sample:
    """The cameras of one moment."""

    token: str
    cameras: tuple[Kept, ...]

    @cached_property
    def time(self) -> int:
        return round(float(self.cameras[0].part["moment"]) * 1_000_000)

    @cached_property
    def ego(self) -> Matrix:
        poses = {kept.part["sensor"]: np.array(kept.part["pose"]) for kept in self.cameras}
        ahead = next((poses[name] for name in FRONT if name in poses), next(iter(poses.values())))
        heading = np.arctan2(ahead[1, 2], ahead[0, 2])
        middle = np.mean([matrix[:3, 3] for matrix in poses.values()], axis=0)
        return pose(turned(float(heading)), middle)

    def data(self) -> Iterator[tuple[str, Row, Row]]:
        """Yield the channel, the calibrated sensor and the file of every sensor."""
        for kept in self.cameras:
            part = kept.part
            yield self._datum(part["channel"], part["pose"], part["intrinsics"], part["file"],
                              "png", part["size"])  # fmt: skip
            if "sweep" in part:
                yield self._datum("LIDAR_TOP", part["sweep_pose"], [], part["sweep"], "pcd",
                                  (0, 0))  # fmt: skip

    def _datum(
        self, channel: str, matrix: Any, k: Any, name: str, kind: str, size: Sequence[int]
    ) -> tuple[str, Row, Row]:
        mounted = inverse(self.ego) @ np.array(matrix)
        sensor: Row = {
            "sensor_token": token("sensor", channel),
            "translation": (np.round(mounted[:3, 3], 6) + 0.0).tolist(),
            "rotation": (np.round(quaternion(mounted[:3, :3]), 9) + 0.0).tolist(),
            "camera_intrinsic": k,
        }  # fmt: skip
        sensor = {"token": token("calibrated", json.dumps(sensor)), **sensor}
        datum: Row = {
            "token": token("data", self.token, channel), "sample_token": self.token,
            "ego_pose_token": token("ego", self.token), "calibrated_sensor_token": sensor["token"],
            "timestamp": self.time, "fileformat": kind, "is_key_frame": True,
            "height": size[1], "width": size[0], "filename": name,
        }  # fmt: skip
        return channel, sensor, datum

    def annotations(self) -> dict[str, Row]:
        """Return what is annotated by the id of the object."""
        found: dict[str, Row] = {}
        for kept in self.cameras:
            for box in kept.part["boxes"]:
                known = found.setdefault(box["id"], dict(box))
                known["seen"] = max(known["seen"], box["seen"])
                known["hits"] = max(known["hits"], box["hits"])
        return dict(sorted(found.items()))


@dataclass(frozen=True)
class _Scene:
    """A sequence of a city with its samples."""

    token: str
    city: str
    name: str
    samples: tuple[_Sample, ...]


def _scenes(parts: Iterator[Kept]) -> Iterator[_Scene]:
    for (city, sequence), kept in groupby(parts, lambda k: (k.place.city, k.part["sequence"])):
        samples = tuple(
            _Sample(token("sample", city, sequence, moment), tuple(cameras))
            for moment, cameras in groupby(kept, lambda k: k.place.moment)
        )
        yield _Scene(token("scene", city, sequence), city, f"{city} {sequence}", samples)


def _linked(rows: Sequence[Row]) -> Sequence[Row]:
    """Chain rows by their tokens: "prev" and "next" are empty at the ends."""
    for index, row in enumerate(rows):
        row["prev"] = rows[index - 1]["token"] if index else ""
        row["next"] = rows[index + 1]["token"] if index + 1 < len(rows) else ""
    return rows


def _scene_rows(whole: Whole) -> Iterator[Row]:
    for scene in _scenes(whole.parts()):
        yield {
            "token": scene.token, "log_token": token("log", scene.city),
            "nbr_samples": len(scene.samples), "first_sample_token": scene.samples[0].token,
            "last_sample_token": scene.samples[-1].token, "name": scene.name,
            "description": "made with CityX",
        }  # fmt: skip


def _sample_rows(whole: Whole) -> Iterator[Row]:
    for scene in _scenes(whole.parts()):
        yield from _linked([
            {"token": s.token, "timestamp": s.time, "scene_token": scene.token}
            for s in scene.samples
        ])  # fmt: skip


def _ego_rows(whole: Whole) -> Iterator[Row]:
    for scene in _scenes(whole.parts()):
        for sample in scene.samples:
            yield {
                "token": token("ego", sample.token), "timestamp": sample.time,
                "rotation": quaternion(sample.ego[:3, :3]),
                "translation": sample.ego[:3, 3].tolist(),
            }  # fmt: skip


def _data_rows(whole: Whole) -> Iterator[Row]:
    for scene in _scenes(whole.parts()):
        by_channel: dict[str, list[Row]] = {}
        for sample in scene.samples:
            for channel, _, datum in sample.data():
                by_channel.setdefault(channel, []).append(datum)
        for rows in by_channel.values():
            yield from _linked(rows)


def _sensor_rows(whole: Whole) -> Iterator[Row]:
    seen = set()
    for scene in _scenes(whole.parts()):
        for sample in scene.samples:
            for _, sensor, _ in sample.data():
                if sensor["token"] not in seen:
                    seen.add(sensor["token"])
                    yield sensor


def _annotation_rows(whole: Whole) -> Iterator[Row]:
    for scene in _scenes(whole.parts()):
        for instance, rows in _annotated(scene).items():
            yield from _linked([
                {
                    "token": token("annotation", sample.token, box["id"]),
                    "sample_token": sample.token, "instance_token": instance,
                    "visibility_token": _visible(box["seen"]),
                    "attribute_tokens": [], "translation": box["centre"],
                    "size": [box["size"][1], box["size"][0], box["size"][2]],
                    "rotation": quaternion(turned(box["heading"])),
                    "num_lidar_pts": box["hits"], "num_radar_pts": 0,
                }
                for sample, box in rows
            ])  # fmt: skip


def _visible(share: float) -> str:
    return next((key for key, _, most in VISIBILITY if share <= most), VISIBILITY[-1][0])


def _annotated(scene: _Scene) -> dict[str, list[tuple[_Sample, Row]]]:
    found: dict[str, list[tuple[_Sample, Row]]] = {}
    for sample in scene.samples:
        for key, box in sample.annotations().items():
            found.setdefault(token("instance", scene.token, key), []).append((sample, box))
    return found


def _instance_rows(whole: Whole) -> Iterator[Row]:
    for scene in _scenes(whole.parts()):
        for instance, rows in _annotated(scene).items():
            tokens = [token("annotation", sample.token, box["id"]) for sample, box in rows]
            yield {
                "token": instance, "category_token": token("category", rows[0][1]["class"]),
                "nbr_annotations": len(rows), "first_annotation_token": tokens[0],
                "last_annotation_token": tokens[-1], "object_id": rows[0][1]["id"],
            }  # fmt: skip


def _category_rows(whole: Whole) -> Iterator[Row]:
    for held in whole.classes:
        if held.thing:
            name = CATEGORIES.get(held.name, f"cityx.{held.name}")
            yield {"token": token("category", held.number), "name": name,
                   "description": f"class {held.name} of CityX", "index": held.number}  # fmt: skip


def _channel_rows(whole: Whole) -> Iterator[Row]:
    channels: set[str] = set()
    for kept in whole.parts():
        channels |= {kept.part["channel"], *(["LIDAR_TOP"] if "sweep" in kept.part else [])}
    for channel in sorted(channels):
        kind = "lidar" if channel == "LIDAR_TOP" else "camera"
        yield {"token": token("sensor", channel), "channel": channel, "modality": kind}


def _log_rows(whole: Whole) -> Iterator[Row]:
    for city in whole.cities:
        yield {"token": token("log", city), "logfile": city, "vehicle": "cityx",
               "date_captured": "", "location": city}  # fmt: skip


def _map_rows(whole: Whole) -> Iterator[Row]:
    for city in whole.cities:
        yield {"token": token("map", city), "log_tokens": [token("log", city)],
               "category": "semantic_prior", "filename": f"maps/{city}.png"}  # fmt: skip


def _visibility_rows(_: Whole) -> Iterator[Row]:
    for key, level, most in VISIBILITY:
        yield {"token": key, "level": level, "description": f"visible up to {most * 100:.0f} %"}


_TABLES: Mapping[str, Callable[[Whole], Iterator[Row]]] = {
    "scene": _scene_rows, "sample": _sample_rows, "sample_data": _data_rows,
    "ego_pose": _ego_rows, "calibrated_sensor": _sensor_rows, "sensor": _channel_rows,
    "sample_annotation": _annotation_rows, "instance": _instance_rows,
    "category": _category_rows, "attribute": lambda _: iter(()), "visibility": _visibility_rows,
    "log": _log_rows, "map": _map_rows,
}  # fmt: skip


def _finish(whole: Whole, files: Files) -> None:
    for name, rows in _TABLES.items():
        with files.file(f"{TABLES}/{name}.json") as path:
            stream_list(path, rows(whole))


def _city(view: View, name: str, files: Files) -> None:
    """Write the map of where vehicles drive: white on black, from the middle of the streets."""
    from PIL import Image, ImageDraw

    xmin, ymin, xmax, ymax = view.extent
    metres = max(MAP_METRES, max(xmax - xmin, ymax - ymin) / MOST_MAP)
    size = (int((xmax - xmin) / metres) + 1, int((ymax - ymin) / metres) + 1)
    picture = Image.new("L", size)
    pen = ImageDraw.Draw(picture)
    network = view.network
    for edge in range(network.edge_count if network is not None else 0):
        assert network is not None
        points = (network.edge_points(edge) - (xmin, ymax)) * (1 / metres, -1 / metres)
        width = 2 * float(network.half_width[edge]) / metres
        pen.line([tuple(point) for point in points.tolist()], 255, round(width), joint="curve")
    files.picture(f"nuscenes/maps/{name}.png", np.asarray(picture))


NUSCENES = Format("nuscenes", "tables of scenes, samples, poses and annotations", _shot, _finish,
                  _city, boxes=True)  # fmt: skip
