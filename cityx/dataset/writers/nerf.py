"""NeRF's transforms.json, one folder per city, as instant-ngp and nerfstudio read it.

Cameras have x right, y up, and look along -z (OpenGL); the world is the city's, z up.

References
----------
Mildenhall et al., "NeRF", ECCV 2020; https://docs.nerf.studio/quickstart/data_conventions.html
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from cityx.city.camera import intrinsics
from cityx.dataset.record import Record
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import Format, Part, Place, Whole, by_city, picture_of
from cityx.dataset.writers.poses import OPENGL, camera_to_world

if TYPE_CHECKING:
    from cityx.dataset.classes import Class


def _shot(record: Record, place: Place, classes: Sequence[Class], files: Files) -> Part:
    del classes
    camera = record.shot.camera
    name = f"images/{record.shot.name}.png"
    files.picture(f"nerf/{place.city}/{name}", picture_of(record))
    matrix = camera_to_world(camera)
    matrix[:3, :3] = matrix[:3, :3] @ OPENGL
    k = intrinsics(camera)
    lens = {
        "camera_angle_x": camera.hfov, "fl_x": k[0, 0], "fl_y": k[1, 1], "cx": k[0, 2],
        "cy": k[1, 2], "w": camera.width, "h": camera.height,
    }  # fmt: skip
    frame = {"file_path": name, "time": record.shot.moment, "transform_matrix": matrix.tolist()}
    return {"lens": lens, "frame": frame}


def _finish(whole: Whole, files: Files) -> None:
    for city, kept in by_city(whole.parts()):
        lens = kept[0].part["lens"]
        shared = all(item.part["lens"] == lens for item in kept)
        frames: list[dict[str, Any]] = [
            {**item.part["frame"], **({} if shared else item.part["lens"])} for item in kept
        ]
        content = {
            "camera_model": "OPENCV", **lens, "k1": 0.0, "k2": 0.0, "p1": 0.0, "p2": 0.0,
            "aabb_scale": 16, "frames": frames,
        }  # fmt: skip
        files.json(f"nerf/{city}/transforms.json", content)


NERF = Format("nerf", "transforms.json with poses", _shot, _finish)
