"""What stands in a finished city, by the names of the objects of its map."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cached_property
from typing import Any, cast

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.level_room import RAILS
from cityx.checks.predicates.building_predicates import Buildings
from cityx.city import City
from cityx.city.ground import DROPPED, KERB_HEIGHT
from cityx.city.layout import BAY
from cityx.city.levels import ground_levels
from cityx.city.section import BAND_KINDS
from cityx.geometry.arrays import FloatArray
from cityx.geometry.polylines import to_linestrings, values_along
from cityx.ground.walking.crosswalks import crosswalks_of
from cityx.ids import stable_id

STEP = 2.0  # metres between the places along walls at which the ground is looked up
AT_HOUSE = 0.5  # metres from an outline within which an entrance is one of its house
SAME = 0.7  # intersection over union from which two outlines are of one house
AT_KERB = 2.5  # metres from a kerb that the map draws as a point to that of the city
MOST = 0.5  # of a shape that other land of its tag covers where the map draws both
WATERS = ("water", "sea", "river", "pool")
ON_EDGE = 3.0  # metres from where ways cross to the middles of streets
_NAMED = re.compile(r"\b(?:node|way|relation)/\d+\b")  # in notes


class Finished:
    """What stands in a city, by the names of the map's objects; and the parts of buildings in it.

    Parameters
    ----------
    city
        The city.
    mapped_parts
        Shapes of the parts of buildings that the map draws, in the metres of the city.
    """

    def __init__(self, city: City, mapped_parts: NDArray[Any]) -> None:
        self.city = city
        self.mapped_parts = mapped_parts
        self._colors: dict[bool, Mapping[str, FloatArray]] = {}
        self._materials: dict[bool, Mapping[str, str]] = {}
        self._trees_of: dict[tuple[str, ...], shapely.STRtree] = {}
        self._kerb_trees: dict[str, shapely.STRtree] = {}

    @cached_property
    def buildings(self) -> Mapping[str, int]:
        """Rows of the buildings."""
        return _rows(self.city.layout.buildings)

    @cached_property
    def _outlines(self) -> shapely.STRtree:
        return shapely.STRtree(self.city.layout.buildings.geometry.to_numpy())

    def known_as(self, name: str, shape: shapely.Geometry) -> str:
        """Return the name under which a building stands, its own where none is.

        An outline may stand under the name of a relation that it is the outer way of, or of
        another drawing of the same house.
        """
        if name in self.buildings:
            return name
        shape = shapely.make_valid(shape)
        plans, best, found = self._outlines.geometries, SAME, name
        for row in sorted(self._outlines.query(shape, predicate="intersects").tolist()):
            # Courts are of the relation; its outer way alone has none.
            filled = shapely.Polygon(shapely.get_exterior_ring(plans[row]))
            both = shapely.union(filled, shape).area
            share = shapely.intersection(filled, shape).area / both
            other = str(self.city.layout.buildings["source"].to_numpy()[row])
            if share > best and other.startswith("osm/"):
                best, found = share, other.removeprefix("osm/")
        return found

    @cached_property
    def _walls(self) -> shapely.STRtree:
        return shapely.STRtree(shapely.boundary(self._outlines.geometries))

    def is_at_house(self, place: shapely.Geometry) -> bool:
        """Return whether a place is on the outline of a building."""
        return len(self._walls.query(place, "dwithin", AT_HOUSE)) > 0

    @cached_property
    def roads(self) -> Mapping[str, int]:
        """Rows of the streets; of a way that is a street and a railway that of the street."""
        table = self.city.layout.roads
        return _rows(table, np.argsort(~table["kind"].isin(RAILS).to_numpy(), kind="stable"))

    @cached_property
    def kinds(self) -> Mapping[str, frozenset[str]]:
        """Kinds of what is built of each object; one way may be a street and a tram line."""
        layout = self.city.layout
        found: dict[str, set[str]] = {name: {"building"} for name in self.buildings}
        for table in (layout.areas, layout.lines, layout.points, layout.roads):
            pairs = zip(table["source"].to_numpy(str), table["kind"].to_numpy(str), strict=True)
            for source, kind in pairs:
                found.setdefault(source.removeprefix("osm/"), set()).add(kind)
        return {name: frozenset(kinds) for name, kinds in found.items()}

    def covers(self, key: str, value: str, shape: shapely.Geometry) -> bool:
        """Return whether land of the same tag, or water, covers most of a shape in the site."""
        site = shapely.box(*self.city.layout.extent)
        own = shapely.intersection(shapely.make_valid(shape), site)
        table, shapes = self.city.layout.areas, self._land.geometries
        near = self._land.query(own, predicate="intersects")
        stated = np.array([f'"{key}": "{value}"' in table["tags"].iat[row] for row in near], bool)
        wet = table["kind"].iloc[near].isin(WATERS).to_numpy() & (key == "waterway")
        both = shapely.intersection(own, shapely.union_all(shapes[near[stated | wet]]))
        whole, part = ((one.area or one.length) for one in (own, both))
        return bool(part > MOST * whole)

    @cached_property
    def _land(self) -> shapely.STRtree:
        return shapely.STRtree(self.city.layout.areas.geometry.to_numpy())

    @cached_property
    def _failures(self) -> Mapping[int, str]:
        return {failure.object_id: failure.error for failure in self.city.failures}

    def failed(self, name: str) -> str:
        """Return why an object could not be built where the build names a reason, else ""."""
        kind, number = name.split("/")
        return self._failures.get(stable_id("osm", kind, int(number)), "")

    @cached_property
    def noted(self) -> Mapping[str, str]:
        """What the notes of the build say of the objects that they name."""
        found: dict[str, str] = {}
        for note in self.city.notes:
            for name in _NAMED.findall(note):
                found.setdefault(name, note.split(": osm/")[0])
        return found

    @cached_property
    def parts(self) -> Mapping[int, NDArray[np.int64]]:
        """Rows of the parts of each building, the largest first."""
        table = self.city.layout.parts
        owner = table["building"].to_numpy(np.uint64)
        return _grouped(owner, np.argsort(-shapely.area(table.geometry.to_numpy()), kind="stable"))

    @cached_property
    def edges(self) -> Mapping[int, NDArray[np.int64]]:
        """Edges of each row of the streets."""
        network = self.city.network
        if network is None:
            return {}
        return _grouped(network.edge_road, np.arange(len(network.edge_road)))

    @cached_property
    def _standing(self) -> Mapping[str, FloatArray]:
        """Places of all that stands in the scene, by the names of its prototypes; trees by ""."""
        names = np.array([one.name for one in self.city.scene.prototypes], str)
        found: dict[str, list[FloatArray]] = {}
        for group, table in self.city.scene.instances.items():
            places = np.asarray(table.position[:, :2], float)
            if group == "trees":
                found.setdefault("", []).append(places)
                continue
            for kind in np.unique(table.prototype).tolist():
                found.setdefault(str(names[kind]), []).append(places[table.prototype == kind])
        return {name: np.vstack(places) for name, places in found.items()}

    @cached_property
    def _own_places(self) -> tuple[NDArray[np.uint64], FloatArray]:
        """Objects of what stands in the scene, rising, and the first place of each."""
        tables = [table for _, table in sorted(self.city.scene.instances.items())]
        if not tables:
            return np.zeros(0, np.uint64), np.zeros((0, 2))
        ids, first = np.unique(
            np.concatenate([table.object_id for table in tables]), return_index=True
        )
        return ids, np.concatenate([table.position[:, :2] for table in tables])[first]

    def moved(self, name: str, place: shapely.Geometry) -> float:
        """Return how far from a place an object of the map stands, metres; NaN for nowhere."""
        kind, number = name.split("/")
        ids, places = self._own_places
        own = np.uint64(stable_id("osm", kind, int(number)))
        row = int(np.searchsorted(ids, own))
        if row == len(ids) or ids[row] != own:
            return np.nan
        return float(np.hypot(*(places[row].astype(float) - (place.x, place.y))))

    def is_near(self, begins: tuple[str, ...], place: shapely.Geometry, far: float) -> bool:
        """Return whether something of a kind stands near a place; trees where no name is given."""
        if begins not in self._trees_of:
            chosen = [
                places for name, places in self._standing.items()
                if (name.startswith(begins) if begins else not name)
            ]  # fmt: skip
            points = shapely.points(np.vstack(chosen)) if chosen else []
            self._trees_of[begins] = shapely.STRtree(points)
        return len(self._trees_of[begins].query(place, "dwithin", far)) > 0

    @cached_property
    def _building_ids(self) -> list[int]:
        return cast("list[int]", self.city.layout.buildings["id"].to_numpy(np.uint64).tolist())

    def colors(self, walls: bool) -> Mapping[str, FloatArray]:
        """Return the mean colours of the meshes of walls or roofs, linear RGB, by building."""
        if walls not in self._colors:
            means = dict(zip(self._looks.ids.tolist(), self._looks.mean_colors(walls=walls),
                             strict=True))  # fmt: skip
            ids, names = self._building_ids, self.buildings.items()
            self._colors[walls] = {name: means[ids[row]] for name, row in names
                                   if ids[row] in means}  # fmt: skip
        return self._colors[walls]

    def materials(self, walls: bool) -> Mapping[str, str]:
        """Return the material of most of the walls or roofs of each building that has some."""
        if walls not in self._materials:
            found = dict(zip(self._looks.ids.tolist(), self._looks.main_materials(walls=walls),
                             strict=True))  # fmt: skip
            ids = self._building_ids
            self._materials[walls] = {name: found[ids[row]] for name, row in self.buildings.items()
                                      if found.get(ids[row])}  # fmt: skip
        return self._materials[walls]

    @cached_property
    def _looks(self) -> Buildings:
        """The buildings as predicates see them."""
        return Buildings(self.city, "building")

    @cached_property
    def _mapped_parts(self) -> shapely.STRtree:
        return shapely.STRtree(self.mapped_parts)

    def left_of(self, outline: shapely.Geometry) -> float:
        """Return the area of an outline on which the map draws no part, square metres."""
        near = self._mapped_parts.query(outline, "intersects")
        return float(shapely.difference(outline, shapely.union_all(self.mapped_parts[near])).area)

    def parts_of(self, name: str) -> NDArray[np.int64]:
        """Return the rows of the parts of a building."""
        building = self._building_ids[self.buildings[name]]
        return self.parts.get(building, np.zeros(0, np.int64))

    def heights_of(self, name: str) -> FloatArray:
        """Return the height of each part of a building above the lowest ground at its walls.

        That of the building counts for all, but for the bays of a house that steps down a slope,
        which are its parts where none is drawn on the map.
        """
        rows = self.parts_of(name)
        lowest, tops = self._ground_at_parts[rows], self._tops[rows]
        in_bays = self._in_bays[rows]
        common = lowest.min() if len(rows) else 0.0
        return np.asarray(tops - np.where(in_bays, lowest, common) - KERB_HEIGHT)

    @cached_property
    def _in_bays(self) -> NDArray[np.bool_]:
        """Whether every part is a bay."""
        return np.asarray(self.city.layout.parts["zone"].to_numpy(str) == BAY)

    @cached_property
    def _tops(self) -> FloatArray:
        """Absolute height of the top of every part."""
        layout = self.city.layout
        top = layout.parts["top"].to_numpy(float)
        return np.asarray(ground_levels(layout, self.city.terrain) + top)

    @cached_property
    def _ground_at_parts(self) -> FloatArray:
        """Lowest terrain at the walls of every part, metres."""
        walls = shapely.segmentize(self.city.layout.parts.geometry.to_numpy(), STEP)
        points, of = shapely.get_coordinates(walls, return_index=True)
        found: FloatArray = np.full(len(walls), np.inf)
        np.minimum.at(found, of, self.city.terrain.height_at(points))
        return found

    def part(self, name: str, column: str) -> Any:
        """Return a value of the largest part of a building."""
        return self.city.layout.parts[column].to_numpy()[self.parts_of(name)[0]]

    @cached_property
    def crosswalks(self) -> NDArray[Any]:
        """Lines along which people cross streets on the finished ground."""
        ground, network = self.city.ground, self.city.network
        if ground is None or network is None:
            return np.zeros(0, object)
        return np.asarray(
            shapely.linestrings(crosswalks_of(ground, self.city.layout, network).ends), object
        )

    def kerb_near(self, place: shapely.Geometry) -> float:
        """Return the height of the kerb that is nearest to a place, metres; NaN without one."""
        ground = self.city.ground
        if ground is None:
            return np.nan
        far = {height: self._kerbs(name).query_nearest(place, max_distance=AT_KERB,
                                                       return_distance=True)[1]
               for name, height in (("kerb_dropped", DROPPED), ("kerb", KERB_HEIGHT))}  # fmt: skip
        near = {height: float(found.min()) for height, found in far.items() if len(found)}
        return min(near, key=lambda height: near[height], default=np.nan)

    def _kerbs(self, name: str) -> shapely.STRtree:
        if name not in self._kerb_trees:
            ground = self.city.ground
            assert ground is not None
            corners = ground.vertices[ground.triangles_of(name)]
            self._kerb_trees[name] = shapely.STRtree(shapely.polygons(corners))
        return self._kerb_trees[name]

    @cached_property
    def _edge_lines(self) -> shapely.STRtree:
        network = self.city.network
        return shapely.STRtree([] if network is None else to_linestrings(network.lines))

    def height_of_way(self, name: str, way: shapely.Geometry, place: shapely.Geometry) -> float:
        """Return the height of a street at a place that it leads over, NaN where there is none."""
        network = self.city.network
        own = self._edges_named.get(name, frozenset())
        edges = [edge for edge in self._edge_lines.query(place, "dwithin", ON_EDGE).tolist()
                 if edge in own]  # fmt: skip
        if network is None or not edges:
            return np.nan
        bearing = _bearing(way, place)

        def turned(edge: int) -> float:
            return abs(float(np.sin(_bearing(self._edge_lines.geometries[edge], place) - bearing)))

        edge = min(edges, key=turned)
        along = shapely.line_locate_point(self._edge_lines.geometries[edge], place)
        return float(values_along(network.lines, network.z, [edge], [along])[0])

    @cached_property
    def _edges_named(self) -> Mapping[str, frozenset[int]]:
        """Edges of all rows of the streets that bear a name; the site may cut a way in pieces."""
        found: dict[str, set[int]] = {}
        sources = self.city.layout.roads["source"].to_numpy(str).tolist()
        for row, edges in self.edges.items():
            found.setdefault(sources[row].removeprefix("osm/"), set()).update(edges.tolist())
        return {name: frozenset(edges) for name, edges in found.items()}

    def is_driven(self, name: str) -> bool:
        """Return whether a street is in the network."""
        return name in self._edges_named

    def barrier(self, name: str) -> FloatArray:
        """(v, 3) corners of what stands of a barrier."""
        batch = self.city.scene.meshes.get("barriers")
        if batch is None:
            return np.zeros((0, 3))
        rows = np.isin(batch.object_id, self._lines.get(name, np.zeros(0, np.uint64)))
        return np.asarray(batch.take(np.flatnonzero(rows)).vertices, float)

    @cached_property
    def _lines(self) -> Mapping[str, NDArray[np.uint64]]:
        """Ids of the lines that stand of each object."""
        table = self.city.layout.lines
        ids: dict[str, list[int]] = {}
        for source, number in zip(table["source"].tolist(), table["id"].tolist(), strict=True):
            ids.setdefault(str(source).removeprefix("osm/"), []).append(int(number))
        return {name: np.array(own, np.uint64) for name, own in ids.items()}

    def bands_of(self, name: str) -> list[NDArray[np.int64]]:
        """Return all bands of each edge of a street, walks too, those of one edge together."""
        row = self.roads.get(name, -1)
        none = np.zeros(0, np.int64)
        return [self._bands.get(int(edge), none) for edge in self.edges.get(row, ())]

    def carriageway_of(self, name: str) -> list[NDArray[np.int64]]:
        """Return what lies between the kerbs of each edge of a street but parked cars."""
        lanes = self.city.lanes
        kinds = [BAND_KINDS.index(kind) for kind in ("drive", "bus", "cycle", "shoulder")]
        return [rows[np.isin(lanes.kind[rows], kinds)] if lanes is not None else rows
                for rows in self.bands_of(name)]  # fmt: skip

    @cached_property
    def _bands(self) -> Mapping[int, NDArray[np.int64]]:
        lanes = self.city.lanes
        return {} if lanes is None else _grouped(lanes.edge, np.arange(lanes.count))

    def lanes_of(self, name: str) -> list[NDArray[np.int64]]:
        """Return the lanes for vehicles of each edge of a street, those of one edge together."""
        row = self.roads.get(name, -1)
        none = np.zeros(0, np.int64)
        return [self._lanes.get(int(edge), none) for edge in self.edges.get(row, ())]

    @cached_property
    def _lanes(self) -> Mapping[int, NDArray[np.int64]]:
        """Lanes for vehicles of each edge of the network."""
        lanes = self.city.lanes
        if lanes is None:
            return {}
        driven = np.isin(lanes.kind, [BAND_KINDS.index("drive"), BAND_KINDS.index("bus")])
        return _grouped(lanes.edge, np.flatnonzero(driven))


def _bearing(line: shapely.Geometry, place: shapely.Geometry) -> float:
    """Return the direction of a line at a place, radians."""
    along = float(shapely.line_locate_point(line, place))
    ends = shapely.get_coordinates(
        shapely.line_interpolate_point(line, [max(along - 1.0, 0.0), along + 1.0])
    )
    return float(np.arctan2(*(ends[1] - ends[0])[::-1]))


def _grouped(key: NDArray[Any], rows: NDArray[np.int64]) -> dict[int, NDArray[np.int64]]:
    """Return rows by their keys, in the order that they come in."""
    if not len(rows):
        return {}
    ordered = rows[np.argsort(key[rows], kind="stable")]
    keys, first = np.unique(key[ordered], return_index=True)
    return dict(zip(keys.tolist(), np.split(ordered, first[1:]), strict=True))


def _rows(table: Any, order: NDArray[np.int64] | None = None) -> dict[str, int]:
    """Return the row of each name; of several the last, in the order given."""
    rows = np.arange(len(table)) if order is None else order
    sources = table["source"].to_numpy(str)[rows]
    pairs = zip(sources.tolist(), rows.tolist(), strict=True)
    return {one.removeprefix("osm/"): row for one, row in pairs if one}
