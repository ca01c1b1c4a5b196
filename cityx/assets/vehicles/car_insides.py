"""Insides of cars that show through the windows of the fine form, and who drives them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.assets.shapes import Color, bevelled, lathe, loft, tube
from cityx.assets.vehicles.car_bodies import Body, waist_of
from cityx.assets.vehicles.car_shell import cabin_line, skinned
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
