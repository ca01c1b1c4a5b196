"""The verdict on a city: what was measured, and what was seen where nothing can be measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Measured = Mapping[str, bool | None]  # goal -> met; None where no check can tell
Checklist = Mapping[str, str]  # goal -> the question to somebody who looks at pictures
Answer = Literal["yes", "no", "cannot tell"]
SURE, UNSURE = 0.8, 0.5  # trust in what was seen the same in both orders, or but once
_MET: Mapping[Answer, bool | None] = {"yes": True, "no": False, "cannot tell": None}


@dataclass(frozen=True)
class Seen:
    """What a look at the pictures found about one goal.

    Attributes
    ----------
    answer
        To the question whether it is met.
    looks
        How many looks gave this answer.
    """

    answer: Answer
    looks: int = 1

    @property
    def confidence(self) -> float:
        """How far it is to be trusted, 0 to 1."""
        return SURE if self.looks > 1 else UNSURE


@dataclass(frozen=True)
class View:
    """A picture of a city.

    Attributes
    ----------
    name
        Of its camera.
    shows
        What it shows, in words, with the ids of things and where in the picture they are.
    picture
        PNG.
    """

    name: str
    shows: str
    picture: bytes = field(repr=False, default=b"")


@dataclass(frozen=True)
class Sight:
    """What somebody who looks is given.

    Attributes
    ----------
    text
        What was asked for.
    checklist
        Questions to be answered, by the ids of their goals.
    missed
        What was measured as missing.
    views
        The pictures.
    changed
        Whether the text asks for a change of a city that stood before.
    """

    text: str
    checklist: Checklist
    missed: tuple[str, ...] = ()
    views: tuple[View, ...] = ()
    changed: bool = False


@dataclass(frozen=True)
class Fault:
    """Something that is seen to be wrong.

    Attributes
    ----------
    about
        The thing or the place.
    wrong
        What is wrong with it.
    severity
        How bad it is.
    edit
        A command that would mend it, "" where there is none.
    """

    about: str
    wrong: str
    severity: Literal["minor", "major", "block"] = "major"
    edit: str = ""


@dataclass(frozen=True)
class Looked:
    """What somebody saw: answers to the checklist, and what is wrong."""

    answers: Mapping[str, Answer] = field(default_factory=dict)
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True)
class Finding:
    """What is held of one goal in the end.

    Attributes
    ----------
    met
        Whether it is met, None where nobody can tell.
    origin
        "check" where it was measured, "seen" where a model looked, "nobody".
    confidence
        1 for what was measured.
    severity
        "block" for what was measured as missing, "major" for what was only seen as missing,
        "minor" where two looks contradict a measurement, "" for none.
    disagree
        Whether a look contradicts the measurement; another view may settle it.
    """

    met: bool | None
    origin: Literal["check", "seen", "nobody"]
    confidence: float
    severity: Literal["block", "major", "minor", ""] = ""
    disagree: bool = False


@dataclass(frozen=True)
class Verdict:
    """The verdict on all goals.

    Attributes
    ----------
    findings
        By goal.
    notes
        What the report says of how it came about.
    """

    findings: Mapping[str, Finding]
    notes: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether nothing was measured as missing."""
        return not any(finding.severity == "block" for finding in self.findings.values())

    @property
    def open(self) -> tuple[str, ...]:
        """Goals that can be neither measured nor seen."""
        return tuple(goal for goal, found in self.findings.items() if found.met is None)

    @property
    def unsettled(self) -> tuple[str, ...]:
        """Goals that were measured as met and seen as missing."""
        return tuple(goal for goal, found in self.findings.items() if found.disagree)

    def to_json(self) -> dict[str, Any]:
        """Return plain values for the report."""
        return {
            "ok": self.ok,
            "findings": {goal: vars(found) for goal, found in self.findings.items()},
            "notes": list(self.notes),
        }


def merge(measured: Measured, seen: Mapping[str, Seen]) -> Verdict:
    """Merge measurements and looks; no look erases what was measured as missing.

    Parameters
    ----------
    measured
        Goal to whether it is met.
    seen
        Goal to what was seen; goals that were not measured at all may be among them.
    """
    goals = dict.fromkeys((*measured, *seen))
    return Verdict({goal: _held(measured.get(goal), seen.get(goal)) for goal in goals})


def _held(met: bool | None, look: Seen | None) -> Finding:
    """Return what is held of one goal."""
    if met is False:
        return Finding(
            False, "check", 1.0, "block", disagree=look is not None and look.answer == "yes"
        )
    if met:
        missing = look is not None and look.answer == "no"
        twice = missing and look is not None and look.looks > 1
        return Finding(True, "check", 1.0, "minor" if twice else "", disagree=missing)
    if look is None or look.answer == "cannot tell":
        return Finding(None, "nobody", 0.0)
    severity: Literal["major", ""] = "major" if look.answer == "no" else ""
    return Finding(_MET[look.answer], "seen", look.confidence, severity)
