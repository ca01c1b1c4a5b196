"""How countries paint their roads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from cityx.system.tables import Between

Amount = Annotated[float, Between(0.0)]


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
    depth: Amount = 0.6
    gap: Amount = 0.0
    strip: Amount = 0.0


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
    edge_line: Amount = 0.12
    dashes: tuple[Amount, Amount] = (3.0, 3.0)
    closing: bool = True
    stop_line: Amount = 0.4
    paved_mouths: bool = False
    coated_crossroads: bool = False
    feathers: bool = False
