"""Windows of one map held against each other: which objects of their inner part are the same.

A city that is built tile by tile must not depend on where its tiles end. So a place is built within
windows of several sizes, and what lies in its middle is compared by id and content.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.content import hash_instances, hash_mesh, hash_table
from cityx.city.ground import SURFACES
from cityx.city.layout import SCHEMA
from cityx.city.mesh import MeshBatch
from cityx.city.rows import take_rows
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import stable_id

Box = tuple[float, float, float, float]
Rows = NDArray[np.uint64]  # (n, 2) id and content of objects
Share = tuple[int, int]  # equal, of all that either has

SAMPLE = 1.0  # metres between the places at which surfaces are compared


def box_about(x: float, y: float, half: float) -> Box:
    """Return the square about a place, by half of its side."""
    return x - half, y - half, x + half, y + half


def compared(one: City, other: City, inner: Box) -> dict[str, Share]:
    """Count by kind what two cities of one frame show the same within a rectangle.

    Parameters
    ----------
    inner
        Objects count whose middle lies in it; of what reaches over it, the part inside.

    Returns
    -------
    shares
        Kind to the number of equal objects and of all; of surfaces, of samples; of meshes that
        hold a whole site in one object, of vertices.
    """
    found = dict(_shares(_objects(one, inner), _objects(other, inner)))
    for name in sorted({*one.scene.meshes, *other.scene.meshes}):
        sides = [_vertices(city.scene.meshes.get(name), inner) for city in (one, other)]
        found[f"vertices/{name}"] = _share(*sides)
    xy = _samples(inner)
    if one.ground is not None and other.ground is not None:
        labels = [_labels(city, xy) for city in (one, other)]
        found["ground/surface"] = int((labels[0] == labels[1]).sum()), len(xy)
    heights = [np.rint(1e3 * (c.terrain.height_at(xy) + c.terrain.datum)) for c in (one, other)]
    found["terrain"] = int((heights[0] == heights[1]).sum()), len(xy)
    return found


def table(columns: Mapping[str, Mapping[str, Share]]) -> str:
    """Return shares as a table of Markdown: a row for each kind, per cent."""
    kinds = sorted({kind for shares in columns.values() for kind in shares})
    lines = [f"| kind (count) | {' | '.join(columns)} |", "| --- " * (len(columns) + 1) + "|"]
    for kind in kinds:
        total = max(shares.get(kind, (0, 0))[1] for shares in columns.values())
        cells = [_percent(shares.get(kind, (0, 0))) for shares in columns.values()]
        if total:
            lines.append(f"| {kind} ({total:,}) | {' | '.join(cells)} |")
    return "\n".join(lines)


def _percent(share: Share) -> str:
    equal, total = share
    if total == 0:
        return "-"
    # A share that is not all of it must not be rounded to it.
    return "100" if equal == total else f"{min(100 * equal / total, 99.99):.4g}"


def _shares(one: Mapping[str, Rows], other: Mapping[str, Rows]) -> Iterator[tuple[str, Share]]:
    nothing = np.zeros((0, 2), np.uint64)
    for name in sorted({*one, *other}):
        yield name, _share(one.get(name, nothing), other.get(name, nothing))


def _share(one: NDArray[Any], other: NDArray[Any]) -> Share:
    """Count rows that both hold, and those that either does, as often as they occur."""
    every = np.concatenate([one, other])
    if not len(every):
        return 0, 0
    _, row = np.unique(every, axis=0, return_inverse=True)
    row = row.ravel()
    counts = [np.bincount(part, minlength=row.max() + 1) for part in np.split(row, [len(one)])]
    return int(np.minimum(*counts).sum()), int(np.maximum(*counts).sum())


def _objects(city: City, inner: Box) -> dict[str, Rows]:
    found = {f"layout/{name}": _of_table(city, name, inner) for name in SCHEMA}
    for name, batch in city.scene.meshes.items():
        found[f"meshes/{name}"] = np.column_stack(hash_mesh(_meshes_in(batch, inner)))
    made = city.scene.prototypes
    names = np.array([stable_id(p.name, hash_mesh(p.mesh)[1].tolist()) for p in made], np.uint64)
    for name, rows in city.scene.instances.items():
        own = take_rows(rows, _inside(rows.position[:, :2], inner))
        found[f"instances/{name}"] = np.column_stack(hash_instances(own, names))
    if city.network is not None:
        found["network/edges"] = _edges(city, inner)
    return found


def _of_table(city: City, name: str, inner: Box) -> Rows:
    table = getattr(city.layout, name)
    shapes = table.geometry.to_numpy()
    if name == "buildings":
        table = table[_inside(_middles(shapes), inner)]
    elif name == "parts":
        whole = city.layout.buildings
        own = whole["id"][_inside(_middles(whole.geometry.to_numpy()), inner)]
        table = table[table["building"].isin(own)]
    else:
        cut = shapely.normalize(shapely.clip_by_rect(shapes, *inner))
        table = table.set_geometry(cut)[~shapely.is_empty(cut)]
    return np.column_stack(hash_table(table, name))


def _middles(shapes: NDArray[Any]) -> FloatArray:
    middles: FloatArray = shapely.get_coordinates(shapely.centroid(shapes)).reshape(-1, 2)
    return np.round(middles, 3)


def _inside(xy: FloatArray, box: Box) -> NDArray[np.bool_]:
    return np.asarray(((xy >= box[:2]) & (xy < box[2:])).all(axis=1))


def _meshes_in(batch: MeshBatch, inner: Box) -> MeshBatch:
    """Return the objects that lie wholly in a rectangle."""
    filled = np.flatnonzero(np.diff(batch.vertex_start) > 0)
    if not len(filled):
        return batch.take(filled)
    begin = batch.vertex_start[:-1][filled]
    low = np.minimum.reduceat(batch.vertices[:, :2], begin)
    high = np.maximum.reduceat(batch.vertices[:, :2], begin)
    return batch.take(filled[_inside(low, inner) & _inside(high, inner)])


def _vertices(batch: MeshBatch | None, inner: Box) -> IntArray:
    """(n, 3) places of vertices in a rectangle, whole millimetres, each once."""
    if batch is None:
        return np.zeros((0, 3), np.int64)
    own = batch.vertices[_inside(batch.vertices[:, :2], inner)]
    return np.asarray(np.unique(np.rint(1e3 * own).astype(np.int64), axis=0))


def _edges(city: City, inner: Box) -> Rows:
    """Return the edges of the network that lie wholly in a rectangle."""
    network = city.network
    assert network is not None
    rows = []
    for edge in range(network.edge_count):
        points = network.edge_points(edge)
        if not _inside(points, inner).all():
            continue
        span = slice(*network.point_start[edge : edge + 2].tolist())
        held = (points, network.half_width[edge], network.trim[edge], network.crossing[edge],
                network.z[span] + city.terrain.datum, network.lift[span])  # fmt: skip
        bits = b"".join(np.rint(1e3 * np.asarray(v, float)).astype(int).tobytes() for v in held)
        rows.append((int(network.edge_id[edge]), stable_id(bits.hex())))
    return np.array(rows, np.uint64).reshape(-1, 2)


def _samples(inner: Box) -> FloatArray:
    # Off the round numbers, on which borders are drawn.
    x, y = (np.arange(inner[k] + 0.37, inner[k + 2], SAMPLE) for k in (0, 1))
    return np.column_stack([axis.ravel() for axis in np.meshgrid(x, y)])


def _labels(city: City, xy: FloatArray) -> IntArray:
    assert city.ground is not None
    face = city.ground.face_at(xy, *(surface.name for surface in SURFACES))
    return np.asarray(np.where(face < 0, -1, city.ground.face_label[np.maximum(face, 0)]))
