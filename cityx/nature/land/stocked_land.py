"""Land with things in rows on it: graves, vines, solar panels, stalls, containers, allotments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.layout import of_kinds
from cityx.geometry.arrays import FloatArray
from cityx.geometry.rectangles import rectangles_of
from cityx.ground.pieces import Pieces, inside_extent, join_pieces, pieces
from cityx.ids import choose, hash_ids, uniform
from cityx.system.tables import table

PURPOSE = "nature/stocked_land"


@dataclass(frozen=True)
class Stock:
    """What stands on land, and how it is set out.

    Attributes
    ----------
    land
        Kinds of areas, as `cityx.city.layout.of_kinds` takes them.
    pieces
        Names of prototypes, and how many of each there are.
    along, across
        Metres from one to the next in a row, and from row to row.
    edge
        Metres from the border of the land to the middle of a piece.
    share
        Of the places that are taken.
    aisles
        After how many rows there is an aisle, and its metres; 0 for none.
    faces
        "south", or "" where rows face each other in turn.
    """

    land: tuple[str, ...]
    pieces: Mapping[str, float]
    along: float
    across: float
    edge: float
    share: float = 1.0
    aisles: tuple[int, float] = (0, 0.0)
    faces: str = ""


STOCKS: Mapping[str, Stock] = table("nature/stocked_land", Stock)


def stocked_land(city: City) -> Pieces:
    """Set out what stands in rows on the land of a city."""
    found = join_pieces([
        _stocked(city, name, stock, shape, int(own))
        for name, stock in STOCKS.items()
        for shape, own in zip(*_land(city, stock), strict=True)
    ])  # fmt: skip
    return found.take(inside_extent(city, found.xy, 1.0))


def _land(city: City, stock: Stock) -> tuple[list[Any], list[int]]:
    areas = city.layout.areas
    rows = areas[of_kinds(areas, stock.land)]
    return rows.geometry.tolist(), rows["id"].tolist()


def _stocked(city: City, name: str, stock: Stock, shape: Any, own: int) -> Pieces:
    """Set out what stands on one area."""
    xy, row, angle = _places(shape, stock)
    ids = hash_ids(0, f"{PURPOSE}/{name}", np.full(len(xy), own, np.uint64), np.arange(len(xy)))
    kinds = np.array(list(stock.pieces), object)
    drawn = kinds[choose(city.seed, PURPOSE, ids, list(stock.pieces.values()))]
    yaw = angle + np.pi * (row % 2) if not stock.faces else np.zeros(len(xy))
    taken = uniform(city.seed, f"{PURPOSE}/taken", ids) < stock.share
    return pieces(drawn, xy, ids, yaw).take(taken)


def _places(shape: Any, stock: Stock) -> tuple[FloatArray, NDArray[np.int64], float]:
    """Return the places in rows on an area, the row of each, and which way rows run."""
    frame = rectangles_of(np.array([shape], object))
    angle = 0.0 if stock.faces else float(frame.angle[0])
    way = np.array([np.cos(angle), np.sin(angle)])
    left = np.array([-way[1], way[0]])
    middle = frame.centre[0]
    corner = shapely.get_coordinates(shape) - middle
    long, deep = (np.ptp(corner @ axis) - 2 * stock.edge for axis in (way, left))
    x = _spread(long, stock.along)
    every, wide = stock.aisles
    y = _spread(deep, stock.across)
    if every:
        number = np.arange(len(y))
        y = y + wide * (number // every - (len(y) - 1) / 2 / every)
    row, at = np.divmod(np.arange(len(x) * len(y)), max(len(x), 1))
    xy = middle + x[at, None] * way + y[row, None] * left
    inner = shapely.buffer(shape, -stock.edge + 0.01, join_style="mitre")
    kept = shapely.intersects_xy(inner, xy[:, 0], xy[:, 1]) if len(xy) else np.zeros(0, bool)
    return xy[kept], row[kept], angle


def _spread(length: float, step: float) -> FloatArray:
    """Return places a step apart, about 0."""
    count = int(max(length, 0.0) / step + 1e-6) + 1
    return np.asarray(step * (np.arange(count) - (count - 1) / 2))
