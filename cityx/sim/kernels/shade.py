"""Light on what a camera sees, and the shade of what stands in the sun."""

from __future__ import annotations

from math import ceil, exp, floor, sqrt
from typing import Any

import numpy as np

from cityx.geometry.compiled import borrowing, compiled

BEFORE = 0.6  # metres before a surface at which it is asked whether the sun comes there
LIGHTEST = 2.2  # light at which a picture is white but for the curve
GLOW = np.array([[0.0, 0.0, 0.0], [2.2, 0.08, 0.05], [2.2, 1.0, 0.05], [0.0, 0.0, 0.0],
                 [0.08, 2.0, 1.0]])  # fmt: skip  # light of a lamp by its bit
OUT = 0.4  # share of its light that the glass of a lamp sends back when it does not burn
BOUNCED = 0.30  # share of the sky's light that comes up from the ground


@compiled
def tops(first: Any, corner: Any, mesh: Any, way: Any, frame: Any, top: Any) -> None:
    """Write to (h, w) cells how high the highest triangle over each middle is."""
    west, south, size = frame[0], frame[1], frame[2]
    rows, columns = top.shape
    p = np.empty((3, 3))
    for n in range(len(mesh)):
        w = way[n]
        for t in range(first[mesh[n]], first[mesh[n] + 1]):
            for k in range(3):
                for a in range(3):
                    p[k, a] = (w[a, 0] * corner[t, k, 0] + w[a, 1] * corner[t, k, 1]
                               + w[a, 2] * corner[t, k, 2] + w[a, 3])  # fmt: skip
            ux, uy = p[1, 0] - p[0, 0], p[1, 1] - p[0, 1]
            vx, vy = p[2, 0] - p[0, 0], p[2, 1] - p[0, 1]
            area = ux * vy - uy * vx
            if abs(area) < 1e-9:
                continue
            j0 = max(ceil((p[0, 1] + min(0.0, uy, vy) - south) / size - 0.5), 0)
            j1 = min(floor((p[0, 1] + max(0.0, uy, vy) - south) / size - 0.5), rows - 1)
            i0 = max(ceil((p[0, 0] + min(0.0, ux, vx) - west) / size - 0.5), 0)
            i1 = min(floor((p[0, 0] + max(0.0, ux, vx) - west) / size - 0.5), columns - 1)
            for j in range(j0, j1 + 1):
                dy = south + (j + 0.5) * size - p[0, 1]
                for i in range(i0, i1 + 1):
                    dx = west + (i + 0.5) * size - p[0, 0]
                    one, other = (dx * vy - dy * vx) / area, (dy * ux - dx * uy) / area
                    if one < 0.0 or other < 0.0 or one + other > 1.0:
                        continue
                    z = p[0, 2] + one * (p[1, 2] - p[0, 2]) + other * (p[2, 2] - p[0, 2])
                    top[j, i] = max(top[j, i], z)


@compiled
def darken(top: Any, frame: Any, x: float, y: float, rise: float, reach: float, dark: Any) -> None:
    """Write the height up to which each cell lies in the shade of what stands towards (x, y)."""
    rows, columns = top.shape
    size = frame[2]
    highest = -np.inf
    for j in range(rows):
        for i in range(columns):
            highest = max(highest, top[j, i])
    for j in range(rows):
        for i in range(columns):
            found = -np.inf
            away = size
            while away < reach and highest - away * rise > found:
                p, q = i + round(x * away / size), j + round(y * away / size)
                if not (0 <= p < columns and 0 <= q < rows):
                    break
                found = max(found, top[q, p] - away * rise)
                away += size
            dark[j, i] = found


@borrowing
def lit(dark: Any, frame: Any, x: float, y: float, z: float) -> float:
    """Return which share of the sun comes to a place."""
    u, v = (x - frame[0]) / frame[2] - 0.5, (y - frame[1]) / frame[2] - 0.5
    i, j = floor(u), floor(v)
    rows, columns = dark.shape
    if not (0 <= i < columns - 1 and 0 <= j < rows - 1):
        return 1.0
    u, v = u - i, v - j
    found = 0.0
    for b in range(2):
        for a in range(2):
            share = (u if a else 1.0 - u) * (v if b else 1.0 - v)
            if z > dark[j + b, i + a] - 0.1:
                found += share
    return found


@compiled
def paint(
    close: Any, thing: Any, face: Any, corner: Any, face_colour: Any, face_tinted: Any,
    face_lamp: Any, lamp: Any, way: Any, tint: Any, mover_way: Any, mover_tint: Any, eye: Any,
    rays: Any, towards: Any, sun: Any, sky: Any, visibility: float, frame: Any, dark: Any,
    curve: Any, image: Any,
) -> None:  # fmt: skip
    """Write (h, w, 3) uint8 pictures of what `cityx.sim.kernels.draw.draw` has drawn.

    Parameters
    ----------
    face_lamp, lamp
        Which bit a face is of, and (n,) uint8, those that burn of each thing.
    eye, rays
        (3,) metres, and (3, 3): direction of depth 1 of the pixel (0, 0), its change by a column
        and by a row.
    towards, sun, sky
        (3,) direction of the sun, its light and that of the sky on white, linear.
    visibility
        Metres at which contrast falls to 2 %.
    frame, dark
        Of `darken`.
    curve
        (k,) uint8, what light from 0 to `LIGHTEST` looks like.
    """
    height, width = close.shape
    still = len(way)
    last_thing, last_face = -2, -2
    n0, n1, n2 = 0.0, 0.0, 1.0
    base = np.zeros(3)
    light = np.zeros(3)
    steps = len(curve) - 1
    for j in range(height):
        for i in range(width):
            d0 = rays[0, 0] + i * rays[1, 0] + j * rays[2, 0]
            d1 = rays[0, 1] + i * rays[1, 1] + j * rays[2, 1]
            d2 = rays[0, 2] + i * rays[1, 2] + j * rays[2, 2]
            size = sqrt(d0 * d0 + d1 * d1 + d2 * d2)
            up = max(d2 / size, 0.0)
            haze = (1.0 - up) ** 6
            number = thing[j, i]
            if number < 0:
                for k in range(3):
                    light[k] = 1.25 * sky[k] * (1.0 - haze) + (
                        1.1 * (0.45 * sky[k] + 0.55 * (sky[0] + sky[1] + sky[2]) / 3.0) + 0.04
                        * sun[k]) * haze  # fmt: skip
            else:
                row = face[j, i]
                if number != last_thing or row != last_face:
                    last_thing, last_face = number, row
                    w = way[number] if number < still else mover_way[number - still]
                    a0, a1 = corner[row, 1, 0] - corner[row, 0, 0], (
                        corner[row, 1, 1] - corner[row, 0, 1])  # fmt: skip
                    a2 = corner[row, 1, 2] - corner[row, 0, 2]
                    b0, b1 = corner[row, 2, 0] - corner[row, 0, 0], (
                        corner[row, 2, 1] - corner[row, 0, 1])  # fmt: skip
                    b2 = corner[row, 2, 2] - corner[row, 0, 2]
                    u0 = w[0, 0] * a0 + w[0, 1] * a1 + w[0, 2] * a2
                    u1 = w[1, 0] * a0 + w[1, 1] * a1 + w[1, 2] * a2
                    u2 = w[2, 0] * a0 + w[2, 1] * a1 + w[2, 2] * a2
                    v0 = w[0, 0] * b0 + w[0, 1] * b1 + w[0, 2] * b2
                    v1 = w[1, 0] * b0 + w[1, 1] * b1 + w[1, 2] * b2
                    v2 = w[2, 0] * b0 + w[2, 1] * b1 + w[2, 2] * b2
                    n0, n1, n2 = u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0
                    long = sqrt(n0 * n0 + n1 * n1 + n2 * n2)
                    back = 1.0 / long if long > 0.0 else 0.0
                    if n0 * d0 + n1 * d1 + n2 * d2 > 0.0:
                        back = -back
                    n0, n1, n2 = n0 * back, n1 * back, n2 * back
                    for k in range(3):
                        code = face_colour[row, k] / 255.0
                        base[k] = code * code
                        if face_tinted[row]:
                            base[k] *= tint[number, k] if number < still else (
                                mover_tint[number - still, k])  # fmt: skip
                deep = 1.0 / close[j, i]
                x, y, z = eye[0] + deep * d0, eye[1] + deep * d1, eye[2] + deep * d2
                facing = n0 * towards[0] + n1 * towards[1] + n2 * towards[2]
                share = 0.0
                if facing > 0.0 and sun[0] > 0.0:
                    share = facing * lit(dark, frame, x + BEFORE * n0, y + BEFORE * n1,
                                         z + BEFORE * n2)  # fmt: skip
                above = 0.5 + 0.5 * n2
                air = 1.0 - exp(-3.912 * deep * size / visibility)
                for k in range(3):
                    fill = sky[k] * (above + (1.0 - above) * BOUNCED)
                    fill += BOUNCED * 0.4 * sun[k] * (1.0 - above)
                    own = base[k] * (sun[k] * share + fill)
                    light[k] = own + (1.1 * sky[k] - own) * air
                if number < still and face_lamp[face[j, i]]:
                    bit = face_lamp[face[j, i]]
                    burns = (lamp[number] & bit) != 0
                    for k in range(3):
                        light[k] = GLOW[bit, k] if burns else OUT * light[k]
            for k in range(3):
                at = int(light[k] / LIGHTEST * steps)
                image[j, i, k] = curve[min(max(at, 0), steps)]
