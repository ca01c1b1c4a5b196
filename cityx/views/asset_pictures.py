"""Pictures of assets: a few at a time on a plane, rendered by the Blender process."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from math import atan2, pi, radians, tan
from pathlib import Path

import numpy as np

from cityx.assets.library.models import Models, turns
from cityx.assets.library.store import Library, set_renders
from cityx.city.camera import Camera
from cityx.city.city import City
from cityx.city.rows import take_rows
from cityx.city.scene import Instances, Scene
from cityx.geometry.arrays import FloatArray
from cityx.ids import id_text, stable_id

TOGETHER = 24  # assets in one Blender process
APART = 400.0  # metres between assets, out of each other's shadows and pictures
FOV = radians(32)
TURN = radians(35)  # to the side of the front, so that depth shows
LOOK_DOWN = radians(14)
ROOM = 1.12  # of the picture about the asset

Say = Callable[[str], None]


def render_assets(
    library: Library,
    rows: Sequence[int],
    *,
    size: tuple[int, int] = (256, 256),
    samples: int = 16,
    say: Say = lambda _: None,
) -> tuple[Library, list[Path]]:
    """Render assets and note the pictures in the library.

    A picture takes one to a few seconds on a CPU, so pictures of 17,000 assets take a night.

    Parameters
    ----------
    library
        The library.
    rows
        Assets to render.
    size, samples
        Pixels, and samples per pixel.
    say
        Called with a line of progress at a time.

    Raises
    ------
    MissingDependency, EngineError
        If Blender is missing or fails.
    """
    from cityx.blender.client import BlenderJob, RenderRequest, run_worker
    from cityx.city.store import write_city

    done: list[str] = []
    for start in range(0, len(rows), TOGETHER):
        chunk = list(rows[start : start + TOGETHER])
        ids = library.catalogue["id"][chunk]
        names = [f"renders/{id_text(number)}.png" for number in ids.tolist()]
        city, cameras = studio(library, chunk, size)
        with tempfile.TemporaryDirectory(prefix="cityx-studio-") as folder:
            write_city(city, Path(folder) / "city")
            requests = tuple(
                RenderRequest(camera, library.folder / name, samples)
                for camera, name in zip(cameras, names, strict=True)
            )
            job = BlenderJob(Path(folder) / "city", renders=requests)
            run_worker(job, progress=lambda _, text: say(text))
        done += names
    return set_renders(library, rows, done), [library.folder / name for name in done]


def studio(
    library: Library, rows: Sequence[int], size: tuple[int, int]
) -> tuple[City, list[Camera]]:
    """Stand assets on a plane in a row, with a camera before each."""
    from cityx.city.frame import Frame
    from cityx.city.layout import Layout
    from cityx.city.mesh import concatenate, one_mesh

    models = library.models(rows)
    table = library.catalogue.take(np.asarray(rows, np.int64))
    count = len(rows)
    spot = np.column_stack([APART * np.arange(count), np.zeros(count), np.zeros(count)])
    centre = np.column_stack([table["x"], table["y"], np.zeros(count)])
    # Fronts face -y in the studio; compass angles turn clockwise.
    theta = table["front"] - pi
    scene = _placed(models, spot, centre, theta)
    plates = []
    for number in range(count):
        half = 0.42 * APART
        corners = np.array([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)])
        plates.append(
            one_mesh(number + 1, corners + spot[number], [(0, 1, 2, 3)],
                     materials=("asphalt_light",), uv=corners[None, :, :2])
        )  # fmt: skip
    scene = scene.with_mesh("ground", concatenate(plates))
    extent = (-APART, -APART, APART * count, APART)
    city = City("studio", Frame(50.0, 8.0), Layout(extent), scene=scene)
    cameras = [
        _camera(id_text(int(table["id"][i])), spot[i], table["length"][i], table["width"][i],
                table["height"][i], size)
        for i in range(count)
    ]  # fmt: skip
    return city, cameras


def _placed(models: Models, spot: FloatArray, centre: FloatArray, theta: FloatArray) -> Scene:
    count = models.count
    rotation = np.zeros((count, 3), np.float32)
    rotation[:, 2] = theta
    matrix = turns(rotation)
    shift = spot - np.einsum("nij,nj->ni", matrix, centre)
    ids = np.array([stable_id("studio", i) for i in range(count)], np.uint64)
    one = np.ones((count, 3), np.float32)
    shells = [models.prototype(i, f"asset_{i}") for i in range(count)]
    rows = Instances(np.arange(count, dtype=np.int32), ids, ids, shift, rotation, one, one)
    scene = Scene().with_instances("assets", shells, rows)
    owner = models.fittings.owner.astype(np.int64)
    position = np.einsum("nij,nj->ni", matrix[owner], models.fittings.position) + shift[owner]
    turn = models.fittings.rotation.copy()
    turn[:, 2] += rotation[owner, 2]
    number = np.array([stable_id("fitting", i) for i in range(len(owner))], np.uint64)
    moved = Instances(models.fittings.prototype, number, ids[owner], position, turn,
                      models.fittings.scale, models.fittings.tint)  # fmt: skip
    for index, layer in enumerate(models.layers):
        of = np.flatnonzero(models.layer == index)
        if len(of):
            scene = scene.with_instances(layer, models.prototypes, take_rows(moved, of))
    return scene


def _camera(
    name: str, spot: FloatArray, length: float, width: float, height: float, size: tuple[int, int]
) -> Camera:
    """Look at an asset from before its front and to the side, so that all of it is seen."""
    radius = float(np.hypot(np.hypot(length, width) / 2, height / 2))
    aspect = min(1.0, size[1] / size[0])
    distance = ROOM * radius / np.sin(np.arctan(tan(FOV / 2) * aspect))
    # South of the asset, turned to the east.
    away = distance * np.cos(LOOK_DOWN)
    x, y = away * np.sin(TURN), -away * np.cos(TURN)
    z = max(height / 2 + distance * np.sin(LOOK_DOWN), 0.3)
    heading = atan2(-x, -y)
    pitch = -atan2(z - height / 2, away)
    position = (float(spot[0] + x), float(spot[1] + y), float(z))
    return Camera(name, position, heading, pitch, FOV, size[0], size[1])
