"""The loop: the planner proposes actions, the gate checks them, until nothing is left to do."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from cityx.agents.evaluator import HARD, ROUNDS, Judged, judged, of_layout
from cityx.agents.planning.planner import OfflinePlanner, Situation, Told
from cityx.agents.planning.search import Fact
from cityx.agents.planning.workflow import PROPOSED, Item, Workflow
from cityx.agents.pool import Message, Pool
from cityx.agents.roles import Executor, OfflineExecutor, Planner, attempt
from cityx.agents.step_runner import Run
from cityx.city import City, Goal
from cityx.city.city import Failure
from cityx.errors import ActionFailed, ActionRejected
from cityx.protocol.serving import Slots
from cityx.protocol.stages import Stage
from cityx.town.presets import TOWN

Say = Callable[[str], None]
MOST_FAILURES = 8  # steps that may fail before a run gives up


def quiet(_: str) -> None:
    """Say nothing."""


def unchanged(items: Sequence[Item], done: Sequence[Item]) -> list[Item]:
    """Return a workflow as it is."""
    del done
    return list(items)


@dataclass(frozen=True)
class _Kept:
    """A layout that may turn out to be the best, and where the loop stood with it."""

    city: City
    judged: Judged
    state: str
    plan: Workflow
    place: int
    told: int
    done: list[Item]
    unmet: list[tuple[Item, str]]
    made: set[Fact]


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
    goals
        What is asked for, to be measured.
    executor
        Who fills in arguments.
    told
        The instruction, for a planner that can read.
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
    goals: tuple[Goal, ...] = ()
    executor: Executor = field(default_factory=OfflineExecutor)
    told: Told = field(default_factory=Told)
    unmet: list[tuple[Item, str]] = field(default_factory=list)
    _avoid: set[str] = field(default_factory=set)
    _gone: set[str] = field(default_factory=set)
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
        start, round_ = city, 0
        best: _Kept | None = None
        city, place = self._begin(city)
        self.run.hold = self._reviews(place)
        while place < len(self._plan.items):
            item = self._plan.items[place]
            if self.run.hold and self.planner.records[item.action].stage != Stage.LAYOUT:
                kept = self._kept(city, place)
                best = kept if best is None or kept.judged.weight < best.judged.weight else best
                if best.judged.weight > 0 and round_ < ROUNDS:
                    round_ += 1
                    self.told = replace(self.told, missed=tuple(best.judged.texts))
                    fresh = self._again(start, round_)
                    if self._plan.items != best.plan.items:
                        city, place = fresh, 0
                        continue
                    # The plan does not tell one town from another: the same would come again.
                city, place = self._settled(best)
                continue
            self.say(f"{place + 1}/{len(self._plan.items)} {item.action}")
            self.run.look_ahead(city, self._plan.items, place)
            try:
                record = self.planner.records[item.action]
                city = attempt(self.executor, self.run.do, city, item, record, self.slots)
            except (ActionRejected, ActionFailed) as error:
                city, place = self._repaired(city, item, place, error)
                continue
            self._tell_done(item, place)
            place = self._onward(city, item, place)
        return self._refined(city, start) if self.goals else city

    def _refined(self, city: City, before: City) -> City:
        """Change single objects while that brings about more of what is asked; return the best."""
        # A killed run begins its refinement again: what was best is in no snapshot.
        self.run.hold = True
        best, least, state = city, math.inf, self.run.state
        for round_ in range(ROUNDS + 1):
            found = judged(city, (*self.goals, *city.goals), before)
            body = {"of": "city", "missed": found.texts}
            self.pool.say(Message("evaluator", "verdict", body, parent=self._told))
            if found.weight >= least:
                break
            best, least, state = city, found.weight, self.run.state
            items = self._remedied(city, found) if round_ < ROUNDS else []
            if not items:
                break
            self.say(f"refining, {round_ + 1} of {ROUNDS}: {', '.join(found.texts)}")
            city = self._changed(city, items)
        self.run.state, self.run.hold = state, False
        return best

    def _remedied(self, city: City, found: Judged) -> list[Item]:
        """Return the actions on single objects that bring about what is missed."""
        from cityx.agents.remedies import remedies
        from cityx.language.references.resolved_changes import slots_of_edit

        planner = OfflinePlanner(self.planner.records.values())
        return [
            replace(item, why=f"missed: {goal.text}")
            for goal, _ in found.missed
            for edit, chosen in remedies(goal.predicate, city)
            for item in planner.answers(slots_of_edit(edit, chosen, city))
        ]

    def _changed(self, city: City, items: list[Item]) -> City:
        """Run actions on single objects; what cannot be done is passed over."""
        self._plan = Workflow(tuple(items), rev=self._plan.rev + 1)
        self._told = self.pool.say(Message("planner", "workflow", self._plan.to_json()))
        for place, item in enumerate(items):
            record = self.planner.records[item.action]
            try:
                city = attempt(self.executor, self.run.do, city, item, record, self.slots)
            except (ActionRejected, ActionFailed) as error:
                self._tell_failed(item, place, error)
                continue
            self._tell_done(item, place)
        return city

    def _tell_done(self, item: Item, place: int) -> None:
        body = {"action": item.action, "item": place, "state": self.run.state}
        self.pool.say(Message("backend", "result", body, parent=self._told))

    def _tell_failed(self, item: Item, place: int, error: Exception) -> None:
        body = {"action": item.action, "error": str(error), "item": place}
        self.pool.say(Message("backend", "reject", body, parent=self._told))

    def _reviews(self, place: int) -> bool:
        """Return whether the layout is to be measured, and made again if it misses a goal."""
        first = self._plan.items[place : place + 1]
        return bool(of_layout(self.goals)) and bool(first) and first[0].action == TOWN

    def _kept(self, city: City, place: int) -> _Kept:
        """Measure a layout and keep all that is needed to go on from it."""
        found = judged(city, of_layout((*self.goals, *city.goals)))
        body = {"of": "layout", "missed": found.texts}
        self.pool.say(Message("evaluator", "verdict", body, parent=self._told))
        whole = replace(found, weight=found.weight + HARD * len(self.unmet))
        return _Kept(
            city, whole, self.run.state, self._plan, place, self._told, list(self._done),
            list(self.unmet), set(self._made),
        )  # fmt: skip

    def _again(self, start: City, round_: int) -> City:
        """Begin again with another town of the same description."""
        self.say(f"another layout, {round_} of {ROUNDS}")
        self.slots = {**self.slots, "town.variant": (round_,)}
        self._done, self.unmet, self._made, self._gone = [], [], set(), set()
        self.run.state = self.run.first
        self._propose(start)
        return start

    def _settled(self, best: _Kept) -> tuple[City, int]:
        """Go on from the best layout; return it and the place in its plan."""
        self.run.hold = False
        self.run.state, self._plan, self._told = best.state, best.plan, best.told
        self._done, self.unmet, self._made = best.done, best.unmet, best.made
        return best.city, best.place

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
        plans = {m.seq: Workflow.from_json(m.body) for m in self.pool.read("workflow")}
        self._plan, self._told = plans[last.parent], last.parent
        for message in self.pool.read("result"):
            if message.seq < last.seq:
                self._note(plans[message.parent].items[message.body["item"]])
        place = int(last.body["item"])
        self.say(f"going on after {self._plan.items[place].action}")
        return self._onward(city, self._plan.items[place], place)

    def _onward(self, city: City, item: Item, place: int) -> int:
        """Return the place of the next item; plan again when files hold other things."""
        self._note(item)
        left = {entry.action for entry in self._plan.items[place + 1 :]}
        if self.planner.records[item.action].kind != "source" or self._fits(city, left):
            return place + 1
        self._propose(city)
        return 0

    def _fits(self, city: City, left: set[str]) -> bool:
        """Return whether a plan still suits what the files turned out to hold."""
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
            done=frozenset((*(item.call.key for item in self._done), *self._gone)),
            rev=self._plan.rev + 1,
        )
        self._plan = replace(plan, items=tuple(self.amended(plan.items, self._done)))
        self._told = self.pool.say(Message("planner", "workflow", self._plan.to_json()))

    def _situation(self, city: City) -> Situation:
        layout = city.layout
        tables = (layout.buildings, layout.roads, layout.own_areas, layout.lines)
        filled = any(len(t) for t in tables)
        stages = city.stages_done if filled else city.stages_done - {"layout"}
        return Situation(city.lod, self.kinds, stages, frozenset(self._made), self.told)

    def _repaired(
        self, city: City, item: Item, place: int, error: ActionRejected | ActionFailed
    ) -> tuple[City, int]:
        """Find another way, or go on without what failed; return the city and the place.

        Raises
        ------
        ActionRejected, ActionFailed
            The error, if the city cannot be without it.
        """
        self._tell_failed(item, place, error)
        if item.firm or len(self.unmet) >= MOST_FAILURES:
            raise error
        why = f"{item.action} {dict(item.args)}: {error}"
        self.told = replace(self.told, failed=(*self.told.failed, why))
        if item.wish or item.why == PROPOSED:
            self.unmet.append((item, str(error)))
            if not self.planner.hears:
                return city, place + 1
            self._gone.add(item.call.key)
            self._propose(city)
            return city, 0
        self._avoid.add(item.action)
        before, leaf = len(self._plan.missing), self._is_leaf(item, place)
        self._propose(city)
        if len(self._plan.missing) > before:
            if not leaf:
                raise error
            self.unmet.append((item, str(error)))
            city = replace(city, failures=(*city.failures, Failure(0, item.action, str(error))))
        return city, 0

    def _is_leaf(self, item: Item, place: int) -> bool:
        """Return whether nothing else that is planned needs what an action gives."""
        taken = {
            f"{port.format.value} {port.role}"
            for other in self._plan.items[place + 1 :]
            for port in self.planner.records[other.action].takes
        }
        return not taken & {*item.gives} and "scene_layout layout" not in item.gives
