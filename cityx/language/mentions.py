"""Mentions: things that a text speaks of and does not ask for.

What the user does ("we train robots"), what was once, what would be if, for whom something is,
and what something is to be kept away from are no wishes.
"""

from __future__ import annotations

from collections.abc import Container, Sequence

from cityx.language.here import AIR, Findings
from cityx.language.lexicon.phrases import PARTS_OF_SPEECH
from cityx.language.scan import ENDS, Item, begin_of, end_of
from cityx.language.scopes import KEPT, NEGATED, READ
from cityx.language.syntax import Syntax, is_plural
from cityx.system.tables import load

_USERS = ("i", "we", "they")
_TEAM = ("team", "group", "students", "class", "lab", "company", "pupils")
_WISHING = load("language/spelling", frozenset[str], "wishing")
_OPEN = ("possible", "you", "need", "necessary", "needed", "feasible")  # after "if"
_ACCESS = ("CLOSE", "OPEN")
_ACCESSIBLE = (
    "close", "closed", "closing", "shut", "open", "opened", "barred", "accessible", "reserved",
)  # fmt: skip
_LIVING = ("vehicle", "person")
_GENERIC = ("vehicle", "person", "element", "plant", "place", "type")
_CALLED = ("tagged", "labelled", "labeled", "marked", "called", "named")
_WHERE = ("in", "at", "through", "on", "along", "across", "during", "inside", "within", "with")


def leave_mentions(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Leave open what is only spoken of."""
    for at, item in enumerate(items):
        if item.text in _USERS or item.text in _TEAM:
            _leave_doing(found, items, syntax, at)
        elif item.text.startswith("avoid") and _is_purpose(items, at):
            _leave(found, items[at : end_of(items, at, ENDS + ",:")], "what something is for")
        elif item.state:
            continue
        elif item.text in ("was", "were") or _is_used_to(items, at):
            _leave_past(found, items, at)
        elif item.text == "if" and _is_condition(items, at):
            first = (
                at
                if at + 1 == len(items) or _is_at_a_begin(items, at)
                else begin_of(items, at, ENDS + ",")
            )
            _leave(found, items[first : end_of(items, at, ENDS + ",")], "what may be or not")
        elif item.text == "from" and _is_kept_away(items, at):
            _leave(found, _listed(items, at), "what something is to keep away from")
        elif item.noun_class in _LIVING and (about := _beneficiary(items, syntax, at)):
            found.leave(item, about)
        elif item.noun and items[at - 1].text in _CALLED and at:
            _leave(found, items[at - 1 : _end_of_list(items, at)], "what is called so")
        elif item.text == "here" and _is_introduced(items, at):
            _leave(found, items[begin_of(items, at, ENDS + ",") : at + 1], "who speaks")
        elif item.get("slot").startswith("not=") and _is_of_one(items, syntax, at):
            found.leave(item, "for whom it is")
        elif item.noun and _is_what_one_is_for(items, syntax, at):
            found.leave(item, "what it is for")


def _leave_doing(found: Findings, items: Sequence[Item], syntax: Syntax, at: int) -> None:
    """Leave what a user does or deals with in general: "we | train agents", "I | study rivers"."""
    begins = at == 0 or items[at - 1].kind in ("mark", "function") or items[at - 1].has("rel")
    doing = items[at + 1 : at + 4]
    if not begins or not doing or any(_says(one, _WISHING) for one in doing):
        return
    end = end_of(items, at, ENDS + ",:")
    for n in range(at + 1, end):
        if n > at + 2 and items[n].text in _WHERE and not syntax.phrase(n):
            end = n
            break
    for n in range(at + 1, end):
        item = items[n]
        verb = n == at + 1 and item.has("noun") and not is_plural(item.text)
        bare = is_plural(item.words[-1]) or item.text in ("traffic",)
        generic = item.noun_class in _GENERIC and bare and not _is_told(items, syntax, n)
        if item.state in ("", NEGATED, KEPT) and (verb or generic):
            found.leave(item, "what somebody does")


def _says(item: Item, words: Container[str]) -> bool:
    return any(word in words for word in item.words)


def _is_told(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether an article or a number stands before a noun."""
    phrase = syntax.phrase(at)
    first = items[at] if phrase is None else items[phrase.first]
    counted = first.quantity is not None or first.has("amount")
    return counted or first.text in PARTS_OF_SPEECH["determiners"]


def _is_used_to(items: Sequence[Item], at: int) -> bool:
    behind = items[at + 1 : at + 2]
    return items[at].text == "used" and bool(behind) and behind[0].words[0] == "to"


def _leave_past(found: Findings, items: Sequence[Item], at: int) -> None:
    """Leave what was: "where people | used to sit"; but "it was night" tells of now."""
    before = items[at - 1] if at else None
    if before is None or before.text == "it" or before.kind == "quantity":
        return
    there = before.text == "there"
    end = end_of(items, at, ENDS + ",")
    first = at - 1 if before.noun_class in _LIVING or there else at
    sky = any(one.get("slot").startswith(AIR) for one in items[at:end])
    if not sky or there:
        _leave(found, items[first:end], "what was")


def _is_purpose(items: Sequence[Item], at: int) -> bool:
    """Return whether "to avoid cars" tells what others are to do, and is no wish of the user."""
    before = items[begin_of(items, at, ENDS + ",") : at]
    return (
        bool(before) and before[-1].text == "to" and not any(_says(one, _WISHING) for one in before)
    )


def _is_condition(items: Sequence[Item], at: int) -> bool:
    """Return whether "if" begins a condition: not "as if", not "if possible"."""
    before, after = items[at - 1] if at else None, items[at + 1 : at + 2]
    as_if = before is not None and before.text in ("as", "even", "see", "check", "tell")
    return bool(after) and not as_if and after[0].text not in _OPEN


def _is_at_a_begin(items: Sequence[Item], at: int) -> bool:
    """Return whether a condition stands before what it is for: "and if | there is a pond, ..."."""
    before = items[begin_of(items, at, ENDS + ",") : at]
    return all(one.kind == "function" or one.has("rel") for one in before)


def _is_kept_away(items: Sequence[Item], at: int) -> bool:
    """Return whether something is to keep away or to stay clear from what follows."""
    before = [one.text for one in items[max(0, at - 4) : at]]
    away = bool(before) and before[-1] in ("away", "clear", "off", "out")
    return away and not {"keep", "keeps", "stay", "stays", "steer", "kept"}.isdisjoint(before)


def _listed(items: Sequence[Item], at: int) -> Sequence[Item]:
    """Return a preposition with all that is listed behind it."""
    end = end_of(items, at, ENDS + ",")
    return items[at:end]


def _beneficiary(items: Sequence[Item], syntax: Syntax, at: int) -> str:
    """Return for whom something is, where a noun says that: "one for | cars"."""
    phrase = syntax.phrase(at)
    if phrase is None or phrase.head != at:
        return ""
    if any(one.quantity is not None or one.has("amount") for one in items[phrase.first : at]):
        return ""
    first = phrase.first
    while first > 1 and items[first - 1].get("rel") in ("and", "or"):
        listed = syntax.phrase(first - 2)
        if listed is None or items[listed.head].noun_class not in _LIVING:
            break
        first = listed.first
    link = items[first - 1] if first else None
    if link is None or items[at].state:
        return ""
    if link.text == "by" and first > 1 and items[first - 2].kind in ("function", "unknown"):
        return "who does something"  # "hit by | cars"
    each = any(one.text in ("every", "each") for one in items[first:at])
    if each and first > 1 and items[first - 2].noun_class in _LIVING:
        return ""  # "two cars for every | bicycle"
    if link.text in ("for", "only for", "just for", "for only"):
        return "for whom it is"
    clause = items[begin_of(items, at, ENDS + ",") : first - 1]
    access = any(_says(one, _ACCESSIBLE) or one.get("verb") in _ACCESS for one in clause)
    close_to = any(one.text == "close" for one in clause)  # "close the square to cars"
    return "whom a place is open to" if link.text == "to" and (access or close_to) else ""


def _is_of_one(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether one thing is for some alone: "a bridge used by | pedestrians only"."""
    link = items[at - 1] if at else None
    head = syntax.head_before(at - 1) if link is not None and link.text in ("by", "for") else -1
    return head >= 0 and items[head].noun_class in ("element", "type", "road")


def _is_what_one_is_for(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether a number stands for a thing for others: "two cranes, one for | ships"."""
    phrase = syntax.phrase(at)
    first = at if phrase is None else phrase.first
    if first < 2 or items[first - 1].text != "for":
        return False
    number = items[first - 2]
    counted = number.quantity is not None and number.quantity.dimension == "count"
    return counted and syntax.head_behind(first - 2) < 0


def _end_of_list(items: Sequence[Item], at: int) -> int:
    """Return where nouns that "or" joins end: "tagged | restaurant or cafe"."""
    while at + 2 < len(items) and items[at + 1].get("rel") == "or" and items[at + 2].noun:
        at += 2
    return at + 1


def _is_introduced(items: Sequence[Item], at: int) -> bool:
    """Return whether somebody says who speaks: "Heritage office | here."."""
    said = items[begin_of(items, at, ENDS + ",") : at]
    ends = at + 1 == len(items) or items[at + 1].is_mark(ENDS + ",")
    told = any(one.has("verb", "mode") or one.get("rel") for one in said)
    return bool(said) and len(said) < 4 and ends and not told and said[0].kind != "function"


def _leave(found: Findings, items: Sequence[Item], about: str) -> None:
    """Note some items in a row as one."""
    for item in items:
        if item.state in ("", NEGATED, KEPT):
            item.state = READ
    found.leave_span((items[0].span[0], items[-1].span[1]), about)
