"""Ranking: which things come first by height, size, length or how busy they are."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.thing_predicates import CannotTell, Selection
from cityx.checks.predicates.vocabulary import KINDS
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.turns import SIDES

DISTANCES = ("nearest", "farthest")  # ranks by how far things are from something else
# Rank -> what is measured, and whether the greatest come first.
_RANKS: Mapping[str, tuple[str, bool]] = MappingProxyType(
    {
        "tallest": ("height", True), "lowest": ("height", False), "largest": ("size", True),
        "smallest": ("size", False), "longest": ("length", True), "busiest": ("flow", True),
        "quietest": ("flow", False),
    }
)  # fmt: skip
_MOST = {f"{side}ernmost": side for side in ("north", "east", "south", "west")}
# Family of things -> the attribute that says how large one is.
_SIZES = {"building": "area", "land": "area", "road": "width", "bridge": "length"}
_UNITS = {"height": "m high", "area": "m2", "width": "m wide", "length": "m long"}
_CLASS = 1000.0  # by which a class of streets counts before lanes
_LANE = 100.0


def is_rank(word: str) -> bool:
    """Return whether a word ranks things by a measure of their own."""
    return word in _RANKS or word in _MOST


def rank_values(rank: str, chosen: Selection, away: FloatArray | None) -> FloatArray | None:
    """Return (r,) numbers of which the least come first, None where nothing measures the rank.

    Parameters
    ----------
    away
        (r,) metres to what things are near to or far from, for a rank by distance.
    """
    if rank in _MOST:
        at = shapely.get_coordinates(shapely.centroid(chosen.shapes))
        return np.asarray(-at @ np.array(SIDES[_MOST[rank]]))
    if rank in DISTANCES:
        assert away is not None
        return away if rank == "nearest" else -away
    if rank not in _RANKS:
        return None
    attribute, greatest = _RANKS[rank]
    value = _measured(_attribute(attribute, chosen), chosen)
    if value is None:
        return None
    return -value if greatest else value


def _attribute(attribute: str, chosen: Selection) -> str:
    return _SIZES.get(KINDS[chosen.layer.kind], "height") if attribute == "size" else attribute


def _measured(attribute: str, chosen: Selection) -> FloatArray | None:
    """Return (r,) an attribute of things; of a street the length of all that has its name."""
    if attribute == "flow":
        return _flow(chosen)
    value = np.asarray(chosen.layer.number(attribute)[chosen.rows], float)
    if attribute == "length" and KINDS[chosen.layer.kind] == "road":
        street = streets_of(chosen)
        value = np.bincount(street, value)[street].astype(float)
    return value


def _flow(chosen: Selection) -> FloatArray | None:
    """Return (r,) how much a street is for through traffic: its class, its lanes, its length.

    A city that stands has no counts of traffic; of anything but streets nothing tells it.
    """
    if KINDS[chosen.layer.kind] != "road" or chosen.layer.kind == "railway":
        return None
    kinds = chosen.layer.city.layout.roads.set_index("id")["kind"]
    own = kinds.loc[chosen.ids].to_numpy()
    order = {word: len(words.ROADS) - at for at, word in enumerate(words.ROADS)}
    rank = np.array([order.get(str(word), 0) for word in own], float)
    lanes = chosen.layer.number("lanes")[chosen.rows]
    length = _measured("length", chosen)
    assert length is not None
    flow = _CLASS * rank + _LANE * np.nan_to_num(lanes) + length / np.max([*length, 1.0])
    street = streets_of(chosen)
    best = np.full(street.max(initial=-1) + 1, -np.inf)
    np.maximum.at(best, street, flow)
    return np.asarray(best[street])


def streets_of(chosen: Selection) -> IntArray:
    """Return (r,) the number of the street that each way is of: all that has one name.

    Of ways without a name those that go on into each other are one.
    """
    unit = np.asarray(chosen.layer.units(chosen.rows), np.int64)
    names = chosen.layer.names.get("name")
    if names is None:
        return unit
    own = names[chosen.rows].astype(str)
    keys = [name or f"\n{number}" for name, number in zip(own, unit, strict=True)]
    return np.asarray(np.unique(keys, return_inverse=True)[1].reshape(-1), np.int64)


def ranked(chosen: Selection, value: FloatArray) -> tuple[IntArray, NDArray[np.int64]]:
    """Return (r,) the number of the thing that each row is of, and the things in order.

    Those of equal measure come by their ids.
    """
    road = KINDS[chosen.layer.kind] == "road"
    thing = streets_of(chosen) if road else np.arange(len(chosen.rows))
    order = np.lexsort((chosen.ids, np.round(value, 6)))
    _, first = np.unique(thing[order], return_index=True)
    return thing, np.asarray(thing[order][np.sort(first)])


# Family of things -> the attributes that tell how large one is.
_TOLD = {"building": ("height", "floors"), "land": ("area",), "road": ("length", "width"),
         "bridge": ("length",)}  # fmt: skip


def sizes_of(chosen: Selection) -> list[str]:
    """Return how large each of some things is, in words: "51 m high, 14 floors", "" for none."""
    found = [""] * len(chosen.rows)
    for attribute in _TOLD.get(KINDS[chosen.layer.kind], ()):
        try:
            value = _measured(attribute, chosen)
        except CannotTell:
            continue
        unit = _UNITS.get(attribute, attribute)
        for at, one in enumerate([] if value is None else np.asarray(value, float).tolist()):
            if np.isfinite(one):
                found[at] += f"{', ' if found[at] else ''}{one:.4g} {unit}"
    return found


def measure_of(rank: str, chosen: Selection) -> str:
    """Say how tall, large or long things of a rank are, or by what else it is told."""
    if rank in _MOST:
        return f"no other lies as far {_MOST[rank]}"
    if rank in DISTANCES:
        return f"no other is {rank.replace('est', 'er')}"
    attribute = _attribute(_RANKS[rank][0], chosen) if rank in _RANKS else "length"
    if attribute == "flow":
        return "told by class, lanes and length, as no traffic has been counted"
    value = _measured(attribute, chosen)
    assert value is not None
    least, most = float(np.min(value)), float(np.max(value))
    told = f"{most:.4g}" if most - least < 0.05 * max(most, 1.0) else f"{least:.4g} to {most:.4g}"
    return f"{told} {_UNITS.get(attribute, attribute)}"
