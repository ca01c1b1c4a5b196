"""What commands show on a terminal: progress, tables, lists that stay short."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from rich.console import RenderableType

SHOWN = 6  # lines of one kind
LONGEST = 160  # letters of a line
CHECK_FAILED, ENGINE_FAILED = 1, 3  # exit codes


class Progress:
    """A spinner with the current step on a terminal; plain lines elsewhere."""

    def __enter__(self) -> Progress:
        """Begin to show."""
        from rich.console import Console

        self._console = Console(stderr=True)
        self._status = self._console.status("starting") if self._console.is_terminal else None
        if self._status:
            self._status.start()
        return self

    def __call__(self, line: str) -> None:
        """Show what is being done."""
        if self._status:
            self._status.update(line)
        else:
            self._console.print(line, markup=False, highlight=False)

    def __exit__(self, *_: object) -> None:
        """End the line."""
        if self._status:
            self._status.stop()


def please_report(log: Path) -> str:
    """Ask for a report of a fault of this program itself."""
    return f"The trace is in {log}; please report it with the input."


def show(renderable: RenderableType) -> None:
    """Print a text or a table of rich."""
    from rich.console import Console

    Console(soft_wrap=isinstance(renderable, str)).print(renderable, markup=False)


def echo_some(lines: Sequence[str], rest: str = "see report.json", most: int = SHOWN) -> None:
    """Print the first lines, long ones cut, and how many more there are and where."""
    for line in lines[:most]:
        typer.echo(line if len(line) <= LONGEST else f"{line[:LONGEST]} ... {rest}")
    if len(lines) > most:
        typer.echo(f"... and {len(lines) - most} more, {rest}")
