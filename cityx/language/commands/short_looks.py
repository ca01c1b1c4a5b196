"""Short looks: short forms of what buildings get: "a third yellow, a third blue", "slate roofs"."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.commands.words_put_in import (
    ARTICLES,
    LOOKS,
    ROOFS,
    asked,
    content,
    here,
    is_share,
)
from cityx.language.lexicon.idioms import FLOOR
from cityx.language.lexicon.phrases import part_named
from cityx.language.scan import Item, Quantity
from cityx.language.scopes import KEPT, READ

_FEW = {"third": 3, "quarter": 4, "fifth": 5, "sixth": 6, "tenth": 10}


def _shares(sentence: list[Item]) -> list[Item]:
    """Read "a third of the houses yellow and a third blue" with the houses of both."""
    first = next((at for at, one in enumerate(sentence) if is_share(one)), None)
    if first is None:
        return sentence
    noun = next((one for one in sentence[first + 1 : first + 4] if one.noun), None)
    if noun is None:
        return sentence
    found = list(sentence[: first + 1])
    for at, item in enumerate(sentence[first + 1 :], start=first + 1):
        after = sentence[at + 1] if at + 1 < len(sentence) else item
        before = sentence[at - 1]
        led = before.words[0] in ARTICLES
        joined = item.text == "half" and (
            before.is_mark(",") or before.get("rel") in ("and", "but")
        )
        look = _is_look(after) or after.text in ("tile", "tiles")
        if item.text in (*_FEW, "half") and (led or joined) and look:
            part = 1 / _FEW.get(item.text, 2)
            if led:
                found[-1].state = READ
            verb = next((one for one in sentence if one.has("verb")), here(item, "make"))
            again = replace(verb, senses=(("verb", verb.get("verb") or "MAKE"),),
                            span=(item.span[0],) * 2)  # fmt: skip
            found.insert(len(found) - led, again)
            found += [
                replace(item, kind="quantity", senses=(), quantity=Quantity("part", part, part)),
                here(item, "of", ("rel", "of")), replace(noun, span=(item.span[1],) * 2),
            ]  # fmt: skip
            continue
        found.append(item)
    return found


def _for_them(sentence: list[Item]) -> list[Item]:
    """Read "gabled roofs for the houses" as "give the houses gabled roofs"."""
    said = content(sentence)
    if len(said) < 2 or any(one.has("verb") or one.state for one in said[:3]):
        return sentence
    link = next((at for at, one in enumerate(sentence) if one.text == "for"), 0)
    told = [one for one in sentence[:link] if one.kind != "function"]
    if not told or any(one.kind == "mark" for one in told) or link + 1 >= len(sentence):
        return sentence
    roofs = all(one.get("slot").startswith(ROOFS) for one in told)
    walls = len(told) == 2 and told[0].has(*LOOKS) and told[1].words[-1] == "walls"
    end = next((at for at in range(link, len(sentence)) if sentence[at].kind == "mark"),
               len(sentence))  # fmt: skip
    named = sentence[link + 1 : end]
    if not (roofs or walls) or not any(one.noun or one.kind == "id" for one in named):
        return sentence
    sentence[link].state = READ
    if walls:
        told[1].state, told[1].senses = READ, ()
    verb = here(sentence[0], "give", ("verb", "MAKE"))
    return [verb, sentence[link], *named, *sentence[:link], *sentence[end:]]


def _more_floors(sentence: list[Item]) -> list[Item]:
    """Read "two storeys more", "by a storey" and "could do with a floor more" as so many floors."""
    for at, item in enumerate(sentence):
        before = sentence[at - 1] if at else None
        after = sentence[at + 1] if at + 1 < len(sentence) else None
        led = at > 1 and before is not None and before.text in ("a", "one", "another")
        by = led and sentence[at - 2].get("rel") == "by"
        led = bool(at) and before is not None and before.text in ("a", "one", "another")
        to = after is not None and (after.get("rel") in ("to", "on", "from", "more")
                                    or after.text in ("to", "off", "onto", "from"))  # fmt: skip
        if (by or (led and to)) and item.text in FLOOR and before is not None:
            item.kind, item.senses = "quantity", ()
            item.quantity, before.state = Quantity("floors", 1.0, 1.0), READ
        floors = item.quantity is not None and item.quantity.dimension == "floors"
        if floors and after is not None and after.get("rel") == "more":
            after.state, after.senses = READ, ()
            for one in sentence[:at]:
                if one.text == "could do with":
                    one.words, one.senses, one.kind = ("gain",), (), "unknown"
    return sentence


_GROW = ("grow", "grow by", "gain", "lose", "shrink by", "rise by")
_LETS = ("let", "have", "make")


def _let_grow(sentence: list[Item]) -> list[Item]:
    """Read "let the towers grow by a floor" as "the towers grow by a floor"."""
    for at, item in enumerate(sentence):
        grows = next((one for one in sentence[at + 1 :] if one.text in _GROW), None)
        if item.text in _LETS and item.has("verb") and grows is not None and not item.state:
            item.state, item.senses = READ, ()
            return sentence
    return sentence


_PLACED = ("in", "on", "near", "along", "around")


def _gets_a_look(sentence: Sequence[Item]) -> bool:
    """Return whether a sentence gives roofs or storeys, which buildings alone have."""
    gone = any(one.get("verb") in ("REMOVE", "MOVE", "REPLACE") for one in sentence)
    looks = any(one.get("slot").startswith(ROOFS) or one.noun == "roof" for one in sentence)
    floors = any(one.quantity is not None and one.quantity.dimension == "floors"
                 for one in sentence)  # fmt: skip
    return not gone and (looks or floors)


def _everything_there(sentence: list[Item]) -> list[Item]:
    """Read "everything in the western half" that gets a roof or a storey as the buildings there."""
    for at, item in enumerate(sentence[:-1]):
        painted = any(one.get("verb") == "PAINT" for one in sentence)
        painted = painted and not _gets_a_look(sentence)
        whole = item.words == ("everything", "in")
        if whole and painted:
            asked((item,))  # of what is there some has no colour
        elif whole and _gets_a_look(sentence):
            inside = here(sentence[at + 1], "in", ("rel", "in"))
            noun = here(sentence[at + 1], "buildings", ("noun", "building:building"))
            return [*sentence[: at + 1], noun, inside, *sentence[at + 1 :]]
        placed = sentence[at + 1].get("rel") in _PLACED or sentence[at + 1].words[0] == "within"
        if item.noun != "everything" or not placed or item.state:
            continue
        if painted:
            asked((item,))
        elif _gets_a_look(sentence):
            item.senses, item.words = (("noun", "building:building"),), ("buildings",)
    return sentence


_COATS = ("coat", "lick", "splash", "layer", "touch")


def _coats(sentence: list[Item]) -> list[Item]:
    """Read "give the houses a fresh coat of white paint" as "make the houses white"."""
    for at, item in enumerate(sentence):
        after = sentence[at + 1 : at + 5]
        color = next((k for k, one in enumerate(after) if one.has("color")), None)
        if item.words[0] not in _COATS or color is None or item.state not in ("", KEPT):
            continue
        after[color].state = ""  # it is no look of what is left out before it
        begin = at
        while begin and sentence[begin - 1].text in ("a", "fresh", "new", "nice", "good"):
            begin -= 1
        if not (item.words[-1] == "of" or (after and after[0].get("rel") == "of")):
            continue
        paint = [one for one in after[color + 1 : color + 2] if one.text == "paint"]
        for one in (*sentence[begin : at + 1], *after[:color], *paint):
            one.state, one.senses = READ, ()
        verb = next((one for one in sentence[:at] if one.has("verb")), None)
        if verb is not None and verb.get("verb") in ("ADD", "PLANT"):
            verb.senses = (("verb", "MAKE"),)
    return sentence


_SHADES = ("dark", "deep", "light", "pale", "bright")


def _make(sentence: list[Item]) -> list[Item]:
    """Read "all the roofs slate, except the church" as "make all the roofs slate"."""
    said = content(sentence)
    if any(one.has("verb") for one in said[:3]) or len(said) < 2:
        return sentence
    whole = said[0].get("rel") in ("all", "every") or is_share(said[0])
    named = next((one for one in said[:2] if one.noun), None)
    if not whole or named is None or any(one.get("rel") == "be" for one in said):
        return sentence
    if named.noun_class not in ("building", "type") and named.noun != "roof":
        return sentence
    if not any(one.has(*LOOKS) or one.get("slot").startswith(ROOFS) for one in said[2:]):
        return sentence
    return [here(sentence[0], "make", ("verb", "MAKE")), *sentence]


def _roofs(sentence: list[Item]) -> list[Item]:
    """Read the roofs of each of the orders of a sentence as those of buildings."""
    begins = [
        at
        for at, one in enumerate(sentence)
        if one.get("verb") in _PAINTS and one.span[0] == one.span[1]
    ]  # put in for shares
    found: list[Item] = []
    for first, last in pairwise([0, *(at for at in begins if at), len(sentence)]):
        found += _roofs_of(sentence[first:last])
    return found


def _roofs_of(sentence: list[Item]) -> list[Item]:
    """Read "make half of the roofs red tile" as "give half of the buildings red tiled roofs"."""
    said = content(sentence)
    if not said or said[0].get("verb") not in _PAINTS:
        return sentence
    roofs = [k for k, one in enumerate(sentence) if one.words[-1:] == ("roofs",)]
    at = next((k for k in roofs if sentence[k].noun == "roof" and not sentence[k].has("slot")),
              None)  # fmt: skip
    if at is None or any(one.noun_class in ("building", "type") for one in sentence[:at]):
        return sentence
    behind = [one for one in sentence[at + 1 :] if one.kind != "function"]
    told = behind[:1] and (_is_look(behind[0]) or behind[0].text in (*_SHADES, "tile", "tiles"))
    led = any(one.get("rel") in ("all", "every") or is_share(one) for one in sentence[:at])
    if not told or not led:
        return sentence
    found = list(sentence[:at])
    building = (("noun", "building:building"),)
    found.append(replace(sentence[at], words=("buildings",), senses=building))
    instead = False
    for place, one in enumerate(sentence[at + 1 :], start=at + 1):
        after = sentence[place + 1] if place + 1 < len(sentence) else one
        begins = one.words[0] in ("instead", "rather") or one.has("neither")
        instead = (instead or begins) and one.kind != "mark"
        if instead:
            one.state = READ  # "slate | instead of tile"
        if one.text in _SHADES and not one.has("slot", *LOOKS):
            one.state = READ  # "dark | slate"
        found.append(one)
        if one.text in ("tile", "tiles") and not (instead or one.has("slot")):
            one.kind, one.senses = "phrase", (("slot", f"{ROOFS}tile"),)
        if one.get("slot").startswith(ROOFS) and not instead:
            one.words = (*one.words, "roofs")
        elif one.has("color") and after.text not in ("tile", "tiles") and not after.get(
            "slot"
        ).startswith(ROOFS):  # fmt: skip
            found.append(here(after, "roof", ("attr", "roof")))
    return found


def _is_look(item: Item) -> bool:
    return item.has(*LOOKS) or item.get("slot").startswith(ROOFS)


FACES = "faces"  # sense of a roof: the side to which it slopes
_EQUIPS = frozenset(("ADD", "MAKE"))
_SLOPING = ("facing", "sloping", "pointing", "looking")


def _facing(sentence: list[Item]) -> list[Item]:
    """Read "panels on every south-facing roof" as on roofs that slope to the south."""
    verbs = {one.get("verb") for one in sentence if one.has("verb")}
    parts = any(one.get("slot").startswith("building.feature=") for one in sentence)
    if not parts or not verbs <= _EQUIPS:
        return sentence
    for at, item in enumerate(sentence):
        after = sentence[at + 1 : at + 4]
        said = [one for one in after if one.kind != "mark"]
        if not item.has("side") or len(said) < 2 or said[0].text not in _SLOPING:
            continue
        if said[1].words[-1] in ("roof", "roofs") and not said[1].has("slot"):
            said[1].senses = (*said[1].senses, (FACES, item.get("side")))
            for one in (item, *after[: after.index(said[1])]):
                one.state, one.senses = READ, ()
    return sentence


def _a_red_one(sentence: list[Item]) -> list[Item]:
    """Read "red roofs and the church a grey one" as "and give the church a grey roof"."""
    roof = next((one for one in sentence if one.noun == "roof" or "roofs" in one.words), None)
    if roof is None:
        return sentence
    for at in range(4, len(sentence)):
        one, color, article = sentence[at], sentence[at - 1], sentence[at - 2]
        if one.text not in ("one", "ones") or not color.has("color") or article.text != "a":
            continue
        joined = next((k for k in range(at - 3, 0, -1) if sentence[k].get("rel") == "and"), 0)
        named = [each for each in sentence[joined + 1 : at - 2] if each.noun]
        if not joined or not named or any(each.has("verb") for each in sentence[joined:at]):
            continue
        one.kind, one.quantity = "phrase", None
        one.senses, one.words = (("noun", "building:roof"),), ("roof",)
        give = here(sentence[joined + 1], "give", ("verb", "MAKE"))
        return [*sentence[: joined + 1], give, *sentence[joined + 1 :]]
    return sentence


_PAINTS = ("PAINT", "MAKE")


def _all_parts(sentence: list[Item]) -> list[Item]:
    """Read "paint every front door red" as that of the doors of all buildings."""
    said = content(sentence)
    if len(said) < 3 or said[0].get("verb") not in _PAINTS:
        return sentence
    at = next((k for k, one in enumerate(sentence)
               if not one.noun and part_named(one.words[-1])), None)  # fmt: skip
    if at is None or at + 1 >= len(sentence):
        return sentence
    whole = any(one.get("rel") in ("all", "every") for one in sentence[:at])
    after = next((one for one in sentence[at + 1 :] if one.kind != "function"), None)
    owned = any(one.noun_class in ("building", "type") for one in sentence)
    if not whole or owned or after is None or not after.has("color"):
        return sentence
    spot = sentence[at]
    if not part_named(spot.text):
        spot.words = spot.words[-1:]  # "front door"
    for one in sentence[:at]:
        if one.get("rel") in ("all", "every") or one.text == "front":
            one.state, one.senses = READ, ()
    of, every = here(after, "of", ("rel", "of")), here(after, "all", ("rel", "all"))
    return [*sentence[: at + 1], of, every, here(after, "buildings", ("noun", "building:building")),
            *sentence[at + 1 :]]  # fmt: skip


def disjoint(shares: Sequence[float]) -> Iterator[float]:
    """Yield each of some shares of a whole as that of what those before it leave."""
    left = 1.0
    for share in shares:
        yield min(share / left, 1.0) if left > 0 else 1.0
        left -= share


MENDS: tuple[Callable[[list[Item]], list[Item]], ...] = (
    _let_grow, _more_floors, _everything_there, _for_them, _coats, _facing, _shares, _make, _roofs,
    _a_red_one, _all_parts,
)  # fmt: skip
