"""How countries paint their roads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cityx.city.frame import Frame

# (south, west, north, east) in degrees.
YELLOW_CENTRES = ((7.0, -170.0, 72.0, -50.0), (-56.0, -82.0, 13.0, -34.0))  # the Americas
YELLOW_TACTILE = (*YELLOW_CENTRES, (-48.0, 60.0, 46.0, 180.0))  # and Asia, Australia
STOPS = YELLOW_CENTRES  # minor roads have stop signs
TEETH = (
    (35.0, -10.0, 48.0, 45.0), (48.0, -5.5, 51.2, 8.0), (50.7, 3.3, 53.6, 7.2),
    (54.5, 8.0, 71.5, 31.0), (46.8, 9.5, 49.1, 17.2),
)  # fmt: skip
RED_CYCLEWAYS = ((49.4, 2.5, 53.6, 7.2), (54.5, 8.0, 57.8, 12.7))  # Low Countries, Denmark


@dataclass(frozen=True)
class Painting:
    """What differs from country to country.

    Attributes
    ----------
    yellow_centre
        Whether the line between the two directions is yellow.
    give_way
        "teeth" (triangles), "dashes" (a broken line) or "stop" (a stop line).
    red_cycleways
        Whether cycle lanes are coloured.
    yellow_tactile
        Whether the ribs before crossings are yellow.
    """

    yellow_centre: bool = False
    give_way: str = "dashes"
    red_cycleways: bool = False
    yellow_tactile: bool = False


def painting_of(frame: Frame) -> Painting:
    """Return what is usual at a place; boxes decide, so it may be wrong near a border."""

    def within(boxes: tuple[tuple[float, float, float, float], ...]) -> bool:
        return any(s <= frame.latitude <= n and w <= frame.longitude <= e for s, w, n, e in boxes)

    way = "stop" if within(STOPS) else "teeth" if within(TEETH) else "dashes"
    return Painting(within(YELLOW_CENTRES), way, within(RED_CYCLEWAYS), within(YELLOW_TACTILE))
