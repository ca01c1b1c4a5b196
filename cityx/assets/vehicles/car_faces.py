"""Fronts and rears of cars drawn for near views: lamps, grilles and bumpers by make."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from cityx.assets.shapes import bevelled, moved, tube
from cityx.assets.shops.lettering import word
from cityx.assets.vehicles.car_bodies import Body, Face
from cityx.assets.vehicles.car_shell import ARCH_GAP, SILL, Skin, cabin_line
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray

# Headlights: metres of height, and where they begin, as a share of half the width.
_LAMPS = {"slit": (0.105, 0.50), "block": (0.165, 0.55), "round": (0.20, 0.55)}
_REARS = {"band": (0.115, 0.50), "block": (0.20, 0.58), "tall": (0.24, 0.74)}
BENEATH = 0.050  # metres from the edge of the bonnet down to the lamps


def _arch(skin: Skin, axle: int) -> float:
    """Metres behind the nose of the edge of a wheel arch that looks to the nearer end."""
    body = skin.body
    gap = body.wheel + ARCH_GAP + 0.02
    return body.axles[axle] * body.length + (gap if axle else -gap)


def front(body: Body, face: Face) -> list[MeshBatch]:
    """Make what a car shows ahead, at -y, but its plate."""
    skin = Skin(body)
    parts = [*_grille(skin, face), *_front_bumper(skin, face)]
    for side in (-1.0, 1.0):
        parts += _headlight(skin, face, side)
        parts += _wiper(body, side)
    if body.sign:
        parts += roof_sign(body)
    parts += _badge(skin, 0.0, _badge_height(skin, face), 0.014)
    # The joint of the bonnet runs from lamp to lamp a hand behind its edge.
    way = skin.ahead(np.linspace(-0.94, 0.94, 41))
    parts.append(skin.ribbon(way, skin.edge(way) - 0.030, 0.007, "rubber"))
    return parts


def _badge_height(skin: Skin, face: Face) -> float:
    nose = float(skin.edge(0.0))
    return nose - (0.085 if face.grille in ("closed", "wide") else 0.07)


def _badge(skin: Skin, way: float, z: float, out: float) -> list[MeshBatch]:
    """Set a bright ring about a dark field."""
    points, normal = skin.frame(way, z, out)
    turn = np.linspace(0.0, 2 * np.pi, 25)
    ring = points + np.column_stack([0.045 * np.cos(turn), 0.0 * turn, 0.045 * np.sin(turn)])
    back = points - 0.02 * normal
    return [tube(ring, 0.007, "metal_grey", sides=6),
            tube([points + 0.002 * normal, back], 0.040, "metal_dark", sides=12)]  # fmt: skip


def _wiper(body: Body, side: float) -> list[MeshBatch]:
    """Lay an arm and a blade along the foot of the windscreen."""
    (y0, z0, _), (y1, z1, _) = body.roof[0], body.roof[1]
    lean = (z1 - z0) / ((y1 - y0) * body.length)
    foot = y0 * body.length - body.length / 2

    def at(x: float, up: float) -> list[float]:
        # Panes bow ahead of the line from foot to roof.
        return [x, foot - 0.055 + 0.05 * abs(x) + up / lean, z0 + 0.02 + up]

    x = side * 0.06 * body.width - 0.10
    blade = [at(x - 0.02, 0.02), at(x + 0.27 * body.width, 0.05)]
    arm = [at(x + 0.05, -0.01), at(x + 0.15 * body.width, 0.04)]
    return [tube(blade, 0.008, "rubber", sides=6), tube(arm, 0.006, "rubber", sides=6)]


def _headlight(skin: Skin, face: Face, side: float) -> list[MeshBatch]:
    """Make a lamp unit: a dark housing, reflectors, a line of day light, the indicator."""
    height, begin = _LAMPS[face.lamps]
    first = float(skin.ahead(begin))
    last = float(skin.beside(0.40 if face.lamps == "slit" else 0.34))
    u = np.linspace(0.0, 1.0, 17)
    way = first + (last - first) * u
    high = skin.edge(way) - BENEATH
    if face.lamps == "slit":
        low = high - height * np.interp(u, [0.0, 0.12, 0.55, 1.0], [0.55, 0.95, 1.0, 0.18])
    elif face.lamps == "block":
        low = high - height * np.interp(
            u, [0.0, 0.10, 0.60, 0.85, 1.0], [0.80, 1.0, 1.0, 0.85, 0.40]
        )
    else:
        low = high - height * np.interp(u, [0.0, 0.15, 0.30, 0.60, 0.85, 1.0],
                                        [0.62, 0.88, 1.0, 1.0, 0.80, 0.45])  # fmt: skip

    def laid(a: float, b: float, bottom: float, top: float, material: str, out: float,
             count: int = 9) -> MeshBatch:  # fmt: skip
        """Lay a field between shares of the breadth and of the height of the lamp."""
        share = np.linspace(a, b, count)
        w = np.interp(share, u, way)
        foot, head = np.interp(share, u, low), np.interp(share, u, high)
        edges = foot + bottom * (head - foot), foot + top * (head - foot)
        if side < 0:
            w, edges = -w[::-1], (edges[0][::-1], edges[1][::-1])
        return skin.patch(w, *edges, material, out=out, rows=4)

    def lens(share: float, level: float, radius: float) -> list[MeshBatch]:
        w = float(np.interp(share, u, way))
        z = float(np.interp(share, u, low + level * (high - low)))
        points, normal = skin.frame(side * w, z, 0.008)
        ring = [points - 0.014 * normal, points, points + 0.002 * normal]
        glass = [points - 0.004 * normal, points + 0.005 * normal, points + 0.009 * normal]
        spark = [points + 0.006 * normal, points + 0.011 * normal]
        return [
            tube(ring, [radius, radius, 0.92 * radius], "metal_grey", sides=12),
            tube(glass, [0.84 * radius, 0.76 * radius, 0.40 * radius], "car_glass", sides=12),
            tube(spark, [0.34 * radius, 0.24 * radius], "lens_white", sides=8),
        ]

    parts = [laid(0.0, 1.0, -0.07, 1.05, "rubber", 0.002, 17),
             laid(0.015, 0.985, 0.0, 1.0, "car_glass", 0.005, 17)]  # fmt: skip
    if face.lamps == "slit":
        parts += [laid(0.02, 0.93, 0.03, 0.20, "lens_white", 0.009, 15),
                  laid(0.06, 0.60, 0.34, 0.90, "metal_dark", 0.0065, 9)]  # fmt: skip
        parts += [*lens(0.17, 0.62, 0.030), *lens(0.34, 0.62, 0.030), *lens(0.50, 0.62, 0.026)]
        parts.append(laid(0.66, 0.90, 0.42, 0.78, "lens_amber", 0.008, 5))
    elif face.lamps == "block":
        parts += [laid(0.05, 0.68, 0.14, 0.74, "metal_dark", 0.0065, 9),
                  laid(0.04, 0.72, 0.83, 0.92, "lens_white", 0.009, 9),
                  laid(0.68, 0.72, 0.22, 0.85, "lens_white", 0.009, 3)]  # fmt: skip
        parts += [*lens(0.20, 0.42, 0.046), *lens(0.46, 0.42, 0.046)]
        parts.append(laid(0.78, 0.95, 0.20, 0.55, "lens_amber", 0.008, 5))
    else:
        parts += [laid(0.05, 0.72, 0.08, 0.94, "metal_dark", 0.0065, 9),
                  laid(0.06, 0.70, 0.08, 0.17, "lens_white", 0.009, 9)]  # fmt: skip
        parts += lens(0.36, 0.54, 0.078)
        parts.append(laid(0.76, 0.95, 0.25, 0.70, "lens_amber", 0.008, 5))
    return parts


def _across(skin: Skin, wide: float, count: int = 25) -> FloatArray:
    """Return the ways across the nose between both sides, shares of half the width."""
    return skin.ahead(np.linspace(-wide, wide, count))


def _grille(skin: Skin, face: Face) -> list[MeshBatch]:
    nose = float(skin.edge(0.0))

    def field(wide: float, low: float, high: float, narrow: float = 0.0) -> list[MeshBatch]:
        """Lay a dark mesh field with a frame; `narrow` draws its lower corners in."""
        share = np.linspace(-wide, wide, 25)
        foot = low + narrow * np.clip((np.abs(share) / wide - 0.72) / 0.28, 0, 1)
        way = skin.ahead(share)
        ring = np.concatenate([np.column_stack([way, foot]),
                               np.column_stack([way, np.full(25, high)])[::-1]])  # fmt: skip
        frame = skin.point(ring[:, 0], ring[:, 1], 0.008)
        return [skin.patch(way, foot, np.full(25, high), "rubber", out=0.003),
                tube(np.vstack([frame, frame[:1]]), 0.008, "metal_grey", sides=4)]  # fmt: skip

    def bars(wide: float, low: float, high: float, count: int, thick: float = 0.012,
             material: str = "metal_dark") -> list[MeshBatch]:  # fmt: skip
        way = _across(skin, wide, 11)
        return [
            skin.patch(way, z - thick / 2, z + thick / 2, material, out=0.012, rows=2)
            for z in np.linspace(low, high, count).tolist()
        ]

    def posts(wide: float, low: float, high: float, count: int) -> list[MeshBatch]:
        return [
            skin.ribbon(skin.ahead(np.full(4, share)), np.linspace(low, high, 4), 0.010,
                        "metal_dark", out=0.010)
            for share in np.linspace(-wide, wide, count).tolist()
        ]  # fmt: skip

    high = nose - 0.055
    if face.grille == "bars":
        low = nose - 0.22
        return [*field(0.48, low, high), *bars(0.47, low + 0.02, high - 0.015, 6)]
    if face.grille == "wide":  # from lamp to lamp, a bright strip over it
        low = nose - 0.175
        return [*field(0.50, low, high, 0.03), *bars(0.48, low + 0.035, high - 0.03, 3),
                *bars(0.50, high - 0.014, high - 0.014, 1, 0.020, "metal_grey")]  # fmt: skip
    if face.grille == "shield":
        low = nose - 0.30
        return [*field(0.44, low, high, 0.11), *bars(0.34, low + 0.05, low + 0.10, 2),
                *bars(0.42, low + 0.14, high - 0.02, 4),
                *posts(0.30, low + 0.02, high - 0.01, 7)]  # fmt: skip
    if face.grille == "slots":
        low = nose - 0.22
        parts = [skin.patch(_across(skin, 0.50), low - 0.02, high + 0.01, "metal_grey", out=0.003)]
        for share in np.linspace(-0.42, 0.42, 7).tolist():
            way = skin.ahead(np.linspace(share - 0.045, share + 0.045, 4))
            parts.append(skin.patch(way, low, high - 0.01, "rubber", out=0.006))
        return parts
    # Closed, as of what has no radiator: a gloss black panel between the lamps.
    return [skin.patch(_across(skin, 0.53), nose - 0.125, nose - 0.050, "car_glass", out=0.004),
            *bars(0.50, nose - 0.118, nose - 0.118, 1, 0.010, "metal_grey")]  # fmt: skip


def _front_bumper(skin: Skin, face: Face) -> list[MeshBatch]:
    """Make the bumper: its lip, the lower intake with bars, and fog lamps in their pockets."""
    nose = float(skin.edge(0.0))
    parts = []
    reach = _arch(skin, 0)
    end = float(skin.beside(max(reach, 0.06)))
    around = np.linspace(-end, end, 45)
    lift = SILL + (nose - SILL) * 0.06
    if face.trims:  # unpainted below
        parts.append(
            skin.patch(around, SILL - 0.008, SILL + 0.42 * (nose - SILL), "rubber", out=0.006)
        )
        level = SILL + 0.26 * (nose - SILL)
        way = _across(skin, 0.55)
        parts.append(skin.patch(way, level - 0.06, level + 0.05, "metal_dark", out=0.009))
        parts += [skin.ribbon(way, np.full(25, level + z), 0.010, "rubber", out=0.013)
                  for z in (-0.03, 0.0, 0.03)]  # fmt: skip
    else:
        parts.append(skin.patch(around, SILL - 0.008, lift, "rubber", out=0.010, rows=3))
        low, high = SILL + 0.10 * (nose - SILL), SILL + 0.34 * (nose - SILL)
        share = np.linspace(-0.60, 0.60, 25)
        top = high - 0.05 * np.clip((np.abs(share) - 0.42) / 0.18, 0, 1)
        way = skin.ahead(share)
        parts.append(skin.patch(way, low, top, "rubber", out=0.003))
        parts += [
            skin.patch(_across(skin, 0.54, 9), z - 0.005, z + 0.005, "metal_dark", out=0.010,
                       rows=2)
            for z in np.linspace(low + 0.03, high - 0.05, 3).tolist()
        ]  # fmt: skip
    for side in (-1.0, 1.0):
        share = np.linspace(0.68, 0.90, 7)
        way = skin.ahead(side * share if side > 0 else side * share[::-1])
        base = SILL + 0.17 * (nose - SILL)
        tall = 0.24 * (nose - SILL) * np.linspace(0.75, 1.0, 7)
        tall = tall if side > 0 else tall[::-1]
        if not face.trims:
            parts.append(skin.patch(way, base, base + tall, "rubber", out=0.003))
            parts.append(skin.patch(way, base + tall - 0.022, base + tall - 0.010, "metal_grey",
                                    out=0.008, rows=2))  # fmt: skip
        points, normal = skin.frame(skin.ahead(side * 0.76), base + 0.075, 0.012)
        parts.append(tube([points - 0.012 * normal, points], 0.030, "metal_grey", sides=10))
        parts.append(tube([points - 0.008 * normal, points + 0.004 * normal], [0.027, 0.020],
                          "car_glass", sides=10))  # fmt: skip
        parts.append(tube([points, points + 0.006 * normal], [0.010, 0.008], "lens_white",
                          sides=6))  # fmt: skip
    # A hollow for the plate, between grille and intake.
    z = plate_places(skin.body, face)[0][1]
    parts.append(skin.patch(_across(skin, 0.20, 9), z - 0.058, z + 0.058, "rubber", out=0.0015))
    return parts


@lru_cache(maxsize=256)
def plate_places(body: Body, face: Face) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return (y, z) of the faces that the plates before and behind are fixed on, metres."""
    skin = Skin(body)
    nose, tail = float(skin.edge(0.0)), float(skin.edge(3.0))
    share = 0.46 if face.grille in ("shield", "bars") or not face.trims else 0.36
    ahead = SILL + share * (nose - SILL)
    behind = SILL + (0.64 if face.rear != "tall" and tail > 0.9 else 0.40) * (tail - SILL)
    before, after = skin.point([0.0, 3.0], [ahead, behind], 0.006)
    return (float(before[1]), ahead), (float(after[1]), behind)


def rear(body: Body, face: Face) -> list[MeshBatch]:
    """Make what a car shows behind, at +y, but its plate."""
    skin = Skin(body)
    tail = float(skin.edge(3.0))
    bumper = SILL + 0.525 * (tail - SILL)
    reach = float(skin.beside(_arch(skin, 1)))
    around = np.linspace(reach, 6 - reach, 45)
    high = SILL + 0.34 * (tail - SILL) if face.trims else SILL + 0.20 * (tail - SILL)
    parts = [skin.patch(around, SILL - 0.008, high, "rubber", out=0.008)]
    lamp = _REARS[face.rear][1] if face.rear != "tall" else 0.84
    # The joints of the tailgate or the boot, and the one above the bumper.
    across = skin.behind(np.linspace(lamp + 0.02, -lamp - 0.02, 25))
    parts.append(skin.ribbon(across, np.full(25, bumper + 0.02), 0.008, "rubber"))
    for side in (-1.0, 1.0):
        up = np.linspace(bumper + 0.02, tail - 0.01, 12)
        way = skin.behind(np.full(12, side * (lamp + 0.02)))
        parts.append(skin.ribbon(way, np.minimum(up, skin.edge(way) - 0.005), 0.008, "rubber"))
        parts += _rear_lamp(skin, face, side)
        spot = skin.behind(np.linspace(side * 0.74 + 0.07, side * 0.74 - 0.07, 5))
        low = SILL + 0.26 * (tail - SILL)
        parts.append(skin.patch(spot, low, low + 0.03, "lens_red", out=0.012, rows=2))
    if body.cargo:  # two doors
        up = np.linspace(bumper + 0.02, tail, 8)
        parts.append(skin.ribbon(np.full(8, 3.0), up, 0.010, "rubber", out=0.003))
    z = plate_places(body, face)[1][1]
    hollow = skin.behind(np.linspace(0.32, -0.32, 9))
    parts.append(skin.patch(hollow, z - 0.085, z + 0.085, "rubber", out=0.0015))
    bar = skin.behind(np.linspace(0.32, -0.32, 9))
    material = "metal_grey" if not face.trims else "rubber"
    parts.append(skin.patch(bar, z + 0.088, z + 0.112, material, out=0.014, rows=2))
    above = tail - 0.08 if z + 0.20 < tail - 0.05 else z + 0.16
    points, normal = skin.frame(3.0, min(above, tail - 0.05), 0.006)
    parts.append(tube([points - 0.01 * normal, points], 0.036, "metal_grey", sides=12))
    if face.rear == "band":  # one light from side to side
        band = skin.behind(np.linspace(0.58, -0.58, 25))
        level = skin.edge(band) - BENEATH - 0.5 * _REARS["band"][0]
        parts.append(skin.patch(band, level - 0.030, level + 0.030, "car_glass", out=0.005))
        parts.append(skin.patch(band, level - 0.010, level + 0.010, "lens_red", out=0.009, rows=2))
    if not face.trims:
        half, end = body.width / 2, body.length / 2
        for x in (0.5 * half, -0.5 * half)[: 1 + (face.lamps == "slit")]:
            pipe = [[x, end - 0.20, 0.245], [x, end - 0.012, 0.245]]
            parts.append(tube(pipe, 0.034, "metal_grey", sides=10))
    return [*parts, *_rear_window(body)]


def _rear_window(body: Body) -> list[MeshBatch]:
    """Make the high brake light and, on upright windows, the wiper."""
    (y1, z1, _), (y0, z0, _) = cabin_line(body)[-2:].tolist()
    run = (y0 - y1) * body.length
    parts = []

    def at(x: float, share: float) -> list[float]:
        bow = 0.06 * (1 - (x / (0.8 * body.width / 2)) ** 2)
        return [x, y1 * body.length - body.length / 2 + share * run + bow + 0.012,
                z1 + share * (z0 - z1)]  # fmt: skip

    lamp = at(0.0, 0.09)
    parts.append(bevelled((-0.13, lamp[1] - 0.03, lamp[2] - 0.009), (0.13, lamp[1] + 0.004,
                          lamp[2] + 0.009), "lens_red", bevel=0.004))  # fmt: skip
    if body.cargo:
        joint = np.array([at(0.0, 0.12), at(0.0, 0.99)]) - (0.0, 0.008, 0.0)
        parts.append(tube(joint, 0.008, "rubber", sides=4))
    elif run < 0.9:
        parts.append(tube([at(0.0, 0.93), at(-0.34, 0.80)], 0.009, "rubber", sides=6))
    return parts


def _rear_lamp(skin: Skin, face: Face, side: float) -> list[MeshBatch]:
    """Make the lights of one side, which run round the corner into the flank."""
    height, begin = _REARS[face.rear]
    body = skin.body
    first = float(skin.beside(body.length - (0.30 if face.rear == "band" else 0.20)))
    last = float(skin.behind(begin))
    u = np.linspace(0.0, 1.0, 17)
    way = first + (last - first) * u
    high = skin.edge(way) - (BENEATH if face.rear != "tall" else 0.02)
    if face.rear == "tall":
        height = min(0.42 * (float(skin.edge(2.9)) - SILL), 0.36)
    taper = np.interp(u, [0.0, 0.45, 1.0], [0.45, 1.0, 0.80 if face.rear == "band" else 1.0])
    low = high - height * taper

    def laid(a: float, b: float, bottom: float, top: float, material: str, out: float,
             count: int = 9) -> MeshBatch:  # fmt: skip
        share = np.linspace(a, b, count)
        w = np.interp(share, u, way)
        foot, head = np.interp(share, u, low), np.interp(share, u, high)
        edges = foot + bottom * (head - foot), foot + top * (head - foot)
        if side < 0:
            w, edges = 6 - w[::-1], (edges[0][::-1], edges[1][::-1])
        return skin.patch(w, *edges, material, out=out, rows=4)

    parts = [laid(-0.0, 1.0, -0.05, 1.04, "rubber", 0.003, 17)]
    if face.rear == "band":
        parts += [laid(0.02, 0.98, 0.0, 1.0, "car_glass", 0.006, 17),
                  laid(0.04, 0.96, 0.60, 0.92, "lens_red", 0.010, 15),
                  laid(0.30, 0.96, 0.10, 0.40, "lens_red", 0.010, 9),
                  laid(0.10, 0.28, 0.10, 0.40, "lens_amber", 0.010, 5),
                  laid(0.78, 0.92, 0.16, 0.34, "lens_white", 0.012, 3)]  # fmt: skip
    elif face.rear == "block":
        parts += [laid(0.02, 0.98, 0.0, 1.0, "lens_red", 0.007, 17),
                  laid(0.64, 0.92, 0.42, 0.57, "lens_white", 0.010, 5),
                  laid(0.30, 0.62, 0.42, 0.57, "lens_amber", 0.010, 7),
                  laid(0.34, 0.92, 0.76, 0.86, "signal_red", 0.010, 9),
                  laid(0.34, 0.92, 0.14, 0.24, "signal_red", 0.010, 9)]  # fmt: skip
    else:
        parts += [laid(0.03, 0.97, 0.0, 1.0, "lens_red", 0.007, 17),
                  laid(0.35, 0.92, 0.32, 0.50, "lens_amber", 0.010, 7),
                  laid(0.35, 0.92, 0.12, 0.28, "lens_white", 0.010, 7),
                  laid(0.40, 0.88, 0.60, 0.90, "signal_red", 0.010, 7)]  # fmt: skip
        parts += _upper_lamp(body, side)
    return parts


def _upper_lamp(body: Body, side: float) -> list[MeshBatch]:
    """Run a slim red light up the pillar beside the rear window."""
    (y1, z1, w1), (y0, z0, _) = cabin_line(body)[-2:].tolist()
    share = np.linspace(0.02, 0.62, 6)
    half, end = body.width / 2, body.length / 2
    y = (y0 + (y1 - y0) * share) * body.length - end + 0.008
    x = half * (0.92 + (w1 - 0.92) * share) - 0.045
    line = np.column_stack([side * x, y, z0 - 0.03 + (z1 - z0) * share])
    return [tube(line, [0.030, 0.032, 0.032, 0.030, 0.026, 0.014], "lens_red", sides=8)]


def roof_sign(body: Body) -> list[MeshBatch]:
    """Set the lamp of a taxi on its roof, with its word before and behind."""
    share, z, _ = body.roof[2]
    y = (share - 0.06) * body.length - body.length / 2
    wide, high = (0.26, 0.11) if body.sign.isascii() else (0.20, 0.13)
    lamp = "lens_amber" if body.sign.isascii() else "lens_white"
    face = y - 0.06
    parts = [bevelled((-wide, face, z - 0.01), (wide, y + 0.06, z + high), lamp, bevel=0.02)]
    text = word(body.sign, 0.85 * wide, z + 0.02, z + high - 0.02, face, "metal_dark", deep=0.003)
    behind = [moved(letter, (0.0, 2 * y, 0.0), yaw=np.pi) for letter in text]
    return [*parts, *text, *behind]


def rails(body: Body) -> list[MeshBatch]:
    """Lay a rail along each side of the roof, on feet."""
    line = np.array(body.roof)
    share = np.linspace(line[1, 0] + 0.05, line[-2, 0] - 0.02, 7)
    z = np.interp(share, line[:, 0], line[:, 1]) + 0.025
    out = (np.interp(share, line[:, 0], line[:, 2]) - 0.06) * body.width / 2
    y = share * body.length - body.length / 2
    parts = []
    for side in (-1.0, 1.0):
        path = np.column_stack([side * out, y, z])
        path = np.vstack([path[0] - [0, 0.04, 0.05], path, path[-1] + [0, 0.04, -0.05]])
        parts.append(tube(path, 0.014, "metal_grey", sides=8))
    return parts
