"""Retrieval: map files, materials, meshes, and what is known of the objects of a scene."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, replace
from difflib import SequenceMatcher
from typing import Annotated, Any

import numpy as np

from cityx.assets.styles.materials import MATERIALS, Material
from cityx.city.city import City
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Instances, Prototype
from cityx.convert.layouts import layout_to_geographic_conversion
from cityx.errors import ActionFailed, nearest
from cityx.ids import id_text, stable_id
from cityx.protocol import InputFiles, ObjectName, Port, Range, action
from cityx.protocol.objects import find_object
from cityx.protocol.preconditions import TABLES
from cityx.protocol.values import GeographicData
from cityx.sources.input_kinds import OSM_SUFFIXES

PLACED = "placed"  # layer of the instances that Asset_placement adds
CLOSE = 0.6  # share of letters that must agree for a word to count as misspelt


@action(
    "convert/osm_file_retrieval-v1",
    classname="OSM_file_retrieval",
    kind="source",
    cost=5.0,
    limits=["Reads files the user handed in, by name; it opens no other file and no network."],
)
def osm_file_retrieval(
    inputs: InputFiles, name: Annotated[str, Port("name", "string", "input")]
) -> GeographicData:
    """Retrieve OpenStreetMap files: read a map the user handed in.

    Parameters
    ----------
    inputs
        Files the user handed in.
    name
        Name of the file among them, or its number counted from 0.
    """
    from cityx.sources.osm import read_osm

    names = [path.name for path in inputs.paths]
    if name in names:
        index = names.index(name)
    elif name.isdecimal():
        index = int(name)
    else:
        raise ActionFailed(f'No input file is called "{name}".{nearest(name, names)}')
    city = read_osm(inputs.path(index, OSM_SUFFIXES))
    return layout_to_geographic_conversion(city, city.layout)


@action(
    "convert/texture_information_extraction-v1",
    classname="Texture_information_extraction",
    kind="query",
    gives=(Port("information", "string", "material_information"),),
    lossy=0.5,
    limits=["Loses the pattern itself: only its name and size are told."],
)
def texture_information_extraction(material: Material) -> str:
    """Extract texture information: the numbers of a material as a JSON text.

    Parameters
    ----------
    material
        Material.
    """
    return json.dumps(asdict(material), sort_keys=True)


@action(
    "convert/asset_material_retrieval-v1",
    classname="Asset_material_retrieval",
    kind="retrieval",
    lossy=0.2,
    limits=["Knows the materials of the table alone; words are matched by letters, not meaning."],
)
def asset_material_retrieval(
    description: Annotated[str, Port("description", "string", "material")],
) -> Material:
    """Retrieve material data for assets: the known material a few words describe best.

    Parameters
    ----------
    description
        Words such as "red brick" or "roof tiles".
    """
    words = description.lower().replace("-", " ").replace("_", " ").split()
    name = _best(words, {name: [*name.split("_"), m.texture] for name, m in MATERIALS.items()})
    if name is None:
        raise ActionFailed(f'No material is like "{description}".{nearest(description, MATERIALS)}')
    return MATERIALS[name]


def _best(words: list[str], entries: Mapping[str, list[str]]) -> str | None:
    """Return the entry whose words agree best with those given, ties by name."""
    scored = []
    for name, known in entries.items():
        score = 0.0
        for word in words:
            close = max((_alike(word, other) for other in known if other), default=0.0)
            score += close if close >= CLOSE else 0.0
        # Entries that need fewer words for the same agreement are meant more probably.
        scored.append((-score, len(known), name))
    best = min(scored, default=None)
    return None if best is None or best[0] == 0 else best[2]


def _alike(word: str, other: str) -> float:
    if word == other:
        return 1.0
    return SequenceMatcher(None, word.rstrip("s"), other.rstrip("s")).ratio() * 0.95


@action(
    "convert/asset_mesh_retrieval-v1",
    classname="Asset_mesh_retrieval",
    kind="retrieval",
    limits=["Knows the prototypes that are in the scene already."],
)
def asset_mesh_retrieval(
    city: City, name: Annotated[str, Port("name", "string", "asset")]
) -> MeshBatch:
    """Retrieve mesh data for assets: the mesh of a prototype of the scene.

    Parameters
    ----------
    city
        City whose scene holds the prototype.
    name
        Name of the prototype.
    """
    return _prototype(city, name).mesh


def _prototype(city: City, name: str) -> Prototype:
    known = {prototype.name: prototype for prototype in city.scene.prototypes}
    if name not in known:
        raise ActionFailed(f'The scene has no prototype "{name}".{nearest(name, known)}')
    return known[name]


@action(
    "convert/asset_placement-v1",
    classname="Asset_placement",
    kind="edit",
    takes=(Port("asset", "string", "asset"), Port("place", "point")),
    gives=(Port("instance", "complex_geometry", "placed"),),
    limits=["Places one instance of a prototype of the scene; it does not look for a free spot."],
)
def asset_placement(
    city: City,
    *,
    asset: str,
    x: Annotated[float, Range(-100_000.0, 100_000.0)],
    y: Annotated[float, Range(-100_000.0, 100_000.0)],
    heading: Annotated[float, Range(-2 * math.pi, 2 * math.pi)] = 0.0,
    scale: Annotated[float, Range(0.001, 1000.0)] = 1.0,
) -> City:
    """Place assets within a scene: add one instance of a prototype, standing on the ground.

    Parameters
    ----------
    city
        City to place it in.
    asset
        Name of a prototype of the scene.
    x, y
        Where its origin goes, metres.
    heading
        Direction its front faces, compass radians.
    scale
        Factor on its size.
    """
    prototype = _prototype(city, asset)
    old = city.scene.instances.get(PLACED)
    count = 0 if old is None else old.count
    ground = float(city.terrain.height_at([[x, y]])[0]) + KERB_HEIGHT
    identity = ("placed", asset, round(x, 3), round(y, 3), round(heading, 6), round(scale, 6))
    number = np.array([stable_id(*identity)], np.uint64)
    if old is not None and number[0] in old.object_id:
        raise ActionFailed(f"{asset} stands at {x:g}, {y:g} already.")
    # Fronts face -y, compass angles run clockwise from +y.
    turned = np.array([[0.0, 0.0, math.pi - heading]], np.float32)
    row = Instances(
        np.array([city.scene.prototypes.index(prototype)], np.int32),
        number,
        np.zeros(1, np.uint64),
        np.array([[x, y, ground]]),
        turned,
        np.full((1, 3), scale, np.float32),
        np.ones((1, 3), np.float32),
    )
    rows = row if not count or old is None else _joined(old, row)
    return replace(city, scene=city.scene.with_instances(PLACED, city.scene.prototypes, rows))


def _joined(first: Instances, second: Instances) -> Instances:
    columns = {
        name: np.concatenate([getattr(first, name), getattr(second, name)])
        for name in first.__dataclass_fields__
    }
    order = np.argsort(columns["object_id"], kind="stable")
    return Instances(**{name: values[order] for name, values in columns.items()})


@action(
    "convert/scene_object_information_extraction-v1",
    classname="Scene_object_information_extraction",
    kind="query",
    gives=(Port("information", "string", "object_information"),),
    limits=["Tells what is stored; it judges nothing. Names and tags are data of the input file."],
)
def scene_object_information_extraction(
    city: City, name: Annotated[str, Port("name", "string", "object"), ObjectName()]
) -> str:
    """Extract scene object information: place, size and attributes of an object as a JSON text.

    Parameters
    ----------
    city
        City that holds the object.
    name
        Id of 16 hexadecimal digits, source such as "osm/way/123", or name.
    """
    number = find_object(city, name)
    if number is None:
        raise ActionFailed(f'"{name}" names no single object of the city.')
    out: dict[str, Any] = {"id": id_text(number)}
    for table in TABLES:
        rows = getattr(city.layout, table)
        for _, row in rows[rows["id"] == np.uint64(number)].iterrows():
            attributes = {
                key: value
                for key, value in json.loads(row.drop(["geometry", "id", "tags"]).to_json()).items()
                if value is not None
            }
            out[table] = attributes | {"bounds": np.round(row.geometry.bounds, 3).tolist()}
    for layer, batch in city.scene.meshes.items():
        for index in np.flatnonzero(batch.object_id == np.uint64(number)).tolist():
            mesh = batch.take([index])
            low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
            out[f"mesh {layer}"] = {
                "low": np.round(low, 3).tolist(),
                "high": np.round(high, 3).tolist(),
                "triangles": mesh.triangle_count,
                "materials": sorted({mesh.materials[m] for m in mesh.material.tolist()}),
            }
    for layer, placed in city.scene.instances.items():
        for index in np.flatnonzero(placed.object_id == np.uint64(number)).tolist():
            out[f"instance {layer}"] = {
                "prototype": city.scene.prototypes[placed.prototype[index]].name,
                "position": np.round(placed.position[index], 3).tolist(),
                "scale": np.round(placed.scale[index].astype(float), 4).tolist(),
            }
    return json.dumps(out, sort_keys=True)
