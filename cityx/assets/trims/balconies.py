"""Balconies: floor level and middle at the origin, x along the wall, y into it.

The forms for near views have the origins and sizes of the plain ones.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from cityx.assets.openings.frames import slab
from cityx.assets.shapes import Color, bevelled, box, cards, lathe, loft, moved, tube
from cityx.assets.trims.mouldings import Shapes, console, raised_panel, scroll, soft
from cityx.city.mesh import MeshBatch, one_mesh
from cityx.geometry.arrays import FloatArray
from cityx.ids import rng_for

BALCONY_WIDTH = 2.4  # metres, of every balcony
_B = BALCONY_WIDTH / 2


def _railing(depth: float, rods: int) -> Shapes:
    shapes: Shapes = []
    for z0, z1 in ((0.06, 0.09), (0.99, 1.04)):
        shapes.append(box((-_B, -depth, z0), (_B, -depth + 0.04, z1), "metal_dark"))
        for x in (-_B, _B - 0.04):
            shapes.append(box((x, -depth + 0.04, z0), (x + 0.04, 0.0, z1), "metal_dark"))
    for x in np.linspace(-_B, _B - 0.02, rods):
        shapes.append(box((x, -depth + 0.01, 0.09), (x + 0.02, -depth + 0.03, 0.99), "metal_dark",
                          bottom=False))  # fmt: skip
    side = max(3, round(depth / (2 * _B) * rods))
    for y in np.linspace(-depth, -0.1, side)[1:]:
        for x in (-_B + 0.01, _B - 0.03):
            shapes.append(box((x, y, 0.09), (x + 0.02, y + 0.02, 0.99), "metal_dark",
                              bottom=False))  # fmt: skip
    return shapes


def balcony_iron() -> Shapes:
    """Shallow stone balcony on consoles with an iron railing."""
    shapes: Shapes = [slab(-_B - 0.05, _B + 0.05, -0.14, 0.0, -0.95, "trim")]
    for x in (-_B + 0.3, _B - 0.3):
        outline = np.array([(0.0, -0.6), (-0.14, -0.5), (-0.2, -0.3), (-0.6, -0.14), (0.0, -0.14)])
        ends = [np.column_stack([np.full(5, x + dx), outline]) for dx in (-0.09, 0.09)]
        shapes.append(loft(np.stack(ends), "trim"))
    return shapes + _railing(0.9, 17)


def balcony_solid() -> Shapes:
    """Concrete balcony with a solid parapet and a rail."""
    return [
        slab(-_B, _B, -0.18, 0.0, -1.15, "trim"),
        box((-_B, -1.15, 0.0), (_B, -1.05, 0.85), "trim", (0.92, 0.92, 0.92)),
        box((-_B, -1.05, 0.0), (-_B + 0.1, 0.0, 0.85), "trim", (0.92, 0.92, 0.92)),
        box((_B - 0.1, -1.05, 0.0), (_B, 0.0, 0.85), "trim", (0.92, 0.92, 0.92)),
        box((-_B, -1.12, 0.98), (_B, -1.08, 1.02), "metal_grey"),
    ]


def balcony_bars() -> Shapes:
    """Concrete slab with a plain railing."""
    return [slab(-_B, _B, -0.2, 0.0, -1.2, "trim"), *_railing(1.18, 15)]


def balcony_glass() -> Shapes:
    """Slab with a glass balustrade."""
    return [
        slab(-_B, _B, -0.2, 0.0, -1.25, "trim"),
        box((-_B, -1.24, 0.04), (_B, -1.22, 1.0), "glass"),
        box((-_B, -1.22, 0.04), (-_B + 0.02, 0.0, 1.0), "glass"),
        box((_B - 0.02, -1.22, 0.04), (_B, 0.0, 1.0), "glass"),
        box((-_B, -1.26, 1.0), (_B, -1.21, 1.05), "metal_grey"),
    ]


def balcony_rail() -> Shapes:
    """Railing close before a French window, drawn for the balcony's width."""
    return _railing(0.22, 21)


def _slab(depth: float, thick: float, *, more: float = 0.0, soffit: bool = True) -> Shapes:
    """Floor of a balcony with a moulded edge on three sides and a drip."""
    line = soft([(0.12, -thick), (0.06, -thick), (0.05, -thick + 0.02), (0.045, -thick + 0.05),
                 (0.012, -0.07), (0.0, -0.06), (0.0, -0.012), (0.012, 0.0), (0.12, 0.0)], 0.008,
                     3)  # fmt: skip
    half = _B + more
    corners = np.array([[-half, 0.0], [-half, -depth], [half, -depth], [half, 0.0]])
    edge = _level_ring(corners, line)
    a, b = half - 0.12, depth - 0.12
    top = np.array([[-a, -b, 0.0], [a, -b, 0.0], [a, 0.0, 0.0], [-a, 0.0, 0.0]])
    low = (top - [0.0, 0.0, thick])[::-1]
    shapes = [edge, one_mesh(0, top, [[0, 1, 2, 3]], materials=("trim",), uv=top[None, :, :2])]
    if soffit:
        shapes.append(one_mesh(0, low, [[0, 1, 2, 3]], materials=("trim",), uv=low[None, :, :2]))
    return shapes


def _level_ring(path: FloatArray, profile: FloatArray, material: str = "trim") -> MeshBatch:
    """Sweep a profile of (inward, up) along an open path in plan whose left side is inside."""
    ahead = np.diff(path, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    normal = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    before = np.vstack([normal[:1], normal])
    after = np.vstack([normal, normal[-1:]])
    mitre = (before + after) / (1 + (before * after).sum(1))[:, None]
    k, p = len(path), len(profile)
    flat = path[:, None] + mitre[:, None] * profile[None, :, :1]
    level = np.broadcast_to(profile[:, 1], (k, p))[..., None]
    vertices = np.concatenate([flat, level], axis=2).reshape(-1, 3)
    row, column = np.meshgrid(np.arange(k - 1), np.arange(p - 1), indexing="ij")
    a = (row * p + column).ravel()
    faces = np.column_stack([a, a + p, a + p + 1, a + 1])
    run = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    up = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    flat_uv = np.stack(np.meshgrid(run, up, indexing="ij"), -1).reshape(-1, 2)
    return one_mesh(0, vertices, faces, materials=(material,), uv=flat_uv[faces])


def _rail_path(depth: float) -> FloatArray:
    return np.array([[-_B, 0.0], [-_B, -depth], [_B, -depth], [_B, 0.0]])


def _handrail(depth: float, z: float, material: str = "metal_dark") -> Shapes:
    line = soft([(0.034, z - 0.01), (0.034, z - 0.028), (0.006, z - 0.028), (0.0, z - 0.02),
                 (0.0, z - 0.004), (0.008, z), (0.032, z), (0.040, z - 0.004), (0.040, z - 0.02),
                 (0.034, z - 0.028)], 0.006, 3)  # fmt: skip
    return [_level_ring(_rail_path(depth), line, material)]


def _lower_rail(depth: float, z: float) -> Shapes:
    line = np.array([(0.03, z), (0.008, z), (0.008, z + 0.012), (0.03, z + 0.012), (0.03, z)])
    return [_level_ring(_rail_path(depth), line, "metal_dark")]


def _places(depth: float, pitch: float) -> list[tuple[float, float]]:
    """Places along the three sides of a railing, at its middle line."""
    found = [(float(x), -depth + 0.02) for x in np.arange(-_B + 0.02, _B, pitch)]
    count = max(2, round((depth - 0.06) / pitch))
    for y in np.linspace(-depth + 0.02, -0.04, count)[1:]:
        found += [(-_B + 0.02, float(y)), (_B - 0.02, float(y))]
    return found


def _iron_bars(depth: float, pitch: float, *, ornate: bool) -> Shapes:
    """Rods with collars; ornate ones carry scrolls and a row of rings under the handrail."""
    shapes: Shapes = []
    for number, (x, y) in enumerate(_places(depth, pitch)):
        path = [[x, y, 0.06], [x, y, 0.46], [x, y, 0.48], [x, y, 0.50], [x, y, 0.52], [x, y, 0.54],
                [x, y, 0.98]]  # fmt: skip
        radii = [0.008, 0.008, 0.011, 0.016, 0.011, 0.008, 0.008]
        if ornate:
            shapes.append(tube(path, radii, "metal_dark", sides=8, caps=(False, False)))
        else:
            shapes.append(tube([path[0], path[-1]], 0.009, "metal_dark", sides=10,
                               caps=(False, False)))  # fmt: skip
            for z in (0.07, 0.965):
                shapes.append(tube([[x, y, z - 0.006], [x, y, z + 0.006]], 0.014, "metal_dark",
                                   sides=10))  # fmt: skip
        front = y < -depth + 0.03 and abs(x) < _B - 0.05
        if ornate and front and number % 2:
            for turn in (-1.0, 1.0):
                shapes.append(scroll(x + turn * 0.5 * pitch, 0.24, y, 0.42 * pitch, -turn,
                    radius=0.006,
                                     start=np.pi / 2))  # fmt: skip
                shapes.append(scroll(x + turn * 0.5 * pitch, 0.76, y, 0.42 * pitch, turn,
                    radius=0.006,
                                     start=-np.pi / 2))  # fmt: skip
        if ornate and front:
            angle = np.linspace(0, 2 * np.pi, 15)
            ring = np.column_stack([x + pitch / 2 + 0.036 * np.cos(angle), np.full(15, y),
                                    0.925 + 0.036 * np.sin(angle)])  # fmt: skip
            shapes.append(tube(ring, 0.006, "metal_dark", sides=8, caps=(False, False)))
    return shapes


def _newels(depth: float) -> Shapes:
    line = [(0.022, 0.0), (0.022, 0.08), (0.016, 0.10), (0.016, 1.02), (0.026, 1.05), (0.03, 1.09),
            (0.026, 1.13), (0.014, 1.15), (0.0, 1.17)]  # fmt: skip
    return [moved(lathe(line, "metal_dark", sides=14), (x, -depth + 0.02, 0.0))
            for x in (-_B + 0.02, _B - 0.02)]  # fmt: skip


def fine_balcony_iron() -> Shapes:
    """Stone balcony on scrolled consoles with a wrought-iron railing."""
    shapes = _slab(0.95, 0.14, more=0.05)
    for x in (-_B + 0.3, _B - 0.3):
        shapes += [moved(part, (x, 0.0, -0.14)) for part in console(0.62, 0.46, 0.18)]
    shapes += _handrail(0.9, 1.04) + _lower_rail(0.9, 0.06) + _lower_rail(0.9, 0.875)
    return shapes + _iron_bars(0.9, 0.14, ornate=True) + _newels(0.9)


def fine_balcony_solid() -> Shapes:
    """Concrete balcony: parapet with recessed panels, coping, rail on posts, flower boxes."""
    shapes = _slab(1.15, 0.18)
    tint: Color = (0.92, 0.92, 0.92)
    line = np.array([(0.10, 0.0), (0.0, 0.0), (0.0, 0.85), (0.10, 0.85), (0.10, 0.0)])
    shapes.append(_level_ring(_rail_path(1.15), line))
    for x0, x1 in pairwise(np.linspace(-_B, _B, 4)):
        panel = raised_panel(x0 + 0.05, x1 - 0.05, 0.08, 0.77, 0.0, "trim", tint)
        shapes += [moved(part, (0.0, -1.15, 0.0)) for part in panel]
    cap = soft([(0.115, 0.84), (-0.015, 0.84), (-0.015, 0.875), (0.0, 0.885), (0.10, 0.89),
                (0.115, 0.875), (0.115, 0.84)], 0.008, 3)  # fmt: skip
    shapes.append(_level_ring(_rail_path(1.15), cap))
    rail = np.array([[-_B + 0.05, 0.0, 1.0], [-_B + 0.05, -1.10, 1.0], [_B - 0.05, -1.10, 1.0],
                     [_B - 0.05, 0.0, 1.0]])  # fmt: skip
    for a, b in pairwise(rail):
        shapes.append(tube([a, b], 0.021, "metal_grey", sides=16))
        for t in np.linspace(0.08, 0.92, 4):
            foot = a + t * (b - a)
            shapes.append(tube([foot - [0, 0, 0.12], foot], 0.011, "metal_grey", sides=10))
    return shapes + [part for x in (-0.55, 0.55) for part in _flower_box(x, -1.27, 0.66)]


def _flower_box(x: float, y: float, z: float, half: float = 0.42) -> Shapes:
    """Box of flowers: soil, stems and small leaves."""
    rng = rng_for(0, "assets/flower box", round(1000 * (x + 10)))
    shapes: Shapes = [bevelled((x - half, y - 0.09, z), (x + half, y + 0.09, z + 0.17), "plastic",
                               (0.32, 0.16, 0.10), bevel=0.01)]  # fmt: skip
    count = 150
    centre = np.column_stack([rng.uniform(x - half, x + half, count), y + rng.normal(0, 0.07,
        count),
                              z + 0.17 + rng.gamma(2.0, 0.05, count)])  # fmt: skip
    centre[:, 2] -= 0.12 * (np.abs(centre[:, 1] - y) > 0.1)
    normal = rng.normal(size=(count, 3)) + np.array([0.0, -0.6, 0.8])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, rng.normal(size=(count, 3)))
    along *= 0.038 / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-6)
    bloom = rng.uniform(size=count) < 0.3
    green = rng.uniform(0.7, 1.2, (count, 1)) * np.ones(3)
    shapes.append(cards(centre[~bloom], along[~bloom], np.cross(normal, along)[~bloom], "leaf",
                        green[~bloom]))  # fmt: skip
    red = rng.uniform(0.7, 1.0, (count, 1)) * np.array([0.75, 0.06, 0.07])
    shapes.append(cards(centre[bloom] + np.array([0, 0, 0.02]), along[bloom], np.cross(normal,
        along)[bloom],
                        "plastic", red[bloom]))  # fmt: skip
    return shapes


def fine_balcony_bars() -> Shapes:
    """Concrete slab with a drip and a steel railing of round bars."""
    shapes = _slab(1.2, 0.2) + _handrail(1.18, 1.05) + _lower_rail(1.18, 0.08)
    return shapes + _iron_bars(1.18, 0.105, ornate=False) + _flower_box(0.5, -1.1, 0.02)


def fine_balcony_glass() -> Shapes:
    """Slab with panes held by clamps on posts under a handrail."""
    shapes = _slab(1.25, 0.2)
    for x0, x1 in pairwise(np.linspace(-_B, _B, 4)):
        shapes.append(bevelled((x0 + 0.02, -1.236, 0.06), (x1 - 0.02, -1.224, 0.99), "pane",
                               bevel=0.002))  # fmt: skip
    for x in (-_B + 0.008, _B - 0.008):
        shapes.append(
            bevelled((x - 0.006, -1.2, 0.06), (x + 0.006, -0.02, 0.99), "pane", bevel=0.002)
        )
    for x in np.linspace(-_B + 0.02, _B - 0.02, 4):
        shapes.append(bevelled((x - 0.018, -1.21, 0.0), (x + 0.018, -1.17, 1.0), "metal_grey"))
        shapes.append(bevelled((x - 0.05, -1.23, -0.01), (x + 0.05, -1.13, 0.012), "metal_grey"))
        for z in (0.22, 0.82):
            for side in (-1.0, 1.0):
                shapes.append(tube([[x + side * 0.035, -1.245, z], [x + side * 0.035, -1.19, z]],
                    0.018,
                                   "metal_grey", sides=14))  # fmt: skip
    rail = np.array([[-_B, 0.0, 1.02], [-_B, -1.23, 1.02], [_B, -1.23, 1.02], [_B, 0.0, 1.02]])
    for a, b in pairwise(rail):
        shapes.append(tube([a, b], 0.022, "metal_grey", sides=18))
    return shapes


def fine_balcony_rail() -> Shapes:
    """Wrought-iron railing close before a French window."""
    depth = 0.22
    shapes = _handrail(depth, 1.04) + _lower_rail(depth, 0.06) + _lower_rail(depth, 0.875)
    return shapes + _iron_bars(depth, 0.115, ornate=True)
