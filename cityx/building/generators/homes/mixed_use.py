"""Modern mixed-use blocks: shops below, flats in volumes of their own materials, terraces above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Annotated

from cityx.assets.styles.facade_styles import FacadeStyle, Fixture, Strip
from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.palette_tables import GREYS, LIGHTS
from cityx.building.design import redesign
from cityx.building.massing.massing import Axes, Mass, Plot, pieces
from cityx.city.city import City
from cityx.protocol import ObjectName, Range, action

LEAST = 9.0  # metres of width under which a house is one volume
SKINS = ("", "second", "third")
JOINT = 0.2  # metres by which upper walls stand behind those below
MANY = 0.75  # share of plots on which the block is divided at all: most of a town is plain


def masses(
    plot: Plot, *, volumes: int = 3, terrace: float = 2.6, retail: int = 1, divided: float = MANY
) -> tuple[Mass, ...]:
    """Divide a block above its shops into volumes, and step their tops back in terraces."""
    axes = plot.axes()
    plain = plot.levels < 4 or axes.width < LEAST or plot.draw("divided") >= divided
    if plain or plot.plan.area < 0.5 * axes.length * axes.width:
        return (plot.body,)
    level = min(retail, plot.levels - 2) * plot.storey
    found = [Mass(plot.plan, 0.0, level, "retail")]
    above = plot.plan.buffer(-JOINT, join_style="mitre")
    count = max(1, min(volumes, int(axes.length / 9.0)))
    edge = _edges(plot, axes, count)
    start = int(3 * plot.draw("first skin")) if plot.noise else 0
    far = axes.length
    for number in range(count):
        x0 = -far if number == 0 else edge[number]
        x1 = far if number == count - 1 else edge[number + 1]
        skin = SKINS[(start + number) % (3 if count > 2 else 2)]
        back = 0.0 if number % 2 == 0 else plot.between("recess", 0.6, 1.8)
        strip = axes.box(x0, -far, x1, axes.width / 2 - back if back else far)
        drop = round(1.49 * plot.draw("drop", number)) if plot.noise and count > 1 else number % 2
        high = plot.height - min(drop, max(plot.levels - 4, 0)) * plot.storey
        for plan in pieces(above & strip):
            found += _terraced(plot, Mass(plan, level, high, skin), terrace)
    return tuple(found)


def _edges(plot: Plot, axes: Axes, count: int) -> Sequence[float]:
    """Return where the volumes meet along the block, unequal shares."""
    shares = [
        1.0 + (0.5 * (2 * plot.draw("volume", i) - 1) * min(1, 2 * plot.noise))
        for i in range(count)
    ]
    run, edges = -axes.length / 2, []
    for share in shares:
        edges.append(run)
        run += axes.length * share / sum(shares)
    return [*edges, run]


def _terraced(plot: Plot, body: Mass, depth: float) -> Sequence[Mass]:
    """Set the top storey, or the two top ones in steps, back from the street."""
    axes = plot.axes(body.plan)
    storeys = round(body.height / plot.storey)
    steps = (
        0
        if storeys < 3
        else 1
        if storeys < 5
        else 1 + int(1.4 * plot.draw("steps") * min(1, 2 * plot.noise))
    )
    found: list[Mass] = []
    left = body
    for step in range(steps):
        back = plot.between(f"terrace {step}", 0.75 * depth, 1.25 * depth)
        far = axes.length + axes.width
        room = axes.box(-far, -far, far, axes.width / 2 - (step + 1) * back)
        upper = pieces(left.plan.buffer(-JOINT, join_style="mitre") & room)
        level = body.high - (steps - step) * plot.storey
        if not upper or plot.axes(upper[0]).width < 0.55 * axes.width:
            break
        found.append(replace(left, high=level))
        found += [replace(left, plan=each, low=level, zone="attic") for each in upper[1:]]
        left = replace(left, plan=upper[0], low=level, zone="attic")
    return [*found, left]


_FRAMES = (0x3A3D40, 0x55585A, 0x2E3032, 0xD8D8D5, 0x6A5D50)
_FLATS = FacadeStyle(
    "punched", 3.2, (("window_wide", 4), ("window_office", 2), ("window_single", 1)),
    (("door_glass", 1),), sill=0.5, ground_storey=3.6, corner=0.7, scale=(0.85, 1.0),
    surrounds=(("", 3), ("sill_metal", 3)), heads=(("coping", 1),), back="sill_metal",
    balcony=0.45, base=(("stone", 3), ("paint", 2), ("", 1)), string=0.5, shops=0.65,
    balconies=(("balcony_glass", 3), ("balcony_bars", 3), ("balcony_solid", 1)),
)  # fmt: skip
_LOGGIAS = replace(
    _FLATS, windows=(("window_wide", 1),), bay=4.0, sill=0.18, balcony=0.0,
    fixtures=(
        Fixture("loggia_box", "bay", tint="trim", first=0, last=-1, every=2, street=True),
        Fixture("terrace_planter", "edge", tint="wall", spacing=5.0, share=0.4, scattered=True),
    ),
)  # fmt: skip
_SCREENED = replace(
    _FLATS, windows=(("window_wide", 2), ("window_single", 1)), sill=0.18, bay=3.4, balcony=0.3,
    slabs=(Strip("band_box", 0.26, 0.10, "trim", 0.9, lobby=False),),
    fixtures=(
        Fixture("screen_panel", "pier", first=0, last=-1, scattered=True, share=0.45, street=True),
    ),
)  # fmt: skip
_ZONES = {
    "second": Look(
        _LOGGIAS,
        (
            (4, "brick", (0x5E5048, 0x8B7B6C, 0x6D5A50, 0xA8988A, 0x9C5F4A, 0xB08F70)),
            (1, "concrete", GREYS),
        ),
        frames=_FRAMES,
        own_trim=True,
    ),
    "third": Look(
        _SCREENED,
        (
            (3, "metal_panel", (0x8D9194, 0x6B6E70, 0xA9A79F, 0x7A6A5A, 0x4E5456)),
            (2, "wood", (0x8A7256, 0x9A7B58)),
            (2, "plaster", (0x5E5C5A, 0x7C7A76, 0xA58F72, 0x6E7F86)),
        ),
        frames=_FRAMES,
        own_trim=True,
    ),
    "retail": Look(
        FacadeStyle(
            "strip", 3.6, (("window_wide", 1),), (("door_glass", 1),), sill=0.35,
            ground_storey=4.2, corner=0.4, surrounds=(("", 1),), heads=(("coping", 1),), back="",
            shops=1.0, fins=(Strip("band_box", 0.4, 0.10, "wall", 0.9, every=2, lobby=False),),
        ),
        ((3, "stone", (0x5E5A56, 0x8F8A82, 0xA79E90)), (2, "concrete", GREYS),
         (2, "metal_panel", (0x3E4144, 0x55585B)), (1, "brick", (0x5E5048, 0x6D5A50))),
        frames=_FRAMES,
    ),
    "attic": Look(
        replace(
            _FLATS, windows=(("window_wide", 1),), sill=0.18, balcony=0.0, bay=3.6,
            fixtures=(Fixture("terrace_pergola", "top", share=0.12),),
        ),
        ((3, "metal_panel", (0x4E5456, 0x6B6E70, 0x7A6A5A)), (2, "plaster", (0xE2E0DB, 0x7C7A76)),
         (1, "wood", (0x8A7256,))),
        frames=_FRAMES,
    ),
}  # fmt: skip

GENERATOR = Generator(
    "mixed_use",
    "Modern mixed-use block",
    Look(
        _FLATS,
        (
            (4, "plaster", LIGHTS),
            (2, "concrete", GREYS),
            (2, "brick", (0x5E5048, 0x8B7B6C, 0x6D5A50, 0xA8988A)),
            (1, "metal_panel", (0x8D9194, 0x6B6E70, 0xA9A79F, 0x7A6A5A)),
        ),
        frames=_FRAMES,
        own_trim=True,
    ),
    zones=MappingProxyType(_ZONES),
    mass=masses,
    roofs=(("flat", 1.0),),
    flat=((4, "roof_gravel", (0x8B8780, 0x7E7B75)), (2, "bitumen", (0xA2A19C, 0x8F8E8A)),
          (2, "grass", (0xFFFFFF,))),
    area=(80.0, 9000.0),
    levels=(2, 18),
    plot=(20.0, 48.0, 14.0, 20.0),
    chimneys=0.0,
    floors=(5, 9),
    storey=3.2,
    use="apartments",
)  # fmt: skip


@action(
    "building/mixed_use-v1",
    limits=["Only footprints of a size that admits such a building change."],
    requires=("layout",),
    labels=("modern", "mixed-use", "flats", "balcony", "loggia", "terrace", "contemporary"),
)
def mixed_use(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    floors: Annotated[int, Range(0, 18)] = 0,
    building: Annotated[str | None, ObjectName()] = None,
    volumes: Annotated[int, Range(1, 6)] = 3,
    terrace: Annotated[float, Range(1.0, 6.0)] = 2.6,
    retail: Annotated[int, Range(1, 3)] = 1,
    noise: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Build modern blocks of flats over shops.

    A base for shops, volumes of two or three materials side by side above it, loggias, screens and
    balconies, and top storeys set back behind terraces.

    Parameters
    ----------
    share
        Share of the buildings that become one.
    floors
        Storeys, 0 to keep those of each building.
    building
        The one building to change, or None for all.
    volumes
        Volumes side by side, where there is room.
    terrace
        Metres that the top storeys are set back.
    retail
        Storeys of the base.
    noise
        How far measures vary; 0 is regular.
    """
    mass = partial(masses, volumes=volumes, terrace=terrace, retail=retail, divided=1.0)
    return redesign(
        city, GENERATOR, share=share, floors=floors, building=building, mass=mass, noise=noise
    )
