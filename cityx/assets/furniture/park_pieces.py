"""Things of parks, playgrounds and pitches, at real size; front -y, foot at the origin.

Measures are those of the games' rules: FIFA (football), FIBA (basketball), ITF (tennis).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.furniture.furniture_parts import (
    BLUE,
    BURIED,
    GREEN,
    PALE,
    RED,
    YELLOW,
    Shapes,
    post,
)
from cityx.assets.shapes import Color, box, cards, cylinder, disc, loft, tube
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.ids import rng_for

LINE = 0.10  # metres


def _bar(a: list[float], b: list[float], radius: float, material: str = "metal_grey",
         tint: Color = (1.0, 1.0, 1.0)) -> MeshBatch:  # fmt: skip
    return tube([a, b], radius, material, tint, sides=6)


def swing() -> Shapes:
    """Swing with two seats under a bar of 3.4 m."""
    parts: Shapes = [_bar([-1.7, 0, 2.3], [1.7, 0, 2.3], 0.05, "plastic", RED)]
    for x in (-1.7, 1.7):
        for y in (-0.8, 0.8):
            parts.append(_bar([x, y, BURIED], [x, 0, 2.3], 0.045, "plastic", RED))
    for x in (-0.8, 0.8):
        for side in (-0.22, 0.22):
            parts.append(_bar([x + side, 0, 0.48], [x + side, 0, 2.28], 0.012))
        parts.append(box((x - 0.25, -0.11, 0.43), (x + 0.25, 0.11, 0.48), "rubber"))
    return parts


def slide() -> Shapes:
    """Slide of 3.4 m with a ladder and a platform."""
    parts: Shapes = [box((-0.4, 0.7, 1.5), (0.4, 1.5, 1.58), "bench_wood")]
    for x in (-0.38, 0.38):
        for y in (0.74, 1.46):
            parts.append(post(2.3, 0.045, "metal_grey", x=x, y=y))
        parts.append(_bar([x, 0.74, 2.25], [x, 1.46, 2.25], 0.03, "plastic", BLUE))
        parts.append(_bar([x, 1.5, 1.55], [x, 2.0, 0.0], 0.03))
    for k in range(5):
        y, z = 1.58 + 0.09 * k, 1.3 - 0.28 * k
        parts.append(box((-0.38, y - 0.05, z), (0.38, y + 0.05, z + 0.04), "bench_wood"))
    run = [(0.75, 1.58), (0.3, 1.4), (-0.9, 0.5), (-1.5, 0.32), (-2.0, 0.30)]
    rings = [np.array([[-0.3, y, z], [0.3, y, z], [0.3, y, z - 0.04], [-0.3, y, z - 0.04]])
             for y, z in run]  # fmt: skip
    parts.append(loft(np.stack(rings), "metal_grey"))
    for x in (-0.32, 0.32):
        side = [np.array([[x - 0.02, y, z], [x + 0.02, y, z], [x + 0.02, y, z + 0.16],
                          [x - 0.02, y, z + 0.16]])[::-1] for y, z in run]  # fmt: skip
        parts.append(loft(np.stack(side), "plastic", YELLOW))
    parts.append(post(0.30, 0.04, y=-1.8))
    return parts


def climbing_frame() -> Shapes:
    """Cube of bars, 2 m high."""
    parts: Shapes = []
    at = (-1.0, 0.0, 1.0)
    for x in at:
        for y in at:
            parts.append(_bar([x, y, BURIED], [x, y, 2.0], 0.022, "plastic", GREEN))
    for z in (0.7, 1.35, 2.0):
        for a in at:
            parts.append(_bar([-1, a, z], [1, a, z], 0.02, "plastic", YELLOW))
            parts.append(_bar([a, -1, z], [a, 1, z], 0.02, "plastic", RED))
    return parts


def spring_rider() -> Shapes:
    """Animal on a spring."""
    turn = np.linspace(0, 8 * np.pi, 33)
    coil = np.column_stack([0.1 * np.cos(turn), 0.1 * np.sin(turn), 0.35 * turn / turn[-1]])
    return [
        tube(coil, 0.015, "metal_dark", sides=4),
        box((-0.14, -0.4, 0.36), (0.14, 0.4, 0.62), "plastic", YELLOW),
        box((-0.1, -0.55, 0.55), (0.1, -0.3, 0.85), "plastic", YELLOW),
        box((-0.25, -0.3, 0.68), (0.25, -0.26, 0.72), "plastic", RED),
    ]


def picnic_table() -> Shapes:
    """Table with two fixed benches."""
    parts: Shapes = [
        box((-0.9, -0.36, 0.72), (0.9, 0.36, 0.76), "bench_wood"),
        box((-0.9, -0.85, 0.43), (0.9, -0.58, 0.47), "bench_wood"),
        box((-0.9, 0.58, 0.43), (0.9, 0.85, 0.47), "bench_wood"),
    ]
    for x in (-0.65, 0.65):
        parts.append(_bar([x, -0.6, BURIED], [x, 0.25, 0.74], 0.04, "bench_wood"))
        parts.append(_bar([x, 0.6, BURIED], [x, -0.25, 0.74], 0.04, "bench_wood"))
        parts.append(box((x - 0.03, -0.8, 0.39), (x + 0.03, 0.8, 0.43), "bench_wood"))
    return parts


def football_goal() -> Shapes:
    """Goal of 5 m with a net; the field lies before it (-y)."""
    parts: Shapes = [_bar([-2.5, 0, 2.0], [2.5, 0, 2.0], 0.05, "sign")]
    for x in (-2.5, 2.5):
        parts.append(_bar([x, 0, BURIED], [x, 0, 2.0], 0.05, "sign"))
        parts.append(_bar([x, 0, 2.0], [x, 1.0, 0.0], 0.02))
    parts.append(_bar([-2.5, 1.0, 0.02], [2.5, 1.0, 0.02], 0.02))
    for x in np.linspace(-2.4, 2.4, 17):
        parts.append(box((x - 0.004, 0.99, 0.0), (x + 0.004, 1.0, 0.02), "sign", PALE))
        parts.append(tube([[x, 0.02, 1.98], [x, 1.0, 0.02]], 0.005, "sign", PALE, sides=3))
    for share in np.linspace(0.1, 0.9, 6):
        z, y = 2.0 * (1 - share), share
        parts.append(tube([[-2.5, y, z], [2.5, y, z]], 0.005, "sign", PALE, sides=3))
    return parts


def basketball_hoop() -> Shapes:
    """Backboard and ring at 3.05 m; the court lies before it (-y)."""
    ring = np.linspace(0.0, 2 * np.pi, 13)
    hoop = np.column_stack([0.225 * np.cos(ring), -1.35 + 0.225 * np.sin(ring), np.full(13, 3.05)])
    return [
        post(3.2, 0.08),
        _bar([0, 0, 3.1], [0, -1.05, 3.3], 0.06),
        box((-0.9, -1.1, 2.9), (0.9, -1.05, 3.95), "sign"),
        box((-0.3, -1.11, 3.1), (0.3, -1.10, 3.55), "sign", RED),
        box((-0.25, -1.115, 3.15), (0.25, -1.10, 3.5), "sign"),
        tube(hoop, 0.012, "plastic", (0.85, 0.25, 0.04), sides=4, caps=(False, False)),
    ]


def tennis_net() -> Shapes:
    """Net of 12.8 m across a court, along x."""
    parts: Shapes = []
    for x in (-6.4, 6.4):
        parts.append(post(1.07, 0.045, "metal_dark", x=x))
    parts.append(box((-6.4, -0.012, 0.92), (6.4, 0.012, 0.98), "sign"))
    for z in np.linspace(0.08, 0.86, 7):
        parts.append(box((-6.4, -0.004, z), (6.4, 0.004, z + 0.008), "metal_dark"))
    for x in np.linspace(-6.2, 6.2, 41):
        parts.append(box((x - 0.004, -0.004, 0.05), (x + 0.004, 0.004, 0.92), "metal_dark"))
    return parts


def flower_bed() -> Shapes:
    """Oval bed of flowers in rings of colour, 3.2 x 2 m, with a stone edge."""
    rng = rng_for(0, "assets/flower_bed", 1)
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    oval = np.column_stack([1.6 * np.cos(angle), np.sin(angle)])

    def ring(scale: float, z: float) -> NDArray[np.float64]:
        return np.column_stack([scale * oval, np.full(24, z)])

    parts: Shapes = [
        loft(np.stack([ring(1.0, -0.1), ring(1.0, 0.08), ring(0.93, 0.08)]), "stone",
             (0.85, 0.83, 0.78), caps=(False, False)),
        loft(np.stack([ring(0.94, 0.0), ring(0.94, 0.05), ring(0.4, 0.16)]), "soil"),
    ]  # fmt: skip
    count = 330
    turn, radius = rng.uniform(0, 2 * np.pi, count), np.sqrt(rng.uniform(0, 1, count))
    xy = np.column_stack([1.45 * radius * np.cos(turn), 0.88 * radius * np.sin(turn)])
    flower = rng.uniform(size=count) < 0.55
    z = 0.12 + 0.14 * (1 - radius) + np.where(flower, 0.22, 0.10) * rng.uniform(0.7, 1.2, count)
    band = (radius * 3).astype(int)
    colours = np.array([[8.5, 1.0, 6.0], [8.0, 4.6, 6.0], [7.5, 0.7, 1.2]])
    green = np.array([0.9, 1.0, 0.9]) * rng.uniform(0.6, 1.1, (count, 1))
    tint = np.where(flower[:, None], colours[band] / 8.5, green)
    normal = np.array([0.0, 0.0, 1.0]) + 0.5 * rng.normal(size=(count, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, rng.normal(size=(count, 3)))
    along *= np.where(flower, 0.07, 0.1)[:, None] / np.linalg.norm(along, axis=1, keepdims=True)
    across = np.cross(normal, along)
    centre = np.column_stack([xy, z])
    for kind, material in ((flower, "cloth"), (~flower, "leaf")):
        parts.append(cards(centre[kind], along[kind], across[kind], material, tint[kind]))
    return parts


def sandpit() -> Shapes:
    """Sandpit of 3 m framed by timber."""
    parts: Shapes = [box((-1.4, -1.4, -0.1), (1.4, 1.4, 0.1), "sand")]
    for s in (-1.5, 1.5):
        parts.append(box((-1.6, s - 0.1, -0.1), (1.6, s + 0.1, 0.28), "bench_wood"))
        parts.append(box((s - 0.1, -1.4, -0.1), (s + 0.1, 1.4, 0.28), "bench_wood"))
    return parts


def park_board() -> Shapes:
    """Map of a park on two posts."""
    return [
        post(1.9, 0.04, "bench_wood", x=-0.55),
        post(1.9, 0.04, "bench_wood", x=0.55),
        box((-0.65, -0.04, 0.9), (0.65, 0.0, 1.8), "sign", GREEN),
        box((-0.58, -0.05, 0.97), (0.58, -0.04, 1.73), "sign", PALE),
        disc((0.2, -0.055, 1.4), 0.15, "sign", BLUE, sides=10, thickness=0.01),
        cylinder((-0.7, -0.02, 1.86), (0.7, -0.02, 1.86), 0.05, "bench_wood", sides=6),
    ]


PARK_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            swing, slide, climbing_frame, spring_rider, picnic_table, football_goal,
            basketball_hoop, tennis_net, flower_bed, sandpit, park_board,
        )
    }
)  # fmt: skip


@dataclass(frozen=True)
class Court:
    """One court; x runs along its length, the origin is in its middle.

    Attributes
    ----------
    length, width
        Of the lines' outer rectangle.
    margin
        Metres beyond the lines at the ends and at the sides, that belong to the court.
    surface
        Tint of a hard surface, or None for grass.
    lines
        Polylines, (k, 2) float each.
    things
        Name of a prototype, x, y, and the direction its front looks to.
    paint
        Colour of the surface, sRGB 0xRRGGBB, -1 for its usual one.
    """

    length: float
    width: float
    margin: tuple[float, float]
    surface: Color | None
    lines: tuple[FloatArray, ...]
    things: tuple[tuple[str, float, float, float], ...]
    paint: int = -1


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> FloatArray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])


def _arc(x: float, y: float, radius: float, low: float, high: float) -> FloatArray:
    turn = np.linspace(low, high, max(5, round(abs(high - low) * 6)))
    return np.column_stack([x + radius * np.cos(turn), y + radius * np.sin(turn)])


def football(length: float, width: float) -> Court:
    """Make a field; its areas shrink with it below the full size of 105 m."""
    a, b, s = length / 2, width / 2, min(1.0, length / 105.0, width / 68.0)
    lines = [_rectangle(-a, -b, a, b), np.array([[0.0, -b], [0.0, b]]),
             _arc(0, 0, 9.15 * s, 0, 2 * np.pi)]  # fmt: skip
    for side in (-1, 1):
        for deep, half in ((16.5 * s, 20.16 * s), (5.5 * s, 9.16 * s)):
            lines.append(np.array([[side * a, -half], [side * (a - deep), -half],
                                   [side * (a - deep), half], [side * a, half]]))  # fmt: skip
        turn = np.arccos(5.5 / 9.15)
        middle = 0.0 if side < 0 else np.pi
        lines.append(_arc(side * (a - 11.0 * s), 0, 9.15 * s, middle - turn, middle + turn))
    goals = (("football_goal", -a, 0.0, 0.0), ("football_goal", a, 0.0, np.pi))
    return Court(length, width, (2.0, 2.0), None, tuple(lines), goals)


def basketball() -> Court:
    """Make a court of 28 x 15 m."""
    lines = [_rectangle(-14, -7.5, 14, 7.5), np.array([[0.0, -7.5], [0.0, 7.5]]),
             _arc(0, 0, 1.8, 0, 2 * np.pi)]  # fmt: skip
    for side in (-1, 1):
        lines.append(np.array([[side * 14, -2.45], [side * 8.2, -2.45], [side * 8.2, 2.45],
                               [side * 14, 2.45]]))  # fmt: skip
        middle = 0.0 if side < 0 else np.pi
        lines.append(_arc(side * 8.2, 0, 1.8, middle - np.pi / 2, middle + np.pi / 2))
        basket = side * 12.425
        turn = np.arcsin(6.6 / 6.75)
        arc = _arc(basket, 0, 6.75, middle - turn, middle + turn)
        lines.append(np.vstack([[side * 14, arc[0, 1]], arc, [side * 14, arc[-1, 1]]]))
    hoops = (("basketball_hoop", -13.8, 0.0, 0.0), ("basketball_hoop", 13.8, 0.0, np.pi))
    return Court(28.0, 15.0, (1.0, 1.0), (0.24, 0.30, 0.38), tuple(lines), hoops)


def tennis(clay: bool) -> Court:
    """Make a court of 23.77 x 10.97 m."""
    a, b, single, service = 11.885, 5.485, 4.115, 6.4
    lines = [_rectangle(-a, -b, a, b), np.array([[-a, -single], [a, -single]]),
             np.array([[-a, single], [a, single]]), np.array([[-service, 0], [service, 0]]),
             np.array([[-service, -single], [-service, single]]),
             np.array([[service, -single], [service, single]])]  # fmt: skip
    tint = (0.62, 0.25, 0.14) if clay else (0.16, 0.34, 0.24)
    net = (("tennis_net", 0.0, 0.0, 0.0),)
    return Court(2 * a, 2 * b, (4.0, 2.2), tint, tuple(lines), net)
