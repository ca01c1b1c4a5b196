"""Tables of data: TOML files under `cityx/data`, read once, strictly, into the types of the code.

Words, materials, species and styles are data. A row that does not fit the type that holds it fails
with a sentence that names the file, the row and the nearest known key; all faults are told at once.
"""

from __future__ import annotations

import dataclasses
import re
import tomllib
import types
import typing
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from math import inf, isfinite
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args, get_origin

from cityx.errors import InputError, nearest

DATA = Path(__file__).parents[1] / "data"
KINDS = (".toml", ".lark", ".css")  # of files of data
_NAMED = re.compile(r'\b(?:load|table|text_of)\(\s*"([\w/.]+)"|\bDATA / "([\w/.]+)"')
_WORDS: Mapping[Any, str] = {
    str: "text", float: "number", int: "integer", bool: "true or false", dict: "table",
    Mapping: "table",
}  # fmt: skip
T = TypeVar("T")


@dataclasses.dataclass(frozen=True)
class Between:
    """Bounds of a number, for ``Annotated[float, Between(0, 1)]``; infinity is outside of all."""

    low: float = -inf
    high: float = inf

    def fault(self, value: float) -> str:
        """Return what is wrong with a number, "" if nothing."""
        if self.low <= value <= self.high and isfinite(value):
            return ""
        upwards = f"{self.low:g} to {self.high:g}" if self.high < inf else f"{self.low:g} on"
        return f"{value!r} is not a number from {upwards}"


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
        Numbers may have bounds; see `Between`.
    part
        Key of the file's top level; all of the file without one.

    Raises
    ------
    InputError
        If the file cannot be read or rows do not fit; the message names file, row and key of each.
    """
    held = _read_once(DATA / f"{name}.toml")
    place = f"{name}.toml"
    if part and part not in held:
        raise InputError(f'{place}: there is no part "{part}".{nearest(part, held)}')
    faults: list[str] = []
    where = f"{place}, {part}" if part else place
    made: T = _value(kind, held[part] if part else held, where, faults)
    return _faultless(made, faults)


def read_table(path: Path) -> dict[str, Any]:
    """Read a TOML file.

    Raises
    ------
    InputError
        If there is none or it is not TOML; the message names the file and the line.
    """
    try:
        known = _kept_tables().pop(str(path), None)
        if known is not None:
            return known
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{path.name} cannot be read as TOML: {error}.") from error


@cache
def _kept_tables() -> dict[str, dict[str, Any]]:
    """Return the tables of the package as an earlier run has read them, each to be taken once.

    Files are known by their times and sizes, as Python knows compiled modules.
    """
    from cityx.system.cache import cached_json
    from cityx.system.digests import files_below, stamp_of

    paths = files_below(DATA, KINDS[0])

    def make() -> dict[str, dict[str, Any]]:
        found = {}
        for path in paths:
            # Who reads it says so.
            with suppress(OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
                found[path] = tomllib.loads(Path(path).read_text(encoding="utf-8"))
        return found

    made: dict[str, dict[str, Any]] = cached_json(f"tables-{stamp_of(paths)}", make)
    return made


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
        If keys are unknown or missing, or values have another type or are out of bounds; the
        message has a line for each that names the place.
    """
    faults: list[str] = []
    made: T = _filled(kind, row, place, faults)
    return _faultless(made, faults)


def faults_of(kind: type[Any], row: Mapping[str, Any], place: str) -> list[str]:
    """Return what is wrong with a table, a sentence each; see `filled`."""
    faults: list[str] = []
    _filled(kind, row, place, faults)
    return faults


def unknown(key: str, known: Iterable[str], place: str) -> str:
    """Return the sentence on a key that there is not."""
    return f'{place}: there is no key "{key}".{nearest(key, known)}'


@cache
def hints_of(kind: type[Any]) -> dict[str, Any]:
    """Return the types of the fields of a dataclass, with their bounds."""
    known: dict[str, Any] = {}
    while True:
        try:
            return typing.get_type_hints(kind, localns=known, include_extras=True)
        except NameError as error:  # imported for type checks alone: no table gives one
            if error.name in known:
                raise
            known[str(error.name)] = Any


def _faultless(made: T, faults: Sequence[str]) -> T:
    if faults:
        raise InputError("\n".join(faults))
    return made


def _filled(kind: Any, row: Mapping[str, Any], place: str, faults: list[str]) -> Any:
    """Make a dataclass as `filled` does; None, with a sentence for each fault, if it does not fit.

    The same holds for the result of all functions below.
    """
    hints, before = hints_of(kind), len(faults)
    faults += [unknown(key, hints, place) for key in row if key not in hints]
    for field in dataclasses.fields(kind):
        required = field.default is field.default_factory is dataclasses.MISSING
        if required and field.name not in row:
            faults.append(f'{place}: the key "{field.name}" is missing.')
    values = {
        key: _value(hints[key], value, f"{place}, {key}", faults)
        for key, value in row.items()
        if key in hints
    }
    return kind(**values) if len(faults) == before else None


def _value(hint: Any, value: Any, place: str, faults: list[str]) -> Any:
    origin, inner, is_row = _sort_of(hint)
    if hint is Any:
        return value
    if origin is Annotated:
        return _bounded(inner, value, place, faults)
    if is_row:
        return _row(hint, value, place, faults)
    if origin in (tuple, frozenset, Sequence):
        return _array(origin, inner, value, place, faults)
    if origin in (dict, Mapping) and isinstance(value, dict):
        made = {
            _key(inner[0], key, place, faults): _value(
                inner[1], _named(inner[1], key, each), f"{place}.{key}", faults
            )
            for key, each in value.items()
        }
        return made if origin is dict else types.MappingProxyType(made)
    if origin in (types.UnionType, typing.Union):
        kind = next(each for each in inner if each is not type(None))
        return _value(kind, value, place, faults)
    if origin is typing.Literal:
        if value in inner:
            return value
        faults.append(f"{place}: {value!r} is none of {', '.join(map(repr, inner))}.")
        return None
    if hint is float and type(value) is int:
        return float(value)
    if type(value) is not (origin or hint):
        faults.append(f"{place}: {value!r} is not of type {_word(origin or hint)}.")
        return None
    return " ".join(value.split()) if hint is str and "\n" in value else value


@cache
def _sort_of(hint: Any) -> tuple[Any, tuple[Any, ...], bool]:
    """Return the origin and the arguments of a type, and whether it is a dataclass."""
    return get_origin(hint), get_args(hint), dataclasses.is_dataclass(hint)


def _key(kind: Any, key: str, place: str, faults: list[str]) -> Any:
    if kind is not int:
        return key
    try:
        return int(key, 0)
    except ValueError:
        faults.append(f'{place}: the key "{key}" is no integer.')
        return None


def _bounded(inner: Sequence[Any], value: Any, place: str, faults: list[str]) -> Any:
    before = len(faults)
    made = _value(inner[0], value, place, faults)
    for bounds in inner[1:]:
        if isinstance(bounds, Between) and len(faults) == before and (why := bounds.fault(made)):
            faults.append(f"{place}: {why}.")
    return made


def _row(kind: Any, value: Any, place: str, faults: list[str]) -> Any:
    names = [field.name for field in dataclasses.fields(kind)]
    if isinstance(value, list) and len(value) <= len(names):
        value = dict(zip(names, value, strict=False))
    if not isinstance(value, dict):
        faults.append(f"{place}: {value!r} is not a table of {', '.join(names)}.")
        return None
    return _filled(kind, value, place, faults)


def _named(kind: Any, key: str, row: Any) -> Any:
    """Return a row with its key as its name, where its type begins with one."""
    if not dataclasses.is_dataclass(kind) or dataclasses.fields(kind)[0].name != "name":
        return row
    if isinstance(row, dict):
        return {"name": key, **row}
    return [key, *row] if isinstance(row, list) else row


def _array(origin: Any, inner: Sequence[Any], value: Any, place: str, faults: list[str]) -> Any:
    many = len(inner) == 1 or inner[-1] is Ellipsis
    if many and get_args(inner[0])[:2] == (str, float):
        value = {value: 1.0} if isinstance(value, str) else value
        value = list(value.items()) if isinstance(value, dict) else value
    value = value.split() if isinstance(value, str) else value
    if not isinstance(value, list | tuple) or not (many or len(value) == len(inner)):
        due = "an array" if many else f"an array of {len(inner)}"
        faults.append(f"{place}: {value!r} is not {due}.")
        return None
    kinds = [inner[0]] * len(value) if many else inner
    before = len(faults)
    items = [
        _value(kind, each, f"{place}[{number}]", faults)
        for number, (kind, each) in enumerate(zip(kinds, value, strict=True))
    ]
    if len(faults) > before:
        return None
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
