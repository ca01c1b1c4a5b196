"""Topics: what a request is about, where its commands do not name it themselves.

"In the park put a pond in the middle and a bench at the edge", "the two towers ruin the view:
lower both", "every third house: add a storey", "clear it, and make that land a square".
"""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.commands.roles import TERM
from cityx.language.commands.words_put_in import LAND, by_sentence, here, removes
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ

_FRONTS = ("in", "on", "at")
_BESIDE = ("along", "near", "around")  # of which nothing is a part
_PUTS = ("ADD", "PLANT")
_WITHIN = ("in", "on", "at", "near", "along", "around")
_LAND = (*LAND, "place")
_TURNS = ("MAKE", "REPLACE", "ADD")


def place_first(items: list[Item]) -> list[Item]:
    """Read "in the park put a pond in the middle, ..." as "in the park: put a pond ...".

    Each of the things has a place of its own, which lies in the one that is told first.
    """
    return by_sentence(items, _with_topic)


def _with_topic(sentence: list[Item]) -> list[Item]:
    verb = next((at for at, one in enumerate(sentence) if one.get("verb") in _PUTS), 0)
    place = [one for one in sentence[:verb] if one.kind != "mark"]
    if not place or place[0].get("rel") not in (*_FRONTS, *_BESIDE) or sentence[verb].state:
        return sentence
    named = [one for one in place if one.noun or one.kind == "id"]
    plain = all(one.kind == "function" or one in named for one in place[1:])
    parts = [at for at in range(verb, len(sentence)) if _is_part_of_it(sentence, at)]
    others = [one for one in sentence[verb:]
              if one.get("rel") in (*_WITHIN, "to") and one.words[-1] != "facing"]  # fmt: skip
    if len(named) != 1 or not plain or (others and not parts):
        return sentence
    listed = any(one.get("rel") == "and" or one.is_mark(",") for one in sentence[verb:])
    if not parts and not listed:  # one thing, whose place is told behind it as well
        end = len(sentence) - bool(sentence[-1].is_mark(ENDS))
        turned = (at for at in range(verb, end) if sentence[at].words[-1] == "facing")
        end = next(turned, end)
        return [*sentence[verb:end], *place, *sentence[end:]]
    if place[0].get("rel") in _BESIDE:
        return sentence
    return [*place, here(sentence[verb], ":", kind="mark"), *sentence[verb:]]


def _is_part_of_it(sentence: Sequence[Item], at: int) -> bool:
    """Return whether what stands here is a place in what is told first: "in the middle"."""
    if sentence[at].get("rel") not in _WITHIN:
        return False
    after = [one for one in sentence[at + 1 : at + 5] if one.kind != "function"][:2]
    return any(one.get(TERM) in ("END", "EDGE", "MIDDLE", "CORNER") for one in after) or (
        bool(after) and after[0].has("side")
    )


def both(items: list[Item]) -> list[Item]:
    """Read "lower both to 18 m" as of the two that were spoken of."""
    for item, after in zip(items, [*items[1:], None], strict=False):
        alone = after is None or after.kind == "mark" or after.get("rel") in ("to", "by", "with")
        if item.text in ("both", "both of them", "all of them") and alone and not item.state:
            item.words, item.senses = ("them",), (("rel", "it"),)
    return items


def that_land(items: list[Item]) -> list[Item]:
    """Read "clear it, and make that land a square" as "..., and put a square in its place"."""
    for at, item in enumerate(items):
        verb = items[at - 1] if at else item
        land = items[at + 1] if at + 1 < len(items) else item
        if _becomes(items, at) and removes(items[:at]):  # "and its plot becomes a playground"
            return _in_its_place(items, at, land, items[at + 3 :])
        if verb.get("verb") not in _TURNS or item.get("rel") != "it" or land.text not in _LAND:
            continue
        if item.text not in ("that", "this") or not removes(items[: at - 1]):
            continue
        rest = items[at + 2 :]
        if rest and rest[0].text in ("into", "to", "in to"):
            rest = rest[1:]
        return _in_its_place(items, at - 1, land, rest)
    return items


def _becomes(items: Sequence[Item], at: int) -> bool:
    """Return whether land is said to become something: "its plot becomes"."""
    said = [one.text for one in items[at : at + 3]]
    return len(said) == 3 and said[0] in ("its", "their", "the", "that", "this") and (
        said[1] in _LAND and said[2] in ("becomes", "become", "becoming")
    )  # fmt: skip


def _in_its_place(
    items: list[Item], at: int, land: Item, rest: Sequence[Item]
) -> list[Item]:  # fmt: skip
    """Return items in which what comes behind a place is put into what was cleared."""
    ends = (k for k, one in enumerate(rest) if one.is_mark(ENDS) or one.get("rel") == "with")
    end = next(ends, len(rest))
    put = here(items[at], "put", ("verb", "ADD"))
    place = [here(land, "in", ("rel", "in")),
             Item("phrase", land.span, ("its", "place"), (("rel", "it"),))]  # fmt: skip
    return [*items[:at], put, *rest[:end], *place, *rest[end:]]


def of_the_topic(clause: Sequence[Item]) -> list[Item]:
    """Return a command behind a colon with what was named before it: "add a storey | to them".

    "Convert to shops" is "convert them to shops". Empty where it names what it is about, or puts
    something somewhere.
    """
    said = [item for item in clause if item.kind != "mark" and item.state != READ]
    if not said or not said[0].has("verb"):
        return []
    verb, *rest = said
    it = here(verb, "them", ("rel", "it"))
    if not rest:
        return [verb, it]  # "b03: demolish"
    if rest[0].get("rel") in ("to", "in", "by"):
        return [verb, it, *rest]
    amount = rest[0].quantity
    if amount is not None and amount.dimension in ("floors", "length", "lanes") and len(rest) == 1:
        return [verb, *rest, here(verb, "to", ("rel", "to")), it]
    return []


def subject_of(items: Sequence[Item]) -> int:
    """Return where the subject ends of a sentence that orders nothing: "the towers | ruin it".

    0 where it may order something, or tells what something is to be.
    """
    end = next((at for at, one in enumerate(items) if at and _tells_of_it(items, at)), 0)
    subject, told = items[:end], items[end:]
    known = any(one.kind == "id" for one in subject) or (
        bool(subject) and subject[0].kind == "function"
        and any(one.noun_class in ("building", "type") for one in subject)
        and all(one.noun_class in ("", "building", "type") for one in subject)
    )  # fmt: skip
    plain = not any(
        one.has("verb", "slot", "color", "material", "compared") or one.state or one.kind == "id"
        or (one.quantity is not None and one.quantity.dimension != "count")
        or one.noun_class in ("building", "type", "element", "plant", "vehicle", "road")
        for one in told
    )  # fmt: skip
    orders = any(one.has("verb") for one in subject)
    strange = any(one.kind == "unknown" or one.text in ("too", "so", "very") for one in told)
    return end if known and plain and strange and not orders else 0


def _tells_of_it(items: Sequence[Item], at: int) -> bool:
    """Return whether a verb that orders nothing stands at an item."""
    item = items[at]
    return item.get("rel") == "be" or (item.kind == "unknown" and not item.has("noun"))
