"""Facade styles: the sizes and prototypes the facade grammar works with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

Weighted = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class FacadeStyle:
    """One style of facade; weighted tuples are drawn per building.

    Attributes
    ----------
    mode
        "punched", "strip", "curtain", "hall", "nave" or "shed", see `cityx.geometry.facades`.
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
    """

    mode: str
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


_S = FacadeStyle
FACADE_STYLES: Mapping[str, FacadeStyle] = MappingProxyType(
    {
        "classic": _S(
            "punched", 2.35, (("window_casement", 7), ("window_sash", 2)),
            (("door_double", 5), ("door_panel", 1)), sill=0.75, ground_storey=3.9, corner=0.45,
            surrounds=(("surround_flat", 4), ("surround_cap", 4), ("surround_pediment", 2),
                       ("surround_block", 1)),
            heads=(("cornice", 6), ("coping", 1)), balcony=0.4,
            balconies=(("balcony_iron", 3), ("balcony_rail", 1)), string=0.85,
            base=(("stone", 3), ("paint", 4), ("", 3)), pipe=True,
        ),
        "georgian": _S(
            "punched", 2.3, (("window_sash", 9), ("window_casement", 1)),
            (("door_panel", 6), ("door_glass", 1)), sill=0.8, ground_storey=3.7, corner=0.45,
            surrounds=(("surround_lintel", 5), ("surround_block", 3), ("surround_flat", 2),
                       ("surround_cap", 1)),
            heads=(("coping", 5), ("cornice", 4)), balcony=0.12, balconies=(("balcony_rail", 1),),
            string=0.6, base=(("paint", 4), ("stone", 2), ("", 4)), pipe=True,
        ),
        "plain": _S(
            "punched", 2.6, (("window_single", 3), ("window_casement", 4)),
            (("door_glass", 3), ("door_double", 2)), sill=0.85, ground_storey=3.2,
            surrounds=(("sill", 5), ("sill_metal", 3), ("surround_flat", 2)),
            heads=(("eaves_board", 3), ("coping", 2)), balcony=0.4,
            balconies=(("balcony_iron", 1), ("balcony_solid", 1), ("balcony_bars", 2)), string=0.3,
            base=(("paint", 3), ("", 5)), pipe=True,
        ),
        "modern": _S(
            "punched", 3.0, (("window_single", 4), ("window_office", 2)), (("door_glass", 1),),
            sill=0.55, ground_storey=3.6, corner=0.6, scale=(1.1, 1.2),
            surrounds=(("", 3), ("sill_metal", 3)), heads=(("coping", 1),), back="sill_metal",
            balcony=0.45, balconies=(("balcony_glass", 3), ("balcony_bars", 3),
                                     ("balcony_solid", 1)),
        ),
        "office": _S(
            "strip", 3.1, (("window_strip", 2), ("window_office", 3)), (("door_glass", 1),),
            sill=0.85, ground_storey=4.2, corner=0.4, scale=(1.0, 1.15),
            surrounds=(("", 1),), heads=(("coping", 1),), back="",
        ),
        "curtain": _S(
            "curtain", 1.5, (("window_office", 1),), (("door_glass", 1),), ground_storey=4.5,
            surrounds=(("", 1),), heads=(("coping", 1),), back="",
        ),
        "slab": _S(
            "punched", 3.1, (("window_single", 4), ("window_slider", 2)), (("door_glass", 1),),
            sill=0.9, ground_storey=3.0, surrounds=(("sill_metal", 1),), heads=(("coping", 1),),
            back="sill_metal", balcony=0.65, balconies=(("balcony_solid", 2), ("balcony_bars", 3),
                                     ("balcony_glass", 1)),
        ),
        "asian": _S(
            "punched", 2.5, (("window_slider", 5), ("window_single", 2)), (("door_glass", 1),),
            sill=0.9, ground_storey=3.4, corner=0.35, scale=(0.95, 1.1),
            surrounds=(("sill_metal", 3), ("", 2)), heads=(("coping", 1),), back="sill_metal",
            balcony=0.45, balconies=(("balcony_solid", 2), ("balcony_glass", 1),
                                     ("balcony_bars", 2),
                                     ("balcony_rail", 1)),
            cooling=0.3, pipe=True,
        ),
        "mediterranean": _S(
            "punched", 2.9, (("window_shuttered", 6), ("window_casement", 1)),
            (("door_double", 2), ("door_panel", 1)), sill=0.8, ground_storey=3.6,
            surrounds=(("sill", 3), ("surround_flat", 2)),
            heads=(("eaves_board", 3), ("cornice", 1), ("coping", 1)), balcony=0.6,
            balconies=(("balcony_iron", 4), ("balcony_rail", 2)), string=0.3,
            base=(("paint", 3), ("stone", 1), ("", 5)), cooling=0.06, pipe=True,
        ),
        "house": _S(
            "punched", 3.3, (("window_single", 4), ("window_casement", 1), ("window_cottage", 1)),
            (("door_house", 1),), ground_storey=2.7, corner=0.7, scale=(0.9, 0.9),
            surrounds=(("sill", 2), ("sill_metal", 2)), heads=(("eaves_board", 1),), balcony=0.15,
            balconies=(("balcony_solid", 1),), pipe=True,
        ),
        "cottage": _S(
            "punched", 3.0, (("window_sash", 2), ("window_cottage", 3)), (("door_house", 1),),
            ground_storey=2.7, corner=0.6, scale=(0.95, 0.85),
            surrounds=(("surround_block", 2), ("sill", 2), ("surround_lintel", 1)),
            heads=(("eaves_board", 1),), pipe=True,
        ),
        "warehouse": _S(
            "hall", 5.5, (("window_factory", 2), ("window_strip", 1)), (("door_service", 1),),
            ground_storey=4.0, corner=0.8, surrounds=(("", 1),), heads=(("coping", 1),), back="",
            scale=(1.25, 0.8),
        ),
        "box": _S(
            "punched", 4.0, (("window_office", 2), ("window_single", 1)), (("door_glass", 1),),
            ground_storey=4.0, corner=0.7, surrounds=(("", 1),), heads=(("coping", 1),), back="",
        ),
        "worship": _S(
            "nave", 4.5, (("window_arched", 1),), (("door_portal", 1),), corner=1.0,
            surrounds=(("", 1),), heads=(("cornice", 2), ("", 1)), back="",
        ),
        "shed": _S(
            "shed", 2.6, (("window_small", 1),), (("door_service", 1),), ground_storey=2.2,
            corner=0.3, surrounds=(("", 1),), back="",
        ),
        "walkup": _S(
            "punched", 2.5, (("window_sash", 6), ("window_single", 2)),
            (("door_panel", 3), ("door_glass", 2)), sill=0.8, ground_storey=3.7, corner=0.5,
            surrounds=(("surround_block", 6), ("surround_lintel", 2), ("surround_cap", 1)),
            heads=(("cornice", 5), ("coping", 3)), string=0.6,
            base=(("stone", 2), ("paint", 2), ("", 4)), cooling=0.08,
        ),
    }
)  # fmt: skip
