"""Classical palazzos: rendered or ashlar town palaces of the nineteenth century."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import STONES
from cityx.building.design import redesign
from cityx.building.massing.massing import COURT, Mass, Plot, Site, carve, grow, site_of
from cityx.building.massing.rules import chamfered, courtyard
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

PAVILIONS = ("none", "ends", "centre", "corner")
LEAST = 7.0  # metres of depth and front under which a palace is one plain body
BODY = 0.8  # height of the main roof as a share of that of the pavilions
ROTUNDA = (5.0, 6.6)  # metres of front of a corner with a dome
SHEARED = 0.02  # share of the plan that the cut of a corner may take


def masses(
    plot: Plot, *, pavilions: str = "any", attic: float = 6.0, wing: float = 13.0
) -> tuple[Mass, ...]:
    """Lay wings around a court and set pavilions with roofs of their own into the front."""
    site = site_of(plot)
    x, y = site.half
    rise = min(plot.rise, attic) if not plot.said else plot.rise
    body = replace(plot.body, high=plot.height - plot.rise + BODY * rise, rise=BODY * rise)
    if min(2 * x, 2 * y) < LEAST or plot.levels < 3 or plot.plan.area < 2.4 * x * y:
        return (body,)
    form = pavilions
    if form == "any":
        wide = 2 * x > 19.0
        form = plot.pick("pavilions", PAVILIONS, (2, 3, 3, 3) if wide else (4, 0, 0.01, 3))
    full = plot.height - plot.rise + rise
    if form == "corner":
        found = _cornered(site, plot, body, full, rise)
    elif form in ("ends", "centre"):
        found = _sliced(site, plot, body, full, rise, form, wing)
    else:
        found = [body]
    rules = {"body": courtyard(wing, then="")}
    grown: list[Mass] = []
    for mass in found:
        inner = mass.zone == "" and mass.plan.area > 300.0
        grown += grow(plot, rules, start="body", depth=1, axiom=mass) if inner else [mass]
    return tuple(grown)


def _sliced(
    site: Site, plot: Plot, body: Mass, full: float, rise: float, form: str, wing: float
) -> Sequence[Mass]:
    """Cut slices off the front, as deep as a wing: two at its ends, or one in its middle."""
    x, y = site.half
    wide = plot.between("pavilion", 0.17, 0.24) * 2 * x
    wide = min(max(wide, 4.6), 9.0)
    spans = [(-x, wide - x), (x - wide, x)] if form == "ends" else [(-wide / 2, wide / 2)]
    if 2 * x - len(spans) * wide < 5.0:
        return [body]
    rest, found = site.plan, list[Mass]()
    foot = y - 0.9 * wing if 2 * y > 2 * wing + COURT else -2 * y
    roof = "flat" if body.roof == "flat" else "mansard"
    for x0, x1 in spans:
        inside, rest = carve(rest, shapely.box(x0, foot, x1, 2 * y))
        high = full if roof != "flat" else body.high
        found += site.masses(inside, 0.0, high, "pavilion", roof, rise if roof != "flat" else 0.0)
    return [*site.masses(rest, 0.0, body.high, "", body.roof, body.rise), *found]


def _cornered(site: Site, plot: Plot, body: Mass, full: float, rise: float) -> Sequence[Mass]:
    """Cut a corner off and set a dome on it."""
    x, y = site.half
    side = min(plot.between("rotunda", *ROTUNDA), 0.45 * 2 * x, 0.6 * 2 * y)
    hand = 1.0 if plot.draw("hand") < 0.5 else -1.0
    x0, x1 = sorted((hand * x, hand * (x - side)))
    square = shapely.box(x0, y - side, x1, y)
    inside, rest = carve(site.plan, square)
    if side < 3.6 or inside.area < 0.97 * square.area:
        return [body]
    leg = min(0.42 * side, (2 * SHEARED * plot.plan.area) ** 0.5)
    cut = chamfered(inside, (hand * x, y), leg) if leg > 1.0 else inside
    roof = plot.pick("rotunda roof", ("dome", "pyramidal"), (4, 1)) if rise else "flat"
    dome = site.masses(cut, 0.0, full, "corner", roof, rise)
    return [*site.masses(rest, 0.0, body.high, "", body.roof, body.rise), *dome]


_WALLS = (
    (6, "stone", (*STONES, 0xD8CDB4, 0xCFC1A4, 0xC9BC9E)),
    (5, "plaster", (0xDDD2BA, 0xD5C6A4, 0xDAD3C8, 0xCAB08C, 0xC5B896, 0xCFB99C, 0xC2A593)),
    (0.6, "brick", (0xA5604A, 0x9B6A54)),
)
_FRAMES = (0xEDEBE6, 0xE8E4DA, 0xF0EFEC, 0x7A5B43, 0xD9D2C2)
_FRONT = FacadeStyle(
    "punched", 2.3, (("window_parisian", 1),), (("door_gateway", 1),),
    sill=0.32, ground_storey=4.1, corner=0.5,
    surrounds=(("surround_flat", 3), ("surround_cap", 4), ("surround_pediment", 2)),
    heads=(("cornice", 1),), string=1.0, base=(("stone", 5), ("paint", 1)), pipe=True,
    slabs=(Strip("band_box", 0.16, 0.12, "trim", every=2),),
    fixtures=(
        Fixture("palace_blocks", "pier", tint="trim", street=True, share=0.85),
        Fixture("palace_balcony", "bay", tint="trim", first=2, last=2, stretch="bay", street=True,
                share=0.75),
        Fixture("palace_balcony", "bay", tint="trim", first=-1, last=-1, stretch="bay",
                street=True, share=0.8),
        Fixture("palace_modillions", "head", tint="trim", stretch="bay", street=True, share=0.6),
        Fixture("gateway_frame", "door", tint="trim"),
        Fixture("palace_portal", "door", tint="trim", share=0.6),
    ),
)  # fmt: skip
_MAIN = replace(
    _FRONT, bay=2.0, corner=0.8, quoins=1.0, surrounds=(("surround_flat", 1),),
    fixtures=(
        Fixture("palace_blocks", "pier", tint="trim", street=True),
        Fixture("palace_aedicule", "window", tint="trim", first=1, last=2, stretch="opening",
                street=True),
        Fixture("palace_balcony", "bay", tint="trim", first=-1, last=-1, stretch="bay",
                street=True),
        Fixture("palace_modillions", "head", tint="trim", stretch="bay", street=True),
        Fixture("gateway_frame", "door", tint="trim"),
        Fixture("palace_portal", "door", tint="trim"),
    ),
)  # fmt: skip
_CORNER = replace(
    _MAIN, bay=2.4, corner=0.5, quoins=0.0,
    fixtures=(
        Fixture("gateway_frame", "door", tint="trim"),
        Fixture("palace_balcony", "bay", tint="trim", first=2, last=2, stretch="bay"),
        Fixture("palace_balcony", "bay", tint="trim", first=-1, last=-1, stretch="bay"),
        Fixture("palace_modillions", "head", tint="trim", stretch="bay"),
        Fixture("dome_finial", "top"),
    ),
)  # fmt: skip

GENERATOR = Generator(
    "palazzo",
    "Classical palazzo",
    Look(_FRONT, _WALLS, frames=_FRAMES, own_trim=True, old=True),
    zones=MappingProxyType(
        {
            "pavilion": Look(_MAIN, _WALLS, frames=_FRAMES, own_trim=True, old=True),
            "corner": Look(_CORNER, _WALLS, frames=_FRAMES, own_trim=True, old=True),
            "yard": Look(
                FacadeStyle("punched", 3.0, (("window_small", 1),), (("door_service", 1),)),
                _WALLS,
                frames=_FRAMES,
                own_trim=True,
            ),
        }
    ),
    mass=masses,
    roofs=(("mansard", 8), ("flat", 0.6)),
    pitch=(35.0, 43.0),
    pitched=(
        (6, "slate", (0x50545A, 0x5C6064, 0x474A50, 0x66676A)),
        (3, "roof_metal", (0x7E8486, 0x8D9396, 0x6E7476)),
        (0.5, "copper", (0xFFFFFF,)),
    ),
    area=(60.0, 6000.0),
    levels=(2, 9),
    plot=(16.0, 34.0, 12.0, 18.0),
    floors=(4, 6),
    storey=3.6,
    use="apartments",
)  # fmt: skip


@action(
    "building/palazzo-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("palazzo", "haussmann", "classical", "old", "town", "mansard", "paris"),
)
def palazzo(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 9)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    pavilions: Annotated[str, Choice("any", *PAVILIONS)] = "any",
    attic: Annotated[float, Range(1.0, 9.0)] = 6.0,
    wing: Annotated[float, Range(8.0, 30.0)] = 13.0,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build classical town palaces.

    Ashlar or rendered fronts of the nineteenth century: a rusticated ground floor or shops, tall
    windows, balconies of iron along the second and the last floor, a mansard, and pavilions or a
    domed corner.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    pavilions
        Where parts of the front have roofs of their own.
    attic
        Metres of the highest roofs, at most.
    wing
        Metres of depth beyond which a court opens behind the front.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, pavilions=pavilions, attic=attic, wing=wing)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
