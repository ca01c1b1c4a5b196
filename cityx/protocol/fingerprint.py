"""Fingerprints of values: equal for equal content, whatever the type."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from hashlib import blake2b
from typing import Any

import numpy as np


def fingerprint(value: Any) -> str:
    """Hash arrays, tables, geometries and dataclasses by content, exactly; 32 hex digits."""
    hasher = blake2b(digest_size=16)
    for piece in _pieces(value):
        hasher.update(piece)
        hasher.update(b"\x1f")
    return hasher.hexdigest()


def _pieces(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        yield f"{value.dtype}{value.shape}".encode()
        if value.dtype == object:
            for item in value.ravel().tolist():
                yield from _pieces(item)
        else:
            yield np.ascontiguousarray(value).tobytes()
    elif hasattr(value, "wkb"):
        yield value.wkb
    elif is_dataclass(value) and not isinstance(value, type):
        yield type(value).__name__.encode()
        for column in fields(value):
            yield column.name.encode()
            yield from _pieces(getattr(value, column.name))
    elif hasattr(value, "columns") and hasattr(value, "geometry"):
        for name in value.columns:
            yield str(name).encode()
            yield from _pieces(value[name].to_numpy(object))
    elif isinstance(value, Mapping):
        for key in sorted(value, key=str):
            yield str(key).encode()
            yield from _pieces(value[key])
    elif isinstance(value, frozenset | set):
        yield repr(sorted(map(repr, value))).encode()
    elif isinstance(value, tuple | list):
        yield str(len(value)).encode()
        for item in value:
            yield from _pieces(item)
    else:
        yield repr(value).encode()
