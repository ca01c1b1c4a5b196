"""What a driver made of a task, and what went wrong on the way."""

from __future__ import annotations

import traceback
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

from cityx.agents.journal import JOURNAL, Journal, Step
from cityx.checks.predicates import Reply
from cityx.city import City, Layout
from cityx.city.frame import NOWHERE
from cityx.errors import ActionFailed, ActionRejected, CityxError, InputError, UsageError
from cityx.projects.desk import STORE
from cityx.protocol.gate import CODES
from cityx_bench.scenes import EMPTY
from cityx_bench.tasks import SlotPair, Task

# What ends a proposal besides the codes of the gate: an action failed, the whole was refused before
# anything ran, an engine is missing, CityX itself failed.
FAILED, REFUSED, ENGINE, CRASH = "FAILED", "REFUSED", "ENGINE", "CRASH"


class Fault(NamedTuple):
    """One step that did not run to its end."""

    code: str
    action: str
    message: str


@dataclass(frozen=True)
class Outcome:
    """What a driver made of a task.

    Attributes
    ----------
    city
        As it is now; as it was where nothing came about.
    reply
        What was answered and done.
    faults
        Steps that were rejected or failed.
    unsupported
        What was asked for and no action serves, by name.
    slots
        How the text was read, None where the driver reads none.
    planning_s
        Seconds until it was known what to do.
    """

    city: City
    reply: Reply
    faults: tuple[Fault, ...] = ()
    unsupported: tuple[str, ...] = ()
    slots: tuple[SlotPair, ...] | None = None
    planning_s: float = 0.0


@dataclass(frozen=True)
class Workplace:
    """Where a task is carried out.

    Attributes
    ----------
    task
        The task.
    folder
        Of the results; it holds the base scene, built and with its journal, if there is one.
    start
        The city before anything is done.
    inputs
        Files by the names that tasks call them.
    seed, lod
        Of the city.
    runs_before
        Number of runs that the journal held before the task.
    """

    task: Task
    folder: Path
    start: City
    inputs: Mapping[str, Path] = field(default_factory=dict)
    seed: int = 0
    lod: int = 2
    runs_before: int = 0

    @classmethod
    def opened(
        cls, task: Task, folder: Path, inputs: Mapping[str, Path], *, seed: int, lod: int
    ) -> Workplace:
        """Return the place of a task, as it is before the task."""
        start = City("town", NOWHERE, Layout((0.0, 0.0, 0.0, 0.0)), seed=seed, lod=lod)
        if task.base != EMPTY:
            start = _city(folder)
        return cls(task, folder, start, inputs, seed, lod, len(_runs(folder)))

    @property
    def based(self) -> bool:
        """Whether a city is there that is to be changed."""
        return self.task.base != EMPTY

    @property
    def files(self) -> list[Path]:
        """The input files of the task."""
        return [self.inputs[name] for name in self.task.inputs]

    def city(self) -> City:
        """Return the city that lies in the folder now."""
        return _city(self.folder)

    def steps(self) -> list[Step]:
        """Return the steps of the runs that the task made."""
        runs = _runs(self.folder)[self.runs_before :]
        if not runs:
            return []
        with Journal(self.folder / STORE / JOURNAL) as journal:
            return [step for number in runs for step in journal.steps(number)]


def _city(folder: Path) -> City:
    from cityx.city.store import read_city

    return read_city(folder / STORE)


def _runs(folder: Path) -> tuple[int, ...]:
    path = folder / STORE / JOURNAL
    if not path.exists():
        return ()
    with Journal(path) as journal:
        return tuple(record.number for record in journal.runs())


def faults_of(steps: Iterable[Step]) -> tuple[Fault, ...]:
    """Return the steps of a journal that were rejected or failed."""
    return tuple(
        Fault(_code(step), step.action, step.error)
        for step in steps
        if step.status in ("rejected", "rolled_back")
    )


def _code(step: Step) -> str:
    word = step.error.partition(":")[0]
    return word if step.status == "rejected" and word in CODES else FAILED


def fault_of(error: Exception) -> Fault:
    """Return an error as a fault; what CityX did not raise on purpose keeps its last lines."""
    if isinstance(error, ActionRejected):
        return Fault(error.code, "", str(error))
    kinds = ((ActionFailed, FAILED), (InputError, REFUSED), (UsageError, REFUSED),
             (CityxError, ENGINE))  # fmt: skip
    code = next((code for kind, code in kinds if isinstance(error, kind)), CRASH)
    if code != CRASH:
        return Fault(code, "", str(error))
    lines = traceback.format_exception(error, limit=-3)
    return Fault(CRASH, "", "".join(lines).strip())


def acted(place: Workplace, outcome: Outcome) -> Outcome:
    """Return an outcome with the journal's record of the task: actions, changes, faults."""
    steps = place.steps()
    done = tuple(step.action for step in steps if step.status == "done")
    reply = Reply(outcome.reply.kind, outcome.reply.mentions, done, len(done))
    # A step that stands in the journal and ended the run as an error is one fault, not two.
    told = faults_of(steps)
    said = {fault.message for fault in told}
    more = tuple(fault for fault in outcome.faults if fault.message not in said)
    return replace(outcome, reply=reply, faults=(*told, *more))
