"""Measure how many shots a second a dataset gets, by what is asked of each.

    python benchmarks/dataset.py CITY [--shots 12] [--size 640x480] [--threads 2] [--pictures]

Shots of three plans are taken of a built city, and their files written to a folder that is thrown
away. Shown are the seconds of a shot by the clock, those of the processor, and how many shots a
second the threads would give if nothing else ran: their number by the seconds of the processor.
The first shot of each set is not counted: it loads what the others find.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from cityx.dataset.channels import CYCLES
from cityx.dataset.cities import open_site, plan_shots
from cityx.dataset.classes import CLASSES
from cityx.dataset.makers import Wanted, open_city
from cityx.dataset.order import FOLDER, Order, Source
from cityx.dataset.shots import Shot
from cityx.dataset.writers import formats_named
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import Place

PLANS = ("street", "drive", "aerial")
SETS = {
    "depth": Order(channels=("depth",)),
    "semantic, instance": Order(channels=("semantic", "instance")),
    "truth": Order(channels=("truth",)),
    "truth, boxes": Order(channels=("truth",), boxes=True),
    "spinning_64": Order(channels=(), lidar="spinning_64"),
}
PICTURES = {
    "rgb, draft": Order(channels=("rgb",), quality="draft"),
    "paper's set, draft": Order(channels=("paper",), quality="draft"),
}


def wanted_of(shots: tuple[Shot, ...], *, sweep: bool) -> list[Wanted]:
    """Return shots with the next of their sequences."""
    following = {(s.sequence, s.sensor, s.frame): s for s in shots}
    return [Wanted(s, following.get((s.sequence, s.sensor, s.frame + 1)), sweep) for s in shots]


class Taken(NamedTuple):
    """Seconds of a shot: by the clock, of the processor, and of the processor for its files."""

    clock: float
    used: float
    written: float


def taken(store: Path, order: Order, shots: tuple[Shot, ...], threads: int) -> Taken:
    """Take shots and write them, and measure both."""
    records = open_city(store, order, threads)(wanted_of(shots, sweep=bool(order.lidar)))
    next(records)
    clock, used = time.perf_counter(), time.process_time()
    made = list(records)
    clock, used = time.perf_counter() - clock, time.process_time() - used
    (raw,) = formats_named(["raw"])
    with tempfile.TemporaryDirectory() as folder:
        files = Files(Path(folder), Path(folder) / "aside")
        begun = time.process_time()
        for row, record in enumerate(made):
            raw.shot(replace(record, facts={}), Place(row, row, "city"), CLASSES, files)
        written = time.process_time() - begun
    return Taken(clock / len(made), used / len(made), written / len(made))


def main() -> None:
    """Print a row per plan and set."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("city", type=Path)
    parser.add_argument("--shots", type=int, default=12)
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--pictures", action="store_true", help="also what Cycles makes")
    given = parser.parse_args()
    width, height = map(int, given.size.split("x"))
    store = given.city / "city"
    site = open_site(Source("city", FOLDER, given.city), store)
    sets = {**SETS, **(PICTURES if given.pictures else {})}
    print(f"{given.city.name}, {width}x{height}, {given.threads} threads, {given.shots} shots")
    print("| plan | channels | clock, s | processor, s | a second | written, s |")
    print("| --- | --- | --- | --- | --- | --- |")
    for plan in PLANS:
        order = Order(views=given.shots + 1, plan=plan, size=(width, height),
                      length=given.shots + 1 if plan == "drive" else None)  # fmt: skip
        shots = plan_shots(site, order)
        for name, asked in sets.items():
            order = replace(asked, size=(width, height), formats=("raw",))
            made = taken(store, order, shots, given.threads)
            of_blender = bool(order.made_by(CYCLES))  # a process of its own
            rate = 1 / made.clock if of_blender else given.threads / max(made.used, 1e-9)
            used = "" if of_blender else f"{made.used:.3f}"
            print(f"| {plan} | {name} | {made.clock:.3f} | {used} | {rate:.2g} | "
                  f"{made.written:.3f} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
