"""Glyphs: outlines of letters from the fonts that come with Blender, kept for signs.

``python -m cityx.blender.glyphs`` renews ``cityx/assets/glyphs.npz``. What makes signs reads that
file alone, so that the same letters come out on every machine, with or without Blender. Inter and
Noto Sans CJK are under the SIL Open Font License 1.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import scale, translate

from cityx.assets.lettering import CAP, FILE, FIRST_EAST_ASIAN, GRID, characters

LATIN, EAST_ASIAN = "Inter.woff2", "Noto Sans CJK Regular.woff2"
STEPS = 5  # straight pieces of a curve between two points of an outline
STROKE = {LATIN: 0.022, EAST_ASIAN: 0.012}  # em by which outlines grow: signs are set in bold
TOLERANCE = 0.003  # em
# Of each font a letter, and its height and foot in em as they are kept.
MEASURE = {LATIN: ("H", CAP - 0.044, 0.022), EAST_ASIAN: ("国", 0.88, -0.06)}


def outlines(text: str) -> dict[str, Any]:
    """Return the shape of every character that the fonts have, polygons in em, baseline at 0."""
    latin = [letter for letter in text if ord(letter) < FIRST_EAST_ASIAN]
    asian = [letter for letter in text if ord(letter) >= FIRST_EAST_ASIAN]
    found = {}
    for name, letters in ((LATIN, latin), (EAST_ASIAN, asian)):
        shapes = _outlines(letters, name)
        letter, height, foot = MEASURE[name]
        _, low, _, high = shapes[letter].bounds
        size = height / (high - low)
        for letter, shape in shapes.items():
            kept = translate(scale(shape, size, size, origin=(0, 0)), 0.0, foot - size * low)
            bold = kept.buffer(STROKE[name], join_style="mitre", mitre_limit=2.0)
            found[letter] = bold.simplify(TOLERANCE)
    return found


def _outlines(letters: Sequence[str], name: str) -> dict[str, Any]:
    """Set each character on a line of its own and take the lines apart."""
    folder = Path(bpy.utils.system_resource("DATAFILES", path="fonts"))
    text = ["H", "H", *letters]
    curve = bpy.data.curves.new("glyphs", "FONT")
    curve.font = bpy.data.fonts.load(str(folder / name))
    curve.body = "\n".join(text)
    thing = bpy.data.objects.new("glyphs", curve)
    bpy.context.scene.collection.objects.link(thing)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    made = thing.evaluated_get(depsgraph).to_curve(depsgraph)
    rings = [(spline.character_index // 2, _points(spline)) for spline in made.splines]
    first, second = (min(ring[:, 1].min() for k, ring in rings if k == n) for n in (0, 1))
    drawn: dict[str, list[Any]] = {}
    for number, ring in rings:
        if number >= 2:
            level = ring - [0.0, first + number * (second - first)]
            drawn.setdefault(text[number], []).append(shapely.linearrings(level))
    return {letter: _filled(np.array(each)) for letter, each in drawn.items()}


def _filled(rings: NDArray[Any]) -> Any:
    """Fill rings where they wind round a place, as fonts do; they may overlap."""
    faces = shapely.get_parts(shapely.polygonize([shapely.node(shapely.multilinestrings(rings))]))
    turn = np.where(shapely.is_ccw(rings), 1, -1)
    inside = shapely.contains(
        shapely.polygons(rings)[:, None], shapely.point_on_surface(faces)[None, :]
    )
    return shapely.union_all(faces[(turn[:, None] * inside).sum(axis=0) != 0])


def _points(spline: bpy.types.Spline) -> NDArray[np.float64]:
    """Walk along a closed spline, (n, 2)."""
    held = spline.bezier_points
    step = np.linspace(0.0, 1.0, STEPS, endpoint=False)[:, None]
    runs = []
    for number, point in enumerate(held):
        after = held[(number + 1) % len(held)]
        a, b, c, d = (np.array(at)[:2] for at in
                      (point.co, point.handle_right, after.handle_left, after.co))  # fmt: skip
        straight = abs(np.cross(b - a, d - a)) + abs(np.cross(c - a, d - a)) < 1e-6
        t = step[:1] if straight else step
        runs.append((1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d)
    return np.vstack(runs)


def write(path: Path = FILE) -> int:
    """Write the outlines of all characters that signs may need, and return how many there are."""
    found = outlines(characters())
    letters = sorted(found)
    shapes = np.array([found[letter] for letter in letters], object)
    pieces, glyph = shapely.get_parts(shapes, return_index=True)
    rings, piece = shapely.get_rings(pieces, return_index=True)
    points, ring = shapely.get_coordinates(rings, return_index=True)
    np.savez_compressed(
        path,
        letters=np.array(letters),
        glyph=glyph.astype(np.int16),
        piece=piece.astype(np.int16),
        ring=ring.astype(np.int32),
        points=np.rint(points / GRID).astype(np.int16),
    )
    return len(letters)


if __name__ == "__main__":
    write()
