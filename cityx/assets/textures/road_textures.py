"""Patterns of carriageways besides plain asphalt and setts: worn, of stone, brick or slabs."""

from __future__ import annotations

import numpy as np

from cityx.assets.textures.courses import lay
from cityx.assets.textures.grounds import asphalt
from cityx.assets.textures.noise import (
    axes,
    cells,
    fractal,
    per_cell,
    sampled,
    smooth,
    speckle,
    value_noise,
)
from cityx.assets.textures.relief import Relief

UNITS = 20  # half bricks along a tile of two metres; a multiple of four, the herringbone's period


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
