"""Explain a brief in words: what is understood, and what would be done."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cityx.agents.briefs import IN_PART, Request, read_request
from cityx.agents.planning.planner import OfflinePlanner, Situation
from cityx.agents.planning.workflow import Item
from cityx.options import BuildOptions


def explain(text: str, paths: Sequence[Path] = ()) -> dict[str, Any]:
    """Return the brief of an instruction and the plan for it; nothing is run or written.

    Raises
    ------
    Clarify
        If the instruction contradicts itself or leaves open what is meant.
    InputError
        If a file is of no use.
    """
    from cityx.protocol.catalogue import known_records
    from cityx.protocol.registry import registry

    files: list[tuple[Path, str]] = []
    if paths:
        from cityx.sources.intake import sort_inputs

        files = [(item.path, item.kind) for item in sort_inputs(list(paths)).all]
    options = BuildOptions(text=text)
    request = read_request(options, files)
    planner = OfflinePlanner(known_records(registry()))
    situation = Situation(options.lod, tuple(kind for _, kind in files))
    plan = planner.workflow(request.slots, situation)
    return explained(request, plan.items, plan.missing)


def explained(
    request: Request, plan: Sequence[Item], missing: Sequence[str] = ()
) -> dict[str, Any]:
    """Return a brief and its plan as plain values.

    Parameters
    ----------
    request
        What is wanted.
    plan
        Items of the workflow.
    missing
        What nothing can bring about.
    """
    from cityx.language.scene import scene_of

    return {
        "text": request.brief.text,
        "scene": scene_of(request.brief).told(),
        "brief": request.brief.to_json(),
        "asked": [list(pair) for pair in request.brief.items()],
        "reply": request.reply,
        "notes": list(request.notes),
        "goals": [{"goal": g.text, "predicate": g.predicate} for g in request.brief.goals],
        "workflow": [item.to_json() for item in plan],
        "missing": list(missing),
    }


def explanation(found: Mapping[str, Any]) -> str:
    """Return what `explain` found as lines of text."""
    return "\n".join(_lines(found))


def _lines(found: Mapping[str, Any]) -> Iterator[str]:
    if found["asked"]:
        yield "asked for"
        width = max(len(str(key)) for key, _ in found["asked"])
        yield from (f"  {key:<{width}}  {value}" for key, value in found["asked"])
    if found["goals"]:
        yield "measured by"
        yield from (f"  {goal['predicate']}" for goal in found["goals"])
    yield from (f"note: {text}" for text in found["notes"])
    yield "plan"
    for place, item in enumerate(found["workflow"], start=1):
        args = " ".join(f"{name}={value}" for name, value in item["args"].items())
        why = f"  ({item['why']})" if item["why"] else ""
        yield f"  {place:2d} {item['action']}{' ' + args if args else ''}{why}"
    yield from (f"missing: {text}" for text in found["missing"])
    if found["reply"] == IN_PART:
        yield "Understood in part: the notes name what is not understood or is left open."
