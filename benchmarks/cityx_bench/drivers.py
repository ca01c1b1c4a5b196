"""Drivers that solve a task, behind one interface, ``propose(place) -> outcome``."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

from cityx.agents.ablation import arm_of
from cityx.agents.briefs import Request, read_request
from cityx.agents.planning.planner import OfflinePlanner, Situation
from cityx.checks.predicates import Reply
from cityx.city import City
from cityx.errors import InputError, UsageError, nearest
from cityx.ids import id_text
from cityx.language import Brief, Selector
from cityx.language.asked import slots_of_brief
from cityx.language.brief import Clarify
from cityx.language.references.resolved_changes import slots_of_edits
from cityx.language.references.selecting import choose
from cityx.options import BuildOptions, PlannerChoice
from cityx.projects.build import build
from cityx.projects.desk import Desk
from cityx.projects.edit import OFFLINE, edit_city, led
from cityx.protocol.catalogue import known_records
from cityx.protocol.gate import Call
from cityx.protocol.registry import registry
from cityx.sources.intake import sort_inputs
from cityx_bench.outcome import Outcome, Workplace, acted, fault_of
from cityx_bench.random_driver import random_outcome
from cityx_bench.tasks import MOVING, SlotPair

GOLD = Path(__file__).with_name("gold.json")
NO_GOLD = "a gold plan"
NAMES = ("offline", "null", "random", "oracle")
LLM, REPLAY, EXPORT = "llm", "replay", "export"


class Driver(Protocol):
    """Solves tasks."""

    def propose(self, place: Workplace) -> Outcome:
        """Return the first complete proposal for a task, carried out."""


def driver_named(name: str) -> Driver:
    """Return a driver.

    Parameters
    ----------
    name
        One of `NAMES`, or "llm:SPEC", "replay:FILE" or "export:FILE"; "offline:DL" plans by
        descriptions and limitations alone, see `cityx.agents.ablation`.

    Raises
    ------
    UsageError
        If there is none.
    """
    word, _, detail = name.partition(":")
    if word in (LLM, REPLAY, EXPORT):
        return Models(planner_choice(word, detail))
    if word == "offline" and detail:
        return Offline(PlannerChoice(shown=arm_of(detail)))
    made: Mapping[str, Callable[[], Driver]] = {
        "offline": Offline, "null": Null, "random": Random, "oracle": Oracle,
    }  # fmt: skip
    if name not in made:
        raise UsageError(
            f'There is no driver "{name}"; one of {", ".join(NAMES)}, llm:SPEC, replay:FILE, '
            f"export:FILE.{nearest(name, NAMES)}"
        )
    return made[name]()


def planner_choice(word: str, detail: str) -> PlannerChoice:
    """Return who plans where a language model drives.

    Parameters
    ----------
    word
        "llm", "replay" or "export".
    detail
        A model as of ``--planner``, perhaps with "@" and the address of its server; or a file of
        recorded decisions; or one of prompts.

    Raises
    ------
    UsageError
        If nothing is named.
    """
    if not detail:
        example = "openai-chat:MODEL" if word == LLM else "FILE"
        raise UsageError(f'Driver "{word}" needs what to ask: {word}:{example}.')
    if word == REPLAY:
        return PlannerChoice(planner=REPLAY, replay=detail, look=False)
    if word == EXPORT:
        return PlannerChoice(export=detail, look=False)
    spec, _, address = detail.partition("@")
    return PlannerChoice(planner=spec, base_url=address, look=False)


class Models:
    """Builds and changes cities as the command line does with ``--planner``.

    Parameters
    ----------
    choice
        Which model, or which recorded decisions.
    """

    def __init__(self, choice: PlannerChoice) -> None:
        self._choice = choice

    def propose(self, place: Workplace) -> Outcome:
        """Read and plan with the model, and build or change the city."""
        if place.based:
            return carried_out(
                place,
                Outcome(place.start, Reply("done")),
                lambda: edit_city(
                    place.folder, place.task.text, files=place.files, choice=self._choice
                ),
            )
        options = replace(_options(place, place.task.text), choice=self._choice)
        return carried_out(
            place,
            Outcome(place.start, Reply("done")),
            lambda: build(place.files, place.folder, options),
        )


class Offline:
    """Does what the command line does.

    Parameters
    ----------
    choice
        What of the actions' records is planned by.
    """

    def __init__(self, choice: PlannerChoice = OFFLINE) -> None:
        self._choice = choice

    def propose(self, place: Workplace) -> Outcome:
        """Read the text, plan, and build or change the city."""
        begin = time.perf_counter()
        options = replace(_options(place, place.task.text), choice=self._choice)
        try:
            files = [(item.path, item.kind) for item in sort_inputs(place.files).all]
            known = place.start if place.based else None
            request = read_request(options, files, base=place.based, city=known)
            unsupported = _planned(place, request, files)
        except Clarify as error:
            return _asked_back(place, error.brief, time.perf_counter() - begin)
        except (InputError, UsageError) as error:
            return Outcome(place.start, Reply("partial"), (fault_of(error),))
        spent = time.perf_counter() - begin
        reply = Reply("partial" if unsupported else request.reply, _mentions(request, unsupported))
        outcome = Outcome(place.start, reply, (), unsupported, _slots(request.brief), spent)
        if place.based and unsupported:
            return outcome  # a change happens whole or not at all
        if place.based:
            return carried_out(
                place, outcome,
                lambda: edit_city(
                    place.folder, place.task.text, files=place.files, choice=self._choice
                ),
            )  # fmt: skip
        return carried_out(place, outcome, lambda: build(place.files, place.folder, options))


def carried_out(place: Workplace, outcome: Outcome, do: Callable[[], object]) -> Outcome:
    """Do something to the city of a task and return the outcome with what came of it."""
    begin = time.perf_counter()
    try:
        do()
    except Clarify as error:
        return _asked_back(place, error.brief, time.perf_counter() - begin)
    except Exception as error:  # noqa: BLE001  a benchmark counts what breaks, and goes on
        return acted(place, replace(outcome, faults=(fault_of(error),)))
    return acted(place, replace(outcome, city=place.city()))


def _options(place: Workplace, text: str = "") -> BuildOptions:
    return BuildOptions(text=text, seed=place.seed, lod=place.lod, formats=(), render=False)


def _slots(brief: Brief) -> tuple[SlotPair, ...]:
    return tuple((key, value) for key, value in brief.items())


def _asked_back(place: Workplace, brief: Brief, spent: float) -> Outcome:
    mentions = {f"conflict:{c.code.rpartition(':')[2]}" for c in brief.conflicts}
    mentions |= {"question"} if brief.questions else set()
    reply = Reply("clarify", frozenset(mentions))
    return Outcome(place.start, reply, slots=_slots(brief), planning_s=spent)


def _mentions(request: Request, unsupported: Iterable[str]) -> frozenset[str]:
    notes = {note.code for note in request.brief.notes}
    return frozenset(notes | {f"unsupported:{name}" for name in unsupported})


def _planned(place: Workplace, request: Request, files: list[tuple[Path, str]]) -> tuple[str, ...]:
    """Plan, and return what nothing serves: changes without an action, and what moves.

    A slot that nothing serves is one without which the plan is the same. Only what moves is looked
    for so; other slots may be met by a usual town, which their goals tell.
    """
    planner = OfflinePlanner(known_records(registry()))
    if place.based:
        with Desk(place.folder) as desk:
            changes, base = led(desk, request)
            city = place.start if base is None else desk.at(base)
        return tuple(
            f"edit={edit.verb}"
            for edit, slots in slots_of_edits(changes, city)
            if not planner.answers(slots)
        )
    situation = Situation(place.lod, tuple(kind for _, kind in files))
    plan = planner.workflow(request.slots, situation)
    said = slots_of_brief(request.brief)
    options = {key: value for key, value in request.slots.items() if key not in said}
    found = []
    for slot in request.brief.slots:
        if slot.key in MOVING:
            others = tuple(other for other in request.brief.slots if other is not slot)
            less = slots_of_brief(replace(request.brief, slots=others))
            if planner.workflow({**less, **options}, situation).items == plan.items:
                found.append(f"{slot.key}={slot.value}")
    return tuple(found)


class Null:
    """Does nothing: what it gets right could be had for nothing."""

    def propose(self, place: Workplace) -> Outcome:
        """Return the city as it was."""
        return Outcome(place.start, Reply("done"))


class Random:
    """Runs actions drawn at random, with arguments drawn at random, that the gate lets pass."""

    def propose(self, place: Workplace) -> Outcome:
        """Run a few actions."""
        return random_outcome(place, registry())


class Oracle:
    """Carries out the plan that is written down for a task; it must always be right.

    Parameters
    ----------
    plans
        Task to its plan; those of `GOLD` by default.
    """

    def __init__(self, plans: Mapping[str, Mapping[str, Any]] | None = None) -> None:
        self._plans = json.loads(GOLD.read_text()) if plans is None else plans

    def propose(self, place: Workplace) -> Outcome:
        """Carry the plan out, or say that there is none."""
        plan = self._plans.get(place.task.id)
        if plan is None:
            return Outcome(place.start, Reply("partial"), unsupported=(NO_GOLD,))
        reply = Reply(plan.get("reply", "done"), frozenset(plan.get("mentions", ())))
        outcome = Outcome(place.start, reply)
        if "calls" in plan:
            calls = [Call(action, _named(place.start, args)) for action, args in plan["calls"]]
            return carried_out(place, outcome, lambda: change(place, calls))
        if "build" not in plan:
            return outcome
        traced = [place.inputs[name] for name in plan.get("files", ())]  # by who sees a picture

        def do() -> None:
            build(traced or place.files, place.folder, _gold(place, plan["build"]))
            if "then" in plan:
                city = place.city()
                change(place, [Call(action, _named(city, args)) for action, args in plan["then"]])

        return carried_out(place, outcome, do)


def _named(city: City, args: Mapping[str, Any]) -> dict[str, Any]:
    """Return arguments of a plan with the ids of what it names: {"kind": "tree", "inside": "p"}."""
    return {
        key: tuple(id_text(int(one)) for one in choose(Selector(**value), city).ids)
        if isinstance(value, dict)
        else value
        for key, value in args.items()
    }


def _gold(place: Workplace, said: Mapping[str, Any]) -> BuildOptions:
    """Return the options of a plan: lists in JSON are tuples here."""
    given: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value for key, value in said.items()
    }
    return replace(_options(place), **given)


def change(place: Workplace, calls: list[Call]) -> City:
    """Run actions on the base scene of a task and return the city.

    Raises
    ------
    CityxError
        As of `Desk.change`.
    """
    with Desk(place.folder) as desk:
        desk.change(calls, text=place.task.text)
        return desk.city
