"""Cars at real size: body, cabin of glass, wheels and lights; paint is tinted per instance.

The form for near views has a rounded body, tyres, spoked wheels, seats, joints and mirrors.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cityx.assets.kept_prototypes import kept
from cityx.assets.shapes import box, cylinder, fine_shapes, loft, moved, prototype, tube
from cityx.assets.styles.materials import srgb_to_linear
from cityx.assets.vehicles.car_bodies import BODIES, Body, waist_of
from cityx.assets.vehicles.car_faces import rails
from cityx.assets.vehicles.car_flanks import DRIVEN_FROM_RIGHT, doors, flanks, interior
from cityx.assets.vehicles.car_parts import car_parts, meshes_of
from cityx.assets.vehicles.car_shell import ARCH_GAP, SILL, Skin, cabin_line, mirrored, skinned
from cityx.assets.vehicles.number_plates import number_plate
from cityx.assets.vehicles.services import service_parts
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.geometry.arrays import FloatArray
from cityx.system.tables import load

_PAINTS = load("assets/cars", tuple[tuple[int, float], ...], "paints")
PAINTS = np.array([srgb_to_linear(color) for color, _ in _PAINTS]) / 0.8  # the material is 0.80
PAINT_SHARES = np.array([share for _, share in _PAINTS])
ARCH_STEPS = 7
TYRE = 0.205  # metres, width of a tyre
TUCKED = 0.012  # metres, from the side of the body to the outer face of a wheel
FINE = 3  # level of detail from which the fine form is made
PAINT, GLASS, SEAL, PILLAR = 0, 1, 2, 3
CABIN = ("car_paint", "car_pane", "rubber", "car_glass")
# Shares of the height from the waist to the edge of the roof, and from there to its middle.
RISE = np.array([0.0, 0.05, 0.30, 0.60, 0.90, 1.0])
CROWN = np.array([0.06, 0.14, 0.35, 0.65, 1.0])


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
    parts = [loft(np.array(glass)[:, ::-1], "car_glass"), loft(roof_rings[:, ::-1], "car_paint")]
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
    return [*parts, *service_parts(body)]


def fine_car(body: Body, country: str = "") -> list[MeshBatch]:
    """Make what all makes of a body have but its wheels; see `vehicles.car`."""
    skin = Skin(body)
    parts = [*skin.lower_body(), *greenhouse(skin), *_wells(skin)]
    parts += interior(body, -1.0 if country in DRIVEN_FROM_RIGHT else 1.0)
    return [*parts, *flanks(skin), *(rails(body) if body.rails else []), *service_parts(body)]


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


def wheel_parts(radius: float, width: float) -> list[MeshBatch]:
    """Make a wheel about its axle, x: its outer face at x = 0, what holds it at negative x."""
    return [
        cylinder((-width, 0, 0), (0, 0, 0), radius, "rubber", sides=14),
        cylinder((-0.02, 0, 0), (0.006, 0, 0), 0.66 * radius, "metal_grey", sides=10),
        cylinder((0, 0, 0), (0.012, 0, 0), 0.2 * radius, "metal_dark", sides=6),
    ]


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
        with fine_shapes():
            return fine_wheel(body.wheel)
    return wheel_parts(body.wheel, TYRE)
