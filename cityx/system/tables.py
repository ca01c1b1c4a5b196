"""Tables of data: TOML files under `cityx/data`, read once, strictly, into the types of the code.

Words, materials, species and styles are data. A row that does not fit the type that holds it fails
with a sentence that names the file, the row and the nearest known key.
"""

from __future__ import annotations

import dataclasses
import re
import tomllib
import types
import typing
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin

from cityx.errors import InputError, nearest

DATA = Path(__file__).parents[1] / "data"
KINDS = (".toml", ".lark", ".css")  # of files of data
_NAMED = re.compile(r'\b(?:load|table|text_of)\(\s*"([\w/.]+)"|\bDATA / "([\w/.]+)"')
_WORDS = {str: "text", float: "number", int: "integer", bool: "true or false"}
T = TypeVar("T")


def table(name: str, kind: type[T], part: str = "") -> Mapping[str, T]:
    """Return the rows of a file by key, each of one type; see `load`."""
    return types.MappingProxyType(load(name, dict[str, kind], part))  # type: ignore[valid-type]


def load(name: str, kind: type[T], part: str = "") -> T:
    """Return a file of data, or a part of it, as a type.

    Parameters
    ----------
    name
        File under `cityx/data` without ".toml", such as "assets/materials".
    kind
        A dataclass, a number, a text, or a dict, tuple or frozenset of such. Rows of a dataclass
        are tables of its fields, or arrays of them in order; a field ``name`` is the key of the
        row. A text where an array is due is cut into words, and line breaks in a text are spaces.
        Where pairs of a word and a number are due, a table ``{word = number}`` does, and a word
        alone has the number 1. "$dome" is the entry "dome" of the file's part ``shared``.
    part
        Key of the file's top level; all of the file without one.

    Raises
    ------
    InputError
        If the file cannot be read or a row does not fit; the message names file, row and key.
    """
    held = _read_once(DATA / f"{name}.toml")
    place = f"{name}.toml"
    if part and part not in held:
        raise InputError(f'{place}: there is no part "{part}".{nearest(part, held)}')
    made: T = _value(kind, held[part] if part else held, f"{place}, {part}" if part else place)
    return made


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


@cache
def _read_once(path: Path) -> dict[str, Any]:
    held = read_table(path)
    shared = held.pop("shared", None)
    return held if shared is None else _resolved(held, shared, path.name)


def text_of(name: str) -> str:
    """Return a file of data as it is, such as a grammar; `name` is its path under `cityx/data`."""
    return (DATA / name).read_text(encoding="utf-8")


def files_of(*folders: str) -> list[Path]:
    """Return the files of data in folders of `cityx/data`, sorted; all without a folder."""
    roots = [DATA / folder for folder in folders] or [DATA]
    return sorted(path for root in roots for end in KINDS for path in root.rglob(f"*{end}"))


def files_read_by(source: str) -> list[Path]:
    """Return the files of data that a module names in its source."""
    names = {one or other for one, other in _NAMED.findall(source)}
    return [DATA / (name if "." in name else f"{name}.toml") for name in sorted(names)]


def filled(kind: type[T], row: Mapping[str, Any], place: str) -> T:
    """Make a dataclass of a table: tables become dataclasses and mappings, arrays tuples.

    Parameters
    ----------
    kind
        The dataclass; what the table leaves out keeps its default.
    row
        As TOML gives it; see `load`.
    place
        File and table, for messages.

    Raises
    ------
    InputError
        If a key is unknown or missing, or a value has another type; the message names the place.
    """
    hints = _hints(kind)  # type: ignore[arg-type]
    for key in row:
        if key not in hints:
            raise InputError(f'{place}: there is no key "{key}".{nearest(key, hints)}')
    for field in dataclasses.fields(kind):  # type: ignore[arg-type]
        required = field.default is field.default_factory is dataclasses.MISSING
        if required and field.name not in row:
            raise InputError(f'{place}: the key "{field.name}" is missing.')
    return kind(**{key: _value(hints[key], value, f"{place}, {key}") for key, value in row.items()})


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
    origin, inner = get_origin(hint), get_args(hint)
    if hint is Any:
        return value
    if dataclasses.is_dataclass(hint):
        return _row(hint, value, place)
    if origin in (tuple, frozenset, Sequence):
        return _array(origin, inner, value, place)
    if origin in (dict, Mapping) and isinstance(value, dict):
        made = {
            int(key, 0) if inner[0] is int else key: _value(
                inner[1], _named(inner[1], key, each), f"{place}.{key}"
            )
            for key, each in value.items()
        }
        return made if origin is dict else types.MappingProxyType(made)
    if origin in (types.UnionType, typing.Union):
        return _value(next(each for each in inner if each is not type(None)), value, place)
    if origin is typing.Literal:
        if value not in inner:
            raise InputError(f"{place}: {value!r} is none of {', '.join(map(repr, inner))}.")
        return value
    if hint is float and type(value) is int:
        return float(value)
    if type(value) is not hint:
        raise InputError(f"{place}: {value!r} is not of type {_word(hint)}.")
    return " ".join(value.split()) if hint is str and "\n" in value else value


def _row(kind: Any, value: Any, place: str) -> Any:
    names = [field.name for field in dataclasses.fields(kind)]
    if isinstance(value, list) and len(value) <= len(names):
        value = dict(zip(names, value, strict=False))
    if not isinstance(value, dict):
        raise InputError(f"{place}: {value!r} is not a table of {', '.join(names)}.")
    return filled(kind, value, place)


def _named(kind: Any, key: str, row: Any) -> Any:
    """Return a row with its key as its name, where its type begins with one."""
    if not dataclasses.is_dataclass(kind) or dataclasses.fields(kind)[0].name != "name":
        return row
    return {"name": key, **row} if isinstance(row, dict) else [key, *row]


def _array(origin: Any, inner: Sequence[Any], value: Any, place: str) -> Any:
    many = len(inner) == 1 or inner[-1] is Ellipsis
    if many and get_args(inner[0])[:2] == (str, float):
        value = {value: 1.0} if isinstance(value, str) else value
        value = list(value.items()) if isinstance(value, dict) else value
    value = value.split() if isinstance(value, str) else value
    if not isinstance(value, list | tuple) or not (many or len(value) == len(inner)):
        due = "an array" if many else f"an array of {len(inner)}"
        raise InputError(f"{place}: {value!r} is not {due}.")
    kinds = [inner[0]] * len(value) if many else inner
    items = (
        _value(kind, each, f"{place}[{number}]")
        for number, (kind, each) in enumerate(zip(kinds, value, strict=True))
    )
    return frozenset(items) if origin is frozenset else tuple(items)


def _resolved(value: Any, shared: Mapping[str, Any], place: str) -> Any:
    """Return a value with what it names of the shared ones in its place."""
    if isinstance(value, dict):
        return {key: _resolved(item, shared, f"{place}, {key}") for key, item in value.items()}
    if isinstance(value, list):
        return [_resolved(item, shared, place) for item in value]
    if isinstance(value, str) and value.startswith("$"):
        if value[1:] not in shared:
            known = nearest(value[1:], shared)
            raise InputError(f'{place}: there is no shared "{value[1:]}".{known}')
        return shared[value[1:]]
    return value


def _word(hint: Any) -> str:
    return _WORDS.get(hint, getattr(hint, "__name__", "table"))
