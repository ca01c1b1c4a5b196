"""Cars drawn for near views: rounded bodies, tyres, spoked wheels, seats, joints and mirrors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.assets.shapes import Color, bevelled, lathe, loft, tube
from cityx.assets.vehicles.car_bodies import Body, waist_of
from cityx.assets.vehicles.car_faces import rails
from cityx.assets.vehicles.car_flanks import doors, flanks
from cityx.assets.vehicles.car_shell import ARCH_GAP, Skin, cabin_line, mirrored, skinned
from cityx.city.mesh import MeshBatch

FloatArray = NDArray[np.float64]
DRIVEN_FROM_RIGHT = ("gb", "jp")  # countries whose steering wheels are at the right
SKINS: tuple[Color, ...] = ((0.62, 0.40, 0.29), (0.50, 0.31, 0.21), (0.24, 0.13, 0.08))
COATS: tuple[Color, ...] = ((0.07, 0.09, 0.14), (0.62, 0.62, 0.60), (0.22, 0.24, 0.26),
                            (0.10, 0.10, 0.11))  # fmt: skip
HAIRS: tuple[Color, ...] = ((0.03, 0.02, 0.015), (0.09, 0.05, 0.03), (0.02, 0.02, 0.02))
FLOOR = 0.42  # metres, of the cabin over a road, under wheels of 0.3


def rounded(rings: FloatArray, times: int = 2) -> FloatArray:
    """Cut the corners of closed rings, (m, k, 3), again and again (Chaikin)."""
    for _ in range(times):
        after = np.roll(rings, -1, axis=1)
        pair = np.stack([0.75 * rings + 0.25 * after, 0.25 * rings + 0.75 * after], axis=2)
        rings = pair.reshape(len(rings), -1, 3)
    return rings


def fine_car(body: Body, country: str = "") -> list[MeshBatch]:
    """Make what all makes of a body have but its wheels; see `vehicles.car`."""
    skin = Skin(body)
    parts = [*skin.lower_body(), *greenhouse(skin), *_wells(skin)]
    parts += interior(body, -1.0 if country in DRIVEN_FROM_RIGHT else 1.0)
    return [*parts, *flanks(skin), *(rails(body) if body.rails else [])]


def _wells(skin: Skin) -> list[MeshBatch]:
    """Line the wheel arches: a dark vault over each wheel and a lip around its opening."""
    parts = []
    body = skin.body
    angle = np.linspace(0.03, np.pi - 0.03, 21)
    radius = body.wheel + ARCH_GAP
    clad = 0.030 if body.faces[0].trims or "slots" in {face.grille for face in body.faces} else 0.0
    for share in body.axles:
        y = share * body.length - radius * np.cos(angle)
        z = 0.92 * body.wheel + radius * np.sin(angle)
        way = skin.beside(y)
        outer = skin.point(way, z, -0.004)
        inner = outer * [0.0, 1.0, 1.0] + [0.55 * body.width / 2, 0.0, 0.0]
        vault = np.stack([outer, inner])
        lip = skin.point(way, z, 0.0)
        parts += [skinned(vault, "rubber"), skinned(mirrored(vault), "rubber")]
        for side in (1.0, -1.0):
            material = "rubber" if clad else "car_paint"
            parts.append(tube(lip * [side, 1.0, 1.0], max(0.008, clad), material, sides=4))
    return parts


PAINT, GLASS, SEAL, PILLAR = 0, 1, 2, 3
CABIN = ("car_paint", "car_pane", "rubber", "car_glass")
# Shares of the height from the waist to the edge of the roof, and from there to its middle.
RISE = np.array([0.0, 0.05, 0.30, 0.60, 0.90, 1.0])
CROWN = np.array([0.06, 0.14, 0.35, 0.65, 1.0])


def greenhouse(skin: Skin) -> list[MeshBatch]:
    """Make windscreen, windows, pillars and roof as one skin, with seals along the waist."""
    from scipy.interpolate import PchipInterpolator

    body = skin.body
    line = cabin_line(body)
    length, half = body.length, body.width / 2
    roof_from, roof_to = line[1, 0], line[-2, 0]
    pillar = 0.028  # of the length
    middle = 0.5 * (roof_from + roof_to) + 0.01
    cargo = body.cargo  # no windows beside its load
    cuts = [line[0, 0] + 0.004, line[0, 0] + 0.3 * (roof_from - line[0, 0]), roof_from - 0.01,
            roof_from, middle - pillar / 2, middle + pillar / 2, roof_to - pillar, roof_to,
            line[-1, 0]]  # fmt: skip
    door = doors(body)[2] / length
    quarter = roof_to + 0.34 * (line[-1, 0] - roof_to)
    rim = min(0.012, 0.2 * (line[-1, 0] - roof_to))  # of the roof about the rear window
    cuts += [door - 0.005, door + 0.010, quarter, roof_to + rim, line[-1, 0] - rim]
    fill = np.linspace(line[0, 0], line[-1, 0], 25)
    near = np.abs(fill[:, None] - np.array(cuts)).min(axis=1) > 0.006
    share = np.unique(np.concatenate([[line[0, 0]], cuts, fill[near]]))
    high = PchipInterpolator(line[:, 0], line[:, 1])(share)
    wide = PchipInterpolator(line[:, 0], line[:, 2])(share) * half
    waist = waist_of(body, share) - 0.02
    high = np.maximum(high, waist + 0.015)
    foot = np.minimum((0.945 if skin.boxy else 0.92) * half, skin.breadth(share * length) - 0.004)
    edge = waist + (high - waist) * 0.93
    y = share * length - length / 2
    side_x = (
        foot[:, None]
        + (wide - foot)[:, None] * RISE
        + 0.025 * np.sin(np.pi * RISE) * ((edge - waist)[:, None] > 0.2)
    )
    side_z = waist[:, None] + (edge - waist)[:, None] * RISE
    top_x = wide[:, None] * (1 - CROWN)
    top_z = edge[:, None] + (high - edge)[:, None] * (1 - (1 - CROWN) ** 2.2)
    bow = 0.10 * (1 - (top_x / np.maximum(wide, 1e-6)[:, None]) ** 2)  # panes bulge outward
    ends = np.clip((roof_from - share) / (roof_from - line[0, 0]), 0, 1) - np.clip(
        (share - roof_to) / (line[-1, 0] - roof_to), 0, 1
    )
    top_y = y[:, None] - bow * ends[:, None] * 0.6
    right = np.stack([np.concatenate([side_x, top_x], axis=1),
                      np.concatenate([np.broadcast_to(y[:, None], side_x.shape), top_y], axis=1),
                      np.concatenate([side_z, top_z], axis=1)], axis=-1)  # fmt: skip
    left = right[:, -2::-1] * [-1.0, 1.0, 1.0]
    at = (share[1:] + share[:-1]) / 2
    bands = len(RISE) + len(CROWN) - 1  # of one side
    kind = np.full((len(at), bands), PAINT)
    screen = (at < roof_from - 0.01) & (at > line[0, 0] + 0.004)
    rear = (at > roof_to + rim) & (at < line[-1, 0] - rim)
    kind[np.ix_(screen | (rear & (not cargo)), np.arange(len(RISE), bands))] = GLASS
    sides = (at > line[0, 0] + 0.3 * (roof_from - line[0, 0])) & (at < quarter)
    if cargo:
        sides &= at < middle + pillar / 2
    bars = (np.abs(at - middle) < pillar / 2) | ((at > door - 0.005) & (at < door + 0.010))
    rows = np.arange(1, len(RISE) - 2)
    kind[np.ix_(sides, rows)] = GLASS
    kind[np.ix_(sides & bars, rows)] = PILLAR
    kind[:, 0] = SEAL
    kind[at < line[0, 0] + 0.004] = SEAL
    both = np.concatenate([kind, kind[:, ::-1]], axis=1)
    parts = [skinned(np.concatenate([right, left], axis=1), CABIN, kinds=both)]
    if body.faces[0].lamps == "slit":  # bright strips along the feet of the windows
        along = right[np.flatnonzero(sides)[0] : np.flatnonzero(sides)[-1] + 2, 1]
        for side in (-1.0, 1.0):
            strip = np.add(along, (0.003, 0.0, 0.0)) * [side, 1.0, 1.0]
            parts.append(tube(strip, 0.007, "metal_grey", sides=4))
    return parts


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


def fine_wheel(radius: float) -> list[MeshBatch]:
    """Make a wheel about its axle, x, outer face at x = 0; see `vehicles.car_wheel`.

    A tyre with a rounded tread, a rim with a lip, five double spokes, the disc of the brake, nuts.
    """
    r = radius
    tread = np.array([(0.03, 0.66), (0.002, 0.70), (-0.004, 0.82), (0.030, 0.95), (0.055, 0.99),
                      (0.07, 1.0), (0.15, 1.0), (0.165, 0.99), (0.19, 0.94),
                      (0.205, 0.75)])  # fmt: skip
    lip = np.array(
        [(0.004, 0.72), (-0.005, 0.715), (-0.006, 0.695), (0.004, 0.675), (0.025, 0.665)]
    )

    def turned(line: FloatArray, material: str, sides: int = 16,
               caps: tuple[bool, bool] = (True, True)) -> MeshBatch:  # fmt: skip
        """Turn a profile of depth behind the outer face and share of the radius."""
        turn = np.arange(2 * sides) * (np.pi / sides)
        radii = line[:, 1:] * r
        rings = np.stack([np.broadcast_to(-line[:, :1], (len(line), len(turn))),
                          radii * np.cos(turn), radii * np.sin(turn)], axis=-1)  # fmt: skip
        return loft(rings[::-1], material, caps=caps)

    parts = [
        turned(tread, "rubber"),
        turned(lip, "metal_grey", caps=(False, False)),
        turned(np.array([(0.020, 0.665), (0.150, 0.62)]), "metal_dark", caps=(False, False)),
        turned(np.array([(0.075, 0.46), (0.090, 0.46)]), "metal_grey", 20),  # the brake
        turned(np.array([(0.120, 0.66), (0.125, 0.02)]), "rubber", 20),
        turned(np.array([(-0.002, 0.07), (0.004, 0.15), (0.07, 0.17)]), "metal_grey", 16),
        turned(np.array([(-0.005, 0.015), (-0.004, 0.065)]), "metal_dark", 12),
    ]
    for spoke in range(5):
        middle = 2 * np.pi * spoke / 5 + np.pi / 2
        for turn in (-0.20, 0.20):
            # Blades from the hub to the rim: share of the radius, angle, half breadth, depth.
            blade = [(0.11, 0.45 * turn, 0.062, 0.002), (0.40, 0.9 * turn, 0.044, -0.006),
                     (0.68, 1.25 * turn, 0.058, -0.001)]  # fmt: skip
            rings = []
            for share, angle, wide, face in blade:
                a = middle + angle
                out = np.array([0.0, np.cos(a), np.sin(a)])
                side = np.array([0.0, -np.sin(a), np.cos(a)])
                rings.append([share * r * out + s * wide * r * side - [x, 0.0, 0.0]
                              for s, x in ((-1.0, face + 0.022), (-0.72, face), (0.72, face),
                                           (1.0, face + 0.022))])  # fmt: skip
            parts.append(loft(np.array(rings)[:, ::-1], "metal_grey"))
        nut = np.array([0.004, 0.095 * r * np.cos(middle), 0.095 * r * np.sin(middle)])
        parts.append(tube([nut - [0.01, 0, 0], nut], 0.009, "metal_dark", sides=5))
    return parts
