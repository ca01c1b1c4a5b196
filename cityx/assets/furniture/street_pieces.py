"""Street furniture that stands by rule: signs, tubs, tables, kiosks, bicycles, service poles.

Each maker is named for a prototype and returns its shapes: z up, front -y (towards the road),
origin on the ground at the foot.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.furniture_parts import (
    BLUE,
    BURIED,
    DARK,
    GREEN,
    GREY,
    PALE,
    RED,
    STONE,
    YELLOW,
    Shapes,
    post,
)
from cityx.assets.shapes import (
    Color,
    box,
    cards,
    cylinder,
    disc,
    is_fine,
    lathe,
    loft,
    moved,
    prism,
    tube,
)
from cityx.city.mesh import MeshBatch
from cityx.ids import rng_for

FINE_LEAVES, FINE_LEAF, FINE_SLIM = 4, 0.66, 0.55  # of mounds in near views


def leaf_mound(name: str, low: Color, high: Color, count: int, *, size: float = 0.07) -> MeshBatch:
    """Fill a box with the leaves of a low shrub, the same for the same name; more in near views."""
    rng = rng_for(0, f"assets/{name}", 1)
    slim = 1.0
    if is_fine():
        count, size, slim = FINE_LEAVES * count, FINE_LEAF * size, FINE_SLIM
    share = rng.uniform(-1, 1, (count, 3))
    share /= np.maximum(np.abs(share).max(axis=1, keepdims=True), 0.6)
    a, b = np.array(low), np.array(high)
    centre = (a + b) / 2 + share * (b - a) / 2
    normal = share + 0.6 * rng.normal(size=(count, 3)) + [0, 0, 0.4]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, rng.normal(size=(count, 3)))
    along *= size / np.linalg.norm(along, axis=1, keepdims=True)
    shade = rng.uniform(0.6, 1.1, (count, 1)) * [0.9, 0.95, 0.85]
    return cards(centre, along, slim * np.cross(normal, along), "leaf", shade)


def planter() -> Shapes:
    """Tub of concrete, 1.2 m wide, with a low shrub."""
    return [
        box((-0.6, -0.3, -0.05), (0.6, 0.3, 0.5), "concrete"),
        box((-0.54, -0.24, 0.5), (0.54, 0.24, 0.52), "soil"),
        leaf_mound("planter", (-0.55, -0.28, 0.5), (0.55, 0.28, 0.95), 170),
    ]


def planter_round() -> Shapes:
    """Round tub with a clipped bush on a stem."""
    return [
        lathe([(0.26, -0.05), (0.34, 0.5), (0.37, 0.52), (0.37, 0.58), (0.30, 0.58), (0.29, 0.52),
               (0.0, 0.52)], "concrete", (0.75, 0.6, 0.5), sides=12),
        cylinder((0, 0, 0.5), (0, 0, 1.0), 0.025, "bark", sides=5),
        leaf_mound("planter_round", (-0.36, -0.36, 0.9), (0.36, 0.36, 1.6), 200),
    ]  # fmt: skip


def _chair(x: float, y: float, yaw: float) -> Shapes:
    parts: Shapes = [box((-0.21, -0.21, 0.43), (0.21, 0.21, 0.46), "bench_wood")]
    for a in (-0.19, 0.19):
        for b in (-0.19, 0.19):
            parts.append(box((a - 0.012, b - 0.012, 0.0), (a + 0.012, b + 0.012, 0.43),
                             "metal_dark"))  # fmt: skip
        parts.append(box((a - 0.012, 0.18, 0.46), (a + 0.012, 0.205, 0.86), "metal_dark"))
    parts.append(box((-0.2, 0.18, 0.62), (0.2, 0.205, 0.84), "bench_wood"))
    return [moved(part, (x, y, 0.0), yaw=yaw) for part in parts]


def cafe_set() -> Shapes:
    """Round table with three chairs."""
    parts: Shapes = [
        lathe([(0.22, 0.0), (0.22, 0.03), (0.03, 0.05), (0.03, 0.70), (0.36, 0.71), (0.36, 0.735),
               (0.0, 0.735)], "metal_dark", sides=12),
    ]  # fmt: skip
    for x, y, yaw in ((-0.62, 0.0, np.pi / 2), (0.62, 0.05, -np.pi / 2), (0.08, 0.6, 0.1)):
        parts += _chair(x, y, yaw)
    return parts


def parasol() -> Shapes:
    """Square parasol of 2.4 m over a table with four chairs."""
    top, eave = 2.75, 2.25
    parts: Shapes = [
        box((-0.3, -0.3, 0.0), (0.3, 0.3, 0.06), "metal_dark"),
        post(2.8, 0.028, "bench_wood"),
        lathe([(0.03, 0.70), (0.40, 0.71), (0.40, 0.735), (0.0, 0.735)], "metal_dark", sides=12),
    ]
    corner = np.array([[-1.2, -1.2], [1.2, -1.2], [1.2, 1.2], [-1.2, 1.2]])
    ring = [np.column_stack([corner * s, np.full(4, z)])
            for s, z in ((1.0, eave - 0.14), (1.0, eave), (0.05, top))]  # fmt: skip
    parts.append(loft(np.stack(ring), "cloth", (0.78, 0.72, 0.60), caps=(True, True)))
    for x, y, yaw in ((-0.72, 0.0, np.pi / 2), (0.72, 0.0, -np.pi / 2), (0.0, 0.72, 0.0),
                      (0.0, -0.72, np.pi)):  # fmt: skip
        parts += _chair(x, y, yaw)
    return parts


def shop_board() -> Shapes:
    """Folding board before a shop."""
    face = [(-0.3, 0.0), (0.3, 0.0), (0.3, 1.0), (-0.3, 1.0)]
    leaf = prism(face, -0.015, 0.015, "bench_wood")
    slate = prism([(-0.25, 0.1), (0.25, 0.1), (0.25, 0.94), (-0.25, 0.94)], -0.022, -0.014, "sign",
                  DARK)  # fmt: skip

    def leaning(shape: MeshBatch, sign: float) -> MeshBatch:
        v = shape.vertices.copy()
        v[:, 1] = sign * (v[:, 1] - 0.2 * (1.0 - v[:, 2]))
        v[:, 0] *= sign
        return replace(shape, vertices=v)

    return [leaning(part, sign) for part in (leaf, slate) for sign in (1.0, -1.0)]


def kiosk() -> Shapes:
    """Newspaper kiosk of 3 x 2 m with an awning."""
    parts: Shapes = [
        box((-1.5, -1.0, BURIED), (1.5, 1.0, 0.95), "plastic", GREEN),
        box((-1.5, -0.1, 0.95), (1.5, 1.0, 2.35), "plastic", GREEN),
        box((-1.42, -0.98, 0.95), (1.42, -0.1, 1.0), "bench_wood"),
        box((-1.5, -1.0, 0.95), (-1.42, -0.1, 2.35), "plastic", GREEN),
        box((1.42, -1.0, 0.95), (1.5, -0.1, 2.35), "plastic", GREEN),
        box((-1.65, -1.15, 2.35), (1.65, 1.15, 2.5), "metal_dark"),
        prism([(-1.5, 2.5), (1.5, 2.5), (1.1, 2.85), (-1.1, 2.85)], -1.0, 1.0, "metal_dark"),
        box((-1.3, -1.17, 2.5), (1.3, -1.1, 2.8), "sign", PALE),
    ]
    for row in range(2):
        for column in range(7):
            x, z = -1.15 + 0.38 * column, 1.15 + 0.55 * row
            color = (RED, PALE, BLUE, YELLOW)[(column + row) % 4]
            parts.append(box((x - 0.14, -0.13, z), (x + 0.14, -0.1, z + 0.4), "sign", color))
    for x in (-1.1, 0.0, 1.1):
        parts.append(box((x - 0.35, -1.03, 0.25), (x + 0.35, -1.0, 0.85), "sign", PALE))
    return parts


def bicycle() -> Shapes:
    """Parked bicycle, 1.75 m long, along y."""
    ring = np.linspace(0.0, 2 * np.pi, 13)
    paint: Color = (0.10, 0.14, 0.18)
    parts: Shapes = []
    for y in (-0.52, 0.52):
        wheel = np.column_stack(
            [np.zeros(13), y + 0.33 * np.cos(ring), 0.335 + 0.33 * np.sin(ring)]
        )
        parts.append(tube(wheel, 0.018, "rubber", sides=4, caps=(False, False)))
    frame = (
        ([0, 0.52, 0.335], [0, 0.05, 0.28]), ([0, 0.05, 0.28], [0, 0.22, 0.86]),
        ([0, 0.05, 0.28], [0, -0.38, 0.68]), ([0, 0.19, 0.76], [0, -0.36, 0.76]),
        ([0, 0.52, 0.335], [0, 0.19, 0.76]), ([0, -0.52, 0.335], [0, -0.34, 1.0]),
    )  # fmt: skip
    parts += [tube(bar, 0.014, "car_paint", paint, sides=4) for bar in frame]
    parts.append(box((-0.06, 0.12, 0.86), (0.06, 0.36, 0.92), "rubber"))
    parts.append(tube([[-0.28, -0.22, 1.02], [0, -0.34, 1.0], [0.28, -0.22, 1.02]], 0.013,
                      "metal_grey", sides=4))  # fmt: skip
    return parts


def wheelie_bins() -> Shapes:
    """Two bins on wheels beside each other, lids to the front."""
    parts: Shapes = []
    for x, lid in ((-0.36, BLUE), (0.36, (0.25, 0.16, 0.08))):
        ring = [np.array([[x - s, -t, z], [x + s, -t, z], [x + s, t, z], [x - s, t, z]])
                for s, t, z in ((0.21, 0.27, 0.04), (0.27, 0.34, 0.98))]  # fmt: skip
        parts.append(loft(np.stack(ring), "plastic", DARK))
        parts.append(box((x - 0.29, -0.36, 0.98), (x + 0.29, 0.38, 1.05), "plastic", lid))
        parts.append(cylinder((x - 0.24, 0.3, 0.1), (x + 0.24, 0.3, 0.1), 0.1, "rubber", sides=8))
    return parts


def sign_no_entry() -> Shapes:
    """Round red sign with a white bar."""
    return [
        post(2.7),
        disc((0, -0.055, 2.38), 0.30, "sign", RED, sides=16, thickness=0.02),
        box((-0.2, -0.07, 2.33), (0.2, -0.055, 2.43), "sign"),
    ]


def sign_one_way() -> Shapes:
    """Tall blue sign with a white arrow upwards, which is ahead."""
    return [
        post(2.75),
        box((-0.21, -0.055, 2.14), (0.21, -0.035, 2.70), "sign", BLUE),
        box((-0.04, -0.065, 2.21), (0.04, -0.055, 2.48), "sign"),
        prism([(-0.13, 2.46), (0.13, 2.46), (0.0, 2.63)], -0.065, -0.055, "sign"),
    ]


def belisha_beacon() -> Shapes:
    """Pole in black and white bands with an amber globe, beside a zebra on the British Isles."""
    band = 0.3
    return [
        cylinder((0, 0, BURIED), (0, 0, 2.7), 0.048, "plastic", DARK, sides=10),
        *(
            cylinder((0, 0, z), (0, 0, z + band), 0.052, "plastic", PALE, sides=10)
            for z in np.arange(0.3, 2.6, 2 * band).tolist()
        ),
        lathe([(0.0, 2.66), (0.11, 2.71), (0.16, 2.85), (0.11, 2.99), (0.0, 3.04)], "plastic",
              (1.0, 0.42, 0.03), sides=12),
    ]  # fmt: skip


def sign_crossing() -> Shapes:
    """Square blue sign of a pedestrian crossing."""
    return [
        post(2.7),
        box((-0.3, -0.055, 2.08), (0.3, -0.035, 2.68), "sign", BLUE),
        prism([(-0.24, 2.14), (0.24, 2.14), (0.0, 2.6)], -0.065, -0.055, "sign"),
        box((-0.035, -0.075, 2.2), (0.035, -0.065, 2.4), "sign", DARK),
        disc((0, -0.075, 2.46), 0.035, "sign", DARK, sides=8, thickness=0.01),
        box((-0.16, -0.07, 2.155), (0.16, -0.06, 2.185), "sign", DARK),
    ]


def sign_name() -> Shapes:
    """Street name on a post; the blade runs along x and is read from both sides."""
    return [
        post(2.9, 0.028),
        box((-0.03, -0.015, 2.58), (0.78, 0.015, 2.80), "sign", BLUE),
        box((0.04, -0.02, 2.655), (0.70, 0.02, 2.725), "sign", PALE),
    ]


def grating() -> Shapes:
    """Grating of a shaft, flush with the pavement."""
    parts: Shapes = [box((-0.75, -0.4, -0.05), (0.75, 0.4, 0.004), "metal_dark")]
    for y in (-0.4, 0.37):
        parts.append(box((-0.75, y, 0.0), (0.75, y + 0.03, 0.012), "metal_grey"))
    for x in np.linspace(-0.74, 0.71, 13):
        parts.append(box((x, -0.4, 0.0), (x + 0.03, 0.4, 0.012), "metal_grey"))
    return parts


def guard_rail_post() -> Shapes:
    """Post of a guard rail, a C of steel 0.76 m above the ground."""
    flanges = [box((-0.05, y, -0.4), (0.05, y + 0.01, 0.76), "metal_grey") for y in (-0.05, 0.04)]
    return [box((-0.05, -0.04, -0.4), (-0.04, 0.04, 0.76), "metal_grey"), *flanges]


def stone_bench() -> Shapes:
    """Block of stone to sit on, 2 m."""
    return [
        box((-1.0, -0.25, BURIED), (1.0, 0.25, 0.40), "stone", STONE),
        box((-1.03, -0.28, 0.40), (1.03, 0.28, 0.47), "bench_wood"),
    ]


def traffic_cone() -> Shapes:
    """Cone of 0.75 m on a square foot, with two bands that shine back."""
    orange: Color = (1.0, 0.16, 0.02)
    bands = ((0.30, 0.118, 0.40, 0.097), (0.50, 0.076, 0.60, 0.055))
    return [
        box((-0.2, -0.2, 0.0), (0.2, 0.2, 0.04), "plastic", DARK),
        cylinder((0.0, 0.0, 0.04), (0.0, 0.0, 0.75), 0.16, "plastic", orange, sides=12, top=0.025),
        *(
            cylinder((0, 0, low), (0, 0, high), wide, "sign", sides=12, top=narrow)
            for low, wide, high, narrow in bands
        ),
    ]  # fmt: skip


def work_barrier() -> Shapes:
    """Barrier of 2 m before road works: two striped boards on feet."""
    stripes = [
        box((x, -0.02, low), (x + 0.25, 0.02, low + 0.2), "plastic", RED if k % 2 else PALE)
        for low in (0.45, 0.9)
        for k, x in enumerate((-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75))
    ]
    feet = [
        part
        for x in (-0.85, 0.85)
        for part in (
            box((x - 0.03, -0.035, 0.0), (x + 0.03, -0.02, 1.1), "plastic", GREY),
            box((x - 0.1, -0.35, 0.0), (x + 0.1, 0.35, 0.08), "plastic", DARK),
        )
    ]
    return [*stripes, *feet]


STREET_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            planter, planter_round, cafe_set, parasol, shop_board, kiosk, bicycle, wheelie_bins,
            sign_no_entry, sign_one_way, belisha_beacon, sign_crossing, sign_name,
            grating, stone_bench, guard_rail_post, traffic_cone, work_barrier,
        )
    }
)  # fmt: skip
