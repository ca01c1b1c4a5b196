"""Patterns of walls: plaster, masonry, boards, panels, curtain walls."""

from __future__ import annotations

import numpy as np

from cityx.assets.textures.courses import lay
from cityx.assets.textures.noise import (
    axes,
    fractal,
    smooth,
    speckle,
    value_noise,
)
from cityx.assets.textures.relief import Relief


def plaster(size: int) -> Relief:
    """Draw fine rendered plaster with faint clouds and runs of rain."""
    grain = fractal("plaster", size, 96, octaves=3, gain=0.7)
    clouds = fractal("plaster/clouds", size, 3, octaves=4, gain=0.6)
    runs = fractal("plaster/runs", size, 40, 3, octaves=2)
    albedo = 1 + 0.045 * clouds + 0.02 * runs + 0.025 * grain
    height = 0.0012 * grain + 0.004 * fractal("plaster/trowel", size, 9, octaves=3)
    return Relief(3.0, albedo, height, 1 + 0.03 * clouds, brightness=0.84)


def brick(size: int) -> Relief:
    """Draw running bond of 25 x 8.3 cm bricks, joints included, in lime mortar."""
    wander = 0.004 * fractal("brick/wander", size, 24, octaves=2)
    wall = lay("brick", size, 2.0, 8, 24, jitter=0.02, warp=(wander, 0.6 * np.roll(wander, 77, 1)))
    grain = fractal("brick/grain", size, 128, octaves=2, gain=0.8)
    face = smooth(0.0035, 0.0080, wall.edge)  # 1 on the brick, 0 in the joint
    # Most bricks are near the mean, some are burnt dark, a few pale.
    tone = 0.84 + 0.24 * (wall.draw(1) - 0.5) - 0.15 * smooth(0.84, 0.9, wall.draw(2))
    tone = tone * (1 + 0.10 * grain + 0.05 * fractal("brick/fire", size, 40, 80, octaves=2))
    mortar = 1.20 + 0.08 * grain
    hue = (wall.draw(3) - 0.5) * face
    albedo = (face * tone + (1 - face) * mortar)[..., None] * np.stack(
        [1 + 0.10 * hue, 1 - 0.04 * hue, 1 - 0.16 * hue], axis=2
    )
    lean = (wall.draw(4) - 0.5) * 0.0015
    height = face * (0.006 + lean + 0.0008 * grain) + (1 - face) * 0.0006 * grain
    return Relief(2.0, albedo, height, 0.97 - 0.05 * face, brightness=0.8)


def ashlar(size: int) -> Relief:
    """Draw dressed stone in courses of 45 cm, blocks of about 90 cm."""
    wall = lay("ashlar", size, 3.6, 4, 8, jitter=0.12)
    face = smooth(0.005, 0.014, wall.edge)
    grain = fractal("ashlar/grain", size, 80, octaves=3, gain=0.7)
    beds = fractal("ashlar/beds", size, 5, 36, octaves=3)
    clouds = fractal("ashlar/clouds", size, 4, octaves=4, gain=0.6)
    tone = 1 + 0.16 * (wall.draw(1) - 0.5) + 0.05 * beds + 0.05 * clouds + 0.035 * grain
    hue = (wall.draw(2) - 0.5) * 0.06
    arris = 1 - 0.10 * (1 - smooth(0.01, 0.05, wall.edge))
    albedo = (tone * arris * (0.55 + 0.45 * face))[..., None] * np.stack(
        [1 + hue, np.ones_like(hue), 1 - 1.6 * hue], axis=2
    )
    height = 0.010 * face + 0.004 * smooth(0.012, 0.05, wall.edge) + 0.0012 * grain
    return Relief(3.6, albedo, height, 1 - 0.06 * face, brightness=0.8)


def concrete(size: int) -> Relief:
    """Draw fair-faced concrete: clouds, pores, faint formwork joints twice a tile."""
    u, v = axes(size)
    clouds = fractal("concrete/clouds", size, 4, octaves=5, gain=0.6)
    grain = fractal("concrete/grain", size, 128, octaves=2, gain=0.8)
    runs = fractal("concrete/runs", size, 28, 2, octaves=3)
    panels = lay("concrete", size, 4.0, 2, 2, bond=0.0)
    joint = 1 - smooth(0.004, 0.014, panels.edge)
    pores = smooth(0.9965, 0.999, speckle("concrete", size))
    tone = 1 + 0.07 * clouds + 0.03 * runs + 0.035 * grain + 0.05 * (panels.draw(1) - 0.5)
    albedo = tone * (1 - 0.28 * joint) * (1 - 0.35 * pores)
    height = 0.0007 * grain - 0.004 * joint - 0.002 * pores + 0.0 * (u + v)
    return Relief(4.0, albedo, height, 1 + 0.04 * clouds, brightness=0.82)


def boards(size: int) -> Relief:
    """Draw lapped weatherboards, 15 cm each, grain along u."""
    wall = lay("boards", size, 2.4, 1, 16, bond=0.5, jitter=0.45)
    grain = fractal("boards/grain", size, 6, 150, octaves=3, gain=0.7)
    figure = fractal("boards/figure", size, 3, 40, octaves=3)
    lap = 0.15
    gap = 1 - smooth(0.002, 0.008, wall.edge)
    shadow = smooth(lap - 0.016, lap - 0.002, wall.up)  # below the board above
    tone = 1 + 0.20 * (wall.draw(1) - 0.5) + 0.09 * grain + 0.06 * figure
    albedo = tone * (1 - 0.45 * shadow) * (1 - 0.35 * gap)
    height = 0.016 * (1 - wall.up / lap) - 0.004 * gap + 0.0009 * grain
    return Relief(2.4, albedo, height, 1 + 0.05 * grain, brightness=0.78)


def panels(size: int) -> Relief:
    """Draw sheet metal cassettes of 1 x 2 m with open joints."""
    wall = lay("panels", size, 4.0, 2, 4, bond=0.0)
    joint = 1 - smooth(0.006, 0.018, wall.edge)
    bulge = fractal("panels/bulge", size, 5, octaves=2)
    dust = fractal("panels/dust", size, 30, 4, octaves=3)
    albedo = (1 + 0.06 * (wall.draw(1) - 0.5) + 0.02 * dust) * (1 - 0.75 * joint)
    lean = (wall.draw(2) - 0.5) * 0.010 * (wall.across - 1.0) + (wall.draw(3) - 0.5) * 0.010 * (
        wall.up - 0.5
    )
    height = (0.006 * bulge + lean) * (1 - joint) - 0.015 * joint
    return Relief(4.0, albedo, height, 0.8 + 0.2 * smooth(-1, 1, dust) + joint, brightness=0.86)


def curtain(size: int) -> Relief:
    """Draw a curtain wall of four storeys by twelve panes: mullions, spandrels, glass."""
    wall = lay("curtain", size, 14.0, 12, 4, bond=0.0)
    storey, pane = 3.5, 14.0 / 12
    mullion = 1 - smooth(0.030, 0.060, np.minimum(wall.across, pane - wall.across))
    rail = 1 - smooth(0.020, 0.055, np.abs(wall.up - 0.85))
    slab = 1 - smooth(0.020, 0.060, np.minimum(wall.up, storey - wall.up))
    frame = np.maximum(mullion, np.maximum(rail, slab))
    spandrel = (1 - smooth(0.84, 0.86, wall.up)).astype(np.float32)
    # Blinds are drawn to different heights behind some panes.
    drop = storey - 2.2 * np.clip(wall.draw(2) * 2.6 - 1.6, 0, 1)
    blind = smooth(0.0, 0.05, wall.up - drop) * (1 - spandrel)
    glass = 0.62 + 0.22 * (wall.draw(1) - 0.5) + 0.24 * blind + 0.2 * (wall.up / storey)
    glass = glass * (1 - spandrel) + spandrel * (0.80 + 0.05 * (wall.draw(5) - 0.5))
    albedo = glass * (1 - frame) + frame * 2.2
    lean = (wall.draw(3) - 0.5) * 0.012 * (wall.across - pane / 2)
    lean = lean + (wall.draw(4) - 0.5) * 0.006 * (wall.up - storey / 2)
    height = lean * (1 - frame) + 0.05 * frame
    roughness = 0.35 + 0.25 * spandrel + 0.6 * frame
    return Relief(14.0, albedo, height, roughness, brightness=0.38)


def paint(size: int) -> Relief:
    """Draw road paint: worn through on the crests of the stones below."""
    grain = speckle("paint", size)
    clouds = fractal("paint/clouds", size, 5, octaves=4, gain=0.65)
    worn = smooth(0.80, 0.98, grain + 0.16 * clouds)
    patches = smooth(0.2, 0.8, value_noise("paint/patches", size, 11))
    albedo = (1 + 0.03 * clouds) * (1 - worn * (0.30 + 0.25 * patches))
    height = 0.0012 * fractal("paint/stones", size, 128, octaves=2) - 0.001 * worn
    return Relief(2.0, albedo, height, 0.92 + 0.08 * worn, brightness=0.84)
