"""Heads of people: neck, skull, nose and ears, with the hair, beards and hats on them.

The skull is told in its own height: 0 is the chin and 1 the crown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cityx.assets.people.body import (
    CHIN,
    Body,
    Part,
    ball,
    bound,
    curve,
    heights,
    level,
    ring_angles,
    sheet,
    stacked,
)
from cityx.assets.people.skeleton import chained, rigid
from cityx.assets.shapes import Color, is_fine, loft
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.system.tables import table

# (z, half width, front, back) of the skull, in its height above the chin.
_SKULL = np.array([
    (-0.010, 0.060, 0.370, -0.250), (0.015, 0.120, 0.405, -0.160), (0.060, 0.180, 0.415, -0.030),
    (0.120, 0.225, 0.405, 0.080), (0.200, 0.258, 0.400, 0.190), (0.280, 0.280, 0.395, 0.290),
    (0.360, 0.298, 0.395, 0.365), (0.440, 0.310, 0.385, 0.410), (0.500, 0.314, 0.382, 0.432),
    (0.570, 0.322, 0.405, 0.450), (0.660, 0.330, 0.405, 0.460), (0.750, 0.328, 0.385, 0.450),
    (0.840, 0.300, 0.335, 0.405), (0.920, 0.238, 0.250, 0.318), (0.972, 0.145, 0.145, 0.195),
    (1.000, 0.0, 0.0, 0.0),
])  # fmt: skip
_CROWN = 0.03  # y of the crown above the axis of the head, in heights of the skull
HEAD_Y = -0.006  # axis of the head before that of the body
NECK_BINDING = chained(("head", "neck", "chest"), ((0.886, 0.016), (0.838, 0.014)))
Line = tuple[tuple[float, float], ...]

CENTRE = np.array([0.0, 0.03, 0.55])  # of the skull; shells grow away from it


def neck(body: Body, skin: Color) -> list[Part]:
    """Neck with the top of the chest, which an open collar shows."""
    wide = (0.0370 - 0.0060 * body.female) * (1 + 0.12 * body.build - 0.08 * body.child)
    z = heights(0.795, CHIN + 0.35 * body.skull, 3, 8)
    share = (z - z[0]) / (z[-1] - z[0])
    flare = 1.0 + 1.1 * np.exp(-((share / 0.22) ** 2))
    reach = np.column_stack([wide * flare, wide * 0.98 * (1 + 0.1 * (flare - 1)),
                             wide * 1.06 * (1 - 0.1 * (flare - 1))])  # fmt: skip
    centre = np.column_stack([np.zeros(len(z)), 0.016 - 0.014 * share])
    rings = stacked(z, centre, reach, level(7, 18), power=2.0)
    return [bound(loft(rings, "skin", skin), NECK_BINDING)]


def skull_points(body: Body, z: FloatArray, angle: FloatArray) -> FloatArray:
    """Points of the skull at heights (0 chin, 1 crown) and angles, broadcast, (..., 3)."""
    height, turn = np.broadcast_arrays(z, angle)
    reach = curve(_SKULL, height.ravel()).reshape(*height.shape, 3)
    broad = 1.0 + 0.05 * body.build - 0.02 * body.female + 0.04 * body.child
    face = np.clip(1.0 - height / 0.45, 0.0, 1.0)  # a woman's jaw and a child's are narrower
    wide = broad * (1.0 - 0.10 * body.female * face + 0.05 * body.child * face)
    c, s = np.cos(turn), np.sin(turn)
    x = reach[..., 0] * wide * np.sign(c) * np.abs(c) ** 0.9
    along = np.sign(s) * np.abs(s) ** 0.9
    y = _CROWN * np.clip(height, 0, 1) ** 4
    y = y + np.where(along < 0, reach[..., 1], reach[..., 2]) * along
    if is_fine():  # sockets of the eyes, hollows beside the mouth
        front = np.clip(-along, 0.0, 1.0)
        for px, pz, rx, rz, deep in ((0.15, 0.495, 0.085, 0.050, 0.030),
                                     (0.17, 0.27, 0.07, 0.07, 0.010)):  # fmt: skip
            gap = ((np.abs(x) - px) / rx) ** 2 + ((height - pz) / rz) ** 2
            y = y + deep * np.exp(-gap) * front
    return np.stack([x, y, height], axis=-1)


def on_head(body: Body, points: FloatArray) -> FloatArray:
    """Move points from heights of the skull to the body's frame, (..., 3)."""
    return np.asarray(points * body.skull + np.array([0.0, HEAD_Y, CHIN]))


def head(body: Body, skin: Color, brow: Color) -> list[Part]:
    """Skull, nose and ears; eyes, brows and a mouth at the fine level."""
    ends = (
        ([-0.01, 0.015, 0.06], [0.90, 0.945, 0.98, 1.0])
        if is_fine()
        else ([-0.01, 0.05], [0.93, 1.0])
    )
    z = np.concatenate([ends[0], np.linspace(0.12, 0.84, level(4, 15)), ends[1]])
    points = skull_points(body, z[:, None], ring_angles(level(10, 28))[None, :])
    solids = [loft(points, "skin", skin)]
    nose_rows = np.array([
        (0.315, 0.018, 0.050, 0.02), (0.335, 0.050, 0.105, 0.02), (0.365, 0.052, 0.142, 0.02),
        (0.395, 0.040, 0.135, 0.02), (0.450, 0.030, 0.100, 0.02), (0.510, 0.026, 0.066, 0.02),
        (0.565, 0.030, 0.040, 0.02),
    ])  # fmt: skip
    height = heights(0.315, 0.565, 4, 9)
    reach = curve(nose_rows, height) * [1.0, 1.0 - 0.25 * body.child, 1.0]
    nose = stacked(height, np.array([0.0, -0.345]), reach, level(5, 10), power=2.0)
    solids.append(loft(nose, "skin", skin))
    for side in (1.0, -1.0):
        solids.append(ball((0.318 * side, 0.045, 0.455), (0.030, 0.055, 0.070, 0.110), "skin", skin,
                           plain=(3, 5)))  # fmt: skip
    if is_fine():
        solids += _features(skin, brow)
    nod = rigid("head")
    return [bound(replace(solid, vertices=on_head(body, solid.vertices)), nod) for solid in solids]


def _features(skin: Color, brow: Color) -> list[MeshBatch]:
    """Eyes, brows and lips, in heights of the skull."""
    red, green, blue = skin
    lips = (0.80 * red, 0.55 * green, 0.52 * blue)
    solids = []
    for side in (1.0, -1.0):
        solids.append(ball((0.150 * side, -0.318, 0.492), (0.058, 0.045, 0.02, 0.021), "skin",
                           (0.05, 0.035, 0.03), fine=(4, 10)))  # fmt: skip
        path = np.array([(0.065, 0.555), (0.13, 0.580), (0.20, 0.578), (0.26, 0.545)])
        rings = []
        for x, z in path:
            y = -0.392 + 0.42 * max(x - 0.06, 0.0) ** 1.4
            thick = 0.012 if 0.1 < x < 0.22 else 0.008
            rings.append([(x * side, y - 0.020, z), (x * side, y, z + thick),
                          (x * side, y + 0.02, z), (x * side, y, z - thick)])  # fmt: skip
        order = slice(None) if side < 0 else slice(None, None, -1)
        solids.append(loft(np.array(rings)[order], "hair", brow))
    solids.append(ball((0.0, -0.352, 0.205), (0.105, 0.062, 0.02, 0.026), "skin", lips,
                       fine=(4, 12)))  # fmt: skip
    return solids


@dataclass(frozen=True)
class Hair:
    """A way to wear hair.

    Attributes
    ----------
    edge
        (angle from the face, height) of the hairline, radians from 0 to pi.
    thick
        (at the edge, at the sides, on the crown) relative to the radius of the skull.
    strands
        Depth of the locks that the fine level shows.
    curl
        Whether locks are curls.
    crown
        Height above which the head is bald; 1 for none.
    """

    edge: Line
    thick: tuple[float, float, float]
    strands: float = 0.025
    curl: bool = False
    crown: float = 1.0


HAIR = table("assets/clothes", Hair, "hair")
HATS = ("cap", "beanie", "brimmed hat")
HELMET, CYCLE_HELMET = HELMETS = ("helmet", "cycle helmet")  # of motorcyclists and of cyclists


def crown_of(style: str) -> float:
    """Height of the top of the hair, in heights of the skull."""
    thick = HAIR[style].thick[2]
    return float(1.0 + (1.0 - CENTRE[2]) * thick)


def hair(body: Body, style: str, color: Color, *, under_hat: bool = False) -> list[Part]:
    """Make hair; `style` is a key of `HAIR`. A hat presses it flat on the crown."""
    look = HAIR[style]
    if not look.edge or (under_hat and look.crown < 1.0):
        return []
    if under_hat:
        flat = min(look.thick[2], 0.04)
        look = replace(look, thick=(look.thick[0], min(look.thick[1], 0.10), flat))
    angle = ring_angles(level(10, 32))
    rows = level(3, 7) if under_hat else level(4, 13)
    solids = [loft(_shell(body, look, angle, rows), "hair", color)]
    if style == "ponytail":
        solids.append(_tail(color))
    elif style == "bun":
        solids.append(ball((0.0, 0.54, 0.72), (0.15, 0.13, 0.13, 0.14), "hair", color))
    return _worn(body, solids)


def beard(body: Body, color: Color, full: float) -> list[Part]:
    """Make a beard, `full` 0 to 1 long."""
    angle = ring_angles(level(8, 28))
    aside = _aside(angle)
    low = np.where(aside < 1.15, -0.01 - 0.06 * full, 0.10)
    cheek = np.interp(aside, [0.0, 0.25, 0.5, 1.0, 1.2, 1.4], [0.155, 0.17, 0.24, 0.36, 0.44, 0.10])
    cheek = np.maximum(cheek, low + 0.004)
    share = np.linspace(0.0, 1.0, level(3, 6))[:, None]
    z = low + (cheek - low) * share
    skin = skull_points(body, np.maximum(z, 0.015), angle[None, :])
    grown = np.clip((1.35 - aside) / 0.2, 0.0, 1.0) * (0.02 + 0.08 * full)
    middle = np.array([0.0, -0.05, 0.25])
    around = (
        middle + (skin - middle) * (1.0 + grown * np.sin(np.pi * (0.12 + 0.82 * share)))[..., None]
    )
    inside = np.where(aside < 1.35, 1.0, 0.9)[None, :, None]  # behind the ears it is in the head
    around = middle + (around - middle) * inside
    around[..., 2] = np.minimum(around[..., 2], z + 0.01) - 0.05 * full * (1 - share) * (
        aside < 0.7
    )
    point = np.broadcast_to(middle, (1, len(angle), 3))
    rings = np.concatenate([point, around, point])
    return _worn(body, [loft(rings, "hair", color)])


def hat(body: Body, kind: str, color: Color) -> list[Part]:
    """Make a hat, one of `HATS` or `HELMETS`."""
    angle = ring_angles(level(10, 30))
    edges: dict[str, Line] = {
        "cap": ((0.0, 0.76), (1.2, 0.70), (3.1416, 0.52)),
        "beanie": ((0.0, 0.72), (1.0, 0.62), (1.6, 0.44), (3.1416, 0.30)),
        "brimmed hat": ((0.0, 0.77), (3.1416, 0.66)),
        # Over the ears down to the jaw, with a visor; and one that ends above the ears.
        HELMET: ((0.0, 0.80), (0.80, 0.78), (1.02, 0.50), (1.12, 0.10), (1.3, 0.0), (3.1416, 0.02)),
        CYCLE_HELMET: ((0.0, 0.78), (1.2, 0.66), (1.7, 0.58), (3.1416, 0.42)),
    }
    thick = {"cap": (0.13, 0.15, 0.14), "beanie": (0.14, 0.17, 0.26),
             "brimmed hat": (0.13, 0.15, 0.30), HELMET: (0.24, 0.30, 0.34),
             CYCLE_HELMET: (0.16, 0.22, 0.34)}[kind]  # fmt: skip
    look = Hair(edges[kind], thick, 0.012 if kind == "beanie" else 0.0)
    rings = _shell(body, look, angle, level(4, 9), hollow=False)
    if kind == "brimmed hat":  # straight sides, a crown that is pinched
        top = rings[-1, 0, 2]
        share = np.clip((rings[..., 2] - 0.95) / (top - 0.95), 0.0, 1.0)
        rings[..., 2] -= 0.05 * share**2 * np.exp(-((rings[..., 0] / 0.07) ** 2))
    solids = [loft(rings, "plastic" if kind in HELMETS else "cloth", color)]
    if kind == HELMET:
        solids.append(_pane(body))
    if kind == "cap":
        solids.append(_visor(body, color))
    if kind == "brimmed hat":
        solids.append(_brim(body, angle, look, color))
    return _worn(body, solids)


def _worn(body: Body, solids: Sequence[MeshBatch]) -> list[Part]:
    nod = rigid("head")
    return [bound(replace(solid, vertices=on_head(body, solid.vertices)), nod) for solid in solids]


def _aside(angle: FloatArray) -> FloatArray:
    """Angle from the face, 0 to pi."""
    return np.asarray(np.abs((angle + np.pi / 2 + np.pi) % (2 * np.pi) - np.pi))


def _shell(body: Body, look: Hair, angle: FloatArray, rows: int, *,
           hollow: bool = True) -> FloatArray:  # fmt: skip
    """Rings from a point in the skull over the hairline up to the crown, closed."""
    aside = _aside(angle)
    edge = np.interp(aside, [a for a, _ in look.edge], [z for _, z in look.edge])
    share = np.sin(np.linspace(0.0, 1.0, rows) * np.pi / 2)[:, None]
    top = look.crown
    bare = edge > top - 0.02  # a bald front: there the shell stays within the head
    edge = np.minimum(edge, top - 0.02)
    z = edge + (top - edge) * share  # (rows, k)
    # What hangs lower than the widest place of the head falls straight down from there.
    on = skull_points(body, np.maximum(z, 0.46), angle[None, :])
    near = skull_points(body, np.clip(z, 0.0, 1.0), angle[None, :])
    falls = (edge < 0.08) & (aside > 0.6)
    points = np.where(falls[None, :, None], on, near)
    points[..., 2] = z
    at_edge, aside_thick, on_top = look.thick
    height = np.clip((z - 0.5) / 0.5, 0.0, 1.0)
    thick = aside_thick + (on_top - aside_thick) * height**1.5
    rise = np.clip(share * 4.0, 0.0, 1.0)
    thick = at_edge + (thick - at_edge) * rise * (2.0 - rise)
    thick = np.where(falls & (z < 0.2), aside_thick * 0.9, thick)
    thick = thick + look.strands * _locks(angle, z, look.curl) * np.sin(np.pi * share**2) ** 0.5
    thick = np.where(bare, -0.08, thick)
    grown = CENTRE + (points - CENTRE) * (1.0 + thick[..., None])
    level_z = np.where(points[..., 2] < CENTRE[2], points[..., 2], grown[..., 2])
    grown[..., 2] = np.minimum(level_z, CENTRE[2] + (1.0 - CENTRE[2]) * (1.0 + on_top))
    taper = np.clip(-z / 0.7, 0.0, 1.0)[..., None] * np.array([0.16, 0.10, 0.0])
    grown *= 1.0 - taper
    start = np.broadcast_to(CENTRE, (1, len(angle), 3))
    inside = CENTRE + (grown[:1] - CENTRE) * (0.93 if hollow else 0.97)
    inside[..., 2] = grown[:1, :, 2]
    end = start if look.crown < 1.0 else grown[-1:].mean(axis=1, keepdims=True)
    return np.concatenate([start, inside, grown[:-1] if look.crown == 1.0 else grown,
                           np.broadcast_to(end, (1, len(angle), 3))])  # fmt: skip


def _locks(angle: FloatArray, z: FloatArray, curl: bool) -> FloatArray:
    """Height of locks, about -1 to 1, (rows, k)."""
    if not is_fine():
        return np.zeros(z.shape)
    if curl:
        return np.asarray(np.sin(9 * angle + 3 * np.sin(14 * z)) * np.sin(26 * z + 2 * angle))
    return np.asarray(0.6 * np.sin(11 * angle + 5 * z) + 0.4 * np.sin(19 * angle - 7 * z + 1))


def _tail(color: Color) -> MeshBatch:
    """Ponytail: out from the back of the head and down."""
    path = np.array([(0.60, -0.42), (0.61, -0.25), (0.63, 0.0), (0.65, 0.28), (0.66, 0.52),
                     (0.60, 0.66), (0.50, 0.70)])  # fmt: skip
    radius = np.array([0.03, 0.075, 0.10, 0.11, 0.10, 0.075, 0.06])
    z = np.linspace(0, len(path) - 1, level(5, 11))
    y, up, r = (np.interp(z, np.arange(len(path)), v) for v in (path[:, 0], path[:, 1], radius))
    around = ring_angles(level(5, 12))
    rings = np.empty((len(z), len(around), 3))
    rings[..., 0] = r[:, None] * np.cos(around)
    rings[..., 1] = y[:, None] + 0.8 * r[:, None] * np.sin(around)
    rings[..., 2] = up[:, None]
    return loft(rings, "hair", color)


def _visor(body: Body, color: Color) -> MeshBatch:
    """Peak of a cap: a curved sheet before the forehead."""
    turn = np.linspace(-1.0, 1.0, level(6, 14)) * 0.85
    root = skull_points(body, np.full(len(turn), 0.76), turn - np.pi / 2)
    out = np.stack([root * [1.0, 1.0, 0.0] * 1.04, root * [1.0, 1.0, 0.0] * 1.16], axis=0)
    reach = 0.34 * np.cos(turn * 1.25)
    tip = root * [1.02, 1.10, 0.0]
    tip[:, 1] -= np.maximum(reach, 0.0)
    rows = np.stack([out[0], 0.5 * (out[0] + tip), tip])
    droop = np.array([0.785, 0.765, 0.72])[:, None] - 0.16 * (np.abs(turn) / 0.85)[None, :] ** 2 * \
        np.array([0.35, 0.6, 0.8])[:, None]  # fmt: skip
    rows[..., 2] = droop
    low = rows - [0.0, 0.0, 0.022]
    # Rows run outwards, so that the upper side is the outer one where columns run clockwise.
    return sheet(rows[:, ::-1], low[:, ::-1], "cloth", color, around=False)


def _pane(body: Body) -> MeshBatch:
    """Visor of a helmet: a dark pane before the face."""
    turn = np.linspace(-1.08, 1.08, level(8, 16)) - np.pi / 2
    z = np.linspace(0.10, 0.84, level(3, 6))[:, None]
    skin = skull_points(body, np.broadcast_to(z, (len(z), len(turn))), turn[None, :])
    far = np.array([1.42, 1.42, 1.0])
    outer = CENTRE * [1, 1, 0] + (skin - CENTRE * [1, 1, 0]) * far
    inner = CENTRE * [1, 1, 0] + (skin - CENTRE * [1, 1, 0]) * (far - [0.04, 0.04, 0.0])
    return sheet(outer, inner, "car_glass", (1.0, 1.0, 1.0), around=False)


def _brim(body: Body, angle: FloatArray, look: Hair, color: Color) -> MeshBatch:
    aside = _aside(angle)
    edge = np.interp(aside, [a for a, _ in look.edge], [z for _, z in look.edge])
    root = skull_points(body, edge, angle)
    rows = np.stack([root * [factor, factor, 1.0] for factor in (1.9, 1.5, 1.05)])
    rows[..., 2] += (
        np.array([0.02, -0.01, 0.0])[:, None]
        + 0.03 * np.cos(2 * angle) * np.array([-1.0, -0.5, 0.0])[:, None]
    )
    return sheet(rows, rows - [0.0, 0.0, 0.03], "cloth", color, around=True)
