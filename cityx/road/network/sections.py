"""Cross-sections of edges: what lies where between the kerbs, and the walks beside them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH
from cityx.city.section import CARRIAGEWAY, KIND, NARROWEST_LANE, PARKING, Band, read_section
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered

if TYPE_CHECKING:
    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork


TWO_LANES = 5.5  # metres; narrower two-way streets have one lane for both directions
LEAST_DRIVE = 2.5  # metres left to traffic; where parked cars leave less, they do not park
LEAST_TAGGED = 2.0  # metres of a lane of the map; where it gets less, the map's lanes do not fit
_STATED = r'"lanes": *"\d'
GIVES_WAY = ("parking", "shoulder", "median", "verge", "cycle")  # in this order, where it is tight


@dataclass(frozen=True)
class Bands:
    """Bands of the edges of a network, b of them, edge by edge from left to right.

    Attributes
    ----------
    edge
        (b,) int64.
    kind
        (b,) uint8 into `cityx.city.section.BAND_KINDS`.
    direction
        (b,) int8, as of `cityx.city.section.Band`.
    turns
        (b,) uint8, bits of `cityx.city.section.TURN`.
    left, right
        (b,) float64, metres from the centreline, positive to the left.
    """

    edge: IntArray
    kind: NDArray[np.uint8]
    direction: NDArray[np.int8]
    turns: NDArray[np.uint8]
    left: FloatArray
    right: FloatArray

    def take(self, rows: Any) -> Bands:
        """Return the given bands (indices or mask)."""
        return Bands(*(getattr(self, column.name)[rows] for column in fields(self)))

    @property
    def middle(self) -> FloatArray:
        """(b,) metres from the centreline to the middle, positive to the left."""
        return (self.left + self.right) / 2

    @property
    def width(self) -> FloatArray:
        """(b,) metres."""
        return self.left - self.right


def bands_of(layout: Layout, network: RoadNetwork) -> Bands:
    """Divide every edge into bands that fill its carriageway, and add its sidewalks.

    A cross-section of the layout is scaled to the width between the kerbs; where its lanes would
    get too narrow, parked cars, shoulders and medians give way, and at last the section as a whole.
    """
    table = layout.roads.iloc[network.edge_road]
    text = table["section"].to_numpy().astype(str)
    total = 2.0 * network.half_width
    groups = [_usual(table, total, network.left_hand)]
    described = np.flatnonzero(text != "")
    known: dict[tuple[str, float], tuple[Band, ...] | None] = {}
    of_text, fitting = [], np.zeros(len(total), bool)
    for edge in described.tolist():
        key = (text[edge], float(total[edge]))
        if key not in known:
            known[key] = _fitted(read_section(key[0]), key[1])
        bands = known[key]
        if bands is not None:
            fitting[edge] = True
            of_text.append((edge, bands))
    if of_text:
        groups[0] = groups[0].take(~fitting[groups[0].edge])
        groups.append(_of_text(of_text, total))
    groups.append(_walks(table, total, of_text))
    joined = Bands(*(np.concatenate([getattr(group, column.name) for group in groups])
                     for column in fields(Bands)))  # fmt: skip
    return joined.take(np.lexsort((-joined.left, joined.edge)))


def _usual(table: Any, total: FloatArray, left_hand: NDArray[np.bool_]) -> Bands:
    """Divide edges by the columns of their roads: parked cars outside, lanes of one width."""
    parked = [table[f"parking_{side}"].to_numpy(bool) for side in ("left", "right")]
    tagged = np.maximum(table["lanes"].to_numpy().astype(int), 1)
    stated = table["tags"].str.contains(_STATED, regex=True).to_numpy().astype(bool)
    least = np.where(stated, np.maximum(tagged * LEAST_TAGGED, LEAST_DRIVE), LEAST_DRIVE)
    tight = total - PARKING * (parked[0].astype(int) + parked[1]) < least
    at_left, at_right = (column & ~tight for column in parked)
    width = total - PARKING * (at_left.astype(int) + at_right)
    oneway = table["oneway"].to_numpy(bool)
    two_way = ~oneway & (total >= TWO_LANES) & (width >= 2 * NARROWEST_LANE)
    wanted = np.where(two_way, np.maximum(tagged, 2), tagged)
    narrowest = np.where(stated, LEAST_TAGGED, NARROWEST_LANE)
    lanes = np.clip(wanted, 1, np.maximum(width // narrowest, 1)).astype(int)
    share = table["lanes_forward"].to_numpy() / tagged
    forward = np.clip(np.rint(lanes * share), 1, np.maximum(lanes - 1, 1)).astype(int)
    forward = np.where(oneway, lanes, np.where(lanes == 1, 0, forward))
    # Parking left, lanes, parking right.
    count = at_left.astype(int) + lanes + at_right
    edge = np.repeat(np.arange(len(total)), count)
    place = numbered(count)
    lane = place - at_left[edge]
    driving = (lane >= 0) & (lane < lanes[edge])
    first = np.where(left_hand, forward, lanes - forward)[edge]
    ahead = np.where(left_hand, 1, -1)[edge]
    direction = np.where(lane < first, ahead, -ahead)
    direction = np.where(driving & (oneway | (lanes > 1))[edge], direction, 0)
    direction = np.where(driving & oneway[edge], 1, direction)
    left = total[edge] / 2 - np.where(at_left[edge] & (place > 0), PARKING, 0.0)
    step = (width / lanes)[edge]
    left = left - np.clip(lane, 0, lanes[edge]) * step
    size = np.where(driving, step, PARKING)
    kind = np.where(driving, KIND["drive"], KIND["parking"])
    return Bands(
        edge,
        kind.astype(np.uint8),
        direction.astype(np.int8),
        np.zeros(len(edge), np.uint8),
        left,
        left - size,
    )


def _fitted(bands: tuple[Band, ...], total: float) -> tuple[Band, ...] | None:
    """Scale a cross-section to the width between the kerbs; None when it does not fit."""
    kerbs = [number for number, band in enumerate(bands) if band.kind in CARRIAGEWAY]
    before, after = bands[: kerbs[0]], bands[kerbs[-1] + 1 :]
    inside = [band for band in bands if band.kind in CARRIAGEWAY]
    for leaving in ("", *GIVES_WAY):
        inside = [band for band in inside if band.kind != leaving] or inside
        moving = [band for band in inside if band.kind in ("drive", "bus")]
        if not moving:  # a cycleway, or a street that is closed to what drives
            moving = inside
        fixed = sum(band.width for band in inside if band not in moving)
        scale = (total - fixed) / max(sum(band.width for band in moving), 1e-9)
        if scale * min((band.width for band in moving), default=0.0) >= min(
            LEAST_TAGGED, *(band.width for band in moving)
        ):
            break
    else:
        return None
    scaled = [
        Band(band.kind, band.width * scale if band in moving else band.width, band.direction,
             band.turns)
        for band in inside
    ]  # fmt: skip
    return (*before, *scaled, *after)


def _of_text(found: list[tuple[int, tuple[Band, ...]]], total: FloatArray) -> Bands:
    """Lay the bands of cross-sections side by side; what lies beyond a kerb begins behind it."""
    rows = []
    for edge, bands in found:
        inside = [number for number, band in enumerate(bands) if band.kind in CARRIAGEWAY]
        at = total[edge] / 2 + sum(
            band.width for band in bands[: inside[0]]
        ) + KERB_WIDTH * (inside[0] > 0)  # fmt: skip
        for number, band in enumerate(bands):
            if number == inside[0] > 0 or number == inside[-1] + 1:
                at -= KERB_WIDTH
            rows.append((edge, KIND[band.kind], band.direction, band.turns, at, at - band.width))
            at -= band.width
    columns = list(zip(*rows, strict=True))
    types = (np.int64, np.uint8, np.int8, np.uint8, np.float64, np.float64)
    return Bands(*(np.array(column, kind) for column, kind in zip(columns, types, strict=True)))


def _walks(table: Any, total: FloatArray, of_text: list[tuple[int, tuple[Band, ...]]]) -> Bands:
    """Return the sidewalks of the edges whose cross-section names none."""
    named = np.zeros(len(total), bool)
    named[[edge for edge, bands in of_text if any(band.kind == "walk" for band in bands)]] = True
    groups = []
    for column, sign in (("sidewalk_left", 1.0), ("sidewalk_right", -1.0)):
        size = table[column].to_numpy(float)
        edge = np.flatnonzero((size > 0) & ~named)
        near = sign * (total[edge] / 2 + KERB_WIDTH)
        far = near + sign * size[edge]
        groups.append((edge, np.maximum(near, far), np.minimum(near, far)))
    edge, left, right = (np.concatenate(column) for column in zip(*groups, strict=True))
    none = np.zeros(len(edge))
    return Bands(edge, np.full(len(edge), KIND["walk"], np.uint8), none.astype(np.int8),
                 none.astype(np.uint8), left, right)  # fmt: skip
