"""The conformance suite: what must hold for every action, built in or from elsewhere."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from importlib.util import find_spec
from typing import Any

import numpy as np
import shapely

from cityx.city.city import City
from cityx.errors import (
    ActionFailed,
    ActionRejected,
    CityxError,
    EngineError,
    MissingDependency,
    UsageError,
)
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.example_city import example_city
from cityx.protocol.fingerprint import fingerprint
from cityx.protocol.formats import FORMATS, Format, type_name
from cityx.protocol.input_files import InputFiles
from cityx.protocol.parameters import Parameter
from cityx.protocol.registry import Registry
from cityx.protocol.running import Call, injected, run_action
from cityx.protocol.stages import NEUTRAL, stages_after
from cityx.protocol.values import (
    GeographicData,
    Image,
    LinearColor,
    NoiseFunction,
    make_boxes,
    make_lines,
    make_points,
    make_surfaces,
)


@dataclass(frozen=True)
class Result:
    """Outcome of one test of one action.

    Attributes
    ----------
    action, test
        Which.
    passed
        Whether it holds; None when it cannot be tried here.
    message
        What is wrong, or why it was not tried.
    """

    action: str
    test: str
    passed: bool | None
    message: str = ""


class _Skip(Exception):
    """The test cannot be tried here; the text says why."""


class _Trial:
    """Two runs of one action on the same inputs, made when first asked for."""

    def __init__(self, record: Encapsulation, actions: Registry) -> None:
        self.record = record
        self.actions = actions

    @cached_property
    def runs(self) -> tuple[Any, Any, bool]:
        """Both results, and whether the inputs are as before."""
        city, data = _ready_city(self.record, self.actions), _data(self.record)
        before = fingerprint(city), fingerprint(data)
        first = _run(self.record, self.actions, city, data)
        second = _run(self.record, self.actions, city, data)
        return first, second, before == (fingerprint(city), fingerprint(data))


def check_action(name: str, actions: Registry) -> tuple[Result, ...]:
    """Run the suite on one action.

    Raises
    ------
    UsageError
        If there is no such action.
    """
    action_id = actions.resolve(name)
    try:
        trial = _Trial(actions[action_id], actions)
    except CityxError as error:
        return (Result(action_id, "record is complete", False, str(error)),)
    results = []
    for test in _TESTS:
        title = test.__name__.removeprefix("_").replace("_", " ")
        try:
            test(trial)
        except _Skip as reason:
            results.append(Result(action_id, title, None, str(reason)))
        except (AssertionError, CityxError) as error:
            results.append(Result(action_id, title, False, str(error) or "does not hold"))
        except Exception as error:  # noqa: BLE001  a plugin may raise anything
            text = f"{type(error).__name__}: {error}"
            results.append(Result(action_id, title, False, text))
        else:
            results.append(Result(action_id, title, True))
    return tuple(results)


def _record_is_complete(trial: _Trial) -> None:
    record = trial.record
    entry = trial.actions.entry(record.id)
    function = entry.load() if entry.generator else record.resolve()
    assert getattr(function, "encapsulation", None) == record, "run leads to another action"
    runs = entry.generator or entry.run == record.run
    assert runs, f"the entry runs {entry.run}, the record {record.run}"
    if record.kind == "conversion" and record.lossy > 0:
        said = any(text.startswith("Loses ") for text in record.limits)
        assert said, 'a conversion that loses something says it in limits: "Loses ..."'


def _schema_is_valid(trial: _Trial) -> None:
    record = trial.record
    from jsonschema import Draft202012Validator

    schema = record.schema()
    Draft202012Validator.check_schema(schema)
    paper = json.loads(json.dumps(record.to_paper()))
    assert set(paper) >= {"name", "description", "parameters", "limitation", "run"}
    validator = Draft202012Validator(schema)
    example = example_arguments(record)
    assert validator.is_valid(example), f"the schema refuses {example}"
    assert not validator.is_valid(example | {"no_such_parameter": 1})


def _record_survives_json(trial: _Trial) -> None:
    record = trial.record
    again = Encapsulation.from_json(json.loads(json.dumps(record.to_json())))
    assert again == record, "the record read back from JSON differs"


def _bad_arguments_are_rejected_by_name(trial: _Trial) -> None:
    record = trial.record
    good = example_arguments(record)
    assert not record.argument_faults(good), record.argument_faults(good)
    bad = {parameter.name: _bad_value(parameter.kind) for parameter in record.parameters}
    try:
        record.arguments(bad | {"no_such_parameter": 1})
    except ActionRejected as error:
        missing = [name for name in [*bad, "no_such_parameter"] if name not in str(error)]
        assert not missing, f"the refusal does not name {missing}"
    else:
        raise AssertionError("bad arguments were admitted")


def _bad_value(kind: str) -> Any:
    return {"boolean": 2, "string": 7}.get(kind, "bad")


def _runs_and_returns_its_type(trial: _Trial) -> None:
    value, record = trial.runs[0], trial.record
    if record.scope in ("city", "thing"):
        assert isinstance(value, City), f"it returned {type(value).__name__}, not City"
        return
    fmt = record.gives[0].format
    names = {type_name(kind) for kind in type(value).__mro__}
    wanted = FORMATS[fmt].types
    assert names & set(wanted), f"it returned {type(value).__name__}, no {fmt.value}"


def _same_seed_gives_the_same_result(trial: _Trial) -> None:
    first, second, _ = trial.runs
    assert fingerprint(first) == fingerprint(second), "two runs with one seed differ"


def _inputs_stay_untouched(trial: _Trial) -> None:
    assert trial.runs[2], "it wrote into its inputs"


_TESTS: tuple[Callable[[_Trial], None], ...] = (
    _record_is_complete,
    _schema_is_valid,
    _record_survives_json,
    _bad_arguments_are_rejected_by_name,
    _runs_and_returns_its_type,
    _same_seed_gives_the_same_result,
    _inputs_stay_untouched,
)


def example_arguments(record: Encapsulation) -> dict[str, Any]:
    """Return arguments that pass: defaults left out, required ones made up from their bounds."""
    roles = {port.name: port.role for port in record.takes}
    return {p.name: _example(p, roles.get(p.name, "")) for p in record.parameters if p.required}


# Words that mean something in the example city, by role of the port or name of the parameter.
_WORDS = {
    "asset": "tree_cone",
    "object": "The Tower",
    "streets": "Long Street",
    "along": "Long Street",
    "park": "The Park",
    "material": "red brick",
    "color": "#336699",
    "number": "12.5",
    "path": "Long Street",
}


def _example(parameter: Parameter, role: str) -> Any:
    if parameter.choices:
        return parameter.choices[0]
    if parameter.kind == "boolean":
        return True
    if parameter.kind == "string":
        role = "object" if parameter.names_object else role or parameter.name
        return _WORDS.get(role, "example")
    if parameter.lists_names:
        return [_WORDS.get(parameter.name, _WORDS["object"])]
    low = 1.0 if parameter.low is None else parameter.low
    high = low + 10 if parameter.high is None else parameter.high
    number = min(max(low, 2.0), high)
    if parameter.points:
        return [[number + 10 * row, number] for row in range(max(2, parameter.points[0]))]
    if parameter.kind == "array":
        return [number] * (parameter.length or 0)
    return int(number) if parameter.kind == "integer" else number


def _run(record: Encapsulation, actions: Registry, city: City, data: dict[str, Any]) -> Any:
    """Run an action on example data, or through the runner when it works on a city."""
    missing = [module for module in record.needs if find_spec(module) is None]
    if missing:
        raise _Skip(f"{missing[0]} is not installed")
    if record.kind == "source":
        raise _Skip("reads files of the user")
    args = example_arguments(record)
    try:
        if record.scope != "value":
            return run_action(city, Call(record.id, args), actions, apart=False).city
        function = actions.function(record.id)
        given = injected(record, function, city, InputFiles())
        return function(**given, **data, **record.arguments(args))
    except (EngineError, MissingDependency) as error:
        raise _Skip(str(error)) from error
    except ActionFailed as error:
        # An edit that is asked for nothing refuses; one that crashes has another cause.
        said = isinstance(error.__cause__, UsageError | ActionFailed)
        refused = record.stage == "edit" and said
        if record.stage != "layout" and not refused:
            raise
        raise _Skip(f"the example city has no room for it: {error}") from error


def _data(record: Encapsulation) -> dict[str, Any]:
    """Return an example value for every data port that is no argument."""
    scalars = {p.name for p in record.parameters}
    if record.scope != "value":
        return {}
    return {
        port.name: example_value(port.format, port.role)
        for port in record.takes
        if port.name not in scalars and not port.optional
    }


def example_value(fmt: Format, role: str = "") -> Any:
    """Return a small value of a format."""
    city = example_city()
    grid = np.stack(np.meshgrid(np.arange(4.0), np.arange(3.0)), axis=2).reshape(-1, 2)
    red, blue = LinearColor(1.0, 0.0, 0.0), LinearColor(0.0, 0.0, 1.0)
    pixels = np.zeros((3, 4, 3))
    pixels[:, :2], pixels[:, 2:] = red, blue
    if role == "height_field":
        pixels = np.linspace(0, 1, 12).reshape(3, 4, 1)
    square = shapely.box(0, 0, 10, 6)
    from cityx.assets.styles.materials import MATERIALS

    made: dict[Format, Callable[[], Any]] = {
        Format.SCENE_LAYOUT: lambda: city.layout,
        Format.NOISE_FUNCTION: lambda: NoiseFunction(1),
        Format.IMAGE: lambda: Image(pixels, 1.0, (0.0, 0.0), ((red, "building"), (blue, "park"))),
        Format.TEXTURE_MATERIAL: lambda: MATERIALS["brick"],
        Format.GEOGRAPHIC_DATA: lambda: GeographicData(
            np.array([shapely.box(24.94, 60.17, 24.941, 60.1705)], object),
            ({"building": "yes", "height": "12"},),
            ("example/1",),
        ),
        Format.POINT: lambda: make_points(grid, "tree", 1),
        Format.BOOLEAN: lambda: True,
        Format.COMPLEX_GEOMETRY: lambda: example_city(built=True).scene.meshes["buildings"],
        Format.COLOR: lambda: LinearColor(0.2, 0.4, 0.6),
        Format.BASIC_GEOMETRY: lambda: make_boxes([[0, 0, 0], [9, 0, 1]], (4, 3, 5), 0.3),
        Format.STRING: lambda: "example",
        Format.SURFACE: lambda: make_surfaces([square], "building", 9.0),
        Format.LINE: lambda: make_lines([shapely.LineString([(0, 0), (20, 0)])], "road", 6.0),
        Format.RANDOM_NUMBER: lambda: 3,
    }
    return made[fmt]()


@lru_cache(maxsize=16)
def _prepared(names: tuple[str, ...], *, built: bool, actions: Registry) -> City:
    city = example_city(built=built)
    for name in names:
        city = run_action(city, Call(name), actions, apart=False).city
    return city


def _ready_city(record: Encapsulation, actions: Registry) -> City:
    """Return an example city on which an action may run, made by the actions it needs."""
    if record.scope == "value" or record.stage in NEUTRAL:
        return _prepared((), built=True, actions=actions)
    wanted: list[str] = []
    roles = {port.role for port in record.takes if not port.optional}
    tests = {test.test for test in record.preconditions}
    layers = {test.layer for test in record.preconditions if test.test == "has_layer"}
    network = "has_network" in tests or "road_network" in roles or "road" in record.requires
    ground = "has_ground" in tests or bool(roles & {"ground", "ground_arrangement"})
    shells = "building" in record.requires or "buildings" in layers | roles
    if (network or ground) and record.id != "road/network-v1" and "road/network-v1" in actions:
        wanted.append("road/network-v1")
    if ground and record.id != "road/ground-v1" and "road/ground-v1" in actions:
        wanted.append("road/ground-v1")
    if shells and record.id != "building/shell-v1" and "building/shell-v1" in actions:
        wanted.append("building/shell-v1")
    try:
        city = _prepared(tuple(wanted), built=False, actions=actions)
    except (ActionRejected, ActionFailed) as error:
        raise _Skip(f"an action it builds on fails: {error}") from error
    return replace(city, stages_done=city.stages_done - stages_after(record.stage))
