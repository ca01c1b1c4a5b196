"""A tool: what a client may ask for, with the schema of its arguments.

No tool takes code, a path or an address: only names and numbers that are checked, and one text in
words, which is read by `cityx.projects.instructions` and never run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from jsonschema import Draft202012Validator

from cityx.server import queries
from cityx.server.jobs import Job
from cityx.server.replies import Reply

PATIENCE_S = 15.0  # that a call waits for work; what takes longer goes on as a job
MOST_WORDS = 2000  # letters of a text in words
MOST_IDS = 500  # of a selector
DEEPEST, LARGEST = 16, 20_000  # levels and values of the arguments of a call
Arguments = Mapping[str, Any]


@dataclass(frozen=True)
class Tool:
    """One tool.

    Attributes
    ----------
    name, description
        As clients see them.
    properties, required
        Schema of the arguments.
    run
        Called with the arguments in any thread; a job that it returns is waited for.
    read_only, destructive, idempotent
        Hints for clients.
    patience
        Seconds that a call waits for its job, unless the property "seconds" says otherwise.
    others
        Schema of arguments that `run` itself checks.
    """

    name: str
    description: str
    run: Callable[[Arguments], Reply | Job]
    properties: Mapping[str, Any] = field(default_factory=dict)
    required: tuple[str, ...] = ()
    read_only: bool = False
    destructive: bool = False
    idempotent: bool = False
    patience: float = PATIENCE_S
    others: Mapping[str, Any] = field(default_factory=dict)

    @property
    def schema(self) -> dict[str, Any]:
        """JSON schema of the arguments."""
        needed = [*self.required, *self.others.get("required", ())]
        return {
            "type": "object",
            "properties": {**self.others.get("properties", {}), **self.properties},
            "required": needed,
            "additionalProperties": False,
        }

    @cached_property
    def _validator(self) -> Draft202012Validator:
        known = {"type": "object", "properties": self.properties, "required": list(self.required)}
        return Draft202012Validator(known | {"additionalProperties": bool(self.others)})

    def patience_for(self, arguments: Arguments) -> float:
        """Return the seconds that a call waits for its job."""
        told = arguments.get("seconds") if "seconds" in self.properties else None
        return self.patience if told is None else float(told)

    def faults(self, arguments: Arguments) -> list[str]:
        """Return every reason to refuse arguments, one sentence each."""
        found = [
            f"{'.'.join(map(str, error.path)) or self.name}: {error.message[:200]}."
            for error in self._validator.iter_errors(arguments)
        ]
        return sorted(found)


def refusals(tool: Tool, arguments: Arguments) -> list[str]:
    """Return every reason to refuse the arguments of a call, measured before it is looked at."""
    size, level = 0, [arguments]
    for _ in range(DEEPEST):
        level = [item for value in level for item in _inside(value)]
        size += len(level)
        if not level:
            return tool.faults(arguments)
        if size > LARGEST:
            return [f"The arguments hold more than {LARGEST} values."]
    return [f"The arguments are nested deeper than {DEEPEST} levels."]


def _inside(value: Any) -> list[Any]:
    if isinstance(value, Mapping):
        return list(value.values())
    return value if isinstance(value, list) else []


def text(description: str, most: int = MOST_WORDS, **more: Any) -> dict[str, Any]:
    """Return the schema of a text of bounded length."""
    return {"type": "string", "maxLength": most, "description": description, **more}


def whole(description: str, low: int, high: int, default: int | None = None) -> dict[str, Any]:
    """Return the schema of a whole number within bounds."""
    found = {"type": "integer", "minimum": low, "maximum": high, "description": description}
    return found if default is None else found | {"default": default}


REVISION = whole("Revision you looked at; another one by now is answered CONFLICT.", 0, 2**31)
KEY = text("Any word of yours; the same key again returns the first answer.", 80, minLength=1)
CHANGING = {"expected_rev": REVISION, "idempotency_key": KEY}
DRY = {"type": "boolean", "default": False, "description": "Only tell whether it may run."}
BIND = {
    "type": "object", "additionalProperties": text("Role of what the city holds.", 80),
    "maxProperties": 20, "description": "Data port to the role that fills it, where it matters.",
}  # fmt: skip
WORDS = text("In words, such as: snow at dusk.", minLength=1)
PAGE = whole("Page, from 1.", 1, 10**6, 1)
ROWS = whole("Rows of a page.", 1, queries.MOST_ROWS, queries.PAGE)
JOB = text("As answered by the call that began it.", 40)
_ID = text("Id.", 16, pattern="^[0-9a-f]{16}$")
_COORDINATE = {"type": "number", "minimum": -1e6, "maximum": 1e6}
SELECTOR = {
    "type": "object",
    "additionalProperties": False,
    "description": "An object must suit all that is given; without layer or ids, of the layout.",
    "properties": {
        "layer": text("Such as layout/buildings, meshes/ground, instances/trees.", 80),
        "kind": text("Such as residential, apartments, tree.", 80),
        "ids": {"type": "array", "maxItems": MOST_IDS, "items": _ID},
        "name": text("Part of its name.", 80),
        "near": {
            "type": "object", "additionalProperties": False, "required": ["x", "y", "radius"],
            "description": "Metres in the frame of the city, x east, y north.",
            "properties": {"x": _COORDINATE, "y": _COORDINATE,
                           "radius": {"type": "number", "minimum": 0, "maximum": 1e6}},
        },
    },
}  # fmt: skip
