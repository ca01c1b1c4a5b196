"""Waysides: regular places beside streets, paths and the edges of parks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.geometry.arrays import FloatArray
from cityx.geometry.polygons import region_of_corners
from cityx.geometry.polylines import arc_lengths, every, locate, pack
from cityx.ids import UInt64Array, mix
from cityx.road.network.street_designs import SIDES
from cityx.road.surface.kerbs import KerbPlaces, join_places, places_along
from cityx.sources.features.vocabulary import WATER_KINDS

PATH_MARGIN = 2.0  # metres kept free at the ends of a path
Polygons = tuple[tuple[float, ...], ...]  # corners: x, y and which polygon
ROADS, AREAS = "roads", "areas"


@dataclass(frozen=True)
class Wayside:
    """n places beside ways.

    Attributes
    ----------
    xy
        (n, 2) float, metres.
    toward
        (n, 2) float, unit vectors to the way.
    line
        (n,) uint64, id of the stretch of the way and its side.
    number
        (n,) int, place along it, from 0.
    """

    xy: FloatArray
    toward: FloatArray
    line: UInt64Array
    number: NDArray[np.int64]

    def take(self, rows: Any) -> Wayside:
        """Return some of the places, by mask or by index."""
        return Wayside(self.xy[rows], self.toward[rows], self.line[rows], self.number[rows])


def beside(
    city: City, ids: UInt64Array, *, spacing: float, beyond: float, margin: float, sides: str,
    part: Polygons | None = None,
) -> Wayside:  # fmt: skip
    """List places at a regular spacing beside ways, on the ground.

    Parameters
    ----------
    city
        Where.
    ids
        Of streets, paths or areas; of an area the places lie inside its edge, of waters outside.
    spacing
        Metres along the way.
    beyond
        Metres from the kerb, the rim of a path or the edge of an area.
    margin
        Metres kept free behind junctions.
    sides
        "left", "right" or "both" of the way as it is drawn; an area has but one.
    part
        Corners of polygons in which they lie: x, y and which polygon.
    """
    left, right = SIDES[sides]
    chosen = [sign for sign, wanted in ((1, left), (-1, right)) if wanted]
    groups = [_of_streets(city, ids, sign, spacing, beyond, margin) for sign in chosen]
    groups += [_of_paths(city, ids, sign, spacing, beyond) for sign in chosen]
    groups.append(_of_areas(city, ids, spacing, beyond))
    names = ("xy", "toward", "line", "number")
    found = Wayside(*(np.concatenate([getattr(group, name) for group in groups]) for name in names))
    if part is None:
        return found
    return found.take(shapely.contains_xy(region_of_corners(part), *found.xy.T))


def _of_streets(
    city: City, ids: UInt64Array, sign: int, spacing: float, beyond: float, margin: float
) -> Wayside:
    network = city.network
    if network is None:
        return _along(np.zeros(0, object), ids, sign, spacing, beyond)
    road = city.layout.roads["id"].to_numpy(np.uint64)[network.edge_road]
    edges = np.flatnonzero(np.isin(road, ids))
    places: KerbPlaces = join_places(
        places_along(network, edges, sign, spacing=spacing, beyond=beyond, margin=margin)
    )
    line = mix(network.edge_id[places.edge] ^ np.uint64(sign > 0))
    return Wayside(places.xy, places.toward_road, line, places.number)


def _of_paths(
    city: City, ids: UInt64Array, sign: int, spacing: float, beyond: float
) -> Wayside:  # fmt: skip
    """Places beside ways that carry no cars."""
    roads = city.layout.roads
    driven = np.zeros(len(roads), bool)
    if city.network is not None:
        driven[city.network.edge_road] = True
    rows = np.flatnonzero(np.isin(roads["id"].to_numpy(np.uint64), ids) & ~driven)
    half = np.nan_to_num(roads["width"].to_numpy(float)[rows], nan=2.0) / 2
    lines = roads.geometry.to_numpy()[rows]
    own = roads["id"].to_numpy(np.uint64)[rows]
    return _along(lines, own, sign, spacing, half + beyond)


def _of_areas(city: City, ids: UInt64Array, spacing: float, beyond: float) -> Wayside:
    areas = city.layout.areas
    rows = np.flatnonzero(np.isin(areas["id"].to_numpy(np.uint64), ids))
    wet = areas["kind"].iloc[rows].isin(WATER_KINDS).to_numpy()
    off = np.where(wet, beyond, -beyond)
    edged = shapely.buffer(areas.geometry.to_numpy()[rows], off, join_style="mitre")
    parts, at = shapely.get_parts(edged, return_index=True)
    rings = shapely.get_exterior_ring(parts)
    kept = ~shapely.is_empty(rings)
    own = areas["id"].to_numpy(np.uint64)[rows][at[kept]]
    found = _along(rings[kept], own, 1, spacing, 0.0)
    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = found.xy.T  # a river leaves the site
    return found.take((x > xmin) & (x < xmax) & (y > ymin) & (y < ymax))


def _along(
    lines: NDArray[Any], own: UInt64Array, sign: int, spacing: float, aside: Any
) -> Wayside:  # fmt: skip
    """Places along lines, `aside` metres to their left (`sign` 1) or right."""
    if not len(lines):
        empty = np.zeros((0, 2))
        return Wayside(empty, empty, np.zeros(0, np.uint64), np.zeros(0, np.int64))
    packed = pack(lines)
    closed = shapely.is_closed(lines)
    row, along = every(arc_lengths(packed)[1], spacing, np.where(closed, 0.0, PATH_MARGIN))
    position, ahead = locate(packed, row, along)
    out = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * float(sign)
    offset = np.broadcast_to(np.asarray(aside, float), (len(lines),))[row]
    number = np.arange(len(row)) - np.searchsorted(row, row)
    line = mix(own[row] ^ np.uint64(sign > 0))
    return Wayside(position + out * offset[:, None], -out, line, number)
