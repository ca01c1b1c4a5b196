"""Checks of junctions, measured on the finished ground: surfaces, walks and the curves of kerbs."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from cityx.checks.check import NAMED, Check, named
from cityx.city import City
from cityx.city.ground import LABEL, ON_ROADWAY, ROADWAY, Ground
from cityx.city.layout import Layout
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components, join_segments
from cityx.geometry.polylines import Polylines, every, locate, to_linestrings
from cityx.ground.arrangement import BEYOND, edge_lengths, face_areas, owners

STONES = ("kerb", "kerb_dropped")
# Where crossings cut a median down.
WAYS_THROUGH = ("tactile", "tactile_pale", "tactile_buff", "tactile_red", "landing", "ramp")
RADII = (3.0, 12.0)  # metres a kerb's curve may have between two arms
SLACK = 0.1  # share by which a radius measured on chords may miss
SMOOTH = 0.02  # metres; corners of the outline that stand out less come from rounding
CHORD = 2.6  # metres; longer pieces of an outline are straight
JOINT = 0.12  # metres; corners of the outline closer than that are one
CORNER = np.radians([30.0, 125.0])  # turns of the kerb that lead from one arm into the next
DRAWN = 2.0  # metres from a curve to a tram track whose bed, or a rim, that makes the corner
HOUSE = 3.1  # metres from a curve to a house that leaves no room for the least radius and a walk
ALONG = 8.0  # metres from a junction at which the direction of an arm is seen
BESIDE = 4.0  # metres beyond a junction's mouth within which a curve belongs to it
GROUNDED = 0.05  # metres; lanes farther off the ground lie on structures of their own
SPACING = 1.0  # metres between the places of a lane that are tested
TIMES = 3.0  # times the product of its two widest arms that a junction may cover
RETURN = 5.0  # metres of kerb radius that an arm's mouth is wider for
LET_PASS = 2  # kerb curves outside of the limits, of which a small map has few


@dataclass(frozen=True)
class KerbCurves:
    """Curves of kerbs at junctions, k of them.

    Attributes
    ----------
    middle
        (k, 2) float, metres.
    turn
        (k,) float, radians.
    radius
        (k,) float, metres.
    free
        (k,) bool, whether the radius is free: set by no house so near, surface drawn on the map,
        tram track, or rim of the site, and by no corner that nothing may turn about.
    """

    middle: FloatArray
    turn: FloatArray
    radius: FloatArray
    free: BoolArray


def check_junctions(city: City) -> list[Check]:
    """Run every check on junctions; none where the ground has no kerbs or no streets."""
    ground, network = city.ground, city.network
    if ground is None or network is None or city.lod == 0 or not network.edge_count:
        return []
    found = [*_surfaces(ground), _walks(city, ground)]
    curves = kerb_curves(city, ground)
    wrong = curves.free & ~_within(curves.radius)
    free = int(curves.free.sum())
    return [
        *found,
        Check(
            "kerb_radius",
            1.0 - max(int(wrong.sum()) - LET_PASS, 0) / free if free else 1.0,
            0.9,
            f"share of {free:,} kerb curves between two arms of a junction with a radius of "
            f"{RADII[0]:g} to {RADII[1]:g} m, {LET_PASS} others let pass; "
            f"{int((~curves.free).sum()):,} where houses leave no room, where nothing may turn, or "
            "the map's rim, its tram tracks or road areas make the corner, are left out",
            at_least=True,
            ids=_places(curves.middle[wrong]),
        ),
    ]


def _within(radius: FloatArray) -> BoolArray:
    return np.asarray((radius > RADII[0] * (1 - SLACK)) & (radius < RADII[1] * (1 + SLACK)))


def _places(points: FloatArray) -> tuple[str, ...]:
    return tuple(f"({x:.1f}, {y:.1f})" for x, y in points[:NAMED].tolist())


def _surfaces(ground: Ground) -> list[Check]:
    """Check that every junction is one closed, simple surface of sensible size."""
    owner = _junction_of_face(ground)
    left, right = ground.edge_faces.T.astype(np.int64)
    mine, theirs = owner[left], np.where(right == BEYOND, 0, owner[np.maximum(right, 0)])
    rim = mine != theirs
    # Both sides of an edge may be junctions; each gets the edge as a piece of its outline.
    junction = np.concatenate([mine[rim], theirs[rim]])
    ends = np.concatenate([ground.edges[rim], ground.edges[rim][:, ::-1]]).astype(np.int64)
    own = junction > 0
    junction, ends = junction[own], ends[own]
    count = int(owner.max(initial=0)) + 1
    # One number of a junction and a corner, or a piece, sorts ten times as fast as rows of two.
    size = len(ground.vertices)
    corner, times = np.unique(np.repeat(junction, 2) * size + ends.ravel(), return_counts=True)
    bad = np.zeros(count, bool)
    bad[corner[times != 2] // size] = True
    inner = (mine == theirs) & (mine > 0)
    piece = components(np.column_stack([left, right])[inner], len(owner))
    held = owner > 0
    parts = np.unique(owner[held] * len(owner) + piece[held]) // len(owner)
    bad |= np.bincount(parts, minlength=count) > 1
    ids = np.unique(ground.face_object[ground.face_label == LABEL["junction"]])
    area = np.bincount(owner, face_areas(ground), minlength=count)
    limit = _usual_size(ground, owner, count)
    large = area[1:] > limit[1:]
    total = max(len(ids), 1)
    return [
        Check("junction_surfaces", float(bad[1:].sum()) / total, 0.03,
              f"share of {len(ids):,} junctions that are no single closed surface with a simple "
              "outline",
              ids=named(ids[bad[1:]])),
        Check("junction_sizes", max(int(large.sum()) - LET_PASS, 0) / total, 0.1,
              f"share of junctions that cover more than {TIMES:g} times the product of their two "
              f"widest arms, kerb returns of {RETURN:g} m included; {LET_PASS} others let pass",
              ids=named(ids[large])),
    ]  # fmt: skip


def _junction_of_face(ground: Ground) -> IntArray:
    """(f,) the junction each face belongs to, from 1; 0 for none. What is painted on it counts."""
    return owners(ground, LABEL["junction"], ON_ROADWAY)


def _usual_size(ground: Ground, owner: IntArray, count: int) -> FloatArray:
    """(j,) the largest area that the mouths of each junction explain."""
    left, right = ground.edge_faces.T.astype(np.int64)
    inner = right != BEYOND
    left, right = left[inner], right[inner]
    edge = ground.edges[inner].astype(np.int64)
    length = edge_lengths(ground)[inner]
    road = ground.labelled(*ROADWAY, "tramway")
    at, wide, place = [], [], []
    for a, b in ((left, right), (right, left)):
        rows = np.flatnonzero((owner[a] > 0) & road[b] & (owner[a] != owner[b]))
        at.append(owner[a[rows]])
        wide.append(length[rows])
        place.append(edge[rows])
    junction, size = np.concatenate(at), np.concatenate(wide)
    pairs = np.concatenate(place)
    # Pieces of outline that hang together are one mouth.
    keys = np.repeat(junction, 2) * len(ground.vertices) + pairs.ravel()
    node = np.unique(keys, return_inverse=True)[1].reshape(-1, 2)
    mouth = components(node, int(node.max(initial=-1)) + 1)[node[:, 0]] if len(node) else node[:, 0]
    mouths, index = np.unique(mouth, return_inverse=True)
    total = np.bincount(index, size, minlength=len(mouths))
    of_mouth = np.zeros(len(mouths), np.int64)
    of_mouth[index] = junction
    order = np.lexsort((-total, of_mouth))
    of_mouth, total = of_mouth[order], total[order]
    rank = np.arange(len(of_mouth)) - np.searchsorted(of_mouth, of_mouth)
    best = np.zeros((2, count))
    for place_of in (0, 1):
        rows = rank == place_of
        best[place_of, of_mouth[rows]] = total[rows]
    returns = 2 * RETURN * (best > 0)
    # A junction inside of a wider paved area has one mouth all round and no size of its own.
    return np.where(best[1] > 0, TIMES * (best + returns).prod(axis=0), np.inf)


def _walks(city: City, ground: Ground) -> Check:
    """Check that no lane runs over a kerb or a walk."""
    graph, network = city.lanes, city.network
    share = 0.0
    if graph is not None and network is not None and graph.count:
        off = np.abs(network.lift) > GROUNDED
        level = np.ones(network.edge_count, bool)
        level[np.repeat(np.arange(network.edge_count), np.diff(network.point_start))[off]] = False
        on_ground = graph.travelled & level[graph.edge]
        lines = graph.lines
        length = shapely.length(to_linestrings(lines)[on_ground])
        line, along = every(length, SPACING)
        places = locate(lines, np.flatnonzero(on_ground)[line], along)[0]
        over = int(ground.on(places, *STONES, "sidewalk").sum())
        share = max(over - LET_PASS, 0) / max(len(places), 1)
    return Check("sidewalk_on_carriageway", share, 0.001,
                 "share of the middles of lanes that run over a kerb or a sidewalk, "
                 f"{LET_PASS} m let pass")  # fmt: skip


def kerb_curves(city: City, ground: Ground) -> KerbCurves:
    """Measure the curves of kerbs at junctions on the outline of the carriageway."""
    outline = _outline(ground)
    owner = outline.line_of_point()
    step = np.diff(outline.points, axis=0)
    same = owner[1:] == owner[:-1]
    inner = np.flatnonzero(same[1:] & same[:-1]) + 1
    before, after = step[inner - 1], step[inner]
    turn = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0],
                      (before * after).sum(axis=1))  # fmt: skip
    bent = np.flatnonzero(np.abs(turn) > np.radians(1.0))
    point, turn = inner[bent], turn[bent]
    gap = np.hypot(*(outline.points[point[1:]] - outline.points[point[:-1]]).T)
    joined = (owner[point[1:]] == owner[point[:-1]]) & (gap < CHORD)
    run = np.r_[True, ~joined][: len(point)].cumsum() - 1
    count = int(run.max(initial=-1)) + 1
    total = np.bincount(run, turn, minlength=count)
    inside = np.flatnonzero(joined)
    length = np.bincount(run[inside], gap[inside], minlength=count)
    middle = np.column_stack(
        [np.bincount(run, turn * column[point], minlength=count) for column in outline.points.T]
    ) / np.maximum(total, 1e-9)[:, None]  # fmt: skip
    kept = (total > CORNER[0]) & (total < CORNER[1])
    # What is narrower than two of the least curves, as a median is, has a nose instead.
    line = owner[point[np.flatnonzero(np.diff(run, prepend=-1))]]
    kept &= _turning_near(outline.points[point], turn, owner[point], middle, line) < CORNER[1]
    kept[kept] = _at_junctions(city, middle[kept])
    middle, total, length = middle[kept], total[kept], length[kept]
    free = ~_given(city.layout, middle) & ~_unturned(city, middle)
    return KerbCurves(middle, total, length / total, free)


def _turning_near(
    bend: FloatArray, turn: FloatArray, of_bend: IntArray, places: FloatArray, of_place: IntArray
) -> FloatArray:
    """(k,) what the own outline turns in all within two of the least radii of each place.

    Parameters
    ----------
    bend, turn, of_bend
        (b, 2), (b,) and (b,): where outlines turn, radians, and the outline.
    places, of_place
        (k, 2) and (k,): places on outlines, and the outline.
    """
    near, spot = shapely.STRtree(shapely.points(bend)).query(
        shapely.points(places), predicate="dwithin", distance=2 * RADII[0]
    )
    own = of_place[near] == of_bend[spot]
    return np.asarray(np.bincount(near[own], turn[spot[own]], minlength=len(places)), float)


def _given(layout: Layout, places: FloatArray) -> BoolArray:
    """(k,) whether a house, a drawn surface, a tram's bed or the site's rim makes a corner."""
    parts, areas, roads = layout.parts, layout.areas, layout.roads
    standing = (parts["base"].to_numpy() < 0.5) & parts["walls"].to_numpy()
    found = np.zeros(len(places), bool)
    spots = shapely.points(places)
    for shapes, reach in (
        (parts.geometry.to_numpy()[standing], HOUSE),
        (areas.geometry.to_numpy()[(areas["kind"] == "road_area").to_numpy()], HOUSE),
        (roads.geometry.to_numpy()[(roads["kind"] == "tram").to_numpy()], DRAWN),
        (np.array([shapely.boundary(shapely.box(*layout.extent))]), DRAWN),
    ):
        near = shapely.STRtree(shapes).query(spots, predicate="dwithin", distance=reach)[0]
        found[near] = True
    return found


def _unturned(city: City, places: FloatArray) -> BoolArray:
    """(k,) whether a place lies between two arms of which none leads into the other.

    As the noses of an island in the mouth of a roundabout do: both arms lead to the junction, or
    both away from it.
    """
    network = city.network
    found = np.zeros(len(places), bool)
    if network is None or not len(places):
        return found
    lines = to_linestrings(network.lines)
    ends = network.edge_nodes.ravel().astype(np.int64)  # of each edge its start, then its end
    along = np.repeat(np.minimum(ALONG, shapely.length(lines) / 2), 2)
    along[1::2] *= -1.0
    seen = shapely.line_interpolate_point(np.repeat(lines, 2), along)
    arms = shapely.get_coordinates(seen) - network.node_position[ends]
    bearing = np.arctan2(arms[:, 1], arms[:, 0])
    oneway = city.layout.roads["oneway"].to_numpy(bool)[network.edge_road]
    order = np.argsort(ends, kind="stable")
    hubs = np.flatnonzero(network.node_degree >= 3)
    first, last = (np.searchsorted(ends[order], hubs, side) for side in ("left", "right"))
    nearest = shapely.STRtree(shapely.points(network.node_position[hubs])).nearest(
        shapely.points(places)
    )
    toward = places - network.node_position[hubs[nearest]]
    looks = np.arctan2(toward[:, 1], toward[:, 0])
    for place, hub in enumerate(nearest.tolist()):
        own = order[first[hub] : last[hub]]
        turn = (bearing[own] - looks[place]) % (2 * np.pi)
        beside = own[[int(turn.argmin()), int(turn.argmax())]]
        found[place] = bool(oneway[beside // 2].all()) and len(np.unique(beside % 2)) == 1
    return found


def _outline(ground: Ground) -> Polylines:
    """Return the lines where kerb stones meet the carriageway, the stones on the left hand."""
    left, right = ground.edge_faces.T.astype(np.int64)
    inner = right != BEYOND
    left, right, edge = left[inner], right[inner], ground.edges[inner].astype(np.int64)
    road, stone = ground.labelled(*ROADWAY, "tramway"), ground.labelled(*STONES, *WAYS_THROUGH)
    ends = np.concatenate([edge[stone[left] & road[right]],
                           edge[road[left] & stone[right]][:, ::-1]])  # fmt: skip
    head, rank = join_segments(ends, np.zeros(len(ends), np.int64))
    order = np.lexsort((rank, head))
    ends, head = ends[order], head[order]
    last = np.flatnonzero(np.r_[head[1:] != head[:-1], True][: len(head)])
    points = np.insert(ends[:, 0], last + 1, ends[last, 1])
    chain = np.insert(head, last + 1, head[last])
    lines = shapely.linestrings(
        ground.vertices[points], indices=np.unique(chain, return_inverse=True)[1]
    ) if len(points) else np.zeros(0, object)  # fmt: skip
    smooth, row = shapely.get_coordinates(shapely.simplify(lines, SMOOTH), return_index=True)
    # Where two curves and a strip meet on the grid, the outline may jog by its joint.
    near = np.hypot(*np.diff(smooth, axis=0, prepend=np.inf).T) < JOINT
    near &= np.r_[False, row[1:] == row[:-1]][: len(row)]
    smooth, row = smooth[~near], row[~near]
    kept = np.flatnonzero(np.bincount(row, minlength=len(lines)) > 1)
    long = np.isin(row, kept)
    start = np.searchsorted(row[long], np.append(kept, len(lines)))
    return _begun_on_the_straight(Polylines(smooth[long], start.astype(np.int64)))


def _begun_on_the_straight(lines: Polylines) -> Polylines:
    """Let closed lines begin and end in the middle of their longest piece, where nothing turns."""
    parts = []
    for begin, end in pairwise(lines.start.tolist()):
        points = lines.points[begin:end]
        if len(points) > 3 and (points[0] == points[-1]).all():
            longest = int(np.hypot(*np.diff(points, axis=0).T).argmax())
            middle = (points[longest] + points[longest + 1])[None] / 2
            points = np.concatenate([middle, np.roll(points[:-1], -longest - 1, axis=0), middle])
        parts.append(points)
    return Polylines(
        np.concatenate(parts) if parts else lines.points,
        np.concatenate([[0], np.cumsum([len(part) for part in parts])]).astype(np.int64),
    )


def _at_junctions(city: City, places: FloatArray) -> BoolArray:
    """(k,) whether places lie at a junction."""
    network = city.network
    found = np.zeros(len(places), bool)
    if network is None:
        return found
    reach = np.zeros(len(network.node_position))
    for end in (0, 1):
        np.maximum.at(reach, network.edge_nodes[:, end], network.trim[:, end])
    hubs = np.flatnonzero(network.node_degree >= 3)
    tree = shapely.STRtree(shapely.points(places))
    near = tree.query(shapely.points(network.node_position[hubs]), predicate="dwithin",
                      distance=reach[hubs] + BESIDE)[1]  # fmt: skip
    found[near] = True
    return found
