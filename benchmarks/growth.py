"""Measure how CPU time grows with the city: one extract against four copies of it side by side.

    python benchmarks/growth.py MAP [--lod 0 --lod 2] [--repeat 3]

Nodes outside the map's declared bounds are dropped, so that the copies meet without overlap. The
ratio to read is that of the CPU seconds to the buildings: linear growth gives the same for both.
"""

from __future__ import annotations

import argparse
import bz2
import gzip
import statistics
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cityx_bench.speed import build_once

SIDE = 2  # copies along each axis
SPREAD = 10**13  # between the ids of two copies; OSM's own are near 10**10
OPEN = {".gz": gzip.open, ".bz2": bz2.open}


def tile_map(path: Path, out: Path, side: int) -> None:
    """Write `side` times `side` copies of a map with bounds, shifted by its width and height."""
    with OPEN.get(path.suffix, open)(path, "rb") as file:
        root = ET.parse(file).getroot()
    bounds = root.find("bounds")
    if bounds is None:
        raise SystemExit(f"{path} declares no bounds; give another map.")
    west, south, east, north = (
        float(bounds.attrib[key]) for key in ("minlon", "minlat", "maxlon", "maxlat")
    )
    inner = [
        item
        for item in root
        if item.tag != "node"
        or (west <= float(item.attrib["lon"]) < east and south <= float(item.attrib["lat"]) < north)
    ]
    made = ET.Element("osm", version="0.6")
    for copy in range(side * side):
        shift = (copy % side * (east - west), copy // side * (north - south))
        made.extend(_moved(inner, copy * SPREAD, *shift))
    ET.ElementTree(made).write(out, encoding="utf-8", xml_declaration=True)


def _moved(items: list[Any], offset: int, east: float, north: float) -> Iterator[Any]:
    for item in items:
        if item.tag == "bounds":
            change = {"minlon": east, "maxlon": east, "minlat": north, "maxlat": north}
            new = ET.Element("bounds", item.attrib)
        elif item.tag in ("node", "way", "relation"):
            change = {"lon": east, "lat": north} if item.tag == "node" else {}
            new = ET.Element(item.tag, item.attrib, id=str(int(item.attrib["id"]) + offset))
            for child in item:
                ref = child.attrib.get("ref")
                more = {"ref": str(int(ref) + offset)} if ref else {}
                ET.SubElement(new, child.tag, child.attrib | more)
        else:
            continue
        for key, step in change.items():
            new.set(key, f"{float(item.attrib[key]) + step:.7f}")
        yield new


def measure(path: Path, lod: int, repeat: int) -> tuple[int, float]:
    """Return the buildings of a map and the CPU seconds of its whole build, with warm caches."""
    with tempfile.TemporaryDirectory() as folder:
        runs = [build_once(path, lod, Path(folder) / str(turn), Path(folder) / "cache")
                for turn in range(repeat + 1)]  # fmt: skip
    return int(runs[0]["buildings"]), statistics.median(run["cpu_s"] for run in runs[1:])


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("map", type=Path)
    parser.add_argument("--lod", type=int, action="append")
    parser.add_argument("--repeat", type=int, default=1)
    args = parser.parse_args()
    path = args.map
    with tempfile.TemporaryDirectory() as folder:
        maps = [Path(folder) / f"{side * side}.osm" for side in (1, SIDE)]
        for side, tiled in zip((1, SIDE), maps, strict=True):
            tile_map(path, tiled, side)
        for lod in args.lod or [0, 2]:
            (few, once), (many, often) = (measure(tiled, lod, args.repeat) for tiled in maps)
            print(
                f"{path.name} LOD {lod}: {few} buildings {once:.2f} s, {many} buildings "
                f"{often:.2f} s CPU: {many / few:.2f} times the buildings, {often / once:.2f} "
                f"times the CPU"
            )


if __name__ == "__main__":
    main()
