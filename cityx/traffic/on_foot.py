"""Streets for people in a simulator: crossings between junctions, and footways."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from cityx.geometry.arrays import FloatArray
from cityx.geometry.polylines import arc_lengths, locate
from cityx.ground.walking.crosswalks import ASIDE, ON_GROUND, USUAL_DEPTH
from cityx.ground.walking.mapped_crossings import BARE, SIGNALS, barred_crossings
from cityx.traffic.shared_ground import Heights
from cityx.traffic.streets import Crossing, Halts, Lane, Link, Streets, Way

if TYPE_CHECKING:
    from cityx.city.city import City

BEFORE = 1.0  # metres from where one halts to a crossing
LEAST = 4.0  # metres of a street that are left on both sides of a crossing
ROUND = 1.0  # metres round a crossing that a footway ends at
LEAST_PATH = 0.2  # metres; a shorter piece of a footway is none
SAME = 1  # decimals of a metre at which ends of footways are one place
FOOTWAYS = ("footway", "path", "pedestrian", "steps")
FOOT = 1.4  # metres per second
HALF_STEP = 0.5  # metres of a footway that is no wider than a person
_SHUT = r'"foot": *"no"|"access": *"(?:no|private)"'


@dataclass(frozen=True)
class _Cut:
    """A crossing of a street between its junctions: where, and how."""

    edge: int
    along: float
    half: float
    signalled: bool
    first: bool


def divided(streets: Streets, halts: Halts, city: City) -> Streets:
    """Divide streets where people cross them between junctions.

    A crossing without room before a junction belongs to it, where it has none on that arm.

    Parameters
    ----------
    streets
        The streets, with the crossings of their junctions.
    halts
        Where the map has crossings.
    city
        The city, whose footways tell of more crossings.
    """
    network = city.network
    assert network is not None
    heights = Heights(city, network)
    cuts: dict[int, list[_Cut]] = {}
    for cut in sorted(_cuts(streets, halts, city), key=lambda cut: (cut.edge, cut.along)):
        cuts.setdefault(cut.edge, []).append(cut)
    made = _Divided(streets, heights)
    for edge in sorted(cuts):
        made.divide(edge, cuts[edge])
    return made.streets()


def _cuts(streets: Streets, halts: Halts, city: City) -> list[_Cut]:
    """Find the crossings of the map, and those of footways, at which there are none yet."""
    network = city.network
    assert network is not None
    length = arc_lengths(network.lines)[1]
    taken: dict[int, list[float]] = {}
    for crossing in streets.crossings:
        at = float(halts.zebra_at[crossing.edge, crossing.end])
        taken.setdefault(crossing.edge, []).append(
            at if crossing.end == 0 else float(length[crossing.edge]) - at
        )
    mapped = halts.between
    found = [
        _Cut(edge, along, float(halts.zebra_width[edge]) / 2, told == SIGNALS, told != BARE)
        for edge, along, told in zip(
            mapped.edge.tolist(), mapped.along.tolist(), mapped.told.tolist(), strict=True
        )
    ]
    barred = barred_crossings(city.layout, network.lines)
    for edge, along in zip(barred.edge.tolist(), barred.along.tolist(), strict=True):
        taken.setdefault(edge, []).append(along)
    found += [_Cut(edge, along, USUAL_DEPTH / 2, False, False)
              for edge, along in _met_by_paths(city)]  # fmt: skip
    kept = []
    for cut in found:
        others = taken.setdefault(cut.edge, [])
        if all(abs(cut.along - other) > ASIDE for other in others):
            others.append(cut.along)
            kept.append(cut)
    return kept


def _met_by_paths(city: City) -> list[tuple[int, float]]:
    """Return where footways meet the middles of streets on the ground: edge, and metres along."""
    network = city.network
    assert network is not None
    paths = _paths(city)
    shapes = Heights(city, network).shapes
    noded = shapely.get_parts(shapely.line_merge(shapely.node(shapely.multilinestrings(paths))))
    ends = shapely.get_coordinates(
        shapely.get_point(np.repeat(noded, 2), np.tile([0, -1], len(noded)))
    )
    path, edge = shapely.STRtree(shapes).query(paths, predicate="intersects")
    spots = shapely.intersection(paths[path], shapes[edge])
    points, row = shapely.get_parts(spots, return_index=True)
    some = shapely.get_type_id(points) == shapely.GeometryType.POINT
    edges = edge[row[some]]
    along = shapely.line_locate_point(shapes[edges], points[some])
    # A footway that ends at a street leads along it, not across.
    known, count = np.unique(np.round(ends, SAME), axis=0, return_counts=True)
    loose = shapely.STRtree(shapely.points(known[count == 1]))
    across = np.maximum.reduceat(np.abs(network.lift), network.point_start[:-1])[edges] <= ON_GROUND
    across[loose.query(points[some], "dwithin", 10.0**-SAME)[0]] = False
    pairs = np.unique(np.column_stack([edges, np.round(along, 2)])[across], axis=0)
    return [(int(edge), float(along)) for edge, along in pairs]


def _paths(city: City) -> NDArray[Any]:
    """(k,) footways on the ground on which one may walk."""
    roads = city.layout.roads
    open_ = roads["kind"].isin(FOOTWAYS).to_numpy() & (roads["layer"].to_numpy() == 0)
    open_ &= ~roads["bridge"].to_numpy() & ~roads["tunnel"].to_numpy()
    open_ &= ~roads["tags"].str.contains(_SHUT, regex=True).to_numpy().astype(bool)
    return np.asarray(shapely.force_2d(roads.geometry.to_numpy()[open_]))


class _Divided:
    """Streets while they are divided; a class for the lists that grow."""

    def __init__(self, streets: Streets, heights: Heights) -> None:
        self.before, self.heights = streets, heights
        self.ways = list(streets.ways)
        self.links: list[Link] = []
        self.place, self.signals = list(streets.place), streets.signals.tolist()
        self.crossings = list(streets.crossings)
        self.own: dict[int, list[int]] = {}
        for number, way in enumerate(streets.ways):
            self.own.setdefault(way.edge, []).append(number)
        # First and last part of each way.
        self.last = list(range(len(streets.ways)))

    def divide(self, edge: int, cuts: list[_Cut]) -> None:
        """Divide the ways of an edge at crossings, in their order along it."""
        own = self.own.get(edge, [])
        if not own or any(self.ways[way].name.endswith("#") for way in own):
            return
        spans = [self._spans(edge, way, cuts) for way in own]  # each [cut][lane] of two places
        kept: list[int] = []
        for number in range(len(cuts)):
            chosen = [*kept, number]
            if all(_roomy(self.ways[way], span, chosen)
                   for way, span in zip(own, spans, strict=True)):  # fmt: skip
                kept.append(number)
            else:
                self._at_junction(own, cuts[number])
        if not kept:
            return
        middles = [len(self.place) + number for number in range(len(kept))]
        shapes = [self._shape(cuts[number]) for number in kept]
        self.place += [shape.mean(axis=0) for shape in shapes]
        self.signals += [cuts[number].signalled for number in kept]
        parts = {way: self._parts(way, [span[number] for number in kept], middles)
                 for way, span in zip(own, spans, strict=True)}  # fmt: skip
        for place, number in enumerate(kept):
            nearer = tuple(
                parts[way][len(kept) - place if self.ways[way].name.startswith("-") else place]
                for way in own if self.ways[way].driven
            )  # fmt: skip
            cut = cuts[number]
            self.crossings.append(
                Crossing(edge, 1, middles[place], nearer, 2 * cut.half, shapes[place], cut.first)
            )

    def _at_junction(self, own: list[int], cut: _Cut) -> None:
        """Let a crossing belong to the nearest junction of its street that has none there yet."""
        length = float(arc_lengths(self.heights.lines)[1][cut.edge])
        end = int(cut.along > length / 2)
        first = self.ways[own[0]]
        onward = not first.name.startswith("-")
        junction = first.source if (end == 0) == onward else self.ways[own[0]].target
        taken = {(crossing.junction, way) for crossing in self.crossings for way in crossing.ways}
        crossed = tuple(way for way in own if self.ways[way].driven)
        if not any((junction, way) in taken for way in crossed):
            shape = self._shape(cut)
            self.crossings.append(
                Crossing(cut.edge, end, junction, crossed, 2 * cut.half,
                         shape if end else shape[::-1].copy(), cut.first or self.signals[junction])
            )  # fmt: skip

    def _shape(self, cut: _Cut) -> FloatArray:
        """(2, 3) from kerb to kerb, from the left of the street to its right."""
        middle, ahead = locate(self.heights.lines, [cut.edge], [cut.along])
        half = self.heights.network.half_width[cut.edge]
        left = np.array([-ahead[0, 1], ahead[0, 0]]) * half
        ends = np.stack([middle[0] + left, middle[0] - left])
        return np.round(self.heights.lifted(np.full(2, cut.edge), ends), 3)

    def _spans(self, edge: int, way: int, cuts: list[_Cut]) -> list[list[tuple[float, float]]]:
        """Return for each crossing and lane where one halts before it and where it ends."""
        back = self.ways[way].name.startswith("-")
        found = []
        for cut in cuts:
            near, far = cut.half + BEFORE, cut.half
            reach = (cut.along + near, cut.along - far) if back else (cut.along - near,
                                                                      cut.along + far)  # fmt: skip
            spots = shapely.points(locate(self.heights.lines, [edge, edge], list(reach))[0])
            found.append([
                tuple(shapely.line_locate_point(_flat(lane), spots).tolist())
                for lane in self.ways[way].lanes
            ])  # fmt: skip
        return found

    def _parts(
        self, number: int, spans: list[list[tuple[float, float]]], middles: list[int]
    ) -> list[int]:
        """Divide one way; return the numbers of its parts in its direction."""
        way = self.ways[number]
        if way.name.startswith("-"):
            spans, middles = spans[::-1], middles[::-1]
        count = len(middles)
        numbers = [number, *range(len(self.ways), len(self.ways) + count)]
        stops = [way.source, *middles, way.target]
        pieces = [_pieces(lane.shape, [span[k] for span in spans])
                  for k, lane in enumerate(way.lanes)]  # fmt: skip
        made = []
        for part in range(count + 1):
            lanes = tuple(replace(lane, shape=pieces[k][2 * part])
                          for k, lane in enumerate(way.lanes))  # fmt: skip
            name = f"{way.name}#{part}" if part else way.name
            made.append(replace(way, name=name, source=stops[part], target=stops[part + 1],
                                lanes=lanes))  # fmt: skip
        self.ways[number] = made[0]
        self.ways += made[1:]
        self.links += [
            Link((numbers[part], k), (numbers[part + 1], k), pieces[k][2 * part + 1])
            for part in range(count) for k, lane in enumerate(way.lanes) if lane.kind != "walk"
        ]  # fmt: skip
        self.last[number] = numbers[-1]
        return numbers

    def streets(self) -> Streets:
        """Return the streets as they have become."""
        links = [replace(link, source=(self.last[link.source[0]], link.source[1]))
                 for link in self.before.links]  # fmt: skip
        junctions = len(self.before.place)
        crossings = [
            replace(crossing, ways=tuple(self._end(way, crossing.junction)
                                         for way in crossing.ways))
            if crossing.junction < junctions else crossing
            for crossing in self.crossings
        ]  # fmt: skip
        return replace(
            self.before, ways=tuple(self.ways), links=(*links, *self.links),
            crossings=tuple(crossings), place=np.round(np.array(self.place), 3),
            signals=np.array(self.signals, bool),
        )  # fmt: skip

    def _end(self, way: int, junction: int) -> int:
        """Return the part of a way that lies at a junction."""
        return way if self.ways[way].source == junction else self.last[way]


def _flat(lane: Lane) -> shapely.LineString:
    return shapely.LineString(lane.shape[:, :2])


def _roomy(way: Way, spans: list[list[tuple[float, float]]], chosen: list[int]) -> bool:
    """Return whether enough of each lane is left before, between and after crossings."""
    for k, lane in enumerate(way.lanes):
        ends = sorted(spans[number][k] for number in chosen)
        cuts = np.array([0.0, *(place for pair in ends for place in pair), _flat(lane).length])
        if (np.diff(cuts)[::2] < LEAST).any():
            return False
    return True


def _pieces(shape: FloatArray, spans: list[tuple[float, float]]) -> list[FloatArray]:
    """Divide a line at places along it: what lies before, within and after each span."""
    line = shapely.LineString(shape)
    cuts = [0.0, *(place for span in spans for place in span), line.length]
    return [
        np.round(shapely.get_coordinates(substring(line, begin, end), include_z=True), 3)
        for begin, end in pairwise(cuts)
    ]


def with_paths(streets: Streets, city: City) -> Streets:
    """Add the footways on the ground, which end where people cross streets.

    Parameters
    ----------
    streets
        Streets with all their crossings.
    city
        The city.
    """
    network = city.network
    assert network is not None
    lines = _paths(city)
    if not len(lines):
        return streets
    spots = np.array(
        [shapely.buffer(shapely.LineString(each.shape[:, :2]), each.width / 2 + ROUND, quad_segs=2)
         for each in streets.crossings], object,
    )  # fmt: skip
    pieces = _between(lines, spots, city)
    tree = shapely.STRtree(spots)
    ends = shapely.get_point(np.repeat(pieces, 2), np.tile([0, -1], len(pieces)))
    near, crossing = tree.query(ends, "dwithin", 10.0**-SAME)
    junction = np.full(len(ends), -1, np.int64)
    junction[near[::-1]] = [streets.crossings[row].junction for row in crossing[::-1].tolist()]
    loose = np.flatnonzero(junction < 0)
    places = np.round(shapely.get_coordinates(ends[loose]), SAME)
    known, own = np.unique(places, axis=0, return_inverse=True)
    junction[loose] = len(streets.place) + own.ravel()
    there = (
        np.column_stack([known, city.terrain.height_at(known)]) if len(known) else np.zeros((0, 3))
    )
    ways: list[Way] = []
    for number, (piece, (source, target)) in enumerate(
        zip(pieces.tolist(), junction.reshape(-1, 2).tolist(), strict=True)
    ):
        if source != target:
            ways += _both_ways(number, piece, source, target, city)
    return replace(
        streets, ways=(*streets.ways, *ways), place=np.concatenate([streets.place, there]),
        signals=np.r_[streets.signals, np.zeros(len(known), bool)],
    )  # fmt: skip


def _between(lines: NDArray[Any], spots: NDArray[Any], city: City) -> NDArray[Any]:
    """Return the pieces of footways from one that they meet or crossing to the next."""
    network = city.network
    assert network is not None
    barred = barred_crossings(city.layout, network.lines)
    closed = shapely.buffer(
        shapely.points(locate(network.lines, barred.edge, barred.along)[0]),
        network.half_width[barred.edge] + ROUND,
    )
    noded = shapely.node(shapely.multilinestrings(lines))
    left = shapely.difference(noded, shapely.union_all([*spots, *closed]))
    merged = shapely.line_merge(left)
    parts = shapely.get_parts(merged)
    parts = parts[shapely.length(parts) > LEAST_PATH]
    order = np.lexsort(np.round(shapely.bounds(parts), 2).reshape(-1, 4).T)
    return np.asarray(shapely.normalize(parts[order]))


def _both_ways(number: int, piece: Any, source: int, target: int, city: City) -> list[Way]:
    points = shapely.get_coordinates(piece)
    shape = np.round(np.column_stack([points, city.terrain.height_at(points)]), 3)
    found = []
    for sign, line, ends in (("", shape, (source, target)), ("-", shape[::-1], (target, source))):
        lane = Lane(-1, "walk", 2 * HALF_STEP, FOOT, line, narrow=False)
        found.append(Way(f"{sign}path{number}", -1 - number, *ends, 0, (lane,), ()))
    return found
