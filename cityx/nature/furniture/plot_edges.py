"""Rows along the open edges of paved plots: bollards, tubs, or stands for bicycles."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city import City
from cityx.geometry.polylines import arc_lengths, every, locate, pack
from cityx.ground.pieces import Pieces, join_pieces, pieces
from cityx.ground.standing import WALKED
from cityx.ids import choose, hash_ids
from cityx.nature.land.frontages import frontage_edges
from cityx.places.profile import Furniture
from cityx.road.surface.kerbs import yaw_facing

PURPOSE = "nature/plot_edges"
# Metres between the middles of a row, and behind the edge.
SPACING = {"bollard": 1.6, "planter": 2.6, "planter_round": 1.9, "bicycle_parking": 3.4}
BEHIND = {"bollard": 0.05, "planter": 0.25, "planter_round": 0.3, "bicycle_parking": 0.85}
MOST = {"bicycle_parking": 2}  # of one row; others fill it
LEAST = 2.0  # metres of an edge that has a row


def along_plots(city: City, furniture: Furniture) -> Pieces:
    """Draw a row for each open edge of a plot behind which there is paving.

    Parameters
    ----------
    city
        City with its ground; facades tell where doors are.
    furniture
        Of the profile of the place.
    """
    ground = city.ground
    edges = frontage_edges(city)
    edges = edges.take((edges.kind == "") & (shapely.length(edges.lines) > LEAST))
    if ground is None or not len(edges.id):
        return join_pieces([])
    weights = furniture.plot_rows
    words = np.array(list(weights), object)
    kind = words[choose(city.seed, PURPOSE, edges.id, list(weights.values()))]
    found = []
    for name, spacing in SPACING.items():
        rows = np.flatnonzero(kind == name)
        if not len(rows):
            continue
        lines = pack(edges.lines[rows])
        row, at = every(arc_lengths(lines)[1], spacing, 0.5)
        number = np.arange(len(row)) - np.searchsorted(row, row)
        kept = number < MOST.get(name, len(row))
        row, at, number = row[kept], at[kept], number[kept]
        foot, ahead = locate(lines, row, at)
        inward = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * edges.side[rows[row], None]
        xy = foot + BEHIND[name] * inward
        ids = hash_ids(0, PURPOSE, edges.id[rows[row]], number)
        paved = ground.on(xy + 0.3 * inward, *WALKED)
        found.append(pieces(name, xy, ids, yaw_facing(-inward)).take(paved))
    return join_pieces(found)
