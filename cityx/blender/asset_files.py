"""Asset files that only Blender reads: ``python -m cityx.blender.asset_files JOB.json``.

Reads .blend and USD files one after the other into plain arrays, one NPZ per asset. Nothing of a
file is run: scripts, drivers and handlers stay off. A process that dies is started again by the
caller without the file it died of.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import time
import traceback
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from cityx.blender.operators import call
from cityx.blender.worker import say
from cityx.system.parents import end_with_parent

MEMORY = 6 << 30  # bytes a file may need; a packed one can ask for any number
SECONDS = 120  # a file may take
ARRAYS = ("vertices", "triangles", "part", "colors")
GREY = (0.5, 0.5, 0.5)


class Unfit(Exception):
    """A file cannot be an asset; the text is the reason."""


def read_file(path: Path, root: Path, most: int) -> list[dict[str, Any]]:
    """Read the assets of one file: arrays by name.

    Parameters
    ----------
    path
        .blend, .usd, .usda, .usdc or .usdz.
    root
        Folder that nothing it refers to may leave.
    most
        Triangles an asset may have.
    """
    call("wm.read_homefile", use_empty=True, use_factory_startup=True, load_ui=False)
    bpy.context.preferences.filepaths.use_scripts_auto_execute = False
    if path.suffix.lower() == ".blend":
        groups = _append(path, root)
    else:
        bpy.ops.wm.usd_import(
            filepath=str(path), import_cameras=False, import_lights=False, import_volumes=False,
            import_skeletons=False, import_blendshapes=False, set_frame_range=False,
            import_textures_mode="IMPORT_NONE", create_world_material=False,
        )  # fmt: skip
        groups = [(path.stem, bpy.context.scene.collection)]
    _check_references(path, root)
    found = []
    for name, collection in groups:
        item = _arrays(collection, most)
        if item is not None:
            found.append(item | {"name": name})
    if not found:
        raise Unfit("it holds no geometry")
    return found


def _append(path: Path, root: Path) -> list[tuple[str, Any]]:
    """Load a .blend file's collections, or all its objects where it has none."""
    del root
    try:
        with bpy.data.libraries.load(str(path), link=False) as (held, wanted):
            wanted.collections = list(held.collections)
            if not held.collections:
                wanted.objects = list(held.objects)
    except (OSError, RuntimeError, UnicodeDecodeError) as error:
        raise Unfit(f"it is broken: {error}") from None
    collections = [item for item in bpy.data.collections if item is not None]
    top = bpy.context.scene.collection
    if not collections:
        for item in bpy.data.objects:
            top.objects.link(item)
        return [(path.stem, top)]
    nested = {child.name for item in collections for child in item.children}
    # A collection that objects place is a part of them, no asset of its own.
    nested |= {o.instance_collection.name for o in bpy.data.objects if o.instance_collection}
    return [(item.name, item) for item in collections if item.name not in nested]


def _check_references(path: Path, root: Path) -> None:
    named = [item.filepath for item in bpy.data.libraries]
    for image in bpy.data.images:
        if image.filepath and not image.packed_file and image.source in ("FILE", "SEQUENCE"):
            named.append(image.filepath)
    for name in named:
        if name in ("", str(path)):
            continue
        plain = name[2:] if name.startswith("//") else name
        target = Path(bpy.path.abspath(name, start=str(path.parent)))
        if name.startswith("//"):
            target = path.parent / plain
        if "\\" in plain or target.resolve() == path.resolve():
            if target.resolve() == path.resolve():
                continue
            raise Unfit(f'it refers to "{name[:60]}", outside the folder')
        if not target.resolve().is_relative_to(root.resolve()):
            raise Unfit(f'it refers to "{name[:60]}", outside the folder')


def _arrays(collection: Any, most: int) -> dict[str, Any] | None:
    """Evaluate what a collection shows: its meshes, with modifiers and instances."""
    scene = bpy.context.scene
    top = scene.collection
    alone = bpy.data.scenes.new("asset")
    if collection is top:
        alone = scene
    else:
        alone.collection.children.link(collection)
    layer = alone.view_layers[0]
    layer.update()
    graph = layer.depsgraph
    vertices: list[Any] = []
    triangles: list[Any] = []
    part: list[Any] = []
    parts: list[str] = []
    colors: list[tuple[float, float, float]] = []
    count = total = 0
    for item in graph.object_instances:
        source = item.object
        if source.type not in ("MESH", "CURVE", "SURFACE", "FONT", "META"):
            continue
        if not item.show_self or source.hide_render:
            continue
        try:
            mesh = source.to_mesh()
        except RuntimeError:
            continue
        if mesh is None or not len(mesh.polygons):
            continue
        mesh.calc_loop_triangles()
        size = len(mesh.loop_triangles)
        total += size
        if total > most:
            raise Unfit(f"it is huge: more than {most / 1e6:.0f} million triangles")
        points = np.empty(3 * len(mesh.vertices))
        mesh.vertices.foreach_get("co", points)
        corner = np.empty(3 * size, np.int32)
        mesh.loop_triangles.foreach_get("vertices", corner)
        slot = np.empty(size, np.int32)
        mesh.loop_triangles.foreach_get("material_index", slot)
        matrix = np.array(item.matrix_world)
        faces = corner.reshape(-1, 3)
        if np.linalg.det(matrix[:3, :3]) < 0:
            faces = faces[:, ::-1]
        vertices.append(points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3])
        triangles.append(faces + count)
        slots = mesh.materials[:] or [None]
        part.append(np.minimum(slot, len(slots) - 1) + len(parts))
        for material in slots:
            parts.append(f"{source.name} {material.name if material else ''}".strip())
            colors.append(_color(material))
        count += len(points) // 3
        source.to_mesh_clear()
    if not triangles:
        return None
    return {
        "vertices": np.concatenate(vertices) * float(scene.unit_settings.scale_length or 1.0),
        "triangles": np.concatenate(triangles).astype(np.int64),
        "part": np.concatenate(part).astype(np.int64),
        "parts": parts,
        "colors": np.array(colors, float),
    }


def _color(material: Any) -> tuple[float, float, float]:
    """Return the base colour of a material, linear."""
    if material is None:
        return GREY
    if material.use_nodes and material.node_tree:
        for node in material.node_tree.nodes:
            if node.type == "BSDF_PRINCIPLED" and not node.inputs["Base Color"].is_linked:
                red, green, blue, _ = node.inputs["Base Color"].default_value
                return (red, green, blue)
    red, green, blue, _ = material.diffuse_color
    return (red, green, blue)


def main(arguments: list[str]) -> int:
    """Run one job: the files it names, in order, each to files of its own."""
    job = json.loads(Path(arguments[0]).read_text())
    end_with_parent(job["parent"])
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
    out = Path(job["out"])
    for number, name in enumerate(job["files"]):
        begin = time.perf_counter()
        signal.alarm(SECONDS)  # what hangs in the engine is ended by the signal itself
        say(number / len(job["files"]), Path(name).name)
        # The caller finds this note when the process dies of the file.
        (out / f"{job['first'] + number}.begun").write_text(name)
        record: dict[str, Any] = {"assets": []}
        try:
            for index, item in enumerate(read_file(Path(name), Path(job["root"]), job["most"])):
                stem = f"{job['first'] + number}_{index}"
                np.savez(out / f"{stem}.npz", **{key: item[key] for key in ARRAYS})
                record["assets"].append({"file": f"{stem}.npz", "name": item["name"],
                                         "parts": item["parts"]})  # fmt: skip
        except Unfit as error:
            record = {"refused": str(error)}
        except MemoryError:
            record = {"refused": f"it is huge: it needs more than {MEMORY >> 30} GB of memory"}
        except Exception as error:  # noqa: BLE001  one file must not end the others
            traceback.print_exc()
            record = {"refused": f"it is broken: {type(error).__name__}: {error}"}
        record["seconds"] = round(time.perf_counter() - begin, 3)
        partial = out / f"{job['first'] + number}.partial"
        partial.write_text(json.dumps(record))
        partial.replace(out / f"{job['first'] + number}.json")
    return 0


if __name__ == "__main__":
    status = main(sys.argv[1:])
    sys.stdout.flush()
    # Threads of USD can wait for each other for ever when Python takes the module down.
    os._exit(status)
