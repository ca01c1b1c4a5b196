"""Patterns of bark: ridged, smooth and flaking."""

from __future__ import annotations

import numpy as np

from cityx.assets.textures.noise import cells, fractal, sampled, smooth
from cityx.assets.textures.relief import Relief

# Colours of the plates of planes from the youngest to the oldest, and which cells of seven keep
# each of the older layers.
PLATES = ((1.0, 0.95, 0.76), (0.74, 0.72, 0.52), (0.52, 0.50, 0.38), (0.40, 0.36, 0.30))
KEPT = ((0, 2, 3, 5), (1, 4, 6), (0, 3))


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
