"""The results of a benchmark: results.json, and results.md with the same numbers as tables."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cityx.system.atomic import replaced
from cityx_bench.scoring import Rate, Rates, Sample, fault_codes, rates_of, slot_score
from cityx_bench.tasks import CATEGORIES

LEAST_DETAIL = 2  # level below which windows, lamps and cars are left out
LONGEST = 110  # letters of evidence in a table


def results_of(samples: Sequence[Sample], command: str, title: str = "Agents") -> dict[str, Any]:
    """Return all numbers of a set of samples.

    Parameters
    ----------
    samples
        Of one driver.
    command
        That made them.
    title
        What was measured.
    """
    left_out = [s for s in samples if not s.scored]
    return {
        "title": title,
        "command": command,
        "driver": samples[0].driver if samples else "",
        "registry": samples[0].registry if samples else "",
        "lod": samples[0].lod if samples else None,
        "samples": len(samples),
        "rates": rates_of(samples).to_json(),
        "categories": {
            name: rates_of(own).to_json()
            for name in dict.fromkeys((*CATEGORIES, *(s.category for s in samples)))
            if (own := [s for s in samples if s.category == name])
        },
        "unsupported": {s.task: list(s.unsupported) for s in left_out},
        "faults": fault_codes(samples),
        "slots": slot_score(samples),
        "planning_s_most": max((s.planning_s for s in samples), default=0.0),
        "tasks": [_row(s) for s in samples],
    }  # fmt: skip


def _row(sample: Sample) -> dict[str, Any]:
    met = [goal["met"] for goal in sample.goals]
    return {
        "task": sample.task, "seed": sample.seed, "category": sample.category,
        "scored": sample.scored, "executed": sample.executed, "right": sample.right,
        "goals": {"met": met.count(True), "unmet": met.count(False), "open": met.count(None)},
        "causes": list(_causes(sample)), "seconds": sample.seconds,
    }  # fmt: skip


def _causes(sample: Sample) -> Iterator[str]:
    """Return why a sample is not right: what no action serves, failed steps, what was missed."""
    yield from (f"no action serves {name}" for name in sample.unsupported)
    yield from (f"{f['code']} {f['action']}: {f['message']}" for f in sample.faults)
    for goal in sample.goals:
        if not goal["met"]:
            yield f"{goal['predicate']}: {goal['evidence']}"
    yield from (f"not clean: {rule['evidence']}" for rule in sample.clean if not rule["met"])


def write_results(
    samples: Sequence[Sample], command: str, folder: Path, *, title: str = "Agents"
) -> dict[str, Any]:
    """Write results.json and results.md into a folder and return the numbers."""
    found = results_of(samples, command, title)
    with replaced(folder / "results.json") as temporary:
        temporary.write_text(json.dumps(found, indent=1, allow_nan=False), encoding="utf-8")
    with replaced(folder / "results.md") as temporary:
        temporary.write_text("\n".join(_lines(found, samples)) + "\n", encoding="utf-8")
    return found


def _lines(found: dict[str, Any], samples: Sequence[Sample]) -> Iterator[str]:
    yield f"# {found['title']}, driver {found['driver']}"
    yield f"\n`{found['command']}`\n"
    yield from tables_of(found, samples, found["tasks"])


def tables_of(
    found: dict[str, Any], samples: Sequence[Sample], rows: Sequence[dict[str, Any]]
) -> Iterator[str]:
    """Yield the tables of results, without a title.

    Parameters
    ----------
    found
        As of `results_of`.
    samples
        They are of.
    rows
        Those of ``found["tasks"]`` that are listed.
    """
    yield (f"{found['samples']} proposals; {len(found['unsupported'])} ask for what no action "
           "serves and count as neither.")  # fmt: skip
    if found["lod"] is not None and found["lod"] < LEAST_DETAIL:
        yield (f"Built at level of detail {found['lod']}: windows, lamps and parked cars are left "
               "out, so that goals about them are missed.")  # fmt: skip
    yield "\n| category | executed (ER@1) | right of executed (SR@1) | right of all |"
    yield "| --- | --- | --- | --- |"
    for name in found["categories"]:
        yield _rates_row(name, rates_of(s for s in samples if s.category == name))
    yield _rates_row("all", rates_of(samples))
    yield from counts_table("code of a fault", found["faults"])
    if found["slots"]:
        said = found["slots"]
        yield (f"\nReading: precision {said['precision']:.3f}, recall {said['recall']:.3f}, "
               f"F1 {said['f1']:.3f} over {said['slots']} slots; planning takes "
               f"{found['planning_s_most']:.2f} s at most.")  # fmt: skip
    if rows:
        yield "\n| task | seed | executed | right | goals met, unmet, open | s | cause |"
        yield "| --- | --- | --- | --- | --- | --- | --- |"
        yield from map(_task_row, rows)


def _rates_row(name: str, rates: Rates) -> str:
    cells = (rate_cell(rate) for rate in (rates.executed, rates.right_of_executed, rates.right))
    return f"| {name} | {' | '.join(cells)} |"


def rate_cell(rate: Rate) -> str:
    """Return counts, percent and interval in one cell."""
    low, high = rate.interval
    return f"{rate.hits}/{rate.total} = {rate.percent:.2f} % ({low:.0f}-{high:.0f})"


def counts_table(title: str, counts: Mapping[str, int]) -> Iterator[str]:
    """Yield a table of counts, nothing where there are none."""
    if counts:
        yield f"\n| {title} | times |"
        yield "| --- | --- |"
        yield from (f"| {name} | {times} |" for name, times in counts.items())


def _task_row(row: dict[str, Any]) -> str:
    goals = row["goals"]
    said = "; ".join(_short(text) for text in row["causes"])
    marks = ["-" if not row["scored"] else "yes" if row[name] else "no"
             for name in ("executed", "right")]  # fmt: skip
    return (f"| {row['task']} | {row['seed']} | {marks[0]} | {marks[1]} | {goals['met']}, "
            f"{goals['unmet']}, {goals['open']} | {row['seconds']:.0f} | {said} |")  # fmt: skip


def _short(text: str) -> str:
    line = " ".join(text.split()).replace("|", "/")
    return line if len(line) <= LONGEST else line[: LONGEST - 1] + "…"


def summary(found: dict[str, Any]) -> Iterable[str]:
    """Yield the lines that a command prints."""
    rates = found["rates"]
    names = (("executed", "executed"), ("right_of_executed", "right of executed"),
             ("right", "right of all"))  # fmt: skip
    for key, words in names:
        rate = Rate(rates[key]["hits"], rates[key]["of"])
        yield f"{words:<18} {rate_cell(rate)}"
    if found["unsupported"]:
        said = ", ".join(f"{task} ({', '.join(w)})" for task, w in found["unsupported"].items())
        yield f"not counted        {said}"
    for row in found["tasks"]:
        if row["scored"] and not row["right"]:
            yield f"{row['task']}: {'; '.join(_short(text) for text in row['causes'])}"
