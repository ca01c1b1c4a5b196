"""Legends: which colour or value of a semantic map means which class, and which one it follows."""

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

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError, UsageError, nearest
from cityx.geometry.arrays import FloatArray
from cityx.sources.map_classes import MapClass, class_of
from cityx.sources.semantic_map.picture import Picture
from cityx.system.tables import table

REJECT = 20.0  # CIELab; about the distance of two colours that nobody would name alike
REJECT_EXACT = 4.0  # where no compression blurred the colours
NEAR = 3.0  # CIELab; compression moves most of a flat colour by less
CLEAR = 0.65  # share of pixels so near to a class; measured: maps 0.75, photographs at most 0.59
MODE = 5  # pixels, edge of the window in which the most frequent class wins after compression
FITS = 0.97  # share of pixels that a legend must explain
NEARLY = 0.01  # shares of pixels closer than this are the same


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


@dataclass(frozen=True)
class Match:
    """How well a legend explains a picture.

    Attributes
    ----------
    legend
        The legend.
    share
        Of the pixels that say something, those that have a colour or value of it.
    seen
        Number of its entries that the picture shows.
    """

    legend: Legend
    share: float
    seen: int

    def text(self) -> str:
        """Return the evidence as words."""
        return (
            f'"{self.legend.name}" explains {100 * self.share:.1f} % of the pixels with '
            f"{self.seen} of its {len(self.legend.entries)} classes"
        )


def unpacked(keys: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Return (n, 3) colours of (n,) 0xRRGGBB."""
    channels = [keys >> 16, (keys >> 8) & 255, keys & 255]
    return np.asarray(np.stack(channels, axis=-1), np.uint8)


def to_lab(colors: NDArray[np.uint8]) -> FloatArray:
    """Return (n, 3) CIELab of (n, 3) sRGB colours."""
    from skimage.color import rgb2lab

    return np.asarray(rgb2lab(colors.reshape(-1, 1, 3) / 255.0).reshape(-1, 3))


def nearest_entry(keys: NDArray[np.int64], legend: Legend, reject: float) -> NDArray[np.int64]:
    """Return the entry of a legend that (n,) keys mean, -1 for none.

    Colours are compared in CIELab, values must be equal.
    """
    wanted = np.array([entry.key for entry in legend.entries])
    if legend.by_value:
        order = np.argsort(wanted)
        place = np.minimum(np.searchsorted(wanted[order], keys), len(wanted) - 1)
        return np.where(wanted[order][place] == keys, order[place], -1)
    from scipy.spatial import cKDTree

    far, entry = cKDTree(to_lab(unpacked(wanted))).query(to_lab(unpacked(keys)))
    return np.where(far <= reject, entry, -1)


def match(picture: Picture, legend: Legend, reject: float | None = None) -> Match:
    """Measure how well a legend explains a picture.

    Parameters
    ----------
    reject
        CIELab from the colour of a class at which a pixel is none; by the compression when None.
    """
    if reject is None:
        reject = REJECT if picture.lossy else REJECT_EXACT
    if legend.by_value and picture.values is None:
        return Match(legend, 0.0, 0)
    keys, index = picture.distinct(by_value=legend.by_value)
    entry = nearest_entry(keys, legend, reject)
    count = np.bincount(index[~picture.void], minlength=len(keys))
    share = float(count[entry >= 0].sum() / max(count.sum(), 1))
    # A colour of a handful of pixels is a stain, not a class.
    shown = entry[(entry >= 0) & (count > 1e-4 * count.sum())]
    return Match(legend, share, len(np.unique(shown)))


def fitting(picture: Picture, presets: Mapping[str, Legend] = PRESETS) -> list[Match]:
    """Return the presets that explain a picture, best first.

    A picture without any second class says nothing, so two classes are asked for. The colours of a
    photograph lie about those of a legend, those of a map on them.
    """
    found = [match(picture, legend) for legend in presets.values()]
    fits = [item for item in found if item.share >= FITS and item.seen >= 2]
    return sorted(
        (item for item in fits if match(picture, item.legend, NEAR).share >= CLEAR),
        key=lambda item: (-round(item.share, 3), len(item.legend.entries) - item.seen),
    )


def labelled(picture: Picture, legend: Legend) -> NDArray[np.uint8]:
    """Return the (rows, columns) entries of a legend; the number of entries where there is none.

    After lossy compression each pixel takes the most frequent entry around it.
    """
    keys, index = picture.distinct(by_value=legend.by_value)
    entry = nearest_entry(keys, legend, REJECT if picture.lossy else REJECT_EXACT)
    none = len(legend.entries)
    labels = np.where(entry < 0, none, entry).astype(np.uint8)[index]
    labels[picture.void] = none
    return most_frequent(labels, none + 1) if picture.lossy else labels


def most_frequent(labels: NDArray[Any], count: int, window: int = MODE) -> NDArray[np.uint8]:
    """Return the most frequent label in a square window around each pixel, the lowest of equals."""
    from scipy.ndimage import uniform_filter

    best = np.zeros(labels.shape, np.float32)
    found = np.zeros(labels.shape, np.uint8)
    for label in range(count):
        share = uniform_filter((labels == label).astype(np.float32), window, mode="nearest")
        more = share > best + 1e-4  # sums in single precision differ by less
        best[more], found[more] = share[more], label
    return found
