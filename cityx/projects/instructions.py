"""Instructions: carry out a text on a folder: edit the city there, or build one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from cityx.agents.explain import explain, explained
from cityx.agents.loop import Say
from cityx.options import BuildOptions, PlannerChoice
from cityx.projects.build import build
from cityx.projects.desk import STORE, Cancelled, Desk
from cityx.projects.drawn import Drawn
from cityx.projects.edit import OFFLINE, edit_city, planned, roles_at

QUICK = BuildOptions(formats=(), render=False)


def is_built(folder: Path) -> bool:
    """Return whether a folder holds a city."""
    return (folder / STORE / "city.json").exists()


def plan_text(text: str, folder: Path, choice: PlannerChoice = OFFLINE) -> dict[str, Any]:
    """Return what a text asks for and the actions that would bring it about; nothing is run.

    Parameters
    ----------
    text
        In words.
    folder
        Of a built city, or where one is to be built.
    choice
        Who reads the text; a city that is to be built is planned offline.

    Returns
    -------
    plan
        As of `cityx.agents.explain.explain`; "builds" tells whether a city is built first.

    Raises
    ------
    Clarify
        If the text contradicts itself or leaves open what is meant.
    UsageError
        If no action does what is asked.
    """
    if not is_built(folder):
        return {**explain(text), "builds": True}
    with Desk(folder) as desk, roles_at(desk, choice) as roles:
        request, items, *_ = planned(desk, text, roles=roles)
    return {**explained(request, items), "builds": False}


def carry_out_text(
    text: str, folder: Path, say: Say, cancelled: Callable[[], bool], options: BuildOptions = QUICK,
    *, stored: Callable[[], None] = lambda: None, drawn: Drawn | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Build the city that a text asks for, or change the one that is there.

    Parameters
    ----------
    text, folder
        As of `plan_text`.
    say
        Called with one line of progress at a time.
    cancelled
        Asked between actions whether the work is called off.
    options
        Of a build; who reads and plans is that of a change too.
    stored
        Called when the folder holds a changed city, before its views and goals are looked at.
    drawn
        A path or an area that the text speaks of; of changes alone.

    Returns
    -------
    told
        "revision", its number; "message", one sentence; "warnings", goals that are missed and what
        else a reader should know.

    Raises
    ------
    Clarify, UsageError
        As of `plan_text`; the folder is as it was.
    Cancelled
        The folder is as it was.
    """

    def heard(line: str) -> None:
        if cancelled():
            raise Cancelled("The work was called off; the folder stays as it was.")
        say(line)

    if is_built(folder):
        report = edit_city(
            folder, text, say=say, cancelled=cancelled, choice=options.choice, stored=stored,
            drawn=drawn,
        )  # fmt: skip
        goals, notes = report["goals_of_change"], report["notes_of_change"]
    else:
        report = build([], folder, replace(options, text=text), say=heard)
        goals, notes = report["goals"], report["notes"]
    broken = [
        f"check broken: {name} = {item['value']}, {item['bound']} {item['limit']}"
        for name, item in report.get("checks_broken", {}).items()
    ]
    number = int(report.get("revision", 1))
    missed = [
        f"missed: {goal['goal']} ({goal['evidence']})" for goal in goals if goal["met"] is False
    ]
    return {
        "revision": number, "message": f"Revision {number}.",
        "warnings": [*missed, *broken, *notes],
    }  # fmt: skip
