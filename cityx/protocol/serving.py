"""Match the slots of a brief to actions and their arguments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

DO = "do"  # key of the actions that are called for: pairs of an action and its arguments
Slots = Mapping[str, tuple[Any, ...]]  # what is asked for, by the keys of a brief


@dataclass(frozen=True, init=False)
class Serves:
    """Mark an action as one that answers a wish.

    Attributes
    ----------
    slots
        "key", or "key=value": what must be asked for, all of it; "!key": what must not.
    args
        Arguments that answer it.
    """

    slots: tuple[str, ...]
    args: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))

    def __init__(self, *slots: str, **args: Any) -> None:
        object.__setattr__(self, "slots", slots)
        object.__setattr__(self, "args", MappingProxyType(args))

    def __hash__(self) -> int:
        """Hash by what must be asked for."""
        return hash(self.slots)

    def asked(self, slots: Slots) -> bool:
        """Return whether a brief asks for all of it."""
        for pattern in self.slots:
            key, equals, value = pattern.removeprefix("!").partition("=")
            if pattern.startswith("!"):
                if slots.get(key):
                    return False
                continue
            held = slots.get(key, ())
            if not held or (equals and value not in map(str, held)):
                return False
        return True

    def to_json(self) -> dict[str, Any]:
        """Return a plain dictionary."""
        return {"slots": list(self.slots), "args": dict(self.args)}

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> Serves:
        """Rebuild it from `to_json`."""
        return cls(*record["slots"], **record["args"])
