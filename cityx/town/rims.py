"""Rims of districts: the main roads and river banks that bound them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import takewhile
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.parcels.lattice import PER_METRE, Corner, Key
from cityx.town.plane import Plane
from cityx.town.rivers import ABUTMENT, Pair, Turn, across, around, landing, turn_at

MEETING = 45.0  # metres along a bank within which a bridge bends to meet a road there
ON = 0.01  # metres from a line within which a place lies on it
STRAIGHT = 70.0  # metres from a corner by a river within which a road runs straight to the bank
SHORE = 20.0  # metres from the middle of the road along a shore to the water
WALK = 9.0  # metres from there to the land before the water
ROUND = 55.0  # metres of the least radius of a shore
RINGS = 2  # of districts around one whose shore depends on them
SITE: Key = (0, 0)  # of the one district of a site


@dataclass(frozen=True)
class Side:
    """One side of a district.

    Attributes
    ----------
    line
        (k, 2) whole millimetres, the district on its left.
    beyond
        Lattice index of the district across it.
    kind
        "road" where the main road between both runs, "bank" where the district has a road of its
        own along a river.
    taken
        (t, 2) places on a bank where bridges land.
    """

    line: IntArray
    beyond: Key
    kind: str
    taken: IntArray


@dataclass(frozen=True)
class Rim:
    """A district's outline; s sides.

    Attributes
    ----------
    key
        Lattice index.
    anchor
        (2,) whole millimetres: where the frame of the district's own lines has its origin.
    sides
        Counter-clockwise.
    """

    key: Key
    anchor: IntArray
    sides: tuple[Side, ...]

    def local(self, places: IntArray) -> FloatArray:
        """Return places in the district's own frame, metres."""
        return np.asarray((np.asarray(places, np.int64) - self.anchor) / PER_METRE)

    def places(self, points: FloatArray) -> IntArray:
        """Return places of points in the district's own frame, whole millimetres."""
        return np.asarray(self.anchor + np.rint(np.asarray(points) * PER_METRE).astype(np.int64))

    def lines(self) -> NDArray[Any]:
        """(s,) the sides as lines in the district's own frame."""
        return self._lines.copy()

    @cached_property
    def _lines(self) -> NDArray[Any]:
        of = np.repeat(np.arange(len(self.sides)), [len(side.line) for side in self.sides])
        points = np.concatenate([side.line for side in self.sides])
        return np.asarray(shapely.linestrings(self.local(points), indices=of), object)

    def polygon(self) -> Any:
        """Return the outline in the district's own frame."""
        ring = np.concatenate([self.local(side.line)[:-1] for side in self.sides])
        return shapely.Polygon(ring)


@dataclass(frozen=True)
class Bridge:
    """A bridge over a river at a corner of districts.

    Attributes
    ----------
    road
        The main road it carries on.
    line
        (2, 2) from bank to bank, whole millimetres.
    """

    road: Pair
    line: IntArray


class Rims:
    """Main roads and rims of a plane; answers are kept, for neighbours ask for them again."""

    def __init__(self, plane: Plane) -> None:
        self.plane = plane
        self._turns: dict[Corner, Turn | None] = {}
        self._bridges: dict[Corner, Bridge | None] = {}
        self._roads: dict[Pair, IntArray] = {}

    def turn(self, name: Corner) -> Turn | None:
        """Return the course of the river round a corner."""
        if not self.plane.plan.river:
            return None
        if name not in self._turns:
            self._turns[name] = turn_at(self.plane, name)
        return self._turns[name]

    def road(self, a: Key, b: Key) -> IntArray:
        """Return the main road between two districts, (k, 2), the lower one on its left.

        It ends on the bank of a river.
        """
        pair = (min(a, b), max(a, b))
        if pair not in self._roads:
            line = self.plane.edge(*pair)
            start, end = self._ends(*pair)
            line = self._trimmed(line, start, pair[0])
            self._roads[pair] = self._trimmed(line[::-1], end, pair[0])[::-1]
        return self._roads[pair]

    def _ends(self, a: Key, b: Key) -> tuple[Corner, Corner]:
        cell = self.plane.cell(a)
        m = cell.beyond.index(b)
        return cell.corners[m], cell.corners[(m + 1) % len(cell.corners)]

    def _trimmed(self, line: IntArray, name: Corner, key: Key) -> IntArray:
        """Cut a road that begins at a corner off at the bank of a river that flows by there."""
        turn = self.turn(name)
        return line if turn is None or _is_mouth(turn) else self._cut(line, turn, key)

    def _cut(self, line: IntArray, turn: Turn, key: Key) -> IntArray:
        """Extend a road that begins at a corner to the bank of the river there."""
        away = np.hypot(*((line - turn.place) / PER_METRE).T)
        away[-1] = np.inf  # a short road keeps its other end
        line = np.concatenate([turn.middle[None], line[away > STRAIGHT]])
        place = landing(turn, self._bank(turn, key), line)
        if place is None:
            return line
        metres = (line - turn.place) / PER_METRE
        cut = shapely.LineString(metres).project(shapely.Point((place - turn.place) / PER_METRE))
        at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(metres, axis=0).T))])
        at[-1] = np.inf
        return np.concatenate([place[None], line[at > cut + 1.0]])

    def _bank(self, turn: Turn, key: Key) -> IntArray:
        """Return the bank of a turn that a district's side lies on."""
        site = shapely.Point((self.plane.cell(key).site - turn.place) / PER_METRE)
        away = [turn.line(bank).distance(site) for bank in (turn.left, turn.right)]
        return turn.left if away[0] < away[1] else turn.right

    def over_mouths(self, a: Key, b: Key) -> IntArray:
        """Return where a main road leaves the ground for the mouths of rivers at its ends, (2, 2).

        Where there is none it is the end of the road.
        """
        a, b = min(a, b), max(a, b)
        line = self.road(a, b)
        cuts = []
        for name, from_end in zip(self._ends(a, b), (line, line[::-1]), strict=True):
            turn = self.turn(name)
            cut = from_end[0]
            if turn is not None and _is_mouth(turn):
                dry = b if self.plane.is_wet(a) else a
                place = landing(turn, self._bank(turn, dry), from_end)
                if place is not None:
                    way = (turn.place - place) / PER_METRE
                    step = ABUTMENT * PER_METRE * way / np.hypot(*way)
                    cut = place + np.rint(step).astype(np.int64)
            cuts.append(cut)
        return np.stack(cuts)

    def bridge(self, name: Corner) -> Bridge | None:
        """Return the bridge at a corner, or None."""
        if name not in self._bridges:
            self._bridges[name] = self._bridge_at(name)
        return self._bridges[name]

    def _bridge_at(self, name: Corner) -> Bridge | None:
        turn = self.turn(name)
        if turn is None or _is_mouth(turn):
            return None
        cells = around(self.plane, name)
        pairs = [(min(p), max(p)) for p in zip(cells, [*cells[1:], cells[0]], strict=True)]
        roads = sorted(pair for pair in pairs if self.plane.side_kind(*pair) == "road")
        ends = {}
        for pair in roads:
            line = self.road(*pair)
            place = line[0] if self._ends(*pair)[0] == name else line[-1]
            if not (place == turn.place).all():
                ends[pair] = (place, self.plane.bank(pair[0]))
        for pair, (place, bank) in ends.items():
            there = across(turn, place, self._far_bank(turn, pair[0]))
            if there is None:
                continue
            others = [far for far, side in ends.values() if side != bank]
            away = [float(np.hypot(*((far - there) / PER_METRE))) for far in others]
            if others and min(away) < MEETING:
                there = others[int(np.argmin(away))]
            return Bridge(pair, np.stack([place, there]))
        return None

    def _far_bank(self, turn: Turn, key: Key) -> IntArray:
        return turn.right if self._bank(turn, key) is turn.left else turn.left

    def rim(self, key: Key) -> Rim:
        """Return the rim of a dry district."""
        cell = self.plane.cell(key)
        kinds = [self.plane.side_kind(key, beyond) for beyond in cell.beyond]
        count = len(kinds)
        # Begin with a road, so that no run of banks is cut in two.
        first = kinds.index("road") if "road" in kinds else 0
        order = [(first + m) % count for m in range(count)]
        sides: list[Side] = []
        while order:
            if kinds[order[0]] == "river":
                run = list(takewhile(lambda m: kinds[m] == "river", order))
                sides.append(self._along_river(key, run, ring="road" not in kinds))
            else:
                run = order[:1]
                sides.append(self._along_road(key, run[0]))
                after = (run[0] + 1) % count
                if kinds[after] == "road":
                    sides += self._at_bank(key, cell.corners[after], sides[-1], after)
            order = order[len(run) :]
        joined = [_cut_to(sides[k - 1], side, sides[(k + 1) % len(sides)]) for k, side in enumerate(sides)]  # fmt: skip  # noqa: E501
        return Rim(key, cell.site, tuple(joined))

    def _along_road(self, key: Key, m: int) -> Side:
        """Return the main road along a side; where a river ends it is cut off at its bank."""
        cell = self.plane.cell(key)
        line = self.road(key, cell.beyond[m])
        line = line if key < cell.beyond[m] else line[::-1]
        names = cell.corners[m], cell.corners[(m + 1) % len(cell.corners)]
        for name in names:
            turn = self.turn(name)
            if turn is not None and _is_mouth(turn):
                line = self._cut(line, turn, key)
            line = line[::-1]
        return Side(line, cell.beyond[m], "road", np.zeros((0, 2), np.int64))

    def _at_bank(self, key: Key, name: Corner, before: Side, m: int) -> list[Side]:
        """Return the bank at a corner where a district only touches a river, between its roads."""
        turn = self.turn(name)
        if turn is None or _is_mouth(turn):
            return []
        after = self._along_road(key, m)
        if (before.line[-1] == after.line[0]).all():
            return []
        bank = self._bank(turn, key)
        line = turn.line(bank)
        first, last = (
            line.project(shapely.Point((place - turn.place) / PER_METRE))
            for place in (before.line[-1], after.line[0])
        )
        bank = bank if first < last else bank[::-1]
        bridge = self.bridge(name)
        taken = np.zeros((0, 2), np.int64) if bridge is None else bridge.line
        return [Side(bank, after.beyond, "bank", taken)]

    def _along_river(self, key: Key, run: list[int], *, ring: bool) -> Side:
        """Return the whole of a district's bank along consecutive sides."""
        cell = self.plane.cell(key)
        own = [(min(key, cell.beyond[m]), max(key, cell.beyond[m])) for m in run]
        corners = [cell.corners[m] for m in run]
        if not ring:
            corners.append(cell.corners[(run[-1] + 1) % len(cell.corners)])
        places, taken = [], [np.zeros((0, 2), np.int64)]
        for k, name in enumerate(corners):
            turn = self.turn(name)
            assert turn is not None, "a corner beside a river has a turn"
            bank = self._bank(turn, key)
            turned = turn.sides[0] == own[k] if k < len(own) else turn.sides[0] != own[-1]
            places.append(bank[::-1] if turned else bank)
            bridge = self.bridge(name)
            if bridge is not None:
                taken.append(bridge.line)
        if ring:
            places.append(places[0][:1])
        return Side(
            _without_loops(np.concatenate(places)),
            cell.beyond[run[0]],
            "bank",
            np.concatenate(taken),
        )


def _is_mouth(turn: Turn) -> bool:
    return len(turn.sides) == 1


def _without_loops(line: IntArray) -> IntArray:
    """Cut off the loops of a line, which tight bends of a river leave inside of them."""
    points = (line - line[0]) / PER_METRE
    closed = bool((line[0] == line[-1]).all())
    parts = shapely.linestrings(np.stack([points[:-1], points[1:]], axis=1))
    first, second = shapely.STRtree(parts).query(parts, predicate="intersects")
    loops = (second > first + 1) & ~(closed & (first == 0) & (second == len(parts) - 1))
    pairs = sorted(zip(first[loops].tolist(), (-second[loops]).tolist(), strict=True))
    kept, done = [], -1
    for begin, end in pairs:
        if begin <= done:
            continue
        kept.append(line[done + 1 : begin + 1])
        met = shapely.get_coordinates(shapely.intersection(parts[begin], parts[-end]))[:1]
        kept.append(line[0] + np.rint(met * PER_METRE).astype(np.int64))
        done = -end
    return np.concatenate([*kept, line[done + 1 :]])


def _cut_to(before: Side, side: Side, after: Side) -> Side:
    """Cut a bank off where the roads at both ends of it meet it."""
    if side.kind != "bank" or before is side:
        return side
    base, start, end = side.line[0], before.line[-1], after.line[0]
    bank = shapely.LineString((side.line - base) / PER_METRE)
    at = shapely.line_locate_point(bank, shapely.points((side.line - base) / PER_METRE))
    low, high = (bank.project(shapely.Point((p - base) / PER_METRE)) for p in (start, end))
    inner = side.line[(at > low + 1.0) & (at < high - 1.0)]
    places = np.concatenate([start[None], inner, end[None]])
    cut = shapely.LineString((places - base) / PER_METRE)
    away = (side.taken - base) / PER_METRE
    near = shapely.distance(shapely.points(away.reshape(-1, 2)), cut) < ON
    return replace(side, line=places, taken=side.taken[near])


def waters_of(rims: Rims, key: Key) -> tuple[Any, Any]:
    """Return the water of a wet district and the land along its shore, in its own frame."""
    plane = rims.plane
    near = {key}
    for _ in range(RINGS):
        near = {other for cell in near for name in plane.cell(cell).corners for other in around(plane, name)}  # fmt: skip  # noqa: E501
    wet = sorted(cell for cell in near if plane.is_wet(cell))
    whole = shapely.union_all([_outline(rims, cell, key) for cell in wet])
    own = _outline(rims, key, key)
    inner = shapely.buffer(whole, -SHORE - ROUND, quad_segs=6)
    water = shapely.intersection(shapely.buffer(inner, ROUND, quad_segs=6), own)
    dry = shapely.difference(shapely.buffer(whole, -WALK, quad_segs=2), water)
    return water, shapely.intersection(dry, own)


def _outline(rims: Rims, key: Key, frame: Key) -> Any:
    """Return the outline of a district in the frame of another, metres."""
    plane = rims.plane
    cell, anchor = plane.cell(key), plane.cell(frame).site
    lines = []
    for beyond in cell.beyond:
        line = plane.edge(key, beyond)
        lines.append((line if key < beyond else line[::-1])[:-1])
    return shapely.Polygon((np.concatenate(lines) - anchor) / PER_METRE)


def rim_of_site(anchor: IntArray, half: FloatArray) -> Rim:
    """Return the rim of a site's one district, a rectangle of twice so many metres."""
    x, y = np.rint(half * PER_METRE).astype(np.int64).tolist()
    ring = anchor + np.array([(-x, -y), (x, -y), (x, y), (-x, y), (-x, -y)])
    none = np.zeros((0, 2), np.int64)
    sides = tuple(Side(ring[k : k + 2], SITE, "bank", none) for k in range(4))
    return Rim(SITE, anchor, sides)
