"""Windows drawn for near views: profiled frames and sashes, glazing bars, curtains, blinds.

Each fills a niche: y = 0 is the face of the wall, `NICHE_DEPTH` its back; -y stands out. They have
the sizes of their plain forms in `cityx.assets.openings.openings`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from cityx.assets.shapes import Color, bevelled, tube
from cityx.assets.trims.mouldings import (
    Shapes,
    bar,
    curtain,
    frame,
    hinge,
    knob,
    ledge,
    lever,
    portal,
    raised_panel,
    rectangle,
    ring_moulding,
    slats,
    soft,
)
from cityx.city.mesh import MeshBatch, one_mesh

BACKING = 0.136  # metres; the dark of the room
FRAME_FRONT = 0.050
PANE_MATERIAL = "pane"
BOARD = 0.028  # metres from the lower edge of the opening to that of the frame: the sill board
DWELLING = 2.45  # metres; no window of a dwelling is wider or taller
PALE: Color = (0.92, 0.91, 0.88)
LINEN: Color = (0.80, 0.77, 0.70)


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
    """Make a window for near views; see `cityx.assets.openings.openings.window`."""
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
        shapes += _shutters(w, h)
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


def fine_glazing(
    width: float,
    height: float,
    glass: str,
    *,
    columns: Sequence[float],
    rows: Sequence[float],
    frame_width: float,
    bar_width: float,
    bottom: bool,
    blind: float,
    drawn: float,
) -> Shapes:
    """Make frame, panes, bars and dressing of a window that has only a plain form.

    Arguments are those of `openings.glazing`; like there, all of it stands before the
    plane y = 0.
    """
    w = width / 2
    line = [(0.0, 0.0), (0.0, -0.075), (0.6 * frame_width, -0.075), (0.75 * frame_width, -0.068),
            (0.9 * frame_width, -0.060), (frame_width, -0.056), (frame_width, -0.012)]  # fmt: skip
    sweep = frame if bottom else portal
    shapes: Shapes = [sweep(-w, w, 0.0, height, soft(line, 0.004, 3), "frame_paint")]
    inside = w - 0.8 * frame_width
    low = 0.8 * frame_width if bottom else 0.0
    top = height - 0.8 * frame_width
    opening = rectangle(-inside, inside, low, top)
    shapes += [plate(opening, -0.012, glass), plate(opening, -0.050, PANE_MATERIAL)]
    for share in columns:
        x = -w + share * width
        shapes.append(bar((x, low), (x, top), bar_width / 2, -0.062, "frame_paint"))
    for share in rows:
        z = share * height
        shapes.append(bar((-inside, z), (inside, z), bar_width / 2, -0.064, "frame_paint"))
    folds = max(2, round(inside * 0.6 / 0.075))
    if blind:
        shapes += slats(-inside, inside, top - blind * (top - low), top, -0.030, tint=PALE)
        return shapes
    # Rooms that one lives in have drapes at least; halls and works have large or barred windows.
    lived_in = max(width, height) < DWELLING and len(columns) * len(rows) < 6
    if drawn or lived_in:
        reach = (1.4 * drawn if drawn else 0.15) * 2 * inside
        tied, tint = (0.2, PALE) if drawn else (0.35, LINEN)
        for edge, end in ((-inside, -inside + reach), (inside, inside - reach)):
            shapes.append(curtain(edge, end, low, top, -0.030, folds=folds, tied=tied, tint=tint))
    return shapes


def plate(outline: object, y: float, material: str) -> MeshBatch:
    """Make a flat face on a convex outline that faces outward."""
    ring = np.asarray(outline, float)
    corners = np.column_stack([ring[:, 0], np.full(len(ring), y), ring[:, 1]])
    fan = [[0, i, i + 1] for i in range(1, len(ring) - 1)]
    faces = [[0, 1, 2, 3]] if len(ring) == 4 else fan
    uv = np.zeros((len(faces), 4, 2))
    for row, face in enumerate(faces):
        uv[row, : len(face)] = ring[face]
    return one_mesh(0, corners, faces, materials=(material,), uv=uv)


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
    """Hang what is behind the panes: see `cityx.assets.openings.openings.DRESSINGS`."""
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


def _shutters(w: float, h: float, *, leaf: float = 0.5, gap: float = 0.03) -> Shapes:
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
    from cityx.assets.openings.openings import arch

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
