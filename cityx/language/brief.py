"""A brief: what an instruction asks for, and what was not understood of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from cityx.errors import UsageError
from cityx.system.tables import load, table

Span = tuple[int, int]  # first and one past the last character of the text
Value = str | float | int

# Key -> meaning. Keys with ".min" and ".max" bound the key without it.
KEYS = table("language/slots", str, "keys")
# Families: what is measured of any thing with a name, "river.width", "tree.count", "tower.color".
MEASURED = (
    "count", "width", "length", "height", "floors", "area", "side", "share", "size.x", "size.y",
    "size", "near", "relation", "second", "metres", "part", "by", "material", "color", "roof",
    "roof_color", "walls", "speed", "wears", "beacons",
)  # fmt: skip
SINGLE = load("language/slots", frozenset[str], "single")


def is_key(key: str) -> bool:
    """Return whether a key is one of the closed list."""
    base = key.removesuffix(".min").removesuffix(".max")
    family = any(base.endswith(f".{name}") and len(base) > len(name) + 1 for name in MEASURED)
    return base in KEYS or family


@dataclass(frozen=True)
class Slot:
    """One thing that is asked for.

    Attributes
    ----------
    key, value
        A key of `KEYS`; the value is a word or a number in SI units.
    span, text
        Where the text says so, and in which words; (0, 0) and "" for an option.
    every
        Whether it is asked of each thing it is about: "every house of brick".
    mostly
        Whether it is asked of most of them alone: "mostly brick".
    """

    key: str
    value: Value
    span: Span = (0, 0)
    text: str = ""
    every: bool = False
    mostly: bool = False


@dataclass(frozen=True)
class Selector:
    """The objects an edit is about.

    Attributes
    ----------
    kind
        "building", "tree", "house"...; "" where ids alone are named, "it" for a pronoun.
    ids
        Objects named by their ids.
    rank, k, nth
        "tallest" and how many of them, or which one in that order.
    filters
        Conditions on single objects: "height>30", "material=brick".
    share
        Part of the objects, 0 to 1.
    near, inside, along, side, of
        Where the objects are: near, in or along what, on which side (of what). The place may be
        one of a rank, as in "tallest building".
    reach
        Metres that count as near, 0 where nothing is said.
    alone
        Whether the words mean one object, as "the church" does.
    where
        Where else the objects are, by other objects: between two, behind one, across the street.
    but
        Which of them are left out: "except the church", "apart from those along the river".
    """

    kind: str = ""
    ids: tuple[str, ...] = ()
    rank: str = ""
    k: int = 0
    nth: int = 0
    filters: tuple[str, ...] = ()
    share: float | None = None
    near: str = ""
    reach: float = 0.0
    inside: str = ""
    along: str = ""
    side: str = ""
    of: str = ""
    alone: bool = False
    where: tuple[Reference, ...] = ()
    but: tuple[Selector, ...] = ()

    def items(self) -> Iterator[tuple[str, Value]]:
        """Yield what is said, as keys and values."""
        if not self.ids and self.kind:
            yield "target", self.kind
        for one in self.ids:
            yield "target", one
        yield from (("filter", text) for text in self.filters)
        for key in ("rank", "k", "nth", "share", "near", "reach", "inside", "along", "side", "of"):
            value = getattr(self, key)
            if value not in ("", 0, None) and not (key == "k" and self.nth):
                yield {"inside": "in"}.get(key, key), value
        for reference in self.where:
            yield from reference.items()
        yield from (("except", one.text) for one in self.but)

    @property
    def text(self) -> str:
        """What is said, in one line."""
        return " ".join(str(value) for _, value in self.items()) or "everything"


@dataclass(frozen=True)
class Reference:
    """What something is placed by, or measured by.

    Attributes
    ----------
    key
        A relation ("between", "behind", "before", "opposite", "near", "in", "along", "around",
        "edge", "end"), or what is taken over ("height", "floors", "color"...).
    spots
        The objects; two for "between", none for the edge or the end of the site.
    amount
        Metres within which something is near; how much more there is to be than of the other.
    side
        The side of it that is meant: "at the western end of the park".
    """

    key: str
    spots: tuple[Selector, ...] = ()
    amount: float = 0.0
    side: str = ""

    def items(self) -> Iterator[tuple[str, Value]]:
        """Yield what is said, as keys and values."""
        for at, spot in enumerate(self.spots):
            yield ("and" if at else self.key), spot.text
        if not self.spots:
            yield self.key, self.side or "site"
        elif self.side:
            yield "side", self.side
        if self.amount:
            yield "by", self.amount


@dataclass(frozen=True)
class Edit:
    """One change of a city that exists.

    Attributes
    ----------
    verb
        "set_color", "remove", "add_agent"...: a value of the key "edit".
    target
        What is changed; None where something is added.
    change
        What it becomes: pairs of a key and a value in SI units.
    span
        Where the text says so.
    wished
        Whether a file asks for it, and not the user.
    refs
        Other objects by which it is placed, or whose look or measures it takes over.
    """

    verb: str
    target: Selector | None = None
    change: tuple[tuple[str, Value], ...] = ()
    span: Span = (0, 0)
    wished: bool = False
    refs: tuple[Reference, ...] = ()

    def items(self) -> Iterator[tuple[str, Value]]:
        """Yield the edit as keys and values, the verb first."""
        if self.verb in ("undo", "redo"):
            yield from self.change
            return
        yield "edit", self.verb
        if self.target is not None:
            yield from self.target.items()
        yield from self.change
        for reference in self.refs:
            yield from reference.items()


@dataclass(frozen=True)
class Command:
    """A change of the finished city by which a description comes about.

    Attributes
    ----------
    text
        A command of the language of edits, as a user would give it.
    span
        Where the description asks for it.
    """

    text: str
    span: Span = (0, 0)


@dataclass(frozen=True)
class GoalText:
    """A goal that can be measured: a predicate over the finished city, as text."""

    text: str
    predicate: str
    hard: bool = True
    span: Span = (0, 0)


@dataclass(frozen=True)
class Conflict:
    """Two parts of an instruction that cannot both hold; the text says what would be right."""

    code: str
    text: str
    spans: tuple[Span, ...] = ()


@dataclass(frozen=True)
class Question:
    """Something to ask the user before anything runs, with answers to choose from."""

    text: str
    candidates: tuple[str, ...] = ()

    @property
    def said(self) -> str:
        """The question with the answers to choose from."""
        return self.text + (f" ({', '.join(self.candidates)})" if self.candidates else "")


@dataclass(frozen=True)
class Wish:
    """One of the things that a request asks for, which may be carried out without the others.

    Attributes
    ----------
    text, span
        Its words.
    edits
        What it changes.
    needs
        Places in `Brief.wishes` of those that it must not be carried out without.
    given
        What there must be in the city for it to be asked for: "if there is a pond".
    """

    text: str
    span: Span
    edits: tuple[Edit, ...]
    needs: tuple[int, ...] = ()
    given: tuple[Selector, ...] = ()


@dataclass(frozen=True)
class Left:
    """A wish that is left out, while others of the same request are carried out.

    Attributes
    ----------
    text, span
        Its words.
    questions
        What is to be asked about it, or why it is left out.
    """

    text: str
    span: Span
    questions: tuple[Question, ...]

    def holds(self, span: Span) -> bool:
        """Return whether something of the text begins in it."""
        return span[1] > 0 and self.span[0] <= span[0] < self.span[1]

    @property
    def told(self) -> str:
        """Its words and why it is left out, in one line."""
        return f'left out: "{self.text}". {" ".join(one.said for one in self.questions)}'


@dataclass(frozen=True)
class Note:
    """Something the user should know of the reading: a mended word, an ignored sentence.

    Attributes
    ----------
    code, text, span
        What it is, in words, and where the text says so.
    of
        Where the text names the thing whose place is left open, with its number: "six benches".
    about
        What the words are of that are left open, as the text of the note says it.
    """

    code: str
    text: str
    span: Span = (0, 0)
    of: Span | None = None
    about: str = ""


@dataclass(frozen=True)
class Brief:
    """What an instruction asks for.

    Attributes
    ----------
    text
        The instruction.
    slots, edits
        What is asked of a city, and what is to be changed of one.
    then
        Commands that are carried out on a new city when it is finished.
    goals
        The same as predicates.
    unread
        Spans of content words that nobody understood.
    conflicts, questions
        What has to be settled before anything runs.
    kept, negated
        What must stay as it is, and what must not be there.
    notes
        Mended spellings, words that leave something open, ignored instructions.
    wishes, left
        The changes by what asks for them, and the wishes that are left out.
    """

    text: str = ""
    slots: tuple[Slot, ...] = ()
    edits: tuple[Edit, ...] = ()
    then: tuple[Command, ...] = ()
    goals: tuple[GoalText, ...] = ()
    unread: tuple[Span, ...] = ()
    conflicts: tuple[Conflict, ...] = ()
    questions: tuple[Question, ...] = ()
    kept: tuple[Slot, ...] = ()
    negated: tuple[Slot, ...] = ()
    notes: tuple[Note, ...] = field(default=())
    wishes: tuple[Wish, ...] = ()
    left: tuple[Left, ...] = ()

    def items(self) -> list[tuple[str, Value]]:
        """Return everything asked for as keys and values, once each, in the order of the text."""
        said = [(slot.span, [(slot.key, slot.value)]) for slot in self.slots]
        said += [(slot.span, [("not", slot.value)]) for slot in self.negated]
        said += [(slot.span, [("keep", slot.value)]) for slot in self.kept]
        said += [(edit.span, list(edit.items())) for edit in self.edits]
        said += [(one.span, [("then", one.text)]) for one in self.then]
        ordered = sorted(said, key=lambda one: one[0])
        return list(dict.fromkeys(pair for _, pairs in ordered for pair in pairs))

    def value(self, key: str) -> Value | None:
        """Return the value of a slot, or None."""
        return next((slot.value for slot in self.slots if slot.key == key), None)

    def values(self, key: str) -> tuple[Value, ...]:
        """Return every value of a slot."""
        return tuple(slot.value for slot in self.slots if slot.key == key)

    @property
    def words_unread(self) -> tuple[str, ...]:
        """The words that were not understood."""
        return tuple(self.text[first:last] for first, last in self.unread)

    @property
    def told(self) -> tuple[str, ...]:
        """What is to be said of the reading: words not understood, what is left out or open."""
        words = ", ".join(f'"{word}"' for word in self.words_unread)
        unread = (f"not understood: {words}",) if words else ()
        return (*unread, *(one.told for one in self.left), *(note.text for note in self.notes))

    @property
    def heard(self) -> str:
        """What was understood, in one line, "" for nothing."""
        pairs = ", ".join(f"{key} = {value}" for key, value in self.items())
        return f"understood: {pairs}" if pairs else ""

    def joined(self, note: Brief) -> Brief:
        """Return this brief with what a text file asks for; its spans point into that file."""
        names = (
            "slots", "edits", "then", "goals", "conflicts", "questions", "kept", "negated", "notes",
            "left",
        )  # fmt: skip
        both = {name: getattr(self, name) + getattr(note, name) for name in names}
        later = [
            replace(one, needs=tuple(at + len(self.wishes) for at in one.needs))
            for one in note.wishes
        ]
        return replace(self, wishes=(*self.wishes, *later), **both)

    def to_json(self) -> dict[str, Any]:
        """Return plain values, for report.json and `cityx explain`."""
        record = asdict(replace(self, wishes=()))
        record["unread"] = [
            {"text": self.text[first:last], "span": [first, last]} for first, last in self.unread
        ]
        return _plain(record)  # type: ignore[no-any-return]


class Clarify(UsageError):
    """An instruction leaves open what is meant; nothing was done.

    Parameters
    ----------
    brief
        The instruction as it was read; its conflicts and questions say what is open.
    notes
        What else is to be said of the reading.
    """

    def __init__(self, brief: Brief, notes: Sequence[str] = ()) -> None:
        said = [conflict.text for conflict in brief.conflicts]
        said += [question.said for question in brief.questions]
        said += [f"note: {note}" for note in notes]
        super().__init__("\n".join(said))
        self.brief = brief


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items() if item not in ("", None, ())}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value
