"""Surface models: what stands on the ground of a height grid becomes houses, trees and streets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.chains import components
from cityx.geometry.raster.centrelines import centrelines
from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.mask_outlines import outlines
from cityx.geometry.raster.patches import depth, label_patches
from cityx.geometry.raster.regions import parted
from cityx.geometry.raster.relief import HIGH, split_at_steps, street_ground, tell_apart
from cityx.geometry.raster.roof_measures import Roofs, measure_roofs
from cityx.sources.class_map import ClassMap, features_of, street_tags
from cityx.sources.features.tagged import Owner, Tagged, Tags, joined, tag, tag_by_place
from cityx.sources.map_classes import class_of

SOURCE = "surface"  # first word of every provenance
JOG = 1.6  # metres; shorter walls are noise of the grid
JOG_CELLS = 2.0  # and so are walls of two cells
STRAY = 1.5  # metres that a street may stray from the middle of its gap
DEAD_END = 40.0  # metres; a shorter one leads into a yard
LONE = 500.0  # metres of streets that hang together and lead nowhere, round a lone house
CARRIAGEWAY = 0.5  # share of a gap between houses; the rest are walks and front gardens
NARROWEST, WIDEST = 4.0, 10.0  # metres of carriageway
TREE_REACH = 3.0  # metres round the middle of a crown in which its top lies


@dataclass(frozen=True)
class Standing:
    """What stands on the ground of a site.

    Attributes
    ----------
    above
        (rows, columns) metres above the ground, no voids.
    houses, trees
        (rows, columns) bool.
    grid
        Where the cells lie.
    crowns
        (rows, columns) metres above the ground of the crowns.
    """

    above: FloatArray
    houses: BoolArray
    trees: BoolArray
    grid: Grid
    crowns: FloatArray


def find_standing(above: FloatArray, grid: Grid, canopy: FloatArray | None = None) -> Standing:
    """Find what stands on the ground.

    Parameters
    ----------
    above
        (rows, columns) metres above the ground, no voids.
    canopy
        The same of crowns alone; then whatever else stands is a house.
    """
    houses, trees = tell_apart(above, grid.pixel)
    if canopy is None:
        return Standing(above, houses, trees, grid, above)
    return Standing(above, houses, (canopy > HIGH) & ~houses, grid, canopy)


def features_above(found: Standing) -> Tagged:
    """Draw houses with their heights and roofs, trees, and the streets between the houses."""
    return joined(_houses(found), _trees(found), _streets(found))


def _houses(found: Standing) -> Tagged:
    bodies, _ = label_patches(found.houses)
    roofs = split_at_steps(found.houses, found.above, found.grid.pixel)
    shapes, _ = outlines(bodies, jog=max(JOG / found.grid.pixel, JOG_CELLS))
    if len(shapes) == 0:
        return tag([], [])
    shapes, _ = parted(shapes, bodies, roofs)
    shapes = found.grid.shapes_to_metres(shapes)
    return tag_by_place(
        shapes, roof_tags(measure_roofs(shapes, found.above, found.grid)), (SOURCE, "building")
    )


def roof_tags(roofs: Roofs) -> list[Tags]:
    """Write what was measured of roofs as tags of buildings."""
    tags: list[Tags] = []
    for row, height in enumerate(roofs.height.tolist()):
        own = {"building": "yes"}
        if np.isfinite(height):
            own["height"] = f"{max(height, HIGH):.1f}"
        if roofs.shape[row]:
            own["roof:shape"] = str(roofs.shape[row])
        if roofs.rise[row] > 0:
            own["roof:height"] = f"{min(float(roofs.rise[row]), height - HIGH / 2):.1f}"
            own["roof:orientation"] = "across" if roofs.across[row] else "along"
        tags.append(own)
    return tags


def _trees(found: Standing) -> Tagged:
    """Draw small crowns as trees with their heights, large ones as woods."""
    from scipy import ndimage

    classes = (class_of("ground"), class_of("tree"))
    drawn = features_of(ClassMap(found.trees.astype(np.uint8), classes, found.grid), SOURCE)
    reach = max(3, int(2 * TREE_REACH / found.grid.pixel) | 1)
    tops = ndimage.maximum_filter(found.crowns, reach)
    single = shapely.get_type_id(drawn.shapes) == 0
    heights = found.grid.values_at(tops, shapely.get_coordinates(drawn.shapes[single]))
    owners = list(drawn.owners)
    for row, height in zip(drawn.owner[single].tolist(), heights.tolist(), strict=True):
        own = owners[row]
        owners[row] = Owner(own.key, {**own.tags, "height": f"{height:.1f}"}, own.more)
    return Tagged(drawn.shapes, drawn.owner, drawn.k, owners)


def _streets(found: Standing) -> Tagged:
    """Lay streets along the middles of the gaps between blocks."""
    pixel = found.grid.pixel
    ground = street_ground(found.houses, found.above, pixel)
    lines = centrelines(ground, tolerance=STRAY / pixel).lines
    lines = _leading(lines, found.grid)
    if len(lines) == 0:
        return tag([], [])
    deep = depth(ground)
    room = [_room(line, deep) * pixel for line in lines]
    tags = [street_tags(min(max(CARRIAGEWAY * width, NARROWEST), WIDEST)) for width in room]
    return tag_by_place(found.grid.shapes_to_metres(lines), tags, (SOURCE, "road"))


def _room(line: Any, deep: FloatArray) -> float:
    """Return the cells from wall to wall along a street, the median."""
    rows, columns = deep.shape
    spots = shapely.get_coordinates(shapely.segmentize(line, 2.0))
    column = np.clip(spots[:, 0].astype(int), 0, columns - 1)
    return 2 * float(np.median(deep[np.clip(spots[:, 1].astype(int), 0, rows - 1), column]))


def _leading(lines: NDArray[Any], grid: Grid) -> NDArray[Any]:
    """Leave out short dead ends, and ways round lone houses."""
    box = shapely.box(0, 0, grid.columns, grid.rows)
    rim = shapely.buffer(box.boundary, STRAY / grid.pixel + 1)
    while len(lines):
        ends = shapely.get_point(np.repeat(lines, 2), np.tile([0, -1], len(lines)))
        _, node, degree = np.unique(
            shapely.get_coordinates(ends), axis=0, return_inverse=True, return_counts=True
        )
        loose = (degree[node.ravel()] == 1) & ~shapely.intersects(rim, ends)
        short = shapely.length(lines) * grid.pixel < DEAD_END
        dropped = loose.reshape(-1, 2).any(axis=1) & short
        lines = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines[~dropped])))
        if not dropped.any():
            break
    if len(lines) == 0:
        return lines
    group = _groups(lines)
    length = np.bincount(group, shapely.length(lines) * grid.pixel)
    at_rim = np.bincount(group, shapely.intersects(rim, lines)) > 0
    kept = at_rim | (length >= LONE)
    return np.asarray(lines[kept[group]], object)


def _groups(lines: NDArray[Any]) -> NDArray[np.int64]:
    """Return the number of the network that each line belongs to."""
    first, second = shapely.STRtree(lines).query(lines, predicate="intersects")
    group = components(np.column_stack([first, second]), len(lines))
    return np.unique(group, return_inverse=True)[1].astype(np.int64)
