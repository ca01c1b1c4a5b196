"""Patterns of bark, ridged and smooth."""

from __future__ import annotations

import numpy as np

from cityx.assets.textures.noise import cells, fractal, sampled, smooth
from cityx.assets.textures.relief import Relief


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
    """Draw the pale bark of birches and planes: flakes in three tones, dark marks across."""
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
