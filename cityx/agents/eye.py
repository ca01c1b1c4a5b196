"""The eye: somebody looks at pictures of a city, says what is wrong, and the picture is mended.

What is seen comes as faults, each with a command that would mend it. A command is read as one of a
user, by the same rules, and passes the same gate and checks. It may ask for nothing that the text
does not ask for, touch nothing that is protected, and take away little. What would break a check or
miss more of the goals is taken back. Then the pictures are taken again, in up to three rounds; the
better state is kept, and with no answer the city stays as it was built.

After a change of a city the same holds. What it asks for outweighs what was asked before, and what
it neither names nor touched stays as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cityx.agents.briefs import Request
from cityx.agents.commands import Change, Meant, meaning_of
from cityx.agents.evaluator import judged
from cityx.agents.planning.planner import OfflinePlanner
from cityx.agents.roles import Evaluator
from cityx.agents.verdict import Checklist, Fault, Looked, Sight, View
from cityx.checks.predicates.change_predicates import changed_ids, located
from cityx.checks.predicates.facts import Facts
from cityx.checks.predicates.parser import parse
from cityx.checks.predicates.syntax import Call, Comparison, Name
from cityx.checks.predicates.thing_predicates import CannotTell
from cityx.checks.predicates.vocabulary import family_of, split_arguments
from cityx.city import City
from cityx.errors import CityxError
from cityx.language import Edit
from cityx.language.lexicon.words import words_of
from cityx.protocol.objects import find_objects
from cityx.protocol.serving import Slots

ROUNDS = 3  # times that the city is changed and looked at again
MANY = 40  # things of which no picture of one tells anything
FEW, PART = 5, 0.2  # things, and share of their kind, that may be taken away unless it is denied
SEVERITY = {"minor": 1.0, "major": 3.0, "block": 10.0}
BLOCK = 1000.0  # weight of a check that a change broke
NO_PICTURES = "Nobody looked at the city: no pictures could be taken."
NO_ANSWER = "Nobody answered what the pictures show; the city is as it was measured."
WHY = "seen in the pictures"
_TAKING = ("remove", "replace")
# Keys of a change that say where and which way, not what.
_PLACES = frozenset(
    ("in", "on", "near", "along", "around", "of", "from", "side", "direction", "by")
)

UInt64Array = NDArray[np.uint64]
Take = Callable[[City], Sequence[View]]


@dataclass
class Eye:
    """Looks at a city and lets it be mended.

    Attributes
    ----------
    evaluator
        Who looks.
    take
        Takes the pictures of a city.
    change
        Carries actions out on a city.
    planner
        Says which actions serve a change.
    request
        What is asked for.
    checklist
        Questions about the pictures, by the ids of their goals.
    before, named
        The city before a change, and the objects that the change is about; None for a new city.
    rounds
        What was seen and done so far, for the report.
    answers
        To the checklist, of the state that is kept.
    notes
        What the report says of it.
    """

    evaluator: Evaluator
    take: Take
    change: Change
    planner: OfflinePlanner
    request: Request
    checklist: Checklist = field(default_factory=dict)
    before: City | None = None
    named: Sequence[str] = ()
    rounds: list[dict[str, Any]] = field(default_factory=list)
    answers: Looked = field(default_factory=Looked)
    notes: list[str] = field(default_factory=list)
    kept: int = 0

    def watched(self, city: City) -> City:
        """Return a city after up to `ROUNDS` changes, the best of those that were looked at."""
        best, least = city, (float("inf"), float("inf"))
        for round_ in range(ROUNDS + 1):
            looked = self._look(city)
            if looked is None:
                if self._weight(city) < least[0] < float("inf"):  # nobody looked, but it is better
                    best, self.kept = city, round_
                break
            weight = self._weight(city), sum(SEVERITY[one.severity] for one in looked.faults)
            told: dict[str, Any] = {"seen": [asdict(fault) for fault in looked.faults],
                                    "missed": weight[0], "doubt": weight[1]}  # fmt: skip
            self.rounds.append(told)
            if weight >= least:
                self.notes.append("The last change made the city no better; it was taken back.")
                break
            best, least, self.answers, self.kept = city, weight, looked, round_
            changed = self._mended(city, looked.faults, told) if round_ < ROUNDS else city
            if changed is city:
                break
            city = changed
        self._conclude()
        return best

    def _conclude(self) -> None:
        """Say what of that which was seen is mended in the state that is kept."""
        done = [one for told in self.rounds[: self.kept] for one in told["seen"] if one.get("done")]
        mended = [(one["about"], one["wrong"]) for one in done]
        for fault in self.answers.faults:
            if (fault.about, fault.wrong) not in mended:
                self.notes.append(f"Seen and not mended: {fault.about}: {fault.wrong}.")
        self.notes += [f"Seen and mended: {one['about']}: {one['wrong']}." for one in done]

    def report(self) -> dict[str, Any]:
        """Return what was seen, changed and not answered, as plain values."""
        return {"rounds": self.rounds, "kept": self.kept, "notes": list(self.notes)}

    def _look(self, city: City) -> Looked | None:
        """Return what is seen of a city, None and a note where nobody answers."""
        try:
            views = tuple(self.take(city))
        except CityxError as error:
            self.notes.append(f"{NO_PICTURES} {error}")
            return None
        if not views:
            self.notes.append(NO_PICTURES)
            return None
        found = judged(city, self.request.goals, self.before)
        sight = Sight(
            self.request.brief.text, self.checklist, tuple(found.texts), views,
            changed=self.before is not None,
        )  # fmt: skip
        looked = self.evaluator.look(sight, lambda command: self.faults(command, city))
        if looked is None:
            self.notes.append(NO_ANSWER)
        return looked

    def _weight(self, city: City) -> float:
        """Return what is missed; after a change, what was asked before it weighs as if not hard."""
        if self.before is None:
            return judged(city, (*self.request.goals, *city.goals)).weight
        earlier = [replace(goal, hard=False) for goal in city.goals]
        return judged(city, self.request.goals, self.before).weight + judged(city, earlier).weight

    def _mended(self, city: City, faults: Sequence[Fault], told: dict[str, Any]) -> City:
        """Carry out the commands that may be, one by one; write down what became of each."""
        from cityx.checks.broken import broken_by_change

        for fault, line in zip(faults, told["seen"], strict=True):
            line |= {"done": False, "why": ""}
            if not fault.edit:
                line["why"] = "no change was named"
                continue
            if wrong := self.faults(fault.edit, city):
                line["why"] = " ".join(wrong)
                continue
            try:
                changed = self.change(city, self._meant(fault.edit, city).items(WHY))
            except CityxError as error:
                line["why"] = str(error)
                continue
            broken, _ = broken_by_change(city, changed)
            if broken or self._weight(changed) > self._weight(city):
                line["why"] = f"it would break {', '.join(broken) or 'what was asked for'}"
                continue
            line["done"] = True
            city = changed
        return city

    def faults(self, command: str, city: City) -> list[str]:
        """Return why a command cannot be carried out, in words for who gave it."""
        meant = self._meant(command, city)
        unasked = [self._unasked(edit, slots, city) for edit, slots, _ in meant.edits]
        return [*meant.faults, *(fault for faults in unasked for fault in faults)]

    def _meant(self, command: str, city: City) -> Meant:
        """Return what a command means; what the text protects stays protected."""
        return meaning_of(command, city, self.planner, self.request.brief.kept)

    def _unasked(self, edit: Edit, slots: Slots, city: City) -> list[str]:
        """Return what a change asks for that the text does not, and what it takes too much of."""
        brief = self.request.brief
        asked = {str(value) for values in self.request.slots.values() for value in values}
        asked |= {str(slot.value) for slot in brief.slots}
        asked |= {word.text.removesuffix("s") for word in words_of(brief.text)}
        denied = {str(slot.value) for slot in brief.negated}
        faults = []
        for key, value in edit.change:
            said = str(value)
            parts = {said, *(part.removesuffix("s") for part in said.split("_"))}
            plain = key in _PLACES or (key == "count" and value == 1)
            if said in denied and edit.verb not in _TAKING:
                faults.append(f"The text says not to have {said}.")
            elif not plain and not parts & asked and not _is_in(value, asked):
                faults.append(f"The text does not ask for {key} {said}.")
        objects = slots.get("objects", ((),))[0]
        if self.before is not None and not (edit.target and edit.target.kind in asked):
            own = touched(self.before, city, self.named)
            if not np.isin(find_objects(city, objects), own).all():
                faults.append("The change that was asked for neither names nor touched this.")
        if edit.verb in _TAKING and edit.target is not None and edit.target.kind not in denied:
            built = "building" in slots.get("family", ())
            most = max(FEW, PART * len(city.layout.buildings)) if built else FEW
            if len(objects) > most:
                faults.append(f"{len(objects)} things are too many to take away.")
        return faults


def _is_in(value: object, asked: set[str]) -> bool:
    """Return whether a number is one that is asked for."""
    if not isinstance(value, int | float):
        return False
    return any(str(number) in asked for number in (value, float(value), int(value)))


class Things(NamedTuple):
    """Things of which pictures are taken: how they are called, (n,) ids and shapes, how many."""

    text: str
    ids: UInt64Array
    shapes: NDArray[Any]
    number: int

    def among(self, ids: UInt64Array) -> Things:
        """Return those that are among some ids; how many there are of all stays told."""
        kept = np.isin(self.ids, ids)
        return self._replace(ids=self.ids[kept], shapes=self.shapes[kept])


def touched(before: City, after: City, named: Sequence[str]) -> UInt64Array:
    """Return the ids of what a change touched or is about."""
    return np.union1d(changed_ids(before, after), find_objects(after, named))


def touched_things(city: City, ids: UInt64Array) -> Iterator[Things]:
    """Yield what a change touched, one kind of thing after the other, each thing once."""
    told = np.zeros(0, np.uint64)
    for own, shapes in located(city, ids):
        new = ~np.isin(own, told)
        if new.any():
            yield Things("what was changed", own[new], shapes[new], len(np.unique(own[new])))
        told = np.union1d(told, own)


def asked_things(request: Request, city: City) -> Iterator[Things]:
    """Yield what the goals of a request are about, if there is any."""
    facts = Facts(city)
    seen: set[str] = set()
    for goal in request.goals:
        wanted = parse(goal.predicate)
        measured = wanted.left if isinstance(wanted, Comparison) else getattr(wanted, "of", wanted)
        if not isinstance(measured, Call):
            continue
        for group in split_arguments(measured)[0][:1]:
            head = group.head.word if isinstance(group.head, Name) else ""
            if not family_of(head) or str(group) in seen:
                continue
            seen.add(str(group))
            with suppress(CannotTell):
                found = facts.select(group)
                if 0 < found.count < MANY:
                    yield Things(str(group), found.ids, found.shapes, found.count)
