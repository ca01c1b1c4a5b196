"""Denied traits: "no house has a red roof" denies red roofs, and "no street without trees" none.

What no thing of a kind has denies no such thing. A look becomes a denial of its own, "red roofs of
houses"; of all else it is said that each is without it, or with it where both are denied.
"""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.here import BUILDINGS
from cityx.language.measurable import OF_A_KIND
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import NEGATED, READ

TRAIT = "denied_trait"  # sense of an item that stands for what no building of a kind has
_HAVING = ("has", "have", "having", "with", "gets", "get")
_WITHOUT = ("without", "with no", "lacking", "lacks", "lack", "has no", "have no")
_THEM = ("of them", "of these", "of those")
_OF_ROOFS, _OF_WALLS = "roof", "facade"
_CLAD = ("made", "made of", "built of", "made from", "painted", "clad", "clad in", "of", "in")
_STANDING = ("stand", "stands", "lie", "lies", "sit", "sits", "face", "faces", "overlook")
# What is said of things that are not there: "no cars are | allowed", "no house is | left".
_THERE = ("there", "present", "seen", "visible", "allowed", "permitted", "anywhere", "left",
          "wanted", "needed", "built", "to", "open", "closed", "lit", "on")  # fmt: skip
_THINGS = (*BUILDINGS, "road", "element", "vehicle", "person", "plant")
_FAR = 24  # items of a clause that are looked at, so that time stays short
Spans = list[tuple[int, int]]


def settle_denied_traits(items: Sequence[Item]) -> tuple[Spans, Spans]:
    """Let a "no" before a thing deny what is said of the thing, and not that it is there.

    Returns
    -------
    spoken, left
        Places of things that are only spoken of, and none are asked for; and of what is open.
    """
    spoken: Spans = []
    left: Spans = []
    for at, item in enumerate(items):
        if item.state or not item.has("neg") or item.text in ("nothing", "nobody"):
            continue
        end = _end(items, at)
        if trait := _denied_look(items, at, end):
            _settle_look(items[at:end], trait)
        elif (
            item.text not in _WITHOUT and (thing := _thing(items, at, end)) >= 0 and thing + 2 < end
        ):
            spoken += _said_of_each(items, at, thing)
        if (
            not item.state
            and (thing := _thing(items, at, end)) >= 0
            and _is_told(items, thing, end)
        ):
            for one in items[at:end]:
                one.state = READ
            left.append((item.span[0], items[end - 1].span[1]))
    return spoken, left


def _end(items: Sequence[Item], at: int) -> int:
    """Return where a clause ends: at a mark, or a word that joins another one."""
    last = min(at + 1 + _FAR, len(items))
    for n in range(at + 1, last):
        joins = items[n].get("rel") in ("and", "but") or items[n].text in ("while", "or", "nor")
        if items[n].is_mark(ENDS + ",:()") or joins:
            return n
    return last


def _thing(items: Sequence[Item], at: int, end: int) -> int:
    """Return the noun right behind a "no", -1 for none: "none of the | houses"."""
    for n in range(at + 1, min(at + 4, end)):
        if items[n].noun_class in _THINGS and not items[n].has("slot"):
            return n
        if items[n].kind != "function":
            break
    return -1


def _before(items: Sequence[Item], at: int) -> str:
    """Return the buildings that "none of them" stands for."""
    near = reversed(items[max(0, at - _FAR) : at])
    return next((one.noun for one in near if one.noun_class in BUILDINGS), "")


def _denied_look(items: Sequence[Item], at: int, end: int) -> str:
    """Return the one look that is denied of buildings, as the key and value of a slot."""
    own = [one for one in items[at + 1 : end] if one.kind != "function"]
    told = [one for one in own if one.get("rel") != "be" and one.text not in (*_HAVING, *_CLAD)]
    looks = [pair for one in told if (pair := _look(one))]
    nouns = [one.noun for one in told if one.noun and not _look(one)]
    if len(looks) != 1 or len(looks) + len(nouns) != len(told):
        return ""
    (name, value), named = looks[0], [one for one in nouns if one not in (_OF_ROOFS, _OF_WALLS)]
    if items[at].text.endswith(_THEM) or items[at].text == "none":
        named = named or [_before(items, at)]
    if _OF_ROOFS in nouns and name in ("color", "material"):
        name = "roof_color" if name == "color" else "roof"
    if len(named) > 1 or not (named or name.startswith("roof")):
        return ""
    kinds = [one.noun_class for one in told if one.noun in named]
    if any(kind not in BUILDINGS for kind in kinds) or "" in named:
        return ""
    if not named and items[at].text in _WITHOUT and at and items[at - 1].noun_class in BUILDINGS:
        named = [items[at - 1].noun]  # "houses | without red roofs"
    kind = named[0] if named else "building"
    return f"{OF_A_KIND[name] if kind == 'building' else f'{kind}.{name}'}={value}"


def _is_told(items: Sequence[Item], thing: int, end: int) -> bool:
    """Return whether a verb behind a thing says how or where it is, without a measure."""
    link, behind = items[thing + 1 : thing + 2], items[thing + 2 : end]
    tells = bool(link) and (link[0].get("rel") == "be" or link[0].text in _STANDING)
    measured = any(
        (one.quantity is not None and one.words[0] != "within") or one.has("compared")
        for one in behind
    )
    plain = not behind or behind[0].text in _THERE or any(one.has("keep", "mode") for one in behind)
    return tells and not measured and not plain


def _look(item: Item) -> tuple[str, str] | None:
    """Return what a word says of how buildings look."""
    key, _, value = item.get("slot").partition("=")
    if key == "building.roof":
        return "roof", value
    if item.has("noun") or item.has("slot"):
        return None
    name = next((one for one in ("color", "material") if item.has(one)), "")
    return (name, item.get(name)) if name else None


def _settle_look(items: Sequence[Item], trait: str) -> None:
    """Let the words of a denial stand for a look alone."""
    for one in items:
        look = bool(_look(one))
        one.kind, one.senses = ("phrase", ((TRAIT, trait),)) if look else ("function", ())
        one.state = NEGATED if look else READ


def _said_of_each(items: Sequence[Item], at: int, thing: int) -> Spans:
    """Say of each thing that it lacks what none has, or has what none is without."""
    be = items[thing + 1]
    link = items[thing + 2] if be.get("rel") == "be" else be
    if link is not be and link.text not in _WITHOUT:
        return []
    lacks = link.text in _WITHOUT or (link.has("neg") and link.text != "not")
    if not (lacks or link.text in _HAVING):
        return []
    for one in (items[at], *([be] if link is not be else [])):
        one.kind, one.senses, one.state = "function", (), READ
    link.kind, link.words = "phrase", ("with",) if lacks else ("without",)
    link.senses = (("rel", "with"),) if lacks else (("neg", "neg"),)
    return [items[thing].span]
