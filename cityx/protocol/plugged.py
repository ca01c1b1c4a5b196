"""Generators of other packages: actions that make the mesh of one building from its footprint.

`generator` is `action` with what a generator may say besides: in which styles it is chosen, on
which buildings it makes sense, whether its walls are bare. Nothing here imports a package before
its generators are asked for.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from cityx.errors import UsageError
from cityx.protocol.actions import CITY, F, action, encapsulation_of, hints_of
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.registry import BUILTIN, registry
from cityx.system.extensions import refuse, remembered

ANY = (0.0, float("inf"))
LONGEST_NAME = 32  # letters
Weight = float | Mapping[str, float]


@dataclass(frozen=True)
class Traits:
    """What a generator of another package says of itself; see `generator`."""

    styles: Mapping[str, Weight] = field(default_factory=lambda: MappingProxyType({}))
    bare: bool = False
    like: str = "mixed_use"
    area: tuple[float, float] = ANY
    levels: tuple[float, float] = ANY
    width: tuple[float, float] = ANY
    floors: tuple[int, int] = (2, 6)
    storey: float = 3.2
    use: str = "yes"
    title: str = ""


@dataclass(frozen=True)
class MeshAction:
    """An action of another package that makes the mesh of one building.

    Attributes
    ----------
    name
        Its word in commands, sentences and tables: "ziggurat".
    package
        Distribution it comes from.
    record, function, traits
        What it says of itself, and the function.
    """

    name: str
    package: str
    record: Encapsulation
    function: Callable[..., Any]
    traits: Traits

    @property
    def title(self) -> str:
        """Name for people."""
        return self.traits.title or self.name.replace("_", " ").capitalize()

    @property
    def words(self) -> tuple[str, ...]:
        """What a sentence may call such a building, singular."""
        return spoken(self.name, self.title, self.record.labels)


def generator(
    action_id: str,
    *,
    styles: Mapping[str, Weight] | None = None,
    bare: bool = False,
    like: str = "mixed_use",
    area: tuple[float, float] = ANY,
    levels: tuple[float, float] = ANY,
    width: tuple[float, float] = ANY,
    floors: tuple[int, int] = (2, 6),
    storey: float = 3.2,
    use: str = "yes",
    title: str = "",
    labels: Sequence[str] = (),
    limits: Sequence[str] = (),
) -> Callable[[F], F]:
    """Encapsulate a function ``Footprint -> MeshBatch`` as a generator of buildings.

    Parameters
    ----------
    action_id
        "building/name-vN".
    styles
        Style word, style family, region or "*" (every town) -> how likely it is chosen there; the
        weights of the built-in generators of a use add up to about 15. A weight by use
        (``{"modern": {"flats": 4}}``) holds for that use alone: house, flats, office, retail,
        industry, worship, civic, shed. Without any it is built where it is asked for.
    bare
        Whether its walls get no windows and doors.
    like
        Built-in generator whose windows, doors and frames its walls get.
    area, levels, width
        (least, greatest) footprint in square metres, storeys, and metres of the shorter side that
        it makes sense on.
    floors, storey
        (least, greatest) storeys, and metres of one, of a typical building.
    use
        Value of building=* that fits it.
    title
        Name for people; the name of the id when left out.
    labels
        Words that sentences may use for it, singular.
    limits
        Sentences on what it cannot do.

    Raises
    ------
    UsageError
        At import, as of `cityx.protocol.action`, or if a weight is no number of 0 or more.
    """
    traits = Traits(
        checked_styles(styles or {}, f"Action {action_id}"),
        bare, like, area, levels, width, floors, storey, use, title,
    )  # fmt: skip
    made = action(action_id, labels=labels, limits=limits or ("Its walls are as it makes them.",))

    def encapsulate(function: F) -> F:
        made(function).traits = traits  # type: ignore[attr-defined]
        return function

    return encapsulate


def checked_styles(styles: Mapping[str, Any], place: str) -> Mapping[str, Weight]:
    """Return the weights of a generator by style, as `generator` describes them.

    Raises
    ------
    UsageError
        If a weight is no number of 0 or more.
    """
    for word, weight in styles.items():
        numbers = weight.values() if isinstance(weight, Mapping) else (weight,)
        if not all(isinstance(n, int | float) and 0 <= n < float("inf") for n in numbers):
            raise UsageError(f'{place}: the weight of style "{word}" is no number >= 0.')
    folded = {word.strip().lower().replace(" ", "_"): weight for word, weight in styles.items()}
    return MappingProxyType(folded)


def spoken(name: str, title: str, labels: Sequence[str]) -> tuple[str, ...]:
    """Return what a sentence may call a kind of building, singular."""
    words = (name.replace("_", " "), title, *labels)
    return tuple(dict.fromkeys(word.lower() for word in words))


def mesh_action(function: Callable[..., Any], package: str = "") -> MeshAction:
    """Return an action for one building with what it says of itself.

    Raises
    ------
    UsageError
        If it is none.
    """
    record = encapsulation_of(function)
    if record.scope != "thing":
        raise UsageError(f"Action {record.id} does not make the mesh of one building.")
    if record.stage.value != "building":
        raise UsageError(f"Action {record.id} makes a building: its id must begin with building/.")
    if CITY in hints_of(function, record.id).values():
        raise UsageError(f"Action {record.id} makes one building and is given no city.")
    if len(record.name) > LONGEST_NAME:
        raise UsageError(f"Action {record.id}: its name has over {LONGEST_NAME} letters.")
    return MeshAction(record.name, package, record, function, getattr(function, "traits", Traits()))


@remembered
def mesh_actions() -> Mapping[str, MeshAction]:
    """Return the generators that installed packages bring, by name, the newest version of each."""
    actions = registry()
    for sentence in actions.refused:
        refuse(sentence)
    found: dict[str, MeshAction] = {}
    for action_id in sorted(actions.of_stage("building"), key=version_of):
        entry = actions.entries[action_id]
        if entry.package == BUILTIN or entry.generator:
            continue
        try:
            function = actions.function(action_id)
            if encapsulation_of(function).scope == "thing":
                made = mesh_action(function, entry.package)
                found[made.name] = made
        except UsageError as error:
            refuse(str(error))
    return MappingProxyType(dict(sorted(found.items())))


def version_of(action_id: str) -> tuple[str, int]:
    """Return the name and the number of the version that an id holds."""
    name, _, number = action_id.rpartition("-v")
    return name, int(re.sub(r"\D", "", number) or 0)
