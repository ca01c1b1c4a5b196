"""Search for plans: which actions, in which order, make facts of one kind from those at hand.

Actions add facts and take none away, so the problem is free of deletions: the cheapest way to each
fact is found in one pass over an AND/OR graph, as Dijkstra's algorithm does, with the costs of
several needs added up. A fact is a format with a role, and remembers the user's inputs it derives
from, since the cheapest picture of a city would ignore them all.

References
----------
Bonet and Geffner, "Planning as heuristic search", Artificial Intelligence 129, 2001: the additive
heuristic and the plans extracted from it.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from cityx.protocol.conversions import LOSS_WEIGHT
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.formats import Port

# A format and a role; STAGE and the name of one that has run; FILE and what a user's file holds.
Fact = tuple[str, str]
STAGE, FILE = "stage", "file"
LAYOUT: Fact = ("scene_layout", "layout")
KEPT = 4  # origins of a fact that are followed, cheapest first
PRECONDITIONS: Mapping[str, Fact] = {
    "has_network": ("line", "road_network"), "has_ground": ("surface", "ground"),
}  # fmt: skip


@dataclass(frozen=True)
class Node:
    """A fact and the inputs it derives from.

    Attributes
    ----------
    fact
        What it is.
    origin
        Positions of the user's inputs it derives from.
    """

    fact: Fact
    origin: frozenset[int] = frozenset()

    @property
    def key(self) -> tuple[Fact, tuple[int, ...]]:
        """By which nodes are ordered."""
        return self.fact, tuple(sorted(self.origin))


@dataclass(frozen=True)
class Operator:
    """An action as the search sees it.

    Attributes
    ----------
    action
        Its id.
    needs
        Facts it needs, all of them.
    reads
        Facts of which it takes all that there are, at least one; () for none.
    gives
        Facts it adds; a role "" is that of the fact it needs.
    cost
        Cost and loss together.
    """

    action: str
    needs: tuple[Fact, ...]
    reads: tuple[Fact, ...]
    gives: tuple[Fact, ...]
    cost: float


@dataclass(frozen=True)
class Use:
    """An operator with the facts it is given.

    Attributes
    ----------
    operator
        The operator.
    given
        One node for each of its needs, then those it reads.
    """

    operator: Operator
    given: tuple[Node, ...]


def operators_of(records: Iterable[Encapsulation]) -> tuple[Operator, ...]:
    """Read operators from the records of actions: their ports, stages and preconditions.

    Actions for one thing at a time, edits and renders are left out: no city needs them to be one.
    """
    return tuple(
        _operator(record)
        for record in records
        if record.scope != "thing" and record.kind not in ("edit", "render", "query", "retrieval")
    )


def _operator(record: Encapsulation) -> Operator:
    source = record.kind == "source" and record.scope == "city"
    required = [(port.format.value, port.role) for port in record.takes if not port.optional]
    files = [(FILE, port.role) for port in record.takes if port.optional and port.role]
    required += [(STAGE, stage) for stage in record.requires]
    required += [
        PRECONDITIONS[test.test] for test in record.preconditions if test.test in PRECONDITIONS
    ]
    gives = [_given(port, record) for port in record.gives]
    if LAYOUT in gives or record.scope == "city":
        gives.append((STAGE, "layout" if LAYOUT in gives else record.stage.value))
    return Operator(
        record.id,
        tuple(dict.fromkeys(required)),
        tuple(files) if source else (),
        tuple(gives),
        record.cost + LOSS_WEIGHT * record.lossy,
    )


def _given(port: Port, record: Encapsulation) -> Fact:
    """Return the fact of an output; a layout that comes of data becomes that of the city."""
    is_layout = port.format.value == LAYOUT[0] and not port.role
    return LAYOUT if is_layout or record.stage == "layout" else (port.format.value, port.role)


class Reached:
    """Every fact that can be had, the cheapest way to it, and whose inputs it derives from.

    Parameters
    ----------
    operators
        What may be done.
    start
        What is there.
    """

    def __init__(self, operators: Sequence[Operator], start: Iterable[Node]) -> None:
        self._operators = sorted(operators, key=lambda operator: operator.action)
        self.cost: dict[Node, float] = {}
        self.by: dict[Node, Use] = {}
        self._held: dict[Fact, list[Node]] = {}
        self._waiting: dict[str, list[Operator]] = {}
        for operator in self._operators:
            for format_name in {fact[0] for fact in (*operator.needs, *operator.reads)}:
                self._waiting.setdefault(format_name, []).append(operator)
        self._spread(list(start))

    def _spread(self, start: list[Node]) -> None:
        queue: list[tuple[float, tuple[Fact, tuple[int, ...]], int, Node, Use | None]] = []
        count = 0

        def push(cost: float, node: Node, use: Use | None) -> None:
            nonlocal count
            if node not in self.cost:
                count += 1
                heapq.heappush(queue, (cost, node.key, count, node, use))

        for node in start:
            push(0.0, node, None)
        for operator in self._operators:
            if not operator.needs and not operator.reads:
                for node in _results(operator, ()):
                    push(operator.cost, node, Use(operator, ()))
        while queue:
            cost, _, _, node, use = heapq.heappop(queue)
            if node in self.cost or self._is_idle(node):
                continue
            self.cost[node] = cost
            self._held.setdefault(node.fact, []).append(node)
            if use is not None:
                self.by[node] = use
            for operator in self._waiting.get(node.fact[0], ()):
                for given in self._choices(operator, node):
                    total = operator.cost + sum(self.cost[other] for other in given)
                    for made in _results(operator, given):
                        push(total, made, Use(operator, given))

    def _is_idle(self, node: Node) -> bool:
        """Return whether a fact adds nothing to a cheaper one of its kind."""
        same = self._held.get(node.fact, [])
        return len(same) >= KEPT or any(other.origin >= node.origin for other in same)

    def _choices(self, operator: Operator, new: Node) -> list[tuple[Node, ...]]:
        """Return the ways to give an operator its needs, the new fact among them."""
        if operator.reads and any(_fits(new.fact, fact) for fact in operator.reads):
            return self._all_read(operator)
        found: list[tuple[Node, ...]] = []
        for place, need in enumerate(operator.needs):
            if _fits(new.fact, need):
                pools = [
                    [new] if other == place else self._nodes(wanted)
                    for other, wanted in enumerate(operator.needs)
                ]
                read = tuple(node for fact in operator.reads for node in self._nodes(fact))
                if not operator.reads or read:
                    found += [(*given, *read) for given in product(*pools)]
        return found

    def _all_read(self, operator: Operator) -> list[tuple[Node, ...]]:
        read = tuple(node for fact in operator.reads for node in self._nodes(fact))
        pools = [self._nodes(need)[:1] for need in operator.needs]
        return [(*given, *read) for given in product(*pools)]

    def _nodes(self, wanted: Fact) -> list[Node]:
        exact = self._held.get(wanted)
        if exact:
            return exact
        nodes = [node for fact, held in self._held.items() if _fits(fact, wanted) for node in held]
        return sorted(nodes, key=lambda node: (self.cost[node], node.key))[:KEPT]

    def best(self, wanted: Fact, *, origin: frozenset[int] = frozenset()) -> Node | None:
        """Return the cheapest fact of a kind among those that derive from most of some inputs."""
        nodes = [node for fact, held in self._held.items() if _fits(fact, wanted) for node in held]
        order = sorted(nodes, key=lambda n: (-len(n.origin & origin), self.cost[n], n.key))
        return order[0] if order else None

    def root(self, node: Node) -> Fact:
        """Return the fact at hand that one comes from, by the first need of each action."""
        while (use := self.by.get(node)) is not None and use.given:
            node = use.given[0]
        return node.fact

    def uses(self, wanted: Iterable[Node]) -> list[Use]:
        """Return what must be done for some facts, each after what it needs."""
        found: dict[Use, None] = {}
        done: set[Node] = set()

        def visit(node: Node) -> None:
            if node in done:
                return
            done.add(node)
            use = self.by.get(node)
            if use is None:
                return
            for given in use.given:
                visit(given)
            found.setdefault(use)

        for node in wanted:
            visit(node)
        return list(found)


def _fits(fact: Fact, wanted: Fact) -> bool:
    if fact[0] != wanted[0]:
        return False
    return wanted[1] in ("", fact[1])


def _results(operator: Operator, given: tuple[Node, ...]) -> list[Node]:
    origin = frozenset[int]().union(*(node.origin for node in given))
    role = next((node.fact[1] for node in given if node.fact[0] != STAGE), "")
    return [
        Node((name, word if word or name == STAGE else role), origin)
        for name, word in operator.gives
    ]
