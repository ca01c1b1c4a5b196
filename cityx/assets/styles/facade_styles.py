"""Facade styles: the measures and prototypes the facade grammar works with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Weighted = tuple[tuple[str, float], ...]
Mode = Literal["punched", "strip", "curtain", "hall", "nave", "shed"]
Tint = Literal["", "wall", "trim", "frame", "accent", "sign"]
At = Literal["door", "front", "bay", "pier", "corner", "top", "edge", "foot", "gable", "ground",
             "window", "head", "side"]  # fmt: skip
Stretch = Literal["", "wall", "bay", "height", "gable", "plan", "along", "across", "storey", "cell",
                  "opening", "round"]  # fmt: skip


@dataclass(frozen=True)
class Strip:
    """A straight member that repeats over a front: a fin, a mullion, a spandrel, a joint.

    Attributes
    ----------
    name
        Prototype of unit size: "band_box", "band_paint" or "band_frame" (`trims.trims`).
    breadth, depth
        Metres along the wall (fins) or up it (slabs), and metres it stands out.
    tint
        Whose colour it has: "wall", "trim", "frame" or "accent".
    shade
        Multiplies that colour.
    spacing
        Metres between fins where they do not follow the bays; 0 follows them.
    every
        Of bays or storeys, each so-manyth has one.
    lobby
        Whether fins and slabs leave out the ground floor.
    share
        Share of buildings that have it.
    """

    name: str
    breadth: float
    depth: float
    tint: Tint = "trim"
    shade: float = 1.0
    spacing: float = 0.0
    every: int = 1
    lobby: bool = True
    share: float = 1.0


@dataclass(frozen=True)
class Fixture:
    """A thing of real size that a style puts on its walls, roofs or plot.

    Attributes
    ----------
    name
        Prototype (`cityx.assets.fixtures`); it stands at its origin, -y outward, z up.
    at
        "door": at the main door. "front": once, in the middle of the wall of the main door.
        "bay": in every bay of the storeys `first` to `last`. "pier": between the bays. "corner":
        at free outer corners, those with `street` where both walls face one. "top": on the middle
        of the roof of each part. "edge": along the walls' upper ends. "foot": along their feet,
        clear of doors. "gable": at the eaves in the middle of the walls under the ends of a ridge
        along the longer side. "ground": in a row over the middle of the plan, on the ground.
        "window": at the foot of the windows of the storeys `first` to `last`. "head": over the
        bays, at the upper end of the wall. "side": along the upper ends of the walls beside the
        front, whether or not a neighbour covers them.
    tint
        Whose colour it has: "wall", "trim", "frame", "accent", "sign" (a colour of its own per
        building) or "" for its own.
    first, last
        Storeys, counted from the ground floor 0; negative counts from the top one, -1.
    every
        Each so-manyth bay, pier, or storey has one.
    floors
        Of the storeys from `first` on, each so-manyth has one.
    spacing
        Metres between things along an edge or a plan; 0 for one alone. Corners nearer than this to
        one of the same part have none.
    lift, out
        Metres above and before where it would stand.
    stretch
        "" for real size; "wall" as wide as the wall, "bay" as wide as a bay (drawn 1 m wide),
        "height" from the foot to the top of the wall (drawn 1 m high), "gable" as wide as the wall
        and as high as the roof above it, "plan" as large as the plan (drawn 1 m by 1 m), "along"
        and "across" only as long or as wide as it; "storey" as high as a storey (drawn 1 m high),
        "cell" that and as wide as a bay, "opening" as wide and high as a window (drawn 1 m by 1 m),
        "round" as wide as the wall and on round its outer corners, as far as it stands out.
    street
        True: only walls at a street. False: only others. None: all.
    share
        Share of buildings, or with `scattered` of places, that have it.
    scattered
        Whether the share is drawn for each place.
    before
        Whether it may stand before doors and shopfronts, as an arcade does.
    """

    name: str
    at: At
    tint: Tint = ""
    first: int = 0
    last: int = 0
    every: int = 1
    floors: int = 1
    spacing: float = 0.0
    lift: float = 0.0
    out: float = 0.0
    stretch: Stretch = ""
    street: bool | None = None
    share: float = 1.0
    scattered: bool = False
    before: bool = False


@dataclass(frozen=True)
class FacadeStyle:
    """One style of facade; weighted tuples are drawn per building.

    Attributes
    ----------
    mode
        "punched", "strip", "curtain", "hall", "nave" or "shed", see `facade.grammar`.
    bay, sill, ground_storey, corner
        Metres: bay, height of sills above the floor, least height of the ground floor, solid wall
        at the ends.
    windows, surrounds, doors, heads
        Prototypes of windows; of what frames them ("" for nothing); of the main door; of the upper
        edge of the wall: "cornice", "coping", "eaves_board" or "".
    scale
        (width, height) of the windows relative to the size they were drawn for.
    back
        Surround of windows that face no street.
    balcony
        Share of buildings with balconies, and their prototypes.
    string, base
        Share of fronts with a string course, and of ground floors faced with stone or paint.
    cooling
        Share of windows with an outdoor unit beneath.
    pipe
        Whether rain pipes run down between houses.
    quoins
        Share of buildings with dressed stones, long and short in turn, up their free corners.
    fins, slabs
        Upright members between the bays, and level ones at the floors.
    fixtures
        Things of real size on walls, roofs and plots.
    entrance
        Whether the main door belongs here rather than in other zones.
    shops
        Least share of the buildings at streets that have shops on the ground floor.
    """

    mode: Mode
    bay: float
    windows: Weighted
    doors: Weighted
    sill: float = 0.9
    ground_storey: float = 3.2
    corner: float = 0.5
    surrounds: Weighted = (("sill", 1.0),)
    heads: Weighted = (("", 1.0),)
    scale: tuple[float, float] = (1.0, 1.0)
    back: str = "sill"
    balcony: float = 0.0
    balconies: Weighted = (("balcony_solid", 1.0),)
    string: float = 0.0
    base: Weighted = (("", 1.0),)
    cooling: float = 0.0
    pipe: bool = False
    quoins: float = 0.0
    fins: tuple[Strip, ...] = ()
    slabs: tuple[Strip, ...] = ()
    fixtures: tuple[Fixture, ...] = ()
    entrance: bool = False
    shops: float = 0.0
