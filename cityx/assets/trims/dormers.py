"""What breaks or edges a sloping roof: dormers, roof windows, panels, ridge tiles, gutters.

Dormers stand on the roof with the middle of their front at the origin, where the front meets the
slope; -y points to the eave, and their depth of `DEPTH` metres is scaled until the back lies inside
the roof. What lies in the slope has x along the eave, y up the slope and z away from the roof.
Ridge tiles and gutters are one metre long (x from -0.5 to 0.5).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from cityx.assets.openings.frames import Shapes
from cityx.assets.shapes import box, loft, prism, prototype
from cityx.city.mesh import MeshBatch, one_mesh
from cityx.city.scene import Prototype

DEPTH = 2.0  # metres, drawn depth of dormers
SUNK = 0.3  # metres a dormer reaches below the slope at its front
# Width of the walls, height of the front to its eave, height of its own roof above that; metres.
DORMERS: dict[str, tuple[float, float, float]] = {
    "gabled": (1.5, 1.55, 0.6), "hipped": (1.5, 1.55, 0.55), "segment": (1.5, 1.5, 0.4),
    "shed": (2.3, 1.4, 0.3),
}  # fmt: skip
# The window in the front: width, height, and height of its foot above the slope.
OPENING = (1.0, 1.2, 0.2)
SHED_OPENING = (1.7, 1.0, 0.22)
EAVE, FRONT = 0.12, 0.14  # metres that a dormer's roof runs out at its sides and its front
THICK = 0.09
PLATE = 0.03  # metres by which the front stands before the cheeks
ROOF_WINDOW = (0.94, 1.4)  # metres, along the eave and up the slope
PANELS = (3.3, 3.4)  # metres, of a field of solar panels
_STEPS = 8  # pieces of an arc


def dormer_opening(kind: str) -> tuple[float, float, float]:
    """Return width, height and foot of the window of a dormer."""
    return SHED_OPENING if kind == "shed" else OPENING


def _arc(width: float, height: float, rise: float) -> list[tuple[float, float]]:
    """Points of a flat arch from its right spring to its left."""
    half = width / 2
    radius = (half**2 + rise**2) / (2 * rise)
    reach = np.arcsin(half / radius)
    turn = np.linspace(reach, -reach, _STEPS + 1)
    return [(float(radius * np.sin(t)), float(height + rise - radius + radius * np.cos(t)))
            for t in turn]  # fmt: skip


def _front(kind: str) -> list[tuple[float, float]]:
    """Outline of the front, x and z, counter-clockwise from the front."""
    width, height, rise = DORMERS[kind]
    low = [(-width / 2, -SUNK), (width / 2, -SUNK)]
    if kind == "gabled":
        return [*low, (width / 2, height), (0.0, height + rise - THICK), (-width / 2, height)]
    if kind == "segment":
        return [*low, *_arc(width, height, rise)]
    return [*low, (width / 2, height), (-width / 2, height)]


@lru_cache(maxsize=16)
def dormer_front(kind: str, *, detail: int = 2) -> Prototype:
    """Make the front of a dormer, a plate the window stands before; `kind` is of `DORMERS`."""
    width, height, opening = (*DORMERS[kind][:2], dormer_opening(kind))
    half, top = opening[0] / 2, opening[1] + opening[2]
    shapes: Shapes = [prism(_front(kind), -PLATE, 0.02, "plaster")]
    if detail > 2:  # a frame round the opening and a sill
        edge = min(0.1, width / 2 - half)
        shapes += [
            box((-half - edge, -PLATE - 0.02, opening[2]), (-half, -PLATE, top), "trim"),
            box((half, -PLATE - 0.02, opening[2]), (half + edge, -PLATE, top), "trim"),
            box((-half - edge, -PLATE - 0.02, top),
                (half + edge, -PLATE, min(top + edge, height)), "trim"),
        ]  # fmt: skip
    shapes.append(
        box((-half - 0.1, -PLATE - 0.07, opening[2] - 0.06), (half + 0.1, -PLATE, opening[2]),
            "trim")
    )  # fmt: skip
    return prototype(f"dormer_{kind}_front", "trim", shapes)


@lru_cache(maxsize=64)
def dormer_roof(kind: str, material: str, *, detail: int = 2) -> Prototype:
    """Make the cheeks and the roof of a dormer of one roof material."""
    del detail
    width, height, rise = DORMERS[kind]
    shapes: Shapes = [prism(_front(kind), 0.02, DEPTH, material, (0.92, 0.92, 0.92))]
    half = width / 2 + EAVE
    if kind == "gabled":
        drop = EAVE * rise / (width / 2)
        for side in (-1.0, 1.0):
            line = [(side * half, height - drop - 0.02), (0.0, height + rise - THICK)]
            ring = [*line, (0.0, height + rise), (side * half, height - drop - 0.02 + THICK)]
            shapes.append(_run(ring, material))
    elif kind == "segment":
        outer = _arc(width + 2 * EAVE, height - 0.04, rise + 0.12)
        inner = _arc(width + 2 * EAVE - 0.02, height - 0.1, rise + 0.08)
        for k in range(_STEPS):
            shapes.append(_run([inner[k], outer[k], outer[k + 1], inner[k + 1]], material))
    elif kind == "shed":
        corners = ((-half, THICK), (half, THICK), (half, 0.0), (-half, 0.0))
        rings = [[[x, y, z + dz] for x, dz in corners]
                 for y, z in ((-FRONT, height - 0.02), (DEPTH, height + rise))]  # fmt: skip
        shapes.append(loft(np.array(rings), material))
    else:
        shapes.append(_hip(half, height - 0.03, rise, material))
    return prototype(f"dormer_{kind}_{material}", "trim", shapes)


def _run(outline: list[tuple[float, float]], material: str) -> MeshBatch:
    """Extrude an outline, x and z, over the depth of a dormer and its overhang."""
    area = sum(a[0] * b[1] - b[0] * a[1]
               for a, b in zip(outline, [*outline[1:], outline[0]], strict=True))  # fmt: skip
    return prism(outline if area > 0 else outline[::-1], -FRONT, DEPTH, material)


def _hip(half: float, height: float, rise: float, material: str) -> MeshBatch:
    """Roof with a hip over the front."""
    low, top = height, height + rise
    points = [
        (-half, -FRONT, low), (half, -FRONT, low), (half, DEPTH, low), (-half, DEPTH, low),
        (0.0, half - FRONT, top), (0.0, DEPTH, top),
    ]  # fmt: skip
    faces = [(3, 2, 1, 0), (0, 1, 4, -1), (1, 2, 5, 4), (3, 0, 4, 5), (2, 3, 5, -1)]
    place = np.array(points)
    uv = np.zeros((len(faces), 4, 2))
    for row, face in enumerate(faces):
        corner = place[[i for i in face if i >= 0]]
        flat = corner[:, :2] if row in (0, 1) else corner[:, 1:]
        uv[row, : len(corner)] = flat
    return one_mesh(0, place, faces, materials=(material,), uv=uv)


@lru_cache(maxsize=4)
def roof_window(*, detail: int = 2) -> Prototype:
    """Make a window that lies in the slope, about its middle."""
    del detail
    x, y = ROOF_WINDOW[0] / 2, ROOF_WINDOW[1] / 2
    shapes: Shapes = [
        box((-x, -y, -0.08), (x, -y + 0.09, 0.07), "metal_dark"),
        box((-x, y - 0.09, -0.08), (x, y, 0.07), "metal_dark"),
        box((-x, -y + 0.09, -0.08), (-x + 0.08, y - 0.09, 0.07), "metal_dark"),
        box((x - 0.08, -y + 0.09, -0.08), (x, y - 0.09, 0.07), "metal_dark"),
        box((-x + 0.08, -y + 0.09, -0.08), (x - 0.08, y - 0.09, 0.045),
            "glass"),
        box((-x - 0.08, -y - 0.12, -0.08), (x + 0.08, -y, 0.03), "metal_grey"),
    ]  # fmt: skip
    return prototype("roof_window", "window", shapes)


@lru_cache(maxsize=2)
def roof_panels(*, detail: int = 2) -> Prototype:
    """Make two rows of three solar panels close above the slope, about their middle."""
    del detail
    shapes: Shapes = []
    for row in range(2):
        for column in range(3):
            x, y = -1.65 + 1.1 * column, -1.7 + 1.7 * row
            shapes.append(box((x + 0.02, y + 0.02, 0.06), (x + 1.08, y + 1.68, 0.10), "metal_grey"))
            shapes.append(box((x + 0.05, y + 0.05, 0.10), (x + 1.05, y + 1.65, 0.106), "car_glass"))
    for y in (-1.3, -0.4, 0.4, 1.3):
        shapes.append(box((-1.65, y - 0.02, -0.04), (1.65, y + 0.02, 0.06), "metal_grey"))
    return prototype("roof_panels", "trim", shapes)


@lru_cache(maxsize=16)
def ridge_tiles(material: str, *, detail: int = 2) -> Prototype:
    """Make a metre of the cap of ridges and hips, its middle line at the origin."""
    del detail
    ring = np.array([(-0.15, -0.07), (-0.09, 0.045), (0.0, 0.075), (0.09, 0.045), (0.15, -0.07)])
    ends = [np.column_stack([np.full(len(ring), x), ring[::-1]]) for x in (-0.5, 0.5)]
    return prototype(f"ridge_{material}", "trim", [loft(np.stack(ends), material)])


@lru_cache(maxsize=2)
def gutter(*, detail: int = 2) -> Prototype:
    """Make a metre of gutter before a fascia whose upper edge lies at z = 0."""
    del detail
    line = [(0.0, -0.12), (0.07, -0.13), (0.12, -0.08), (0.13, -0.01), (0.0, -0.01)]
    ring = np.array([(-out, up) for out, up in line[::-1]])
    ends = [np.column_stack([np.full(len(ring), x), ring]) for x in (-0.5, 0.5)]
    return prototype("gutter", "trim", [loft(np.stack(ends), "metal_grey")])


@lru_cache(maxsize=2)
def quoins(*, detail: int = 2) -> Prototype:
    """Make two courses of corner stones, 0.62 m high, long and short in turn.

    The origin is the foot of an outer corner; the wall to its right runs along x, the other along
    y, both away from the corner.
    """
    del detail
    long, short, out = 0.46, 0.28, 0.03
    return prototype(
        "quoins",
        "trim",
        [
            box((-out, -out, 0.0), (long, short, 0.30), "stone"),
            box((-out, -out, 0.31), (short, long, 0.61), "stone"),
        ],
    )
