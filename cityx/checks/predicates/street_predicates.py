"""Streets, paths, railways and bridges, measured on the road network and the lanes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import material_named
from cityx.checks.predicates import words
from cityx.checks.predicates.building_predicates import looks_of_faces
from cityx.checks.predicates.finding import Measured
from cityx.checks.predicates.hubs import avenues, rings
from cityx.checks.predicates.junctions import standing_pieces
from cityx.checks.predicates.places import places_of
from cityx.checks.predicates.street_pattern import Pattern, pattern_of
from cityx.checks.predicates.thing_predicates import (
    Absent,
    CannotTell,
    Layer,
    TableLayer,
    UInt64Array,
    column,
    union,
)
from cityx.city import City, RoadNetwork
from cityx.city.ground import Ground
from cityx.city.section import KIND
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.ground.standing import stand_on

KINDS: Mapping[str, tuple[str, ...]] = {
    "road": words.ROADS, "path": words.PATHS, "railway": words.RAILWAYS,
}  # fmt: skip
SAME_SIDE = 0.9  # share of streets from which a city drives on one side
SAME_LANE = 0.1  # metres between the middles of lanes that are one, driven both ways
JOINED = 0.05  # metres between the ends of two ways that are one street
BENDS = np.cos(np.radians(50.0))  # of a street that goes on where two ways meet
SAMPLES = 15  # places along a way at which its surface is looked at
WHEEL_PATH = 1.5  # metres from the middle of a way
RUN = 3.0  # metres over which a slope is measured at least
NARROWEST = 2.0  # metres of a bridge's deck
BARRED = 20.0  # metres from the end of a deck to what bars the street before it
CARRIED = 1.0  # metres from a deck to what carries and edges it
BESIDE = 1.5  # metres between two decks that are one bridge
MEDIAN = 30.0  # metres at most between the middles of two carriageways of one street
BUFFER = 0.4  # metres between cycles and cars that protect
TELLING = 45.0  # metres of a way between junctions from which its walks are seen
SIDEWARD, WIDEST_WALK = (
    0.1,
    9.0,
)  # metres between the places looked at beside a street, and to where
WALK_LABELS = (
    "sidewalk", "furnishing", "edging", "ramp", "landing", "guide_strip", "kerb_dropped", "tactile",
    "tactile_pale", "tactile_buff", "tactile_red", "kerb",
)  # fmt: skip
VERGE = 2.0  # metres of kerb, furnishing and green between a carriageway and its walk
HUB_SHARE = 0.25  # of the site's shorter side within which a square is the main one


@dataclass(frozen=True)
class Roads(TableLayer):
    """The ways of a kind; a street from end to end counts once."""

    @cached_property
    def _table(self) -> Any:
        table = self.city.layout.roads
        return table[table["kind"].isin(KINDS[self.kind]).to_numpy()]

    @property
    def weights(self) -> FloatArray:
        """(n,) metres: half of all streets by length, not by number of ways, is the median."""
        return np.asarray(shapely.length(self.shapes))

    @cached_property
    def beside(self) -> FloatArray:
        """(n,) metres from the middle to where its walks end: who goes along it goes within."""
        walks = [self._table[f"sidewalk_{side}"].to_numpy(float) for side in ("left", "right")]
        half = np.nan_to_num(self.number("width")) / 2
        beside = half + np.nan_to_num(np.maximum(*walks)) + VERGE
        return np.where(np.isin(column(self._table, "kind"), words.PATHS), 0.0, beside)

    def number(self, attribute: str) -> FloatArray:
        """Return widths of carriageways, lanes, slopes, speeds or lengths."""
        if attribute == "width":
            return self._of_edges(lambda net: 2 * net.half_width, "width")
        if attribute == "lanes":
            return np.asarray(self._table["lanes"].to_numpy(float))
        if attribute == "slope":
            return self._slopes()
        if attribute == "speed":
            return np.asarray(self._table["maxspeed_kmh"].to_numpy(float) / 3.6)
        if attribute == "length":
            return np.asarray(shapely.length(self.shapes))
        if attribute == "walk":
            return self._walks()
        if attribute == "median":
            return self._medians()
        return super().number(attribute)

    def _walks(self) -> FloatArray:
        """(n,) metres of the narrower walk of each street, NaN where there is none.

        Roundabouts, and ways that junctions take up for the most part, tell of none.
        """
        ground = self.city.ground
        found = []
        for side, sign in (("left", 1.0), ("right", -1.0)):
            wide = self._table[f"sidewalk_{side}"].to_numpy(float)
            if ground is not None:
                told = (wide > 0) & (shapely.length(self.shapes) >= TELLING)
                told &= ~self._table["roundabout"].to_numpy(bool)
                wide = np.where(told, self._paved_beside(ground, sign), np.nan)
            found.append(np.where(wide > 0, wide, np.nan))
        return np.asarray(np.fmin(*found))

    def _paved_beside(self, ground: Ground, sign: float) -> FloatArray:
        """(n,) metres that are walked on beside the carriageway, the middle one along each way."""
        share = (np.arange(SAMPLES) + 0.5) / SAMPLES
        at = shapely.line_interpolate_point(self.shapes[:, None], share, normalized=True)
        step = np.maximum(0.1 / np.maximum(shapely.length(self.shapes), 1.0), 1e-6)[:, None]
        on = shapely.line_interpolate_point(self.shapes[:, None], share + step, normalized=True)
        here, ahead = (shapely.get_coordinates(one).reshape(-1, SAMPLES, 2) for one in (at, on))
        way = (ahead - here) / np.maximum(np.linalg.norm(ahead - here, axis=2), 1e-9)[..., None]
        out = sign * np.stack([-way[..., 1], way[..., 0]], axis=2)  # (n, s, 2)
        half = np.nan_to_num(self.number("width")) / 2
        far = half[:, None] + np.arange(SIDEWARD / 2, WIDEST_WALK, SIDEWARD)  # (n, d)
        spots = here[:, :, None] + far[:, None, :, None] * out[:, :, None]
        walked = ground.on(spots.reshape(-1, 2), *WALK_LABELS).reshape(spots.shape[:3])
        return np.asarray(np.median(SIDEWARD * walked.sum(axis=2), axis=1))

    def _medians(self) -> FloatArray:
        """(n,) metres between the carriageways of each street, NaN where there is but one."""
        oneway = self._table["oneway"].to_numpy(bool)
        kind, name = (column(self._table, key) for key in ("kind", "name"))
        pairs = carriageways(self.shapes, kind, name, oneway)
        half = np.nan_to_num(self.number("width")) / 2
        found = np.full(len(self.ids), np.nan)
        middle = shapely.line_interpolate_point(self.shapes, 0.5, normalized=True)
        for a, b in pairs.tolist():
            gap = float(shapely.distance(middle[a], self.shapes[b]) - half[a] - half[b])
            found[[a, b]] = np.fmax(found[[a, b]], gap)
        return found

    def has(self, attribute: str, word: str) -> BoolArray:
        """Return which have a class or surface, are one-way, or have parking or cycle lanes."""
        if attribute == "surface":
            return self._paved(words.PAVINGS[word])
        if attribute == "oneway":
            return np.asarray(self._oneway == (word == "true"))
        if attribute == "protected":
            return np.asarray(self._protected == (word == "true"))
        if attribute in ("parking", "cycling"):
            return np.asarray(self._beside({"cycling": "cycle"}.get(attribute, attribute)) == word)
        if attribute != "class":
            return super().has(attribute, word)
        if word in (words.AVENUE, words.RING):
            return np.asarray(self._shaped(word) >= 0)
        return np.isin(column(self._table, "kind"), words.ROAD_CLASSES[word])

    def _paved(self, materials: tuple[str, ...]) -> BoolArray:
        """(n,) whether most of the ground along ways is of some materials."""
        mesh = self.city.scene.meshes.get("ground")
        if mesh is None:
            raise CannotTell("the ground is not laid yet")
        own = np.isin([material_named(name).root for name in mesh.materials], materials)
        width = np.nan_to_num(self._table["width"].to_numpy(float))
        aside = np.minimum(width / 4, WHEEL_PATH)  # a painted line may run along the middle
        lines = shapely.offset_curve(self.shapes, np.maximum(aside, 0.1))
        share = (np.arange(SAMPLES) + 0.5) / SAMPLES
        spots = shapely.line_interpolate_point(lines[:, None], share, normalized=True)
        face = stand_on(mesh, shapely.get_coordinates(spots)).face.reshape(-1, SAMPLES)
        return np.asarray((own[mesh.material[face]] & (face >= 0)).mean(axis=1) > 1 / 2)

    def _bands(self, kind: str) -> tuple[IntArray, Any]:
        """Return the rows of the lanes of a kind, -1 for those of other ways, and the lanes."""
        lanes, network = self.city.lanes, self.city.network
        if lanes is None or network is None:
            raise CannotTell("the city has no lanes yet")
        row = self.rows_of_edges(network)[lanes.edge]
        return np.where(lanes.kind == KIND[kind], row, -1), lanes

    @property
    def _oneway(self) -> BoolArray:
        """(n,) whether all lanes lead one way."""
        row, lanes = self._bands("drive")
        ways = [np.bincount(row[(row >= 0) & (lanes.direction == sign)], minlength=len(self.ids))
                for sign in (1, -1)]  # fmt: skip
        return np.asarray((ways[0] > 0) != (ways[1] > 0))

    def _beside(self, kind: str) -> NDArray[np.str_]:
        """(n,) on which sides of the middle there is a band of a kind."""
        row, lanes = self._bands(kind)
        middle = (lanes.left + lanes.right) / 2
        left, right = (np.isin(np.arange(len(self.ids)), row[(row >= 0) & side])
                       for side in (middle > 0, middle < 0))  # fmt: skip
        return np.array(words.ON_SIDES)[left + 2 * right]

    @property
    def _protected(self) -> BoolArray:
        """(n,) whether something lies between cycles and cars on every side that has both."""
        row, lanes = self._bands("cycle")
        drive, _ = self._bands("drive")
        has, bare = np.zeros(len(self.ids), bool), np.zeros(len(self.ids), bool)
        for lane in np.flatnonzero(row >= 0).tolist():
            cars = (lanes.edge == lanes.edge[lane]) & (drive >= 0)
            beside = np.maximum(
                lanes.right[cars] - lanes.left[lane], lanes.right[lane] - lanes.left[cars]
            )
            has[row[lane]] = True
            bare[row[lane]] |= bool((beside < BUFFER).any())
        return np.asarray(has & ~bare)

    def units(self, rows: IntArray) -> IntArray:
        """Return the number of the street of each way; avenues and rings are found by shape."""
        for word in (words.AVENUE, words.RING):
            shaped = self.__dict__.get(f"_{word}")
            if shaped is not None and len(rows) and (shaped[rows] >= 0).all():
                return np.asarray(shaped[rows])
        kind, name = (column(self._table, key)[rows] for key in ("kind", "name"))
        lines = self.shapes[rows]
        oneway = self._table["oneway"].to_numpy(bool)[rows]
        street = strokes(lines, kind)
        pairs = street[carriageways(lines, kind, name, oneway)]
        return np.asarray(components(pairs, street.max(initial=-1) + 1)[street], np.int64)

    def _shaped(self, word: str) -> IntArray:
        return self._avenue if word == words.AVENUE else self._ring

    @cached_property
    def _avenue(self) -> IntArray:
        hub, reach, _ = hub_of(self.city)
        return avenues(self.shapes, hub, reach)

    @cached_property
    def _ring(self) -> IntArray:
        return rings(self.shapes, *hub_of(self.city))

    def _of_edges(self, values: Any, otherwise: str) -> FloatArray:
        """Mean of a value of the network's edges, by length; the layout's where there is none."""
        own = self._table[otherwise].to_numpy(float)
        network = self.city.network
        if network is None or not network.edge_count:
            return np.asarray(own)
        row = self.rows_of_edges(network)
        kept = row >= 0
        length = _edge_lengths(network)[kept]
        total = np.bincount(row[kept], length, minlength=len(own))
        sums = np.bincount(row[kept], length * values(network)[kept], minlength=len(own))
        return np.where(total > 0, sums / np.maximum(total, 1e-9), own)

    def rows_of_edges(self, network: RoadNetwork) -> IntArray:
        """(e,) row of this layer that each edge of the network belongs to, -1 for none."""
        of_road = np.full(len(self.city.layout.roads), -1, np.int64)
        all_ids = self.city.layout.roads["id"].to_numpy(np.uint64)
        of_road[np.isin(all_ids, self.ids)] = np.arange(len(self.ids))
        return of_road[network.edge_road]

    def _slopes(self) -> FloatArray:
        """(n,) steepest grade of each way, rise over run."""
        network = self.city.network
        if network is None or (self.city.heights is None and not self.city.terrain.is_flat):
            raise CannotTell("the streets have no heights yet")
        row = self.rows_of_edges(network)
        edge = np.repeat(np.arange(network.edge_count), np.diff(network.point_start))
        run = np.hypot(*np.diff(network.points, axis=0).T)
        rise = np.abs(np.diff(network.z))
        kept = (np.diff(edge) == 0) & (run >= RUN) & (row[edge[:-1]] >= 0)
        steepest = np.zeros(len(self.ids))
        np.maximum.at(steepest, row[edge[:-1]][kept], rise[kept] / run[kept])
        return steepest

    @cached_property
    def grounds(self) -> NDArray[Any]:
        """(n,) carriageways."""
        half = np.fmax(self.number("width"), NARROWEST) / 2
        return np.asarray(shapely.buffer(self.shapes, half, cap_style="flat"), object)


def _edge_lengths(network: RoadNetwork) -> FloatArray:
    edge = np.repeat(np.arange(network.edge_count), np.diff(network.point_start))
    step = np.hypot(*np.diff(network.points, axis=0).T)
    inner = np.diff(edge) == 0
    return np.asarray(
        np.bincount(edge[:-1][inner], step[inner], minlength=network.edge_count), np.float64
    )


def strokes(lines: NDArray[Any], kind: NDArray[Any]) -> IntArray:
    """Return the number of the street that each way is a piece of, (n,).

    Two ways are one street where they meet end to end, are of one class and go on within 50
    degrees; where more meet, the straightest pair goes on first.
    """
    count = len(lines)
    if not count:
        return np.zeros(0, np.int64)
    ends, heading = _ends_of(lines)  # (2 n, 2): starts, then ends
    tree = shapely.STRtree(shapely.points(ends))
    a, b = tree.query(shapely.points(ends), predicate="dwithin", distance=JOINED)
    straight = -np.einsum("ij,ij->i", heading[a], heading[b])
    good = (a < b) & (a % count != b % count) & (straight >= BENDS)
    good &= kind[a % count] == kind[b % count]
    a, b, straight = a[good], b[good], straight[good]
    taken = np.zeros(2 * count, bool)
    pairs = []
    for at in np.lexsort((b, a, -np.round(straight, 6))).tolist():
        if not taken[a[at]] and not taken[b[at]]:
            taken[[a[at], b[at]]] = True
            pairs.append((a[at] % count, b[at] % count))
    return np.asarray(components(np.array(pairs, np.int64).reshape(-1, 2), count), np.int64)


def carriageways(
    lines: NDArray[Any], kind: NDArray[Any], name: NDArray[Any], oneway: BoolArray
) -> IntArray:
    """Return (p, 2) pairs of ways that are the two carriageways of one street.

    Both are one-way, of one name and class, side by side and lead opposite ways.
    """
    own = np.flatnonzero(oneway & (name != ""))
    begin, end = (shapely.get_coordinates(shapely.get_point(lines[own], k)) for k in (0, -1))
    way = (end - begin) / np.maximum(np.hypot(*(end - begin).T), 1e-9)[:, None]
    a, b = shapely.STRtree(lines[own]).query(lines[own], predicate="dwithin", distance=MEDIAN)
    opposite = np.einsum("ij,ij->i", way[a], way[b]) <= -BENDS
    a, b = own[a], own[b]
    same = (a < b) & (kind[a] == kind[b]) & (name[a] == name[b]) & opposite
    return np.asarray(np.column_stack([a, b])[same], np.int64)


def _ends_of(lines: NDArray[Any]) -> tuple[FloatArray, FloatArray]:
    """Return both ends of lines, and the unit vectors that lead away from them into the lines."""
    first, second = (shapely.get_coordinates(shapely.get_point(lines, k)) for k in (0, 1))
    last, before = (shapely.get_coordinates(shapely.get_point(lines, k)) for k in (-1, -2))
    ends = np.concatenate([first, last])
    into = np.concatenate([second - first, before - last])
    return ends, into / np.maximum(np.hypot(*into.T), 1e-9)[:, None]


def hub_of(city: City) -> tuple[FloatArray, float, float]:
    """Return the centre that avenues leave: the main square, else the middle of the site.

    Returns
    -------
    hub
        (x, y).
    reach
        Metres to the nearest border of the site.
    square
        Square metres of the main square, 0 without one.
    """
    xmin, ymin, xmax, ymax = city.layout.extent
    middle = shapely.Point((xmin + xmax) / 2, (ymin + ymax) / 2)
    squares = places_of(city, "plaza")
    away = shapely.distance(squares, middle)
    hub, square = np.array([middle.x, middle.y]), 0.0
    if len(squares) and away.min() <= HUB_SHARE * min(xmax - xmin, ymax - ymin):
        best = squares[int(np.argmin(np.round(away, 3)))]
        hub, square = shapely.get_coordinates(best.centroid)[0], float(best.area)
    reach = min(hub[0] - xmin, xmax - hub[0], hub[1] - ymin, ymax - hub[1])
    return hub, float(reach), square


def driving_side(city: City) -> Measured:
    """Return the side that vehicles keep to, by the lanes of streets driven both ways.

    Raises
    ------
    Absent
        If no street is driven both ways.
    """
    graph = city.lanes
    drive = np.zeros(0, bool) if graph is None else graph.kind == KIND["drive"]
    if graph is None or not drive.any():
        raise Absent("there is no lane")
    middle = (graph.left + graph.right) / 2
    count = int(graph.edge.max()) + 1
    ways = [drive & (graph.direction == way) for way in (1, -1)]
    lanes = [np.bincount(graph.edge[way], minlength=count) for way in ways]
    total = [np.bincount(graph.edge[way], middle[way], count) for way in ways]
    both = (lanes[0] > 0) & (lanes[1] > 0)
    apart = total[0][both] / lanes[0][both] - total[1][both] / lanes[1][both]
    apart = apart[np.abs(apart) > SAME_LANE]  # a lane for both directions has no side
    if not len(apart):
        raise Absent("no street has a lane for each direction")
    left = float((apart > 0).mean())
    side, share = ("left", left) if left > 0.5 else ("right", 1 - left)
    return Measured(
        (side,) if share >= SAME_SIDE else (),
        f"vehicles keep {side} on {share:.0%} of {len(apart)} stretches with lanes both ways",
    )


def street_pattern(city: City) -> Pattern:
    """Return the pattern of a city's streets, back ways apart."""
    layer = Roads(city, "road")
    kept = ~np.isin(column(layer._table, "kind"), words.BACK)
    lines = layer.shapes[kept]
    found = pattern_of(lines)
    if found.word != "organic":
        return found
    hub, reach, square = hub_of(city)
    return pattern_of(lines, rings=int(rings(lines, hub, reach, square).max(initial=-1)) + 1)


@dataclass(frozen=True)
class Bridges(Layer):
    """Bridges: ways over others, those that touch or lie side by side as one."""

    @cached_property
    def _parts(self) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], IntArray]:
        """Return ids, lines, decks and the bridge that each way over a bridge belongs to."""
        table = self.city.layout.roads
        table = table[table["bridge"].to_numpy(bool)]
        lines = np.asarray(table.geometry.to_numpy(), object)
        width = np.fmax(table["width"].to_numpy(float), NARROWEST)
        decks = shapely.buffer(lines, width / 2, cap_style="flat")
        tree = shapely.STRtree(decks)
        pairs = np.column_stack(tree.query(decks, predicate="dwithin", distance=BESIDE))
        label = np.asarray(components(pairs, len(decks)), np.int64)
        return table["id"].to_numpy(np.uint64), lines, np.asarray(decks, object), label

    @cached_property
    def _numbers(self) -> IntArray:
        return np.unique(self._parts[3])

    @cached_property
    def ids(self) -> UInt64Array:
        """(n,) least id of the ways of each."""
        ids, _, _, label = self._parts
        return np.array([ids[label == n].min() for n in self._numbers.tolist()], np.uint64)

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) decks."""
        _, _, decks, label = self._parts
        return np.array([union(decks[label == n]) for n in self._numbers.tolist()], object)

    def members(self, rows: IntArray) -> UInt64Array:
        """Return the ids of the ways."""
        ids, _, _, label = self._parts
        return np.asarray(ids[np.isin(label, self._numbers[rows])])

    @property
    def names(self) -> Mapping[str, NDArray[Any]]:
        """Names and sources of the first way of each."""
        table = self.city.layout.roads
        rows = np.searchsorted(table["id"].to_numpy(np.uint64), self.ids)
        return {key: column(table, key)[rows] for key in ("name", "source")}

    def has(self, attribute: str, word: str) -> BoolArray:
        """Return which no lane for cars leads over, with barriers before both ends."""
        if attribute == "material":
            return np.isin(self._looks[0], words.THING_MATERIALS[word])
        if attribute == "color":
            return np.asarray(self._looks[1] == word)
        if attribute != "closed":
            return super().has(attribute, word)
        ids, lines, _, label = self._parts
        driven = np.isin(ids, self._driven)
        barriers = shapely.points(standing_pieces(self.city, ("work_barrier",))[0])
        closed = []
        for n in self._numbers.tolist():
            own = lines[label == n]
            ends = shapely.get_point(max(own.tolist(), key=shapely.length), [0, -1])
            barred = all(shapely.dwithin(barriers, end, BARRED).any() for end in ends)
            closed.append(barred and not driven[label == n].any())
        return np.asarray(np.array(closed, bool) == (word == "true"))

    @cached_property
    def _looks(self) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
        """(n,) roots of the materials of what carries and edges each, words of their colours."""
        mesh = self.city.scene.meshes.get("structures")
        if mesh is None:
            raise CannotTell("no bridge is built yet, so none has a material or a colour")
        middle = mesh.vertices[mesh.faces[:, :3]].mean(axis=1)
        found = shapely.STRtree(shapely.buffer(self.shapes, CARRIED)).query(
            shapely.points(middle[:, :2]), predicate="within"
        )
        faces, first = np.unique(found[0], return_index=True)
        return looks_of_faces(mesh, faces, found[1][first], len(self.ids))

    @property
    def _driven(self) -> UInt64Array:
        """Ids of the ways that have lanes for cars; before there are lanes by their kind."""
        city = self.city
        table = city.layout.roads
        ids = table["id"].to_numpy(np.uint64)
        if city.lanes is None or city.network is None:
            return np.asarray(ids[table["kind"].isin(words.ROADS).to_numpy()])
        edges = city.lanes.edge[city.lanes.kind == KIND["drive"]]
        return np.asarray(np.unique(ids[city.network.edge_road[edges]]), np.uint64)

    def number(self, attribute: str) -> FloatArray:
        """Return lengths or widths of decks."""
        _, lines, _, label = self._parts
        if attribute not in ("length", "width"):
            return super().number(attribute)
        longest = [shapely.length(lines[label == n]).max() for n in self._numbers.tolist()]
        if attribute == "length":
            return np.array(longest, float)
        return np.asarray(shapely.area(self.shapes) / np.maximum(longest, 1e-9))
