"""Patterns of what grows and lies outdoors: roads, paving, vegetation, soil, water and bark."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cityx.assets.textures.noise import (
    Field,
    axes,
    blurred,
    cells,
    fractal,
    lattice,
    per_cell,
    sampled,
    smooth,
    speckle,
)
from cityx.assets.textures.relief import Courses, Relief, lay

SETT_TILE = 4.0  # metres of a tile of setts
SETT_COURSE = SETT_TILE / 26  # metres of one course
PLAZA_TILE, PLAZA_FIELD, PLAZA_BAND = 7.2, 3.6, 0.4  # metres of a tile of a square, of its fields
# with the bands about them, and of the bands
SAND, MOSS = (0.52, 0.46, 0.38), (0.20, 0.23, 0.12)  # what fills joints, linear RGB
# Colours of the plates of planes from the youngest to the oldest, and which cells of seven keep
# each of the older layers.
PLATES = ((1.0, 0.95, 0.76), (0.74, 0.72, 0.52), (0.52, 0.50, 0.38), (0.40, 0.36, 0.30))
KEPT = ((0, 2, 3, 5), (1, 4, 6), (0, 3))


def asphalt(size: int) -> Relief:
    """Draw asphalt in use: aggregate and clouds of wear; cracks would show that tiles repeat."""
    grain = speckle("asphalt", size)
    stones = smooth(0.62, 0.98, blurred(speckle("asphalt/stones", size), 1) * 1.9 - 0.45)
    bright = smooth(0.955, 0.985, speckle("asphalt/bright", size))
    clouds = fractal("asphalt/clouds", size, 3, octaves=5, gain=0.6)
    tone = 0.84 + 0.34 * (grain - 0.5) + 0.16 * stones + 0.55 * bright + 0.09 * clouds
    height = 0.0014 * (grain - 0.5) + 0.0022 * stones + 0.0015 * bright
    return Relief(4.0, tone, height, 0.97 + 0.05 * clouds, brightness=0.5)


def setts(size: int) -> Relief:
    """Draw granite setts of many quarries, 15 x 20 cm, crowned, with sandy joints.

    Courses of `SETT_COURSE` lie along v, one after the other along u: a view may push each along
    itself, so that no street shows that the tile repeats.
    """
    rough = 0.005 * fractal("setts/rough", size, 44, octaves=2)
    courses = round(SETT_TILE / SETT_COURSE)
    road = lay("setts", size, SETT_TILE, 20, courses, jitter=0.28,
               warp=(1.6 * rough, np.roll(rough, 61, 0)))  # fmt: skip
    laid = _granite("setts", road, size, SETT_TILE, crowned=0.042, joint=(0.004, 0.013))
    polish = np.asarray(laid.roughness)
    return replace(
        laid, albedo=laid.albedo.swapaxes(0, 1), height=laid.height.T, roughness=polish.T
    )


def gutter_stones(size: int) -> Relief:
    """Draw courses of long stones, 16 cm across: u runs along the kerb, v = 0 is at the kerb."""
    wander = 0.005 * fractal("gutter/wander", size, 14, octaves=2)
    row = lay("gutter", size, 2.56, 8, 16, jitter=0.22, warp=(wander, 0.5 * np.roll(wander, 61, 0)))
    return _granite("gutter", row, size, 2.56, crowned=0.025, joint=(0.004, 0.014), filled=MOSS)


def gutter_slabs(size: int) -> Relief:
    """Draw slabs of concrete, 60 x 40 cm, with mortared joints and a film of dirt."""
    row = lay("gutter_slabs", size, 2.4, 4, 6, bond=0.0)
    joint = 1 - smooth(0.003, 0.009, row.edge)
    grain = speckle("gutter_slabs", size) - np.float32(0.5)
    clouds = fractal("gutter_slabs/clouds", size, 7, octaves=5, gain=0.65)
    tone = 1 + 0.16 * (row.draw(1) - 0.5) + 0.10 * grain + 0.14 * clouds
    height = (row.draw(2) - 0.5) * 0.003 - 0.004 * joint + 0.0006 * grain
    return Relief(2.4, tone * (1 - 0.6 * joint), height, 1 + 0.04 * clouds, brightness=0.7)


def _granite(
    key: str, stones: Courses, size: int, tile: float, *, crowned: float,
    joint: tuple[float, float], filled: tuple[float, float, float] = SAND,
) -> Relief:  # fmt: skip
    """Blocks of granite, grey, bluish, reddish and yellow, each of its own, in filled joints."""
    grain = fractal(f"{key}/grain", size, round(55 * tile), octaves=2, gain=0.8)
    clouds = fractal(f"{key}/clouds", size, 5, octaves=4, gain=0.65)
    crown = smooth(0.001, crowned, stones.edge)
    gap = 1 - smooth(*joint, stones.edge)
    dark = smooth(0.88, 0.90, stones.draw(4))
    tone = 1 + 0.52 * (stones.draw(1) - 0.5) - 0.30 * dark + 0.10 * grain + 0.12 * clouds
    kind = stones.draw(2)
    # Most are grey; a tenth is red, a tenth yellow, a fifth blue.
    red, yellow = smooth(0.90, 0.91, kind), smooth(0.80, 0.81, kind) - smooth(0.90, 0.91, kind)
    blue = 1 - smooth(0.20, 0.21, kind)
    hue = np.stack([1 + 0.16 * red + 0.11 * yellow - 0.05 * blue,
                    1 - 0.03 * red + 0.04 * yellow - 0.01 * blue,
                    1 - 0.10 * red - 0.13 * yellow + 0.07 * blue], axis=2)  # fmt: skip
    sand = np.array(filled, np.float32) * (1 + 0.2 * grain)[..., None]
    albedo = (tone * (0.55 + 0.45 * crown))[..., None] * hue
    albedo = albedo * (1 - gap[..., None]) + sand * gap[..., None]
    lean = (stones.draw(3) - 0.5) * 0.05 * (stones.up - 0.05)
    height = 0.012 * crown + lean * crown + 0.0008 * grain
    polish = np.asarray(1 - 0.12 * crown * (1 - gap), dtype=np.float32)
    return Relief(tile, albedo, height, polish, brightness=0.6)


def paving(size: int) -> Relief:
    """Draw concrete slabs of 60 x 40 cm in half bond."""
    walk = lay("paving", size, 2.4, 4, 6, jitter=0.0)
    joint = 1 - smooth(0.003, 0.010, walk.edge)
    arris = 1 - smooth(0.004, 0.020, walk.edge)
    grain = speckle("paving", size) - np.float32(0.5)
    clouds = fractal("paving/clouds", size, 5, octaves=5, gain=0.65)
    gum = smooth(0.60, 0.66, _spots("paving/gum", size))
    tone = 1 + 0.27 * (walk.draw(1) - 0.5) + 0.13 * grain + 0.07 * clouds - 0.10 * arris
    hue = (walk.draw(2) - 0.5) * 0.07
    shade = tone * (1 - 0.65 * joint) * (1 - 0.16 * gum)
    albedo = shade[..., None] * np.stack([1 + hue, np.ones_like(hue), 1 - hue], axis=2)
    lean = (walk.draw(3) - 0.5) * 0.006 * (walk.across - 0.3)
    lean = lean + (walk.draw(4) - 0.5) * 0.006 * (walk.up - 0.2)
    height = lean - 0.005 * joint - 0.002 * arris + 0.0006 * grain
    return Relief(2.4, albedo, height, 1 - 0.1 * gum + 0.04 * clouds, brightness=0.66)


def plaza_slabs(size: int) -> Relief:
    """Draw fields of slabs between narrow bands of setts: the ground of squares."""
    walk = lay("plaza", size, PLAZA_TILE, 12, 18, jitter=0.0)
    u, v = axes(size)
    fields = np.float32(PLAZA_TILE / PLAZA_FIELD)
    off = np.maximum(*(np.abs(np.mod(w * fields, 1.0) - np.float32(0.5)) for w in (u, v)))
    band = off > 0.5 - PLAZA_BAND / 2 / PLAZA_FIELD
    setts = lay("plaza/band", size, PLAZA_TILE, 36, 36, jitter=0.2)
    clouds = fractal("plaza/clouds", size, 4, octaves=6, gain=0.7)
    grain = speckle("plaza", size) - np.float32(0.5)
    joint = 1 - smooth(0.004, 0.012, np.where(band, setts.edge, walk.edge))
    slab = 1.06 + 0.24 * (walk.draw(1) - 0.5) + 0.06 * clouds
    stone = 0.66 + 0.20 * (setts.draw(1) - 0.5)
    tone = (np.where(band, stone, slab) + 0.10 * grain) * (1 - 0.5 * joint)
    hue = np.where(band, -0.02, 0.07 * (walk.draw(2) - 0.4))
    albedo = tone[..., None] * np.stack([1 + hue, np.ones_like(hue), 1 - hue], axis=2)
    height = 0.0006 * grain - 0.005 * joint + np.where(band, 0.002 * setts.draw(3), 0.0)
    return Relief(PLAZA_TILE, albedo, height.astype(np.float32), 1 + 0.04 * clouds, brightness=0.66)


def _spots(key: str, size: int) -> Field:
    """Round spots, few and of several sizes: 1 at their middles."""
    near, _, index = cells(key, size, 12)
    reach = 0.02 + 0.10 * per_cell(key, index, 1)
    spot = np.clip(1 - near / (3 * reach), 0, 1)
    return np.where(per_cell(key, index, 2) > 0.7, spot, np.float32(0))


def grass(size: int) -> Relief:
    """Draw a mown lawn: blades in all directions, patches of moss and dry tips."""
    bend = 0.012 * fractal("grass/bend", size, 20, octaves=2)
    blades = np.maximum(
        sampled(fractal("grass/a", size, 190, 56, octaves=2, gain=0.8), bend, bend),
        sampled(fractal("grass/b", size, 64, 180, octaves=2, gain=0.8), -bend, bend),
    )
    tufts = fractal("grass/tufts", size, 34, octaves=3, gain=0.7)
    patches = fractal("grass/patches", size, 5, octaves=4, gain=0.6)
    dry = smooth(0.15, 1.1, fractal("grass/dry", size, 9, octaves=4, gain=0.7) + 0.25 * blades)
    fine = speckle("grass", size) - np.float32(0.5)
    tone = 0.80 + 0.30 * blades + 0.22 * tufts + 0.10 * patches + 0.22 * fine
    tone = np.maximum(tone, 0.18)
    warm = 0.10 * patches + 0.30 * dry
    albedo = tone[..., None] * np.stack([1 + 0.9 * warm, 1 + 0.15 * warm, 1 - 0.1 * warm], axis=2)
    height = 0.012 * blades + 0.020 * tufts
    return Relief(6.0, albedo, height, 1.0, brightness=0.5)


def soil(size: int) -> Relief:
    """Draw bare earth with clods and small stones."""
    clods = fractal("soil/clods", size, 22, octaves=5, gain=0.68)
    clouds = fractal("soil/clouds", size, 4, octaves=4, gain=0.6)
    near, far, index = cells("soil/stones", size, 52)
    there = smooth(0.86, 0.88, per_cell("soil/stones", index, 1))
    stone = there * smooth(0.10, 0.35, far - near)
    fine = speckle("soil", size) - np.float32(0.5)
    tone = 0.85 + 0.22 * clods + 0.10 * clouds + 0.18 * fine
    body = np.maximum(tone, 0.2) * (1 - stone) + stone * (0.9 + 0.7 * per_cell("soil", index, 2))
    hue = 0.06 * clouds * (1 - stone)
    albedo = body[..., None] * np.stack([1 + hue, np.ones_like(hue), 1 - hue], axis=2)
    height = 0.022 * clods + 0.014 * stone + 0.002 * fine
    return Relief(4.0, albedo, height, 1.0, brightness=0.55)


def furrows(size: int) -> Relief:
    """Draw a field in rows half a metre apart, running along u, with young crop on the ridges."""
    _, v = axes(size)
    wander = 0.006 * fractal("furrows/wander", size, 6, octaves=3)
    t = np.asarray(((v + wander) * 16) % 1, dtype=np.float32)
    ridge = np.minimum(1.4 * smooth(0.0, 0.5, t) * (1 - smooth(0.5, 1.0, t)), 1)
    clods = fractal("furrows/clods", size, 48, octaves=4, gain=0.7)
    plants = smooth(0.05, 0.6, fractal("furrows/plants", size, 70, octaves=3, gain=0.7))
    crop = plants * smooth(0.45, 0.9, ridge)
    clouds = fractal("furrows/clouds", size, 3, octaves=4, gain=0.6)
    earth = np.maximum(0.72 + 0.2 * clods + 0.14 * ridge + 0.08 * clouds, 0.2)
    green = np.array([0.75, 1.15, 0.55], np.float32)
    shade = crop[..., None]
    albedo = earth[..., None] * (1 - shade) + shade * green * (1 + 0.25 * clods)[..., None]
    height = 0.09 * ridge + 0.025 * clods + 0.04 * crop
    return Relief(8.0, np.maximum(albedo, 0.05), height, 1.0, brightness=0.6)


def ripples(size: int) -> Relief:
    """Draw wind ripples on water; the colour is even, the normals carry the picture."""
    count = 36
    wave = lattice("ripples", count, 4)
    u, v = axes(size)
    height = np.zeros((size, size), np.float64)
    for i in range(count):
        number = 3 + 30 * float(wave[0, i]) ** 1.6  # waves per tile
        lean = (float(wave[1, i]) - 0.5) * 1.9  # tangent of the angle to the wind
        norm = (1 + lean * lean) ** 0.5
        k = round(number / norm), round(number * lean / norm)
        phase = (u * k[0] + v * k[1] + float(wave[2, i])).astype(np.float64)
        t = phase - np.floor(phase)
        arch = 4 * t * (1 - t)  # crests a little sharper than a sine, as wind makes them
        height += (1 - arch * (0.6 + 0.4 * arch)) * (1.6 / number**1.25)
    even = np.ones((size, size), np.float32)
    return Relief(12.0, even, (0.06 * blurred(height.astype(np.float32), 1)), 1.0, brightness=1.0)


def bark(size: int) -> Relief:
    """Draw the ridged bark of a street tree: long interlacing ridges up the stem."""
    bend = 0.022 * fractal("bark/bend", size, 5, 3, octaves=4, gain=0.6)
    near, far, _ = cells("bark", size, 22, 4)
    ridge = smooth(0.0, 0.55, sampled(far - near, bend, np.roll(bend, 37, 1)))
    grain = fractal("bark/grain", size, 120, 22, octaves=3, gain=0.7)
    clouds = fractal("bark/clouds", size, 3, octaves=4)
    tone = (0.58 + 0.42 * ridge) * (1 + 0.16 * grain + 0.12 * clouds)
    lichen = smooth(0.5, 1.2, clouds + 0.5 * grain)
    albedo = np.maximum(tone, 0.1)[..., None] * np.stack(
        [np.ones_like(tone), 1 + 0.06 * lichen, 1 - 0.02 * lichen], axis=2
    )
    height = 0.011 * ridge + 0.003 * grain
    return Relief(1.0, albedo, height, 1.0, brightness=0.6)


def bark_smooth(size: int) -> Relief:
    """Draw the pale bark of birches and cherries: flakes in three tones, dark marks across."""
    bend = 0.05 * fractal("bark_smooth/bend", size, 5, octaves=3)
    near, far, _ = cells("bark_smooth", size, 5, 4)
    flake = smooth(0.02, 0.16, sampled(far - near, bend, np.roll(bend, 53, 0)))
    tone = fractal("bark_smooth/tone", size, 4, 3, octaves=3)
    marks = fractal("bark_smooth/marks", size, 6, 34, octaves=2)
    mark = smooth(0.55, 0.95, marks)
    grain = fractal("bark_smooth/grain", size, 60, 90, octaves=2)
    level = (0.78 + 0.10 * flake + 0.14 * tone + 0.04 * grain) * (1 - 0.72 * mark)
    warm = smooth(-0.4, 0.6, tone)
    albedo = np.maximum(level, 0.06)[..., None] * np.stack(
        [np.ones_like(level), 0.98 + 0.02 * warm, 0.90 + 0.10 * warm], axis=2
    )
    return Relief(1.0, albedo, 0.002 * flake - 0.004 * mark, 1.0, brightness=0.75)


def bark_flaking(size: int) -> Relief:
    """Draw the bark of planes: plates that came off one after the other, cream, olive and grey."""
    bend = 0.07 * fractal("bark_flaking/bend", size, 7, octaves=4)
    plates = np.array(PLATES, np.float32)
    albedo = np.broadcast_to(plates[0], (size, size, 3))
    height = np.zeros((size, size), np.float32)
    # Each layer leaves patches of the younger bark below it bare.
    for number, (wide, high) in enumerate(((5, 3), (9, 6), (14, 9)), start=1):
        near, _, index = cells(f"bark_flaking/{number}", size, wide, high, jitter=1.0)
        kept = np.isin(index % 7, KEPT[number - 1]).astype(np.float32)
        kept = sampled(kept * smooth(0.9, 0.75, near), bend, np.roll(bend, 31 * number, 0))
        edge = smooth(0.25, 0.6, kept)
        albedo = albedo + edge[..., None] * (plates[number] - albedo)
        height = height + 0.0012 * edge
    grain = fractal("bark_flaking/grain", size, 70, 60, octaves=3, gain=0.7)
    clouds = fractal("bark_flaking/clouds", size, 4, octaves=3)
    albedo = albedo * np.clip(1 + 0.10 * grain + 0.10 * clouds, 0.3, 1.6)[..., None]
    return Relief(1.0, albedo, height + 0.0006 * grain, 1.0, brightness=0.7)
