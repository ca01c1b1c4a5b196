"""The gate: every call is checked here before it runs, and all its faults are reported at once."""

from __future__ import annotations

import json
from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cityx.errors import ActionRejected, UsageError
from cityx.protocol.conversions import ConversionGraph, Path, serves
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.formats import Port
from cityx.protocol.holdings import Node, held, lacks
from cityx.protocol.objects import find_objects, name_hint
from cityx.protocol.stages import NEUTRAL, stages_after

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.protocol.input_files import InputFiles
    from cityx.protocol.registry import Registry

MOST_FAULTS = 5  # names that lead to no object of which one call is told
CODES = (
    "UNKNOWN_ACTION",
    "BAD_ARGS",
    "MISSING_INPUT",
    "PRECONDITION",
    "STAGE_ORDER",
    "NO_SUCH_OBJECT",
    "CAPABILITY",
    "UNTRUSTED",
    "DUPLICATE",
    "BUDGET",
)


@dataclass(frozen=True)
class Call:
    """An action and its arguments, as a planner proposes them.

    Attributes
    ----------
    action
        Id or name.
    args
        JSON values by parameter.
    bind
        Data port to the role of what the city holds ("road_centerline"), where the cheapest
        source is not meant.
    """

    action: str
    args: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    bind: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def key(self) -> str:
        """The call as one line of JSON, equal for equal calls."""
        record = [self.action, dict(self.args), dict(self.bind)]
        return json.dumps(record, sort_keys=True, default=repr)


@dataclass(frozen=True)
class Budget:
    """What a run may still spend.

    Attributes
    ----------
    steps
        Actions.
    seconds
        Wall time.
    """

    steps: int
    seconds: float


class Fault(NamedTuple):
    """One reason to refuse a call."""

    code: str
    message: str


class GateRejection(ActionRejected):
    """A refused call.

    Attributes
    ----------
    faults
        Every reason; the error's code is that of the first.
    """

    def __init__(self, faults: tuple[Fault, ...]) -> None:
        super().__init__("\n".join(f"{f.code}: {f.message}" for f in faults), code=faults[0].code)
        self.faults = faults


def check(
    call: Call,
    city: City,
    actions: Registry,
    *,
    inputs: InputFiles | None = None,
    seen: Container[str] = (),
    budget: Budget | None = None,
) -> None:
    """Check a call, and refuse it with all of its faults.

    Parameters
    ----------
    call
        The call.
    city
        State it would run on.
    actions
        The registry.
    inputs
        Files the user handed in.
    seen
        `Call.key` of calls that already ran on this very state.
    budget
        What may still be spent.

    Raises
    ------
    GateRejection
        With every fault found.
    """
    faults = find_faults(call, city, actions, inputs=inputs, seen=seen, budget=budget)
    if faults:
        raise GateRejection(faults)


def find_faults(
    call: Call,
    city: City,
    actions: Registry,
    *,
    inputs: InputFiles | None = None,
    seen: Container[str] = (),
    budget: Budget | None = None,
) -> tuple[Fault, ...]:
    """Return every reason to refuse a call, () when it may run; see `check`."""
    found: list[Fault] = []
    if budget is not None and (budget.steps < 1 or budget.seconds <= 0):
        left = f"{budget.steps} steps and {budget.seconds:g} seconds are left"
        found.append(Fault("BUDGET", f"The budget is spent: {left}."))
    try:
        action_id = actions.resolve(call.action)
    except UsageError as error:
        return (Fault("UNKNOWN_ACTION", str(error)), *found)
    if not actions.is_trusted(action_id):
        package = actions.entry(action_id).package
        message = f"{action_id} comes from package {package}, which is not trusted."
        return (Fault("UNTRUSTED", message), *found)
    record = actions[action_id]
    found += [Fault("BAD_ARGS", text) for text in record.argument_faults(call.args)]
    found += _missing_inputs(record, call, city, actions, inputs)
    found += [
        Fault("PRECONDITION", f"{record.id}: {test}")
        for test in record.preconditions
        if not test.holds(city)
    ]
    found += _order_faults(record, city)
    found += _object_faults(record, call, city)
    found += [
        Fault("CAPABILITY", f"{record.id} needs {module}, which is not installed.")
        for module in record.needs
        if find_spec(module) is None
    ]
    if call.key in seen:
        message = f"{record.id} already ran with these arguments on this very city."
        found.append(Fault("DUPLICATE", message))
    return tuple(found)


def stages_of(city: City) -> frozenset[str]:
    """Return the stages that have run; a layout with rows counts however it came."""
    layout = city.layout
    tables = (layout.buildings, layout.roads, layout.own_areas, layout.points)
    filled = any(len(t) for t in tables)
    return city.stages_done | ({"layout"} if filled else set())


def _order_faults(record: Encapsulation, city: City) -> list[Fault]:
    done = stages_of(city)
    found = [
        Fault("STAGE_ORDER", f"{record.id} needs stage {stage} to have run first.")
        for stage in record.requires
        if stage not in done
    ]
    if record.stage not in NEUTRAL:
        late = sorted(done & stages_after(record.stage))
        if late:
            words = " and ".join(late)
            found.append(
                Fault(
                    "STAGE_ORDER",
                    f"{record.id} is too late: stage {record.stage} comes before {words}, "
                    "which already ran.",
                )
            )
    return found


def _object_faults(record: Encapsulation, call: Call, city: City) -> list[Fault]:
    found = []
    for parameter in record.parameters:
        value = call.args.get(parameter.name)
        if not parameter.names_object or parameter.fault(value) or value is None:
            continue
        names = [value] if isinstance(value, str) else list(value)
        unknown = [names[at] for at in np.flatnonzero(find_objects(city, names) == 0).tolist()]
        for name in unknown[:MOST_FAULTS]:
            hint = name_hint(city, name)
            message = f'{record.id}: {parameter.name} = "{name}" names no single object.{hint}'
            found.append(Fault("NO_SUCH_OBJECT", message))
        if len(unknown) > MOST_FAULTS:
            more = f"{record.id}: so do {len(unknown) - MOST_FAULTS} more of {parameter.name}."
            found.append(Fault("NO_SUCH_OBJECT", more))
    return found


def open_ports(record: Encapsulation) -> tuple[Port, ...]:
    """Return the data ports of a typed action that the city must fill."""
    scalars = {p.name for p in record.parameters}
    return tuple(port for port in record.takes if port.name not in scalars)


def fill_port(
    port: Port,
    city: City,
    graph: ConversionGraph,
    role: str = "",
    inputs: InputFiles | None = None,
) -> Path | str:
    """Return how a port is filled from the city, or the sentence why it cannot be.

    Parameters
    ----------
    port
        The port.
    city
        The city.
    graph
        Conversions.
    role
        The role bound by the call, "" for the cheapest.
    inputs
        Files the user handed in.
    """
    held_nodes = held(city, inputs)
    nodes = [node for node in held_nodes if not role or node[1] == role]
    if not nodes:
        known = ", ".join(sorted({node[1] for node in held_nodes}))
        return f'The city holds nothing of role "{role}"; it holds {known}.'
    wanted: Node = (port.format, port.role)
    # A role that was asked for by name is taken as it is; otherwise the subject must agree.
    usable = nodes if role else [n for n in nodes if serves(n[1], port.role)]
    found = graph.best(((node, 0.0) for node in usable), (port.format, "" if role else wanted[1]))
    if isinstance(found, Path):
        return found
    return f"Nothing the city holds can become {port}: {found.reason}"


def _missing_inputs(
    record: Encapsulation, call: Call, city: City, actions: Registry, inputs: InputFiles | None
) -> list[Fault]:
    if record.scope == "city":
        return [
            Fault("MISSING_INPUT", f"{record.id} needs {port}, which no action has made yet.")
            for port in record.takes
            if not port.optional and lacks(city, (port.format, port.role))
        ]
    if record.scope == "thing":
        return []
    ports = [port for port in open_ports(record) if not port.optional or port.name in call.bind]
    found = [
        Fault("MISSING_INPUT", f'{record.id} has no data port "{name}" to bind.')
        for name in sorted(call.bind)
        if name not in {port.name for port in open_ports(record)}
    ]
    graph = ConversionGraph.of(actions) if ports else None
    for port in ports:
        assert graph is not None
        answer = fill_port(port, city, graph, call.bind.get(port.name, ""), inputs)
        if isinstance(answer, str):
            found.append(Fault("MISSING_INPUT", f"{record.id}: {answer}"))
    return found
