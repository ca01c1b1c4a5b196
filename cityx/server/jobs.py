"""Jobs: work that one thread does in turn while clients wait, poll or cancel."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any, Literal
from uuid import uuid4

from cityx.server.replies import Reply

State = Literal["queued", "running", "ended"]
LINES = 20  # of progress that are kept


@dataclass(eq=False)
class Job:
    """One piece of work.

    Attributes
    ----------
    what
        Name of the tool that asked for it.
    work
        Does it; called with the job itself, in the thread of the owner.
    id
        Unlike that of any other job.
    reply
        How it ended, once it has.
    running
        Whether it was begun.
    said
        The last lines of progress.
    steps
        How many lines there were.
    """

    what: str
    work: Callable[[Job], Reply]
    id: str = field(default_factory=lambda: f"job_{uuid4().hex[:12]}")
    reply: Future[Reply] = field(default_factory=Future)
    running: bool = False
    said: deque[str] = field(default_factory=lambda: deque(maxlen=LINES))
    steps: int = 0
    _stop: threading.Event = field(default_factory=threading.Event)

    @property
    def state(self) -> State:
        """Whether it waits, runs or has ended."""
        if self.reply.done():
            return "ended"
        return "running" if self.running else "queued"

    def say(self, line: str) -> None:
        """Take a line of progress."""
        self.said.append(line)
        self.steps += 1

    def cancel(self) -> None:
        """Call the work off; an action in progress ends first and is rolled back."""
        self._stop.set()

    def cancelled(self) -> bool:
        """Return whether the work was cancelled."""
        return self._stop.is_set()

    def to_json(self) -> dict[str, Any]:
        """Return where it stands."""
        return {
            "job": self.id, "tool": self.what, "state": self.state, "steps": self.steps,
            "progress": list(self.said), "cancelled": self.cancelled(),
        }  # fmt: skip
