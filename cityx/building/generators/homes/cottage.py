"""Cottages: steep roofs on low walls, small leaded windows, timber gables, an outshut."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated, Any

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import RED_TILES, REDS, SLATES, STOCK, STONES
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot
from cityx.city.city import City
from cityx.geometry.parcels.lots import Lot, lot_of, masses_on, slope_of
from cityx.protocol import ObjectName, Range, action

LEAST = 5.4  # metres of cottage; a narrower one has neither outshut nor wing
LOWEST = 1.95  # metres under the eave of an outshut
WINGED = 0.2  # share of its box that a plan must lack to have a ridge for each wing


def masses(
    plot: Plot, *, outshut: float = 0.6, wing: float = 0.4, timber: float = 0.4
) -> tuple[Mass, ...]:
    """Lean an outshut against the back or a gable, or turn a wing to the street."""
    turn, winged, leaning, where, deep, framed = plot.draws("cottage", 6)
    zone, low = ("timber", "timber_low") if framed < timber else ("", "low")
    body = replace(plot.body, zone=zone)
    lot = lot_of(plot, lengthwise=True)
    if plot.rise <= 0 or not lot.boxy or lot.depth < LEAST:
        return (body,)
    side = 1.0 if turn < 0.5 else -1.0
    slope = slope_of(plot, lot)
    if winged < wing and lot.length > 8.5 and lot.depth > 6.5:
        return tuple(_winged(lot, plot, side, slope, zone, low)) or (body,)
    if leaning >= outshut:
        return (body,)
    eave = plot.height - plot.rise
    if where < 0.45 and lot.length > LEAST + 2.4:
        cut = 1.9 + 0.7 * deep
        rise = min(0.55 * cut, eave + 0.5 * plot.rise - LOWEST)
        rest = (-lot.x + cut, -lot.y, lot.x, lot.y)
        strip = (-lot.x, -lot.y, -lot.x + cut, lot.y)
        down = lot.compass(-side, 0.0)
        boxes = [rest, strip] if side > 0 else [(-b[2], b[1], -b[0], b[3]) for b in (rest, strip)]
    else:
        cut = min(1.6 + 0.6 * deep, 0.3 * lot.depth)
        rise = min(1.1 * cut, eave - 0.1 - LOWEST)
        boxes = [(-lot.x, -lot.y + cut, lot.x, lot.y), (-lot.x, -lot.y, lot.x, -lot.y + cut)]
        down = lot.compass(0.0, -1.0)
    if rise < 0.3:
        return (body,)
    high = LOWEST + rise
    width = min(boxes[0][2] - boxes[0][0], boxes[0][3] - boxes[0][1])
    up = min(slope * width / 2, plot.rise)
    main = lot.masses(boxes[:1], low=0.0, high=eave + up, zone=zone, roof=plot.roof, rise=up)
    lean = lot.masses(boxes[1:], low=0.0, high=high, zone=low, roof="skillion", rise=rise,
                      direction=down)  # fmt: skip
    return (*main, *lean)


def _winged(lot: Lot, plot: Plot, side: float, slope: float, zone: str, low: str) -> list[Mass]:
    """Build an L with a ridge for each wing; a low porch stands in its inner corner."""
    reach = 0.46 * lot.length
    cut = WINGED * lot.length * lot.depth / (lot.length - reach)
    eave = plot.height - plot.rise
    rise = min(0.5 * cut, eave - 0.1 - LOWEST)
    if rise < 0.2:
        return []
    back, step, front = -lot.y, lot.y - cut, lot.y
    knee = lot.x - reach
    ring = [(-lot.x, back), (lot.x, back), (lot.x, front), (knee, front), (knee, step),
            (-lot.x, step)]  # fmt: skip
    box = (-lot.x, step, knee, front)
    if side < 0:
        ring = [(-a, b) for a, b in ring[::-1]]
        box = (-knee, step, lot.x, front)
    roof = plot.roof if plot.said else "gabled"
    up = min(slope * min(reach, lot.depth - cut) / 2, plot.rise)
    made = masses_on(lot.outline(ring), low=0.0, high=eave + up, zone=zone, roof=roof, rise=up)
    return made + lot.masses([box], low=0.0, high=LOWEST + rise, zone=low, roof="skillion",
                             rise=rise, direction=lot.along())  # fmt: skip


_LIME = (0xEFE9DA, 0xE6DCC3, 0xF0ECE2, 0xE2C9A6, 0xE8C7B4)
_FRAMES = (0xEFEDE8, 0x3B4A3F, 0x4A3A30, 0xE6E2D8, 0x2F4A5A)
_DRAWN: dict[str, Any] = {"back": "sill", "heads": (("", 1),), "ground_storey": 2.5}
_DOORS = (("door_boards", 2), ("door_house", 2))
_THINGS = (
    Fixture("flower_box", "bay", first=0, last=0, lift=0.62, street=True, share=0.35,
            scattered=True),
    Fixture("trellis", "foot", street=True, share=0.45, scattered=True),
    Fixture("log_pile", "foot", street=False, share=0.15, scattered=True),
)  # fmt: skip
_BODY = FacadeStyle(
    "punched", 2.7, (("window_leaded", 3), ("window_cottage", 3)), _DOORS,
    sill=0.85, corner=0.5, scale=(0.9, 0.9), surrounds=(("surround_block", 1), ("sill", 2)),
    fixtures=(
        *_THINGS,
        Fixture("barge_boards", "gable", "trim", stretch="gable", share=0.6),
    ),
    **_DRAWN,
)  # fmt: skip
_TIMBERED = FacadeStyle(
    "punched", 2.5, (("window_leaded", 1),), _DOORS, sill=0.95, corner=0.4, scale=(0.85, 0.9),
    surrounds=(("", 1),), base=(("stone", 2), ("", 1)),
    fixtures=(
        *_THINGS,
        Fixture("timber_bay", "bay", first=1, last=3, stretch="bay"),
        Fixture("timber_gable", "gable", stretch="gable"),
    ),
    **_DRAWN,
)  # fmt: skip
_LOW = FacadeStyle(
    "punched", 2.6, (("window_small", 1),), (("door_boards", 1),), sill=0.8, corner=0.5,
    scale=(0.8, 0.75), surrounds=(("sill", 1),),
    fixtures=(Fixture("rain_butt", "foot", share=0.4, scattered=True),),
    **_DRAWN,
)  # fmt: skip
_WALLS = ((4, "plaster", _LIME), (5, "brick", REDS[:6] + STOCK[:4]), (3, "stone", STONES))
_INFILL = ((1, "plaster", (0xEFE9DA, 0xECE3CF, 0xF0ECE2)),)

GENERATOR = Generator(
    "cottage",
    "Cottage",
    Look(_BODY, _WALLS, frames=_FRAMES, bricks=True, old=True),
    zones=MappingProxyType(
        {
            "low": Look(_LOW, _WALLS, frames=_FRAMES, bricks=True),
            "timber": Look(_TIMBERED, _INFILL, frames=_FRAMES, old=True),
            "timber_low": Look(_LOW, _INFILL, frames=_FRAMES),
        }
    ),
    mass=masses,
    roofs=(("gabled", 6), ("half-hipped", 4)),
    pitch=(47.0, 55.0),
    pitched=(
        (5, "roof_tiles", (*RED_TILES, 0x9C5A3E)),
        (3, "thatch", (0xFFFFFF, 0xE8DEC8)),
        (2, "slate", SLATES),
    ),
    area=(20.0, 500.0),
    levels=(1, 3),
    plot=(8.5, 12.5, 6.0, 8.5),
    floors=(1, 2),
    storey=2.5,
    use="house",
)


@action(
    "building/cottage-v1",
    limits=[
        "Only footprints of a size that admits such a building change.",
        "Plans that are not nearly rectangular keep one body.",
    ],
    requires=("layout",),
    labels=("cottage", "village", "half-timbered", "thatch", "house", "rural"),
)
def cottage(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 3)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    outshut: Annotated[float, Range(0.0, 1.0)] = 0.6,
    wing: Annotated[float, Range(0.0, 1.0)] = 0.4,
    timber: Annotated[float, Range(0.0, 1.0)] = 0.4,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build cottages with steep roofs.

    Low walls of brick, stone or limewash, half timbering above, leaded windows, steep tiles or
    thatch, and an outshut that carries the roof down to a man's height.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    outshut, wing, timber
        Share of cottages with a low part under a lean-to roof, with a wing to the street, and with
        half timbering above the ground floor.
    noise
        How far cottages vary; 0 makes all alike.
    """
    mass = partial(masses, outshut=outshut, wing=wing, timber=timber)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
