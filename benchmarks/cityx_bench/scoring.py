"""Scoring: a proposal becomes a sample, samples become rates with their uncertainty."""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from math import isclose, isnan, sqrt
from typing import Any

from cityx.checks.predicates import Finding, clean, measure_all, parse
from cityx.city import City
from cityx.errors import CityxError
from cityx_bench.drivers import Driver
from cityx_bench.outcome import Outcome, Workplace
from cityx_bench.quality import measured
from cityx_bench.tasks import SlotPair, Task

Z = 1.959964  # of the normal distribution, for 95 %
NEARLY = 1e-3  # relative, by which a number that was read may miss the one that is meant
CLARIFY = "CLARIFY"  # code of a question that no task asked for


@dataclass(frozen=True)
class Rate:
    """So many of so many.

    Attributes
    ----------
    hits, total
        Counts.
    """

    hits: int
    total: int

    @property
    def percent(self) -> float:
        """The share, percent with two digits; 0 of nothing."""
        return round(100 * self.hits / self.total, 2) if self.total else 0.0

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95 % interval of the share, percent; all of it where nothing was tried.

        References
        ----------
        E. B. Wilson, Probable inference, the law of succession, and statistical inference, 1927.
        """
        if not self.total:
            return 0.0, 100.0
        n, p = self.total, self.hits / self.total
        middle = (p + Z * Z / (2 * n)) / (1 + Z * Z / n)
        half = Z / (1 + Z * Z / n) * sqrt(p * (1 - p) / n + Z * Z / (4 * n * n))
        return round(100 * max(middle - half, 0.0), 2), round(100 * min(middle + half, 1.0), 2)

    def to_json(self) -> dict[str, Any]:
        """Return counts, percent and interval."""
        return {"hits": self.hits, "of": self.total, "percent": self.percent,
                "interval": list(self.interval)}  # fmt: skip


@dataclass(frozen=True)
class Rates:
    """The three rates of a set of proposals.

    Attributes
    ----------
    executed
        ER@1: proposals in which every step passed the gate and ran, of all.
    right_of_executed
        SR@1 as the paper defines it: those that are right, of the executed ones.
    right
        Those that are right, of all.
    """

    executed: Rate
    right_of_executed: Rate
    right: Rate

    @classmethod
    def of(cls, total: int, executed: int, right: int) -> Rates:
        """Return the rates of counts."""
        return cls(Rate(executed, total), Rate(right, executed), Rate(right, total))

    def to_json(self) -> dict[str, Any]:
        """Return the rates by name."""
        return {name: rate.to_json() for name, rate in vars(self).items()}


@dataclass(frozen=True)
class Sample:
    """One proposal, measured; what the log keeps.

    Attributes
    ----------
    task, digest, category
        Which task.
    driver, seed, lod, registry
        Who did it, with what.
    scored
        Whether it counts: not where something is asked for that no action serves.
    executed, right
        See `Rates`.
    goals
        Predicates with what was measured: met, unmet, or None where it cannot be told.
    clean
        Rules of a clean city, in the same form.
    faults
        Steps that did not run to their end.
    unsupported
        What no action serves.
    reply
        What was answered and done.
    slots
        Items read and meant, and those that agree; empty where the driver reads none.
    quality
        Measures of `cityx_bench.quality` of a city that was generated, None where there was
        nothing to measure; empty for a change of a city.
    planning_s, seconds
        Until it was known what to do, and in all.
    """

    task: str
    digest: str
    category: str
    driver: str
    seed: int
    lod: int
    registry: str
    scored: bool
    executed: bool
    right: bool
    goals: Sequence[Mapping[str, Any]]
    clean: Sequence[Mapping[str, Any]]
    faults: Sequence[Mapping[str, str]]
    unsupported: Sequence[str]
    reply: Mapping[str, Any]
    slots: Mapping[str, int]
    quality: Mapping[str, float | None]
    planning_s: float
    seconds: float

    @property
    def key(self) -> tuple[str, str, int, str, int, str]:
        """What makes it the same sample; one that is in the log is not run again."""
        return self.task, self.digest, self.seed, self.driver, self.lod, self.registry

    def to_json(self) -> dict[str, Any]:
        """Return a plain dictionary."""
        return asdict(self)


def judged(place: Workplace, driver: Driver, name: str, registry: str) -> Sample:
    """Run a driver on a task and measure the result.

    Parameters
    ----------
    place
        Where, and which task.
    driver, name
        Who, and what it is called.
    registry
        Digest of the actions.
    """
    begin = time.perf_counter()
    outcome = driver.propose(place)
    task = place.task
    before = place.start if place.based else None
    unknown = unmeasurable(task)
    asked = [text for text in task.expect if text not in unknown]
    found = measure_all(
        asked, outcome.city, before=before, inputs=place.inputs, reply=outcome.reply
    )
    told = {**dict(zip(asked, found, strict=True)), **unknown}
    goals = [told[text] for text in task.expect]
    rules = clean(outcome.city)
    faults = [fault._asdict() for fault in outcome.faults]
    if outcome.reply.kind == "clarify" and task.category != "clarify":
        faults.append({"code": CLARIFY, "action": "", "message": "it asked back"})
    executed = not faults and not outcome.unsupported
    right = executed and all(finding.met for finding in (*goals, *rules))
    return Sample(
        task.id, task.digest, task.category, name, place.seed, place.lod, registry,
        not outcome.unsupported, executed, right,
        [{"predicate": text, **_said(found)}
         for text, found in zip(task.expect, goals, strict=True)],
        [_said(found) for found in rules],
        faults, list(outcome.unsupported), _reply(outcome), slot_counts(task, outcome.slots),
        _quality(place, outcome.city), round(outcome.planning_s, 3),
        round(time.perf_counter() - begin, 3),
    )  # fmt: skip


def unmeasurable(task: Task) -> dict[str, Finding]:
    """Return what a task expects that is no predicate: whether it holds cannot be told."""
    found = {}
    for text in task.expect:
        try:
            parse(text)
        except CityxError as error:
            found[text] = Finding(None, str(error))
    return found


def _quality(place: Workplace, city: City) -> dict[str, float | None]:
    """Return the measures of a city that was generated, {} where none was or one was changed."""
    path = place.folder / "report.json"
    if place.based or not path.exists():
        return {}
    report = json.loads(path.read_text(encoding="utf-8"))
    found = measured(city, report, place.files)
    return {name: None if isnan(value) else round(value, 4) for name, value in found.items()}


def _said(found: Finding) -> dict[str, Any]:
    return {"met": found.met, "evidence": found.evidence}


def _reply(outcome: Outcome) -> dict[str, Any]:
    said = outcome.reply
    return {"kind": said.kind, "mentions": sorted(said.mentions), "actions": list(said.actions),
            "mutations": said.mutations}  # fmt: skip


def slot_counts(task: Task, said: Sequence[SlotPair] | None) -> dict[str, int]:
    """Return how many slots a text has, how many were read, and how many of both agree."""
    if said is None:
        return {}
    left = list(said)
    both = 0
    for meant in task.slots:
        found = next((pair for pair in left if _agree(meant, pair)), None)
        if found is not None:
            left.remove(found)
            both += 1
    return {"meant": len(task.slots), "read": len(said), "both": both}


def _agree(one: SlotPair, other: SlotPair) -> bool:
    if one[0] != other[0]:
        return False
    try:
        return isclose(float(one[1]), float(other[1]), rel_tol=NEARLY)
    except ValueError:
        return str(one[1]) == str(other[1])


def rates_of(samples: Iterable[Sample]) -> Rates:
    """Return the rates of the samples that count."""
    counted = [sample for sample in samples if sample.scored]
    return Rates.of(
        len(counted), sum(s.executed for s in counted), sum(s.right for s in counted)
    )  # fmt: skip


def fault_codes(samples: Iterable[Sample]) -> dict[str, int]:
    """Return how often each code ended a step, the most frequent first."""
    counts = Counter(fault["code"] for sample in samples for fault in sample.faults)
    return dict(sorted(counts.items(), key=lambda pair: (-pair[1], pair[0])))


def slot_score(samples: Iterable[Sample]) -> dict[str, float]:
    """Return precision, recall and F1 of the reading over all slots, {} where nothing was read."""
    total = Counter[str]()
    for sample in samples:
        total.update(sample.slots)
    if not total["meant"]:
        return {}
    precision = total["both"] / max(total["read"], 1)
    recall = total["both"] / total["meant"]
    both = precision + recall
    return {"precision": round(precision, 4), "recall": round(recall, 4),
            "f1": round(2 * precision * recall / both, 4) if both else 0.0,
            "slots": total["meant"]}  # fmt: skip
