"""The offline planner: what a brief asks for, as a workflow over the registered actions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
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
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.holdings import OF_LAYOUT, READABLE
from cityx.protocol.serving import DO, Slots
from cityx.protocol.stages import topological_order

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
class Told:
    """What a planner that can read is told besides the slots.

    Attributes
    ----------
    text
        The instruction.
    unread, denied
        Words of it that nobody understood, and what it says not to have.
    goals
        What is measured, as predicates.
    missed
        Goals that the last layout missed, with what was measured.
    failed
        Actions that failed, with their reasons.
    """

    text: str = ""
    unread: tuple[str, ...] = ()
    denied: tuple[str, ...] = ()
    goals: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    failed: tuple[str, ...] = ()


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
    told
        The instruction, and what became of it so far.
    """

    lod: int = 2
    kinds: tuple[str, ...] = ()
    stages: frozenset[str] = frozenset()
    facts: frozenset[Fact] = frozenset()
    told: Told = field(default_factory=Told)


class OfflinePlanner:
    """Plans by search over what actions take and give.

    Parameters
    ----------
    records
        Records of the actions that may be used.
    """

    hears = False

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
        if "height" in situation.kinds and "terrain" not in situation.stages:
            items += self._terrain(slots, operators, missing)
        items += self._parts(slots, situation, operators, missing)
        planned = {item.action for item in items}
        items += [
            item
            for item in self._wished(slots, avoid)
            if item.call.key not in done and item.action not in planned
        ]
        return Workflow(tuple(in_order(items, self.records)), tuple(missing), rev)

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
        # What needs a layout itself makes none: terrain would go round and widen the site.
        first = [item for item in operators if not {LAYOUT, (STAGE, "layout")} & {*item.needs}]
        found = Reached(first, start)
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
        missing: list[str],
    ) -> list[Item]:
        """Choose what makes each part of the city."""
        held = {LAYOUT, *OF_LAYOUT, *situation.facts}
        held |= {(STAGE, stage) for stage in situation.stages | {"layout", "terrain"}}
        found = Reached(
            [item for item in operators if LAYOUT not in item.gives], [Node(fact) for fact in held]
        )
        wanted: list[tuple[Part, Node]] = []
        for part in self._listed():
            if situation.lod not in part.lods or part.fact in situation.facts:
                continue
            node = found.best(part.fact)
            if node is None:
                missing.append(f"no action makes {part.name}")
            else:
                wanted.append((part, node))
        why = {use.operator.action: part.name for part, node in reversed(wanted)
               if (use := found.by.get(node))}  # fmt: skip
        return [
            replace(item, why=why.get(item.action, item.why))
            for item in self._items(found, [node for _, node in wanted], slots, "what others need")
        ]

    def _listed(self) -> Sequence[Part]:
        """Return the parts as listed; by name where no record tells an order, as the list does."""
        told = any(record.after or record.requires for record in self.records.values())
        return PARTS if told else sorted(PARTS, key=lambda part: part.name)

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
        """Return the actions that are called for, by name or by what they serve."""
        called = [(str(action), dict(args)) for action, args in slots.get(DO, ())]
        found = [
            self._item(self.records[action], slots, (action,), args)
            for action, args in called
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
        known = {parameter.name: parameter for parameter in record.parameters}
        # What an action cannot do is left to its goal, which is missed and names it.
        said = {name: value for name, value in args.items()
                if name in known and not known[name].fault(value)}  # fmt: skip
        return Item(
            record.id, {**arguments(record, slots), **said}, why=why, gives=gives, wish=wish
        )


def arguments(record: Encapsulation, slots: Slots) -> dict[str, Any]:
    """Return the arguments that a brief gives an action.

    A parameter takes the slot that the action binds to it, or that of its own name: "sun.time" is
    the parameter ``time`` of ``background/sun``, unless nothing says what that action does. A slot
    of several values gives the first that the parameter admits; of one that it admits none of, the
    action's own default holds.
    """
    bound = dict(record.binds)
    args = {}
    for parameter in record.parameters:
        named = record.description != UNSAID
        own = slots.get(f"{record.name}.{parameter.name}", ()) if named else ()
        for value in (*own, *slots.get(bound.get(parameter.name, ""), ())):
            if not parameter.fault(value):
                args[parameter.name] = value
                break
    return args


# Slots that say where something comes to be; an action that is not told would choose another place.
PLACES = ("at", "within", "beside", "ground", "over", "walk.goal", "walk.origin")


def untaken(record: Encapsulation, slots: Slots, item: Item) -> list[str]:
    """Return why an action takes values that are asked for not at all; it must not run without.

    Parameters
    ----------
    record
        Of the action.
    slots
        What is asked for.
    item
        The action with the arguments that it takes.
    """
    taken = {slot for name, slot in record.binds if name in item.args}
    faults = []
    for name, slot in record.binds:
        if slot in slots and slot not in taken:
            parameter = next(one for one in record.parameters if one.name == name)
            faults.append(parameter.fault(slots[slot][0]))
            taken.add(slot)
    told = {slot.partition("=")[0] for slot in item.wish}
    if any(slots.get(slot) and slot not in taken | told for slot in PLACES):
        faults.append(
            f"{record.id} cannot be told such a place; name a square, a park, a street, a building "
            "or a thing."
        )
    return faults


def in_order(items: Sequence[Item], records: Mapping[str, Encapsulation]) -> list[Item]:
    """Put actions behind what they take data of and what their limitation puts before them.

    Nothing else decides; where these leave it open, the order in which actions were found stays.
    """
    names = [f"{place:03d}" for place in range(len(items))]
    makes = {fact: name for name, item in zip(names, items, strict=True) for fact in item.gives}
    after: dict[str, set[str]] = {name: set() for name in names}
    for name, item in zip(names, items, strict=True):
        record = records[item.action]
        for port in record.takes:
            maker = makes.get(f"{port.format.value} {port.role}")
            if maker is not None and maker != name and port.role:
                after[maker].add(name)
        earlier = _earlier(record, records)
        for other, entry in zip(names, items, strict=True):
            stage = records[entry.action].stage
            # What needs a stage to have run may be of that stage itself.
            waits = stage == record.stage and stage in records[entry.action].requires
            if entry.action in earlier or (stage in earlier and not waits and other != name):
                after[other].add(name)
    return [items[int(name)] for name in topological_order(after)]


def _earlier(record: Encapsulation, records: Mapping[str, Encapsulation]) -> set[str]:
    """Return stages and actions that come before an action, those before these included."""
    found: set[str] = set()
    left = [*record.after, *record.requires]
    while left:
        word = left.pop()
        if word not in found:
            found.add(word)
            left += records[word].after if word in records else ()
    return found


def _bind(use: Use, record: Encapsulation, found: Reached) -> dict[str, str]:
    """Name the role of the file that a port is filled from, through conversions or at once."""
    if record.scope != "value":
        return {}
    ports = [port for port in record.takes if not port.optional]
    roots = [found.root(node) for node in use.given]
    pairs = zip(ports, roots, strict=False)
    return {port.name: root[1] for port, root in pairs if (root,) in READABLE.values()}
