"""How countries paint their roads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cityx.city.frame import Frame

Boxes = tuple[tuple[float, float, float, float], ...]  # (south, west, north, east) in degrees

YELLOW_CENTRES: Boxes = ((7.0, -170.0, 72.0, -50.0), (-56.0, -82.0, 13.0, -34.0))  # the Americas
YELLOW_TACTILE: Boxes = (*YELLOW_CENTRES, (-48.0, 60.0, 46.0, 180.0))  # and Asia, Australia
NORTH_AMERICA: Boxes = ((32.5, -170.0, 72.0, -52.0), (24.5, -98.0, 32.5, -79.0))
BRITISH_ISLES: Boxes = ((50.0, -11.0, 61.0, 1.5), (51.0, 1.2, 53.0, 1.8))
JAPAN: Boxes = ((24.0, 122.9, 34.0, 132.0), (31.0, 130.5, 45.6, 146.0))
TEETH: Boxes = (
    (35.0, -10.0, 48.0, 45.0), (48.0, -5.5, 51.2, 8.0), (50.7, 3.3, 53.6, 7.2),
    (54.5, 8.0, 71.5, 31.0), (46.8, 9.5, 49.1, 17.2),
)  # fmt: skip
GERMANY: Boxes = (
    (47.6, 7.6, 49.1, 13.0), (49.1, 6.4, 51.0, 12.2), (51.0, 6.1, 53.3, 14.6),
    (53.3, 7.0, 54.8, 14.3),
)  # fmt: skip
# Where crossings that neither signals nor signs rule seldom have bars.
FEW_ZEBRAS: Boxes = (*GERMANY, *BRITISH_ISLES)
SIGNAL_CROSSINGS: tuple[tuple[str, Boxes], ...] = (("studs", BRITISH_ISLES), ("lines", GERMANY))
RED_CYCLEWAYS: Boxes = ((49.4, 2.5, 53.6, 7.2), (54.5, 8.0, 57.8, 12.7))  # Low Countries, Denmark
# The first that holds the place wins; minor roads of the Americas and of Japan have stop signs.
GIVE_WAY: tuple[tuple[str, Boxes], ...] = (
    ("double dashes", BRITISH_ISLES),
    ("stop", (*YELLOW_CENTRES, *JAPAN)),
    ("teeth", TEETH),
)
STOP_WORDS: tuple[tuple[str, Boxes], ...] = (("STOP", NORTH_AMERICA), ("止まれ", JAPAN))


@dataclass(frozen=True)
class Ribs:
    """Tactile paving before crossings.

    Attributes
    ----------
    painted, plain, mouth
        Its surface before crossings with paint, before those without, and where a walk goes on
        across the mouth of a street; "" for none.
    depth
        Metres along the way across.
    gap
        Metres between the kerb and them.
    strip
        Metres of a strip that leads to crossings with paint across the walk, 0 for none.

    References
    ----------
    Department for Transport, "Guidance on the use of tactile paving surfaces", 2021: blisters 0.8 m
    deep, red before crossings under control, buff elsewhere, and a stem of 1.2 m to the back.
    JIS T 9251 and guideline on guiding blocks, 1985: two rows of tiles, 0.3 m behind the face of
    the kerb.
    ADA 2010, 705: 0.61 m of domes at every ramp of a kerb.
    DIN 32984: ribs along the way across where signals rule it, found by a strip across the walk.
    """

    painted: str = "tactile_pale"
    plain: str = "tactile_pale"
    mouth: str = ""
    depth: float = 0.6
    gap: float = 0.0
    strip: float = 0.0


# The first that holds the place wins.
RIBS: tuple[tuple[Ribs, Boxes], ...] = (
    (Ribs("tactile_red", "tactile_buff", "tactile_buff", depth=0.8, strip=1.2), BRITISH_ISLES),
    (Ribs("tactile_pale", "", strip=0.6), GERMANY),
    (Ribs("tactile", "tactile", "tactile"), NORTH_AMERICA),
    (Ribs("tactile", "tactile", gap=0.15), YELLOW_TACTILE),
)
TURN_GUIDES: tuple[tuple[str, Boxes], ...] = (
    ("both", JAPAN),
    ("outer", (*GERMANY, *TEETH, *RED_CYCLEWAYS, *NORTH_AMERICA)),
)


@dataclass(frozen=True)
class Painting:
    """What differs from country to country.

    Attributes
    ----------
    yellow_centre
        Whether the line between the two directions is yellow.
    give_way
        "teeth" (triangles), "dashes" (a broken line), "double dashes" or "stop" (a stop line).
    red_cycleways
        Whether cycle lanes are coloured.
    ribs
        What blind people feel before crossings.
    stop_word
        What is written behind the stop line of a minor road, or "".
    stems
        Whether a street that ends at another of its class gives way to it by a line.
    yellow_kerbs
        Whether lines along the kerb tell where nobody may park.
    boxes
        Whether junctions under signals are hatched.
    edge_lines
        Whether streets between kerbs have lines along their sides.
    zebras
        Whether crossings have bars that neither signals nor the map rule.
    signal_crossing
        What marks crossings under signals: "bars", two broken "lines" or rows of "studs".
    red_furten
        Whether the way of cycle lanes across junctions is coloured.
    one_way_arrows
        Whether arrows tell on the carriageway that a street is one way.
    beacons
        Whether poles with amber globes stand beside zebras, rather than signs before them.
    turn_guides
        Which sides of ways have lines across large junctions: "both", the "outer" of turns, or "".
    centre_marks
        Whether the middles of junctions have marks.
    diamonds
        Whether lozenges tell of zebras ahead.
    limits
        Whether yellow figures on the lanes tell speed limits.
    gutters
        Whether stones lie along kerbs, rather than asphalt up to them.
    parking
        What marks lanes of parked cars on asphalt: lines between "stalls", a broken "outline" of
        each row, or one "line" along it.
    edge_line
        Metres of breadth of the lines along the sides of streets between kerbs.
    dashes
        Metres of dash and gap of lines between lanes between kerbs.
    closing
        Whether lines between lanes are unbroken before junctions.
    stop_line
        Metres of breadth of stop lines.
    paved_mouths
        Whether setts lead walks across the mouths of side streets in town.
    coated_crossroads
        Whether crossroads of minor streets are coloured.
    feathers
        Whether arrowheads tell where bicycles ride on classified roads without a lane for them.

    References
    ----------
    TSRGD 2016, diagrams 1001, 1005 and 1008: 2 m dashes 4 m apart, stop lines of 0.2 to 0.3 m.
    RMS-1, 1993: in towns 3 m dashes 6 m apart, stop lines of 0.5 m.
    """

    yellow_centre: bool = False
    give_way: str = "dashes"
    red_cycleways: bool = False
    ribs: Ribs = Ribs()
    stop_word: str = ""
    stems: bool = False
    yellow_kerbs: bool = False
    boxes: bool = False
    edge_lines: bool = False
    zebras: bool = True
    signal_crossing: str = "bars"
    red_furten: bool = False
    one_way_arrows: bool = False
    beacons: bool = False
    turn_guides: str = ""
    centre_marks: bool = False
    diamonds: bool = False
    limits: bool = False
    gutters: bool = True
    parking: str = "stalls"
    edge_line: float = 0.12
    dashes: tuple[float, float] = (3.0, 3.0)
    closing: bool = True
    stop_line: float = 0.4
    paved_mouths: bool = False
    coated_crossroads: bool = False
    feathers: bool = False


def painting_of(frame: Frame) -> Painting:
    """Return what is usual at a place; boxes decide, so it may be wrong near a border."""

    def within(boxes: Boxes) -> bool:
        return any(s <= frame.latitude <= n and w <= frame.longitude <= e for s, w, n, e in boxes)

    def first(table: tuple[tuple[str, Boxes], ...], usual: str) -> str:
        return next((name for name, boxes in table if within(boxes)), usual)

    british, german = within(BRITISH_ISLES), within(GERMANY)
    return Painting(
        yellow_centre=within(YELLOW_CENTRES),
        give_way=first(GIVE_WAY, "dashes"),
        red_cycleways=within(RED_CYCLEWAYS),
        ribs=next((ribs for ribs, boxes in RIBS if within(boxes)), Ribs()),
        stop_word=first(STOP_WORDS, ""),
        stems=british or within((*NORTH_AMERICA, *JAPAN)),
        yellow_kerbs=british,
        boxes=british,
        edge_lines=within(JAPAN),
        beacons=british,
        zebras=not within(FEW_ZEBRAS),
        signal_crossing=first(SIGNAL_CROSSINGS, "bars"),
        red_furten=within((*GERMANY, *RED_CYCLEWAYS)),
        one_way_arrows=british or within(JAPAN),
        turn_guides="" if british else first(TURN_GUIDES, ""),
        centre_marks=within(JAPAN),
        diamonds=within(JAPAN),
        limits=within(JAPAN),
        gutters=not british,
        parking="outline" if british else "line" if german else "stalls",
        edge_line=0.15 if within(JAPAN) else 0.12,
        dashes=(2.0, 4.0) if british else (3.0, 6.0) if german else (3.0, 3.0),
        closing=not british,
        stop_line=0.3 if british else 0.5 if german else 0.4,
        paved_mouths=british,
        coated_crossroads=within(JAPAN),
        feathers=within(JAPAN),
    )
