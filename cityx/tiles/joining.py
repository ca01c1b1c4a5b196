"""Tiles about a place as a city or a world for a simulator, joined in a process of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cityx.errors import UsageError
from cityx.sim.places import JOINER, answer_order, in_process, keep
from cityx.sim.world import World, kept_world
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
    (west, south, east, north), size = region.box, region.order.size
    in_process({
        "compile": str(region.folder.resolve()), "key": region.key,
        "middle": [(west + east) / 2, (south + north) / 2],
        "size": [east - west - size / 2, north - south - size / 2],
    }, JOINER)  # fmt: skip
    world = kept_world(region.key, region.name)
    return world or compiled_world(region)  # without a cache it is compiled here


def compiled_world(region: Region) -> World:
    """Return the world of a region, and keep it."""
    from cityx.sim.compile.worlds import compile_world

    world = compile_world(region_city(region), region.key)
    keep(world)
    return world


def _answered(order: dict[str, Any]) -> dict[str, Any]:
    if "compile" in order:
        (x, y), (wide, deep) = order["middle"], order["size"]
        region = region_about(Path(order["compile"]), (x, y), (wide, deep))
        if region.key != order["key"]:
            raise UsageError(f"Tiles of {order['compile']} have changed meanwhile; begin again.")
        compiled_world(region)
        return {}
    wide, deep = order["size"]
    return {"folder": str(joined_folder(Path(order["tiles"]), order["at"], (wide, deep)))}


if __name__ == "__main__":
    answer_order(_answered)
