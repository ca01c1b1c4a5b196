"""Levels and heights of buildings: what tags say, what neighbours suggest, what is usual."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import UInt64Array, choose, uniform
from cityx.system.tables import table

# Where levels are borrowed from: (metres, of how many neighbours, how many of them must be known,
# share of the type that must be known). Where only a few are tagged those are the tallest, so that
# they say nothing about the rest.
LENDING = ((2000.0, 24, 6, 0.10), (150.0, 8, 3, 0.05))
TINY = 20.0  # square metres; such a building has one level
SLENDER = 8.0  # a building without height tags is at most this many times as high as its root area
MAX_LEVELS = 200
MAX_HEIGHT = 1000.0
WALL_REACH = 0.3  # metres between walls that are shared but were drawn twice


@dataclass(frozen=True)
class Type:
    """A type of building.

    Attributes
    ----------
    levels
        Quantiles (10, 50, 90 %) of the levels in low, urban and core places.
    storey, ground
        Metres per storey, and of the ground floor.
    uses
        Values of building=* that mean it.
    """

    name: str
    levels: tuple[tuple[float, float, float], ...]
    storey: float
    ground: float
    uses: tuple[str, ...] = ()


TYPES = tuple(table("sources/building_types", Type, "types").values())
TYPE = {found.name: index for index, found in enumerate(TYPES)}
# Height in metres of towers by their own word, when no tag says more.
TOWER_HEIGHT = table("sources/building_types", float, "towers")

TYPE_OF_USE = {use: TYPE[found.name] for found in TYPES for use in found.uses}


def building_types(
    uses: list[str], areas: FloatArray, place: IntArray, industrial: NDArray[np.bool_]
) -> IntArray:
    """Return the type, (n,) index into `TYPES`, of each building.

    Parameters
    ----------
    uses
        Values of building=*; "yes" is judged by size and surroundings.
    industrial
        (n,) whether it stands on industrial land.
    """
    known = np.array([TYPE_OF_USE.get(use, -1) for use in uses], np.int64)
    tower = np.array([use in TOWER_HEIGHT for use in uses], bool)
    large = np.where(industrial, TYPE["industrial"], TYPE["retail"])
    guessed = np.select(
        [areas < 25.0, areas < 200.0, industrial & (areas > 800.0), areas < 800.0, areas < 3000.0],
        [
            TYPE["garage"],
            np.where(
                place == 0, TYPE["house"], np.where(place == 1, TYPE["terrace"], TYPE["mixed"])
            ),
            TYPE["industrial"],
            np.where(place == 0, TYPE["terrace"], TYPE["mixed"]),
            np.where(place == 0, TYPE["civic"], TYPE["mixed"]),
        ],
        large,
    )
    return np.where(tower, TYPE["tower"], np.where(known >= 0, known, guessed)).astype(np.int64)


def storey_heights(types: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return metres per storey and of the ground floor, (n,) each."""
    storey = np.array([found.storey for found in TYPES])
    ground = np.array([found.ground for found in TYPES])
    return storey[types], ground[types]


def height_of_levels(levels: FloatArray, types: IntArray, *, on_ground: Any = True) -> FloatArray:
    """Return the metres that a number of storeys take; the ground floor is often higher."""
    storey, ground = storey_heights(types)
    first = np.where(on_ground, ground, storey)
    return np.asarray(first + np.maximum(levels - 1, 0) * storey)


def levels_of_height(height: FloatArray, types: IntArray, *, on_ground: Any = True) -> FloatArray:
    """Return how many storeys fit into a height without roof, at least one."""
    storey, ground = storey_heights(types)
    first = np.where(on_ground, ground, storey)
    # Storeys of a tagged height vary; half a storey decides.
    return np.asarray(np.clip(np.rint(1 + (height - first) / storey), 1, MAX_LEVELS))


def prior_levels(types: IntArray, place: IntArray, ids: UInt64Array, *, seed: int) -> FloatArray:
    """Draw levels from the usual distribution of a type in its place, by hashed quantile."""
    table = np.array([found.levels for found in TYPES])  # (types, 3, 3)
    low, middle, high = np.moveaxis(table[types, place], -1, 0)
    u = uniform(seed, "osm/levels", ids)
    spread = np.select(
        [u < 0.1, u < 0.5, u < 0.9],
        [low, low + (u - 0.1) / 0.4 * (middle - low), middle + (u - 0.5) / 0.4 * (high - middle)],
        high + (u - 0.9) / 0.1 * (high - middle) * 0.5,
    )
    return np.asarray(np.maximum(np.rint(spread), 1.0))


def fill_levels(
    levels: FloatArray,
    polygons: NDArray[Any],
    types: IntArray,
    place: IntArray,
    ids: UInt64Array,
    *,
    seed: int,
) -> FloatArray:
    """Give levels to the buildings whose tags say nothing.

    First a building that shares a wall lends its levels, one more or less at times; then one of
    the known buildings of the type nearby, near ones more likely, so that the distribution and not
    only the mean is kept; then the distribution usual for the type. Small and slender buildings
    are kept low.

    Parameters
    ----------
    levels
        (n,) known levels, NaN where unknown.
    polygons, types, place, ids
        (n,) outlines, types, classes of the surroundings, stable ids.
    """
    unknown = np.flatnonzero(np.isnan(levels))
    filled = levels.copy()
    filled[unknown] = prior_levels(types[unknown], place[unknown], ids[unknown], seed=seed)
    known = np.flatnonzero(~np.isnan(levels))
    area = shapely.area(polygons)
    if len(known) and len(unknown):
        for rule in LENDING:
            _copy_near(filled, unknown, known, polygons, types, ids, seed, rule)
        _copy_shared_walls(filled, unknown, known, polygons, types, ids, area, seed)
    # A flat's staircase or bay may be drawn as a small building of its own.
    tiny = (area[unknown] < TINY) & (types[unknown] != TYPE["apartments"])
    filled[unknown[tiny]] = 1.0
    storey, ground = storey_heights(types[unknown])
    limit = 1 + np.floor((SLENDER * np.sqrt(area[unknown]) - ground) / storey)
    filled[unknown] = np.minimum(filled[unknown], np.maximum(limit, 1.0))
    return np.clip(filled, 0.0, MAX_LEVELS)


def _copy_near(
    filled: FloatArray,
    unknown: IntArray,
    known: IntArray,
    polygons: NDArray[Any],
    types: IntArray,
    ids: UInt64Array,
    seed: int,
    rule: tuple[float, int, int, float],
) -> None:
    """Draw the levels of one of the nearest known buildings of the type."""
    from scipy.spatial import KDTree

    reach, neighbours, needed, share = rule
    centres = shapely.get_coordinates(shapely.centroid(polygons))
    for kind in np.unique(types[unknown]).tolist():
        asking, lending = unknown[types[unknown] == kind], known[types[known] == kind]
        if len(lending) < max(needed, share * (len(lending) + len(asking))):
            continue
        lending = lending[np.argsort(ids[lending])]
        tree = KDTree(centres[lending])
        distance, index = tree.query(
            centres[asking], k=min(neighbours, len(lending)), distance_upper_bound=reach
        )
        found = np.isfinite(distance)
        enough = found.sum(axis=1) >= needed
        asking, distance, index, found = (
            asking[enough], distance[enough], index[enough], found[enough],
        )  # fmt: skip
        weight = np.where(found, 1.0 / (np.where(found, distance, 1.0) ** 2 + 100.0), 0.0)
        edges = np.cumsum(weight, axis=1)
        drawn = uniform(seed, "osm/neighbour", ids[asking]) * edges[:, -1]
        pick = np.minimum((edges <= drawn[:, None]).sum(axis=1), found.sum(axis=1) - 1)
        filled[asking] = filled[lending[index[np.arange(len(asking)), pick]]]


def _copy_shared_walls(
    filled: FloatArray,
    unknown: IntArray,
    known: IntArray,
    polygons: NDArray[Any],
    types: IntArray,
    ids: UInt64Array,
    area: FloatArray,
    seed: int,
) -> None:
    """Copy the levels of the known building of the type that shares a wall, lowest id first."""
    tree = shapely.STRtree(polygons[known])
    asking, lending = tree.query(polygons[unknown], predicate="dwithin", distance=WALL_REACH)
    asking, lending = unknown[asking], known[lending]
    alike = (types[asking] == types[lending]) & (area[asking] > 25.0)
    asking, lending = asking[alike], lending[alike]
    order = np.lexsort((ids[lending], asking))
    asking, lending = asking[order], lending[order]
    first = np.ones(len(asking), bool)
    first[1:] = asking[1:] != asking[:-1]
    asking, lending = asking[first], lending[first]
    step = choose(seed, "osm/terrace-step", ids[asking], [1.0, 3.0, 1.0]) - 1
    filled[asking] = np.maximum(filled[lending] + step, 1.0)
