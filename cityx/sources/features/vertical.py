"""What the tags of one building or part say about its heights, roof and surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.sources.features import measures
from cityx.sources.features.building_heights import MAX_HEIGHT, MAX_LEVELS
from cityx.sources.features.roofs import SHAPE
from cityx.sources.features.tagged import Tags
from cityx.sources.features.vocabulary import ROOF_WORDS

_KEYS = frozenset({
    "height", "building:height", "est_height", "min_height", "building:min_height",
    "building:levels", "levels", "building:min_level", "min_level", "roof:height", "roof:levels",
    "roof:angle", "roof:shape", "building:roof:shape", "roof:direction", "roof:orientation",
    "building:colour", "building:color", "colour", "color", "building:material", "material",
    "building:facade:colour", "building:facade:material", "facade:colour", "facade:material",
    "building:cladding", "roof:colour", "roof:color", "building:roof:colour", "roof:material",
    "building:roof:material", "building:roof", "roof:type", "roof:slope:direction",
})  # fmt: skip
# What numbers are read from, the first that is there.
_NUMBERS = {
    "height": ("height", "building:height", "est_height"),
    "min_height": ("min_height", "building:min_height"),
    "levels": ("building:levels", "levels"),
    "min_level": ("building:min_level", "min_level"),
    "roof_height": ("roof:height",),
    "roof_levels": ("roof:levels",),
    "roof_angle": ("roof:angle",),
    "roof_direction": ("roof:direction", "roof:slope:direction"),
}
_SILENT = (nan,) * 8 + (-1, False, False, -1, "", -1, "")


@dataclass(frozen=True)
class Vertical:
    """What tags say, n things; NaN, -1 or "" where they are silent.

    Attributes
    ----------
    height, min_height
        Metres above ground of the highest and the lowest point.
    levels, min_level
        Storeys above ground up to the eave, and how many of them are open below.
    roof_height, roof_levels, roof_angle, roof_direction
        Metres, count, degrees, compass radians.
    roof_shape
        Index into `cityx.sources.features.roofs.SHAPES`.
    across, along
        Whether the ridge runs across the longer side, and whether it is said to run along it.
    wall_color, wall_material, roof_color, roof_material
        As in the table of parts.
    """

    height: FloatArray
    min_height: FloatArray
    levels: FloatArray
    min_level: FloatArray
    roof_height: FloatArray
    roof_levels: FloatArray
    roof_angle: FloatArray
    roof_direction: FloatArray
    roof_shape: IntArray
    across: NDArray[np.bool_]
    along: NDArray[np.bool_]
    wall_color: IntArray
    wall_material: NDArray[Any]
    roof_color: IntArray
    roof_material: NDArray[Any]

    def take(self, rows: IntArray) -> Vertical:
        """Return some rows."""
        return Vertical(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    @property
    def has_height(self) -> NDArray[np.bool_]:
        """(n,) whether anything is said about the height."""
        return np.asarray(~(np.isnan(self.height) & np.isnan(self.levels)))


def read_vertical(tags: Sequence[Tags]) -> Vertical:
    """Read the tags of n things."""
    known: dict[tuple[tuple[str, str], ...], tuple[Any, ...]] = {(): _SILENT}
    rows = []
    for own in tags:
        said = tuple(item for item in own.items() if item[0] in _KEYS)
        if said not in known:
            known[said] = _read(own)
        rows.append(known[said])
    columns = list(zip(*rows, strict=True)) if rows else [()] * len(_SILENT)
    kinds = [float] * 8 + [np.int64, bool, bool, np.int64, object, np.int64, object]
    arrays = [np.array(column, kind) for column, kind in zip(columns, kinds, strict=True)]
    return Vertical(*arrays)


def unread_keys(tags: Tags) -> list[str]:
    """Return the keys of heights, levels and roofs whose values say nothing that can be read."""
    said = dict(zip(Vertical.__dataclass_fields__, _read(tags), strict=True))
    found = []
    for name, keys in _NUMBERS.items():
        key = next((key for key in keys if key in tags), None)
        if key is not None and said[name] != said[name]:
            found.append(key)
    shape = tags.get("roof:shape", "")
    return [*found, "roof:shape"] if shape and said["roof_shape"] < 0 else found


def _first(tags: Tags, *keys: str) -> str | None:
    return next((tags[key] for key in keys if key in tags), None)


def _number(value: float | None) -> float:
    return nan if value is None else value


def _read(tags: Tags) -> tuple[Any, ...]:
    length, count = measures.measure, measures.count
    height = length(_first(tags, *_NUMBERS["height"]), 0.5, MAX_HEIGHT)
    low = length(_first(tags, *_NUMBERS["min_height"]), 0.0, MAX_HEIGHT)
    if height is not None and low is not None and low >= height - 0.1:
        low = None
    levels = count(_first(tags, *_NUMBERS["levels"]), 0, MAX_LEVELS)
    min_level = count(_first(tags, *_NUMBERS["min_level"]), 0, MAX_LEVELS)
    roof = _first(tags, "roof:shape", "building:roof:shape", "roof:type", "building:roof")
    orientation = measures.word(tags.get("roof:orientation"))
    return (
        _number(height), _number(low), _number(levels), _number(min_level),
        _number(length(tags.get("roof:height"), 0.0, MAX_HEIGHT)),
        _number(count(tags.get("roof:levels"), 0, 20)),
        _number(measures.angle_deg(tags.get("roof:angle"))),
        measures.direction(_first(tags, *_NUMBERS["roof_direction"])),
        SHAPE.get(ROOF_WORDS.get(measures.word(roof), ""), -1),
        orientation == "across",
        orientation == "along",
        measures.color(_first(
            tags, "building:colour", "building:color", "building:facade:colour", "facade:colour",
            "colour", "color",
        )),
        measures.word(_first(
            tags, "building:material", "building:facade:material", "facade:material",
            "building:cladding", "material",
        )),
        measures.color(_first(tags, "roof:colour", "roof:color", "building:roof:colour")),
        measures.word(_first(tags, "roof:material", "building:roof:material")),
    )  # fmt: skip
