"""Railways and tramways: one track and more, side by side."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated

from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.protocol import Choice, ObjectName, Range, action
from cityx.road.network.curves import LIMITS, streets_on
from cityx.road.network.street_designs import Curves, Design, Layer, Name

# Class to metres from track to track, of bed, its surface and km/h (EN 15273: 4 m and more for
# trains; BOStrab: 2.65 m cars need 3 m).
USUAL: Mapping[str, tuple[float, float, str, float]] = MappingProxyType(
    {
        "rail": (4.0, 3.2, "ballast", 120.0),
        "light_rail": (3.5, 3.0, "ballast", 80.0),
        "subway": (3.5, 3.0, "ballast", 70.0),
        "tram": (3.0, 2.6, "asphalt", 50.0),
    }
)


@action(
    "road/railway-v1",
    limits=[*LIMITS, "Switches are not built: tracks that meet cross."],
    labels=("train", "tracks", "tram", "tramway", "streetcar", "sketch", "metro"),
)
def railway(
    city: City,
    curves: Curves,
    *,
    curve: Annotated[str | None, ObjectName()] = None,
    kind: Annotated[str, Choice(*USUAL)] = "rail",
    tracks: Annotated[int, Range(1, 12)] = 2,
    spacing: Annotated[float | None, Range(2.8, 12.0)] = None,
    layer: Layer = 0,
    name: Name = "",
) -> Layout:
    """Build railway or tram tracks on curves; rails of trams lie flush in the streets they follow.

    Parameters
    ----------
    city
        City whose ways are met.
    curves
        Middles of the tracks, open or closed, metres.
    curve
        The one curve to build on; all when left out.
    kind
        Class of the railway, as OpenStreetMap has it.
    tracks
        Tracks side by side.
    spacing
        Metres from track to track.
    layer
        Level where it crosses other ways or water: above 0 it passes over on a bridge.
    name
        Name of the line.
    """
    apart, bed, surface, speed = USUAL[kind]
    design = Design(kind, surface, speed, width=bed, layer=layer, lit=False, name=name)
    return streets_on(city, curves, design, curve=curve, tracks=tracks, spacing=spacing or apart)
