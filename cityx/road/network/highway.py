"""Motorways and trunk roads: two carriageways with shoulders, parted by a median."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated

from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.protocol import Choice, ObjectName, action
from cityx.road.network.curves import LIMITS, streets_on
from cityx.road.network.street_designs import (
    Curves,
    Design,
    Lanes,
    LaneWidth,
    Layer,
    Look,
    Median,
    Name,
    Shoulder,
    Speed,
    Strip,
    Surface,
    Width,
    widths_of,
)

STYLES: Mapping[str, Look] = MappingProxyType(
    {
        "motorway": Look(
            lanes=4, lane_width=3.6, shoulder=2.5, verge=3.0, median=3.0, speed_kmh=120.0
        ),
        "parkway": Look(
            lanes=4, lane_width=3.5, shoulder=1.0, verge=6.0, median=12.0, speed_kmh=90.0
        ),
        "expressway": Look(
            lanes=2, lane_width=3.5, shoulder=1.5, verge=3.0, speed_kmh=100.0
        ),
        "concrete": Look(
            lanes=6, lane_width=3.6, shoulder=3.0, verge=2.0, median=2.0, speed_kmh=110.0,
            surface="concrete",
        ),
    }
)  # fmt: skip


@action(
    "road/highway-v1",
    limits=LIMITS,
    labels=("motorway", "freeway", "expressway", "dual", "carriageway", "sketch", "shoulder"),
)
def highway(
    city: City,
    curves: Curves,
    *,
    curve: Annotated[str | None, ObjectName()] = None,
    kind: Annotated[str, Choice("motorway", "trunk")] = "motorway",
    style: Annotated[str, Choice(*STYLES)] = "motorway",
    lanes: Lanes = None,
    lane_width: LaneWidth = None,
    width: Width = None,
    median: Median = None,
    shoulder: Shoulder = None,
    verge: Strip = None,
    oneway: bool = False,
    surface: Surface = None,
    speed_kmh: Speed = None,
    lit: bool = False,
    layer: Layer = 0,
    name: Name = "",
) -> Layout:
    """Build highways on curves, of two carriageways unless the median is 0 or they are one-way.

    Parameters
    ----------
    city
        City whose streets are met.
    curves
        Middles of the highways, open or closed, metres.
    curve
        The one curve to build on; all when left out.
    kind
        Class of the road, as OpenStreetMap has it.
    style
        What the highway has where the other parameters leave it open.
    lanes
        Lanes of both directions together.
    lane_width
        Width of one lane, metres.
    width
        All carriageways with their shoulders, without the median, metres.
    median
        Strip between the carriageways, metres; 0 for one carriageway.
    shoulder
        Paved strip at the outer side of each carriageway, metres.
    verge
        Green strip beside the outer shoulder, metres.
    oneway
        Whether there is one carriageway along the curve only, as on a ramp.
    surface
        What the carriageway is made of.
    speed_kmh
        Speed limit.
    lit
        Whether lamps stand along it.
    layer
        Level where it crosses other ways or water: above 0 it passes over on a bridge.
    name
        Name of the highway.
    """
    look = STYLES[style]
    total, lane = widths_of(look, width, lane_width)
    design = Design(
        kind,
        look.of("surface", surface),
        look.of("speed_kmh", speed_kmh),
        look.of("lanes", lanes),
        total,
        lane,
        median=0.0 if median is None and oneway else look.of("median", median),
        verge=(look.of("verge", verge),) * 2,
        shoulder=(look.of("shoulder", shoulder),) * 2,
        oneway=oneway,
        layer=layer,
        lit=lit,
        name=name,
    )
    return streets_on(city, curves, design, curve=curve)
