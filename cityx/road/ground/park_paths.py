"""Paths of parks: mapped ones by their surface, and a network where a park has none.

A drawn network is a walk round the park inside of its edge, a middle from which straight walks
lead to it, and ways out to the streets where the park comes nearest to them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.geometry.arrays import FloatArray
from cityx.ground.arrangement import Regions, join_regions, regions

PARKS = ("park", "garden", "cemetery")
ON_FOOT = ("footway", "path", "cycleway", "steps", "bridleway", "pedestrian", "track", "service",
           "living_street")  # fmt: skip
IN_THE_WAY = ("water", "sea", "river", "pool", "pitch", "playground", "parking", "railway")
LEAST_AREA = 1500.0  # square metres; a smaller green is crossed, not walked in
MAPPED = 0.6  # metres of mapped path per square root of area from which a park has its own
WIDTH, RING_WIDTH = 2.6, 2.2  # metres
CLEAR = 1.8  # metres between a drawn path and water, pitches, houses
PER_GATE = 90.0  # metres of perimeter per way out
MOST_GATES = 7
GATE_REACH = 24.0  # metres from the park's edge to the street that a way out leads to
SAMPLE = 6.0  # metres between the places looked at for a way out
MIDDLE = 4000.0  # square metres from which a park has a middle with walks to it
ROUNDED = 6.0  # metres, radius of the bends of the walk round


@dataclass(frozen=True)
class ParkPaths:
    """Paths drawn into parks without mapped ones.

    Attributes
    ----------
    lines
        (n,) LineStrings.
    width
        (n,) metres.
    gates
        (g, 2) where paths leave the park.
    middles
        (m, 3) middles of parks, x and y and the radius of the round there, metres.
    """

    lines: NDArray[Any]
    width: FloatArray
    gates: FloatArray
    middles: FloatArray


def unmapped_parks(layout: Layout) -> NDArray[Any]:
    """(n,) polygons of parks that are large enough for paths and have next to none on the map."""
    areas, roads = layout.areas, layout.roads
    shapes = areas.geometry.to_numpy()
    large = np.isin(areas["kind"].to_numpy().astype(str), PARKS) & (
        shapely.area(shapes) > LEAST_AREA
    )
    shapes = shapely.intersection(shapes[large], shapely.box(*layout.extent))
    shapes = shapely.get_parts(shapes)
    shapes = shapes[(shapely.get_type_id(shapes) == 3) & (shapely.area(shapes) > LEAST_AREA)]
    ways = roads.geometry.to_numpy()[np.isin(roads["kind"].to_numpy().astype(str), ON_FOOT)]
    have = np.zeros(len(shapes))
    if len(ways) and len(shapes):
        park, way = shapely.STRtree(ways).query(shapes, predicate="intersects")
        inside = shapely.length(shapely.intersection(ways[way], shapes[park]))
        np.add.at(have, park, inside)
    return np.asarray(shapes[have < MAPPED * np.sqrt(shapely.area(shapes))])


def park_paths(layout: Layout) -> ParkPaths:
    """Draw a network of paths into every park that has none on the map."""
    lines: list[Any] = []
    width: list[float] = []
    gates: list[FloatArray] = []
    middles: list[tuple[float, float, float]] = []
    parks = unmapped_parks(layout)
    if len(parks):
        roads, areas = layout.roads, layout.areas
        walked = ~roads["tunnel"].to_numpy() & (roads["layer"].to_numpy() == 0)
        walked &= ~np.isin(roads["kind"].to_numpy().astype(str), ("rail", "subway", "motorway"))
        streets = roads.geometry.to_numpy()[walked]
        half = np.nan_to_num(roads["width"].to_numpy()[walked] / 2, nan=1.5)
        closed = np.isin(areas["kind"].to_numpy().astype(str), IN_THE_WAY)
        solid = np.concatenate([areas.geometry.to_numpy()[closed],
                                layout.buildings.geometry.to_numpy()])  # fmt: skip
        blocks = np.concatenate([shapely.buffer(solid, CLEAR, quad_segs=2),
                                 shapely.buffer(streets, half + CLEAR, quad_segs=2)])  # fmt: skip
        block_tree, street_tree = shapely.STRtree(blocks), shapely.STRtree(streets)
        for park in parks:
            near = np.sort(block_tree.query(park, predicate="intersects"))
            free = _areas_of(shapely.difference(park, shapely.unary_union(blocks[near])))
            found = _network(park, free, streets, street_tree)
            lines += found[0]
            width += found[1]
            gates += found[2]
            middles += found[3]
    return ParkPaths(np.array(lines, dtype=object), np.array(width), np.array(gates).reshape(-1, 2),
                     np.array(middles).reshape(-1, 3))  # fmt: skip


def _areas_of(shape: Any) -> Any:
    """Return ground without the lines that come with it where things only touch."""
    if shapely.get_type_id(shape) != shapely.GeometryType.GEOMETRYCOLLECTION:
        return shape
    parts = shapely.get_parts(shape)
    return shapely.multipolygons(parts[shapely.get_dimensions(parts) == 2])


def _network(
    park: Any, free: Any, streets: NDArray[Any], tree: Any
) -> tuple[list[Any], list[float], list[FloatArray], list[tuple[float, float, float]]]:
    """Lines, widths, gates and middle of one park."""
    size = float(shapely.area(park)) ** 0.5
    gates, ways = _gates(park, streets, tree)
    deepest = shapely.get_point(shapely.maximum_inscribed_circle(free, 1.0), 0)
    inset = float(np.clip(0.16 * size, 4.5, 13.0))
    inner = shapely.buffer(shapely.buffer(park, -inset - ROUNDED), ROUNDED, quad_segs=4)
    pieces = shapely.get_parts(inner)
    pieces = pieces[shapely.area(pieces) > 0.15 * size * size]
    lines: list[Any] = []
    middles: list[tuple[float, float, float]] = []
    feet = np.full(len(gates), deepest, dtype=object)
    if len(pieces):
        rim = shapely.get_exterior_ring(pieces[np.argmax(shapely.area(pieces))])
        ring = shapely.simplify(rim, 0.15)
        # What stands in the way of the walk round cuts it.
        parts = shapely.get_parts(shapely.line_merge(shapely.intersection(ring, free)))
        lines += [part for part in parts if shapely.length(part) > SAMPLE]
        feet = shapely.line_interpolate_point(ring, shapely.line_locate_point(ring, gates))
        if size * size > MIDDLE:
            x, y = shapely.get_coordinates(deepest)[0]
            middles.append((float(x), float(y), float(np.clip(0.05 * size, 3.0, 8.0))))
            lines += _straight(free, feet, np.full(len(feet), deepest, dtype=object))
    width = [RING_WIDTH] * len(lines)
    walks = _straight(park, gates, feet)
    exits = [shapely.LineString(shapely.get_coordinates([way, gate]))
             for way, gate in zip(ways, gates, strict=True)]  # fmt: skip
    if not walks:  # a park too narrow to walk in
        return [], [], [], []
    lines += [*walks, *exits]
    width += [WIDTH] * (len(walks) + len(exits))
    return lines, width, [shapely.get_coordinates(gate)[0] for gate in gates], middles


def _straight(free: Any, begin: NDArray[Any], end: NDArray[Any]) -> list[Any]:
    """Straight walks between points; one that would cross a pond or a pitch is left out."""
    around = shapely.buffer(free, 0.5)
    lines = [shapely.LineString(shapely.get_coordinates([a, b]))
             for a, b in zip(begin, end, strict=True)]  # fmt: skip
    return [line for line in lines if shapely.covers(around, line) and shapely.length(line) > 1.0]


def _gates(park: Any, streets: NDArray[Any], tree: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    """Points of a park's edge nearest to streets, one per stretch, and the street's near point."""
    rim = shapely.get_exterior_ring(park)
    length = float(shapely.length(rim))
    along = np.arange(0.0, length, SAMPLE)
    spots = shapely.line_interpolate_point(rim, along)
    spot, way = tree.query_nearest(spots, max_distance=GATE_REACH, all_matches=False)
    if not len(spot):
        return np.zeros(0, object), np.zeros(0, object)
    gap = shapely.distance(spots[spot], streets[way])
    count = int(np.clip(round(length / PER_GATE), 2, MOST_GATES))
    stretch = np.minimum((along[spot] / length * count).astype(int), count - 1)
    order = np.lexsort((spot, np.round(gap, 2), stretch))
    first = order[np.unique(stretch[order], return_index=True)[1]]
    chosen, line = spots[spot[first]], streets[way[first]]
    on_street = shapely.line_interpolate_point(line, shapely.line_locate_point(line, chosen))
    return np.asarray(chosen), np.asarray(on_street)


def park_regions(layout: Layout) -> Regions:
    """Return the paths that are drawn into parks, as gravel."""
    found = park_paths(layout)
    if not len(found.lines):
        return Regions()
    label = LABEL["trail"]
    bands = shapely.buffer(found.lines, found.width / 2, quad_segs=3, join_style="round")
    rounds = shapely.buffer(shapely.points(found.middles[:, :2]), found.middles[:, 2] + WIDTH,
                            quad_segs=8)  # fmt: skip
    joined = shapely.unary_union(np.concatenate([bands, rounds]))
    clipped = shapely.intersection(joined, shapely.box(*layout.extent))
    return join_regions([regions(clipped, label, SURFACES[label].priority)])
