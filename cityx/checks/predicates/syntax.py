"""Predicates as data: what the text of one says, before anything is measured."""

from __future__ import annotations

import re
from dataclasses import dataclass

NAME = r"[A-Za-z_][A-Za-z0-9_]*(?:[.:][A-Za-z0-9_]+)*"
_PLAIN = re.compile(NAME)
_RESERVED = ("in",)


@dataclass(frozen=True)
class Number:
    """A number, metres, degrees or whatever the measured thing has; finite."""

    value: float

    def __str__(self) -> str:
        """Write it so that it reads back the same."""
        return str(int(self.value)) if self.value.is_integer() else repr(self.value)


@dataclass(frozen=True)
class Name:
    """A word: a kind, an attribute, an id, a file, a style; quoted where it holds other signs."""

    word: str

    def __str__(self) -> str:
        """Write it, in quotes where it needs them."""
        if _PLAIN.fullmatch(self.word) and self.word not in _RESERVED:
            return self.word
        escaped = self.word.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'


@dataclass(frozen=True)
class Negative:
    """The negative of an expression that is no plain number."""

    of: Expression

    def __str__(self) -> str:
        """Write it."""
        return f"-{_grouped(self.of, 3)}"


@dataclass(frozen=True)
class Arithmetic:
    """Two expressions joined by +, -, * or /."""

    left: Expression
    sign: str
    right: Expression

    def __str__(self) -> str:
        """Write it with the brackets it needs."""
        rank = _rank(self)
        return f"{_grouped(self.left, rank)} {self.sign} {_grouped(self.right, rank + 1)}"


@dataclass(frozen=True)
class Call:
    """A form and its arguments: ``stat(building, height, p90)``."""

    form: str
    arguments: tuple[Argument, ...] = ()

    def __str__(self) -> str:
        """Write it."""
        return f"{self.form}({', '.join(map(str, self.arguments))})"


Expression = Number | Name | Negative | Arithmetic | Call


@dataclass(frozen=True)
class Comparison:
    """Two expressions compared.

    Attributes
    ----------
    sign
        "==", "!=", "<=", ">=", "<", ">", or "~": about as many, or of such a colour. Among
        arguments also "=".
    """

    left: Expression
    sign: str
    right: Expression

    def __str__(self) -> str:
        """Write it; arguments without spaces."""
        gap = "" if self.sign == "=" else " "
        return f"{self.left}{gap}{self.sign}{gap}{self.right}"


@dataclass(frozen=True)
class Within:
    """An expression between two others, both included."""

    of: Expression
    low: Expression
    high: Expression

    def __str__(self) -> str:
        """Write it."""
        return f"{self.of} in [{self.low}, {self.high}]"


Condition = Comparison | Within
Argument = Expression | Condition
# What is true or false: a comparison, or a form that is one by itself, such as ``same(others)``.
Predicate = Comparison | Within | Call


def _rank(node: Expression) -> int:
    if isinstance(node, Arithmetic):
        return 1 if node.sign in "+-" else 2
    return 4 if not isinstance(node, Negative) else 3


def _grouped(node: Expression, least: int) -> str:
    return str(node) if _rank(node) >= least else f"({node})"
