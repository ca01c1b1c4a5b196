"""Fences, hedges and walls round all elements of a kind: their land, or their walls."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.measuring import things_of
from cityx.city import City
from cityx.edit.land.enclose import AROUND, GATE, KINDS, PAVED, SHORTEST, interrupted, put_up
from cityx.errors import ActionFailed
from cityx.ids import UInt64Array
from cityx.protocol import Choice, Port, Range, action
from cityx.town.elements import ELEMENTS, PLACES, chosen_by, may_be_enclosed

# What lies between a lot and the walk is no way.
HARD = tuple(label for label in PAVED if label not in ("frontage", "edging"))
# Metres outside of land, or inside where negative, of what goes round it; the longest first.
AWAY = (-0.8, 0.5, 0.8, 1.6)
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
    shapes, ids = _grounds(city, kind)
    word = kind.replace("_", " ")
    if not len(shapes):
        raise ActionFailed(f"There is no {word} for a {barrier} to go round.")
    found = [_round(city, shape, ids) for shape in shapes.tolist()]
    lines = np.concatenate(found)
    if not len(lines):
        raise ActionFailed(f"No {barrier} finds room round the {word}.")
    return put_up(city, barrier, lines, height)


def _round(city: City, shape: Any, ids: UInt64Array) -> NDArray[Any]:
    """Return the lines that go round a shape: the longest, and others where that has gaps."""
    tried = sorted(
        (interrupted(city, _rings(shape, away), ids, paved=HARD) for away in AWAY), key=_metres
    )
    found = tried.pop()
    for lines in reversed(tried):
        near = shapely.buffer(shapely.union_all(found), GATE)
        more = shapely.get_parts(shapely.difference(lines, near))
        found = np.concatenate([found, more[shapely.length(more) >= SHORTEST]])
    return found


def _rings(shape: Any, away: float) -> NDArray[Any]:
    """Return the rings so far outside of a shape, or inside of it where negative."""
    parts = shapely.get_parts(shapely.buffer(shape, away, join_style="mitre"))
    return np.asarray(shapely.get_exterior_ring(parts[~shapely.is_empty(parts)]))


def _metres(lines: NDArray[Any]) -> float:
    return round(float(shapely.length(lines).sum()), 2)


def _grounds(city: City, kind: str) -> tuple[NDArray[Any], UInt64Array]:
    """Return the land of elements as one shape each, or their buildings; and the ids of these."""
    areas, element = city.layout.areas, ELEMENTS.get(kind)
    source = areas["source"].to_numpy(str)
    made = np.char.startswith(source, f"made/{kind}/")
    if element is not None and made.any():
        number = np.array([one.split("/")[2] for one in source[made].tolist()])
        shapes = areas.geometry.to_numpy()[made]
        whole = [shapely.union_all(shapes[number == one]) for one in np.unique(number)]
        return np.array(whole, object), areas["id"].to_numpy(np.uint64)[made]
    if element is not None and element.is_thing:
        return np.zeros(0, object), np.zeros(0, np.uint64)
    chosen = things_of(chosen_by(kind), city)
    shapes = chosen.grounds
    built = element is not None and bool(element.building)
    grown = shapely.buffer(shapes, AROUND, join_style="mitre") if built else shapes
    return np.asarray(grown, object), np.asarray(chosen.layer.members(chosen.rows), np.uint64)
