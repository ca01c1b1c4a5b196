"""Repairs of streets: trenches, patches and seams, as outlines beside centrelines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.roads import RoadNetwork
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import arc_lengths, locate, pieces, to_linestrings
from cityx.geometry.ranges import numbered
from cityx.ids import uniform

_Drawn = tuple[IntArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]

PURPOSE = "street repairs"
CARRIAGEWAY = 1.3  # metres of half width; what is narrower is a footway
STATIONS = 9  # points along each side of an outline: long trenches follow bends
SEAM_TONE = -0.35  # of the bitumen in a joint between two lanes of asphalt
PAVER = 3.6  # metres that a machine lays at once; wider streets have a joint


@dataclass(frozen=True)
class Kind:
    """A kind of repair.

    Attributes
    ----------
    spacing
        Metres of street for each, on the average.
    length, width
        Range of its extent along and across the street, metres.
    across
        Whether it is cut square to the street: from the middle over the kerb.
    """

    spacing: float
    length: tuple[float, float]
    width: tuple[float, float]
    across: bool = False


# Mains run along the street, connections of houses across it; patches fill what broke.
KINDS = (
    Kind(28.0, (8.0, 45.0), (0.6, 1.3)),
    Kind(12.0, (0.5, 0.9), (0.0, 0.0), across=True),
    Kind(12.0, (0.8, 4.5), (0.7, 2.2)),
)
# Of the arms of junctions how many have a trench from their midst, and metres of arm that it takes
# before them and of its width; how many a patch amid them, and its extent.
TRENCHES, INTO_ARM, TRENCH = 0.55, (0.5, 7.0), (0.6, 1.4)
PATCHES, PATCH = 0.8, (1.0, 3.2)
OVER_KERB = (-1.5, 2.6)  # metres from the kerb at which a connection ends, inside or in the walk


@dataclass(frozen=True)
class Repairs:
    """Outlines of r repairs.

    Attributes
    ----------
    outline
        (r, 2 * STATIONS, 2) float, metres.
    tone
        (r,) float, how much paler (to 1) or darker (to -1) than the street it is.
    """

    outline: FloatArray
    tone: FloatArray


def street_repairs(network: RoadNetwork) -> Repairs:
    """Draw the repairs of all streets; each depends on its street alone."""
    lines = network.lines
    length = arc_lengths(lines)[1]
    found = [_drawn(network, length, number) for number in range(len(KINDS))]
    found += [_at_junctions(network, length, end) for end in (0, 1)]
    columns = zip(*found, strict=True)
    edge, begin, end, inner, outer, tone = (np.concatenate(column) for column in columns)
    share = np.linspace(0.0, 1.0, STATIONS)
    along = begin[:, None] + (end - begin)[:, None] * share  # (r, s)
    middle, ahead = locate(lines, np.repeat(edge, STATIONS), along.ravel())
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    near = (middle + left * np.repeat(inner, STATIONS)[:, None]).reshape(-1, STATIONS, 2)
    far = (middle + left * np.repeat(outer, STATIONS)[:, None]).reshape(-1, STATIONS, 2)
    return Repairs(np.concatenate([near, far[:, ::-1]], axis=1), tone)


def lane_seams(network: RoadNetwork) -> list[FloatArray]:
    """Return the joints between the lanes in which streets were laid, (n, 2) each."""
    lines = network.lines
    length = arc_lengths(lines)[1]
    begin, end = network.trim[:, 0], length - network.trim[:, 1]
    found = []
    passes = np.ceil(2 * network.half_width / PAVER).astype(np.int64)
    for count in range(2, int(passes.max(initial=1)) + 1):
        rows = np.flatnonzero((passes == count) & (end > begin))
        laid = to_linestrings(pieces(lines, rows, begin[rows], end[rows]))
        for number in range(1, count):
            offset = network.half_width[rows] * (2 * number / count - 1)
            found.extend(shapely.get_parts(shapely.offset_curve(laid, offset)))
    return [shapely.get_coordinates(seam) for seam in found if not shapely.is_empty(seam)]


def mouth_seams(network: RoadNetwork) -> FloatArray:
    """Return the joints across arms where the surfaces of junctions begin, (n, 2, 2)."""
    lines = network.lines
    length = arc_lengths(lines)[1]
    paved = (network.half_width > CARRIAGEWAY) & (network.trim.sum(axis=1) < length)
    edge, end = np.nonzero((network.trim > 0) & paved[:, None])
    along = np.where(end == 0, network.trim[edge, end], length[edge] - network.trim[edge, end])
    middle, ahead = locate(lines, edge, along)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * network.half_width[edge][:, None]
    return np.stack([middle - left, middle + left], axis=1)


def _at_junctions(network: RoadNetwork, length: FloatArray, end: int) -> _Drawn:
    """Draw trenches and patches amid junctions, of the arms that begin or end (1) there."""
    joint = network.node_degree[network.edge_nodes[:, end]] >= 3
    joint &= (network.half_width > CARRIAGEWAY) & (network.trim.sum(axis=1) < length)
    columns = []
    for word, share, (low, high) in (("trench", TRENCHES, TRENCH), ("patch", PATCHES, PATCH)):
        purpose = f"{PURPOSE}/junction/{end}/{word}"
        ids = network.edge_id
        edge = np.flatnonzero(joint & (uniform(0, purpose, ids) < share))
        draws = [uniform(0, purpose, ids[edge], k) for k in range(1, 6)]
        width = low + (high - low) * draws[0]
        trim, half = network.trim[edge, end], network.half_width[edge]
        if word == "trench":
            near = 0.3 * trim * draws[1]
            far = np.minimum(
                trim + INTO_ARM[0] + (INTO_ARM[1] - INTO_ARM[0]) * draws[2], length[edge]
            )
        else:
            extent = low + (high - low) * draws[1]
            near = np.maximum(trim - extent, 0.0) * draws[2]
            far = np.minimum(near + extent, length[edge])
        inner = (2.0 * draws[3] - 1.0) * np.maximum(half - width - 0.5, 0.0) - width / 2
        begin = near if end == 0 else length[edge] - far
        columns.append((edge, begin, begin + far - near, inner, inner + width, _tones(draws[4])))
    return tuple(np.concatenate(column) for column in zip(*columns, strict=True))


def _tones(draw: FloatArray) -> FloatArray:
    """Tones of repairs from draws: most are younger than their street, and darker."""
    tone = 2 * draw - 1.0
    return np.where(tone < 0.3, -0.4 - 0.6 * np.abs(tone), tone)


def _drawn(network: RoadNetwork, length: FloatArray, number: int) -> _Drawn:
    """Edge, begin and end along it, inner and outer offset, and tone of repairs of one kind."""
    kind, half = KINDS[number], network.half_width

    def draw(word: str, ids: NDArray[np.uint64], k: IntArray | int = 0) -> FloatArray:
        return np.asarray(uniform(0, f"{PURPOSE}/{number}/{word}", ids, k))

    wanted = length / kind.spacing * (half > CARRIAGEWAY)
    count = np.floor(wanted + draw("count", network.edge_id)).astype(np.int64)
    edge = np.repeat(np.arange(len(count)), count)
    nth = numbered(count)
    ids = network.edge_id[edge]
    low, high = kind.length
    extent = np.minimum(low + (high - low) * draw("length", ids, nth), length[edge])
    begin = (length[edge] - extent) * draw("along", ids, nth)
    side = np.where(draw("side", ids, nth) < 0.5, -1.0, 1.0)
    if kind.across:
        inner = np.zeros(len(edge))
        outer = half[edge] + np.where(draw("over", ids, nth) < 0.5, *OVER_KERB)
    else:
        width = kind.width[0] + (kind.width[1] - kind.width[0]) * draw("width", ids, nth)
        inner = np.maximum(half[edge] - width - 0.3, 0.0) * draw("offset", ids, nth)
        outer = inner + width
    tone = _tones(draw("tone", ids, nth))
    return edge, begin, begin + extent, side * inner, side * outer, tone
