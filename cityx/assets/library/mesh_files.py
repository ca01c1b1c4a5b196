"""Mesh files as plain arrays: .glb, .gltf, .obj through trimesh, others through Blender."""

from __future__ import annotations

import json
import tempfile
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.library.hostile import (
    MAX_BYTES,
    MAX_TRIANGLES,
    Refused,
    check_gltf,
    check_obj,
    check_triangles,
    inside,
)
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.system.blender_process import run_module

GREY = (0.5, 0.5, 0.5)
PIXELS = 64_000_000  # of a texture; larger ones are not opened for their mean colour
# y up and z towards the viewer become z up and -y towards the viewer.
Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
MODULE = "cityx.blender.asset_files"


@dataclass(frozen=True)
class RawMesh:
    """An asset as a file holds it, z up, metres as far as the file says so.

    Attributes
    ----------
    name
        Of the collection in the file, or of the file.
    vertices, triangles
        (n, 3) float and (t, 3) int.
    part
        (t,) which of `parts` each triangle belongs to.
    parts
        Names of materials and objects.
    colors
        (p, 3) linear RGB of each part.
    metric
        Whether the file says that its unit is the metre.
    """

    name: str
    vertices: FloatArray
    triangles: IntArray
    part: IntArray
    parts: tuple[str, ...]
    colors: FloatArray
    metric: bool


class _Folder:
    """Opens what a file refers to, within the folder alone; trimesh asks it for every name."""

    def __init__(self, path: Path, root: Path) -> None:
        self.path, self.root = path, root

    def get(self, name: str) -> bytes:
        """Return the bytes of a file."""
        target = inside(name, self.path, self.root)
        if not target.is_file() or target.stat().st_size > MAX_BYTES:
            raise FileNotFoundError(name)
        return target.read_bytes()

    def __getitem__(self, name: str) -> bytes:
        """Return the bytes of a file."""
        return self.get(name)

    def namespaced(self, namespace: str) -> _Folder:
        """Return itself: names stay relative to the file."""
        del namespace
        return self


def read_mesh_file(path: Path, root: Path, *, up: str = "y") -> RawMesh:
    """Read a .glb, .gltf or .obj file.

    Parameters
    ----------
    path
        The file, which has passed `check_size`.
    root
        Folder that nothing it refers to may leave.
    up
        Axis that points up in an .obj, "y" or "z"; glTF says "y".

    Raises
    ------
    Refused
        If it is broken, too much, or refers to what is not in the folder.
    """
    import trimesh

    suffix = path.suffix.lower()
    is_obj = suffix == ".obj"
    if is_obj:
        check_obj(path, root)
    else:
        check_gltf(path, root)
    try:
        with warnings.catch_warnings(), path.open("rb") as file:
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(
                file, file_type=suffix[1:], resolver=_Folder(path, root), process=False
            )
            raw = _flattened(scene, path.stem, metric=not is_obj)
    except Refused:
        raise
    except Exception as error:  # a parser of foreign files may raise anything
        raise Refused(f"it is broken: {type(error).__name__}: {_short(error)}") from error
    if up == "y" or not is_obj:
        raw = RawMesh(raw.name, raw.vertices @ Z_UP.T, raw.triangles, raw.part, raw.parts,
                      raw.colors, raw.metric)  # fmt: skip
    return raw


def _short(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text[:120] or "no reason given"


def _flattened(scene: Any, name: str, *, metric: bool) -> RawMesh:
    """Put every placed mesh of a scene into one set of arrays."""
    vertices: list[NDArray[Any]] = []
    triangles: list[NDArray[Any]] = []
    part: list[NDArray[Any]] = []
    parts: list[str] = []
    colors: list[tuple[float, float, float]] = []
    count = total = 0
    for node in sorted(scene.graph.nodes_geometry):
        matrix, key = scene.graph[node]
        mesh = scene.geometry[key]
        faces = np.asarray(getattr(mesh, "faces", np.zeros((0, 3))), np.int64)
        if not len(faces):
            continue
        total += len(faces)
        check_triangles(total)
        points = np.asarray(mesh.vertices, np.float64)
        if faces.min() < 0 or faces.max() >= len(points):
            raise Refused("it is broken: a face names a vertex that is not there")
        points = points @ np.asarray(matrix)[:3, :3].T + np.asarray(matrix)[:3, 3]
        if np.linalg.det(np.asarray(matrix)[:3, :3]) < 0:
            faces = faces[:, ::-1]
        vertices.append(points)
        triangles.append(faces + count)
        part.append(np.full(len(faces), len(parts)))
        label, color = _surface(mesh)
        parts.append(f"{node} {label}".strip())
        colors.append(color)
        count += len(points)
    if not triangles:
        raise Refused("it holds no geometry")
    return RawMesh(
        name, np.concatenate(vertices), np.concatenate(triangles), np.concatenate(part),
        tuple(parts), np.array(colors, float), metric,
    )  # fmt: skip


def _surface(mesh: Any) -> tuple[str, tuple[float, float, float]]:
    """Name of a mesh's material, and its mean colour, linear."""
    material = getattr(mesh.visual, "material", None)
    label = str(getattr(material, "name", "") or "")
    factor = getattr(material, "baseColorFactor", None)
    image = getattr(material, "baseColorTexture", None)
    if factor is None and image is None:
        factor, image = getattr(material, "diffuse", None), getattr(material, "image", None)
        linear = False
    else:
        linear = True
    color = np.ones(3)
    if factor is not None:
        values = np.asarray(factor, float)[:3]
        color = values / 255.0 if values.max(initial=0) > 1.0 or not linear else values
        color = color if linear else _to_linear(color)
    if image is not None:
        color = color * _mean(image)
    elif factor is None:
        color = np.array(GREY)
    red, green, blue = np.clip(color, 0.0, 1.0).tolist()
    return label, (red, green, blue)


def _mean(image: Any) -> FloatArray:
    try:
        width, height = image.size
        if width * height > PIXELS:
            return np.array(GREY)
        small = image.convert("RGB").resize((1, 1), resample=4)  # a box: the mean
        return _to_linear(np.asarray(small, float).reshape(3) / 255.0)
    except Exception:  # noqa: BLE001  a broken picture costs its colour alone
        return np.array(GREY)


def _to_linear(srgb: FloatArray) -> FloatArray:
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def read_blender_files(
    paths: Sequence[Path], root: Path, *, say: Callable[[str], None] = lambda _: None
) -> list[list[RawMesh] | str]:
    """Read .blend and USD files in a Blender process; scripts in them are not run.

    A file the process dies of is refused, and a new process goes on with the next one.

    Parameters
    ----------
    paths
        The files.
    root
        Folder that nothing they refer to may leave.
    say
        Called with a line of progress at a time.

    Returns
    -------
    found
        For each file its assets, or the reason why it is refused.

    Raises
    ------
    MissingDependency
        If Blender is not installed.
    """
    found: list[list[RawMesh] | str] = []
    with tempfile.TemporaryDirectory(prefix="cityx-assets-") as name:
        out = Path(name)
        while len(found) < len(paths):
            first = len(found)
            request: dict[str, Any] = {
                "files": [str(path.resolve()) for path in paths[first:]],
                "root": str(root.resolve()),
                "out": str(out),
                "first": first,
                "most": MAX_TRIANGLES,
            }
            code, log = run_module(
                MODULE, request, out, progress=lambda _, text: say(f"reading {text}")
            )
            while len(found) < len(paths) and (out / f"{len(found)}.json").exists():
                found.append(_answer(out, len(found)))
            if len(found) < len(paths):  # it died of the next one
                fate = f"signal {-code}" if code < 0 else f"status {code}"
                last = log.strip().splitlines()[-1:] or ["no words"]
                found.append(f"Blender ended ({fate}) while reading it: {last[0][:120]}")
    return found


def _answer(out: Path, number: int) -> list[RawMesh] | str:
    record = json.loads((out / f"{number}.json").read_text())
    if "refused" in record:
        return str(record["refused"])
    meshes = []
    for item in record["assets"]:
        with np.load(out / item["file"]) as held:
            meshes.append(
                RawMesh(
                    str(item["name"]), held["vertices"], held["triangles"], held["part"],
                    tuple(item["parts"]), held["colors"], metric=True,
                )
            )  # fmt: skip
        (out / item["file"]).unlink()
    return meshes
