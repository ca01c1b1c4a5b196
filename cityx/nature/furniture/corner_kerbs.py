"""Furniture behind the kerbs of junctions: bollards round corners, things past side streets."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.ground import KERB_WIDTH, Ground
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import arc_lengths, every, locate, pack, to_linestrings
from cityx.ground.arrangement import BEYOND
from cityx.ground.pieces import Pieces, ids_of_places, join_pieces, pieces, room_along
from cityx.ground.standing import WALKED
from cityx.ground.street_rules import CLEAR, FRONT_LINE, KERB_RULES, WIDE_WALK
from cityx.ids import choose, hash_ids, uniform
from cityx.places.profile import Furniture
from cityx.road.surface.kerbs import yaw_facing

PURPOSE = "nature/street_pieces-v1"
REACH = 12.0  # metres; no walk is looked at farther than this
# Bollards along the curves of kerbs at junctions: metres between them, behind the kerb, and of the
# longest curve (a longer one is no corner but a roundabout).
CORNER_SPACING, FROM_CORNER, LONGEST_CORNER = 1.8, 0.35, 30.0
BENT = 1.04  # length over chord from which a kerb is a corner, not the far side of a junction
PAST_SPACING = 4.2  # metres of kerb per draw
LEAST_FAR = 9.0  # metres of straight kerb, free for crossings at its ends
CROSSING_GAP = 4.0  # metres round a mapped crossing
AT_ENDS = 3.5  # metres that stay free there
SQUARE = 30.0  # metres from the middle of a street within which things turn to it
TO_LINE = 3.5  # metres from the line within which things are moved there


def at_corners(city: City, rims: NDArray[Any], furniture: Furniture) -> Pieces:
    """Bollards that keep wheels off the curves of kerbs at junctions, at some of the corners.

    Parameters
    ----------
    city
        City with its ground.
    rims
        Segments at which walks end, as of `cityx.ground.pieces.walk_rims`.
    furniture
        Of the profile of the place.
    """
    ground = city.ground
    assert ground is not None
    curves = corner_kerbs(ground)
    long = shapely.length(curves)
    ids = ids_of_kerbs(curves)
    share = furniture.corner_bollards
    chosen = (uniform(city.seed, f"{PURPOSE}/corner", ids) < share) & (long < LONGEST_CORNER)
    chosen &= ~_straight(curves)
    row, foot, out, room = behind(ground, curves[chosen], rims, CORNER_SPACING, CORNER_SPACING / 2)
    xy = foot + (KERB_WIDTH + FROM_CORNER) * out
    fits = (room >= KERB_WIDTH + FROM_CORNER + CLEAR) & ground.on(xy, *WALKED)
    own = hash_ids(0, f"{PURPOSE}/corner", ids[chosen][row], _nth(row))
    return pieces("bollard", xy, own, yaw_facing(-out)).take(fits)


def past_junctions(city: City, rims: NDArray[Any], furniture: Furniture, density: float) -> Pieces:
    """Low furniture on wide walks along the straight kerbs that pass a side street.

    Arguments are those of `at_corners`; ``density`` is a factor of how often there is something.
    """
    ground = city.ground
    assert ground is not None
    kerbs = corner_kerbs(ground)
    kerbs = kerbs[_straight(kerbs) & (shapely.length(kerbs) >= LEAST_FAR)]
    if not len(kerbs):
        return join_pieces([])
    row, foot, out, room = behind(ground, kerbs, rims, PAST_SPACING, AT_ENDS)
    ids = hash_ids(0, f"{PURPOSE}/past", ids_of_kerbs(kerbs)[row], _nth(row))
    weights = dict(furniture.past_junctions)
    weights[""] /= max(density, 1e-6)
    name = np.array(list(weights), object)[
        choose(city.seed, f"{PURPOSE}/past", ids, list(weights.values()))
    ]
    deep = {rule.piece: rule.depth for rule in KERB_RULES}
    depth = np.array([deep.get(str(word), 0.0) for word in name])
    from_kerb = FRONT_LINE + depth
    xy = foot + from_kerb[:, None] * out
    fits = (name != "") & (room >= np.maximum(WIDE_WALK, from_kerb + depth + CLEAR))
    points = city.layout.points
    crossings = points.geometry.to_numpy()[points["kind"].to_numpy() == "crossing"]
    fits &= ground.on(xy, *WALKED) & ~near_any(xy, crossings, CROSSING_GAP)
    return pieces(name, xy, ids, yaw_facing(-out)).take(fits)


def behind(
    ground: Ground, kerbs: NDArray[Any], rims: NDArray[Any], spacing: float, margin: float
) -> tuple[NDArray[np.int64], FloatArray, FloatArray, FloatArray]:
    """Find places along kerbs, so many metres from each other and from both ends.

    Returns
    -------
    row, foot, out, room
        Rows of kerbs, places, directions to their walks, and metres from there to the walk's end.
    """
    lines = pack(kerbs)
    row, along = every(arc_lengths(lines)[1], spacing, margin)
    foot, way = locate(lines, row, along)
    out = np.column_stack([-way[:, 1], way[:, 0]])
    # The walk lies on one side of the kerb, the junction on the other.
    out = np.where(ground.on(foot + KERB_WIDTH / 2 * out, "junction")[:, None], -out, out)
    room = KERB_WIDTH + room_along(foot + KERB_WIDTH * out, out, rims, REACH)
    return row, foot, out, room


def _nth(row: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.arange(len(row)) - np.searchsorted(row, row)


def _straight(kerbs: NDArray[Any]) -> NDArray[np.bool_]:
    ends = [shapely.get_point(kerbs, number) for number in (0, -1)]
    return np.asarray(shapely.length(kerbs) <= BENT * shapely.distance(*ends))


def corner_kerbs(ground: Ground) -> NDArray[Any]:
    """(c,) lines at which the surfaces of junctions meet raised kerbs."""
    left, right = ground.edge_faces.T.astype(np.int64)
    joint, kerb = ground.labelled("junction"), ground.labelled("kerb")
    inner = right != BEYOND
    right = np.maximum(right, 0)
    rim = inner & ((joint[left] & kerb[right]) | (joint[right] & kerb[left]))
    edges = shapely.linestrings(ground.vertices[ground.edges[rim]])
    return np.asarray(shapely.get_parts(shapely.line_merge(shapely.multilinestrings(edges))))


def ids_of_kerbs(kerbs: NDArray[Any]) -> NDArray[np.uint64]:
    """(n,) ids of kerbs, by the whole decimetre of their middles."""
    middle = shapely.line_interpolate_point(kerbs, shapely.length(kerbs) / 2)
    return ids_of_places(shapely.get_coordinates(middle), f"{PURPOSE}/place")


def in_kerb_line(
    network: RoadNetwork | None, xy: FloatArray, depth: FloatArray, turn: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Move things of wide walks into the line of what stands at their kerb, square to the street.

    Those too far from the line stay where they are and turn; those far from any street stay as
    they are.

    Parameters
    ----------
    network
        The streets; without any, things stay as they are.
    xy
        (n, 2) float, places, metres.
    depth
        (n,) float, half their sizes across the walk, metres.
    turn
        (n,) float, their turns about z, radians.

    Returns
    -------
    moved, turned
        The same for where they belong.
    """
    if network is None or not network.edge_count or not len(xy):
        return xy, turn
    shapes = to_linestrings(network.lines)
    spots = shapely.points(xy)
    spot, edge = shapely.STRtree(shapes).query_nearest(spots, max_distance=SQUARE)
    spot, first = np.unique(spot, return_index=True)  # ties go to the first line
    edge = edge[first]
    foot, _ = locate(network.lines, edge, shapely.line_locate_point(shapes[edge], spots[spot]))
    out = xy[spot] - foot
    far = np.hypot(*out.T)
    beside = far > network.half_width[edge]
    spot, edge, foot, far = spot[beside], edge[beside], foot[beside], far[beside]
    out = out[beside] / far[:, None]
    line = network.half_width[edge] + FRONT_LINE + depth[spot]
    near = np.abs(far - line) < TO_LINE
    moved, turned = xy.copy(), turn.copy()
    turned[spot] = yaw_facing(-out)
    moved[spot[near]] = (foot + line[:, None] * out)[near]
    return moved, turned
