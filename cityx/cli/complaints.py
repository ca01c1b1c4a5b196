"""What a command line got wrong, in one sentence of this program's own."""

from __future__ import annotations

import re
from typing import Any

import typer

from cityx.errors import UsageError

Wrong: Any = typer.BadParameter.__base__  # all that typer says of a command line
_NO_COMMAND = re.compile(r"No such command '(?P<word>.*?)'\.(?P<hint>.*)")
_TOO_MANY = re.compile(r"Got unexpected extra arguments?(?:\(s\))? \((?P<words>.*)\)")
_NUMBERS = {"int_parsing": "a whole number", "float_parsing": "a number",
            "int_from_float": "a whole number"}  # fmt: skip


def usage_error(error: Any) -> UsageError | None:
    """Return what typer says of a command line as an error of CityX; None if it shows its help."""
    said = str(error.format_message())
    if said.startswith("Usage:"):  # nothing was said, so there is nothing wrong
        return None
    told = _of_value(error) or _of_missing(error) or _of_names(error, said)
    plain = said.rstrip(".").replace("'", "")
    return UsageError(told or f"{plain}.{_help(error)}")


def _of_value(error: Any) -> str:
    """Say of a value that a type refused what the option takes."""
    faults = getattr(error.__cause__, "errors", None)
    if not isinstance(error, typer.BadParameter) or error.param is None or faults is None:
        return ""
    fault = faults()[0]
    kind = _NUMBERS.get(fault["type"], "")
    low, high = getattr(error.param, "min", None), getattr(error.param, "max", None)
    span = ""
    if low is not None:
        span = f"{low:g} or more" if high is None else f"{low:g} to {high:g}"
    elif high is not None:
        span = f"{high:g} or less"
    takes = ", ".join(word for word in (kind, span) if word)
    if not takes:
        takes = f"something else ({fault['msg']})"
    return f'{_name(error)} is "{fault["input"]}"; it takes {takes}.'


def _of_missing(error: Any) -> str:
    """Say which argument or option is missing, and what it is."""
    if not str(error).startswith("Missing parameter") or error.param is None:
        return ""
    what = getattr(error.param, "help", "") or ""
    return f"{_name(error)} is missing{': ' if what else '.'}{what}{_help(error)}"


def _of_names(error: Any, said: str) -> str:
    """Say which option or command there is not, or which word is one too many."""
    option = getattr(error, "option_name", "")
    if option and said.startswith("No such option"):
        near = " or ".join(f'"{word}"' for word in error.possibilities or ())
        hint = f" Did you mean {near}?" if near else _help(error)
        return f'There is no option "{option}".{hint}'
    found = _NO_COMMAND.fullmatch(said)
    if found:
        hint = found["hint"].replace("'", '"') or _help(error)
        return f'There is no command "{found["word"]}".{hint}'
    found = _TOO_MANY.fullmatch(said)
    return f"Nothing takes the words: {found['words']}.{_help(error)}" if found else ""


def _name(error: Any) -> str:
    names = error.param.opts
    return "/".join(names) if names[0].startswith("-") else f"The argument {names[0].upper()}"


def _help(error: Any) -> str:
    path = error.ctx.command_path if error.ctx is not None else "cityx"
    return f" See {path} --help."
