"""Panel-built slabs: sections of large panels with open joints, loggias, stairs, lift houses."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

import shapely

from cityx.assets.fixtures.estates import SPANDRELS
from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import GREYS
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, Site, carve, site_of
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

SKINS = (*SPANDRELS, *(f"loggia_{word}" for word in SPANDRELS), "grey")
STAIR = 3.4  # metres of front of a stair
STEP = 0.45  # metres that stairs stand back from the front
HEAD = 2.5  # metres of a lift house above the roof
LEAST = 8.0  # metres of a section without its stair


def masses(
    plot: Plot, *, section: float = 24.0, colour: str = "any", step: float = 0.35
) -> tuple[Mass, ...]:
    """Cut a slab into sections of slightly different height, a stair with a lift house in each."""
    words = SKINS if colour == "any" else (colour, f"loggia_{colour}")
    zone = plot.pick("skin", words if colour != "grey" else ("grey",))
    zone = "" if zone == "grey" else zone
    site = _lengthwise(plot)
    x, y = site.half
    body = replace(plot.body, zone=zone, roof="flat", rise=0.0)
    if 2 * x < STAIR + LEAST or 2 * y < 6.0 or plot.levels < 3 or plot.plan.interiors:
        return (body,)
    count = max(1, round(2 * x / plot.waver("section", section, body)))
    long = 2 * x / count
    rest, found = site.plan, list[Mass]()
    heights = [_height(plot, number, step) for number in range(count)]
    for number in range(count):
        middle = -x + (number + 0.5) * long
        at = middle + (plot.draw("stair at", number) - 0.5) * 0.3 * long * min(1, 2 * plot.noise)
        span = shapely.box(at - STAIR / 2, -2 * y, at + STAIR / 2, 2 * y)
        stair, rest = carve(rest, span)
        stair = shapely.intersection(stair, shapely.box(-2 * x, -2 * y, 2 * x, y - STEP))
        high = heights[number] + HEAD if plot.levels >= 5 else heights[number]
        found += site.masses(stair, 0.0, min(high, plot.height + HEAD), "stair")
    for number in range(count):
        x0 = -2 * x if number == 0 else number * long - x
        x1 = 2 * x if number == count - 1 else (number + 1) * long - x
        piece, rest = carve(rest, shapely.box(x0, -2 * y, x1, 2 * y))
        found += site.masses(piece, 0.0, heights[number], zone)
    found += site.masses(rest, 0.0, plot.storey, zone)
    return tuple(found)


def _lengthwise(plot: Plot) -> Site:
    """Return the site with x along the slab, wherever the street lies."""
    return site_of(plot, facing=False)


def _height(plot: Plot, number: int, step: float) -> float:
    """Height of a section: that of the slab, or a storey less."""
    low = plot.draw("drop", number) < step if plot.noise else number % 2 == 1 and step > 0
    return plot.height - plot.storey if low and plot.levels > 4 else plot.height


_WALLS = (
    (5, "concrete", (*GREYS, 0xC9C4B8, 0xBDB7A8)),
    (3, "plaster", (0xDAD2C4, 0xD3CFC7, 0xCFC3A8, 0xC4C1BB)),
)
_JOINTS = (Strip("band_paint", 0.07, 0.012, "wall", 0.42, lobby=False),)
_LEVELS = (Strip("band_paint", 0.07, 0.013, "wall", 0.42, lobby=False),)
_FRONT = FacadeStyle(
    "punched", 3.2, (("window_panel", 1),), (("door_stairwell", 1),), sill=0.9, ground_storey=2.8,
    corner=0.2, surrounds=(("sill_metal", 1),), heads=(("coping", 1),), back="sill_metal",
    base=(("paint", 2), ("", 3)), fins=_JOINTS, slabs=_LEVELS,
    fixtures=(
        Fixture("stairwell_roof", "door"),
        Fixture("wall_dish", "bay", first=1, last=-1, lift=1.0, share=0.04, scattered=True),
    ),
)  # fmt: skip


def _coloured(word: str) -> FacadeStyle:
    panels = Fixture(f"spandrel_{word}", "bay", first=0, last=-1, lift=0.95, stretch="bay")
    return replace(_FRONT, fixtures=(panels, *_FRONT.fixtures))


def _loggias(word: str) -> FacadeStyle:
    def column(name: str, stretch: str, share: float) -> Fixture:
        return Fixture(name, "bay", first=1, last=-1, every=3, stretch=stretch, street=True,
                       share=share, scattered=share < 1.0)  # fmt: skip

    return replace(
        _FRONT,
        fixtures=(
            column(f"loggia_{word}", "cell", 1.0),
            column("loggia_glazed", "cell", 0.3),
            column("loggia_things", "", 0.4),
            *_FRONT.fixtures,
        ),
    )


_STAIR = replace(
    _FRONT, windows=(("window_slit", 1),), bay=2.4, fins=(), doors=(("door_service", 1),),
    fixtures=(
        Fixture("stair_glass", "bay", first=1, last=-1, stretch="cell"),
        Fixture("stair_entry", "foot"),
    ),
)  # fmt: skip

# Shops and offices below a slab: broad panes between pilasters, over a base of dressed stone.
_PODIUM = replace(
    _FRONT, mode="strip", bay=4.2, windows=(("window_office", 1),), doors=(("door_glass", 1),),
    ground_storey=3.4, base=(("stone", 1),),
    fins=(Strip("band_box", 0.5, 0.16, "wall", 0.9, lobby=False),),
    slabs=(Strip("band_box", 0.55, 0.10, "trim", 0.95, lobby=False),), fixtures=(),
)  # fmt: skip


def _look(facade: FacadeStyle) -> Look:
    return Look(facade, _WALLS, frames=(0xEFEDE8, 0xE6E2D8, 0xF2F1EE), own_trim=True)


GENERATOR = Generator(
    "panel_slab",
    "Panel-built slab",
    _look(_FRONT),
    zones=MappingProxyType(
        {word: _look(_coloured(word)) for word in SPANDRELS}
        | {f"loggia_{word}": _look(_loggias(word)) for word in SPANDRELS}
        | {"stair": _look(_STAIR), "podium": _look(_PODIUM)}
    ),
    mass=masses,
    roofs=(("flat", 1.0),),
    area=(120.0, 9000.0),
    levels=(4, 26),
    plot=(40.0, 90.0, 11.0, 14.0),
    chimneys=0.0,
    floors=(5, 12),
    storey=2.8,
    use="apartments",
)


@action(
    "building/panel_slab-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("panel", "slab", "prefabricated", "soviet", "plattenbau", "housing estate"),
)
def panel_slab(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 26)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    section: Annotated[float, Range(12.0, 60.0)] = 24.0,
    colour: Annotated[str, Choice("any", "grey", *SPANDRELS)] = "any",
    step: Annotated[float, Range(0.0, 1.0)] = 0.35,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build slabs of prefabricated panels.

    Storey-high panels with open joints, coloured spandrels or columns of loggias, bands of glass
    blocks before the stairs, and lift houses on the roof; long slabs consist of sections.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    section
        Metres of front that share a stair.
    colour
        Of spandrels and loggias.
    step
        Share of the sections that are a storey lower.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, section=section, colour=colour, step=step)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
