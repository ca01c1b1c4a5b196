"""Actions as clients see them: found by words, told in full, called through the gate."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from typing import Any

from cityx.agents.annotator import labels_of
from cityx.errors import UsageError
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.formats import Format
from cityx.protocol.registry import Registry
from cityx.protocol.stages import to_stage

MOST_FOUND = 40  # of a search; more drown a model
# How much a word of the query counts by where it stands.
_IN_NAME, _IN_LABELS, _IN_TEXT = 4.0, 2.0, 1.0
_STEM = 4  # letters that two words must share to count as one: "trees" finds "tree"


def search(
    records: Iterable[Encapsulation], query: str, stage: str, formats: Iterable[str]
) -> list[dict[str, Any]]:
    """Return the actions that suit some words, best first.

    Parameters
    ----------
    query
        Words, "" for all.
    stage
        Stage they must belong to, "" for any.
    formats
        Data formats of which each must come in or go out.

    Raises
    ------
    UsageError
        If there is no such stage or format.
    """
    if stage:
        to_stage(stage)
    wanted = set(formats)
    known = [item.value for item in Format]
    if wanted - set(known):
        raise UsageError(f"There are no formats {sorted(wanted - set(known))}; known are {known}.")
    rows = []
    for record in records:
        score = _score(record, query)
        if (stage and record.stage != stage) or not wanted <= _formats(record) or not score:
            continue
        rows.append((-score, record.id, record))
    return [_line(record) for _, _, record in sorted(rows, key=lambda row: row[:2])]


def _formats(record: Encapsulation) -> set[str]:
    return {port.format.value for port in (*record.takes, *record.gives)}


def _score(record: Encapsulation, query: str) -> float:
    words = _words(query)
    if not words:
        return 1.0
    places = (
        (_IN_NAME, _words(f"{record.name} {record.classname}")),
        (_IN_LABELS, _words(" ".join(labels_of(record)))),
        (_IN_TEXT, _words(record.description)),
    )
    return sum(
        max((weight for weight, held in places if _among(word, held)), default=0.0)
        for word in words
    )


def _words(text: str) -> set[str]:
    return set(re.findall(r"[a-z]{2,}", text.lower().replace("_", " ")))


def _among(word: str, held: set[str]) -> bool:
    if word in held:
        return True
    return any(
        len(shorter) >= _STEM and longer.startswith(shorter)
        for other in held
        for shorter, longer in [sorted((word, other), key=len)]
    )


def _line(record: Encapsulation) -> dict[str, Any]:
    return {
        "id": record.id, "does": record.description, "stage": record.stage.value,
        "arguments": [p.name for p in record.parameters],
    }  # fmt: skip


def doc(actions: Registry, name: str) -> dict[str, Any]:
    """Return the whole record of an action.

    Raises
    ------
    UsageError
        If there is none of this name.
    """
    found: dict[str, Any] = json.loads(json.dumps(actions[name].document()))
    return found


def loses(record: Encapsulation) -> bool:
    """Tell whether an action starts from what the last one left, so that twice is not once.

    All others draw by the identity of things: running one again gives the same.
    """
    return "edit" in (record.kind, record.stage)
