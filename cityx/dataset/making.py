"""Making a dataset: cities are planned, shots taken by workers, formats finished.

A killed run leaves shots that are whole, and a manifest that says which; the same order goes on
there, and ends with the same bytes as one that nothing disturbed.
"""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from pathlib import Path
from time import perf_counter
from types import MappingProxyType
from typing import Any, Protocol

from cityx.dataset import manifest as kept
from cityx.dataset.card import RUNS, card
from cityx.dataset.channels import CYCLES
from cityx.dataset.cities import (
    SHOTS,
    Planner,
    Site,
    build_source,
    open_site,
    plan_shots,
    read_shots,
    store_of,
    write_city_files,
)
from cityx.dataset.makers import Opener, Wanted, open_city
from cityx.dataset.manifest import DiskFull, Done, Manifest
from cityx.dataset.order import (
    FOLDER,
    NAME,
    TILE,
    Faults,
    Order,
    Source,
    check_words,
    differences,
    identity_of,
)
from cityx.dataset.shots import Shot
from cityx.dataset.taking import ASIDE, FULL, WORK, Failed, Job, Task, take
from cityx.dataset.workers import Cluster, Died, Pool, check_cluster, share_threads
from cityx.dataset.writers import FORMATS, formats_named, outside_formats
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import Place, Whole
from cityx.errors import InputError, UsageError
from cityx.system.atomic import replaced

RENEW = 500  # shots after which a worker is replaced
CHUNK, CHUNK_CYCLES = 16, 48  # shots that a worker is given; Blender begins anew with each chunk
# Which camera of a rig carries the LiDAR, of those there are: the one that looks ahead.
LEADS: Mapping[str, int] = MappingProxyType({"left": 1, "mono": 2, "front": 3})
SHOWN = 24  # shots that the page shows
Say = Callable[[str], None]


class Progress(Protocol):
    """Shows how far a dataset is."""

    def say(self, line: str) -> None:
        """Show what is being done."""

    def shots(self, done: int, total: int, rate: float) -> None:
        """Show how many shots are done, and how many come in a second."""


@dataclass(frozen=True)
class Hands:
    """Functions of the workers; all top level, so that they can be sent to other processes.

    Attributes
    ----------
    open
        Reads a stored city for planning.
    plan
        Plans its shots.
    tell
        Writes what is told of it.
    shoot
        Opens what takes its shots.
    build
        Builds a city that is not there.
    """

    open: Callable[[Source, Path], Site] = open_site
    plan: Planner = plan_shots
    tell: Callable[[Site, Sequence[Shot], Order, Files], None] = write_city_files
    shoot: Opener = open_city
    build: Callable[[Source, Order, Path, Say], None] = build_source


@dataclass(frozen=True)
class Running:
    """How a dataset is made, none of which changes a byte of it.

    Attributes
    ----------
    workers
        Processes of this machine.
    cluster
        Workers of dask instead: the address of a scheduler, or ``local:N``.
    budget
        Bytes that the dataset may take, None for what the disk has.
    renew
        Shots after which a worker is replaced.
    skip_failed
        Whether a dataset is finished without shots that cannot be taken.
    command
        As the user gave it, for the card.
    hands
        Who does the work.
    faults
        What is known to be wrong already.
    """

    workers: int = 1
    cluster: str = ""
    budget: int | None = None
    renew: int = RENEW
    skip_failed: bool = False
    command: str = ""
    hands: Hands = field(default_factory=Hands)
    faults: Faults = field(default_factory=Faults)


@dataclass(frozen=True)
class Summary:
    """What a run did.

    Attributes
    ----------
    made, total
        Shots of this run, and of the dataset.
    size
        Bytes of the dataset.
    seconds
        Of taking shots, by the clock.
    spent
        Seconds of all workers by what they did: "truth", "cycles", "files".
    failed
        Names of shots that could not be taken, with the cause.
    faults
        What is wrong with the files of a dataset that was finished before.
    """

    made: int
    total: int
    size: int
    seconds: float
    spent: Mapping[str, float]
    failed: Mapping[str, str] = field(default_factory=dict)
    faults: tuple[str, ...] = ()


_Planned = tuple[Site | None, tuple[Shot, ...]]  # a city and its shots


def make_dataset(
    order: Order, sources: Sequence[Source], out: Path, running: Running, progress: Progress
) -> Summary:
    """Make a dataset, or go on with one of the same order.

    Parameters
    ----------
    order
        What is asked for.
    sources
        Its cities.
    out
        Folder of the dataset.
    running
        How it is made.
    progress
        Is told how far it is.

    Raises
    ------
    UsageError, InputError, MissingExtra
        With every fault of what is asked for; nothing was written.
    DiskFull
        What is done stays done, and the same order goes on there.
    """
    faults = running.faults
    check_words(order, faults)
    if order.place_profile and all(source.kind in (FOLDER, TILE) for source in sources):
        faults.say("--place-profile is for cities that are built here; these are built already.")
    if running.cluster:
        faults.of(lambda: check_cluster(running.cluster))
    _check_rig(order, faults)
    # What follows needs an order that can be understood.
    identity = None if faults.found else faults.of(lambda: identity_of(order, sources))
    if identity is not None:
        _check_folder(out, identity, faults)
        if not (out / kept.NAME).exists():
            _check_room(order, sources, out, running, faults)
    faults.end()
    assert identity is not None
    if (out / kept.NAME).exists():
        return _checked(out, progress)
    planned = _planned(order, sources, out, running, progress)
    with _alone(out), _full_disk(), closing(Manifest(out / WORK / "manifest.sqlite")) as manifest:
        with replaced(out / NAME) as temporary:
            temporary.write_text(json.dumps(identity, indent=1) + "\n")
        return _Run(order, sources, out, running, progress, manifest, planned).run()


def _check_folder(out: Path, identity: Mapping[str, Any], faults: Faults) -> None:
    if out.exists() and not out.is_dir():
        faults.say(f"{out} is a file; give a folder for the dataset.")
    elif (out / NAME).exists():
        there = json.loads((out / NAME).read_text())
        differing = differences(there, identity)
        if differing:
            faults.say(f"{out} holds another dataset: {'; '.join(differing)}. Give another folder.")
    elif out.is_dir() and any(entry.name != WORK for entry in out.iterdir()):
        faults.say(f"{out} is not empty and holds no dataset; give another folder.")


def _check_rig(order: Order, faults: Faults) -> None:
    """Refuse formats that cannot store the cameras of the rig."""
    from cityx.dataset.rigs import rig_named

    rig = faults.of(lambda: rig_named(order.rig))
    if rig is None or not set(order.formats) <= {*FORMATS, *outside_formats()}:
        return
    names = {mount.sensor for mount in rig}
    for item in formats_named(order.formats):
        if item.sensors is not None and not names <= item.sensors:
            faults.say(f"{item.name} knows the cameras {', '.join(sorted(item.sensors))}; the rig "
                       f"{order.rig} has {', '.join(sorted(names))}.")  # fmt: skip


def _check_room(
    order: Order, sources: Sequence[Source], out: Path, running: Running, faults: Faults
) -> None:
    """Compare what is needed with what there is; a file of shots says itself how many they are."""
    from cityx.dataset.rigs import rig_named

    shots = (order.views or 1) * len(rig_named(order.rig)) * len(sources)
    need = order.bytes_of_a_shot() * shots
    here = next(path for path in (out.resolve(), *out.resolve().parents) if path.exists())
    there = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
    free = shutil.disk_usage(here).free + there  # of a run that goes on, a part is there
    for room, what in ((free, "are free on the disk"), (running.budget, "may be used")):
        if room is not None and need > room:
            faults.say(f"about {_gb(need)} are needed and {_gb(room)} {what}; ask for fewer or "
                       "smaller shots, or fewer channels.")  # fmt: skip


def _gb(size: float) -> str:
    return f"{size / 1e9:.3g} GB"


def _checked(out: Path, progress: Progress) -> Summary:
    """Check the files of a finished dataset."""
    progress.say("the dataset is finished; its files are checked")
    shutil.rmtree(out / WORK, ignore_errors=True)  # of one that was killed at the very end
    count = size = 0
    with (out / kept.NAME).open(encoding="utf-8") as lines:
        for line in lines:
            record = json.loads(line)
            count += "number" in record
            size += sum(file["size"] for file in record["files"])
    return Summary(0, count, size, 0.0, {}, faults=tuple(kept.faults_of(out)))


@contextmanager
def _alone(out: Path) -> Iterator[None]:
    """Keep other runs away from a folder; the lock goes with the process, however that ends."""
    (out / WORK).mkdir(parents=True, exist_ok=True)
    with closing(sqlite3.connect(out / WORK / "lock.sqlite", timeout=0)) as lock:
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError as error:
            raise UsageError(f"{out} is being made by another process.") from error
        yield


@contextmanager
def _full_disk() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        if error.errno in FULL:
            raise DiskFull("The disk is full.") from error
        raise


def _planned(
    order: Order, sources: Sequence[Source], out: Path, running: Running, progress: Progress
) -> dict[str, _Planned]:
    """Plan the cities that are built already, before anything is written.

    Raises
    ------
    InputError, UsageError
        With what is wrong with any of them.
    """
    found: dict[str, _Planned] = {}
    faults = Faults()
    for source in sources:
        if source.kind == FOLDER and not (out / "cities" / source.name / SHOTS).exists():
            progress.say(f"planning {source.name}")
            site = running.hands.open(source, store_of(source, out / WORK))
            shots = faults.of(partial(running.hands.plan, site, order))
            if shots is not None:  # of many cities the scenes would not fit the memory
                found[source.name] = (site if len(sources) == 1 else None, shots)
    faults.end()
    return found


class _Run:
    """One run; a class because what it counts changes with every shot."""

    def __init__(
        self, order: Order, sources: Sequence[Source], out: Path, running: Running,
        progress: Progress, manifest: Manifest, planned: dict[str, _Planned],
    ) -> None:  # fmt: skip
        from cityx.dataset.classes import CLASSES

        self.order, self.sources, self.out = order, sources, out
        self.running, self.progress, self.manifest = running, progress, manifest
        self.planned = planned
        self.work = out / WORK
        self.stores = {source.name: store_of(source, self.work) for source in sources}
        threads = 1 if running.cluster else max(1, (os.cpu_count() or 1) // running.workers)
        self.job = Job(out.resolve(), order, running.hands.shoot, self.stores, CLASSES, threads)
        self.done = manifest.numbers()
        self.size, self.largest = manifest.size(), 0
        self.made, self.total = 0, 0
        self.seconds = 0.0
        self.spent: dict[str, float] = {}
        self.failed: dict[str, str] = {}

    def run(self) -> Summary:
        shutil.rmtree(self.out / ASIDE, ignore_errors=True)
        workers = self._workers()
        try:
            with closing(workers):
                first = moment = 0
                for index, source in enumerate(self.sources):
                    shots = self._shots(source)
                    tasks = list(self._tasks(source, shots, first, moment, index))
                    first += len(tasks)
                    moment = max((task.place.moment for task in tasks), default=moment - 1) + 1
                    rest = (len(self.sources) - index - 1) * len(tasks)
                    self._take(workers, tasks, first + rest)
                    if source.kind != FOLDER:
                        shutil.rmtree(self.work / "cities" / source.name, ignore_errors=True)
                if not first:
                    raise InputError(f"the plan {self.order.plan} has no shot in any tile.")
                self.total = first
        except DiskFull as error:
            raise DiskFull(f"{error} {self._so_far()}") from error
        finally:
            self._note()
        if not self.failed or self.running.skip_failed:
            self._finish()
        return Summary(self.made, self.total, self.size, self.seconds, self.spent, self.failed)

    def _workers(self) -> Pool | Cluster:
        if self.running.cluster:
            return Cluster(take, self.job, self.running.cluster)
        share_threads(self.job.threads)
        return Pool(take, self.job, self.running.workers, renew=self.running.renew)

    def _so_far(self) -> str:
        return (
            f"{len(self.done)} shots are done and stay in {self.out}; the same command goes on "
            "where this one stopped."
        )

    def _shots(self, source: Source) -> tuple[Shot, ...]:
        """Return the shots of a city, planned now or by an earlier run, and see to its files."""
        path, hands = f"cities/{source.name}/{SHOTS}", self.running.hands
        if self.manifest.holds(path):
            shots = read_shots(self.out / path)
            if source.kind != FOLDER and not self._all_done(source, shots):
                hands.build(source, self.order, self.work, self.progress.say)
            return shots
        site, shots = self.planned.pop(source.name, (None, ()))
        if site is None:
            hands.build(source, self.order, self.work, self.progress.say)
            site = hands.open(source, self.stores[source.name])
        if not shots:
            self.progress.say(f"planning {source.name}")
            shots = hands.plan(site, self.order)
        if not shots and source.kind != TILE:
            raise InputError(f"the plan {self.order.plan} has no shot in {source.name}.")
        if not shots:
            self.progress.say(f"{source.name}: no place for a shot")
        files = Files(self.out, self.out / ASIDE)
        hands.tell(site, shots, self.order, files)
        self.manifest.add_files(files.written)
        self.size += sum(file.size for file in files.written)
        return shots

    def _all_done(self, source: Source, shots: Sequence[Shot]) -> bool:
        return self.manifest.count(source.name) == len(shots)

    def _tasks(
        self, source: Source, shots: Sequence[Shot], first: int, moment: int, index: int
    ) -> Iterator[Task]:
        following = {(s.sequence, s.sensor, s.frame): s for s in shots}
        leads = {
            (shot.sequence, shot.frame): shot.sensor
            for shot in sorted(shots, key=lambda shot: LEADS.get(shot.sensor, 0))
        }
        shown = shown_of(len(shots), index, len(self.sources))
        seen: dict[tuple[str, int], int] = {}
        for row, shot in enumerate(shots):
            number = seen.setdefault((shot.sequence, shot.frame), moment + len(seen))
            after = following.get((shot.sequence, shot.sensor, shot.frame + 1))
            place = Place(first + row, number, source.name)
            sweep = bool(self.order.lidar) and leads[shot.sequence, shot.frame] == shot.sensor
            yield Task(place, Wanted(shot, after, sweep), row in shown)

    def _take(self, workers: Pool | Cluster, tasks: Sequence[Task], total: int) -> None:
        left = [task for task in tasks if task.place.number not in self.done]
        began, before = perf_counter(), self.seconds
        for result in workers.run(list(self._chunks(left))):
            self.seconds = before + perf_counter() - began
            match result:
                case Done():
                    self._add(result)
                case Failed(full=True):
                    raise DiskFull("The disk is full.")
                case Failed(task=task, cause=cause) | Died(item=task, cause=cause):
                    self.failed[f"{task.place.city}/{task.wanted.shot.name}"] = cause
            rate = self.made / max(self.seconds, 1e-9)
            self.progress.shots(len(self.done), total, rate)

    def _chunks(self, tasks: Sequence[Task]) -> Iterator[list[Task]]:
        most = CHUNK_CYCLES if self.order.made_by(CYCLES) else CHUNK
        size = max(1, min(most, -(-len(tasks) // (2 * max(self.running.workers, 1)))))
        rest = iter(tasks)
        while chunk := list(islice(rest, size)):
            yield chunk

    def _add(self, done: Done) -> None:
        self.manifest.add(done)
        size = sum(file.size for file in done.files)
        self.done.add(done.place.number)
        self.made += 1
        self.size += size
        self.largest = max(self.largest, size)
        for what, seconds in done.seconds.items():
            self.spent[what] = self.spent.get(what, 0.0) + seconds
        budget = self.running.budget
        if budget is not None and self.size + self.largest > budget:
            raise DiskFull(f"The budget of {_gb(budget)} is used up.")

    def _note(self) -> None:
        """Keep what this run did; the card tells of it, and nothing else depends on it."""
        if self.made:
            record = {
                "shots": self.made, "seconds": round(self.seconds, 1),
                "workers": self.running.cluster or self.running.workers,
                "spent": {key: round(value, 1) for key, value in self.spent.items()},
                "size": list(self.order.size), "channels": [c.name for c in self.order.wanted],
            }  # fmt: skip
            # A full disk is told of already, and has no room for this.
            with suppress(OSError), (self.out / RUNS).open("a", encoding="utf-8") as file:
                file.write(json.dumps(record) + "\n")

    def _finish(self) -> None:
        from cityx.dataset.page import dataset_page

        files = Files(self.out, self.out / ASIDE)
        names = [source.name for source in self.sources]
        for item in formats_named(self.order.formats):
            if item.finish is not None:
                self.progress.say(f"finishing {item.name}")
                whole = Whole(self.job.classes, names, self.manifest.parts(item.name))
                item.finish(whole, files)
        files.json("classes.json", [
            {"number": c.number, "name": c.name, "colour": list(c.color), "thing": c.thing,
             "train_id": c.train_id}
            for c in self.job.classes
        ])  # fmt: skip
        shown = dataset_page(self.out, self.order, self.manifest, self.job.classes)
        files.text("index.html", shown)
        self.manifest.add_files(files.written)
        text = card(self.out, self.order, self.manifest, self.job.classes, self.running.command,
                    self.failed)  # fmt: skip
        with replaced(self.out / "README.md", aside=self.out / ASIDE) as temporary:
            temporary.write_text(text)
        self.size = self.manifest.size()
        listed = "".join(self.manifest.lines())
        with replaced(self.out / kept.NAME, aside=self.out / ASIDE) as temporary:
            temporary.write_text(listed)
        shutil.rmtree(self.work, ignore_errors=True)


def shown_of(shots: int, city: int, cities: int) -> set[int]:
    """Return which shots of a city the page shows: some of each, or one of every so many cities."""
    step = -(-cities // SHOWN)
    if city % step:
        return set()
    count = min(shots, max(1, SHOWN // cities))
    return {index * shots // count for index in range(count)}
