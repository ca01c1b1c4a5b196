"""Crossings that the map draws on streets, and where it says that nobody may cross."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, to_linestrings

if TYPE_CHECKING:
    from cityx.city.layout import Layout


TELLS = ("", "bare", "bars", "signals")  # what the map says of a crossing
BARE, BARS, SIGNALS = 1, 2, 3
# Many maps tell of the signals of a junction by its crossings alone.
SIGNALLED = r'"crossing": *"traffic_signals"|"crossing:signals": *"yes"'
# OpenStreetMap's crossing=*, crossing:markings=*, crossing_ref=* and kerb=*.
_NO = r'"crossing": *"no"'
_BARE = r'"crossing": *"(?:unmarked|informal)"|"crossing:markings": *"no"'
_BARS = (
    r'"crossing": *"(?:zebra|marked|uncontrolled)"|"crossing_ref": *"zebra"'
    r'|"crossing:markings": *"(?:yes|zebra|lines|ladder)'
)
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
    return np.asarray(points.geometry[points["tags"].str.contains(_RAISED, regex=True)])


def _on_edges(layout: Layout, lines: Polylines, *, barred: bool) -> MappedCrossings:
    row = np.flatnonzero((layout.points["kind"] == "crossing").to_numpy())
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
    raised = tags.contains(_RAISED, regex=True).to_numpy().astype(bool)
    return MappedCrossings(
        edge.astype(np.int64), np.asarray(along), told[which], raised[which], row[which]
    )
