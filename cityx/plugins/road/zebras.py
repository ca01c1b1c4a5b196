"""Crossings with bars: at the ends of arms, and those of the map between junctions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from cityx.geometry.polylines import every, to_linestrings
from cityx.plugins.road.marks import ZEBRA, BoolArray, FloatArray, IntArray, Marks, Street, boxes

BAR = 0.5  # metres, width of a zebra bar and of the gap after it


@dataclass(frozen=True)
class Zebras:
    """Crossings with bars, z of them, and where traffic halts before them.

    Attributes
    ----------
    edge
        (z,) int64.
    along, depth
        (z,) float, metres from the edge's start to the middle, and metres along the road.
    """

    edge: IntArray
    along: FloatArray
    depth: FloatArray


def zebras_of(street: Street, chosen: BoolArray) -> Zebras:
    """Find all crossings with bars: at the ends of arms, and those of the map between junctions."""
    network = street.network
    edge, end = np.nonzero(network.crossing & chosen[:, None])
    back = network.trim[edge, end] + street.setback[edge, end] + street.depth[edge] / 2
    along = np.where(end == 0, back, street.length[edge] - back)
    more, there = _mapped_crossings(street, chosen)
    edge, along = np.concatenate([edge, more]), np.concatenate([along, there])
    return Zebras(edge, along, street.depth[edge])


def zebra_bars(street: Street, zebras: Zebras) -> tuple[Marks, IntArray]:
    """Paint the bars of crossings; also returns the crossing of each."""
    width = 2 * street.network.half_width[zebras.edge] - BAR
    which, lateral = every(width, 2 * BAR, BAR / 2)
    lateral = lateral - width[which] / 2
    size = np.full(len(which), BAR)
    marks, edge = boxes(street.lines, zebras.edge[which], zebras.along[which], lateral,
                         zebras.depth[which], size)  # fmt: skip
    return (marks, edge), which


def _mapped_crossings(street: Street, chosen: BoolArray) -> tuple[IntArray, FloatArray]:
    """Crossings of the map between junctions: edge and distance from its start."""
    points = street.layout.points
    mapped = points[(points["kind"] == "crossing").to_numpy()]
    unmarked = mapped["tags"].str.contains("unmarked", regex=False).to_numpy().astype(bool)
    places = mapped.geometry.to_numpy()[~unmarked]
    edges = np.flatnonzero(chosen)
    if not len(places) or not len(edges):
        return np.zeros(0, np.int64), np.zeros(0)
    shapes = to_linestrings(street.lines)[edges]
    point, row = shapely.STRtree(shapes).query_nearest(places, max_distance=1.0, all_matches=False)
    along = shapely.line_locate_point(shapes[row], places[point])
    edge = edges[row]
    begin, end = street.free
    clear = (along > begin[edge] + ZEBRA) & (along < end[edge] - ZEBRA)
    edge, along = edge[clear], along[clear]
    order = np.lexsort((along, edge))
    edge, along = edge[order], along[order]
    # Crossings mapped once per lane or island are one crossing.
    apart = np.r_[True, (edge[1:] != edge[:-1]) | (np.diff(along) > 2 * ZEBRA)][: len(edge)]
    return edge[apart], along[apart]
