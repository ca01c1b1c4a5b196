"""Tables of data in TOML: read once, strictly, into the dataclasses of the code."""

from __future__ import annotations

import dataclasses
import tomllib
import types
import typing
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin

from cityx.errors import InputError, nearest

T = TypeVar("T")
DATA = Path(__file__).parents[1] / "data"


def read_table(path: Path) -> dict[str, Any]:
    """Read a TOML file.

    Raises
    ------
    InputError
        If there is none or it is not TOML; the message names the file and the line.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{path.name} cannot be read as TOML: {error}.") from error


def filled(kind: type[T], table: Mapping[str, Any], place: str) -> T:
    """Make a dataclass of a table: tables become dataclasses and mappings, arrays tuples.

    Parameters
    ----------
    kind
        The dataclass; what the table leaves out keeps its default.
    table
        As TOML gives it. Where pairs of a word and a number are due, a table ``{word = number}``
        does, and a word alone has the number 1.
    place
        File and table, for messages.

    Raises
    ------
    InputError
        If a key is unknown or missing, or a value has another type; the message names the place.
    """
    hints = _hints(kind)  # type: ignore[arg-type]
    for key in table:
        if key not in hints:
            raise InputError(f'{place}: there is no key "{key}".{nearest(key, hints)}')
    for field in dataclasses.fields(kind):  # type: ignore[arg-type]
        required = field.default is field.default_factory is dataclasses.MISSING
        if required and field.name not in table:
            raise InputError(f'{place}: the key "{field.name}" is missing.')
    values = {key: _value(hints[key], value, f"{place}, {key}") for key, value in table.items()}
    return kind(**values)


@cache
def _hints(kind: type[Any]) -> dict[str, Any]:
    known: dict[str, Any] = {}
    while True:
        try:
            return typing.get_type_hints(kind, localns=known)
        except NameError as error:  # imported for type checks alone: no table gives one
            if error.name in known:
                raise
            known[str(error.name)] = Any


def _value(hint: Any, value: Any, place: str) -> Any:
    if dataclasses.is_dataclass(hint) and isinstance(value, dict):
        return filled(hint, value, place)  # type: ignore[arg-type]
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (tuple, Sequence):
        return _tuple(inner, value, place)
    if origin is Mapping and isinstance(value, dict):
        made = {key: _value(inner[1], each, f"{place}.{key}") for key, each in value.items()}
        return types.MappingProxyType(made)
    if origin in (types.UnionType, typing.Union):
        return _value(next(each for each in inner if each is not type(None)), value, place)
    if hint is float and type(value) is int:
        return float(value)
    if type(value) is not hint:
        raise InputError(f"{place}: {value!r} is not of type {_word(hint)}.")
    return value


def _tuple(inner: Sequence[Any], value: Any, place: str) -> tuple[Any, ...]:
    many = len(inner) == 1 or inner[-1] is Ellipsis
    if many and get_args(inner[0])[:2] == (str, float):
        value = {value: 1.0} if isinstance(value, str) else value
        value = list(value.items()) if isinstance(value, dict) else value
    if not isinstance(value, (list, tuple)) or not (many or len(value) == len(inner)):
        due = "an array" if many else f"an array of {len(inner)}"
        raise InputError(f"{place}: {value!r} is not {due}.")
    kinds = [inner[0]] * len(value) if many else inner
    return tuple(_value(kind, each, place) for kind, each in zip(kinds, value, strict=True))


def _word(hint: Any) -> str:
    return {str: "text", float: "number", int: "integer", bool: "true or false"}.get(
        hint, getattr(hint, "__name__", "table")
    )
