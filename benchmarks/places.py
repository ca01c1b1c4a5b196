"""Where benchmarks of movement take place: windows of real maps."""

from __future__ import annotations

import math
from pathlib import Path

from cityx.options import BuildOptions
from cityx.projects.build import build

MAPS = Path(__file__).resolve().parents[2] / "shared" / "data" / "osm"
# Name -> map, middle of the window (latitude, longitude; its own when None), edge in metres.
PLACES: dict[str, tuple[str, tuple[float, float] | None, float]] = {
    "soho": ("london_soho.osm.gz", None, 500.0),
    "ichigaya": ("tokyo_ichigaya.osm.gz", None, 500.0),
    "berlin": ("berlin_moabit_utymap.osm.gz", None, 600.0),
    "krems": ("krems.osm.gz", (48.4095, 15.6035), 700.0),
    "east village": ("new_york_east_village.osm.gz", None, 600.0),
}
BLOCK, BLOCKS = 140.0, 9  # metres between streets of the grid, and blocks along a side
MAIN = 3  # every such street of it is a main one; where two meet are signals
STOP_ASIDE = 5.0  # metres from the middle of a street to its stops, between which people walk
METRES = 111_200.0  # of a degree of latitude
MIDDLE = (52.0, 13.0)


def grid(folder: Path) -> Path:
    """Build a grid of streets with sidewalks that holds hundreds of vehicles and people."""
    made = folder / "grid"
    if made.exists():
        return made
    file = folder / "grid.osm"
    step = BLOCK / METRES, BLOCK / METRES / math.cos(math.radians(MIDDLE[0]))
    count, lines = BLOCKS + 1, ['<osm version="0.6">']
    for i in range(count):
        for j in range(count):
            kind = "traffic_signals" if i % MAIN == 0 and j % MAIN == 0 else ""
            lines.append(_node(1 + i * count + j, (i, j), step, kind))
            stop = i, min(j + 0.5, BLOCKS - 0.5)  # on the walk amid a block
            aside = stop[0] + STOP_ASIDE / BLOCK, stop[1]
            lines.append(_node(10_000 + i * count + j, aside, step, "bus_stop"))
    for number in range(2 * count):
        main, across = number // 2 % MAIN == 0, number % 2
        nodes = [1 + (number // 2 * count + k if across else k * count + number // 2)
                 for k in range(count)]  # fmt: skip
        tags = {"highway": "secondary" if main else "residential", "lanes": "2",
                "sidewalk": "both", "width": "6.5", "maxspeed": "50"}  # fmt: skip
        lines += [f'<way id="{number + 1}">', *(f'<nd ref="{node}"/>' for node in nodes),
                  *(f'<tag k="{key}" v="{value}"/>' for key, value in tags.items()),
                  "</way>"]  # fmt: skip
    file.write_text("\n".join([*lines, "</osm>"]))
    build([file], made, BuildOptions(lod=1, formats=(), render=False))
    return made


def _node(number: int, place: tuple[float, float], step: tuple[float, float], kind: str) -> str:
    """Return a node of the grid as XML."""
    lat, lon = (middle + size * (along - BLOCKS / 2)
                for middle, size, along in zip(MIDDLE, step, place, strict=True))  # fmt: skip
    tags = f'<tag k="highway" v="{kind}"/>' if kind else ""
    return f'<node id="{number}" lat="{lat:.7f}" lon="{lon:.7f}">{tags}</node>'


def built(name: str, kept: Path, *, lod: int) -> Path:
    """Build a place in a folder of its name, without pictures, unless it is there already."""
    file, at, size = PLACES[name]
    folder = kept / name.replace(" ", "_")
    if not folder.exists():
        options = BuildOptions(lod=lod, size=(size, size), at=at, formats=(), render=False)
        build([MAPS / file], folder, options)
    return folder
