"""Things of the waterside: boats, reeds, stones, bollards, ladders; front -y is to the water."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.furniture_parts import RED, STONE, YELLOW, Shapes, post
from cityx.assets.shapes import Color, box, cards, lathe, loft, tube
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.ids import rng_for


def _outline(blunt: float) -> tuple[FloatArray, FloatArray]:
    """Places along a hull from stern to bow, shares of its length, and of its beam there."""
    along = np.concatenate([[-0.5, -0.485], np.linspace(-0.4, 0.4, 7), [0.485, 0.5]])
    stern, bow = 1.0 - blunt * (2 * along) ** 2, 1.0 - np.abs(2 * along) ** 2.2
    full = np.where(along < 0, stern, np.sqrt(np.clip(bow, 0.0, 1.0)))
    return along, np.clip(full, 0.04, 1.0)


def _hull(length: float, beam: float, low: float, high: float, material: str, tint: Color,
          *, blunt: float = 0.1, floor: float = 0.0) -> MeshBatch:  # fmt: skip
    """Skin an open hull along y: outside up to the gunwale, then inside down to the floor."""
    # Both ends are solid for a hand's breadth, so that the caps are plain.
    along, full = _outline(blunt)
    rise = 0.18 * (2 * along) ** 2 * (high - low)
    rings = []
    for a, w, r in zip(along, full, rise, strict=True):
        half, keel = w * beam / 2, 0.55 * w * beam / 2
        inner = max(half - 0.07, 0.01)
        bed = high + r - 0.001 if abs(a) == 0.5 else floor
        profile = [(-half, high + r), (-keel, low), (keel, low), (half, high + r),
                   (inner, high + r), (0.8 * inner, bed), (-0.8 * inner, bed),
                   (-inner, high + r)]  # fmt: skip
        rings.append(np.array([[x, a * length, z] for x, z in profile]))
    return loft(np.stack(rings), material, tint)


def rowing_boat() -> Shapes:
    """Wooden rowing boat of 4.2 m; the waterline is at z 0."""
    hull = _hull(4.2, 1.45, -0.18, 0.38, "bench_wood", (1.3, 1.2, 1.1), blunt=0.35, floor=0.04)
    parts: Shapes = [hull]
    for y, half in ((-1.2, 0.55), (-0.1, 0.62), (1.0, 0.48)):
        parts.append(box((-half, y - 0.13, 0.22), (half, y + 0.13, 0.26), "bench_wood"))
    for x in (-0.35, 0.3):
        parts.append(tube([[x, -1.3, 0.30], [x + 0.1, 1.1, 0.34]], 0.02, "bench_wood", sides=4))
    return parts


def motor_boat() -> Shapes:
    """White motor boat of 5.5 m with a windscreen and an outboard engine."""
    return [
        _hull(5.5, 2.1, -0.25, 0.62, "car_paint", (0.85, 0.86, 0.86), blunt=0.05, floor=0.15),
        box((-0.75, 0.5, 0.3), (0.75, 1.7, 0.68), "car_paint", (0.85, 0.86, 0.86)),
        box((-0.72, 0.45, 0.68), (0.72, 0.5, 1.05), "car_glass"),
        box((-0.7, -1.7, 0.15), (0.7, -1.2, 0.55), "cloth", (0.75, 0.7, 0.6)),
        box((-0.7, -0.4, 0.15), (-0.15, 0.1, 0.55), "cloth", (0.75, 0.7, 0.6)),
        box((0.15, -0.4, 0.15), (0.7, 0.1, 0.55), "cloth", (0.75, 0.7, 0.6)),
        box((-0.18, -3.1, 0.2), (0.18, -2.7, 0.95), "plastic", (0.06, 0.065, 0.07)),
    ]


def barge() -> Shapes:
    """House barge of 17 m: planked deck, cabin with framed windows, wheelhouse, plants."""
    length, beam, blunt = 17.0, 3.6, 0.12
    cream, green, red = (0.78, 0.74, 0.62), (0.05, 0.14, 0.10), (0.26, 0.05, 0.04)
    along, full = _outline(blunt)
    rows = slice(1, -1)
    half = np.maximum(full[rows] * beam / 2 - 0.06, 0.02)
    deck = np.stack([
        np.column_stack([[-w, w, w, -w], np.full(4, a * length), [0.63, 0.63, 0.67, 0.67]])
        for a, w in zip(along[rows], half, strict=True)
    ])  # fmt: skip
    rim = 0.75 + 0.18 * (2 * along) ** 2 * 1.15
    parts: Shapes = [
        _hull(length, beam, -0.4, 0.75, "car_paint", (0.03, 0.045, 0.05), blunt=blunt, floor=0.55),
        loft(deck, "bench_wood", (0.9, 0.85, 0.8)),
        *(tube(np.column_stack([side * full * beam / 2, along * length, rim]), 0.05, "bench_wood",
               sides=6) for side in (-1.0, 1.0)),
        box((-1.35, -6.5, 0.6), (1.35, 4.2, 1.72), "plaster", green),
        box((-1.38, -6.53, 0.6), (1.38, 4.23, 0.98), "plaster", red),
        box((-1.46, -6.6, 1.72), (1.46, 4.35, 1.80), "plaster", cream),
        box((-1.30, -6.45, 1.80), (1.30, 4.20, 1.85), "plaster", (0.36, 0.37, 0.37)),
        box((-1.1, -7.9, 0.6), (1.1, -6.5, 2.35), "bench_wood"),
        box((-1.12, -7.55, 1.45), (1.12, -6.85, 2.15), "glass"),
        box((-0.85, -7.92, 1.45), (0.85, -6.48, 2.15), "glass"),
        box((-1.2, -8.0, 2.35), (1.2, -6.4, 2.43), "plaster", cream),
        # The way down from the fore deck, with a window on either side.
        box((-0.38, 4.2, 0.67), (0.38, 4.26, 1.66), "bench_wood"),
        box((-0.26, 4.25, 1.15), (0.26, 4.275, 1.52), "glass"),
    ]  # fmt: skip
    for x in (-1.15, 0.57):
        parts += _window((x, 4.21, 1.12), (x + 0.58, 4.26, 1.55), cream, 1)
    for y in np.arange(-5.6, 3.4, 1.75):
        parts += _window((-1.39, y, 1.10), (1.39, y + 0.9, 1.58), cream, 0)
    for x in (-1.36, 1.36):
        for y in (-6.3, -2.9, 0.6, 4.05):
            parts.append(post(2.35, 0.02, "metal_grey", x=x, y=y))
        for z in (2.08, 2.34):
            parts.append(tube([[x, -6.3, z], [x, 4.05, z]], 0.016, "metal_grey", sides=5))
    rng = rng_for(0, "assets/barge", 1)
    for y in (-4.6, -1.2, 2.2):
        parts.append(box((-0.95, y, 1.85), (0.95, y + 0.4, 2.13), "bench_wood", (0.7, 0.6, 0.5)))
        centre = rng.uniform((-0.85, y + 0.05, 2.14), (0.85, y + 0.35, 2.38), (36, 3))
        turn = rng.uniform(0, 2 * np.pi, 36)
        way = np.column_stack([np.cos(turn), np.sin(turn), rng.uniform(0.2, 1.2, 36)]) * 0.055
        across = 0.035 * np.column_stack([-np.sin(turn), np.cos(turn), np.zeros(36)])
        tint = np.where(rng.uniform(size=(36, 1)) < 0.18, [2.6, 0.5, 0.6], [0.9, 1.0, 0.8])
        parts.append(cards(centre, way, across, "leaf", tint, fold=0.2))
    for side in (-1.0, 1.0):
        for y in (-5.0, -0.5, 4.0):
            parts.append(_fender(side * (beam / 2 + 0.06), y))
    for y in (-8.1, 7.2):
        parts.append(lathe([(0.07, 0.66), (0.07, 0.95), (0.11, 0.97), (0.11, 1.02), (0.0, 1.03)],
                           "metal_dark", sides=8, center=(0.0, y)))  # fmt: skip
    parts.append(post(2.6, 0.06, "metal_dark", x=0.6, y=-5.3))
    return parts


def _window(low: tuple[float, float, float], high: tuple[float, float, float], tint: Color,
            axis: int) -> Shapes:  # fmt: skip
    """Frame with panes on both faces of a wall that stands across an axis, or on its outer one."""
    out = np.zeros(3)
    out[axis] = 0.015
    inner = np.array([0.0, 0.06, 0.06]) if axis == 0 else np.array([0.06, 0.0, 0.06])
    start, end = np.array(low), np.array(high)
    pane = (tuple(start - out + inner), tuple(end + out - inner))
    return [box(low, high, "plaster", tint), box(*pane, "glass")]


def _fender(x: float, y: float) -> MeshBatch:
    """Old tyre that hangs at the side of a hull."""
    ring = np.linspace(0.0, 2 * np.pi, 13)
    hoop = np.column_stack([np.full(13, x), y + 0.22 * np.cos(ring), 0.45 + 0.22 * np.sin(ring)])
    return tube(hoop, 0.08, "rubber", sides=6, caps=(False, False))


def reeds() -> Shapes:
    """Clump of reeds, 1.7 m."""
    rng = rng_for(0, "assets/reeds", 1)
    count = 90
    foot = rng.normal(size=(count, 2)) * 0.28
    height = rng.uniform(0.7, 1.7, count)
    lean = rng.normal(size=(count, 2)) * 0.16 + foot * 0.25
    along = np.column_stack([lean, height]) / 2
    turn = rng.uniform(0, np.pi, count)
    across = 0.014 * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(count)])
    centre = np.column_stack([foot, np.full(count, -0.12)]) + along
    dry = rng.uniform(size=(count, 1))
    tint = rng.uniform(0.7, 1.2, (count, 1)) * (
        (1 - dry) * [0.9, 0.95, 0.8] + dry * [1.9, 1.25, 1.3]
    )
    return [cards(centre, along, across, "leaf", tint, fold=0.0)]


def boulder() -> Shapes:
    """Stone of 0.7 m, rounded."""
    rng = rng_for(0, "assets/boulder", 1)
    angle = np.arange(9) * 2 * np.pi / 9
    bump = rng.uniform(0.85, 1.15, (5, 9))
    radius = np.array([0.26, 0.37, 0.36, 0.24, 0.08])
    height = np.array([-0.15, 0.02, 0.16, 0.29, 0.34])
    rings = [np.column_stack([1.2 * r * b * np.cos(angle), r * b * np.sin(angle), np.full(9, z)])
             for r, b, z in zip(radius, bump, height, strict=True)]  # fmt: skip
    return [loft(np.stack(rings), "stone", (0.34, 0.33, 0.30))]


def mooring_bollard() -> Shapes:
    """Iron bollard of a quay."""
    return [
        lathe([(0.17, -0.1), (0.17, 0.04), (0.11, 0.08), (0.10, 0.32), (0.17, 0.40), (0.18, 0.46),
               (0.10, 0.52), (0.0, 0.53)], "metal_dark", sides=10),
    ]  # fmt: skip


def quay_ladder() -> Shapes:
    """Ladder down a quay wall; hangs from the edge at z 0 before -y."""
    parts: Shapes = []
    for x in (-0.22, 0.22):
        parts.append(tube([[x, 0.3, 0.05], [x, 0.28, 0.75], [x, -0.1, 0.75], [x, -0.12, -0.45]],
                          0.02, "metal_grey", sides=6))  # fmt: skip
    for z in np.linspace(-0.4, 0.5, 4):
        parts.append(box((-0.22, -0.135, z - 0.015), (0.22, -0.105, z + 0.015), "metal_grey"))
    return parts


def life_ring() -> Shapes:
    """Life ring on a post with a board."""
    ring = np.linspace(0.0, 2 * np.pi, 13)
    hoop = np.column_stack([0.28 * np.cos(ring), np.full(13, -0.09), 1.3 + 0.28 * np.sin(ring)])
    return [
        post(1.75, 0.045, "bench_wood"),
        box((-0.35, -0.05, 0.95), (0.35, -0.03, 1.7), "sign", YELLOW),
        tube(hoop, 0.06, "plastic", RED, sides=6, caps=(False, False)),
    ]


def quay_steps() -> Shapes:
    """Flight of stone steps down to the water, 2.4 m wide, before the edge of a quay."""
    parts: Shapes = []
    for k in range(6):
        top = 0.0 - 0.17 * k
        parts.append(box((-1.2, -0.32 * (k + 1), -1.4), (1.2, -0.32 * k, top), "stone", STONE))
    return parts


CRANE = (0.80, 0.42, 0.10)  # paint of cranes
CARGO = ((0.45, 0.10, 0.08), (0.10, 0.22, 0.42), (0.12, 0.34, 0.22), (0.62, 0.60, 0.55))


def quay_crane() -> Shapes:
    """Portal crane of 27 m on four legs, its boom ahead over 30 m."""
    parts: Shapes = [
        box((x - 0.5, y - 0.5, -0.1), (x + 0.5, y + 0.5, 15.0), "metal_panel", CRANE)
        for x in (-5.0, 5.0) for y in (-4.0, 4.0)
    ]  # fmt: skip
    for y in (-4.0, 4.0):
        parts.append(box((-5.5, y - 0.4, 14.6), (5.5, y + 0.4, 16.2), "metal_panel", CRANE))
        parts.append(box((-5.0, y - 0.2, 4.0), (5.0, y + 0.2, 4.5), "metal_panel", CRANE))
    for x in (-5.0, 5.0):
        parts.append(box((x - 0.4, -4.5, 14.6), (x + 0.4, 4.5, 16.2), "metal_panel", CRANE))
    parts.append(box((-1.0, -16.0, 18.0), (1.0, 14.0, 19.4), "metal_panel", CRANE))
    parts.append(box((-2.2, 4.0, 16.2), (2.2, 12.0, 21.0), "metal_panel", (0.72, 0.72, 0.70)))
    parts.append(box((-0.9, -4.0, 15.4), (0.9, -1.6, 18.0), "glass", (0.35, 0.42, 0.46)))
    parts.append(box((-0.6, 2.0, 19.4), (0.6, 3.2, 27.0), "metal_panel", CRANE))
    for y in (-15.0, 12.0):
        parts.append(tube([(0.0, 2.6, 26.8), (0.0, y, 19.4)], [0.12, 0.12], "metal_dark", sides=5))
    parts.append(tube([(0.0, -12.0, 18.0), (0.0, -12.0, 7.0)], [0.06, 0.06], "metal_dark", sides=4))
    parts.append(box((-0.8, -12.8, 6.0), (0.8, -11.2, 7.0), "metal_dark"))
    return parts


def container_stack() -> Shapes:
    """Nine containers of 12 m, three beside each other and up to three high."""
    parts: Shapes = []
    for row, high in enumerate((3, 2, 3)):
        for level in range(high):
            low = (-6.1, -4.0 + 2.7 * row, 2.6 * level)
            far = (6.1, low[1] + 2.44, low[2] + 2.58)
            paint = CARGO[(3 * row + 2 * level) % len(CARGO)]
            parts.append(box(low, far, "metal_panel", paint, bottom=False))
            doors = ((-6.13, low[1] + 0.1, low[2] + 0.1), (-6.1, far[1] - 0.1, far[2] - 0.1))
            parts.append(box(*doors, "metal_dark"))
    return parts


SHORE_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            quay_crane, container_stack,
            rowing_boat, motor_boat, barge, reeds, boulder, mooring_bollard, quay_ladder,
            life_ring, quay_steps,
        )
    }
)  # fmt: skip
