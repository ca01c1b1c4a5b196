"""The surfaces of carriageways and junctions, as polygons.

Each edge becomes a strip from one junction to the next; each junction joins its arms up to their
trims and rounds the corners. The arrangement resolves what overlaps.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import (
    Polylines,
    arc_lengths,
    chords_of_quarter,
    locate,
    pieces,
    to_linestrings,
)
from cityx.ground.arrangement import GRID
from cityx.road.network.network import AIM, junction_clusters, node_corners
from cityx.road.surface.corners import LEAST_RADIUS, NOSE, NOSE_RADIUS, Arms, Corners

Shapes = NDArray[Any]

ROUND = 8  # chords per quarter circle beside bends; 1.5 cm off at a radius of 3 m
MITRE = 2.0  # longest mitre, in half widths; sharper bends are cut off
FINE = 0.01  # metres by which centrelines are simplified
OVERLAP = 0.5  # metres that a carriageway reaches into the junction surface, also where arms curve
SHORTEST = 0.5  # metres; a shorter piece between two junctions belongs to them
BEND = 0.05  # radians; below it the wedge at a bend is thinner than the kerb's joint
FLAT = np.radians(150.0)  # between arms whose kerbs run through; and as much beyond 180 degrees
BENT = np.radians(12.0)  # at the points of a centreline; less looks round
DIRECT = 0.95  # of the way along an arm that bends away is the straight one; it has no taper there
TURNED = np.radians(185.0)  # beyond it two strips leave a wedge open
TAPER = 8.0  # metres on both sides of a node along which a kerb passes from width to width
GORE_REACH = 60.0  # metres from the node within which a gore is paved up to its nose
HEAD = 2 * KERB_WIDTH  # metres
ASKEW = 2.0  # half widths that a street goes on beyond the border; one almost along it ends earlier
AGAIN = 0.25  # share by which the curve of a corner may begin further away on arms that bend
JOINT = GRID  # metres; more would show as a step of the kerb
HAIR = 0.001  # metres; thinner strips, which come from rounding, would join what lies apart
LEAST_CURVE = 0.03  # square metres; smaller pieces come from rounding
NOSE_REACH = 4 * LEAST_RADIUS  # metres behind a junction in which medians have their noses
NARROW_MEDIAN = 1.5  # metres; what parts two carriageways less is paved
LEAST_ISLAND = 6.0  # square metres; a smaller hole in a junction is paved


@dataclass(frozen=True)
class Carriageway:
    """The surfaces of all roads on the ground.

    Attributes
    ----------
    edge
        (k,) edges of the network that have a piece between junctions.
    strips
        (k,) polygons, their carriageways.
    node
        (j,) lowest node of each junction; nodes joined by edges that lie inside of it are one.
    stars
        (j,) polygons, the junction surfaces as far as the trims of their arms.
    curve_node, curves
        (c,) lowest node of the junction, and the surface behind which the kerb curves at a corner,
        or at all corners of several nodes; the carriageways win over it.
    discs, disc_edge
        Polygons that close the wedge at a bend, and the edge each belongs to.
    heads, head_edge
        Short pieces of carriageway before the decks that edges on the ground lead to.
    gores, gore_edge
        Wedges between two arms that part at a sharp angle, up to where they are paved.
    bends, bend_edge
        Polygons that round the inside of a bend, and their edges; the carriageways win over them.
    drawn
        Road areas of the map about them, drawn from kerb to kerb.
    """

    edge: IntArray
    strips: Shapes
    node: IntArray
    stars: Shapes
    curve_node: IntArray
    curves: Shapes
    discs: Shapes
    disc_edge: IntArray
    heads: Shapes
    head_edge: IntArray
    gores: Shapes
    gore_edge: IntArray
    bends: Shapes
    bend_edge: IntArray
    drawn: Shapes = field(default_factory=lambda: np.zeros(0, object))

    @property
    def kerbed(self) -> Shapes:
        """All surfaces behind whose rims kerbs stand, those of the map included."""
        return np.concatenate([self.driven, self.drawn])

    @property
    def driven(self) -> Shapes:
        """All surfaces whose rims kerbs follow."""
        return np.concatenate(
            [self.strips, self.stars, self.curves, self.discs, self.gores, self.bends]
        )


def build_carriageway(
    layout: Layout, network: RoadNetwork, on_ground: NDArray[np.bool_]
) -> Carriageway:
    """Widen the edges on the ground to strips that end where the junction surfaces begin."""
    lines = past_border(network, layout.extent, network.half_width)
    length = arc_lengths(lines)[1]
    begin, end = network.trim[:, 0], length - network.trim[:, 1]
    edge = np.flatnonzero(on_ground & (end - begin > SHORTEST))
    # A little overlap, so that rounding leaves no crack; the junction wins there.
    centre = pieces(lines, edge, begin[edge] - OVERLAP, end[edge] + OVERLAP)
    strips = widened(centre, network.half_width[edge])
    kind = layout.roads["kind"].to_numpy()[network.edge_road]
    arms, corners, _ = node_corners(
        layout, kind, lines, network.edge_nodes, network.node_position, network.half_width
    )
    junctions = _junctions(network, lines, arms, corners, on_ground)
    discs, disc_edge = _discs(network, lines, arms, on_ground)
    heads = _heads(network, lines, on_ground)
    gores = _gores(network, lines, arms, corners, on_ground)
    bends = _bends(network, lines, arms, corners, on_ground)
    return Carriageway(edge, strips, *junctions, discs, disc_edge, *heads, *gores, *bends)


def past_border(network: RoadNetwork, extent: tuple[float, ...], half: FloatArray) -> Polylines:
    """Return the centrelines, those that end at the site's border led on beyond it.

    A carriageway ends square. Where it runs out of the site askew, a corner of its end would lie
    inside, with a kerb and a sidewalk across the street.

    Parameters
    ----------
    extent
        (west, south, east, north) of the site, metres.
    half
        (e,) metres to both sides of the centrelines that shall reach the border.
    """
    lines = network.lines
    degree = np.bincount(network.edge_nodes.ravel(), minlength=len(network.node_position))
    low, high = np.array(extent[:2]), np.array(extent[2:])
    points = lines.points.copy()
    first, last = lines.start[:-1], lines.start[1:] - 1
    for end, (tip, inner) in enumerate(((first, first + 1), (last, last - 1))):
        ahead = lines.points[tip] - lines.points[inner]
        ahead /= np.maximum(np.hypot(*ahead.T), HAIR)[:, None]
        gap = np.stack([lines.points[tip] - low, high - lines.points[tip]], axis=1)  # (e, 2, 2)
        outward = np.stack([-ahead, ahead], axis=1)
        # Of a corner of the site the side that the street crosses more squarely counts.
        across = np.where(np.abs(gap) < JOINT, outward, 0.0).max(axis=(1, 2))
        leaves = (across > 0) & (degree[network.edge_nodes[:, end]] == 1)
        slope = np.sqrt(np.maximum(1 - across**2, 0)) / np.maximum(across, HAIR)
        reach = half * np.minimum(slope, ASKEW) + OVERLAP
        points[tip[leaves]] += (reach[:, None] * ahead)[leaves]
    return replace(lines, points=points)


def widened(lines: Polylines, half: Any) -> Shapes:
    """Widen centrelines to strips that end square.

    Parameters
    ----------
    lines
        k centrelines, scene frame, metres.
    half
        (k,) half their widths, or one for all, metres.
    """
    centre = shapely.simplify(to_linestrings(lines), FINE)
    return np.asarray(
        shapely.buffer(centre, half, cap_style="flat", join_style="mitre", mitre_limit=MITRE)
    )


def _heads(
    network: RoadNetwork, lines: Polylines, on_ground: NDArray[np.bool_]
) -> tuple[Shapes, IntArray]:
    """Extend carriageways by a kerb's width towards decks, so that no kerb lies before them."""
    decked = np.zeros(len(network.node_position), bool)
    decked[network.edge_nodes[~on_ground]] = True
    edge, end = np.nonzero(on_ground[:, None] & decked[network.edge_nodes])
    length = arc_lengths(lines)[1][edge]
    foot, ahead = locate(lines, edge, np.where(end == 0, 0.0, length))
    ahead = ahead * np.where(end == 0, -1.0, 1.0)[:, None]
    axis = shapely.linestrings(np.stack([foot - ahead * OVERLAP, foot + ahead * HEAD], axis=1))
    return np.asarray(shapely.buffer(axis, network.half_width[edge], cap_style="flat")), edge


def _discs(
    network: RoadNetwork, lines: Polylines, arms: Arms, on_ground: NDArray[np.bool_]
) -> tuple[Shapes, IntArray]:
    """Close the wedge where two edges meet at an angle, and lead from one width to another."""
    ground = on_ground[arms.edge]
    degree = np.bincount(arms.node[ground], minlength=len(network.node_position))
    after, gap = arms.following()
    half = network.half_width[arms.edge]
    bent = np.abs(gap - np.pi) > BEND
    uneven = np.abs(half - half[after]) > BEND
    chosen = ground & (degree[arms.node] == 2)
    # Both arms of a pair count, also where only one of them is followed by a bend.
    wanted = np.zeros(len(degree), bool)
    wanted[arms.node[chosen & (bent | uneven)]] = True
    discs, arm = _wedges(network, lines, arms, chosen & wanted[arms.node])
    return discs, arms.edge[arm]


def _junctions(
    network: RoadNetwork, lines: Polylines, arms: Arms, corners: Corners,
    on_ground: NDArray[np.bool_],
) -> tuple[IntArray, Shapes, IntArray, Shapes]:  # fmt: skip
    """Join the arms of each junction as far as their trims: nodes, surfaces, and their curves."""
    degree = np.bincount(arms.node[on_ground[arms.edge]], minlength=len(network.node_position))
    at_junction = on_ground[arms.edge] & (degree[arms.node] >= 3)
    rows = np.flatnonzero(at_junction)
    none = np.zeros(0, np.int64), np.zeros(0, object)
    if not len(rows):
        return (*none, *none)
    trim = np.maximum(network.trim[arms.edge[rows], arms.end[rows]], SHORTEST)
    strips = _arm_strips(network, lines, arms, rows, 0.0, trim)
    wedges, wedge_arm = _wedges(network, lines, arms, at_junction)
    cluster = junction_clusters(network)
    node = cluster[np.concatenate([arms.node[rows], arms.node[wedge_arm]])]
    stars, hubs = joined_by(np.concatenate([strips, wedges]), node)
    turned = np.flatnonzero(
        at_junction[corners.first] & at_junction[corners.second] & (corners.gap >= NOSE)
    )
    curves, row = _curves(network, lines, arms, corners, turned)
    curve_node = cluster[arms.node[corners.first[turned[row]]]]
    # Several nodes in one junction have corners between them that no node has by itself.
    several = np.bincount(cluster[np.unique(arms.node[rows])], minlength=len(degree)) > 1
    inner = several[curve_node]
    many = np.flatnonzero(several[hubs])
    joins = several[cluster[arms.node[rows]]]
    long = rows[joins]
    paved, _ = joined_by(
        np.concatenate(
            [stars[many], _arm_strips(network, lines, arms, long, 0.0, trim[joins] + NOSE_REACH)]
        ),
        np.concatenate([hubs[many], cluster[arms.node[long]]]),
    )
    joined, _ = joined_by(
        np.concatenate([paved, curves[inner]]), np.concatenate([hubs[many], curve_node[inner]])
    )
    medians = _medians(network, lines, arms, long)
    added, row = _inner_curves(paved, joined, hubs[many], medians)
    # What lies farther out rounds a bend of an arm, whose kerb is its own.
    near = shapely.distance(added, stars[many[row]]) < LEAST_RADIUS
    added, row = added[near], row[near]
    return (
        hubs,
        shapely.simplify(stars, GRID),
        np.concatenate([curve_node[~inner], hubs[many[row]]]),
        np.concatenate([curves[~inner], added]),
    )


def _arm_strips(
    network: RoadNetwork, lines: Polylines, arms: Arms, rows: IntArray, near: Any, far: Any
) -> Shapes:
    """Return the carriageways of some arms between two distances from their nodes."""
    part = _arm_lines(lines, arms, rows, near, far)
    return widened(part, network.half_width[arms.edge[rows]])


def _arm_lines(lines: Polylines, arms: Arms, rows: IntArray, near: Any, far: Any) -> Polylines:
    """Return the centrelines of some arms between two distances from their nodes."""
    edge, end = arms.edge[rows], arms.end[rows]
    length = arc_lengths(lines)[1][edge]
    begin, finish = np.minimum(near, length - SHORTEST), np.minimum(far, length)
    back = end == 1
    return pieces(
        lines, edge, np.where(back, length - finish, begin), np.where(back, length - begin, finish)
    )


def _inner_curves(
    paved: Shapes, joined: Shapes, hubs: IntArray, medians: tuple[IntArray, Shapes, FloatArray]
) -> tuple[Shapes, IntArray]:
    """Round all corners of junctions of several nodes: what lies before the curves, and its row.

    Parameters
    ----------
    paved, joined
        (j,) their surfaces with the beginnings of their arms, and these with known curves.
    hubs
        (j,) lowest node of each, rising.
    medians
        What `_medians` found; these keep noses, as wide as themselves.
    """
    node, between, width = medians
    row = np.searchsorted(hubs, node)
    radius = np.full(len(hubs), LEAST_RADIUS)
    added, owner = _added(paved, _without_small_holes(_closed(joined, radius)))
    np.minimum.at(radius, row, width / 2 - GRID)
    parted = np.unique(row)
    noses, at = _added(paved[parted], _without_small_holes(_closed(joined[parted], radius[parted])))
    zone = np.full(len(hubs), None, object)
    zone[parted] = joined_by(between, row)[0]
    wide = ~shapely.intersects(added, zone[owner])
    narrow = shapely.intersects(noses, zone[parted[at]])
    return (
        np.concatenate([added[wide], noses[narrow]]),
        np.concatenate([owner[wide], parted[at[narrow]]]),
    )


def _medians(
    network: RoadNetwork, lines: Polylines, arms: Arms, rows: IntArray
) -> tuple[IntArray, Shapes, FloatArray]:
    """Find medians between arms that run abreast from different nodes of one junction.

    Returns
    -------
    node, between, width
        (m,) the junction's lowest node, the land up to the middles of both arms, and metres.
    """
    cluster = junction_clusters(network)
    ends = cluster[network.edge_nodes[arms.edge[rows]]]
    rows = rows[ends[:, 0] != ends[:, 1]]
    trim = network.trim[arms.edge[rows], arms.end[rows]]
    strips = _arm_strips(network, lines, arms, rows, trim, trim + NOSE_REACH)
    one, other = shapely.STRtree(strips).query(
        strips, predicate="dwithin", distance=2 * LEAST_RADIUS
    )
    node, bearing = arms.node[rows], arms.bearing[rows]
    pair = (cluster[node[one]] == cluster[node[other]]) & (node[one] < node[other])
    pair &= np.cos(bearing[one] - bearing[other]) > np.cos(NOSE)
    width = shapely.distance(strips[one], strips[other])
    pair &= width > NARROW_MEDIAN
    one, other, width = one[pair], other[pair], width[pair]
    middles = to_linestrings(_arm_lines(lines, arms, rows, 0.0, trim + NOSE_REACH))
    between = shapely.convex_hull(shapely.union(middles[one], middles[other]))
    return cluster[node[one]], between, width


def _curves(
    network: RoadNetwork, lines: Polylines, arms: Arms, corners: Corners, rows: IntArray
) -> tuple[Shapes, IntArray]:
    """Round some corners between neighbouring arms: what lies before the curve, and its row."""
    pair = np.column_stack([corners.first[rows], corners.second[rows]])
    radius, gap = corners.radius[rows], corners.gap[rows]
    length = arc_lengths(lines)[1]
    # Arms bend: what they need may reach further than their trims.
    tangent = radius / np.tan(gap / 2)
    beyond = np.hypot(*(corners.place[rows] - network.node_position[arms.node[pair[:, 0]]]).T)
    strips = []
    for arm in pair.T:
        edge, end = arms.edge[arm], arms.end[arm]
        reach = np.maximum(network.trim[edge, end], beyond + tangent) + tangent * AGAIN + SHORTEST
        reach = np.minimum(reach, length[edge])
        begin = np.where(end == 0, 0.0, length[edge] - reach)
        strips.append(widened(pieces(lines, edge, begin, begin + reach), network.half_width[edge]))
    both = shapely.union(*strips)
    added, row = _added(both, _closed(both, radius))
    # A pair also has a notch behind its node, which other arms fill; and bends of its own.
    node = network.node_position[arms.node[pair[row, 0]]]
    kept = shapely.distance(added, shapely.points(node)) > SHORTEST / 2
    near = (tangent * AGAIN + SHORTEST)[row]
    kept &= shapely.distance(added, shapely.points(corners.place[rows[row]])) < near
    return added[kept], row[kept]


def _added(shapes: Shapes, closed: Shapes) -> tuple[Shapes, IntArray]:
    """Return the pieces by which shapes have grown, and the row of each."""
    grown = shapely.difference(closed, shapes, grid_size=HAIR)
    parts, row = shapely.get_parts(grown, return_index=True)
    kept = (shapely.get_type_id(parts) == 3) & (shapely.area(parts) > LEAST_CURVE)
    # They overlap what they join, so that rounding to the grid leaves no sliver between.
    return shapely.buffer(parts[kept], JOINT, join_style="bevel"), row[kept]


def _gores(
    network: RoadNetwork, lines: Polylines, arms: Arms, corners: Corners,
    on_ground: NDArray[np.bool_],
) -> tuple[Shapes, IntArray]:  # fmt: skip
    """Find the wedges between arms that part at a sharp angle, up to the nose that parts them."""
    rows = np.flatnonzero(
        (corners.gap < NOSE)
        & on_ground[arms.edge[corners.first]]
        & on_ground[arms.edge[corners.second]]
    )
    length = arc_lengths(lines)[1]
    pair = (corners.first[rows], corners.second[rows])
    reach = np.minimum(GORE_REACH, np.minimum(*(length[arms.edge[arm]] for arm in pair)))
    strips, rims = [], []
    for arm in pair:
        edge, end = arms.edge[arm], arms.end[arm]
        begin = np.where(end == 0, 0.0, length[edge] - reach)
        part = pieces(lines, edge, begin, begin + reach)
        strips.append(widened(part, network.half_width[edge]))
        rims.append(shapely.get_coordinates(to_linestrings(part), return_index=True))
    (points, owner), (others, other_owner) = rims
    ring = np.concatenate([points, others])
    hull = shapely.convex_hull(
        shapely.multipoints(ring[np.argsort(np.r_[owner, other_owner], kind="stable")],
                            indices=np.sort(np.r_[owner, other_owner]))
    ) if len(ring) else np.zeros(0, object)  # fmt: skip
    both = shapely.union(*strips)
    closed = _closed(both, np.full(len(both), NOSE_RADIUS))
    parts, row = _added(both, shapely.intersection(closed, hull))
    return parts, arms.edge[pair[1]][row]


def _bends(
    network: RoadNetwork, lines: Polylines, arms: Arms, corners: Corners,
    on_ground: NDArray[np.bool_],
) -> tuple[Shapes, IntArray]:  # fmt: skip
    """Round the inside of bends, where two edges meet, and at the points of one."""
    degree = np.bincount(arms.node[on_ground[arms.edge]], minlength=len(network.node_position))
    ground = on_ground[arms.edge]
    rows = np.flatnonzero(
        ground[corners.first]
        & ground[corners.second]
        & (degree[arms.node[corners.first]] == 2)
        & (corners.gap >= NOSE)
    )
    between, row = _curves(network, lines, arms, corners, rows)
    step = np.diff(lines.points, axis=0)
    owner = lines.line_of_point()
    same = owner[1:] == owner[:-1]
    point = np.flatnonzero(same[1:] & same[:-1]) + 1
    a, b = step[point - 1], step[point]
    turn = np.abs(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)))
    sharp = on_ground[owner[point]] & (turn > BENT) & (turn < np.pi - NOSE)
    point, turn = point[sharp], turn[sharp]
    edge = owner[point]
    along, length = arc_lengths(lines)
    half = network.half_width[edge]
    reach = (half + LEAST_RADIUS) * np.tan(turn / 2) + LEAST_RADIUS  # the next bend may be near
    begin = np.maximum(along[point] - reach, 0.0)
    local = widened(
        pieces(lines, edge, begin, np.minimum(along[point] + reach, length[edge])), half
    )
    inside, at = _added(local, _closed(local, np.full(len(local), LEAST_RADIUS)))
    first = arms.edge[corners.first[rows[row]]]
    return np.concatenate([between, inside]), np.concatenate([first, edge[at]])


def joined_by(shapes: Shapes, group: IntArray) -> tuple[Shapes, IntArray]:
    """Return the union of the shapes of each group, and the groups in order."""
    parts, row = shapely.get_parts(shapes, return_index=True)
    solid = shapely.get_dimensions(parts) == 2  # where shapes but touch, lines are left of them
    parts, row = parts[solid], row[solid]
    order = np.argsort(group[row], kind="stable")
    groups = np.unique(group)
    held, index = np.unique(group[row][order], return_inverse=True)
    found = np.full(len(groups), shapely.MultiPolygon(), object)
    if len(held):
        heaps = shapely.multipolygons(parts[order], indices=index)
        found[np.searchsorted(groups, held)] = shapely.union_all(
            np.asarray(heaps, object)[:, None], axis=1
        )
    return found, groups


@dataclass(frozen=True)
class Unions:
    """Unions of some of many shapes; those of the same ones are made once.

    Attributes
    ----------
    shapes
        (n,) polygons.
    width
        Metres by which they are made wider before.
    """

    shapes: Shapes
    width: float = 0.0
    _made: dict[bytes, Any] = field(default_factory=dict)

    @cached_property
    def tree(self) -> shapely.STRtree:
        """Search tree over the shapes as they are."""
        return shapely.STRtree(self.shapes)

    def of(self, rows: IntArray, group: IntArray) -> tuple[Shapes, IntArray]:
        """Return the union of the shapes of each group, given by rows, as `joined_by` does."""
        order = np.lexsort((rows, group))
        rows = rows[order]
        groups, start = np.unique(group[order], return_index=True)
        heaps = np.split(rows, start[1:]) if len(rows) else []
        names = [heap.tobytes() for heap in heaps]
        fresh = {name: heap for name, heap in zip(names, heaps, strict=True)
                 if name not in self._made}  # fmt: skip
        if fresh:
            shapes = self.shapes[np.concatenate(list(fresh.values()))]
            if self.width:
                with np.errstate(divide="ignore", invalid="ignore"):  # a needle's mitre is cut off
                    shapes = shapely.buffer(shapes, self.width, join_style="mitre")
            number = np.repeat(np.arange(len(fresh)), [len(heap) for heap in fresh.values()])
            self._made.update(zip(fresh, joined_by(shapes, number)[0], strict=True))
        return np.array([self._made[name] for name in names], object), groups


def _closed(shapes: Shapes, radius: FloatArray) -> Shapes:
    """Round the corners that a shape has towards its outside."""
    with np.errstate(divide="ignore", invalid="ignore"):  # at spikes, which the mitre limit cuts
        grown = shapely.buffer(shapes, radius, join_style="mitre", mitre_limit=MITRE)
    closed = np.full(len(shapes), None, object)
    chords = chords_of_quarter(radius)
    for count in np.unique(chords).tolist():
        rows = np.flatnonzero(chords == count)
        closed[rows] = shapely.buffer(grown[rows], -radius[rows], quad_segs=count)
    return closed


def _wedges(
    network: RoadNetwork, lines: Polylines, arms: Arms, chosen: NDArray[np.bool_]
) -> tuple[Shapes, IntArray]:
    """Fill what two strips leave open between them where they meet straight, or bend away.

    Parameters
    ----------
    chosen
        (a,) bool, arms to look at; both of a pair must be among them.

    Returns
    -------
    wedges, arm
        (w,) polygons and one arm of each.
    """
    after, gap = arms.following()
    both = chosen & chosen[after] & (after != np.arange(len(after)))
    rows = np.flatnonzero(both & (np.abs(gap - np.pi) < np.pi - FLAT))
    length = arc_lengths(lines)[1]
    corners = [network.node_position[arms.node[rows]]]
    for arm, other, side in ((rows, after[rows], 1.0), (after[rows], rows, -1.0)):
        edge, end = arms.edge[arm], arms.end[arm]
        along = np.maximum(network.trim[edge, end], np.minimum(TAPER, length[edge] / 2))
        # The kerb of the wider arm keeps its line up to the node.
        wider = network.half_width[edge] > network.half_width[arms.edge[other]] + BEND
        along = np.where(wider, 0.0, along)
        far = locate(lines, edge, np.where(end == 0, along, length[edge] - along))[0]
        direct = np.hypot(*(far - corners[0]).T)
        along = np.where(direct < DIRECT * along, np.minimum(along, AIM), along)
        at, ahead = locate(lines, edge, np.where(end == 0, along, length[edge] - along))
        ahead = ahead * np.where(end == 0, 1.0, -1.0)[:, None]
        left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
        corners.append(at + left * (side * network.half_width[edge])[:, None])
    tapers = shapely.polygons(np.stack(corners, axis=1))
    turned = np.flatnonzero(both & (gap > TURNED))
    half = network.half_width[arms.edge]
    centre = shapely.points(network.node_position[arms.node[turned]])
    discs = shapely.buffer(centre, np.minimum(half[turned], half[after[turned]]), quad_segs=ROUND)
    return np.concatenate([tapers, discs]), np.concatenate([rows, turned])


def _without_small_holes(shapes: Shapes) -> Shapes:
    """Pave the holes of junctions that are no islands."""
    filled = shapes.copy()
    parts, owner = shapely.get_parts(shapes, return_index=True)
    rings, of_part = shapely.get_rings(parts, return_index=True)
    outer = np.r_[True, of_part[1:] != of_part[:-1]][: len(rings)]
    hole = np.flatnonzero(~outer)
    patches = shapely.polygons(rings[hole])
    small = shapely.area(patches) < LEAST_ISLAND
    if small.any():
        patch, row = patches[small], owner[of_part[hole[small]]]
        patched, rows = joined_by(np.concatenate([patch, shapes[np.unique(row)]]),
                                np.concatenate([row, np.unique(row)]))  # fmt: skip
        filled[rows] = patched
    return filled
