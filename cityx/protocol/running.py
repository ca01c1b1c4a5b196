"""Running a call: through the gate, as a transaction, with ports filled and things mapped."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

from cityx.city.city import City
from cityx.errors import ActionFailed, CityxError, EngineError, InternalFault, MissingDependency
from cityx.ids import rng_for, stable_id
from cityx.protocol.actions import CITY, GENERATOR, INPUTS, hints_of
from cityx.protocol.conversions import ConversionGraph, Path, apply_path
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.gate import Budget, Call, check, fill_port, open_ports
from cityx.protocol.holdings import take
from cityx.protocol.input_files import InputFiles
from cityx.protocol.isolation import is_inside, run_apart
from cityx.protocol.registry import BUILTIN
from cityx.protocol.stages import NEUTRAL
from cityx.system.atomic import disk_fault

if TYPE_CHECKING:
    from collections.abc import Container

    from cityx.protocol.registry import Registry


from typing import TYPE_CHECKING

import numpy as np

from cityx.city.layout import Layout
from cityx.city.mesh import MeshBatch, concatenate
from cityx.city.sites import merged
from cityx.protocol.formats import Format

if TYPE_CHECKING:
    from cityx.protocol.encapsulation import Encapsulation
    from cityx.protocol.registry import Registry

# Putting what a typed action returned into the city.

# Formats that describe what lies on the ground go into the layout, solid ones into the scene;
# the others are answers and leave the city as it is.
_INTO_LAYOUT = (Format.POINT, Format.LINE, Format.SURFACE, Format.GEOGRAPHIC_DATA)
_INTO_SCENE = (Format.BASIC_GEOMETRY,)


def deposit(city: City, value: Any, record: Encapsulation, actions: Registry) -> City:
    """Return the city with a value added: objects of ids already there are replaced."""
    fmt = record.gives[0].format
    target = None
    if fmt in _INTO_LAYOUT:
        target = Format.SCENE_LAYOUT
    elif fmt in _INTO_SCENE:
        target = Format.COMPLEX_GEOMETRY
    if target is not None:
        path = ConversionGraph.of(actions).path((fmt, record.gives[0].role), (target, ""))
        if isinstance(path, Path):
            value = apply_path(path, value, actions, city=city)
    if isinstance(value, Layout):
        return replace(city, layout=merged(city.layout, value))
    if isinstance(value, MeshBatch):
        return replace(city, scene=city.scene.with_mesh(record.name, _named(value, record)))
    return city


def _named(batch: MeshBatch, record: Encapsulation) -> MeshBatch:
    """Give ids to meshes that have none and sort by id."""
    ids = batch.object_id.copy()
    for row in np.flatnonzero(ids == 0).tolist():
        ids[row] = stable_id(record.id, row)
    named = replace(batch, object_id=ids)
    return concatenate([named]).take(np.argsort(ids, kind="stable"))


RAISER = "cityx.building.mesh_buildings:raised_by"  # called by name, as actions are
__all__ = ["Budget", "Call", "Outcome", "injected", "run_action", "run_step"]


@dataclass(frozen=True)
class Outcome:
    """What a call came to.

    Attributes
    ----------
    city
        The new city.
    value
        What a typed action returned; None for an action on the whole city.
    conversions
        Port to the chain that filled it: part of what was done, for the journal.
    """

    city: City
    value: Any
    conversions: Mapping[str, Path]


def run_step(
    city: City,
    call: Call,
    actions: Registry,
    *,
    inputs: InputFiles | None = None,
    seen: Container[str] = (),
    budget: Budget | None = None,
    apart: bool = True,
) -> City:
    """Run one call and return the new city; see `run_action`."""
    return run_action(
        city, call, actions, inputs=inputs, seen=seen, budget=budget, apart=apart
    ).city


def run_action(
    city: City,
    call: Call,
    actions: Registry,
    *,
    inputs: InputFiles | None = None,
    seen: Container[str] = (),
    budget: Budget | None = None,
    apart: bool = True,
) -> Outcome:
    """Run one call: gate, ports, function, result. Whatever fails, `city` stays as it was.

    Parameters
    ----------
    city
        State before.
    call
        The call.
    actions
        The registry.
    inputs
        Files the user handed in, for actions that read them.
    seen, budget
        As in `cityx.protocol.gate.check`.
    apart
        Whether actions of other packages run in a process of their own, within limits.

    Raises
    ------
    ActionRejected
        If the gate refuses the call.
    ActionFailed
        If the action fails; the message starts with its id.
    EngineError, MissingDependency
        If an engine it needs does not work.
    """
    check(call, city, actions, inputs=inputs, seen=seen, budget=budget)
    record = actions[call.action]
    entry = actions.entry(record.id)
    outside = entry.package != BUILTIN and not entry.generator  # its action is one of CityX
    if apart and outside and record.scope != "thing" and not is_inside():
        return Outcome(run_apart(city, call, inputs, package=entry.package), None, {})
    function = actions.function(record.id)
    args = record.arguments(call.args)
    given = injected(record, function, city, inputs or InputFiles())
    with_id = f"{record.id} failed: "
    try:
        if record.scope == "thing":
            whose = entry.package if apart else BUILTIN
            raised = _raiser()(city, function, args, package=whose)
            return Outcome(_finished(city, raised, record, call), None, {})
        paths = {} if record.scope == "city" else _paths(record, call, city, actions, inputs)
        for name, path in paths.items():
            given[name] = apply_path(path, take(city, path.source, inputs), actions, city=city)
        result = function(**given, **args)
    except (EngineError, MissingDependency):
        raise
    except ActionFailed as error:
        text = str(error)
        said = text if text.startswith(record.id) else with_id + text
        raise type(error)(said) from error
    except Exception as error:
        if disk_fault(error):
            raise
        ours = entry.package == BUILTIN and not isinstance(error, CityxError)
        kind = InternalFault if ours else ActionFailed
        raise kind(f"{with_id}{type(error).__name__}: {error}") from error
    if record.scope == "city":
        if not isinstance(result, City):
            raise ActionFailed(f"{with_id}it returned {type(result).__name__}, not City.")
        return Outcome(_finished(city, result, record, call), None, {})
    after = deposit(city, result, record, actions)
    return Outcome(_finished(city, after, record, call), result, paths)


def _raiser() -> Callable[..., City]:
    """Return what raises buildings by an action for one building: a module of a room above."""
    module, _, name = RAISER.partition(":")
    found: Callable[..., City] = getattr(import_module(module), name)
    return found


def _finished(before: City, after: City, record: Encapsulation, call: Call) -> City:
    if record.stage in NEUTRAL or (after is before and record.scope == "value"):
        return after
    earlier = {action: args for action, args in after.made.items() if action != record.id}
    return replace(
        after,
        stages_done=after.stages_done | {record.stage.value},
        made={**earlier, record.id: dict(call.args)},
    )


def _paths(
    record: Encapsulation,
    call: Call,
    city: City,
    actions: Registry,
    inputs: InputFiles | None,
) -> dict[str, Path]:
    ports = [port for port in open_ports(record) if not port.optional or port.name in call.bind]
    if not ports:
        return {}
    graph = ConversionGraph.of(actions)
    found: dict[str, Path] = {}
    for port in ports:
        answer = fill_port(port, city, graph, call.bind.get(port.name, ""), inputs)
        if isinstance(answer, Path):
            found[port.name] = answer
    return found


def injected(
    record: Encapsulation, function: Callable[..., Any], city: City, inputs: InputFiles
) -> dict[str, Any]:
    """Return what the runner hands over: the city, the input files, a random stream."""
    out: dict[str, Any] = {}
    for name, kind in hints_of(function, record.id).items():
        if name == "return":
            continue
        if kind == CITY:
            out[name] = city
        elif kind == INPUTS:
            out[name] = inputs
        elif kind == GENERATOR:
            out[name] = rng_for(city.seed, record.id, stable_id("action", record.id))
    return out
