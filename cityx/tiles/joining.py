"""Tiles about a place as a city or a world for a simulator, joined in a process of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cityx.errors import UsageError
from cityx.sim.places import JOINER, answer_order, compiled_scenery, in_process, keep
from cityx.sim.scenery import Scenery
from cityx.sim.world import World, kept_scenery, kept_world
from cityx.tiles.order import read_order
from cityx.tiles.region import Region, kept_region, place_of, region_about, region_city


def joined_folder(tiles: Path, at: str, size: tuple[float, float]) -> Path:
    """Return the folder of the tiles about a place as one city, in the cache.

    Parameters
    ----------
    tiles
        Folder of tiles.
    at
        As of `cityx.tiles.region.place_of`.
    size
        Width and depth, metres.

    Raises
    ------
    InputError, UsageError
        If there is no such place, or its tiles cannot be joined.
    """
    return kept_region(region_about(tiles, place_of(read_order(tiles)[0], at), size))


def region_world(region: Region) -> World:
    """Return the world of the tiles of a region, compiled in a process of its own if none is kept.

    A journey reads many of them one after the other: what joins tiles and compiles takes ten times
    the memory of a world, and gives it back when it ends.

    Raises
    ------
    InputError, UsageError
        If its tiles cannot be joined, or have no lane.
    """
    world = kept_world(region.key, region.name)
    if world is not None:
        return world
    in_process(_order_of(region, "compile"), JOINER)
    world = kept_world(region.key, region.name)
    return world or compiled_world(region)  # without a cache it is compiled here


def compiled_world(region: Region) -> World:
    """Return the world of a region, and keep it."""
    from cityx.sim.compile.worlds import compile_world

    world = compile_world(region_city(region), region.key)
    keep(world)
    return world


def region_scenery(region: Region) -> Scenery:
    """Return what cameras see of a region, compiled in a process of its own if none is kept.

    Raises
    ------
    InputError, UsageError
        If its tiles cannot be joined.
    """
    scenery = kept_scenery(region.key, region.name)
    if scenery is None:
        in_process(_order_of(region, "scenery"), JOINER)
        scenery = kept_scenery(region.key, region.name)
    return scenery or compiled_scenery(region_city(region), region.key)


def _order_of(region: Region, what: str) -> dict[str, Any]:
    """Return how another process is asked for something of a region."""
    (west, south, east, north), size = region.box, region.order.size
    return {
        what: str(region.folder.resolve()), "key": region.key,
        "middle": [(west + east) / 2, (south + north) / 2],
        "size": [east - west - size / 2, north - south - size / 2],
    }  # fmt: skip


def _answered(order: dict[str, Any]) -> dict[str, Any]:
    for what in ("compile", "scenery"):
        if what not in order:
            continue
        (x, y), (wide, deep) = order["middle"], order["size"]
        region = region_about(Path(order[what]), (x, y), (wide, deep))
        if region.key != order["key"]:
            raise UsageError(f"Tiles of {order[what]} have changed meanwhile; begin again.")
        if what == "compile":
            compiled_world(region)
        else:
            compiled_scenery(region_city(region), region.key)
        return {}
    wide, deep = order["size"]
    return {"folder": str(joined_folder(Path(order["tiles"]), order["at"], (wide, deep)))}


if __name__ == "__main__":
    answer_order(_answered)
