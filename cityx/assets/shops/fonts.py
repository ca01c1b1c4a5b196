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

from cityx.errors import EngineError
from cityx.geometry import polygons
from cityx.geometry.polygons import rings_of, triangulate
from cityx.system.cache import Arrays, cached_arrays
from cityx.system.digests import edition_of

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


@dataclass(frozen=True)
class Letter:
    """A letter on its baseline, in em.

    Attributes
    ----------
    points
        (m, 2) float, its rings one after the other, outer ones counter-clockwise.
    start
        (r + 1,) int, first point of each ring.
    triangles
        (t, 3) int, rows of `points`.
    """

    points: NDArray[np.float64]
    start: NDArray[np.int64]
    triangles: NDArray[np.int64]


def has(letter: str) -> bool:
    """Return whether there is an outline of a letter."""
    return letter in _block_of(letter)


def letter_of(letter: str) -> Letter:
    """Return a letter; a space has no points.

    Raises
    ------
    KeyError
        If no font has it.
    """
    return _block_of(letter)[letter]


def outline(letter: str) -> Any:
    """Draw the shape of a letter from its font, a multipolygon in em; empty for a space."""
    cut = _cut(letter)
    scale, rise = _setting(cut)
    shape = affine_transform(_filled(_rings(cut.file, letter)), [scale, 0, 0, scale, 0.0, rise])
    bold = shape.buffer(cut.stroke, join_style="mitre", mitre_limit=2.0).simplify(TOLERANCE)
    pieces = shapely.get_parts(bold)
    return shapely.multipolygons(pieces[~shapely.is_empty(pieces)])


def _block_of(letter: str) -> Mapping[str, Letter]:
    cut = _cut(letter)
    return _block(cut, ord(letter) // cut.block)


@lru_cache(maxsize=4096)
def _block(cut: Cut, number: int) -> Mapping[str, Letter]:
    """Return the letters of a run of codes, kept from run to run, as opening a font is slow."""
    key = f"letters-{_edition()}/{Path(cut.file).stem}-{number:04x}"
    held = cached_arrays(key, lambda: _packed(cut, number))
    points, rings, triangles = held["points"], held["rings"], held["triangles"]
    found, at = {}, [0, 0, 0]
    for code, *counts in held["letters"].tolist():
        end = [first + count for first, count in zip(at, counts, strict=True)]
        start = np.concatenate([[0], np.cumsum(rings[at[1] : end[1]])])
        found[chr(code)] = Letter(points[at[0] : end[0]], start, triangles[at[2] : end[2]])
        at = end
    return found


def _packed(cut: Cut, number: int) -> Arrays:
    """Draw a block: its letters one after the other, and of each the sizes of what it has."""
    codes = [code for code in range(number * cut.block, (number + 1) * cut.block)
             if code in _codes(cut.file)]  # fmt: skip
    points, sizes, triangles, letters = [np.zeros((0, 2))], [], [np.zeros((0, 3), np.int64)], []
    for code in codes:
        flat = shapely.orient_polygons(shapely.get_parts(outline(chr(code))))
        rings = rings_of(flat)
        faces = triangulate(flat, rings).triangles.reshape(-1, 3)
        points.append(rings.points)
        sizes += np.diff(rings.start).tolist()
        triangles.append(faces)
        letters.append((code, len(rings.points), len(rings.polygon), len(faces)))
    return {"letters": np.array(letters, np.int64).reshape(-1, 4),
            "points": np.concatenate(points), "rings": np.array(sizes, np.int64),
            "triangles": np.concatenate(triangles)}  # fmt: skip


@cache
def _edition() -> str:
    """Hash of this code and of Blender's version, so that no letter is that of another font."""
    return f"{edition_of([Path(__file__), Path(polygons.__file__)])}-{version('bpy')}"


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
