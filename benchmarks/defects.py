"""Plant defects into good cities and tabulate how many of them checks and goals find.

    python benchmarks/defects.py [--places 10] [--kept FOLDER] [--verbose]

The cities are towns of 300 m made from a sentence and the example city, built here without
pictures; `--kept` keeps them for the next time. Defects of `cityx_bench.defects.KINDS` are planted
one at a time, each at places drawn by hash. A defect is found when a check or goal that speaks of
it turns and, where the check names things, names it. An alarm without a reason, in a city with
another defect, in an untouched one or after a harmless change, is false.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from cityx_bench.defects import (
    PLACES,
    Base,
    Case,
    base_of,
    harmless,
    plant_all,
    rows_of,
    table,
    untouched,
)

from cityx.agents.journal import Journal
from cityx.agents.loop import Loop
from cityx.agents.pool import Pool
from cityx.agents.step_runner import Run
from cityx.city import City
from cityx.city.store import read_city, write_city
from cityx.options import BuildOptions
from cityx.projects.build import generate, make_job
from cityx.protocol.example_city import example_city
from cityx.system.stopwatch import Stopwatch

# Name -> what is asked for, seed and level of detail.
TOWNS = {
    "grid": ("A grid town with a park and a river with two bridges on a rainy evening", 1, 2),
    "towers": ("A modern city with a river with two bridges and four towers of 80 to 120 m, at "
               "night", 4, 2),
    "radial": ("A radial old town with a plaza and a park, at noon, clear", 2, 2),
    "organic": ("An organic village with a lake in the fog at dawn", 3, 1),
    "suburb": ("A suburb with a park and a lake, snow, in the morning", 5, 2),
}  # fmt: skip
PATTERNS = ("grid", "radial", "organic", "ring")
FRESH = 16  # towns that nothing is planted into
SIDE, SIDE_OF_FRESH = 300.0, 200.0  # metres
HARMLESS = 6  # places of each harmless change
EXAMPLE = "example"


def town(text: str, seed: int, lod: int, side: float) -> City:
    """Build a town from a sentence, without views."""
    options = BuildOptions(text=text, seed=seed, lod=lod, size=(side, side), render=False)
    job = make_job([], options)
    with _journal(seed) as (journal, number):
        return generate(job, journal, number, Stopwatch(), None)


def built_example() -> City:
    """Build the example city: ground, streets, houses and all that stands in them."""
    job = make_job([], BuildOptions(time="afternoon", weather="clear", render=False))
    with _journal(0) as (journal, number):
        run = Run(journal, number, "example", job.actions, Stopwatch(), job.files, None)
        pool = Pool(journal.database, number)
        loop = Loop(job.roles.planner, run, pool, job.request.slots)
        return loop.carry_out(replace(example_city(), lod=2))


@contextmanager
def _journal(seed: int) -> Iterator[tuple[Journal, int]]:
    with tempfile.TemporaryDirectory() as folder, Journal(Path(folder) / "journal") as journal:
        yield journal, journal.start_run([], {}, seed)


def cities(kept: Path | None) -> Iterator[tuple[str, City]]:
    """Yield the cities that defects are planted into, by name; kept ones are read."""
    for name in (*TOWNS, EXAMPLE):
        folder = kept / name if kept else None
        if folder and folder.exists():
            yield name, read_city(folder)
            continue
        city = built_example() if name == EXAMPLE else town(*TOWNS[name], SIDE)
        if folder:
            write_city(city, folder)
        yield name, city


def fresh(count: int) -> Iterator[Base]:
    """Yield towns of other seeds, two thirds of them without facades, which take less time."""
    for seed in range(count):
        pattern = PATTERNS[seed % len(PATTERNS)]
        lod = 2 if seed % 3 == 2 else 1
        yield base_of(
            f"{pattern} {seed}", town(f"A {pattern} town", 100 + seed, lod, SIDE_OF_FRESH)
        )


def shown(case: Case) -> str:
    """Write what is to be known of a case that went wrong."""
    turned = ", ".join(f"{name} {' '.join(ids[:2])}" for name, ids in case.turned.items())
    word = "found" if case.found else "missed" if case.kind else "untouched"
    return f"{case.kind or '-'} in {case.base}: {word}; false: {list(case.false)}; turned: {turned}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--places", type=int, default=PLACES)
    parser.add_argument("--kept", type=Path)
    parser.add_argument("--verbose", action="store_true", help="show every case that went wrong")
    options = parser.parse_args()
    bases = [base_of(name, city) for name, city in cities(options.kept)]
    negatives = [*untouched(bases), *untouched(list(fresh(FRESH))), *harmless(bases, HARMLESS)]
    cases = [*plant_all(bases, options.places), *negatives]
    for case in cases:
        if options.verbose and (case.false or (case.kind and not case.found)):
            print(shown(case))
    print(table(rows_of(cases)))
    alarmed = sum(bool(case.false) for case in negatives)
    print(f"{len(negatives)} cities and changes without a defect: {alarmed} with an alarm")


if __name__ == "__main__":
    main()
