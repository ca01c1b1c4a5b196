"""Extensions: what other packages add by entry points, read once and never fatal.

A package names a value in its metadata, under a group such as ``cityx.formats``. One that cannot be
imported, is of the wrong kind or takes a name that is taken is left out, with one sentence that
says why; all others are read.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache, partial
from importlib.metadata import EntryPoint, entry_points
from typing import Any, TypeVar

from cityx.errors import UsageError

T = TypeVar("T")
_REFUSED: dict[str, None] = {}  # sentences in the order in which they were found
_CACHES: list[Callable[[], None]] = []
_ADDED: list[tuple[str, EntryPoint]] = []  # of packages that are not installed


def remembered(function: Callable[[], T]) -> Callable[[], T]:
    """Make a function of no arguments that is run once per process, or since `forget`."""
    kept = cache(function)
    _CACHES.append(kept.cache_clear)
    return kept


def forget() -> None:
    """Read installed packages anew when they are next asked for."""
    _REFUSED.clear()
    for clear in _CACHES:
        clear()


def add_point(group: str, name: str, value: str, package: str) -> None:
    """Let an entry count in this process as if its package were installed."""
    _ADDED.append((package, EntryPoint(name, value, group)))
    forget()


def refuse(sentence: str) -> None:
    """Note why an extension was left out."""
    _REFUSED.setdefault(sentence)


def refusals() -> tuple[str, ...]:
    """Return why extensions were left out, one sentence each, of those asked for so far."""
    return tuple(_REFUSED)


def tried(call: Callable[[], T], passing: tuple[type[Exception], ...] = ()) -> tuple[T | None, str]:
    """Run code of a package, which may raise anything; return its result, or why it failed.

    Parameters
    ----------
    call
        What is run.
    passing
        Errors that the caller handles itself.
    """
    try:
        return call(), ""
    except passing:
        raise
    except Exception as error:  # noqa: BLE001  a package may raise anything
        return None, f"{type(error).__name__}: {error}"


def extensions(
    group: str, admit: Callable[[object], tuple[str, T]], taken: Callable[[str], bool]
) -> dict[str, T]:
    """Import what packages register in a group, sorted by name.

    Parameters
    ----------
    group
        Entry point group, such as "cityx.formats".
    admit
        Returns the name of a value and the value; raises `UsageError` if it is of the wrong kind.
    taken
        Whether a name belongs to CityX itself.
    """
    found: dict[str, T] = {}
    owner: dict[str, str] = {}
    for package, point in points_of(group):
        where = f'Package {package}, entry "{point.name}" of {group}'
        try:
            made, why = tried(partial(_admitted, admit, point), passing=(UsageError,))
        except UsageError as error:
            refuse(f"{where}: {error} It was left out.")
            continue
        if made is None:
            refuse(f"{where} cannot be loaded: {why}. It was left out.")
            continue
        name, value = made
        if taken(name) or name in found:
            holder = "CityX" if taken(name) else f"package {owner[name]}"
            refuse(f'{where}: the name "{name}" is taken by {holder}. It was left out.')
            continue
        found[name], owner[name] = value, package
    return found


def _admitted(admit: Callable[[object], tuple[str, T]], point: EntryPoint) -> tuple[str, T]:
    return admit(point.load())


@cache
def _installed(path: tuple[str, ...]) -> Any:
    """Return the entry points of all packages on a path: reading them takes 20 ms each time."""
    del path  # `sys.path`; what it holds is read anew since `forget`
    return entry_points()


_CACHES.append(_installed.cache_clear)


def points_of(group: str) -> list[tuple[str, EntryPoint]]:
    """Return the entry points of a group with their packages, sorted by name and package."""
    names: dict[int, str] = {}  # a distribution parses its metadata anew for every look at its name
    found = []
    for point in _installed(tuple(sys.path)).select(group=group):
        if point.dist is not None and id(point.dist) not in names:
            names[id(point.dist)] = point.dist.name
        found.append((names.get(id(point.dist), "unknown"), point))
    added = [(package, point) for package, point in _ADDED if point.group == group]
    own = {point.name for _, point in added}
    found = [(package, point) for package, point in found if point.name not in own] + added
    return sorted(found, key=lambda pair: (pair[1].name, pair[0]))
