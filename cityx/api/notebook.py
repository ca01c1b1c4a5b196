"""What notebooks and terminals show of a project: pictures, explanations, progress."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any


class Pictures(tuple[Path, ...]):
    """Files of pictures, shown in a notebook."""

    @property
    def path(self) -> Path:
        """The first."""
        return self[0]

    def _repr_html_(self) -> str:
        shown = (
            f'<img alt="{escape(path.name)}" style="max-width: 100%" '
            f'src="{_data(path.read_bytes(), "png")}">'
            for path in self
            if path.is_file()
        )
        return "".join(shown)


class Explanation(dict[str, Any]):
    """How a sentence is understood, and the plan for it; prints as lines."""

    def __repr__(self) -> str:
        """Return what `cityx explain` prints."""
        from cityx.agents.explain import explanation

        return explanation(self)


@dataclass(frozen=True)
class Steps:
    """Progress of a dataset as lines."""

    tell: Callable[[str], None]

    def say(self, line: str) -> None:
        """Show what is being done."""
        self.tell(line)

    def shots(self, done: int, total: int, rate: float) -> None:
        """Show how many shots are done."""
        self.tell(f"{done} of {total} shots" + (f", {rate:.2g} a second" if rate else ""))


def project_page(text: str, plan: str, picture: bytes = b"") -> str:
    """Return a project as HTML: its picture, if there is one, and its plan, above its lines."""
    shown = f'<img alt="The city from above" src="{_data(picture, "jpeg")}">' if picture else ""
    return (
        '<div style="display: flex; flex-wrap: wrap; gap: 1em; align-items: flex-start">'
        f"{shown}{plan}</div><pre>{escape(text)}</pre>"
    )


def _data(picture: bytes, kind: str) -> str:
    return f"data:image/{kind};base64,{b64encode(picture).decode()}"
