"""Streets of towns: a carriageway with parked cars, kerbs, verges and sidewalks."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated

from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.city.section import PARKING
from cityx.protocol import Choice, ObjectName, action
from cityx.road.network.curves import LIMITS, streets_on
from cityx.road.network.street_designs import (
    CYCLE_LANE,
    Curves,
    Design,
    Lanes,
    LaneWidth,
    Layer,
    Look,
    Median,
    Name,
    Side,
    Speed,
    Strip,
    Surface,
    Width,
    on_sides,
    widths_of,
)

STYLES: Mapping[str, Look] = MappingProxyType(
    {
        "plain": Look(lanes=2, lane_width=3.0, sidewalk=2.0),
        "terrace": Look(lanes=2, lane_width=2.75, sidewalk=2.2, parking="both", speed_kmh=30.0),
        "avenue": Look(lanes=2, lane_width=3.25, sidewalk=3.0, verge=2.0, parking="both"),
        "boulevard": Look(lanes=4, lane_width=3.25, sidewalk=4.0, verge=2.0, median=5.0),
        "old_town": Look(lanes=2, lane_width=2.5, sidewalk=1.5, surface="sett", speed_kmh=20.0),
        "shared": Look(lanes=2, lane_width=2.75, surface="paving_stones", speed_kmh=10.0),
        "industrial": Look(lanes=2, lane_width=3.75, sidewalk=1.5, surface="concrete"),
    }
)


@action(
    "road/asphalt_street-v1",
    limits=LIMITS,
    labels=("street", "avenue", "boulevard", "residential", "sketch", "parking", "bicycle"),
)
def asphalt_street(
    city: City,
    curves: Curves,
    *,
    curve: Annotated[str | None, ObjectName()] = None,
    kind: Annotated[
        str, Choice("residential", "living_street", "unclassified", "service", "tertiary")
    ] = "residential",
    style: Annotated[str, Choice(*STYLES)] = "plain",
    lanes: Lanes = None,
    lane_width: LaneWidth = None,
    width: Width = None,
    median: Median = None,
    parking: Side = None,
    cycle: Side = None,
    cycle_behind_parking: bool = False,
    verge: Strip = None,
    sidewalk: Strip = None,
    walk_on: Annotated[str, Choice("both", "left", "right")] = "both",
    oneway: bool = False,
    roundabout: bool = False,
    surface: Surface = None,
    speed_kmh: Speed = None,
    layer: Layer = 0,
    name: Name = "",
) -> Layout:
    """Build town streets on curves, joined to each other and to the streets of the city.

    Parameters
    ----------
    city
        City whose streets are met.
    curves
        Centrelines, open or closed, metres.
    curve
        The one curve to build on; all when left out.
    kind
        Class of the street, as OpenStreetMap has it.
    style
        What the street has where the other parameters leave it open.
    lanes
        Lanes of both directions together.
    lane_width
        Width of one lane, metres.
    width
        Carriageway from kerb to kerb with all that lies in it but a median, metres.
    median
        Green or paved strip between two carriageways, metres; 0 for one carriageway.
    parking
        Sides of the curve on which cars park along the kerb.
    cycle
        Sides with a cycle lane.
    cycle_behind_parking
        Whether the cycle lane runs between parked cars and kerb.
    verge
        Green strip between kerb and sidewalk on the sides that have one, metres.
    sidewalk
        Sidewalk behind kerb and verge, metres; 0 for none.
    walk_on
        Sides that have a sidewalk.
    oneway
        Whether traffic runs along the curve only.
    roundabout
        Whether the curve, which must be closed, is a roundabout.
    surface
        What the carriageway is made of.
    speed_kmh
        Speed limit.
    layer
        Level where it crosses other ways or water: above 0 it passes over on a bridge.
    name
        Name of the street.
    """
    look = STYLES[style]
    total, lane = widths_of(look, width, lane_width)
    design = Design(
        kind,
        look.of("surface", surface),
        look.of("speed_kmh", speed_kmh),
        1 if roundabout and lanes is None else look.of("lanes", lanes),
        total,
        lane,
        median=0.0 if median is None and (oneway or roundabout) else look.of("median", median),
        parking=on_sides(look.of("parking", parking), PARKING),
        cycle=on_sides(look.of("cycle", cycle), CYCLE_LANE),
        cycle_behind=cycle_behind_parking,
        sidewalk=on_sides(walk_on, look.of("sidewalk", sidewalk)),
        verge=on_sides(walk_on, look.of("verge", verge)),
        oneway=oneway or roundabout,
        roundabout=roundabout,
        layer=layer,
        name=name,
    )
    return streets_on(city, curves, design, curve=curve)
