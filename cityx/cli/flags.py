"""Flags of commands, made of the dataclasses of `cityx.options`."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import is_dataclass
from functools import wraps
from typing import Annotated, Any

import typer

from cityx.options import Declared, declared, options_from


def with_flags(function: Callable[..., None]) -> Callable[..., None]:
    """Give a command the flags of its parameters that are annotated with dataclasses of options.

    The module of the command must not postpone the evaluation of annotations, which would also
    slow the start of every command down.
    """
    signature = inspect.signature(function)
    kinds = {name: item.annotation for name, item in signature.parameters.items()}
    groups: dict[str, Any] = {name: kind for name, kind in kinds.items() if is_dataclass(kind)}
    flags = {name: tuple(declared(kind)) for name, kind in groups.items()}
    parameters: list[inspect.Parameter] = []
    for name, item in signature.parameters.items():
        parameters += map(_parameter, flags[name]) if name in flags else [item]

    @wraps(function)
    def command(**values: Any) -> None:
        for name, kind in groups.items():
            given = {item.name: values.pop(item.name) for item in flags[name]}
            given = {key: value for key, value in given.items() if value is not None}
            values[name] = options_from(kind, given, flags=True)
        function(**values)

    del command.__dict__["__wrapped__"]  # typer would read its signature
    command.__dict__["__signature__"] = signature.replace(parameters=parameters)
    command.__annotations__ = {}
    return command


def _parameter(item: Declared) -> inspect.Parameter:
    """Return an option as typer reads it from the signature of a command."""
    option, kind, default = item.option, item.kind, item.default
    low, high = option.low, option.high
    if option.spelling is not None:
        low = high = None  # of the value; the text is read by its spelling
        kind = str if default is not None else str | None
        default = default if default is None else option.spelling.write(default)
    elif kind == tuple[str, ...]:
        kind, default = list[str] | None, None
    info = typer.Option(item.flag, help=option.help, min=low, max=high)
    return inspect.Parameter(
        item.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, info]
    )
