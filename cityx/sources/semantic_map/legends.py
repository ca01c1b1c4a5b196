"""Legends: which colour or value of a semantic map means which class."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from cityx.errors import InputError, UsageError, nearest
from cityx.sources.map_classes import MapClass, class_of
from cityx.system.tables import table


@dataclass(frozen=True)
class Entry:
    """One line of a legend.

    Attributes
    ----------
    key
        A colour 0xRRGGBB, or a value of a map with one value per pixel.
    meaning
        Its class.
    """

    key: int
    meaning: MapClass


@dataclass(frozen=True)
class Legend:
    """What a map may show.

    Attributes
    ----------
    name
        Of the legend.
    by_value
        Whether keys are values of pixels; colours otherwise.
    entries
        One per colour or value.
    """

    name: str
    by_value: bool
    entries: tuple[Entry, ...]


# Name -> class by colour, and by value of the pixel.
_COLORS = table("sources/legends", dict[str, str], "colors")
_VALUES = table("sources/legends", dict[int, str], "values")


def color_key(text: str) -> int:
    """Return 0xRRGGBB of "#rrggbb"; raises ValueError for anything else."""
    if not re.fullmatch(r"#?[0-9A-Fa-f]{6}", text.strip()):
        raise ValueError(text)
    return int(text.strip().removeprefix("#"), 16)


def _presets() -> dict[str, Legend]:
    colors = {
        name: Legend(name, False, tuple(Entry(color_key(k), class_of(w)) for k, w in table.items()))
        for name, table in _COLORS.items()
    }
    values = {
        name: Legend(name, True, tuple(Entry(key, class_of(word)) for key, word in table.items()))
        for name, table in _VALUES.items()
    }
    return {**colors, **values}


PRESETS: Mapping[str, Legend] = MappingProxyType(_presets())


def find_legend(said: str | Path) -> Legend:
    """Return a preset by its name, or read a legend file (.json or .csv).

    Raises
    ------
    UsageError
        If there is neither a preset nor a file of that name.
    InputError
        If the file is no legend; all its faults are named.
    """
    if str(said) in PRESETS:
        return PRESETS[str(said)]
    path = Path(said)
    if not path.is_file():
        raise UsageError(
            f'There is no legend "{said}": it is neither a file nor one of '
            f"{', '.join(PRESETS)}.{nearest(str(said), PRESETS)}"
        )
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read as text: {error}.") from error
    return read_legend(text, str(path))


def read_legend(text: str, name: str) -> Legend:
    """Read the text of a legend: JSON or CSV.

    JSON is a list of objects, or an object with such a list under "classes", or an object from
    colours or values to classes. CSV has a line of names. Each line has "color" or "value" and
    "class", and may have "height" (metres) or "levels" of its buildings.

    Raises
    ------
    InputError
        With all faults.
    """
    rows = _json_rows(text, name) if text.lstrip()[:1] in ("{", "[") else _csv_rows(text, name)
    faults: list[str] = []
    entries: list[tuple[bool, Entry]] = []
    for number, row in enumerate(rows, start=1):
        try:
            entries.append(_entry(row))
        except (InputError, ValueError) as error:
            faults.append(f"line {number}: {error}")
    kinds = {by_value for by_value, _ in entries}
    if len(kinds) > 1:
        faults.append("some lines have colours and some values; one map has one kind")
    keys = [entry.key for _, entry in entries]
    twice = sorted({key for key in keys if keys.count(key) > 1})
    if twice:
        faults.append(f"said twice: {', '.join(map(_shown(kinds == {False}), twice))}")
    if not rows:
        faults.append("it has no lines")
    if faults:
        raise InputError(f"{name} is no legend: {'; '.join(faults)}")
    return Legend(name, kinds == {True}, tuple(entry for _, entry in entries))


def _shown(colors: bool) -> Any:
    return (lambda key: f"#{key:06X}") if colors else str


def _json_rows(text: str, name: str) -> Sequence[Mapping[str, Any]]:
    try:
        found = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(f"{name} is no JSON: {error}.") from error
    if isinstance(found, dict) and isinstance(found.get("classes"), list):
        found = found["classes"]
    if isinstance(found, dict):
        found = [{_key_name(key): key, "class": word} for key, word in found.items()]
    if not all(isinstance(row, dict) for row in found):
        raise InputError(f"{name} is no legend: each class is an object with color and class.")
    return list(found)


def _key_name(key: str) -> str:
    return "color" if key.startswith("#") else "value"


def _csv_rows(text: str, name: str) -> Sequence[Mapping[str, Any]]:
    rows = list(csv.DictReader(io.StringIO(text)))
    if rows and ("class" not in rows[0] or not {"color", "value"} & set(rows[0])):
        raise InputError(
            f"{name} is no legend: its first line names {', '.join(map(str, rows[0]))}; it must "
            'name "class", and "color" or "value".'
        )
    return rows


def _entry(row: Mapping[str, Any]) -> tuple[bool, Entry]:
    meaning = class_of(str(row.get("class") or ""))
    height = str(row.get("height") or "").strip()
    levels = str(row.get("levels") or "").strip()
    if height:
        meaning = meaning.taller(_positive(height, "height"))
    if levels:
        storeys = round(_positive(levels, "levels"))
        meaning = MapClass(
            meaning.word, meaning.role, {**meaning.tags, "building:levels": str(storeys)}
        )
    said = str(row.get("color") or row.get("value") or "").strip()
    if str(row.get("value")) == "0":
        said = "0"
    if said.startswith("#") or row.get("color"):
        try:
            return False, Entry(color_key(said), meaning)
        except ValueError:
            raise InputError(f'"{said}" is no colour; write #rrggbb') from None
    if not re.fullmatch(r"-?\d+(\.0*)?", said):
        raise InputError(f'"{said}" is no value; write a whole number or #rrggbb')
    return True, Entry(int(float(said)), meaning)


def _positive(text: str, what: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = -1.0
    if not 0 < number < 1000:
        raise InputError(f'"{text}" is no {what} of a building')
    return number
