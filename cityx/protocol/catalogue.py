"""The records of all actions, kept between processes, so that planning imports no plugin."""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cache
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path

from cityx.atomic import replaced
from cityx.cache import cache_folder
from cityx.errors import UsageError
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.registry import BUILTIN, Registry

_PACKAGE = Path(__file__).parents[1]


@cache
def code_digest() -> str:
    """Return a digest of the source of CityX, 32 hex digits: another one may make other cities."""
    hasher = blake2b(digest_size=16)
    for path in sorted(_PACKAGE.rglob("*.py")):
        hasher.update(str(path.relative_to(_PACKAGE)).encode())
        hasher.update(path.read_bytes())
    return hasher.hexdigest()


def registry_hash(actions: Registry) -> str:
    """Return a digest of a registry, 32 hex digits: its actions and the code behind them."""
    outside = sorted({entry.package for entry in actions.entries.values()} - {BUILTIN})
    held = [code_digest(), *((name, _version(name)) for name in outside), *actions]
    return blake2b(json.dumps(held).encode(), digest_size=16).hexdigest()


def _version(package: str) -> str:
    try:
        return version(package)
    except Exception:  # noqa: BLE001  a package without metadata has no version
        return ""


def known_records(actions: Registry) -> tuple[Encapsulation, ...]:
    """Return the records of all trusted actions, from an earlier process where they are the same.

    Records of other packages are read anew: their code may change without a new version.
    """
    builtin = [name for name in actions if actions.entries[name].package == BUILTIN]
    folder = cache_folder()
    path = None
    if folder is not None:
        digest = blake2b(json.dumps([code_digest(), builtin]).encode(), digest_size=16)
        path = folder / f"records-{digest.hexdigest()}.json"
    found = _read(path)
    if found is None:
        found = tuple(actions[name] for name in builtin if actions.is_trusted(name))
        _write(path, found)
    others = [name for name in actions if actions.entries[name].package != BUILTIN]
    for name in others:
        if actions.is_trusted(name):
            try:
                found += (actions[name],)
            except UsageError as error:
                if str(error) not in actions.refused:
                    actions.refused.append(str(error))
    return found


def _read(path: Path | None) -> tuple[Encapsulation, ...] | None:
    if path is None:
        return None
    try:
        return tuple(map(Encapsulation.from_json, json.loads(path.read_text())))
    except (OSError, ValueError, KeyError, TypeError, UsageError):
        return None


def _write(path: Path | None, records: tuple[Encapsulation, ...]) -> None:
    if path is None:
        return
    with suppress(OSError), replaced(path) as temporary:
        temporary.write_text(json.dumps([record.to_json() for record in records]))
