"""European perimeter blocks: rendered housing of 1890 to 1930, with oriels, gables, balconies."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.generators import Generator, Look
from cityx.assets.palette_tables import PLASTERS, REDS
from cityx.city.city import City
from cityx.geometry.massing import Mass, Plot, grow
from cityx.geometry.massing_rules import courtyard
from cityx.plugins.building.design import redesign
from cityx.protocol import Choice, ObjectName, Range, action

FRONTS = ("oriel", "gable", "balcony", "plain")
STEEP = 7.5  # metres; the highest roof


def masses(
    plot: Plot, *, front: str = "any", wing: float = 12.0, closed: bool = False
) -> tuple[Mass, ...]:
    """Lay wings around a court, open to the back, behind a front with oriels, gables, balconies."""
    zone = plot.pick("front", FRONTS, (4, 3, 3, 2)) if front == "any" else front
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
_PLAIN = FacadeStyle(
    "punched", 2.7, (("window_block", 4), ("window_casement", 3)),
    (("door_glass", 2), ("door_double", 3)), sill=0.85, ground_storey=3.4,
    surrounds=(("sill", 2), ("surround_flat", 5)),
    heads=(("cornice", 2), ("eaves_board", 2)), balcony=0.0, string=0.7,
    base=(("paint", 4), ("stone", 2), ("", 2)), pipe=True,
    fixtures=(
        Fixture("stucco_garland", "window", tint="trim", first=1, last=2, stretch="opening",
                street=True, share=0.5),
    ),
)  # fmt: skip
_ORIEL = replace(
    _PLAIN,
    fixtures=(
        Fixture("oriel", "bay", tint="wall", first=1, last=-2, every=3, stretch="storey",
                street=True),
        Fixture("oriel_foot", "bay", tint="wall", first=1, last=1, every=3, street=True),
        Fixture("oriel_cap", "bay", tint="trim", first=-1, last=-1, every=3, street=True),
        *_PLAIN.fixtures,
    ),
)  # fmt: skip
_GABLE = replace(
    _PLAIN, heads=(("cornice", 1),),
    slabs=(Strip("band_box", 0.14, 0.09, "trim", lobby=False, share=0.6),),
    fixtures=(
        Fixture("gable_head", "head", tint="wall", every=4, street=True),
        Fixture("gable_saddle", "head", every=4, street=True),
        Fixture("palace_aedicule", "window", tint="trim", first=1, last=1, stretch="opening",
                street=True, share=0.6),
        *_PLAIN.fixtures,
    ),
)  # fmt: skip
_BALCONY = replace(
    _PLAIN, balcony=1.0, string=0.3,
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
    labels=("perimeter", "block", "housing", "flats", "european", "oriel", "berlin"),
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
    """Build European perimeter blocks with oriels, gables or balconies.

    The rendered housing of 1890 to 1930: bay windows carried out over the pavement from the first
    floor, ornamental gables at the eaves, steep roofs, and wings around a court on deep plots.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    front
        What stands out of the front.
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
