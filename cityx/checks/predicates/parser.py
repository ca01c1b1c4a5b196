"""The grammar of predicates: text becomes `cityx.checks.predicates.syntax`, or an error says why.

Nothing is ever run: names that mean nothing are refused when a predicate is read.
"""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import Any

from lark import Lark, Token, Transformer, v_args
from lark.exceptions import UnexpectedCharacters, UnexpectedEOF, UnexpectedInput, UnexpectedToken

from cityx.checks.predicates.syntax import (
    NAME,
    Arithmetic,
    Call,
    Comparison,
    Name,
    Negative,
    Number,
    Predicate,
    Within,
)
from cityx.checks.predicates.vocabulary import faults_of, quoted_choices
from cityx.errors import UsageError

LONGEST = 1000  # signs but for ids; the longest of the benchmark has 60
MOST_IDS = 50_000  # that a predicate names
DEEPEST = 16  # brackets within brackets
_IDS = re.compile(r"\b[0-9a-f]{16}\b ?")

GRAMMAR = rf"""
start: condition

?condition: comparison | within | expression
comparison: expression (COMPARED | ABOUT) expression
within: expression "in" "[" expression "," expression "]"

?expression: expression ADDED term -> arithmetic | term
?term: term MULTIPLIED factor -> arithmetic | factor
?factor: number | negative | call | name | text | "(" expression ")"

number: NUMBER
negative: "-" factor
call: NAME "(" [argument ("," argument)*] ")"
?argument: setting | condition
setting: NAME "=" expression
name: NAME
text: TEXT

ABOUT: "~"
COMPARED: "==" | "!=" | "<=" | ">=" | "<" | ">"
ADDED: "+" | "-"
MULTIPLIED: "*" | "/"
NAME: /{NAME}/
NUMBER: /([0-9]+(\.[0-9]+)?|\.[0-9]+)([eE][+-]?[0-9]+)?/
TEXT: /"(\\["\\]|[^"\\\n])*"/
%ignore /[ \t]+/
"""
"""Grammar of one predicate, LALR(1)."""

_WORDS = {
    "COMPARED": "a comparison (==, !=, <=, >=, <, >)", "IN": '"in [low, high]"', "ABOUT": '"~"',
    "NAME": "a word", "NUMBER": "a number", "TEXT": "a quoted word", "LPAR": '"("', "RPAR": '")"',
    "LSQB": '"["', "RSQB": '"]"', "COMMA": '","', "EQUAL": '"="', "ADDED": '"+" or "-"',
    "MULTIPLIED": '"*" or "/"', "MINUS": '"-"', "$END": "the end",
}  # fmt: skip


@v_args(inline=True)
class _Reader(Transformer[Token, Predicate]):
    """Makes nodes as the parser goes, so that no depth of nesting recurses."""

    def start(self, condition: Any) -> Any:
        return condition

    def comparison(self, left: Any, sign: Any, right: Any) -> Comparison:
        return Comparison(left, str(sign), right)

    def within(self, of: Any, low: Any, high: Any) -> Within:
        return Within(of, low, high)

    def arithmetic(self, left: Any, sign: Token, right: Any) -> Arithmetic:
        return Arithmetic(left, str(sign), right)

    def number(self, token: Token) -> Number:
        value = float(token)
        if not math.isfinite(value):
            raise UsageError(f"the number {token[:40]} is too large")
        return Number(value)

    def negative(self, of: Any) -> Number | Negative:
        return Number(-of.value) if isinstance(of, Number) and of.value > 0 else Negative(of)

    def call(self, form: Token, *arguments: Any) -> Call:
        return Call(str(form), tuple(item for item in arguments if item is not None))

    def setting(self, name: Token, value: Any) -> Comparison:
        return Comparison(Name(str(name)), "=", value)

    def name(self, token: Token) -> Name:
        return Name(str(token))

    def text(self, token: Token) -> Name:
        return Name(token[1:-1].replace('\\"', '"').replace("\\\\", "\\"))


@lru_cache(maxsize=1)
def _parser() -> Lark:
    return Lark(GRAMMAR, parser="lalr", transformer=_Reader())


@lru_cache(maxsize=1024)
def parse(text: str) -> Predicate:
    """Read one predicate.

    Parameters
    ----------
    text
        Such as ``share(building, style=modern) >= 0.7``.

    Raises
    ------
    UsageError
        If it is no predicate, or names a form, kind, attribute or word that does not exist; the
        message says where, and what would be right.
    """
    if len(text) > LONGEST:
        plain, ids = _IDS.subn("", text)
        if len(plain) > LONGEST:
            raise UsageError(f"A predicate has at most {LONGEST} signs, this has {len(plain)}.")
        if ids > MOST_IDS:
            raise UsageError(f"A predicate names at most {MOST_IDS} ids, this {ids}.")
    if _depth(text) > DEEPEST:
        raise UsageError(f'"{text}": more than {DEEPEST} brackets within brackets.')
    try:
        found: Any = _parser().parse(text)
    except UnexpectedInput as error:
        raise UsageError(_explained(text, error)) from None
    except UsageError as error:
        raise UsageError(f'"{text}": {error}.') from None
    faults = faults_of(found)
    if faults:
        raise UsageError(f'"{text}": ' + " ".join(faults))
    for choice in quoted_choices(found):
        parse(f"n({choice}) >= 1")
    return found  # type: ignore[no-any-return]


def _depth(text: str) -> int:
    depth = deepest = 0
    for sign in text:
        depth += (sign in "([") - (sign in ")]")
        deepest = max(deepest, depth)
    # Signs before a number nest as brackets do, but leave no bracket.
    return deepest + text.count("--") + text.count("- -")


def _explained(text: str, error: UnexpectedInput) -> str:
    """Describe where a text stops being a predicate, and what would be right there."""
    if isinstance(error, UnexpectedCharacters):
        expected, found = error.allowed or set(), f'"{error.char}"'
    elif isinstance(error, UnexpectedToken) and error.token.type != "$END":
        expected, found = error.accepts or error.expected, f'"{error.token}"'
    else:
        assert isinstance(error, UnexpectedEOF | UnexpectedToken)
        expected, found = set(error.expected), "the end"
    wanted = " or ".join(sorted({_WORDS.get(name, name) for name in expected}))
    column = min(max(int(error.column), 1), len(text) + 1) if error.column else len(text) + 1
    column = len(text) + 1 if found == "the end" else column
    return f'"{text}", sign {column}: {found} is not expected here; {wanted} would be right.'
