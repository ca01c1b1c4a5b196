"""The records of all actions, known without importing any plugin."""

from __future__ import annotations

import json
from functools import cache
from hashlib import blake2b
from importlib.metadata import version

from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.registry import BUILTIN, Registry
from cityx.protocol.shipped import PACKAGE, fresh_records
from cityx.system import tables
from cityx.system.cache import cached_json
from cityx.system.tables import files_of


@cache
def code_digest() -> str:
    """Return a digest of the source and the data of CityX, 32 hex digits.

    Another one may make other cities.
    """
    hasher = blake2b(digest_size=16)
    for root, paths in ((PACKAGE, sorted(PACKAGE.rglob("*.py"))), (tables.DATA, files_of())):
        for path in paths:
            hasher.update(str(path.relative_to(root)).encode())
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
    """Return the records of all trusted actions, where they hold those that come with the package.

    Those of plugins that have changed are kept from an earlier process. Records of other packages
    are read anew: their code may change without a new version.
    """
    held = {r["id"]: r for records in fresh_records().values() for r in records}
    builtin = [name for name in actions if actions.entries[name].package == BUILTIN]
    changed = [name for name in builtin if name not in held]
    if changed:
        digest = blake2b(json.dumps([code_digest(), changed]).encode(), digest_size=16).hexdigest()
        read = cached_json(f"records-{digest}", lambda: [actions[n].to_json() for n in changed])
        held |= {record["id"]: record for record in read}
    found = [Encapsulation.from_json(held[name]) for name in builtin]
    for name in actions:
        if actions.entries[name].package == BUILTIN or not actions.is_trusted(name):
            continue
        record = actions.outside_record(name)
        if record is not None:
            found.append(record)
    return tuple(found)
