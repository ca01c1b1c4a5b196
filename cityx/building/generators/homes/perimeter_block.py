"""European perimeter blocks: rendered housing from 1870 to 1965, stuccoed, plain or stripped."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import PALE_PLASTERS, PLASTERS, REDS
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, grow
from cityx.building.massing.rules import courtyard
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

FRONTS = ("stucco", "oriel", "gable", "balcony", "plain", "postwar")
SHARES = (5, 3, 2, 3, 3, 3)
STEEP = 7.5  # metres; the highest roof


def masses(
    plot: Plot, *, front: str = "any", wing: float = 12.0, closed: bool = False
) -> tuple[Mass, ...]:
    """Lay wings around a court, open to the back, behind a front of one of `FRONTS`."""
    zone = plot.pick("front", FRONTS, SHARES) if front == "any" else front
    zone = "" if zone == "plain" or plot.levels < 3 else zone
    rise = plot.rise if plot.said else min(plot.rise, STEEP)
    body = replace(plot.body, zone=zone, high=plot.height - plot.rise + rise, rise=rise)
    if plot.plan.area < 330.0:
        return (body,)
    rules = {"lot": courtyard(wing, closed=closed)}
    return grow(plot, rules, depth=1, axiom=body)


_WALLS = (
    (9, "plaster", PLASTERS),
    (1.2, "brick", REDS),
)
_GARLAND = Fixture("stucco_garland", "window", tint="trim", first=1, last=2, stretch="opening",
                   street=True, share=0.5)  # fmt: skip
_TURRET = Fixture("corner_turret", "corner", tint="wall", stretch="height", lift=3.9, street=True,
                  spacing=18.0, share=0.45)  # fmt: skip
# Tenements of 1870 to 1900: dressed stones below, pediments in the middle, blocks under the eave.
_STUCCO = FacadeStyle(
    "punched", 2.35, (("window_casement", 1),), (("door_double", 1),), sill=0.72,
    ground_storey=3.9, corner=0.6, scale=(0.96, 1.1),
    surrounds=(("surround_pediment", 4), ("surround_cap", 3)), heads=(("cornice", 1),),
    balcony=0.3, balconies=(("balcony_iron", 1),), string=1.0,
    base=(("paint", 3), ("stone", 2)), pipe=True, quoins=0.25,
    slabs=(Strip("band_box", 0.14, 0.06, "trim", every=1, share=0.7),),
    fixtures=(
        Fixture("palace_blocks", "pier", tint="trim", street=True, share=0.5),
        Fixture("palace_modillions", "head", tint="trim", stretch="bay", street=True, share=0.7),
        _GARLAND,
        _TURRET,
    ),
)  # fmt: skip
# The same, or houses of about 1910, whose stucco was struck off: a smooth coat, sills and little
# else.
_PLAIN = FacadeStyle(
    "punched", 2.5, (("window_casement", 3), ("window_block", 2)),
    (("door_glass", 2), ("door_double", 3)), sill=0.8, ground_storey=3.5,
    surrounds=(("sill", 5), ("surround_flat", 2)),
    heads=(("cornice", 1), ("eaves_board", 3)), balcony=0.25,
    balconies=(("balcony_iron", 2), ("balcony_bars", 2)), string=0.35,
    base=(("paint", 5), ("stone", 2)), pipe=True,
)  # fmt: skip
# Blocks of 1950 to 1965 in the gaps of the war: low storeys, broad windows, rows of balconies.
_POSTWAR = FacadeStyle(
    "punched", 3.1, (("window_single", 3), ("window_panel", 2)), (("door_glass", 1),), sill=0.92,
    ground_storey=2.9, corner=0.7, surrounds=(("sill", 2), ("sill_metal", 2), ("surround_flat", 2)),
    heads=(("eaves_board", 3), ("", 1)), back="sill_metal", balcony=0.3,
    balconies=(("balcony_solid", 3), ("balcony_bars", 4)),
    base=(("paint", 3), ("stone", 2)), string=0.6, pipe=True,
)  # fmt: skip
_DRESSED = replace(
    _STUCCO, bay=2.7, windows=(("window_block", 4), ("window_casement", 3)), sill=0.85,
    scale=(1.0, 1.0), ground_storey=3.5, surrounds=(("sill", 2), ("surround_flat", 5)),
    balcony=0.0, heads=(("cornice", 2), ("eaves_board", 2)), quoins=0.0, slabs=(),
    fixtures=(_GARLAND,),
)  # fmt: skip
_ORIEL = replace(
    _DRESSED,
    fixtures=(
        Fixture("oriel", "bay", tint="wall", first=1, last=-2, every=3, stretch="storey",
                street=True),
        Fixture("oriel_foot", "bay", tint="wall", first=1, last=1, every=3, street=True),
        Fixture("oriel_cap", "bay", tint="trim", first=-1, last=-1, every=3, street=True),
        _GARLAND,
        _TURRET,
    ),
)  # fmt: skip
_GABLE = replace(
    _DRESSED, heads=(("cornice", 1),),
    slabs=(Strip("band_box", 0.14, 0.09, "trim", lobby=False, share=0.6),),
    fixtures=(
        Fixture("gable_head", "head", tint="wall", every=4, street=True),
        Fixture("gable_saddle", "head", every=4, street=True),
        Fixture("palace_aedicule", "window", tint="trim", first=1, last=1, stretch="opening",
                street=True, share=0.6),
        _GARLAND,
    ),
)  # fmt: skip
_BALCONY = replace(
    _DRESSED, balcony=1.0, string=0.3,
    balconies=(("balcony_iron", 3), ("balcony_solid", 1), ("balcony_bars", 1)),
    fins=(Strip("band_box", 0.4, 0.08, "trim", every=2, share=0.6),), fixtures=(),
)  # fmt: skip


def _look(facade: FacadeStyle) -> Look:
    return Look(facade, _WALLS, own_trim=True, old=True)


GENERATOR = Generator(
    "perimeter_block",
    "European perimeter block",
    _look(_PLAIN),
    zones=MappingProxyType(
        {
            "stucco": Look(_STUCCO, ((1, "plaster", PLASTERS),), own_trim=True, old=True),
            "postwar": Look(
                _POSTWAR,
                ((6, "plaster", PALE_PLASTERS), (1, "brick", (*REDS, 0xA98A6A))),
                frames=(0xEFEDE8, 0xF2F1EE, 0xE6E2D8),
                own_trim=True,
            ),
            "oriel": Look(_ORIEL, ((1, "plaster", PLASTERS),), own_trim=True, old=True),
            "gable": Look(_GABLE, ((1, "plaster", PLASTERS),), own_trim=True, old=True),
            "balcony": _look(_BALCONY),
            "yard": _look(
                FacadeStyle("punched", 3.0, (("window_small", 1),), (("door_service", 1),))
            ),
        }
    ),
    mass=masses,
    roofs=(("gabled", 5), ("mansard", 3), ("half-hipped", 1), ("flat", 0.4)),
    pitch=(38.0, 48.0),
    area=(60.0, 8000.0),
    levels=(2, 10),
    plot=(16.0, 40.0, 11.0, 15.0),
    floors=(4, 6),
    storey=3.3,
    use="apartments",
)  # fmt: skip


@action(
    "building/perimeter_block-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("perimeter", "block", "tenement", "wilhelminian", "flats", "oriel", "berlin"),
)
def perimeter_block(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 10)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    front: Annotated[str, Choice("any", *FRONTS)] = "any",
    wing: Annotated[float, Range(8.0, 30.0)] = 12.0,
    closed: bool = False,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build European perimeter blocks: tenements with stucco, oriels, gables or balconies.

    The rendered housing of central Europe: stuccoed tenements of the 1880s and those whose stucco
    was struck off, bay windows and gables of about 1910, and plain blocks of the 1950s, under
    steep roofs, with wings around a court on deep plots.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    front
        What the front is like.
    wing
        Metres of depth beyond which a court opens behind the front.
    closed
        Whether the court has wings on all sides; else it opens to the back.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, front=front, wing=wing, closed=closed)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
