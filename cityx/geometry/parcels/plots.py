"""Plots: parcels seen from their street, and the room on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray
from cityx.geometry.parcels.parcels import Parcels
from cityx.geometry.polylines import pack
from cityx.geometry.rectangles import GRID, inner_rectangles
from cityx.geometry.seams import moved, on_grid
from cityx.ids import UInt64Array, uniform

INSIDE = 1e-6  # share of a rectangle that may lie outside; more makes it shrink
SHRINKS = 6  # of a rectangle by a cell of the raster in which it was found
MITRE = 3.0  # times the distance; a corner of a set-back line goes no further


@dataclass(frozen=True)
class Plots:
    """m parcels, each in a frame of its own: x along its front, y away from the street.

    Attributes
    ----------
    shapes, street
        (m,) parcels and their edges on the street, moved to ``shift``.
    shift
        (m, 2) whole metres, the place of each parcel.
    middle, right, inward
        (m, 2) middle of the front, unit vectors along the front and away from the street.
    low, high
        (m, 2) extent of the parcel in its frame, metres.
    id, block_id
        (m,) of the parcel and of its block.
    density, height
        (m,) 0 to 1, and wanted metres or NaN.
    """

    shapes: NDArray[Any]
    street: NDArray[Any]
    shift: FloatArray
    middle: FloatArray
    right: FloatArray
    inward: FloatArray
    low: FloatArray
    high: FloatArray
    id: UInt64Array
    block_id: UInt64Array
    density: FloatArray
    height: FloatArray

    @property
    def count(self) -> int:
        """Number of parcels."""
        return len(self.shapes)

    @property
    def area(self) -> FloatArray:
        """(m,) square metres."""
        return np.asarray(shapely.area(self.shapes))

    @property
    def width(self) -> FloatArray:
        """(m,) metres along the front."""
        return self.high[:, 0] - self.low[:, 0]

    def take(self, rows: Any) -> Plots:
        """Return some of the plots."""
        return Plots(
            self.shapes[rows], self.street[rows], self.shift[rows], self.middle[rows],
            self.right[rows], self.inward[rows], self.low[rows], self.high[rows], self.id[rows],
            self.block_id[rows], self.density[rows], self.height[rows],
        )  # fmt: skip

    def draw(self, purpose: str, low: float, high: float, *, seed: int) -> FloatArray:
        """Draw a number between two for each parcel."""
        return np.asarray(low + (high - low) * uniform(seed, f"plot/{purpose}", self.id))

    def draw_alike(self, purpose: str, low: float, high: float, *, seed: int) -> FloatArray:
        """Draw a number between two that all parcels of a block share."""
        return np.asarray(low + (high - low) * uniform(seed, f"plot/{purpose}", self.block_id))

    def place(self, points: FloatArray) -> FloatArray:
        """Take points, (m, k, 2), from the frames of the plots to where they lie."""
        return np.asarray(
            self.middle[:, None]
            + points[..., :1] * self.right[:, None]
            + points[..., 1:] * self.inward[:, None]
        )

    def outlines(self, points: FloatArray) -> NDArray[Any]:
        """Return (m,) polygons with given corners, (m, k, 2), in the frames of the plots."""
        return on_grid(np.asarray(shapely.polygons(self.place(points)), object))

    def boxes(self, x0: Any, y0: Any, x1: Any, y1: Any) -> NDArray[Any]:
        """Return (m,) rectangles in the frames of the plots."""
        x0, y0, x1, y1 = (np.broadcast_to(side, self.count) for side in (x0, y0, x1, y1))
        corner = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
        return self.outlines(np.moveaxis(np.array(corner, float), 2, 0))

    def within(self, shapes: NDArray[Any]) -> NDArray[Any]:
        """Cut shapes at the borders of their parcels."""
        return on_grid(np.asarray(shapely.intersection(self.shapes, shapes), object))

    def street_margin(self, depth: Any) -> NDArray[Any]:
        """Return what is nearer to the parcel's street than a depth, also beyond its sides."""
        depth = np.broadcast_to(np.asarray(depth, float), self.count)
        return np.asarray(
            shapely.buffer(
                _run_on(self.street, depth), depth, cap_style="flat", join_style="mitre",
                mitre_limit=MITRE,
            ),
            object,
        )  # fmt: skip

    def room(self, *, front: Any, side: Any) -> NDArray[Any]:
        """Return the parcels less a margin along the street and another one all around."""
        inner = shapely.buffer(self.shapes, -np.asarray(side), join_style="mitre")
        return np.asarray(shapely.difference(inner, self.street_margin(front)), object)


def plots_of(parcels: Parcels, density: FloatArray, height: FloatArray) -> Plots:
    """Look at parcels from their streets.

    Parameters
    ----------
    density, height
        (m,) 0 to 1, and wanted metres or NaN.
    """
    shift = np.floor(parcels.front[:, 0])
    front = parcels.front - shift[:, None]
    way = front[:, 1] - front[:, 0]
    right = way / np.hypot(*way.T)[:, None]
    inward = np.column_stack([-right[:, 1], right[:, 0]])
    middle = front.mean(axis=1)
    shapes = moved(parcels.shapes, -shift)
    low, high = _extent(shapes, middle, right, inward)
    return Plots(
        shapes, moved(parcels.street, -shift), shift, middle, right, inward, low, high,
        parcels.id, parcels.block_id, density, height,
    )  # fmt: skip


def _extent(
    shapes: NDArray[Any], middle: FloatArray, right: FloatArray, inward: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the boxes around shapes in their frames, (m, 2) lower and upper corners."""
    points, row = shapely.get_coordinates(shapes, return_index=True)
    offset = points - middle[row]
    at = np.column_stack([(offset * right[row]).sum(axis=1), (offset * inward[row]).sum(axis=1)])
    low, high = np.full((len(shapes), 2), np.inf), np.full((len(shapes), 2), -np.inf)
    np.minimum.at(low, row, at)
    np.maximum.at(high, row, at)
    return low, high


def _run_on(lines: NDArray[Any], length: FloatArray) -> NDArray[Any]:
    """Make open lines longer, straight on at both ends."""
    parts, row = shapely.get_parts(lines, return_index=True)
    packed = pack(parts)
    points = packed.points.copy()
    first, last = packed.start[:-1], packed.start[1:] - 1
    open_ended = ~shapely.is_closed(parts)
    for end, inner in ((first, first + 1), (last, last - 1)):
        way = packed.points[end] - packed.points[inner]
        way *= (length[row] / np.hypot(*way.T) * open_ended)[:, None]
        points[end] = packed.points[end] + way
    longer = shapely.linestrings(points, indices=packed.line_of_point())
    return np.asarray(shapely.multilinestrings(longer, indices=row), object)


@dataclass(frozen=True)
class Pads:
    """Rectangles square to the street, m of them, in the frames of their plots.

    Attributes
    ----------
    x0, y0, x1, y1
        (m,) metres; y0 is the side nearer to the street. All are 0 where there is no room.
    """

    x0: FloatArray
    y0: FloatArray
    x1: FloatArray
    y1: FloatArray

    @property
    def width(self) -> FloatArray:
        """(m,) metres along the street."""
        return self.x1 - self.x0

    @property
    def depth(self) -> FloatArray:
        """(m,) metres away from the street."""
        return self.y1 - self.y0

    def take(self, rows: Any) -> Pads:
        """Return some of the pads."""
        return Pads(self.x0[rows], self.y0[rows], self.x1[rows], self.y1[rows])


def pads_in(plots: Plots, rooms: NDArray[Any], *, deepest: float = np.inf) -> Pads:
    """Find a large rectangle in the room of every plot.

    Parameters
    ----------
    rooms
        (m,) shapes within the parcels, perhaps empty.
    deepest
        Metres from the street beyond which nothing stands.
    """
    low, high = plots.low.copy(), plots.high.copy()
    high[:, 1] = np.minimum(high[:, 1], deepest)
    rows = np.flatnonzero(~shapely.is_empty(rooms))
    sides = np.zeros((4, plots.count))
    if len(rows):
        some, room = plots.take(rows), rooms[rows]
        tight_low, tight_high = _extent(room, some.middle, some.right, some.inward)
        at_low = np.maximum(tight_low, low[rows])
        at_high = np.maximum(np.minimum(tight_high, high[rows]), at_low)
        centre = some.place(((at_low + at_high) / 2)[:, None])[:, 0]
        found, size = inner_rectangles(room, centre, some.right, at_high - at_low)
        offset = found - some.middle
        middle = np.column_stack(
            [(offset * some.right).sum(axis=1), (offset * some.inward).sum(axis=1)]
        )
        half = _shrunk(some, room, middle, size / 2, (at_high - at_low) / GRID / 2)
        sides[:, rows] = np.column_stack([middle - half, middle + half]).T
    return Pads(*sides)


def _shrunk(
    plots: Plots, rooms: NDArray[Any], middle: FloatArray, half: FloatArray, cell: FloatArray
) -> FloatArray:
    """Make rectangles smaller until they lie in their rooms; (m, 2) half sides, or 0."""
    half = half.copy()
    out = np.ones(len(half), bool)
    for _ in range(SHRINKS):
        rows = np.flatnonzero(out & (half > 0).all(axis=1))
        if not len(rows):
            break
        low, high = (middle - half)[rows], (middle + half)[rows]
        box = plots.take(rows).boxes(*low.T, *high.T)
        beyond = shapely.area(box) - shapely.area(shapely.intersection(box, rooms[rows]))
        out[rows] = beyond > INSIDE * shapely.area(box)
        half[out] -= cell[out]
    half[out | (half <= 0).any(axis=1)] = 0.0
    return half
