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
from cityx.town.elements import ELEMENTS, PLACES, chosen_by, may_be_enclosed

RINGED = tuple(name for name in (*ELEMENTS, *PLACES) if may_be_enclosed(name))


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
    ids = _grounds(city, kind)
    if not len(ids):
        raise ActionFailed(f"There is no {kind.replace('_', ' ')} for a {barrier} to go round.")
    names = tuple(id_text(int(one)) for one in ids)
    return enclose(city, kind=barrier, near=names, height=height)


def _grounds(city: City, kind: str) -> UInt64Array:
    """Return the ids of the land of elements; of their buildings where they have none."""
    areas, element = city.layout.areas, ELEMENTS.get(kind)
    made = areas["source"].str.startswith(f"made/{kind}/").to_numpy(bool)
    if element is not None and made.any():
        return np.asarray(areas["id"].to_numpy(np.uint64)[made])
    if element is not None and element.is_thing:
        return np.zeros(0, np.uint64)
    chosen = things_of(chosen_by(kind), city)
    return np.asarray(chosen.layer.members(chosen.rows))
