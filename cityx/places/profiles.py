"""Which profile a city has: that of its country, or the one that the user asked for."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cityx.errors import InputError, UsageError, nearest
from cityx.places.countries import country_at
from cityx.places.profile import TOP, Profile, Rules, Written
from cityx.system.tables import DATA, faults_of, filled, hints_of, read_table, unknown

if TYPE_CHECKING:
    from cityx.city.frame import Frame

OWN = "own"  # name of a profile that a user wrote
FOLDER, TABLE, TOWNS = DATA / "places", "countries", "border_towns"
Table = dict[str, Any]
Lineage = tuple[tuple[str, Table], ...]  # profiles with what each says itself, from "world" on


def profile_of(frame: Frame) -> Profile:
    """Return the profile of a place: the one asked for, else that of its country.

    Raises
    ------
    InputError, UsageError
        If the one asked for says what no profile can say, or does not exist.
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
    return _made(_known(name), None)


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
        If the file cannot be read as TOML; with all of its keys and values that are wrong.
    UsageError
        If there is no such profile.
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
    _lineage(OWN, said, path.name)
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
        lineage = _known(place or country_at(latitude, longitude).lower() or TOP)
    return _made(lineage, (latitude, longitude))


@cache
def _read(name: str) -> Table:
    return read_table(FOLDER / f"{name}.toml")


@cache
def _countries() -> Mapping[str, Table]:
    """Return what the table of countries says, by code; most countries need one line."""
    return _read(TABLE)


def _written(name: str) -> Table | None:
    """Return what a profile says itself, in a file of its own or in the table of countries."""
    file = FOLDER / f"{name}.toml"
    if name.isidentifier() and name not in (TABLE, TOWNS) and file.is_file():
        return _read(name)
    return _countries().get(name.upper())


def _known(name: str) -> Lineage:
    """Return a profile of CityX with those it inherits."""
    said = _written(name)
    if said is None:
        hint = nearest(name, profile_names())
        raise UsageError(f'There is no profile of a place "{name}".{hint}')
    return _lineage(name, said)


def _lineage(name: str, said: Table, place: str = "") -> Lineage:
    """Return a profile and those it inherits, with what each says itself, from "world" on.

    Parameters
    ----------
    place
        What messages call the profile, by its name when left out.

    Raises
    ------
    InputError
        With everything that is wrong in any of them.
    """
    found: dict[str, Table] = {}
    faults: list[str] = []
    while True:
        found[name] = said
        place = place or f'Profile "{name}"'
        faults += faults_of(Written, said, place) + _unknown_words(Rules, said, _read(TOP), place)
        parent = said.get("inherits", TOP)
        if name == TOP or not isinstance(parent, str):
            break
        if parent in found:
            circle = " inherits ".join(f'"{each}"' for each in [*found, parent])
            faults.append(f"{place}, inherits: profiles inherit each other in a circle: {circle}.")
            break
        inherited = _written(parent)
        if inherited is None:
            hint = nearest(parent, profile_names())
            faults.append(f'{place}, inherits: there is no profile of a place "{parent}".{hint}')
            break
        name, said, place = parent, inherited, ""
    if faults:
        raise InputError("\n".join(faults))
    return tuple(reversed(found.items()))


def _unknown_words(kind: Any, said: Any, known: Table, place: str) -> list[str]:
    """Return a sentence for each word of a closed table that "world" does not have there."""
    if not isinstance(said, dict):
        return []  # told by its type
    faults = []
    for each in fields(kind):
        at, value, hint = f"{place}, {each.name}", said.get(each.name), hints_of(kind)[each.name]
        if each.metadata.get("closed") and isinstance(value, dict):
            words = known[each.name]
            faults += [unknown(word, words, at) for word in value if word not in words]
        elif is_dataclass(hint) and isinstance(hint, type):
            faults += _unknown_words(hint, value, known.get(each.name, {}), at)
    parts = said.get("within")
    for number, part in enumerate(parts if isinstance(parts, list) else ()):
        faults += _unknown_words(kind, part, known, f"{place}, within[{number}]")
    return faults


def _made(lineage: Lineage, at: tuple[float, float] | None) -> Profile:
    """Merge tables in the order of the lineage; of boxes within a country those count that hold."""
    merged: Table = {}
    for _, said in lineage:
        for table in (said, *(part for part in said.get("within", ()) if _holds(part["box"], at))):
            merged = _over(Rules, merged, table)
    names = [name for name, _ in reversed(lineage)]
    return filled(Profile, {"lineage": names, **merged}, f'Profile "{names[0]}"')


def _holds(box: Sequence[float], at: tuple[float, float] | None) -> bool:
    south, west, north, east = box
    return at is not None and south <= at[0] <= north and west <= at[1] <= east


def _over(kind: Any, below: Table, said: Table) -> Table:
    """Lay what a profile says over what it inherits."""
    found = dict(below)
    for each in fields(kind):
        if each.name not in said:
            continue
        value, inherited = said[each.name], below.get(each.name, {})
        if is_dataclass(hint := hints_of(kind)[each.name]):
            found[each.name] = _over(hint, inherited, value)
        elif each.metadata.get("merged"):
            found[each.name] = {**inherited, **value}
        else:
            found[each.name] = value
    return found
