"""The graph of conversions: how a value of one format becomes one of another."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.formats import Format
from cityx.protocol.holdings import Node
from cityx.protocol.registry import Registry

# Why some formats never become others: a sentence for every pair without a conversion.

F = Format
_PLACES = (F.SCENE_LAYOUT, F.POINT, F.LINE, F.SURFACE, F.BASIC_GEOMETRY, F.COMPLEX_GEOMETRY)
_SCALARS = (F.BOOLEAN, F.RANDOM_NUMBER)
_LOOKS = (F.COLOR, F.TEXTURE_MATERIAL)

_TO: dict[Format, str] = {
    F.NOISE_FUNCTION: (
        "A noise function is made from a seed alone; data would have to be fitted, "
        "which says nothing beyond them."
    ),
    F.GEOGRAPHIC_DATA: (
        "Geographic data carry longitude, latitude and a source; this value does not say "
        "where on Earth it lies."
    ),
    F.BOOLEAN: "A yes or no answers a question, and this value does not say which.",
    F.RANDOM_NUMBER: "A random number must not depend on data; its stream is keyed by identity.",
    F.STRING: "A text about this value needs a question; the queries of the scene answer those.",
    F.COLOR: "This value has no colour of its own.",
    F.TEXTURE_MATERIAL: "This value says nothing of how a surface looks.",
    F.IMAGE: "This value has no extent on the ground to draw.",
}
_FROM: dict[Format, str] = {
    F.NOISE_FUNCTION: "A noise function has no edges; draw it as an image and classify that.",
    F.BOOLEAN: "A yes or no has no place and no extent.",
    F.COLOR: "A colour has no place and no extent.",
    F.TEXTURE_MATERIAL: "A material has no place and no extent until it is given to a surface.",
    F.STRING: "A text is read into a brief by the agents, never into geometry.",
    F.RANDOM_NUMBER: "A single number decides too little.",
    F.IMAGE: "What the pixels mean is not said; a semantic map or a height image says it.",
}


def reason(source: Format, target: Format) -> str:
    """Return why one format never becomes another."""
    if target in _PLACES:
        return _FROM.get(source, "The value lacks a role that says what it shows.")
    return _TO.get(target, "No conversion keeps what this value is about.")


LOSS_WEIGHT = 10.0  # a full loss counts as ten exact steps
MAX_STEPS = 4  # longer chains have lost what the value was about


@dataclass(frozen=True)
class Edge:
    """One conversion in the graph.

    Attributes
    ----------
    action
        Id of the action.
    classname
        Its name; breaks ties.
    port
        Parameter that takes the value.
    source, target
        Nodes; a source role "" takes every role, a target role "" keeps the role it got.
    weight
        Cost and loss together.
    lossy
        Share lost, 0 to 1.
    """

    action: str
    classname: str
    port: str
    source: Node
    target: Node
    weight: float
    lossy: float


@dataclass(frozen=True)
class Path:
    """A chain of conversions.

    Attributes
    ----------
    source, target
        Nodes at its ends; the target's role is the one the value arrives with.
    edges
        The conversions in order; () when source and target agree.
    """

    source: Node
    target: Node
    edges: tuple[Edge, ...]

    @property
    def steps(self) -> tuple[str, ...]:
        """Classnames in order."""
        return tuple(edge.classname for edge in self.edges)

    @property
    def weight(self) -> float:
        """Cost and loss together."""
        return sum(edge.weight for edge in self.edges)

    @property
    def lossy(self) -> float:
        """Share lost over the whole chain, 0 to 1."""
        kept = 1.0
        for edge in self.edges:
            kept *= 1.0 - edge.lossy
        return 1.0 - kept


@dataclass(frozen=True)
class NotConvertible:
    """Why no chain exists.

    Attributes
    ----------
    source, target
        Nodes at the ends.
    reason
        One sentence.
    """

    source: Node
    target: Node
    reason: str


def subject(role: str) -> str:
    """Return the subject of a role: "road" of "road_centerline"."""
    return role.partition("_")[0]


def serves(role: str, wanted: str) -> bool:
    """Return whether something of one role may fill a port of another."""
    return wanted in ("", role) or role == "" or (subject(role) == subject(wanted))


class ConversionGraph:
    """All conversions of a registry.

    Parameters
    ----------
    records
        Records of conversions; those that do not take exactly one value are left aside.
    """

    def __init__(self, records: Iterable[Encapsulation]) -> None:
        self.edges = tuple(
            sorted(
                (edge for record in records for edge in _edges(record)),
                key=lambda e: (e.classname, e.port),
            )
        )

    @classmethod
    def of(cls, actions: Registry) -> ConversionGraph:
        """Read the conversions of a registry."""
        return cls(actions.records("convert"))

    def path(self, source: Node, target: Node) -> Path | NotConvertible:
        """Return the cheapest chain from one node to another, or why there is none."""
        return self.best(((source, 0.0),), target)

    def best(self, sources: Iterable[tuple[Node, float]], target: Node) -> Path | NotConvertible:
        """Return the cheapest chain to a node from any of several, each with a handicap.

        The order is that of weight, then length, then classnames, so the answer never depends on
        the order of the sources.
        """
        given = sorted(sources)
        queue: list[tuple[float, int, tuple[str, ...], Node, Node, tuple[Edge, ...]]] = [
            (handicap, 0, (), node, node, ()) for node, handicap in given
        ]
        heapq.heapify(queue)
        done: set[tuple[Node, int]] = set()
        while queue:
            weight, length, names, start, node, chain = heapq.heappop(queue)
            if node[0] is target[0] and serves(node[1], target[1]):
                return Path(start, node, chain)
            if (node, length) in done or length == MAX_STEPS:
                continue
            done.add((node, length))
            for edge in self.edges:
                if edge.source[0] is node[0] and serves(node[1], edge.source[1]):
                    after = (edge.target[0], edge.target[1] or node[1])
                    step = (weight + edge.weight, length + 1, (*names, edge.classname))
                    heapq.heappush(queue, (*step, start, after, (*chain, edge)))
        first = given[0][0] if given else (target[0], "")
        return NotConvertible(first, target, reason(first[0], target[0]))

    def table(self) -> Mapping[tuple[Format, Format], Path | NotConvertible]:
        """Return the answer for every pair of formats, whatever the roles."""
        roles = {fmt: {""} for fmt in Format}
        for edge in self.edges:
            roles[edge.source[0]].add(edge.source[1])
        return {
            (a, b): self.best((((a, role), 0.0) for role in sorted(roles[a])), (b, ""))
            for a in Format
            for b in Format
        }


def _edges(record: Encapsulation) -> list[Edge]:
    required = [port for port in record.takes if not port.optional]
    data = {port.name for port in record.takes}
    open_scalars = [p.name for p in record.parameters if p.required and p.name not in data]
    if len(required) != 1 or open_scalars or len(record.gives) != 1 or record.scope != "value":
        return []
    port, result = required[0], record.gives[0]
    weight = record.cost + LOSS_WEIGHT * record.lossy
    return [
        Edge(
            record.id,
            record.classname,
            port.name,
            (port.format, port.role),
            (result.format, result.role),
            weight,
            record.lossy,
        )
    ]


def apply_path(path: Path, value: Any, actions: Registry, **injected: Any) -> Any:
    """Run a chain on a value.

    Parameters
    ----------
    path
        The chain.
    value
        Value of the chain's source format.
    actions
        Registry the chain was found in.
    injected
        What actions may ask for besides: ``city`` for those that look into the city.
    """
    for edge in path.edges:
        record = actions[edge.action]
        extra = {name: injected[name] for name in injected_names(record, actions) if name}
        value = actions.function(edge.action)(**extra, **{edge.port: value})
    return value


def injected_names(record: Encapsulation, actions: Registry) -> tuple[str, ...]:
    """Return the parameters of an action that the runner fills by itself."""
    import inspect

    named = {p.name for p in record.parameters} | {port.name for port in record.takes}
    signature = inspect.signature(actions.function(record.id))
    return tuple(name for name in signature.parameters if name not in named)
