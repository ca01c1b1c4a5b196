"""Fences, hedges and walls round all elements of a kind: their land, or their walls."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from cityx.checks.predicates.measuring import things_of
from cityx.city import City
from cityx.edit.land.enclose import KINDS, enclose
from cityx.errors import ActionFailed
from cityx.ids import UInt64Array, id_text
from cityx.protocol import Choice, Port, Range, action
from cityx.town.elements import ELEMENTS, Element

RINGED = tuple(name for name, element in ELEMENTS.items() if element.may_be_enclosed)


@action(
    "edit/ring-v1",
    limits=["Ways and houses interrupt it; it has a gate every 40 m."],
    requires=("layout",),
    after=(
        "nature/barriers-v1",
        "nature/furniture-v1",
        "nature/street_pieces-v1",
        "nature/parks-v1",
        "nature/gardens-v1",
    ),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("hedge", "fence", "wall", "surrounded", "enclosed", "round"),
)
def ring(
    city: City,
    *,
    kind: Annotated[str, Choice(*RINGED)],
    barrier: Annotated[str, Choice(*KINDS)],
    height: Annotated[float | None, Range(0.3, 4.0)] = None,
) -> City:
    """Put a hedge, a fence or a wall round every element of a kind.

    Parameters
    ----------
    city
        City with its ground.
    kind
        What is enclosed.
    barrier
        What goes round it.
    height
        Metres; usual for the barrier when left out.
    """
    ids = _grounds(city, ELEMENTS[kind])
    if not len(ids):
        raise ActionFailed(f"There is no {kind.replace('_', ' ')} for a {barrier} to go round.")
    names = tuple(id_text(int(one)) for one in ids)
    return enclose(city, kind=barrier, near=names, height=height)


def _grounds(city: City, element: Element) -> UInt64Array:
    """Return the ids of the land of elements; of their buildings where they have none."""
    areas = city.layout.areas
    made = areas["source"].str.startswith(f"made/{element.name}/").to_numpy(bool)
    if made.any():
        return np.asarray(areas["id"].to_numpy(np.uint64)[made])
    if element.is_thing:
        return np.zeros(0, np.uint64)
    chosen = things_of(element.measure, city)
    return np.asarray(chosen.layer.members(chosen.rows))
