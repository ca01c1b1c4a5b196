"""Short forms: "a third yellow, a third blue", "lamps along the quay", "20 mph limit please".

What people leave out of an order because it goes without saying is put in.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

from cityx.checks.predicates.vocabulary import KINDS
from cityx.language.commands.roles import TERM
from cityx.language.commands.short_looks import MENDS as LOOKING
from cityx.language.commands.words_put_in import (
    ARTICLES,
    LOOKS,
    ROOFS,
    asked,
    by_sentence,
    content,
    here,
    is_share,
)
from cityx.language.scan import Item, Quantity
from cityx.language.scopes import KEPT, NEGATED, READ


def in_full(items: list[Item]) -> list[Item]:
    """Return the items of a request with what its sentences leave out."""
    return by_sentence(items, _whole)


def _whole(sentence: list[Item]) -> list[Item]:
    for mend in _MENDS:
        sentence = mend(sentence)
    return sentence


_LOSES = ("lose", "ditch", "scrap", "axe", "bin", "lose all", "drop")
_LED = ("the", "all", "every", "any", "those", "these", "both")


def _loses(sentence: list[Item]) -> list[Item]:
    """Read "lose the cars" as "remove the cars"; but "every house loses a floor"."""
    said = content(sentence)
    if said and said[0].text in _LOSES and not said[0].state:
        after = sentence[sentence.index(said[0]) + 1 :][:1]
        if after and (after[0].words[0] in _LED or after[0].get("rel") in ("all", "every")):
            said[0].kind, said[0].senses = "phrase", (("verb", "REMOVE"),)
    return sentence


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
            if _is_less(said[count:], without=words[-1] == "without"):
                asked(one for one in said[count:] if one.kind != "function")
                return sentence
            tail = len(said)
            while tail > count and said[tail - 1].text in _LONGER:
                tail -= 1
            for gone in (*said[:count], *said[tail:]):
                gone.state, gone.senses = READ, ()
            for kept in said[count:tail]:
                kept.state = "" if kept.state == NEGATED else kept.state
            return [here(sentence[0], "remove", ("verb", "REMOVE")), *sentence]
    return sentence


def _is_less(said: list[Item], *, without: bool) -> bool:
    """Return whether "I don't want ..." is of a state, or of some: "the church | so tall"."""
    if not without and any(word in ("all", "every") for word in said[0].words):
        return True  # "we don't need all of the lamps"
    noun = next((at for at, one in enumerate(said) if one.noun or one.kind == "id"), len(said))
    behind = said[noun + 1 : noun + 2]
    placed = any(one.get("rel") or one.text in (*_LONGER, "that", "which", "there", "here")
                 for one in behind)  # fmt: skip
    return bool(behind) and not placed


_WISHES = (
    "i'd like", "i would like", "i want", "we'd like", "we would like", "we want", "we need",
    "i need", "there should be", "there could be", "we could have", "we're missing", "i like",
    "we like", "we are missing", "we missing", "give us", "could we get", "can we get", "could use",
)  # fmt: skip


def _fronted_wish(sentence: list[Item]) -> list[Item]:
    """Read "along the quay I'd like four statues" as "along the quay add four statues"."""
    said = content(sentence)
    fronted = bool(said) and said[0].get("rel") in ("along", "in", "on", "near", "around", "by")
    comma = next((at for at, one in enumerate(sentence) if one.is_mark(",")), 0)
    if fronted and comma and not any(one.has("verb") for one in said):
        after = sentence[comma + 1 : comma + 3]
        new = len(after) > 1 and (after[0].words[0] in ARTICLES or after[0].quantity is not None)
        if new and after[1].noun_class in ("element", "plant") and sentence[0] is said[0]:
            verb = here(after[0], "add", ("verb", "ADD"))
            return [*sentence[:comma], verb, *sentence[comma + 1 :]]
    for at, _ in enumerate(sentence):
        for count in (1, 2, 3):
            words = " ".join(one.text for one in sentence[at : at + count])
            after = sentence[at + count : at + count + 1]
            new = bool(after) and (
                after[0].quantity is not None or after[0].words[0] in ARTICLES
                or after[0].get("slot").startswith(ROOFS)
            )  # fmt: skip
            first = not content(sentence[:at])
            if words in _WISHES and new and (fronted or first) and not after[0].state:
                verb = here(sentence[at], "add", ("verb", "ADD"))
                for one in sentence[at : at + count]:
                    one.state, one.senses = READ, ()
                front = [one for one in sentence[:at] if not one.is_mark(",")]
                return [*front, verb, *sentence[at + count :]]
    return sentence


_STANDS = ("stands", "is", "was", "stood", "are", "stand")


def _ones_of_them(sentence: list[Item]) -> list[Item]:
    """Read "the benches, the red ones" as "the red benches": it says which, and adds none."""
    end = next((at + 1 for at, one in enumerate(sentence) if one.text == "ones"
                and (at + 1 == len(sentence) or sentence[at + 1].kind == "mark")), 0)  # fmt: skip
    if end < 5:
        return sentence
    comma = next((at for at in range(end - 1, 0, -1) if sentence[at].is_mark(",")), 0)
    told = sentence[comma + 1 : end - 1]
    if not comma or not told or told[0].words[0] not in ("the", "those"):
        return sentence
    looks = [one for one in told[1:] if one.kind != "function"]
    noun = next((at for at in range(comma - 1, 0, -1) if sentence[at].noun), 0)
    if not noun or not looks or any(one.has("rel", "verb") for one in looks):
        return sentence
    behind = [one for one in sentence[end : end + 1] if one.is_mark(",")]
    for one in (sentence[comma], told[0], sentence[end - 1], *behind):
        one.state, one.senses = READ, ()
    return [*sentence[:noun], *looks, sentence[noun], *sentence[noun + 1 : comma],
            *([] if behind else (sentence[comma],)), told[0],
            *sentence[end - 1 : end], *sentence[end + len(behind) :]]  # fmt: skip


def _fills_a_plot(item: Item) -> bool:
    """Return whether a noun is of a building, or of land that lies where one could."""
    return item.noun_class in ("type", "building") or KINDS.get(item.noun) == "land"


def _where_it_stands(sentence: list[Item]) -> list[Item]:
    """Read "put a villa where the church stands" as "replace the church with a villa".

    Things that fill no plot are put in a place that is land, which stays.
    """
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
    new = next((one for one in sentence[verb + 1 : where] if one.noun), None)
    place = next(one for one in sentence[where + 1 : stands] if one.noun)
    if new is None or not _fills_a_plot(new):
        if new is None or not _fills_a_plot(place) or place.noun_class != "element":
            asked([sentence[where], *sentence[stands : stands + 1]])
            return sentence
        for one in sentence[stands:]:
            if one.kind != "mark":
                one.state, one.senses = READ, ()
        sentence[where].state = READ
        return [*sentence[:where], here(sentence[where], "in", ("rel", "in")), *sentence[where:]]
    lead = sentence[verb]
    lead.senses, lead.words = (("verb", "REPLACE"),), ("replace",)
    for one in (sentence[where], *sentence[stands : len(sentence)]):
        if one.kind != "mark":
            one.state, one.senses = READ, ()
    link = here(sentence[where], "with", ("rel", "with"))
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
            if article.kind == "function" and article.words[0] not in ARTICLES:
                continue
            item.senses = (("verb", "ADD"),)
            for one in (room, link):
                one.state, one.senses = READ, ()
    return sentence


def _squares(sentence: list[Item]) -> list[Item]:
    """Read "the church square" as the square near the church."""
    for at in range(1, len(sentence)):
        square, named = sentence[at], sentence[at - 1]
        if square.text != "square" or named.noun_class != "type" or square.state or named.state:
            continue
        near = here(square, "near", ("rel", "near"))
        the = here(square, "the", kind="function")
        square.senses = tuple(one for one in square.senses if one[0] == "noun")
        return [*sentence[: at - 1], square, near, the, named, *sentence[at + 1 :]]
    return sentence


def _halves(sentence: list[Item]) -> list[Item]:
    """Read "in the northern half of the park" as at the northern end of it."""
    for at in range(1, len(sentence) - 1):
        half, side, after = sentence[at], sentence[at - 1], sentence[at + 1 : at + 4]
        if not side.has("side") or half.words[0] != "half" or not is_share(half):
            continue
        of = half.words[-1] == "of"
        noun = next((one for one in after if one.noun), None)
        if noun is None or noun.noun_class != "element" or not (of or after[0].get("rel") == "of"):
            continue
        half.kind, half.quantity, half.senses, half.words = (
            "phrase", None, ((TERM, "END"),), ("end",))  # fmt: skip
        return [*sentence[: at + 1], *([here(after[0], "of", ("rel", "of"))] if of else ()),
                *sentence[at + 1 :]]  # fmt: skip
    return sentence


def _adds(sentence: list[Item]) -> list[Item]:
    """Read "lamps along the quay" as "add lamps along the quay"."""
    said = content(sentence)
    if len(said) < 3 or any(one.has("verb") or one.state for one in said[:3]):
        return sentence
    first = said[0]
    new = first.noun_class in ("element", "plant") and not first.has("slot")
    led = sentence[0].words[0] in ("a", "an") and sentence[1] is first
    if led and first.noun_class == "type":  # "a villa of two floors near the church"
        link = [one for one in said[1:] if one.get("rel") in ("near", "along", "in", "on")]
        told = any(one.get("rel") == "be" for one in said)
        if link and not told and not sentence[-1].is_mark(":"):
            return [here(sentence[0], "build", ("verb", "ADD")), *sentence]
    at = 3 if said[1].get("rel") in ("all", "every") and said[2].quantity is not None else 1
    placed = any(one.get("rel") in ("along", "around", "near", "in", "on")
                 for one in said[at : at + 1])  # fmt: skip
    begins = sentence[0] is first
    told = any(one.has(*LOOKS) or one.get("rel") == "be" for one in said[1:])
    part = first.get("slot").startswith("building.feature=")
    if part and placed and begins and not sentence[-1].is_mark(":"):
        return [
            here(sentence[0], "put", ("verb", "ADD")),
            *sentence,
        ]  # "solar panels on every roof"
    if not (new and placed and begins) or told or sentence[-1].is_mark(":"):
        return sentence
    return [here(sentence[0], "add", ("verb", "ADD")), *sentence]


_LIMITS = ("limit", "speed limit", "limits", "zone")


def _limit(sentence: list[Item]) -> list[Item]:
    """Read "20 mph limit please" as one on all streets."""
    for at, item in enumerate(sentence):
        speed = item.quantity is not None and item.quantity.dimension == "speed"
        after = sentence[at + 1] if at + 1 < len(sentence) else item
        if speed and after.text in _LIMITS and not any(content(sentence[:at])):
            rest = content(sentence[at + 2 :])
            if all(one.text in ("everywhere", "throughout", "overall") for one in rest):
                for one in sentence[at + 1 :]:
                    one.state, one.senses = READ, ()
                road = here(after, "streets", ("noun", "road:road"))
                on = here(after, "on", ("rel", "on"))
                every = here(after, "all", ("rel", "all"))
                return [item, on, every, road, *sentence[at + 1 :]]
    return sentence


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
    end = next((k for k in range(at + 1, len(sentence))
                if sentence[k].words[-1] in ("can", "could", "possible")),
               len(sentence))  # fmt: skip
    for one in sentence[at + 1 : end + 1]:
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
    return [here(sentence[0], "remove", ("verb", "REMOVE")), *sentence]


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
    place = [here(link, "in", ("rel", "in")), here(link, "the", kind="function"),
             here(link, "park", ("noun", "element:park"))]  # fmt: skip
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
    _loses, _unwanted, _fronted_wish, *LOOKING, _ones_of_them, _where_it_stands, _room, _squares,
    _halves, _adds, _limit, _at_random, _as_many, _should_go, _lawns, _one_lane,
)  # fmt: skip
