"""Changes in words: a sentence becomes actions on a built city, and its views are made anew."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from cityx.agents.brief import Edit
from cityx.agents.briefs import Request, read_request
from cityx.agents.desk import Desk, Revision
from cityx.agents.loop import Say, quiet
from cityx.agents.options import BuildOptions
from cityx.agents.planning.planner import OfflinePlanner
from cityx.agents.planning.workflow import Item
from cityx.agents.results import write_report
from cityx.city import City
from cityx.errors import UsageError
from cityx.protocol.serving import Slots

UNDO = "undo"


def edit_city(
    folder: Path,
    text: str,
    *,
    files: Sequence[Path] = (),
    say: Say = quiet,
    cancelled: Callable[[], bool] = lambda: False,
    expected: int | None = None,
) -> dict[str, Any]:
    """Change a built city as a sentence says, whole or not at all, and return its report.

    Parameters
    ----------
    folder
        Folder of a built city.
    text
        What is to change.
    files
        Texts (.txt, .md) with wishes of their own.
    say
        Called with one line of progress at a time.
    cancelled
        Asked after every action whether to stop; what was done is taken back then.
    expected
        Revision that the caller looked at, None for any.

    Raises
    ------
    Clarify
        If the sentence leaves open what is meant; nothing is changed.
    UsageError
        If no action does what is asked; nothing is changed.
    """
    with Desk(folder) as desk:
        request, items = planned(desk, text, files)
        if items is None:
            revision = _undone(desk, request, expected)
        else:
            for place, item in enumerate(items, start=1):
                say(f"{place}/{len(items)} {item.action}")
            calls = [item.call for item in items]
            revision = desk.change(calls, text=text, expected=expected, cancelled=cancelled)
        return renew(folder, desk.city, request, revision, say)


def planned(desk: Desk, text: str, files: Sequence[Path] = ()) -> tuple[Request, list[Item] | None]:
    """Return what a sentence asks for and the actions for it; None for going back.

    Raises
    ------
    Clarify, UsageError
        As of `edit_city`.
    """
    from cityx.protocol.catalogue import known_records

    request = read_request(BuildOptions(text=text), wishes_in(files), base=True)
    edits = request.brief.edits
    if any(edit.verb == UNDO for edit in edits):
        if len(edits) > 1:
            raise UsageError("Going back and a change are two things; ask for one at a time.")
        return request, None
    planner = OfflinePlanner(known_records(desk.actions))
    items: list[Item] = []
    faults = []
    for edit in edits:
        found = planner.answers(slots_of_edit(edit))
        items += found
        if not found:
            said = f'"{text[slice(*edit.span)]}": ' if not files else ""  # spans are of one text
            faults.append(f"{said}no action does this ({_named(edit)}).")
    if not edits:
        faults.append("The sentence names no change that is understood.")
    if faults:
        raise UsageError("\n".join(faults))
    return request, items


def wishes_in(files: Sequence[Path]) -> list[tuple[Path, str]]:
    """Return the texts among files, with their kind.

    Raises
    ------
    UsageError
        If one of them is no text: a built city is changed by words alone.
    """
    from cityx.sources.inputs import classify

    found = [classify(path) for path in files]
    other = [f"{item.path.name} is {item.kind}" for item in found if item.kind != "text"]
    if other:
        raise UsageError(f"A city is changed by words: {', '.join(other)}; give .txt or .md.")
    return [(item.path, item.kind) for item in found]


def slots_of_edit(edit: Edit) -> Slots:
    """Return a change as slots: its verb, its target and what becomes of it."""
    found: dict[str, tuple[Any, ...]] = {}
    for key, value in edit.items():
        found[key] = (*found.get(key, ()), value)
    return found


def _named(edit: Edit) -> str:
    return ", ".join(f"{key} {value}" for key, value in edit.items())


def _undone(desk: Desk, request: Request, expected: int | None) -> Revision:
    (edit,) = request.brief.edits
    count = next((int(value) for key, value in edit.change if key == UNDO), 1)
    for _ in range(max(count, 1)):
        revision = desk.undo(expected=expected)
        expected = None
    return revision


def undo(folder: Path, to: int | None = None, *, say: Say = quiet) -> dict[str, Any]:
    """Go back to an earlier revision of a city, the one before the last change by default.

    Raises
    ------
    UsageError
        If there is no such revision.
    """
    with Desk(folder) as desk:
        revision = desk.undo(to)
        return renew(folder, desk.city, Request(), revision, say)


def renew(
    folder: Path, city: City, request: Request, revision: Revision, say: Say = quiet
) -> dict[str, Any]:
    """Make the views of a changed city anew, those that there are, and its report.

    The checks of the report stay those of the last `cityx check`, of which it tells the hash.
    """
    from cityx.agents.views import make_views
    from cityx.checks.meshes import triangle_counts
    from cityx.checks.predicates import measure_all
    from cityx.checks.report import counts

    files = {"blend": "city.blend", "glb": "city.glb", "usd": "city.usdc", "sumo": "city.sumocfg"}
    formats = [name for name, file in files.items() if (folder / file).exists()]
    if formats:
        staging = folder / ".views.partial"
        make_views(city, staging, formats, store=folder / "city", say=say)
        for file in staging.iterdir():
            file.replace(folder / file.name)
        staging.rmdir()
    path = folder / "report.json"
    report: dict[str, Any] = json.loads(path.read_text()) if path.exists() else {}
    goals = request.brief.goals
    findings = measure_all((goal.predicate for goal in goals), city)
    report["checks_of"] = report.get("checks_of", report.get("hash", ""))
    report |= {
        "hash": revision.content, "revision": revision.number, "counts": counts(city),
        "triangles": triangle_counts(city), "change": request.brief.to_json(),
        "goals_of_change": [
            {"goal": goal.text, "met": finding.met, "evidence": finding.evidence,
             "predicate": goal.predicate}
            for goal, finding in zip(goals, findings, strict=True)
        ],
    }  # fmt: skip
    write_report(report, folder)
    return report
