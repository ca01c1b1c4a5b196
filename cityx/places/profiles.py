"""Which profile a city has: that of its country, or the one that the user asked for."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cache, lru_cache
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args, get_origin, get_type_hints

from cityx.errors import InputError, UsageError, nearest
from cityx.places.countries import country_at
from cityx.places.profile import Profile
from cityx.system.tables import DATA, read_table

if TYPE_CHECKING:
    from cityx.city.frame import Frame

OWN = "own"  # name of a profile that a user wrote
TOP = "world"  # what every profile inherits in the end
FOLDER, TABLE, TOWNS = DATA / "places", "countries", "border_towns"
Table = dict[str, Any]


def profile_of(frame: Frame) -> Profile:
    """Return the profile of a place: the one asked for, else that of its country.

    Raises
    ------
    UsageError
        If the one asked for does not exist or says what no profile can say.
    """
    return _profile_at(frame.latitude, frame.longitude, frame.place)


def keeps_left(frame: Frame, asked: str = "auto") -> bool:
    """Return whether traffic keeps to the left: as asked, or with "auto" as in the country."""
    return (profile_of(frame).drive if asked == "auto" else asked) == "left"


def climate_of(frame: Frame) -> str:
    """Return the climate of a place: "tropic", "warm", "japan", "temperate" or "north"."""
    profile = profile_of(frame)
    if frame.place and country_at(frame.latitude, frame.longitude).lower() not in profile.lineage:
        return profile.trees.usual
    return next(name for limit, name in profile.trees.climate if abs(frame.latitude) < limit)


@cache
def profile_named(name: str) -> Profile:
    """Return a profile by its name, without what holds in parts of a country only.

    Raises
    ------
    UsageError
        If there is none of the name.
    """
    return _made(_lineage(name, _written(name)), None)


def usual_lane() -> float:
    """Return the metres of a lane of which nothing is known but that it is one."""
    return profile_named(TOP).streets.lane_widths["primary"]


def place_text(asked: str) -> str:
    """Return what a frame keeps of a profile that the user asks for: a name, or all it says.

    Parameters
    ----------
    asked
        Name of a profile such as "de", or a TOML file that says how it differs from one.

    Raises
    ------
    InputError
        If the file cannot be read as TOML.
    UsageError
        If there is no such profile, or a key or a value of it is wrong.
    """
    path = Path(asked)
    if path.suffix != ".toml":
        name = asked.strip().lower()
        profile_named(name)
        return name
    try:
        said = tomllib.loads(path.read_text())
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{path.name} is no profile of a place: {error}.") from None
    _made(_lineage(OWN, said), None)
    return json.dumps(said, ensure_ascii=False, separators=(",", ":"))


@cache
def profile_names() -> tuple[str, ...]:
    """Return the names of all profiles, sorted."""
    stems = {file.stem for file in FOLDER.glob("*.toml")}
    return tuple(sorted(stems - {TABLE, TOWNS} | {code.lower() for code in _countries()}))


@lru_cache(maxsize=64)
def _profile_at(latitude: float, longitude: float, place: str) -> Profile:
    if place.startswith("{"):
        lineage = _lineage(OWN, json.loads(place))
    else:
        name = place or country_at(latitude, longitude).lower() or TOP
        lineage = _lineage(name, _written(name))
    return _made(lineage, (latitude, longitude))


@cache
def _read(name: str) -> Table:
    return read_table(FOLDER / f"{name}.toml")


@cache
def _countries() -> Mapping[str, Table]:
    """Return what the table of countries says, by code; most countries need one line."""
    return _read(TABLE)


def _written(name: str) -> Table:
    """Return what a profile says itself, in a file of its own or in the table of countries."""
    file = FOLDER / f"{name}.toml"
    if name.isidentifier() and name not in (TABLE, TOWNS) and file.is_file():
        return _read(name)
    if name.upper() not in _countries():
        raise UsageError(
            f'There is no profile of a place "{name}".{nearest(name, profile_names())}'
        )
    return _countries()[name.upper()]


def _lineage(name: str, said: Table) -> tuple[tuple[str, Table], ...]:
    """Return a profile and those it inherits, with what each says itself, from "world" on."""
    found = [(name, said)]
    while found[-1][0] != TOP:
        parent = found[-1][1].get("inherits", TOP)
        if not isinstance(parent, str):
            raise UsageError(f'Profile "{found[-1][0]}": "inherits" must be the name of a profile.')
        if parent in [each for each, _ in found]:
            circle = " inherits ".join(f'"{each}"' for each in [*(n for n, _ in found), parent])
            raise UsageError(f"Profiles inherit each other in a circle: {circle}.")
        found.append((parent, _written(parent)))
    return tuple(reversed(found))


def _made(lineage: tuple[tuple[str, Table], ...], at: tuple[float, float] | None) -> Profile:
    """Merge tables in the order of the lineage; of boxes within a country those count that hold."""
    merged: Table = {}
    for name, said in lineage:
        for number, table in enumerate(_tables(name, said, at)):
            where = f'Profile "{name}"' + (f", within {number}" if number else "")
            merged = _over(Profile, merged, table, where)
    names = tuple(name for name, _ in reversed(lineage))
    made: Profile = _filled(Profile, {"lineage": names, **merged})
    return made


@cache
def _hints(kind: Any) -> Mapping[str, Any]:
    return get_type_hints(kind)


def _filled(kind: Any, values: Table) -> Any:
    """Make a dataclass, and those within it, of checked values."""
    hints = _hints(kind)
    return kind(**{
        key: _filled(hints[key], value) if is_dataclass(hints[key]) else value
        for key, value in values.items()
    })  # fmt: skip


def _tables(name: str, said: Table, at: tuple[float, float] | None) -> Iterator[Table]:
    """Yield what a profile says, then what it says of parts that hold a place."""
    yield {key: value for key, value in said.items() if key not in ("inherits", "within")}
    parts = said.get("within", [])
    if not isinstance(parts, list) or not all(isinstance(part, dict) for part in parts):
        raise UsageError(f'Profile "{name}": "within" must be a list of tables, each with a "box".')
    for part in parts:
        box = part.get("box")
        if (
            not isinstance(box, list)
            or len(box) != 4
            or not all(isinstance(each, int | float) for each in box)
        ):
            raise UsageError(
                f'Profile "{name}": "box" must be [south, west, north, east] in degrees.'
            )
        south, west, north, east = box
        inside = at is not None and south <= at[0] <= north and west <= at[1] <= east
        # What no place asks for is checked all the same, against nothing.
        table = {key: value for key, value in part.items() if key != "box"}
        _over(Profile, {}, table, f'Profile "{name}", within')
        yield table if inside else {}


def _over(kind: Any, below: Table, said: Table, where: str) -> Table:
    """Lay what a profile says over what it inherits, checked."""
    found = dict(below)
    hints = _hints(kind)
    known = {each.name: each for each in fields(kind) if each.name != "lineage"}
    for key, value in said.items():
        if key not in known:
            raise UsageError(f'{where} has no key "{key}".{nearest(key, known)}')
        hint, place = hints[key], f'{where}, "{key}"'
        if is_dataclass(hint):
            if not isinstance(value, dict):
                raise UsageError(f"{place} must be a table, not {value!r}.")
            found[key] = _over(hint, dict(below.get(key, {})), value, place)
        else:
            checked = _checked(hint, value, place)
            merged = known[key].metadata.get("merged")
            if known[key].metadata.get("closed") and key in below:
                _known(checked, below[key], place)
            found[key] = {**below.get(key, {}), **checked} if merged else checked
    if kind is Profile and found.get("drive", "right") not in ("left", "right"):
        raise UsageError(f'{where}, "drive" must be "left" or "right", not {found["drive"]!r}.')
    return found


def _known(said: Table, words: Table, where: str) -> None:
    for word in said:
        if word not in words:
            raise UsageError(f'{where} has no key "{word}".{nearest(word, words)}')


_WORDS = {bool: "true or false", float: "a number", int: "a whole number", str: "a text"}


def _checked(hint: Any, value: Any, where: str) -> Any:
    """Return a value as its type asks for it.

    Raises
    ------
    UsageError
        If it is of another type.
    """
    origin, inner = get_origin(hint), get_args(hint)
    if hint is float and isinstance(value, int | float) and not isinstance(value, bool):
        if not 0.0 <= value < inf:
            raise UsageError(f"{where} must be a number from 0 on, not {value!r}.")
        return float(value)
    if hint in _WORDS and type(value) is hint:
        return value
    if hint in _WORDS:
        raise UsageError(f"{where} must be {_WORDS[hint]}, not {value!r}.")
    if origin is tuple:
        if not isinstance(value, list | tuple):
            raise UsageError(f"{where} must be a list, not {value!r}.")
        kinds = [inner[0]] * len(value) if inner[-1] is Ellipsis else list(inner)
        if len(kinds) != len(value):
            raise UsageError(f"{where} must have {len(kinds)} entries, not {len(value)}.")
        return tuple(_checked(kind, each, where) for kind, each in zip(kinds, value, strict=True))
    if not isinstance(value, dict):
        raise UsageError(f"{where} must be a table, not {value!r}.")
    return {key: _checked(inner[1], each, f'{where}, "{key}"') for key, each in value.items()}
