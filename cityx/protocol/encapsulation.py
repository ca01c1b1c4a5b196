"""The record of an action: S(Classname, Description, Input, Limitation, Run)."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from importlib import import_module
from typing import Any

from cityx.errors import ActionRejected, UsageError, nearest
from cityx.protocol.formats import Port
from cityx.protocol.parameters import Parameter
from cityx.protocol.preconditions import Pre
from cityx.protocol.serving import Serves
from cityx.protocol.stages import Stage, to_stage

ID_PATTERN = re.compile(r"([a-z]+)/([a-z][a-z0-9_]*)-v([1-9][0-9]*)")
CLASSNAME_PATTERN = re.compile(r"[A-Za-z][A-Za-z0-9_]{2,63}")
MAX_DESCRIPTION = 400  # letters; forty descriptions must fit one prompt
SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"
KINDS = ("plugin", "conversion", "source", "retrieval", "edit", "query", "render")
SCOPES = ("city", "thing", "value")


@dataclass(frozen=True)
class Encapsulation:
    """Everything the planner, the gate and the documentation know of an action.

    Attributes
    ----------
    id
        "stage/name-vN".
    classname
        C, the word models call it by.
    description
        D, one objective sentence.
    parameters, takes
        I, the scalar arguments and the data that come in.
    limits, requires, preconditions, after
        L, as prose, as stages that must have run, as tests of the city, and as stages and actions
        that come first where they are planned too. The ranges of parameters belong to L as well.
    run
        R, "module:function".
    gives
        The data that come out.
    kind
        One of `KINDS`.
    scope
        "city": City in, City out; "thing": mapped over the things of a layer; "value": data in,
        data out.
    cost, lossy
        Weight in a chain of conversions, and how much is lost, 0 (exact) to 1.
    needs
        Modules that must be importable, such as "bpy".
    labels
        Words for retrieval, beside those derived from the other fields.
    serves
        Wishes that the action answers.
    binds
        (parameter, slot) pairs: arguments that a brief gives.
    extension
        Whether it is a conversion beyond the paper's fourteen.
    """

    id: str
    classname: str
    description: str
    run: str
    parameters: tuple[Parameter, ...] = ()
    takes: tuple[Port, ...] = ()
    gives: tuple[Port, ...] = ()
    limits: tuple[str, ...] = ()
    requires: tuple[str, ...] = ()
    preconditions: tuple[Pre, ...] = ()
    after: tuple[str, ...] = ()
    kind: str = "plugin"
    scope: str = "city"
    cost: float = 1.0
    lossy: float = 0.0
    needs: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()
    serves: tuple[Serves, ...] = ()
    binds: tuple[tuple[str, str], ...] = ()
    extension: bool = False

    def __post_init__(self) -> None:
        """Refuse a record with anything missing or empty, naming every fault."""
        if faults := list(_faults(self)):
            raise UsageError(f"Action {self.id or '(no id)'}: {' '.join(faults)}")

    @property
    def stage(self) -> Stage:
        """The stage its id names."""
        return to_stage(self.id.partition("/")[0])

    @property
    def name(self) -> str:
        """The id without stage and version."""
        return self.id.partition("/")[2].rpartition("-v")[0]

    @property
    def version(self) -> int:
        """The number behind the id's "-v"."""
        return int(self.id.rpartition("-v")[2])

    @property
    def limitation(self) -> str:
        """L as one text: what must have run, tests, what it cannot do, what comes first, ranges."""
        said = [f"Needs stage {stage} to have run." for stage in self.requires]
        said += [*map(str, self.preconditions), *self.limits]
        if self.after:
            said.append(f"Comes after {', '.join(self.after)} where planned.")
        said += [f"{p.name}: {p.interval}." for p in self.parameters if p.interval]
        return " ".join(said)

    def parameter(self, name: str) -> Parameter | None:
        """Return the parameter of a name, or None."""
        return next((p for p in self.parameters if p.name == name), None)

    def schema(self) -> dict[str, Any]:
        """Return the JSON schema (Draft 2020-12) of the arguments."""
        return {
            "$schema": SCHEMA_DIALECT,
            "title": self.classname,
            "description": self.description,
            "type": "object",
            "properties": {p.name: p.schema() for p in self.parameters},
            "required": [p.name for p in self.parameters if p.required],
            "additionalProperties": False,
        }

    def to_paper(self) -> dict[str, Any]:
        """Return the paper's document of an action, as valid JSON.

        The paper's `tuple` is written as an array of fixed length, and limitation, run and the
        formats of inputs and outputs, which its example leaves out, are added.
        """
        return {
            "name": self.classname,
            "description": self.description,
            "parameters": {p.name: p.schema() for p in self.parameters},
            "limitation": self.limitation,
            "run": self.run,
            "input_formats": {port.name: port.format.value for port in self.takes},
            "output_formats": {port.name: port.format.value for port in self.gives},
        }

    def document(self) -> dict[str, Any]:
        """Return what people and clients are shown: the paper's document, then schema and the rest.

        The values are plain, fit for JSON.
        """
        return self.to_paper() | {
            "id": self.id,
            "stage": self.stage.value,
            "kind": self.kind,
            "requires": list(self.requires),
            "after": list(self.after),
            "preconditions": [test.to_json() for test in self.preconditions],
            "takes": [port.to_json() for port in self.takes],
            "gives": [port.to_json() for port in self.gives],
            "cost": self.cost,
            "lossy": self.lossy,
            "labels": list(self.labels),
            "serves": [wish.to_json() for wish in self.serves],
            "binds": dict(self.binds),
            "extension": self.extension,
            "schema": self.schema(),
        }

    def to_json(self) -> dict[str, Any]:
        """Return the whole record as a plain dictionary; `from_json` reads it back."""
        out: dict[str, Any] = {}
        for column in fields(self):
            value = getattr(self, column.name)
            if isinstance(value, tuple):
                value = [_plain(v) for v in value]
            out[column.name] = value
        return out

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> Encapsulation:
        """Rebuild a record.

        Raises
        ------
        UsageError
            If a field is missing, empty or unknown.
        """
        known = [column.name for column in fields(cls)]
        missing = [name for name in known if name not in record]
        unknown = [name for name in record if name not in known]
        if missing or unknown:
            faults = [f"field {name} is missing." for name in missing]
            faults += [f"there is no field {name}." for name in unknown]
            raise UsageError(f"Action {record.get('id', '(no id)')}: {' '.join(faults)}")
        made: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value
            for name, value in record.items()
        }
        made["parameters"] = tuple(map(Parameter.from_json, record["parameters"]))
        made["takes"] = tuple(map(Port.from_json, record["takes"]))
        made["gives"] = tuple(map(Port.from_json, record["gives"]))
        made["serves"] = tuple(map(Serves.from_json, record["serves"]))
        made["binds"] = tuple((parameter, slot) for parameter, slot in record["binds"])
        made["preconditions"] = tuple(map(Pre.from_json, record["preconditions"]))
        return cls(**made)

    def read(self, said: Mapping[str, str]) -> dict[str, Any]:
        """Return the values that texts stand for, by the kinds of the parameters."""
        known = {p.name: p for p in self.parameters}
        return {
            name: known[name].read(text) if name in known else text for name, text in said.items()
        }

    def argument_faults(self, args: Mapping[str, Any]) -> list[str]:
        """Return every reason why arguments are refused, one sentence each."""
        names = [p.name for p in self.parameters]
        found = []
        for name in sorted(args):
            if name not in names:
                hint = nearest(name, names) or (
                    f" It has {', '.join(names)}." if names else " It has none."
                )
                found.append(f'{self.id} has no parameter "{name}".{hint}')
        for parameter in self.parameters:
            if parameter.name in args:
                fault = parameter.fault(args[parameter.name])
                found += [f"{self.id}: {fault}"] if fault else []
            elif parameter.required:
                found.append(
                    f"{self.id}: {parameter.name} is missing. It is {parameter.description}"
                )
        return found

    def arguments(self, args: Mapping[str, Any]) -> dict[str, Any]:
        """Return admitted JSON arguments as Python values; those left out stay out.

        Raises
        ------
        ActionRejected
            If any is refused; the message names every fault.
        """
        if faults := self.argument_faults(args):
            raise ActionRejected(" ".join(faults), code="BAD_ARGS")
        return {p.name: p.coerce(args[p.name]) for p in self.parameters if p.name in args}

    def call(self, *data: Any, **args: Any) -> Any:
        """Check the arguments against their ranges and run the function on the data given."""
        return self.resolve()(*data, **self.arguments(args))

    def resolve(self) -> Callable[..., Any]:
        """Import and return the function that R names.

        Raises
        ------
        UsageError
            If it does not lead to a function.
        """
        module, _, name = self.run.partition(":")
        try:
            found = getattr(import_module(module), name)
        except (ImportError, AttributeError) as error:
            raise UsageError(f'Action {self.id}: run "{self.run}" leads nowhere.') from error
        if not callable(found):
            raise UsageError(f'Action {self.id}: run "{self.run}" is no function.')
        return found  # type: ignore[no-any-return]


def _plain(value: Any) -> Any:
    if hasattr(value, "to_json"):
        return value.to_json()
    return list(value) if isinstance(value, tuple) else value


def _faults(record: Encapsulation) -> list[str]:
    found: list[str] = []
    match = ID_PATTERN.fullmatch(record.id)
    if not match:
        found.append('the id is not of the form "stage/name-vN", such as "road/network-v1".')
    else:
        to_stage(match.group(1))
    if not CLASSNAME_PATTERN.fullmatch(record.classname):
        found.append("classname is empty or no word of 3 to 64 letters, digits and underscores.")
    if not record.description.strip():
        found.append("description is empty: write a docstring.")
    elif len(record.description) > MAX_DESCRIPTION:
        found.append(f"description has more than {MAX_DESCRIPTION} letters.")
    found += [
        f"parameter {p.name} is not described: add it to the docstring."
        for p in record.parameters
        if not p.description.strip()
    ]
    said = record.limits or record.requires or record.preconditions
    if not said or not all(text.strip() for text in record.limits):
        found.append("limits is empty: say what the action cannot do.")
    if not record.gives:
        found.append(
            'gives is empty: name the data that come out, such as Port("network", "line").'
        )
    if not re.fullmatch(r"[\w.]+:\w+", record.run):
        found.append('run is empty or not of the form "module:function".')
    for word in (*record.requires, *(w for w in record.after if not ID_PATTERN.fullmatch(w))):
        to_stage(word)
    if record.kind not in KINDS:
        found.append(f"kind {record.kind!r} is none of {', '.join(KINDS)}.")
    if record.scope not in SCOPES:
        found.append(f"scope {record.scope!r} is none of {', '.join(SCOPES)}.")
    if record.scope == "thing" and (
        len(record.takes) != 1 or record.gives[:1] != (Port("result", "complex_geometry"),)
    ):
        found.append("an action for one building takes its footprint alone and returns MeshBatch.")
    known = {p.name for p in record.parameters}
    for wish in record.serves:
        found += record.argument_faults(wish.args) if not wish.args.keys() <= known else []
    found += [
        f"binds names {parameter}, which is no parameter."
        for parameter, _ in record.binds
        if parameter not in known
    ]
    if record.cost < 0 or not 0 <= record.lossy <= 1:
        found.append("cost must be at least 0 and lossy between 0 and 1.")
    return found
