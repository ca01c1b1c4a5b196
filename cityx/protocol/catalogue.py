"""The records of all actions, kept between processes, so that planning imports no plugin."""

from __future__ import annotations

import json
from functools import cache
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path

from cityx.cache import cached_json
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
    digest = blake2b(json.dumps([code_digest(), builtin]).encode(), digest_size=16).hexdigest()
    held = cached_json(f"records-{digest}", lambda: [actions[name].to_json() for name in builtin])
    found = [Encapsulation.from_json(record) for record in held]
    for name in actions:
        if actions.entries[name].package == BUILTIN or not actions.is_trusted(name):
            continue
        try:
            found.append(actions[name])
        except UsageError as error:
            if str(error) not in actions.refused:
                actions.refused.append(str(error))
    return tuple(found)
