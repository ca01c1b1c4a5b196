"""Generators of other packages, checked: their words name things, their volumes are volumes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import wraps
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from cityx.assets.styles.generators import Generator, Look
from cityx.assets.styles.package_generators import (
    PackageGenerator,
    package_generators,
    read_package_generator,
    sentence,
)
from cityx.building.generators import Masses, action_of
from cityx.building.massing.massing import Mass, Plot
from cityx.errors import UsageError, nearest
from cityx.system.extensions import refuse, remembered, tried

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.protocol.registry import Entry

FACINGS = ("", "stone", "paint")


@remembered
def packaged() -> Mapping[str, Generator]:
    """Return the generators of installed packages that can be used, by name."""
    found = {}
    for name, made in package_generators().items():
        try:
            _action(made)
            found[name] = _with_volumes(made)
        except UsageError as error:
            refuse(str(error))
    return MappingProxyType(found)


def action_of_entry(entry: Entry) -> Callable[..., City]:
    """Make the action of a generator of a package.

    Raises
    ------
    UsageError
        In one sentence, whatever is wrong with it.
    """
    return _action(read_package_generator(entry))


def _action(made: PackageGenerator) -> Callable[..., City]:
    if faults := _faults(made.kind):
        raise UsageError(sentence(made.entry, " ".join(faults)))
    masses = _checked(made.masses) if callable(made.masses) else _block(made.kind)
    if made.masses is not None and not callable(made.masses):
        raise UsageError(sentence(made.entry, f"{made.entry.run} is no function"))
    try:
        return action_of(made.entry.id, made.kind, masses)
    except (UsageError, TypeError) as error:
        raise UsageError(sentence(made.entry, str(error))) from error


def _with_volumes(made: PackageGenerator) -> Generator:
    return made.kind if made.masses is None else replace(made.kind, mass=_checked(made.masses))


def _block(kind: Generator) -> Masses:
    """Return what raises a footprint as it is."""

    def masses(plot: Plot) -> tuple[Mass, ...]:
        return (plot.body,)

    masses.__doc__ = f"Build what people call: {kind.title}."
    return masses


def _checked(masses: Callable[..., Any]) -> Masses:
    """Return a function for volumes whose faults are those that a design names and survives."""

    @wraps(masses)
    def grow(plot: Plot, **given: Any) -> Sequence[Mass]:
        made, why = tried(lambda: list(masses(plot, **given)))
        if made is None:
            raise ValueError(f"its package failed: {why}")
        if not all(isinstance(each, Mass) for each in made):
            raise ValueError("its package gave back something else than a Mass")
        return made

    return grow


def _faults(kind: Generator) -> list[str]:
    """Return a sentence for every word of a table that names nothing."""
    from cityx.assets.fixtures import names as fixtures
    from cityx.assets.openings.doors import DOORS
    from cityx.assets.openings.windows import WINDOWS
    from cityx.assets.styles.materials import MATERIALS
    from cityx.assets.trims.roof_furniture import REACH
    from cityx.assets.trims.trims import TRIMS
    from cityx.building.roofs.shapes import SHAPES, SYNONYMS

    faults: dict[tuple[str, str], str] = {}  # zones have what they inherit, which is told once

    def known(place: str, name: str, said: Iterable[str], words: Iterable[str]) -> None:
        words = list(words)
        for word in said:
            if word not in words:
                told = f'{kind.name}.toml, {place}{name}: there is no "{word}".'
                faults.setdefault((name, word), f"{told}{nearest(word, words)}")

    def look(place: str, each: Look) -> None:
        facade = each.facade
        known(place, "walls", [row[1] for row in each.walls], MATERIALS)
        lists = {
            "windows": ("", *WINDOWS), "doors": ("", *DOORS), "surrounds": ("", *TRIMS),
            "heads": ("", *TRIMS), "balconies": TRIMS, "base": FACINGS,
        }  # fmt: skip
        place += "facade, "
        for name, words in lists.items():
            known(place, name, [word for word, _ in getattr(facade, name)], words)
        known(place, "back", [facade.back], ("", *TRIMS))
        known(place, "fins", [strip.name for strip in facade.fins], TRIMS)
        known(place, "slabs", [strip.name for strip in facade.slabs], TRIMS)
        known(place, "fixtures", [each.name for each in facade.fixtures], fixtures())

    look("look, ", kind.look)
    for name, zone in kind.zones.items():
        look(f"zones.{name}, ", zone)
    known("", "roofs", [word for word, _ in kind.roofs], [*SHAPES, *SYNONYMS])
    known("", "rooftop", kind.rooftop, REACH)
    for name in ("pitched", "flat"):
        known("", name, [row[1] for row in getattr(kind, name)], MATERIALS)
    return list(faults.values())
