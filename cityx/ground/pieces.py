"""Things that stand somewhere: as arrays, with the room before them, and as rows of a layer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.city import City, Instances
from cityx.city.bounds import OURS
from cityx.city.ground import KERB_HEIGHT, Ground
from cityx.city.layout import in_town
from cityx.city.thing_outlines import placed_rings, solid_ring
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.polylines import arc_lengths, every, locate, pack, to_linestrings
from cityx.geometry.probes import Segments, segments_of, way_to
from cityx.ground.arrangement import BEYOND
from cityx.ground.standing import WALKED, earth_over, stand_on, surfaces_at
from cityx.ground.walking.passage import in_lanes
from cityx.ids import hash_ids
from cityx.system.remembered import Remembered

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

DOOR_WAY = 9.0  # metres before a door that its path takes


@dataclass(frozen=True)
class Pieces:
    """Things that stand somewhere, (n,) each.

    Attributes
    ----------
    name
        Names of prototypes.
    xy
        (n, 2) metres.
    id
        uint64, stable.
    yaw
        Radians about z; the front, -y of the prototype, turns with it.
    scale
        Of all three axes.
    """

    name: NDArray[Any]
    xy: FloatArray
    id: NDArray[np.uint64]
    yaw: FloatArray
    scale: FloatArray

    def __len__(self) -> int:
        """Count the things."""
        return len(self.id)

    def take(self, rows: ArrayLike) -> Pieces:
        """Return some of the things, by mask or by index."""
        index = np.asarray(rows)
        return Pieces(self.name[index], self.xy[index], self.id[index], self.yaw[index],
                      self.scale[index])  # fmt: skip


def pieces(name: Any, xy: FloatArray, ids: NDArray[np.uint64], yaw: FloatArray) -> Pieces:
    """Make pieces of one name, or of (n,) names, at their real size."""
    names = np.broadcast_to(np.asarray(name, dtype=object), (len(ids),))
    return Pieces(names, np.asarray(xy, float).reshape(-1, 2), ids, np.asarray(yaw, float),
                  np.ones(len(ids)))  # fmt: skip


def join_pieces(groups: Sequence[Pieces]) -> Pieces:
    """Join groups of pieces."""
    if not groups:
        return pieces("", np.zeros((0, 2)), np.zeros(0, np.uint64), np.zeros(0))
    names = ("name", "xy", "id", "yaw", "scale")
    return Pieces(*(np.concatenate([getattr(g, n) for g in groups]) for n in names))


def places_at_walls(
    city: City, spacing: float, margin: float, before: float, surfaces: tuple[str, ...]
) -> tuple[FloatArray, FloatArray]:
    """Space places along the walls of houses of towns that stand on some surfaces.

    Parameters
    ----------
    city
        City with its ground; without one there are no places.
    spacing, margin
        Metres of wall per place, and from the corners of a house.
    before
        Metres before the wall at which the ground is looked at.
    surfaces
        What it has to be there.

    Returns
    -------
    foot, out
        (n, 2) places at the foot of walls, and unit vectors away from them.
    """
    buildings = city.layout.buildings
    houses = buildings.geometry.to_numpy()[in_town(buildings)]
    if city.ground is None or not len(houses):
        return np.zeros((0, 2)), np.zeros((0, 2))
    walls = pack(shapely.get_exterior_ring(shapely.orient_polygons(shapely.get_parts(houses))))
    ends = np.delete(np.arange(len(walls.points)), walls.start[1:] - 1)
    start, end = walls.points[ends], walls.points[ends + 1]
    sides = pack(shapely.linestrings(np.stack([start, end], axis=1)))
    row, at = every(arc_lengths(sides)[1], spacing, margin)
    foot, along = locate(sides, row, at)
    out = np.column_stack([along[:, 1], -along[:, 0]])  # outlines run counter-clockwise
    near = inside_extent(city, foot, 0.5)
    near[near] = city.ground.on(foot[near] + before * out[near], *surfaces)
    return foot[near], out[near]


def ids_of_places(xy: FloatArray, purpose: str) -> NDArray[np.uint64]:
    """(n,) ids of places, (n, 2) metres, by their whole decimetres."""
    cell = np.round(xy * 10).astype(np.int64).view(np.uint64)
    return hash_ids(0, purpose, cell[:, 0], cell[:, 1])


def front(yaw: ArrayLike) -> FloatArray:
    """(n, 2) direction that a prototype, front -y, faces after a turn."""
    angle = np.asarray(yaw, float)
    return np.column_stack([np.sin(angle), -np.cos(angle)])


def heights(city: City, xy: FloatArray) -> FloatArray:
    """(n,) height of what things stand on: the ground, or the ramp or cutting that it opens for.

    Where neither is built, the terrain and a kerb.
    """
    z = stand_on(city.scene.meshes.get("ground"), xy).z
    opened = np.flatnonzero(np.isnan(z))
    spot, height = surfaces_at(city.scene.meshes.get("decks"), xy[opened])
    np.fmin.at(z, opened[spot], height)
    return np.asarray(np.where(np.isnan(z), city.terrain.height_at(xy) + KERB_HEIGHT, z))


def with_pieces(city: City, layer: str, found: Pieces, z: FloatArray | None = None) -> City:
    """Return the city with one layer of furniture; of equal ids the first stays.

    Parameters
    ----------
    city
        The city.
    layer
        Name of the layer; rows it held before are replaced.
    found
        The things.
    z
        (n,) heights of their feet, metres; the ground's when left out.
    """
    from cityx.assets.furniture.street_furniture import furniture

    order = np.unique(found.id, return_index=True)[1]
    chosen = found.take(order)
    names, number = np.unique(chosen.name.astype(str), return_inverse=True)
    total = len(order)
    rotation = np.zeros((total, 3), np.float32)
    rotation[:, 2] = chosen.yaw
    rows = Instances(
        number.astype(np.int32),
        chosen.id,
        np.zeros(total, np.uint64),
        np.column_stack([chosen.xy, heights(city, chosen.xy) if z is None else z[order]]),
        rotation,
        np.repeat(chosen.scale.astype(np.float32)[:, None], 3, axis=1),
        np.ones((total, 3), np.float32),
    )
    prototypes = [furniture(str(name), detail=city.lod) for name in names]
    return replace(city, scene=city.scene.with_instances(layer, prototypes, rows))


def may_stand(city: City, found: Pieces) -> BoolArray:
    """(n,) whether things, as they are turned, keep off every carriageway and every embankment.

    What counts of a thing is its outline between ankle and head.
    """
    from cityx.assets.furniture.street_furniture import furniture

    free = np.isnan(earth_over(city.scene.meshes.get("structures"), found.xy))
    outlines = np.empty(len(found), object)
    names, number = np.unique(found.name.astype(str), return_inverse=True)
    for index, name in enumerate(names.tolist()):
        of = np.flatnonzero(number == index)
        ring = solid_ring(furniture(name, detail=city.lod).mesh.vertices)
        scale = np.repeat(found.scale[of, None], 2, axis=1)
        ring = ring if len(ring) else np.zeros((1, 2))
        outlines[of] = shapely.multipoints(placed_rings(ring, found.xy[of], found.yaw[of], scale))
    return free & ~in_lanes(city, shapely.convex_hull(outlines), found.xy)


def of_maps(table: GeoDataFrame) -> BoolArray:
    """(n,) whether things of the layout are of the user's map, not of a town that was made."""
    return ~np.asarray(table["source"].str.startswith((*OURS, "town/")), bool)


def walk_rims(ground: Ground, labels: Sequence[str] = WALKED) -> NDArray[Any]:
    """(k,) segments at which what people walk on ends: kerbs, walls, lawns, water."""
    walked = ground.labelled(*labels)
    left, right = ground.edge_faces.T.astype(np.int64)
    inside = np.where(right == BEYOND, False, walked[np.maximum(right, 0)])
    rim = walked[left] != inside
    return np.asarray(shapely.linestrings(ground.vertices[ground.edges[rim]]))


_SEGMENTS: Remembered[Segments] = Remembered()  # several questions in turn are about the same


def room_along(
    start: FloatArray, direction: FloatArray, rims: NDArray[Any], reach: float
) -> FloatArray:
    """(n,) metres from points along unit directions to the first rim, at most `reach`."""
    if not len(start) or not len(rims):
        return np.full(len(start), reach)
    return way_to(_SEGMENTS.get(lambda: segments_of(rims), (rims,)), start, direction, reach)


def ways_to_doors(city: City) -> NDArray[Any]:
    """(d,) straight lines from doors, along which one comes to them."""
    rows = city.scene.instances.get("doors")
    if rows is None or not rows.count:
        return np.zeros(0, object)
    foot = rows.position[:, :2]
    far = foot + DOOR_WAY * front(rows.rotation[:, 2])
    return np.asarray(shapely.linestrings(np.stack([foot, far], axis=1)))


def inside_extent(city: City, xy: FloatArray, margin: float = 0.0) -> BoolArray:
    """(n,) whether points lie in the site."""
    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = xy.T
    inside = (x >= xmin + margin) & (x <= xmax - margin)
    return np.asarray(inside & (y >= ymin + margin) & (y <= ymax - margin))


def in_carriageways(city: City, xy: FloatArray, depth: FloatArray) -> BoolArray:
    """(n,) whether things of a half size reach into a carriageway of the network."""
    network = city.network
    reaches = np.zeros(len(xy), bool)
    if network is None or not network.edge_count or not len(xy):
        return reaches
    lines = to_linestrings(network.lines)
    spots = shapely.points(xy)
    most = network.half_width + float(depth.max())
    line, spot = shapely.STRtree(spots).query(lines, predicate="dwithin", distance=most)
    gap = shapely.distance(spots[spot], lines[line]) - network.half_width[line]
    reaches[spot[gap < depth[spot]]] = True
    return reaches
