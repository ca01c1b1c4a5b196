"""What is known of a run before anything is built: its order, its tiles, what they will take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely

from cityx.errors import UsageError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.places.profiles import place_text
from cityx.projects.place_words import check_place
from cityx.sources.input_kinds import place_name
from cityx.sources.intake import sort_inputs
from cityx.sources.osm import site_of
from cityx.sources.osm.areas import candidate_ways
from cityx.sources.osm.reader import read_elements
from cityx.tiles.actions import plan_of
from cityx.tiles.grid import Box, Tile, holds, in_order, tiles_of
from cityx.tiles.order import HIGH_MARGIN, MARGIN, SIZE, Order, check_size, code_of
from cityx.tiles.plane import box_in_frame, plane_land
from cityx.tiles.relief import relief_of
from cityx.tiles.split import Survey, fragment_of, is_empty, surveyed


@dataclass(frozen=True)
class Cost:
    """What tiles take by what is in their windows: measured, see docs/tiles.md.

    Attributes
    ----------
    tile
        Of any tile.
    building, road_km, km2
        Of each building, kilometre of road and square kilometre of the window besides.
    """

    tile: float
    building: float
    road_km: float
    km2: float

    def of(self, size: Size) -> float:
        """Return what a tile takes."""
        return (
            self.tile + self.building * size.buildings + self.road_km * size.road_km
            + self.km2 * size.km2
        )  # fmt: skip


@dataclass(frozen=True)
class Size:
    """What the window of a tile holds."""

    buildings: int
    road_km: float
    km2: float


# At detail level 2, fitted to the runs of docs/tiles.md; other levels are shares of it.
CPU_S = Cost(1.1, 0.0126, 0.33, 0.0)
DISK_MB = Cost(4.0, 0.035, 1.0, 3.5)
SHARED_MB = 65.0  # prototypes that the stores of all tiles share
MEMORY_MB = Cost(500.0, 0.15, 4.0, 60.0)
CPU_OF, DISK_OF = {0: 0.2, 1: 0.65, 2: 1.0, 3: 2.8}, {0: 0.02, 1: 0.25, 2: 1.0, 3: 6.5}


@dataclass(frozen=True)
class Estimate:
    """What a run takes.

    Attributes
    ----------
    tiles, buildings, km2
        How many tiles, with what in them.
    cpu_s
        Seconds of one processor.
    memory_mb
        Of the worker with the largest tile.
    disk_mb
        Of all tiles.
    """

    tiles: int
    buildings: int
    km2: float
    cpu_s: float
    memory_mb: float
    disk_mb: float


def order_of(
    paths: Sequence[Path], *, seed: int = 0, lod: int = 2, size: float = SIZE,
    margin: float | None = None, place: str = "",
) -> tuple[Order, Path]:  # fmt: skip
    """Read what a run is about from its files.

    Parameters
    ----------
    paths
        A map, and height files of its ground.
    seed, lod, size, margin
        As of `Order`; the margin is `MARGIN`, or `HIGH_MARGIN` with heights, when None.
    place
        Profile of the place.

    Returns
    -------
    order
        What all tiles have in common.
    source
        The map.

    Raises
    ------
    UsageError, InputError
        With every fault of what is asked for.
    """
    check_size(size, MARGIN if margin is None else margin)
    if place:
        check_place(place)
    inputs = sort_inputs(list(paths))
    maps = [item.path for item in inputs.all if item.kind == "osm"]
    heights = [item.path for item in inputs.heights]
    others = [item.path.name for item in inputs.all if item.kind not in ("osm", "height")]
    if len(maps) != 1 or others:
        given = f"; {', '.join(others)} cannot be split" if others else ""
        raise UsageError(
            "Tiles are made of one OpenStreetMap file, and of heights of its ground if there are "
            f"any; {len(maps)} maps given{given}."
        )
    if margin is None:
        margin = HIGH_MARGIN if heights else MARGIN
    frame, site = site_of(read_elements(maps[0]), str(maps[0]))
    frame = replace(frame, place=place_text(place) if place else "")
    order = Order(
        place_name(maps[0].name), frame, site, seed, lod, float(size), float(margin),
        tuple(inputs.records), plan_of(paths, lod, seed), plan_of(paths, 0, seed),
        code_of(), relief=relief_of(heights, frame, site),
    )  # fmt: skip
    return order, maps[0]


def sizes_of(survey: Survey, order: Order, area: Box | None = None) -> dict[Tile, tuple[Size, int]]:
    """Return what the window of each tile holds, and how many of the buildings are its own."""
    osm = survey.osm
    solid = np.concatenate(candidate_ways(osm))
    bounds = survey.ways[solid]
    there = np.isfinite(bounds).all(axis=1)
    middles = (bounds[there, :2] + bounds[there, 2:]) / 2
    roads = np.array([row for row, tags in enumerate(osm.way_tags) if "highway" in tags], np.int64)
    flat, lengths = _pieces(survey, roads)
    found = {}
    for tile in in_order(tiles_of(order.site if area is None else area, order.size)):
        window = tile.box(order.size, order.margin)
        if is_empty(fragment_of(survey, window)):
            continue
        size = Size(
            int(holds(window, middles).sum()),
            float(lengths[holds(window, flat)].sum()) / 1e3,
            (order.size + 2 * order.margin) ** 2 / 1e6,
        )
        found[tile] = size, int(holds(tile.box(order.size), middles).sum())
    return found


def plane_sizes(order: Order, tiles: Sequence[Tile]) -> dict[Tile, tuple[Size, int]]:
    """Return what the window of each tile of the plane holds; its layout is made for that."""
    found = {}
    for tile in tiles:
        layout = plane_land(order, tile).layout
        window = box_in_frame(order, tile, order.margin)
        inside = shapely.intersection(layout.roads.geometry.to_numpy(), shapely.box(*window))
        middles = shapely.get_coordinates(shapely.centroid(layout.buildings.geometry.to_numpy()))
        size = Size(
            len(layout.buildings),
            float(shapely.length(inside).sum()) / 1e3,
            (order.size + 2 * order.margin) ** 2 / 1e6,
        )
        found[tile] = size, int(holds(box_in_frame(order, tile), middles).sum())
    return found


def times(told: Estimate, count: int, order: Order) -> Estimate:
    """Return the estimate of so many tiles from that of some of them."""
    factor, shared = count / told.tiles, DISK_OF[order.lod] * SHARED_MB
    return Estimate(
        count, round(told.buildings * factor), told.km2 * factor, told.cpu_s * factor,
        told.memory_mb, shared + (told.disk_mb - shared) * factor,
    )  # fmt: skip


def _pieces(survey: Survey, ways: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return middles and lengths of the pieces of ways."""
    from cityx.sources.osm.elements import way_lines

    lines, _ = way_lines(survey.osm, survey.xy, ways)
    xy, of = shapely.get_coordinates(lines, return_index=True)
    same = of[1:] == of[:-1]
    step = np.diff(xy, axis=0)[same]
    return xy[:-1][same] + step / 2, np.hypot(*step.T)


def estimate(sizes: dict[Tile, tuple[Size, int]], order: Order) -> Estimate:
    """Estimate what a run takes from what the windows of its tiles hold."""
    windows = [size for size, _ in sizes.values()]
    return Estimate(
        len(sizes),
        sum(own for _, own in sizes.values()),
        len(sizes) * order.size**2 / 1e6,
        CPU_OF[order.lod] * sum(map(CPU_S.of, windows)),
        max(map(MEMORY_MB.of, windows), default=0.0),
        DISK_OF[order.lod] * (SHARED_MB * bool(windows) + sum(map(DISK_MB.of, windows))),
    )


def survey_of(order: Order, source: Path) -> Survey:
    """Find where the elements of the map of an order lie."""
    return surveyed(read_elements(source), order.frame)
