"""Bounds of buildings: least and greatest heights and storeys that whatever designs them keeps.

They stand in the tags of a building, so that they are stored and passed on with it.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

CLEAR = 0.02  # metres by which heights keep clear of a bound, which roofs round to
MEASURES = ("height", "levels")  # metres with the roof, and storeys
KEYS = {name: (f"least_{name}", f"most_{name}") for name in MEASURES}


# Sources of buildings whose heights no input states.
OURS = ("made/", "parcel/")


class Bounds(NamedTuple):
    """(n,) least and greatest values; 0 and infinity where nothing is asked."""

    least: FloatArray
    most: FloatArray

    def of(self, rows: NDArray[np.int64]) -> Bounds:
        """Return those of some rows."""
        return Bounds(self.least[rows], self.most[rows])


def kept_clear(lowest: float, highest: float) -> tuple[float, float]:
    """Return bounds of heights, metres, kept clear of where they leave room for it."""
    return min(lowest + CLEAR, highest), max(highest - CLEAR, lowest)


def bounds_of(buildings: GeoDataFrame, measure: str) -> Bounds:
    """Return what the buildings of a table must keep of one of `MEASURES`."""
    tags = buildings["tags"].to_numpy(str)
    found = Bounds(np.zeros(len(tags)), np.full(len(tags), np.inf))
    for key, values in zip(KEYS[measure], found, strict=True):
        for row in np.flatnonzero(np.char.find(tags, f'"{key}"') >= 0).tolist():
            values[row] = float(json.loads(tags[row])[key])
    return found


def is_stated(buildings: GeoDataFrame) -> BoolArray:
    """(n,) whether an input states how high a building is, or how many storeys it has."""
    ours = buildings["source"].str.startswith(OURS).to_numpy(bool)
    tags = buildings["tags"].to_numpy(str)
    said = [np.char.find(tags, f'"{key}"') >= 0 for key in ("height", "building:levels")]
    return np.asarray(~ours & (said[0] | said[1]))


def with_bounds(
    buildings: GeoDataFrame, rows: NDArray[np.int64], measure: str, least: float, most: float
) -> GeoDataFrame:
    """Bind some buildings; what binds them already stays where it is narrower.

    Parameters
    ----------
    least, most
        0 and infinity for no bound.
    """
    tags = buildings["tags"].to_numpy(object).copy()
    keys = KEYS[measure]
    for row in rows.tolist():
        own = json.loads(tags[row] or "{}")
        least_of = max(least, float(own.get(keys[0], 0.0)))
        most_of = min(most, float(own.get(keys[1], np.inf)))
        own |= {keys[0]: f"{least_of:g}"} if least_of > 0.0 else {}
        own |= {keys[1]: f"{most_of:g}"} if np.isfinite(most_of) else {}
        tags[row] = json.dumps(own, sort_keys=True)
    return buildings.assign(tags=tags.astype(str))


def unbound(tags: dict[str, str], *measures: str) -> dict[str, str]:
    """Return tags without bounds, for a building of which something else is asked now."""
    gone = {key for measure in measures for key in KEYS[measure]}
    return {key: value for key, value in tags.items() if key not in gone}


def released(buildings: GeoDataFrame, rows: NDArray[np.int64]) -> GeoDataFrame:
    """Return a table in which some buildings are bound by nothing."""
    tags = buildings["tags"].to_numpy(object).copy()
    for row in rows.tolist():
        own = json.loads(tags[row] or "{}")
        free = unbound(own, *MEASURES)
        tags[row] = json.dumps(free) if free != own else tags[row]
    return buildings.assign(tags=tags.astype(str))
