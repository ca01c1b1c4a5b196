"""The language of edits: verb, target, change, place, as a grammar over items."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from cityx.language.scan import Item

if TYPE_CHECKING:
    from lark import Lark, Token, Tree

# Terminals are kinds of items, see `commands.terminals`; the value is the item's index.
GRAMMAR = """
start: remove | look | lined | resize | shift | replace | add | plant | move | rotate | scale
     | close | lights | copy | fill | pave | strip | swap | topic
topic: targets
remove: REMOVE targets | targets BE? REMOVE
look: _paint (attr _at?)? targets (link* change)+ | targets (BE | IN) _paint? (link* change)+
    | _paint targets attr (link* change)+ | (ADD | MAKE) roofing link targets
roofing: ROOF
_paint: PAINT | CLAD | MAKE
attr: ATTR
change: COLOR | MATERIAL | STYLE | ROOF | FLOORS | LENGTH | LIMIT | LANES | factor | KIND
    | (COLOR | MATERIAL | STYLE) BUILDING
    | SURFACE ROAD? | ONEWAY ROAD? | CARFREE ROAD? | SPEED | COLOR ATTR | MATERIAL ATTR
factor: TIMES (ATTR | SIZE)? | COUNT SIGN (ATTR | SIZE)? | FACTOR COUNT | SHARE ATTR?
resize: _resizing (attr _at?)? targets (way amount)? | _resizing targets attr (way amount)?
shift: (ADD | REMOVE | RAISE | LOWER) amount link targets
_resizing: DOUBLE | TRIPLE | QUADRUPLE | HALVE | RAISE | LOWER | WIDEN | NARROW
_at: OF | ON | IN | REL
way: TO | BY | WITH
amount: LENGTH | FLOORS | SHARE | COUNT | LANES | factor | LIMIT | SPEED
replace: REPLACE targets link new | targets BE REPLACE link new
new: trait* (KIND | THING | AGENT | PLANT | BUILDING) (link* trait)*
trait: MATERIAL | COLOR | STYLE | ROOF | FLOORS | LENGTH | COUNT | LIMIT | ALL
fill: FILL targets WITH things
lined: PLANTS targets WITH (things | plants)
add: (ADD | MAKE | PLANTS) things (place | destination | _late)* again?
again: AND? (AGAIN | COUNT AMOUNT) THING? (REL IT | place | destination)
_late: link* SPEED | MODE | AXIS | AND? COUNT? EVERY
things: thing (AND thing)*
thing: own* (AGENT | THING | KIND | BUILDING) (link* MODE | link* trait | link* SPEED | EVERY)*
own: trait | SPEED | AMOUNT | MODE | SIZE
plant: (PLANTS | ADD | MAKE) plants (place | destination | _late)* again?
plants: (trait | AMOUNT | OF | SIZE)* PLANT (link? EVERY)* (AND plants)?
move: MOVE targets (link? LENGTH | link? direction | place | destination)+
direction: SIDE
rotate: ROTATE targets link? (ANGLE | COUNT) CLOCKWISE?
scale: SCALE targets link? (factor | COUNT | SHARE)
close: (CLOSE | OPEN) targets (link AGENT)?
lights: (TURN_ON | TURN_OFF) targets
copy: COPY targets (link? LENGTH | link? direction | link? place | destination)*
swap: REPLACE _look link _look (_at? targets)?
_look: MATERIAL | COLOR | STYLE | SURFACE
targets: target (AND target)*
target: _named? ID (TO ID)? filter* | IT
    | mod* _noun filter* | mod* NEAREST mod* _noun filter* reference
_noun: BUILDING | KIND | THING | AGENT | PLANT | ROAD | WHOLE | QUARTER
reference.4: (TO | FROM) spot
_named: BUILDING | KIND | THING | PLANT | ROAD
mod: ALL | COUNT | SHARE | RANK | NEAREST | ORDINAL | REST | MATERIAL | COLOR | STYLE | ROOF
   | FLOORS | OF | SIDE | SIZE
filter: bound | within | nearest | WITH ROOF | (OF | WITH) MATERIAL | (WITH | OF) FLOORS | place
      | FROM spot
bound.2: (WITH | BE | OF)? LIMIT
within.3: LIMIT OF spot
nearest.4: NEAREST (TO | FROM) spot
destination: TO spot
place: where+ spot | where* SIDE (OF spot)? | away
away: where* AWAY SIDE OF spot
where: REL | IN | ON | BY
spot: (ALL | COUNT | RANK | NEAREST | SIDE | SIZE)* _place_noun beyond?
_place_noun: BUILDING | KIND | THING | ROAD | PLANT | WHOLE | QUARTER | ID | IT
beyond: REL spot | OF spot
link: TO | IN | WITH | OF | BY | BE | ON | FROM
pave: (ADD | MAKE) SURFACE (_at | TO)+ targets | CLAD targets (WITH | IN) SURFACE | SURFACE targets
strip: (ADD | MAKE | REMOVE | OPEN | CLOSE) ALL? STRIP (_at | TO | FROM)+ targets
"""


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
    from lark.exceptions import LarkError

    known = parser()
    try:
        tree = known.parse(terminals)
    except LarkError:
        return None
    return _node(tree, items).children[0]


def _node(tree: Tree[Token] | Token, items: Sequence[Item]) -> Node:
    from lark import Token

    if isinstance(tree, Token):
        index = int(tree)
        return Node(str(tree.type), items[index] if index >= 0 else None)
    return Node(str(tree.data), None, tuple(_node(child, items) for child in tree.children))


@lru_cache(maxsize=1)
def parser() -> Lark:
    """Return the parser of edits, which takes (terminal, index) pairs; built when first used."""
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
