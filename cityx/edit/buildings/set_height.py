"""Heights of buildings."""

from __future__ import annotations

from math import inf
from typing import Annotated

from cityx.city.bounds import kept_clear
from cityx.city.city import City
from cityx.edit.amounts import changed_amounts
from cityx.edit.buildings.designing import Wish, heights_of, redesigned
from cityx.edit.targets import buildings_named
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.serving import Serves

Metres = Annotated[float | None, Range(2.2, 1000.0)]


@action(
    "edit/set_height-v1",
    limits=[
        "Storeys keep their height, their number follows; parapets and crowns count.",
        "Neighbours stay as they are, also where a higher wall covers their windows.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("height", "taller", "higher", "lower", "raise", "double"),
    serves=tuple(
        Serves(f"edit={verb}", "family=building")
        for verb in ("set_height", "raise_height", "scale_height")
    ),
    binds={
        "objects": "objects", "height": "height", "least": "height.min", "most": "height.max",
        "by": "by", "factor": "factor",
    },
)  # fmt: skip
def set_height(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    height: Metres = None,
    least: Metres = None,
    most: Metres = None,
    by: Annotated[float, Range(-1000.0, 1000.0)] = 0.0,
    factor: Annotated[float, Range(0.05, 20.0)] = 1.0,
) -> City:
    """Make buildings higher or lower.

    Parameters
    ----------
    city
        The city.
    objects
        The buildings.
    height
        Metres from the ground to the top, for all of them; their own when left out.
    least, most
        Metres that none is below or above.
    by
        Metres by which each rises, negative to lower it.
    factor
        Of the height of each.
    """
    ids = buildings_named(city, objects)
    now = heights_of(city, ids)
    low, high = kept_clear(-inf if least is None else least, inf if most is None else most)
    wanted = changed_amounts(now, height, factor=factor, by=by, least=low, most=high)
    return redesigned(city, ids, Wish(height=wanted))
