"""Replies: every tool answers in one form, and every error has its status and its code."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from cityx.errors import (
    ActionFailed,
    ActionRejected,
    CityxError,
    EngineError,
    InputError,
    MissingDependency,
    UsageError,
)
from cityx.language.brief import Clarify
from cityx.projects.desk import Cancelled, Conflict

Status = Literal["ok", "rejected", "failed", "accepted"]
STATUSES: tuple[Status, ...] = ("ok", "rejected", "failed", "accepted")
MOST_LETTERS = 4000  # of a message; what a model reads of it costs it room


class NoCity(UsageError):
    """The folder holds no city yet."""


class Busy(UsageError):
    """So much work waits that no more is taken."""


class KeyTaken(UsageError):
    """An idempotency key was used for another call before."""


# The first kind that an error is decides; a rejected caller may try something else at once.
_KINDS: tuple[tuple[type[CityxError], Status, str], ...] = (
    (Conflict, "rejected", "CONFLICT"),
    (NoCity, "rejected", "NO_CITY"),
    (Busy, "rejected", "BUSY"),
    (KeyTaken, "rejected", "KEY_TAKEN"),
    (Clarify, "rejected", "CLARIFY"),
    (UsageError, "rejected", "USAGE"),
    (InputError, "rejected", "INPUT"),
    (Cancelled, "failed", "CANCELLED"),
    (ActionFailed, "failed", "ACTION_FAILED"),
    (EngineError, "failed", "ENGINE"),
    (MissingDependency, "failed", "CAPABILITY"),
)


@dataclass(frozen=True)
class Reply:
    """What a tool answers.

    Attributes
    ----------
    status
        "ok"; "rejected", nothing was done and other arguments may do; "failed", it was tried and
        nothing changed; "accepted", a job works on it.
    code
        One word for programs.
    message
        One or more sentences for people and models.
    state_rev
        Revision that the city has, 0 for none.
    changed
        Ids of objects that are not as they were, and parts of the city that are no objects.
    artifacts
        Addresses of resources that came about.
    warnings
        What a reader should know.
    job_id
        The job, "" for none.
    data
        What was asked for, JSON.
    pictures
        PNG files to show.
    """

    status: Status
    code: str = "OK"
    message: str = ""
    state_rev: int = 0
    changed: tuple[str, ...] = ()
    artifacts: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    job_id: str = ""
    data: Mapping[str, Any] = field(default_factory=dict)
    pictures: tuple[bytes, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Return a plain dictionary, without the pictures, of text that any reader can decode."""
        record = asdict(self)
        del record["pictures"]
        record["message"] = self.message[:MOST_LETTERS]
        text = json.dumps(record, default=str).encode("utf-8", "replace")
        found: dict[str, Any] = json.loads(text)
        return found


def _of(kind: str, description: str, **more: Any) -> dict[str, Any]:
    return {"type": kind, "description": description, **more}


_TEXTS = {"type": "string"}
SCHEMA: Mapping[str, Any] = {
    "type": "object",
    "properties": {
        "status": _of("string", "rejected: try other arguments; failed: nothing changed; "
                      "accepted: a job works on it.", enum=list(STATUSES)),
        "code": _of("string", "OK or one word for the reason."),
        "message": _of("string", "For people and models."),
        "state_rev": _of("integer", "Revision of the city, 0 for none."),
        "changed": _of("array", "Ids of objects that changed.", items=_TEXTS),
        "artifacts": _of("array", "Addresses of resources.", items=_TEXTS),
        "warnings": _of("array", "What a reader should know.", items=_TEXTS),
        "job_id": _of("string", "The job, empty for none."),
        "data": _of("object", "What was asked for."),
    },
    "required": ["status", "code", "message", "state_rev", "changed", "artifacts", "warnings",
                 "job_id", "data"],
}  # fmt: skip


def reply_of_error(error: CityxError, revision: int, job: str = "") -> Reply:
    """Return the reply that tells of an error."""
    if isinstance(error, ActionRejected):
        return Reply("rejected", error.code, str(error), revision, job_id=job)
    for kind, status, code in _KINDS:
        if isinstance(error, kind):
            return Reply(status, code, str(error), revision, job_id=job)
    return Reply("failed", "FAILED", str(error), revision, job_id=job)


def reply_of_fault(error: Exception, revision: int, job: str = "") -> Reply:
    """Return the reply that tells of a fault of CityX itself; the trace is for the log."""
    said = f"CityX itself failed ({type(error).__name__}); the city is as it was."
    return Reply("failed", "INTERNAL", said, revision, job_id=job)
