"""Streets of setts: courses shifted along themselves, uneven work, relaid patches.

The texture is one tile; what is drawn here over the scene hides that it repeats.
"""

from __future__ import annotations

from cityx.assets.textures.grounds import SETT_COURSE, SETT_TILE
from cityx.blender import nodes
from cityx.blender.nodes import Socket, Tree

STRAY, STRAY_SIZE = 0.11, 1.7  # metres by which courses stray, and between their bends
PLOT = (18 * SETT_COURSE, 2.6)  # metres along and across the street in which one patch may lie
PATCHED = 0.86  # of the draws of plots, above which one was dug up
SMALLER = 1.28  # times as many stones lie in a patch, from another delivery
PATCH_TONE = 0.5  # range of the brightness of patches
BLOTCH, BLOTCH_TONE = 1.3, (0.82, 1.18)  # metres between paler and darker spots, and their tones
LOAD = 5.5  # metres between loads of warm and of cold stone
COLD, WARM = (0.94, 0.99, 1.07, 1.0), (1.07, 1.0, 0.90, 1.0)


def laid_setts(tree: Tree, uv: Socket) -> tuple[Socket, Socket]:
    """Return where setts are read from their texture, and the colour that they are tinted with.

    Parameters
    ----------
    tree
        Node tree of the material.
    uv
        Metres along and across the street.
    """
    push = tree.nodes.new("ShaderNodeTexNoise")
    push.inputs["Scale"].default_value = 1 / STRAY_SIZE
    push.inputs["Detail"].default_value = 3.0
    tree.links.new(uv, push.inputs["Vector"])
    centred = nodes.vector(tree, "SUBTRACT", push.outputs["Color"], (0.5, 0.5, 0.5))
    bent = nodes.vector(tree, "MULTIPLY_ADD", centred, (STRAY, STRAY, 0.0), uv)
    along, across, _ = nodes.parts(tree, bent)
    patch, drawn = _patches(tree, along, across)
    size = nodes.math(tree, "MULTIPLY_ADD", patch, SMALLER - 1.0, 1.0)
    along = nodes.math(tree, "MULTIPLY", along, size)
    across = nodes.math(tree, "MULTIPLY", across, size)
    course = _whole(tree, along, SETT_COURSE)
    shift, _ = nodes.white(tree, nodes.math(tree, "MULTIPLY_ADD", patch, 3071.0, course))
    across = nodes.math(tree, "MULTIPLY_ADD", shift, SETT_TILE, across)
    # The other tones of a patch are its own, those of the street change from spot to spot.
    spot = nodes.smoothstep(tree, nodes.noise(tree, BLOTCH, 3.0), 0.3, 0.7)
    low, high = BLOTCH_TONE
    tone = nodes.math(tree, "MULTIPLY_ADD", spot, high - low, low)
    other = nodes.math(tree, "MULTIPLY_ADD", drawn, PATCH_TONE, -PATCH_TONE / 2)
    tone = nodes.math(tree, "MULTIPLY_ADD", patch, other, tone)
    load = nodes.smoothstep(tree, nodes.noise(tree, LOAD, 1.0), 0.35, 0.65)
    return nodes.joined(tree, along, across), nodes.product(
        tree, nodes.mix(tree, load, COLD, WARM), tone
    )


def _whole(tree: Tree, value: Socket, step: float) -> Socket:
    """Return the number of whole steps in a value."""
    return nodes.math(tree, "FLOOR", nodes.math(tree, "DIVIDE", value, step))


def _patches(tree: Tree, along: Socket, across: Socket) -> tuple[Socket, Socket]:
    """Return 1 where setts were taken up and relaid, and a number that each patch draws.

    A patch begins and ends with whole courses; its sides are toothed, as courses are in bond.
    """
    long, wide = PLOT
    course = _whole(tree, along, SETT_COURSE)
    tooth, _ = nodes.white(tree, course)
    across = nodes.math(tree, "MULTIPLY_ADD", tooth, 0.16, across)
    middle = nodes.math(tree, "MULTIPLY", nodes.math(tree, "ADD", course, 0.5), SETT_COURSE)
    row = _whole(tree, middle, long)
    slip, _ = nodes.white(tree, row)
    across = nodes.math(tree, "MULTIPLY_ADD", slip, wide, across)
    plot = nodes.math(tree, "MULTIPLY_ADD", row, 131.7, _whole(tree, across, wide))
    chance, bounds = nodes.white(tree, plot)
    first, second, drawn = nodes.parts(tree, bounds)
    inside = nodes.math(tree, "GREATER_THAN", chance, PATCHED)
    for value, step, draw in ((middle, long, first), (across, wide, second)):
        share = nodes.math(tree, "FRACT", nodes.math(tree, "DIVIDE", value, step))
        after = nodes.math(tree, "GREATER_THAN", share, nodes.math(tree, "MULTIPLY", draw, 0.4))
        end = nodes.math(tree, "MULTIPLY_ADD", draw, 0.4, 0.6)
        before = nodes.math(tree, "LESS_THAN", share, end)
        inside = nodes.math(tree, "MULTIPLY", inside, nodes.math(tree, "MULTIPLY", after, before))
    return inside, drawn
