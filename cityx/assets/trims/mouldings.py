"""Mouldings and other small work of joiners, masons, smiths and upholsterers, drawn for near views.

x along the wall, y into it, z up, as in `openings.frames`. Profiles are swept round outlines
with mitres, so that corners close.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from cityx.assets.shapes import WHITE, Color, loft, moved, tube
from cityx.city.mesh import MeshBatch, one_mesh
from cityx.geometry.arrays import FloatArray

Shapes = list[MeshBatch]


def rectangle(x0: float, x1: float, z0: float, z1: float) -> FloatArray:
    """Outline (4, 2) of a rectangle, counter-clockwise seen from outside."""
    return np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]], float)


def soft(profile: ArrayLike, radius: float = 0.004, steps: int = 2) -> FloatArray:
    """Round the inner corners of an open polyline, (p, 2), by arcs of `steps` pieces."""
    line = np.asarray(profile, float)
    found = [line[:1]]
    for before, here, after in zip(line[:-2], line[1:-1], line[2:], strict=True):
        a, b = before - here, after - here
        la, lb = max(np.hypot(*a), 1e-9), max(np.hypot(*b), 1e-9)
        reach = min(radius, 0.45 * la, 0.45 * lb)
        start, end = here + a / la * reach, here + b / lb * reach
        t = np.linspace(0.0, 1.0, steps + 1)[:, None]
        found.append((1 - t) ** 2 * start + 2 * t * (1 - t) * here + t**2 * end)
    return np.vstack([*found, line[-1:]])


def ring_moulding(outline: ArrayLike, profile: ArrayLike, material: str, tint: Color = WHITE,
                  *, closed: bool = True) -> MeshBatch:  # fmt: skip
    """Sweep a profile round an outline.

    Parameters
    ----------
    outline
        (k, 2) float, x and z, counter-clockwise seen from outside; the frame is drawn within it.
    profile
        (p, 2) float: metres inward from the outline, and y; from the outer edge to the inner one.
    closed
        Whether the last point of the outline joins the first.
    """
    points, line = np.asarray(outline, float), np.asarray(profile, float)
    k, p = len(points), len(line)
    ahead = np.roll(points, -1, axis=0) - points
    size = np.maximum(np.hypot(*ahead.T), 1e-9)
    normal = np.column_stack([-ahead[:, 1], ahead[:, 0]]) / size[:, None]
    last = np.roll(normal, 1, axis=0)
    if not closed:
        normal[-1], last[0] = last[-1], normal[0]
    mitre = (normal + last) / np.maximum(1 + (normal * last).sum(1), 0.1)[:, None]
    flat = points[:, None] + line[None, :, :1] * mitre[:, None]  # (k, p, 2)
    depth = np.broadcast_to(line[:, 1], (k, p))
    vertices = np.stack([flat[..., 0], depth, flat[..., 1]], axis=-1).reshape(-1, 3)
    row, column = np.meshgrid(np.arange(k if closed else k - 1), np.arange(p - 1), indexing="ij")
    row, column = row.ravel(), column.ravel()
    after = (row + 1) % k
    faces = np.column_stack(
        [row * p + column, after * p + column, after * p + column + 1, row * p + column + 1]
    )
    along = np.concatenate([[0.0], np.cumsum(size)])
    across = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    u0, u1, v0, v1 = along[row], along[row + 1], across[column], across[column + 1]
    uv = np.stack([np.stack(pair, -1) for pair in ((u0, v0), (u1, v0), (u1, v1), (u0, v1))], axis=1)
    return one_mesh(0, vertices, faces, materials=(material,), uv=uv, tint=tint)


def frame(x0: float, x1: float, z0: float, z1: float, profile: ArrayLike, material: str,
          tint: Color = WHITE) -> MeshBatch:  # fmt: skip
    """Sweep a profile round a rectangle, inward."""
    return ring_moulding(rectangle(x0, x1, z0, z1), profile, material, tint)


def portal(x0: float, x1: float, z0: float, z1: float, profile: ArrayLike, material: str,
           tint: Color = WHITE) -> MeshBatch:  # fmt: skip
    """Sweep a profile up, over and down: a frame without its foot."""
    path = [[x1, z0], [x1, z1], [x0, z1], [x0, z0]]
    return ring_moulding(path, profile, material, tint, closed=False)


def ledge(profile: ArrayLike, x0: float, x1: float, material: str,
          tint: Color = WHITE) -> MeshBatch:  # fmt: skip
    """Sweep a closed profile, (p, 2) of y and z, from x0 to x1, with its ends.

    The profile runs counter-clockwise as seen from +x, where y points right and z up.
    """
    ring = np.asarray(profile, float)
    ends = [np.column_stack([np.full(len(ring), x), ring]) for x in (x0, x1)]
    return loft(np.stack(ends), material, tint)


def bar(start: Sequence[float], end: Sequence[float], half: float, y: float, material: str,
        *, depth: float = 0.024) -> MeshBatch:  # fmt: skip
    """Make a moulded glazing bar between two points (x, z), its nose at depth `y`."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    way = (b - a) / max(np.hypot(*(b - a)), 1e-9)
    side = np.array([way[1], -way[0]])  # to the right of the way
    across = half * np.array([-1.0, -1.0, -0.8, -0.45, -0.25, 0.25, 0.45, 0.8, 1.0, 1.0])
    level = y + depth * np.array([1.0, 0.62, 0.4, 0.22, 0.0, 0.0, 0.22, 0.4, 0.62, 1.0])
    p = len(across)
    rows = [np.column_stack([at[0] + across * side[0], level, at[1] + across * side[1]])
            for at in (a, b)]  # fmt: skip
    index = np.arange(p - 1)
    # Seen from outside the profile runs from left to right of the way: turn to face out.
    faces = np.column_stack([index, index + 1, index + 1 + p, index + p])
    return one_mesh(0, np.vstack(rows), faces, materials=(material,))


def sheet(grid: ArrayLike, material: str, tint: ArrayLike = WHITE) -> MeshBatch:
    """Skin a grid of points, (rows from below, columns from left, 3), that faces outward."""
    points = np.asarray(grid, float)
    m, n, _ = points.shape
    row, column = np.meshgrid(np.arange(m - 1), np.arange(n - 1), indexing="ij")
    a = (row * n + column).ravel()
    faces = np.column_stack([a, a + 1, a + 1 + n, a + n])
    flat = points[..., [0, 2]].reshape(-1, 2)
    return one_mesh(0, points.reshape(-1, 3), faces, materials=(material,), uv=flat[faces],
                    tint=tint)  # fmt: skip


def curtain(x0: float, x1: float, z0: float, z1: float, y: float, *, folds: int,
            tied: float = 0.0, tint: Color = WHITE, rows: int = 8) -> MeshBatch:  # fmt: skip
    """Hang a curtain in folds.

    Parameters
    ----------
    x0, x1, z0, z1
        What it covers, metres.
    y
        Depth of the middle of its folds.
    folds
        Number of folds; each is drawn with eight pieces.
    tied
        Share of the width by which it is drawn to the side of x0 below the middle.
    """
    s = np.linspace(0.0, 1.0, 8 * folds + 1)
    t = np.linspace(0.0, 1.0, rows + 1)
    waist = tied * np.exp(-(((t - 0.42) / 0.22) ** 2))
    x = x0 + (x1 - x0) * s[None] * (1 - waist[:, None])
    swell = 0.55 + 0.45 * (1 - t)[:, None]
    wave = np.sin(2 * np.pi * folds * s)[None] + 0.35 * np.sin(
        2 * np.pi * (folds * 0.5 * s[None] + 0.6 * t[:, None])
    )
    grid = np.stack(
        [x, y - 0.009 * swell * wave, np.broadcast_to(z0 + (z1 - z0) * t[:, None], x.shape)], -1
    )
    if x1 < x0:
        grid = grid[:, ::-1]
    return sheet(grid, "curtain", tint)


def slats(x0: float, x1: float, z0: float, z1: float, y: float, *, pitch: float = 0.026,
          material: str = "curtain", tint: Color = WHITE) -> Shapes:  # fmt: skip
    """Hang a blind of curved slats with cords and a lower rail."""
    count = max(2, int((z1 - z0) / pitch))
    bow = np.array([(-0.011, -0.006), (-0.006, -0.001), (0.0, 0.001), (0.006, 0.0),
                    (0.011, -0.003)])  # fmt: skip
    z = z1 - 0.02 - pitch * np.arange(count)[:, None]
    shapes: Shapes = []
    over = np.stack([np.broadcast_to(y + bow[:, 0], (count, 5)), z + bow[:, 1]], -1)
    for thick, ends in ((0.0, (x0, x1)), (-0.0012, (x1, x0))):
        rows = over + np.array([0.0, thick])
        line = np.stack([np.concatenate([np.full((count, 5, 1), x), rows], 2) for x in ends], 2)
        p = 10
        base = p * np.arange(count)[:, None] + 2 * np.arange(4)[None]
        a = base.ravel()
        faces = np.column_stack([a, a + 1, a + 3, a + 2])
        shapes.append(one_mesh(0, line.reshape(-1, 3), faces, materials=(material,), tint=tint))
    rail = soft([(y - 0.012, -0.012), (y + 0.012, -0.012), (y + 0.012, 0.008), (y - 0.012, 0.008)])
    low = float(z[-1, 0]) - pitch
    shapes.append(ledge(rail + np.array([0.0, low]), x0, x1, material, tint))
    for share in (0.15, 0.85):
        x = x0 + share * (x1 - x0)
        shapes.append(tube([[x, y - 0.013, low], [x, y - 0.013, z1]], 0.0012, material, sides=4,
                           caps=(False, False)))  # fmt: skip
    return shapes


def raised_panel(x0: float, x1: float, z0: float, z1: float, front: float, material: str,
                 tint: Color = WHITE) -> Shapes:  # fmt: skip
    """Make a field with a bolection moulding that stands on a leaf whose face is at `front`."""
    span = min(x1 - x0, z1 - z0)
    wide = min(1.0, span / 0.30)
    line = np.array([(0.0, 0.0), (0.0, -0.010), (0.006, -0.015), (0.016, -0.016), (0.024, -0.011),
                     (0.028, -0.003), (0.034, -0.002), (0.036, -0.001), (0.075, -0.003),
                     (0.092, -0.009), (0.097, -0.010)])  # fmt: skip
    profile = soft(line * [wide, 1.0] + np.array([0.0, front]), 0.003, 2)
    inset = 0.097 * wide
    field = rectangle(x0 + inset, x1 - inset, z0 + inset, z1 - inset)
    corners = np.column_stack([field[:, 0], np.full(4, front - 0.010), field[:, 1]])
    return [
        frame(x0, x1, z0, z1, profile, material, tint),
        one_mesh(0, corners, [[0, 1, 2, 3]], materials=(material,), uv=field[None], tint=tint),
    ]


def lever(x: float, z: float, y: float, turn: float, material: str = "metal_grey") -> Shapes:
    """Make a lever handle on a plate; `turn` is the side it points to, -1 or 1."""
    plate = soft([(0.0, y), (0.0, y - 0.004), (0.004, y - 0.007), (0.012, y - 0.008)], 0.002, 2)
    grip = [[x, y - 0.004, z], [x, y - 0.035, z], [x + turn * 0.01, y - 0.046, z],
            [x + turn * 0.03, y - 0.050, z], [x + turn * 0.12, y - 0.050, z - 0.006]]  # fmt: skip
    corners = rectangle(x - 0.012, x + 0.012, z - 0.10, z + 0.06)
    return [
        ring_moulding(rectangle(x - 0.022, x + 0.022, z - 0.11, z + 0.07), plate, material),
        one_mesh(0, np.column_stack([corners[:, 0], np.full(4, y - 0.008), corners[:, 1]]),
                 [[0, 1, 2, 3]], materials=(material,)),
        tube(grip, [0.009, 0.009, 0.009, 0.009, 0.007], material, sides=12),
        tube([[x, y - 0.004, z - 0.07], [x, y - 0.010, z - 0.07]], 0.008, "metal_dark", sides=12),
    ]  # fmt: skip


def knob(x: float, z: float, y: float, radius: float = 0.03,
         material: str = "metal_grey") -> MeshBatch:  # fmt: skip
    """Make a turned knob that stands out from a face at `y`."""
    s = np.linspace(0.0, np.pi, 7)[1:]
    path = [[x, y, z], [x, y - 0.006, z], [x, y - 0.02, z]]
    radii = [0.9 * radius, 0.8 * radius, 0.35 * radius]
    for angle in s:
        path.append([x, y - 0.02 - radius * (1 - np.cos(angle)) * 0.8, z])
        radii.append(max(radius * np.sin(angle), 0.35 * radius if angle < 1 else 0.002))
    return tube(path, radii, material, sides=14)


def hinge(x: float, z: float, y: float, material: str = "metal_grey") -> Shapes:
    """Make a butt hinge: a knuckle of three with finials."""
    shapes: Shapes = []
    for low, high in ((-0.045, -0.016), (-0.014, 0.014), (0.016, 0.045)):
        shapes.append(tube([[x, y, z + low], [x, y, z + high]], 0.007, material, sides=10))
    tip = [[x, y, z + 0.045], [x, y, z + 0.05], [x, y, z + 0.056]]
    shapes.append(tube(tip, [0.006, 0.008, 0.002], material, sides=10))
    return shapes


def scroll(x: float, z: float, y: float, size: float, turn: float, *, start: float = 0.0,
           radius: float = 0.008, material: str = "metal_dark") -> MeshBatch:  # fmt: skip
    """Bend an iron bar to a volute about a point."""
    count = 24
    angle = np.linspace(0.0, 3.4 * np.pi, count)
    reach = size * (1.0 - 0.78 * angle / angle[-1])
    path = np.column_stack(
        [
            x + turn * reach * np.cos(angle + start),
            np.full(count, y),
            z + reach * np.sin(angle + start),
        ]
    )
    return tube(path, np.linspace(radius, 0.6 * radius, count), material, sides=6)


def console(reach: float, tall: float, wide: float) -> Shapes:
    """Carve a scrolled console that hangs below the origin.

    Parameters
    ----------
    reach
        Metres from the wall to its front.
    tall, wide
        Metres down and along the wall.
    """
    t = np.linspace(0.0, 1.0, 17)
    out = 0.05 + (reach - 0.06) * (1 - t) ** 1.6 + 0.012 * np.sin(3 * np.pi * t)
    line = np.vstack([np.column_stack([-out, -tall * t]), [(0.0, -tall), (0.0, 0.0)]])
    shapes: Shapes = [ledge(line, -wide / 2, wide / 2, "trim")]
    for side in (-1.0, 1.0):
        volute = scroll(0.0, 0.0, 0.0, 0.28 * reach, 1.0, material="trim", radius=0.05 * reach)
        shapes.append(moved(volute, (side * wide / 2, -0.55 * reach, -0.3 * reach), yaw=np.pi / 2))
    return shapes
