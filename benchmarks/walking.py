"""Measure people on foot: how fast they are simulated, and whether they keep to walks and rules.

    python benchmarks/walking.py [--minutes 10] [--density heavy] [--traffic heavy] [FOLDER ...]
    python benchmarks/walking.py --minutes 10 --count 500

A row for each built city (`cityx build ... -o FOLDER`); without any, extracts of
`../shared/data/osm` are built first, without pictures. `--traffic` lets vehicles drive before
people walk, so that these wait for them. `--count` puts so many vehicles and as many people into
a made grid of streets instead, at any time. Of the processor's seconds those of stepping are told
apart: ten steps a second of SUMO's process, and of the crowd. The checks are those of
`cityx.checks.movement_checks`.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage
from types import ModuleType

from places import PLACES, built, grid

from cityx.checks.movement_checks import check_movement
from cityx.city import City
from cityx.city.store import read_city
from cityx.city.tracks import MOVER
from cityx.ground.walking.walkable import walkable_of
from cityx.motion import crowds
from cityx.motion import pedestrians as people
from cityx.motion.traffic import traffic
from cityx.traffic import session
from cityx.traffic.demand import PER_KM

EXCESS = 1.6, 1.1  # vehicles and people asked for to have one of them under way at any time


def row(
    name: str, city: City, minutes: float, density: str, *, among: str, count: int = 0
) -> None:  # fmt: skip
    """Simulate people in a city and print the results."""
    seconds = 60.0 * minutes
    city = replace(city, tracks=None)
    area = walkable_of(city)
    stepping = [_Timed(session, "simulate"), _Timed(crowds, "walked")]
    clock, busy = [time.perf_counter()], [_processor()]
    if count:
        city = traffic(city, per_km=EXCESS[0] * count / _kilometres(city), duration=seconds)
    elif among:
        city = traffic(city, density=among, duration=seconds)
    clock, busy = [*clock, time.perf_counter()], [*busy, _processor()]
    wanted = round(EXCESS[1] * count) or None
    walked = people.pedestrians(city, density=density, count=wanted, duration=seconds)
    clock, busy = [*clock, time.perf_counter()], [*busy, _processor()]
    tracks = walked.tracks
    assert tracks is not None
    foot = tracks.kind == MOVER["pedestrian"]
    print(
        f"{name}: {seconds:g} s; {area.area / 1e4:.2f} ha walkable, "
        f"{area.crosswalks.count} crosswalks"
    )
    for kind, chosen, step in (("vehicles", ~foot, 1), ("people", foot, 2)):
        span = tracks.take(chosen)
        under_way = (span.time[span.sample_start[1:] - 1] - span.time[span.sample_start[:-1]]).sum()
        print(
            f"    {kind:<9} {int(chosen.sum())}, {under_way / seconds:.0f} at a time; "
            f"{busy[step] - busy[step - 1]:.0f} s of processor, "
            f"{clock[step] - clock[step - 1]:.0f} s on the clock; {len(span.time):,} samples"
        )
    print(f"    together {seconds / (busy[2] - busy[0]):.1f} times real time of one core, "
          f"{seconds / (clock[2] - clock[0]):.1f} on the clock")  # fmt: skip
    for kind, timed in zip(("vehicles", "people"), stepping, strict=True):
        print(f"    stepping {kind} alone: {timed.busy:.0f} s of processor, "
              f"{timed.clock:.0f} s on the clock")  # fmt: skip
    spent, passed = sum(t.busy for t in stepping), sum(t.clock for t in stepping)
    print(f"    stepping together {seconds / max(spent, 1e-9):.1f} times real time of one core, "
          f"{seconds / max(passed, 1e-9):.1f} on the clock")  # fmt: skip
    for check in check_movement(walked):
        print(f"    {check.name:<26} {check.value:g} (limit {check.limit:g})")


class _Timed:
    """A function of a module that tells what it took; a class since it counts."""

    def __init__(self, module: ModuleType, name: str) -> None:
        self.function = getattr(module, name)
        self.clock = self.busy = 0.0
        setattr(module, name, self)

    def __call__(self, *args: object) -> object:
        clock, busy = time.perf_counter(), _processor()
        found = self.function(*args)
        self.clock += time.perf_counter() - clock
        self.busy += _processor() - busy
        return found


def _kilometres(city: City) -> float:
    """Return the length of all streets that vehicles are counted on."""
    roads = city.layout.roads
    kinds = roads["kind"].str.replace("_link", "", regex=False)
    return float(roads.geometry.length[kinds.isin(list(PER_KM))].sum()) / 1000.0


def _processor() -> float:
    """Return the processor seconds of this process and those it has waited for."""
    spent = [getrusage(who) for who in (RUSAGE_SELF, RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in spent)


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--density", default="heavy", choices=("light", "medium", "heavy"))
    parser.add_argument("--traffic", default="", choices=("light", "medium", "heavy"))
    parser.add_argument("--count", type=int, default=0)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        given = ((folder.name, folder) for folder in args.folders)
        places = ((name, built(name, Path(scratch), lod=2)) for name in PLACES)
        places = [("grid", grid(Path(scratch)))] if args.count else places
        for name, folder in given if args.folders else places:
            row(name, read_city(folder / "city"), args.minutes, args.density, among=args.traffic,
                count=args.count)  # fmt: skip


if __name__ == "__main__":
    main()
