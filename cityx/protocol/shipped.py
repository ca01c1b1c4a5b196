"""The records that come with the package, so that a first start imports no plugin.

`records.json` holds the records of every plugin file beside a digest of what they are read from. In
a checkout where a plugin has changed its own are read from it; `make records` renews the file.
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any

from cityx.system.tables import files_read_by

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
         "serving", "shipped", "stages", "values")  # fmt: skip
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
        if held["form"] != _form():
            return {}
        plugins = held["plugins"]
    except (OSError, ValueError, KeyError):
        return {}
    return {
        module: tuple(known["records"])
        for module, known in plugins.items()
        if known["face"] == _digest(module, known["of"])
    }


def module_of(path: Path, root: Path = PACKAGE.parent) -> str:
    """Return the name by which a source file is imported."""
    return ".".join(path.relative_to(root).with_suffix("").parts)


def plugin_files() -> tuple[Path, ...]:
    """Return the source files of the built-in plugins, sorted."""
    return tuple(sorted(path for room in ROOMS for path in (PACKAGE / room).rglob("*.py")))


def written_records() -> str:
    """Return the text that `records.json` should hold, read from the plugins themselves."""
    from cityx.protocol.registry import registry

    actions = registry(outside=False)
    by_module: dict[str, list[dict[str, Any]]] = {}
    for name in actions:
        record = actions[name]
        by_module.setdefault(record.run.partition(":")[0], []).append(record.to_json())
    lines = []
    for path in plugin_files():
        module = module_of(path)
        of = _sources(path) if module in by_module else []
        known = {"of": of, "face": _digest(module, of), "records": by_module.get(module, [])}
        lines.append(f"{json.dumps(module)}: {json.dumps(known, sort_keys=True)}")
    form = json.dumps(_form())
    return f'{{"form": {form}, "plugins": {{\n' + ",\n".join(lines) + "\n}}\n"


def write_records() -> None:
    """Renew `records.json` after a change of a plugin's signature, docstring or constants."""
    HELD.write_text(written_records(), encoding="utf-8")


@cache
def _form() -> str:
    hasher = blake2b(digest_size=16)
    for name in _FORM:
        hasher.update((PACKAGE / "protocol" / f"{name}.py").read_bytes())
    return hasher.hexdigest()


def _digest(module: str, others: Sequence[str]) -> str:
    hasher = blake2b(digest_size=16)
    for name in (module, *others):
        hasher.update(_face_of(name))
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


def _sources(path: Path) -> list[str]:
    """Return the modules from which a plugin takes the constants its records are made of."""
    from cityx.protocol.actions import LATE_NAMES

    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported: dict[str, str] = {}
    made: dict[str, ast.expr] = {}
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("cityx."):
            imported |= {alias.asname or alias.name: node.module for alias in node.names}
        elif isinstance(node, ast.Assign):
            made |= {t.id: node.value for t in node.targets if isinstance(t, ast.Name)}
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value:
            made[node.target.id] = node.value
    names: set[str] = set()
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.decorator_list:
            result = [node.returns] if node.returns else []
            for part in (*node.decorator_list, node.args, *result):
                names |= set(_names(part, made, names))
    names -= LATE_NAMES.keys()  # a type counts by its name alone
    return sorted({imported[name] for name in names if not _is_form(imported.get(name, ""))})


def _is_form(module: str) -> bool:
    return not module or module == "cityx.protocol" or module.startswith("cityx.protocol.")


def _names(node: ast.AST, made: Mapping[str, ast.expr], known: set[str]) -> Iterator[str]:
    for part in ast.walk(node):
        if isinstance(part, ast.Name) and part.id not in known:
            known.add(part.id)
            yield part.id
            if part.id in made:
                yield from _names(made[part.id], made, known)
