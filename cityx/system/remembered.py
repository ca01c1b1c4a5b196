"""Remembered results: the last value derived from some objects, kept while they live."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from typing import Any, Generic, TypeVar

T = TypeVar("T")

_ALL: weakref.WeakSet[Remembered[Any]] = weakref.WeakSet()


class Remembered(Generic[T]):
    """One value, with weak references to the objects that it was made of.

    Values of a City never change, so that the same objects make the same value again.
    """

    def __init__(self) -> None:
        self._last: tuple[tuple[weakref.ref[Any], ...], tuple[object, ...], T] | None = None
        _ALL.add(self)

    def get(self, make: Callable[[], T], parts: Sequence[object], *key: object) -> T:
        """Return what `make` gives: the last value, if that is of the same parts and key.

        Parameters
        ----------
        make
            Makes the value out of the parts and the key, and nothing else.
        parts
            Objects, compared by identity.
        *key
            Words and numbers, compared by value.
        """
        last = self._last  # read once, and set at once: threads may ask together
        if last is not None and last[1] == key and _same(last[0], parts):
            return last[2]
        value = make()
        self._last = tuple(map(weakref.ref, parts)), key, value
        return value

    def forget(self) -> None:
        """Keep no value any more."""
        self._last = None


def forget_all() -> None:
    """Let go of every remembered value: they may hold the objects that they were made of."""
    for each in list(_ALL):
        each.forget()


def _same(references: tuple[weakref.ref[Any], ...], parts: Sequence[object]) -> bool:
    return len(references) == len(parts) and all(
        reference() is part for reference, part in zip(references, parts, strict=True)
    )
