"""Patterns of buildings: walls of plaster, masonry, boards and panels, and roofs."""

from __future__ import annotations

import numpy as np

from cityx.assets.textures.noise import axes, cells, fractal, per_cell, smooth, speckle, value_noise
from cityx.assets.textures.relief import Relief, lay


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
