"""Storeys of buildings."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from cityx.city.city import City
from cityx.edit.amounts import changed_amounts
from cityx.edit.buildings.designing import Wish, levels_of, redesigned
from cityx.edit.targets import buildings_named
from cityx.errors import ActionFailed
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.serving import Serves

FEWEST, MOST = 1, 200
Floors = Annotated[int | None, Range(FEWEST, MOST)]


@action(
    "edit/set_floors-v1",
    limits=["Storeys keep their height; another kind of building where the old has no such."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("floors", "storeys", "levels", "stories"),
    serves=tuple(
        Serves(f"edit={verb}", "family=building")
        for verb in ("set_floors", "raise_floors", "scale_floors")
    ),
    binds={
        "objects": "objects", "floors": "floors", "least": "floors.min", "most": "floors.max",
        "by": "by", "factor": "factor",
    },
)  # fmt: skip
def set_floors(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    floors: Floors = None,
    least: Floors = None,
    most: Floors = None,
    by: Annotated[int, Range(-MOST, MOST)] = 0,
    factor: Annotated[float, Range(0.05, 20.0)] = 1.0,
) -> City:
    """Give buildings more or fewer storeys.

    Parameters
    ----------
    city
        The city.
    objects
        The buildings.
    floors
        Storeys above ground, for all of them; their own when left out.
    least, most
        Storeys that none is below or above.
    by
        Storeys that are put on each, negative to take them off.
    factor
        Of the storeys of each.
    """
    ids = buildings_named(city, objects)
    now = levels_of(city, ids)
    whole = np.round(now * factor)
    wanted = changed_amounts(whole, floors, factor=1.0, by=by, least=least, most=most)
    if (wanted < FEWEST).any() or (wanted > MOST).any():
        worst = wanted[np.argmax(np.abs(wanted))]
        raise ActionFailed(
            f"A building of {worst:.0f} storeys is not built; {FEWEST} to {MOST} are."
        )
    return redesigned(city, ids, Wish(floors=np.asarray(wanted, np.int64)))
