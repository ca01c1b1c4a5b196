"""Steps done ahead: those of a later stage, by a copy of this process, beside steps before them.

Buildings and streets both read the layout and the terrain and never each other
(`cityx.protocol.stages`). So a copy of the process raises the buildings while this one lays the
ground; what they changed is put into the city when their turn comes, step by step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from types import MappingProxyType
from typing import Any

from cityx.agents.planning.workflow import Item
from cityx.city import City
from cityx.city.city import Failure
from cityx.errors import CityxError
from cityx.protocol.gate import Call
from cityx.protocol.input_files import InputFiles
from cityx.protocol.registry import BUILTIN, Registry
from cityx.protocol.running import run_action
from cityx.protocol.stages import Stage
from cityx.system.forked import Forked
from cityx.system.stopwatch import Stopwatch


class Clash(Exception):
    """Both sides changed the same thing."""


@dataclass(frozen=True)
class Whole:
    """A part that became another."""

    value: Any


@dataclass(frozen=True)
class Inner:
    """A dataclass or a mapping some of whose members changed, each by a change of its own."""

    members: Mapping[str, Any]


@dataclass(frozen=True)
class More:
    """A tuple or set to which something was added."""

    added: Any


Change = Whole | Inner | More


def difference(before: Any, after: Any) -> Change | None:
    """Return what has changed of a value, None for nothing."""
    if after is before:
        return None
    if is_dataclass(after) and type(after) is type(before) and not isinstance(after, type):
        names = [item.name for item in fields(after) if item.init]
        pairs = {name: (getattr(before, name), getattr(after, name)) for name in names}
    elif isinstance(after, Mapping) and before is not None and not before.keys() - after.keys():
        pairs = {name: (before.get(name), value) for name, value in after.items()}
    elif isinstance(after, frozenset):
        return More(after - before) if after >= before else Whole(after)
    elif isinstance(after, tuple) and isinstance(before, tuple) and _is_told(after, before):
        return More(after[len(before) :]) if len(after) > len(before) else None
    else:
        return Whole(after)
    found = {name: difference(*pair) for name, pair in pairs.items()}
    return Inner({name: change for name, change in found.items() if change is not None})


def _is_told(after: tuple[Any, ...], before: tuple[Any, ...]) -> bool:
    """Return whether a tuple is one of words that go on; nothing counts its members by place."""
    words = all(isinstance(item, (str, Failure)) for item in after)
    return words and after[: len(before)] == before


def changed(current: Any, before: Any, change: Change) -> Any:
    """Put a change into a value that others may have changed as well.

    Parameters
    ----------
    current
        The value as it is.
    before
        What the change was made of.
    change
        From `difference`.

    Raises
    ------
    Clash
        If `current` differs from `before` where it is to change.
    """
    if isinstance(change, More):
        return current + change.added if isinstance(current, tuple) else current | change.added
    if isinstance(change, Whole):
        if current is not before:
            raise Clash
        return change.value
    if isinstance(current, Mapping):
        members = {
            name: changed(current.get(name), before.get(name), inner)
            for name, inner in change.members.items()
        }
        found = {**current, **members}
        return MappingProxyType(found) if isinstance(current, MappingProxyType) else found
    return replace(current, **{
        name: changed(getattr(current, name), getattr(before, name), inner)
        for name, inner in change.members.items()
    })  # fmt: skip


def later_stage(
    items: Sequence[Item], place: int, city: City, actions: Registry
) -> tuple[Call, ...]:
    """Return the calls that may be done beside the item at a place and those that follow it.

    They are those of the next stage, buildings, while streets are laid. What streets do to the
    terrain must have been done, and packages of others run in processes of their own.
    """
    stages = [actions[item.action].stage for item in items[place:]]
    if not stages or stages[0] != Stage.ROAD or city.heights is None:
        return ()
    first = next((i for i, stage in enumerate(stages) if stage != Stage.ROAD), len(stages))
    found = []
    for item, stage in zip(items[place + first :], stages[first:], strict=True):
        if stage != Stage.BUILDING or actions.entry(item.action).package != BUILTIN:
            break
        found.append(item.call)
    return tuple(found)


@dataclass(frozen=True)
class _Done:
    """A call made by the copy: its key, what it changed, its step and the seconds of that."""

    key: str
    change: Change | None
    step: str
    spent: Mapping[str, float]


class Ahead:
    """Calls that a copy of this process makes, one after the other.

    Parameters
    ----------
    city
        The city on which the first is made.
    calls
        The calls; no others are to come between them.
    actions, inputs
        As of `cityx.protocol.running.run_action`.
    """

    def __init__(
        self, city: City, calls: Sequence[Call], actions: Registry, inputs: InputFiles
    ) -> None:
        self._before = city
        self._keys = [call.key for call in calls]
        self._copy = Forked(lambda: _made(city, calls, actions, inputs))
        self._done: list[_Done] | None = None

    def take(self, city: City, call: Call, watch: Stopwatch) -> City | None:
        """Return the city with what a call changed; None where the call must be made now.

        Parameters
        ----------
        city
            As it is when the turn of the call has come.
        watch
            Takes the seconds that the copy has spent, of those of the step of the first call.
        """
        if not self._keys or self._keys[0] != call.key:
            return None
        if self._done is None:
            self._done = self._copy.result()
            first = step_name(call)
            for made in self._done:
                watch.split(first, {made.step: made.spent})
        before = self._before
        kept = city.layout is before.layout and city.terrain is before.terrain
        if not kept or not self._done:
            self.close()
            return None
        made = self._done.pop(0)
        try:
            after: City = city if made.change is None else changed(city, before, made.change)
        except Clash:
            self.close()
            return None
        self._before = after  # what the copy changed next it changed of this
        self._keys.pop(0)
        return after

    def close(self) -> None:
        """End the copy; nothing that it makes is of use."""
        self._keys.clear()
        self._copy.close()


def _made(city: City, calls: Sequence[Call], actions: Registry, inputs: InputFiles) -> list[_Done]:
    """Make calls until one fails: it will fail again when its turn has come."""
    found = []
    for call in calls:
        watch, name = Stopwatch(), step_name(call)
        with watch.step(name):
            try:
                after = run_action(city, call, actions, inputs=inputs).city
            except CityxError:
                break
            change = difference(city, after)
        spent = {"wall_s": watch.wall[name], "cpu_s": watch.cpu[name]}
        found.append(_Done(call.key, change, name, spent))
        city = after
    return found


def step_name(call: Call) -> str:
    """Return the name of the step of a call: its action without the version."""
    return call.action.rsplit("-v", 1)[0]
