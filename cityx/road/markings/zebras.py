"""Zebra crossing and other crossing markings, at the ends of arms and between junctions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import every
from cityx.road.markings.marks import (
    DOTTED,
    LINE,
    NONE,
    PLAIN,
    QUIET,
    STRIPED,
    ZEBRA,
    Marks,
    Street,
    boxes,
)
from cityx.road.network.through_roads import through_roads
from cityx.road.surface.carriageway import Carriageway, joined_by
from cityx.road.surface.roundabouts import ring_edges, ring_nodes

BAR = 0.5  # metres, width of a zebra bar and of the gap after it
FLARE = 0.5  # metres by which the kerb may bend away from its street within a crossing
FLARED = 2.0  # metres, the same where its curve begins within a crossing
DRAWN = 3.5  # metres, the same where the map draws what is driven on, kerb to kerb
MOUTH = 2.4  # metres along a street of the way across its mouth
KERB_GAP = 0.1  # metres between a mark and the kerb
# Metres across the road: the marks of a row and the gaps between, and their breadth along it (RMS,
# wide lines; TSRGD 2016, diagram 1055.1).
ROWS = {"lines": (0.5, 0.2, 0.25), "studs": (0.12, 0.38, 0.12), "bars": (0.5, 0.2, LINE)}


@dataclass(frozen=True)
class Zebras:
    """Crossings, z of them, with bars or without.

    Attributes
    ----------
    edge
        (z,) int64.
    along, depth
        (z,) float, metres from the edge's start to the middle, and metres along the road.
    kind
        (z,) int64 into `cityx.road.markings.marks.KINDS`.
    flare
        (z,) float, metres by which kerbs may lie off their street there: `FLARE` as a rule.
    """

    edge: IntArray
    along: FloatArray
    depth: FloatArray
    kind: IntArray
    flare: FloatArray

    def take(self, rows: BoolArray) -> Zebras:
        """Return some of them."""
        return Zebras(*(getattr(self, name)[rows] for name in Zebras.__dataclass_fields__))

    @property
    def flared(self) -> BoolArray:
        """(z,) whether the kerbs have begun to curve, or the map draws them elsewhere."""
        return np.asarray(self.flare > FLARE)


def zebras_of(street: Street, chosen: BoolArray, road: Carriageway) -> Zebras:
    """Find all crossings: at the ends of arms, and those of the map between junctions."""
    network = street.network
    edge, end = np.nonzero((street.crossing > 0) & chosen[:, None])
    back = network.trim[edge, end] + street.setback[edge, end] + street.depth[edge] / 2
    along = np.where(end == 0, back, street.length[edge] - back)
    kind, flared = street.crossing[edge, end], street.setback[edge, end] < 0
    more, there, told = _between_junctions(street, chosen)
    edge, along = np.concatenate([edge, more]), np.concatenate([along, there])
    flared = np.concatenate([flared, np.zeros(len(more), bool)])
    kind, depth = np.concatenate([kind, told]), street.depth[edge]
    return Zebras(edge, along, depth, kind, _flares(street, edge, along, depth, flared, road))


def mouth_crossings(street: Street, chosen: BoolArray, road: Carriageway) -> Zebras:
    """Find where walks continue across the mouths of streets without a mapped crossing.

    These are streets with walks that end at a road, and all arms where several of one class meet;
    the road that goes straight on is crossed elsewhere.
    """
    network = street.network
    table = street.layout.roads.iloc[network.edge_road]
    walk = table[["sidewalk_left", "sidewalk_right"]].to_numpy(float).max(axis=1, initial=0.0)
    walked = chosen & (walk > 0) & ~np.isin(street.kind, (*QUIET, "living_street"))
    node = network.edge_nodes
    ring = ring_edges(street.layout, network)[:, None] | ring_nodes(street.layout, network)[node]
    ends = walked[:, None] & (street.crossing == NONE) & street.joint[node] & ~ring
    through = through_roads(street)
    major = through.major | through.tee
    ends[through.edge[major], through.side[major]] = False
    inner = street.cluster[node]
    ends &= (inner[:, 0] != inner[:, 1])[:, None]
    taken = np.where(street.crossing > 0, street.setback + street.depth[:, None], 0.0).sum(axis=1)
    ends &= (street.length - network.trim.sum(axis=1) - taken > 2 * MOUTH)[:, None]
    edge, end = np.nonzero(ends)
    back = street.mouth[edge, end] + MOUTH / 2
    along = np.where(end == 0, back, street.length[edge] - back)
    flared = back - MOUTH / 2 < network.trim[edge, end]
    depth, kind = np.full(len(edge), MOUTH), np.full(len(edge), PLAIN)
    return Zebras(edge, along, depth, kind, _flares(street, edge, along, depth, flared, road))


def _flares(
    street: Street, edge: IntArray, along: FloatArray, depth: FloatArray, flared: BoolArray,
    road: Carriageway,
) -> FloatArray:  # fmt: skip
    """(z,) metres by which kerbs may lie off their street at crossings."""
    flare = np.where(flared, FLARED, FLARE)
    width = 2 * (street.network.half_width[edge] + DRAWN)
    across, _ = boxes(street.lines, edge, along, np.zeros(len(edge)), depth, width)
    flare[shapely.STRtree(across).query(road.drawn, predicate="intersects")[1]] = DRAWN
    return flare


def joined(first: Zebras, second: Zebras) -> Zebras:
    """Return the crossings of both."""
    return Zebras(
        *(np.concatenate([getattr(one, name) for one in (first, second)])
          for name in Zebras.__dataclass_fields__)
    )  # fmt: skip


def zebra_bars(street: Street, zebras: Zebras, road: Carriageway) -> tuple[Marks, IntArray]:
    """Paint the bars of crossings from kerb to kerb; also returns the crossing of each."""
    rows = np.flatnonzero(zebras.kind == STRIPED)
    edge, width = zebras.edge[rows], _widths(street, zebras, rows) - BAR
    which, lateral = every(width, 2 * BAR, BAR / 2)
    lateral = lateral - width[which] / 2
    size = np.full(len(which), BAR)
    marks, edge = boxes(street.lines, edge[which], zebras.along[rows][which], lateral,
                        zebras.depth[rows][which], size)  # fmt: skip
    return _on_road(marks, edge, rows[which], zebras, road)


def crossing_rows(
    street: Street, zebras: Zebras, road: Carriageway, style: str
) -> tuple[Marks, IntArray]:
    """Paint the two rows of short marks along crossings under signals; also the crossing of each.

    Parameters
    ----------
    street, zebras, road
        The streets, their crossings and their surfaces.
    style
        "lines" or "studs".
    """
    size, gap, breadth = ROWS[style]
    rows = np.flatnonzero(zebras.kind == DOTTED)
    width = _widths(street, zebras, rows)
    which, lateral = every(width, size + gap, size / 2 + KERB_GAP)
    lateral = lateral - width[which] / 2
    own = np.tile(which, 2)
    side = np.repeat([-0.5, 0.5], len(which))
    along = zebras.along[rows][own] + side * (zebras.depth[rows][own] - LINE)
    marks, edge = boxes(street.lines, zebras.edge[rows][own], along, np.tile(lateral, 2), breadth,
                        np.full(len(own), size))  # fmt: skip
    return _on_road(marks, edge, rows[own], zebras, road)


def _widths(street: Street, zebras: Zebras, rows: IntArray) -> FloatArray:
    """(k,) metres across which marks are looked for: more where the kerbs curve away."""
    half = street.network.half_width[zebras.edge[rows]]
    return np.asarray(2 * (half + np.where(zebras.flared, zebras.flare, 0.0)[rows]))


def _on_road(
    marks: Any, edge: IntArray, crossing: IntArray, zebras: Zebras, road: Carriageway
) -> tuple[Marks, IntArray]:  # fmt: skip
    """Leave out marks of flared crossings that reach over a kerb."""
    kept = np.ones(len(marks), bool)
    rows = np.flatnonzero(zebras.flared[crossing])
    if len(rows):
        driven = road.kerbed
        mark, surface = shapely.STRtree(driven).query(marks[rows], predicate="intersects")
        pair = np.unique(np.stack([crossing[rows[mark]], surface]), axis=1)
        paved, group = joined_by(driven[pair[1]], pair[0])
        paved = shapely.buffer(paved, -KERB_GAP)
        at = np.searchsorted(group, crossing[rows])
        carried = np.isin(crossing[rows], group)
        kept[rows] = False
        kept[rows[carried]] = shapely.covered_by(marks[rows[carried]], paved[at[carried]])
    return (marks[kept], edge[kept]), crossing[kept]


def _between_junctions(
    street: Street, chosen: BoolArray
) -> tuple[IntArray, FloatArray, IntArray]:  # fmt: skip
    """Crossings of the map between junctions: edge, distance from its start, and kind."""
    mapped, (begin, end) = street.mapped, street.free
    edge, along = mapped.edge, mapped.along
    clear = chosen[edge] & (along > begin[edge] + ZEBRA) & (along < end[edge] - ZEBRA)
    edge, along, kind = edge[clear], along[clear], street.told[clear]
    order = np.lexsort((along, edge))
    edge, along, kind = edge[order], along[order], kind[order]
    # Crossings mapped once per lane or island are one crossing.
    apart = np.r_[True, (edge[1:] != edge[:-1]) | (np.diff(along) > 2 * ZEBRA)][: len(edge)]
    return edge[apart], along[apart], kind[apart]
