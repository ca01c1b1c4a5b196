"""What a street built on a curve looks like: its cross-section, and what in it cannot be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Any

from cityx.city.section import NARROWEST_LANE, Band, carriageway_width
from cityx.protocol import Choice, Port, Range, Text
from cityx.protocol.values import Lines

WIDEST_LANE = 6.0  # metres; a wider one is used as two
WIDEST_STREET = 60.0  # metres between the kerbs, as of a map
CYCLE_LANE = 1.6  # metres; the least beside parked cars is 1.5 in most guides
EXACT = 0.005  # metres within which two ways to say one width agree
SURFACES = ("asphalt", "concrete", "sett", "cobblestone", "paving_stones", "bricks", "gravel",
            "compacted", "ground")  # fmt: skip

# Parameters that the generators have in common; None leaves a thing to the style.
Curves = Annotated[Lines, Port("curves", "line", role="curve")]
Lanes = Annotated[int | None, Range(1, 12)]
LaneWidth = Annotated[float | None, Range(NARROWEST_LANE, WIDEST_LANE)]
Width = Annotated[float | None, Range(2.0, WIDEST_STREET)]
Median = Annotated[float | None, Range(0.0, 20.0)]
Strip = Annotated[float | None, Range(0.0, 15.0)]
Shoulder = Annotated[float | None, Range(0.0, 4.0)]
Side = Annotated[str | None, Choice("none", "left", "right", "both")]
Surface = Annotated[str | None, Choice(*SURFACES)]
Speed = Annotated[float | None, Range(5.0, 130.0)]
Layer = Annotated[int, Range(-3, 3)]
Name = Annotated[str, Text()]

SIDES: Mapping[str, tuple[bool, bool]] = MappingProxyType(
    {"none": (False, False), "left": (True, False), "right": (False, True), "both": (True, True)}
)


@dataclass(frozen=True)
class Design:
    """A street as it is asked for; sides are left and right of the curve as it is drawn.

    Attributes
    ----------
    kind
        Class, as in the table of roads.
    lanes
        Both directions together; 0 for paths and tracks.
    width
        Metres from kerb to kerb, a median left out; 0 where the lanes say it.
    lane_width
        Metres; 0 where the width says it.
    median
        Metres between two carriageways; 0 for a single one.
    parking, cycle, sidewalk, verge, shoulder
        Metres on each side, 0 for none. A verge lies between the kerb and the sidewalk.
    cycle_behind
        Whether cycles ride between the parked cars and the kerb.
    oneway, roundabout
        Traffic along the curve alone; a ring.
    layer
        Level where it crosses other ways: 1 and more pass over, -1 and less under.
    surface, speed_kmh, lit, name
        As in the table of roads.
    """

    kind: str
    surface: str
    speed_kmh: float
    lanes: int = 0
    width: float = 0.0
    lane_width: float = 0.0
    median: float = 0.0
    parking: tuple[float, float] = (0.0, 0.0)
    cycle: tuple[float, float] = (0.0, 0.0)
    cycle_behind: bool = False
    sidewalk: tuple[float, float] = (0.0, 0.0)
    verge: tuple[float, float] = (0.0, 0.0)
    shoulder: tuple[float, float] = (0.0, 0.0)
    oneway: bool = False
    roundabout: bool = False
    layer: int = 0
    lit: bool = True
    name: str = ""


def on_sides(word: str, metres: float) -> tuple[float, float]:
    """Return metres left and right for a word of `SIDES`."""
    left, right = SIDES[word]
    return metres * left, metres * right


@dataclass(frozen=True)
class Look:
    """A style: what a street has where the caller leaves it open; the attributes are a design's."""

    lanes: int
    lane_width: float
    sidewalk: float = 0.0
    verge: float = 0.0
    shoulder: float = 0.0
    median: float = 0.0
    parking: str = "none"
    cycle: str = "none"
    surface: str = "asphalt"
    speed_kmh: float = 50.0

    def of(self, name: str, given: Any) -> Any:
        """Return what is given, or what the style has of that name."""
        return getattr(self, name) if given is None else given


def widths_of(look: Look, width: float | None, lane: float | None) -> tuple[float, float]:
    """Return the width and the lane width of a design: what is given, or the style's lanes."""
    if width is None:
        return 0.0, look.of("lane_width", lane)
    return width, lane or 0.0


def faults_of(design: Design) -> list[str]:
    """Return every contradiction of a design as a sentence."""
    found = []
    lane = lane_width(design)
    if design.lanes and not NARROWEST_LANE <= lane <= WIDEST_LANE:
        found.append(
            f"{design.lanes} lanes would be {lane:.2f} m wide each, not {NARROWEST_LANE:g} to "
            f"{WIDEST_LANE:g} m: change width, lanes or what lies beside them."
        )
    if design.width and design.lane_width and abs(lane - design.lane_width) > EXACT:
        found.append(
            f"A width of {design.width:g} m leaves {lane:.2f} m to each of {design.lanes} lanes, "
            f"not lane_width = {design.lane_width:g}."
        )
    total = sum(_beside(design)) + design.lanes * lane
    if total > WIDEST_STREET:
        found.append(f"{total:.1f} m between the kerbs are more than {WIDEST_STREET:g} m.")
    if design.median and design.oneway:
        found.append("A one-way street has no second carriageway that a median could part.")
    elif design.median and design.lanes < 2:
        found.append(f"A median parts two carriageways, but lanes = {design.lanes}.")
    elif design.median and design.lanes % 2:
        found.append(f"A median parts carriageways of equal lanes, but lanes = {design.lanes}.")
    if design.roundabout and (design.median or any(design.parking)):
        found.append("A roundabout has neither a median nor parked cars.")
    return found


def _beside(design: Design) -> tuple[float, float]:
    """Metres between the outermost lanes and the kerbs."""
    sides = zip(design.parking, design.cycle, design.shoulder, strict=True)
    left, right = (sum(side) for side in sides)
    return left, right


def lane_width(design: Design) -> float:
    """Metres of one lane: what is left of the width, or what is said of lanes."""
    if not design.width or not design.lanes:
        return design.lane_width
    return (design.width - sum(_beside(design))) / design.lanes


def carriageways(design: Design, *, left_hand: bool) -> tuple[tuple[Band, ...], ...]:
    """Return the cross-section of each carriageway, the left one first, kerbs to backs of walks.

    Bands run from left to right along the curve. Of a pair parted by a median the left one is that
    of the traffic against the curve where one keeps to the right.
    """
    lane = lane_width(design)
    against = 0 if design.oneway else design.lanes // 2
    ahead = [Band("drive", lane, 1)] * (design.lanes - against)
    back = [Band("drive", lane, -1)] * against
    if design.lanes == 1 and not design.oneway:
        ahead = [Band("drive", lane)]
    inner = [ahead, back] if left_hand else [back, ahead]
    left, right = _side(design, 0, left_hand), _side(design, 1, left_hand)
    if not design.median:
        return ((*left, *inner[0], *inner[1], *reversed(right)),)
    return (*left, *inner[0]), (*inner[1], *reversed(right))


def _side(design: Design, side: int, left_hand: bool) -> list[Band]:
    """Bands from the back of the walk to the outermost lane of one side."""
    along = 1 if design.oneway or (side == 0) == left_hand else -1
    cycle = Band("cycle", design.cycle[side], along)
    parking = Band("parking", design.parking[side])
    edge = [cycle, parking] if design.cycle_behind else [parking, cycle]
    bands = [
        Band("walk", design.sidewalk[side]),
        Band("verge", design.verge[side]),
        Band("shoulder", design.shoulder[side]),
        *edge,
    ]
    return [band for band in bands if band.width > 0]


def turned(bands: tuple[Band, ...]) -> tuple[Band, ...]:
    """Return a cross-section as one sees it the other way along the road."""
    return tuple(
        Band(band.kind, band.width, -band.direction, band.turns) for band in reversed(bands)
    )


def row_of(bands: tuple[Band, ...]) -> dict[str, object]:
    """Return what a cross-section says in the columns of the table of roads."""
    lanes = [band for band in bands if band.kind in ("drive", "bus")]
    middle = [number for number, band in enumerate(bands) if band in lanes]
    left, right = bands[: middle[0]], bands[middle[-1] + 1 :]

    def sum_of(side: tuple[Band, ...], *kinds: str) -> float:
        return float(sum(band.width for band in side if band.kind in kinds))

    walks = [any(band.kind == "walk" for band in side) for side in (left, right)]
    return {
        "lanes": len(lanes),
        "lanes_forward": max(1, sum(band.direction >= 0 for band in lanes)),
        "lane_width": lanes[0].width,
        "width": carriageway_width(bands),
        # What is behind the kerb is a walk as a whole; the verge is a strip of it.
        "sidewalk_left": sum_of(left, "walk", "verge") * walks[0],
        "sidewalk_right": sum_of(right, "walk", "verge") * walks[1],
        "parking_left": sum_of(left, "parking") > 0,
        "parking_right": sum_of(right, "parking") > 0,
    }
