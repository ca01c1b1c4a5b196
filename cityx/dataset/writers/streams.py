"""Long JSON files written element by element, so that no dataset is too large for the memory."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any


def stream_json(path: Path, head: Mapping[str, Any], lists: Mapping[str, Iterable[Any]]) -> None:
    """Write an object: small values first, then long lists with one element per line."""
    with path.open("w", encoding="utf-8") as file:
        file.write("{")
        separator = "\n"
        for key, value in head.items():
            file.write(f"{separator}{json.dumps(key)}: {json.dumps(value, allow_nan=False)}")
            separator = ",\n"
        for key, items in lists.items():
            file.write(f"{separator}{json.dumps(key)}: [")
            _elements(file, items)
            separator = ",\n"
        file.write("\n}\n")


def stream_list(path: Path, items: Iterable[Any]) -> None:
    """Write a list with one element per line."""
    with path.open("w", encoding="utf-8") as file:
        file.write("[")
        _elements(file, items)
        file.write("\n")


def _elements(file: Any, items: Iterable[Any]) -> None:
    separator = "\n"
    for item in items:
        file.write(separator + json.dumps(item, allow_nan=False))
        separator = ",\n"
    file.write("\n]")
