"""Bicycles, motorcycles and scooters at real size: frames without wheels, and how they are ridden.

Frame: the front looks to -y, x to the left, z up, metres, origin on the ground under the middle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from cityx.assets.shapes import WHITE, Color, box, cylinder, loft, ring, tube
from cityx.city.mesh import MeshBatch

Shapes = list[MeshBatch]
DARK: Color = (0.03, 0.03, 0.032)


@dataclass(frozen=True)
class TwoWheeler:
    """What a bicycle or motorcycle is made of.

    Attributes
    ----------
    size
        Length, width and height with its rider, metres.
    wheel, tyre
        Radius of a wheel and of its tyre, metres.
    axles
        Metres from the middle to each axle, front first.
    parts
        Makes the frame.
    seat
        (y, z) of the pelvis of a rider of usual height, metres.
    development
        Metres gone per turn of the pedals, 0 without pedals.
    """

    size: tuple[float, float, float]
    wheel: float
    tyre: float
    axles: tuple[float, float]
    parts: Callable[[TwoWheeler], Shapes]
    seat: tuple[float, float]
    development: float = 0.0

    def wheel_places(self) -> list[tuple[float, float, float]]:
        """Return the middles of the wheels, metres."""
        return [(0.0, y, self.wheel) for y in self.axles]


def wheel_of(model: TwoWheeler) -> Shapes:
    """Make the parts of a wheel about its axle, x: tyre, rim, hub and spokes."""
    r, tyre = model.wheel, model.tyre
    heavy = tyre > 0.03  # a motorcycle's
    found = [ring(r - tyre, tyre, "rubber"), ring(r - 2.1 * tyre, 0.5 * tyre, "metal_grey")]
    hub = 0.05 if heavy else 0.022
    found.append(cylinder((-0.06, 0, 0), (0.06, 0, 0), hub, "metal_grey", sides=8))
    count, thick = (5, 0.016) if heavy else (14, 0.0022)
    for spoke in range(count):
        angle = 2 * np.pi * spoke / count
        way = np.array([0.0, np.cos(angle), np.sin(angle)])
        side = np.array([0.03 * (-1) ** spoke * (not heavy), 0.0, 0.0])
        ends = [side + 0.8 * hub * way, (r - 2.1 * tyre) * way]
        found.append(tube(ends, thick, "metal_grey", sides=4))
    if heavy:
        found.append(cylinder((0.045, 0, 0), (0.05, 0, 0), 0.42 * r, "metal_grey", sides=16))
    return found


def _bicycle(model: TwoWheeler) -> Shapes:
    r = model.wheel
    front, rear = model.axles
    crank, saddle, head = (0.0, 0.03, 0.28), (0.0, 0.22, 0.93), (0.0, -0.36, 0.90)
    low_head = (0.0, -0.40, 0.70)

    def bar(ends: list[tuple[float, float, float]], radius: float = 0.016) -> MeshBatch:
        return tube(ends, radius, "car_paint", sides=6)

    found = [
        bar([crank, low_head], 0.02), bar([(0.0, 0.19, 0.80), (0.0, -0.37, 0.83)]),
        bar([crank, saddle]), bar([low_head, head], 0.02),
    ]  # fmt: skip
    for x in (-0.055, 0.055):
        found += [
            bar([(0.2 * x, 0.05, 0.28), (x, rear, r)], 0.010),
            bar([(0.2 * x, 0.19, 0.80), (x, rear, r)], 0.009),
            bar([(0.6 * x, -0.41, 0.68), (x, front, r)], 0.012),
        ]
    grips = [(-0.29, -0.30, 1.03), (-0.1, -0.42, 1.02), (0.1, -0.42, 1.02), (0.29, -0.30, 1.03)]
    found += [
        tube([head, (0.0, -0.41, 1.02)], 0.012, "metal_grey", sides=6),
        tube(grips, 0.013, "metal_dark", sides=6),
        box((-0.08, 0.14, 0.93), (0.08, 0.40, 0.98), "plastic", DARK),
        cylinder((-0.05, crank[1], crank[2]), (-0.045, crank[1], crank[2]), 0.09, "metal_grey",
                 sides=16),
        box((-0.04, front - 0.06, 0.80), (0.04, front + 0.02, 0.87), "lens_white"),
        box((-0.03, rear + 0.02, 0.74), (0.03, rear + 0.05, 0.79), "signal_red"),
    ]  # fmt: skip
    found += [_mudguard(model, y) for y in model.axles]
    return found


def _mudguard(model: TwoWheeler, axle: float) -> MeshBatch:
    """Bend a strip over a wheel."""
    angle = np.radians(np.linspace(10.0, 150.0, 8))
    radius = model.wheel + 0.025
    y, z = axle + radius * np.cos(angle), model.wheel + radius * np.sin(angle)
    path = np.column_stack([np.zeros(len(y)), y, z])
    return tube(path, 0.02, "plastic", DARK, sides=5)


def _motorcycle(model: TwoWheeler) -> Shapes:
    front, rear = model.axles
    found = [
        # Tank, seat and tail as one body that narrows to the rear; engine and box below.
        _swept([(-0.42, 0.82, 0.10, 0.08), (-0.28, 0.90, 0.16, 0.15), (-0.02, 0.88, 0.14, 0.14),
                (0.10, 0.80, 0.10, 0.08)], "car_paint"),
        _swept([(0.06, 0.79, 0.12, 0.05), (0.30, 0.78, 0.15, 0.05), (0.62, 0.84, 0.12, 0.05)],
               "plastic", DARK),
        _swept([(0.30, 0.70, 0.10, 0.06), (0.80, 0.80, 0.08, 0.06), (0.95, 0.84, 0.03, 0.03)],
               "car_paint"),
        box((-0.17, -0.34, 0.26), (0.17, 0.16, 0.66), "metal_dark"),
        cylinder((-0.22, -0.1, 0.36), (0.22, -0.1, 0.36), 0.12, "metal_grey", sides=12),
        tube([(-0.16, -0.2, 0.34), (-0.18, 0.2, 0.28), (-0.19, 0.85, 0.38)], 0.045, "metal_grey",
             sides=8),
        tube([(-0.34, -0.34, 1.02), (-0.12, -0.46, 1.04), (0.12, -0.46, 1.04),
              (0.34, -0.34, 1.02)], 0.014, "metal_dark", sides=6),
        cylinder((0, -0.66, 0.86), (0, -0.52, 0.86), 0.09, "lens_white", sides=12),
        box((-0.06, 0.93, 0.80), (0.06, 0.97, 0.87), "signal_red"),
        box((-0.1, 0.99, 0.50), (0.1, 1.0, 0.64), "plate_white"),
    ]  # fmt: skip
    for x in (-0.09, 0.09):
        found += [
            tube([(x, -0.44, 1.0), (x, front, model.wheel)], 0.026, "metal_grey", sides=6),
            tube([(x, 0.12, 0.40), (x, rear, model.wheel)], 0.028, "metal_dark", sides=6),
        ]
    return [*found, *(_mudguard(model, y) for y in model.axles)]


def _scooter(model: TwoWheeler) -> Shapes:
    front, rear = model.axles
    found = [
        _shield(),
        # Footboard and tunnel to the body that carries the seat; the engine swings below it.
        box((-0.19, -0.42, 0.255), (0.19, 0.06, 0.30), "plastic", DARK),
        box((-0.165, -0.40, 0.30), (0.165, 0.04, 0.308), "rubber"),
        _swept([(-0.02, 0.42, 0.15, 0.15), (0.12, 0.50, 0.19, 0.22), (0.42, 0.58, 0.20, 0.19),
                (0.74, 0.66, 0.15, 0.12), (0.90, 0.71, 0.06, 0.05)], "car_paint"),
        _swept([(-0.02, 0.76, 0.10, 0.03), (0.14, 0.775, 0.155, 0.055), (0.40, 0.765, 0.15, 0.05),
                (0.52, 0.80, 0.145, 0.05), (0.80, 0.815, 0.11, 0.04)], "plastic", DARK),
        box((-0.12, 0.24, 0.20), (0.10, 0.66, 0.37), "metal_dark"),
        tube([(-0.14, 0.26, 0.22), (-0.18, 0.40, 0.24)], 0.022, "metal_grey", sides=8),
        tube([(-0.18, 0.38, 0.24), (-0.20, 0.56, 0.27), (-0.20, 0.86, 0.36)],
             [0.035, 0.055, 0.045], "metal_grey", sides=12),
        # Head with lamp, bar with grips, levers and mirrors.
        _swept([(-0.57, 1.00, 0.07, 0.07), (-0.50, 1.02, 0.12, 0.085), (-0.36, 1.04, 0.09, 0.05)],
               "car_paint"),
        cylinder((0, -0.605, 1.005), (0, -0.56, 1.005), 0.068, "lens_white", sides=16),
        tube([(-0.33, -0.34, 1.07), (-0.12, -0.42, 1.06), (0.12, -0.42, 1.06),
              (0.33, -0.34, 1.07)], 0.013, "metal_dark", sides=8),
        tube([(0, -0.42, 1.0), (0, -0.56, 0.62)], 0.032, "metal_dark", sides=8),
        box((-0.05, 0.895, 0.66), (0.05, 0.925, 0.73), "signal_red"),
        box((-0.10, 0.925, 0.44), (0.10, 0.937, 0.58), "plate_white"),
        box((-0.03, 0.86, 0.46), (0.03, 0.926, 0.68), "plastic", DARK),
    ]  # fmt: skip
    for side in (-1.0, 1.0):
        found += [
            tube([(side * 0.22, -0.385, 1.065), (side * 0.335, -0.34, 1.07)], 0.02, "rubber",
                 sides=8),
            tube([(side * 0.18, -0.44, 1.05), (side * 0.33, -0.40, 1.05)], 0.007, "metal_grey",
                 sides=6),
            tube([(side * 0.17, -0.41, 1.07), (side * 0.25, -0.42, 1.20),
                  (side * 0.27, -0.41, 1.25)], 0.007, "metal_dark", sides=6),
            *_mirror(side * 0.27, -0.41, 1.28),
            tube([(side * 0.075, -0.555, 0.60), (side * 0.085, front, model.wheel)], 0.022,
                 "metal_grey", sides=8),
            cylinder((side * 0.13, -0.605, 0.80), (side * 0.13, -0.55, 0.80), 0.026, "lens_amber",
                     sides=12),
            cylinder((side * 0.12, 0.83, 0.74), (side * 0.12, 0.90, 0.74), 0.024, "lens_amber",
                     sides=12),
            tube([(side * 0.13, 0.40, 0.52), (side * 0.10, rear, model.wheel + 0.02)], 0.022,
                 "metal_dark", sides=8),
        ]  # fmt: skip
    found.append(_guard(front, model.wheel, 0.085, "car_paint", (8.0, 128.0)))
    found.append(_guard(rear, model.wheel, 0.085, "plastic", (20.0, 150.0), DARK))
    return found


def _shield() -> MeshBatch:
    """Bend the plate before the legs of who rides a scooter: narrow below, arched to the front."""
    levels = [
        (0.28, -0.46, 0.17),
        (0.40, -0.52, 0.21),
        (0.62, -0.56, 0.225),
        (0.80, -0.545, 0.20),
        (0.92, -0.51, 0.15),
        (1.00, -0.47, 0.09),
    ]  # (z, y of the middle, half width)
    across = np.linspace(-1.0, 1.0, 9)
    rings = []
    for z, y, half in levels:
        back = 0.13 * across**2 * (half / 0.225)
        outer = np.column_stack([half * across, y + back, np.full(9, z)])
        inner = outer + np.array([0.0, 0.035, 0.0])
        rings.append(np.concatenate([outer, inner[::-1]]))
    return loft(np.array(rings), "car_paint")


def _mirror(x: float, y: float, z: float) -> Shapes:
    """Hold a round glass to the rear in a shell."""
    return [
        cylinder((x, y - 0.03, z), (x, y, z), 0.055, "plastic", DARK, sides=16),
        cylinder((x, y, z), (x, y + 0.004, z), 0.048, "metal_grey", sides=16),
    ]


def _guard(
    axle: float, wheel: float, half: float, material: str, span: tuple[float, float],
    tint: Color = WHITE,
) -> MeshBatch:  # fmt: skip
    """Arch a broad mudguard over a wheel, between two angles, degrees from the rear."""
    angle = np.radians(np.linspace(*span, 12))
    section = np.array([(-1.0, -0.035), (-0.6, 0.012), (0.0, 0.028), (0.6, 0.012), (1.0, -0.035),
                        (0.95, -0.045), (0.0, 0.016), (-0.95, -0.045)])  # fmt: skip
    radius = wheel + 0.03 + section[:, 1]
    rings = np.stack([
        np.column_stack([half * section[:, 0], axle - np.cos(np.pi - a) * radius,
                         wheel + np.sin(a) * radius]) for a in angle
    ])  # fmt: skip
    return loft(rings[:, ::-1], material, tint)


def _swept(
    stations: list[tuple[float, float, float, float]], material: str, tint: Color = WHITE
) -> MeshBatch:
    """Skin eight-cornered sections along y: (y, z of the middle, half width, half height)."""
    angle = np.pi / 8 + np.arange(8) * np.pi / 4
    rings = np.array([
        [(w * np.cos(a), y, z + h * np.sin(a)) for a in angle[::-1]] for y, z, w, h in stations
    ])  # fmt: skip
    return loft(rings, material, tint)


TWO_WHEELERS: Mapping[str, TwoWheeler] = MappingProxyType(
    {
        "bicycle": TwoWheeler(
            (1.78, 0.60, 1.75), 0.345, 0.018, (-0.55, 0.53), _bicycle, (0.24, 1.04), 5.2
        ),
        "motorcycle": TwoWheeler(
            (2.10, 0.75, 1.60), 0.31, 0.055, (-0.74, 0.70), _motorcycle, (0.28, 0.90)
        ),
        "scooter": TwoWheeler(
            (1.85, 0.70, 1.65), 0.24, 0.050, (-0.66, 0.60), _scooter, (0.34, 0.88)
        ),
    }
)
