"""Coverage: the words of an instruction that no part of its reading stands for.

The rules mark what they read. Here the text is held against what came of it instead: a word that
stands in no slot, denial, command or note is lost, however a rule may have marked it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cityx.language.brief import Note, Slot, Span
from cityx.language.lexicon.numbers import EVERY_SO_MANY
from cityx.language.lexicon.phrases import FUNCTION_WORDS
from cityx.language.lexicon.words import forms_of
from cityx.language.scan import ENDS, Item, begin_of, end_of, within
from cityx.language.scopes import READ
from cityx.language.syntax import Syntax
from cityx.system.tables import load

# Verbs and nouns of the function words that say something where nothing carries them on.
_LINKING = load("language/spelling", frozenset[str], "linking")
_NARROWER = frozenset(" ".join(load("language/things", str, "narrower").split()).split(", "))
_RELATING = load("language/spelling", frozenset[str], "relating")
_RELATED = (".near", ".relation", ".by")  # ends of keys for how things stand to each other
# Relations that say something by themselves: "every other", "in one direction", "the rest".
_TELLING = (*EVERY_SO_MANY, "direction", "change", "green", "rest")
_FRAMES = ("place:city", "place:landscape")  # nouns for all of the site
_MAKING = ("MAKE", "ADD", "APPLY")  # verbs by which users begin any wish
_USUAL = ("drive", "walk", "ride")  # what vehicles and people do anyway
_TOLD = ("rank", "mode", "ordinal", "keep", "unchanged")


def lost(items: Sequence[Item], slots: Sequence[Slot], told: Iterable[Span]) -> list[Item]:
    """Return the items with content that nothing of a reading stands for.

    Parameters
    ----------
    items
        All items of the text.
    slots
        What was read: what is asked for, denied and kept.
    told
        Other places of the text that something was made or told of.
    """
    covered = within(items, [*(slot.span for slot in slots), *told])
    related = any(slot.key.endswith(_RELATED) for slot in slots)
    said = {part for slot in slots for part in (*slot.key.split("."), str(slot.value))}
    syntax = Syntax(items)
    before = _told_before(items, covered)
    after = _told_before(items[::-1], covered[::-1])[::-1]
    kept = [slot.span for slot in slots if slot.key == "keep"]
    return [
        item for at, item in enumerate(items)
        if not covered[at] and (
            not _is_carried(syntax, covered, before, after, at)
            or (item.text in _RELATING and not related)
        )
        and _says_something(item) and not _is_said(item, said)
        and not (item.has("keep", "unchanged") and _is_in_a_sentence(items, at, kept))
    ]  # fmt: skip


def narrower(text: str, items: Sequence[Item]) -> list[Note]:
    """Return notes on names that say more than what is built shows: "a | primary school"."""
    return [
        Note("narrower", f'"{text[slice(*item.span)]}" is built as any {noun}; what else its name '
             "says is left open.", item.span)
        for item in items
        if item.state == READ and not _NARROWER.isdisjoint(_singulars(item))
        and (noun := item.noun.replace("_", " "))
    ]  # fmt: skip


def _singulars(item: Item) -> set[str]:
    """Return the words of an item with its last word in each of its forms."""
    *before, last = [word for word in item.words if word != "-"] or [""]
    return {" ".join((*before, form)) for form in forms_of(last)}


def _is_carried(
    syntax: Syntax,
    covered: Sequence[bool],
    before: Sequence[bool],
    after: Sequence[bool],
    at: int,
) -> bool:
    """Return whether what stands around an item carries it: the head of what is told, a verb."""
    if syntax.items[at].quantity is not None or syntax.items[at].get("rel") in EVERY_SO_MANY:
        return False
    phrase = syntax.phrase(at)
    if phrase is not None and any(covered[phrase.first : phrase.end]):
        return True
    first, end = (at, at + 1) if phrase is None else (phrase.first, phrase.end)
    if end < len(covered) and _is_a_copula(syntax.items[end]) and after[end]:
        return True  # "streets | with two lanes", "the roofs | are red"
    if end + 1 < len(covered) and syntax.items[end].is_mark(":") and covered[end + 1]:
        return True  # "streets | : narrow"
    link = syntax.items[first - 1] if first else None
    if link is not None and link.has("rel", "compared") and link.state == READ:
        return True  # "palms along | the streets": the relation was read with what it is to
    if syntax.items[at].get("mode") in _USUAL and before[at]:
        return True  # "cars | driving"
    return before[at] and after[at]


def _told_before(items: Sequence[Item], covered: Sequence[bool]) -> list[bool]:
    """Return for each item whether the last one with content in its clause is covered."""
    told, last = [], False
    for item, here in zip(items, covered, strict=True):
        told.append(last)
        if item.kind == "mark":
            last = False
        elif here or not _is_empty(item):
            last = here
    return told


def _is_a_copula(item: Item) -> bool:
    return item.get("rel") in ("with", "of", "be") or item.text in ("have", "has", "having")


def _is_empty(item: Item) -> bool:
    return item.kind == "function" or item.has("rel", "exact", "approx", "bound")


def _says_something(item: Item) -> bool:
    if item.quantity is not None:
        return bool(item.state) and item.quantity.exact != 1
    if item.kind == "function" or (item.kind == "phrase" and item.text in FUNCTION_WORDS):
        return item.text in _LINKING
    if item.has("any_source", "source"):
        return False
    if item.has("noun", "head"):
        noun = item.get("noun") or item.get("head")
        return noun not in _FRAMES and (item.state == READ or item.get("verb") in _MAKING)
    if item.has("verb"):
        return item.get("verb") not in _MAKING
    return item.has(*_TOLD) or item.get("rel") in _TELLING


def _is_in_a_sentence(items: Sequence[Item], at: int, spans: Sequence[Span]) -> bool:
    """Return whether something of a text stands in the same sentence as an item."""
    sentence = items[begin_of(items, at, ENDS) : end_of(items, at, ENDS)]
    return any(sentence[0].span[0] <= one[0] < sentence[-1].span[1] for one in spans)


def _is_said(item: Item, said: set[str]) -> bool:
    """Return whether a slot at another word says the same."""
    values = {value.partition("=")[2] for kind, value in item.senses if kind == "slot"}
    return bool(item.noun and item.noun in said) or not values.isdisjoint(said)
