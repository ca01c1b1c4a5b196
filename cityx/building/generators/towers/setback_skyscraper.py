"""Setback skyscrapers: masonry towers stepped back by the zoning of 1916."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import REDS, STONES
from cityx.building.design import redesign
from cityx.building.massing.massing import Mass, Plot, grow
from cityx.building.massing.rules import crowned, light_court, notched, otherwise, setback
from cityx.city.city import City
from cityx.protocol import Choice, ObjectName, Range, action

CROWNS = ("pyramidal", "flat", "mansard", "steps")


def masses(
    plot: Plot, *, inset: float = 4.5, depth: int = 7, crown: str = "any"
) -> tuple[Mass, ...]:
    """Step a tower back, three times at most, and set a crown on it."""
    crown = plot.pick("crown roof", CROWNS, (3, 1, 2, 4)) if crown == "any" else crown
    roof = "flat" if crown == "steps" else crown
    steps = 0.8 * inset, 0.7 * inset
    tall = plot.between("crown", 6.0, 14.0)
    rules = {
        "lot": setback(inset, 0.34, then="tier", zone="tower"),
        "tier": otherwise(setback(steps[0], 0.42, then="shaft", zone="tower"), "shaft"),
        "shaft": otherwise(
            setback(steps[1], 0.55, then="corners", zone="tower", least=12.0), "corners"
        ),
        "corners": otherwise(notched(2.4, then="top"), "top"),
        "top": crowned(2.2, tall, roof=roof),
    }
    if crown == "steps":
        rules["top"] = crowned(1.8, 1.6 * tall, then="ziggurat")
        rules["ziggurat"] = crowned(1.6, tall, then="lantern")
        rules["lantern"] = crowned(1.4, 0.5 * tall)
    if plot.levels < 16:
        rules["lot"] = light_court(14.0, above=3 * plot.storey, then="tier", foot="")
    return grow(plot, rules, depth=depth)


_MASONRY = (
    (5, "stone", (*STONES, 0xB9A98C, 0xAE9F88)),
    (4, "brick", (0xB49A78, 0xA5805F, *REDS[:4])),
    (1, "plaster", (0xD8CFBC, 0xC7BBA4)),
)
_SHAFT = FacadeStyle(
    "punched", 2.6, (("window_sash", 5), ("window_single", 2)), (("door_bronze", 1),),
    sill=0.8, ground_storey=4.6, corner=0.9, scale=(1.05, 1.05),
    surrounds=(("sill", 2), ("surround_lintel", 1)), back="sill",
    heads=(("cornice", 1), ("coping", 2)), string=0.9, base=(("stone", 5), ("", 1)),
    fins=(Strip("band_box", 0.55, 0.16, "wall", 1.06),),
    slabs=(Strip("band_paint", 0.9, 0.03, "wall", 0.62, share=0.6),),
)  # fmt: skip
_TOWER = replace(
    _SHAFT,
    surrounds=(("sill", 1),),
    heads=(("coping", 1),),
    fins=(
        Strip("band_box", 0.55, 0.22, "wall", 1.06),
        Strip("band_box", 0.18, 0.36, "wall", 1.1, lobby=False),
    ),
    slabs=(Strip("band_paint", 0.95, 0.03, "wall", 0.55, share=0.75),),
    fixtures=(
        Fixture("deco_panel", "bay", first=1, last=-1, every=2, stretch="bay", share=0.6),
        Fixture("deco_fin", "edge", tint="wall", spacing=5.2),
    ),
)
_FRAMES = (0x2F3234, 0x4A3A30, 0x38463F, 0x5B5247)

GENERATOR = Generator(
    "setback_skyscraper",
    "Setback skyscraper",
    Look(_SHAFT, _MASONRY, frames=_FRAMES, bricks=True, old=True),
    zones=MappingProxyType(
        {
            "tower": Look(_TOWER, _MASONRY, frames=_FRAMES, bricks=True),
            "crown": Look(
                FacadeStyle(
                    "punched", 3.0, (("window_arched", 3), ("window_single", 1)),
                    (("door_service", 1),), surrounds=(("surround_flat", 1),),
                    heads=(("cornice", 1),), corner=1.0,
                    fins=(Strip("band_box", 0.7, 0.25, "wall", 1.08, lobby=False),),
                    fixtures=(
                        Fixture("tower_needle", "top", share=0.55),
                        Fixture("deco_fin", "edge", tint="wall", spacing=4.0),
                    ),
                ),
                _MASONRY,
                frames=_FRAMES,
                bricks=True,
            ),
        }
    ),
    mass=masses,
    roofs=(("flat", 1.0),),
    pitched=((3, "copper", (0xFFFFFF,)), (2, "slate", (0x50545A, 0x5C6064))),
    area=(350.0, 12000.0),
    levels=(10, 110),
    width=(16.0, 200.0),
    plot=(28.0, 46.0, 26.0, 40.0),
    floors=(18, 38),
    storey=3.7,
    use="office",
)  # fmt: skip


@action(
    "building/setback_skyscraper-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("skyscraper", "setback", "art deco", "new york", "tower", "masonry"),
)
def setback_skyscraper(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 110)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    inset: Annotated[float, Range(1.5, 12.0)] = 4.5,
    depth: Annotated[int, Range(0, 8)] = 7,
    crown: Annotated[str, Choice("any", *CROWNS)] = "any",
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build masonry skyscrapers that step back as they rise.

    A base to the street line, tiers drawn in above it, piers that run up the shaft, and a crown.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    inset
        Metres of the first step; the next are smaller.
    depth
        How often a volume is divided; 0 is a plain block.
    crown
        What ends the tower: a roof, or steps.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, inset=inset, depth=depth, crown=crown)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
