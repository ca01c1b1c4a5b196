"""Patterns of pavements and carriageways: flags, slabs, blocks and ribs, worn, stone and brick.

Those with bands are drawn for v = 0 at the kerb (`cityx.road.ground.joints` lays them so).
"""

from __future__ import annotations

import numpy as np

from cityx.assets.textures.grounds import asphalt
from cityx.assets.textures.noise import (
    Field,
    axes,
    cells,
    fractal,
    per_cell,
    sampled,
    smooth,
    speckle,
    value_noise,
)
from cityx.assets.textures.relief import Relief, lay

BAND_TILE = 5.12  # metres of walk, from its kerb, after which the bands begin anew
SLABS = (0.92, 2.92)  # metres from the kerb between which the slabs lie
RAISED_TILE = 1.2  # metres of slabs with domes or ribs
GUIDE_TILE = 6.0  # metres, as wide as walks with a line of ribs are
GUIDE = (0.96, 1.26)  # metres from the kerb of the line of ribs
UNITS = 20  # half bricks along a tile of two metres; a multiple of four, the herringbone's period


def _spots(key: str, size: int, count: int, share: float) -> Field:
    """Round spots of gum and oil, 1 at their middles."""
    near, _, index = cells(key, size, count)
    reach = 0.04 + 0.16 * per_cell(key, index, 1)
    there = per_cell(key, index, 2) < share
    return np.where(there, smooth(1.0, 0.5, near / reach), np.float32(0))


def _toned(tone: Field, hue: Field) -> Field:
    """Grey of a tone, warmer where `hue` is above 0."""
    color = np.stack([1 + hue, 1 + 0.25 * hue, 1 - hue], axis=2)
    return np.asarray(tone[..., None] * color, np.float32)


def flagstones(size: int) -> Relief:
    """Draw flags of sandstone 60 cm deep and of many lengths, worn, patched and stained."""
    wander = 0.006 * fractal("flags/wander", size, 9, octaves=2)
    walk = lay("flags", size, 4.8, 6, 8, jitter=0.30, warp=(wander, np.roll(wander, 77, 1)))
    joint = 1 - smooth(0.006, 0.016, walk.edge)
    arris = 1 - smooth(0.006, 0.045, walk.edge)
    grain = speckle("flags", size) - np.float32(0.5)
    bed = fractal("flags/bed", size, 40, octaves=4, gain=0.7)  # of the stone
    clouds = fractal("flags/clouds", size, 4, octaves=5, gain=0.65)
    fresh = smooth(0.90, 0.92, walk.draw(5))  # flags that were renewed
    dark = 1 - smooth(0.09, 0.10, walk.draw(5))  # and others that keep wet and dirt
    tone = 1 + 0.34 * (walk.draw(1) - 0.5) + 0.07 * grain + 0.06 * bed + 0.09 * clouds
    tone = (tone + 0.20 * fresh - 0.24 * dark) * (1 - 0.10 * arris) * (1 - 0.55 * joint)
    tone = tone * (1 - 0.20 * _spots("flags/gum", size, 22, 0.35))
    hue = 0.13 * (walk.draw(2) - 0.25) - 0.05 * fresh + 0.03 * clouds
    lean = (walk.draw(3) - 0.5) * 0.008 * (walk.across - 0.4)
    height = lean - 0.006 * joint - 0.002 * arris + 0.0012 * bed + 0.0004 * grain
    return Relief(4.8, _toned(tone, hue), height, 1 + 0.05 * clouds, brightness=0.62)


def _mosaic(size: int, tile: float) -> tuple[Field, Field, Field]:
    """Small stones of 5 to 6 cm: tone, warmth and height."""
    near, far, index = cells("mosaic", size, round(tile / 0.064), jitter=0.55)
    face = smooth(0.05, 0.22, far - near)
    pale = smooth(0.86, 0.87, per_cell("mosaic", index, 3))
    tone = (0.70 + 0.46 * per_cell("mosaic", index, 1) + 0.25 * pale) * face + 0.62 * (1 - face)
    hue = 0.16 * (per_cell("mosaic", index, 2) - 0.5) * face + 0.10 * (1 - face)
    return tone, hue, np.asarray(0.006 * face, np.float32)


def mosaic(size: int) -> Relief:
    """Draw a pavement of small stones, as they lie along houses and between slabs and kerb."""
    tone, hue, height = _mosaic(size, 2.56)
    clouds = fractal("mosaic/clouds", size, 3, octaves=4, gain=0.6)
    return Relief(2.56, _toned(tone * (1 + 0.10 * clouds), hue), height, 1.0, brightness=0.6)


def slab_walk(size: int) -> Relief:
    """Draw two courses of granite slabs between bands of small stones, the first at the kerb."""
    _, v = axes(size)
    off = np.broadcast_to(v * np.float32(BAND_TILE), (size, size))
    small, small_hue, small_height = _mosaic(size, BAND_TILE)
    # Slabs lie turned by 45 degrees: lozenges of 0.73 m that triangles complete at both rims.
    u, w = axes(size)
    count = 5  # lozenges across two tiles; both diagonals close after a whole number of them
    x = np.broadcast_to((u + w) * np.float32(count), (size, size))
    y = np.broadcast_to((u - w) * np.float32(count), (size, size))
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    metres = np.float32(BAND_TILE / count / 2**0.5)
    across, up = (x - i) * metres, (y - j) * metres
    edge = np.minimum(np.minimum(across, metres - across), np.minimum(up, metres - up))
    low, high = SLABS
    edge = np.minimum(edge, np.minimum(np.abs(off - low), np.abs(off - high)))
    # One slab is the same modulo the tile along both axes.
    index = ((i + j) % (2 * count)) * 2 * count + (i - j) % (2 * count)
    joint = 1 - smooth(0.004, 0.013, edge.astype(np.float32))
    grain = speckle("slab_walk", size) - np.float32(0.5)
    clouds = fractal("slab_walk/clouds", size, 4, octaves=5, gain=0.65)
    tone = 1.12 + 0.38 * (per_cell("slab_walk", index, 1) - 0.5) + 0.16 * grain + 0.07 * clouds
    tone = tone * (1 - 0.55 * joint) * (1 - 0.18 * _spots("slab_walk/gum", size, 24, 0.35))
    hue = 0.08 * (per_cell("slab_walk", index, 2) - 0.4)
    slab = (off > low) & (off < high)
    shade = np.where(slab, tone, 0.74 * small * (1 + 0.10 * clouds))
    warm = np.where(slab, hue, small_hue)
    height = np.where(slab, 0.006 - 0.005 * joint + 0.0005 * grain, small_height)
    return Relief(BAND_TILE, _toned(shade, warm), height, 1 + 0.04 * clouds, brightness=0.6)


def _blocks(size: int, tile: float) -> tuple[Field, Field, Field]:
    """Concrete blocks of 10 x 20 cm: tone, warmth and height."""
    walk = lay("blocks", size, tile, round(tile / 0.2), round(tile / 0.1), jitter=0.0)
    joint = 1 - smooth(0.002, 0.009, walk.edge)
    grain = speckle("blocks", size) - np.float32(0.5)
    clouds = fractal("blocks/clouds", size, 4, octaves=5, gain=0.6)
    kind = walk.draw(1)
    dark = smooth(0.72, 0.73, kind)  # a third colour in four
    tone = 1 + 0.16 * (walk.draw(2) - 0.5) - 0.20 * dark + 0.10 * grain + 0.08 * clouds
    tone = tone * (1 - 0.45 * joint) * (1 - 0.15 * _spots("blocks/gum", size, 20, 0.25))
    hue = 0.11 * (walk.draw(3) - 0.4) + 0.05 * dark
    return tone, hue, np.asarray(-0.004 * joint + 0.0004 * grain, np.float32)


def walk_blocks(size: int) -> Relief:
    """Draw small blocks of concrete in half bond, of three tones."""
    tone, hue, height = _blocks(size, 3.0)
    return Relief(3.0, _toned(tone, hue), height, 1.0, brightness=0.66)


def guided_blocks(size: int) -> Relief:
    """Draw the same blocks with a line of ribbed yellow tiles along the kerb, for blind people."""
    tone, hue, height = _blocks(size, GUIDE_TILE)
    u, v = axes(size)
    off = np.broadcast_to(v * np.float32(GUIDE_TILE), (size, size))
    run = np.broadcast_to(u * np.float32(GUIDE_TILE / 0.3), (size, size)) % 1
    low, high = GUIDE
    line = (off > low) & (off < high)
    rib = np.cos((off - low) * np.float32(2 * np.pi * 4 / (high - low)))
    joint = smooth(0.03, 0.0, np.minimum(run, 1 - run))
    worn = value_noise("guide/worn", size, 40)
    yellow = np.array([1.75, 1.22, 0.14], np.float32) * (0.82 + 0.25 * worn)[..., None]
    yellow = yellow * (1 - 0.35 * joint)[..., None] * (1 - 0.10 * (rib > 0.2))[..., None]
    albedo = np.where(line[..., None], yellow, _toned(tone, hue))
    height = np.where(line, 0.004 * np.clip(-rib, 0, 1), height)
    return Relief(GUIDE_TILE, albedo, height, 1.0, brightness=0.62)


def _raised(key: str, size: int, slabs: int, top: Field) -> Relief:
    """Slabs with what rises from them, `top` from 0 to 1, worn on its crown."""
    u, v = axes(size)
    x = np.broadcast_to(u * np.float32(slabs), (size, size))
    y = np.broadcast_to(v * np.float32(slabs), (size, size))
    index = np.floor(x).astype(np.int64) + slabs * np.floor(y).astype(np.int64)
    metres = np.float32(RAISED_TILE / slabs)
    edge = np.minimum(np.minimum(x % 1, 1 - x % 1), np.minimum(y % 1, 1 - y % 1)) * metres
    joint = 1 - smooth(0.002, 0.008, edge.astype(np.float32))
    grain = speckle(key, size) - np.float32(0.5)
    worn = value_noise(f"{key}/worn", size, 8)
    tone = 1 + 0.24 * (per_cell(key, index, 1) - 0.5) + 0.10 * grain + 0.20 * (worn - 0.5)
    tone = tone * (1 + 0.10 * top) * (1 - 0.16 * (top > 0.02) * (top < 0.5)) * (1 - 0.45 * joint)
    height = 0.005 * top - 0.004 * joint + 0.0003 * grain
    return Relief(RAISED_TILE, _toned(tone, 0 * tone), np.asarray(height, np.float32), 1.0,
                  brightness=0.66)  # fmt: skip


def _domes(size: int, count: int, radius: float) -> Field:
    """Flat domes in a square grid, `count` along a tile, of a radius in metres."""
    u, v = axes(size)
    pitch = RAISED_TILE / count
    x, y = (((axis * np.float32(count)) % 1 - 0.5) * np.float32(pitch) for axis in (u, v))
    return smooth(radius, 0.6 * radius, np.hypot(x, y).astype(np.float32))


def domes(size: int) -> Relief:
    """Draw tiles of 30 cm with five rows of five domes, which warn blind people (JIS T 9251)."""
    return _raised("domes", size, 4, _domes(size, 20, 0.0115))


def blisters(size: int) -> Relief:
    """Draw slabs of 40 cm with six rows of six flat blisters, as before British crossings."""
    return _raised("blisters", size, 3, _domes(size, 18, 0.0125))


def ribbed_slabs(size: int) -> Relief:
    """Draw slabs of 30 cm with ribs across the kerb, which point the way (DIN 32984)."""
    u, _ = axes(size)
    rib = np.broadcast_to(np.cos(u * np.float32(2 * np.pi * 32)), (size, size))
    return _raised("ribbed", size, 4, smooth(-0.2, 0.7, rib))


def asphalt_worn(size: int) -> Relief:
    """Draw asphalt at the end of its life: crazed, cracked, patched, its aggregate laid bare."""
    new = asphalt(size)
    bend = 0.010 * fractal("worn/bend", size, 24, octaves=3)
    near, far, _ = cells("worn/craze", size, 22, jitter=1.0)
    craze = 1 - smooth(0.02, 0.10, sampled(far - near, bend, np.roll(bend, 77, 0)))
    craze = craze * smooth(0.50, 0.68, value_noise("worn/where", size, 5))
    near, far, index = cells("worn/patches", size, 4, jitter=0.6)
    patch = smooth(0.80, 0.81, per_cell("worn/patches", index)) * smooth(0.0, 0.02, far - near)
    seam = smooth(0.80, 0.81, per_cell("worn/patches", index)) * (1 - smooth(0.0, 0.03, far - near))
    clouds = fractal("worn/clouds", size, 6, octaves=4, gain=0.7)
    tone = np.asarray(new.albedo) * (1 + 0.16 * clouds) * (1 - 0.30 * patch)
    albedo = np.maximum(tone * (1 - 0.55 * craze) * (1 - 0.6 * seam), 0.05)
    height = np.asarray(new.height) * (1 - 0.5 * patch) - 0.006 * craze - 0.003 * seam
    return Relief(4.0, albedo, height, 1.0 - 0.05 * patch, brightness=0.5)


def cobbles(size: int) -> Relief:
    """Draw round field stones of 10 to 16 cm in sand."""
    near, far, index = cells("cobbles", size, 16, jitter=0.75)
    dome = smooth(0.0, 0.55, far - near)
    joint = 1 - smooth(0.05, 0.16, far - near)
    grain = fractal("cobbles/grain", size, 120, octaves=2, gain=0.8)
    tone = (0.72 + 0.56 * per_cell("cobbles", index, 1)) * (0.55 + 0.45 * dome) * (1 + 0.08 * grain)
    hue = (per_cell("cobbles", index, 2) - 0.5) * 0.22 * (1 - joint)
    sand = 0.50 * (1 + 0.2 * grain)
    body = tone * (1 - joint) + sand * joint
    albedo = body[..., None] * np.stack([1 + hue, np.ones_like(hue), 1 - hue], axis=2)
    height = 0.035 * dome + 0.0015 * grain
    polish = np.asarray(1 - 0.15 * dome * (1 - joint), np.float32)
    return Relief(2.0, albedo, height, polish, brightness=0.6)


def clinker(size: int) -> Relief:
    """Draw paving bricks of 20 x 10 cm in herringbone, with sanded joints."""
    u, v = axes(size)
    x = np.broadcast_to(u * UNITS, (size, size))
    y = np.broadcast_to(v * UNITS, (size, size))
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    # Two half bricks that lie side by side, then two that stand on each other, step by step.
    turn = (i - j) % 4
    flat = turn < 2
    i0 = np.where(flat, i - turn, i)
    j0 = np.where(turn == 2, j - 1, j)
    across, up = x - i0, y - j0
    wide, high = np.where(flat, 2.0, 1.0), np.where(flat, 1.0, 2.0)
    metres = np.float32(2.0 / UNITS)
    edge = np.minimum(np.minimum(across, wide - across), np.minimum(up, high - up)) * metres
    index = ((j0 % UNITS) * UNITS + i0 % UNITS) * 2 + flat
    grain = fractal("clinker/grain", size, 120, octaves=2, gain=0.8)
    face = smooth(0.0015, 0.006, edge.astype(np.float32))
    tone = 0.86 + 0.28 * (per_cell("clinker", index, 1) - 0.5) + 0.07 * grain
    tone = tone - 0.14 * smooth(0.85, 0.9, per_cell("clinker", index, 2))
    hue = (per_cell("clinker", index, 3) - 0.5) * 0.14 * face
    body = tone * face + 0.62 * (1 - face)
    albedo = body[..., None] * np.stack([1 + hue, np.ones_like(hue), 1 - hue], axis=2)
    height = 0.005 * face + 0.0015 * (per_cell("clinker", index, 4) - 0.5) * face + 0.0005 * grain
    return Relief(2.0, albedo, height, 1 - 0.08 * face, brightness=0.7)


def road_slabs(size: int) -> Relief:
    """Draw concrete slabs of 4 m with sealed joints, brushed and stained by traffic."""
    slabs = lay("road_slabs", size, 8.0, 2, 2, bond=0.0)
    joint = 1 - smooth(0.006, 0.020, slabs.edge)
    brush = fractal("road_slabs/brush", size, 6, 160, octaves=2, gain=0.8)
    grain = speckle("road_slabs", size) - np.float32(0.5)
    clouds = fractal("road_slabs/clouds", size, 5, octaves=5, gain=0.65)
    bend = 0.012 * fractal("road_slabs/bend", size, 12, octaves=3)
    near, far, _ = cells("road_slabs/cracks", size, 4, jitter=1.0)
    crack = 1 - smooth(0.003, 0.012, sampled(far - near, bend, np.roll(bend, 61, 0)))
    crack = crack * smooth(0.58, 0.75, value_noise("road_slabs/where", size, 3))
    tone = 1 + 0.10 * (slabs.draw(1) - 0.5) + 0.05 * brush + 0.10 * grain + 0.09 * clouds
    albedo = tone * (1 - 0.75 * joint) * (1 - 0.45 * crack)
    height = 0.0012 * brush + 0.0006 * grain - 0.006 * joint - 0.004 * crack
    return Relief(8.0, albedo, height, 1 + 0.03 * clouds, brightness=0.8)
