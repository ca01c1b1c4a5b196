"""The offline planner: what a brief asks for, as a workflow over the registered actions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from cityx.agents.ablation import UNSAID
from cityx.agents.planning.search import (
    FILE,
    LAYOUT,
    STAGE,
    Fact,
    Node,
    Operator,
    Reached,
    Use,
    operators_of,
)
from cityx.agents.planning.workflow import PARTS, Item, Part, Workflow
from cityx.plugins.layout.presets import ORDER
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.holdings import OF_LAYOUT, READABLE
from cityx.protocol.serving import DO, Slots
from cityx.protocol.stages import stages_after, topological_order

# What a file of a kind holds.
FILES: Mapping[str, Fact] = {
    "drawn": (FILE, "drawn"),
    "osm": (FILE, "osm"),
    "semantic": (FILE, "semantic_map"),
    "satellite": (FILE, "satellite"),
    "height": (FILE, "height_field"),
}
TERRAIN: Fact = ("surface", "terrain")


@dataclass(frozen=True)
class Situation:
    """What a plan starts from.

    Attributes
    ----------
    lod
        Level of detail of the city.
    kinds
        Kinds of the input files, in order.
    stages
        Stages that have run.
    facts
        What has been made of the city besides its layout.
    """

    lod: int = 2
    kinds: tuple[str, ...] = ()
    stages: frozenset[str] = frozenset()
    facts: frozenset[Fact] = frozenset()


class OfflinePlanner:
    """Plans by search over what actions take and give.

    Parameters
    ----------
    records
        Records of the actions that may be used.
    """

    def __init__(self, records: Iterable[Encapsulation]) -> None:
        self.records = {record.id: record for record in records}
        self._operators = operators_of(self.records.values())

    def workflow(
        self,
        slots: Slots,
        situation: Situation,
        *,
        avoid: frozenset[str] = frozenset(),
        done: frozenset[str] = frozenset(),
        rev: int = 0,
    ) -> Workflow:
        """Return everything that is left to do.

        Parameters
        ----------
        slots
            What the brief asks for.
        situation
            What is there.
        avoid
            Actions that failed and are not to be tried again.
        done
            `Call.key` of what ran already.
        rev
            Of the new workflow.
        """
        operators = [item for item in self._operators if item.action not in avoid]
        missing: list[str] = []
        items: list[Item] = []
        if "layout" not in situation.stages:
            items += self._layout(slots, situation, operators, missing)
        wished = [item for item in self._wished(slots, avoid) if item.call.key not in done]
        items += [item for item in wished if self.records[item.action].stage == "layout"]
        if "height" in situation.kinds and "terrain" not in situation.stages:
            items += self._terrain(slots, operators, missing)
        others = [item for item in wished if self.records[item.action].stage != "layout"]
        items += self._parts(slots, situation, operators, others, missing)
        return Workflow(tuple(items), tuple(missing), rev)

    def answers(self, slots: Slots) -> list[Item]:
        """Return the actions that answer a wish by what they say they serve, in order."""
        return self._wished(slots, frozenset())

    def _layout(
        self,
        slots: Slots,
        situation: Situation,
        operators: Sequence[Operator],
        missing: list[str],
    ) -> list[Item]:
        """Choose how the files become a layout, or how one is made without any."""
        start = [
            Node(fact, frozenset({place}))
            for place, kind in enumerate(situation.kinds)
            if kind in FILES
            for fact in (FILES[kind], *READABLE.get(kind, ()))
        ]
        wanted = frozenset(place for place, kind in enumerate(situation.kinds) if kind in FILES)
        found = Reached(operators, start)
        node = found.best(LAYOUT, origin=wanted)
        unused = wanted - (node.origin if node else frozenset())
        for place in sorted(unused):
            if situation.kinds[place] != "height":
                missing.append(f"no action makes a layout of input {place + 1}")
        if node is None:
            missing.append("no action makes a layout")
            return []
        return self._items(found, [node], slots, "a layout")

    def _terrain(
        self, slots: Slots, operators: Sequence[Operator], missing: list[str]
    ) -> list[Item]:
        held = [Node(LAYOUT), Node((STAGE, "layout")), Node(FILES["height"], frozenset({0}))]
        found = Reached(operators, held)
        node = found.best(TERRAIN, origin=frozenset({0}))
        if node is None or not node.origin:
            missing.append("no action lays the terrain of height files")
            return []
        return self._items(found, [node], slots, "the terrain")

    def _parts(
        self,
        slots: Slots,
        situation: Situation,
        operators: Sequence[Operator],
        wished: Sequence[Item],
        missing: list[str],
    ) -> list[Item]:
        """Choose what makes each part of the city, and put it in order."""
        held = {LAYOUT, *OF_LAYOUT, *situation.facts}
        held |= {(STAGE, stage) for stage in situation.stages | {"layout", "terrain"}}
        found = Reached(
            [item for item in operators if LAYOUT not in item.gives], [Node(fact) for fact in held]
        )
        wanted: list[tuple[Part, Node]] = []
        for part in PARTS:
            if situation.lod not in part.lods or part.fact in situation.facts:
                continue
            node = found.best(part.fact)
            if node is None:
                missing.append(f"no action makes {part.name}")
            else:
                wanted.append((part, node))
        why = {use.operator.action: part.name for part, node in reversed(wanted)
               if (use := found.by.get(node))}  # fmt: skip
        items = [
            replace(item, why=why.get(item.action, item.why))
            for item in self._items(found, [node for _, node in wanted], slots, "what others need")
        ]
        planned = {item.action for item in items}
        items += [item for item in wished if item.action not in planned]
        return in_order(items, self.records)

    def _items(self, found: Reached, nodes: Sequence[Node], slots: Slots, why: str) -> list[Item]:
        """Turn the ways to some facts into items; the protocol runs conversions on the way."""
        items = []
        ends = {found.by.get(node) for node in nodes}
        for use in found.uses(nodes):
            record = self.records[use.operator.action]
            if record.scope == "value" and use not in ends:
                continue
            gives = tuple(" ".join(fact) for fact in use.operator.gives if fact[0] != STAGE)
            item = self._item(record, slots)
            items.append(replace(item, bind=_bind(use, record, found), why=why, gives=gives))
        return items

    def _wished(self, slots: Slots, avoid: frozenset[str]) -> list[Item]:
        """Return the actions that are called for, by name or by what they serve, in order."""
        called = [(str(action), dict(args)) for action, args in slots.get(DO, ())]
        rank = {action: place for place, action in enumerate(ORDER)}
        found = [
            self._item(self.records[action], slots, (action,), args)
            for action, args in sorted(called, key=lambda pair: rank.get(pair[0], len(rank)))
            if action in self.records and self.records[action].description != UNSAID
        ]
        found += [
            self._item(record, slots, wish.slots, wish.args)
            for record in self.records.values()
            for wish in record.serves
            if wish.asked(slots)
        ]
        return [item for item in found if item.action not in avoid]

    def _item(
        self,
        record: Encapsulation,
        slots: Slots,
        wish: tuple[str, ...] = (),
        args: Mapping[str, Any] = MappingProxyType({}),
    ) -> Item:
        gives = tuple(f"{port.format.value} {port.role}" for port in record.gives)
        why = "asked for" if wish else ""
        known = {parameter.name for parameter in record.parameters}
        said = {name: value for name, value in args.items() if name in known}
        return Item(
            record.id, {**arguments(record, slots), **said}, why=why, gives=gives, wish=wish
        )


def arguments(record: Encapsulation, slots: Slots) -> dict[str, Any]:
    """Return the arguments that a brief gives an action.

    A parameter takes the slot that the action binds to it, or that of its own name: "sun.time" is
    the parameter ``time`` of ``background/sun``. A slot of several values gives the first that the
    parameter admits; of one that it admits none of, the action's own default holds.
    """
    bound = dict(record.binds)
    args = {}
    for parameter in record.parameters:
        own = slots.get(f"{record.name}.{parameter.name}", ())
        for value in (*own, *slots.get(bound.get(parameter.name, ""), ())):
            if not parameter.fault(value):
                args[parameter.name] = value
                break
    return args


def in_order(items: Sequence[Item], records: Mapping[str, Encapsulation]) -> list[Item]:
    """Put actions in the order of `PARTS`, of their stages and of what they need of each other."""
    rank = {" ".join(part.fact): place for place, part in enumerate(PARTS)}
    first = sorted(
        enumerate(items),
        key=lambda pair: (min(rank.get(g, len(rank)) for g in pair[1].gives), pair[0]),
    )
    names = [f"{place:03d}" for place in range(len(first))]
    ordered = [item for _, item in first]
    stage = [records[item.action].stage for item in ordered]
    makes = {fact: name for name, item in zip(names, ordered, strict=True) for fact in item.gives}
    after: dict[str, set[str]] = {name: set() for name in names}
    for place, item in enumerate(ordered):
        for port in records[item.action].takes:
            maker = makes.get(f"{port.format.value} {port.role}")
            if maker is not None and maker != names[place] and port.role:
                after[maker].add(names[place])
        for other in range(len(ordered)):
            if stage[other] in stages_after(stage[place]):
                after[names[place]].add(names[other])
    return [ordered[int(name)] for name in topological_order(after)]


def _bind(use: Use, record: Encapsulation, found: Reached) -> dict[str, str]:
    """Name the role of the file that a port is filled from, through conversions or at once."""
    if record.scope != "value":
        return {}
    ports = [port for port in record.takes if not port.optional]
    roots = [found.root(node) for node in use.given]
    pairs = zip(ports, roots, strict=False)
    return {port.name: root[1] for port, root in pairs if (root,) in READABLE.values()}
