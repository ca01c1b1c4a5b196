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
from cityx.errors import InputError, UsageError
from cityx.geometry.arrays import BoolArray
from cityx.geometry.raster.centrelines import Centrelines, centrelines
from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.mask_outlines import outlines
from cityx.geometry.raster.patches import (
    label_patches,
    split_at_necks,
    without_holes,
    without_specks,
)
from cityx.geometry.raster.regions import filled, parted, regions, without_small_patches
from cityx.geometry.raster.rows import Plots, cut_into_houses
from cityx.places.profiles import usual_lane
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import Report, Tagged, Tags, joined, tag, tag_by_place
from cityx.sources.map_classes import MapClass, Role

LEAST_BUILDING = 12.0  # square metres; a smaller patch is noise, or a shed that nobody misses
LEAST_YARD = 6.0  # square metres; a smaller hole in a house is noise
LEAST_STREET = 60.0  # square metres of a patch of street
LEAST_GAP = 20.0  # square metres; a smaller hole in a street is no block
LEAST_REGION = 30.0  # square metres
LEAST_PIXELS = 6  # of any patch, whatever it measures on the ground
CROWN = 120.0  # square metres; a larger patch of crowns is a wood
EXACT, PLAUSIBLE = "exact", "plausible"  # fidelity of what is drawn to what is shown
FINEST, COARSEST = 0.05, 10.0  # metres of a pixel that can be read as a city
LARGE_HOUSE = 2500.0  # square metres from which a patch may be a row of houses
BENT = 0.62  # share of its box below which a large patch is no single house
LONG = 3.0  # area over the square of its width, from which a large patch is a row
WAVY = 2.0  # pixels that the width of a patch may be off
PLOT = (18.0, 24.0, 6.0)  # metres along and across the row that a house takes, and between two
LEAST_HOUSE = 60.0  # square metres of a house cut out of a row
JOG = 1.6  # metres; shorter walls are drawing noise
JOG_PIXELS = 2.0  # and so are walls of two pixels
STRAY = 0.6  # metres that a centreline may stray
SOFT = 0.75  # metres over which borders of regions are smoothed, at least a pixel
SOFT_PIXELS = 1.5
SEAM = 2.0  # metres; void that is narrower, or has few pixels across, is a border between classes
SEAM_PIXELS = 4.0
# Least width in metres, class of a street and its lanes, widest first.
STREETS = (
    (16.0, "primary"), (11.0, "secondary"), (8.0, "tertiary"), (4.6, "residential"),
    (2.4, "service"), (0.0, "footway"),
)  # fmt: skip
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

    def mask_of(self, word: str) -> BoolArray:
        """Return the (rows, columns) pixels of the classes of one name."""
        wanted = np.array([item.word == word for item in self.classes], bool)
        return np.asarray(wanted[self.labels])

    def pixels(self, square_metres: float) -> float:
        """Return how many pixels an area takes, at least `LEAST_PIXELS`."""
        return max(square_metres / self.grid.pixel**2, LEAST_PIXELS)


def check_asked(fidelity: str, pixel: float | None) -> None:
    """Refuse what no image can be read with.

    Raises
    ------
    InputError
        If a pixel is too small or too large for a city.
    UsageError
        If there is no such fidelity.
    """
    if fidelity not in (EXACT, PLAUSIBLE):
        raise UsageError(f'There is no fidelity "{fidelity}"; write {EXACT} or {PLAUSIBLE}.')
    if pixel is not None and not FINEST <= pixel <= COARSEST:
        raise InputError(
            f"A pixel of {pixel:g} m is of no use; an image of a city has {FINEST:g} to "
            f"{COARSEST:g}."
        )


def features_of(found: ClassMap, source: str, fidelity: str = EXACT) -> Tagged:
    """Draw everything a class map shows.

    Parameters
    ----------
    source
        First word of every provenance: "semantic", "satellite".
    fidelity
        `EXACT` for the houses that the map shows, `PLAUSIBLE` to cut whole rows into houses.

    Returns
    -------
    features
        Polygons, lines and points with tags, scene frame.
    """
    found = uncovered(found)
    houses = _buildings(found, source, fidelity)
    streets = _ways(found, source, Role.ROAD)
    rails = _ways(found, source, Role.RAIL)
    trees, found = _trees(found, source)
    return joined(houses, streets, rails, trees, _regions(found, source))


def uncovered(found: ClassMap) -> ClassMap:
    """Continue the ground below cars and the like."""
    labels = filled(found.labels, found.mask(Role.COVER))
    return ClassMap(labels, found.classes, found.grid)


def _owned(grid: Grid, source: str, word: str, shapes: NDArray[Any], tags: list[Tags]) -> Tagged:
    return tag_by_place(grid.shapes_to_metres(shapes), tags, (source, word))


def _buildings(found: ClassMap, source: str, fidelity: str) -> Tagged:
    """Draw the houses, with a wall between those that touch."""
    mask = without_specks(found.mask(Role.BUILDING), found.pixels(LEAST_BUILDING))
    mask = without_holes(mask, found.pixels(LEAST_YARD))
    rows = np.zeros_like(mask)
    if fidelity == PLAUSIBLE:
        mask, rows = _houses_of_rows(mask, found)
    bodies, _ = label_patches(mask)
    jog = max(JOG / found.grid.pixel, JOG_PIXELS)
    shapes, exact = outlines(bodies, jog=jog)
    solidity = shapely.area(exact) / np.maximum(shapely.area(shapely.convex_hull(exact)), 1e-9)
    parts = _by_class(found, split_at_necks(bodies, solidity), mask)
    shapes, part = parted(shapes, bodies, parts)
    tags = _said_of_houses(found, parts, rows)
    return _owned(found.grid, source, "building", shapes, [tags[n] for n in part.tolist()])


def _said_of_houses(found: ClassMap, parts: NDArray[Any], rows: BoolArray) -> dict[int, Tags]:
    """Return the tags of each part by its number; a house of a row is one for a family."""
    number = parts.ravel()
    built = np.flatnonzero(found.mask(Role.BUILDING).ravel() & (number > 0))
    known, first = np.unique(number[built], return_index=True)
    pixel = built[first]
    said = {}
    for part, label, cut in zip(
        known.tolist(), found.labels.ravel()[pixel].tolist(), rows.ravel()[pixel].tolist(),
        strict=True,
    ):  # fmt: skip
        tags = dict(found.classes[label].tags)
        said[part] = {**tags, "building": "house"} if cut and tags["building"] == "yes" else tags
    return said


def _houses_of_rows(mask: BoolArray, found: ClassMap) -> tuple[BoolArray, BoolArray]:
    """Cut what is no single house into houses without the shreds; tell which pixels were cut."""
    pixel = found.grid.pixel
    labels, _ = label_patches(mask)
    numbers = rows_of_houses(labels, pixel)
    plots = Plots(PLOT[0] / pixel, PLOT[1] / pixel, PLOT[2] / pixel)
    houses = cut_into_houses(labels, numbers, plots)
    return without_specks(houses, found.pixels(LEAST_HOUSE)), np.isin(labels, numbers)


def rows_of_houses(labels: NDArray[Any], pixel: float) -> NDArray[np.int64]:
    """Return the numbers of patches that are whole rows of houses: too large and bent for one."""
    area = np.bincount(labels.ravel())[1:] * pixel**2
    large = np.flatnonzero(area > LARGE_HOUSE) + 1
    if len(large) == 0:
        return large
    number = np.zeros(len(area) + 1, np.int64)
    number[large] = np.arange(1, len(large) + 1)
    _, exact = outlines(number[labels], jog=0.0)
    box = shapely.area(shapely.oriented_envelope(exact))
    deep = 2 * shapely.length(shapely.maximum_inscribed_circle(exact, WAVY))
    bent = shapely.area(exact) < BENT * box
    row = bent | (shapely.area(exact) > LONG * deep**2)
    return np.asarray(large[row], np.int64)


def _by_class(found: ClassMap, bodies: NDArray[Any], mask: BoolArray) -> NDArray[Any]:
    """Split bodies where the class changes; filled-in yards count for the house around them."""
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
    # A slit one pixel wide falls into specks and goes: one surface carries all of its lanes.
    mask = ~without_specks(~mask, LEAST_GAP / grid.pixel**2)
    return centrelines(mask, tolerance=STRAY / grid.pixel)


def _middles(lines: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(shapely.line_interpolate_point(lines, 0.5, normalized=True), object)


def street_tags(width: float) -> Tags:
    """Return the tags of a street that is so many metres wide from border to border."""
    width = min(width, WIDEST)
    kind = next(word for least, word in STREETS if width >= least)
    tags = {"highway": kind, "width": f"{max(width, 1.0):.1f}"}
    # Streets wider than two lanes have more.
    lanes = min(MOST_LANES, int(width / usual_lane()) // 2 * 2)
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
    known = found.mask(Role.REGION, Role.TREE) | _wide(found.mask(Role.VOID), found.grid.pixel)
    if not known.any():
        return tag([], [])
    labels = filled(found.labels, ~known)
    labels = without_small_patches(labels, found.pixels(LEAST_REGION))
    smooth = max(SOFT / found.grid.pixel, SOFT_PIXELS)
    shapes, label = regions(labels, smooth=smooth, tolerance=0.3 * smooth)
    said = np.array([bool(item.tags) for item in found.classes], bool)[label]
    tags = [dict(found.classes[index].tags) for index in label[said].tolist()]
    return _owned(found.grid, source, "region", shapes[said], tags)


def _wide(void: BoolArray, pixel: float) -> BoolArray:
    """Return void without its seams: colours mixed along a border are the land beside them."""
    from skimage.morphology import isotropic_opening

    if not void.any():
        return void
    return np.asarray(isotropic_opening(void, max(SEAM / 2 / pixel, SEAM_PIXELS / 2)), bool)


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
        name, frame, layout, seed=seed, stages_done=frozenset({"layout"}), notes=(*notes, *counts)
    )
