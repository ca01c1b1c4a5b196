"""Layers of a city against the input they were made of, on cells of one metre."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.facts import Facts
from cityx.checks.predicates.thing_predicates import CannotTell
from cityx.city import City, Frame
from cityx.city.frame import NOWHERE
from cityx.city.sites import WINDOW, cut, moved, window_about
from cityx.geometry.arrays import BoolArray
from cityx.geometry.raster.grid import Grid
from cityx.options import HowToRead
from cityx.sources.class_map import ClassMap
from cityx.sources.intake import input_of, read_alone
from cityx.sources.map_classes import Role

CELL = 1.0  # metres
READER = "layout/inputs-v"  # action that reads inputs, without its version
LARGEST = 40_000_000  # cells that are compared at once
WATER_WORDS = ("water", "sea", "river", "lake")
GREEN_WORDS = ("grass", "park", "wood", "forest", "vegetation", "meadow", "garden", "tree")
Box = tuple[float, float, float, float]


def overlap_of_layers(facts: Facts, layer: str, path: Path) -> tuple[float, str]:
    """Return intersection over union of a layer and what an input shows of it.

    Parameters
    ----------
    layer
        "building", "road", "water" or "green".
    path
        A map, a drawing, an image of classes, or an aerial image as it is understood.

    Returns
    -------
    share
        0 to 1, over the part of the site that the input shows.
    evidence
        The areas.

    Raises
    ------
    CannotTell
        If the input shows no such layer or lies elsewhere.
    InputError
        If it cannot be read.
    """
    kind = input_of(path, facts.how).kind
    if kind == "semantic" and _window_args(facts.city) is None:
        shown, box = _of_classes(path, layer, facts)
    elif kind in ("osm", "drawn", "satellite", "semantic"):
        shown, box = _of_layout(path, layer, facts)
    else:
        raise CannotTell(f"{path.name} is {kind} and shows no {layer} that could be compared")
    grid = _grid(facts.city.layout.extent, box)
    wanted = shown(grid)
    own = _filled(facts.region(layer), grid)
    both, either = int((own & wanted).sum()), int((own | wanted).sum())
    if not wanted.any():
        raise CannotTell(f"{path.name} shows no {layer} within the site")
    return both / either, (
        f"{layer}: {own.sum():,} m2 of the city, {wanted.sum():,} m2 of {path.name}, {both:,} m2 "
        "of both"
    )


def _grid(site: Box, shown: Box) -> Grid:
    """Return the cells of what the site and an input share."""
    low, high = np.maximum(site[:2], shown[:2]), np.minimum(site[2:], shown[2:])
    columns, rows = np.floor((high - low) / CELL).astype(int).tolist()
    if min(columns, rows) < 1:
        raise CannotTell("the input lies elsewhere than the city")
    if columns * rows > LARGEST:
        raise CannotTell(f"the site has more than {LARGEST:,} cells of {CELL:g} m")
    return Grid(rows, columns, CELL, float(low[0]), float(low[1] + rows * CELL))


def _filled(region: Any, grid: Grid) -> BoolArray:
    """Return the cells whose middles lie in a region."""
    parts = shapely.get_parts([region])
    return np.asarray(grid.numbered(parts[shapely.area(parts) > 0]) > 0)


def open_area(shapes: NDArray[Any], covered: NDArray[Any], city: City) -> float:
    """Return the square metres of the site that lie in some shapes and in none of others."""
    grid = _grid(city.layout.extent, city.layout.extent)
    free = (grid.numbered(shapes) > 0) & (grid.numbered(covered) == 0)
    return float(free.sum() * grid.pixel**2)


Shown = Callable[[Grid], BoolArray]


def _of_layout(path: Path, layer: str, facts: Facts) -> tuple[Shown, Box]:
    """Return what a file shows of a layer, and where it lies, in the city's frame."""
    city = facts.city
    if path not in facts.read:
        how = replace(facts.how, seed=city.seed, place=city.frame.place)
        facts.read[path] = read_alone(path, how)
    found = facts.read[path]
    layout = (
        found.layout if found.frame == NOWHERE else moved(found.layout, found.frame, city.frame)
    )
    args = _window_args(city)
    if args is not None:  # buildings that its border cuts are in the city wholly or not at all
        layout = cut(layout, _window(layout.extent, city, args))
    source = Facts(City("input", city.frame, layout, seed=city.seed))
    return lambda grid: _filled(source.region(layer), grid), layout.extent


def _window_args(city: City) -> Mapping[str, Any] | None:
    """Return what was said of the window that a city was cut out of its inputs by, if it was."""
    for action, args in city.made.items():
        if action.startswith(READER) and {"width", "depth", "latitude"} & args.keys():
            return args
    return None


def _window(extent: Box, city: City, args: Mapping[str, Any]) -> Box:
    """Return that window, frame of the city."""
    centre = (extent[0] + extent[2]) / 2, (extent[1] + extent[3]) / 2
    if "latitude" in args and city.frame != NOWHERE:
        x, y = city.frame.to_local([[args["longitude"], args["latitude"]]])[0].tolist()
        if extent[0] <= x <= extent[2] and extent[1] <= y <= extent[3]:
            centre = x, y
    width, depth = (args.get(name) or WINDOW for name in ("width", "depth"))
    return window_about(extent, centre, width, depth)


def _of_classes(path: Path, layer: str, facts: Facts) -> tuple[Shown, Box]:
    """Do the same for an image of classes, pixel by pixel."""
    from cityx.sources.semantic_map import read_class_map

    city, how = facts.city, facts.how
    found, frame, _ = read_class_map(
        path, legend=how.legend or None, pixel=how.pixel, confirm=how.confirm_legend
    )
    mask = _MASKS[layer](found)

    def shown(grid: Grid) -> BoolArray:
        row, column = np.mgrid[0 : grid.rows, 0 : grid.columns]
        points = grid.to_metres(np.column_stack([column.ravel(), row.ravel()]) + 0.5)
        values = found.grid.values_at(mask, _carried(points, city.frame, frame))
        return values.reshape(grid.rows, grid.columns)

    return shown, _box_in(found.grid.extent, frame, city.frame)


def _carried(points: NDArray[np.float64], old: Frame, new: Frame) -> NDArray[np.float64]:
    return (
        points if NOWHERE in (old, new) or old == new else new.to_local(old.to_geographic(points))
    )


def _box_in(box: Box, old: Frame, new: Frame) -> Box:
    corners = np.array([(box[0], box[1]), (box[2], box[1]), (box[0], box[3]), (box[2], box[3])])
    x, y = _carried(corners, old, new).T
    return float(x.min()), float(y.min()), float(x.max()), float(y.max())


def _mask_of(found: ClassMap, known: tuple[str, ...]) -> BoolArray:
    words = {item.word for item in found.classes if any(word in item.word for word in known)}
    return np.asarray(
        np.any(
            [found.mask_of(word) for word in words] or [np.zeros_like(found.labels, bool)], axis=0
        )
    )


_MASKS: Mapping[str, Callable[[ClassMap], BoolArray]] = {
    "building": lambda found: found.mask(Role.BUILDING),
    "road": lambda found: found.mask(Role.ROAD),
    "water": lambda found: _mask_of(found, WATER_WORDS),
    "green": lambda found: _mask_of(found, GREEN_WORDS),
}


def height_correlation(city: City, path: Path, how: HowToRead) -> tuple[float, str]:
    """Return the correlation of the terrain with the height file it was made of.

    Raises
    ------
    CannotTell
        If one of the two is level, or the file says nothing of the ground.
    InputError
        If it cannot be read or does not cover the site.
    """
    from cityx.sources.heights.height_files import HeightOptions
    from cityx.sources.heights.height_source import lay_terrain, read_heights

    options = HeightOptions(span=how.height_range, crs=how.height_crs, pixel=how.pixel)
    heights = read_heights(path, options)
    if not heights.has_ground:
        raise CannotTell(f"{path.name} says nothing of the ground")
    bare = lay_terrain(City("input", city.frame, city.layout), heights).terrain
    grid = _grid(city.layout.extent, city.layout.extent)
    step = max(int(np.sqrt(grid.rows * grid.columns / 40_000)), 1)
    row, column = np.mgrid[0 : grid.rows : step, 0 : grid.columns : step]
    points = grid.to_metres(np.column_stack([column.ravel(), row.ravel()]) + 0.5)
    own, wanted = city.terrain.height_at(points), bare.height_at(points)
    if np.ptp(wanted) == 0:
        raise CannotTell(f"{path.name} is level, which correlates with nothing")
    value = float(np.corrcoef(own, wanted)[0, 1]) if np.ptp(own) > 0 else 0.0
    return value, f"the terrain and {path.name} correlate by {value:.4f} at {len(points):,} places"
