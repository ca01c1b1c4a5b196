"""How walks are paved: courses run along the kerb, and meet in a seam where it turns."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, Ground
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.chains import components
from cityx.geometry.polylines import Polylines, locate, miters, to_linestrings
from cityx.ground.arrangement import BEYOND, face_areas, inner_points
from cityx.ground.drape import Paving
from cityx.road.network.network import node_corners
from cityx.road.surface.corners import meeting_of

Shapes = NDArray[Any]

LAID = ("sidewalk", "ramp", "landing", "tactile", "tactile_pale", "tactile_buff", "tactile_red",
        "guide_strip", "furnishing", "edging", "setts", "mouth_setts", "gutter", "parking_lane",
        "frontage")  # fmt: skip
# Laid from the kerb on.
FROM_KERB = ("sidewalk", "ramp", "landing", "furnishing", "gutter", "parking_lane")
_NOTHING: Mapping[str, str] = MappingProxyType({})
LAP = np.radians(12.0)  # of turn after which the courses along a curve begin anew
PAST = 0.1  # metres that a seam reaches beyond the walk, so that rounding leaves none short
LOOK = 3.0  # metres along a street to both sides of a place
STRAIGHT = np.cos(np.radians(6.0))  # of the turn within them; bands follow no stronger one
LEAST_BANDED = 30.0  # square metres of a walk with bands; smaller pieces would be patches
AT_END = 0.05  # metres from the end of an edge
FARTHEST = 20.0  # metres from a street's middle to a face of its walk
MOST_MITRE = 3.0  # longest seam, in widths of the walk


def seam_lines(layout: Layout, network: RoadNetwork) -> Shapes:
    """Lines across walks at corners of junctions and along bends, from kerb to back, (n,)."""
    lines = network.lines
    table = layout.roads.iloc[network.edge_road]
    walk = np.column_stack([table[name].to_numpy(float)
                            for name in ("sidewalk_left", "sidewalk_right")])  # fmt: skip
    kind = table["kind"].to_numpy()
    found = _at_corners(layout, network, lines, kind, walk), _at_bends(network, lines, walk)
    return np.concatenate(found)


def _at_corners(
    layout: Layout, network: RoadNetwork, lines: Polylines, kind: Any, walk: FloatArray
) -> Shapes:
    """Seams from where two kerbs would meet to where the backs of their walks do."""
    arms, corners, _ = node_corners(
        layout, kind, lines, network.edge_nodes, network.node_position, network.half_width
    )
    one, other = corners.first, corners.second
    # A corner lies left of the arm that comes first, right of the next.
    widths = [walk[arms.edge[one], arms.end[one]], walk[arms.edge[other], 1 - arms.end[other]]]
    back = [
        network.half_width[arms.edge[arm]] + KERB_WIDTH + width
        for arm, width in zip((one, other), widths, strict=True)
    ]
    bearing = arms.bearing[one]
    ahead = np.column_stack([np.cos(bearing), np.sin(bearing)])
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    far = network.node_position[arms.node[one]] + left * back[0][:, None]
    far = far + ahead * meeting_of(back[0], back[1], corners.gap)[:, None]
    reach = far - corners.place
    length = np.hypot(*reach.T)
    walked = (np.minimum(*widths) > 0) & (length < MOST_MITRE * np.maximum(*back)) & (length > 0)
    reach = reach * ((length + PAST) / np.maximum(length, PAST))[:, None]
    ends = np.round(np.stack([corners.place, corners.place + reach], axis=1), 3)
    return np.asarray(shapely.linestrings(ends[walked]))


def _at_bends(network: RoadNetwork, lines: Polylines, walk: FloatArray) -> Shapes:
    """Seams wherever streets have turned by `LAP` since the last."""
    owner = lines.line_of_point()
    step = np.diff(lines.points, axis=0)
    same = owner[1:] == owner[:-1]
    point = np.flatnonzero(same[1:] & same[:-1]) + 1
    a, b = step[point - 1], step[point]
    turn = np.zeros(len(owner))
    turn[point] = np.abs(np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)))
    total = np.cumsum(np.round(turn, 6))
    lap = np.floor((total - total[lines.start[:-1]][owner]) / LAP)
    point = point[lap[point] > lap[point - 1]]
    edge = owner[point]
    across = miters(lines)[point]
    seams = []
    for side, sign in ((0, 1.0), (1, -1.0)):
        width = walk[edge, side]
        near = network.half_width[edge]
        far = near + KERB_WIDTH + width + PAST
        ends = (
            lines.points[point][:, None]
            + sign * across[:, None] * np.stack([near, far], axis=1)[:, :, None]
        )
        seams.append(shapely.linestrings(np.round(ends, 3)[width > 0]))
    return np.concatenate(seams)


def _scattered(ground: Ground, chosen: BoolArray) -> BoolArray:
    """(f,) those of the chosen faces that hang together with less than `LEAST_BANDED`."""
    left, right = ground.edge_faces.T.astype(np.int64)
    joined = (right != BEYOND) & chosen[left] & chosen[np.maximum(right, 0)]
    piece = components(np.column_stack([left, right])[joined], len(chosen))
    area = np.bincount(piece, np.where(chosen, face_areas(ground), 0.0), minlength=len(chosen))
    return np.asarray(chosen & (area < LEAST_BANDED)[piece])


def courses(
    ground: Ground, network: RoadNetwork, laid: Mapping[str, str] = _NOTHING, *,
    guided: str = "", main: BoolArray | None = None, bent: Mapping[str, str] = _NOTHING,
) -> Paving:  # fmt: skip
    """Return how faces are paved: along their street, walks from their kerb on; east elsewhere.

    Parameters
    ----------
    ground, network
        The ground and the streets on it.
    laid
        Surface to the material its faces get instead of its own.
    guided
        Material of the walks of main streets, "" for that of the others.
    main
        (e,) whether edges are main streets.
    bent
        Material with bands to that of corners and bends, which straight bands do not follow.
    """
    size = len(ground.face_label)
    along, shift = np.tile([1.0, 0.0], (size, 1)), np.zeros(size)
    names = tuple(dict.fromkeys([*laid.values(), *filter(None, [guided]), *bent.values()]))
    material = np.full(size, -1)
    for surface, name in laid.items():
        material[ground.labelled(surface)] = names.index(name)
    rows = np.flatnonzero(ground.labelled(*LAID))
    if not len(rows) or not network.edge_count:
        return Paving(along, shift, material, names)
    lines = network.lines
    shapes = to_linestrings(lines)
    inner = inner_points(ground)[rows]
    spots = shapely.points(inner)
    row, edge = shapely.STRtree(shapes).query(spots, predicate="dwithin", distance=FARTHEST)
    # Not the street whose middle is nearest, but that whose kerb is.
    off = np.round(shapely.distance(spots[row], shapes[edge]) - network.half_width[edge], 3)
    order = np.lexsort((network.edge_id[edge], off, row))
    row, first = np.unique(row[order], return_index=True)
    edge = edge[order][first]
    place = shapely.line_locate_point(shapes[edge], spots[row])
    foot, ahead = locate(lines, edge, place)
    face = rows[row]
    aside = (ahead[:, 0] * (inner[row] - foot)[:, 1]) - (ahead[:, 1] * (inner[row] - foot)[:, 0])
    walk = ground.labelled(*FROM_KERB)[face]
    # A walk is laid with its kerb on the right hand, so that both sides mirror each other.
    turned = (ahead[:, 0] < 0) | ((ahead[:, 0] == 0) & (ahead[:, 1] < 0))
    turned = np.where(walk, aside < 0, turned)
    ahead = np.round(np.where(turned[:, None], -ahead, ahead), 6)
    along[face] = ahead
    across = ahead[:, 0] * inner[row][:, 1] - ahead[:, 1] * inner[row][:, 0]
    kerb = network.half_width[edge] + KERB_WIDTH
    shift[face] = np.where(walk, np.round(np.abs(aside) - kerb - across, 4), 0.0)
    if guided and main is not None:
        told = ground.labelled("sidewalk")[face] & main[edge]
        material[face[told]] = names.index(guided)
    if bent:
        before, after = (locate(lines, edge, place + far)[1] for far in (-LOOK, LOOK))
        straight = (before * after).sum(axis=1) > STRAIGHT
        # At the end of an edge the walk goes round the corner.
        end = np.minimum(place, shapely.length(shapes[edge]) - place) < AT_END
        for banded, plain in bent.items():
            told = face[(~straight | end) & (material[face] == names.index(banded))]
            material[told] = names.index(plain)
            material[_scattered(ground, material == names.index(banded))] = names.index(plain)
    return Paving(along, shift, material, names)
