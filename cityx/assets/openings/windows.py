"""Windows as things that sit on a wall; see `cityx.assets.openings.frames`.

`WINDOWS` gives the opening each was drawn for. The forms for near views, of the same sizes, have
profiled frames and sashes, glazing bars, curtains and blinds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets.kept_prototypes import kept
from cityx.assets.openings import windows_houses as houses
from cityx.assets.openings import windows_old_town as old_town
from cityx.assets.openings import windows_towers as towers
from cityx.assets.openings.frames import (
    BACKING,
    FINE,
    GLASS,
    LINEN,
    PALE,
    PANE,
    PANE_MATERIAL,
    SASH,
    Shapes,
    arch,
    glazing,
    plate,
    set_back,
    slab,
)
from cityx.assets.openings.windows_halls import HALL_WINDOWS
from cityx.assets.shapes import bevelled, fine_shapes, moved, prism, prototype, tube
from cityx.assets.trims.mouldings import (
    bar,
    curtain,
    frame,
    hinge,
    knob,
    ledge,
    lever,
    raised_panel,
    rectangle,
    ring_moulding,
    slats,
    soft,
)
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype


def _shutters(width: float, height: float, *, leaf: float = 0.5, gap: float = 0.03) -> Shapes:
    """Make two open louvred shutters beside the opening."""
    shapes: Shapes = []
    for side in (-1, 1):
        near, far = side * (width / 2 + gap), side * (width / 2 + gap + leaf)
        x0, x1 = min(near, far), max(near, far)
        shapes.append(slab(x0, x1, 0.0, height, -0.045, "door_paint"))
        for z in np.linspace(0.12, height - 0.12, 7)[:-1]:
            top = z + (height - 0.24) / 6 - 0.09
            shapes.append(
                slab(x0 + 0.06, x1 - 0.06, z, top, -0.058, "door_paint",
                     (0.8, 0.8, 0.8), back=-0.045)
            )  # fmt: skip
    return shapes


Maker = Callable[[str, float, float], Shapes]


def window_sash(glass: str, blind: float, curtain: float) -> Shapes:
    """Sash window of two by two panes in each half, with a meeting rail."""
    shapes = glazing(1.05, 1.75, glass, columns=(0.5,), rows=(0.25, 0.75), bar=0.028,
                     blind=blind, curtain=curtain)  # fmt: skip
    shapes.append(slab(-0.47, 0.47, 0.85, 0.92, SASH - 0.012, "frame_paint", back=PANE))
    return shapes


def window_casement(glass: str, blind: float, curtain: float) -> Shapes:
    """Two casements under a two-light transom, the box window of the old quarters."""
    shapes = glazing(1.15, 1.9, glass, columns=(0.5,), frame=0.07, bar=0.075,
                     blind=blind, curtain=curtain)  # fmt: skip
    shapes.append(slab(-0.51, 0.51, 1.30, 1.38, SASH - 0.014, "frame_paint", back=PANE))
    return shapes


def window_single(glass: str, blind: float, curtain: float) -> Shapes:
    """Modern window with one fixed and one opening light."""
    return glazing(1.35, 1.5, glass, columns=(0.64,), frame=0.07, bar=0.08,
                   blind=blind, curtain=curtain)  # fmt: skip


def window_french(glass: str, blind: float, curtain: float) -> Shapes:
    """Pair of glazed doors to a balcony, with low solid panels."""
    shapes = glazing(1.3, 2.25, glass, columns=(0.5,), rows=(0.76,), frame=0.07, bar=0.07,
                     bottom=False, blind=blind, curtain=curtain)  # fmt: skip
    for x0, x1 in ((-0.57, -0.05), (0.05, 0.57)):
        shapes.append(slab(x0, x1, 0.0, 0.42, SASH + 0.008, "frame_paint", back=PANE))
    return shapes


def window_office(glass: str, blind: float, curtain: float) -> Shapes:
    """Wide office window of three lights over a panel."""
    shapes = glazing(2.2, 1.9, glass, columns=(1 / 3, 2 / 3), frame=0.06, bar=0.06,
                     blind=blind, curtain=curtain)  # fmt: skip
    shapes.append(slab(-1.04, 1.04, 0.42, 0.48, SASH, "frame_paint", back=PANE))
    return shapes


def window_strip(glass: str, blind: float, curtain: float) -> Shapes:
    """Ribbon window that meets its neighbours."""
    return glazing(3.0, 1.5, glass, columns=(0.25, 0.5, 0.75), frame=0.05, bar=0.05,
                   blind=blind, curtain=curtain)  # fmt: skip


def window_shuttered(glass: str, blind: float, curtain: float) -> Shapes:
    """Tall casement with open louvred shutters."""
    shapes = glazing(1.0, 1.6, glass, columns=(0.5,), rows=(0.36, 0.68), bar=0.04,
                     blind=blind, curtain=curtain)  # fmt: skip
    return shapes + _shutters(1.0, 1.6)


def window_small(glass: str, blind: float, curtain: float) -> Shapes:
    """Small window of a bathroom, stair or back wall."""
    return glazing(0.8, 0.95, glass, frame=0.06, blind=blind, curtain=curtain)


def window_cottage(glass: str, blind: float, curtain: float) -> Shapes:
    """Casement pair with glazing bars."""
    return glazing(1.2, 1.25, glass, columns=(0.25, 0.5, 0.75), rows=(0.34, 0.67), frame=0.06,
                   bar=0.028, blind=blind, curtain=curtain)  # fmt: skip


def window_slider(glass: str, blind: float, curtain: float) -> Shapes:
    """Aluminium sliding window of two leaves that overlap."""
    shapes = glazing(1.7, 1.2, glass, frame=0.045, blind=blind, curtain=curtain)
    shapes.append(slab(-0.03, 0.03, 0.045, 1.155, SASH - 0.015, "frame_paint", back=PANE))
    shapes.append(slab(-0.80, 0.0, 0.045, 0.085, SASH - 0.01, "frame_paint", back=PANE))
    shapes.append(slab(0.0, 0.80, 0.045, 0.085, SASH, "frame_paint", back=PANE))
    return shapes


def window_factory(glass: str, blind: float, curtain: float) -> Shapes:
    """Steel window of many small panes."""
    return glazing(2.4, 1.8, glass, columns=(1 / 6, 2 / 6, 3 / 6, 4 / 6, 5 / 6),
                   rows=(0.25, 0.5, 0.75), frame=0.05, bar=0.025,
                   blind=blind, curtain=curtain)  # fmt: skip


def window_arched(glass: str, blind: float, curtain: float) -> Shapes:
    """Tall window with a round head and tracery bars."""
    del blind, curtain
    shapes = [
        prism(arch(1.5, 4.0), -0.06, 0.0, "trim", (0.9, 0.88, 0.84)),
        moved(prism(arch(1.22, 3.74), -0.075, 0.0, glass), (0.0, 0.0, 0.12)),
    ]
    for x in (-0.2, 0.2):
        shapes.append(slab(x - 0.025, x + 0.025, 0.12, 3.7, -0.10, "metal_dark", back=-0.07))
    for z in (1.0, 1.9, 2.8):
        shapes.append(slab(-0.6, 0.6, z - 0.02, z + 0.02, -0.095, "metal_dark", back=-0.07))
    return shapes


FRAME_FRONT = 0.050
BOARD = 0.028  # metres from the lower edge of the opening to that of the frame: the sill board


@dataclass(frozen=True)
class Sash:
    """One light of a window.

    Attributes
    ----------
    x0, x1, z0, z1
        Shares of the frame's inside.
    columns, rows
        Panes across and up.
    y
        Metres its face lies behind the wall.
    hung
        "l", "r" or "": the side of its hinges.
    panel
        Share of its height that is a solid panel.
    """

    x0: float
    x1: float
    z0: float
    z1: float
    columns: int = 1
    rows: int = 1
    y: float = 0.064
    hung: str = ""
    panel: float = 0.0


@dataclass(frozen=True)
class Pattern:
    """What a window is made of: its size, its sashes, and what belongs to it besides."""

    width: float
    height: float
    sashes: tuple[Sash, ...]
    border: float = 0.055
    stile: float = 0.045
    bar: float = 0.013
    board: bool = True
    shutters: bool = False


_OFFICE = (*(Sash(i / 3, (i + 1) / 3, 0.24, 1.0, hung="l" if i == 0 else "") for i in range(3)),
           *(Sash(i / 3, (i + 1) / 3, 0.0, 0.24) for i in range(3)))  # fmt: skip
PATTERNS: Mapping[str, Pattern] = MappingProxyType(
    {
        "window_sash": Pattern(1.05, 1.75, (
            Sash(0, 1, 0.0, 0.52, 2, 2, 0.090), Sash(0, 1, 0.48, 1.0, 2, 2, 0.062)),
            border=0.05, stile=0.042, bar=0.010),
        "window_casement": Pattern(1.15, 1.9, (
            Sash(0, 0.5, 0, 0.70, hung="l"), Sash(0.5, 1, 0, 0.70, hung="r"),
            Sash(0, 0.5, 0.70, 1, 2, 1), Sash(0.5, 1, 0.70, 1, 2, 1))),
        "window_single": Pattern(1.35, 1.5, (
            Sash(0, 0.64, 0, 1, hung="l"), Sash(0.64, 1, 0, 1, hung="r")), stile=0.055),
        "window_french": Pattern(1.3, 2.25, (
            Sash(0, 0.5, 0, 0.76, 1, 2, hung="l", panel=0.26),
            Sash(0.5, 1, 0, 0.76, 1, 2, hung="r", panel=0.26),
            Sash(0, 0.5, 0.76, 1), Sash(0.5, 1, 0.76, 1)), board=False),
        "window_office": Pattern(2.2, 1.9, _OFFICE, stile=0.04),
        "window_strip": Pattern(3.0, 1.5, tuple(
            Sash(i / 4, (i + 1) / 4, 0, 1, hung="l" if i % 2 else "") for i in range(4)),
            border=0.045, stile=0.038),
        "window_shuttered": Pattern(1.0, 1.6, (
            Sash(0, 0.5, 0, 1, 1, 3, hung="l"), Sash(0.5, 1, 0, 1, 1, 3, hung="r")),
            shutters=True),
        "window_small": Pattern(0.8, 0.95, (Sash(0, 1, 0, 1, hung="l"),)),
        "window_cottage": Pattern(1.2, 1.25, (
            Sash(0, 0.5, 0, 1, 2, 3, hung="l"), Sash(0.5, 1, 0, 1, 2, 3, hung="r")), bar=0.010),
        "window_slider": Pattern(1.7, 1.2, (
            Sash(0, 0.515, 0, 1, y=0.066), Sash(0.485, 1, 0, 1, y=0.090)),
            border=0.04, stile=0.035),
        "window_factory": Pattern(2.4, 1.8, (
            Sash(0, 1 / 3, 0, 1, 2, 4), Sash(1 / 3, 2 / 3, 0, 0.5, 2, 2, hung="l"),
            Sash(1 / 3, 2 / 3, 0.5, 1, 2, 2), Sash(2 / 3, 1, 0, 1, 2, 4)),
            border=0.04, stile=0.022, bar=0.009),
    }
)  # fmt: skip
SLIDING = ("window_sash", "window_slider")


def fine_window(name: str, glass: str, dressing: int) -> Shapes:
    """Make a window for near views; see `window`."""
    if name == "window_arched":
        return arched_window(glass)
    pattern = PATTERNS[name]
    w, h = pattern.width / 2, pattern.height
    foot = BOARD if pattern.board else 0.012
    shapes: Shapes = [plate(rectangle(-w + 0.004, w - 0.004, 0.004, h - 0.004), BACKING, glass)]
    if pattern.board:
        shapes.append(_sill_board(w))
    else:
        step = [(0.13, 0.0), (0.13, 0.014), (0.03, 0.014), (-0.02, 0.008), (-0.02, 0.0)]
        shapes.append(ledge(step, -w, w, "metal_grey"))
    border, front = pattern.border, FRAME_FRONT
    outer = [(0.0, 0.135), (0.0, front), (0.7 * border, front), (0.82 * border, front + 0.008),
             (0.82 * border, front + 0.016), (border, front + 0.016), (border, 0.135)]  # fmt: skip
    shapes.append(frame(-w, w, foot, h, soft(outer, 0.005, 3), "frame_paint"))
    x0, z0 = -w + border, foot + border
    inner_w, inner_h = 2 * w - 2 * border, h - foot - 2 * border
    for sash in pattern.sashes:
        box = (x0 + sash.x0 * inner_w, x0 + sash.x1 * inner_w,
               z0 + sash.z0 * inner_h, z0 + sash.z1 * inner_h)  # fmt: skip
        shapes += _light(sash, pattern, *box)
    _fixed_bars(shapes, pattern, x0, z0, inner_w, inner_h)
    if name in SLIDING:
        shapes += _sliding_furniture(pattern, x0, z0, inner_w, inner_h)
    shapes += _dress(dressing, x0 + 0.01, x0 + inner_w - 0.01, z0, z0 + inner_h)
    if pattern.shutters:
        shapes += _fine_shutters(w, h)
    return shapes


def _sliding_furniture(
    pattern: Pattern, x0: float, z0: float, width: float, height: float
) -> Shapes:
    """Lifts, horns, catch and cords of sashes that slide up; pulls and track of those aside."""
    shapes: Shapes = []
    first, second = pattern.sashes
    if first.x1 < 1.0:  # they slide aside
        for sash, edge in ((first, first.x1), (second, second.x0)):
            x, z = x0 + edge * width, z0 + 0.5 * height
            way = -1.0 if sash is first else 1.0
            cup = [[x + way * 0.018, sash.y - 0.001, z + dz] for dz in (-0.05, -0.045, 0.045, 0.05)]
            shapes.append(tube(cup, [0.002, 0.008, 0.008, 0.002], "metal_grey", sides=10))
        for y in (first.y + 0.012, second.y + 0.012):
            shapes.append(tube([[x0, y, z0 + 0.004], [x0 + width, y, z0 + 0.004]], 0.005,
                               "metal_grey", sides=8))  # fmt: skip
        return shapes
    middle = z0 + second.z0 * height
    angle = np.linspace(0.0, np.pi, 10)
    for share in (0.27, 0.73):  # ring lifts on the lower sash
        x, z = x0 + share * width, z0 + 0.022
        ring = np.column_stack([x + 0.024 * np.cos(angle), first.y - 0.004 - 0.016 * np.sin(angle),
                                np.full(10, z)])  # fmt: skip
        shapes.append(tube(ring, 0.004, "metal_grey", sides=8))
        for side in (-0.024, 0.024):
            shapes.append(knob(x + side, z, first.y, 0.008))
    shapes.append(knob(x0 + 0.5 * width, middle + 0.03, second.y, 0.014))
    t = np.linspace(0.0, 1.0, 9)
    for x in (x0 + 0.002, x0 + width - pattern.stile + 0.002):  # horns under the upper sash
        out = 0.028 * (1 - t) ** 0.8 + 0.004 * np.sin(2 * np.pi * t)
        line = np.vstack([np.column_stack([second.y + 0.028 - out, middle - 0.075 * t]),
                          [(second.y + 0.028, middle - 0.075), (second.y + 0.028,
                              middle)]])  # fmt: skip
        shapes.append(ledge(line, x, x + pattern.stile - 0.004, "frame_paint"))
    for x in (x0 + 0.004, x0 + width - 0.004):  # cords in their grooves, and parting beads
        shapes.append(tube([[x, first.y - 0.004, z0 + 0.5 * height], [x, first.y - 0.004,
            z0 + height]],
                           0.003, "cloth", sides=6))  # fmt: skip
        shapes.append(tube([[x, second.y + 0.026, z0], [x, second.y + 0.026, z0 + height]], 0.005,
                           "frame_paint", sides=6))  # fmt: skip
    return shapes


def _sill_board(w: float) -> MeshBatch:
    """Sloping board of the sill: upstand at the frame, nose over the wall with a drip."""
    top = [(0.06, 0.040), (0.056, 0.040), (0.052, 0.032), (-0.022, 0.016), (-0.032, 0.012),
           (-0.035, 0.006), (-0.034, -0.006), (-0.031, -0.006), (-0.029, 0.004), (0.0, 0.002),
           (0.06, 0.002)]  # fmt: skip
    # Seen from +x with y to the right the outline above runs counter-clockwise.
    return ledge(top, -w, w, "metal_grey")


def _light(sash: Sash, pattern: Pattern, x0: float, x1: float, z0: float, z1: float) -> Shapes:
    """Make a sash: stiles and rails, panes, bars, hinges and furniture."""
    y, stile = sash.y, min(pattern.stile, 0.3 * (x1 - x0), 0.3 * (z1 - z0))
    line = [(0.0, y + 0.030), (0.0, y), (0.62 * stile, y), (0.70 * stile, y + 0.003),
            (0.78 * stile, y + 0.010), (0.92 * stile, y + 0.014), (stile, y + 0.016),
            (stile, y + 0.030)]  # fmt: skip
    shapes: Shapes = [frame(x0, x1, z0, z1, soft(line, 0.004, 3), "frame_paint")]
    a, b, low, high = x0 + stile, x1 - stile, z0 + stile, z1 - stile
    if sash.panel:
        top = z0 + sash.panel * (z1 - z0)
        shapes.append(plate(rectangle(a, b, low, top), y + 0.016, "frame_paint"))
        shapes += raised_panel(a + 0.01, b - 0.01, low + 0.01, top - 0.03, y + 0.016, "frame_paint")
        low = top
        shapes.append(bevelled((a, y + 0.002, top - 0.025), (b, y + 0.03, top + 0.02),
                               "frame_paint"))  # fmt: skip
    shapes.append(plate(rectangle(a - 0.004, b + 0.004, low, high + 0.004), y + 0.020,
                         PANE_MATERIAL))  # fmt: skip
    for share in np.arange(1, sash.columns) / sash.columns:
        x = a + share * (b - a)
        shapes.append(bar((x, low), (x, high), pattern.bar, y + 0.002, "frame_paint"))
    for share in np.arange(1, sash.rows) / sash.rows:
        z = low + share * (high - low)
        shapes.append(bar((a, z), (b, z), pattern.bar, y + 0.003, "frame_paint"))
    if sash.hung:
        edge, meet = (x0, x1) if sash.hung == "l" else (x1, x0)
        for share in (0.12, 0.88):
            shapes += hinge(edge, z0 + share * (z1 - z0), y - 0.004)
        turn = 1.0 if sash.hung == "r" else -1.0
        grip = z0 + min(0.5 * (z1 - z0), 1.05)
        inside = meet - turn * -0.022
        if sash.panel:
            shapes += lever(inside, grip, y, turn)
        else:
            shapes.append(knob(inside, grip, y, 0.014, "metal_dark"))
        # A weather bar throws rain off the foot of an opening light.
        drip = [(y - 0.022, 0.004), (y, 0.0), (y, 0.032), (y - 0.008, 0.026), (y - 0.018, 0.012)]
        shapes.append(ledge(np.array(drip) + np.array([0.0, z0 + 0.004]), x0 + 0.012, x1 - 0.012,
                            "frame_paint"))  # fmt: skip
    return shapes


def _fixed_bars(
    shapes: Shapes, pattern: Pattern, x0: float, z0: float, width: float, height: float
) -> None:
    """Mullions and transoms between sashes, one each, in front of their joints."""
    places = {(round(s.x0, 3), round(s.z0, 3), round(s.z1, 3)) for s in pattern.sashes if s.x0 > 0}
    y = FRAME_FRONT + 0.002
    for share, low, high in sorted(places):
        if any(abs(s.x1 - share) < 1e-3 for s in pattern.sashes):
            x = x0 + share * width
            shapes.append(bar((x, z0 + low * height), (x, z0 + high * height), 0.026, y,
                              "frame_paint", depth=0.03))  # fmt: skip
    for share in sorted({round(s.z0, 3) for s in pattern.sashes if s.z0 > 0}):
        if any(abs(s.z1 - share) < 1e-3 for s in pattern.sashes):
            z = z0 + share * height
            shapes.append(bar((x0, z), (x0 + width, z), 0.030, y - 0.006, "frame_paint",
                              depth=0.03))  # fmt: skip


def _dress(dressing: int, x0: float, x1: float, z0: float, z1: float) -> Shapes:
    """Hang what is behind the panes: see `DRESSINGS`."""
    y = 0.124
    width, height = x1 - x0, z1 - z0
    folds = max(3, round(0.5 * width / 0.075))
    side = max(2, folds // 2)
    shapes: Shapes = []
    if dressing == 0:  # drapes tied back at the sides
        reach = 0.15 * width
        shapes.append(curtain(x0, x0 + reach, z0, z1, y, folds=side, tied=0.35, tint=LINEN))
        shapes.append(curtain(x1, x1 - reach, z0, z1, y, folds=side, tied=0.35, tint=LINEN))
    elif dressing == 1:
        shapes += slats(x0, x1, z1 - 0.40 * height, z1, y, tint=PALE)
    elif dressing == 2:
        reach = 0.30 * width
        shapes.append(curtain(x0, x0 + reach, z0, z1, y, folds=folds, tied=0.2, tint=PALE))
        shapes.append(curtain(x1, x1 - reach, z0, z1, y, folds=folds, tied=0.2, tint=PALE))
    else:
        shapes += slats(x0, x1, z1 - 0.72 * height, z1, y, tint=PALE)
    shapes.append(_pelmet(x0, x1, z1, y))
    return shapes


def _pelmet(x0: float, x1: float, z: float, y: float) -> MeshBatch:
    """Rail that curtains and blinds hang from."""
    return tube([[x0, y, z - 0.012], [x1, y, z - 0.012]], 0.008, "metal_grey", sides=8)


def _fine_shutters(w: float, h: float, *, leaf: float = 0.5, gap: float = 0.03) -> Shapes:
    """Open louvred shutters on pintles beside the window, with their holdbacks."""
    shapes: Shapes = []
    for side in (-1, 1):
        near, far = side * (w + gap), side * (w + gap + leaf)
        x0, x1 = min(near, far), max(near, far)
        stile = [(0.0, -0.008), (0.0, -0.040), (0.05, -0.040), (0.056, -0.034), (0.056, -0.010)]
        for low, high in ((0.0, 0.47 * h), (0.47 * h, h)):
            shapes.append(frame(x0, x1, low, high, soft(stile, 0.004, 2), "door_paint"))
            shapes.append(plate(rectangle(x0 + 0.05, x1 - 0.05, low + 0.05, high - 0.05), -0.010,
                                 "door_paint"))  # fmt: skip
            for z in np.arange(low + 0.07, high - 0.06, 0.034):
                blade = np.array([(-0.036, -0.014), (-0.032, -0.016), (-0.011, 0.012),
                                  (-0.014, 0.016)])  # fmt: skip
                shapes.append(ledge(blade + np.array([0.0, z]), x0 + 0.054, x1 - 0.054,
                    "door_paint",
                                    (0.88, 0.88, 0.88)))  # fmt: skip
        for z in (0.16 * h, 0.84 * h):
            x = side * (w + 0.012)
            shapes += hinge(x, z, -0.022, "metal_dark")
            strap = sorted((side * (w + 0.01), side * (w + gap + 0.6 * leaf)))
            shapes.append(bevelled((strap[0], -0.046, z - 0.018), (strap[1], -0.040, z + 0.018),
                                   "metal_dark"))  # fmt: skip
        shapes.append(knob(side * (w + gap + 0.85 * leaf), -0.06, 0.0, 0.02, "metal_dark"))
    return shapes


def arched_window(glass: str) -> Shapes:
    """Tall window with a round head: moulded jambs, tracery, leaded panes and saddle bars."""
    outline = arch(1.5, 4.0, 16)
    shapes: Shapes = [plate(outline, BACKING, glass)]
    jamb = [(0.0, 0.0), (0.02, 0.0), (0.03, 0.012), (0.05, 0.02), (0.06, 0.035), (0.075, 0.04),
            (0.09, 0.055), (0.10, 0.075), (0.14, 0.08), (0.14, 0.135)]  # fmt: skip
    shapes.append(ring_moulding(outline, soft(jamb, 0.012, 3), "trim", (0.9, 0.88, 0.84)))
    clear = arch(1.23, 3.86, 16) + np.array([0.0, 0.13])
    clear[:, 1] = np.minimum(clear[:, 1], 3.86)
    shapes.append(plate(clear, 0.115, PANE_MATERIAL))
    for x in (-0.2, 0.2):
        shapes.append(bar((x, 0.13), (x, 3.42), 0.045, 0.06, "trim", depth=0.07))
    for sign in (-1.0, 1.0):
        angle = np.linspace(0.0, 0.62 * np.pi, 12)
        path = np.column_stack([sign * (0.2 - 0.42 * (1 - np.cos(angle))), np.full(12, 0.095),
                                3.0 + 0.56 * np.sin(angle)])  # fmt: skip
        inside = np.abs(path[:, 0]) < 0.6
        shapes.append(tube(path[inside], 0.032, "trim", sides=10))
    for z in np.arange(0.5, 3.4, 0.42):
        shapes.append(tube([[-0.6, 0.098, z], [0.6, 0.098, z]], 0.009, "metal_dark", sides=8))
    for z in np.arange(0.26, 3.3, 0.21):
        shapes.append(bar((-0.6, z), (0.6, z), 0.005, 0.106, "metal_dark", depth=0.008))
    for x in np.arange(-0.53, 0.56, 0.132):
        shapes.append(bar((x, 0.13), (x, 3.3), 0.005, 0.107, "metal_dark", depth=0.008))
    sill = [(0.13, 0.0), (0.13, 0.13), (0.10, 0.13), (0.0, 0.04), (-0.05, 0.02), (-0.05, -0.02),
            (-0.03, -0.02), (-0.025, 0.0)]  # fmt: skip
    shapes.append(ledge(sill, -0.74, 0.74, "trim", (0.9, 0.88, 0.84)))
    return shapes


# Name -> maker and the width and height it was drawn for.
WINDOWS: Mapping[str, tuple[Maker, float, float]] = MappingProxyType(
    {
        "window_sash": (window_sash, 1.05, 1.75),
        "window_casement": (window_casement, 1.15, 1.9),
        "window_single": (window_single, 1.35, 1.5),
        "window_french": (window_french, 1.3, 2.25),
        "window_office": (window_office, 2.2, 1.9),
        "window_strip": (window_strip, 3.0, 1.5),
        "window_shuttered": (window_shuttered, 1.0, 1.6),
        "window_small": (window_small, 0.8, 0.95),
        "window_cottage": (window_cottage, 1.2, 1.25),
        "window_slider": (window_slider, 1.7, 1.2),
        "window_factory": (window_factory, 2.4, 1.8),
        "window_arched": (window_arched, 1.5, 4.0),
        "window_pair": (towers.window_pair, 2.0, 1.8),
        "window_deep": (towers.window_deep, 2.4, 2.0),
        "window_slit": (towers.window_slit, 0.5, 2.3),
        "window_wide": (towers.window_wide, 2.6, 2.4),
        "window_lattice": (towers.window_lattice, 1.9, 1.9),
        "window_grille": (towers.window_grille, 3.0, 1.3),
        "window_moderne": (towers.window_moderne, 1.95, 1.4),
        "window_ribbon": (towers.window_ribbon, 1.3, 1.4),
        "window_deco": (towers.window_deco, 1.3, 1.9),
        "window_glass_block": (towers.window_glass_block, 1.5, 2.5),
        "window_picture": (houses.window_picture, 2.7, 1.55),
        "window_grid": (houses.window_grid, 0.95, 1.5),
        "window_leaded": (houses.window_leaded, 1.3, 1.0),
        "window_terrace": (houses.window_terrace, 1.75, 1.95),
        "window_prow": (houses.window_prow, 1.8, 1.6),
        "window_temple": (houses.window_temple, 2.3, 2.5),
        "window_barn": (houses.window_barn, 0.8, 0.8),
        "window_parisian": (old_town.window_parisian, 1.15, 2.3),
        "window_persiana": (old_town.window_persiana, 1.0, 1.7),
        "window_georgian": (old_town.window_georgian, 1.05, 1.95),
        "window_tenement": (old_town.window_tenement, 1.0, 1.75),
        "window_block": (old_town.window_block, 1.7, 1.75),
        "window_cross": (old_town.window_cross, 1.1, 1.9),
        "window_mullioned": (old_town.window_mullioned, 1.5, 2.6),
        "window_panel": (old_town.window_panel, 1.8, 1.4),
        **HALL_WINDOWS,
    }
)
# What is drawn behind the pane: nothing, a blind half down, curtains, a blind nearly closed.
DRESSINGS: tuple[tuple[float, float], ...] = ((0.0, 0.0), (0.38, 0.0), (0.0, 0.22), (0.7, 0.0))


@lru_cache(maxsize=512)
@kept("window", least=FINE)
def window(name: str, dressing: int = 0, *, detail: int = 2) -> Prototype:
    """Make a window prototype.

    Parameters
    ----------
    name
        Key of `WINDOWS`.
    dressing
        Index into `DRESSINGS`.
    detail
        Level of detail; from `FINE` on it fills a niche.

    Raises
    ------
    KeyError
        If there is no such window.
    """
    maker = WINDOWS[name][0]
    suffix = f"_{dressing}"
    if detail >= FINE:
        if name == "window_arched" or name in PATTERNS:
            shapes = fine_window(name, GLASS, dressing)
        else:
            with fine_shapes():
                shapes = set_back(maker(GLASS, *DRESSINGS[dressing]))
        return prototype(f"{name}{suffix}_fine", "window", shapes)
    return prototype(name + suffix, "window", maker(GLASS, *DRESSINGS[dressing]))
