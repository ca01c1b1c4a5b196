"""Goals here: what a change is measured by once it is known which objects it means."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from cityx.edit.land.cleared_land import GROWS
from cityx.language.brief import Brief, Edit, GoalText, Note, Selector
from cityx.language.goals import OTHERS, edit_predicates, target_predicates
from cityx.language.measurable import things
from cityx.protocol.serving import Slots
from cityx.town.elements import ELEMENTS

BESIDES = "same(others, beyond=30)"
KIND = "goal.kind"  # slot: kind of the objects of a change, in the language of predicates
_FORMS = ("before", "behind", "opposite", "around")
CROSSING = "crosswalk"
MAIN_STREET = "main_street"
NEAR = 60.0  # metres within which what was put near something stands


def with_goals_here(brief: Brief, changes: Sequence[tuple[Edit, Slots]]) -> Brief:
    """Add to a brief what measures the changes whose words alone no predicate says.

    Parameters
    ----------
    brief
        As it was read.
    changes
        Each with what it is in a city, as of `slots_of_edits`.
    """
    goals: list[GoalText] = []
    known: set[tuple[int, int]] = set()
    meant = [edit for edit, _ in changes]
    # Which street is the main street depends on the place, and some changes become several.
    vague = [
        one
        for one in brief.edits
        if one.target is not None
        and (one not in meant or one.target.kind == MAIN_STREET or _is_of_the_rest(one))
    ]
    dropped = {predicate for one in vague for predicate in edit_predicates(one)}
    unmeasured = False
    for edit, slots in changes:
        text = " ".join(f"{key}={value}" for key, value in edit.items())
        own = [*_placed(edit)]
        told = {goal.predicate for goal in brief.goals}
        by_name = edit in brief.edits and edit not in vague
        by_name = by_name and any(one in told for one in edit_predicates(edit))
        if edit.target is not None and not by_name:
            own += [*_by_ids(edit, slots)]
            known |= {edit.span} if own else set()
            unmeasured |= not own
        goals += [GoalText(text, one, span=edit.span) for one in own]
    notes = tuple(note for note in brief.notes if not _is_settled(note, known))
    kept = tuple(goal for goal in brief.goals if goal.predicate not in dropped)
    if unmeasured:  # what it changes would count as what nobody asked for
        kept = tuple(goal for goal in kept if goal.predicate != OTHERS)
    brief = replace(brief, goals=kept)
    if not goals and notes == brief.notes:
        return brief
    if any(_moves_ground(edit, slots) for edit, slots in changes):
        rest = [replace(one, predicate=BESIDES) if one.predicate == OTHERS else one
                for one in brief.goals]  # fmt: skip
        brief = replace(brief, goals=tuple(rest))
    held = {goal.predicate: goal for goal in (*goals, *brief.goals)}
    return replace(brief, goals=tuple(held.values()), notes=notes)


def _is_of_the_rest(edit: Edit) -> bool:
    """Return whether a change is of a share of what another leaves: "a third red, a third blue"."""
    return edit.target is not None and edit.target.share is not None and bool(edit.target.but)


def _moves_ground(edit: Edit, slots: Slots) -> bool:
    """Return whether land is laid out otherwise, so that what lies beside it follows."""
    if edit.verb == "move" and slots.get("family") == ("land",):
        return True
    if slots.get("family") == ("road",):
        return edit.verb != "set_speed"
    change = dict(edit.change)
    new = str(change.get("element") or change.get("building.type") or "")
    laid_out = new in ELEMENTS or new in GROWS or new == CROSSING
    return edit.verb in ("add", "add_building", "replace") and laid_out


def _is_settled(note: Note, known: set[tuple[int, int]]) -> bool:
    return note.code == "not_checkable" and note.span in known


def _by_ids(edit: Edit, slots: Slots) -> Iterator[str]:
    kinds, objects = slots.get(KIND, ()), slots.get("objects", ())
    if not kinds or not objects or edit.target is None:
        return
    chosen = f'{kinds[0]}, id="{" ".join(objects[0])}"'
    laid = slots.get("element", ())
    if edit.verb == "replace" and laid:
        yield f"n({chosen}) == 0"
        if new := things(str(laid[0])):
            yield f"gained({new}) >= 1"
        return
    species = dict(edit.change).get("species")
    if edit.verb == "replace" and species is not None:
        yield f"n({chosen}, species={species}) == {len(objects[0])}"
        return
    plain = Selector(edit.target.kind)
    for one in target_predicates(replace(edit, target=plain), chosen):
        yield _of_every(one, len(objects[0]))


def _of_every(predicate: str, count: int) -> str:
    """Return a share of named things as their number: of words that narrow, shares are of all."""
    inner = predicate.removeprefix("share(").removesuffix(") == 1.0")
    whole = predicate.startswith("share(") and predicate.endswith(") == 1.0")
    return f"n({inner}) == {count}" if whole else predicate


def _placed(edit: Edit) -> Iterator[str]:
    """Yield how something new stands to other objects."""
    change = dict(edit.change)
    own = things(str(change.get("element") or change.get("building.type") or ""))
    own = "tree" if edit.verb == "plant" else own
    if edit.target is not None or not own:
        return
    for one in edit.refs:
        others = [_kind(spot) for spot in one.spots]
        if not others or not all(others):
            continue
        if one.key == "between":
            yield f"between({own}, {others[0]}, {others[1]})"
        elif one.key in _FORMS:
            yield f"{one.key}({own}, {others[0]})"
        elif one.key == "near":
            yield f"dist({own}, {others[0]}) <= {one.amount or NEAR:g}"
        elif one.key in ("in", "on", "to") and not one.side:
            yield f"dist({own}, {others[0]}) <= 0.5"


def _kind(spot: Selector) -> str:
    """Return the kind of a place in the language of predicates, "" where more tells it."""
    if spot.ids:
        return f'"{spot.ids[0]}"' if len(spot.ids) == 1 else ""
    told = spot.filters or spot.where or spot.but or spot.near or spot.inside or spot.along
    if told or spot.side or spot.nth:
        return ""
    kind = things(spot.kind)
    if spot.rank == "tallest" and kind.startswith("building"):
        return f"top({kind}, height, 1)"
    return "" if spot.rank or spot.k else kind
