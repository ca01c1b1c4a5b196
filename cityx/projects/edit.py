"""Edits in words: a sentence becomes actions on a built city, and its views are updated."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cityx.agents.ablation import shown_records
from cityx.agents.briefs import Request, read_request
from cityx.agents.loop import Say, quiet
from cityx.agents.planning.planner import OfflinePlanner, untaken
from cityx.agents.planning.workflow import Item
from cityx.agents.pool import Pool
from cityx.agents.roles import Roles, offline_roles
from cityx.agents.step_runner import Run
from cityx.city import City
from cityx.errors import ActionFailed, ActionRejected, CityxError, InputError, UsageError
from cityx.language import Brief, Edit, Question, read_brief
from cityx.language.brief import Clarify, Left, Note, Wish
from cityx.language.commands.that_place import PLACES
from cityx.language.goals import OTHERS
from cityx.language.leaving import without
from cityx.language.references.goals_here import with_goals_here
from cityx.language.references.listing import told_of
from cityx.language.references.naming import names_of
from cityx.language.references.resolved_changes import changes_here
from cityx.language.references.selecting import Open, choose
from cityx.language.references.selecting import said as said_of
from cityx.options import BuildOptions, PlannerChoice
from cityx.projects.desk import Desk, Revision
from cityx.projects.drawn import Drawn, Placed, placed_in, with_drawn
from cityx.projects.looking import Looking
from cityx.projects.outcome import COMPARING, choices_of, deeds_of
from cityx.projects.results import stale_notes, stale_views, write_report
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.serving import Slots
from cityx.sources.blend_curves import SUFFIX, BlendCurves, read_blend_curves
from cityx.system.allocator import rare_collection

if TYPE_CHECKING:
    from cityx.checks.predicates import Finding

UNDO, REDO = "undo", "redo"
SHELLS = "buildings"  # layer of the shells of buildings
OFFLINE = PlannerChoice()
# Vehicles keep to the lanes of a city, but for those that are to go along a curve of another's.
FLOW, FOLLOWING = "dynamic/vehicle_flow-v1", "dynamic/vehicle_on_path-v1"
ON_PATH = ("kind", "count", "speed")  # what both take
LOOKS = ".looks.partial"  # folder of the pictures that a model looks at, while it does


def edit_city(
    folder: Path,
    text: str,
    *,
    files: Sequence[Path] = (),
    say: Say = quiet,
    cancelled: Callable[[], bool] = lambda: False,
    expected: int | None = None,
    choice: PlannerChoice = OFFLINE,
    stored: Callable[[], None] = lambda: None,
    drawn: Drawn | None = None,
) -> dict[str, Any]:
    """Change a built city as a sentence says, and return its report.

    Of several wishes those that are understood are carried out, all of them or none; the others are
    told in `left_of_change` of the report, with what is to be asked about each.

    Parameters
    ----------
    folder
        Folder of a built city.
    text
        What is to change.
    files
        Texts (.txt, .md) with wishes of their own, and .blend files whose curves paths may name.
    say
        Called with one line of progress at a time.
    cancelled
        Asked after every action whether to stop; what was done is taken back then.
    expected
        Revision that the caller looked at, None for any.
    choice
        Who reads the sentence.
    stored
        Called when the folder holds the changed city, before its views and goals are looked at.
    drawn
        A path or an area that the sentence speaks of: "along this", "in this area", "here".

    Raises
    ------
    Clarify
        If the sentence leaves open what is meant by all that it asks for; nothing is changed.
    UsageError
        If no action does what is asked; nothing is changed.
    """
    with rare_collection(), Desk(folder) as desk, roles_at(desk, choice) as roles:
        seen, before = desk.revision, desk.city
        plan = planned(desk, text, files, roles=roles, drawn=drawn)
        told = len(roles.notes)
        if not plan.items and plan.base == seen:  # all is so already, or is only told
            revision = next(one for one in desk.revisions() if one.number == seen)
            return renew(folder, before, plan.request, revision, say, before=before)
        if not plan.items:
            content = desk.content_at(seen)
            revision = desk.undo(plan.base, expected=expected)
            stored()
            return renew(
                folder, desk.city, plan.request, revision, say, before=before, content=content
            )
        before, begun, content = desk.at(plan.base), -1, desk.content_at(plan.base)
        made = before

        def calling(place: int) -> None:
            nonlocal begun
            begun = place
            say(f"{place + 1}/{len(plan.items)} {plan.items[place].action}")

        def watched(run: Run, city: City) -> City:
            nonlocal begun, made
            begun = -1
            if choice.look:
                roles.attach(Pool(run.journal.database, run.number))
                city = looking.mended(run, city)
            made = city
            return city

        while True:
            named = [str(one) for item in plan.items for one in item.args.get("objects", ())]
            looking = Looking(roles, plan.request, folder / LOOKS, say, before=before, named=named)
            try:
                revision = desk.change(
                    [item.call for item in plan.items], text=text,
                    expected=seen if expected is None and plan.base != seen else expected,
                    cancelled=cancelled, base=None if plan.base == seen else plan.base,
                    calling=calling, watched=watched,
                )  # fmt: skip
                break
            except (ActionFailed, ActionRejected, InputError, UsageError) as error:
                less = None if begun < 0 else plan.less(begun, error, before, roles.checker)
                others = [f'left out: "{one.text}". {question.text}'
                          for one in plan.request.brief.left
                          for question in one.questions[:1]]  # fmt: skip
                if less is None and not others:
                    raise
                if less is None:  # all that was left out before is named as well
                    cause = error.__cause__ if isinstance(error.__cause__, ActionFailed) else error
                    said = dict.fromkeys([str(cause), *others])
                    raise UsageError("\n".join([*said, "Nothing was changed."])) from error
                plan, begun = less, -1
        request = plan.request
        stored()
        notes = [*request.brief.notes, *(Note("model", note) for note in roles.notes[told:])]
        if revision.number == seen:  # what was tried and why it came to nothing
            notes += [Note("tried", one) for one in made.notes if one not in before.notes]
        request = replace(request, brief=replace(request.brief, notes=tuple(notes)))
        return renew(
            folder, desk.city, request, revision, say, before=before, content=content,
            looking=looking,
        )  # fmt: skip


class Plan(NamedTuple):
    """What a sentence asks for, the actions for it, and the revision that they run on.

    Without actions it asks to go back to the revision, or forward to it.
    """

    request: Request
    items: list[Item]
    base: int
    said: tuple[Edit, ...] = ()  # the change of each action
    curves: tuple[BlendCurves, ...] = ()
    alone: bool = True  # whether spans of changes are of the text of the brief alone
    placed: Placed | None = None

    def less(
        self, place: int, error: CityxError, city: City, planner: OfflinePlanner
    ) -> Plan | None:
        """Return a plan without the wish of an action that failed, None where none is left."""
        failed, brief = self.said[place], self.request.brief
        reasons = {
            edit: [Question(str(error))]
            for wish in brief.wishes for edit in wish.edits if _is_of(failed, edit)
        }  # fmt: skip
        fewer = without(brief, reasons)
        if fewer is None:
            return None
        changes, items, said = _possible(
            fewer, city, planner, self.curves, told=self.alone, placed=self.placed
        )
        return self._replace(request=replace(self.request, brief=changes), items=items, said=said)


@contextmanager
def roles_at(desk: Desk, choice: PlannerChoice = OFFLINE) -> Iterator[Roles]:
    """Let somebody play the roles of a change; what a model decides goes to the city's journal.

    Raises
    ------
    InputError, UsageError, MissingExtra
        As of `cityx.projects.build.roles_of`.
    """
    from cityx.protocol.catalogue import known_records

    records = shown_records(known_records(desk.actions), choice.shown)
    if replace(choice, shown=OFFLINE.shown, look=OFFLINE.look) == OFFLINE:
        yield offline_roles(records)
        return
    from cityx.projects.build import roles_of

    roles = roles_of(choice, records)
    try:
        roles.attach(Pool(desk.journal.database, desk.revision))
        yield roles
    finally:
        roles.close()


def planned(
    desk: Desk, text: str, files: Sequence[Path] = (), *, roles: Roles, drawn: Drawn | None = None
) -> Plan:
    """Return what a sentence asks for and the actions for it.

    A model, where there is one, puts what the rules do not understand into words that they do.
    Which actions serve a change is a table that the checks hold it to, so nobody else plans it.

    Raises
    ------
    Clarify, UsageError
        As of `edit_city`.
    """
    drawings = [file for file in files if file.name.lower().endswith(SUFFIX)]
    files = [file for file in files if file not in drawings]
    curves = [read_blend_curves(file) for file in drawings]
    placed = placed_in(text, drawn)
    if placed is not None:
        text = placed.text
        curves.append(placed.drawn.curves)
    request = read_request(
        BuildOptions(text=text), wishes_in(files), base=True, city=desk.city,
        maker=roles.brief_maker,
    )  # fmt: skip
    notes = (*request.brief.notes, *(Note("model", note) for note in roles.notes))
    request = replace(request, brief=replace(request.brief, notes=notes))
    changes, base = led(desk, request)
    edits = changes.edits
    if base is not None and not edits:
        return Plan(request, [], base)
    base = desk.revision if base is None else base
    if len(edits) < len(request.brief.edits):
        changes = replace(changes, wishes=())  # who goes back as well wants all or nothing
    changes, items, said = _possible(
        changes, desk.at(base), roles.checker, curves, told=not files, placed=placed
    )
    brief = changes if changes.left else replace(
        request.brief, goals=changes.goals, wishes=changes.wishes, notes=changes.notes
    )  # fmt: skip
    request = replace(request, brief=brief)
    return Plan(request, items, base, said, tuple(curves), not files, placed)


def _possible(
    brief: Brief, city: City, planner: OfflinePlanner, curves: Sequence[BlendCurves], *,
    told: bool, placed: Placed | None = None,
) -> tuple[Brief, list[Item], tuple[Edit, ...]]:  # fmt: skip
    """Return a brief without the wishes that cannot be carried out in a city, and its actions.

    Each action comes with the change that it is for.

    Parameters
    ----------
    told
        Whether spans of changes are of the text of the brief alone.
    placed
        What was drawn beside the sentence.

    Raises
    ------
    Clarify, UsageError
        As of `edit_city`, if no wish is left.
    """
    if not brief.edits:
        raise UsageError("The sentence names no change that is understood.")
    resolved, asked, idle = changes_here(brief, city)
    reasons: dict[Edit, list[Question]] = {}
    if placed is not None:
        try:
            resolved = with_drawn(resolved, placed, city)
        except Open as error:
            raise Clarify(replace(brief, questions=(error.question,))) from None
    asked += [(question, wish.edits) for wish in brief.wishes for question in _lacking(wish, city)]
    for question, edits in asked:
        for edit in edits:
            reasons.setdefault(edit, []).append(question)
    items: list[Item] = []
    of: list[Edit] = []
    faults: list[str] = []
    spared: list[Left] = []
    for edit, meant in resolved:
        said = f'"{brief.text[slice(*edit.span)]}": ' if told else ""
        slots = _along_curves(meant, brief.text[slice(*edit.span)], curves)
        found = [_on_curve(item, planner.records[item.action], curves)
                 for item in planner.answers(slots)]  # fmt: skip
        items += found
        of += [edit] * len(found)
        wrong = list(_faults_of(edit, slots, found, planner))
        if found and not wrong:
            spared += _without_traits(brief, edit, found, planner)
        faults += [f"{said}{fault}" for fault in wrong]
        for wish in brief.wishes:
            if wrong and any(_is_of(edit, one) for one in wish.edits):
                reasons.setdefault(wish.edits[0], []).extend(map(Question, wrong))
    if not reasons and not faults:
        brief = replace(brief, notes=(*brief.notes, *idle), left=(*brief.left, *spared))
        order = _removals_first(items)
        return (with_goals_here(brief, resolved), [items[at] for at in order],
                tuple(of[at] for at in order))  # fmt: skip
    less = without(brief, reasons)
    if less is not None:
        return _possible(less, city, planner, curves, told=told, placed=placed)
    if asked:
        questions = dict.fromkeys(question for question, _ in asked)
        raise Clarify(replace(brief, questions=(*_questions_of(brief), *questions)))
    raise UsageError("\n".join([*(one.text for one in _questions_of(brief)), *faults]))


REMOVES, STREETS = "edit/remove-v1", "edit/streets-v1"


def _removals_first(items: Sequence[Item]) -> list[int]:
    """Return the order of actions in which what goes is gone before its street changes.

    What is meant was chosen in the city as it is; a street that is closed takes its cars with it.
    """
    streets = [at for at, item in enumerate(items) if item.action == STREETS]
    late = [at for at, item in enumerate(items) if item.action == REMOVES and streets
            and at > streets[0]]  # fmt: skip
    rest = [at for at in range(len(items)) if at not in late]
    begin = rest.index(streets[0]) if late else 0
    return [*rest[:begin], *late, *rest[begin:]]


def _lacking(wish: Wish, city: City) -> Iterator[Question]:
    """Yield what there is not in a city and must be for a wish to be asked for."""
    for one in wish.given:
        try:
            choose(one, city)
        except Open as error:
            yield error.question


def _is_of(edit: Edit, said: Edit) -> bool:
    """Return whether a change is what was said, or was made of it."""
    return edit.span == said.span and edit.wished == said.wished


def _questions_of(brief: Brief) -> list[Question]:
    """Return what is to be asked about the wishes that are left out."""
    return [question for one in brief.left for question in one.questions]


def _faults_of(
    edit: Edit, slots: Slots, items: Sequence[Item], planner: OfflinePlanner
) -> Iterator[str]:
    """Yield why the actions for a change do not do all that it asks."""
    if not items:
        placed = edit.refs or any(key in (*PLACES, "side", "last") for key, _ in edit.change)
        if edit.verb in ("add", "add_building") and not placed:
            yield "where is it to stand? Name a place, as in: along the main street, in the park."
            return
        yield f"no action does this ({_named(edit)})."
    for item in items:
        yield from untaken(planner.records[item.action], slots, item)


def _without_traits(
    brief: Brief, edit: Edit, items: Sequence[Item], planner: OfflinePlanner
) -> Iterator[Left]:
    """Yield what a change says of something new that no action takes, which is done without it."""
    lost = list(dict.fromkeys(_lost(edit, items, planner)))
    if lost:
        words = brief.text[slice(*edit.span)].rstrip(".!? ")
        told = [(key.rpartition(".")[2] if key != "roof.color" else "colour of the roof",
                 value) for key, value in edit.change if key in lost]  # fmt: skip
        told += [("turn", f"towards {said_of(ref.spots[0])}") for ref in edit.refs
                 if ref.key in lost]  # fmt: skip
        said = ", ".join(f"{key} ({value})" for key, value in told)
        why = Question(f"Nothing gives what is new its {said}; it is made without.")
        yield Left(words, (0, 0), (why,))


# What is said of something new that an action must take, or nothing is built.
TRAITS = ("height", "width", "floors", "material", "color", "style", "roof", "size", "amount",
          "count", "spacing", "mode", "who", "wears", "speed", "gates", "direction",
          "path")  # fmt: skip
NEW = ("add", "add_building", "plant", "add_agent")
# What a change calls some of them -> the slot that actions take.
_SLOTS = {
    "color": "rgb", "roof.color": "roof.rgb", "building.roof": "roof",
    "building.material": "material",
}  # fmt: skip


def _lost(edit: Edit, items: Sequence[Item], planner: OfflinePlanner) -> list[str]:
    """Return what a change says of something new that no action takes."""
    if edit.verb not in NEW or not items:
        return []
    taken = {slot for item in items for _, slot in planner.records[item.action].binds}
    taken |= {slot.partition("=")[0] for item in items for slot in item.wish}
    taken |= {word for word, slot in _SLOTS.items() if slot in taken}
    said = dict.fromkeys(key for key, _ in edit.change)
    turned = [ref.key for ref in edit.refs if ref.key == "facing" and "toward" not in taken]
    return turned + [key for key in said if key not in taken
            and key.removeprefix("building.").partition(".")[0] in TRAITS]  # fmt: skip


def led(desk: Desk, request: Request) -> tuple[Brief, int | None]:
    """Return the changes of a request without its going back, and the revision that leads to.

    Changes are of the city as it was there: names of what has gone since are known.

    Raises
    ------
    Clarify
        If something that is undone is to stay, or a change comes before the going back.
    UsageError
        If there is nothing to undo or to redo.
    """
    brief = request.brief
    steps = [edit for edit in brief.edits if edit.verb in (UNDO, REDO)]
    rest = tuple(edit for edit in brief.edits if edit not in steps)
    if not steps:
        return brief, None
    words = brief.text[slice(*steps[-1].span)]
    if brief.edits[: len(steps)] != tuple(steps):
        question = Question(
            f'"{words}" comes after a change of the same sentence; is that change meant, or the '
            "one before it? Say first what is to be taken back."
        )
        raise Clarify(replace(brief, questions=(question,)))
    if brief.kept and not rest:
        kept = ", ".join(f'"{slot.text}"' for slot in brief.kept)
        question = Question(
            f"Going back takes a change back as a whole, {kept} too; say what is to be changed "
            "again, as in: undo it, then make b07 red."
        )
        raise Clarify(replace(brief, questions=(question,)))
    base = desk.led(map(_step, steps))
    if not rest:
        return replace(brief, edits=()), base
    here, there = (names_of(city, brief.text) for city in (desk.city, desk.at(base)))
    if here != there:
        again = read_brief(brief.text, base=True, names=there)
        rest = tuple(edit for edit in again.edits if edit.verb not in (UNDO, REDO))
    return replace(brief, edits=rest), base


def _step(edit: Edit) -> float:
    """Return how many changes an edit redoes, negative for those that it undoes."""
    count = next(value for key, value in edit.change if key == edit.verb)
    number = math.inf if count == "all" else max(float(count), 1.0)
    return -number if edit.verb == UNDO else number


def _on_curve(item: Item, record: Encapsulation, curves: Sequence[BlendCurves]) -> Item:
    """Give an action the points of the curve that its path is, if a .blend holds it."""
    for held in curves:
        if item.args.get("path") in held.lines and record.parameter("points") is not None:
            name = str(item.args["path"])
            return replace(item, args={**item.args, "points": held.line(name)})
        if item.action == FLOW and item.args.get("along") in held.lines:
            args = {key: value for key, value in item.args.items() if key in ON_PATH}
            name = str(item.args["along"])
            return replace(item, action=FOLLOWING, args={
                **args, "path": name, "points": held.line(name),
            })  # fmt: skip
    return item


def _along_curves(slots: Slots, text: str, curves: Sequence[BlendCurves]) -> Slots:
    """Take the curve of a .blend that a text names for the path, the longest name first."""
    names = sorted((name for held in curves for name in held.lines), key=len, reverse=True)
    for name in names:
        if re.search(rf"\b{re.escape(name)}\b", text, re.IGNORECASE):
            return {**slots, "path": (name,)}
    return slots


def wishes_in(files: Sequence[Path]) -> list[tuple[Path, str]]:
    """Return the texts among files, with their kind.

    Raises
    ------
    UsageError
        If one of them is no text: a built city is changed by words alone.
    """
    from cityx.sources.input_kinds import classify

    found = [classify(path) for path in files]
    other = [f"{item.path.name} is {item.kind}" for item in found if item.kind != "text"]
    if other:
        raise UsageError(f"A city is changed by words: {', '.join(other)}; give .txt or .md.")
    return [(item.path, item.kind) for item in found]


def _named(edit: Edit) -> str:
    return ", ".join(f"{key} {value}" for key, value in edit.items())


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
    folder: Path, city: City, request: Request, revision: Revision, say: Say = quiet, *,
    before: City | None = None, content: str = "", looking: Looking | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Update the existing views and the report of a changed city.

    `content` is the hash of the city before, "" where it is not known.

    What was added, whether all else is the same and which checks the change broke is told by the
    city as it was before, if that is given. The checks of the report of a large city stay those of
    the last `cityx check`, of which it tells the hash: there only what stands near the change is
    measured. What was seen of the change is told where somebody looked.
    """
    from cityx.checks.broken import broken_by_change
    from cityx.checks.report import counts, generators_of
    from cityx.checks.shell_checks import triangle_counts
    from cityx.projects.file_formats import formats
    from cityx.projects.views import renew_views

    present = [name for name, each in formats().items() if (folder / each.file).exists()]
    if present:
        then = None if before is None else (before, content)
        renew_views(city, folder, present, revision.content, before=then, say=say)
    path = folder / "report.json"
    report: dict[str, Any] = json.loads(path.read_text()) if path.exists() else {}
    goals = request.brief.goals
    findings = _findings(request, city, before)
    told = told_of(request.brief, city, before)
    deeds = [] if before is None or before is city else deeds_of(before, city)
    report["checks_of"] = report.get("checks_of", report.get("hash", ""))
    broken: dict[str, Any] = {}
    if before is not None:
        known = report.get("checks") if report["checks_of"] == report.get("hash") else None
        broken, checks = broken_by_change(before, city, known or None)
        if checks is not None:
            report |= {"checks": checks, "checks_of": revision.content}
    news = [note for note in city.notes if before is not None and note not in before.notes]
    report |= {
        "hash": revision.content, "revision": revision.number, "counts": counts(city),
        "generators": generators_of(city),
        "triangles": triangle_counts(city), "change": request.brief.to_json(),
        "reply_of_change": request.reply,
        "left_of_change": [
            {"text": one.text, "questions": [question.said for question in one.questions]}
            for one in request.brief.left
        ],
        "notes_of_change": [*request.notes, *news, *(looking.notes if looking else ())],
        "listed_of_change": told,
        "same_of_change": before is not None and revision.content == (
            content or report.get("hash", "")),
        "done_of_change": [one.to_json() for one in deeds],
        "chosen_of_change": [] if before is None else choices_of(request.brief, before),
        "checks_broken": broken,
        "goals_of_change": [
            {"goal": goal.text, "met": finding.met, "evidence": finding.evidence,
             "predicate": goal.predicate}
            for goal, finding in zip(goals, findings, strict=True)
        ],
    }  # fmt: skip
    seen = looking.told(report, "goals_of_change") if looking else {}
    stale = stale_views(folder, revision.content)
    report |= {"stale_views": stale}
    report["notes_of_change"] += stale_notes(stale)
    report |= {"verdict_of_change": seen.get("verdict"), "looks_of_change": seen.get("looks")}
    write_report(report, folder)
    return report


def _findings(request: Request, city: City, before: City | None) -> list[Finding]:
    """Measure the goals of a change: those that compare states on all of the city."""
    from cityx.checks.predicates import Finding, measure_all

    goals = [goal.predicate for goal in request.brief.goals]
    compare = [bool(COMPARING.search(goal)) for goal in goals]
    here = [goal for goal, whole in zip(goals, compare, strict=True) if not whole]
    everywhere = [goal for goal, whole in zip(goals, compare, strict=True) if whole]
    found = iter(measure_all(here, _about(request, city)) if here else ())
    compared = iter(measure_all(everywhere, city, before=before, together=goals))
    findings = [next(compared if whole else found) for whole in compare]
    if any(note.code == "not_checkable" for note in request.brief.notes):
        why = "cannot tell: nothing measures what all else is compared with"
        others = [goal == OTHERS for goal in goals]
        findings = [Finding(None, why) if o and not f.met else f
                    for f, o in zip(findings, others, strict=True)]  # fmt: skip
    return findings


def _about(request: Request, city: City) -> City:
    """Return a city whose shells are those that a change names, so that no others are measured.

    It is the city itself where a change is about more than buildings with names or ids.
    """
    from cityx.checks.predicates.facts import Facts
    from cityx.checks.predicates.thing_predicates import Absent, CannotTell

    batch = city.scene.meshes.get(SHELLS)
    targets = [edit.target for edit in request.brief.edits]
    if batch is None or not targets or any(one is None or not one.ids for one in targets):
        return city
    facts = Facts(city)
    words = {word for one in targets if one is not None for word in one.ids}
    try:
        ids = np.concatenate([facts.named(word).ids for word in sorted(words)])
    except (Absent, CannotTell):
        return city
    rows = np.flatnonzero(np.isin(batch.object_id, ids))
    if len(rows) != len(words):
        return city
    return replace(city, scene=city.scene.with_mesh(SHELLS, batch.take(rows)))
