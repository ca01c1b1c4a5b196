"""The bodies of a city for physics engines: ``city_bodies.npz``, and a model of MuJoCo.

The text beside the arrays, ``city_bodies.json``, tells the words that numbers stand for and the
meaning of every array, so that a reader in any language needs nothing else.

MuJoCo takes every mesh for its convex hull, so ground is written triangle by triangle, each as a
slab with the thickness `SLAB`.

References
----------
MuJoCo documentation, "XML Reference" (MJCF).
"""

from __future__ import annotations

import json
import os
from dataclasses import fields
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from cityx.assets.colliders import bodies_of
from cityx.city.bodies import FORM, FORMS, MOTION, MOTIONS, Bodies, Colliders, take_bodies
from cityx.city.scene import Scene
from cityx.city.store import View
from cityx.ids import id_text
from cityx.outputs.gltf_instances import quaternions
from cityx.system.atomic import replaced
from cityx.system.tables import table
from cityx.version import __version__

MEANINGS = dict(table("outputs/bodies", str))
SLAB = 0.5  # metres of ground below its surface; a thing that falls cannot get through at once
STEP = 0.002  # seconds; stiff enough for heavy things on hard ground
FLAT = 1e-4  # square metres of a triangle that carries nothing
MEMORY = "512M"  # MuJoCo's own guess is too small for thousands of geoms
Window = tuple[float, float, float, float]


def write_bodies(view: View, path: str | os.PathLike[str]) -> Bodies:
    """Write the bodies of a city.

    Parameters
    ----------
    view
        The city as engines see it.
    path
        File to make, ``city_bodies.npz``; the text gets the suffix ``.json``. Both are replaced
        when complete.

    Returns
    -------
    bodies
        What was written.
    """
    path = Path(path)
    bodies = bodies_of(view.scene, view.tracks, view.moment)
    arrays = {**_arrays(bodies), **_arrays(bodies.colliders)}
    with replaced(path) as temporary:
        np.savez_compressed(temporary, **arrays)
    record = {
        "cityx": __version__,
        "name": view.name,
        "arrays": path.name,
        "gravity": [0.0, 0.0, -9.81],
        "projection": view.frame.projection,
        "attribution": list(view.attribution),
        "moment": view.moment,
        "bodies": bodies.count,
        "kinds": list(bodies.kinds),
        "forms": list(FORMS),
        "motions": list(MOTIONS),
        "meaning": MEANINGS,
    }
    with replaced(path.with_suffix(".json")) as temporary:
        temporary.write_text(json.dumps(record, indent=1))
    return bodies


def read_bodies(path: str | os.PathLike[str]) -> Bodies:
    """Read bodies that were written; see `write_bodies`."""
    path = Path(path)
    record = json.loads(path.with_suffix(".json").read_text())
    with np.load(path) as arrays:
        held = dict(arrays)
    shapes = Colliders(**{field.name: held.pop(field.name) for field in fields(Colliders)})
    return Bodies(**held, kinds=tuple(record["kinds"]), colliders=shapes)


def _arrays(value: Any) -> dict[str, Any]:
    held = {field.name: getattr(value, field.name) for field in fields(value)}
    return {name: array for name, array in held.items() if isinstance(array, np.ndarray)}


def write_mjcf(
    scene: Scene, bodies: Bodies, path: str | os.PathLike[str], *, window: Window
) -> Bodies:
    """Write the bodies of a city within a window.

    Free bodies are named ``body_ID``; all geoms of an object carry its id, with a number. Doors
    stand shut, and what is driven is left out: a simulation moves it as it likes.

    Parameters
    ----------
    scene
        Gives the triangles of what has no other collider.
    bodies
        Of that scene.
    path
        XML file to make.
    window
        (xmin, ymin, xmax, ymax) that the middle of a thing lies in, metres. Its middle becomes the
        origin.

    Returns
    -------
    written
        The bodies in the file.
    """
    origin = np.array([(window[0] + window[2]) / 2, (window[1] + window[3]) / 2, 0.0])
    root = ElementTree.Element("mujoco", model="city")
    # The same friction whichever way a thing is pushed, and hardly any creep.
    ElementTree.SubElement(
        root, "option", timestep=str(STEP), gravity="0 0 -9.81", cone="elliptic", impratio="10"
    )
    ElementTree.SubElement(root, "size", memory=MEMORY)
    asset, world = (ElementTree.SubElement(root, name) for name in ("asset", "worldbody"))
    kept = take_bodies(bodies, _inside(bodies, window) & (bodies.motion != MOTION["driven"]))
    for row in range(kept.count):
        _add_body(asset, world, kept, row, origin)
    _add_ground(asset, world, scene, bodies, window, origin)
    ElementTree.indent(root)
    with replaced(Path(path)) as temporary:
        ElementTree.ElementTree(root).write(temporary)
    return kept


def _inside(bodies: Bodies, window: Window) -> NDArray[np.bool_]:
    """(n,) whether the middle of each body's collider lies in a window; meshes apart."""
    shapes = bodies.colliders
    first = shapes.part_start[bodies.shape]
    own = (bodies.scale == 1).all(axis=1) & ~bodies.position.any(axis=1)
    xy = np.where(own[:, None], shapes.center[first, :2], bodies.position[:, :2])
    (west, south, east, north), (x, y) = window, xy.T
    inside = (x >= west) & (x <= east) & (y >= south) & (y <= north)
    return np.asarray(inside & (shapes.form[first] != FORM["mesh"]))


def _add_body(
    asset: ElementTree.Element,
    world: ElementTree.Element,
    bodies: Bodies,
    row: int,
    origin: NDArray[np.float64],
) -> None:
    shapes, name = bodies.colliders, id_text(int(bodies.object_id[row]))
    turn = np.roll(quaternions(bodies.rotation[row])[0], 1)  # w first
    body = ElementTree.SubElement(
        world, "body", name=f"body_{name}_{row}",
        pos=_words(bodies.position[row] - origin), quat=_words(turn),
    )  # fmt: skip
    parts = range(*shapes.parts(int(bodies.shape[row])).indices(len(shapes.form)))
    total = float(shapes.volume[shapes.parts(int(bodies.shape[row]))].sum())
    if bodies.motion[row] == MOTION["free"]:
        ElementTree.SubElement(body, "freejoint")
    for part in parts:
        weight = bodies.mass[row] * shapes.volume[part] / max(total, 1e-9)
        corners = shapes.corners(part) * bodies.scale[row]
        label = f"{name}_{row}_{part}"
        ElementTree.SubElement(asset, "mesh", name=label, vertex=_words(corners))
        ElementTree.SubElement(
            body, "geom", type="mesh", mesh=label, mass=f"{weight:.6g}",
            friction=_friction(bodies.friction[row]),
        )  # fmt: skip


def _add_ground(
    asset: ElementTree.Element,
    world: ElementTree.Element,
    scene: Scene,
    bodies: Bodies,
    window: Window,
    origin: NDArray[np.float64],
) -> None:
    """Add the triangles of what collides by its own mesh as slabs."""
    first = bodies.colliders.part_start[bodies.shape]
    whole = bodies.colliders.form[first] == FORM["mesh"]
    ids, frictions = bodies.object_id[whole].tolist(), bodies.friction[whole].tolist()
    touch = dict(zip(ids, frictions, strict=True))
    low, high = np.array(window[:2]), np.array(window[2:])
    for layer, batch in scene.meshes.items():
        triangles, face = batch.triangles()
        own = batch.object_id[batch.face_object()[face]]
        corners = batch.vertices[triangles]  # (t, 3, 3)
        met = (corners[:, :, :2].max(axis=1) >= low) & (corners[:, :, :2].min(axis=1) <= high)
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        level = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] > FLAT
        chosen = met.all(axis=1) & level & np.isin(own, ids)
        for number in np.flatnonzero(chosen).tolist():
            top = corners[number] - origin
            slab = np.concatenate([top, top - [0.0, 0.0, SLAB]])
            name = f"{layer}_{number}"
            ElementTree.SubElement(asset, "mesh", name=name, vertex=_words(slab))
            ElementTree.SubElement(
                world, "geom", name=name, type="mesh", mesh=name,
                friction=_friction(touch[int(own[number])]),
            )  # fmt: skip


def _friction(sliding: float) -> str:
    """Return MuJoCo's three: sliding, and its own of turning and rolling."""
    return f"{sliding:.4g} 0.005 0.0001"


def _words(values: NDArray[np.float64]) -> str:
    return " ".join(f"{value:.6g}" for value in np.asarray(values).ravel().tolist())
