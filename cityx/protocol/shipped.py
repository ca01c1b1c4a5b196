"""The records that come with the package, so that a first start imports no action.

`records.json` holds the records of every module with actions beside a digest of the source they
are read from. It is generated (`cityx.protocol.records`); where it is absent or a module has
changed, records are read from the modules themselves.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any

from cityx.system.cache import cached_json
from cityx.system.digests import files_below, stamp_of
from cityx.system.tables import KINDS, files_read_by

PACKAGE = Path(__file__).parents[1]
# Rooms of the package that hold actions.
ROOMS = (
    "building",
    "convert",
    "edit",
    "light",
    "motion",
    "nature",
    "road",
    "terrain",
    "town",
    "views",
)
HELD = Path(__file__).with_name("records.json")
# What a record looks like is decided here.
_FORM = ("actions", "docstrings", "encapsulation", "formats", "parameters", "preconditions",
         "records", "serving", "shipped", "stages", "values")  # fmt: skip
# A signature's last line, and what is indented below it.
_BODY = re.compile(r"^((?:def |\))[^\n]*:(?:[ \t]*#[^\n]*)?\n)((?:(?:[ \t][^\n]*)?\n)+)", re.M)
_DOCSTRING = re.compile(r'\s*"""[\s\S]*?"""')


def face(text: str) -> str:
    """Return a module's source without the bodies of its functions; docstrings stay."""

    def without(found: re.Match[str]) -> str:
        doc = _DOCSTRING.match(found[2])
        return found[1] + (doc[0] if doc else "")

    return _BODY.sub(without, text)


@cache
def fresh_records() -> Mapping[str, tuple[Mapping[str, Any], ...]]:
    """Return the records of every plugin module that looks as it did when they were written.

    Returns
    -------
    records
        Module to its records as plain values, () for a module without actions.
    """
    try:
        held = json.loads(HELD.read_text(encoding="utf-8"))
        if held["form"] != form():
            return {}
        plugins = held["plugins"]
    except (OSError, ValueError, KeyError):
        return {}

    def unchanged() -> list[str]:
        return [name for name, it in plugins.items() if it["face"] == digest(name, it["of"])]

    # Sources are read again only when one of them has another time or size.
    stamp = stamp_of([HELD, *files_below(PACKAGE, ".py", *KINDS)])
    return {
        name: tuple(plugins[name]["records"]) for name in cached_json(f"fresh-{stamp}", unchanged)
    }


def module_of(path: Path, root: Path = PACKAGE.parent) -> str:
    """Return the name by which a source file is imported."""
    return ".".join(path.relative_to(root).with_suffix("").parts)


def plugin_files() -> tuple[Path, ...]:
    """Return the source files of the built-in plugins, sorted."""
    return tuple(sorted(path for room in ROOMS for path in (PACKAGE / room).rglob("*.py")))


@cache
def form() -> str:
    """Return a digest of the code that decides what a record looks like."""
    hasher = blake2b(digest_size=16)
    for name in _FORM:
        hasher.update((PACKAGE / "protocol" / f"{name}.py").read_bytes())
    return hasher.hexdigest()


def digest(module: str, others: Sequence[str]) -> str:
    """Return a digest of the faces of a module and of what its records take constants from.

    Parameters
    ----------
    others
        Modules by their dotted names, and files of the package by their paths, which count whole.
    """
    hasher = blake2b(digest_size=16)
    for name in (module, *others):
        hasher.update(_whole(name) if "/" in name else _face_of(name))
    return hasher.hexdigest()


@cache
def _face_of(module: str) -> bytes:
    path = PACKAGE.parent.joinpath(*module.split("."))
    source = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    try:
        text = source.read_text(encoding="utf-8")
        return face(text).encode() + b"".join(path.read_bytes() for path in files_read_by(text))
    except OSError:
        return b""


def _whole(name: str) -> bytes:
    path = PACKAGE / name
    return path.read_bytes() if path.is_file() else b""
