"""Measure how long a change of one building takes in a large city, pictures apart.

    python benchmarks/edits.py CITY [--rounds 3]

CITY is the folder of a built city (`--no-render`), with exports (`--formats glb`), which each
change renews, or without (`--formats ""`); it is copied, and changed in the copy. The first row is
that of fresh processes, imports included, after one that compiles the program; the others follow in
one process. Each row has the clock and the processor time, medians of the rounds.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage

import numpy as np

from cityx.city.store import read_city
from cityx.ids import id_text
from cityx.projects.edit import edit_city

CHANGES = {
    "height": "Make {} {} m tall", "material": "Make {} {}", "colour": "Paint {} {}",
    "style": "Make {} {}",
}  # fmt: skip
VALUES = {
    "height": ("14", "17", "12", "16"), "material": ("brick", "concrete", "stone", "glass"),
    "colour": ("red", "blue", "green", "white"),
    "style": ("art deco", "modern", "brutalist", "european"),
}  # fmt: skip


def fresh(folder: Path, text: str, compiled: Path) -> tuple[float, float]:
    """Change a city by the command line; returns seconds of the clock and of the processor.

    The program is compiled in a folder, as an installed one is.
    """
    own = {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": str(compiled)}
    before, begin = getrusage(RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-m", "cityx.cli", "edit", str(folder), text]
    subprocess.run(command, check=True, capture_output=True, env={**os.environ, **own})
    after = getrusage(RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - begin, spent


def warm(folder: Path, text: str) -> tuple[float, float]:
    """Change a city in this process; returns the same."""
    begin, spent = time.perf_counter(), time.process_time()
    edit_city(folder, text)
    return time.perf_counter() - begin, time.process_time() - spent


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("city", type=Path)
    parser.add_argument("--rounds", type=int, default=3, choices=range(1, 5))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        folder = Path(shutil.copytree(options.city, Path(work) / "city"))
        buildings = read_city(folder / "city").layout.buildings["id"].to_numpy(np.uint64)
        own = id_text(int(buildings[len(buildings) // 2]))
        print(f"{len(buildings):,} buildings\n")
        print("| change | clock, s | processor, s |\n| --- | --- | --- |")
        height = [f"Make {own} {11 + number} m tall" for number in range(options.rounds + 1)]
        _, *times = [fresh(folder, text, Path(work) / "compiled") for text in height]
        rows = {"height, fresh process": times}
        edit_city(folder, f"Make {own} 15 m tall")
        for name, form in CHANGES.items():
            texts = [form.format(own, value) for value in VALUES[name][: options.rounds]]
            rows[name] = [warm(folder, text) for text in texts]
        for name, times in rows.items():
            clock, spent = np.median(times, axis=0)
            print(f"| {name} | {clock:.2f} | {spent:.2f} |", flush=True)


if __name__ == "__main__":
    main()
