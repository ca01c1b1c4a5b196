"""The decorator that encapsulates a function as an action."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Protocol, TypeVar, cast, get_args, get_origin

from cityx.errors import UsageError
from cityx.protocol.docstrings import parse_docstring
from cityx.protocol.encapsulation import ID_PATTERN, Encapsulation
from cityx.protocol.formats import Port, format_of, to_format, type_name
from cityx.protocol.parameters import REQUIRED, ObjectName, Parameter, Range, parameter_from
from cityx.protocol.preconditions import Pre
from cityx.protocol.serving import Serves
from cityx.protocol.stages import stages_before

F = TypeVar("F", bound=Callable[..., Any])

CITY = "cityx.city.city:City"
GENERATOR = "numpy.random._generator:Generator"
INPUTS = "cityx.protocol.input_files:InputFiles"
# What the runner hands over by itself; never an argument of a call.
INJECTED = frozenset({CITY, GENERATOR, INPUTS})
_THING = "cityx.protocol.values:Footprint"
# Which buildings an action for one building is run on; the runner takes these, not the function.
_WHICH = (
    parameter_from(
        "objects", Annotated[tuple[str, ...] | None, ObjectName()], None,
        "The buildings to raise with it; all that it fits when left out.",
    ),
    parameter_from(
        "share", Annotated[float, Range(0.0, 1.0)], 1.0,
        "Share of those buildings, by the hash of their ids.",
    ),
)  # fmt: skip
WHICH = tuple(parameter.name for parameter in _WHICH)
_DEFAULT_KINDS = {"convert": "conversion", "edit": "edit", "render": "render"}


# What a stage reads and makes, for actions on the whole city that do not say it.
_LAYOUT = (Port("layout", "scene_layout", "layout"),)
_STAGE_TAKES = dict.fromkeys(("terrain", "building", "road", "nature", "dynamic"), _LAYOUT)
_STAGE_GIVES = {
    "layout": _LAYOUT,
    "terrain": (Port("terrain", "surface", "terrain"),),
    "building": (Port("buildings", "complex_geometry", "buildings"),),
    "road": (Port("roads", "complex_geometry", "road_mesh"),),
    "nature": (Port("plants", "complex_geometry", "plants"),),
    "background": (Port("sky", "texture_material", "sky"),),
    "dynamic": (Port("agents", "complex_geometry", "agents"),),
    "edit": (Port("scene", "complex_geometry", "scene"),),
    "render": (Port("picture", "image", "render"),),
}


class Action(Protocol):
    """A plain function that carries its record."""

    encapsulation: Encapsulation

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Run the function; nothing is checked."""


def action(
    action_id: str,
    *,
    limits: Sequence[str] = (),
    requires: Sequence[str | Pre] = (),
    after: Sequence[str] = (),
    takes: Sequence[Port] = (),
    gives: Sequence[Port] = (),
    cost: float = 1.0,
    lossy: float = 0.0,
    kind: str | None = None,
    labels: Sequence[str] = (),
    serves: Sequence[str | Serves] = (),
    binds: Mapping[str, str] | None = None,
    needs: Sequence[str] = (),
    classname: str | None = None,
    extension: bool = False,
) -> Callable[[F], F]:
    """Encapsulate a function as an action; it stays the plain function it was.

    Description and Input are read from the docstring and the signature. A first parameter of type
    `City` makes it an action on the whole city; otherwise its data ports are the parameters whose
    types belong to one of the fourteen formats.

    Parameters
    ----------
    action_id
        "stage/name-vN"; the version rises when a seed gives another result.
    limits
        Sentences on what it cannot do.
    requires
        Stages that must have run, and tests of the city such as ``has_layer("roads")``.
    after
        Actions that come first where they are planned too, beside the stages that come before its
        own.
    takes, gives
        Data ports; derived from the annotations where they can be. An action on the whole city that
        names none takes and gives what its stage does.
    cost, lossy
        Weight in a chain of conversions, and the share of information lost, 0 to 1.
    kind
        "plugin", "conversion", "source", "retrieval", "edit", "query" or "render"; by default
        follows from the stage.
    labels
        Words for retrieval.
    serves
        Wishes that it answers: the key of a brief's slot, or `Serves` for several with arguments.
    binds
        Parameter to the slot of a brief that fills it.
    needs
        Modules that must be importable, such as "bpy".
    classname
        The word models call it by; by default the name in the id.
    extension
        Whether it is a conversion beyond the paper's fourteen.

    Raises
    ------
    UsageError
        At import, if anything of the record is missing or empty.
    """

    def encapsulate(function: F) -> F:
        doc = parse_docstring(function.__doc__)
        signature = inspect.signature(function)
        hints = _hints(function, action_id)
        ports: list[Port] = []
        parameters: list[Parameter] = []
        kinds: list[str] = []
        for name, parameter in signature.parameters.items():
            if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
                raise UsageError(f"Action {action_id}: *{name} is not allowed; name every input.")
            if name not in hints:
                raise UsageError(f"Action {action_id}: parameter {name} has no annotation.")
            kinds.append(type_name(hints[name]))
            if kinds[-1] in INJECTED:
                continue
            text = doc.parameters.get(name, "")
            if not text:
                raise UsageError(
                    f"Action {action_id}: parameter {name} is not described in the docstring."
                )
            port = _port(name, hints[name], parameter)
            if port is not None:
                ports.append(port)
                if not type_name(_bare(hints[name])).startswith("builtins:"):
                    continue
            default = REQUIRED if parameter.default is parameter.empty else parameter.default
            try:
                parameters.append(parameter_from(name, hints[name], default, text))
            except UsageError as error:
                raise UsageError(f"Action {action_id}: {error}") from None
        result = hints.get("return")
        if result is None:
            raise UsageError(f"Action {action_id}: the result has no annotation.")
        match = ID_PATTERN.fullmatch(action_id)
        stage, name = (match.group(1), match.group(2)) if match else ("", "")
        scope = _scope(kinds, result)
        if scope == "thing":
            known = {parameter.name for parameter in parameters}
            parameters += [each for each in _WHICH if each.name not in known]
        record = Encapsulation(
            id=action_id,
            classname=name if classname is None else classname,
            description=doc.summary,
            run=f"{function.__module__}:{function.__name__}",
            parameters=tuple(parameters),
            takes=tuple(takes) or tuple(ports) or _stage_ports(_STAGE_TAKES, stage, scope),
            gives=tuple(gives) or _result_ports(result) or _stage_ports(_STAGE_GIVES, stage, scope),
            limits=tuple(limits),
            requires=tuple(word for word in requires if isinstance(word, str)),
            preconditions=tuple(test for test in requires if isinstance(test, Pre)),
            after=(*sorted(stages_before(stage)), *after),
            kind=kind or _DEFAULT_KINDS.get(stage, "plugin"),
            scope=scope,
            cost=cost,
            lossy=lossy,
            needs=tuple(needs),
            labels=tuple(labels),
            serves=tuple(Serves(s) if isinstance(s, str) else s for s in serves),
            binds=tuple((binds or {}).items()),
            extension=extension,
        )
        function.encapsulation = record  # type: ignore[attr-defined]
        return function

    return encapsulate


def encapsulation_of(function: object) -> Encapsulation:
    """Return the record of an action.

    Raises
    ------
    UsageError
        If the object is no action.
    """
    record = getattr(function, "encapsulation", None)
    if not isinstance(record, Encapsulation):
        raise UsageError(f"{function!r} is no action: it lacks the @action decorator.")
    return record


def hints_of(function: Callable[..., Any], action_id: str) -> dict[str, str]:
    """Return the "module:class" of every parameter and of the result ("return")."""
    hints = _hints(function, action_id)
    return {name: type_name(_bare(hint)) for name, hint in hints.items()}


def _hints(function: Callable[..., Any], action_id: str) -> dict[str, Any]:
    """Resolve annotations, also of names imported under TYPE_CHECKING that the protocol knows."""
    known: dict[str, Any] = {}
    names = getattr(function, "__globals__", {})
    while True:
        try:
            return typing.get_type_hints(function, localns=known, include_extras=True)
        except NameError as error:
            name = str(error.name)
            if name in known or name in names or name not in LATE_NAMES:
                raise UsageError(
                    f"Action {action_id}: annotation {name} is unknown when the plugin runs; "
                    "import it outside TYPE_CHECKING."
                ) from None
            known[name] = _late(name)


_VALUES = "cityx.protocol.values"
# Names that a plugin may import for type checking alone.
LATE_NAMES = {
    "City": "cityx.city.city",
    "Layout": "cityx.city.layout",
    "MeshBatch": "cityx.city.mesh",
    "Material": "cityx.assets.styles.materials",
    "np": "numpy",
    "InputFiles": "cityx.protocol.input_files",
    "Points": _VALUES,
    "Lines": _VALUES,
    "Surfaces": _VALUES,
    "Boxes": _VALUES,
    "Image": _VALUES,
    "GeographicData": _VALUES,
    "NoiseFunction": _VALUES,
    "Footprint": _VALUES,
    "LinearColor": _VALUES,
}


def _late(name: str) -> Any:
    from importlib import import_module

    module = import_module(LATE_NAMES[name])
    return module if name == "np" else getattr(module, name)


def _port(name: str, annotation: Any, parameter: inspect.Parameter) -> Port | None:
    """Return the data port of a parameter, or None when it is a scalar argument."""
    kind: Any = annotation
    marks: tuple[Any, ...] = ()
    if get_origin(annotation) is typing.Annotated:
        kind, *rest = get_args(annotation)
        marks = tuple(rest)
    ports = [mark for mark in marks if isinstance(mark, Port)]
    if ports:
        return Port(name, ports[0].format, ports[0].role, optional=ports[0].optional)
    fmt = format_of(kind)
    if fmt is None or type_name(kind).startswith(("builtins:", "numpy.")):
        return None
    if type_name(kind).endswith(":LinearColor") and parameter.default is not parameter.empty:
        return None
    return Port(name, fmt, optional=parameter.default is not parameter.empty)


def _result_ports(result: Any) -> tuple[Port, ...]:
    marks: tuple[Any, ...] = ()
    if get_origin(result) is typing.Annotated:
        result, *rest = get_args(result)
        marks = tuple(rest)
    for mark in marks:
        if isinstance(mark, Port):
            return (mark,)
    fmt = format_of(result)
    return () if fmt is None else (Port("result", to_format(fmt)),)


def _stage_ports(table: Mapping[str, tuple[Port, ...]], stage: str, scope: str) -> tuple[Port, ...]:
    return table.get(stage, ()) if scope == "city" else ()


def _scope(kinds: Sequence[str], result: Any) -> str:
    if type_name(_bare(result)) == CITY:
        return "city"
    return "thing" if _THING in kinds else "value"


def _bare(annotation: Any) -> Any:
    return get_args(annotation)[0] if get_origin(annotation) is typing.Annotated else annotation


def as_action(function: Callable[..., Any]) -> Action:
    """Return the function typed as an action, after checking that it is one."""
    encapsulation_of(function)
    return cast(Action, function)
