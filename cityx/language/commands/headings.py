"""Headings: what a request says besides its orders: a title, what it is about, a reason, a "maybe".

None of it changes anything, so none of it holds up what the request orders.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from cityx.language.brief import Note, Selector
from cityx.language.commands.grammar import parse
from cityx.language.commands.selection import targets_of
from cityx.language.commands.terminals import terminals_of
from cityx.language.commands.wishes import FRONTS, is_command, is_limit, span_of
from cityx.language.commands.words_put_in import asked
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ

_REASONS = (
    ("so", "that"), ("so",), ("because",), ("in", "order", "to"), ("there", "no"),
    ("there", "is", "no"), ("there", "are", "no"), ("it", "too"), ("it", "is", "too"),
    ("it's", "too"), ("they", "too"), ("they", "are", "too"), ("they're", "too"), ("that", "too"),
)  # fmt: skip
# Phrases that leave an order to who carries it out.
_ASIDES = (
    ("if", "you", "can"), ("if", "possible"), ("if", "feasible"), ("if", "that", "works"),
    ("if", "that", "possible"), ("if", "that", "is", "possible"), ("if", "it", "possible"),
    ("if", "it", "is", "possible"), ("if", "that's", "possible"), ("if", "it's", "possible"),
    ("if", "you", "like"), ("where", "possible"), ("ideally",), ("preferably",), ("maybe",),
    ("perhaps",), ("thanks",), ("thank", "you"), ("cheers",), ("please",),
)  # fmt: skip
# Words that only begin a sentence: "ok so", "oh and".
_OPENINGS = ("ok", "okay", "hey", "hi", "hello", "so", "well", "oh", "alright", "right then",
             "anyway", "um", "please")  # fmt: skip
_RELATIVE = ("where", "wherever", "that", "which")
_NEW = ("a", "an", "some", "another", "several", "no")
_LOOKS = ("color", "material", "surface")
_PURPOSE = " is taken as what it is for; it changes nothing."
_MOTIVE = " is taken as a reason; it changes nothing."
_OBJECTS = ("building", "type", "element", "plant", "vehicle", "person", "road", "place")


def without_asides(text: str, items: Sequence[Item]) -> tuple[list[Item], list[Note]]:
    """Return the items of a request without its reasons and asides, and what is to be noted.

    A reason that names an amount says how much is meant, and stays.
    """
    kept: list[Item] = []
    notes: list[Note] = []
    at = 0
    while at < len(items):
        aside = _length(items, at, _ASIDES)
        if aside and not items[at].state and (kept or items[at].text != "please"):
            for item in items[at : at + aside]:
                item.state = READ
            at += aside
            continue
        end = _end_of_telling(items, at)
        if end > at:
            notes.append(_passed_over(text, items[at:end], "told", f": {_IN_ANY_CASE}"))
            at = end
            continue
        begins = not kept or kept[-1].is_mark(ENDS)
        if begins and items[at].text in _OPENINGS and not items[at].noun:
            items[at].state = READ
            at += 1
            continue
        end = _end_of_purpose(items, at) if begins else _end_of_cause(items, at, kept)
        if end > at:
            notes.append(_passed_over(text, items[at:end], "purpose", _PURPOSE))
            at = end
            continue
        if _orders_behind_so(items, at):
            items[at].state = READ
            motive = _motive_of(kept)
            if motive:
                notes.append(_passed_over(text, motive, "reason", _MOTIVE))
                del kept[-len(motive) :]
            at += 1
            continue
        reason = _length(items, at, _REASONS)
        place = bool(kept) and kept[-1].text in _RELATIVE  # "benches where | there are no trees"
        if place and reason:
            asked(items[at - 1 : next((k for k in range(at, len(items))
                                       if items[k].kind == "mark"), len(items))])  # fmt: skip
        reason = reason and not place and any(one.has("verb", "slot") or one.noun for one in kept)
        end = _end_of_reason(items, at) if reason else at
        if end > at:
            why = " is taken as a reason; nothing measures it."
            notes.append(_passed_over(text, items[at:end], "reason", why))
            at = end
            continue
        kept.append(items[at])
        at += 1
    return kept, notes


def _passed_over(text: str, items: Sequence[Item], code: str, why: str) -> Note:
    """Take words for read that change nothing, and return the note that quotes them."""
    for item in items:
        item.state = READ
    span = span_of(items)
    return Note(code, f'"{text[slice(*span)]}"{why}', span)


def _length(items: Sequence[Item], at: int, phrases: Sequence[tuple[str, ...]]) -> int:
    """Return how many items a phrase takes that begins at one, 0 where none does."""
    for phrase in phrases:
        said: tuple[str, ...] = ()
        for number, item in enumerate(items[at : at + len(phrase)], start=1):
            said += item.words
            if said == phrase:
                return number
    return 0


_IN_ANY_CASE = "what cannot be done is named in any case."
_WHEN = ("if", "where", "wherever", "when", "whenever")
_TELLING = ("tell", "say", "report", "list", "name", "flag", "mention", "know", "warn", "note")
_CANNOT = ("room", "fit", "fits", "possible", "impossible", "space", "enough", "work", "works")


def _end_of_telling(items: Sequence[Item], at: int) -> int:
    """Return where a wish ends to be told what cannot be done; `at` where there is none.

    "If it doesn't fit, say where"; "where that's not possible tell me which ones".
    """
    begins = at == 0 or items[at - 1].kind == "mark" or items[at - 1].get("rel") in ("and", "but")
    if items[at].text not in _WHEN or not begins:
        return at
    end = at
    while end < len(items) and not items[end].is_mark(ENDS + ";"):
        end += 1
    words = {one.text for one in items[at:end]}
    told = words.intersection(_TELLING) and words.intersection(_CANNOT)
    return end if told and not any(one.noun for one in items[at:end]) else at


def _end_of_cause(items: Sequence[Item], at: int, kept: Sequence[Item]) -> int:
    """Return where "close the bridge | for repairs" ends, which adds nothing; `at` for none."""
    if items[at].text != "for" or not any(one.get("verb") in ("CLOSE", "REMOVE") for one in kept):
        return at
    end = next((k for k in range(at, len(items)) if items[k].kind == "mark"), len(items))
    return end if _is_purpose([one for one in items[at + 1 : end]
                               if one.kind != "function"]) else at  # fmt: skip


def _orders_behind_so(items: Sequence[Item], at: int) -> bool:
    """Return whether an order follows a reason: "it is too dark, so | add lamps"."""
    if items[at].text not in ("so", "therefore", "hence") or at + 1 >= len(items):
        return False
    said = [one for one in items[at + 1 : at + 6] if one.state != READ
            and one.kind != "function" and one.get("rel") != "please"]  # fmt: skip
    verb = next(iter(said), items[at])
    place = next(k for k, one in enumerate(items) if one is verb)
    return verb.has("verb") and not verb.state and is_command(items, place)


def _motive_of(kept: Sequence[Item]) -> list[Item]:
    """Return the words of a sentence up to here that tell why, none where these order something."""
    begin = next((at + 1 for at in range(len(kept) - 1, -1, -1) if kept[at].is_mark(ENDS)), 0)
    said = list(kept[begin:])
    ordered = [one for one in said if one.kind != "mark" and one.get("rel") != "please"][:1]
    return [] if not ordered or ordered[0].has("verb") else said


def _end_of_purpose(items: Sequence[Item], at: int) -> int:
    """Return where "for the flood study," ends, behind which an order begins; `at` for none."""
    if items[at].text != "for":
        return at
    end = at + 1
    while end < len(items) and not items[end].is_mark(ENDS + ",:") and not items[end].has("verb"):
        end += 1
    said = [item for item in items[at + 1 : end] if item.kind != "function"]
    after = items[end : end + 2]
    ordered = any(item.has("verb") and item.state == "" for item in after)
    if not said or not ordered or said[-1].kind != "unknown":
        return at  # "for the houses, ..." names what is meant
    if any(item.state or item.has("rank", "slot", "neg", *_LOOKS) or item.kind == "id"
           or item.quantity is not None for item in said):  # fmt: skip
        return at
    return end + (items[end].kind == "mark")


def _end_of_reason(items: Sequence[Item], at: int) -> int:
    """Return where a reason ends: at a mark, or before the next order; `at` where it is none."""
    end = at + 1
    while end < len(items) and not items[end].is_mark(ENDS + ",:()"):
        joined = items[end].get("rel") == "and" and end + 1 < len(items)
        if joined and items[end + 1].has("verb") and is_command(items, end + 1):
            break
        end += 1
    told = any(item.quantity is not None or item.has("compared", "bound")
               for item in items[at:end])  # fmt: skip
    return at if told or end - at < 3 else end  # "so it is" says nothing of its own


# What begins a sentence that tells what a request is for.
_REMARKS = (
    ("it", "for"), ("it", "is", "for"), ("this", "is", "for"), ("this", "for"), ("it", "a"),
    ("it", "is", "a"), ("this", "is", "a"), ("i'm", "filming"), ("i'm", "planning"),
    ("i'm", "making"), ("i'm", "shooting"), ("i", "am", "filming"), ("i", "am", "planning"),
    ("i", "filming"), ("i", "planning"), ("we're", "filming"), ("we're", "making"),
    ("we're", "planning"), ("we", "are", "filming"), ("we", "are", "planning"),
)  # fmt: skip


def _is_ordered(before: Item, item: Item) -> bool:
    """Return whether a word is a change that somebody is about to make: "planning to | add"."""
    return before.text == "to" and item.get("verb") in _CHANGES


_CHANGES = ("ADD", "PLANT", "REMOVE", "REPLACE", "PAINT", "MOVE", "RAISE", "LOWER", "WIDEN")


def is_remark(words: Sequence[Item]) -> bool:
    """Return whether a sentence only tells what a request is for: "It's for a 1945 film."."""
    said = [item for item in words if item.kind != "mark"]
    told = tuple(word for item in said[:4] for word in item.words)
    if not any(told[: len(one)] == one for one in _REMARKS):
        return False
    if any(_is_ordered(before, item) for before, item in pairwise(said)):
        return False
    return not any(
        (item.state not in ("", READ))
        or is_limit(item)
        or item.kind == "id"
        or item.has(*_LOOKS, "compared", "neg")
        or item.get("rel") == "too" or (item.has("slot") and not item.noun)
        or (item.quantity is not None and item.quantity.dimension in _MEASURED)
        for item in said[1:]
    )  # fmt: skip


_MEASURED = ("length", "floors", "share", "lanes", "speed", "area")


def is_heading(words: Sequence[Item], after: Sequence[Sequence[Item]], *, first: bool) -> bool:
    """Return whether a clause is a title: "Security planning: ...", "Audit mock-up. ..."."""
    said = [item for item in words if item.kind not in ("mark", "function")]
    if not said:
        return False
    if words[-1].is_mark(":") and words[0].text == "for" and after and _is_purpose(said):
        return True  # "For my thesis: ..."
    if not any(map(_orders, after)):
        return False
    told = words[-1].is_mark(":") and _orders(after[0])  # "Night market: 15 stalls ..."
    if any(item.state or is_limit(item) or item.kind == "id" or item.has(*_LOOKS)
           or (item.has("slot") and not told)
           or (item.quantity is not None and item.quantity.dimension not in ("count", "hour"))
           for item in said):  # fmt: skip
        return False
    orders = any(item.has("verb") and not item.noun for item in said)
    if words[-1].is_mark(":"):
        return not orders or any(item.kind == "unknown" for item in said)
    plain = all(item.kind == "unknown" or (item.has("attr") and not item.noun) for item in said)
    return first and words[-1].is_mark(".!\n") and plain


def _is_purpose(said: Sequence[Item]) -> bool:
    """Return whether "for ..." names what a request is for, and no things of the city."""
    return not any(
        item.state or item.has("noun", "slot", "rank", *_LOOKS) or item.quantity is not None
        or item.get("rel") in ("all", "every") or item.kind == "id"
        for item in said
    ) and any(item.kind == "unknown" for item in said)  # fmt: skip


def _orders(clause: Sequence[Item]) -> bool:
    """Return whether a clause orders something: it begins with a verb, or names what is new."""
    said = [item for item in clause if item.kind != "mark" and item.get("rel") != "please"]
    if not said:
        return False
    first = next((item for item in said if item.kind != "function"), said[0])
    counted = first.quantity is not None and first.quantity.dimension in ("count", "speed")
    several = first.noun_class in _OBJECTS and first.words[-1].endswith("s")
    return first.has("verb") or counted or several or said[0].words[0] in _NEW


def topic_of(words: Sequence[Item]) -> list[Selector]:
    """Return the objects that a heading is about: "The park needs work:", "In the park:"."""
    said = [item for item in words if item.kind != "mark"]
    if said and said[0].get("rel") in FRONTS:
        said = said[1:]
    end = next((at for at, item in enumerate(said) if at and item.get("rel") == "be"), len(said))
    if any(item.kind == "unknown" for item in said[:end]):
        return []
    terminals = terminals_of(said[:end], verb_first=False)
    command = parse(terminals, said[:end]) if terminals else None
    return targets_of(command) if command is not None and command.name == "topic" else []
