"""Ways for people: footways, cycleways, steps, paths, pedestrian streets; and tracks."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated

from cityx.city.city import City
from cityx.city.layout import Layout
from cityx.protocol import Choice, ObjectName, Range, action
from cityx.road.network.curves import LIMITS, streets_on
from cityx.road.network.street_designs import Curves, Design, Layer, Name, Surface

SPEED = 5.0  # km/h, at a walk
# Class to metres of width and surface, where the caller leaves them open.
USUAL: Mapping[str, tuple[float, str]] = MappingProxyType(
    {
        "footway": (2.0, "paving_stones"),
        "cycleway": (2.5, "asphalt"),
        "path": (1.5, "ground"),
        "steps": (2.0, "paving_stones"),
        "pedestrian": (6.0, "paving_stones"),
        "bridleway": (2.0, "ground"),
        "track": (2.8, "gravel"),
    }
)


@action(
    "road/path-v1",
    limits=[*LIMITS, "Steps are built as slopes."],
    labels=("footpath", "trail", "bicycle", "stairs", "promenade", "sketch", "walk"),
)
def path(
    city: City,
    curves: Curves,
    *,
    curve: Annotated[str | None, ObjectName()] = None,
    kind: Annotated[str, Choice(*USUAL)] = "footway",
    width: Annotated[float | None, Range(0.8, 30.0)] = None,
    surface: Surface = None,
    lit: bool = False,
    layer: Layer = 0,
    name: Name = "",
) -> Layout:
    """Build footways, cycleways, steps, paths, pedestrian streets or tracks on curves.

    Parameters
    ----------
    city
        City whose ways are met.
    curves
        Centrelines, open or closed, metres.
    curve
        The one curve to build on; all when left out.
    kind
        Class of the way, as OpenStreetMap has it.
    width
        Metres.
    surface
        What it is made of.
    lit
        Whether lamps stand along it.
    layer
        Level where it crosses other ways or water: above 0 it passes over on a bridge.
    name
        Name of the way.
    """
    usual_width, usual_surface = USUAL[kind]
    design = Design(
        kind, surface or usual_surface, SPEED, width=width or usual_width, layer=layer, lit=lit,
        name=name,
    )  # fmt: skip
    return streets_on(city, curves, design, curve=curve)
