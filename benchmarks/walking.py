"""Measure people on foot: how fast they are simulated, and whether they keep to walks and rules.

    python benchmarks/walking.py [--minutes 10] [--density heavy] [--traffic heavy] [FOLDER ...]

A row for each built city (`cityx build ... -o FOLDER`); without any, extracts of
`../shared/data/osm` are built first, without pictures. `--traffic` lets vehicles drive before
people walk, so that these wait for them. The checks are those of `cityx.checks.movement`.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from places import PLACES, built

from cityx.checks.movement import check_movement
from cityx.city import City
from cityx.city.store import read_city
from cityx.city.tracks import MOVER
from cityx.city.walkable import walkable_of
from cityx.plugins.dynamic import pedestrians as people
from cityx.plugins.dynamic.traffic import traffic


def row(name: str, city: City, minutes: float, density: str, *, among: str) -> None:
    """Let people walk in a city and print what came of it."""
    seconds = 60.0 * minutes
    city = replace(city, tracks=None)
    if among:
        city = traffic(city, density=among, duration=seconds)
    area = walkable_of(city)
    spent, process = time.perf_counter(), time.process_time()
    walked = people.pedestrians(city, density=density, duration=seconds)
    spent, process = time.perf_counter() - spent, time.process_time() - process
    tracks = walked.tracks
    assert tracks is not None
    foot = tracks.kind == MOVER["pedestrian"]
    length = np.diff(tracks.sample_start)[foot]
    span = tracks.take(foot)
    under_way = (span.time[span.sample_start[1:] - 1] - span.time[span.sample_start[:-1]]).sum()
    print(
        f"{name}: {int(foot.sum())} people, {under_way / seconds:.0f} at a time, "
        f"{int((~foot).sum())} vehicles; {area.area / 1e4:.2f} ha walkable, "
        f"{area.crosswalks.count} crosswalks; {process:.0f} s of processor ({spent:.0f} s), "
        f"{seconds / process:.0f} times real time; {length.sum():,} samples"
    )
    for check in check_movement(walked):
        print(f"    {check.name:<26} {check.value:g} (limit {check.limit:g})")


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--density", default="heavy", choices=("light", "medium", "heavy"))
    parser.add_argument("--traffic", default="", choices=("light", "medium", "heavy"))
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        given = ((folder.name, folder) for folder in args.folders)
        places = ((name, built(name, Path(scratch), lod=2)) for name in PLACES)
        for name, folder in given if args.folders else places:
            row(name, read_city(folder / "city"), args.minutes, args.density, among=args.traffic)


if __name__ == "__main__":
    main()
