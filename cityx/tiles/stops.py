"""Stops: data sets over tiles, which are loaded one after the other with those about them.

A stop is a tile and what lies within `REACH` of it, joined as one city when its turn comes and
given up after it. Cameras of a stop are in the tile itself, so that each sees at least so far.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from cityx.city import City, Layout
from cityx.dataset.making import Hands
from cityx.dataset.order import TILE, Source
from cityx.errors import InputError, UsageError
from cityx.tiles.grid import Box, Tile, in_order, tile_at, tile_named, tiles_of
from cityx.tiles.order import read_order
from cityx.tiles.ownership import owned
from cityx.tiles.plane import box_in_frame, origin_of, tiles_in
from cityx.tiles.region import Region, region_about, write_region
from cityx.tiles.run import records

if TYPE_CHECKING:
    from cityx.dataset.cities import Say, Site
    from cityx.dataset.order import Order
    from cityx.dataset.shots import Shot

REACH = 500.0  # metres; what is farther from a tile is not in its pictures
MOST = 4096  # stops of a data set


def stops_in(folder: Path, area: Box | None, plan: str = "street") -> tuple[Source, ...]:
    """Return the stops of a folder of tiles, along the curve of Morton.

    Parameters
    ----------
    folder
        Of tiles.
    area
        Metres of the frame of the run; None for all tiles that are built, or, when the plan is a
        file, for those in which its cameras are.
    plan
        Of the data set.

    Raises
    ------
    InputError, UsageError
        If the folder holds no tiles, or none of them is meant; or more than `MOST`.
    """
    order, known = read_order(folder)
    tiles: Iterable[Tile]
    if area is not None:
        tiles = tiles_in(order, area) if order.plane is not None else tiles_of(area, order.size)
        missed = "lies in the area; cityx tiles plan shows where they lie"
    elif Path(plan).is_file():
        tiles = _under(Path(plan), City(order.name, order.frame, Layout(order.site)), order.size)
        missed = f"lies under the cameras of {plan}"
    else:
        tiles = records(folder)
        missed = f"of {folder} is built yet; --at and --area name those that are to be"
    tiles = in_order(tiles if order.plane is not None else {*known} & {*tiles})
    if not tiles:
        raise InputError(f"No tile {missed}.")
    if len(tiles) > MOST:
        raise UsageError(f"{len(tiles):,} tiles are meant, a data set takes {MOST:,}; give --area.")
    return tuple(
        Source(f"tile_{tile.name}", TILE, folder, tile=tile.name, hash=_about(folder, tile).key)
        for tile in tiles
    )


def _under(path: Path, city: City, size: float) -> set[Tile]:
    """Return the tiles in which the cameras of a file are."""
    from cityx.dataset.plans.custom import read_plan

    places = [take.position for take in (item.take for item in read_plan(path, city))]
    return {tile_at(x, y, size) for own in places for x, y, _ in own.tolist()}


def _about(folder: Path, tile: Tile) -> Region:
    """Return the tiles that are loaded for one."""
    order, _ = read_order(folder)
    west, south, east, north = tile.box(order.size)
    side = order.size + 2 * REACH
    return region_about(folder, ((west + east) / 2, (south + north) / 2), (side, side))


def build_stop(source: Source, order: Order, work: Path, say: Say) -> None:
    """Join what a stop loads, unless it is there; any other city is built as always.

    Raises
    ------
    InputError, UsageError
        If a tile cannot be built or joined.
    """
    if source.kind != TILE or source.path is None:
        from cityx.dataset.cities import build_source

        build_source(source, order, work, say)
        return
    out = work / "cities" / source.name
    if (out / "report.json").is_file():
        return
    tile = tile_named(source.tile)
    region = _about(source.path, tile)
    near = box_in_frame(region.order, tile, REACH)
    write_region(region, out, lambda line: say(f"{source.name}: {line}"), within=near)


def plan_stop(site: Site, order: Order) -> tuple[Shot, ...]:
    """Plan the shots of a stop: those whose cameras are in its tile.

    A tile without any place for a plan that is drawn has none.

    Raises
    ------
    InputError, UsageError
        As of `cityx.dataset.cities.plan_shots`.
    """
    from cityx.dataset.cities import plan_shots
    from cityx.dataset.plans.planning import is_file

    source = site.source
    if source.kind != TILE or source.path is None:
        return plan_shots(site, order)
    run, _ = read_order(source.path)
    tile = tile_named(source.tile)
    box = box_in_frame(run, tile)
    city = replace(owned(site.city, box), ground=site.city.ground, scene=site.city.scene)
    drawn = not is_file(order.plan)
    try:
        return plan_shots(replace(site, city=city), order, within=box, origin=origin_of(run, tile))
    except InputError:
        if drawn:
            return ()
        raise


HANDS = Hands(build=build_stop, plan=plan_stop)
