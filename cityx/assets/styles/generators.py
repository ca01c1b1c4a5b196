"""Generators: what a kind of building is made of, as data.

A generator is a grammar of its own: how its volume grows, how its facades are divided, its roofs
and materials, and the plots it makes sense on. Its values come from ``data/generators/NAME.toml``,
its volumes from the module of that name under `cityx.building.generators`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from cityx.assets.styles.facade_styles import FacadeStyle, Weighted
from cityx.assets.styles.palette_tables import FLAT, PLAIN_FRAMES, Surfaces

# A `Plot` becomes `Mass`es, both of `cityx.building.massing`, which this room does not import.
Massing = Callable[[Any], Sequence[Any]]
ANY = (0.0, float("inf"))


@dataclass(frozen=True)
class Look:
    """What a zone of a building looks like.

    Attributes
    ----------
    facade
        Division of its walls and what is put on them.
    walls
        Materials and colours, weighted.
    frames
        sRGB colours of window frames.
    own_trim
        Whether dressings are the wall's own colour, a shade lighter or darker.
    bricks
        Whether a reddish colour without a material means brick.
    old
        Whether its shops have old fronts.
    """

    facade: FacadeStyle
    walls: Surfaces
    frames: tuple[int, ...] = PLAIN_FRAMES
    own_trim: bool = False
    bricks: bool = False
    old: bool = False


@dataclass(frozen=True)
class Generator:
    """One kind of building.

    Attributes
    ----------
    name, title
        Its word in commands and tables; its name for people.
    look, zones
        How it looks; how parts of a named zone look.
    mass
        Grows its volumes; None raises the footprint as it is.
    roofs
        Shapes drawn where the input names none; () leaves the roof to the region.
    pitch
        Least and greatest slope of those roofs, degrees.
    pitched, flat
        Surfaces of sloping and of level roofs; ``pitched`` () is the region's own.
    eaves
        How far its pitched roofs run out, relative to the usual overhang.
    rooftop
        Weights of roof furniture by name; empty for the usual of its use.
    chimneys
        Share of its houses with a sloping roof that have one.
    area, levels, width
        (least, greatest) footprint in square metres, storeys, and metres of the shorter side that
        it makes sense on.
    plot
        (least, greatest) length and width of a typical plot, metres: for libraries and samples.
    floors, storey
        (least, greatest) storeys, and metres of one, of a typical building.
    use
        Value of building=* that fits it.
    covers
        Whether its ground floor covers the whole footprint, as the map has it.
    labels, limits
        Words by which its action is found, and what that cannot do, one sentence each.
    asked
        (usual, most) storeys that a call of the action asks for; None for 0, which keeps those of
        each building, and the most of `levels`.
    texts
        What the inputs do that the actions of all generators have, where it is not the usual.
    """

    name: str
    title: str
    look: Look
    zones: Mapping[str, Look] = field(default_factory=lambda: MappingProxyType({}))
    mass: Massing | None = None
    roofs: Weighted = ()
    pitch: tuple[float, float] = (30.0, 42.0)
    pitched: Surfaces = ()
    eaves: float = 1.0
    flat: Surfaces = FLAT
    rooftop: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    chimneys: float = 0.72
    area: tuple[float, float] = ANY
    levels: tuple[float, float] = ANY
    width: tuple[float, float] = ANY
    plot: tuple[float, float, float, float] = (12.0, 24.0, 10.0, 16.0)
    floors: tuple[int, int] = (2, 6)
    storey: float = 3.2
    use: str = "yes"
    covers: bool = True
    labels: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()
    asked: tuple[int, int] | None = None
    texts: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    def looks(self) -> dict[str, Look]:
        """Return its looks by key: the name, or the name and a zone."""
        return {self.name: self.look} | {f"{self.name}/{z}": k for z, k in self.zones.items()}
