"""Kinds of people: how children, runners and wheelchair users look, and what part of a crowd is."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.people.gear import PRAM, WHEELCHAIR
from cityx.assets.vehicles.movers import HI_VIS, UNIFORM, WORN, person_look, person_of
from cityx.city.tracks import GAIT
from cityx.geometry.arrays import IntArray
from cityx.ids import hash_ids

WEARS = tuple(WORN)
RUNNER = "runner"
# Kind -> what is told of the look of each.
KINDS: Mapping[str, Mapping[str, Any]] = MappingProxyType({
    "man": {"sex": "male", "age": "adult"}, "woman": {"sex": "female", "age": "adult"},
    "child": {"age": "child"}, "elder": {"age": "elder"},
    RUNNER: {"style": "sport", "jogs": True, "age": "adult"},
    WHEELCHAIR: {"gear": WHEELCHAIR}, PRAM: {"gear": PRAM, "age": "adult"},
    # Who helps others over the road or works on it, and who watches over a place.
    "steward": {"age": "adult", "wears": HI_VIS}, "officer": {"age": "adult", "wears": UNIFORM},
})  # fmt: skip
SHARED = ("child", "elder", WHEELCHAIR, PRAM, RUNNER)  # of which a crowd can have a part
TRIES = 20  # other people that are looked at until one is of no kind that has a part of its own


def parts_of(ids: NDArray[np.uint64], shares: Mapping[str, float], seed: int) -> NDArray[np.str_]:
    """Draw who of a crowd is of which kind.

    Parameters
    ----------
    ids
        (n,) of the people.
    shares
        Kind -> its part of them; together at most 1.
    seed
        Key of the draws.

    Returns
    -------
    kinds
        (n,) words of `SHARED`, "" for who is of none; as many of each as its part of n, rounded.
    """
    kinds = np.full(len(ids), "", "<U12")
    order = np.argsort(hash_ids(seed, "people/kind", ids), kind="stable")
    told = 0.0
    for kind, share in shares.items():
        first, last = round(told * len(ids)), round((told + share) * len(ids))
        kinds[order[first:last]] = kind
        told += share
    return kinds


def looks_of_kinds(
    number: IntArray, kinds: NDArray[np.str_], *, wears: str = "", apart: tuple[str, ...] = ()
) -> NDArray[np.str_]:
    """Return how people of some kinds look.

    Parameters
    ----------
    number
        (n,) of each, of those that differ.
    kinds
        (n,) words of `KINDS`, "" for anybody.
    wears
        What all have on, of `WEARS`, "" for whatever they like.
    apart
        Kinds that are told by age and of which nobody else is to be.
    """
    ages = {str(KINDS[kind]["age"]) for kind in apart if "age" in KINDS[kind]}
    found = []
    for row, kind in zip(number.tolist(), kinds.tolist(), strict=True):
        own = {"wears": wears, **KINDS.get(kind, {})}
        look = person_look(row, **own)
        if "age" not in own:
            tries = (person_look(row + 1000 * more, **own) for more in range(TRIES))
            look = next((one for one in tries if person_of(one).age not in ages), look)
        found.append(look)
    return np.array(found or [""])[: len(number)]


def gaits_of(looks: NDArray[np.str_], gait: NDArray[np.uint8] | int) -> NDArray[np.uint8]:
    """(n,) gaits of people, in a wheelchair and with a pram whatever the others do."""
    found = np.broadcast_to(np.asarray(gait, np.uint8), len(looks)).copy()
    for gear, own in ((WHEELCHAIR, "sit"), (PRAM, "push")):
        found[np.char.find(looks, f"_{gear}_") >= 0] = GAIT[own]
    return found
