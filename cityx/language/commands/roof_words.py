"""Roofs in a request for a city that stands: of all, of those of a form, and others for them."""

from __future__ import annotations

from dataclasses import replace

from cityx.language.commands.words_put_in import ROOFS
from cityx.language.lexicon.phrases import part_named
from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.scopes import READ

_CARRY = ("carrying", "bearing", "with", "holding")
_ALL = ("all", "every")
_LEADS = ("please", "and", *_ALL)


def roofs_of_a_form(items: list[Item]) -> list[Item]:
    """Read "make the flat roofs green" as of the roofs of the buildings that have such.

    Nothing says there that others are to become flat.
    """
    for at, item in enumerate(items):
        if not item.get("slot").startswith(ROOFS) or item.words[-1] != "roofs" or item.state:
            continue
        clause = items[begin_of(items, at, ENDS + ",:") : at]
        begin = max((n + 1 for n, one in enumerate(clause) if one.get("rel") == "and"), default=0)
        lead = [one for one in clause[begin:] if one.kind != "mark"]
        makes = [one for one in clause if one.get("verb") in ("MAKE", "PAINT")]
        known = any(one.words[-1] == "the" or one.get("rel") in _ALL for one in lead[-1:])
        plain = all(one in makes or one.kind == "function" or one.get("rel") in _LEADS
                    for one in lead)  # fmt: skip
        told = [one for one in items[at + 1 : at + 5] if one.get("rel") not in ("be", "to")]
        look = told[0] if told else item
        looks = look.has("color", "material") or look.get("slot").startswith(ROOFS)
        if not (known and plain and looks) or not (makes or items[at + 1].get("rel") == "be"):
            continue
        where = item.span
        paint = Item("phrase", where, ("paint",), (("verb", "PAINT"),))
        roofs = [Item("phrase", where, ("roofs",), (("noun", "place:roof"),)),
                 Item("phrase", where, ("of",), (("rel", "of"),)),
                 Item("phrase", where, ("all",), (("rel", "all"),)),
                 Item("phrase", where, ("buildings",), (("noun", "building:building"),)),
                 Item("phrase", where, ("with",), (("rel", "with"),))]  # fmt: skip
        why = [one for one in clause[begin:] if one.text == "so"]  # "..., so make them green"
        joined = [*clause[:begin], *why]
        own = replace(item, senses=tuple(one for one in item.senses if one[0] == "slot"))
        rest = roofs_of_a_form(_painted_too(items[items.index(look) :]))
        return [*items[: at - len(clause)], *joined, paint, *roofs, own, *rest]
    return items


def _painted_too(rest: list[Item]) -> list[Item]:
    """Return what follows a look with a verb where it is of other things: "..., the walls red"."""
    joined = next((n for n, one in enumerate(rest[:3]) if one.get("rel") == "and"), 0)
    after = [one for one in rest[joined + 1 : joined + 4] if one.kind != "function"][:1]
    other = bool(after) and (
        bool(after[0].noun) or part_named(after[0].text) or after[0].get("slot").startswith(ROOFS)
    )
    if not joined or not other or after[0].has("verb"):
        return rest
    paint = Item("phrase", rest[joined].span, ("paint",), (("verb", "PAINT"),))
    return [*rest[: joined + 1], paint, *rest[joined + 1 :]]


def all_roofs(items: list[Item]) -> list[Item]:
    """Read "make all roofs flat" as of the roofs of all buildings."""
    for at, item in enumerate(items):
        if item.text not in ("flat", "level"):
            continue
        told = items[begin_of(items, at, ENDS + ",") : at]
        makes = [one for one in told if one.get("verb") == "MAKE" or one.text == "should be"]
        roofs = [one for one in told if one.noun == "roof"]
        plain = all(one in makes or one in roofs or one.kind == "function" or
                    one.get("rel") in ("all", "every", "be") for one in told)  # fmt: skip
        several = any(one.words[-1] == "roofs" for one in roofs) or any(
            one.get("rel") in ("all", "every") for one in told)  # fmt: skip
        if roofs and plain and several:
            lead = Item("phrase", told[0].span, ("make",), (("verb", "MAKE"),))
            houses = Item("phrase", roofs[0].span, ("all", "buildings"),
                          (("noun", "building:building"),))  # fmt: skip
            roof = replace(item, kind="phrase", senses=(("slot", "building.roof=flat"),))
            begin = items.index(told[0])
            return [*items[:begin], lead, houses, roof, *items[at + 1 :]]
    return items


def other_roofs(items: list[Item]) -> list[Item]:
    """Read "replace pitched roofs by flat ones carrying solar panels" as two changes.

    "Give buildings with pitched roofs flat roofs, and put solar panels on them": what lies on the
    new roofs is a change of its own, of the same buildings.
    """
    for at, item in enumerate(items):
        verb = items[at - 1 - (items[at - 1].kind == "function")] if at else item
        roof = item.get("slot").startswith(ROOFS) and item.text.endswith(("roof", "roofs"))
        if not roof or verb.get("verb") != "REPLACE":
            continue
        link = next((k for k in range(at + 1, min(at + 16, len(items)))
                     if items[k].get("rel") in ("by", "with")), 0)  # fmt: skip
        made = next((k for k in range(link + 1, len(items)) if items[k].kind != "function"), 0)
        if not link or not made:
            continue
        new = items[made]
        whole = new.words[-1] in ("roof", "roofs")  # or the word for roofs stands behind it
        ones = items[made + 1 : made + 1 + (not whole)]
        shape = "flat" if new.text == "flat" else _roof_in(new)
        if not shape or any(one.text not in ("one", "ones", "roof", "roofs") for one in ones):
            continue
        first, place = items.index(verb), items[at + 1 : link]
        own = bool(place) and place[0].get("rel") == "of"
        noun = Item("phrase", item.span, ("buildings",), (("noun", "building:building"),))
        target = place[1:] if own else [noun, *place]
        named = next((k for k, one in enumerate(target) if one.noun), len(target))
        told = replace(item, senses=tuple(one for one in item.senses if one[0] == "slot"))
        roofs = replace(new, kind="phrase", senses=(("slot", f"{ROOFS}{shape}"),),
                        words=(shape, "roofs"))  # fmt: skip
        give = replace(verb, words=("give",), senses=(("verb", "MAKE"),))
        for one in ones:
            one.state, one.senses = READ, ()
        rest = _carried(items[made + 1 + len(ones) :])
        target = [*target[:named], told, *target[named:]]
        return [*items[:first], give, *target, roofs, *ones, *rest]
    return items


def _roof_in(item: Item) -> str:
    slot = item.get("slot")
    return slot.partition("=")[2].split(" ")[0] if slot.startswith(ROOFS) else ""


def _carried(rest: list[Item]) -> list[Item]:
    """Return "carrying solar panels" as a command: put solar panels on them."""
    part = any(one.get("slot").startswith("building.feature=") for one in rest[:4])
    if not rest or rest[0].text not in _CARRY or not part:
        return rest
    at = rest[0].span
    end = next((k for k, one in enumerate(rest) if one.kind == "mark"), len(rest))
    lead = [Item("mark", at, (",",)), Item("phrase", at, ("put",), (("verb", "ADD"),))]
    on = [Item("phrase", at, ("on",), (("rel", "on"),)),
          Item("phrase", at, ("them",), (("rel", "it"),))]  # fmt: skip
    return [*lead, *rest[1:end], *on, *rest[end:]]
