"""Records: what is known of an asset without opening its file.

A record has the attributes of the paper (path, collection, width, length, area, centre coordinates,
style) and those that placement needs besides: the true footprint, the front, the height.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.errors import InputError
from cityx.ids import id_text
from cityx.system.tables import table, text_of

GROUPS = ("buildings", "plants", "vehicles", "people", "furniture")
SOURCES = ("procedural", "imported")

COLUMNS = table("assets/library", str, "columns")  # column -> NumPy dtype
DOCUMENT_SCHEMA: Mapping[str, Any] = MappingProxyType(
    json.loads(text_of("assets/record.schema.json"))
)


@dataclass(frozen=True)
class Catalogue:
    """Records of n assets, column by column; see `COLUMNS`.

    Attributes
    ----------
    columns
        (n,) arrays by name.
    """

    columns: Mapping[str, NDArray[Any]]

    def __len__(self) -> int:
        """Return the number of assets."""
        return len(self.columns["id"])

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return one column."""
        return self.columns[name]

    def take(self, rows: Any) -> Catalogue:
        """Return the records of the given rows, in that order."""
        return Catalogue(
            MappingProxyType({name: values[rows] for name, values in self.columns.items()})
        )

    def replaced(self, **columns: Any) -> Catalogue:
        """Return the catalogue with some columns replaced."""
        return make_catalogue(len(self), **{**self.columns, **columns})

    def record(self, row: int) -> dict[str, Any]:
        """Return one record as the JSON document has it."""
        return _to_json({name: values[row] for name, values in self.columns.items()})

    def document(self) -> dict[str, list[dict[str, Any]]]:
        """Return all records by group, as the paper lists them."""
        out: dict[str, list[dict[str, Any]]] = {}
        for row, group in enumerate(self["group"].tolist()):
            out.setdefault(group, []).append(self.record(row))
        return {group: out[group] for group in GROUPS if group in out}


def make_catalogue(size: int, /, **columns: Any) -> Catalogue:
    """Make a catalogue of n assets; columns broadcast, those left out are "", 0 or NaN.

    Raises
    ------
    KeyError
        If a column is not one of `COLUMNS`.
    """
    unknown = set(columns) - set(COLUMNS)
    if unknown:
        raise KeyError(f"a record has no column {sorted(unknown)}")
    return Catalogue(
        MappingProxyType(
            {name: _column(columns.get(name), kind, size) for name, kind in COLUMNS.items()}
        )
    )


def _column(values: Any, kind: str, size: int) -> NDArray[Any]:
    if kind in ("str", "polygon"):
        out = np.empty(size, object)
        out[:] = "" if values is None and kind == "str" else values
        if kind == "str":
            out[:] = [str(word) for word in out]
        return out
    fill: Any = np.nan if kind == "float64" else 0
    given = fill if values is None else np.asarray(values)
    return np.broadcast_to(np.asarray(given, dtype=kind), (size,)).copy()


def join_catalogues(parts: Iterable[Catalogue]) -> Catalogue:
    """Put catalogues one after the other."""
    held = list(parts)
    if not held:
        return make_catalogue(0)
    return Catalogue(
        MappingProxyType({name: np.concatenate([p[name] for p in held]) for name in COLUMNS})
    )


def _to_json(row: Mapping[str, Any]) -> dict[str, Any]:
    """Turn one row into a record, the paper's attributes first."""
    out: dict[str, Any] = {
        "path": row["path"],
        "collection": row["collection"],
        "width": _rounded(row["width"]),
        "length": _rounded(row["length"]),
        "area": _rounded(row["area"]),
        "coordinates": {"x": _rounded(row["x"]), "y": _rounded(row["y"])},
        "style": row["style"],
        "id": id_text(int(row["id"])),
    }
    for name, kind in COLUMNS.items():
        if name in out or name in ("x", "y", "group"):
            continue
        value = row[name]
        if kind == "polygon":
            out[name] = np.round(np.asarray(value.exterior.coords)[:-1, :2], 4).tolist()
        elif kind == "str":
            out[name] = str(value)
        elif kind == "float64":
            out[name] = _rounded(value)
        else:
            out[name] = int(value)
    return out


def _rounded(value: float) -> float | None:
    return round(float(value), 6) if np.isfinite(value) else None


def validate_document(document: Any) -> list[str]:
    """Return what is wrong with a document of records, one sentence each; [] when it is valid."""
    from jsonschema import Draft202012Validator

    faults = Draft202012Validator(dict(DOCUMENT_SCHEMA)).iter_errors(document)
    return [
        f"{'/'.join(map(str, fault.absolute_path)) or 'document'}: {fault.message}."
        for fault in sorted(faults, key=lambda fault: list(map(str, fault.absolute_path)))
    ]


def read_paper_records(text: str) -> dict[str, Any]:
    r"""Read records as the paper prints them: paths with "\\", an ellipsis, a comma too many.

    Raises
    ------
    InputError
        If it is no document of records even then.
    """
    clean = re.sub(r"\\+(?![\"\\])", "/", text)
    clean = re.sub(r"\[\s*\.\.\.\s*\]", "[]", clean)
    clean = re.sub(r",?\s*\.\.\.\s*(?=[\]}])", "", clean)
    try:
        document = json.loads(clean)
    except json.JSONDecodeError as error:
        raise InputError(
            f"The records are no JSON: {error.msg}, line {error.lineno}, column {error.colno}."
        ) from None
    faults = validate_document(document)
    if faults:
        raise InputError("The records are not as they should be: " + " ".join(faults[:5]))
    return dict(document)


def rectangle_columns(footprints: Sequence[Any] | NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Measure footprints: width, length, area, x, y, angle and footprint_area; (n,) each.

    Parameters
    ----------
    footprints
        (n,) polygons in the assets' own frames, metres.
    """
    from cityx.geometry.rectangles import rectangles_of

    shapes = np.asarray(footprints, object)
    box = rectangles_of(shapes)
    return {
        "width": box.width,
        "length": box.length,
        "area": box.width * box.length,
        "x": box.centre[:, 0],
        "y": box.centre[:, 1],
        "angle": box.angle,
        "footprint_area": shapely.area(shapes),
    }
