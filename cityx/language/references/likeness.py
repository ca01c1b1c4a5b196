"""Likeness: what a change takes over from other objects: their colour, their height."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cityx.checks.predicates.thing_predicates import CannotTell, Selection
from cityx.checks.predicates.vocabulary import known_words
from cityx.city import City
from cityx.geometry.turns import SIDES
from cityx.ids import id_text
from cityx.language import Edit, Reference, Selector
from cityx.language.brief import Value
from cityx.language.measurable import COLORS, MATERIALS
from cityx.language.references.palette import in_turn
from cityx.language.references.selecting import Open, choose

NUMBERS = ("height", "floors", "width", "lanes", "length")
LOOKS = ("color", "material", "style", "roof")
_SHAPES = {"roof": "roof_shape"}  # what is measured of a look
_SAID = {"color": COLORS, "material": MATERIALS}  # words of predicates by those of sentences


def taken_over(edit: Edit, city: City) -> Edit:
    """Return an edit with what it takes over from other objects as values of its own.

    Raises
    ------
    Open
        If the other object is not there, or has no such measure or look.
    """
    found: list[tuple[str, Value]] = []
    places: list[Reference] = []
    for one in edit.refs:
        if one.key in (*NUMBERS, *LOOKS):
            found.append((one.key, _value(one, city)))
        else:
            places.append(one)
    if not found:
        return edit
    return replace(edit, change=(*edit.change, *found), refs=tuple(places))


MOST = 200  # objects each of which is compared with its own neighbours


def each_taken_over(edit: Edit, city: City) -> list[Edit]:
    """Return an edit once, or for each of its objects where each has another to be like.

    Raises
    ------
    Open
        As of `taken_over`, or if the objects are too many.
    """
    target = edit.target
    if target is not None and edit.verb == "set_direction":
        return _headed(edit, target, city)
    if turns := in_turn(edit, city):
        return turns
    if target is None or not any(_beside_itself(one, target) for one in edit.refs):
        return [taken_over(edit, city)]
    chosen = choose(target, city)
    if len(chosen.ids) > MOST:
        raise Open(f"{len(chosen.ids)} objects are too many to compare with their neighbours.")
    found = []
    for number in chosen.ids.tolist():
        own = Selector(ids=(id_text(int(number)),))
        refs = [_of_one(one, target, own) for one in edit.refs]
        found.append(taken_over(replace(edit, target=own, refs=tuple(refs)), city))
    return found


def _headed(edit: Edit, target: Selector, city: City) -> list[Edit]:
    """Return a change of direction told by the compass, by which way each street is drawn.

    A street that leads as much to one side as to the other is asked about.
    """
    side = str(dict(edit.change).get("direction", ""))
    if side not in SIDES:
        return [edit]
    chosen = choose(target, city)
    found = []
    for number, line in zip(chosen.ids.tolist(), chosen.shapes.tolist(), strict=True):
        ends = np.array([line.coords[0][:2], line.coords[-1][:2]])
        way = ends[1] - ends[0]
        ahead = float(way @ np.array(SIDES[side])) / max(float(np.hypot(*way)), 1e-9)
        if abs(ahead) < ALONG:
            name = chosen.where(chosen.ids == number).examples(1)
            raise Open(f"{name} does not lead {side}; which way is it to be driven?")
        word = "along" if ahead > 0 else "against"
        own = Selector(ids=(id_text(int(number)),))
        found.append(replace(edit, target=own, change=(("direction", word),)))
    return found


ALONG = 0.5  # of a street's way to a side, the least by which it leads there


def _beside_itself(one: Reference, target: Selector) -> bool:
    near = [inner for spot in one.spots for inner in spot.where if inner.key == "near"]
    meant = replace(target, alone=False)
    return one.key in (*NUMBERS, *LOOKS) and any(inner.spots == (meant,) for inner in near)


def _of_one(one: Reference, target: Selector, own: Selector) -> Reference:
    """Return a reference to the neighbours of all as one to those of a single object."""
    if not _beside_itself(one, target):
        return one
    spots = [
        replace(spot, where=tuple(replace(inner, spots=(own,)) for inner in spot.where),
                but=(own,)) for spot in one.spots
    ]  # fmt: skip
    return replace(one, spots=tuple(spots))


def _value(one: Reference, city: City) -> Value:
    other = choose(one.spots[0], city)
    try:
        if one.key in NUMBERS:
            return _number(one, other)
        return _word(one.key, other)
    except CannotTell as error:
        raise Open(f"It cannot be told what {one.key} {other.examples()} has: {error}.") from error


def _number(one: Reference, other: Selection) -> float | int:
    """Return a measure of the other, of several the greatest or the least, and so much more."""
    values = other.layer.number(one.key)[other.rows]
    values = values[np.isfinite(values)]
    if not len(values):
        raise Open(f"{other.examples()} has no {one.key}.")
    value = float(values.min() if one.amount < 0 else values.max()) + one.amount
    if value <= 0:
        raise Open(f"{-one.amount:g} less than the {one.key} of {other.examples()} leaves none.")
    return round(value) if one.key in ("floors", "lanes") else round(value, 3)


def _word(key: str, other: Selection) -> str:
    """Return the look that most of the others have, in the words of sentences."""
    name = _SHAPES.get(key, key)
    counts = {
        word: int(other.layer.has(name, word)[other.rows].sum())
        for word in known_words("building", name)
    }
    best = max(counts, key=lambda word: counts[word], default="")
    if not best or not counts[best]:
        raise Open(f"The {key} of {other.examples()} is none that has a word; name it.")
    said = _SAID.get(key, {})
    return next((word for word, measured in said.items() if measured == best), best)
