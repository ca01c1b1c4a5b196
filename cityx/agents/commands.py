"""Commands: one change of a city in words, read as one of a user, and the actions that serve it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from cityx.agents.planning.planner import OfflinePlanner, untaken
from cityx.agents.planning.workflow import Item
from cityx.city import City
from cityx.language import Brief, Edit, Slot, read_brief
from cityx.language.brief import Clarify
from cityx.language.implied_commands import is_understood
from cityx.language.references.dwellings import with_dwellings
from cityx.language.references.goals_here import with_goals_here
from cityx.language.references.naming import names_of
from cityx.language.references.resolved_changes import slots_of_edits
from cityx.protocol.serving import Slots

MOST_EDITS = 3  # changes that one command may ask for
NOT_HERE = ("undo", "redo", "unspecified")  # no changes of a city as it is

Change = Callable[[City, Sequence[Item]], City]


def as_sentence(command: str) -> str:
    """Return a command with the point that ends it."""
    return f"{command.strip().rstrip('.')}."


def is_one_change(brief: Brief) -> bool:
    """Return whether what was read is one change of a city as it is."""
    return len(brief.edits) <= MOST_EDITS and not any(one.verb in NOT_HERE for one in brief.edits)


@dataclass(frozen=True)
class Meant:
    """What a command means in a city.

    Attributes
    ----------
    brief
        As it was read.
    edits
        The changes, each with what actions take of it and the actions that serve it.
    faults
        Why it cannot be carried out, in words for who gave it.
    """

    brief: Brief
    edits: tuple[tuple[Edit, Slots, tuple[Item, ...]], ...] = ()
    faults: tuple[str, ...] = ()

    def items(self, why: str) -> list[Item]:
        """Return the actions that carry it out, with the reason for them."""
        return [replace(item, why=why) for _, _, items in self.edits for item in items]


def meaning_of(
    command: str, city: City, planner: OfflinePlanner, kept: Iterable[Slot] = ()
) -> Meant:
    """Return what a command means in a city.

    Parameters
    ----------
    kept
        What must stay as it is, besides what the command says.
    """
    said = as_sentence(command)
    brief = read_brief(said, base=True, names=names_of(city, said))
    brief = with_dwellings(brief, city)
    brief = replace(brief, kept=tuple(dict.fromkeys((*kept, *brief.kept))))
    if not is_understood(brief):
        strange = ", ".join(f'"{word}"' for word in brief.words_unread)
        why = f"the city knows no {strange}" if strange else "say it in plainer words"
        return Meant(brief, faults=(f'"{command}" is not understood; {why}.',))
    if not is_one_change(brief):
        return Meant(brief, faults=(f'"{command}" is not one change of the city.',))
    try:
        found = slots_of_edits(brief, city)
    except Clarify as error:
        return Meant(brief, faults=tuple(one.text for one in error.brief.questions))
    brief = with_goals_here(brief, found)
    edits = tuple((edit, slots, tuple(planner.answers(slots))) for edit, slots in found)
    faults = [] if all(items for *_, items in edits) else [f'"{command}": no action does this.']
    for _, slots, items in edits:
        for item in items:
            faults += untaken(planner.records[item.action], slots, item)
    return Meant(brief, edits, tuple(faults))
