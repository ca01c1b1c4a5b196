"""Generators of buildings of other packages: a table each, as those of CityX have.

An entry ``"building/kiosk-v1" = "kiosks"`` of the group ``cityx.generators`` finds ``kiosk.toml``
beside the module ``kiosks``, which is imported only if the entry names a function of it for the
volumes: "kiosks:masses". The table has the keys of `Generator`, and ``styles``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import Any

from cityx.assets.styles.generator_tables import generator_of
from cityx.assets.styles.generators import Generator
from cityx.errors import CityxError, InputError, UsageError
from cityx.protocol.plugged import (
    LONGEST_NAME,
    Weight,
    checked_styles,
    mesh_actions,
    spoken,
    version_of,
)
from cityx.protocol.registry import Entry, registry
from cityx.system.extensions import refuse, remembered, tried
from cityx.system.tables import DATA, read_table


@dataclass(frozen=True)
class PackageGenerator:
    """A generator that a package brings.

    Attributes
    ----------
    entry
        What names it: id, package, where it is found.
    kind
        Its table.
    styles
        Where it stands unasked, as of `cityx.protocol.plugged.generator`.
    masses
        Grows its volumes as the package gave it, unchecked; None where the footprint is raised.
    """

    entry: Entry
    kind: Generator
    styles: Mapping[str, Weight]
    masses: Callable[..., Any] | None


@dataclass(frozen=True)
class OutsideBuilding:
    """What a town and a sentence know of a kind of building of another package.

    Attributes
    ----------
    action, package
        Id of the action that builds it, and where it comes from.
    styles
        As of `PackageGenerator`.
    words
        What a sentence may call it, singular.
    """

    action: str
    package: str
    styles: Mapping[str, Weight]
    words: tuple[str, ...]


def read_package_generator(entry: Entry) -> PackageGenerator:
    """Read the table that an entry names, and import the function for its volumes, if any.

    Raises
    ------
    UsageError
        In one sentence, whatever is wrong with it.
    """
    try:
        made, why = tried(partial(_read, entry), passing=(CityxError,))
    except CityxError as error:
        made, why = None, str(error)
    if made is None:
        raise UsageError(sentence(entry, why))
    return made


def sentence(entry: Entry, why: str) -> str:
    """Return why a generator is left out, on one line."""
    said = " ".join(why.split())
    end = "" if said.endswith((".", "?")) else "."
    return f"Generator {entry.id} of package {entry.package} cannot be used: {said}{end}"


def _read(entry: Entry) -> PackageGenerator:
    name = entry.classname
    if entry.stage != "building":
        raise UsageError("its id must begin with building/")
    if len(name) > LONGEST_NAME:
        raise UsageError(f"its name has over {LONGEST_NAME} letters")
    if (DATA / "generators" / f"{name}.toml").is_file():
        raise UsageError(f'the name "{name}" is taken by a building of CityX')
    module, _, function = entry.run.partition(":")
    path = _folder(module) / f"{name}.toml"
    if not path.is_file():
        raise InputError(f"there is no {path.name} beside the module {module}")
    table = read_table(path)
    styles = table.pop("styles", {})
    if not isinstance(styles, dict):
        raise InputError(f"{path.name}, styles: {styles!r} is not of type table")
    kind = generator_of(name, table, path.name)
    masses = getattr(import_module(module), function) if function else None
    return PackageGenerator(entry, kind, checked_styles(styles, path.name), masses)


def _folder(module: str) -> Path:
    """Return the folder of a module, which is not imported."""
    spec = find_spec(module)
    if spec is None:
        raise InputError(f"there is no module {module}")
    folders = list(spec.submodule_search_locations or ())
    return Path(folders[0]) if folders else Path(str(spec.origin)).parent


@remembered
def package_generators() -> Mapping[str, PackageGenerator]:
    """Return the generators of installed packages by name, the newest version of each."""
    actions = registry()
    for said in actions.refused:
        refuse(said)
    found: dict[str, PackageGenerator] = {}
    for action_id in sorted(actions.of_stage("building"), key=version_of):
        entry = actions.entries[action_id]
        if not entry.generator:
            continue
        try:
            found[entry.classname] = read_package_generator(entry)
        except UsageError as error:
            refuse(str(error))
    return MappingProxyType(dict(sorted(found.items())))


@remembered
def outside_buildings() -> Mapping[str, OutsideBuilding]:
    """Return all kinds of building of other packages by name; of two of a name the generator."""
    found = {
        name: OutsideBuilding(
            made.entry.id, made.entry.package, made.styles,
            spoken(name, made.kind.title, made.kind.labels),
        )
        for name, made in package_generators().items()
    }  # fmt: skip
    for name, mesh in mesh_actions().items():
        own = OutsideBuilding(mesh.record.id, mesh.package, mesh.traits.styles, mesh.words)
        found.setdefault(name, own)
    return MappingProxyType(dict(sorted(found.items())))
