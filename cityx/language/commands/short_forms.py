"""Short forms: "a third yellow, a third blue", "lamps along the quay", "20 mph limit please".

What people leave out of an order because it goes without saying is put in.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.commands.roles import TERM
from cityx.language.lexicon.phrases import part_named
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import KEPT, NEGATED, READ

_LOOKS = ("color", "material")
_ROOFS = "building.roof="
_FEW = {"third": 3, "quarter": 4, "fifth": 5, "sixth": 6, "tenth": 10}
_ARTICLES = ("a", "an", "one", "another", "some")


def in_full(items: list[Item]) -> list[Item]:
    """Return the items of a request with what its sentences leave out."""
    found: list[Item] = []
    begin = 0
    for end, item in enumerate(items):
        if not (item.is_mark(ENDS + ":") or end + 1 == len(items)):
            continue
        sentence = items[begin : end + 1]
        for mend in _MENDS:
            sentence = mend(sentence)
        found += sentence
        begin = end + 1
    return found


def _at(item: Item, word: str, *senses: tuple[str, str], kind: str = "phrase") -> Item:
    """Return a word that goes without saying, at the place of an item."""
    at = item.span[0]
    return Item(kind, (at, at), (word,), senses)


def _content(sentence: Sequence[Item]) -> list[Item]:
    return [one for one in sentence if one.kind not in ("function", "mark")
            and one.get("rel") not in ("please", "and", "but")]  # fmt: skip


_LOSES = ("lose", "ditch", "scrap", "axe", "bin", "lose all", "drop")
_LED = ("the", "all", "every", "any", "those", "these", "both")


def _loses(sentence: list[Item]) -> list[Item]:
    """Read "lose the cars" as "remove the cars"; but "every house loses a floor"."""
    said = _content(sentence)
    if said and said[0].text in _LOSES and not said[0].state:
        after = sentence[sentence.index(said[0]) + 1 :][:1]
        if after and (after[0].words[0] in _LED or after[0].get("rel") in ("all", "every")):
            said[0].kind, said[0].senses = "phrase", (("verb", "REMOVE"),)
    return sentence


def _shares(sentence: list[Item]) -> list[Item]:
    """Read "a third of the houses yellow and a third blue" with the houses of both."""
    first = next((at for at, one in enumerate(sentence) if _is_share(one)), None)
    if first is None:
        return sentence
    noun = next((one for one in sentence[first + 1 : first + 4] if one.noun), None)
    if noun is None:
        return sentence
    found = list(sentence[: first + 1])
    for at, item in enumerate(sentence[first + 1 :], start=first + 1):
        after = sentence[at + 1] if at + 1 < len(sentence) else item
        led = sentence[at - 1].words[0] in _ARTICLES
        if item.text in (*_FEW, "half") and led and after.has(*_LOOKS):
            part = 1 / _FEW.get(item.text, 2)
            found[-1].state = READ
            verb = next((one for one in sentence if one.has("verb")), _at(item, "make"))
            again = replace(verb, senses=(("verb", verb.get("verb") or "MAKE"),),
                            span=(item.span[0],) * 2)  # fmt: skip
            found.insert(len(found) - 1, again)
            found += [
                replace(item, kind="quantity", senses=(), quantity=Quantity("part", part, part)),
                _at(item, "of", ("rel", "of")), replace(noun, span=(item.span[1],) * 2),
            ]  # fmt: skip
            continue
        found.append(item)
    return found


def _is_share(item: Item) -> bool:
    return item.quantity is not None and item.quantity.dimension in ("part", "share")


_UNWANTED = (
    ("i", "don't", "want"), ("we", "don't", "want"), ("i", "do", "not", "want"),
    ("we", "can", "do", "without"), ("i", "can", "do", "without"), ("we", "don't", "need"),
    ("i", "don't", "need"),
)  # fmt: skip
_LONGER = ("any", "more", "anymore", "longer", "any longer", "any more")


def _unwanted(sentence: list[Item]) -> list[Item]:
    """Read "I don't want the kiosks any more" and "the kiosks can go" as "remove the kiosks"."""
    said = [one for one in sentence if one.kind != "mark"]
    words: list[str] = []
    for count, one in enumerate(said[:5], start=1):
        words += one.words
        if tuple(words) in _UNWANTED and count < len(said):
            after = said[count]
            if after.words[0] not in _LED and after.get("rel") not in ("all", "every"):
                return sentence
            tail = len(said)
            while tail > count and said[tail - 1].text in _LONGER:
                tail -= 1
            for gone in (*said[:count], *said[tail:]):
                gone.state, gone.senses = READ, ()
            for kept in said[count:tail]:
                kept.state = "" if kept.state == NEGATED else kept.state
            return [_at(sentence[0], "remove", ("verb", "REMOVE")), *sentence]
    return sentence


_WISHES = (
    "i'd like", "i would like", "i want", "we'd like", "we would like", "we want", "we need",
    "i need", "there should be", "there could be", "we could have", "we're missing", "i like",
    "we like", "we are missing", "we missing", "give us", "could we get", "can we get", "could use",
)  # fmt: skip


def _fronted_wish(sentence: list[Item]) -> list[Item]:
    """Read "along the quay I'd like four statues" as "along the quay add four statues"."""
    said = _content(sentence)
    fronted = bool(said) and said[0].get("rel") in ("along", "in", "on", "near", "around", "by")
    comma = next((at for at, one in enumerate(sentence) if one.is_mark(",")), 0)
    if fronted and comma and not any(one.has("verb") for one in said):
        after = sentence[comma + 1 : comma + 3]
        new = len(after) > 1 and (after[0].words[0] in _ARTICLES or after[0].quantity is not None)
        if new and after[1].noun_class in ("element", "plant") and sentence[0] is said[0]:
            verb = _at(after[0], "add", ("verb", "ADD"))
            return [*sentence[:comma], verb, *sentence[comma + 1 :]]
    for at, _ in enumerate(sentence):
        for count in (1, 2, 3):
            words = " ".join(one.text for one in sentence[at : at + count])
            after = sentence[at + count : at + count + 1]
            new = bool(after) and (
                after[0].quantity is not None or after[0].words[0] in _ARTICLES
                or after[0].get("slot").startswith(_ROOFS)
            )  # fmt: skip
            first = not _content(sentence[:at])
            if words in _WISHES and new and (fronted or first) and not after[0].state:
                verb = _at(sentence[at], "add", ("verb", "ADD"))
                for one in sentence[at : at + count]:
                    one.state, one.senses = READ, ()
                front = [one for one in sentence[:at] if not one.is_mark(",")]
                return [*front, verb, *sentence[at + count :]]
    return sentence


def _for_them(sentence: list[Item]) -> list[Item]:
    """Read "gabled roofs for the houses" as "give the houses gabled roofs"."""
    said = _content(sentence)
    if len(said) < 2 or any(one.has("verb") or one.state for one in said[:3]):
        return sentence
    link = next((at for at, one in enumerate(sentence) if one.text == "for"), 0)
    told = [one for one in sentence[:link] if one.kind != "function"]
    if not told or any(one.kind == "mark" for one in told) or link + 1 >= len(sentence):
        return sentence
    roofs = all(one.get("slot").startswith(_ROOFS) for one in told)
    walls = len(told) == 2 and told[0].has(*_LOOKS) and told[1].words[-1] == "walls"
    end = next((at for at in range(link, len(sentence)) if sentence[at].kind == "mark"),
               len(sentence))  # fmt: skip
    named = sentence[link + 1 : end]
    if not (roofs or walls) or not any(one.noun or one.kind == "id" for one in named):
        return sentence
    sentence[link].state = READ
    if walls:
        told[1].state, told[1].senses = READ, ()
    verb = _at(sentence[0], "give", ("verb", "MAKE"))
    return [verb, sentence[link], *named, *sentence[:link], *sentence[end:]]


_FLOOR = ("floor", "story", "storey", "level")


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
        if (by or (led and to)) and item.text in _FLOOR and before is not None:
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
    """Return whether a sentence gives roofs, colours or storeys, which buildings alone have."""
    gone = any(one.get("verb") in ("REMOVE", "MOVE", "REPLACE") for one in sentence)
    looks = any(one.get("slot").startswith(_ROOFS) or one.noun == "roof" or one.has("color")
                for one in sentence)  # fmt: skip
    floors = any(one.quantity is not None and one.quantity.dimension == "floors"
                 for one in sentence)  # fmt: skip
    return not gone and (looks or floors)


def _everything_there(sentence: list[Item]) -> list[Item]:
    """Read "everything in the western half" that gets a roof or a colour as the buildings there."""
    for at, item in enumerate(sentence[:-1]):
        whole = item.words == ("everything", "in") and _gets_a_look(sentence)
        if whole:
            inside = _at(sentence[at + 1], "in", ("rel", "in"))
            noun = _at(sentence[at + 1], "buildings", ("noun", "building:building"))
            return [*sentence[: at + 1], noun, inside, *sentence[at + 1 :]]
        placed = sentence[at + 1].get("rel") in _PLACED or sentence[at + 1].words[0] == "within"
        if item.noun != "everything" or not placed or item.state:
            continue
        if _gets_a_look(sentence):
            item.senses, item.words = (("noun", "building:building"),), ("buildings",)
    return sentence


_STANDS = ("stands", "is", "was", "stood", "are", "stand")


def _ones_of_them(sentence: list[Item]) -> list[Item]:
    """Read "the benches, the red ones" as "the red benches": it says which, and adds none."""
    end = len(sentence) - bool(sentence[-1].kind == "mark")
    if end < 5 or sentence[end - 1].text != "ones":
        return sentence
    comma = next((at for at in range(end - 1, 0, -1) if sentence[at].is_mark(",")), 0)
    told = sentence[comma + 1 : end - 1]
    if not comma or not told or told[0].words[0] not in ("the", "those"):
        return sentence
    looks = [one for one in told[1:] if one.kind != "function"]
    noun = next((at for at in range(comma - 1, 0, -1) if sentence[at].noun), 0)
    if not noun or not looks or any(one.has("rel", "verb") for one in looks):
        return sentence
    for one in (sentence[comma], told[0], sentence[end - 1]):
        one.state, one.senses = READ, ()
    return [*sentence[:noun], *looks, sentence[noun], *sentence[noun + 1 : comma + 1],
            told[0], *sentence[end - 1 :]]  # fmt: skip


def _where_it_stands(sentence: list[Item]) -> list[Item]:
    """Read "put a villa where the church stands" as "replace the church with a villa"."""
    where = next((at for at, one in enumerate(sentence) if one.text == "where" and at), None)
    verb = next((at for at, one in enumerate(sentence) if one.get("verb") == "ADD"), None)
    if where is None or verb is None or where < verb:
        return sentence
    stands = next((at for at in range(where + 1, len(sentence)) if sentence[at].text in _STANDS),
                  None)  # fmt: skip
    if stands is None or not any(one.noun for one in sentence[where + 1 : stands]):
        return sentence
    if any(one.kind != "mark" and one.text != "now" for one in sentence[stands + 1 :]):
        return sentence
    lead = sentence[verb]
    lead.senses, lead.words = (("verb", "REPLACE"),), ("replace",)
    for one in (sentence[where], *sentence[stands : len(sentence)]):
        if one.kind != "mark":
            one.state, one.senses = READ, ()
    link = _at(sentence[where], "with", ("rel", "with"))
    marks = [one for one in sentence[stands:] if one.kind == "mark"]
    return [*sentence[: verb + 1], *sentence[where : stands + 1], link, *sentence[verb + 1 : where],
            *marks]  # fmt: skip


def _room(sentence: list[Item]) -> list[Item]:
    """Read "make room for a tennis court" as "add a tennis court"."""
    for at, item in enumerate(sentence[:-3]):
        room, link, article = sentence[at + 1 : at + 4]
        if item.get("verb") != "MAKE" or room.text not in ("room", "space", "way"):
            continue
        if link.text == "for" and article.kind in ("function", "quantity"):
            if article.kind == "function" and article.words[0] not in _ARTICLES:
                continue
            item.senses = (("verb", "ADD"),)
            for one in (room, link):
                one.state, one.senses = READ, ()
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
    said = _content(sentence)
    if any(one.has("verb") for one in said[:3]) or len(said) < 2:
        return sentence
    whole = said[0].get("rel") in ("all", "every") or _is_share(said[0])
    named = next((one for one in said[:2] if one.noun), None)
    if not whole or named is None or any(one.get("rel") == "be" for one in said):
        return sentence
    if named.noun_class not in ("building", "type") and named.noun != "roof":
        return sentence
    if not any(one.has(*_LOOKS) or one.get("slot").startswith(_ROOFS) for one in said[2:]):
        return sentence
    return [_at(sentence[0], "make", ("verb", "MAKE")), *sentence]


def _roofs(sentence: list[Item]) -> list[Item]:
    """Read "make half of the roofs red tile" as "give half of the buildings red tiled roofs"."""
    said = _content(sentence)
    if not said or said[0].get("verb") not in _PAINTS:
        return sentence
    roofs = [k for k, one in enumerate(sentence) if one.words[-1:] == ("roofs",)]
    at = next((k for k in roofs if sentence[k].noun == "roof" and not sentence[k].has("slot")),
              None)  # fmt: skip
    if at is None or any(one.noun_class in ("building", "type") for one in sentence[:at]):
        return sentence
    behind = [one for one in sentence[at + 1 :] if one.kind != "function"]
    told = behind[:1] and (_is_look(behind[0]) or behind[0].text in _SHADES)
    led = any(one.get("rel") in ("all", "every") or _is_share(one) for one in sentence[:at])
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
        if one.text in _SHADES and not one.has("slot", *_LOOKS):
            one.state = READ  # "dark | slate"
        found.append(one)
        if one.text in ("tile", "tiles") and not (instead or one.has("slot")):
            one.kind, one.senses = "phrase", (("slot", f"{_ROOFS}tile"),)
        if one.get("slot").startswith(_ROOFS) and not instead:
            one.words = (*one.words, "roofs")
        elif one.has("color") and after.text not in ("tile", "tiles") and not after.get(
            "slot"
        ).startswith(_ROOFS):  # fmt: skip
            found.append(_at(after, "roof", ("attr", "roof")))
    return found


def _is_look(item: Item) -> bool:
    return item.has(*_LOOKS) or item.get("slot").startswith(_ROOFS)


FACES = "faces"  # sense of a roof: the side to which it slopes
_SLOPING = ("facing", "sloping", "pointing", "looking")


def _facing(sentence: list[Item]) -> list[Item]:
    """Read "on every south-facing roof" as on roofs that slope to the south."""
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


def _squares(sentence: list[Item]) -> list[Item]:
    """Read "the church square" as the square near the church."""
    for at in range(1, len(sentence)):
        square, named = sentence[at], sentence[at - 1]
        if square.text != "square" or named.noun_class != "type" or square.state or named.state:
            continue
        near = _at(square, "near", ("rel", "near"))
        the = _at(square, "the", kind="function")
        square.senses = tuple(one for one in square.senses if one[0] == "noun")
        return [*sentence[: at - 1], square, near, the, named, *sentence[at + 1 :]]
    return sentence


def _halves(sentence: list[Item]) -> list[Item]:
    """Read "in the northern half of the park" as at the northern end of it."""
    for at in range(1, len(sentence) - 1):
        half, side, after = sentence[at], sentence[at - 1], sentence[at + 1 : at + 4]
        if not side.has("side") or half.words[0] != "half" or not _is_share(half):
            continue
        of = half.words[-1] == "of"
        noun = next((one for one in after if one.noun), None)
        if noun is None or noun.noun_class != "element" or not (of or after[0].get("rel") == "of"):
            continue
        half.kind, half.quantity, half.senses, half.words = (
            "phrase", None, ((TERM, "END"),), ("end",))  # fmt: skip
        return [*sentence[: at + 1], *([_at(after[0], "of", ("rel", "of"))] if of else ()),
                *sentence[at + 1 :]]  # fmt: skip
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
        give = _at(sentence[joined + 1], "give", ("verb", "MAKE"))
        return [*sentence[: joined + 1], give, *sentence[joined + 1 :]]
    return sentence


def _adds(sentence: list[Item]) -> list[Item]:
    """Read "lamps along the quay" as "add lamps along the quay"."""
    said = _content(sentence)
    if len(said) < 3 or any(one.has("verb") or one.state for one in said[:3]):
        return sentence
    first = said[0]
    new = first.noun_class in ("element", "plant") and not first.has("slot")
    led = sentence[0].words[0] in ("a", "an") and sentence[1] is first
    if led and first.noun_class == "type":  # "a villa of two floors near the church"
        link = [one for one in said[1:] if one.get("rel") in ("near", "along", "in", "on")]
        told = any(one.get("rel") == "be" for one in said)
        if link and not told and not sentence[-1].is_mark(":"):
            return [_at(sentence[0], "build", ("verb", "ADD")), *sentence]
    at = 3 if said[1].get("rel") in ("all", "every") and said[2].quantity is not None else 1
    placed = any(one.get("rel") in ("along", "around", "near", "in", "on")
                 for one in said[at : at + 1])  # fmt: skip
    begins = sentence[0] is first
    told = any(one.has(*_LOOKS) or one.get("rel") == "be" for one in said[1:])
    part = first.get("slot").startswith("building.feature=")
    if part and placed and begins and not sentence[-1].is_mark(":"):
        return [_at(sentence[0], "put", ("verb", "ADD")), *sentence]  # "solar panels on every roof"
    if not (new and placed and begins) or told or sentence[-1].is_mark(":"):
        return sentence
    return [_at(sentence[0], "add", ("verb", "ADD")), *sentence]


_LIMITS = ("limit", "speed limit", "limits", "zone")


def _limit(sentence: list[Item]) -> list[Item]:
    """Read "20 mph limit please" as one on all streets."""
    for at, item in enumerate(sentence):
        speed = item.quantity is not None and item.quantity.dimension == "speed"
        after = sentence[at + 1] if at + 1 < len(sentence) else item
        if speed and after.text in _LIMITS and not any(_content(sentence[:at])):
            rest = _content(sentence[at + 2 :])
            if all(one.text in ("everywhere", "throughout", "overall") for one in rest):
                for one in sentence[at + 1 :]:
                    one.state, one.senses = READ, ()
                road = _at(after, "streets", ("noun", "road:road"))
                on = _at(after, "on", ("rel", "on"))
                every = _at(after, "all", ("rel", "all"))
                return [item, on, every, road, *sentence[at + 1 :]]
    return sentence


_PAINTS = ("PAINT", "MAKE")


def _all_parts(sentence: list[Item]) -> list[Item]:
    """Read "paint every front door red" as that of the doors of all buildings."""
    said = _content(sentence)
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
    of, every = _at(after, "of", ("rel", "of")), _at(after, "all", ("rel", "all"))
    return [*sentence[: at + 1], of, every, _at(after, "buildings", ("noun", "building:building")),
            *sentence[at + 1 :]]  # fmt: skip


def _at_random(sentence: list[Item]) -> list[Item]:
    """Pass over "at random" behind a share or a number, which are taken so anyway."""
    counted = any(one.quantity is not None for one in sentence)
    for one, after in pairwise(sentence):
        if counted and one.text in ("at", "at random", "randomly") and (
            after.text == "random" or one.text != "at"
        ):  # fmt: skip
            one.state, one.senses = READ, ()
            if one.text == "at":
                after.state = READ
    return sentence


def _as_many(sentence: list[Item]) -> list[Item]:
    """Read "keep as many of the trees as you can" as keeping the trees."""
    at = next((k for k, one in enumerate(sentence) if one.has("keep")), None)
    if at is None:
        return sentence
    words = [word for one in sentence[at + 1 : at + 4] for word in one.words]
    if words[:2] not in (["as", "many"], ["as", "much"]):
        return sentence
    named = False
    for one in sentence[at + 1 :]:
        if one.noun and not named:
            named = True
            one.state, one.words = KEPT, one.words[-1:]
            one.senses = tuple(each for each in one.senses if each[0] == "noun") or one.senses
        elif one.kind != "mark":
            one.state, one.senses = READ, ()
    return sentence


_GONE = ("disappear", "disappears", "vanish", "go", "leave", "disappeared")
_OUGHT = ("can", "may", "should", "must", "shall", "has", "have", "need", "needs", "ought")


def _should_go(sentence: list[Item]) -> list[Item]:
    """Read "the parked cars should disappear" as "remove the parked cars"."""
    said = [one for one in sentence if one.kind != "mark"]
    while said and said[-1].get("rel") == "please":
        said = said[:-1]
    ought = next((at for at, one in enumerate(said) if one.words[0] in _OUGHT), 0)
    if not ought or any(one.has("verb") for one in said[:ought]):
        return sentence
    tail = [word for one in said[ought:] for word in one.words
            if word not in (*_OUGHT, "to", "be", "all")]  # fmt: skip
    if len(tail) != 1 or tail[0] not in _GONE or not any(one.noun for one in said[:ought]):
        return sentence
    for one in said[ought:]:
        one.state, one.senses = READ, ()
    return [_at(sentence[0], "remove", ("verb", "REMOVE")), *sentence]


def _lawns(sentence: list[Item]) -> list[Item]:
    """Read "swap the park's lawn for a pond" as "add a pond in the park"."""
    verb = next((at for at, one in enumerate(sentence) if one.get("verb") == "REPLACE"), None)
    grassy = [at for at, one in enumerate(sentence) if one.words[-1:] and not one.state
              and one.words[-1] in ("lawn", "grass", "lawns")]  # fmt: skip
    lawn = grassy[0] if grassy else None
    if verb is None or lawn is None or lawn < verb:
        return sentence
    owner = sentence[lawn - 1] if sentence[lawn - 1].noun == "park" else sentence[lawn]
    link = sentence[lawn + 1] if lawn + 1 < len(sentence) else None
    if "park" not in owner.text or link is None or link.get("rel") not in ("with", "by", "to"):
        return sentence
    end = next((k for k in range(lawn + 2, len(sentence)) if sentence[k].kind == "mark"
                or sentence[k].get("rel") in ("with", "and") or sentence[k].text == "+"
                or sentence[k].get("rel") in ("in", "on")), len(sentence))  # fmt: skip
    sentence[verb].senses, sentence[verb].words = (("verb", "ADD"),), ("add",)
    for one in sentence[verb + 1 : lawn + 2]:
        one.state, one.senses = READ, ()
    place = [_at(link, "in", ("rel", "in")), _at(link, "the", kind="function"),
             _at(link, "park", ("noun", "element:park"))]  # fmt: skip
    return [*sentence[:end], *place, *sentence[end:]]


def _one_lane(sentence: list[Item]) -> list[Item]:
    """Read "narrow it to a single 3.5 m lane" as "make it one lane, 3.5 m wide"."""
    for at in range(2, len(sentence) - 1):
        one, size, lane = sentence[at - 1], sentence[at], sentence[at + 1]
        length = size.quantity is not None and size.quantity.dimension == "length"
        verb = next((each for each in sentence if each.get("verb") == "NARROW"), None)
        if not (length and lane.text == "lane" and one.text in ("single", "one")) or not verb:
            continue
        link = next((each for each in sentence[:at] if each.get("rel") == "to"), None)
        assert size.quantity is not None
        verb.senses, verb.words = (("verb", "MAKE"),), ("make",)
        if link is not None:
            link.state, link.senses = READ, ()
        one.kind, one.quantity, one.state, one.senses = (
            "quantity", Quantity("lanes", 1.0, 1.0), "", ())  # fmt: skip
        size.quantity = replace(size.quantity, attribute="width")
        lane.state, lane.senses = READ, ()
        return sentence
    return sentence


_MENDS: tuple[Callable[[list[Item]], list[Item]], ...] = (
    _loses, _unwanted, _fronted_wish, _let_grow, _more_floors, _everything_there, _for_them,
    _ones_of_them, _where_it_stands, _room, _coats, _facing, _squares, _shares, _make, _roofs,
    _halves, _a_red_one, _adds, _limit, _all_parts, _at_random, _as_many, _should_go, _lawns,
    _one_lane,
)  # fmt: skip


def disjoint(shares: Sequence[float]) -> Iterator[float]:
    """Yield each of some shares of a whole as that of what those before it leave."""
    left = 1.0
    for share in shares:
        yield min(share / left, 1.0) if left > 0 else 1.0
        left -= share
