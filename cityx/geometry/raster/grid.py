"""Where the pixels of a north-up raster lie on the ground."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray


@dataclass(frozen=True)
class Grid:
    """A north-up raster of square pixels on the ground.

    Every function of `cityx.geometry.raster` counts in one way: the point (column, row) = (0, 0)
    is the north-west corner of the first pixel, and the centre of pixel [i, j] of an array is the
    point (j + 0.5, i + 0.5). Here alone it is said where that lies in metres.

    Attributes
    ----------
    rows, columns
        Size.
    pixel
        Edge of a pixel, metres.
    west, north
        The north-west corner, scene frame, metres.
    """

    rows: int
    columns: int
    pixel: float
    west: float
    north: float

    @classmethod
    def about_origin(cls, rows: int, columns: int, pixel: float) -> Grid:
        """Return the grid whose middle is the origin."""
        return cls(rows, columns, pixel, -columns * pixel / 2, rows * pixel / 2)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """(xmin, ymin, xmax, ymax), metres."""
        east, south = self.west + self.columns * self.pixel, self.north - self.rows * self.pixel
        return self.west, south, east, self.north

    def to_metres(self, points: ArrayLike) -> FloatArray:
        """Return (n, 2) metres of (n, 2) points given as (column, row)."""
        points = np.asarray(points, float).reshape(-1, 2)
        corner = np.array([self.west, self.north])
        return np.asarray(corner + points * np.array([self.pixel, -self.pixel]))

    def to_pixels(self, points: ArrayLike) -> FloatArray:
        """Return (n, 2) points as (column, row) of (n, 2) metres."""
        points = np.asarray(points, float).reshape(-1, 2)
        corner = np.array([self.west, self.north])
        return np.asarray((points - corner) / np.array([self.pixel, -self.pixel]))

    def shapes_to_metres(self, shapes: ArrayLike) -> NDArray[Any]:
        """Return shapes given as (column, row) in metres, rounded to 0.1 mm."""
        return np.asarray(
            shapely.transform(np.asarray(shapes, object), lambda p: np.round(self.to_metres(p), 4)),
            object,
        )

    def values_at(self, raster: NDArray[Any], points: ArrayLike) -> NDArray[Any]:
        """Return (n,) values of the pixels that hold (n, 2) metres; the nearest ones outside."""
        cell = np.floor(self.to_pixels(points)).astype(np.int64)
        column = np.clip(cell[:, 0], 0, self.columns - 1)
        return np.asarray(raster[np.clip(cell[:, 1], 0, self.rows - 1), column])

    def touched(self, shapes: NDArray[Any]) -> NDArray[np.bool_]:
        """Return whether some of (n,) polygons in metres reaches into each pixel."""
        return self._drawn([(shape, 1) for shape in shapes], all_touched=True) > 0

    def numbered(self, shapes: NDArray[Any], *, touched: bool = False) -> NDArray[np.int32]:
        """Return the number from 1 of the shape that holds the middle of each pixel, 0 for none.

        Parameters
        ----------
        shapes
            (n,) polygons in metres; of those that overlap the last one counts.
        touched
            Whether pixels whose middle no shape holds count for one that reaches into them.
        """
        pairs = [*zip(shapes, range(1, len(shapes) + 1), strict=True)]
        found = self._drawn(pairs)
        if touched:
            found = np.where(found > 0, found, self._drawn(pairs, all_touched=True))
        return found

    def _drawn(self, pairs: list[Any], *, all_touched: bool = False) -> NDArray[np.int32]:
        from rasterio.features import rasterize
        from rasterio.transform import Affine

        size = self.rows, self.columns
        if not pairs:
            return np.zeros(size, np.int32)
        place = Affine(self.pixel, 0.0, self.west, 0.0, -self.pixel, self.north)
        drawn = rasterize(
            _named(pairs), size, transform=place, all_touched=all_touched, dtype="int32"
        )
        return np.asarray(drawn)


def _named(pairs: list[Any]) -> list[Any]:
    """Return pairs of a shape and a number with the rings of polygons as lists.

    Shapes tell their points one by one, which takes longer than to draw them.
    """
    shapes = np.array([shape for shape, _ in pairs], object)
    if (shapely.get_type_id(shapes) != shapely.GeometryType.POLYGON).any():
        return pairs
    rings, of = shapely.get_rings(shapes, return_index=True)
    points, ring = shapely.get_coordinates(rings, return_index=True)
    ends = np.searchsorted(ring, np.arange(len(rings) + 1)).tolist()
    first = np.searchsorted(of, np.arange(len(shapes) + 1)).tolist()
    xy = [*map(tuple, points.tolist())]
    lines = [xy[begin:end] for begin, end in pairwise(ends)]
    return [
        ({"type": "Polygon", "coordinates": lines[begin:end]}, number)
        for (begin, end), (_, number) in zip(pairwise(first), pairs, strict=True)
    ]
