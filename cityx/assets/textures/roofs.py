"""Patterns of roofs; v runs up the slope."""

from __future__ import annotations

import numpy as np

from cityx.assets.textures.courses import lay
from cityx.assets.textures.noise import (
    axes,
    cells,
    fractal,
    per_cell,
    smooth,
    speckle,
    value_noise,
)
from cityx.assets.textures.relief import Relief


def roof_tiles(size: int) -> Relief:
    """Draw pantiles: 25 cm wide, 33 cm exposed, each lapping over the one below."""
    roof = lay("roof_tiles", size, 2.0, 8, 6, bond=0.0)
    width, exposed = 0.25, 2.0 / 6
    t = roof.across / np.float32(width)
    # A wide trough and a narrow roll, as polynomials so that no sine is needed.
    roll = smooth(0.62, 0.80, t) * (1 - smooth(0.80, 0.99, t))
    trough = -(1 - (2 * np.clip(t / 0.62, 0, 1) - 1) ** 2)
    nib = 1 - roof.up / np.float32(exposed)  # thick at the lower edge, thin under the next
    lap = 1 - smooth(0.0, 0.018, roof.up)  # shade just above the lower edge is the tile's own end
    under = smooth(exposed - 0.035, exposed - 0.004, roof.up)
    grain = fractal("roof_tiles/grain", size, 96, octaves=3, gain=0.7)
    lichen = smooth(0.45, 1.0, fractal("roof_tiles/lichen", size, 12, octaves=4, gain=0.7))
    tone = 1 + 0.26 * (roof.draw(1) - 0.5) - 0.16 * smooth(0.88, 0.92, roof.draw(2))
    tone = tone * (1 + 0.06 * grain + 0.10 * roll + 0.12 * trough) * (1 - 0.45 * under)
    tone = tone * (1 - 0.10 * lap)
    hue = (roof.draw(3) - 0.5) * 0.16
    albedo = tone[..., None] * np.stack([1 + hue, 1 - 0.3 * hue, 1 - hue], axis=2)
    grey = np.array([0.95, 1.0, 0.9], np.float32)
    albedo = albedo * (1 - 0.35 * lichen[..., None]) + 0.30 * lichen[..., None] * grey
    height = 0.030 * roll + 0.012 * trough + 0.020 * nib + 0.0008 * grain
    return Relief(2.0, albedo, height, 0.95 + 0.05 * grain, brightness=0.74)


def slate(size: int) -> Relief:
    """Draw slates 25 cm wide, 20 cm exposed, in half bond."""
    roof = lay("slate", size, 2.0, 8, 10, jitter=0.08)
    exposed = 0.2
    split = fractal("slate/split", size, 40, 60, octaves=3, gain=0.65)
    gap = 1 - smooth(0.002, 0.007, np.minimum(roof.edge, roof.across))
    under = smooth(exposed - 0.022, exposed - 0.002, roof.up)
    tone = 1 + 0.34 * (roof.draw(1) - 0.5) + 0.09 * split
    hue = (roof.draw(2) - 0.5) * 0.14
    shade = tone * (1 - 0.5 * under) * (1 - 0.35 * gap)
    albedo = shade[..., None] * np.stack([1 + hue, np.ones_like(hue), 1 - hue], axis=2)
    lean = (roof.draw(3) - 0.5) * 0.012 * (roof.across - 0.125)
    height = 0.008 * (1 - roof.up / exposed) + lean + 0.0010 * split - 0.002 * gap
    roughness = 0.85 + 0.3 * (roof.draw(4) - 0.5) + 0.05 * split
    return Relief(2.0, albedo, height, roughness, brightness=0.74)


def seams(size: int) -> Relief:
    """Draw sheet metal with standing seams every 60 cm, running up the slope."""
    u, _ = axes(size)
    count, width = 4, 0.6
    along = np.broadcast_to((u * count) % 1, (size, size)) * np.float32(width)
    near = np.minimum(along, width - along)
    seam = 1 - smooth(0.008, 0.020, near)
    foot = 1 - smooth(0.012, 0.07, near)
    sheet = lay("seams", size, 2.4, 4, 2, bond=0.0)
    tone = 1 + 0.07 * (sheet.draw(1) - 0.5)
    runs = fractal("seams/runs", size, 48, 3, octaves=3)
    clouds = fractal("seams/clouds", size, 5, octaves=4, gain=0.6)
    albedo = tone * (1 + 0.035 * runs + 0.05 * clouds) * (1 - 0.18 * foot + 0.16 * seam)
    height = 0.028 * seam + 0.004 * fractal("seams/dents", size, 8, octaves=2)
    return Relief(2.4, albedo, height, 0.9 + 0.12 * clouds, brightness=0.82)


def felt(size: int) -> Relief:
    """Draw bitumen felt: rolls a metre wide, lapped, with the stains of dried puddles."""
    roof = lay("felt", size, 4.0, 1, 4, bond=0.5)
    grain = speckle("felt", size) - np.float32(0.5)
    lap = 1 - smooth(0.004, 0.020, roof.up)
    band = 1 - smooth(0.08, 0.10, roof.up)  # bare strip of the lap
    end = 1 - smooth(0.004, 0.020, np.minimum(roof.across, 4.0 - roof.across))
    level = fractal("felt/level", size, 3, octaves=5, gain=0.55)
    puddle = smooth(0.05, 0.45, level)
    tone = 1 + 0.12 * (roof.draw(1) - 0.5) + 0.16 * grain + 0.06 * level + 0.05 * puddle
    albedo = tone * (1 - 0.12 * band) * (1 - 0.35 * np.maximum(lap, end))
    height = 0.004 * band + 0.0008 * grain + 0.006 * level
    return Relief(4.0, albedo, height, 1 - 0.05 * puddle, brightness=0.78)


def gravel(size: int) -> Relief:
    """Draw loose stones of 2 to 5 cm."""
    near, far, index = cells("gravel", size, 44)
    near2, far2, index2 = cells("gravel/small", size, 84)
    big = smooth(0.25, 0.45, per_cell("gravel", index, 1))  # cells filled by small stones instead
    round_big = smooth(0.0, 0.5, far - near)
    round_small = smooth(0.0, 0.5, far2 - near2)
    dome = big * round_big + (1 - big) * 0.55 * round_small
    shade = big * (0.5 + 0.5 * round_big) + (1 - big) * (0.5 + 0.5 * round_small)
    tone = big * per_cell("gravel", index, 2) + (1 - big) * per_cell("gravel/small", index2, 2)
    hue = 0.14 * (big * per_cell("gravel", index, 3) + (1 - big) * 0.5 - 0.5)
    grain = fractal("gravel/grain", size, 160, octaves=1)
    body = shade * (0.72 + 0.56 * tone) * (1 + 0.12 * grain)
    albedo = body[..., None] * np.stack([1 + hue, np.ones_like(hue), 1 - hue], axis=2)
    return Relief(2.0, albedo, 0.018 * dome, 0.94 + 0.06 * tone, brightness=0.55)


def thatch(size: int) -> Relief:
    """Draw reed laid up the slope."""
    strands = fractal("thatch/strands", size, 160, 9, octaves=2, gain=0.8)
    tufts = fractal("thatch/tufts", size, 26, 7, octaves=3, gain=0.6)
    ends = value_noise("thatch/ends", size, 128, 40)
    clouds = fractal("thatch/clouds", size, 4, octaves=3)
    hue = 0.18 * (value_noise("thatch/hue", size, 40, 6) - 0.5)
    tone = 0.8 + 0.34 * strands + 0.20 * tufts + 0.35 * (ends - 0.5) + 0.08 * clouds
    tone = np.maximum(tone, 0.12)
    albedo = tone[..., None] * np.stack([1 + hue, np.ones_like(hue), 1 - 1.5 * hue], axis=2)
    height = 0.010 * strands + 0.022 * tufts
    return Relief(2.0, albedo, height, 1.0, brightness=0.6)
