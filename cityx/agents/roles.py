"""The roles of the agents: what each is asked, and the offline player of each.

A language model takes a role behind the same interface (`cityx.agents.models`). Whoever plays,
nothing but registered actions can come out, and the gate checks every call.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from cityx.agents.annotator import Labels, annotate
from cityx.agents.planning.planner import OfflinePlanner, Situation
from cityx.agents.planning.workflow import Item, Workflow
from cityx.agents.pool import Pool
from cityx.agents.verdict import Looked, Sight
from cityx.city import City
from cityx.errors import ActionRejected
from cityx.language import Brief
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.gate import Call
from cityx.protocol.serving import Slots

# Faults of a call that other arguments may mend; the others ask for another plan.
MENDABLE = ("BAD_ARGS", "NO_SUCH_OBJECT", "DUPLICATE")


class BriefMaker(Protocol):
    """Turns an instruction into slots."""

    def read(
        self,
        text: str,
        *,
        inputs: Sequence[tuple[str, str]] = (),
        base: bool = False,
        options: Mapping[str, Any] | None = None,
        names: Iterable[str] = (),
        stands: Sequence[str] = (),
    ) -> Brief:
        """Return the `Brief` of a text; arguments as of `cityx.language.read_brief`.

        Parameters
        ----------
        stands
            What stands in a city that is to be changed, in lines, for who can read them.
        """


class Planner(Protocol):
    """Says what is left to do."""

    @property
    def records(self) -> Mapping[str, Encapsulation]:
        """The actions that may be planned, by id."""

    @property
    def hears(self) -> bool:
        """Whether it plans otherwise when it is told what failed."""

    def workflow(
        self,
        slots: Slots,
        situation: Situation,
        *,
        avoid: frozenset[str] = frozenset(),
        done: frozenset[str] = frozenset(),
        rev: int = 0,
    ) -> Workflow:
        """Return a workflow; arguments as of `OfflinePlanner.workflow`."""


class Executor(Protocol):
    """Fills in the arguments of one action."""

    @property
    def tries(self) -> int:
        """Number of calls it may propose for one item before planning again."""

    def call(
        self, item: Item, record: Encapsulation, slots: Slots, faults: Sequence[str] = ()
    ) -> Call:
        """Return the call of an item; `faults` say why the last ones were refused."""


class Annotator(Protocol):
    """Labels the actions."""

    def label(
        self, database: sqlite3.Connection, registry: str, records: Iterable[Encapsulation]
    ) -> Labels:
        """Return action to labels; arguments as of `cityx.agents.annotator.annotate`."""


class Evaluator(Protocol):
    """Looks at what was built."""

    @property
    def sees(self) -> bool:
        """Whether pictures are of use to it."""

    def look(self, sight: Sight, wrong: Callable[[str], list[str]]) -> Looked | None:
        """Return what is seen, None where nobody answers.

        Parameters
        ----------
        sight
            The pictures, and what was asked for.
        wrong
            Returns why a command cannot be carried out.
        """


class OfflineBriefMaker:
    """Reads a brief by rules."""

    def read(
        self,
        text: str,
        *,
        inputs: Sequence[tuple[str, str]] = (),
        base: bool = False,
        options: Mapping[str, Any] | None = None,
        names: Iterable[str] = (),
        stands: Sequence[str] = (),
    ) -> Brief:
        """Return the brief of a text."""
        from cityx.language import read_brief

        del stands
        return read_brief(text, inputs=inputs, base=base, options=options, names=names)


class OfflineExecutor:
    """Calls an item as the planner wrote it: its arguments came from the brief."""

    tries = 1

    def call(
        self, item: Item, record: Encapsulation, slots: Slots, faults: Sequence[str] = ()
    ) -> Call:
        """Return the call of an item."""
        del record, slots, faults
        return item.call


class OfflineAnnotator:
    """Labels actions by what their records show."""

    def label(
        self, database: sqlite3.Connection, registry: str, records: Iterable[Encapsulation]
    ) -> Labels:
        """Return action to labels."""
        return annotate(database, registry, records)


class OfflineEvaluator:
    """Sees nothing; what no check can measure stays open."""

    sees = False

    def look(self, sight: Sight, wrong: Callable[[str], list[str]]) -> Looked | None:
        """Return None."""
        del sight, wrong
        return None


def _nothing(*_: Any) -> None:
    """Do nothing."""


@dataclass(frozen=True)
class Roles:
    """The players of the roles in a run.

    Attributes
    ----------
    brief_maker, planner, executor, annotator, evaluator
        The players.
    checker
        Who checks what the planner proposes, and plans before anything has been read.
    notes
        What the report says of them: where a model failed and who took over. It grows.
    attach
        Takes the messages of the run, once there are any, to write down what models cost.
    close
        Gives back what they hold; call it when the run ends.
    """

    planner: Planner
    checker: OfflinePlanner
    brief_maker: BriefMaker = field(default_factory=OfflineBriefMaker)
    executor: Executor = field(default_factory=OfflineExecutor)
    annotator: Annotator = field(default_factory=OfflineAnnotator)
    evaluator: Evaluator = field(default_factory=OfflineEvaluator)
    notes: list[str] = field(default_factory=list)
    attach: Callable[[Pool], None] = _nothing
    close: Callable[[], None] = _nothing


def offline_roles(records: Iterable[Encapsulation]) -> Roles:
    """Return the roles as they are played without a model."""
    planner = OfflinePlanner(records)
    return Roles(planner, planner)


def attempt(
    executor: Executor,
    do: Callable[[City, Call], City],
    city: City,
    item: Item,
    record: Encapsulation,
    slots: Slots,
) -> City:
    """Carry an item out, with other arguments where the gate refuses those proposed.

    Parameters
    ----------
    do
        Runs a call on a city and returns the new one.

    Raises
    ------
    ActionRejected, ActionFailed
        The last refusal, or what no other argument mends.
    """
    faults: list[str] = []
    while True:
        try:
            return do(city, executor.call(item, record, slots, faults))
        except ActionRejected as error:
            faults.append(str(error))
            if error.code not in MENDABLE or len(faults) >= executor.tries:
                raise
