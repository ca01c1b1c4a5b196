"""Tables of a city for people: GeoDataFrames with a coordinate system, one row per thing.

Each is indexed by the stable id of its things, unsigned 64-bit, as in reports and exports. They are
made of the city's own tables and arrays, which have no coordinate system, and are never read back.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.ground import SURFACES
from cityx.city.lanes import LaneGraph
from cityx.city.section import BAND_KINDS, TURN, TURNS
from cityx.city.tracks import MOVER_KINDS, poses_at
from cityx.errors import UsageError, nearest
from cityx.ids import stable_id

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

WATER = ("water", "sea", "river", "pool", "wetland")
FURNITURE = ("street_furniture", "street_pieces", "park_pieces", "tree_pits")
JUNCTION = 3  # arms at which a node of the road network is a junction
_WAYS = ("source", "tags")


def table_of(
    city: City, ids: NDArray[np.uint64], geometry: Any, columns: Mapping[str, Any]
) -> GeoDataFrame:
    """Make a table of things.

    Parameters
    ----------
    city
        Whose frame is the coordinate system.
    ids, geometry
        (n,) ids and shapes, metres.
    columns
        (n,) values by name.
    """
    import pandas as pd
    from geopandas import GeoDataFrame

    index = pd.Index(np.asarray(ids, np.uint64), name="id")
    return GeoDataFrame(dict(columns), geometry=np.asarray(geometry, object), index=index,
                        crs=city.frame.projection)  # fmt: skip


def _of_layout(city: City, name: str, columns: Iterable[str] = (), **more: Any) -> GeoDataFrame:
    """Return a table of the layout: some columns first, its other ones after them."""
    table = getattr(city.layout, name)
    first = [column for column in columns if column in table]
    rest = [c for c in table.columns if c not in (*first, *_WAYS, "id", "geometry")]
    found = {column: table[column].array for column in (*first, *rest)} | more
    if "source" in table:
        found["source"] = table["source"].array
    if "tags" in table:
        found["tags"] = [json.loads(text) if text else {} for text in table["tags"]]
    return table_of(city, table["id"].to_numpy(np.uint64), table.geometry.to_numpy(), found)


class Tables(ABC):
    """The tables of a city."""

    @property
    @abstractmethod
    def city(self) -> City:
        """The city."""

    @property
    def buildings(self) -> GeoDataFrame:
        """The buildings by their outlines; height and ground are metres."""
        middles = shapely.get_coordinates(
            shapely.centroid(self.city.layout.buildings.geometry.to_numpy())
        ).reshape(-1, 2)
        columns = ("name", "use", "height", "levels", "generator", "place")
        return _of_layout(
            self.city, "buildings", columns, ground=self.city.terrain.height_at(middles)
        )

    @property
    def parts(self) -> GeoDataFrame:
        """The volumes that buildings are made of; "building" is the id of theirs."""
        return _of_layout(
            self.city, "parts", ("building", "use", "base", "top", "levels", "roof_shape")
        )

    @property
    def roads(self) -> GeoDataFrame:
        """The ways that carry movement, in driving direction; widths are metres."""
        columns = ("name", "kind", "lanes", "width", "oneway", "maxspeed_kmh", "surface")
        return _of_layout(self.city, "roads", columns)

    @property
    def land(self) -> GeoDataFrame:
        """The regions of the map that are no water: parks, plazas, car parks, ..."""
        table = _of_layout(self.city, "areas", ("name", "kind"))
        return table[~table["kind"].isin(WATER)]

    @property
    def water(self) -> GeoDataFrame:
        """The regions of the map that are water."""
        table = _of_layout(self.city, "areas", ("name", "kind"))
        return table[table["kind"].isin(WATER)]

    @property
    def lanes(self) -> GeoDataFrame:
        """The lanes by their middles, in the direction of travel.

        "road" is the id of the way, "next" are the ids of the lanes that traffic goes on to.
        """
        graph, network = self.city.lanes, self.city.network
        if graph is None or network is None:
            return _nothing(
                self.city, "road", "kind", "direction", "width", "speed_kmh", "turns", "next"
            )
        part = np.repeat(np.arange(graph.count), np.diff(graph.point_start))
        filled = np.diff(graph.point_start) >= 2
        shapes = np.full(graph.count, shapely.LineString(), object)
        whole = filled[part]
        shapes[filled] = shapely.linestrings(
            graph.points[whole], indices=np.cumsum(filled)[part[whole]] - 1
        )
        ids = self.city.layout.roads["id"].to_numpy(np.uint64)
        road = ids[network.edge_road[graph.edge]]
        turns = [
            ";".join(name for name in TURNS if bits & TURN[name]) for bits in graph.turns.tolist()
        ]
        return table_of(self.city, graph.lane_id, shapes, {
            "road": road, "kind": np.array(BAND_KINDS, object)[graph.kind],
            "direction": graph.direction, "width": graph.left - graph.right,
            "speed_kmh": graph.speed, "turns": turns, "next": _following(graph),
        })  # fmt: skip

    @property
    def junctions(self) -> GeoDataFrame:
        """Where three or more carriageways meet; the id is that of the place."""
        network = self.city.network
        if network is None:
            return _nothing(self.city, "arms")
        rows = np.flatnonzero(network.node_degree >= JUNCTION)
        places = network.node_position[rows]
        ids = np.array([stable_id("junction", *map("{:.2f}".format, xy)) for xy in places.tolist()],
                       np.uint64)  # fmt: skip
        return table_of(self.city, ids, shapely.points(places), {"arms": network.node_degree[rows]})

    @property
    def ground(self) -> GeoDataFrame:
        """The faces of the ground, which leave no gap and no overlap; rows are numbered.

        "surface" is what it is made of, "object" the id of the road, area or building that it
        belongs to, 0 for none.
        """
        import pandas as pd

        faces = self.city.ground
        if faces is None:
            return _nothing(self.city, "surface", "object")
        count = len(faces.face_label)
        # Each face is what its edges enclose; an edge bounds the face on either hand.
        sides = faces.edge_faces.T.ravel()
        lines = shapely.linestrings(faces.vertices[np.tile(faces.edges, (2, 1))])
        order = np.argsort(sides, kind="stable")
        order = order[sides[order] >= 0]
        shapes = np.full(count, shapely.Polygon(), object)
        held = np.unique(sides[order])
        shapes[held] = shapely.build_area(
            shapely.multilinestrings(lines[order], indices=np.searchsorted(held, sides[order]))
        )
        names = np.array([surface.name for surface in SURFACES], object)
        table = table_of(self.city, faces.face_object, shapes, {
            "surface": names[faces.face_label], "object": faces.face_object,
        })  # fmt: skip
        return table.set_index(pd.RangeIndex(count, name="face"))

    @property
    def trees(self) -> GeoDataFrame:
        """The trees by their places on the ground; "height" is metres."""
        return placed(self.city, "trees")

    @property
    def furniture(self) -> GeoDataFrame:
        """Lamps, benches, bollards, stops and whatever else stands in streets and parks."""
        return placed(
            self.city, *(layer for layer in FURNITURE if layer in self.city.scene.instances)
        )

    @property
    def vehicles(self) -> GeoDataFrame:
        """The parked vehicles, and those that drive, at the city's moment."""
        import pandas as pd

        parked = placed(
            self.city, *(layer for layer in ("vehicles",) if layer in self.city.scene.instances)
        )
        parked = parked.assign(kind="parked", speed=0.0)
        moving = self.movers
        driving = moving[~moving["on_foot"]].drop(columns="on_foot")
        return pd.concat([parked, driving]) if len(driving) else parked

    @property
    def people(self) -> GeoDataFrame:
        """The people and animals on foot, at the city's moment."""
        moving = self.movers
        return moving[moving["on_foot"]].drop(columns="on_foot")

    @property
    def movers(self) -> GeoDataFrame:
        """What moves by itself, at the city's moment; "speed" is metres per second."""
        tracks = self.city.tracks
        if tracks is None:
            return _nothing(self.city, "kind", "look", "z", "heading", "height", "speed").assign(
                on_foot=np.zeros(0, bool)
            )
        poses = poses_at(tracks, self.city.moment)
        kinds = np.array(MOVER_KINDS, object)
        rows = poses.row
        return table_of(self.city, tracks.object_id[rows], shapely.points(poses.position[:, :2]), {
            "kind": kinds[tracks.kind[rows]], "look": tracks.look[rows].astype(object),
            "z": poses.position[:, 2], "heading": poses.heading, "height": tracks.size[rows, 2],
            "speed": poses.speed, "on_foot": tracks.on_foot[rows],
        })  # fmt: skip

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of the layers of placed things, for `layer`."""
        return tuple(self.city.scene.instances)

    def layer(self, name: str) -> GeoDataFrame:
        """Return the things of a layer: windows, doors, trims, roof_furniture, trees, ...

        Raises
        ------
        UsageError
            If there is no such layer.
        """
        return placed(self.city, name)


def _following(graph: LaneGraph) -> list[list[int]]:
    found: list[list[int]] = [[] for _ in range(graph.count)]
    for before, after in graph.connection.tolist():
        found[before].append(int(graph.lane_id[after]))
    return found


def placed(city: City, *layers: str) -> GeoDataFrame:
    """Return the things of layers of instances: trees, windows, street_furniture, vehicles, ...

    "look" is the mesh that shows a thing, "owner" the id of the building it belongs to, 0 for none,
    "heading" its turn counter-clockwise, radians, "height" metres.

    Raises
    ------
    UsageError
        If there is no such layer.
    """
    instances = city.scene.instances
    for layer in layers:
        if layer not in instances:
            hint = nearest(layer, instances) or f" There are {', '.join(instances) or 'none'}."
            raise UsageError(f'There is no layer "{layer}".{hint}')
    columns = ("layer", "look", "z", "heading", "height", "owner")
    if not layers:
        return _nothing(city, *columns)
    rows = [instances[layer] for layer in layers]
    prototypes = city.scene.prototypes
    used = np.concatenate([row.prototype for row in rows])
    place = np.concatenate([row.position for row in rows])
    tall = np.zeros(len(prototypes))
    for number in np.unique(used).tolist():
        z = prototypes[number].mesh.vertices[:, 2]
        tall[number] = z.max() - z.min() if len(z) else 0.0
    values = (
        np.repeat(np.array(layers, object), [row.count for row in rows]),
        np.array([prototypes[number].name for number in used], object),
        place[:, 2],
        np.concatenate([row.rotation[:, 2] for row in rows]),
        tall[used] * np.concatenate([row.scale[:, 2] for row in rows]),
        np.concatenate([row.owner for row in rows]),
    )
    ids = np.concatenate([row.object_id for row in rows])
    return table_of(city, ids, shapely.points(place[:, :2]),
                    dict(zip(columns, values, strict=True)))  # fmt: skip


def _nothing(city: City, *columns: str) -> GeoDataFrame:
    """Return a table without rows."""
    return table_of(city, np.zeros(0, np.uint64), [], {name: np.zeros(0) for name in columns})
