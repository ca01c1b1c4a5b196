"""What of a built window belongs to its tile.

What stands belongs to one tile as a whole: a building by the middle of its outline, with its
parts, shell and whatever hangs on it; any other mesh by the middle of its bounds; an instance by
its place. What covers the ground or runs along it is cut: ground, roads, areas, lines at the border
itself; meshes of `SPREAD`, and those longer than `WIDEST`, between the faces whose middles lie on
either side.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Layout
from cityx.city.ground import Ground
from cityx.city.lanes import LaneGraph
from cityx.city.mesh import MeshBatch
from cityx.city.roads import RoadNetwork
from cityx.city.rows import take_rows
from cityx.city.scene import Instances, Scene
from cityx.city.sites import pieces_of
from cityx.geometry.ranges import ranges
from cityx.ids import UInt64Array
from cityx.tiles.grid import Box, holds

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

# Metres; less than any margin, so that the tile that owns a smaller object sees all of it.
WIDEST = 100.0
GLOBAL = ("surroundings",)  # layers of a whole site
# Layers whose objects are all of one material or kind in a site: they are cut however small.
SPREAD = ("ground", "bay_lines", "lawn_edging", "shores")


def owned(city: City, box: Box) -> City:
    """Return what of a built window belongs to a tile.

    Of its network and lanes those of streets that lie in the tile stay. They are whole, so that
    those of tiles side by side can be joined by their ids.

    Parameters
    ----------
    city
        Built about the tile with a margin of more than `WIDEST`.
    box
        The tile, metres.
    """
    middles = shapely.get_coordinates(shapely.centroid(city.layout.buildings.geometry.to_numpy()))
    inside = holds(box, middles)
    every = city.layout.buildings["id"].to_numpy(np.uint64)
    buildings = every, every[inside]
    layout = _layout(city.layout, box, inside)
    return replace(
        _with_streets(city, layout),
        layout=layout,
        ground=None if city.ground is None else ground_in(city.ground, box),
        scene=_scene(city.scene, box, buildings),
    )


def _layout(layout: Layout, box: Box, inside: NDArray[np.bool_]) -> Layout:
    buildings = layout.buildings[inside].reset_index(drop=True)
    parts = layout.parts[layout.parts["building"].isin(buildings["id"])]
    dimensions = shapely.get_dimensions(layout.lines.geometry.to_numpy())
    return Layout(
        box,
        buildings=buildings,
        parts=parts.reset_index(drop=True),
        roads=_cut(layout.roads, box, 1),
        areas=_cut(layout.areas, box, 2),
        lines=_cut(layout.lines, box, dimensions),
        points=_standing(layout.points, box),
        restrictions=_standing(layout.restrictions, box),
    )


def _with_streets(city: City, layout: Layout) -> City:
    """Return a city with the network, heights and lanes of the streets of another layout."""
    network = city.network
    if network is None:
        return city
    ids = layout.roads["id"].to_numpy(np.uint64)
    known, first = np.unique(ids, return_index=True)
    every = city.layout.roads["id"].to_numpy(np.uint64)
    row = np.full(len(every), -1, np.int32)  # of the other layout
    there = np.isin(every, known)
    row[there] = first[np.searchsorted(known, every[there])]
    edges = np.flatnonzero(row[network.edge_road] >= 0)
    edge = np.full(network.edge_count + 1, -1, np.int32)  # the last stands for none
    edge[edges] = np.arange(len(edges), dtype=np.int32)
    nodes, ends = np.unique(network.edge_nodes[edges], return_inverse=True)
    points, start = ranges(network.point_start, edges)
    streets = RoadNetwork(
        network.node_position[nodes], network.node_degree[nodes],
        ends.astype(np.int32).reshape(-1, 2), row[network.edge_road[edges]],
        network.edge_id[edges], start, network.points[points], network.half_width[edges],
        network.trim[edges], network.crossing[edges], network.left_hand[edges], network.z[points],
        network.lift[points],
    )  # fmt: skip
    heights, lanes = city.heights, city.lanes
    if heights is not None:
        heights = heights.take(np.flatnonzero(row[heights.road] >= 0))
        heights = replace(heights, road=row[heights.road], edge=edge[heights.edge])
    if lanes is not None:
        lanes = _lanes(lanes, edge)
    return replace(city, network=streets, heights=heights, lanes=lanes)


def _lanes(lanes: LaneGraph, edge: NDArray[np.int32]) -> LaneGraph:
    """Return the lanes of the edges that get a new number, not -1, and what connects those."""
    kept = np.flatnonzero(edge[lanes.edge] >= 0)
    place = np.full(lanes.count, -1, np.int32)
    place[kept] = np.arange(len(kept), dtype=np.int32)
    turns = np.flatnonzero((place[lanes.connection] >= 0).all(axis=1))
    points, start = ranges(lanes.point_start, kept)
    curve, curve_start = ranges(lanes.curve_start, turns)
    return LaneGraph(
        edge[lanes.edge[kept]], lanes.kind[kept], lanes.direction[kept], lanes.left[kept],
        lanes.right[kept], lanes.turns[kept], lanes.speed[kept], lanes.lane_id[kept], start,
        lanes.points[points], place[lanes.connection[turns]], lanes.movement[turns], curve_start,
        lanes.curve[curve],
    )  # fmt: skip


def _standing(table: GeoDataFrame, box: Box) -> GeoDataFrame:
    places = shapely.get_coordinates(shapely.centroid(table.geometry.to_numpy()))
    return table[holds(box, places)].reset_index(drop=True)


def _cut(table: GeoDataFrame, box: Box, dimension: int | NDArray[Any]) -> GeoDataFrame:
    if not len(table):
        return table
    shapes = shapely.intersection(table.geometry.to_numpy(), shapely.box(*box))
    return pieces_of(table, shapes, dimension)


def ground_in(ground: Ground, box: Box) -> Ground:
    """Return the faces of the ground within a tile, whose border cuts none of them."""
    middle = ground.vertices[ground.triangles].mean(axis=1)
    kept = holds(box, middle)
    triangles, of = ground.triangles[kept], ground.triangle_face[kept]
    faces, of = np.unique(of, return_inverse=True)
    place = np.full(len(ground.face_label) + 1, -1, np.int32)  # the last stands for none
    place[faces] = np.arange(len(faces), dtype=np.int32)
    sides = place[ground.edge_faces]
    edge = (sides >= 0).any(axis=1)
    edges, sides = ground.edges[edge], sides[edge]
    turned = sides[:, 0] < 0  # what lies beyond is on the right hand
    edges[turned], sides[turned] = edges[turned][:, ::-1], sides[turned][:, ::-1]
    vertices, numbers = np.unique(
        np.concatenate([triangles.ravel(), edges.ravel()]), return_inverse=True
    )
    corners, ends = np.split(numbers.astype(np.int32), [triangles.size])
    return Ground(
        ground.vertices[vertices],
        corners.reshape(-1, 3),
        of.astype(np.int32).reshape(-1),
        ground.face_label[faces],
        ground.face_object[faces],
        ends.reshape(-1, 2),
        sides,
    )


def _scene(scene: Scene, box: Box, buildings: tuple[UInt64Array, UInt64Array]) -> Scene:
    meshes = {
        name: _meshes(batch, box, buildings, spread=name in SPREAD)
        for name, batch in scene.meshes.items() if name not in GLOBAL
    }  # fmt: skip
    rows = {name: _rows(table, box, buildings) for name, table in scene.instances.items()}
    return placed_alone(
        Scene(
            MappingProxyType({name: batch for name, batch in meshes.items() if batch.count}),
            scene.prototypes,
            MappingProxyType({name: table for name, table in rows.items() if table.count}),
        )
    )


def placed_alone(scene: Scene) -> Scene:
    """Return a scene without the prototypes that nothing places, by their names."""
    used: set[int] = set()
    for table in scene.instances.values():
        used.update(np.unique(table.prototype).tolist())
    order = sorted(used, key=lambda number: scene.prototypes[number].name)
    place = np.zeros(len(scene.prototypes), np.int32)
    place[order] = np.arange(len(order), dtype=np.int32)
    instances: Mapping[str, Instances] = {
        name: replace(table, prototype=place[table.prototype])
        for name, table in scene.instances.items()
    }
    prototypes = tuple(scene.prototypes[number] for number in order)
    return replace(scene, prototypes=prototypes, instances=MappingProxyType(dict(instances)))


def _rows(table: Instances, box: Box, buildings: tuple[UInt64Array, UInt64Array]) -> Instances:
    every, own = buildings
    hung = np.isin(table.owner, every)
    kept = np.where(hung, np.isin(table.owner, own), holds(box, table.position[:, :2]))
    return take_rows(table, kept)


def _meshes(
    batch: MeshBatch, box: Box, buildings: tuple[UInt64Array, UInt64Array], *, spread: bool
) -> MeshBatch:
    every, own = buildings
    filled = np.flatnonzero(np.diff(batch.face_start) > 0)
    batch = batch.take(filled)
    if not batch.count:
        return batch
    starts = batch.vertex_start[:-1]
    low = np.minimum.reduceat(batch.vertices[:, :2], starts)
    high = np.maximum.reduceat(batch.vertices[:, :2], starts)
    hung = np.isin(batch.object_id, every)
    whole = np.where(hung, np.isin(batch.object_id, own), holds(box, (low + high) / 2))
    wide = ~hung & (spread | ((high - low).max(axis=1) > WIDEST))
    face = np.repeat(whole, np.diff(batch.face_start))
    shared = np.repeat(wide, np.diff(batch.face_start))
    face[shared] = holds(box, middles_of(batch)[shared, :2])
    return faces_alone(batch, face)


def middles_of(batch: MeshBatch) -> NDArray[np.float64]:
    """(f, 3) the middles of faces."""
    corners = np.where(batch.faces < 0, batch.faces[:, :1], batch.faces)
    return np.asarray(batch.vertices[corners].mean(axis=1))


def faces_alone(batch: MeshBatch, kept: NDArray[np.bool_]) -> MeshBatch:
    """Return the objects that have some of (f,) faces, with those and their vertices alone."""
    part = batch.with_faces(kept)
    part = part.take(np.flatnonzero(np.diff(part.face_start) > 0))
    used = np.zeros(len(part.vertices) + 1, bool)
    used[part.faces[part.faces >= 0]] = True
    used = used[:-1]
    if used.all():
        return part
    place = np.concatenate([np.cumsum(used) - 1, [-1]]).astype(np.int32)
    start = np.concatenate([[0], np.cumsum(used)])[part.vertex_start]
    return replace(
        part, vertices=part.vertices[used], vertex_start=start.astype(np.int64),
        faces=place[part.faces],
    )  # fmt: skip
