"""Tables of data: TOML files under `cityx/data`, read once and checked against what holds them.

Words, materials, species and styles are data; the modules that use them load them into their own
types, so that a row with a wrong key or value fails with a sentence that names it.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache, partial
from pathlib import Path
from types import MappingProxyType, UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from cityx.errors import InputError, nearest

DATA = Path(__file__).parents[1] / "data"
_READ = re.compile(r'\b(?:load|table)\(\s*"([\w/]+)"')
_KINDS = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}
T = TypeVar("T")


def table(name: str, kind: type[T], part: str = "") -> Mapping[str, T]:
    """Return the rows of a file by key, each of one type; see `load`."""
    return MappingProxyType(load(name, dict[str, kind], part))  # type: ignore[valid-type]


def load(name: str, kind: type[T], part: str = "") -> T:
    """Return a file of data, or a part of it, as a type.

    Parameters
    ----------
    name
        File under `cityx/data` without ".toml", such as "assets/materials".
    kind
        A dataclass, a number, a text, or a dict, tuple or frozenset of such. Rows of a dataclass
        are tables of its fields, or lists of them in order; a field ``name`` that is not given is
        the key of the row. A text in place of a list is cut into words; line breaks in texts are
        spaces; "@dome" is the entry "dome" of the file's part ``shared``.
    part
        Key of the file's top level; all of the file without one.

    Raises
    ------
    InputError
        If the file cannot be read or a row does not fit; the message names file, row and key.
    """
    held = _read(name)
    if part and part not in held:
        raise InputError(f'{name}.toml has no part "{part}".{nearest(part, held)}')
    made: T = _fitted(
        held[part] if part else held, kind, f"{name}.toml{f': {part}' if part else ''}"
    )
    return made


def files_of(*folders: str) -> list[Path]:
    """Return the files of data in folders of `cityx/data`, sorted; all without a folder."""
    roots = [DATA / folder for folder in folders] or [DATA]
    return sorted(path for root in roots for path in root.rglob("*.toml"))


def files_read_by(source: str) -> list[Path]:
    """Return the files of data that a module loads, by its source."""
    return [DATA / f"{name}.toml" for name in sorted(set(_READ.findall(source)))]


@cache
def _read(name: str) -> dict[str, Any]:
    try:
        held = tomllib.loads((DATA / f"{name}.toml").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"The table {name}.toml of CityX cannot be read: {error}.") from error
    shared = held.pop("shared", {})
    return _resolved(held, shared, f"{name}.toml") if shared else held


def _resolved(value: Any, shared: Mapping[str, Any], where: str) -> Any:
    """Return a value with what it names of the shared ones in place."""
    if isinstance(value, dict):
        return {key: _resolved(item, shared, f"{where}: {key}") for key, item in value.items()}
    if isinstance(value, list):
        return [_resolved(item, shared, where) for item in value]
    if isinstance(value, str) and value.startswith("@"):
        if value[1:] not in shared:
            raise InputError(f'{where} names no shared "{value[1:]}".{nearest(value[1:], shared)}')
        return shared[value[1:]]
    return value


def _fitted(value: Any, kind: Any, where: str) -> Any:
    """Return a value of TOML as a type."""
    origin, inner = get_origin(kind), get_args(kind)
    if kind is Any:
        return value
    if origin is UnionType:
        return _fitted(value, inner[0], where)
    if is_dataclass(kind):
        return _record(value, kind, where)
    if origin in (dict, Mapping) and isinstance(value, dict):
        key_kind = partial(int, base=0) if inner[0] is int else str
        named = is_dataclass(inner[1]) and fields(inner[1])[0].name == "name"
        return {
            key_kind(key): _fitted(_named(key, row) if named else row, inner[1], f"{where}.{key}")
            for key, row in value.items()
        }
    if origin in (tuple, frozenset) and isinstance(value, list | str):
        items = value.split() if isinstance(value, str) else value
        kinds = inner if origin is tuple and inner[-1] is not ... else inner[:1] * len(items)
        if len(kinds) != len(items):
            raise InputError(f"{where} must hold {len(kinds)} values, not {len(items)}.")
        return origin(
            _fitted(item, one, f"{where}[{row}]")
            for row, (item, one) in enumerate(zip(items, kinds, strict=True))
        )
    if kind is float and type(value) is int:
        return float(value)
    if type(value) is not kind:
        raise InputError(f"{where} must be {_KINDS.get(kind, 'a list or table')}, not {value!r}.")
    return " ".join(value.split()) if kind is str and "\n" in value else value


def _named(key: str, row: Any) -> Any:
    return [key, *row] if isinstance(row, list) else {"name": key, **row}


@cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _record(value: Any, kind: Any, where: str) -> Any:
    known = {one.name: one for one in fields(kind)}
    if isinstance(value, list) and len(value) <= len(known):
        value = dict(zip(known, value, strict=False))
    if not isinstance(value, dict):
        raise InputError(f"{where} must be a table of {', '.join(known)}, not {value!r}.")
    for key in value:
        if key not in known:
            raise InputError(
                f'{where} has no key "{key}".{nearest(key, known)} Known are {", ".join(known)}.'
            )
    for key, one in known.items():
        if key not in value and one.default is MISSING and one.default_factory is MISSING:
            raise InputError(f'{where} lacks "{key}".')
    hints = _hints(kind)
    return kind(**{k: _fitted(item, hints[k], f"{where}.{k}") for k, item in value.items()})
