"""Errors, named for who can act on them."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


class CityxError(Exception):
    """Base of every error that CityX raises on purpose; the message is meant for its user."""

    exit_code = 3


class InputError(CityxError):
    """A file cannot be used as it is; its owner can act."""

    exit_code = 2


class UsageError(CityxError):
    """A call or a command line asks for something that does not exist; the caller can act."""

    exit_code = 2


class ActionRejected(CityxError):
    """The gate refused a call before it ran; the planner may correct its arguments.

    Parameters
    ----------
    message
        Every fault found, one sentence each.
    code
        One of the gate codes of `cityx.protocol.gate`.
    """

    exit_code = 2

    def __init__(self, message: str, *, code: str = "BAD_ARGS") -> None:
        super().__init__(message)
        self.code = code


class ActionFailed(CityxError):
    """An action that was allowed to run could not do its work; the planner takes another way."""


class InternalFault(ActionFailed):
    """An action of this package broke by a fault of its own; whoever keeps it should hear of it."""


class EngineError(CityxError):
    """An engine (Blender, SUMO) failed, was killed or cannot start."""


class DiskError(CityxError):
    """A disk is full or may not be written to; what stood there before is as it was."""

    exit_code = 4


class MissingDependency(CityxError):
    """An optional library is absent; the message names the extra or system package to install."""


class MissingExtra(MissingDependency):
    """What was asked for needs an extra of this package; nothing was begun."""

    exit_code = 2


def nearest(word: str, known: Iterable[str], count: int = 3) -> str:
    """Return a hint such as `` Did you mean "a" or "b"?``, or an empty string."""
    close = get_close_matches(word, list(known), n=count, cutoff=0.5)
    return "" if not close else " Did you mean " + " or ".join(f'"{name}"' for name in close) + "?"
