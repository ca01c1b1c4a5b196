"""One run of actions on a city: gate, journal, clock and snapshots around every step."""

from __future__ import annotations

import shutil
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cityx.agents.ahead import Ahead, later_stage, step_name
from cityx.agents.journal import Journal, derivation_key
from cityx.agents.planning.workflow import Item
from cityx.city import City
from cityx.errors import ActionFailed, ActionRejected, InputError, InternalFault, UsageError
from cityx.protocol.gate import Budget, Call
from cityx.protocol.input_files import InputFiles
from cityx.protocol.registry import Registry
from cityx.protocol.running import Outcome, run_action
from cityx.system.allocator import return_freed_memory
from cityx.system.stopwatch import Stopwatch

SNAPSHOT_S = 30.0  # seconds of work that a killed process may lose
KEEPING = 0.05  # share of the seconds of work that may go into keeping it
LONG_S = 5.0  # seconds of a step that may have needed much more memory than it leaves
SNAPSHOTS = "snapshots"
FAULT = "fault: "  # what the first line about each begins with, in a log of them


@dataclass
class Run:
    """A run; a step that fails is rolled back: the city stays as it was and the journal says why.

    Attributes
    ----------
    journal, number
        Where steps are recorded, and of which run.
    state
        Key of the city as it is; see `cityx.agents.journal.derivation_key`.
    actions
        The registry.
    inputs
        Files the user handed in.
    keep
        Folder for snapshots of long work, or None for none.
    budget
        Steps and seconds that may be spent; None for any.
    hold
        Whether no snapshot is to be kept now, since what is made may be given up again.
    faults
        File for the traces of faults of this program's own, or None for none.
    workers
        Processes that may work at a time.
    """

    journal: Journal
    number: int
    state: str
    actions: Registry
    watch: Stopwatch = field(default_factory=Stopwatch)
    inputs: InputFiles = field(default_factory=InputFiles)
    keep: Path | None = None
    budget: Budget | None = None
    hold: bool = False
    faults: Path | None = None
    workers: int = 1
    first: str = field(init=False, default="")
    _spent: float = 0.0
    _cost: float = 0.0
    _seen: dict[str, str] = field(default_factory=dict)
    _ahead: Ahead | None = None

    def __post_init__(self) -> None:
        """Remember the state that the run starts from."""
        self.first = self.state

    def look_ahead(self, city: City, items: Sequence[Item], place: int) -> None:
        """Begin what may be done beside the item at a place of a plan, on another core.

        Of a run with a budget nothing is, since that counts step by step.
        """
        if self.workers < 2 or self._ahead is not None or self.budget is not None:
            return
        if calls := later_stage(items, place, city, self.actions):
            self._ahead = Ahead(city, calls, self.actions, self.inputs)

    def close(self) -> None:
        """End what was begun and is of no use any more."""
        if self._ahead is not None:
            self._ahead.close()
            self._ahead = None

    def do(self, city: City, call: Call) -> City:
        """Run one action and return the new city.

        Raises
        ------
        ActionRejected, ActionFailed
            The city is unchanged.
        InputError, UsageError
            What a user asked for cannot be; their words say it best.
        """
        index = self.journal.start_step(
            self.number, call.action, call.args, self.state, bind=call.bind
        )
        begin = time.perf_counter()
        seen = [key for key, state in self._seen.items() if state == self.state]
        try:
            with self.watch.step(step_name(call)):
                outcome = self._made_ahead(city, call) or run_action(
                    city, call, self.actions, inputs=self.inputs, seen=seen, budget=self.budget
                )
        except (ActionRejected, ActionFailed) as error:
            status = "rejected" if isinstance(error, ActionRejected) else "rolled_back"
            self.journal.end_step(self.number, index, status, state=self.state, error=str(error))
            if isinstance(error.__cause__, (InputError, UsageError)):
                raise error.__cause__ from error
            if isinstance(error, InternalFault) and self.faults is not None:
                with self.faults.open("a") as log:
                    log.write(f"{FAULT}{error}\n{''.join(traceback.format_exception(error))}\n")
            raise
        self._seen[call.key] = self.state
        self.state = derivation_key(self.state, call.action, call.args)
        spent = time.perf_counter() - begin
        if spent > LONG_S:
            return_freed_memory()
        self._count(spent)
        self.journal.end_step(
            self.number, index, "done", state=self.state, ms=round(spent * 1000),
            snapshot=self._snapshot(outcome.city),
        )  # fmt: skip
        for port, path in outcome.conversions.items():
            for name in path.steps:
                step = self.journal.start_step(self.number, name, {"fills": port}, self.state)
                self.journal.end_step(self.number, step, "done", state=self.state)
        return outcome.city

    def _made_ahead(self, city: City, call: Call) -> Outcome | None:
        after = self._ahead.take(city, call, self.watch) if self._ahead is not None else None
        return Outcome(after, None, {}) if after is not None else None

    def _count(self, seconds: float) -> None:
        self._spent += seconds
        if self.budget is not None:
            self.budget = Budget(self.budget.steps - 1, self.budget.seconds - seconds)

    def _snapshot(self, city: City) -> str:
        """Keep the city if much work would be lost otherwise; the older snapshot goes."""
        if self.keep is None or self.hold or self._spent < max(SNAPSHOT_S, self._cost / KEEPING):
            return ""
        from cityx.city.store import write_city

        self._spent, begin = 0.0, time.perf_counter()
        with self.watch.step("snapshot"):
            write_city(city, self.keep / self.state)
            held = self.journal.snapshot(self.number)
            wanted = {self.state, held[1] if held is not None else self.state}
            for folder in self.keep.iterdir():
                if folder.name not in wanted:
                    shutil.rmtree(folder)
        self._cost = time.perf_counter() - begin
        return self.state

    def resumed(self) -> City | None:
        """Return the last city that was kept before the process was killed, None without one."""
        held = self.journal.snapshot(self.number)
        if held is None or self.keep is None:
            return None
        from cityx.city.store import read_city

        state, folder = held
        try:
            kept = read_city(self.keep / folder)
        except (InputError, OSError, ValueError, KeyError):
            return None  # the snapshot was lost; all is done again
        self.state = state
        return kept


def unwatched(run: Run, city: City) -> City:
    """Return a city as it is, where nobody looks at it."""
    del run
    return city
