"""Tables of generators: a TOML file becomes a `Generator`, without the volumes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from cityx.assets.styles import palette_tables
from cityx.assets.styles.generators import Generator, Look
from cityx.errors import InputError, nearest
from cityx.system.tables import faults_of, filled, read_table

_REFERENCE = re.compile(r"\$(\w+)(?:\[(\d*):(\d*)\])?")
_OF_CODE = ("name", "mass", "outside")  # no table gives them


def read_generator(name: str, path: Path) -> Generator:
    """Read the table of a generator.

    Raises
    ------
    InputError
        If it cannot be read, or has unknown keys or names, or values of another type.
    """
    return generator_of(name, read_table(path), path.name)


def generator_of(name: str, table: Mapping[str, Any], place: str) -> Generator:
    """Make a generator of what its table holds; see `read_generator`.

    Parameters
    ----------
    place
        What messages call the table.
    """
    held = dict(table)
    shared = dict(held.pop("shared", {}))
    for key in shared:
        shared[key] = _referred(shared[key], shared, f"{place}, shared.{key}")
    held = _referred(held, shared, place)
    known: dict[str, dict[str, Any]] = {}
    zones = held.pop("zones", {})
    for key, look in {"look": held.pop("look", {}), **zones}.items():
        known[key] = _inherited(look, known, f"{place}, {key}")
    if said := [key for key in _OF_CODE if key in held]:
        raise InputError(f'{place}: there is no key "{said[0]}".')
    look = known.pop("look")
    # Zones have what is wrong with the look that they are like.
    zones = {} if faults_of(Look, look, place) else known
    return filled(Generator, {"name": name, "look": look, "zones": zones, **held}, place)


def _referred(value: Any, shared: Mapping[str, Any], place: str) -> Any:
    """Put in place what "$name" and "$NAME[a:b]" stand for: a shared value, or a palette."""
    if isinstance(value, dict):
        return {key: _referred(each, shared, place) for key, each in value.items()}
    if isinstance(value, list):
        return [part for each in value for part in _parts(each, shared, place)]
    if not isinstance(value, str) or not value.startswith("$"):
        return value
    match = _REFERENCE.fullmatch(value)
    known = {**_palettes(), **shared}
    if match is None or match[1] not in known:
        raise InputError(f'{place}: nothing is named "{value}".{nearest(value[1:], known)}')
    found = known[match[1]]
    if match[2] is None:
        return found
    return found[slice(*(int(end) if end else None for end in match.groups()[1:]))]


def _parts(value: Any, shared: Mapping[str, Any], place: str) -> Iterator[Any]:
    """Yield the elements that one element of an array stands for."""
    found = _referred(value, shared, place)
    if isinstance(value, str) and isinstance(found, list | tuple):
        yield from found
    else:
        yield found


@cache
def _palettes() -> Mapping[str, Any]:
    """Return the named tuples of `palette_tables`: colours, and surfaces in them."""
    return {
        name: value
        for name, value in vars(palette_tables).items()
        if name.isupper() and isinstance(value, tuple)
    }


def _inherited(
    look: dict[str, Any], known: Mapping[str, dict[str, Any]], place: str
) -> dict[str, Any]:
    """Fill up a look from the one that it is ``like``, and its facade from another's if it says so.

    A zone is like the main look, and a facade like that of its look, where they say nothing.
    """

    def of(name: str) -> dict[str, Any]:
        if name and name not in known:
            raise InputError(f'{place}: no look "{name}" comes before.{nearest(name, known)}')
        return known.get(name, {})

    look, facade = dict(look), dict(look.get("facade", {}))
    start = of(look.pop("like", "look" if known else ""))
    usual = of(facade.pop("like")) if "like" in facade else start
    return start | look | {"facade": usual.get("facade", {}) | facade}
