"""That place: what "there" stands for, and edits that are put there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.brief import Edit, Question, Reference
from cityx.language.commands.gathered import Commands, Spot
from cityx.language.scan import Item
from cityx.language.scopes import READ

PLACES = ("in", "on", "along", "around", "near", "path")  # keys of a change that name a place
_OF_STREETS = ("set_surface", "set_speed", "set_lanes", "set_width", "raise_width", "scale_width")
_STREETS = ("road", "street", "avenue", "side_street")
LINED = ("road", "street", "avenue", "main_street", "side_street", "ring_road", "river", "canal")


def noted(commands: Commands, edits: list[Edit]) -> list[Edit]:
    """Note the place that edits speak of, which "there" is in the next command."""
    for edit in edits:
        target = edit.target
        named: list[Spot] = [(key, str(value)) for key, value in edit.change if key in PLACES]
        named += edit.refs if target is None else ()
        if target is not None and edit.verb != "move":
            told = (("in", target.inside), ("along", target.along), ("near", target.near))
            named = [(key, word) for key, word in told if word]
            named += target.where
            if named and target.alone and target.kind in _STREETS:  # and not what it leads along
                named = [Reference("along", (target,))]
            if not named and edit.verb != "remove" and (target.alone or len(target.ids) == 1):
                lined = target.kind in LINED or edit.verb in _OF_STREETS
                beside = "near" if target.ids else "in"
                named = [("along" if lined else beside, (*target.ids, target.kind)[0])]
        commands.place = named[-1] if named else commands.place
    return edits


def says_there(clause: Sequence[Item]) -> bool:
    """Return whether "there" is a place here: "put five benches there", not "there are"."""
    words = [None, *(one for one in clause if one.kind != "mark" and one.state != READ), None]
    return any(
        item is not None
        and item.text in _THERE
        and (after is None or (after.get("rel") != "be" and after.text not in ("s", "'s")))
        for item, after in pairwise(words[1:])
    )


_THERE = ("there", "in there", "over there", "on there")


def at_that_place(commands: Commands, edits: list[Edit]) -> list[Edit]:
    """Put the place that was named last for "there"; ask where none was."""
    found = []
    for edit in edits:
        target = edit.target
        placed = any(key in (*PLACES, "side") for key, _ in edit.change)
        if target is not None:
            placed = bool(target.ids or target.inside or target.along or target.near or target.side)
            placed |= bool(target.where)
        if placed or edit.verb == "unspecified":
            found.append(edit)
        elif not commands.place:
            commands.questions.append(Question('Where is "there"? Name the place.'))
            return [Edit("unspecified", span=edit.span)]
        else:
            found.append(_put(edit, commands.place))
    return found


def _put(edit: Edit, place: Spot) -> Edit:
    """Return a change at a place."""
    if isinstance(place, Reference):
        if edit.target is None:
            return replace(edit, refs=(*edit.refs, place))
        return replace(edit, target=replace(edit.target, where=(*edit.target.where, place)))
    relation, spot = place
    if edit.target is None:
        agent = edit.verb in ("add_agent", "add_traffic")
        return replace(edit, change=(*edit.change, ("path" if agent else relation, spot)))
    if relation == "along":
        return replace(edit, target=replace(edit.target, along=spot))
    if relation == "near":
        return replace(edit, target=replace(edit.target, near=spot))
    return replace(edit, target=replace(edit.target, inside=spot))
