"""Mediterranean town houses: shutters, low tiled roofs, loggias, terraces and roof towers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

import shapely

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import CLAY, STONES, WARM
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, Site, carve, site_of
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

FORMS = ("plain", "loggia", "terrace", "altana")
CAP = 0.95  # metres of the low roof of a roof tower
DIVIDED = 0.55  # share of houses that are more than a box


def masses(plot: Plot, *, form: str = "any", terrace: float = 0.38) -> tuple[Mass, ...]:
    """Leave an end of the house flat for a terrace, or raise a tower with arches above it."""
    site = site_of(plot)
    x, y = site.half
    body = plot.body
    word = form
    if word == "any":
        divided = plot.draw("divided") < DIVIDED
        word = plot.pick("form", FORMS[1:], (3, 3, 3)) if divided else "plain"
    if word == "loggia":
        return (replace(body, zone="loggia" if plot.levels > 1 else ""),)
    boxy = plot.plan.area > 2.8 * x * y
    if word == "plain" or not boxy or min(x, y) < 2.6 or plot.levels < 2 or not plot.rise:
        return (body,)
    grown = _terraced(site, plot, terrace) if word == "terrace" else _towered(site, plot)
    return tuple(grown)


def _terraced(site: Site, plot: Plot, share: float) -> Sequence[Mass]:
    """Roof one end with tiles, and lay a terrace over the top floor of the other."""
    x, y = site.half
    eave = plot.height - plot.rise
    hand = 1.0 if plot.draw("hand") < 0.5 else -1.0
    long = 2 * x >= min(8.0, 2 * y)
    wide = plot.between("terrace", 0.8 * share, 1.2 * share) * 2 * (x if long else y)
    if wide < 3.0:
        return [plot.body]
    if long:
        x0, x1 = sorted((hand * (x - wide), hand * 2 * x))
        tool = shapely.box(x0, -2 * y, x1, 2 * y)
    else:
        tool = shapely.box(-2 * x, -2 * y, 2 * x, wide - y)
    flat, rest = carve(site.plan, tool)
    level = eave - plot.storey if plot.levels > 2 and plot.draw("drop") < 0.5 else eave
    tiled = site.masses(rest, 0.0, plot.height, "", plot.roof, plot.rise)
    return [*tiled, *site.masses(flat, 0.0, level, "terrace")]


def _towered(site: Site, plot: Plot) -> Sequence[Mass]:
    """Raise an open room over a corner of the front, above the roof."""
    x, y = site.half
    eave = plot.height - plot.rise
    hand = 1.0 if plot.draw("hand") < 0.5 else -1.0
    side = min(plot.between("altana", 3.4, 4.8), 0.9 * x, 0.9 * y)
    if side < 2.4:
        return [plot.body]
    x0, x1 = sorted((hand * x, hand * (x - side)))
    shaft, rest = carve(site.plan, shapely.box(x0, y - side, x1, y))
    found = site.masses(rest, 0.0, plot.height, "", plot.roof, plot.rise)
    found += site.masses(shaft, 0.0, eave, "")
    room = shapely.buffer(shaft, -0.1, join_style="mitre")
    return [*found, *site.masses(room, eave, eave + 2.9 + CAP, "altana", "hipped", CAP)]


_WALLS = ((9, "plaster", (*WARM, 0xBE8368, 0xD2B37C, 0xC79684, 0xECE4D4)), (1, "stone", STONES))
_FRAMES = (0x5C6E5A, 0x6B4A33, 0x7B8C93, 0xE8E4DA, 0x4F6470, 0x8A6A4A, 0x3F5548)
_FRONT = FacadeStyle(
    "punched", 3.1, (("window_persiana", 1),), (("door_planks", 1),), sill=0.75,
    ground_storey=3.6, corner=0.6, surrounds=(("sill", 4), ("surround_flat", 2)),
    heads=(("eaves_board", 2), ("cornice", 2)), balcony=0.35,
    balconies=(("balcony_iron", 4), ("balcony_rail", 2)), string=0.35,
    base=(("paint", 3), ("stone", 1), ("", 5)), cooling=0.05, pipe=True,
    fixtures=(
        Fixture("planks_frame", "door", tint="trim"),
        Fixture("washing_line", "window", first=1, last=-1, share=0.10, scattered=True),
        Fixture("cloth_awning", "window", tint="sign", first=0, last=-1, stretch="opening",
                share=0.13, scattered=True, street=True),
        Fixture("flower_rail", "window", first=1, last=-1, stretch="opening", share=0.22,
                scattered=True),
    ),
)  # fmt: skip
_LOGGIA = replace(
    _FRONT, windows=(("window_casement", 1),), balcony=0.0, string=0.8,
    surrounds=(("surround_flat", 1),),
    fixtures=(
        Fixture("loggia_arch", "bay", tint="wall", first=-1, last=-1, stretch="cell", street=True),
        *_FRONT.fixtures,
    ),
)  # fmt: skip
_ALTANA = FacadeStyle(
    "nave", 1.8, (("window_lancet", 1),), (("door_service", 1),), scale=(0.0, 1.0), corner=0.3,
    surrounds=(("", 1),), back="", heads=(("eaves_board", 1),),
    fixtures=(Fixture("altana_arches", "edge", tint="wall", stretch="wall"),),
)  # fmt: skip


def _look(facade: FacadeStyle) -> Look:
    return Look(facade, _WALLS, frames=_FRAMES, own_trim=True, old=True)


GENERATOR = Generator(
    "mediterranean_house",
    "Mediterranean town house",
    _look(_FRONT),
    zones=MappingProxyType(
        {
            "loggia": _look(_LOGGIA),
            "terrace": _look(replace(
                _FRONT, heads=(("coping", 1),),
                fixtures=(Fixture("roof_pergola", "top"), *_FRONT.fixtures),
            )),
            "altana": _look(_ALTANA),
        }
    ),
    mass=masses,
    roofs=(("hipped", 4), ("gabled", 3), ("flat", 0.8)),
    pitch=(16.0, 23.0),
    pitched=((5, "roof_tiles", CLAY), (6, "roof_tiles", (0x94583C, 0x8A5238, 0xA0704E))),
    area=(30.0, 4000.0),
    levels=(1, 8),
    plot=(8.0, 18.0, 9.0, 14.0),
    chimneys=0.5,
    floors=(2, 4),
    storey=3.3,
    use="apartments",
)  # fmt: skip


@action(
    "building/mediterranean_house-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("mediterranean", "southern", "shutters", "italian", "spanish", "loggia", "terrace"),
)
def mediterranean_house(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 8)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    form: Annotated[str, Choice("any", *FORMS)] = "any",
    terrace: Annotated[float, Range(0.2, 0.6)] = 0.38,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build Mediterranean town houses.

    Lime-washed walls in warm colours, shutters open and closed, washing and awnings at the windows,
    low roofs of clay tiles, and a loggia, a roof terrace or an open tower above the roofs.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    form
        A plain house, one with arches in its top floor, with a terrace, or with a roof tower.
    terrace
        Share of the length that a terrace takes.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, form=form, terrace=terrace)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
