"""Palettes: several colours in turn among neighbours: "pink, yellow or mint", "pastel colours"."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from cityx.checks.predicates.thing_predicates import Selection
from cityx.city import City
from cityx.ids import id_text
from cityx.language import Edit, Selector
from cityx.language.brief import Value
from cityx.language.references.selecting import choose

PASTEL, COLOURFUL = "pastel", "colourful"
# Word for a range of colours -> those that are taken in turn where none are named.
RANGES = {
    PASTEL: ("pink", "yellow", "green", "light_blue", "turquoise", "purple"),
    COLOURFUL: ("red", "yellow", "blue", "green", "orange", "turquoise"),
}
TONE = "color.tone"  # key of a change: "pastel" is half white
NEIGHBOURS = 25.0  # metres between walls within which two of one colour are told as alike


def in_turn(edit: Edit, city: City) -> list[Edit]:
    """Return a change of the colour of several things as one for each colour, [] for any other.

    Neighbours get colours of their own as far as there are colours; all are used where there are
    as many things.

    Raises
    ------
    Open
        As of `choose`.
    """
    said = [str(value) for key, value in edit.change if key == "color"]
    ranges = [word for word in said if word in RANGES]
    colors = [word for word in dict.fromkeys(said) if word not in RANGES]
    if edit.verb != "set_color" or edit.target is None or edit.target.alone:
        return []
    if not ranges and len(colors) < 2:
        return []
    chosen = choose(edit.target, city)
    if len(chosen.ids) < 2:
        first = RANGES[ranges[0]][0] if ranges else ""
        change = tuple(("color", first) if key == "color" else (key, value)
                       for key, value in edit.change)  # fmt: skip
        return [replace(edit, change=change)] if ranges and not colors else []
    colors = colors or list(RANGES[ranges[0]])
    tone: tuple[tuple[str, Value], ...] = ((TONE, PASTEL),) if PASTEL in ranges else ()
    kept = tuple(pair for pair in edit.change if pair[0] != "color")
    which = _spread(chosen, len(colors))
    made = []
    for at, color in enumerate(colors):
        own = tuple(id_text(int(one)) for one in np.sort(chosen.ids[which == at]))
        if own:
            target = Selector(ids=own, but=edit.target.but)
            change = (*kept, ("color", color), *tone)
            made.append(replace(edit, target=target, change=change))
    return made


def _spread(chosen: Selection, number: int) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return (r,) which of so many colours each gets: least used beside it, then least used."""
    shapes = chosen.shapes
    near, other = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=NEIGHBOURS)
    order = np.argsort(near, kind="stable")
    begin = np.searchsorted(near[order], np.arange(len(shapes) + 1))
    other = other[order]
    found = np.full(len(shapes), -1, np.int64)
    total = np.zeros(number, np.int64)
    for row in np.argsort(chosen.ids, kind="stable").tolist():
        beside = found[other[begin[row] : begin[row + 1]]]
        count = np.bincount(beside[beside >= 0], minlength=number)
        best = int(np.lexsort((np.arange(number), total, count))[0])
        found[row] = best
        total[best] += 1
    return found


def softened(rgb: int) -> int:
    """Return a colour half way to white, 0xRRGGBB."""
    channels = [(rgb >> shift) & 0xFF for shift in (16, 8, 0)]
    red, green, blue = ((value + 0xFF) // 2 for value in channels)
    return red << 16 | green << 8 | blue
