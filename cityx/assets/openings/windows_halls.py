"""Windows and doors of halls: churches, mosques, schools, hospitals, stations and works.

They lie on the wall plane as those of `openings.frames`, which lists them: x along the wall,
-y outward, z up, bottom centre at the origin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.shapes import WHITE, Color, box, prism, tube
from cityx.assets.trims.mouldings import rectangle, ring_moulding
from cityx.city.mesh import MeshBatch, one_mesh

Shapes = list[MeshBatch]
Outline = NDArray[np.float64]
PANE = -0.022  # metres before the wall, as of all panes
STONE: Color = (0.90, 0.88, 0.84)
SHADE: Color = (0.62, 0.60, 0.57)


# --- outlines: (k, 2) of x and z, counter-clockwise seen from outside -----------------------------


def pointed(width: float, height: float, *, sharp: float = 1.0, sides: int = 6) -> Outline:
    """Outline of an opening with a pointed arch, its arcs `sharp` widths in radius."""
    half, radius = width / 2, sharp * width
    rise = math.sqrt(radius**2 - (radius - half) ** 2)
    spring = height - rise
    x = np.linspace(half, 0.0, sides + 1)
    z = spring + np.sqrt(np.maximum(radius**2 - (x + radius - half) ** 2, 0.0))
    right = np.column_stack([x, z])
    left = right[-2::-1] * [-1.0, 1.0]
    return np.vstack([[[-half, 0.0], [half, 0.0]], right, left])


def ogee(width: float, height: float, *, sides: int = 5) -> Outline:
    """Outline of an opening with an arch of four centres that ends in a drawn-up tip."""
    half, rise = width / 2, 0.72 * width
    spring = height - rise
    t = np.linspace(0.0, 1.0, 2 * sides + 1)
    x = half * (1.0 - t) ** 1.0
    z = np.where(t < 0.7, 0.78 * np.sin(t / 0.7 * math.pi / 2), 0.0)
    tip = np.clip((t - 0.7) / 0.3, 0.0, 1.0)
    z = np.where(t >= 0.7, 0.78 + 0.22 * tip**1.6, z)
    right = np.column_stack([x, spring + rise * z])
    left = right[-2::-1] * [-1.0, 1.0]
    return np.vstack([[[-half, 0.0], [half, 0.0]], right, left])


def rounded(width: float, height: float, *, rise: float | None = None, sides: int = 8) -> Outline:
    """Outline of an opening with a round or, with less `rise`, a segmental arch."""
    half = width / 2
    up = half if rise is None else rise
    angle = np.linspace(0.0, math.pi, sides + 1)
    head = np.column_stack([half * np.cos(angle), height - up + up * np.sin(angle)])
    return np.vstack([[[-half, 0.0], [half, 0.0]], head])


# --- pieces ---------------------------------------------------------------------------------------


def face(outline: Outline, y: float, material: str, tint: Color = WHITE) -> MeshBatch:
    """Make a flat face that looks outward, a fan about the middle of its outline."""
    ring = np.asarray(outline, float)
    middle = ring.mean(axis=0)
    flat = np.vstack([ring, middle])
    count = len(ring)
    at = np.arange(count)
    faces = np.column_stack([at, (at + 1) % count, np.full(count, count), np.full(count, -1)])
    corners = np.column_stack([flat[:, 0], np.full(count + 1, y), flat[:, 1]])
    uv = flat[np.where(faces < 0, count, faces)]
    return one_mesh(0, corners, faces, materials=(material,), uv=uv, tint=tint)


def rim(outline: Outline, border: float, front: float, material: str, tint: Color = WHITE,
        *, back: float = PANE) -> MeshBatch:  # fmt: skip
    """Frame an outline inward, with an outer side, a face and a reveal down to the pane."""
    profile = [(0.0, 0.0), (0.0, front), (0.6 * border, front), (border, 0.5 * (front + back)),
               (border, back)]  # fmt: skip
    return ring_moulding(outline, profile, material, tint)


def strip(x0: float, x1: float, z0: float, z1: float, front: float, material: str,
          tint: Color = WHITE, *, back: float = 0.0) -> MeshBatch:  # fmt: skip
    """Make a box against the wall."""
    return box((x0, front, z0), (x1, back, z1), material, tint)


def _bars(
    width: float, height: float, columns: int, rows: int, *, half: float = 0.015,
    front: float = -0.05, material: str = "frame_paint", foot: float = 0.0,
) -> Shapes:  # fmt: skip
    """Glazing bars that divide a rectangle into panes."""
    shapes: Shapes = []
    for x in np.linspace(-width / 2, width / 2, columns + 1)[1:-1]:
        shapes.append(strip(x - half, x + half, foot, height, front, material, back=PANE))
    for z in np.linspace(foot, height, rows + 1)[1:-1]:
        shapes.append(
            strip(-width / 2, width / 2, z - half, z + half, front + 0.004, material, back=PANE)
        )
    return shapes


def _rectangular(width: float, height: float, glass: str, columns: int, rows: int, *,
                 border: float = 0.06, half: float = 0.018) -> Shapes:  # fmt: skip
    outline = rectangle(-width / 2, width / 2, 0.0, height)
    return [
        face(outline, PANE, glass),
        rim(outline, border, -0.07, "frame_paint"),
        *_bars(width - border, height - border / 2, columns, rows, half=half, foot=border / 2),
    ]


# --- windows: glass, share of a blind, share of curtains ------------------------------------------


def window_tracery(glass: str, blind: float, curtain: float) -> Shapes:
    """Gothic window of two lights under a foiled circle, in a moulded stone frame."""
    del blind, curtain
    outline = pointed(1.6, 4.2)
    shapes = [
        face(outline, PANE, glass),
        rim(outline, 0.20, -0.10, "frame_paint", STONE),
        strip(-0.86, 0.86, -0.14, 0.06, -0.16, "frame_paint", STONE),
        strip(-0.05, 0.05, 0.0, 2.75, -0.085, "frame_paint", STONE, back=PANE),
    ]
    for side in (-1.0, 1.0):
        head = pointed(0.62, 0.62, sides=4)[1:] * [1.0, 1.0] + [side * 0.31, 2.40]
        path = np.column_stack([head[:, 0], np.full(len(head), -0.05), head[:, 1]])
        shapes.append(tube(path, 0.045, "frame_paint", STONE, sides=4))
    angle = np.linspace(0.0, 2 * np.pi, 13)
    ring = np.column_stack([0.24 * np.cos(angle), np.full(13, -0.05), 3.28 + 0.24 * np.sin(angle)])
    shapes.append(tube(ring, 0.045, "frame_paint", STONE, sides=4))
    for z in (0.75, 1.5, 2.2):
        shapes.append(strip(-0.62, 0.62, z - 0.012, z + 0.012, -0.04, "metal_dark", back=PANE))
    return shapes


def window_lancet(glass: str, blind: float, curtain: float) -> Shapes:
    """Narrow pointed window in a plain stone frame."""
    del blind, curtain
    outline = pointed(0.8, 2.6)
    return [
        face(outline, PANE, glass),
        rim(outline, 0.14, -0.08, "frame_paint", STONE),
        strip(-0.46, 0.46, -0.12, 0.04, -0.13, "frame_paint", STONE),
        *[strip(-0.3, 0.3, z - 0.01, z + 0.01, -0.035, "metal_dark", back=PANE)
          for z in (0.6, 1.1, 1.6)],
    ]  # fmt: skip


def window_belfry(glass: str, blind: float, curtain: float) -> Shapes:
    """Sound opening of a bell chamber: a pointed arch with sloping louvres."""
    del glass, blind, curtain
    outline = pointed(1.3, 3.0)
    shapes = [
        face(outline, -0.012, "metal_dark"),
        rim(outline, 0.18, -0.10, "frame_paint", STONE, back=-0.012),
        strip(-0.72, 0.72, -0.14, 0.05, -0.15, "frame_paint", STONE),
    ]
    for z in np.arange(0.16, 2.35, 0.26):
        half = 0.48 if z < 1.8 else 0.48 * math.sqrt(max(1 - ((z - 1.8) / 1.0) ** 2, 0.1))
        shapes.append(strip(-half, half, z, z + 0.13, -0.07, "bench_wood", (0.75, 0.75, 0.75),
                            back=-0.012))  # fmt: skip
    return shapes


def window_ogee(glass: str, blind: float, curtain: float) -> Shapes:
    """Window with an arch of four centres: panes below, a lattice of plaster in the head."""
    del blind, curtain
    outline = ogee(1.3, 3.0)
    shapes = [
        face(outline, PANE, glass),
        rim(outline, 0.15, -0.08, "frame_paint"),
        strip(-0.78, 0.78, -0.10, 0.04, -0.12, "frame_paint"),
        strip(-0.56, 0.56, 1.86, 1.98, -0.06, "frame_paint", back=PANE),
        strip(-0.03, 0.03, 0.04, 1.9, -0.05, "frame_paint", back=PANE),
    ]
    for z in (0.65, 1.25):
        shapes.append(strip(-0.52, 0.52, z - 0.02, z + 0.02, -0.045, "frame_paint", back=PANE))
    for start in np.arange(-0.9, 0.5, 0.3):
        for lean in (1.0, -1.0):
            a, b = lean * start, lean * (start + 0.62)
            low, high = max(-0.5, min(a, b)), min(0.5, max(a, b))
            if high - low > 0.12:
                za, zb = (
                    2.0 + 0.62 * (low - min(a, b)) / 0.62,
                    2.0 + 0.62 * (high - min(a, b)) / 0.62,
                )
                ends = [(low, za), (high, zb)] if lean > 0 else [(high, za), (low, zb)]
                path = [[x, -0.035, min(z, 2.62 - 0.5 * abs(x))] for x, z in ends]
                shapes.append(tube(path, 0.022, "frame_paint", sides=4))
    return shapes


def window_ward(glass: str, blind: float, curtain: float) -> Shapes:
    """Wide window of a ward: a fixed light, an opening one, a coloured panel, an outside blind."""
    del curtain
    shapes = _rectangular(2.6, 1.7, glass, 1, 1)
    shapes += [
        strip(0.55, 1.27, 0.03, 1.67, -0.045, "door_paint", (0.85, 0.85, 0.85), back=PANE),
        strip(0.50, 0.57, 0.03, 1.67, -0.06, "frame_paint", back=PANE),
        strip(-0.42, -0.35, 0.03, 1.67, -0.06, "frame_paint", back=PANE),
        strip(-1.34, 1.34, 1.70, 1.88, -0.14, "metal_grey"),
        strip(-1.36, 1.36, -0.05, 0.0, -0.12, "metal_grey"),
    ]
    if blind:
        low = 1.68 - 1.6 * blind
        shapes.append(
            strip(-1.26, 0.5, low, 1.7, -0.055, "curtain", (0.82, 0.82, 0.80), back=-0.03)
        )
    return shapes


def window_class(glass: str, blind: float, curtain: float) -> Shapes:
    """Ribbon window of a class room: large fixed lights over opening ones, a coloured panel."""
    del curtain
    shapes = _rectangular(3.0, 2.0, glass, 3, 1)
    shapes += [
        strip(-1.47, 1.47, 0.50, 0.57, -0.06, "frame_paint", back=PANE),
        strip(0.53, 1.47, 0.03, 0.50, -0.05, "door_paint", back=PANE),
        strip(-1.5, 1.5, -0.05, 0.0, -0.11, "metal_grey"),
    ]
    if blind:
        low = 1.96 - 1.4 * blind
        shapes.append(
            strip(-1.44, 1.44, low, 1.96, -0.032, "curtain", (0.86, 0.84, 0.78), back=PANE)
        )
    return shapes


def window_steel(glass: str, blind: float, curtain: float) -> Shapes:
    """Steel window of works: a segmental arch, many panes, a vent that stands open."""
    del blind, curtain
    outline = rounded(3.0, 3.4, rise=0.45)
    shapes = [
        face(outline, PANE, glass),
        rim(outline, 0.05, -0.055, "frame_paint"),
        *_bars(2.9, 2.98, 6, 5, half=0.014, front=-0.045),
        strip(-1.62, 1.62, -0.12, 0.0, -0.12, "trim", (0.85, 0.85, 0.85)),
        # A vent leans out from its upper rail.
        one_mesh(
            0,
            [[-0.48, -0.20, 1.20], [0.48, -0.20, 1.20], [0.48, -0.05, 1.79], [-0.48, -0.05, 1.79]],
            [[0, 1, 2, 3], [3, 2, 1, 0]], materials=(glass,),
        ),
        strip(-0.50, 0.50, 1.77, 1.81, -0.07, "frame_paint", back=PANE),
    ]  # fmt: skip
    for x in (-0.49, 0.49):
        shapes.append(tube([[x, -0.20, 1.20], [x, -0.05, 1.79]], 0.016, "frame_paint", sides=4))
    shapes.append(tube([[-0.49, -0.2, 1.2], [0.49, -0.2, 1.2]], 0.016, "frame_paint", sides=4))
    lintel = rounded(3.36, 3.66, rise=0.5)[2:]
    inner = rounded(3.0, 3.4, rise=0.45)[2:]
    # The arch of bricks over it.
    for a, b, c, d in zip(lintel[:-1], lintel[1:], inner[1:], inner[:-1], strict=True):
        shapes.append(prism([a, b, c, d], -0.035, 0.0, "brick", (0.36, 0.16, 0.11)))
    return shapes


def window_hall(glass: str, blind: float, curtain: float) -> Shapes:
    """Band of light of a hall: profiled glass in an aluminium frame."""
    del blind, curtain
    shapes = _rectangular(4.0, 1.5, glass, 8, 1, half=0.012)
    shapes.append(strip(-2.04, 2.04, -0.05, 0.0, -0.10, "metal_grey"))
    return shapes


def window_station(glass: str, blind: float, curtain: float) -> Shapes:
    """Round-headed window with a fanlight and a moulded archivolt."""
    del blind, curtain
    outline = rounded(1.5, 3.2, sides=10)
    shapes = [
        face(outline, PANE, glass),
        rim(outline, 0.09, -0.07, "frame_paint"),
        strip(-0.70, 0.70, 2.38, 2.48, -0.06, "frame_paint", back=PANE),
        strip(-0.03, 0.03, 0.05, 3.12, -0.05, "frame_paint", back=PANE),
        strip(-0.95, 0.95, -0.14, 0.0, -0.17, "trim"),
        prism([(-0.1, 3.14), (0.1, 3.14), (0.15, 3.58), (-0.15, 3.58)], -0.13, 0.0, "trim"),
    ]
    for angle in (math.pi / 4, 3 * math.pi / 4):
        tip = (0.68 * math.cos(angle), 2.45 + 0.68 * math.sin(angle))
        shapes.append(tube([[0, -0.04, 2.45], [tip[0], -0.04, tip[1]]], 0.022, "frame_paint",
                           sides=4))  # fmt: skip
    for z in (0.9, 1.65):
        shapes.append(strip(-0.68, 0.68, z - 0.018, z + 0.018, -0.045, "frame_paint", back=PANE))
    outer, inner = rounded(1.96, 3.43, sides=10)[2:], rounded(1.5, 3.2, sides=10)[2:]
    for a, b, c, d in zip(outer[:-1], outer[1:], inner[1:], inner[:-1], strict=True):
        shapes.append(prism([a, b, c, d], -0.07, 0.0, "trim"))
    for side in (-1, 1):
        x0, x1 = sorted((side * 0.75, side * 0.98))
        shapes.append(strip(x0, x1, 0.0, 2.45, -0.06, "trim"))
    return shapes


def window_gallery(glass: str, blind: float, curtain: float) -> Shapes:
    """Open gallery of a stand: a dark opening behind a parapet with a rail."""
    del glass, blind, curtain
    return [
        face(rectangle(-2.0, 2.0, 0.0, 2.6), -0.012, "metal_dark"),
        strip(-2.0, 2.0, 0.0, 0.85, -0.14, "frame_paint"),
        strip(-2.0, 2.0, 1.02, 1.08, -0.12, "metal_grey", back=-0.06),
        *[strip(x - 0.02, x + 0.02, 0.85, 1.05, -0.11, "metal_grey", back=-0.07)
          for x in (-1.6, -0.8, 0.0, 0.8, 1.6)],
        strip(-2.0, 2.0, 2.5, 2.6, -0.10, "frame_paint"),
    ]  # fmt: skip


# Name -> maker and the width and height it was drawn for.
HALL_WINDOWS: Mapping[str, tuple[Callable[[str, float, float], Shapes], float, float]] = (
    MappingProxyType(
        {
            "window_tracery": (window_tracery, 1.6, 4.2),
            "window_lancet": (window_lancet, 0.8, 2.6),
            "window_belfry": (window_belfry, 1.3, 3.0),
            "window_ogee": (window_ogee, 1.3, 3.0),
            "window_ward": (window_ward, 2.6, 1.7),
            "window_class": (window_class, 3.0, 2.0),
            "window_steel": (window_steel, 3.0, 3.4),
            "window_hall": (window_hall, 4.0, 1.5),
            "window_station": (window_station, 1.96, 3.58),
            "window_gallery": (window_gallery, 4.0, 2.6),
        }
    )
)


# --- doors ----------------------------------------------------------------------------------------


def door_gothic() -> Shapes:
    """Leaves of a church door under a pointed arch, with iron bands."""
    shapes = [
        face(pointed(1.8, 3.7), -0.05, "door_paint"),
        strip(-0.02, 0.02, 0.05, 3.3, -0.075, "metal_dark", back=-0.05),
    ]
    for z in (0.7, 1.9):
        shapes.append(strip(-0.84, 0.84, z, z + 0.06, -0.07, "metal_dark", back=-0.05))
    return shapes


def door_ogee() -> Shapes:
    """Leaves of a mosque's door under an arch of four centres, studded in fields."""
    shapes = [
        face(ogee(1.8, 3.6), -0.05, "door_paint"),
        strip(-0.02, 0.02, 0.05, 3.0, -0.08, "metal_dark", back=-0.05),
    ]
    for z in (0.35, 1.05, 1.75):
        for x in (-0.78, 0.14):
            shapes.append(strip(x, x + 0.64, z, z + 0.55, -0.07, "door_paint", SHADE, back=-0.05))
    return shapes


def door_auto() -> Shapes:
    """Automatic sliding doors between fixed lights, under a deep metal canopy."""
    shapes = [
        face(rectangle(-1.8, 1.8, 0.0, 2.75), PANE, "glass"),
        rim(rectangle(-1.85, 1.85, -0.02, 2.8), 0.07, -0.08, "frame_paint"),
        strip(-1.8, 1.8, 2.2, 2.42, -0.10, "metal_grey"),
        strip(-2.6, 2.6, 2.85, 3.1, -2.2, "frame_paint"),
        strip(-2.5, 2.5, 2.83, 2.85, -2.1, "plastic", (0.9, 0.9, 0.88)),
        strip(-2.2, 2.2, -0.35, 0.02, -0.8, "concrete"),
    ]
    for x in (-0.9, 0.0, 0.9):
        half = 0.05 if x else 0.025
        shapes.append(strip(x - half, x + half, 0.0, 2.2, -0.065, "frame_paint", back=PANE))
    for x in (-2.45, 2.39):
        shapes.append(box((x, -2.12, -0.1), (x + 0.09, -2.03, 2.85), "metal_grey"))
    return shapes


def door_station() -> Shapes:
    """Arched entrance of a station: three glazed leaves under a great fanlight."""
    outline = rounded(3.0, 4.6, sides=12)
    shapes = [
        face(outline, PANE, "glass"),
        rim(outline, 0.12, -0.10, "frame_paint"),
        strip(-1.45, 1.45, 2.5, 2.66, -0.09, "frame_paint", back=PANE),
        strip(-1.9, 1.9, -0.35, 0.04, -0.8, "stone"),
        prism([(-0.16, 4.5), (0.16, 4.5), (0.24, 5.15), (-0.24, 5.15)], -0.2, 0.0, "trim"),
        strip(-2.4, 2.4, 2.78, 2.9, -1.9, "metal_dark"),
        strip(-2.4, 2.4, 2.9, 2.94, -1.9, "glass"),
    ]
    for x in (-0.5, 0.5):
        shapes.append(strip(x - 0.05, x + 0.05, 0.0, 2.5, -0.08, "frame_paint", back=PANE))
    for x0, x1 in ((-1.4, -0.55), (-0.45, 0.45), (0.55, 1.4)):
        shapes.append(strip(x0, x1, 0.04, 0.75, -0.06, "door_paint", back=PANE))
    for angle in np.linspace(0, math.pi, 7)[1:-1]:
        path = [[0.3 * math.cos(angle), -0.04, 2.9 + 0.3 * math.sin(angle)],
                [1.4 * math.cos(angle), -0.04, 3.1 + 1.4 * math.sin(angle)]]  # fmt: skip
        shapes.append(tube(path, 0.03, "frame_paint", sides=4))
    outer, inner = rounded(3.6, 4.9, sides=12)[2:], outline[2:]
    for a, b, c, d in zip(outer[:-1], outer[1:], inner[1:], inner[:-1], strict=True):
        shapes.append(prism([a, b, c, d], -0.10, 0.0, "trim"))
    for side in (-1, 1):
        x0, x1 = sorted((side * 1.5, side * 1.8))
        shapes.append(strip(x0, x1, -0.1, 3.1, -0.10, "trim"))
    return shapes


HALL_DOORS: Mapping[str, tuple[Callable[[], Shapes], float, float]] = MappingProxyType(
    {
        "door_gothic": (door_gothic, 1.8, 3.7),
        "door_ogee": (door_ogee, 1.8, 3.6),
        "door_auto": (door_auto, 3.7, 2.8),
        "door_station": (door_station, 3.0, 4.6),
    }
)

# Outlines of niches as shares of width and height, where they are not the whole rectangle.
OUTLINES: Mapping[str, Outline] = MappingProxyType(
    {
        "window_tracery": pointed(1.6, 4.2, sides=10) / [1.6, 4.2],
        "window_lancet": pointed(0.8, 2.6, sides=10) / [0.8, 2.6],
        "window_belfry": pointed(1.3, 3.0, sides=10) / [1.3, 3.0],
        "window_steel": rounded(3.0, 3.4, rise=0.45) / [3.0, 3.4],
        "window_station": rounded(1.5, 3.2, sides=12) / [1.96, 3.58],
        "door_gothic": pointed(1.8, 3.7, sides=10) / [1.8, 3.7],
        "door_ogee": ogee(1.8, 3.6) / [1.8, 3.6],
        "door_station": rounded(3.0, 4.6, sides=12) / [3.0, 4.6],
    }
)
