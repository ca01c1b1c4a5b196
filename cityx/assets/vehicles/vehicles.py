"""Cars at real size: body, cabin of glass, wheels and lights; paint is tinted per instance."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cityx.assets.kept_prototypes import kept
from cityx.assets.shapes import box, cylinder, fine_shapes, loft, moved, prototype
from cityx.assets.styles.materials import srgb_to_linear
from cityx.assets.vehicles.car_bodies import BODIES, Body
from cityx.assets.vehicles.car_shell import ARCH_GAP, SILL
from cityx.assets.vehicles.number_plates import number_plate
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype

# (linear RGB, share): what is registered, after the paint makers' yearly surveys.
_PAINTS = (
    (0xE8E8E6, 0.27), (0x141517, 0.21), (0x6D7073, 0.17), (0xA9ACAE, 0.13), (0x24406B, 0.08),
    (0x8E1B1B, 0.05), (0x3B4A56, 0.03), (0x5A4A3C, 0.02), (0x2F4A37, 0.02), (0xC9BFA8, 0.01),
    (0xC4741A, 0.005), (0xD2B32A, 0.005),
)  # fmt: skip
PAINTS = np.array([srgb_to_linear(color) for color, _ in _PAINTS]) / 0.8  # the material is 0.80
PAINT_SHARES = np.array([share for _, share in _PAINTS])


ARCH_STEPS = 7
TYRE = 0.205  # metres, width of a tyre
TUCKED = 0.012  # metres, from the side of the body to the outer face of a wheel
FINE = 3  # level of detail from which the fine form is made


def _lower_body(body: Body) -> MeshBatch:
    """Loft cross-sections from front to rear."""
    return loft(body_rings(body, ARCH_STEPS)[:, ::-1], "car_paint")


def body_rings(body: Body, arch_steps: int) -> NDArray[np.float64]:
    """Cross-sections (m, 12, 3) of the lower body; the lower edge rises over the wheels.

    `arch_steps` are the stations over each wheel.
    """
    half, length = body.width / 2, body.length
    axle = np.array(body.axles) * length
    gap = body.wheel + ARCH_GAP  # half of the opening's width
    around = np.concatenate([a + gap * -np.cos(np.linspace(0, np.pi, arch_steps)) for a in axle])
    hood = np.array(body.hood)
    stations = np.unique(np.round(np.concatenate([around, hood[:, 0] * length]), 4))
    rings = []
    for y in stations:
        top = float(np.interp(y / length, hood[:, 0], hood[:, 1]))
        lift = max(0.0, *(np.sqrt(max(gap**2 - (y - a) ** 2, 0.0)) for a in axle))
        sill = max(
            SILL + 0.12 * (y in (stations[0], stations[-1])),
            lift + body.wheel * 0.92 * (lift > 0.05),
        )
        taper = 1.0 - 0.16 * max(0.0, 1 - y / (0.10 * length)) ** 2
        taper -= 0.12 * max(0.0, 1 - (length - y) / (0.08 * length)) ** 2
        w = half * taper
        sill = min(sill, top - 0.12)
        belt = sill + 0.62 * (top - sill)
        right = [(0.93 * w, sill), (w, min(sill + 0.06, belt)), (w, belt), (0.955 * w, top - 0.03),
                 (0.86 * w, top)]  # fmt: skip
        left = [(-x, z) for x, z in right[::-1]]
        inner = [(-0.62 * half * taper, SILL + 0.02), (0.62 * half * taper, SILL + 0.02)]
        ring = np.array([*right, *left, *inner])
        rings.append(np.column_stack([ring[:, 0], np.full(len(ring), y - length / 2), ring[:, 1]]))
    # Along +y, counter-clockwise seen from the rear is clockwise in (x, z).
    return np.stack(rings)


def cabin(body: Body) -> list[MeshBatch]:
    """Glasshouse with a painted roof: windscreen, side windows, rear window, pillars."""
    length, half = body.length, body.width / 2
    line = np.array(body.roof)
    y = line[:, 0] * length - length / 2
    hood = np.array(body.hood)
    belt = np.interp(line[:, 0], hood[:, 0], hood[:, 1]) - 0.03
    glass, roof = [], []
    foot = 0.90 * half
    for i in range(len(line)):
        z, w = line[i, 1], line[i, 2] * half
        top = max(z - 0.035, belt[i])
        glass.append([(foot, y[i], belt[i]), (w + 0.02, y[i], top), (-w - 0.02, y[i], top),
                      (-foot, y[i], belt[i])])  # fmt: skip
    for i in range(1, len(line) - 1):
        z, w = line[i, 1], line[i, 2] * half
        roof.append([(w + 0.03, y[i], z - 0.06), (w - 0.05, y[i], z), (-w + 0.05, y[i], z),
                     (-w - 0.03, y[i], z - 0.06)])  # fmt: skip
    roof_rings = np.array(roof)
    roof_rings[0, :, 1] -= 0.04
    roof_rings[-1, :, 1] += 0.05
    parts = [
        loft(np.array(glass)[:, ::-1], "car_glass"),
        loft(roof_rings[:, ::-1], "car_paint"),
    ]
    # Pillars: thin painted bars over the glass from roof corner to belt.
    ends = [(1, 0, 0.045), (len(line) - 2, len(line) - 1, 0.06)]
    if len(line) > 4:
        ends.append((2, 2, 0.045))
    for upper, lower, width in ends:
        for side in (-1.0, 1.0):
            low = np.array([side * foot, y[lower], belt[lower]])
            high = np.array(
                [side * (line[upper, 2] * half + 0.02), y[upper], line[upper, 1] - 0.05]
            )
            parts.append(_bar(low, high, width, side))
    if body.cargo:
        for side in (-1.0, 1.0):
            panel = []
            for yy in (-length / 2 + 0.42 * length, y[-2] - 0.01):
                z_low, z_high = 1.15, line[-2, 1] - 0.05
                w_low, w_high = foot + 0.012, line[-2, 2] * half + 0.035
                ring = [(side * w_low, yy, z_low), (side * w_high, yy, z_high),
                        (side * (w_high - 0.05), yy, z_high),
                        (side * (w_low - 0.05), yy, z_low)]  # fmt: skip
                panel.append(ring if side < 0 else ring[::-1])
            parts.append(loft(np.array(panel), "car_paint"))
    return parts


def _bar(
    low: NDArray[np.float64], high: NDArray[np.float64], width: float, side: float
) -> MeshBatch:
    dy, dx = np.array([0.0, width, 0.0]), np.array([side * 0.02, 0.0, 0.0])

    def ring(p: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([p - dy - dx, p - dy + dx, p + dy + dx, p + dy - dx])

    rings = np.stack([ring(low), ring(high)])
    return loft(rings if side > 0 else rings[:, ::-1], "car_paint")


def wheel_parts(radius: float, width: float) -> list[MeshBatch]:
    """Make a wheel about its axle, x: its outer face at x = 0, what holds it at negative x."""
    return [
        cylinder((-width, 0, 0), (0, 0, 0), radius, "rubber", sides=14),
        cylinder((-0.02, 0, 0), (0.006, 0, 0), 0.66 * radius, "metal_grey", sides=10),
        cylinder((0, 0, 0), (0.012, 0, 0), 0.2 * radius, "metal_dark", sides=6),
    ]


def wheel_places(body: Body) -> list[tuple[float, float, float]]:
    """Return the middles of the outer faces of the wheels, metres; x > 0 is the left side."""
    return [
        (side * (body.width / 2 - TUCKED), (share - 0.5) * body.length, body.wheel)
        for share in body.axles
        for side in (-1.0, 1.0)
    ]


def _wheels(body: Body, parts: list[MeshBatch]) -> list[MeshBatch]:
    """Set a wheel under every corner; those on the right are turned about."""
    return [
        moved(part, place, yaw=0.0 if place[0] > 0 else np.pi)
        for place in wheel_places(body)
        for part in parts
    ]


def _fittings(body: Body, country: str) -> list[MeshBatch]:
    """Lights, grille, plates, bumper trims, mirrors, and what stands on the roof."""
    half, end = body.width / 2, body.length / 2
    nose = body.hood[0][1]
    tail = body.hood[-1][1]
    parts = [
        box((-0.42, -end - 0.012, nose - 0.22), (0.42, -end + 0.05, nose - 0.06), "metal_dark"),
        *number_plate(country, 0, end, nose - 0.29, kei=body.kei),
        *number_plate(country, 0, end, tail - 0.12, rear=True, kei=body.kei),
        box((-0.74 * half, -end - 0.01, 0.26), (0.74 * half, -end + 0.06, 0.33), "rubber"),
        box((-0.76 * half, end - 0.06, 0.28), (0.76 * half, end + 0.01, 0.38), "rubber"),
    ]
    for side in (-1.0, 1.0):
        x = sorted((side * 0.50 * half, side * 0.82 * half))
        parts.append(
            box((x[0], -end - 0.008, nose - 0.12), (x[1], -end + 0.12, nose - 0.01), "lens_white")
        )
        x = sorted((side * 0.58 * half, side * 0.86 * half))
        parts.append(box((x[0], end - 0.10, tail - 0.02), (x[1], end + 0.012, tail + 0.12),
                         "lens_red"))  # fmt: skip
        foot = body.roof[0]
        x = sorted((side * (0.90 * half), side * (half + 0.10)))
        y = foot[0] * body.length - end + 0.32
        parts.append(box((x[0], y, foot[1] + 0.04), (x[1], y + 0.08, foot[1] + 0.17), "car_paint"))
        y = 0.05 * body.length
        x = sorted((side * (half - 0.01), side * (half + 0.012)))
        for handle in (y - 0.35, y + 0.62):
            z = foot[1] - 0.10
            parts.append(box((x[0], handle, z), (x[1], handle + 0.16, z + 0.025), "metal_dark"))
    if body.sign:
        share, z, _ = body.roof[2]
        y = (share - 0.06) * body.length - end
        lamp = "lens_amber" if body.sign.isascii() else "lens_white"
        parts.append(box((-0.22, y - 0.06, z - 0.01), (0.22, y + 0.06, z + 0.11), lamp))
    return parts


@lru_cache(maxsize=256)
@kept("car", least=FINE)
def car(
    body: str, *, detail: int = 2, wheels: bool = True, country: str = "", number: int | None = 0
) -> Prototype:
    """Make a car. The prototype's kind is "vehicle".

    Parameters
    ----------
    body
        A key of `BODIES`.
    detail
        From 3 on lines are rounded, wheels have spokes, joints are drawn and plates are written;
        below, all registrations are of one form.
    wheels
        Without them it is the body alone, for cars whose wheels turn.
    country
        A key of `cityx.assets.vehicles.number_plates.PLATES`.
    number
        Of the registration: which make it is, and what its plates say. None leaves both to
        `cityx.assets.vehicles.car_parts`.
    """
    shape = BODIES[body]
    registered = detail >= FINE and number is not None and (country or number)
    variant = f"{country}{number}" if registered else country
    name = "_".join(filter(None, ("car", body, variant, "" if wheels else "body",
                                  "bare" if detail >= FINE and number is None else "",
                                  "fine" if detail >= FINE else "")))  # fmt: skip
    if detail >= FINE:
        from cityx.assets.vehicles.car_parts import car_parts, meshes_of
        from cityx.assets.vehicles.fine_vehicles import fine_car

        with fine_shapes():
            parts = fine_car(shape, country)
        if number is not None:
            parts += meshes_of(car_parts(body, country, number))
    else:
        parts = [_lower_body(shape), *cabin(shape), *_fittings(shape, country)]
    if wheels:
        parts = [*parts, *_wheels(shape, car_wheel(shape, detail))]
    return prototype(name, "vehicle", parts)


def car_wheel(body: Body, detail: int) -> list[MeshBatch]:
    """Make the parts of one wheel of a car, as of `wheel_parts`."""
    if detail >= FINE:
        from cityx.assets.vehicles.fine_vehicles import fine_wheel

        with fine_shapes():
            return fine_wheel(body.wheel)
    return wheel_parts(body.wheel, TYRE)
