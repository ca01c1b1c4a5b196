"""Reading a docstring in NumPy form."""

from __future__ import annotations

import inspect
import re
from dataclasses import dataclass

_SECTION = re.compile(r"^([A-Z][A-Za-z ]+)\n-{3,}$", re.MULTILINE)


@dataclass(frozen=True)
class Docstring:
    """The parts of a docstring.

    Attributes
    ----------
    summary
        Its first line.
    details
        The paragraphs before the first section, summary left out.
    parameters
        Name to text, joined to one line.
    """

    summary: str
    details: str
    parameters: dict[str, str]


def parse_docstring(text: str | None) -> Docstring:
    """Read summary, details and parameters; an empty text gives empty parts."""
    text = inspect.cleandoc(text or "")
    pieces = _SECTION.split(text)
    summary, _, details = pieces[0].strip().partition("\n")
    # The summary may wrap over lines up to the first blank one.
    more, _, details = ("\n" + details).partition("\n\n") if details else ("", "", "")
    sections = dict(zip(pieces[1::2], pieces[2::2], strict=True))
    parameters: dict[str, str] = {}
    for title in ("Parameters", "Other Parameters"):
        parameters |= _entries(sections.get(title, ""))
    return Docstring(_flat(summary + " " + more), _flat(details), parameters)


def _entries(section: str) -> dict[str, str]:
    found: dict[str, str] = {}
    names: list[str] = []
    for line in section.strip("\n").splitlines():
        if line and not line[0].isspace():
            heads = line.split(" : ")[0].rstrip(":")
            names = [name.strip().lstrip("*") for name in heads.split(",")]
            found |= dict.fromkeys(names, "")
        else:
            for name in names:
                found[name] = _flat(f"{found[name]} {line}")
    return found


def _flat(text: str) -> str:
    return " ".join(text.split())
