"""The benchmark of edits: sentences that change base scenes, and sentences that must be refused.

Of each class of the paper (assets, weather, style) there are twenty; twenty more name nothing, name
several things, contradict themselves or ask for what cannot be. A second set was left alone until
it had been run once, and tuned to by the classes of sentences that failed; a third was written and
run after that, so that it tells what the others do not.
"""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from cityx.agents.requests import with_requests
from cityx.checks.predicates import clean, measure_all
from cityx.city.content import content_hash
from cityx.protocol.registry import registry
from cityx.system.atomic import replaced
from cityx_bench.drivers import Offline, change
from cityx_bench.outcome import CRASH, Outcome, Workplace
from cityx_bench.runner import build_scene, scene_folder
from cityx_bench.scenes import LOD
from cityx_bench.scoring import Rate
from cityx_bench.tasks import Task, read_tasks

EDITS = Path(__file__).with_name("edits.json")
HELD_BACK = Path(__file__).with_name("edits_held.json")
UNSEEN = Path(__file__).with_name("edits_unseen.json")
HELD = "held_"  # begins the ids of the second and the third set
REFUSE = "refuse"
CLASSES = ("asset", "weather", "style", REFUSE)
Say = Callable[[str], None]


@dataclass(frozen=True)
class Result:
    """What came of one sentence.

    Attributes
    ----------
    task, group, text
        Id, one of `CLASSES`, and the sentence.
    right
        Whether all came about as asked and nothing else, or whether it was refused as it must be.
    reply
        What was answered: an action that ran, a question, a refusal.
    causes
        Why it is not right.
    seconds
        Processor time of the change, without the measurement.
    """

    task: str
    group: str
    text: str
    right: bool
    reply: str
    causes: tuple[str, ...]
    seconds: float


def class_of(task: Task) -> str:
    """Return the class of a task, by its id."""
    return task.id.removeprefix(HELD).rstrip("0123456789")


def run_edits(tasks: Sequence[Task], out: Path, say: Say) -> list[Result]:
    """Change a fresh copy of its scene by each sentence and measure what came of it.

    Parameters
    ----------
    tasks
        Sentences with their scenes and predicates.
    out
        Folder of scenes and results.
    say
        Called with a line for each.
    """
    for name in sorted({task.base for task in tasks}):
        folder = scene_folder(out, name)
        if not (folder / "city").exists():
            say(f"building the scene {name}")
            build_scene(name, folder)
    found = []
    for task in tasks:
        result = _tried(task, out)
        causes = f": {'; '.join(result.causes)}" if result.causes else ""
        say(f"{task.id} {'right' if result.right else 'wrong'}{causes}")
        found.append(result)
    return found


def _tried(task: Task, out: Path) -> Result:
    folder = out / "work" / task.id
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(scene_folder(out, task.base), folder)
    place = Workplace.opened(task, folder, {}, seed=0, lod=LOD)
    if task.setup:
        change(place, [item.call for item in with_requests([], (), task.setup, registry())])
        place = Workplace.opened(task, folder, {}, seed=0, lod=LOD)
    begin = time.process_time()
    outcome = Offline().propose(place)
    spent = time.process_time() - begin
    refused = class_of(task) == REFUSE
    causes = tuple(_faults_of_refusal(place, outcome) if refused else _faults(place, outcome))
    shutil.rmtree(folder, ignore_errors=True)
    return Result(task.id, class_of(task), task.text, not causes, _said(outcome), causes,
                  round(spent, 3))  # fmt: skip


def _said(outcome: Outcome) -> str:
    if outcome.faults:
        return outcome.faults[0].message.splitlines()[0]
    if outcome.unsupported:
        return f"no action serves {', '.join(outcome.unsupported)}"
    return " ".join(outcome.reply.actions) or outcome.reply.kind


def _faults(place: Workplace, outcome: Outcome) -> Iterator[str]:
    """Yield why a change is not as it was asked for."""
    if outcome.reply.kind == "clarify":
        yield "it asked back"
    yield from (f"no action serves {name}" for name in outcome.unsupported)
    yield from (f"{fault.code}: {fault.message}" for fault in outcome.faults)
    if outcome.reply.kind == "clarify" or outcome.unsupported or outcome.faults:
        return
    goals = measure_all(place.task.expect, outcome.city, before=place.start, reply=outcome.reply)
    for text, goal in zip(place.task.expect, goals, strict=True):
        if not goal.met:
            yield f"{text}: {goal.evidence}"
    yield from (f"not clean: {rule.evidence}" for rule in clean(outcome.city) if not rule.met)


def _faults_of_refusal(place: Workplace, outcome: Outcome) -> Iterator[str]:
    """Yield why a sentence was not refused as it must be: with a reason, and nothing changed."""
    yield from (fault.message for fault in outcome.faults if fault.code == CRASH)
    if outcome.reply.kind != "clarify" and not outcome.faults and not outcome.unsupported:
        yield f"it was done: {' '.join(outcome.reply.actions) or 'nothing'}"
    if content_hash(place.city()).total != content_hash(place.start).total:
        yield "the city changed"


def tables(results: Sequence[Result]) -> dict[str, Rate]:
    """Return how many of each class are right, and of all that are changes."""
    found = {}
    for name in CLASSES:
        own = [result for result in results if result.group == name]
        if own:
            found[name] = Rate(sum(result.right for result in own), len(own))
    edits = [result for result in results if result.group != REFUSE]
    return {**found, "edits": Rate(sum(result.right for result in edits), len(edits))}


def write_edits(results: Sequence[Result], command: str, out: Path) -> list[str]:
    """Write edits.json into a folder and return the lines that a command prints."""
    rates = tables(results)
    record: dict[str, Any] = {
        "command": command,
        "rates": {name: rate.to_json() for name, rate in rates.items()},
        "seconds_most": max((result.seconds for result in results), default=0.0),
        "results": [asdict(result) for result in results],
    }
    with replaced(out / "edits.json") as temporary:
        temporary.write_text(json.dumps(record, indent=1, ensure_ascii=False), encoding="utf-8")
    lines = [f"{name:<8} {rate.hits}/{rate.total}" for name, rate in rates.items()]
    lines += [f'{r.task} "{r.text}": {"; ".join(r.causes)}' for r in results if not r.right]
    return lines


def sentences(
    *, held: bool = False, unseen: bool = False, only: Sequence[str] = ()
) -> tuple[Task, ...]:
    """Return the sentences of the benchmark, of the second set or of the third."""
    return read_tasks(UNSEEN if unseen else HELD_BACK if held else EDITS, only)
