"""Roundabouts: round rings, islands in the middle, painted discs, turning circles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL, SURFACES
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.polylines import Polylines, chords_of_quarter, to_linestrings
from cityx.ground.arrangement import Regions, join_regions, regions

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork

Shapes = NDArray[Any]

LEAST_ISLAND = 2.0  # metres of radius of the island in the middle of the smallest ring
NARROWEST = 1.6  # metres of half width of a ring
APRON = 1.5  # metres of setts round the island, for the rear wheels of lorries
LEAST_APRON = 5.0  # metres of radius of an island that has one
TIGHT = 0.3  # metres into an island that a street may be drawn without running through it
GREEN = 2.5  # metres of radius of an island with lawn; smaller ones are paved
ISLAND_PRIORITY = 77  # above all surfaces of its ring
CROSSED_PRIORITY = 53  # the same of an island that a street runs through: that goes on
MINI = 2.0  # metres of radius of the disc of a mini-roundabout (TSRGD 2016, diagram 611.1)
TURNING = 6.5  # metres of radius of a turning circle
CIRCLE = 12  # chords per quarter circle; 1.4 cm off at a radius of 6.5 m


@dataclass(frozen=True)
class Rings:
    """Closed rings of roundabouts.

    Attributes
    ----------
    polygon
        (r,) polygons that the middle of the ring's carriageway encloses.
    radius
        (r,) float, metres of a circle of the same area.
    """

    polygon: Shapes
    radius: FloatArray


def rings_of(lines: Shapes) -> Rings:
    """Find the rings that lines of roundabouts close."""
    if not len(lines):
        return Rings(np.zeros(0, object), np.zeros(0))
    found = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(lines))))
    return Rings(found, np.sqrt(shapely.area(found) / np.pi))


def round_rings(lines: Shapes, chosen: BoolArray) -> Shapes:
    """Draw the chosen lines as arcs through their points, which stay where they are.

    Parameters
    ----------
    lines
        (n,) LineStrings, metres.
    chosen
        (n,) bool, those of roundabouts.
    """
    drawn = lines.copy()
    for row in np.flatnonzero(chosen).tolist():
        drawn[row] = shapely.LineString(_arcs(shapely.get_coordinates(lines[row])))
    return drawn


def _arcs(points: FloatArray) -> FloatArray:
    """Put points on arcs between the points of one line, (k, 2)."""
    points = points[np.r_[True, np.hypot(*np.diff(points, axis=0).T) > 1e-6]]
    if len(points) < 3:
        return points
    step = np.diff(points, axis=0)
    ahead = step / np.hypot(*step.T)[:, None]
    closed = np.hypot(*(points[0] - points[-1])) < 1e-6
    inner = _unit(ahead[:-1] + ahead[1:])
    if closed:
        seam = _unit(ahead[-1:] + ahead[:1])
        first, last = seam, seam
    else:  # an arc leaves its chord by the angle at which it comes back to it
        first = 2 * (ahead[:1] * inner[:1]).sum(axis=1)[:, None] * ahead[:1] - inner[:1]
        last = 2 * (ahead[-1:] * inner[-1:]).sum(axis=1)[:, None] * ahead[-1:] - inner[-1:]
    tangent = np.concatenate([first, inner, last])
    out = [points[:1]]
    for a, b, u, v in zip(points[:-1], points[1:], tangent[:-1], tangent[1:], strict=True):
        turn = float(np.arccos(np.clip(u @ v, -1.0, 1.0)))
        chord = float(np.hypot(*(b - a)))
        quarter = float(chords_of_quarter(chord / max(2 * np.sin(turn / 2), 1e-9)))
        count = int(np.ceil(turn / (np.pi / 2) * quarter))
        if count > 1 and turn < np.pi / 2:
            share = 4.0 / 3.0 * np.tan(turn / 4.0) / (2.0 * np.sin(turn / 2.0))
            reach = chord * share
            t = (np.arange(1, count) / count)[:, None]
            c, d = a + u * reach, b - v * reach
            out.append(
                (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * c + 3 * (1 - t) * t**2 * d + t**3 * b
            )
        out.append(b[None])
    return np.asarray(np.round(np.concatenate(out), 3))


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.hypot(*vectors.T), 1e-9)[:, None])


def narrowed_rings(lines: Polylines, ring: BoolArray, half: FloatArray) -> FloatArray:
    """Narrow the carriageways of rings until an island fits into the middle: (e,) half widths."""
    rows = np.flatnonzero(ring)
    shapes = to_linestrings(lines)[rows]
    found = rings_of(shapes)
    narrow = half.copy()
    if len(found.polygon):
        outline = shapely.boundary(found.polygon)
        row, which = shapely.STRtree(outline).query(shapes, predicate="intersects")
        middle = shapely.line_interpolate_point(shapes[row], 0.5, normalized=True)
        on = shapely.distance(middle, outline[which]) < 0.01
        most = np.maximum(found.radius[which[on]] - LEAST_ISLAND, NARROWEST)
        np.minimum.at(narrow, rows[row[on]], most)
    return np.asarray(np.round(narrow, 3))


def ring_edges(layout: Layout, network: RoadNetwork) -> BoolArray:
    """(e,) whether each edge is a piece of a roundabout's ring."""
    return np.asarray(layout.roads["roundabout"].to_numpy(bool)[network.edge_road])


def ring_nodes(layout: Layout, network: RoadNetwork) -> BoolArray:
    """(n,) whether each node lies on a roundabout's ring."""
    found = np.zeros(len(network.node_position), bool)
    found[network.edge_nodes[ring_edges(layout, network)]] = True
    return found


def roundabout_regions(layout: Layout, network: RoadNetwork, on_ground: BoolArray) -> Regions:
    """Return the islands of roundabouts, and turning circles."""
    ring = ring_edges(layout, network) & on_ground
    return join_regions([_islands(network, ring), _turning_circles(layout, network, on_ground)])


@dataclass(frozen=True)
class Islands:
    """Islands in the middle of roundabouts, i of them.

    Attributes
    ----------
    id
        (i,) uint64, the least of the ids of the edges round each.
    polygon
        (i,) polygons that the middle of the ring's carriageway encloses.
    half
        (i,) float, metres from there to the apron.
    apron
        (i,) float, metres of setts before the kerb; 0 where there are none.
    radius
        (i,) float, metres of a circle as large as apron, kerb and middle.
    crossed
        (i,) bool, whether a street runs through.
    """

    id: NDArray[np.uint64]
    polygon: Shapes
    half: FloatArray
    apron: FloatArray
    radius: FloatArray
    crossed: BoolArray

    def within(self, inset: FloatArray | float) -> Shapes:
        """(i,) polygons that begin so many metres within the carriageway; empty ones beyond."""
        return np.asarray(shapely.buffer(self.polygon, -(self.half + inset), quad_segs=CIRCLE))


def islands_of(network: RoadNetwork, ring: BoolArray) -> Islands:
    """Find the islands that the chosen edges of rings, (e,) bool, go round."""
    rows, shapes = np.flatnonzero(ring), to_linestrings(network.lines)
    found = rings_of(shapes[rows])
    outline = shapely.boundary(found.polygon)
    row, which = shapely.STRtree(outline).query(shapes[rows], predicate="intersects")
    half = np.zeros(len(outline))
    np.maximum.at(half, which, network.half_width[rows[row]])
    least = np.full(len(outline), np.iinfo(np.uint64).max)
    np.minimum.at(least, which, network.edge_id[rows[row]])
    island = found.radius - half
    keep = (half > 0) & (island > 0.5)
    polygon, half, island = found.polygon[keep], half[keep], island[keep]
    crossed = np.zeros(len(island), bool)
    middle = shapely.buffer(polygon, -(half + TIGHT))
    crossed[shapely.STRtree(middle).query(shapes[~ring], predicate="intersects")[1]] = True
    apron = np.where(island > LEAST_APRON, APRON, 0.0)
    return Islands(least[keep], polygon, half, apron, island, crossed)


def _islands(network: RoadNetwork, ring: BoolArray) -> Regions:
    """Return apron, kerb and middle of each island."""
    found = islands_of(network, ring)
    if not len(found.polygon):
        return Regions()
    priority = np.where(found.crossed, CROSSED_PRIORITY, ISLAND_PRIORITY)
    layers = []
    for inset, label, order in (
        (0.0, "apron", 0), (found.apron, "kerb", 1), (found.apron + KERB_WIDTH, "middle", 2),
    ):  # fmt: skip
        shape = found.within(inset)
        name = np.where(found.radius < GREEN, "courtyard", "grass") if label == "middle" else label
        names = np.broadcast_to(name, len(shape)).tolist()
        layers.append(regions(shape, [LABEL[word] for word in names], priority + order))
    return join_regions(layers)


def _turning_circles(layout: Layout, network: RoadNetwork, on_ground: BoolArray) -> Regions:
    """Widen the ends of streets to circles in which a car turns."""
    places = _points(layout, "turning_circle")
    ends = np.zeros(len(network.node_position), np.int64)
    np.add.at(ends, network.edge_nodes[on_ground].ravel(), 1)
    dead = np.flatnonzero(ends == 1)
    if not len(places) or not len(dead):
        return Regions()
    spots = shapely.points(network.node_position[dead])
    _, node = shapely.STRtree(spots).query_nearest(places, max_distance=2.0)
    centre = np.unique(network.node_position[dead[node]], axis=0)
    disc = shapely.buffer(shapely.points(centre), TURNING, quad_segs=CIRCLE)
    stones = shapely.buffer(disc, KERB_WIDTH, quad_segs=CIRCLE)
    road, kerb = LABEL["carriageway"], LABEL["kerb"]
    return join_regions([
        regions(shapely.union_all(stones), kerb, SURFACES[kerb].priority),
        regions(shapely.union_all(disc), road, SURFACES[road].priority),
    ])  # fmt: skip


def mini_discs(layout: Layout, network: RoadNetwork) -> Shapes:
    """Return the painted discs of mini-roundabouts, at junctions that have room for them."""
    places = _points(layout, "mini_roundabout")
    hubs = np.flatnonzero(network.node_degree >= 3)
    if not len(places) or not len(hubs):
        return np.zeros(0, object)
    spots = shapely.points(network.node_position[hubs])
    _, node = shapely.STRtree(spots).query_nearest(places, max_distance=3.0)
    chosen = np.unique(hubs[node])
    size = np.zeros(len(network.node_position))
    np.maximum.at(size, network.edge_nodes, network.half_width[:, None] * np.ones(2))
    radius = np.minimum(MINI, size[chosen] - 0.8)
    centre = shapely.points(network.node_position[chosen])
    return np.asarray(shapely.buffer(centre, np.maximum(radius, 0.5), quad_segs=CIRCLE))


def _points(layout: Layout, kind: str) -> Shapes:
    points = layout.points
    return np.asarray(points.geometry.to_numpy()[(points["kind"] == kind).to_numpy()])
