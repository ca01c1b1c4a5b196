"""The loop: the planner proposes, the gate and the actions dispose, until nothing is left to do."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from cityx.agents.planning.planner import Situation
from cityx.agents.planning.search import Fact
from cityx.agents.planning.workflow import Item, Workflow
from cityx.agents.pool import Message, Pool
from cityx.agents.roles import Executor, OfflineExecutor, Planner, attempt
from cityx.agents.run import Run
from cityx.city import City
from cityx.city.city import Failure
from cityx.errors import ActionFailed, ActionRejected
from cityx.protocol.serving import Slots

Say = Callable[[str], None]
MOST_FAILURES = 8  # steps that may fail before a run gives up


def quiet(_: str) -> None:
    """Say nothing."""


def unchanged(items: Sequence[Item], done: Sequence[Item]) -> list[Item]:
    """Return a workflow as it is."""
    del done
    return list(items)


@dataclass
class Loop:
    """One run of the agents on one city.

    Attributes
    ----------
    planner
        Who proposes.
    run
        What carries a call out.
    pool
        Where all is told.
    slots
        What is asked for.
    kinds
        Kinds of the input files.
    amended
        Puts what a user asks of single actions into a workflow, less what was done of it.
    executor
        Who fills in arguments.
    unmet
        What failed and was left out, with the reason.
    """

    planner: Planner
    run: Run
    pool: Pool
    slots: Slots
    kinds: tuple[str, ...] = ()
    amended: Callable[[Sequence[Item], Sequence[Item]], list[Item]] = unchanged
    say: Say = quiet
    executor: Executor = field(default_factory=OfflineExecutor)
    unmet: list[tuple[Item, str]] = field(default_factory=list)
    _avoid: set[str] = field(default_factory=set)
    _made: set[Fact] = field(default_factory=set)
    _plan: Workflow = field(default_factory=Workflow)
    _told: int = -1
    _done: list[Item] = field(default_factory=list)

    def carry_out(self, city: City) -> City:
        """Plan and run until nothing is left to do; go on where a killed process stopped.

        Raises
        ------
        ActionRejected, ActionFailed
            If something fails that the city cannot be without.
        InputError, UsageError
            If the inputs or what is asked for make no city.
        """
        city, place = self._begin(city)
        while place < len(self._plan.items):
            item = self._plan.items[place]
            self.say(f"{place + 1}/{len(self._plan.items)} {item.action}")
            try:
                record = self.planner.records[item.action]
                city = attempt(self.executor, self.run.do, city, item, record, self.slots)
            except (ActionRejected, ActionFailed) as error:
                city, place = self._repaired(city, item, place, error)
                continue
            body = {"action": item.action, "item": place, "state": self.run.state}
            self.pool.say(Message("backend", "result", body, parent=self._told))
            place = self._onward(city, item, place)
        return city

    def _begin(self, city: City) -> tuple[City, int]:
        """Return the city to start from and the place in the plan."""
        kept = self.run.resumed()
        if kept is not None:
            for message in reversed(self.pool.read("result")):
                if message.body["state"] == self.run.state:
                    return kept, self._taken_up(kept, message)
        self._propose(city)
        return city, 0

    def _taken_up(self, city: City, last: Message) -> int:
        """Take up the plan after the last step that was kept; return the place in it."""
        told = next(m for m in self.pool.read("workflow") if m.seq == last.parent)
        self._plan, self._told = Workflow.from_json(told.body), told.seq
        plans = {m.seq: Workflow.from_json(m.body) for m in self.pool.read("workflow")}
        for message in self.pool.read("result"):
            if message.seq < last.seq:
                self._note(plans[message.parent].items[message.body["item"]])
        place = int(last.body["item"])
        self.say(f"going on after {self._plan.items[place].action}")
        return self._onward(city, self._plan.items[place], place)

    def _onward(self, city: City, item: Item, place: int) -> int:
        """Return the place of the next item; the plan is made anew when files hold other things."""
        self._note(item)
        left = {entry.action for entry in self._plan.items[place + 1 :]}
        if self.planner.records[item.action].kind != "source" or self._fits(city, left):
            return place + 1
        self._propose(city)
        return 0

    def _fits(self, city: City, left: set[str]) -> bool:
        """Tell whether a plan still suits what the files turned out to hold."""
        stages = self._situation(city).stages
        lays = any(self.planner.records[action].stage == "terrain" for action in left)
        return "layout" in stages and not (lays and "terrain" in stages)

    def _note(self, item: Item) -> None:
        record = self.planner.records[item.action]
        self._done.append(item)
        self._made |= {(port.format.value, port.role) for port in record.gives}
        if record.kind == "source":
            self._avoid.add(item.action)

    def _propose(self, city: City) -> None:
        """Plan everything that is left to do, and tell it."""
        plan = self.planner.workflow(
            self.slots,
            self._situation(city),
            avoid=frozenset(self._avoid),
            done=frozenset(item.call.key for item in self._done),
            rev=self._plan.rev + 1,
        )
        self._plan = replace(plan, items=tuple(self.amended(plan.items, self._done)))
        self._told = self.pool.say(Message("planner", "workflow", self._plan.to_json()))

    def _situation(self, city: City) -> Situation:
        layout = city.layout
        filled = any(len(t) for t in (layout.buildings, layout.roads, layout.areas, layout.lines))
        stages = city.stages_done if filled else city.stages_done - {"layout"}
        return Situation(city.lod, self.kinds, stages, frozenset(self._made))

    def _repaired(
        self, city: City, item: Item, place: int, error: ActionRejected | ActionFailed
    ) -> tuple[City, int]:
        """Find another way, or go on without what failed; return the city and the place.

        Raises
        ------
        ActionRejected, ActionFailed
            The error, if the city cannot be without it.
        """
        body = {"action": item.action, "error": str(error), "item": place}
        self.pool.say(Message("backend", "reject", body, parent=self._told))
        if item.firm or len(self.unmet) >= MOST_FAILURES:
            raise error
        if item.wish:
            self.unmet.append((item, str(error)))
            return city, place + 1
        self._avoid.add(item.action)
        before = len(self._plan.missing)
        self._propose(city)
        left = {entry.action for entry in self._plan.items}
        if len(self._plan.missing) > before and not self._leaf(item, left):
            raise error
        if len(self._plan.missing) > before:
            self.unmet.append((item, str(error)))
            city = replace(city, failures=(*city.failures, Failure(0, item.action, str(error))))
        return city, 0

    def _leaf(self, item: Item, left: set[str]) -> bool:
        """Tell whether nothing else that is planned needs what an action gives."""
        gives = set(item.gives)
        taken = {
            f"{port.format.value} {port.role}"
            for action in left
            for port in self.planner.records[action].takes
        }
        return not gives & taken and "scene_layout layout" not in gives and bool(left)
