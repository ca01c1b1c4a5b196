"""Roads between quarters and towns: two lanes and more, with shoulders, verges, cycle lanes."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated

from cityx.city.city import City
from cityx.city.layout import Layout
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
    Shoulder,
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
        "urban": Look(lanes=2, lane_width=3.25, sidewalk=2.5, cycle="both"),
        "green": Look(lanes=2, lane_width=3.5, sidewalk=2.5, verge=2.5),
        "dual": Look(lanes=4, lane_width=3.25, sidewalk=2.5, median=3.0),
        "rural": Look(lanes=2, lane_width=3.5, shoulder=0.75, verge=2.0, speed_kmh=80.0),
    }
)


@action(
    "road/secondary_road-v1",
    limits=LIMITS,
    labels=("road", "main", "arterial", "country", "rural", "sketch", "shoulder", "verge"),
)
def secondary_road(
    city: City,
    curves: Curves,
    *,
    curve: Annotated[str | None, ObjectName()] = None,
    kind: Annotated[str, Choice("secondary", "primary", "tertiary")] = "secondary",
    style: Annotated[str, Choice(*STYLES)] = "urban",
    lanes: Lanes = None,
    lane_width: LaneWidth = None,
    width: Width = None,
    median: Median = None,
    shoulder: Shoulder = None,
    cycle: Side = None,
    verge: Strip = None,
    sidewalk: Strip = None,
    roundabout: bool = False,
    surface: Surface = None,
    speed_kmh: Speed = None,
    layer: Layer = 0,
    name: Name = "",
) -> Layout:
    """Build secondary and primary roads on curves, joined to each other and to the city's streets.

    Parameters
    ----------
    city
        City whose streets are met.
    curves
        Centrelines, open or closed, metres.
    curve
        The one curve to build on; all when left out.
    kind
        Class of the road, as OpenStreetMap has it.
    style
        What the road has where the other parameters leave it open.
    lanes
        Lanes of both directions together.
    lane_width
        Width of one lane, metres.
    width
        Carriageway with shoulders and cycle lanes but without a median, metres.
    median
        Strip between two carriageways, metres; 0 for one carriageway.
    shoulder
        Paved strip beside the outer lanes, metres.
    cycle
        Sides with a cycle lane.
    verge
        Green strip beside the carriageway, before the sidewalk where there is one, metres.
    sidewalk
        Sidewalk on both sides, metres; 0 for none.
    roundabout
        Whether the curve, which must be closed, is a roundabout.
    surface
        What the carriageway is made of.
    speed_kmh
        Speed limit.
    layer
        Level where it crosses other ways or water: above 0 it passes over on a bridge.
    name
        Name of the road.
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
        median=0.0 if median is None and roundabout else look.of("median", median),
        cycle=on_sides(look.of("cycle", cycle), CYCLE_LANE),
        sidewalk=(look.of("sidewalk", sidewalk),) * 2,
        verge=(look.of("verge", verge),) * 2,
        shoulder=(look.of("shoulder", shoulder),) * 2,
        oneway=roundabout,
        roundabout=roundabout,
        layer=layer,
        lit=style != "rural",
        name=name,
    )
    return streets_on(city, curves, design, curve=curve)
