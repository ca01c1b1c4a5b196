"""Whether builds have become slower: three small ones against ratios that are kept beside this.

A build is measured in slices: a fixed piece of work of the same kinds (Python, small and large
arrays, shapes), done in the same process after every few hundredths of a second of it. CPU seconds
alone follow what else a machine does; those of build and slices follow it alike, and the ratio is
left. What still differs mostly adds, so that the least of several fresh processes counts, and no
more of them are started than it takes to stay below the limit. Calls of functions are counted
besides: they are the same on any machine, but see no array that grows.
"""

from __future__ import annotations

import cProfile
import json
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
import shapely

from cityx.errors import EngineError
from cityx.options import BuildOptions
from cityx.system.atomic import replaced
from cityx.system.stopwatch import Stopwatch
from cityx_bench.inputs import SITE, VILLAGE, town, village, write_map
from cityx_bench.scenes import Box, Thing

RATIOS = Path(__file__).with_name("guard.json")
LIMIT = 1.2  # of what is kept
TRIES = 3  # fresh processes that a build has to stay below it
RECORDED = 10  # of which the least is kept
SLICES, CALLS = "slices", "calls"
APART = 0.03  # CPU seconds from slice to slice
# What reads and compiles files of the program: more the first time than ever after.
NOT_COUNTED = ("start", "request", "import")
# What a fresh process runs, with the arguments of `main`.
PROGRAM = "import sys\nfrom cityx_bench.guard import main\nmain(*sys.argv[1:])"
Say = Callable[[str], None]


@dataclass(frozen=True)
class Case:
    """A small build: what is drawn, its site, its level of detail and its formats."""

    draw: Callable[[], list[Thing]]
    site: Box
    lod: int
    formats: tuple[str, ...] = ()


def _quarter() -> list[Thing]:
    """Return a corner of the town of `inputs`: two blocks and half a park."""
    return [thing for thing in town() if shapely.box(*_CORNER).intersects(thing.shape)]


_CORNER: Box = (-160.0, -100.0, -5.0, 100.0)
CASES: Mapping[str, Case] = MappingProxyType({
    "houses": Case(_quarter, _CORNER, 2, ("glb",)),
    "streets": Case(lambda: [t for t in town() if "building" not in t.tags], SITE, 1),
    "village": Case(village, VILLAGE, 0, ("glb",)),
})  # fmt: skip


class Interleaved(Stopwatch):
    """Times the steps of this process, and a slice of work after each `APART` seconds of it."""

    def __init__(self) -> None:
        super().__init__()
        self.work: list[float] = []

    def __enter__(self) -> Interleaved:
        """Begin to interrupt what runs."""
        signal.signal(signal.SIGPROF, self._interrupt)
        signal.setitimer(signal.ITIMER_PROF, APART)
        return self

    def __exit__(self, *_: object) -> None:
        """Let it run on."""
        signal.setitimer(signal.ITIMER_PROF, 0.0)

    def _interrupt(self, *_: object) -> None:
        begun = time.process_time()
        slice_of_work()
        self.work.append(time.process_time() - begun)
        signal.setitimer(signal.ITIMER_PROF, APART)

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Measure the block without the slices in it, finer than the clock of reports ticks."""
        begun, worked = time.process_time(), sum(self.work)
        try:
            yield
        finally:
            self.add(name, 0.0, time.process_time() - begun - (sum(self.work) - worked))

    @property
    def slices(self) -> float:
        """The steps of the build in slices of work."""
        spent = sum(taken for name, taken in self.cpu.items() if name not in NOT_COUNTED)
        return spent / (sum(self.work) / len(self.work))


def slice_of_work() -> float:
    """Do some 5 ms of work as builds do it; the result keeps it from being left out."""
    found: dict[tuple[int, int], list[float]] = {}
    for k in range(6000):  # Python
        found.setdefault((k % 91, k % 17), []).append(k * 0.5)
    total = sum(sum(values) for values in found.values())
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    for k in range(120):  # small arrays
        turned = np.roll(square, 1, axis=0) - square
        total += float(np.hypot(turned[:, 0], turned[:, 1] + k).sum())
    values = np.cos(np.arange(20_000.0))  # large ones
    total += float(np.cumsum(values[np.argsort(values)])[-1])
    x = np.arange(40.0)
    boxes = shapely.box(x, x % 7, x + 1.5, x % 7 + 1.5)  # shapes
    total += float(shapely.union_all(shapely.buffer(boxes, 0.2)).area)
    return total


def measure(name: str, folder: Path, *, count: bool) -> dict[str, float]:
    """Build a case, after a build that loads the program; returns its slices, and its calls."""
    from cityx.projects.build import build

    case = CASES[name]
    path = folder / f"{name}.osm"
    write_map(case.draw(), case.site, path)
    wanted = BuildOptions(formats=case.formats, lod=case.lod, render=False)
    build([path], folder / "first", wanted)
    with Interleaved() as watch:
        build([path], folder / "second", wanted, watch=watch)
    if not count:
        return {SLICES: watch.slices}
    profile = cProfile.Profile()
    profile.runcall(build, [path], folder / "third", wanted)
    return {SLICES: watch.slices, CALLS: sum(one.callcount for one in profile.getstats())}


def in_fresh_process(name: str, *, count: bool = False, program: str = PROGRAM) -> dict[str, float]:
    """Measure a case in a process of its own.

    Parameters
    ----------
    name
        Of the case.
    count
        Whether calls are counted, too, which takes another build.
    program
        Python, for tests that make builds slower.

    Raises
    ------
    EngineError
        When the process fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", program, name, folder, "count" if count else ""]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise EngineError(f"The build of {name} ended with {done.returncode}: {done.stderr}")
        found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
        return found


def kept_ratios() -> dict[str, dict[str, float]]:
    """Return slices and calls of each case as they were recorded."""
    ratios: dict[str, dict[str, float]] = json.loads(RATIOS.read_text())
    return ratios


def grown(
    name: str, kept: Mapping[str, float], say: Say, *, program: str = PROGRAM
) -> dict[str, float]:
    """Return slices and calls of a case as shares of those that are kept, the least of `TRIES`."""
    found = in_fresh_process(name, count=True, program=program)
    calls, tries = found[CALLS] / kept[CALLS], [found[SLICES] / kept[SLICES]]
    while len(tries) < TRIES and min(tries) >= LIMIT:
        tries.append(in_fresh_process(name, program=program)[SLICES] / kept[SLICES])
    told = ", ".join(f"{once:.3f}" for once in tries)
    say(f"{name}: slices {told}, calls {calls:.4f} of what is recorded")
    return {SLICES: min(tries), CALLS: calls}


def renew_ratios(say: Say) -> None:
    """Measure all cases and record them."""
    ratios: dict[str, dict[str, float]] = {}
    for name in CASES:
        found = [in_fresh_process(name, count=not turn) for turn in range(RECORDED)]
        each = [one[SLICES] for one in found]
        ratios[name] = {SLICES: round(min(each), 1), CALLS: found[0][CALLS]}
        say(f"{name}: {min(each):.1f} to {max(each):.1f} slices, {found[0][CALLS]} calls")
    with replaced(RATIOS) as temporary:
        temporary.write_text(json.dumps(ratios, indent=1) + "\n")


def main(name: str, folder: str, count: str) -> None:
    """Measure a case in this process and print it."""
    sys.stdout.write(f"{json.dumps(measure(name, Path(folder), count=bool(count)))}\n")
