"""Answers of people: checked when they come in, and counted with confidence intervals."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, nan, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from cityx.errors import InputError
from cityx.system.atomic import replaced
from cityx_bench.survey.study import ANSWERS, WORDS, Study

GROUPS = ("volunteer", "expert")
LEVEL = 0.95  # of the confidence intervals
_NAME = frozenset("abcdefghijklmnopqrstuvwxyz0123456789-")


@dataclass(frozen=True)
class Rating:
    """One number that one person gave."""

    participant: str
    group: str
    item: str
    question: str
    value: int
    again: bool  # whether the person saw the picture for the second time


def faults_of(record: Any, study: Study) -> list[str]:
    """Return what is wrong with the record that a page sends; none where it can be kept."""
    if not isinstance(record, dict):
        return ["The answer is no object."]
    faults = []
    name = record.get("participant")
    if not isinstance(name, str) or not 8 <= len(name) <= 64 or not set(name) <= _NAME:
        faults.append("participant is not of 8 to 64 letters a-z, digits and hyphens.")
    if record.get("group") not in GROUPS:
        faults.append(f"group is {record.get('group')!r}; {' or '.join(GROUPS)} is right.")
    if record.get("study") != study.digest:
        faults.append("The answer belongs to another study.")
    ratings = record.get("ratings")
    if not isinstance(ratings, list) or not ratings:
        return [*faults, "ratings is not a list with something in it."]
    most = (len(study.items) + study.repeats) * len(study.questions)
    if len(ratings) > most:
        return [*faults, f"{len(ratings)} ratings are more than the {most} of this study."]
    seen = set()
    questions = {question.name for question in study.questions}
    for k, one in enumerate(ratings):
        if not isinstance(one, dict):
            faults.append(f"ratings[{k}] is no object.")
            continue
        key = (one.get("item"), one.get("question"), bool(one.get("again")))
        value = one.get("value")
        if key[0] not in study.items or key[1] not in questions:
            faults.append(f"ratings[{k}] is of no picture and question of this study.")
        elif not isinstance(value, int) or isinstance(value, bool) or not 1 <= value <= len(WORDS):
            faults.append(f"ratings[{k}] is {value!r}; 1 to {len(WORDS)} is right.")
        elif key in seen:
            faults.append(f"ratings[{k}] is given twice.")
        seen.add(key)
    return faults


def keep(record: Mapping[str, Any], study: Study, folder: Path) -> Path:
    """Store what a person answered; later answers of the same person replace the earlier.

    Raises
    ------
    InputError
        Listing all that is wrong with it.
    """
    faults = faults_of(record, study)
    if faults:
        raise InputError(" ".join(faults))
    path = folder / ANSWERS / f"{record['participant']}.json"
    with replaced(path) as temporary:
        temporary.write_text(json.dumps(record, indent=1), encoding="utf-8")
    return path


def read_ratings(files: Iterable[Path], study: Study) -> list[Rating]:
    """Return the ratings of stored answers.

    Raises
    ------
    InputError
        Listing every file that cannot be read or belongs to another study.
    """
    found: dict[str, list[Rating]] = {}
    faults = []
    for path in sorted(files):
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            faults.append(f"{path}: {error}.")
            continue
        wrong = faults_of(record, study)
        if wrong:
            faults.append(f"{path}: {' '.join(wrong)}")
            continue
        found[record["participant"]] = [
            Rating(
                record["participant"], record["group"], one["item"], one["question"],
                one["value"], bool(one.get("again")),
            )
            for one in record["ratings"]
        ]  # fmt: skip
    if faults:
        raise InputError(" ".join(faults))
    return [one for name in sorted(found) for one in found[name]]


@dataclass(frozen=True)
class Score:
    """What people of a group think of a source, for one question.

    Attributes
    ----------
    people, ratings
        How many gave how many numbers, second looks apart.
    mean
        Of the people's own means, so that each person counts once.
    low, high
        Bounds of its interval of confidence (Student's t over people); NaN for one person alone.
    good
        Share of ratings of 4 and 5.
    """

    source: str
    group: str
    question: str
    people: int
    ratings: int
    mean: float
    low: float
    high: float
    good: float


def scores_of(ratings: Sequence[Rating], sources: Mapping[str, str], study: Study) -> list[Score]:
    """Return the scores of all sources, by group and question, the best first."""
    from scipy.stats import t

    found = []
    first = [one for one in ratings if not one.again]
    for group in GROUPS:
        for question in study.questions:
            table = []
            for source in sorted(set(sources.values())):
                own = [
                    one for one in first
                    if one.group == group and one.question == question.name
                    and sources[one.item] == source
                ]  # fmt: skip
                if not own:
                    continue
                by_person: dict[str, list[int]] = {}
                for one in own:
                    by_person.setdefault(one.participant, []).append(one.value)
                means = np.array([np.mean(values) for values in by_person.values()])
                mean, half = float(means.mean()), nan
                if len(means) > 1:
                    error = float(means.std(ddof=1)) / sqrt(len(means))
                    half = float(t.ppf(0.5 + LEVEL / 2, len(means) - 1)) * error
                good = float(np.mean([one.value >= 4 for one in own]))
                table.append(
                    Score(source, group, question.name, len(means), len(own), mean,
                          mean - half, mean + half, good)
                )  # fmt: skip
            found += sorted(table, key=lambda score: (-score.mean, score.source))
    return found


def steadiness(ratings: Sequence[Rating]) -> tuple[int, float]:
    """Return how many pictures were rated twice, and how far the two numbers lie apart in mean."""
    first = {(r.participant, r.item, r.question): r.value for r in ratings if not r.again}
    apart = [
        abs(first[key] - r.value)
        for r in ratings
        if r.again and (key := (r.participant, r.item, r.question)) in first
    ]
    return len(apart), float(np.mean(apart)) if apart else nan


def table_of(scores: Sequence[Score]) -> str:
    """Return scores as a table in Markdown."""
    rows = [
        "| question | asked | source | people | ratings | mean | 95 % interval | 4 and 5 |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for one in scores:
        sure = f"{one.low:.2f} to {one.high:.2f}" if isfinite(one.low) else "one person alone"
        rows.append(
            f"| {one.question} | {one.group}s | {one.source} | {one.people} | {one.ratings} "
            f"| {one.mean:.2f} | {sure} | {one.good:.0%} |"
        )
    return "\n".join(rows)
