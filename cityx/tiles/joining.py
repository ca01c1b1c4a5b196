"""Tiles about a place as a city for a simulator, joined in a process of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cityx.sim.places import answer_order
from cityx.tiles.order import read_order
from cityx.tiles.region import kept_region, place_of, region_about


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


def _joined(order: dict[str, Any]) -> dict[str, Any]:
    wide, deep = order["size"]
    return {"folder": str(joined_folder(Path(order["tiles"]), order["at"], (wide, deep)))}


if __name__ == "__main__":
    answer_order(_joined)
