"""The lamps of the streets: on or off, whatever the hour."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from cityx.city import City
from cityx.protocol import Port, Serves, action


@action(
    "edit/lamps-v1",
    limits=["A new time or weather switches the lamps again, as it does in a town."],
    requires=("layout",),
    takes=(Port("environment", "scene_layout", role="weather"),),
    gives=(Port("environment", "scene_layout", role="weather"),),
    serves=(
        Serves("edit=set_lights", "lights=on", "!objects", state="on"),
        Serves("edit=set_lights", "lights=off", "!objects", state="off"),
    ),
    labels=("street lamps", "lamps off", "lamps on", "lights off"),
)
def lamps(city: City, *, state: Literal["on", "off"]) -> City:
    """Switch all street lamps on or off; windows stay as the hour lights them.

    Parameters
    ----------
    city
        City; nothing of it but its light changes.
    state
        On or off.
    """
    lit = float(state == "on")
    if city.environment.lamps == lit:
        return replace(city, notes=(*city.notes, f"The lamps are {state} already."))
    return replace(city, environment=replace(city.environment, lamps=lit))
