"""Generate `records.json`, from which the package lists its actions without importing them.

Run ``python -m cityx.protocol.records``, as `make records` and the build of a wheel do.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from cityx.protocol.actions import LATE_NAMES
from cityx.protocol.registry import called, declared, registry
from cityx.protocol.shipped import HELD, digest, form, module_of, plugin_files
from cityx.system.atomic import replaced

# What the actions of generators are derived with, beside their module and its table.
_DERIVING = ("assets/styles/generators.py", "building/generators/__init__.py")


def written_records() -> str:
    """Return the text that `records.json` should hold, read from the plugins themselves."""
    actions = registry(outside=False)
    by_module: dict[str, list[dict[str, Any]]] = {}
    for name in actions:
        record = actions[name]
        by_module.setdefault(record.run.partition(":")[0], []).append(record.to_json())
    lines = []
    for path in plugin_files():
        module = module_of(path)
        of = _sources(path) if module in by_module else []
        known = {"of": of, "face": digest(module, of), "records": by_module.get(module, [])}
        lines.append(f"{json.dumps(module)}: {json.dumps(known, sort_keys=True)}")
    return f'{{"form": {json.dumps(form())}, "plugins": {{\n' + ",\n".join(lines) + "\n}}\n"


def write_records() -> None:
    """Renew `records.json` after a change of a plugin's signature, docstring or constants."""
    with replaced(HELD) as path:
        path.write_text(written_records(), encoding="utf-8")


def _sources(path: Path) -> list[str]:
    """Return the modules and files from which a module takes what its records are made of."""
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
    files: set[str] = set()
    for _, call, node in declared(tree):
        parts: list[ast.AST] = [call, node.args, *([node.returns] if node.returns else [])]
        if called(call) == "action_of":
            files |= {f"data/generators/{path.stem}.toml", *_DERIVING}
            parts = [call, *node.args.kwonlyargs]
        for part in parts:
            names |= set(_names(part, made, names))
    names -= LATE_NAMES.keys()  # a type counts by its name alone
    found = {imported[name] for name in names if not _is_form(imported.get(name, ""))}
    return sorted(found | files)


def _is_form(module: str) -> bool:
    return not module or module == "cityx.protocol" or module.startswith("cityx.protocol.")


def _names(node: ast.AST, made: Mapping[str, ast.expr], known: set[str]) -> Iterator[str]:
    for part in ast.walk(node):
        if isinstance(part, ast.Name) and part.id not in known:
            known.add(part.id)
            yield part.id
            if part.id in made:
                yield from _names(made[part.id], made, known)


if __name__ == "__main__":
    write_records()
