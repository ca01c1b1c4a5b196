"""Signatures that name the options behind ``**options``, for `help` and completion."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from cityx.options import declared

F = TypeVar("F", bound=Callable[..., Any])


def takes(
    kind: type, defaults: Mapping[str, Any] | None = None, without: tuple[str, ...] = ()
) -> Callable[[F], F]:
    """Show the options of a dataclass in the signature of a function, in place of its ``**``.

    Parameters
    ----------
    kind
        The dataclass.
    defaults
        Values instead of those of the dataclass.
    without
        Options that the function names itself.
    """

    def shown(function: F) -> F:
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
        options = [
            inspect.Parameter(
                item.name, inspect.Parameter.KEYWORD_ONLY, annotation=item.kind,
                default=(defaults or {}).get(item.name, item.default),
            )
            for item in declared(kind)
            if item.name not in without
        ]  # fmt: skip
        function.__dict__["__signature__"] = signature.replace(parameters=[*own, *options])
        return function

    return shown
