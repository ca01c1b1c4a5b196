"""Flanks of fine cars: shut lines, handles, trims, mirrors, glazing bars, filler caps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.assets.shapes import bevelled, tube
from cityx.assets.vehicles.car_bodies import Body
from cityx.assets.vehicles.car_shell import ARCH_GAP, SILL, Skin, cabin_line, mirrored, skinned
from cityx.city.mesh import MeshBatch

FloatArray = NDArray[np.float64]
SEAM = 0.007  # metres, breadth of a joint between panels


def doors(body: Body) -> tuple[float, float, float]:
    """Return metres behind the nose where doors begin, meet and end."""
    length = body.length
    roof = cabin_line(body)
    first = body.axles[0] * length + body.wheel + ARCH_GAP + 0.10
    middle = (0.5 * (roof[1][0] + roof[-2][0]) + 0.01) * length
    last = body.axles[1] * length - 0.35 * (body.wheel + ARCH_GAP)
    return first, middle, last


def flanks(skin: Skin) -> list[MeshBatch]:
    """Make what is on the sides of a car."""
    body = skin.body
    parts = []
    for line in _seams(skin):
        parts += _both(skin, *line)
    trims = body.faces[0].trims
    first, middle, _ = doors(body)
    front, rear = (share * body.length for share in body.axles)
    gap = body.wheel + ARCH_GAP
    sill = skin.beside(np.linspace(front + gap + 0.02, rear - gap - 0.02, 8))
    high = SILL + (0.16 if trims else 0.055)
    for way in (sill, -sill[::-1]):
        parts.append(skin.patch(way, SILL - 0.005, high, "rubber"))
    if trims:
        for start, stop in ((first, middle - 0.02), (middle + 0.02, rear - gap - 0.02)):
            way = skin.beside(np.linspace(start, stop, 6))
            for each in (way, -way[::-1]):
                parts.append(skin.patch(each, 0.50, 0.56, "rubber", out=0.012))
    for side in (-1.0, 1.0):
        parts += _mirror(skin, side)
        parts += _handles(skin, side)
    return parts


def _both(skin: Skin, way: FloatArray, z: FloatArray) -> list[MeshBatch]:
    """Draw a joint on the left flank and on the right."""
    return [skin.ribbon(way, z, SEAM, "rubber"), skin.ribbon(-way, z, SEAM, "rubber")]


def _seams(skin: Skin) -> list[tuple[FloatArray, FloatArray]]:
    """Return the joints of doors and wings of the left flank, as ways and heights."""
    body = skin.body
    length = body.length
    first, middle, last = doors(body)
    rise = np.linspace(0.0, 1.0, 15)
    found = []

    def upright(y: FloatArray, low: float, top: float = 0.02) -> None:
        way = skin.beside(y)
        found.append((way, low + (skin.edge(way) - top - low) * rise))

    upright(np.full(15, first), 0.27)
    upright(np.full(15, middle), 0.27)
    if body.kind == "van" or not body.cargo:
        gap = body.wheel + ARCH_GAP
        axle = body.axles[1] * length
        # The rear door ends above the wheel and runs down along its arch.
        knee = 0.92 * body.wheel + np.sqrt(max(gap**2 - (last - axle) ** 2, 0.0)) + 0.03
        upright(np.full(15, last), knee)
        turn = np.linspace(np.arccos(np.clip((axle - last) / (gap + 0.03), -1, 1)), 0.12, 9)
        y = axle - (gap + 0.03) * np.cos(turn)
        found.append((skin.beside(y), 0.92 * body.wheel + (gap + 0.03) * np.sin(turn)))
        low = np.linspace(first, axle - gap - 0.03, 12)
    else:
        low = np.linspace(first, middle, 12)
    found.append((skin.beside(low), np.full(12, 0.275)))
    # Wings end at the bumpers, between the arches and the lamps.
    for y, axle, z in ((0.30, body.axles[0], 0.60), (length - 0.26, body.axles[1], 0.62)):
        arch = axle * length + (body.wheel + ARCH_GAP) * (-0.80 if axle < 0.5 else 0.80)
        at = np.linspace(arch, y, 9)
        level = 0.92 * body.wheel + 0.60 * (body.wheel + ARCH_GAP) + 0.0 * at
        found.append((skin.beside(at), level + (z - level) * np.linspace(0, 1, 9)))
    if body.kind == "van":
        at = skin.beside(np.linspace(middle + 0.05, 0.95 * length, 10))
        found.append((at, skin.edge(at) - 0.16))
    return found


def _handles(skin: Skin, side: float) -> list[MeshBatch]:
    """Set a grip before a dark hollow on each door, and the flap of the filler."""
    body = skin.body
    _, middle, last = doors(body)
    parts = []
    level = 0.80
    chrome = "metal_grey" if body.faces[0].lamps == "slit" and not skin.boxy else "car_paint"
    for y in (middle - 0.24, min(last - 0.02, middle + 1.0) - 0.24):
        way = skin.beside(np.linspace(y, y + 0.17, 5))
        edge = SILL + level * (skin.edge(way) - SILL)
        hollow = way[1:4] if side > 0 else -way[3:0:-1]
        parts.append(skin.patch(hollow, edge[2] - 0.026, edge[2] + 0.020, "rubber", out=0.002))
        grip = skin.path(side * way[[0, 0, 4, 4]], np.full(4, edge[2]), 0.0, 1)
        grip[1:3, 0] += side * 0.032
        parts.append(tube(grip, 0.010, chrome, sides=6))
    if side < 0:  # the filler, behind on the right
        y = body.axles[1] * body.length + 0.02
        turn = np.linspace(0.0, 2 * np.pi, 25)
        way = -skin.beside(y + 0.085 * np.clip(1.3 * np.cos(turn), -1, 1))
        z = skin.edge(way).mean() - 0.17 + 0.085 * np.clip(1.3 * np.sin(turn), -1, 1)
        parts.append(skin.ribbon(way, z, 0.005, "rubber"))
    return parts


def _mirror(skin: Skin, side: float) -> list[MeshBatch]:
    """Make a mirror: painted cap, dark foot, glass and a repeater."""
    body = skin.body
    half, foot, waist = body.width / 2, body.roof[0][0], body.roof[0][1]
    y = (foot + 0.55 * (body.roof[1][0] - foot) * 0.6) * body.length - body.length / 2 + 0.16
    tall = 0.21 if body.kind == "van" else 0.145
    cap_of = "rubber" if body.faces[0].trims else "car_paint"
    z = waist + 0.03
    inner, outer = half - 0.02, half + (0.15 if body.kei else 0.17)
    stalk = [[side * 0.90 * half, y + 0.03, z - 0.02], [side * (inner + 0.05), y + 0.01, z + 0.02]]
    u = np.linspace(0.0, 1.0, 5)
    turn = np.linspace(-1.0, 1.0, 9)
    # Sections from the foot outward: flat behind, rounded ahead.
    rows = []
    for share, size in zip(u, (0.78, 0.97, 1.0, 0.95, 0.72), strict=True):
        x = inner + share * (outer - inner)
        high = tall * size
        mid = z + tall / 2 + 0.01 * share
        bow = -0.085 * size * (1 - np.abs(turn) ** 2.6)
        rows.append(np.column_stack([np.full(9, x), y + 0.03 * share + bow, mid + turn * high / 2]))
    cap = np.array(rows)
    shell = cap[:, ::-1]
    closing = np.stack([cap[:, 0], cap[:, -1]], axis=1)
    ends = [
        np.stack([cap[0], np.broadcast_to(cap[0, [0, -1]].mean(axis=0), cap[0].shape)]),
        np.stack([np.broadcast_to(cap[-1, [0, -1]].mean(axis=0), cap[-1].shape), cap[-1]]),
    ]
    glass = np.add(closing, (0.0, 0.004, 0.0))
    glass = glass + (glass.mean(axis=(0, 1)) - glass) * 0.14
    grids = [(shell[:, ::-1], cap_of), (closing, "rubber"), (glass, "metal_grey")]
    grids += [(grid, cap_of) for grid in ends]
    parts = [tube(stalk, 0.022, "rubber", sides=6)]
    for grid, material in grids:
        parts.append(skinned(grid if side > 0 else mirrored(grid), material))
    low = sorted((side * (inner + 0.10), side * (outer - 0.005)))
    parts.append(bevelled((low[0], y - 0.055, z + 0.50 * tall), (low[1], y + 0.0, z + 0.56 * tall),
                          "lens_amber", bevel=0.003))  # fmt: skip
    return parts
