"""Building generators: code grows the volumes, tables in `cityx/data/generators` hold the looks.

A generator is a module with a function `masses` and a TOML table of the same name. It is named in
`cityx/building/catalogue.py` and gets its weights in `cityx/data/styles.toml`.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

from cityx.assets.styles.generator_tables import read_generator
from cityx.assets.styles.generators import Generator
from cityx.city.city import City
from cityx.protocol import ObjectName, Range, action
from cityx.protocol.docstrings import parse_docstring
from cityx.system.tables import DATA

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
    mass = partial(masses, **fixed) if fixed else masses
    return replace(read_generator(name, table or TABLES / f"{name}.toml"), mass=mass)


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
