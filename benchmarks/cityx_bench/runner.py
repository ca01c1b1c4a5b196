"""Run a benchmark: tasks by processes, every sample logged; a killed run continues."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field, fields
from multiprocessing import get_context
from pathlib import Path

from cityx.agents.requests import with_requests
from cityx.errors import UsageError
from cityx.options import BuildOptions
from cityx.projects.build import build
from cityx.protocol.catalogue import registry_hash
from cityx.protocol.registry import registry
from cityx_bench.drivers import change, driver_named
from cityx_bench.inputs import input_paths, write_inputs
from cityx_bench.outcome import CRASH, Workplace
from cityx_bench.scenes import EMPTY, LOD, SCENES, write_drawing
from cityx_bench.scoring import Sample, judged
from cityx_bench.tasks import Task

LOG = "samples.jsonl"
Say = Callable[[str], None]


@dataclass(frozen=True)
class Bench:
    """What is run.

    Attributes
    ----------
    tasks
        The tasks.
    driver
        Name of who solves them, see `cityx_bench.drivers.driver_named`.
    out
        Folder of the log, the scenes and the inputs.
    seeds
        Every task is run once for each.
    lod
        Level of detail of the cities that are built; base scenes have their own.
    jobs
        Processes.
    inputs
        Files by the names that tasks call them; those of `cityx_bench.inputs` when empty.
    """

    tasks: tuple[Task, ...]
    driver: str
    out: Path
    seeds: tuple[int, ...] = (0,)
    lod: int = 2
    jobs: int = 1
    inputs: Mapping[str, Path] = field(default_factory=dict)


@dataclass(frozen=True)
class _Job:
    """One proposal that is to be made."""

    task: Task
    seed: int
    driver: str
    out: Path
    lod: int
    registry: str
    inputs: Mapping[str, Path]

    @property
    def key(self) -> tuple[str, str, int, str, int, str]:
        return self.task.id, self.task.digest, self.seed, self.driver, self.lod, self.registry


def run_bench(bench: Bench, say: Say) -> list[Sample]:
    """Run what the log does not hold yet, and return the samples in the order of the tasks.

    Raises
    ------
    UsageError
        If there is no such driver.
    """
    driver_named(bench.driver)
    bench.out.mkdir(parents=True, exist_ok=True)
    wanted = _jobs(bench)
    log = bench.out / LOG
    known = {sample.key: sample for sample in read_log(log)}
    left = [job for job in wanted if job.key not in known]
    if left:
        say(f"{len(wanted) - len(left)} of {len(wanted)} proposals are in the log")
        _prepare(bench, left, say)
    # Behind half a line that a killed process left nothing can be read.
    broken = log.exists() and not log.read_bytes().endswith(b"\n")
    with log.open("a", encoding="utf-8") as file:
        file.write("\n" if broken else "")
        for sample in _made(left, bench.jobs):
            known[sample.key] = sample
            file.write(json.dumps(sample.to_json()) + "\n")
            file.flush()
            os.fsync(file.fileno())
            mark = "not counted" if not sample.scored else "right" if sample.right else "wrong"
            say(f"{sample.task} {mark}, {sample.seconds:.0f} s")
    return [known[job.key] for job in wanted]


def export_prompts(bench: Bench, say: Say) -> int:
    """Write what a model would be asked to a file, and return how many prompts wait for answers.

    Parameters
    ----------
    bench
        With a driver "export:FILE"; answers that stand in the file are used. Nothing is scored.

    Raises
    ------
    InputError
        With every fault of the file.
    """
    from cityx.agents.models.prompts import read_prompts

    path = Path(bench.driver.partition(":")[2])
    driver_named(bench.driver)
    bench.out.mkdir(parents=True, exist_ok=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists():
        read_prompts(path)
    wanted = _jobs(bench)
    _prepare(bench, wanted, say)
    for job in wanted:  # one after the other, since all of them write to the file
        _done(job)
        say(f"{job.task.id} asked")
    return sum(one.answer is None for one in read_prompts(path)) if path.exists() else 0


def _jobs(bench: Bench) -> list[_Job]:
    code = registry_hash(registry())
    inputs = dict(bench.inputs) or input_paths(bench.out / "inputs")
    return [
        _Job(task, seed, bench.driver, bench.out, bench.lod, code, inputs)
        for seed in bench.seeds
        for task in bench.tasks
    ]


def read_log(path: Path) -> Iterator[Sample]:
    """Yield the samples of a log; a line that a killed process left half written is no sample."""
    if not path.exists():
        return
    names = {column.name for column in fields(Sample)}
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            record = json.loads(line)
        except ValueError:
            continue
        if isinstance(record, dict) and record.keys() == names:
            yield Sample(**record)


def _made(jobs: Sequence[_Job], workers: int) -> Iterator[Sample]:
    if workers == 1:
        yield from map(_done, jobs)
        return
    alone: list[_Job] = []
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        futures = {pool.submit(_done, job): job for job in jobs}
        for future in as_completed(futures):
            try:
                yield future.result()
            except BrokenProcessPool:
                alone.append(futures[future])
    for job in alone:  # one of them ended its process, and the others with it
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            try:
                yield pool.submit(_done, job).result()
            except BrokenProcessPool:
                yield _died(job)


def _died(job: _Job) -> Sample:
    """Return what is known of a proposal whose process ended on the way."""
    fault = {"code": CRASH, "action": "", "message": "the process that made it died"}
    return Sample(
        job.task.id, job.task.digest, job.task.category, job.driver, job.seed, job.lod,
        job.registry, scored=True, executed=False, right=False, goals=(), clean=(),
        faults=(fault,), unsupported=(), reply={}, slots={}, quality={},
        planning_s=0.0, seconds=0.0,
    )  # fmt: skip


def _prepare(bench: Bench, jobs: Sequence[_Job], say: Say) -> None:
    """Write the inputs and build the base scenes that are needed, once for all."""
    if not bench.inputs and any(job.task.inputs for job in jobs):
        write_inputs(bench.out / "inputs")
    for name in sorted({job.task.base for job in jobs} - {EMPTY}):
        folder = scene_folder(bench.out, name)
        if not (folder / "city").exists():
            say(f"building the scene {name}")
            build_scene(name, folder)


def scene_folder(out: Path, name: str) -> Path:
    """Return where the base scene of a benchmark lies."""
    return out / "scenes" / f"{name}-{registry_hash(registry())[:8]}"


def build_scene(name: str, folder: Path) -> None:
    """Build a base scene into a folder."""
    scene = SCENES[name]
    folder.parent.mkdir(parents=True, exist_ok=True)
    drawing = write_drawing(scene.draw(), scene.extent, folder.parent / f"{name}.geojson")
    options = BuildOptions(
        lod=LOD, formats=(), render=False, time=scene.time, weather=scene.weather,
        settings=scene.settings,
    )  # fmt: skip
    build([drawing], folder, options)


def _done(job: _Job) -> Sample:
    """Make one proposal in a folder of its own and measure it."""
    task = job.task
    word = job.driver.partition(":")[0]
    folder = job.out / "work" / f"{task.id}-{word}-{job.seed}"
    shutil.rmtree(folder, ignore_errors=True)
    if task.base != EMPTY:
        shutil.copytree(scene_folder(job.out, task.base), folder)
    place = Workplace.opened(task, folder, job.inputs, seed=job.seed, lod=job.lod)
    if task.setup:
        items = with_requests([], (), task.setup, registry())
        change(place, [item.call for item in items])
        place = Workplace.opened(task, folder, job.inputs, seed=job.seed, lod=job.lod)
    try:
        return judged(place, driver_named(job.driver), job.driver, job.registry)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def numbers_of(text: str, option: str) -> tuple[int, ...]:
    """Read "0,1,2".

    Raises
    ------
    UsageError
        If these are no whole numbers.
    """
    try:
        return tuple(int(word) for word in text.split(","))
    except ValueError:
        raise UsageError(f'{option} "{text}" is not of the form 0,1,2.') from None
