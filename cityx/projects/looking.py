"""Looking: somebody who can see looks at a city that was built or changed, and has it mended."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cityx.agents.briefs import Request
from cityx.agents.evaluator import measured_of
from cityx.agents.loop import Say
from cityx.agents.planning.workflow import Item
from cityx.agents.pool import Message, Pool
from cityx.agents.roles import OfflineExecutor, Roles, attempt
from cityx.agents.step_runner import Run
from cityx.agents.verdict import Seen, View, merge
from cityx.city import City
from cityx.errors import CityxError
from cityx.projects.views import looks_of
from cityx.protocol.serving import Slots

if TYPE_CHECKING:
    from cityx.agents.commands import Change
    from cityx.agents.eye import Eye


def changing(run: Run, roles: Roles, slots: Slots) -> Change:
    """Return what carries actions out on a city; where one fails, the run is as it was."""

    def change(city: City, items: Sequence[Item]) -> City:
        state = run.state
        try:
            for item in items:
                record = roles.checker.records[item.action]
                city = attempt(OfflineExecutor(), run.do, city, item, record, slots)
        except CityxError:
            run.state = state
            raise
        return city

    return change


@dataclass
class Looking:
    """A look at one city.

    Attributes
    ----------
    roles
        Who looks, if it is somebody who can see, and who plans what mends the city.
    request
        What is asked for.
    folder
        For the pictures; it goes.
    pictures
        Whether any may be taken.
    before, named
        The city before a change, and the objects that the change is about; None for a new city.
    eye
        What was seen and done, None where nobody can see.
    """

    roles: Roles
    request: Request
    folder: Path
    say: Say
    pictures: bool = True
    before: City | None = None
    named: Sequence[str] = ()
    eye: Eye | None = field(default=None, init=False)

    def mended(self, run: Run, city: City) -> City:
        """Return a city as it is after it was looked at, which the run is told of.

        Parameters
        ----------
        run
            Carries out what mends the city.
        """
        if not self.roles.evaluator.sees:
            return city
        from cityx.agents.eye import Eye
        from cityx.agents.models.evaluator import checklist_of

        roles, slots = self.roles, self.request.slots
        self.eye = Eye(
            roles.evaluator, self._take, changing(run, roles, slots), roles.checker, self.request,
            checklist_of(slots), self.before, self.named,
        )  # fmt: skip
        held, run.hold = run.hold, True
        try:
            city = self.eye.watched(city)
        finally:
            shutil.rmtree(self.folder, ignore_errors=True)
            run.hold = held
        pool = Pool(run.journal.database, run.number)
        pool.say(Message("evaluator", "verdict", self.eye.report()))
        return city

    def _take(self, city: City) -> Sequence[View]:
        if not self.pictures:
            return ()
        self.say("taking pictures to be looked at")
        own = np.zeros(0, np.uint64)
        if self.before is not None:
            from cityx.agents.eye import touched

            own = touched(self.before, city, self.named)
        return looks_of(city, self.request, self.folder, self.say, own)

    @property
    def notes(self) -> list[str]:
        """What a report says of it in sentences."""
        return [] if self.eye is None else list(self.eye.notes)

    def told(self, report: Mapping[str, Any], goals: str = "goals") -> dict[str, Any]:
        """Return the verdict, and what was seen and done; what a report measured stands.

        Parameters
        ----------
        report
            With "checks", and with goals under their key.
        """
        eye = self.eye
        if eye is None:
            return {}
        measured = measured_of({"checks": report.get("checks", {}), "goals": report[goals]})
        looks = {goal: Seen(answer) for goal, answer in eye.answers.answers.items()}
        verdict = merge({**dict.fromkeys(eye.checklist), **measured}, looks)
        return {"verdict": verdict.to_json(), "looks": eye.report()}
