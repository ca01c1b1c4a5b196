"""Build windows of one place about one middle and tell which objects of the inner part are equal.

    python benchmarks/windows.py MAP [--height FILE] [--at LAT,LON] [--inner 300] [--largest 1500]
    [--margins 0,50,100,200,350] [--lod 1] [--source] [--seed 0]
    python benchmarks/windows.py --plane X,Y ...

Each window is the inner square with a margin round it; it is compared with the largest one. By
default the layout is that of the whole map, cut to each window; with --source the map is read anew
within each window, as a tile reads its part of a country. --plane takes the endless plane of towns.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from cityx_bench.windows import Box, box_about, compared, table

from cityx.city import City
from cityx.city.frame import NOWHERE
from cityx.sources.heights.height_source import lay_terrain, read_heights
from cityx.sources.osm import read_osm
from cityx.tiles.actions import built, plan_of
from cityx.town.crop import windowed
from cityx.town.plane import Plan
from cityx.town.window import layout_of_window, origin_of


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("map", type=Path, nargs="?")
    parser.add_argument("--height", type=Path)
    parser.add_argument("--at", help="LAT,LON of the middle; that of the map by default.")
    parser.add_argument("--plane", help="X,Y of the middle in the plane of towns, metres.")
    parser.add_argument("--inner", type=float, default=300.0)
    parser.add_argument("--largest", type=float, default=1500.0)
    parser.add_argument("--margins", default="0,50,100,200,350")
    parser.add_argument("--lod", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--source", action="store_true", help="Read the map anew in each window.")
    options = parser.parse_args()
    site = _plane(options) if options.plane else _map(options)
    items = plan_of([options.map] if options.map else [], options.lod, options.seed)
    middle, layout_in = site
    inner = box_about(*middle, options.inner / 2)

    def window(half: float) -> City:
        return built(layout_in(box_about(*middle, half)), items)

    largest = window(options.largest / 2)
    columns = {}
    for margin in map(float, options.margins.split(",")):
        own = window(options.inner / 2 + margin)
        columns[f"{margin:g} m"] = compared(largest, own, inner)
    print(table(columns))


Site = tuple[tuple[float, float], Callable[[Box], City]]


def _map(options: argparse.Namespace) -> Site:
    """Return the middle of the windows, and what reads the layout of one."""
    whole = read_osm(options.map, seed=options.seed)
    xmin, ymin, xmax, ymax = whole.layout.extent
    x, y = round((xmin + xmax) / 2), round((ymin + ymax) / 2)
    if options.at:
        latitude, longitude = map(float, options.at.split(","))
        x, y = whole.frame.to_local([[longitude, latitude]])[0].round().tolist()
    heights = read_heights([options.height]) if options.height else None
    ground: dict[str, float] = {}

    def layout_in(box: Box) -> City:
        if options.source:
            city = read_osm(options.map, seed=options.seed, frame=whole.frame, box=box)
        else:
            city = windowed(whole, box)
        if heights is not None:
            # The largest window, which is the first, says what a run would say for all of them.
            city = lay_terrain(city, heights, **ground)
            ground.update(cell=city.terrain.cell, datum=city.terrain.datum)
        return _with(city, options)

    return (x, y), layout_in


def _with(city: City, options: argparse.Namespace) -> City:
    from dataclasses import replace

    done = city.stages_done | {"terrain"}
    return replace(city, seed=options.seed, lod=options.lod, stages_done=done)


def _plane(options: argparse.Namespace) -> Site:
    x, y = map(float, options.plane.split(","))
    shift = origin_of(box_about(x, y, 1.0))

    def layout_in(box: Box) -> City:
        window = (box[0] + shift[0], box[1] + shift[1], box[2] + shift[0], box[3] + shift[1])
        layout = layout_of_window(window, Plan(), options.seed, frame=NOWHERE)
        return _with(City("plane", NOWHERE, layout), options)

    return (x - shift[0], y - shift[1]), layout_in


if __name__ == "__main__":
    main()
