"""Class maps: a raster that says what lies at each pixel becomes tagged shapes.

Semantic maps and segmented images of every kind take this way: houses become outlines with straight
walls, streets lines with widths, the rest regions that share their borders. Regions run on below
houses and streets, as on any map; the ground arrangement cuts them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Frame, Layout
from cityx.errors import InputError
from cityx.geometry.raster.centrelines import Centrelines, centrelines
from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.outlines import outlines
from cityx.geometry.raster.party_walls import parted
from cityx.geometry.raster.patches import (
    label_patches,
    split_at_necks,
    without_holes,
    without_specks,
)
from cityx.geometry.raster.regions import filled, regions, without_small_patches
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import Owner, Report, Tagged, Tags, joined, tag
from cityx.sources.map_classes import MapClass, Role

BoolArray = NDArray[np.bool_]

LEAST_BUILDING = 12.0  # square metres; a smaller patch is noise, or a shed that nobody misses
LEAST_YARD = 6.0  # square metres; a smaller hole in a house is noise
LEAST_STREET = 60.0  # square metres of a patch of street
LEAST_GAP = 20.0  # square metres; a smaller hole in a street is no block
LEAST_REGION = 30.0  # square metres
LEAST_PIXELS = 6  # of any patch, whatever it measures on the ground
CROWN = 120.0  # square metres; a larger patch of crowns is a wood
JOG = 1.6  # metres; shorter walls are drawing noise
JOG_PIXELS = 2.0  # and so are walls of two pixels
STRAY = 0.6  # metres that a centreline may stray
SOFT = 0.75  # metres over which borders of regions are smoothed, at least a pixel
SOFT_PIXELS = 1.5
# Least width in metres, class of a street and its lanes, widest first.
STREETS = (
    (16.0, "primary"), (11.0, "secondary"), (8.0, "tertiary"), (4.6, "residential"),
    (2.4, "service"), (0.0, "footway"),
)  # fmt: skip
LANE = 3.25  # metres; streets wider than two of them have more lanes
MOST_LANES = 8
WIDEST = 40.0  # metres of carriageway that can be one street


@dataclass(frozen=True)
class ClassMap:
    """What lies where.

    Attributes
    ----------
    labels
        (rows, columns) uint8, index into `classes`.
    classes
        What the labels mean.
    grid
        Where the pixels lie.
    """

    labels: NDArray[np.uint8]
    classes: tuple[MapClass, ...]
    grid: Grid

    def mask(self, *roles: Role) -> BoolArray:
        """Return the (rows, columns) pixels of some roles."""
        wanted = np.array([item.role in roles for item in self.classes], bool)
        return np.asarray(wanted[self.labels])

    def pixels(self, square_metres: float) -> float:
        """Return how many pixels an area takes, at least `LEAST_PIXELS`."""
        return max(square_metres / self.grid.pixel**2, LEAST_PIXELS)


def features_of(found: ClassMap, source: str) -> Tagged:
    """Draw everything a class map shows.

    Parameters
    ----------
    source
        First word of every provenance: "semantic", "satellite".

    Returns
    -------
    features
        Polygons, lines and points with tags, scene frame.
    """
    found = uncovered(found)
    houses = _buildings(found, source)
    streets = _ways(found, source, Role.ROAD)
    rails = _ways(found, source, Role.RAIL)
    trees, found = _trees(found, source)
    return joined(houses, streets, rails, trees, _regions(found, source))


def uncovered(found: ClassMap) -> ClassMap:
    """Let what lies below cars and the like go on below them."""
    labels = filled(found.labels, found.mask(Role.COVER))
    return ClassMap(labels, found.classes, found.grid)


def _owned(grid: Grid, source: str, word: str, shapes: NDArray[Any], tags: list[Tags]) -> Tagged:
    """Name each shape by its place, so that what changes elsewhere changes no id."""
    metres = grid.shapes_to_metres(shapes)
    along = shapely.get_dimensions(metres) == 1
    spots = shapely.point_on_surface(metres)
    spots[along] = _middles(metres[along])
    places = np.round(shapely.get_coordinates(spots), 2) + 0.0
    owners = [
        Owner((source, word, f"{x:.2f},{y:.2f}"), own)
        for (x, y), own in zip(places.tolist(), tags, strict=True)
    ]
    return tag(metres, owners)


def _buildings(found: ClassMap, source: str) -> Tagged:
    """Draw the houses, with a wall between those that touch."""
    mask = without_specks(found.mask(Role.BUILDING), found.pixels(LEAST_BUILDING))
    mask = without_holes(mask, found.pixels(LEAST_YARD))
    bodies, _ = label_patches(mask)
    jog = max(JOG / found.grid.pixel, JOG_PIXELS)
    shapes, exact = outlines(bodies, jog=jog)
    solidity = shapely.area(exact) / np.maximum(shapely.area(shapely.convex_hull(exact)), 1e-9)
    parts = _by_class(found, split_at_necks(bodies, solidity), mask)
    shapes, part = parted(shapes, bodies, parts)
    number, first = np.unique(parts, return_index=True)
    classes = found.labels.ravel()[first[np.searchsorted(number, part)]]
    return _owned(
        found.grid, source, "building", shapes, [dict(found.classes[c].tags) for c in classes]
    )


def _by_class(found: ClassMap, bodies: NDArray[Any], mask: BoolArray) -> NDArray[Any]:
    """Part bodies where the class changes; yards filled in count for the house around them."""
    from skimage.measure import label

    built = found.mask(Role.BUILDING)
    classes = filled(found.labels, mask & ~built) if (mask & ~built).any() else found.labels
    if len(np.unique(classes[mask])) < 2:
        return bodies
    both = bodies.astype(np.int64) * len(found.classes) + np.where(mask, classes, 0)
    small = without_small_patches(np.where(mask, both, 0), found.pixels(LEAST_BUILDING))
    return np.asarray(label(np.where(mask, small, 0), background=0, connectivity=1))


def _ways(found: ClassMap, source: str, role: Role) -> Tagged:
    """Draw the middles of streets or tracks; tags of the class win over those of the width."""
    ways = traced(found.mask(role), found.grid)
    middle = found.grid.to_metres(shapely.get_coordinates(_middles(ways.lines)))
    label = found.grid.values_at(found.labels, middle).tolist()
    own = [found.classes[i].tags if found.classes[i].role is role else {} for i in label]
    widths = (ways.width * found.grid.pixel).tolist() if role is Role.ROAD else []
    drawn = [street_tags(width) for width in widths] or [{} for _ in own]
    tags = [{**by_width, **said} for by_width, said in zip(drawn, own, strict=True)]
    return _owned(found.grid, source, str(role), ways.lines, tags)


def traced(mask: BoolArray, grid: Grid) -> Centrelines:
    """Trace the streets of a mask, without specks and pinholes."""
    mask = without_specks(mask, LEAST_STREET / grid.pixel**2)
    mask = without_holes(mask, LEAST_GAP / grid.pixel**2)
    return centrelines(mask, tolerance=STRAY / grid.pixel)


def streets_of(mask: BoolArray, grid: Grid, source: str) -> Tagged:
    """Draw the streets of a mask that says nothing else: lines with class, width and lanes."""
    ways = traced(mask, grid)
    tags = [street_tags(width) for width in (ways.width * grid.pixel).tolist()]
    return _owned(grid, source, "road", ways.lines, tags)


def _middles(lines: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(shapely.line_interpolate_point(lines, 0.5, normalized=True), object)


def street_tags(width: float) -> Tags:
    """Return the tags of a street that is so many metres wide from border to border."""
    width = min(width, WIDEST)
    kind = next(word for least, word in STREETS if width >= least)
    tags = {"highway": kind, "width": f"{max(width, 1.0):.1f}"}
    lanes = min(MOST_LANES, int(width / LANE) // 2 * 2)
    return {**tags, "lanes": str(lanes)} if lanes > 2 else tags


def _trees(found: ClassMap, source: str) -> tuple[Tagged, ClassMap]:
    """Take single crowns out of the map as trees; large patches stay as woods."""
    from scipy import ndimage

    patches, count = label_patches(found.mask(Role.TREE))
    size = np.bincount(patches.ravel(), minlength=count + 1)
    small = np.flatnonzero((size >= LEAST_PIXELS) & (size <= found.pixels(CROWN)))
    small = small[small > 0]
    middle = np.array(ndimage.center_of_mass(patches > 0, patches, small)).reshape(-1, 2)
    spots = shapely.points(middle[:, ::-1] + 0.5)
    across = 2 * np.sqrt(size[small] / np.pi) * found.grid.pixel
    tags: list[Tags] = [
        {"natural": "tree", "diameter_crown": f"{metres:.1f}"} for metres in across.tolist()
    ]
    trees = _owned(found.grid, source, "tree", np.asarray(spots, object).reshape(-1), tags)
    crown = (size <= found.pixels(CROWN))[patches] & (patches > 0)
    return trees, ClassMap(filled(found.labels, crown), found.classes, found.grid)


def _regions(found: ClassMap, source: str) -> Tagged:
    """Draw the land between and below houses and streets."""
    known = found.mask(Role.REGION, Role.TREE)
    if not known.any():
        return tag([], [])
    labels = filled(found.labels, ~known)
    labels = without_small_patches(labels, found.pixels(LEAST_REGION))
    smooth = max(SOFT / found.grid.pixel, SOFT_PIXELS)
    shapes, label = regions(labels, smooth=smooth, tolerance=0.3 * smooth)
    said = np.array([bool(item.tags) for item in found.classes], bool)[label]
    tags = [dict(found.classes[index].tags) for index in label[said].tolist()]
    return _owned(found.grid, source, "region", shapes[said], tags)


def layout_of(
    found: ClassMap,
    frame: Frame,
    *,
    source: str,
    seed: int,
    draw: Callable[[ClassMap, str], Tagged] = features_of,
) -> tuple[Layout, Report]:
    """Make a complete layout from a class map; see `city_of`."""
    report = Report()
    features = gather(draw(found, source), found.grid.extent, report)
    return resolve(features, frame, seed=seed), report


def city_of(
    found: ClassMap,
    frame: Frame,
    *,
    source: str,
    name: str,
    seed: int,
    notes: tuple[str, ...] = (),
    draw: Callable[[ClassMap, str], Tagged] = features_of,
) -> City:
    """Make a city with a complete layout from a class map.

    Parameters
    ----------
    frame
        Of the site; its origin is that of the map's grid.
    source
        First word of every provenance: "semantic", "satellite".
    name, seed, notes
        Of the city.
    draw
        Makes the features of a map and the first word of their provenance.

    Raises
    ------
    InputError
        If the map shows neither a building nor a street.
    """
    layout, report = layout_of(found, frame, source=source, seed=seed, draw=draw)
    if not len(layout.buildings) and not len(layout.roads):
        shown = ", ".join(sorted({found.classes[i].word for i in np.unique(found.labels).tolist()}))
        raise InputError(
            f"The map shows no city: nothing on it is a building or a street (it shows {shown}; "
            f"a pixel is {found.grid.pixel:.3g} m)."
        )
    counts = tuple(f"map: {number} {what}" for what, number in sorted(report.counts.items()))
    return City(
        name,
        frame,
        layout,
        seed=seed,
        stages_done=frozenset({"layout"}),
        notes=(*notes, *counts),
    )
