"""The side of the road on which a city drives."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Annotated

from cityx.checks.predicates.words import DRIVEN
from cityx.city import City
from cityx.city.asked_goals import with_goal
from cityx.places.countries import country_at
from cityx.places.profile import TOP
from cityx.places.profiles import keeps_left
from cityx.protocol import Choice, action


@action(
    "background/driving_side-v1",
    limits=["Signs, paint and vehicles stay those of the country."],
    labels=("left-hand traffic", "drive on the left", "drive on the right", "driving side"),
    serves=tuple(f"traffic.side={side}" for side in DRIVEN),
    binds={"side": "traffic.side"},
)
def driving_side(city: City, *, side: Annotated[str, Choice(*DRIVEN)] = "left") -> City:
    """Let traffic keep to one side, whatever the country does.

    Parameters
    ----------
    city
        City before its layout: bands of its streets lie as one drives.
    side
        The side.
    """
    frame = city.frame
    if keeps_left(frame) != (side == "left"):
        usual = frame.place or country_at(frame.latitude, frame.longitude).lower() or TOP
        said = json.loads(usual) if usual.startswith("{") else {"inherits": usual}
        place = json.dumps({**said, "drive": side}, ensure_ascii=False, separators=(",", ":"))
        city = replace(city, frame=replace(frame, place=place))
    return with_goal(city, f"traffic keeps {side}", f"road.side == {side}")
