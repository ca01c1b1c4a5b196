"""Changes of cross-sections: the bands of a street that exists, made wider, fewer or others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from cityx.city.section import (
    CARRIAGEWAY,
    NARROWEST_LANE,
    PARKING,
    Band,
    carriageway_width,
    read_section,
)
from cityx.errors import UsageError
from cityx.places.profiles import usual_lane
from cityx.road.network.street_designs import CYCLE_LANE, SIDES, WIDEST_LANE

Bands = tuple[Band, ...]
KEPT_LANE = (
    2.75  # metres of a lane that gives way to what is painted beside it; two cars still pass
)
MOVING = ("drive", "bus")
BESIDE = {"parking": PARKING, "cycle": CYCLE_LANE}  # metres of what lies beside the lanes


def bands_of_row(row: Any, *, left_hand: bool) -> Bands:
    """Return the carriageway of a row of the table of roads, from left to right.

    Parameters
    ----------
    row
        The row; where it has no cross-section its columns say it.
    left_hand
        Whether traffic keeps to the left.
    """
    if row["section"]:
        return tuple(band for band in read_section(row["section"]) if band.kind in CARRIAGEWAY)
    sides = [bool(row[f"parking_{side}"]) for side in ("left", "right")]
    count = max(int(row["lanes"]), 1)
    width = (float(row["width"]) - PARKING * sum(sides)) / count
    forward = count if row["oneway"] else min(max(int(row["lanes_forward"]), 1), count)
    lanes = _directed([Band("drive", width)] * count, forward, left_hand=left_hand)
    ends = [[Band("parking", PARKING)] * side for side in sides]
    return (*ends[0], *lanes, *ends[1])


def _directed(lanes: Sequence[Band], forward: int, *, left_hand: bool) -> list[Band]:
    """Give lanes their directions: those along the road lie on the side one drives on."""
    if len(lanes) == 1 and forward < 1:
        return [replace(lanes[0], direction=0)]
    back = len(lanes) - forward
    signs = [1] * forward + [-1] * back if left_hand else [-1] * back + [1] * forward
    return [replace(lane, direction=sign) for lane, sign in zip(lanes, signs, strict=True)]


def widened(bands: Bands, width: float, *, left_hand: bool) -> Bands:
    """Return a cross-section of another width between the kerbs.

    What lies beside the lanes keeps its width; lanes that would get too narrow or too wide become
    fewer or more.

    Raises
    ------
    UsageError
        If what lies beside the lanes leaves no lane.
    """
    beside = sum(band.width for band in bands if band.kind not in MOVING)
    room = width - beside
    if room < NARROWEST_LANE:
        raise UsageError(
            f"{width:g} m between the kerbs leave {max(room, 0.0):.1f} m to traffic, "
            f"{NARROWEST_LANE:g} m are the least; parked cars, cycle lanes and medians take "
            f"{beside:.1f} m of them."
        )
    lanes = [band for band in bands if band.kind in MOVING]
    count = len(lanes)
    if room / count < NARROWEST_LANE:
        count = int(room // NARROWEST_LANE)
    elif room / count > WIDEST_LANE:
        count = round(room / usual_lane())
    made = bands if count == len(lanes) else with_lanes(bands, count, left_hand=left_hand)
    each = room / count
    return tuple(replace(band, width=each) if band.kind in MOVING else band for band in made)


def with_lanes(bands: Bands, count: int, *, left_hand: bool) -> Bands:
    """Return a cross-section with a number of lanes, both directions together, each as wide as now.

    A single lane of a street that was driven both ways is shared by both.
    """
    lanes = [band for band in bands if band.kind in MOVING]
    width = max(min(lane.width for lane in lanes), NARROWEST_LANE)
    oneway = all(lane.direction > 0 for lane in lanes)
    forward = count if oneway else count - count // 2 if count > 1 else 0
    made = _directed([Band("drive", width)] * count, forward, left_hand=left_hand)
    return _with_middle(bands, made)


def directed(bands: Bands, *, oneway: bool, left_hand: bool) -> Bands:
    """Return a cross-section that is driven one way, along the road, or both."""
    lanes = [replace(band, turns=0) for band in bands if band.kind in MOVING]
    count = len(lanes)
    forward = count if oneway else count - count // 2 if count > 1 else 0
    return _with_middle(bands, _directed(lanes, forward, left_hand=left_hand))


def _with_middle(bands: Bands, lanes: Sequence[Band]) -> Bands:
    """Put other lanes in the place of the lanes of a cross-section; a median stays between them."""
    at = [number for number, band in enumerate(bands) if band.kind in MOVING]
    inner = [band for band in bands[at[0] : at[-1] + 1] if band.kind == "median"]
    half = sum(lane.direction == lanes[0].direction for lane in lanes)
    parted = inner[:1] if half < len(lanes) else []
    return (*bands[: at[0]], *lanes[:half], *parted, *lanes[half:], *bands[at[-1] + 1 :])


def with_strips(bands: Bands, kind: str, sides: str, *, left_hand: bool) -> Bands:
    """Return a cross-section with parking or cycle lanes on some sides, and on no other.

    The kerbs stay while lanes keep `KEPT_LANE`; beyond that they move apart. What is taken away
    leaves its room to the lanes.

    Parameters
    ----------
    bands
        The carriageway.
    kind
        "parking" or "cycle".
    sides
        "none", "left", "right" or "both", as seen along the road.
    left_hand
        Whether traffic keeps to the left.
    """
    at = [number for number, band in enumerate(bands) if band.kind in MOVING]
    left, lanes, right = bands[: at[0]], bands[at[0] : at[-1] + 1], bands[at[-1] + 1 :]
    oneway = all(band.direction > 0 for band in lanes if band.kind in MOVING)
    outer = []
    for side, (strips, wanted) in enumerate(zip((left, right), SIDES[sides], strict=True)):
        kept = [band for band in strips if band.kind != kind]
        if wanted:
            along = 1 if oneway or (side == 0) == left_hand else -1
            strip = Band(kind, BESIDE[kind], along if kind == "cycle" else 0)
            before = [band for band in strips if band.kind == kind]
            strip = before[0] if before else strip
            # Cars park at the kerb, cycles ride between them and the lanes.
            inner = kind == "cycle"
            kept = [*kept, strip] if inner == (side == 0) else [strip, *kept]
        outer.append(kept)
    joined = (*outer[0], *lanes, *outer[1])
    beside = sum(band.width for band in joined if band.kind not in MOVING)
    count = sum(band.kind in MOVING for band in lanes)
    now = [band.width for band in lanes if band.kind in MOVING]
    least = sum(min(width, KEPT_LANE) for width in now)
    room = max(carriageway_width(bands) - beside, least)
    return tuple(
        replace(band, width=room / count) if band.kind in MOVING else band for band in joined
    )
