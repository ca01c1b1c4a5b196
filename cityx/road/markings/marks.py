"""What the marks of streets share: their frame, where lines may run, and plain shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, MeshBatch
from cityx.city.layout import Layout
from cityx.city.mesh import NO_VERTEX, one_mesh
from cityx.city.roads import RoadNetwork
from cityx.city.section import KIND, TRAVELLED
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, arc_lengths, locate, miters
from cityx.ground.pieces import heights
from cityx.ground.walking.mapped_crossings import (
    BARE,
    BARS,
    SIGNALS,
    MappedCrossings,
    mapped_crossings,
)
from cityx.places.painting import Painting
from cityx.road.markings.crossing_places import (
    BEFORE,
    DEPTH,
    RING_SETBACK,
    SETBACK,
    STOP,
    at_ends,
    crossing_middles,
    depths,
    mouths,
)
from cityx.road.network.network import arm_bearings, junction_clusters, node_corners
from cityx.road.network.sections import Bands
from cityx.road.network.signal_places import signal_places
from cityx.road.surface.corners import Arms
from cityx.road.surface.roundabouts import ring_edges, ring_nodes

Shapes = NDArray[Any]
Marks = tuple[Shapes, IntArray]  # polygons and the edge each lies on

USUAL = Painting()
LINE = 0.12  # metres, width of a longitudinal line
ZEBRA = DEPTH  # metres along a street
SIGNAL_REACH = 25.0  # metres from a junction or crossing to the signals or signs that rule it
KINDS = ("none", "zebra", "dotted", "bare")  # of crossings
LOWERED = r'"cityx:crossings": *"lowered"'
NONE, STRIPED, DOTTED, PLAIN = range(4)
ONE_ROAD = np.radians(25.0)  # between arms that leave a junction as one road
QUIET = ("service", "track")  # a drive that meets a street makes no junction of it
RANK = (
    "motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential",
)  # fmt: skip
CLASSIFIED = RANK.index("secondary")  # and roads before it
_MOVING = [KIND[name] for name in TRAVELLED]
_FOR_CARS = [KIND[name] for name in ("drive", "bus")]


@dataclass(frozen=True)
class Street:
    """What the marks of one network share, e edges.

    Attributes
    ----------
    layout, network, bands
        What is painted.
    lines, length
        Centrelines and their lengths, metres.
    kind
        (e,) class of the road.
    setback
        (e, 2) float, metres from the junctions at both ends to a crossing; less than 0 where it
        lies before the curves of the kerbs end.
    depth
        (e,) float, metres of a crossing along the road.
    crossing
        (e, 2) into `KINDS`: bars, two rows of short marks, or lowered kerbs alone.
    mouth
        (e, 2) float, metres from the nodes at which the kerbs of an arm have left its street by
        `FLARE` at most.
    mapped, told
        Crossings of the map, and the kind of each.
    """

    layout: Layout
    network: RoadNetwork
    lines: Polylines
    length: FloatArray
    kind: NDArray[np.str_]
    bands: Bands
    setback: FloatArray
    depth: FloatArray
    crossing: IntArray
    mouth: FloatArray
    mapped: MappedCrossings
    told: IntArray

    @property
    def marked(self) -> BoolArray:
        """(e, 2) whether a crossing with paint lies at the ends of edges."""
        return np.isin(self.crossing, (STRIPED, DOTTED))

    @property
    def halt(self) -> FloatArray:
        """(e, 2) metres from the junctions to the lines before crossings with paint."""
        return self.setback + self.depth[:, None] + BEFORE

    @property
    def free(self) -> tuple[FloatArray, FloatArray]:
        """Begin and end of the part of each edge that carries longitudinal lines."""
        network = self.network
        taken = np.maximum(self.halt + STOP + 0.3, 1.0)
        room = network.trim + np.where(self.marked, taken, np.where(network.trim > 0, 1.0, 0))
        return room[:, 0], self.length - room[:, 1]

    @cached_property
    def rank(self) -> IntArray:
        """(e,) place of the road's class in `RANK`, or behind the last; ramps rank as roads do."""
        rank = np.full(len(self.kind), len(RANK))
        for value, word in enumerate(RANK):
            rank[np.char.startswith(self.kind, word)] = value
        return rank

    @cached_property
    def best(self) -> IntArray:
        """(n,) rank of the highest of the roads that meet at a node."""
        best = np.full(len(self.network.node_position), len(RANK))
        np.minimum.at(best, self.network.edge_nodes, self.rank[:, None] * np.ones(2, int))
        return best

    @cached_property
    def joint(self) -> BoolArray:
        """(n,) whether streets meet at a node, rather than drives that join one."""
        network = self.network
        street = ~np.isin(self.kind, QUIET)
        count = np.bincount(network.edge_nodes[street].ravel(), minlength=len(self.best))
        return count >= 3

    @cached_property
    def signalled(self) -> BoolArray:
        """(n,) whether streets meet at a node under signals."""
        places = shapely.points(self.network.node_position)
        return self.joint & near_any_of(places, signal_places(self.layout))

    @cached_property
    def cluster(self) -> IntArray:
        """(n,) lowest node of the junction that each node belongs to."""
        return junction_clusters(self.network)

    @cached_property
    def arms(self) -> IntArray:
        """(n,) arms of the junction whose lowest node each is."""
        ends = self.cluster[self.network.edge_nodes]
        outside = ends[ends[:, 0] != ends[:, 1]]
        return np.bincount(outside.ravel(), minlength=len(self.cluster))

    @cached_property
    def directions(self) -> IntArray:
        """(n,) in how many directions streets leave the junction whose lowest node each is.

        Both carriageways of a road leave it in one; drives do not count.
        """
        ends = self.cluster[self.network.edge_nodes]
        street = (ends[:, 0] != ends[:, 1]) & ~np.isin(self.kind, QUIET)
        edge, end = np.repeat(np.flatnonzero(street), 2), np.tile([0, 1], int(street.sum()))
        hub, bearing = ends[edge, end], arm_bearings(self.lines, edge, end)
        order = np.lexsort((bearing, hub))
        arms = Arms(hub[order], edge[order], end[order], bearing[order])
        apart = arms.following()[1] > ONE_ROAD
        return np.bincount(arms.node[apart], minlength=len(self.cluster))

    @cached_property
    def ruled_hubs(self) -> IntArray:
        """Lowest nodes of the junctions under signals."""
        return np.asarray(np.unique(self.cluster[self.signalled]))


def street_of(
    layout: Layout, network: RoadNetwork, bands: Bands, painting: Painting = USUAL
) -> Street:
    """Gather what marks depend on."""
    lines = network.lines
    kind = layout.roads["kind"].to_numpy()[network.edge_road].astype(str)
    at_ring = ring_nodes(layout, network)[network.edge_nodes]
    setback = np.where(at_ring & ~ring_edges(layout, network)[:, None], RING_SETBACK, SETBACK)
    depth = depths(kind)
    # A short arm has no room for the distance from a ring.
    length = arc_lengths(lines)[1]
    tight = (length - network.trim.sum(axis=1))[:, None] < setback + depth[:, None] + 6.0
    setback = np.where(tight, SETBACK, setback)
    arms, corners, _ = node_corners(
        layout, kind, lines, network.edge_nodes, network.node_position, network.half_width
    )
    mouth = np.minimum(mouths(arms, corners, network.half_width, len(kind)), network.trim)
    mapped = mapped_crossings(layout, lines)
    joint = network.node_degree[network.edge_nodes] >= 3
    place, told = at_ends(mapped, length, network.trim, joint)
    middle = crossing_middles(place, mouth, network.trim + setback, depth)
    setback = middle - depth[:, None] / 2 - network.trim
    none = np.zeros(told.shape, np.int64)
    plain = Street(layout, network, lines, length, kind, bands, setback, depth, none, mouth,
                   mapped, mapped.told)  # fmt: skip
    ruled = plain.signalled[network.edge_nodes]
    return replace(
        plain,
        crossing=np.where(network.crossing, _kinds(told, ruled, painting), NONE),
        told=_kinds(mapped.told, mapped.told == SIGNALS, painting),
    )


def _kinds(told: IntArray, ruled: BoolArray, painting: Painting) -> IntArray:
    """Choose what crossings look like, into `KINDS`, by what the map tells and the signals."""
    under_signals = STRIPED if painting.signal_crossing == "bars" else DOTTED
    usual = np.where(ruled, under_signals, STRIPED if painting.zebras else PLAIN)
    return np.select(
        [told == BARE, (told == SIGNALS) | ruled, told == BARS],
        [PLAIN, under_signals, STRIPED],
        usual,
    )


def painted_edges(street: Street, on_ground: BoolArray) -> BoolArray:
    """(e,) edges on the ground, long enough and paved so that paint holds."""
    room = street.length - street.network.trim.sum(axis=1) > 4.0
    room |= street.network.crossing.any(axis=1)
    surface = street.layout.roads["surface"].to_numpy()[street.network.edge_road].astype(str)
    return np.asarray(on_ground & room & np.isin(surface, ("asphalt", "concrete", "paved", "")))


def lowered_edges(street: Street, on_ground: BoolArray) -> BoolArray:
    """(e,) edges whose kerbs are said to be lowered where people cross, painted or not."""
    tags = street.layout.roads["tags"].iloc[street.network.edge_road]
    said = tags.str.contains(LOWERED, regex=True).to_numpy().astype(bool)
    return np.asarray(on_ground & said)


def spans_of(bands: Bands, count: int, direction: int) -> tuple[FloatArray, FloatArray]:
    """(e,) lateral bounds of the lanes of one direction; empty where there are none."""
    rows = np.flatnonzero(np.isin(bands.kind, _MOVING) & (bands.direction == direction))
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, bands.edge[rows], bands.right[rows])
    np.maximum.at(high, bands.edge[rows], bands.left[rows])
    return low, high


def lane_count(bands: Bands, count: int, direction: int) -> IntArray:
    """(e,) number of lanes for cars in one direction."""
    cars = np.isin(bands.kind, _FOR_CARS) & (bands.direction == direction)
    return np.bincount(bands.edge[cars], minlength=count)


def near_any_of(spots: Shapes, places: Shapes) -> BoolArray:
    """(k,) whether signals or signs at some places rule what lies near them."""
    found = np.zeros(len(spots), bool)
    if len(places):
        tree = shapely.STRtree(places)
        found[tree.query(spots, predicate="dwithin", distance=SIGNAL_REACH)[0]] = True
    return found


def paved_share(marks: Shapes, *surfaces: Shapes) -> FloatArray:
    """(k,) share of each mark that lies on surfaces, which overlap little."""
    on = np.zeros(len(marks))
    for shapes in surfaces:
        mark, surface = shapely.STRtree(shapes).query(marks, predicate="intersects")
        common = shapely.intersection(marks[mark], shapes[surface])
        on += np.bincount(mark, shapely.area(common), minlength=len(marks))
    return np.asarray(on / np.maximum(shapely.area(marks), 1e-9))


def together(marks: list[Marks]) -> Marks:
    """Join marks in their order."""
    return np.concatenate([mark for mark, _ in marks]), np.concatenate([edge for _, edge in marks])


def boxes(
    lines: Polylines,
    edge: IntArray,
    along: FloatArray,
    lateral: FloatArray,
    length: FloatArray | float,
    width: FloatArray,
) -> Marks:
    """Rectangles in the frame of their edge, `length` along it and `width` across."""
    keep = width > 0.1
    length = np.broadcast_to(np.asarray(length, float), len(keep))[keep]
    edge, along, lateral, width = edge[keep], along[keep], lateral[keep], width[keep]
    if not len(edge):
        return np.zeros(0, object), edge
    position, direction = locate(lines, edge, along)
    across = np.column_stack([-direction[:, 1], direction[:, 0]])
    centre = position + across * lateral[:, None]
    u, v = direction * (length / 2)[:, None], across * (width / 2)[:, None]
    corners = np.stack([centre - u - v, centre + u - v, centre + u + v, centre - u + v], axis=1)
    return np.asarray(shapely.polygons(corners)), edge


def hatched(shape: Any, along: FloatArray, spacing: float, width: float) -> Any:
    """Return bars within a shape, `spacing` metres from middle to middle, along a unit vector."""
    across = np.array([-along[1], along[0]])
    corners = shapely.get_coordinates(shape)
    if not len(corners):
        return shape
    low, high = (corners @ across).min(), (corners @ across).max()
    near, far = (corners @ along).min(), (corners @ along).max()
    # Counted from the origin, so that the bars of neighbours are in line.
    place = np.arange(np.ceil(low / spacing), np.floor(high / spacing) + 1) * spacing
    ends = [place[:, None] * across + reach * along for reach in (near, far)]
    bars = shapely.buffer(
        shapely.linestrings(np.stack(ends, axis=1)), width / 2, cap_style="flat"
    )  # fmt: skip
    return shapely.intersection(shapely.union_all(bars), shape)


def rimmed(
    shape: Any, ways: Sequence[FloatArray], spacing: float, width: float, *, rim: float
) -> Any:
    """Return a rim within a shape and the bars of `hatched` along each of some unit vectors."""
    inner = shapely.buffer(shape, -rim, join_style="mitre")
    bars = [hatched(shape, way, spacing, width) for way in ways]
    return shapely.union_all([shapely.difference(shape, inner), *bars])


def painted_strips(
    city: City, lines: Polylines, width: float, over: float, own_id: int
) -> MeshBatch:
    """Make white strips along lines, one object.

    Parameters
    ----------
    city
        City with its ground.
    lines
        Metres, with points near enough to each other to follow the ground.
    width
        Metres.
    over
        Metres above the ground.
    own_id
        Of the object.
    """
    side = miters(lines) * (width / 2)
    ends = lines.points[lines.start[:-1]] - lines.points[lines.start[1:] - 1]
    closed = np.hypot(*ends.T) < 0.01
    xy = np.stack([lines.points + side, lines.points - side], axis=1)  # (p, 2, 2)
    # A closed line's last corner is its first one, met square.
    first, last = lines.start[:-1][closed], lines.start[1:][closed] - 1
    reach = lines.points[first] - lines.points[np.maximum(last - 1, 0)]
    reach /= np.maximum(np.hypot(*reach.T), 1e-9)[:, None]
    xy[last] += (width / 2) * reach[:, None]
    z = heights(city, lines.points) + over
    vertices = np.concatenate([xy, np.repeat(z, 2).reshape(-1, 2, 1)], axis=2).reshape(-1, 3)
    owner = lines.line_of_point()
    here = np.flatnonzero(owner[1:] == owner[:-1]) * 2
    faces = np.concatenate([np.column_stack([here, here + 1, here + 3]),
                            np.column_stack([here, here + 3, here + 2])])  # fmt: skip
    table = np.column_stack([faces, np.full(len(faces), NO_VERTEX)])
    uv = np.zeros((len(faces), 4, 2))
    uv[:, :3] = vertices[faces][:, :, :2]
    return one_mesh(own_id, vertices, table, materials=("marking_white",),
                    uv=uv)  # fmt: skip
