"""Kerbs that the map draws as points, beside those that are built."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import Ground
from cityx.city.layout import Layout
from cityx.geometry.arrays import FloatArray
from cityx.road.network.contradictions import map_names
from cityx.sources.features.tagged import named_note

AT = 2.5  # metres from a point of the map within which a kerb is the one that it means
BUILT = ("kerb_dropped", "kerb")  # surfaces of lowered and of raised kerbs
LOWERED = frozenset({"lowered", "flush", "no"})
RAISED = frozenset({"raised", "regular"})


def kerb_notes(layout: Layout, ground: Ground) -> tuple[str, ...]:
    """Return sentences that name kerbs of the map that are not built where, or as, it has them."""
    table = layout.points
    words = _words(table["tags"])
    rows = np.flatnonzero(words != "")
    if not len(rows):
        return ()
    gap = np.stack([_gaps(ground, name, table.geometry.to_numpy()[rows]) for name in BUILT])
    far = (gap > AT).all(axis=0)
    lowered = gap[0] <= gap[1]
    meant_low, meant_high = (np.isin(words[rows], list(group)) for group in (LOWERED, RAISED))
    told = (
        (f"kerbs lie over {AT:g} m from those that are built along the streets", far),
        ("kerbs that are lowered are built raised", ~far & ~lowered & meant_low),
        ("kerbs that are raised are built lowered, as at a crossing", ~far & lowered & meant_high),
    )  # fmt: skip
    notes = [named_note(what, map_names(table, rows[chosen])) for what, chosen in told]
    return tuple(note for note in notes if note)


def _words(tags: Any) -> NDArray[np.str_]:
    """(k,) what tags of points say of a kerb, "" for nothing."""
    found = np.full(len(tags), "", dtype="U16")
    for row in np.flatnonzero(tags.str.contains('"kerb"', regex=False)).tolist():
        found[row] = str(json.loads(tags.iat[row]).get("kerb", ""))
    return found


def _gaps(ground: Ground, name: str, places: NDArray[Any]) -> FloatArray:
    """(k,) metres from places to the nearest kerb of a kind, infinite beyond `AT`."""
    shapes = shapely.polygons(ground.vertices[ground.triangles_of(name)])
    pairs, gap = shapely.STRtree(shapes).query_nearest(
        places, max_distance=AT, return_distance=True
    )
    found = np.full(len(places), np.inf)
    np.minimum.at(found, pairs[0], gap)
    return found
