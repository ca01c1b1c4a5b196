"""Measure the round trip through a raster: maps become semantic maps, and these maps again.

    python benchmarks/raster.py [MAP...] [--pixel 0.5] [--window 1000]

Without maps the ten of ``MAPS`` are read from ``../shared/data/osm``. The middle of each is painted
as a semantic map; the table compares what is drawn from it with what was painted:

drawn, bodies outlines on the map, and bodies of houses that hang together in the raster: a raster
              of classes says no more, so a body is what one house is compared with
iou, count    mean IoU of bodies with the best house found, and how many more houses there are
right, (was)  share of corners within 5 degrees of a right angle, and in the map
comp, corr    share of the streets' length found within 3 m, and of what was found that is true
junctions     how many more there are than the map shows, where houses lie over streets that pass
              under them; those nearer than 12 m are one
share         greatest difference of the area of a class, points of the site
cpu           seconds from the raster to the layout
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from rasterio.features import rasterize
from rasterio.transform import Affine

from cityx.city import City, Layout
from cityx.geometry.chains import components
from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.patches import label_patches
from cityx.sources.class_map import ClassMap, layout_of
from cityx.sources.features.vocabulary import CARS
from cityx.sources.map_classes import class_of
from cityx.sources.osm import read_osm
from cityx.town.crop import crop

DATA = Path(__file__).parents[2] / "shared" / "data" / "osm"
MAPS = (
    "villeurbanne_5.osm.gz", "london_soho.osm.gz", "new_york_east_village.osm.gz",
    "sydney_glebe.osm.gz", "krems.osm.gz", "tokyo_kanda.osm.gz", "seattle_roosevelt.osm.gz",
    "nuremberg_laufamholz.osm", "berlin_neukoelln_streets.osm.gz", "harrisburg.osm.gz",
)  # fmt: skip
SMALLEST = 12.0  # square metres of a house
NEAR = 3.0  # metres
ONE_JUNCTION = 12.0  # metres
RIGHT = 5.0  # degrees
LEAST_STUB = 1.0  # metres by which a street must leave another to be seen
# Class of the map -> kinds of area painted in it, later ones over earlier ones.
LAND = {
    "grass": ("grass", "park", "garden", "meadow", "golf", "pitch", "cemetery", "playground"),
    "wood": ("wood", "scrub", "orchard"),
    "farmland": ("farmland",),
    "bare": ("bare", "sand", "rock", "construction"),
    "water": ("water", "sea", "river", "pool"),
}
CLASSES = ("ground", *LAND, "road", "building")


def streets(layout: Layout) -> tuple[Any, Any]:
    """Return the centrelines and widths of the streets on the ground."""
    rows = layout.roads
    rows = rows[rows["kind"].isin(CARS) & ~rows["tunnel"] & ~rows["passage"]]
    return rows.geometry.to_numpy(), rows["width"].to_numpy()


def painted(layout: Layout, grid: Grid) -> np.ndarray:
    """Paint a layout as labels of `CLASSES`."""
    lines, width = streets(layout)
    kinds = layout.areas["kind"]
    layers = [
        (shape, 1 + label)
        for label, words in enumerate(LAND.values())
        for shape in layout.areas.geometry[kinds.isin(words)]
    ]
    layers += [(shape, CLASSES.index("road")) for shape in shapely.buffer(lines, width / 2)]
    layers += [(shape, CLASSES.index("building")) for shape in layout.buildings.geometry]
    place = Affine(grid.pixel, 0.0, grid.west, 0.0, -grid.pixel, grid.north)
    return rasterize(layers, (grid.rows, grid.columns), transform=place, dtype=np.uint8)


def bodies(layout: Layout, labels: np.ndarray, grid: Grid) -> Any:
    """Return the houses of a layout, those that hang together in the raster as one."""
    patches, _ = label_patches(labels == CLASSES.index("building"))
    shapes = layout.buildings.geometry.to_numpy()
    number = grid.values_at(patches, shapely.get_coordinates(shapely.point_on_surface(shapes)))
    found = [shapely.union_all(shapes[number == n]) for n in np.unique(number[number > 0])]
    joined = np.array(found, object)
    return joined[shapely.area(joined) > SMALLEST]


def mean_iou(truth: Any, found: Any) -> float:
    """Return the mean over true houses of the IoU with the best of those found."""
    row, other = shapely.STRtree(found).query(truth, predicate="intersects")
    shared = shapely.area(shapely.intersection(truth[row], found[other]))
    every = shapely.area(truth[row]) + shapely.area(found[other]) - shared
    best = np.zeros(len(truth))
    np.maximum.at(best, row, shared / every)
    return float(best.mean())


def right_angles(shapes: Any) -> float:
    """Return the share of corners that are right angles."""
    rings = shapely.get_rings(shapely.simplify(shapes, 0.05))
    bends = []
    for ring in rings:
        edge = np.diff(shapely.get_coordinates(ring), axis=0)
        heading = np.degrees(np.arctan2(edge[:, 1], edge[:, 0]))
        bends.append((np.roll(heading, -1) - heading + 180) % 360 - 180)
    turn = np.abs(np.concatenate(bends))
    return float((np.abs(turn - 90) < RIGHT).mean())


def noded(lines: Any) -> tuple[Any, Any, Any]:
    """Cut streets where they meet: pieces, the places at their ends, and the two of each piece."""
    pieces = shapely.get_parts(shapely.line_merge(shapely.node(shapely.union_all(lines))))
    ends = np.stack([shapely.get_coordinates(shapely.get_point(pieces, i)) for i in (0, -1)], 1)
    place, row = np.unique(np.round(ends.reshape(-1, 2), 2), axis=0, return_inverse=True)
    return pieces, place, row.reshape(-1, 2)


def shown(layout: Layout) -> Any:
    """Return the streets that a map of classes shows: nothing under houses or within a street."""
    lines, width = streets(layout)
    houses = layout.buildings.geometry.to_numpy()
    pieces, place, ends = noded(shapely.difference(lines, shapely.union_all(houses)))
    street = shapely.STRtree(lines)
    spot, of = street.query(shapely.points(place), predicate="dwithin", distance=0.1)
    half = np.zeros(len(place))
    np.maximum.at(half, spot, width[of] / 2)
    loose = np.bincount(ends.ravel(), minlength=len(place))[ends] == 1
    room = np.where(loose, 0.0, half[ends]).max(axis=1) + LEAST_STUB
    return pieces[~(loose.any(axis=1) & (shapely.length(pieces) < room))]


def junctions(lines: Any) -> int:
    """Count the places where three or more streets meet."""
    _, place, ends = noded(lines)
    count = np.bincount(ends.ravel(), minlength=len(place))
    spots = shapely.points(place[count >= 3])
    pairs = shapely.STRtree(spots).query(spots, predicate="dwithin", distance=ONE_JUNCTION)
    return len(np.unique(components(pairs.T, len(spots))))


def share_within(lines: Any, others: Any) -> float:
    """Return the share of the length of lines that lies near others."""
    every, near = shapely.union_all(lines), shapely.buffer(shapely.union_all(others), NEAR)
    return float(shapely.length(shapely.intersection(every, near)) / shapely.length(every))


def round_trip(city: City, pixel: float) -> dict[str, float]:
    """Paint a city, vectorise it again and measure."""
    xmin, ymin, xmax, ymax = city.layout.extent
    grid = Grid(round((ymax - ymin) / pixel), round((xmax - xmin) / pixel), pixel, xmin, ymax)
    labels = painted(city.layout, grid)
    begin = time.process_time()
    classes = tuple(class_of(word) for word in CLASSES)
    layout, _ = layout_of(ClassMap(labels, classes, grid), city.frame, source="raster", seed=0)
    spent = time.process_time() - begin
    truth, found = bodies(city.layout, labels, grid), layout.buildings.geometry.to_numpy()
    true_lines, lines = streets(city.layout)[0], streets(layout)[0]
    before, after = (
        np.bincount(plane.ravel(), minlength=len(CLASSES)) / plane.size
        for plane in (labels, painted(layout, grid))
    )
    return {
        "Mpx": labels.size / 1e6,
        "drawn": len(city.layout.buildings),
        "bodies": len(truth),
        "iou": mean_iou(truth, found),
        "count %": 100 * (len(found) / len(truth) - 1),
        "right %": 100 * right_angles(found),
        "(was)": 100 * right_angles(truth),
        "comp": share_within(true_lines, lines),
        "corr": share_within(lines, true_lines),
        "junctions %": 100 * (junctions(lines) / junctions(shown(city.layout)) - 1),
        "share pt": 100 * float(np.abs(after - before).max()),
        "cpu s": spent,
    }


def middle_of(city: City, window: float) -> City:
    """Cut the window about the middle house out of a map."""
    middle = np.median(shapely.bounds(city.layout.buildings.geometry.to_numpy()), axis=0)
    x, y = (middle[:2] + middle[2:]) / 2
    return crop(city, x=float(x), y=float(y), width=window, depth=window)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("maps", nargs="*", type=Path)
    parser.add_argument("--pixel", type=float, default=0.5)
    parser.add_argument("--window", type=float, default=1000.0)
    options = parser.parse_args()
    rows = []
    for path in options.maps or [DATA / name for name in MAPS]:
        city = middle_of(read_osm(path), options.window)
        row = round_trip(city, options.pixel)
        if not rows:
            print(f"{'':28}" + "".join(f"{name:>12}" for name in row))
        rows.append(row)
        cells = "".join(
            f"{value:12.3f}" if value % 1 else f"{value:12.0f}" for value in row.values()
        )
        print(f"{path.name.split('.')[0]:28}{cells}", flush=True)
    mean = {name: np.mean([abs(row[name]) for row in rows]) for name in rows[0]}
    print(f"{'mean of sizes':28}" + "".join(f"{value:12.3f}" for value in mean.values()))


if __name__ == "__main__":
    main()
