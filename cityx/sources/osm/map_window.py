"""The site: which rectangle of the map is built, and what is cut at its border."""

from __future__ import annotations

import numpy as np

from cityx.sources.features.clipping import Box, FloatArray, IntArray
from cityx.sources.osm.elements import OsmMap

MIN_DEGREES = 2e-5  # about 2 m; a smaller declared rectangle is a mistake
OUTLIERS = 0.02  # share of points at either end that may be outliers
OVERHANG = 0.25  # how far beyond the rest points still belong to the site, of the rest's span
FEW_POINTS = 200  # fewer say nothing about outliers
FEW_BUILDINGS = 50  # of so few none is an outlier, however finely another one is drawn
WIDEST = 100e3  # metres; a plane does not stand for the Earth beyond, nor memory for its grids
DEGREE = 111_320.0  # metres, of latitude


def site_degrees(osm: OsmMap, buildings: IntArray, roads: IntArray, others: IntArray) -> Box | None:
    """Choose the rectangle to build, (west, south, east, north) in degrees.

    The rectangle the file declares is taken when it holds things to build, cut down to them; else
    a rectangle around the nodes of buildings and roads without far outliers, such as the ends of
    long roads. None when nothing has a position.

    Parameters
    ----------
    buildings, roads, others
        Rows of the ways.
    """
    places = osm.lonlat[osm.nodes_of(np.concatenate([buildings, roads]))]
    if len(places) == 0:
        return None
    reach = _reach(places)
    places = _within_reach(places, reach)
    if osm.bounds is not None:
        low, high = np.array(osm.bounds[:2]), np.array(osm.bounds[2:])
        inside = ((places >= low) & (places <= high)).all(axis=1)
        if (high - low).min() > MIN_DEGREES and inside.any():
            every = osm.lonlat[osm.nodes_of(np.concatenate([buildings, roads, others]))]
            every = _within_reach(every, reach)
            return _box(np.maximum(low, every.min(axis=0)), np.minimum(high, every.max(axis=0)))
    focus = _within_reach(osm.lonlat[osm.nodes_of(buildings)], reach)
    by_buildings = len(focus) >= max(FEW_POINTS, len(places) / 10)
    # Where roads lie denser than buildings (a map without houses) they decide.
    if not by_buildings:
        focus = places
    if len(focus) < FEW_POINTS or (by_buildings and len(buildings) < FEW_BUILDINGS):
        return _box(focus.min(axis=0), focus.max(axis=0))
    low, high = np.quantile(focus, [OUTLIERS, 1 - OUTLIERS], axis=0)
    overhang = OVERHANG * (high - low)
    return _box(
        np.maximum(low - overhang, focus.min(axis=0)),
        np.minimum(high + overhang, focus.max(axis=0)),
    )


def _reach(places: FloatArray) -> FloatArray:
    """Return the (2, 2) lowest and highest longitude and latitude that one site can span."""
    away = places - np.median(places, axis=0)
    middle = places[np.argmin((away**2).sum(axis=1))]  # between two far clusters lies nothing
    half = WIDEST / 2 / DEGREE / np.array([max(np.cos(np.radians(middle[1])), 0.01), 1.0])
    return np.array([middle - half, middle + half])


def _within_reach(places: FloatArray, reach: FloatArray) -> FloatArray:
    inside = ((places >= reach[0]) & (places <= reach[1])).all(axis=1)
    return np.asarray(places[inside], np.float64)


def _box(low: FloatArray, high: FloatArray) -> Box:
    # A site on one line still needs an area: 20 m around it.
    pad = np.where(high - low < 2e-4, 2e-4, 0.0)
    west, south = (low - pad).tolist()
    east, north = (high + pad).tolist()
    return west, south, east, north
