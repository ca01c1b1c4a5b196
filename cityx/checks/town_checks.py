"""Checks of towns laid out by rule: blocks, junctions, dead ends, parcels.

They hold for what `cityx.town` lays out; a town that was mapped is as it is.

References
----------
Ranges are those measured of real towns for mixed street patterns: 3.0 to 3.4 streets at a junction,
at most a fifth of all street ends blind, blocks of 0.5 to 2 hectares in the median.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import NAMED, Check
from cityx.checks.predicates.street_pattern import GRID_SHARE, pattern_of
from cityx.city import Layout
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.parcels.street_edges import street_graph
from cityx.sources.features.vocabulary import CARS

MADE = "town/"  # provenance of streets laid out by rule
PARCEL = "parcel/"  # and of what stands on their parcels
JUNCTIONS, BLOCKS = 20, 8  # fewer junctions with blind ends, or blocks, tell nothing
BORDER = 3.0  # metres from the border of the site, where streets are cut
DEGREE = 3.4  # streets at a junction in the mean
DEGREE_OF_GRID = 4.0  # of streets that are one grid
DEAD_ENDS = 0.20  # of junctions and blind ends together
# Blocks of 110 m have 0.5 to 2 ha in the median; 80 to 220 m may be asked for.
HECTARES = (0.5 * (80 / 110) ** 2, 2.0 * (220 / 110) ** 2)
# Standard deviations of single values, measured, and how many of the mean's a small town may be off
SPREAD = {"degree": 0.45, "dead ends": 0.3}
SURE = 2.5
FRONTED = ("pedestrian", "steps", "footway")  # ways without cars that parcels lie on, too
FRONT = 1.0  # metres between a parcel and the walk it lies on; corners of blocks are rounded
OVERLAP = 1.0  # square metres of two parcels; less is rounding
HECTARE = 1e4  # square metres


@dataclass(frozen=True)
class _Parcels:
    """Land and buildings of p parcels.

    Attributes
    ----------
    names
        (p,) provenance, rising.
    shapes
        (p,) all of each.
    """

    names: NDArray[Any]
    shapes: NDArray[Any]


def check_towns(layout: Layout) -> list[Check]:
    """Run every check; none where streets were not laid out by rule."""
    roads = layout.roads[layout.roads["kind"].isin(CARS)]
    made = roads["source"].str.startswith(MADE).to_numpy(bool)
    if not len(roads) or not made.all():
        return []
    lines = roads.geometry.to_numpy()
    fronts = layout.roads[layout.roads["kind"].isin((*CARS, *FRONTED))]
    return [*_junctions(lines, layout), *_blocks(lines), *_parcels(fronts, layout)]


def _junctions(lines: NDArray[Any], layout: Layout) -> list[Check]:
    """Check how many streets meet at junctions, and how many end blindly."""
    graph = street_graph(lines)
    inner = _inside(graph.places, layout, BORDER)
    junction = inner & (graph.degree >= 3)
    blind = inner & (graph.degree == 1)
    count = int(junction.sum() + blind.sum())
    if count < JUNCTIONS:
        return []
    mean = float(graph.degree[junction].mean()) if junction.any() else 0.0
    margin = SURE * SPREAD["degree"] / np.sqrt(count)
    gridded = pattern_of(lines).grid >= GRID_SHARE
    most = DEGREE_OF_GRID if gridded else DEGREE + margin
    ends = float(blind.sum() / count)
    more = SURE * SPREAD["dead ends"] / np.sqrt(count)
    return [
        Check("town_streets_at_junctions", mean, round(most, 3),
              "streets at a junction in the mean"),
        Check("town_dead_ends", ends, round(DEAD_ENDS + more, 3),
              "blind ends, a share of junctions and blind ends",
              ids=_spots(graph.places[blind])),
    ]  # fmt: skip


def _blocks(lines: NDArray[Any]) -> list[Check]:
    """Check how large blocks are, from the middle of their streets."""
    faces = shapely.get_parts(shapely.polygonize([shapely.union_all(lines)]))
    area = shapely.area(faces) / HECTARE
    if len(area) < BLOCKS:
        return []
    middle = float(np.median(area))
    least, most = (round(limit, 3) for limit in HECTARES)
    return [
        Check("town_blocks_not_small", middle, least, "hectares of a block in the median",
              at_least=True),
        Check("town_blocks_not_large", middle, most, "hectares of a block in the median"),
    ]  # fmt: skip


def _parcels(roads: Any, layout: Layout) -> list[Check]:
    """Check that parcels lie on streets and beside each other."""
    parcels = _parcels_of(layout)
    if not len(parcels.names):
        return []
    walks = roads[["sidewalk_left", "sidewalk_right"]].max(axis=1).to_numpy()
    half = roads["width"].to_numpy() / 2 + walks
    off = _off_street(parcels, roads.geometry.to_numpy(), half)
    # Of what lies near the border the street may lie beyond it.
    boxes = shapely.bounds(parcels.shapes).reshape(-1, 2, 2)
    whole = np.all([_inside(boxes[:, k], layout, half.max() + FRONT) for k in (0, 1)], axis=0)
    lost = parcels.names[off & whole]
    first, second = _overlapping(parcels)
    pairs = zip(parcels.names[first].tolist(), parcels.names[second].tolist(), strict=True)
    return [
        Check("town_parcels_off_street", float(len(lost)), 0,
              f"parcels over {FRONT:g} m from any street", ids=tuple(lost[:NAMED].tolist())),
        Check("town_parcels_overlapping", float(len(first)), 0,
              f"pairs of parcels with over {OVERLAP:g} m2 in common",
              ids=tuple(f"{a} {b}" for a, b in pairs)[:NAMED]),
    ]  # fmt: skip


def _parcels_of(layout: Layout) -> _Parcels:
    """Put the land and the buildings of each parcel together.

    Parcels without a building are left out: at the border of a window their houses, and with them
    their front, may belong to the window beside it.
    """
    tables = (layout.buildings, layout.areas)
    names = np.concatenate([table["source"].to_numpy(object) for table in tables])
    shapes = np.concatenate([table.geometry.to_numpy() for table in tables])
    houses = layout.buildings["source"]
    known = np.unique(houses[houses.str.startswith(PARCEL)].to_numpy(str))
    own = np.isin(names.astype(str), known)
    of = np.searchsorted(known, names[own].astype(str))
    order = np.argsort(of, kind="stable")
    whole = np.zeros(len(known), object)
    whole[:] = shapely.geometrycollections(shapes[own][order], indices=of[order])
    return _Parcels(known, whole)


def _off_street(parcels: _Parcels, lines: NDArray[Any], half: FloatArray) -> BoolArray:
    """(p,) whether the walk of no street runs along a parcel."""
    tree = shapely.STRtree(lines)
    reach = float(half.max() + FRONT)
    parcel, street = tree.query(parcels.shapes, predicate="dwithin", distance=reach)
    away = shapely.distance(parcels.shapes[parcel], lines[street])
    off = np.ones(len(parcels.names), bool)
    off[parcel[away <= half[street] + FRONT]] = False
    return off


def _overlapping(parcels: _Parcels) -> tuple[IntArray, IntArray]:
    """Return the pairs of parcels that share land."""
    parts, of = shapely.get_parts(parcels.shapes, return_index=True)
    parts, inner = shapely.get_parts(parts, return_index=True)
    of = of[inner]
    a, b = shapely.STRtree(parts).query(parts, predicate="intersects")
    a, b = a[of[a] < of[b]], b[of[a] < of[b]]
    shared = shapely.area(shapely.intersection(parts[a], parts[b]))
    pairs, row = np.unique(np.column_stack([of[a], of[b]]), axis=0, return_inverse=True)
    total = np.bincount(row.ravel(), shared, minlength=len(pairs))
    first, second = pairs[total > OVERLAP].T
    return first, second


def _inside(places: FloatArray, layout: Layout, margin: float) -> BoolArray:
    low, high = np.array(layout.extent[:2]), np.array(layout.extent[2:])
    return np.asarray(((places > low + margin) & (places < high - margin)).all(axis=1))


def _spots(points: FloatArray) -> tuple[str, ...]:
    return tuple(f"({x:.1f}, {y:.1f})" for x, y in points[:NAMED].tolist())
