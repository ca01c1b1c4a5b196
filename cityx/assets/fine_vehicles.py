"""Cars drawn for near views: rounded bodies, tyres, spoked wheels, seats, joints and mirrors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.assets.car_bodies import Body, waist_of
from cityx.assets.car_faces import rails
from cityx.assets.shapes import Color, bevelled, loft, tube
from cityx.city.mesh import MeshBatch, one_mesh

FloatArray = NDArray[np.float64]
ARCH_STEPS = 17
DRIVEN_FROM_RIGHT = ("gb", "jp")  # countries whose steering wheels are at the right
CLOTH: Color = (0.16, 0.16, 0.17)  # of seats


def rounded(rings: FloatArray, times: int = 2) -> FloatArray:
    """Cut the corners of closed rings, (m, k, 3), again and again (Chaikin)."""
    for _ in range(times):
        after = np.roll(rings, -1, axis=1)
        pair = np.stack([0.75 * rings + 0.25 * after, 0.25 * rings + 0.75 * after], axis=2)
        rings = pair.reshape(len(rings), -1, 3)
    return rings


def fine_car(body: Body, country: str = "") -> list[MeshBatch]:
    """Make what all makes of a body have but its wheels; see `cityx.assets.vehicles.car`."""
    from cityx.assets.vehicles import body_rings

    rings = rounded(body_rings(body, ARCH_STEPS, np.linspace(0.0, 1.0, 49), smooth=True))
    parts = [loft(rings[:, ::-1], "car_paint"), *greenhouse(body), *_wells(body)]
    parts += interior(body, -1.0 if country in DRIVEN_FROM_RIGHT else 1.0)
    return [*parts, *_sides(body, body.faces[0].trims), *(rails(body) if body.rails else [])]


def _wells(body: Body) -> list[MeshBatch]:
    """Line the wheel arches: a dark vault over each wheel and a lip around its opening."""
    from cityx.assets.vehicles import ARCH_GAP

    parts = []
    angle = np.linspace(0.08, np.pi - 0.08, 19)
    radius = body.wheel + ARCH_GAP
    for share in body.axles:
        y = share * body.length - body.length / 2
        for side in (-1.0, 1.0):
            inner, outer = side * 0.55 * body.width / 2, side * (body.width / 2 - 0.03)
            arc = np.column_stack(
                [
                    y - (radius - 0.012) * np.cos(angle),
                    0.92 * body.wheel + (radius - 0.012) * np.sin(angle),
                ]
            )
            rows = np.stack(
                [
                    np.column_stack([np.full(len(arc), x), arc])
                    for x in ((inner, outer) if side < 0 else (outer, inner))
                ]
            )
            parts.append(_grid(rows, np.zeros((1, len(arc) - 1), int), ("rubber",)))
            lip = np.column_stack(
                [
                    np.full(len(arc), side * (body.width / 2 - 0.012)),
                    y - radius * np.cos(angle),
                    0.92 * body.wheel + radius * np.sin(angle),
                ]
            )
            parts.append(tube(lip, 0.014, "rubber", sides=8))
    return parts


def _grid(points: FloatArray, material: NDArray[np.int64], materials: tuple[str, ...]) -> MeshBatch:
    """Skin a grid of points, (m, k, 3), with a material for each of its (m - 1, k - 1) quads."""
    m, k, _ = points.shape
    at = np.arange(m * k).reshape(m, k)
    faces = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)
    return one_mesh(0, points.reshape(-1, 3), faces, material=material.ravel(),
                    materials=materials)  # fmt: skip


PAINT, GLASS, SEAL = 0, 1, 2
CABIN = ("car_paint", "car_pane", "rubber")
# Shares of the height from the waist to the edge of the roof, and from there to its middle.
RISE = np.array([0.0, 0.05, 0.30, 0.60, 0.90, 1.0])
CROWN = np.array([0.06, 0.14, 0.35, 0.65, 1.0])


def greenhouse(body: Body) -> list[MeshBatch]:
    """Make windscreen, windows, pillars and roof as one skin, with seals along the waist."""
    from scipy.interpolate import PchipInterpolator

    line = np.array(body.roof)
    length, half = body.length, body.width / 2
    roof_from, roof_to = line[1, 0], line[-2, 0]
    pillar = 0.028  # of the length
    middle = 0.5 * (roof_from + roof_to) + 0.01
    cargo = body.cargo  # no windows beside its load
    cuts = [line[0, 0] + 0.004, line[0, 0] + 0.3 * (roof_from - line[0, 0]), roof_from - 0.01,
            roof_from, middle - pillar / 2, middle + pillar / 2, roof_to - pillar, roof_to,
            roof_to + 0.012, line[-1, 0] - 0.012, line[-1, 0]]  # fmt: skip
    fill = np.linspace(line[0, 0], line[-1, 0], 25)
    near = np.abs(fill[:, None] - np.array(cuts)).min(axis=1) > 0.012
    share = np.unique(np.concatenate([[line[0, 0]], cuts, fill[near]]))
    high = PchipInterpolator(line[:, 0], line[:, 1])(share)
    wide = PchipInterpolator(line[:, 0], line[:, 2])(share) * half
    waist = waist_of(body, share) - 0.02
    high = np.maximum(high, waist + 0.015)
    foot = np.full(len(share), 0.92 * half)
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
    rear = (at > roof_to + 0.012) & (at < line[-1, 0] - 0.012)
    kind[np.ix_(screen | (rear & (not cargo)), np.arange(len(RISE), bands))] = GLASS
    window = (at > line[0, 0] + 0.3 * (roof_from - line[0, 0])) & (at < roof_to - pillar)
    window &= np.abs(at - middle) > pillar / 2
    if cargo:
        window &= at < middle
    kind[np.ix_(window, np.arange(1, len(RISE) - 2))] = GLASS
    kind[:, 0] = SEAL
    kind[at < line[0, 0] + 0.004] = SEAL
    both = np.concatenate([kind, kind[:, ::-1]], axis=1)
    return [_grid(np.concatenate([right, left], axis=1), both, CABIN)]


def interior(body: Body, side: float = 1.0) -> list[MeshBatch]:
    """Make what shows through the windows: a dark floor, seats, the dashboard and the wheel.

    The wheel is at the left, x > 0, where `side` is 1, and at the right where it is -1.
    """
    line = np.array(body.roof)
    length, half = body.length, body.width / 2
    front, back = line[0, 0] + 0.01, line[-1, 0] - 0.02
    share = np.linspace(front, back, 9)
    y, level = share * length - length / 2, waist_of(body, share) + 0.006
    rows = np.stack(
        [np.column_stack([np.full(9, x), y, level]) for x in (0.88 * half, -0.88 * half)]
    )
    parts = [_grid(rows, np.zeros((1, 8), int), ("rubber",))]
    roof = float(line[:, 1].max())
    waist = float(level.mean())

    def seat(x: float, at: float, wide: float) -> list[MeshBatch]:
        # Its head stays under the roof, which falls to the rear.
        over = float(np.interp((at + 0.12) / length + 0.5, line[:, 0], line[:, 1]))
        tall = min(0.58 * (roof - waist), over - waist - 0.28)
        lean = [[x, at, waist - 0.02], [x, at + 0.05, waist + tall]]
        shape = np.array([(-wide, -0.05), (wide, -0.05), (wide, 0.06), (-wide, 0.06)])
        rings = [np.column_stack([base[0] + s * shape[:, 0], base[1] + shape[:, 1],
                                  np.full(4, base[2])])
                 for base, s in zip(np.linspace(lean[0], lean[1], 5), (1, 1, 0.97, 0.9, 0.72),
                                    strict=True)]  # fmt: skip
        head = bevelled(
            (x - 0.12, at + 0.03, waist + tall + 0.03),
            (x + 0.12, at + 0.12, waist + tall + 0.19),
            "cloth",
            CLOTH,
            bevel=0.03,
        )
        return [loft(rounded(np.array(rings), 1), "cloth", CLOTH), head]

    driver = (line[1, 0] + 0.10) * length - length / 2
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


def fine_wheel(radius: float) -> list[MeshBatch]:
    """Make a wheel about its axle, x, outer face at x = 0; see `cityx.assets.vehicles.car_wheel`.

    A tyre with a rounded tread, a rim with a lip, five double spokes, a disc and nuts.
    """
    r = radius
    tread = np.array([(0.0, 0.62), (0.0, 0.66), (0.012, 0.80), (0.030, 0.95), (0.055, 0.99),
                      (0.07, 1.0), (0.15, 1.0), (0.165, 0.99), (0.19, 0.94),
                      (0.205, 0.75)])  # fmt: skip
    lip = np.array([(0.004, 0.66), (-0.004, 0.66), (-0.006, 0.645), (0.004, 0.62), (0.02, 0.60)])

    def turned(line: FloatArray, material: str, sides: int = 32) -> MeshBatch:
        """Turn a profile of depth behind the outer face and share of the radius."""
        path = np.column_stack([-line[:, 0], np.zeros((len(line), 2))])
        return tube(path[::-1], (line[:, 1] * r)[::-1], material, sides=sides)

    parts = [
        turned(tread, "rubber"),
        turned(lip, "metal_grey"),
        turned(np.array([(0.035, 0.60), (0.040, 0.02)]), "metal_dark", 24),
        turned(np.array([(-0.004, 0.10), (0.004, 0.14), (0.03, 0.16)]), "metal_grey", 24),
    ]
    for spoke in range(5):
        a = 2 * np.pi * spoke / 5 + np.pi / 2
        for turn in (-0.13, 0.13):
            hub = np.array([-0.012, 0.13 * r * np.cos(a), 0.13 * r * np.sin(a)])
            rim = np.array([-0.006, 0.63 * r * np.cos(a + turn), 0.63 * r * np.sin(a + turn)])
            parts.append(tube([hub, rim], [0.012, 0.017], "metal_grey", sides=8))
        nut = np.array([0.006, 0.085 * r * np.cos(a), 0.085 * r * np.sin(a)])
        parts.append(tube([nut - [0.01, 0, 0], nut], 0.008, "metal_dark", sides=6))
    return parts


def _sides(body: Body, trims: bool) -> list[MeshBatch]:
    """Mirrors, handles, joints of doors, sills and the filler cap."""
    half, end, length = body.width / 2, body.length / 2, body.length
    parts = []
    foot, waist, _ = body.roof[0]
    for side in (-1.0, 1.0):
        y = foot * length - end + 0.34
        stalk = [[side * 0.90 * half, y, waist + 0.05], [side * (half + 0.06), y, waist + 0.10]]
        parts.append(tube(stalk, 0.02, "rubber", sides=10))
        x = sorted((side * (half + 0.03), side * (half + 0.19)))
        parts.append(bevelled((x[0], y - 0.05, waist + 0.04), (x[1], y + 0.06, waist + 0.18),
            "car_paint",
                              bevel=0.03))  # fmt: skip
        parts.append(bevelled((x[0] + 0.015, y + 0.055, waist + 0.055), (x[1] - 0.015, y + 0.064,
            waist + 0.165),
                              "car_glass", bevel=0.004))  # fmt: skip
        flank = half + 0.004
        for share in (0.5 * foot + 0.155, 0.53, 0.735):
            yy = share * length - end
            joint = [[side * (flank - 0.012), yy, 0.34], [side * flank, yy, 0.55],
                     [side * (flank - 0.006), yy, waist - 0.10]]  # fmt: skip
            parts.append(tube(joint, 0.004, "metal_dark", sides=6))
        for share in (0.47, 0.675):
            yy, z = share * length - end, waist - 0.12
            grip = [[side * (flank - 0.01), yy, z], [side * (flank + 0.022), yy + 0.02, z],
                    [side * (flank + 0.022), yy + 0.14, z], [side * (flank - 0.01), yy + 0.16,
                        z]]  # fmt: skip
            parts.append(tube(grip, 0.011, "car_paint", sides=10))
        if trims:
            strip = [[side * (flank - 0.004), -0.28 * length, 0.47],
                     [side * flank, 0.24 * length, 0.47]]  # fmt: skip
            parts.append(tube(strip, 0.014, "rubber", sides=8))
    return parts
