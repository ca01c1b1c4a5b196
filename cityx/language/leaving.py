"""Leaving out: wishes of a request that cannot be carried out here, while others are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from cityx.language.brief import Brief, Edit, Left, Question, Wish
from cityx.language.commands.wishes import goes_with, held
from cityx.language.goals import goals_of

Reasons = Mapping[Edit, Sequence[Question]]  # change -> why it cannot be carried out


def without(brief: Brief, reasons: Reasons) -> Brief | None:
    """Return a brief without the wishes that cannot be carried out, None where none would be left.

    What goes with such a wish is left out too. Its goals are gone; what it protects stays.

    Parameters
    ----------
    reasons
        Of all changes that cannot be carried out.
    """
    needs = [wish.needs for wish in brief.wishes]
    failed = [
        at for at, wish in enumerate(brief.wishes) if any(edit in reasons for edit in wish.edits)
    ]
    out = held(needs, failed)
    if not failed or len(out) == len(brief.wishes):
        return None
    left = []
    for at in sorted(out):
        wish = brief.wishes[at]
        why = dict.fromkeys(one for edit in wish.edits for one in reasons.get(edit, ()))
        others = (brief.wishes[one].text for one in wish.needs if one in out)
        left.append(Left(wish.text, wish.span, tuple(why) or (goes_with(others),)))
    gone = {edit for at in out for edit in brief.wishes[at].edits}
    edits = tuple(edit for edit in brief.edits if edit not in gone)
    goals, _ = goals_of(brief.slots, brief.negated, brief.kept, edits)
    kept = [at for at in range(len(brief.wishes)) if at not in out]
    wishes = tuple(_renumbered(brief.wishes[at], kept) for at in kept)
    notes = tuple(one for one in brief.notes if one.code != "not_checkable"
                  or not any(lost.holds(one.span) for lost in left))  # fmt: skip
    return replace(
        brief, edits=edits, goals=goals, wishes=wishes, left=(*brief.left, *left), notes=notes
    )


def _renumbered(wish: Wish, kept: Sequence[int]) -> Wish:
    return replace(wish, needs=tuple(kept.index(at) for at in wish.needs if at in kept))
