"""Districts: their pattern of streets, the ways out to the main roads, dead ends, and blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.parcels.blind_streets import Net, with_blind_streets
from cityx.geometry.parcels.lattice import PER_METRE, Key
from cityx.geometry.parcels.street_fit import Ways, fitted, settled
from cityx.geometry.parcels.street_patterns import Pattern, curved, divided, grid, grid_nodes, rings
from cityx.ids import choose, hash_bits, hash_ids, uniform
from cityx.town.plane import Plane
from cityx.town.rims import Rim, Rims, Side

KINDS = ("grid", "radial", "organic", "cul_de_sac", "superblock")
# Weights of `KINDS` where the pattern is mixed, by zone.
MIXED = {
    "core": (5, 2, 3, 0, 1), "midrise": (5, 2, 4, 0, 1), "row": (5, 1, 4, 1, 1),
    "suburb": (2, 0, 4, 4, 0), "semi": (2, 0, 4, 4, 0),
    "rural": (0, 0, 1, 0, 0), "industry": (0, 0, 0, 0, 1),
}  # fmt: skip
# Times the length and the depth of a usual block, and share of the links inside that are left out.
SHAPE = {
    "grid": (1.0, 0.75, 0.13), "radial": (0.8, 0.68, 0.05), "organic": (1.0, 0.64, 0.05),
    "cul_de_sac": (1.3, 0.82, 0.04), "superblock": (1.4, 1.2, 0.06),
}  # fmt: skip
SPARSE = {
    "rural": 2.6,
    "suburb": 1.1,
    "semi": 1.1,
    "industry": 1.1,
}  # times that blocks are larger by zone
CLEAR = (34.0, 0.5)  # metres, and share of a block's depth, from main roads to streets along them
# Share of the large blocks that a blind street leads into, and from which size on.
DENSE = ("core", "midrise")  # zones of closed rows of houses, without blind streets
BLIND = {"cul_de_sac": 0.9, "organic": 0.8, "grid": 0.6, "radial": 0.5, "superblock": 0.6}
LEAST_BLIND = {"core": 14e3, "midrise": 14e3, "row": 8.5e3, "suburb": 8.5e3, "semi": 8.5e3,
               "rural": 9e9, "industry": 20e3}  # fmt: skip
BENDS = {"organic": 0.42, "cul_de_sac": 0.45}  # of a block's depth that streets are moved by
BEND_WAVE = 2.2  # of a block's depth
NEAR = 30.0  # metres between ways out on both sides of a main road that become one crossing
OFFSET = 34.0  # metres between those that do not
SHIFTS = np.array([(i / 3, j / 3) for i in range(3) for j in range(3)])  # of a pattern tried


@dataclass(frozen=True)
class Sketch:
    """What a district would have if its neighbours had no say: streets inside, and ways out."""

    rim: Rim
    kind: str
    zone: str
    density: float
    inner: Pattern
    ways: Ways


@dataclass(frozen=True)
class Portals:
    """Where streets meet one main road from both sides; k places.

    Attributes
    ----------
    at
        (k,) metres along the road.
    places
        (k, 2) whole millimetres.
    left, right
        (k,) way out of the district on the left and on the right that ends here, or -1.
    """

    at: FloatArray
    places: IntArray
    left: IntArray
    right: IntArray


@dataclass(frozen=True)
class District:
    """The streets of a district; n places, m links.

    Attributes
    ----------
    sketch
        What it was made from.
    places
        (n, 2) whole millimetres.
    links
        (m, 2) rows of places.
    street
        (m, 2) street of each link: family and line, -1 for a dead end with its number.
    ends
        (e,) rows of places where a street ends blindly.
    """

    sketch: Sketch
    places: IntArray
    links: IntArray
    street: IntArray
    ends: IntArray


def sketched(plane: Plane, rim: Rim) -> Sketch:
    """Lay out the streets of a district by itself."""
    key = rim.key
    density = plane.site_density(key)
    identity = hash_bits(plane.seed, "district", key[0], key[1])
    zone = zone_of(plane, identity, density)
    kind = kind_of(plane, identity, zone)
    block, depth, share = SHAPE[kind]
    larger = plane.plan.block * SPARSE.get(zone, 1.0)
    sizes = (block * larger, depth * larger)
    clearance = max(CLEAR[0], CLEAR[1] * sizes[1])
    polygon, lines = rim.polygon(), rim.lines()
    pattern = _pattern(plane, rim, kind, sizes, polygon, clearance)
    inner, ways = fitted(pattern, polygon, lines, clearance)
    inner = inner.take(~left_out(plane, identity, inner, share))
    return Sketch(rim, kind, zone, density, inner, ways)


def zone_of(plane: Plane, identity: int, density: float) -> str:
    """Return the zone of a district as a whole."""
    zone = str(plane.zone(np.array([density]), np.array([identity], np.uint64))[0])
    outer = zone in ("suburb", "row") and not plane.plan.zone
    if outer and uniform(plane.seed, "district/industry", identity) < plane.plan.industry:
        return "industry"
    return zone


def kind_of(plane: Plane, identity: int, zone: str) -> str:
    """Return the pattern of a district's streets."""
    if plane.plan.pattern != "mixed":
        return plane.plan.pattern
    return KINDS[int(choose(plane.seed, "district/kind", [identity], MIXED[zone])[0])]


def _pattern(
    plane: Plane, rim: Rim, kind: str, sizes: tuple[float, float], polygon: Any, clearance: float
) -> Pattern:
    """Lay the streets of a kind over a district."""
    box = polygon.bounds
    if kind == "radial":
        middle = np.zeros(2)
        found = rings(box, middle, plane.lattice.angle, sizes)
        return divided(found, middle=middle)
    angle = _direction(plane, rim)
    brick = kind in ("organic", "cul_de_sac")
    if plane.plan.pattern == "grid":  # streets run on from district to district
        origin = rim.local(plane.quarters.sites(plane.quarter(rim.anchor[None])))[0]
    else:
        origin = _fitting(polygon, angle, sizes, clearance, brick=brick)
    found = grid(box, origin, angle, sizes, brick=brick)
    if kind not in BENDS:
        return divided(found)
    return curved(
        found, hash_bits(plane.seed, "district/bend", *rim.key) >> 1,
        wave=BEND_WAVE * sizes[1], reach=BENDS[kind] * sizes[1],
    )  # fmt: skip


def _fitting(
    polygon: Any, angle: float, sizes: tuple[float, float], clearance: float, *, brick: bool
) -> FloatArray:
    """Return the crossing from which most of a grid's crossings keep clear of the rim."""
    room = shapely.buffer(polygon, -clearance, join_style="mitre")
    shapely.prepare(room)
    along = np.array([math.cos(angle), math.sin(angle)])
    across = np.array([-along[1], along[0]])
    box = polygon.bounds
    shifts = SHIFTS * sizes
    origins = shifts[:, :1] * along + shifts[:, 1:] * across
    tried = [grid_nodes(box, origin, angle, sizes, brick=brick)[0] for origin in origins]
    of = np.repeat(np.arange(len(tried)), [len(nodes) for nodes in tried])
    inside = shapely.contains_xy(room, np.concatenate(tried))
    return np.asarray(origins[np.bincount(of[inside], minlength=len(tried)).argmax()])


def _direction(plane: Plane, rim: Rim) -> float:
    """Return the direction of a district's streets: of its quarter, or of its longest main road.

    Directions are a tensor: turned by a right angle they are the same, so what is summed are unit
    vectors of four times the angle.
    """
    if plane.plan.pattern == "grid":
        return plane.lattice.angle
    step = np.concatenate([np.diff(rim.local(side.line), axis=0) for side in rim.sides])
    length = np.hypot(*step.T)
    turn = 4 * np.arctan2(step[:, 1], step[:, 0])
    field = length.max() * plane.noise("town/direction", rim.anchor[None], 1500.0)[0]
    own = 4 * (plane.lattice.angle + (math.pi / 8) * field / length.max())
    x = (length**1.5 * np.cos(turn)).sum() + 0.3 * length.sum() * math.cos(own)
    y = (length**1.5 * np.sin(turn)).sum() + 0.3 * length.sum() * math.sin(own)
    return math.atan2(y, x) / 4


def left_out(plane: Plane, identity: int, inner: Pattern, share: float) -> BoolArray:
    """Draw which stretches between crossings are left out, whole ones, (m,)."""
    code = hash_ids(identity & 0xFFFF, "district/link", inner.name[:, 0].astype(np.uint64), inner.name[:, 1])  # fmt: skip  # noqa: E501
    return np.asarray(uniform(plane.seed, "district/gap", code) < share)


class Districts:
    """Districts of a plane; answers are kept, for neighbours ask for them again."""

    def __init__(self, plane: Plane) -> None:
        self.plane = plane
        self.rims = Rims(plane)
        self._sketches: dict[Key, Sketch] = {}
        self._portals: dict[tuple[Key, Key], Portals] = {}

    def sketch(self, key: Key) -> Sketch:
        """Return the sketch of a district."""
        if key not in self._sketches:
            self._sketches[key] = sketched(self.plane, self.rims.rim(key))
        return self._sketches[key]

    def portals(self, a: Key, b: Key) -> Portals:
        """Return where streets meet the main road between two districts."""
        a, b = min(a, b), max(a, b)
        if (a, b) not in self._portals:
            self._portals[a, b] = self._agreed(a, b)
        return self._portals[a, b]

    def _agreed(self, a: Key, b: Key) -> Portals:
        line = self.rims.road(a, b)
        road = shapely.LineString((line - line[0]) / PER_METRE)
        left, left_at = self._offers(a, b, road, line[0])
        right, right_at = self._offers(b, a, road, line[0])
        at, lefts, rights = agreed(left, left_at, right, right_at)
        points = shapely.get_coordinates(shapely.line_interpolate_point(road, at)).reshape(-1, 2)
        return Portals(at, line[0] + np.rint(points * PER_METRE).astype(np.int64), lefts, rights)

    def _offers(
        self, own: Key, beyond: Key, road: Any, start: IntArray
    ) -> tuple[IntArray, FloatArray]:
        """Return the ways out of a district to one road, and metres along the road, rising."""
        if self.plane.is_wet(own):
            return np.zeros(0, np.int64), np.zeros(0)
        sketch = self.sketch(own)
        sides = sketch.rim.sides
        rows = np.array([
            k for k, m in enumerate(sketch.ways.side.tolist())
            if sides[m].beyond == beyond and sides[m].kind == "road"
        ], np.int64)  # fmt: skip
        lines = sketch.rim.lines()[sketch.ways.side[rows]]
        doors = shapely.get_coordinates(shapely.line_interpolate_point(lines, sketch.ways.at[rows]))
        places = (sketch.rim.places(doors.reshape(-1, 2)) - start) / PER_METRE
        at = shapely.line_locate_point(road, shapely.points(places))
        order = np.argsort(at, kind="stable")
        return rows[order], at[order]

    def district(self, key: Key) -> District:
        """Return the streets of a district, agreed with its neighbours."""
        sketch = self.sketch(key)
        rim, inner = sketch.rim, sketch.inner
        doors, at_door = self._doors(sketch)
        count = len(inner.nodes)
        places = np.concatenate([rim.places(inner.nodes), doors])
        way = np.flatnonzero(at_door >= 0)
        outward = np.stack([sketch.ways.node[way], count + at_door[way]], axis=1)
        links = np.concatenate([inner.links, outward])
        street = np.concatenate([inner.street, sketch.ways.street[way]])
        fixed = np.arange(len(places)) >= count
        nodes = rim.local(places)
        kept = settled(links, nodes, fixed, np.zeros(len(places), bool))
        links, street = links[kept], street[kept]
        return self._with_blind_streets(sketch, places, links, street)

    def _with_blind_streets(
        self, sketch: Sketch, places: IntArray, links: IntArray, street: IntArray
    ) -> District:
        """Add streets that end blindly inside of large blocks."""
        rim = sketch.rim
        identity = hash_bits(self.plane.seed, "district", *rim.key)
        doors = [self.rim_places(sketch, side, m) for m, side in enumerate(rim.sides)]
        net = Net(rim.local(places), links, street)
        grown, ends = with_blind_streets(
            net, rim.lines(), [rim.local(door) for door in doors],
            often=BLIND[sketch.kind], least=LEAST_BLIND[sketch.zone],
            blind=sketch.zone not in DENSE,
            drawn=lambda k: float(uniform(self.plane.seed, "district/blind", identity, k)),
        )  # fmt: skip
        return District(
            sketch, np.concatenate([places, rim.places(grown.nodes[len(places) :])]),
            grown.links, grown.street, ends,
        )  # fmt: skip

    def _doors(self, sketch: Sketch) -> tuple[IntArray, IntArray]:
        """Return the places where streets leave, and which of them each way out leads to."""
        places: list[IntArray] = [np.zeros((0, 2), np.int64)]
        at_door = np.full(len(sketch.ways.node), -1, np.int64)
        count = 0
        for m, side in enumerate(sketch.rim.sides):
            used, doors = self._doors_of(sketch, m, side)
            at_door[used] = count + np.arange(len(used))
            places.append(doors)
            count += len(used)
        return np.concatenate(places), at_door

    def _doors_of(self, sketch: Sketch, m: int, side: Side) -> tuple[IntArray, IntArray]:
        """Return the ways out that one side keeps, and the places they lead to."""
        if side.kind == "road":
            portals = self.portals(sketch.rim.key, side.beyond)
            own = portals.left if sketch.rim.key < side.beyond else portals.right
            kept = np.flatnonzero(own >= 0)
            return own[kept], portals.places[kept]
        rows = np.flatnonzero(sketch.ways.side == m)
        line = sketch.rim.lines()[m]
        points = shapely.get_coordinates(shapely.line_interpolate_point(line, sketch.ways.at[rows]))
        places = sketch.rim.places(points.reshape(-1, 2))
        away = (places[:, None] - side.taken) / PER_METRE  # (w, t, 2)
        free = (np.hypot(away[..., 0], away[..., 1]) >= OFFSET).all(axis=1)
        return rows[free], places[free]

    def rim_places(self, sketch: Sketch, side: Side, m: int) -> IntArray:
        """Return every place where a street or a bridge meets one side."""
        if side.kind == "road":
            return self.portals(sketch.rim.key, side.beyond).places
        return np.concatenate([side.taken, self._doors_of(sketch, m, side)[1]])


def agreed(
    left: IntArray, left_at: FloatArray, right: IntArray, right_at: FloatArray
) -> tuple[FloatArray, IntArray, IntArray]:
    """Decide where streets from both sides meet a road: near ones cross it, others keep apart.

    Parameters
    ----------
    left, right
        (l,) and (r,) ways out on both sides.
    left_at, right_at
        Metres along the road, rising.

    Returns
    -------
    at, left, right
        (k,) metres along the road, and the way out on each side or -1.
    """
    found: list[tuple[float, int, int]] = []
    taken_left, taken_right = set(), set()
    apart = np.abs(left_at[:, None] - right_at)
    for i, j in zip(*np.nonzero(apart < NEAR), strict=True):
        if apart[i].argmin() == j and apart[:, j].argmin() == i:
            found.append((float(left_at[i] + right_at[j]) / 2, int(left[i]), int(right[j])))
            taken_left.add(i)
            taken_right.add(j)
    single = [(float(s), int(way), -1) for i, (s, way) in enumerate(zip(left_at, left, strict=True)) if i not in taken_left]  # fmt: skip  # noqa: E501
    single += [(float(s), -1, int(way)) for j, (s, way) in enumerate(zip(right_at, right, strict=True)) if j not in taken_right]  # fmt: skip  # noqa: E501
    for offer in single:
        if all(abs(offer[0] - other[0]) >= OFFSET for other in found):
            found.append(offer)
    found.sort()
    at, lefts, rights = zip(*found, strict=True) if found else ((), (), ())
    return np.array(at, float), np.array(lefts, np.int64), np.array(rights, np.int64)
