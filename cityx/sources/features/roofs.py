"""Roof shapes and heights where tags are silent: what is usual for a type in its place."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import envelopes_of
from cityx.ids import UInt64Array, choose, uniform
from cityx.places.profile import Buildings
from cityx.sources.features.building_heights import TYPES

SHAPES = (
    "flat", "gabled", "hipped", "half-hipped", "pyramidal", "skillion", "gambrel", "mansard",
    "dome", "onion", "round", "saltbox", "sawtooth", "cone", "butterfly", "zollinger",
    "crosspitched", "side_hipped", "side_half-hipped", "hipped-and-gabled", "gabled_row",
    "gabled_height_moved", "double_saltbox", "quadruple_saltbox",
)  # fmt: skip
SHAPE = {name: index for index, name in enumerate(SHAPES)}
MANY_LEVELS = 7  # a higher building has a flat roof
WINGS = 20  # points of an outline with more wings than gables suit
WIDE = 24.0  # metres; a broader building has a flat or shallow roof
LEARN = 20  # tagged roofs of a type from which a map's own habit counts
SHARE = 0.3  # and the share of the type's buildings they must be
MAX_ROOF = 9.0  # metres of a roof nobody measured, churches apart

# Weights of (flat, gabled, hipped, half-hipped, pyramidal, skillion, mansard, sawtooth) by type and
# place: low, urban, core.
_DRAWN = ("flat", "gabled", "hipped", "half-hipped", "pyramidal", "skillion", "mansard", "sawtooth")
_HOUSE = ((15, 52, 25, 3, 3, 2, 0, 0), (25, 48, 20, 2, 2, 1, 2, 0), (60, 25, 15, 0, 0, 0, 0, 0))
_TERRACE = ((15, 72, 10, 0, 0, 0, 3, 0), (25, 55, 5, 0, 0, 0, 15, 0), (60, 25, 5, 0, 0, 0, 10, 0))
_FLATS = ((30, 40, 25, 0, 0, 0, 5, 0), (42, 26, 10, 0, 0, 0, 22, 0), (97, 0, 3, 0, 0, 0, 0, 0))
_FLAT = ((100, 0, 0, 0, 0, 0, 0, 0),) * 3
_WORK = ((85, 5, 5, 0, 0, 3, 2, 0), (92, 2, 3, 0, 0, 0, 3, 0), (100, 0, 0, 0, 0, 0, 0, 0))
_WEIGHTS = {
    "house": _HOUSE, "terrace": _TERRACE, "apartments": _FLATS, "office": _WORK, "retail": _WORK,
    "hotel": _WORK, "parking": _FLAT, "roof": _FLAT, "tower": _FLAT, "hall": _FLAT,
    "industrial": ((45, 45, 0, 0, 0, 5, 0, 5), (55, 30, 0, 0, 0, 5, 0, 10), _FLAT[0]),
    "civic": ((45, 25, 30, 0, 0, 0, 0, 0), (55, 12, 28, 0, 0, 0, 5, 0), _FLAT[0]),
    "church": ((2, 90, 8, 0, 0, 0, 0, 0),) * 3,
    "garage": ((55, 20, 0, 0, 0, 25, 0, 0), (75, 5, 0, 0, 0, 20, 0, 0), (90, 0, 0, 0, 0, 10, 0, 0)),
    "mixed": ((30, 45, 20, 0, 0, 0, 5, 0), (45, 25, 10, 0, 0, 0, 20, 0), _FLAT[0]),
}  # fmt: skip
_TABLE = np.array([_WEIGHTS[found.name] for found in TYPES], float)  # (types, places, shapes)
_TO_SHAPE = np.array([SHAPE[name] for name in _DRAWN])
# Pitch in degrees, low and high.
_PITCH = {
    "gabled": (30, 45), "hipped": (25, 40), "half-hipped": (32, 45), "pyramidal": (25, 40),
    "skillion": (6, 14), "saltbox": (28, 38), "sawtooth": (22, 28), "gambrel": (40, 48),
    "mansard": (40, 50), "cone": (30, 45), "butterfly": (8, 16), "zollinger": (42, 50),
    "crosspitched": (30, 45), "side_hipped": (25, 40), "side_half-hipped": (32, 45),
    "hipped-and-gabled": (28, 40), "gabled_row": (30, 45), "gabled_height_moved": (20, 30),
    "double_saltbox": (25, 35), "quadruple_saltbox": (30, 40),
}  # fmt: skip


def fill_shapes(
    shapes: IntArray,
    polygons: NDArray[Any],
    types: IntArray,
    place: IntArray,
    levels: FloatArray,
    ids: UInt64Array,
    *,
    local: Buildings,
    seed: int,
) -> IntArray:
    """Give a roof shape to the volumes whose tags name none.

    Parameters
    ----------
    shapes
        (n,) index into `SHAPES`, -1 where unknown.
    local
        Of the profile of the place: how many roofs are flat.
    """
    unknown = np.flatnonzero(shapes < 0)
    filled = shapes.copy()
    weights = _TABLE.copy()
    houses = np.array([found.name != "church" for found in TYPES])
    weights[houses, :, 0] += local.flat_roofs * weights[houses].sum(axis=2)
    weights[houses, 1:, 0] += local.flat_roofs_town * weights[houses, 1:].sum(axis=2)
    for kind, place_class in np.unique(np.column_stack([types, place])[unknown], axis=0).tolist():
        rows = unknown[(types[unknown] == kind) & (place[unknown] == place_class)]
        drawn = choose(seed, "osm/roof", ids[rows], weights[kind, place_class])
        filled[rows] = _TO_SHAPE[drawn]
        own = shapes[(types == kind) & (shapes >= 0)]
        if len(own) >= LEARN and len(own) >= SHARE * (types == kind).sum():
            counts = np.bincount(own, minlength=len(SHAPES))
            filled[rows] = choose(seed, "osm/roof", ids[rows], counts)
    return _possible(filled, unknown, polygons, types, levels)


def _possible(
    shapes: IntArray, unknown: IntArray, polygons: NDArray[Any], types: IntArray, levels: FloatArray
) -> IntArray:
    """Replace drawn shapes that the outline does not bear."""
    shapes = shapes.copy()
    area, side = shapely.area(polygons[unknown]), short_side(polygons[unknown])
    solidity = area / np.maximum(shapely.area(shapely.convex_hull(polygons[unknown])), 1e-9)
    church = np.array([found.name == "church" for found in TYPES])[types[unknown]]
    work = np.array([found.name in ("industrial", "hall") for found in TYPES])[types[unknown]]
    high = levels[unknown] >= MANY_LEVELS
    wide = (side > WIDE) & ~church & ~work
    holes = shapely.get_num_interior_rings(polygons[unknown]) > 0
    drawn = shapes[unknown]
    drawn = np.where((high | wide) & ~church, SHAPE["flat"], drawn)
    # A single slope needs an outline that is nearly a box, gables a few clear wings.
    bent = (solidity < 0.85) | holes
    drawn = np.where((drawn == SHAPE["skillion"]) & bent, SHAPE["hipped"], drawn)
    gabled = np.isin(drawn, [SHAPE["gabled"], SHAPE["half-hipped"]])
    ragged = holes | (shapely.get_num_coordinates(polygons[unknown]) - 1 > WINGS)
    drawn = np.where(gabled & bent & ragged, SHAPE["hipped"], drawn)
    pointed = drawn == SHAPE["pyramidal"]
    drawn = np.where(pointed & (area > 250.0), SHAPE["hipped"], drawn)
    drawn = np.where((solidity < 0.5) & ~church, SHAPE["flat"], drawn)
    drawn = np.where(area < 8.0, SHAPE["flat"], drawn)
    shapes[unknown] = drawn
    return shapes


def directions_of(
    polygons: NDArray[Any],
    direction: FloatArray,
    across: NDArray[np.bool_],
    along: NDArray[np.bool_],
) -> FloatArray:
    """Return where roofs slope down to, of those whose ridge is said to lie along or across too.

    Parameters
    ----------
    direction
        (n,) compass radians that tags state, NaN elsewhere.
    across, along
        (n,) whether the ridge is said to run across or along the longer side.
    """
    ridge = envelopes_of(polygons)[:, 0] + np.where(across, np.pi / 2, 0.0)
    said = np.isnan(direction) & (across | along)
    return np.where(said, np.mod(-ridge, 2 * np.pi), direction)


def short_side(polygons: NDArray[Any]) -> FloatArray:
    """Return the shorter side of the rectangle with a polygon's area and perimeter, (n,)."""
    area, half = shapely.area(polygons), shapely.length(polygons) / 2
    root = np.sqrt(np.maximum(half**2 - 4 * area, 0.0))
    # A round outline has less perimeter than any rectangle; its side is its root area.
    return np.where(half**2 < 4 * area, np.sqrt(area), (half - root) / 2)


def roof_heights(
    shapes: IntArray,
    polygons: NDArray[Any],
    types: IntArray,
    ids: UInt64Array,
    angle: FloatArray,
    *,
    seed: int,
) -> FloatArray:
    """Return the height of each roof, (n,) metres, from its pitch or what is usual.

    Parameters
    ----------
    angle
        (n,) tagged pitch in degrees, NaN where unknown.
    """
    side = short_side(polygons)
    u = uniform(seed, "osm/pitch", ids)
    low, high = np.zeros(len(SHAPES)), np.zeros(len(SHAPES))
    for name, (least, most) in _PITCH.items():
        low[SHAPE[name]], high[SHAPE[name]] = least, most
    pitch = low[shapes] + u * (high - low)[shapes]
    church = np.array([found.name == "church" for found in TYPES])[types]
    work = np.array([found.name in ("industrial", "hall", "garage") for found in TYPES])[types]
    pitch = np.where(church & (pitch > 0), np.maximum(pitch, 45.0 + 10 * u), pitch)
    pitch = np.where(work & (shapes != SHAPE["sawtooth"]), np.minimum(pitch, 15.0), pitch)
    pitch = np.where(np.isnan(angle), pitch, angle)
    full = np.isin(shapes, [SHAPE["skillion"]])
    run = np.where(full, side, side / 2)
    run = np.where(shapes == SHAPE["sawtooth"], np.minimum(side, 6.0), run)
    run = np.where(shapes == SHAPE["gabled_row"], np.minimum(side / 2, 3.5), run)
    height = run * np.tan(np.radians(pitch))
    limit = np.where(church, 25.0, MAX_ROOF)
    height = np.where(np.isnan(angle), np.minimum(height, limit), np.minimum(height, 200.0))
    height = np.where(shapes == SHAPE["mansard"], np.minimum(height, 3.2), height)
    height = np.where(shapes == SHAPE["dome"], side / 2, height)
    height = np.where(shapes == SHAPE["onion"], side * 0.9, height)
    height = np.where(shapes == SHAPE["round"], side / 4, height)
    return np.where(shapes == SHAPE["flat"], 0.0, np.maximum(height, 0.4))
