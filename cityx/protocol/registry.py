"""The registry: every action by name, none imported before it is asked for.

Built-in actions are known by `records.json` or found by reading the source of its rooms,
actions of other packages by their entry points in the group ``cityx.actions``, those of their
generators of buildings by the group ``cityx.generators``; making a registry runs
no plugin code at all.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from cityx.errors import UsageError, nearest
from cityx.protocol.actions import encapsulation_of
from cityx.protocol.encapsulation import ID_PATTERN, Encapsulation
from cityx.protocol.shipped import PACKAGE, fresh_records, module_of, plugin_files
from cityx.system.extensions import points_of

GROUP = "cityx.actions"
GENERATORS = "cityx.generators"
# A module of a room above makes the action of a generator: of the entry that names its table.
MAKER = "cityx.building.generators.packaged:action_of_entry"
BUILTIN = "cityx"
DECORATORS = ("action", "generator")  # of functions that are actions


@dataclass(frozen=True)
class Entry:
    """What is known of an action before its module is imported.

    Attributes
    ----------
    id, run
        As in the record; of a generator, where its entry finds its table and its volumes.
    classname
        The word models call it by.
    summary
        First line of its docstring, "" for actions of other packages.
    package
        Distribution it comes from; `BUILTIN` for CityX itself.
    generator
        Whether a package brings it as a generator, whose action CityX makes.
    """

    id: str
    run: str
    classname: str
    summary: str = ""
    package: str = BUILTIN
    generator: bool = False

    @property
    def stage(self) -> str:
        """The stage its id names."""
        return self.id.partition("/")[0]

    def load(self, broken: dict[str, BaseException] | None = None) -> Callable[..., Any]:
        """Import the module and return the function.

        Parameters
        ----------
        broken
            Why modules could not be imported before: none is tried twice, as it may take long.

        Raises
        ------
        UsageError
            If it cannot be imported or carries another id.
        """
        module, _, name = self.run.partition(":")
        if self.generator:
            module, _, name = MAKER.partition(":")
            made: Callable[..., Any] = getattr(import_module(module), name)(self)
            return made
        try:
            function: Callable[..., Any] = getattr(
                _imported(module, {} if broken is None else broken), name
            )
        except (Exception, SystemExit) as error:  # a module may even try to end the program
            if isinstance(error, UsageError) and self.package == BUILTIN:
                raise
            why = "" if isinstance(error, UsageError) else f"{type(error).__name__}: "
            raise UsageError(
                f"Action {self.id} of package {self.package} cannot be loaded from {self.run}: "
                f"{why}{' '.join(str(error).split())}"
            ) from error
        record = encapsulation_of(function)
        if record.id != self.id:
            raise UsageError(f"{self.run} is action {record.id}, not {self.id} as its entry says.")
        return function


def _imported(module: str, broken: dict[str, BaseException]) -> ModuleType:
    if module in broken:
        raise broken[module]
    try:
        return import_module(module)
    except (Exception, SystemExit) as error:  # what `Entry.load` tells of
        broken[module] = error
        raise


@dataclass(eq=False)
class Registry:
    """Actions by id, name or classname.

    Attributes
    ----------
    entries
        Id to entry, in alphabetical order.
    trusted
        Packages whose actions may run besides the built-in ones; None for all installed.
    refused
        Why entries of other packages were left out: one bad package must not stop the others.
    """

    entries: dict[str, Entry] = field(default_factory=dict)
    trusted: frozenset[str] | None = None
    refused: list[str] = field(default_factory=list)
    _loaded: dict[str, Callable[..., Any]] = field(default_factory=dict, repr=False)
    _names: dict[str, list[str]] = field(default_factory=dict, repr=False)
    _lost: set[str] = field(default_factory=set, repr=False)  # ids that cannot be loaded
    _broken: dict[str, BaseException] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, functions: Iterable[Callable[..., Any]]) -> Registry:
        """Make a registry of decorated functions, for tests and notebooks."""
        made = cls()
        for function in functions:
            made.add(function)
        return made

    def add(self, function: Callable[..., Any]) -> None:
        """Register a decorated function that is imported already."""
        record = encapsulation_of(function)
        self.put(Entry(record.id, record.run, record.classname, record.description))
        self._loaded[record.id] = function

    def put(self, entry: Entry) -> None:
        """Register an entry.

        Raises
        ------
        UsageError
            If the id is taken by another package or has the wrong form.
        """
        if not ID_PATTERN.fullmatch(entry.id):
            raise UsageError(
                f'Package {entry.package} registers "{entry.id}", which is not of the form '
                '"stage/name-vN".'
            )
        known = self.entries.get(entry.id)
        if known is not None and known != entry:
            raise UsageError(
                f"Action {entry.id} is registered twice, by {known.package} and {entry.package}."
            )
        self.entries[entry.id] = entry
        for name in {entry.id.rpartition("-v")[0], entry.classname, entry.classname.lower()}:
            ids = self._names.setdefault(name, [])
            if entry.id not in ids:
                ids.append(entry.id)

    def __iter__(self) -> Iterator[str]:
        """Iterate over ids in alphabetical order."""
        return iter(sorted(self.entries))

    def __len__(self) -> int:
        """Return the number of actions."""
        return len(self.entries)

    def __contains__(self, name: object) -> bool:
        """Return whether a name leads to exactly one action."""
        return isinstance(name, str) and len(self._candidates(name)) == 1

    def __getitem__(self, name: str) -> Encapsulation:
        """Return the record of an action by id, "stage/name" or classname."""
        return encapsulation_of(self.function(name))

    def _candidates(self, name: str) -> list[str]:
        if name in self.entries:
            return [name]
        ids = self._names.get(name, [])
        newest: dict[str, str] = {}
        for action_id in sorted(ids, key=lambda i: int(i.rpartition("-v")[2])):
            newest[action_id.rpartition("-v")[0]] = action_id
        return sorted(newest.values())

    def resolve(self, name: str) -> str:
        """Return the id a name leads to; without version the newest.

        Raises
        ------
        UsageError
            If it leads to none or to several.
        """
        ids = self._candidates(name)
        if len(ids) == 1:
            return ids[0]
        if ids:
            raise UsageError(f'"{name}" may be {" or ".join(ids)}; write the id.')
        words = [*self.entries, *self._names] if len(self.entries) <= 1000 else list(self.entries)
        hint = nearest(name, words)
        if ID_PATTERN.fullmatch(name):
            hint += " The package of a plugin must be installed: pip install FOLDER."
        raise UsageError(f'There is no action "{name}".{hint}')

    def function(self, name: str) -> Callable[..., Any]:
        """Return the function of an action, importing its module when needed."""
        action_id = self.resolve(name)
        if action_id not in self._loaded:
            self._loaded[action_id] = self.entries[action_id].load(self._broken)
        return self._loaded[action_id]

    def entry(self, name: str) -> Entry:
        """Return the entry of an action without importing it."""
        return self.entries[self.resolve(name)]

    def of_stage(self, stage: str) -> tuple[str, ...]:
        """Return the ids of one stage."""
        return tuple(i for i in self if self.entries[i].stage == stage)

    def records(self, stage: str = "") -> Iterator[Encapsulation]:
        """Yield the records of the trusted actions that can be loaded, of one stage or of all.

        An action of another package that cannot be loaded is passed over and named in `refused`;
        a built-in one is an error.
        """
        for action_id in self.of_stage(stage) if stage else tuple(self):
            if not self.is_trusted(action_id):
                continue
            if self.entries[action_id].package == BUILTIN:
                yield self[action_id]
            elif (record := self.outside_record(action_id)) is not None:
                yield record

    def outside_record(self, action_id: str) -> Encapsulation | None:
        """Return the record of an action of another package, None where it cannot be loaded.

        `refused` tells why.
        """
        if action_id in self._lost:
            return None
        try:
            return self[action_id]
        except UsageError as error:
            self._lost.add(action_id)
            self.refused.append(str(error))
            return None

    def counts(self) -> Mapping[str, int]:
        """Return the number of actions of each stage, the paper's k_i."""
        found: dict[str, int] = {}
        for entry in self.entries.values():
            found[entry.stage] = found.get(entry.stage, 0) + 1
        return dict(sorted(found.items()))

    def is_trusted(self, name: str) -> bool:
        """Return whether an action may run by where it comes from."""
        package = self.entry(name).package
        return package == BUILTIN or self.trusted is None or package in self.trusted


def registry(*, trusted: Iterable[str] | None = None, outside: bool = True) -> Registry:
    """Make the registry of all built-in and installed actions.

    Parameters
    ----------
    trusted
        Packages whose actions may run; None for all that are installed.
    outside
        Whether to look for actions of other packages.
    """
    made = Registry(trusted=None if trusted is None else frozenset(trusted))
    for entry in _builtin_entries():
        made.put(entry)
    if outside:
        for entry in outside_entries():
            try:
                made.put(entry)
            except UsageError as error:
                made.refused.append(str(error))
    return made


def outside_entries() -> tuple[Entry, ...]:
    """Return the actions that other packages register, sorted by id."""
    found = [
        outside_entry(group, point.name, point.value, package)
        for group in (GROUP, GENERATORS)
        for package, point in points_of(group)
    ]
    return tuple(sorted(found, key=lambda entry: (entry.id, entry.package)))


def outside_entry(group: str, name: str, value: str, package: str) -> Entry:
    """Return what an entry point of a package says; `group` is `GROUP` or `GENERATORS`."""
    word = name.partition("/")[2].rpartition("-v")[0]
    return Entry(name, value.replace(" ", ""), word, "", package, group == GENERATORS)


@cache
def _builtin_entries() -> tuple[Entry, ...]:
    fresh = fresh_records()
    found: list[Entry] = []
    for path in plugin_files():
        records = fresh.get(module_of(path))
        if records is None:
            found += scan(path, PACKAGE.parent)
        else:
            found += [
                Entry(record["id"], record["run"], record["classname"], record["description"])
                for record in records
            ]
    return tuple(found)


def scan(path: Path, root: Path) -> Iterator[Entry]:
    """Yield the actions a source file defines, read from its syntax tree."""
    text = path.read_text(encoding="utf-8")
    if not any(word in text for word in ("@action", "@generator", "action_of")):
        return
    module = module_of(path, root)
    try:
        tree = ast.parse(text)
    except SyntaxError as error:
        raise UsageError(f"{path.name}, line {error.lineno}: {error.msg}.") from error
    constants: dict[str, str] = {}
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(node.value, ast.Constant):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            constants |= {t.id: str(node.value.value) for t in targets if isinstance(t, ast.Name)}
    for name, call, function in declared(tree):
        yield _scanned(f"{module}:{name}", call, ast.get_docstring(function) or "", constants)


def declared(tree: ast.Module) -> Iterator[tuple[str, ast.Call, ast.FunctionDef]]:
    """Yield the name, the call and the documented function of the actions that a module declares.

    Most are functions under ``@action(...)`` or ``@generator(...)``; ``name = action_of(...)``
    makes one of a generator of buildings, by the signature and the docstring of a function among
    its arguments.
    """
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            for call in node.decorator_list:
                if isinstance(call, ast.Call) and called(call) in DECORATORS and call.args:
                    yield node.name, call, node
        elif isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            if called(node.value) != "action_of" or not isinstance(node.targets[0], ast.Name):
                continue
            names = [part.id for part in node.value.args if isinstance(part, ast.Name)]
            for name in functions.keys() & names:
                yield node.targets[0].id, node.value, functions[name]


def called(call: ast.Call) -> str:
    """Return the name of what is called, without its module."""
    func = call.func
    return func.id if isinstance(func, ast.Name) else getattr(func, "attr", "")


def _scanned(run: str, call: ast.Call, doc: str, constants: Mapping[str, str]) -> Entry:
    action_id = _word(call.args[0], constants)
    if action_id is None:
        raise UsageError(f"{run}: the id of an action must be a text or a constant of its module.")
    name = action_id.partition("/")[2].rpartition("-v")[0]
    for keyword in call.keywords:
        if keyword.arg == "classname":
            name = _word(keyword.value, constants) or name
    return Entry(action_id, run, name, " ".join(doc.split("\n\n")[0].split()))


def _word(node: ast.expr, constants: Mapping[str, str]) -> str | None:
    if isinstance(node, ast.Name):
        return constants.get(node.id)
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else None
