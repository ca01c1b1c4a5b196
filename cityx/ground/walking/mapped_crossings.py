"""Crossings that the map draws on streets, and where it says that nobody may cross."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import DROPPED, KERB_HEIGHT
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, to_linestrings
from cityx.sources.features.measures import measure

if TYPE_CHECKING:
    from cityx.city.layout import Layout


TELLS = ("", "bare", "bars", "signals")  # what the map says of a crossing
BARE, BARS, SIGNALS = 1, 2, 3
# Many maps tell of the signals of a junction by its crossings alone.
SIGNALLED = r'"crossing": *"traffic_signals"|"crossing:signals": *"yes"'
# OpenStreetMap's crossing=*, crossing:markings=*, crossing_ref=* and kerb=*.
_KEY = '"crossing": '
_NO = r'"crossing": *"no"'
_BARE = r'"crossing": *"(?:unmarked|informal)"|"crossing:markings": *"no"'
_BARS = (
    r'"crossing": *"(?:zebra|marked|uncontrolled)"|"crossing_ref": *"zebra"'
    r'|"crossing:markings": *"(?:yes|zebra|lines|ladder)'
)
_HEIGHT = "kerb:height"
HIGHEST = 0.5  # metres of a kerb; more is a mistake
_RAISED = r'"kerb": *"(?:raised|regular|yes)"'


@dataclass(frozen=True)
class MappedCrossings:
    """Crossings of the map on edges, m of them.

    Attributes
    ----------
    edge, along
        (m,) edge, and metres from its start.
    told
        (m,) into `TELLS`.
    raised
        (m,) bool, whether its kerbs are said to be those of the rest of the street.
    point
        (m,) row of the layout's points.
    """

    edge: IntArray
    along: FloatArray
    told: IntArray
    raised: BoolArray
    point: IntArray


def mapped_crossings(layout: Layout, lines: Polylines) -> MappedCrossings:
    """Find the crossings of the map that lie on the centrelines of edges."""
    return _on_edges(layout, lines, barred=False)


def barred_crossings(layout: Layout, lines: Polylines) -> MappedCrossings:
    """Find the places on edges at which the map says that nobody may cross: crossing=no."""
    return _on_edges(layout, lines, barred=True)


def raised_kerbs(layout: Layout) -> NDArray[Any]:
    """(k,) points at which the map says that a kerb is as high as elsewhere."""
    points = layout.points[(layout.points["kind"] == "kerb").to_numpy()]
    return np.asarray(points.geometry[_are_raised(points["tags"])])


def kerb_heights(tags: Any) -> FloatArray:
    """(k,) metres that tags of points state of their kerbs, NaN where they state none."""
    found = np.full(len(tags), np.nan)
    for row in np.flatnonzero(tags.str.contains(f'"{_HEIGHT}"', regex=False)).tolist():
        height = measure(json.loads(tags.iat[row])[_HEIGHT], 0.0, HIGHEST)
        found[row] = np.nan if height is None else height
    return found


def _are_raised(tags: Any) -> BoolArray:
    """(k,) whether kerbs are as high as those of the rest of the street: a height says it first."""
    height = kerb_heights(tags)
    said = tags.str.contains(_RAISED, regex=True).to_numpy().astype(bool)
    return np.asarray(np.where(np.isnan(height), said, height > (DROPPED + KERB_HEIGHT) / 2))


def _on_edges(layout: Layout, lines: Polylines, *, barred: bool) -> MappedCrossings:
    # Signals and signs are crossings as well where they bear the key.
    kept = (layout.points["kind"] == "crossing").to_numpy()
    kept = kept | layout.points["tags"].str.contains(_KEY, regex=False).to_numpy(bool)
    row = np.flatnonzero(kept)
    row = row[layout.points["tags"].iloc[row].str.contains(_NO).to_numpy(bool) == barred]
    points = layout.points.iloc[row]
    if not len(points) or not lines.count:
        none = np.zeros(0, np.int64)
        return MappedCrossings(none, np.zeros(0), none, np.zeros(0, bool), none)
    tags = points["tags"].str
    told = np.zeros(len(points), np.int64)
    for number, pattern in ((BARS, _BARS), (SIGNALS, SIGNALLED), (BARE, _BARE)):
        told[tags.contains(pattern, regex=True).to_numpy().astype(bool)] = number
    places, shapes = points.geometry.to_numpy(), to_linestrings(lines)
    which, edge = shapely.STRtree(shapes).query_nearest(places, max_distance=1.0)
    along = shapely.line_locate_point(shapes[edge], places[which])
    raised = _are_raised(points["tags"])
    return MappedCrossings(
        edge.astype(np.int64), np.asarray(along), told[which], raised[which], row[which]
    )
