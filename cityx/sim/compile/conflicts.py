"""Conflicts of a world: ways across a junction that cannot be used at once, and who goes first."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, IntArray
from cityx.sim.compile.lanes import Pieces
from cityx.sim.dynamics import LENGTH, VEHICLE, WIDTH, vehicle_table
from cityx.sim.kernels import fits
from cityx.traffic.conflicts import conflicts_of
from cityx.traffic.streets import Streets

ALONG = 4  # column of the points of pieces
AIR = 0.1  # metres beside a body
STOREY = 2.5  # metres of height within which bodies touch


def conflicts_by_piece(
    pieces: Pieces, streets: Streets
) -> tuple[NDArray[np.int32], NDArray[np.int32], BoolArray]:
    """Return the conflicts of each piece.

    Returns
    -------
    start, other, yields
        (n + 1,) and (m,) int32, pieces that meet each one, ascending; and (m,) whether it gives
        way to that one.
    """
    found = conflicts_of(streets, _meeting(pieces))
    row = np.full(len(streets.links), -1, np.int64)
    across = np.flatnonzero(pieces.link >= 0)
    row[pieces.link[across]] = across
    first, second = row[found.first], row[found.second]
    kept = (first >= 0) & (second >= 0)
    first, second = first[kept], second[kept]
    one, other = np.concatenate([first, second]), np.concatenate([second, first])
    gives = np.concatenate([np.zeros(len(first), bool), np.ones(len(second), bool)])
    order = np.lexsort((other, one))
    one, other, gives = one[order], other[order], gives[order]
    start = np.searchsorted(one, np.arange(pieces.count + 1)).astype(np.int32)
    return start, other.astype(np.int32), gives


def sharing(pieces: Pieces) -> BoolArray:
    """(n,) which pieces cars do not drive along without touching others on the middle of a lane.

    Such are lanes of two streets that lie on each other, and ways across that cut over a lane which
    they do not join. No rule tells who goes first there.
    """
    kind = VEHICLE["car"]
    half = float(vehicle_table()[kind, LENGTH]) / 2
    owner = np.repeat(np.arange(pieces.count), np.diff(pieces.point_start))
    along, lane = pieces.point[:, ALONG], pieces.link < 0
    left = pieces.point[pieces.point_start[1:] - 1, ALONG][owner] - along
    ends = lane[owner] & ((along < half) | (left < half))  # there the junction rules
    rows = np.flatnonzero(pieces.public[owner] & ~pieces.narrow[owner] & ~ends)
    pair = _touching(pieces, kind, rows, -AIR)
    pair = pair[lane[pair].any(axis=1)]
    joined = np.repeat(np.arange(pieces.count), np.diff(pieces.next_start)), pieces.next
    known = np.concatenate([np.column_stack(joined), np.column_stack(joined[::-1]), *(
        np.column_stack([np.flatnonzero(side >= 0), side[side >= 0]]) for side in pieces.beside.T
    )])  # fmt: skip
    code = pair @ [pieces.count, 1]
    pair = pair[~np.isin(code, known @ [pieces.count, 1])]
    both = lane[pair].all(axis=1)
    found = np.zeros(pieces.count, bool)
    found[pair[both].ravel()] = True
    found[pair[~both][~lane[pair[~both]]]] = True
    return found


def _meeting(pieces: Pieces) -> IntArray:
    """(m, 2) links, the lower first, along whose pieces vans touch as they trail along them."""
    owner = np.repeat(np.arange(pieces.count), np.diff(pieces.point_start))
    pair = _touching(pieces, VEHICLE["van"], np.flatnonzero(pieces.link[owner] >= 0), AIR)
    return np.sort(pieces.link[pair], axis=1)


def _touching(pieces: Pieces, kind: int, rows: IntArray, air: float) -> IntArray:
    """(m, 2) pieces, the lower first, along which bodies touch that trail along their lines.

    Parameters
    ----------
    pieces, kind
        Along which, and which vehicle.
    rows
        Points at which their middle is.
    air
        Metres that are added to every side of a body.
    """
    own = vehicle_table()[kind]
    heading = fits.headings(pieces.point, pieces.point_start, own)[rows]
    owner = np.repeat(np.arange(pieces.count), np.diff(pieces.point_start))[rows]
    middle, z = pieces.point[rows, :2], pieces.point[rows, 2]
    ahead = np.column_stack([np.cos(heading), np.sin(heading)])
    side = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * (own[WIDTH] / 2 + air)
    ahead *= own[LENGTH] / 2 + air
    ring = np.stack([middle - ahead - side, middle + ahead - side, middle + ahead + side,
                     middle - ahead + side], axis=1)  # fmt: skip
    body = shapely.polygons(ring)
    one, other = shapely.STRtree(body).query(body, predicate="intersects")
    kept = (owner[one] < owner[other]) & (np.abs(z[one] - z[other]) < STOREY)
    pair = np.column_stack([owner[one[kept]], owner[other[kept]]]).astype(np.int64)
    return np.unique(pair, axis=0)
