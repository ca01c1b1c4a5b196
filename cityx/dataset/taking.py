"""Taking shots: what a worker does with a chunk of them."""

from __future__ import annotations

import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from errno import EDQUOT, EFBIG, ENOSPC
from pathlib import Path
from shutil import disk_usage
from time import perf_counter
from types import MappingProxyType
from typing import TYPE_CHECKING

from cityx.dataset.makers import SECONDS, Maker, Opener, Wanted
from cityx.dataset.manifest import Done
from cityx.dataset.order import Order
from cityx.dataset.record import Record
from cityx.dataset.statistics import counted
from cityx.dataset.writers import formats_named
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import Place
from cityx.errors import CityxError

if TYPE_CHECKING:
    from cityx.dataset.classes import Class

WORK = ".work"  # folder of a dataset for what is gone when it is finished
ASIDE = f"{WORK}/partial"
FULL = frozenset({ENOSPC, EDQUOT, EFBIG})
# Facts that differ from run to run, which files hold none of.
VARYING = frozenset({SECONDS, "memory_mb"})
NOTHING_LEFT = 1 << 20  # bytes; a library that cannot write for lack of them says so in its own way


@dataclass(frozen=True)
class Task:
    """A shot that is to be taken.

    Attributes
    ----------
    place
        Where it stands in the dataset.
    wanted
        It, and what is to be made of it.
    shown
        Whether the page shows it.
    """

    place: Place
    wanted: Wanted
    shown: bool = False


@dataclass(frozen=True)
class Job:
    """What is the same for all chunks.

    Attributes
    ----------
    folder
        Of the dataset.
    order
        What is asked for.
    opener
        Opens the maker of a city.
    stores
        City name to the folder of its store.
    classes
        Every class.
    threads
        That a worker may use.
    """

    folder: Path
    order: Order
    opener: Opener
    stores: Mapping[str, Path]
    classes: Sequence[Class]
    threads: int = 1


@dataclass(frozen=True)
class Failed:
    """A shot that could not be taken.

    Attributes
    ----------
    task
        Which.
    cause
        A sentence.
    full
        Whether there was no room on the disk.
    """

    task: Task
    cause: str
    full: bool = False


_open: dict[str, Maker] = {}  # of this process: the city that it takes shots of


def take(job: Job, chunk: Sequence[Task]) -> Iterator[Done | Failed]:
    """Take shots and write their files; one that fails does not keep the others from being taken.

    Parameters
    ----------
    job
        What is the same for all.
    chunk
        Shots of one city.
    """
    records: Iterator[Record] | None = None
    for row, task in enumerate(chunk):
        making = True
        try:
            if records is None:  # at the beginning, and after a shot that cannot be made
                maker = _maker(job, task.place.city)
                records = maker([other.wanted for other in chunk[row:]])
            record = next(records)
            making = False
            done: Done | Failed = _written(job, task, record)
        except Exception as error:  # noqa: BLE001  whatever one shot brings up, the others go on
            full = _is_full(error, job.folder)
            _log(job, task, full)
            done = Failed(task, _sentence(error), full)
            records = None if making else records
        yield done


def _maker(job: Job, city: str) -> Maker:
    key = f"{job.folder}\0{city}"
    if key not in _open:
        _open.clear()  # before the next is opened, which needs the room
        _open[key] = job.opener(job.stores[city], job.order, job.threads)
    return _open[key]


def _written(job: Job, task: Task, record: Record) -> Done:
    began = perf_counter()
    seconds = dict(record.facts.get(SECONDS, {}))
    kept = {key: value for key, value in record.facts.items() if key not in VARYING}
    record = replace(record, facts=MappingProxyType(kept))
    files = Files(job.folder, job.folder / ASIDE)
    parts = {
        item.name: item.shot(record, task.place, job.classes, files)
        for item in formats_named(job.order.formats)
    }
    if task.shown:
        from cityx.dataset.panels import write_panels

        write_panels(record, task.place, job.classes, files)
    seconds["files"] = perf_counter() - began
    return Done(
        task.place, task.wanted.shot.name, tuple(files.written), parts, counted(record), seconds
    )


def _is_full(error: Exception, folder: Path) -> bool:
    number = error.errno if isinstance(error, OSError) else None
    return number in FULL or disk_usage(folder).free < NOTHING_LEFT


def _sentence(error: Exception) -> str:
    return str(error) if isinstance(error, CityxError) else f"{type(error).__name__}: {error}"


def _log(job: Job, task: Task, full: bool) -> None:
    """Keep the trace of what went wrong beside what is half done."""
    if full:
        return
    folder = job.folder / WORK / "failed"
    with suppress(OSError):  # what cannot be written is told all the same
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{task.place.number}.txt").write_text(traceback.format_exc())
