"""Fronts and rears of cars drawn for near views: lamps, grilles and bumpers by make."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.assets.car_bodies import Body, Face, waist_of
from cityx.assets.lettering import word
from cityx.assets.shapes import Color, bevelled, loft, moved, prism, tube
from cityx.city.mesh import MeshBatch

FloatArray = NDArray[np.float64]
DARK: Color = (0.03, 0.03, 0.032)
# Headlights: metres of height, and where they begin and end, shares of half the width.
_LAMPS = {"slit": (0.085, 0.50), "block": (0.15, 0.56), "round": (0.19, 0.56)}


def front(body: Body, face: Face) -> list[MeshBatch]:
    """Make what a car shows ahead, at -y, but its plate."""
    half, end, nose = body.width / 2, body.length / 2, body.hood[0][1]
    parts = [*_grille(body, face), *_headlights(body, face), *_front_bumper(body, face)]
    y0, z0, _ = body.roof[0]
    foot = y0 * body.length - end
    for side in (-1.0, 1.0):
        wiper = [[side * 0.1, foot - 0.02, z0 + 0.01],
                 [side * 0.1 + 0.28 * body.width, foot + 0.06, z0 + 0.05]]  # fmt: skip
        parts.append(tube(wiper, 0.006, "rubber", sides=6))
    if body.sign:
        parts += roof_sign(body)
    badge = nose - (0.14 if face.trims else 0.05)
    parts.append(tube([[0.0, -end - 0.026, badge], [0.0, -end - 0.01, badge]], 0.035,
                      "metal_grey", sides=20))  # fmt: skip
    parts.append(bevelled((-0.74 * half, -end - 0.002, 0.23), (0.74 * half, -end + 0.10, 0.305),
                          "rubber", bevel=0.02))  # fmt: skip
    return parts


def _top(body: Body, y: FloatArray) -> FloatArray:
    """Upper edge of the lower body at metres behind the nose, on its sides."""
    return waist_of(body, y / body.length) - 0.03


def _out(body: Body, y: FloatArray) -> FloatArray:
    """Half the width of the body at metres behind the nose, as its sections taper."""
    ahead = np.maximum(0.0, 1 - y / (0.10 * body.length))
    return np.asarray(body.width / 2 * (1 - 0.16 * ahead**2))


def _swept(
    x: FloatArray, y: FloatArray, low: FloatArray, high: FloatArray, deep: float, material: str,
    side: float, tint: Color = (1.0, 1.0, 1.0),
) -> MeshBatch:  # fmt: skip
    """Skin a lens that runs round a corner: (m,) places on the body, lower and upper edges."""
    way = np.gradient(np.column_stack([x, y]), axis=0)
    way /= np.hypot(*way.T)[:, None]
    inward = np.column_stack([-way[:, 1], way[:, 0]]) * deep
    rings = np.stack(
        [np.column_stack([side * (x + s * inward[:, 0]), y + s * inward[:, 1], z])
         for s, z in ((-0.3, low), (-0.3, high), (1.0, high), (1.0, low))], axis=1
    )  # fmt: skip
    return loft(rings[:, ::-1] if side > 0 else rings, material, tint)


def _headlights(body: Body, face: Face) -> list[MeshBatch]:
    half, end, nose = body.width / 2, body.length / 2, body.hood[0][1]
    parts: list[MeshBatch] = []
    height, begin = _LAMPS[face.lamps]
    # From beside the grille round the corner of the body and back along the wing.
    back = np.array([0.0, 0.0, 0.012, 0.05, 0.12, 0.20])
    across = np.array([begin, 0.68, 0.80, 0.88, 0.945, 0.975]) * half
    across = np.minimum(across, _out(body, back) + 0.004)
    high = np.maximum(_top(body, back) - 0.015, nose - 0.05)
    high = np.minimum(high, nose + 0.13 * body.hood[2][1])
    shrink = np.array([0.75, 1.0, 1.0, 0.95, 0.75, 0.35])
    low = high - height * shrink
    for side in (-1.0, 1.0):
        lens = "metal_grey" if face.lamps == "round" else "car_glass"
        y = back - end - 0.004
        parts.append(_swept(across, y, low, high, 0.05, lens, side))
        if face.lamps == "slit":  # a bright line below, two lenses in the dark
            parts.append(
                _swept(across + 0.004, y - 0.006, low, low + 0.016, 0.02, "lens_white", side)
            )
            for share in (0.60, 0.72):
                z = nose - 0.05 - 0.42 * height
                parts += _round_lamp(side * share * half, -end - 0.012, z, 0.026)
        elif face.lamps == "block":
            z = nose - 0.05 - 0.5 * height
            for share in (0.63, 0.76):
                parts += _round_lamp(side * share * half, -end - 0.018, z, 0.048)
            parts.append(_swept(across[3:] + 0.005, y[3:] - 0.004, low[3:], low[3:] + 0.05,
                                0.02, "lens_amber", side))  # fmt: skip
        else:
            z = nose - 0.05 - 0.5 * height
            parts += _round_lamp(side * 0.70 * half, -end - 0.024, z, 0.092)
    return parts


def _round_lamp(x: float, y: float, z: float, radius: float) -> list[MeshBatch]:
    """Set a round lens, its rim and the bulb before it."""
    return [
        tube([[x, y, z], [x, y + 0.03, z]], [0.9 * radius, radius], "lens_white", sides=24),
        tube([[x, y - 0.004, z], [x, y, z]], [0.40 * radius, 0.48 * radius], "metal_grey",
             sides=16),
    ]  # fmt: skip


def _bars(body: Body, wide: float, low: float, high: float, count: int) -> list[MeshBatch]:
    """Lay bright bars across a dark field."""
    end = body.length / 2
    return [
        tube([[-wide, -end - 0.014, z], [wide, -end - 0.014, z]], 0.005, "metal_grey", sides=6)
        for z in np.linspace(low, high, count).tolist()
    ]


def _grille(body: Body, face: Face) -> list[MeshBatch]:
    half, end, nose = body.width / 2, body.length / 2, body.hood[0][1]

    def field(wide: float, low: float, high: float) -> MeshBatch:
        return bevelled((-wide, -end - 0.010, low), (wide, -end + 0.06, high), "metal_dark")

    if face.grille == "bars":
        wide, low, high = 0.47 * half, nose - 0.24, nose - 0.08
        return [field(wide, low, high), *_bars(body, wide - 0.02, low + 0.015, high - 0.01, 7)]
    if face.grille == "wide":  # from lamp to lamp, a bright strip over it
        wide, low, high = 0.53 * half, nose - 0.17, nose - 0.045
        return [field(wide, low, high), *_bars(body, wide, high - 0.006, high, 2),
                *_bars(body, wide - 0.03, low + 0.03, high - 0.04, 2)]  # fmt: skip
    if face.grille == "shield":
        high, low = nose - 0.03, nose - 0.27
        outline = np.array([[-0.30, low], [0.30, low], [0.44, low + 0.10], [0.40, high],
                            [-0.40, high], [-0.44, low + 0.10]])  # fmt: skip
        outline[:, 0] *= half
        ring = np.column_stack([outline[:, 0], np.full(6, -end - 0.014), outline[:, 1]])
        frame = tube(np.vstack([ring, ring[:1]]), 0.011, "metal_grey", sides=8)
        return [prism(outline, -end - 0.010, -end + 0.05, "metal_dark"), frame,
                *_bars(body, 0.30 * half, low + 0.04, high - 0.04, 4)]  # fmt: skip
    if face.grille == "slots":
        wide, low, high = 0.46 * half, nose - 0.22, nose - 0.06
        places = np.linspace(-wide, wide, 8)
        pairs = zip(places[:-1].tolist(), places[1:].tolist(), strict=True)
        return [
            bevelled((a + 0.014, -end - 0.010, low), (b - 0.014, -end + 0.05, high), "metal_dark",
                     bevel=0.01)
            for a, b in pairs
        ]  # fmt: skip
    # Closed, as of what has no radiator: a dark line between the lamps.
    return [bevelled((-0.50 * half, -end - 0.008, nose - 0.075), (0.50 * half, -end + 0.04,
                     nose - 0.055), "metal_dark", bevel=0.004)]  # fmt: skip


def _front_bumper(body: Body, face: Face) -> list[MeshBatch]:
    half, end = body.width / 2, body.length / 2
    if face.trims:
        parts = [bevelled((-0.82 * half, -end - 0.03, 0.31), (0.82 * half, -end + 0.06, 0.40),
                          "rubber", bevel=0.02)]  # fmt: skip
        for side in (-1.0, 1.0):
            lamp = [side * 0.64 * half, -end - 0.034, 0.355]
            parts.append(tube([lamp, [lamp[0], lamp[1] + 0.04, lamp[2]]], 0.03, "metal_grey",
                              sides=16))  # fmt: skip
        return parts
    # A low intake in the painted bumper, and pockets at its ends.
    outline = np.array([[-0.60, 0.315], [0.60, 0.315], [0.52, 0.415], [-0.52, 0.415]])
    outline[:, 0] *= half
    parts = [prism(outline, -end - 0.008, -end + 0.05, "metal_dark")]
    for side in (-1.0, 1.0):
        x = sorted((side * 0.66 * half, side * 0.82 * half))
        parts.append(bevelled((x[0], -end - 0.006, 0.34), (x[1], -end + 0.06, 0.45),
                              "metal_dark", bevel=0.02))  # fmt: skip
        lamp = [side * 0.73 * half, -end - 0.014, 0.395]
        parts.append(tube([lamp, [lamp[0], lamp[1] + 0.03, lamp[2]]], 0.028, "metal_grey",
                          sides=16))  # fmt: skip
    return parts


def plate_places(body: Body, face: Face) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return (y, z) of the faces that the plates before and behind are fixed on, metres."""
    end, nose, tail = body.length / 2, body.hood[0][1], body.hood[-1][1]
    # It stands before the grille where both have no room.
    ahead = nose - 0.30 if face.trims else 0.455
    return (-end - 0.02, ahead), (end, 0.50 if face.rear != "block" else tail - 0.12)


def rear(body: Body, face: Face) -> list[MeshBatch]:
    """Make what a car shows behind, at +y, but its plate."""
    half, end, tail = body.width / 2, body.length / 2, body.hood[-1][1]
    low = (-0.78 * half, end - 0.08, 0.24)
    parts = [bevelled(low, (0.78 * half, end + 0.014, 0.36), "rubber", bevel=0.02)]
    parts.append(tube([[0.5 * half, end - 0.10, 0.24], [0.5 * half, end + 0.03, 0.24]], 0.032,
                      "metal_grey", sides=16))  # fmt: skip
    parts.append(tube([[-0.14, end + 0.012, tail - 0.02], [0.14, end + 0.012, tail - 0.02]], 0.012,
                      "metal_grey", sides=10))  # fmt: skip
    for side in (-1.0, 1.0):
        parts += _rear_lamp(body, face, side)
    if face.rear == "band":
        parts.append(bevelled((-0.60 * half, end - 0.03, tail + 0.035), (0.60 * half, end + 0.010,
                              tail + 0.065), "lens_red", bevel=0.006))  # fmt: skip
    return parts


def _rear_lamp(body: Body, face: Face, side: float) -> list[MeshBatch]:
    """Make the lights of one side."""
    half, end, tail = body.width / 2, body.length / 2, body.hood[-1][1]
    if face.rear == "tall":  # up the edge of the tailgate, at both sides of the window
        foot, waist = tail - 0.06, body.hood[-2][1]
        upper = waist + 0.30 * (body.roof[-2][1] - waist)
        z = np.array([foot, tail, waist, upper])
        rise = np.clip((z - waist) / max(body.roof[-2][1] - waist, 0.1), 0.0, 1.0)
        lean = (body.roof[-2][0] - body.roof[-1][0]) * body.length * rise
        y = end + np.array([0.012, 0.012, -0.015, 0.0]) + np.where(z > waist, lean + 0.02, 0.0)
        x = half * np.where(z > waist, 0.90 + (body.roof[-2][2] - 0.88) * rise, 0.86)
        wide, deep = 0.055, 0.10
        rings = np.stack([
            np.column_stack([side * (x + a * wide), y + b, z])
            for a, b in ((-1, 0.0), (0.7, 0.0), (1.0, -deep), (-1, -deep))
        ], axis=1)  # fmt: skip
        parts = [loft(rings if side > 0 else rings[:, ::-1], "lens_red")]
        spot = sorted((side * (0.86 * half - 0.04), side * (0.86 * half + 0.03)))
        parts.append(bevelled((spot[0], end + 0.006, tail + 0.02), (spot[1], end + 0.02,
                              tail + 0.07), "signal_red", bevel=0.006))  # fmt: skip
        parts.append(bevelled((spot[0], end + 0.006, tail - 0.04), (spot[1], end + 0.02,
                              tail + 0.0), "lens_amber", bevel=0.006))  # fmt: skip
        return parts
    begin, high = (0.46, 0.085) if face.rear == "band" else (0.58, 0.13)
    x = np.array(sorted((side * begin * half, side * 0.90 * half)))
    parts = [bevelled((x[0], end - 0.14, tail - 0.01), (x[1], end + 0.014, tail + high), "lens_red",
                      bevel=0.02)]  # fmt: skip
    inner, outer = x[0] + 0.02, x[1] - 0.02
    for z in np.linspace(tail + 0.02, tail + high - 0.03, 2 if face.rear == "band" else 3).tolist():
        parts.append(bevelled((inner, end + 0.008, z), (outer, end + 0.018, z + 0.016),
                              "signal_red", bevel=0.004))  # fmt: skip
    return parts


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
