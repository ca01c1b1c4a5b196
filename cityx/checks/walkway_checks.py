"""Checks of walkways: pavements are connected by crosswalks as far as streets are connected."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.checks.check import Check
from cityx.city import City
from cityx.city.ground import Ground
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.polylines import to_linestrings
from cityx.ground.arrangement import BEYOND
from cityx.ground.walking.crosswalks import FAST, FOOTWAYS, VERGES, crosswalks_of

STONES = ("kerb", "kerb_dropped", "edging")
RAYS = 12  # directions in which walks are looked for where a bridge or a tunnel ends
BESIDE = (0.0, 1.5, 3.0, 6.0)  # metres from its edge


def check_walkways(city: City) -> list[Check]:
    """Measure how much of the pavement hangs together; nothing where no ground is laid.

    Pavements and paths hang together where they touch, over the land between them, over crosswalks,
    and over streets and paths on bridges and in tunnels. Each piece counts to the streets beside
    it, of which the largest one is the whole. Streets without a junction, motorways apart, have no
    place to cross; they do not count.
    """
    ground, network = city.ground, city.network
    if ground is None or network is None or not network.edge_count:
        return []
    area = np.bincount(ground.triangle_face, _areas(ground), len(ground.face_label))
    piece = _pieces(city, ground, network)
    # Nobody walks on stones alone, as round an island in a street.
    walks = ground.labelled(*(label for label in FOOTWAYS if label not in STONES))
    paved = ground.labelled(*FOOTWAYS) & np.isin(piece, piece[walks])
    faces = np.flatnonzero(paved)
    streets = _streets_at(city, network, _spots(ground, faces))
    faces, streets = faces[streets >= 0], streets[streets >= 0]
    if not len(faces):
        return []
    # Each piece counts to the streets beside most of it.
    count = int(streets.max()) + 1
    pair, of_pair = np.unique(piece[faces] * count + streets, return_inverse=True)
    beside = np.bincount(of_pair.ravel(), area[faces])
    order = np.lexsort((beside, pair // count))
    last = np.r_[np.diff(pair[order] // count) > 0, True]
    chosen = pair[order][last]
    size = np.bincount(piece[paved], area[paved])[chosen // count]
    whole = np.zeros(count)
    np.maximum.at(whole, chosen % count, size)
    apart = len(chosen) - int((whole > 0).sum())
    total = float(size.sum())
    return [
        Check("walkways_apart", 1.0 - float(whole.sum()) / total, 0.25,
              f"share of the area of pavements and paths in {apart} pieces to which no crosswalk "
              "leads from the largest beside the same streets"),
    ]  # fmt: skip


def _areas(ground: Ground) -> FloatArray:
    """(t,) square metres of triangles."""
    a, b, c = (ground.vertices[ground.triangles[:, k]] for k in range(3))
    u, v = b - a, c - a
    return np.asarray(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2)


def _pieces(city: City, ground: Ground, network: RoadNetwork) -> IntArray:
    """(f,) number of the piece of walkways and land that each face belongs to."""
    walked = ground.labelled(*FOOTWAYS, *VERGES)
    left, right = ground.edge_faces.T.astype(np.int64)
    inner = (right != BEYOND) & walked[left] & walked[np.maximum(right, 0)]
    crosswalks = crosswalks_of(ground, city.layout, network)
    ends = ground.face_at(crosswalks.ends.reshape(-1, 2), *FOOTWAYS, *VERGES).reshape(-1, 2)
    joined = ends[(ends >= 0).all(axis=1)]
    beside, decks = _over_and_under(city.layout, ground)
    pairs = np.concatenate([np.column_stack([left, right])[inner], joined, beside, decks])
    count = int(pairs.max(initial=-1)) + 1
    return np.asarray(components(pairs, max(count, len(walked)))[: len(walked)], np.int64)


def _over_and_under(layout: Layout, ground: Ground) -> tuple[IntArray, IntArray]:
    """Pairs of an end of a bridge or a tunnel and a walk or land beside it, and of their ends.

    Ends, each place once, are numbered behind the faces.
    """
    roads = layout.roads
    deck = roads["bridge"].to_numpy(bool) | roads["tunnel"].to_numpy(bool)
    roads = roads[deck & ~roads["kind"].isin(FAST).to_numpy()]
    lines = roads.geometry.to_numpy()
    if not len(lines):
        return np.zeros((0, 2), np.int64), np.zeros((0, 2), np.int64)
    ends = shapely.get_coordinates([shapely.get_point(lines, k) for k in (0, -1)])
    place, number = np.unique(np.round(ends, 2), axis=0, return_inverse=True)
    number = len(ground.face_label) + number.ravel().reshape(2, -1).T
    half = np.zeros(len(place))
    np.maximum.at(half, number - len(ground.face_label), roads["width"].to_numpy()[:, None] / 2)
    turn = np.linspace(0.0, 2 * np.pi, RAYS, endpoint=False)
    way = np.column_stack([np.cos(turn), np.sin(turn)])
    reach = half[:, None] + np.array(BESIDE)
    spots = place[:, None, None] + reach[:, :, None, None] * way  # (ends, reaches, rays, 2)
    face = ground.face_at(spots.reshape(-1, 2), *FOOTWAYS, *VERGES)
    own = len(ground.face_label) + np.repeat(np.arange(len(place)), len(BESIDE) * RAYS)
    return np.column_stack([own, face])[face >= 0], number


def _spots(ground: Ground, faces: IntArray) -> FloatArray:
    """(k, 2) places in faces: the middle of a triangle of each."""
    triangle = np.full(len(ground.face_label), -1)
    triangle[ground.triangle_face] = np.arange(len(ground.triangle_face))
    corners = ground.vertices[ground.triangles[triangle[faces]]]
    return np.asarray(corners.mean(axis=1))


def _streets_at(city: City, network: RoadNetwork, spots: FloatArray) -> IntArray:
    """(k,) number of the piece of the streets next to each place, -1 of one without junctions.

    Nobody crosses motorways; the streets that they alone join are apart.
    """
    kind = city.layout.roads["kind"].to_numpy().astype(str)[network.edge_road]
    edges = np.flatnonzero(~np.isin(kind, FAST))
    if not len(edges):
        return np.full(len(spots), -1)
    nodes = network.edge_nodes[edges].astype(np.int64)
    count = len(network.node_position)
    label = components(nodes, count)
    crossed = np.isin(label, label[np.bincount(nodes.ravel(), minlength=count) >= 3])
    label = np.where(crossed, label, -1)
    of_edge = label[nodes[:, 0]]
    if (of_edge == of_edge[0]).all():  # all streets hang together
        return np.full(len(spots), of_edge[0])
    tree = shapely.STRtree(to_linestrings(network.lines)[edges])
    spot, edge = tree.query_nearest(shapely.points(spots), all_matches=False)
    found = np.full(len(spots), -1)
    found[spot] = of_edge[edge]
    return found
