"""Radial avenues and ring roads, recognised by the shape of streets alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.street_pattern import pieces_of
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.chains import components

OUTWARD = np.radians(30.0)  # off the radius, of an avenue
AROUND = np.radians(55.0)  # off the radius from which a street runs around
MOSTLY = 0.7  # of a street's length that must
BEGINS, REACHES = 0.35, 0.7  # of the way to the nearest border: where an avenue begins and leads to
BESIDE = np.radians(12.0)  # as seen from the hub, between two parts of one avenue
LEVEL = 0.15  # of the way to the border, between the radii of two parts of one ring
BINS, TURN = 36, 30  # directions as seen from the hub, and how many of them a ring takes
LEAST = 60.0  # metres of the radius of a ring; a smaller one is a roundabout
SQUARE = 1.6  # radii of a square that the street around it keeps within


def avenues(lines: NDArray[Any], hub: FloatArray, reach: float) -> IntArray:
    """Return the number of the avenue that each street is part of, (n,), -1 for none.

    Parameters
    ----------
    lines
        (n,) linestrings that meet in their ends.
    hub
        (x, y) of the centre.
    reach
        Metres from the hub to the nearest border of the site.
    """
    off, angle, far = _seen_from(lines, hub)
    rows = np.flatnonzero(_share_of(lines, off < OUTWARD) >= MOSTLY)
    label = _joined(lines, rows, lambda a, b: np.abs(_turn(angle[a] - angle[b])) < BESIDE)
    near = shapely.distance(lines, shapely.Point(hub))
    out = far

    def leads(members: IntArray) -> bool:
        return bool(near[members].min() <= BEGINS * reach and out[members].max() >= REACHES * reach)

    return _numbered(len(lines), rows, label, leads)


def rings(lines: NDArray[Any], hub: FloatArray, reach: float, square: float = 0.0) -> IntArray:
    """Return the number of the ring that each street is part of, (n,), -1 for none.

    Parameters
    ----------
    square
        Square metres of the square in the middle; the street around it is no ring.
    """
    off, _, _ = _seen_from(lines, hub)
    rows = np.flatnonzero(_share_of(lines, off > AROUND) >= MOSTLY)
    radius = shapely.distance(shapely.line_interpolate_point(lines, 0.5, normalized=True),
                              shapely.Point(hub))  # fmt: skip
    label = _joined(lines, rows, lambda a, b: np.abs(radius[a] - radius[b]) < LEVEL * reach)
    least = max(LEAST, SQUARE * float(np.sqrt(square / np.pi)))

    def surrounds(members: IntArray) -> bool:
        middle, _, _ = pieces_of(lines[members])
        seen = np.arctan2(*(middle - hub).T[::-1])
        number = np.floor((seen + np.pi) / (2 * np.pi) * BINS).astype(int) % BINS
        return len(np.unique(number)) >= TURN and float(radius[members].mean()) >= least

    return _numbered(len(lines), rows, label, surrounds)


def _seen_from(lines: NDArray[Any], hub: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return pieces' angles off the radius; lines' bearings from the hub and farthest distances."""
    middle, bearing, _ = pieces_of(lines)
    away = middle - hub
    off = np.abs((bearing - np.arctan2(away[:, 1], away[:, 0]) + np.pi / 2) % np.pi - np.pi / 2)
    points, line = shapely.get_coordinates(lines, return_index=True)
    far = np.zeros(len(lines))
    np.maximum.at(far, line, np.hypot(*(points - hub).T))
    half = shapely.get_coordinates(shapely.line_interpolate_point(lines, 0.5, normalized=True))
    return off, np.arctan2(*(half - hub).T[::-1]), far


def _share_of(lines: NDArray[Any], wanted: NDArray[np.bool_]) -> FloatArray:
    """(n,) share of each line's length that its wanted pieces make."""
    cut = [pieces_of(np.array([line], object))[2] for line in lines]
    length = np.concatenate([np.zeros(0), *cut])
    of = np.repeat(np.arange(len(lines)), [len(each) for each in cut])
    total = np.bincount(of, length, minlength=len(lines))
    return np.asarray(
        np.bincount(of, length * wanted, minlength=len(lines)) / np.maximum(total, 1e-9)
    )


def _turn(angle: FloatArray) -> FloatArray:
    return np.asarray((angle + np.pi) % (2 * np.pi) - np.pi)


def _joined(lines: NDArray[Any], rows: IntArray, alike: Any) -> IntArray:
    """(r,) number of the piece that each chosen line belongs to, joined where ends meet."""
    chosen = lines[rows]
    first, second = shapely.STRtree(chosen).query(chosen, predicate="dwithin", distance=1.0)
    pairs = np.column_stack([first, second])[first < second]
    pairs = pairs[alike(rows[pairs[:, 0]], rows[pairs[:, 1]])]
    return np.asarray(components(pairs, len(rows)), np.int64)


def _numbered(count: int, rows: IntArray, label: IntArray, good: Any) -> IntArray:
    number = np.full(count, -1, np.int64)
    found = 0
    for value in np.unique(label).tolist():
        members = rows[label == value]
        if good(members):
            number[members] = found
            found += 1
    return number
