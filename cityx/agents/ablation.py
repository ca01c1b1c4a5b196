"""Ablation: show a planner all or only parts of the actions' records, to measure each part's worth.

The paper takes Description, Input and Limitation out of the documents of its plugins and counts
what still succeeds. Here the offline planner reads the same parts: by the description it knows what
an action serves, by the input what an action needs and is given, by the limitation what comes
before it and which values it admits. The gate always knows everything, so what is planned wrongly
is refused, not run.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import combinations
from typing import Any

from cityx.errors import UsageError
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.serving import Serves

PARTS = "DIL"  # Description, Input, Limitation
UNSAID = "-"  # stands for what is not shown
# All arms, from everything to nothing.
ARMS = tuple("".join(arm) for size in (3, 2, 1, 0) for arm in combinations(PARTS, size))


def arm_of(text: str) -> str:
    """Return an arm in the order of `PARTS`: "D,L", "LD" and "dl" are "DL"; "-" is nothing.

    Raises
    ------
    UsageError
        For a letter that is no part.
    """
    letters = text.upper().replace(",", "").replace(" ", "").replace(UNSAID, "")
    unknown = sorted(set(letters) - set(PARTS))
    if unknown:
        raise UsageError(
            f'"{text}" names {", ".join(unknown)}; the parts are D (Description), I (Input) and '
            'L (Limitation), as in "D,L"; "-" shows none.'
        )
    return "".join(part for part in PARTS if part in letters)


def shown_records(records: Iterable[Encapsulation], arm: str) -> tuple[Encapsulation, ...]:
    """Return records with the parts of an arm alone.

    Parameters
    ----------
    records
        Of all actions.
    arm
        Of `ARMS`. Without D go the description, the labels and the wishes that an action says it
        serves, and a planner cannot call an action or fill a parameter by the action's name either,
        which would tell what it does. Without I go parameters, what a brief binds to them, and the
        ports it takes. Without L go the limits, what must have run or comes first, the
        preconditions, and the ranges of parameters.
    """
    found = []
    for record in records:
        changes: dict[str, Any] = {}
        if "D" not in arm:
            changes |= {"description": UNSAID, "labels": (), "serves": ()}
        if "I" not in arm:
            changes |= {"parameters": (), "binds": (), "takes": ()}
            served = record.serves if "D" in arm else ()
            changes["serves"] = tuple(Serves(*wish.slots) for wish in served)
        if "L" not in arm:
            given = changes.get("parameters", record.parameters)
            changes |= {
                "limits": (UNSAID,), "requires": (), "preconditions": (), "after": (),
                "parameters": tuple(replace(p, low=None, high=None) for p in given),
            }  # fmt: skip
        found.append(replace(record, **changes) if changes else record)
    return tuple(found)
