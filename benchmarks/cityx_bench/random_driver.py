"""Actions at random: the floor of the benchmark, and a test that no predicate holds by chance."""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.checks.predicates import Reply
from cityx.city import City
from cityx.errors import CityxError
from cityx.ids import rng_for, stable_id
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.gate import Call, find_faults
from cityx.protocol.input_files import InputFiles
from cityx.protocol.parameters import Parameter
from cityx.protocol.registry import Registry
from cityx.protocol.running import run_action
from cityx.sources.intake import sort_inputs
from cityx_bench.outcome import Fault, Outcome, Workplace, fault_of

STEPS = 6  # actions that run
TRIES = 80  # calls that are drawn, of which the gate refuses most
CHANGED = 0.3  # of the arguments that may be left out are given
SPREAD = 2.0  # times and part of its default that a number is drawn within: no town of 20 km
KINDS = ("plugin", "source", "edit")  # of actions that change a city
Value = Any


def random_outcome(place: Workplace, actions: Registry) -> Outcome:
    """Run a few random calls that pass the gate; equal seeds and tasks draw the same."""
    rng = rng_for(place.seed, "bench/random", stable_id("task", place.task.id))
    records = [record for name in actions if (record := actions[name]).kind in KINDS]
    sorted_files = sort_inputs(place.files).all
    inputs = InputFiles(
        tuple(item.path for item in sorted_files), tuple(item.kind for item in sorted_files)
    )
    city, done, faults = place.start, list[str](), list[Fault]()
    for _ in range(TRIES):
        if len(done) + len(faults) >= STEPS:
            break
        record = records[int(rng.integers(len(records)))]
        call = Call(record.id, _arguments(record, city, rng))
        if find_faults(call, city, actions, inputs=inputs):
            continue
        try:
            city = run_action(city, call, actions, inputs=inputs).city
        except CityxError as error:
            faults.append(fault_of(error)._replace(action=record.id))
        else:
            done.append(record.id)
    reply = Reply("done", frozenset(), tuple(done), len(done))
    return Outcome(city, reply, tuple(faults))


def _arguments(record: Encapsulation, city: City, rng: np.random.Generator) -> dict[str, Value]:
    return {
        parameter.name: _drawn(parameter, city, rng)
        for parameter in record.parameters
        if parameter.required or rng.random() < CHANGED
    }


def _drawn(parameter: Parameter, city: City, rng: np.random.Generator) -> Value:
    if parameter.names_object:
        names = city.layout.buildings["source"].tolist()
        name = str(rng.choice(names)) if names else "nothing"
        return [name] if parameter.lists_names else name
    if parameter.choices:
        return str(rng.choice(parameter.choices))
    if parameter.kind == "boolean":
        return bool(rng.random() < 0.5)
    if parameter.kind in ("integer", "number"):
        value = _number(parameter, rng)
        return round(value) if parameter.kind == "integer" else value
    if parameter.kind == "array":
        return [_number(parameter, rng) for _ in range(parameter.length or 2)]
    return parameter.default if not parameter.required else "modern"


def _number(parameter: Parameter, rng: np.random.Generator) -> float:
    low = 0.0 if parameter.low is None else parameter.low
    high = low + 1.0 if parameter.high is None else parameter.high
    usual = parameter.default
    if isinstance(usual, int | float) and not isinstance(usual, bool) and usual > 0:
        low, high = max(low, usual / SPREAD), min(high, usual * SPREAD)
    return float(rng.uniform(low, min(high, low + 1000.0)))
