"""The language of edits: verb, target, change, place, as a grammar over items."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from cityx.language.scan import Item
from cityx.system.tables import text_of

if TYPE_CHECKING:
    from lark import Lark, Token, Tree

# Terminals are kinds of items, see `commands.terminals`; the value is the item's index.
GRAMMAR = text_of("language/edits.lark")


@dataclass(frozen=True)
class Node:
    """A rule or a terminal of a parsed command.

    Attributes
    ----------
    name
        The rule in lower case, the terminal in upper case.
    item
        The item of a terminal; None for a rule, and for a verb that is only implied.
    children
        What the rule is made of, in the order of the text.
    """

    name: str
    item: Item | None = None
    children: tuple[Node, ...] = ()

    def leaves(self, *names: str) -> Iterator[Item]:
        """Yield the items below that are one of some terminals, or all."""
        if self.item is not None and (not names or self.name in names):
            yield self.item
        for child in self.children:
            yield from child.leaves(*names)

    def first(self, *names: str) -> Item | None:
        """Return the first item below that is one of some terminals."""
        return next(self.leaves(*names), None)

    def own(self, *names: str) -> list[Node]:
        """Return the direct children of some names."""
        return [child for child in self.children if child.name in names]

    def branch(self, name: str) -> Node | None:
        """Return the first direct child of a name."""
        return next(iter(self.own(name)), None)

    def find(self, name: str) -> Iterator[Node]:
        """Yield every node of a name below, outermost first."""
        for child in self.children:
            if child.name == name:
                yield child
            else:
                yield from child.find(name)


def parse(terminals: Sequence[tuple[str, int]], items: Sequence[Item]) -> Node | None:
    """Parse a command of terminals, each with the index of its item; None if it is none."""
    tree = _tree(tuple(kind for kind, _ in terminals))
    if tree is None:
        return None
    found = _node(tree, [items[at] if at >= 0 else None for _, at in terminals])
    (command,) = (child for child in found.children if child.name not in ("exception", "AND"))
    return Node(command.name, None, (*command.children, *found.own("exception")))


@lru_cache(maxsize=1024)
def _tree(kinds: tuple[str, ...]) -> Tree[Token] | None:
    """Return the tree of a command, whose tokens are places among its terminals."""
    from lark.exceptions import LarkError

    try:
        return parser().parse([(kind, at) for at, kind in enumerate(kinds)])
    except LarkError:
        return None


def _node(tree: Tree[Token] | Token, items: Sequence[Item | None]) -> Node:
    from lark import Token

    if isinstance(tree, Token):
        return Node(str(tree.type), items[int(tree)])
    return Node(str(tree.data), None, tuple(_node(child, items) for child in tree.children))


@lru_cache(maxsize=1)
def parser() -> Lark:
    """Return the parser of edits, which takes (terminal, place) pairs; built when first used."""
    from lark import Lark, Token
    from lark.lexer import Lexer

    class Items(Lexer):
        def __init__(self, conf: Any) -> None:
            del conf

        def lex(self, data: Sequence[tuple[str, int]]) -> Iterator[Token]:  # type: ignore[override]
            yield from (Token(kind, str(index)) for kind, index in data)

    terminals = sorted(set(re.findall(r"\b[A-Z][A-Z_]+\b", GRAMMAR)))
    declared = "%declare " + " ".join(terminals)
    return Lark(GRAMMAR + declared, parser="earley", lexer=Items, ambiguity="resolve")
