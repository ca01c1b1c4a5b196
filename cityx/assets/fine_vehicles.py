"""Cars drawn for near views: rounded bodies, tyres, spoked wheels, lights, joints and mirrors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.assets.shapes import bevelled, loft, tube
from cityx.city.mesh import MeshBatch

if TYPE_CHECKING:
    from cityx.assets.vehicles import Body

FloatArray = NDArray[np.float64]
ARCH_STEPS = 17


def rounded(rings: FloatArray, times: int = 2) -> FloatArray:
    """Cut the corners of closed rings, (m, k, 3), again and again (Chaikin)."""
    for _ in range(times):
        after = np.roll(rings, -1, axis=1)
        pair = np.stack([0.75 * rings + 0.25 * after, 0.25 * rings + 0.75 * after], axis=2)
        rings = pair.reshape(len(rings), -1, 3)
    return rings


def fine_car(body: Body) -> list[MeshBatch]:
    """Make the parts of a car but its wheels; see `cityx.assets.vehicles.car`."""
    from cityx.assets.vehicles import body_rings, cabin

    rings = rounded(body_rings(body, ARCH_STEPS, np.linspace(0.0, 1.0, 33)))
    parts = [loft(rings[:, ::-1], "car_paint"), *cabin(body)]
    return [*parts, *_front(body), *_rear(body), *_sides(body)]


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


def _front(body: Body) -> list[MeshBatch]:
    half, end, nose = body.width / 2, body.length / 2, body.hood[0][1]
    parts = [
        bevelled((-0.42, -end - 0.012, nose - 0.24), (0.42, -end + 0.06, nose - 0.07),
            "metal_dark"),
        bevelled((-0.26, -end - 0.026, nose - 0.36), (0.26, -end + 0.03, nose - 0.25), "sign"),
        bevelled((-0.78 * half, -end - 0.014, 0.23), (0.78 * half, -end + 0.08, 0.31), "rubber",
            bevel=0.02),
    ]  # fmt: skip
    for k in range(7):
        z = nose - 0.225 + 0.022 * k
        parts.append(
            tube([[-0.40, -end - 0.014, z], [0.40, -end - 0.014, z]], 0.005, "metal_grey", sides=6)
        )
    parts.append(tube([[0.0, -end - 0.022, nose - 0.14], [0.0, -end - 0.01, nose - 0.14]], 0.04,
                      "metal_grey", sides=24))  # fmt: skip
    for side in (-1.0, 1.0):
        x = sorted((side * 0.48 * half, side * 0.84 * half))
        parts.append(bevelled((x[0], -end - 0.004, nose - 0.14), (x[1], -end + 0.16, nose - 0.01),
                              "metal_dark", bevel=0.02))  # fmt: skip
        for share in (0.58, 0.73):
            at = [side * share * half, -end - 0.008, nose - 0.075]
            parts.append(tube([at, [at[0], at[1] + 0.03, at[2]]], [0.045, 0.05], "sign", sides=24))
            parts.append(
                tube([[at[0], at[1] - 0.004, at[2]], at], [0.02, 0.024], "metal_grey", sides=16)
            )
        fog = [side * 0.62 * half, -end - 0.012, 0.38]
        parts.append(tube([fog, [fog[0], fog[1] + 0.05, fog[2]]], 0.04, "metal_grey", sides=20))
        y0, z0, _ = body.roof[0]
        foot = y0 * body.length - end
        wiper = [[side * 0.1, foot - 0.02, z0 + 0.01], [side * 0.1 + 0.5, foot + 0.06, z0 + 0.05]]
        parts.append(tube(wiper, 0.006, "rubber", sides=6))
    return parts


def _rear(body: Body) -> list[MeshBatch]:
    half, end, tail = body.width / 2, body.length / 2, body.hood[-1][1]
    parts = [
        bevelled((-0.26, end - 0.03, tail - 0.17), (0.26, end + 0.02, tail - 0.06), "sign"),
        bevelled((-0.78 * half, end - 0.08, 0.25), (0.78 * half, end + 0.014, 0.37), "rubber",
            bevel=0.02),
        tube([[0.5 * half, end - 0.10, 0.24], [0.5 * half, end + 0.03, 0.24]], 0.035, "metal_grey",
             sides=20),
        tube([[-0.14, end + 0.012, tail - 0.03], [0.14, end + 0.012, tail - 0.03]], 0.014,
            "metal_grey",
             sides=10),
    ]  # fmt: skip
    for side in (-1.0, 1.0):
        x = sorted((side * 0.58 * half, side * 0.88 * half))
        parts.append(bevelled((x[0], end - 0.12, tail - 0.04), (x[1], end + 0.014, tail + 0.13),
            "plastic",
                              (0.55, 0.02, 0.02), bevel=0.02))  # fmt: skip
        for z in (tail, tail + 0.045, tail + 0.09):
            parts.append(bevelled((x[0] + 0.02, end + 0.008, z), (x[1] - 0.02, end + 0.018,
                z + 0.02),
                                  "signal_red", bevel=0.004))  # fmt: skip
    return parts


def _sides(body: Body) -> list[MeshBatch]:
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
        face = half + 0.004
        for share in (0.5 * foot + 0.155, 0.53, 0.735):
            yy = share * length - end
            joint = [[side * (face - 0.012), yy, 0.34], [side * face, yy, 0.55],
                     [side * (face - 0.006), yy, waist - 0.10]]  # fmt: skip
            parts.append(tube(joint, 0.004, "metal_dark", sides=6))
        for share in (0.47, 0.675):
            yy, z = share * length - end, waist - 0.12
            grip = [[side * (face - 0.01), yy, z], [side * (face + 0.022), yy + 0.02, z],
                    [side * (face + 0.022), yy + 0.14, z], [side * (face - 0.01), yy + 0.16,
                        z]]  # fmt: skip
            parts.append(tube(grip, 0.011, "car_paint", sides=10))
        strip = [[side * (face - 0.004), -0.28 * length, 0.47], [side * face, 0.24 * length, 0.47]]
        parts.append(tube(strip, 0.014, "rubber", sides=8))
    return parts
