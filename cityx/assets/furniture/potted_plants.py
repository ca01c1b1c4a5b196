"""Rows of potted plants before houses and shops: trees, conifers, ferns, flowers, bamboo, vines.

Each maker is named for a prototype and returns its shapes: z up, front -y (away from the wall),
origin on the ground at the foot. A row is some 1.5 m long and 0.4 m deep.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.furniture_parts import Shapes
from cityx.assets.shapes import Color, box, cards, cylinder, is_fine, lathe, moved, tube
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.ids import rng_for

TERRACOTTA: Color = (0.55, 0.22, 0.12)
GLAZE: Color = (0.10, 0.18, 0.26)
PALE: Color = (0.62, 0.60, 0.55)
BLACK: Color = (0.05, 0.05, 0.055)
NEEDLES: Color = (0.35, 0.55, 0.45)
FROND: Color = (0.75, 0.95, 0.6)
REED: Color = (0.95, 1.05, 0.6)
LEAF: Color = (0.75, 0.85, 0.7)
CANE: Color = (0.45, 0.42, 0.2)
PETALS: tuple[Color, ...] = (
    (0.80, 0.10, 0.32), (0.90, 0.52, 0.05), (0.85, 0.80, 0.84), (0.78, 0.06, 0.04),
    (0.22, 0.12, 0.75),
)  # fmt: skip
WALL_SIDE = 0.42  # of their reach, to the wall and from it, that fronds of a row take
ASIDE = 0.8  # metres that crowns reach from the middle of a row along its wall
AT_WALL = 0.16  # metres that crowns reach from the middle of a row toward its wall
FEWER = 0.18  # of the leaves, away from near views, which are larger there
LARGER = 1.6


def _blades(
    centre: FloatArray,
    along: FloatArray,
    slim: float,
    tint: Color,
    rng: np.random.Generator,
    material: str = "leaf",
) -> Shapes:
    """Leaves about places, (n, 3), of half lengths along, each with its own face and shade."""
    facing = rng.normal(size=centre.shape) + np.array([0.0, 0.0, 1.2])
    across = np.cross(along, facing)
    size = np.linalg.norm(along, axis=1) / np.maximum(np.linalg.norm(across, axis=1), 1e-6)
    shade = rng.uniform(0.65, 1.15, (len(centre), 1)) * tint
    return [cards(centre, along, across * (slim * size)[:, None], material, shade)]


def _count(fine: int) -> tuple[int, float]:
    return (fine, 1.0) if is_fine() else (max(8, int(FEWER * fine)), LARGER)


def pot(x: float, y: float, radius: float, high: float, color: Color) -> Shapes:
    """Return a pot with a rim, and its soil, about (x, y); metres."""
    rim = 1.1 * radius
    profile = [(0.72 * radius, 0.0), (radius, 0.86 * high), (rim, 0.86 * high), (rim, high),
               (0.9 * radius, high), (0.88 * radius, 0.92 * high)]  # fmt: skip
    pot = lathe(profile, "plastic", color, sides=9)
    soil = lathe([(0.9 * radius, 0.9 * high), (0.0, 0.92 * high)], "soil", sides=8)
    return [_at(part, x, y) for part in (pot, soil)]


def _at(part: MeshBatch, x: float, y: float) -> MeshBatch:
    return moved(part, (x, y, 0.0))


def _conifer(name: str, x: float, y: float, foot: float, high: float, wide: float) -> Shapes:
    """Clipped cone of needles on a short stem."""
    rng = rng_for(0, f"assets/{name}", 1)
    count, large = _count(190)
    t = 1.0 - np.sqrt(rng.uniform(0.0, 1.0, count))
    turn = rng.uniform(0, 2 * np.pi, count)
    out = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(count)])
    reach = wide * (1.0 - t) * rng.uniform(0.75, 1.05, count) + 0.01
    low = foot + 0.12 * high
    centre = out * reach[:, None] + [x, y, low] + np.outer(t * (foot + high - low), [0, 0, 1])
    along = 0.035 * large * (out + [0, 0, 1.3] + 0.3 * rng.normal(size=(count, 3)))
    core = lathe([(0.7 * wide, low), (0.02, foot + 0.9 * high)], "leaf", (0.22, 0.3, 0.22), sides=8)
    stem = cylinder((x, y, foot - 0.05), (x, y, low + 0.1), 0.018, "bark", sides=5)
    return [stem, _at(core, x, y), *_blades(centre, along, 0.3, NEEDLES, rng)]


def _fern(name: str, x: float, y: float, foot: float, reach: float) -> Shapes:
    """Fronds that rise and arch to all sides, leaflets along each."""
    rng = rng_for(0, f"assets/{name}", 1)
    fronds, large = _count(34)
    pairs = 7 if is_fine() else 4
    turn = 2 * np.pi * (np.arange(fronds) + rng.uniform(0, 0.7, fronds)) / fronds
    long = reach * rng.uniform(0.7, 1.1, fronds)
    s = (np.arange(pairs) + 1.0) / pairs
    out = np.stack([np.cos(turn), np.sin(turn)], axis=1)  # (f, 2)
    flat = long[:, None] * s * 0.9
    z = foot + long[:, None] * (1.25 * s - 0.85 * s**2) * rng.uniform(0.8, 1.3, (fronds, 1))
    out = out * [1.0, WALL_SIDE]
    spine = np.concatenate([flat[..., None] * out[:, None], z[..., None]], axis=2)
    spine = spine + np.array([x, y, 0.0])
    side = np.stack([-out[:, 1], out[:, 0], np.zeros(fronds)], axis=1)[:, None]
    parts: Shapes = []
    for hand in (-1.0, 1.0):
        blade = 0.30 * long[:, None] * (1.15 - s) * large * 0.5
        along = blade[..., None] * (hand * side + np.array([0.0, 0.0, 0.25]))
        along[..., 1] *= WALL_SIDE
        parts += _blades((spine + along).reshape(-1, 3), along.reshape(-1, 3), 0.32, FROND, rng)
    return parts


def flowers(name: str, low: Color, high: Color, petals: Color) -> Shapes:
    """Return low leaves in a box between two corners, metres, and blossom above them."""
    rng = rng_for(0, f"assets/{name}", 1)
    a, b = np.array(low), np.array(high)
    parts: Shapes = []
    for share, tint, size, slim, rise, material in (
        (200, LEAF, 0.032, 0.5, 0.75, "leaf"), (75, petals, 0.024, 0.95, 1.0, "cloth"),
    ):  # fmt: skip
        count, large = _count(share)
        unit = rng.uniform(-1, 1, (count, 3))
        unit /= np.maximum(np.linalg.norm(unit[:, :2], axis=1), 1.0)[:, None]
        top = 1.0 - 0.45 * np.linalg.norm(unit[:, :2], axis=1) ** 2
        height = rise * top * (0.5 + 0.5 * np.abs(unit[:, 2])) if rise < 1 else top
        centre = np.column_stack([(a + b)[:2] / 2 + unit[:, :2] * (b - a)[:2] / 2,
                                  a[2] + (b - a)[2] * height])  # fmt: skip
        along = size * large * _unit(rng.normal(size=(count, 3)) * [1, 1, 0.5])
        parts += _blades(centre, along, slim, tint, rng, material)
    return parts


def _bamboo(name: str, low: Color, high: Color, stems: int) -> Shapes:
    """Thin canes side by side, slender leaves that hang from their upper halves."""
    rng = rng_for(0, f"assets/{name}", 1)
    x = np.linspace(low[0], high[0], stems) + rng.uniform(-0.04, 0.04, stems)
    y = rng.uniform(low[1], high[1], stems)
    top = low[2] + (high[2] - low[2]) * rng.uniform(0.7, 1.0, stems)
    lean = rng.uniform(-0.07, 0.07, (stems, 2))
    parts: Shapes = [
        tube([[x[k], y[k], low[2] - 0.03], [x[k] + lean[k, 0], y[k] + lean[k, 1], top[k]]],
             [0.008, 0.004], "bench_wood", CANE, sides=4)
        for k in range(stems)
    ]  # fmt: skip
    count, large = _count(64 * stems)
    of = np.arange(count) % stems
    t = rng.uniform(0.35, 1.02, count)
    axis = np.column_stack([lean[of], (top - low[2])[of]])
    centre = np.column_stack([x, y, np.full(stems, low[2])])[of] + t[:, None] * axis
    turn = rng.uniform(0, 2 * np.pi, count)
    way = np.column_stack([np.cos(turn), np.sin(turn), rng.uniform(-0.9, 0.3, count)])
    along = 0.05 * large * _unit(way)
    centre = centre + along * rng.uniform(0.8, 1.8, (count, 1))
    return [*parts, *_blades(centre, along, 0.2, REED, rng)]


def _vine(name: str, x: float, y: float, foot: float, high: float, radius: float) -> Shapes:
    """Three canes with rings about them, a vine with blossom wound up along: morning glory."""
    rng = rng_for(0, f"assets/{name}", 1)
    parts: Shapes = []
    for k in range(3):
        angle = 2 * np.pi * k / 3
        at = (x + 0.8 * radius * np.cos(angle), y + 0.8 * radius * np.sin(angle))
        parts.append(cylinder((*at, foot - 0.05), (*at, foot + high), 0.006, "plastic", CANE,
                              sides=4))  # fmt: skip
    count, large = _count(460)
    for number, tint, size, slim, material in (
        (count, LEAF, 0.036, 0.85, "leaf"), (count // 14, PETALS[4], 0.03, 1.0, "cloth"),
    ):  # fmt: skip
        t = rng.uniform(0.0, 1.0, number)
        turn = 6 * np.pi * t + rng.normal(0, 1.1, number)
        out = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(number)])
        reach = radius * (1.05 - 0.25 * t) * rng.uniform(0.75, 1.2, number)
        centre = out * reach[:, None] + [x, y, foot] + np.outer(t * high, [0, 0, 1])
        along = size * large * _unit(out + [0, 0, -0.7] + 0.5 * rng.normal(size=(number, 3)))
        parts += _blades(centre, along, slim, tint, rng, material)
    return parts


def net_of_vines(name: str, half: float, y: float, low: float, high: float) -> Shapes:
    """Return a net between poles, of the given half width, and leaves that cover most of it."""
    rng = rng_for(0, f"assets/{name}", 1)
    parts: Shapes = [cylinder((x, y, low - 0.1), (x, y, high), 0.009, "plastic", CANE, sides=4)
                     for x in np.linspace(-half, half, 4)]  # fmt: skip
    parts.append(tube([[-half, y, high], [half, y, high]], 0.009, "plastic", CANE, sides=4))
    count, large = _count(900)
    x = rng.uniform(-half, half, count)
    # Vines climb unevenly: the rim of what they cover is a wave of several lengths.
    rim = 0.80 + 0.16 * np.sin(5.1 * x / half + 0.7) + 0.08 * np.sin(11.0 * x / half)
    z = low + (high - low) * np.minimum(rim, 1.02) * rng.uniform(0.0, 1.0, count) ** 0.85
    out = rng.uniform(-0.09, 0.03, count)
    centre = np.column_stack([x, y + out, z])
    along = 0.05 * large * _unit(rng.normal(size=(count, 3)) * [1, 0.35, 1] + [0, -0.2, -0.5])
    blossom = slice(0, count // 18)
    parts += _blades(centre, along, 0.8, (0.8, 0.95, 0.55), rng)
    petals = centre[blossom] + [0.0, -0.05, 0.03]
    return [*parts, *_blades(petals, 0.5 * along[blossom], 1.0, PETALS[1], rng, "cloth")]


def ivy(name: str, half: float, y: float, high: float) -> Shapes:
    """Return stems that fan out on a wall at y, and leaves that cover it with gaps; metres."""
    rng = rng_for(0, f"assets/{name}", 1)
    parts: Shapes = []
    ends = np.linspace(-0.8 * half, 0.8 * half, 7) + rng.uniform(-0.1, 0.1, 7)
    tops = high * rng.uniform(0.6, 0.97, 7)
    for end, top in zip(ends, tops, strict=True):
        knee = [0.45 * end + rng.uniform(-0.08, 0.08), y, 0.5 * top]
        stem = [[0.12 * end, y, -0.05], knee, [end, y, top]]
        parts.append(tube(stem, [0.014, 0.009, 0.003], "bark", sides=4))
    count, large = _count(1100)
    of = rng.integers(0, 7, count)
    t = rng.uniform(0.02, 1.0, count) ** 0.8
    spread = half * (0.10 + 0.16 * t) * rng.normal(size=count)
    x = np.clip(ends[of] * t**1.2 + spread, -half, half)
    z = tops[of] * t + 0.08 * rng.normal(size=count)
    centre = np.column_stack([x, y - rng.uniform(0.0, 0.08, count), np.maximum(z, 0.02)])
    along = 0.05 * large * _unit(rng.normal(size=(count, 3)) * [1, 0.25, 1] + [0, -0.15, -0.6])
    return [*parts, *_blades(centre, along, 0.8, (0.62, 0.80, 0.52), rng)]


def slim_tree(name: str, foot: float, high: float, tint: Color, reach: float) -> Shapes:
    """Return a young tree trained along its wall: no farther than `reach` from its stem, metres."""
    grown = small_tree(name, 0.0, 0.0, foot, high, tint)
    most = max(float(np.abs(part.vertices[:, 1]).max()) for part in grown)
    return [
        replace(part, vertices=part.vertices * [1.0, min(1.0, reach / most), 1.0]) for part in grown
    ]


def small_tree(name: str, x: float, y: float, foot: float, high: float, tint: Color) -> Shapes:
    """Return a young tree of three stems that part low, its crown flat to the wall; metres."""
    rng = rng_for(0, f"assets/{name}", 1)
    reach = 0.29 * high
    fork = np.array([x, y, foot + 0.12 * high])
    parts: Shapes = [cylinder((x, y, foot - 0.05), tuple(fork), 0.026, "bark", sides=6)]
    clumps, crowd = 15, 65
    turn = 2 * np.pi * (np.arange(clumps) + rng.uniform(0, 0.6, clumps)) * 0.381966
    level = (np.arange(clumps) + rng.uniform(0.2, 0.8, clumps)) / clumps
    wide = reach * np.sin(np.pi * (0.15 + 0.8 * level)) * rng.uniform(0.5, 1.0, clumps)
    out = np.column_stack([np.cos(turn), WALL_SIDE * np.sin(turn)]) * wide[:, None]
    heart = np.column_stack([x + out[:, 0], y + out[:, 1], foot + high * (0.4 + 0.55 * level)])
    for k in range(3):
        tip = heart[clumps - 1 - 2 * k]
        knee = 0.5 * (fork + tip) + [0.1 * (k - 1), 0.0, 0.0]
        parts.append(tube([fork, knee, tip], [0.019, 0.013, 0.005], "bark", sides=5))
    for centre in heart[: clumps - 5]:
        root = np.array([x, y, centre[2] - 0.12 * high])
        parts.append(tube([root, centre], [0.008, 0.003], "bark", sides=3))
    count, large = _count(clumps * crowd)
    way = _unit(rng.normal(size=(count, 3)))
    size = np.array([0.5 * reach, 0.22 * reach, 0.4 * reach]) * rng.uniform(0.3, 1.0, (count, 1))
    centre = heart[np.arange(count) % clumps] + way * size
    centre[:, 0] = np.clip(centre[:, 0], -ASIDE, ASIDE)
    centre[:, 1] = np.minimum(centre[:, 1], y + AT_WALL)
    along = 0.042 * large * _unit(way + [0, 0, -0.3] + 0.7 * rng.normal(size=(count, 3)))
    return [*parts, *_blades(centre, along, 0.55, tint, rng)]


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-6))


def trough(low: Color, high: Color, color: Color) -> Shapes:
    """Return a trough between two corners, metres, with its soil."""
    inner = 0.02
    return [
        box(low, high, "plastic", color),
        box((low[0] + inner, low[1] + inner, high[2]),
            (high[0] - inner, high[1] - inner, high[2] + 0.004), "soil"),
    ]  # fmt: skip


def pot_row() -> Shapes:
    """Flowers in pots of several sizes, a fern among them."""
    return [
        *pot(-0.58, 0.0, 0.15, 0.26, TERRACOTTA),
        *flowers("pot 0", (-0.76, -0.18, 0.24), (-0.40, 0.18, 0.52), PETALS[0]),
        *pot(-0.24, 0.0, 0.11, 0.19, GLAZE), *_fern("pot 1", -0.24, 0.0, 0.17, 0.24),
        *pot(0.08, 0.0, 0.17, 0.30, PALE),
        *flowers("pot 2", (-0.12, -0.2, 0.28), (0.28, 0.2, 0.62), PETALS[2]),
        *pot(0.40, 0.06, 0.10, 0.17, TERRACOTTA),
        *flowers("pot 3", (0.28, -0.06, 0.15), (0.52, 0.18, 0.34), PETALS[1]),
        *pot(0.64, 0.0, 0.12, 0.24, BLACK), *_conifer("pot 4", 0.64, 0.0, 0.22, 0.55, 0.12),
    ]  # fmt: skip


def pot_row_conifers() -> Shapes:
    """Three clipped conifers, and a low pot before them."""
    return [
        *pot(-0.5, 0.0, 0.17, 0.34, BLACK),
        *_conifer("cone 0", -0.5, 0.0, 0.32, 0.72, 0.17),
        *pot(0.0, 0.02, 0.15, 0.28, TERRACOTTA),
        *_conifer("cone 1", 0.0, 0.02, 0.26, 0.5, 0.16),
        *pot(0.5, 0.0, 0.17, 0.34, BLACK),
        *_conifer("cone 2", 0.5, 0.0, 0.32, 0.64, 0.18),
        *pot(0.25, -0.12, 0.08, 0.13, GLAZE),
        *flowers("cone 3", (0.16, -0.2, 0.11), (0.34, -0.03, 0.27), PETALS[3]),
    ]


def pot_row_ferns() -> Shapes:
    """Ferns of three sizes in glazed pots."""
    return [
        *pot(-0.48, 0.0, 0.18, 0.30, GLAZE),
        *_fern("fern 0", -0.48, 0.0, 0.27, 0.42),
        *pot(0.02, 0.04, 0.12, 0.22, TERRACOTTA),
        *_fern("fern 1", 0.02, 0.04, 0.2, 0.28),
        *pot(0.46, 0.0, 0.16, 0.36, PALE),
        *_fern("fern 2", 0.46, 0.0, 0.33, 0.38),
    ]


def pot_row_bamboo() -> Shapes:
    """Trough of bamboo, 1.1 m high, and a pot of flowers beside it."""
    return [
        *trough((-0.62, -0.13, 0.0), (0.32, 0.13, 0.26), BLACK),
        *_bamboo("bamboo", (-0.55, -0.07, 0.26), (0.25, 0.07, 1.12), 8),
        *pot(0.56, 0.0, 0.13, 0.24, TERRACOTTA),
        *flowers("bamboo pot", (0.4, -0.16, 0.22), (0.72, 0.16, 0.46), PETALS[1]),
    ]


def pot_row_vines() -> Shapes:
    """Two pots of morning glory on sticks, a trough of flowers between them."""
    return [
        *pot(-0.52, 0.0, 0.14, 0.22, GLAZE),
        *_vine("vine 0", -0.52, 0.0, 0.2, 0.8, 0.13),
        *trough((-0.3, -0.1, 0.0), (0.28, 0.1, 0.18), TERRACOTTA),
        *flowers("vine trough", (-0.32, -0.14, 0.18), (0.3, 0.14, 0.4), PETALS[0]),
        *pot(0.52, 0.0, 0.14, 0.22, GLAZE),
        *_vine("vine 1", 0.52, 0.0, 0.2, 0.68, 0.13),
    ]


def pot_row_maple() -> Shapes:
    """Maple of 2.1 m in a large glazed pot, a fern and flowers at its sides."""
    return [
        *pot(0.0, 0.0, 0.21, 0.42, GLAZE),
        *small_tree("maple", 0.0, 0.0, 0.39, 1.75, (0.95, 0.95, 0.5)),
        *pot(-0.52, 0.0, 0.14, 0.24, TERRACOTTA), *_fern("maple fern", -0.52, 0.0, 0.21, 0.28),
        *pot(0.46, -0.02, 0.12, 0.2, BLACK),
        *flowers("maple pot", (0.32, -0.18, 0.18), (0.6, 0.14, 0.42), PETALS[2]),
    ]  # fmt: skip


def pot_row_olive() -> Shapes:
    """Olive of 1.9 m and a smaller one in pale pots."""
    return [
        *pot(-0.34, 0.0, 0.2, 0.4, PALE),
        *small_tree("olive 0", -0.34, 0.0, 0.37, 1.55, (0.85, 0.92, 0.85)),
        *pot(0.42, 0.0, 0.16, 0.32, PALE),
        *small_tree("olive 1", 0.42, 0.0, 0.3, 1.05, (0.85, 0.92, 0.85)),
    ]


POT_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            pot_row, pot_row_conifers, pot_row_ferns, pot_row_bamboo, pot_row_vines, pot_row_maple,
            pot_row_olive,
        )
    }
)  # fmt: skip
POT_ROWS = tuple(POT_MAKERS)
