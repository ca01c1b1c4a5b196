"""Finishing: what a description asks for and only a change of the finished city brings about.

A brief may hold commands (`Brief.then`): "benches beside the fountain" is one to put them there.
They are read as those of a user, in the city as it stands then, pass the same gate, and are
measured against the city as it was before each. What would break a check or take back something
else that was asked for is left out and told. A list of things changes nothing and is told.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from cityx.agents.briefs import Request
from cityx.agents.commands import Change, Meant, meaning_of
from cityx.agents.evaluator import judged
from cityx.agents.planning.planner import OfflinePlanner
from cityx.city import City
from cityx.errors import CityxError
from cityx.language import Command
from cityx.language.goals import OTHERS
from cityx.language.references.goals_here import BESIDES
from cityx.language.references.listing import in_a_line, told_of
from cityx.language.references.resolved_changes import LIST

UNMEASURED = "done; nothing measures it"


@dataclass
class Finishing:
    """Carries the commands of a brief out.

    Attributes
    ----------
    change
        Carries actions out on a city.
    planner
        Says which actions serve a change.
    request
        What is asked for.
    goals
        What came of each command, as rows of the goals of a report.
    """

    change: Change
    planner: OfflinePlanner
    request: Request
    goals: list[dict[str, Any]] = field(default_factory=list)
    _checks: dict[str, Any] | None = None  # of the city as it stands, and the goals it misses
    _missed: dict[str, str] | None = None

    def finished(self, city: City) -> City:
        """Return a city after all commands that can be carried out."""
        for command in self.request.brief.then:
            city = self._after(city, command)
        return city

    def _after(self, city: City, command: Command) -> City:
        meant = meaning_of(command.text, city, self.planner, self.request.brief.kept)
        if meant.faults:
            self._left_out(command, " ".join(meant.faults))
            return city
        edits = meant.brief.edits
        if edits and all(edit.verb == LIST for edit in edits):
            self._answer(command, meant, city)
            return city
        try:
            changed = self.change(city, meant.items(f'asked for: "{command.text}"'))
        except CityxError as error:
            self._left_out(command, str(error))
            return city
        if wrong := self._spoilt(city, changed):
            self._left_out(command, f"it would spoil {', '.join(wrong)}")
            return city
        self._measure(command, meant, city, changed)
        self._answer(command, meant, changed)
        return changed

    def _answer(self, command: Command, meant: Meant, city: City) -> None:
        """Tell what a command lists; what its words do not choose is not answered."""
        for told in told_of(meant.brief, city, None):
            self._tell(command, None if told.get("open") else True, in_a_line(told))

    def _spoilt(self, city: City, changed: City) -> list[str]:
        """Return the checks that a change breaks, and the goals that are not met any more."""
        from cityx.checks.broken import broken_by_change

        broken, checks = broken_by_change(city, changed, self._checks)
        if self._missed is None:
            self._missed = self._misses(city)
        missed = self._misses(changed)
        spoilt = [*broken, *(missed[one] for one in missed if one not in self._missed)]
        if not spoilt:
            self._checks, self._missed = checks, missed
        return spoilt

    def _misses(self, city: City) -> dict[str, str]:
        """Return the goals that a city misses, in words, by their predicates."""
        found = judged(city, (*self.request.goals, *city.goals))
        return {goal.predicate: goal.text for goal, _ in found.missed}

    def _measure(self, command: Command, meant: Meant, before: City, after: City) -> None:
        from cityx.checks.predicates import measure_all

        asked = [
            goal.predicate for goal in meant.brief.goals if goal.predicate not in (OTHERS, BESIDES)
        ]
        findings = measure_all(asked, after, before=before, together=asked)
        if not asked:
            self._tell(command, None, UNMEASURED)
        for predicate, finding in zip(asked, findings, strict=True):
            self._tell(command, finding.met, finding.evidence, predicate)

    def _left_out(self, command: Command, why: str) -> None:
        self._tell(command, False, f"left out: {why}")

    def _tell(self, command: Command, met: bool | None, evidence: str, predicate: str = "") -> None:
        row = {"goal": command.text, "met": met, "evidence": evidence, "hard": True}
        self.goals.append({**row, "then": True, **({"predicate": predicate} if predicate else {})})
