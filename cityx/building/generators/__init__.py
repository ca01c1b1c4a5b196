"""Building generators: code grows the volumes, tables in `cityx/data/generators` hold the looks.

A generator is a module with a function `masses` and a TOML table of the same name. It is named in
`cityx/building/catalogue.py` and gets its weights in `cityx/data/styles.toml`.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

from cityx.assets.styles import palette_tables
from cityx.assets.styles.generators import Generator
from cityx.city.city import City
from cityx.errors import InputError, nearest
from cityx.protocol import ObjectName, Range, action
from cityx.protocol.docstrings import parse_docstring
from cityx.system.tables import DATA, filled, read_table

if TYPE_CHECKING:
    from cityx.building.massing.massing import Mass

Masses = Callable[..., "Sequence[Mass]"]
TABLES = DATA / "generators"
SIZED = "Only footprints of a size that admits such a building change."
_TEXTS = {
    "share": "Share of the buildings that become one.",
    "floors": "Storeys, 0 to keep those of each building.",
    "building": "The one building to change, or None for all.",
    "noise": "How far measures vary; 0 is regular.",
}
_REFERENCE = re.compile(r"\$(\w+)(?:\[(\d*):(\d*)\])?")


def generator(masses: Masses, *, table: Path | None = None, **fixed: float) -> Generator:
    """Make the generator of a module from its table.

    Parameters
    ----------
    masses
        Grows the volumes on a `Plot`.
    table
        Its looks, measures and words; by default the file of ``cityx/data/generators`` that has
        the name of the module.
    fixed
        Arguments of `masses` in designed towns; the action uses the defaults of `masses`.

    Raises
    ------
    InputError
        If the table has an unknown key or name, or a value of another type.
    """
    name = masses.__module__.rpartition(".")[2]
    path = table or TABLES / f"{name}.toml"
    held = read_table(path)
    shared = held.pop("shared", {})
    for key in shared:
        shared[key] = _referred(shared[key], shared, f"{path.name}, shared.{key}")
    held = _referred(held, shared, path.name)
    known: dict[str, dict[str, Any]] = {}
    zones = held.pop("zones", {})
    for key, look in {"look": held.pop("look", {}), **zones}.items():
        known[key] = _inherited(look, known, f"{path.name}, {key}")
    made = {"name": name, "look": known.pop("look"), "zones": known, **held}
    mass = partial(masses, **fixed) if fixed else masses
    return replace(filled(Generator, made, path.name), mass=mass)


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


def action_of(action_id: str, made: Generator, masses: Masses) -> Callable[..., City]:
    """Make the action that turns buildings of a city into those of a generator.

    Its inputs are those of `masses` that the docstring describes, between share, floors and
    building, and noise; its description is the first line of that docstring.

    Parameters
    ----------
    action_id
        "building/name-vN".
    made
        With the words by which the action is found.
    masses
        Grows the volumes; the docstring tells what is built.
    """
    from cityx.building.design import redesign

    doc = parse_docstring(masses.__doc__)
    own = [p for p in inspect.signature(masses).parameters.values() if p.name in doc.parameters]
    hints = get_type_hints(masses, include_extras=True)
    unit = Annotated[float, Range(0.0, 1.0)]
    default, most = made.asked or (0, made.levels[1])
    common: dict[str, tuple[Any, Any]] = {"share": (unit, 1.0)}
    if most < float("inf"):
        common["floors"] = (Annotated[int, Range(0, int(most))], default)
    common["building"] = (Annotated[str | None, ObjectName()], None)
    inputs = common | {p.name: (hints[p.name], p.default) for p in own} | {"noise": (unit, 0.5)}

    def build(city: City, **arguments: Any) -> City:
        given = {name: usual for name, (_, usual) in inputs.items()} | arguments
        mass = partial(masses, **{p.name: given.pop(p.name) for p in own})
        return redesign(city, made, mass=mass, **given)

    keyword = inspect.Parameter.KEYWORD_ONLY
    build.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter("city", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=City)]
        + [
            inspect.Parameter(name, keyword, default=usual, annotation=hint)
            for name, (hint, usual) in inputs.items()
        ],
        return_annotation=City,
    )
    build.__annotations__ = {"city": City, "return": City} | {k: v[0] for k, v in inputs.items()}
    build.__name__ = build.__qualname__ = action_id.partition("/")[2].rpartition("-v")[0]
    build.__module__ = masses.__module__
    texts = {**_TEXTS, **doc.parameters, **made.texts}
    rows = "\n".join(f"{name}\n    {texts[name]}" for name in inputs)
    build.__doc__ = f"{doc.summary}\n\n{doc.details}\n\nParameters\n----------\n{rows}\n"
    return action(
        action_id, limits=[SIZED, *made.limits], requires=("layout",), labels=made.labels
    )(build)
