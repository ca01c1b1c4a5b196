"""Plausible towns: where an image shows blobs, blocks are built up as densely as it shows.

A small network sees that a row of villas is built on, seldom where one ends. So streets that break
off short of another are led on to it, and blocks whose houses flow together get parcels and houses
of their own; houses that were seen one by one stay as they are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.parcels.parcels import parcels_of
from cityx.geometry.raster.centrelines import Centrelines
from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.patches import label_patches
from cityx.geometry.raster.regions import filled
from cityx.ids import stable_id
from cityx.sources.class_map import ClassMap, features_of, traced
from cityx.sources.features.tagged import Tagged, joined
from cityx.sources.map_classes import Role
from cityx.sources.parcels.footprints import GROUNDS, footprints_of

GAP = 40.0  # metres of street that trees or shadows may hide
AHEAD = np.cos(np.radians(40.0))  # streets are led on within this angle of their direction
RUN = 15.0  # metres of a street's end from which its direction is told
ROUGH = 1.5  # metres of ragged border that are smoothed off streets
WALK = 2.0  # metres of sidewalk that a block leaves to its streets
LEAST_BLOCK = 400.0  # square metres
LEAST_SHARE = 0.06  # of a block under houses, below which nothing is built anew
WHOLE = 0.6  # of a block near houses, from which all of it is built up
NEAR = 8.0  # metres around houses that are their gardens
BLOB = 1200.0  # square metres of one patch, from which it is several houses
LOOSE = 0.75  # share of its hull below which a patch is several houses
BLOBS = 0.5  # share of a block's houses in such patches, from which it is built anew
# Roofs cover less of any block; where more is marked as houses, whole plots are meant, gardens too.
MOST_ROOF = 0.62
PLOTS = ("suburb", 0.6)  # zone and density of such blocks
TOWN = ("suburb", "row", "midrise")  # zones from which one is taken by its coverage


def plausible_features(found: ClassMap, source: str, *, seed: int) -> Tagged:
    """Draw what a class map shows, with connected streets and blobs of houses rebuilt.

    Parameters
    ----------
    found
        The map.
    source
        First word of every provenance.
    seed
        Key of every draw.
    """
    found = with_streets_connected(found)
    ways = traced(found.mask(Role.ROAD), found.grid)
    blocks = _blocks(found, ways)
    share, anew = _reading(found, blocks)
    built = _burnt(found.grid, blocks[anew])
    land = filled(found.labels, built & found.mask(Role.BUILDING))
    kept = features_of(replace(found, labels=land), source)
    plots, of = _plots(found, blocks[anew])
    return joined(kept, _houses(plots, share[anew][of], source, seed)) if len(plots) else kept


def with_streets_connected(found: ClassMap) -> ClassMap:
    """Smooth the borders of streets, and lead those that break off on to the next."""
    from skimage.morphology import isotropic_closing, isotropic_opening

    road = found.mask(Role.ROAD)
    if not road.any():
        return found
    reach = ROUGH / found.grid.pixel
    margin = int(np.ceil(reach)) + 1
    even = isotropic_closing(np.pad(road, margin, mode="edge"), reach)
    even = isotropic_opening(even, reach / 2)[margin:-margin, margin:-margin]
    label = next(i for i, item in enumerate(found.classes) if item.role is Role.ROAD)
    labels = np.where(even, np.uint8(label), filled(found.labels, road & ~even))
    missing = _missing_links(traced(even, found.grid), found.grid)
    return replace(found, labels=np.where(_burnt(found.grid, missing), np.uint8(label), labels))


def _missing_links(ways: Centrelines, grid: Grid) -> NDArray[Any]:
    """Return polygons of street from dead ends on to what lies ahead of them."""
    lines = grid.shapes_to_metres(ways.lines)
    width = ways.width * grid.pixel
    ends = np.concatenate([shapely.get_point(lines, 0), shapely.get_point(lines, -1)])
    line = np.tile(np.arange(len(lines)), 2)
    _, index, count = np.unique(
        shapely.get_coordinates(ends), axis=0, return_inverse=True, return_counts=True
    )
    west, south, east, north = grid.extent
    inside = shapely.box(west + GAP / 4, south + GAP / 4, east - GAP / 4, north - GAP / 4)
    dead = np.flatnonzero((count[index.ravel()] == 1) & shapely.within(ends, inside))
    tree = shapely.STRtree(lines)
    links = []
    for end in dead.tolist():
        own = line[end]
        link = _link(lines, tree, own, ends[end], at_start=end < len(lines))
        if link is not None:
            links.append(link.buffer(width[own] / 2, cap_style="square"))
    return np.array(links, object)


def _link(
    lines: NDArray[Any], tree: shapely.STRtree, own: int, end: Any, *, at_start: bool
) -> Any | None:
    """Return the shortest way from a dead end to another street ahead, or None."""
    back = shapely.line_interpolate_point(lines[own], RUN if at_start else -RUN)
    way = shapely.get_coordinates(end)[0] - shapely.get_coordinates(back)[0]
    near = tree.query(end, predicate="dwithin", distance=GAP)
    near = near[near != own]
    if not len(near) or not np.any(way):
        return None
    spots = shapely.line_interpolate_point(lines[near], shapely.line_locate_point(lines[near], end))
    steps = shapely.get_coordinates(spots) - shapely.get_coordinates(end)
    length = np.hypot(*steps.T)
    turn = (steps @ way) / np.maximum(length * np.hypot(*way), 1e-9)
    length[(turn < AHEAD) | (length == 0)] = np.inf
    best = int(np.argmin(length))
    return shapely.shortest_line(end, spots[best]) if np.isfinite(length[best]) else None


def _blocks(found: ClassMap, ways: Centrelines) -> NDArray[Any]:
    """Return polygons between streets and water, metres."""
    grid = found.grid
    lines = grid.shapes_to_metres(ways.lines)
    taken = list(shapely.buffer(lines, ways.width * grid.pixel / 2 + WALK, quad_segs=4))
    water = found.mask_of("water")
    taken += list(_polygons(grid, water, WALK))
    rest = shapely.difference(shapely.box(*grid.extent), shapely.union_all(taken))
    parts = shapely.get_parts(rest)
    return np.asarray(parts[shapely.area(parts) >= LEAST_BLOCK], object)


def _burnt(grid: Grid, shapes: NDArray[Any]) -> BoolArray:
    """Return the (rows, columns) pixels whose middles lie in polygons."""
    return np.asarray(grid.numbered(shapes) > 0)


def _place(grid: Grid) -> Any:
    """Return the transform from (column, row) to metres as rasterio takes it."""
    from rasterio.transform import Affine

    return Affine(grid.pixel, 0.0, grid.west, 0.0, -grid.pixel, grid.north)


def _polygons(grid: Grid, mask: BoolArray, tolerance: float) -> NDArray[Any]:
    """Return polygons of a mask, metres, valid and smoothed to a tolerance."""
    from rasterio.features import shapes

    outlined = shapes(mask.astype(np.uint8), mask, transform=_place(grid))
    found = [shapely.geometry.shape(item) for item, _ in outlined]
    simple = shapely.make_valid(shapely.simplify(np.array(found, object), tolerance))
    parts = shapely.get_parts(simple)
    return np.asarray(parts[shapely.get_type_id(parts) == 3], object)


def _reading(found: ClassMap, blocks: NDArray[Any]) -> tuple[FloatArray, BoolArray]:
    """Return for each block the share under houses, and whether it is to be rebuilt."""
    from skimage.measure import regionprops_table

    house = found.mask(Role.BUILDING)
    bodies, count = label_patches(house)
    blob = np.zeros(count + 1, bool)
    if count:
        measured = regionprops_table(bodies, properties=("area", "solidity"))
        size = measured["area"] * found.grid.pixel**2
        blob[1:] = (size > BLOB) | ((size > BLOB / 4) & (measured["solidity"] < LOOSE))
    number = found.grid.numbered(blocks).ravel()
    total = np.bincount(number, minlength=len(blocks) + 1)[1:]
    built = np.bincount(number, house.ravel(), minlength=len(blocks) + 1)[1:]
    flowing = np.bincount(number, blob[bodies].ravel(), minlength=len(blocks) + 1)[1:]
    share = built / np.maximum(total, 1)
    return share, (share > LEAST_SHARE) & (flowing > BLOBS * np.maximum(built, 1))


def _plots(found: ClassMap, blocks: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Return the parts of blocks that are built up, and the block of each."""
    from skimage.morphology import isotropic_closing

    if not len(blocks):
        return blocks, np.zeros(0, np.int64)
    reach = NEAR / found.grid.pixel
    near = isotropic_closing(found.mask(Role.BUILDING), reach)
    town = shapely.union_all(_polygons(found.grid, near, NEAR / 4))
    parts = shapely.intersection(blocks, town)
    whole = shapely.area(parts) > WHOLE * shapely.area(blocks)
    parts[whole] = blocks[whole]
    pieces, of = shapely.get_parts(parts, return_index=True)
    good = (shapely.get_type_id(pieces) == 3) & (shapely.area(pieces) >= LEAST_BLOCK)
    return np.asarray(pieces[good], object), of[good]


def _houses(plots: NDArray[Any], share: FloatArray, source: str, seed: int) -> Tagged:
    """Cut plots into parcels and build on them."""
    spots = np.round(shapely.get_coordinates(shapely.point_on_surface(plots)), 2) + 0.0
    ids = np.array([stable_id(source, "block", x, y) for x, y in spots.tolist()], np.uint64)
    cover = np.array([GROUNDS[word].coverage for word in TOWN])
    nearest = np.abs(share[:, None] - cover).argmin(axis=1)
    zone = np.array(TOWN, object)[nearest]
    density = np.clip(share / cover[nearest], 0.0, 1.0)
    zone[share > MOST_ROOF], density[share > MOST_ROOF] = PLOTS
    parcels = parcels_of(plots, ids, zone, density, seed=seed)
    rows = parcels.block
    height = np.full(len(rows), np.nan)
    return footprints_of(parcels, zone[rows], density[rows], height, seed=seed)
