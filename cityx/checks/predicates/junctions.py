"""Blocks, junctions, roundabouts and dead ends: what the lines of streets make together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.thing_predicates import CannotTell, Layer, UInt64Array, column
from cityx.city import City
from cityx.city.layout import NONE_THERE
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.ground.walking.crosswalks import Crosswalks, crosswalks_of
from cityx.ids import hash_ids

AROUND_END, RAMP_REACH = 12, 2.6  # ways looked round an end of a crossing, and how far, metres
LOWERED = ("kerb_dropped", "ramp", "landing")
CONES_APART, LEAST_CONES = 14.0, 6  # metres between, and number, of what closes a street
CLIMBS, ALONGSIDE = 0.3, 12.0  # metres that steps climb; metres from them to their ramp
AT_WALL, BAYS_APART = 2.2, 3.4  # metres from a scaffold to its wall, and between its bays
PLACE = 1000.0  # per metre: ends meet where they are equal to the millimetre
TOGETHER = 14.0  # metres between meeting points that are one junction
AT_BORDER = 2.0  # metres; a street that ends there goes on beyond the site
ROUND, LARGEST_RING = 0.88, 60.0  # roundness, and metres of radius, of the ring of a roundabout
SIGNALS = 32.0  # metres from a junction to the lights that rule it
THIN, LEAST = 6.0, 400.0  # metres, square metres; what is less between streets is no block
LEAST_HEADS = 2  # poles with lights that make a junction signalled


def street_rows(city: City) -> Any:
    """Return the rows of the streets that cars use, those on the ground."""
    roads = city.layout.roads
    cars = np.isin(column(roads, "kind"), words.ROADS)
    level = (roads["layer"].to_numpy() == 0) & ~roads["tunnel"].to_numpy(bool)
    return roads[cars & level]


@dataclass(frozen=True)
class Net:
    """The lines of streets as a graph.

    Attributes
    ----------
    places
        (n, 2) where streets end or meet, metres.
    arms
        (n,) stretches of street that leave each.
    """

    places: FloatArray
    arms: IntArray


def net_of(city: City) -> Net:
    """Return where the streets of a city end and meet."""
    lines = street_rows(city).geometry.to_numpy()
    points, line = shapely.get_coordinates(lines, return_index=True)
    if not len(points):
        return Net(np.zeros((0, 2)), np.zeros(0, np.int64))
    first = np.append(True, np.diff(line) > 0)
    last = np.append(np.diff(line) > 0, True)
    whole, of = np.unique(np.rint(points * PLACE).astype(np.int64), axis=0, return_inverse=True)
    arms = np.bincount(of.ravel(), 2 - first.astype(int) - last.astype(int), minlength=len(whole))
    return Net(whole / PLACE, arms.astype(np.int64))


@dataclass(frozen=True)
class Spots(Layer):
    """Places of a kind that have no row in a table of the layout."""

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) places."""
        raise NotImplementedError

    @cached_property
    def ids(self) -> UInt64Array:
        """(n,) ids by place."""
        at = shapely.get_coordinates(shapely.centroid(self.shapes)).reshape(-1, 2)
        x, y = np.rint(at * 10).astype(np.int64).T
        return hash_ids(0, self.kind, x.view(np.uint64), y.view(np.uint64))


@dataclass(frozen=True)
class Blocks(Spots):
    """Land that streets enclose on all sides, between their walks."""

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) polygons."""
        roads = street_rows(self.city)
        lines = roads.geometry.to_numpy()
        faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(lines))))
        walks = roads[list(NONE_THERE)].max(axis=1).to_numpy(float)
        half = np.nan_to_num(roads["width"].to_numpy(float)) / 2 + np.nan_to_num(walks)
        taken = shapely.union_all(shapely.buffer(lines, half, quad_segs=4))
        land = shapely.difference(faces, taken)
        open_ = shapely.buffer(shapely.buffer(land, -THIN / 2, quad_segs=4), THIN / 2, quad_segs=4)
        parts, of = shapely.get_parts(shapely.intersection(land, open_), return_index=True)
        area = shapely.area(parts)
        order = np.lexsort((-area, of))
        largest = order[np.unique(of[order], return_index=True)[1]] if len(of) else order
        found = parts[largest]
        return np.asarray(found[shapely.area(found) >= LEAST], object)

    def number(self, attribute: str) -> FloatArray:
        """Return areas, or the shorter and longer sides of the smallest rectangles round them."""
        if attribute == "area":
            return np.asarray(shapely.area(self.shapes))
        if attribute not in ("width", "length"):
            return super().number(attribute)
        corner = shapely.get_coordinates(shapely.oriented_envelope(self.shapes)).reshape(-1, 5, 2)
        side = np.hypot(*(corner[:, 1:3] - corner[:, :2]).transpose(2, 0, 1))  # (n, 2)
        return np.asarray(side.min(axis=1) if attribute == "width" else side.max(axis=1))


@dataclass(frozen=True)
class Roundabouts(Spots):
    """Round rings of one-way streets, by their shape."""

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) polygons that the middles of the rings enclose."""
        roads = street_rows(self.city)
        lines = roads.geometry.to_numpy()[roads["oneway"].to_numpy(bool)]
        faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(lines))))
        area, border = shapely.area(faces), shapely.length(shapely.boundary(faces))
        fine = 4 * np.pi * area >= ROUND * border**2
        return np.asarray(faces[fine & (area <= np.pi * LARGEST_RING**2)], object)

    def number(self, attribute: str) -> FloatArray:
        """Return areas or diameters."""
        if attribute == "area":
            return np.asarray(shapely.area(self.shapes))
        if attribute == "width":
            return np.asarray(2 * np.sqrt(shapely.area(self.shapes) / np.pi))
        return super().number(attribute)


@dataclass(frozen=True)
class DeadEnds(Spots):
    """Ends of streets within the site at which no other goes on."""

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) points."""
        net = net_of(self.city)
        ends = shapely.points(net.places[net.arms == 1].reshape(-1, 2))
        border = shapely.box(*self.city.layout.extent).exterior
        return np.asarray(ends[shapely.distance(ends, border) > AT_BORDER], object)


@dataclass(frozen=True)
class Junctions(Spots):
    """Where three stretches of street or more meet; those near each other as one."""

    @cached_property
    def _groups(self) -> tuple[NDArray[Any], IntArray, FloatArray, IntArray]:
        """Middles and arms of junctions; their meeting points, and the junction of each."""
        net = net_of(self.city)
        joint = net.arms >= 3
        spots = shapely.points(net.places[joint].reshape(-1, 2))
        pairs = shapely.STRtree(spots).query(spots, predicate="dwithin", distance=TOGETHER)
        label = np.asarray(components(np.column_stack(pairs), len(spots)), np.int64)
        count = int(label.max(initial=-1)) + 1
        places = np.array(
            [shapely.union_all(spots[label == k]).centroid for k in range(count)], object
        )
        arms = np.bincount(label, net.arms[joint] - 2, minlength=count).astype(np.int64) + 2
        return places, arms, net.places[joint], label

    def meeting(self, row: int) -> FloatArray:
        """Return the places, (k, 2), at which the streets of a junction meet."""
        _, _, places, label = self._groups
        return np.asarray(places[label == row])

    @property
    def shapes(self) -> NDArray[Any]:
        """(n,) points."""
        return self._groups[0]

    def number(self, attribute: str) -> FloatArray:
        """Return how many streets meet."""
        return self._groups[1].astype(float) if attribute == "arms" else super().number(attribute)

    def has(self, attribute: str, word: str) -> BoolArray:
        """Return which are ruled by lights: those that stand there, else those of the layout."""
        if attribute != "signals":
            return super().has(attribute, word)
        lights, least = _lights(self.city)
        ruled = np.zeros(len(self.shapes), np.int64)
        if len(self.shapes) and len(lights):
            spots = shapely.points(lights)
            _, nearest = shapely.STRtree(self.shapes).query_nearest(
                spots, max_distance=SIGNALS, all_matches=False
            )
            ruled = np.bincount(nearest, minlength=len(self.shapes))
        return np.asarray((ruled >= least) == (word == "true"))


@dataclass(frozen=True)
class Crossings(Spots):
    """Where people cross roadways, from walk to walk."""

    @cached_property
    def _found(self) -> Crosswalks:
        ground, network = self.city.ground, self.city.network
        if ground is None or network is None:
            raise CannotTell("the ground is not laid yet")
        found = crosswalks_of(ground, self.city.layout, network)
        return found.take(found.marked | found.lowered)

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) lines from walk to walk."""
        return np.asarray(shapely.linestrings(self._found.ends), object)

    def has(self, attribute: str, word: str) -> BoolArray:
        """Return which have lowered kerbs at both ends, seen on the ground."""
        if attribute != "ramps":
            return super().has(attribute, word)
        ground = self.city.ground
        assert ground is not None
        turn = np.arange(AROUND_END) * 2 * np.pi / AROUND_END
        round_ = np.column_stack([np.cos(turn), np.sin(turn)])
        reach = np.arange(0.25, RAMP_REACH, 0.25)
        near = (reach[:, None, None] * round_[None]).reshape(-1, 2)
        spots = self._found.ends[:, :, None] + near[None, None]
        low = ground.on(spots.reshape(-1, 2), *LOWERED).reshape(spots.shape[:3])
        return np.asarray(low.any(axis=2).all(axis=1) == (word == "true"))


@dataclass(frozen=True)
class RoadWorks(Spots):
    """Places on streets that cones and barriers close."""

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) hulls of what stands together."""
        at, _ = standing_pieces(self.city, ("traffic_cone", "work_barrier"))
        spots = shapely.points(at)
        pairs = shapely.STRtree(spots).query(spots, predicate="dwithin", distance=CONES_APART)
        label = np.asarray(components(np.column_stack(pairs), len(spots)), np.int64)
        groups = [spots[label == k] for k in range(int(label.max(initial=-1)) + 1)]
        found = [shapely.union_all(one).convex_hull for one in groups if len(one) >= LEAST_CONES]
        return np.array(found, object)


@dataclass(frozen=True)
class Scaffolding(Spots):
    """Scaffolds: bays that stand side by side, before a house."""

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) hulls of what stands together."""
        at, _ = standing_pieces(self.city, ("scaffold",))
        spots = shapely.points(at)
        houses = self.city.layout.buildings.geometry.to_numpy()
        by = shapely.STRtree(houses).query(spots, predicate="dwithin", distance=AT_WALL)[0]
        spots = spots[np.unique(by)]
        pairs = shapely.STRtree(spots).query(spots, predicate="dwithin", distance=BAYS_APART)
        label = np.asarray(components(np.column_stack(pairs), len(spots)), np.int64)
        groups = [spots[label == k] for k in range(int(label.max(initial=-1)) + 1)]
        return np.array([shapely.union_all(one).convex_hull for one in groups], object)


@dataclass(frozen=True)
class Steps(Spots):
    """Streets of steps: where treads stand, before they do where the land climbs."""

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) lines."""
        roads = self.city.layout.roads
        own = roads[column(roads, "kind") == "steps"]
        lines = own.geometry.to_numpy()
        mesh = self.city.scene.meshes.get("stairs")
        if mesh is not None:
            at = shapely.points(mesh.vertices[:, :2])
            wide = shapely.buffer(lines, own["width"].to_numpy(float) / 2, cap_style="flat")
            on = np.unique(shapely.STRtree(at).query(wide, predicate="intersects")[0])
            return np.asarray(lines[on], object)
        ends = shapely.get_coordinates(shapely.get_point(lines[:, None], [[0, -1]]))
        z = self.city.terrain.height_at(ends.reshape(-1, 2)).reshape(-1, 2)
        return np.asarray(lines[np.abs(np.diff(z, axis=1))[:, 0] >= CLIMBS], object)


@dataclass(frozen=True)
class Ramps(Spots):
    """Ways without steps that lead beside steps from their foot to their head."""

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) lines."""
        roads = self.city.layout.roads
        walked = np.isin(column(roads, "kind"), words.PATHS) & (column(roads, "kind") != "steps")
        lines = roads.geometry.to_numpy()[walked]
        found = [
            line
            for line in lines.tolist()
            for one in Steps(self.city, "steps").shapes.tolist()
            if line.hausdorff_distance(one) <= ALONGSIDE
        ]
        return np.array(found, object)


def standing_pieces(city: City, names: tuple[str, ...]) -> tuple[FloatArray, bool]:
    """Return where pieces of some names are, and whether they stand or are but in the layout."""
    scene = city.scene
    own = np.array([p.name.startswith(names) for p in scene.prototypes] or [False])
    rows = [r.position[own[r.prototype], :2] for r in scene.instances.values()]
    standing = np.concatenate([np.zeros((0, 2)), *rows])
    if len(standing):
        return standing, True
    points = city.layout.points
    mapped = points.geometry.to_numpy()[np.isin(column(points, "kind"), names)]
    return shapely.get_coordinates(mapped).reshape(-1, 2), False


def _lights(city: City) -> tuple[FloatArray, int]:
    """Return the places of traffic lights, and how many make a junction signalled."""
    scene = city.scene
    lit = np.array([p.name.startswith("traffic_signal") for p in scene.prototypes] or [False])
    rows = [r.position[lit[r.prototype], :2] for r in scene.instances.values()]
    standing = np.concatenate([np.zeros((0, 2)), *rows])
    if len(standing):
        return standing, LEAST_HEADS
    points = city.layout.points
    mapped = points.geometry.to_numpy()[column(points, "kind") == "traffic_signals"]
    return shapely.get_coordinates(mapped).reshape(-1, 2), 1


LAYERS: Mapping[str, type[Layer]] = {
    "block": Blocks, "roundabout": Roundabouts, "dead_end": DeadEnds, "junction": Junctions,
    "crosswalk": Crossings, "road_works": RoadWorks,
    "scaffolding": Scaffolding, "steps": Steps, "ramp": Ramps,
}  # fmt: skip
