"""Fonts: outlines of letters from the fonts that come with Blender, for signs.

Inter and Noto Sans CJK are under the SIL Open Font License 1.1. They lie in the package of Blender,
whose version is pinned, so that the same letters come out on every machine.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.metadata import version
from importlib.util import find_spec
from itertools import pairwise
from math import comb
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import affine_transform

from cityx.cache import Arrays, cached_arrays
from cityx.digests import edition_of
from cityx.errors import EngineError

Point = tuple[float, float]
FIRST_EAST_ASIAN = 0x2E80  # code from which characters fill a square
CAP = 0.73  # em, height of capitals
STEPS = 5  # straight pieces of a curve between two points of an outline
TOLERANCE = 0.003  # em


@dataclass(frozen=True)
class Cut:
    """How the letters of a font are set.

    Attributes
    ----------
    file
        Name of the font below the folder of Blender's fonts.
    letter, height, foot
        A letter, and its height and foot in em as they are set, before it grows.
    stroke
        Em by which outlines grow: signs are set in bold.
    block
        Codes of letters that are kept together.
    """

    file: str
    letter: str
    height: float
    foot: float
    stroke: float
    block: int


LATIN = Cut("Inter.woff2", "H", CAP - 0.044, 0.022, 0.022, 128)
EAST_ASIAN = Cut("Noto Sans CJK Regular.woff2", "国", 0.88, -0.06, 0.012, 16)


def has(letter: str) -> bool:
    """Tell whether there is an outline of a letter."""
    return letter in _block_of(letter)


def outline(letter: str) -> Any:
    """Return the shape of a letter, a multipolygon in em on its baseline; empty for a space.

    Raises
    ------
    KeyError
        If no font has it.
    """
    return _block_of(letter)[letter]


def _block_of(letter: str) -> Mapping[str, Any]:
    cut = _cut(letter)
    return _block(cut, ord(letter) // cut.block)


@lru_cache(maxsize=4096)
def _block(cut: Cut, number: int) -> Mapping[str, Any]:
    """Return the letters of a run of codes, kept from run to run, as opening a font is slow."""
    key = f"letters-{_edition()}/{Path(cut.file).stem}-{number:04x}"
    held = cached_arrays(key, lambda: _packed(cut, number))
    rings = shapely.linearrings(held["points"], indices=held["ring"])
    pieces = shapely.polygons(rings, indices=held["piece"]) if len(rings) else rings
    first = np.searchsorted(held["glyph"], np.arange(len(held["code"]) + 1))
    return {
        chr(code): shapely.multipolygons(pieces[first[k] : first[k + 1]])
        for k, code in enumerate(held["code"].tolist())
    }


def _packed(cut: Cut, number: int) -> Arrays:
    codes = [code for code in range(number * cut.block, (number + 1) * cut.block)
             if code in _codes(cut.file)]  # fmt: skip
    shapes = np.array([_drawn(cut, chr(code)) for code in codes], object)
    pieces, glyph = shapely.get_parts(shapes, return_index=True)
    rings, piece = shapely.get_rings(pieces, return_index=True)
    points, ring = shapely.get_coordinates(rings, return_index=True)
    return {"code": np.array(codes, np.int64), "glyph": glyph, "piece": piece, "ring": ring,
            "points": points}  # fmt: skip


def _drawn(cut: Cut, letter: str) -> Any:
    scale, rise = _setting(cut)
    shape = affine_transform(_filled(_rings(cut.file, letter)), [scale, 0, 0, scale, 0.0, rise])
    bold = shape.buffer(cut.stroke, join_style="mitre", mitre_limit=2.0).simplify(TOLERANCE)
    pieces = shapely.get_parts(bold)
    return shapely.multipolygons(pieces[~shapely.is_empty(pieces)])


@cache
def _edition() -> str:
    """Hash of this code and of Blender's version, so that no letter is that of another font."""
    return f"{edition_of([Path(__file__)])}-{version('bpy')}"


def _cut(letter: str) -> Cut:
    return LATIN if ord(letter) < FIRST_EAST_ASIAN else EAST_ASIAN


@cache
def _setting(cut: Cut) -> tuple[float, float]:
    """Return by how much the letters of a font are scaled, and then raised."""
    _, low, _, high = shapely.bounds(_filled(_rings(cut.file, cut.letter))).tolist()
    scale = cut.height / (high - low)
    return scale, cut.foot - scale * low


@cache
def _font(file: str) -> Any:
    from fontTools.ttLib import TTFont

    spec = find_spec("bpy")
    roots = [] if spec is None or spec.origin is None else [Path(spec.origin).parent]
    found = [path for root in roots for path in root.glob(f"*/datafiles/fonts/{file}")]
    if not found:
        raise EngineError(f"Blender's package does not hold the font {file}; install bpy again.")
    return TTFont(found[0], lazy=True)


@cache
def _codes(file: str) -> Mapping[int, str]:
    codes: Mapping[int, str] = _font(file).getBestCmap()
    return codes


@cache
def _glyphs(file: str) -> Any:
    return _font(file).getGlyphSet()


def _rings(file: str, letter: str) -> NDArray[Any]:
    """Return the outlines of a letter as a font draws them, linear rings in its units."""
    from fontTools.pens.recordingPen import DecomposingRecordingPen

    glyphs = _glyphs(file)
    pen = DecomposingRecordingPen(glyphs)
    glyphs[_codes(file)[ord(letter)]].draw(pen)
    rings: list[list[Point]] = []
    for word, points in pen.value:
        if word == "moveTo":
            rings.append([points[0]])
        elif word == "lineTo":
            rings[-1].append(points[0])
        elif word == "qCurveTo":
            rings[-1] += _quadratic(rings[-1][-1], points)
        elif word == "curveTo":
            rings[-1] += _bezier(np.array([rings[-1][-1], *points], float))
    return np.array([shapely.linearrings(ring) for ring in rings if len(ring) > 2], object)


def _quadratic(start: Point, points: Sequence[Point]) -> list[Point]:
    """Walk along a run of quadratic curves, whose ends between its controls lie midway."""
    *controls, last = (np.array(point, float) for point in points)
    middles = [(one + other) / 2 for one, other in pairwise(controls)]
    found, begin = [], np.array(start, float)
    for control, end in zip(controls, [*middles, last], strict=True):
        found += _bezier(np.array([begin, control, end]))
        begin = end
    return found


def _bezier(controls: NDArray[np.float64]) -> list[Point]:
    """Walk along a Bezier curve of any degree, without its first point."""
    t = np.linspace(0.0, 1.0, STEPS + 1)[1:, None]
    degree = len(controls) - 1
    at = sum(comb(degree, k) * (1 - t) ** (degree - k) * t**k * c for k, c in enumerate(controls))
    return [(float(x), float(y)) for x, y in np.asarray(at)]


def _filled(rings: NDArray[Any]) -> Any:
    """Fill rings where they wind round a place, as fonts do; they may overlap."""
    if not len(rings):
        return shapely.MultiPolygon()
    faces = shapely.get_parts(shapely.polygonize([shapely.node(shapely.multilinestrings(rings))]))
    turn = np.where(shapely.is_ccw(rings), 1, -1)
    inside = shapely.contains(
        shapely.polygons(rings)[:, None], shapely.point_on_surface(faces)[None, :]
    )
    return shapely.union_all(faces[(turn[:, None] * inside).sum(axis=0) != 0])
