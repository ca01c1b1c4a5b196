"""Flanks of fine cars and what shows through their windows: shut lines, mirrors, seats, drivers."""

from __future__ import annotations

import numpy as np

from cityx.assets.shapes import Color, bevelled, lathe, loft, tube
from cityx.assets.vehicles.car_bodies import Body, waist_of
from cityx.assets.vehicles.car_shell import ARCH_GAP, SILL, Skin, cabin_line, mirrored, skinned
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray

SEAM = 0.007  # metres, breadth of a joint between panels
DRIVEN_FROM_RIGHT = ("gb", "jp")  # countries whose steering wheels are at the right
SKINS: tuple[Color, ...] = ((0.62, 0.40, 0.29), (0.50, 0.31, 0.21), (0.24, 0.13, 0.08))
COATS: tuple[Color, ...] = ((0.07, 0.09, 0.14), (0.62, 0.62, 0.60), (0.22, 0.24, 0.26),
                            (0.10, 0.10, 0.11))  # fmt: skip
HAIRS: tuple[Color, ...] = ((0.03, 0.02, 0.015), (0.09, 0.05, 0.03), (0.02, 0.02, 0.02))
FLOOR = 0.42  # metres, of the cabin over a road, under wheels of 0.3


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


def rounded(rings: FloatArray, times: int = 2) -> FloatArray:
    """Cut the corners of closed rings, (m, k, 3), again and again (Chaikin)."""
    for _ in range(times):
        after = np.roll(rings, -1, axis=1)
        pair = np.stack([0.75 * rings + 0.25 * after, 0.25 * rings + 0.75 * after], axis=2)
        rings = pair.reshape(len(rings), -1, 3)
    return rings


def interior(body: Body, side: float = 1.0) -> list[MeshBatch]:
    """Make what shows through the windows: a dark floor, seats, the dashboard and the wheel.

    The wheel is at the left, x > 0, where `side` is 1, and at the right where it is -1.
    """
    line = cabin_line(body)
    length, half = body.length, body.width / 2
    front, back = line[0, 0] + 0.01, line[-1, 0] - 0.02
    share = np.linspace(front, back, 9)
    y, level = share * length - length / 2, waist_of(body, share) - 0.004
    floor = FLOOR + body.wheel - 0.30
    section = [(0.90, level), (0.84, level), (0.80, np.full(9, floor))]
    rows = np.stack([np.column_stack([np.full(9, s * x * half), y, z])
                     for s, x, z in ((1.0, *section[0]), (1.0, *section[1]), (1.0, *section[2]),
                                     (-1.0, *section[2]), (-1.0, *section[1]),
                                     (-1.0, *section[0]))])  # fmt: skip
    parts = [skinned(rows, "car_trim")]
    roof = float(line[:, 1].max())
    waist = float(level.mean())

    def seat(x: float, at: float, wide: float) -> list[MeshBatch]:
        # Its head stays under the roof, which falls to the rear.
        over = float(np.interp((at + 0.12) / length + 0.5, line[:, 0], line[:, 1]))
        tall = min(0.58 * (roof - waist), over - waist - 0.28)
        lean = [[x, at, floor + 0.10], [x, at + 0.09, waist + tall]]
        shape = np.array([(-wide, -0.05), (wide, -0.05), (wide, 0.06), (-wide, 0.06)])
        rings = [np.column_stack([base[0] + s * shape[:, 0], base[1] + shape[:, 1],
                                  np.full(4, base[2])])
                 for base, s in zip(np.linspace(lean[0], lean[1], 5), (1, 1, 0.97, 0.9, 0.72),
                                    strict=True)]  # fmt: skip
        head = bevelled(
            (x - 0.12, at + 0.03, waist + tall + 0.03),
            (x + 0.12, at + 0.12, waist + tall + 0.19),
            "car_trim",
            bevel=0.03,
        )
        low = bevelled((x - wide, at - 0.46, floor + 0.02), (x + wide, at, floor + 0.22),
                       "car_trim", bevel=0.04)  # fmt: skip
        return [loft(rounded(np.array(rings), 1), "car_trim"), head, low]

    driver = _front_seat(body)
    for x in (-0.42 * half, 0.42 * half):
        parts += seat(x, driver, 0.24)
    bench = min(driver + 0.88, (line[-2, 0] - 0.02) * length - length / 2)
    if not body.cargo:
        for x in (-0.42 * half, 0.42 * half):
            parts += seat(x, bench, 0.30)
    dash = (line[0, 0] + 0.6 * (line[1, 0] - line[0, 0])) * length - length / 2
    low, high = (-0.8 * half, dash - 0.25, waist - 0.02), (0.8 * half, dash, waist + 0.07)
    parts.append(bevelled(low, high, "rubber", bevel=0.02))
    turn = np.linspace(0.0, 2 * np.pi, 25)
    across, ahead = 0.18 * np.cos(turn), 0.06 * np.sin(turn)
    rim = np.column_stack([side * 0.42 * half + across, dash + 0.12 + ahead,
                           waist + 0.05 + 0.16 * np.sin(turn)])  # fmt: skip
    parts.append(tube(rim, 0.013, "rubber", sides=8))
    return parts


def _front_seat(body: Body) -> float:
    """Return y of the back of the driver's seat, metres."""
    return (body.roof[1][0] + 0.10) * body.length - body.length / 2


def driver(body: Body, side: float, number: int) -> list[MeshBatch]:
    """Make who drives a car, down to the lap; `side` is as of `interior`, `number` says who."""
    line = cabin_line(body)
    x, y = side * 0.42 * body.width / 2, _front_seat(body) - 0.06
    seat = FLOOR + body.wheel - 0.30 + 0.22
    over = float(np.interp((y + 0.05) / body.length + 0.5, line[:, 0], line[:, 1])) - 0.10
    crown = min(seat + 0.90, over)
    neck = crown - 0.24
    skin, coat = SKINS[number % len(SKINS)], COATS[number % len(COATS)]
    turn = np.linspace(0.0, 2 * np.pi, 13)[:-1]
    rings = [
        np.column_stack([x + wide * np.cos(turn), y - 0.11 + back + deep * np.sin(turn),
                         np.full(12, z)])
        for wide, deep, back, z in (
            (0.18, 0.13, 0.0, seat), (0.17, 0.12, 0.02, seat + 0.25),
            (0.21, 0.12, 0.05, neck - 0.12),
            (0.17, 0.09, 0.07, neck - 0.03), (0.06, 0.06, 0.07, neck))
    ]  # fmt: skip
    head = [(0.045, neck - 0.02), (0.055, neck + 0.03), (0.078, neck + 0.09), (0.082, neck + 0.15),
            (0.060, neck + 0.21), (0.0, neck + 0.235)]  # fmt: skip
    hair = [(0.089, neck + 0.13), (0.090, neck + 0.17), (0.068, neck + 0.225), (0.0, crown + 0.008)]
    parts = [
        loft(np.array(rings), "cloth", coat),
        lathe(head, "skin", skin, sides=6, center=(x, y - 0.05)),
        lathe(hair, "hair", HAIRS[number % len(HAIRS)], sides=6, center=(x, y - 0.035)),
    ]
    waist = float(waist_of(body, np.array(body.roof[0][0])))
    dash = line[0, 0] + 0.6 * (line[1, 0] - line[0, 0])
    grip = dash * body.length - body.length / 2 + 0.12
    for hand in (-1.0, 1.0):
        arm = [[x + 0.19 * hand, y - 0.06, neck - 0.10], [x + 0.24 * hand, y - 0.20, neck - 0.33],
               [x + 0.16 * hand, grip + 0.02, waist + 0.08]]  # fmt: skip
        parts.append(tube(arm, [0.055, 0.045, 0.032], "cloth", coat, sides=5))
        fist = [arm[2], [x + 0.15 * hand, grip - 0.05, waist + 0.12]]
        parts.append(tube(fist, [0.035, 0.028], "skin", skin, sides=5))
    return parts
