"""Cleared ground: what is put "in their place" or "on the biggest gap" that a removal leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cityx.city import City
from cityx.ids import id_text
from cityx.language import Edit, Selector
from cityx.language.commands.earlier import GAP, NEW
from cityx.language.references.ranking import rank_values, ranked
from cityx.language.references.selecting import Open, choose


def on_cleared_ground(edits: Sequence[Edit], city: City) -> list[Edit]:
    """Return edits in which what comes to cleared ground replaces what stood there.

    Of several that are removed one is replaced, the largest or the smallest as it is said, and all
    where none is; the others are removed as before.
    What is put on ground that nothing is known to clear is asked about, with what would clear it.
    """
    found: list[Edit] = []
    for edit in edits:
        gap = next((one for one in edit.refs if one.key == GAP), None)
        at = next((k for k in range(len(found) - 1, -1, -1)
                   if found[k].verb == "remove" and found[k].target is not None), None)  # fmt: skip
        if gap is None or at is None or edit.verb not in NEW:
            found.append(edit)
            continue
        gone = found[at]
        assert gone.target is not None
        try:
            chosen = choose(gone.target, city)
        except Open:
            found.append(edit)  # what is open of the removal is asked of it
            continue
        value = rank_values(gap.side, chosen, None) if gap.side else None
        taken = chosen.ids
        if value is not None:
            thing, order = ranked(chosen, value)
            taken = chosen.ids[thing == order[0]]
        left = chosen.ids[~np.isin(chosen.ids, taken)]
        spot = _named(taken)
        change = tuple(pair for pair in edit.change if pair[0] != "count")
        found[at : at + 1] = [replace(gone, target=_named(left))] if len(left) else []
        found.append(replace(edit, verb="replace", target=spot, change=change))
    return found


def _named(ids: np.ndarray[tuple[int], np.dtype[np.uint64]]) -> Selector:
    return Selector(ids=tuple(id_text(int(one)) for one in np.sort(ids)))
