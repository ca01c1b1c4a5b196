"""Everyday orders: "clear the street of cars", "surround it with a hedge", "give it more benches".

Each is put as the order that the grammar of edits knows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.commands.edits import KMH
from cityx.language.commands.roles import TERM
from cityx.language.commands.words_put_in import (
    ARTICLES,
    LAND,
    LOOKS,
    asked,
    by_sentence,
    content,
    here,
    is_share,
)
from cityx.language.scan import Item, Quantity
from cityx.language.scopes import READ

COLOURFUL = "colourful"
_THINGS = ("element", "plant", "vehicle", "person")
_PLACES = ("road", "place")
_GREEN = ("park", "square", "garden", "plaza", "cemetery", "playground", "beach")
_STARTS = ("and", "but", "then")


def in_everyday_words(items: list[Item]) -> list[Item]:
    """Return the items of a request with its everyday orders as those that the grammar knows."""
    return by_sentence(items, _mended)


def _mended(sentence: list[Item]) -> list[Item]:
    for mend in _MENDS:
        sentence = mend(sentence)
    return sentence


def _begins(sentence: Sequence[Item], at: int) -> bool:
    """Return whether an order begins at an item: first, or behind a comma or an "and"."""
    before = [one for one in sentence[:at] if one.state != READ and one.get("rel") != "please"]
    return not before or before[-1].kind == "mark" or before[-1].get("rel") in _STARTS


def _end_of(sentence: Sequence[Item], at: int) -> int:
    """Return where the order that stands at an item ends."""
    for place in range(at + 1, len(sentence)):
        one = sentence[place]
        joined = one.get("rel") == "and" and place + 1 < len(sentence)
        if one.kind == "mark" or (joined and sentence[place + 1].has("verb")):
            return place
    return len(sentence)


def _is_street(item: Item) -> bool:
    """Return whether an item names a street: by its kind, or by a name of several words."""
    return item.noun_class == "road" or (item.kind == "id" and " " in item.text)


def _is_a_count(item: Item) -> bool:
    return item.quantity is not None and item.quantity.dimension == "count"


def _clears(sentence: list[Item]) -> list[Item]:
    """Read "clear half of them", "clear the cars from it", "clear the street of cars" as removals.

    "Clear the street" alone tells nothing of what goes, "clear the sky" is of the weather, and
    "clear the snow" is an end of it; "clear the way" is no weather, and is asked about.
    """
    for at, item in enumerate(sentence):
        if item.text not in ("clear", "empty", "free") or item.state or not _begins(sentence, at):
            continue
        end = _end_of(sentence, at)
        own = [one for one in content(sentence[at + 1 : end]) if one.get("rel") != "all"]
        ordered = any(one.kind == "function" for one in sentence[at + 1 : at + 2])  # "clear | the"
        if any(one.get("slot").partition("=")[0] in _AIR for one in own):
            if ordered:
                item.kind, item.senses = "phrase", (("verb", "REMOVE"),)
            continue
        airy = any(one.noun == "sky" or one.text in _SKY for one in sentence[at + 1 : end])
        if ordered and item.has("slot") and not airy:
            asked([item])
        if not own:
            continue
        of = next((k for k in range(at + 1, end) if sentence[k].get("rel") == "of"), 0)
        led = own[0].noun_class in _PLACES or own[0].kind == "id" or own[0].noun in _GREEN
        if led and of:
            if any(
                one.kind == "id" or one.noun_class not in _THINGS for one in own[1:] if one.noun
            ):
                continue
            item.kind, item.senses = "phrase", (("verb", "REMOVE"),)
            place = sentence[at + 1 : of]
            sentence[of].senses = (("rel", "in"),)
            return [*sentence[: at + 1], *sentence[of + 1 : end], sentence[of], *place,
                    *sentence[end:]]  # fmt: skip
        first = own[0]
        gone = first.noun_class in _THINGS and not led
        gone |= is_share(first)
        if gone and item.text == "clear":
            item.kind, item.senses = "phrase", (("verb", "REMOVE"),)
    return sentence


_SKY = ("weather", "air")
_AIR = ("weather", "cloud.share", "visibility")
_ROUND = ("surround", "encircle", "enclose", "encompass", "ring")


def _surrounds(sentence: list[Item]) -> list[Item]:
    """Read "surround the park with a fence" as "put a fence around the park"."""
    for at, item in enumerate(sentence):
        if item.text not in _ROUND or not _begins(sentence, at):
            continue
        end = _end_of(sentence, at)
        link = next((k for k in range(at + 1, end)
                     if sentence[k].get("rel") in ("with", "by")), 0)  # fmt: skip
        if not link or not sentence[link + 1 : end]:
            continue
        around = here(sentence[link], "around", ("rel", "around"))
        item.kind, item.senses, item.words, item.state = "phrase", (("verb", "ADD"),), ("put",), ""
        sentence[link].state, sentence[link].senses = READ, ()
        return [*sentence[: at + 1], *sentence[link + 1 : end], around, *sentence[at + 1 : link],
                *sentence[end:]]  # fmt: skip
    return sentence


def _gives(sentence: list[Item]) -> list[Item]:
    """Read "give the park more benches" as "put more benches in the park".

    What buildings are given are parts of them, which other rules read.
    """
    for at, item in enumerate(sentence):
        if item.text != "give" or not _begins(sentence, at):
            continue
        end = _end_of(sentence, at)
        whom = next((k for k in range(at + 1, end) if sentence[k].kind != "function"), end)
        new = next((k for k in range(whom + 1, end) if sentence[k].noun), end)
        if new >= end or sentence[new].noun_class not in ("element", "plant"):
            continue
        lead = sentence[whom + 1 : new + 1]
        counted = any(one.quantity is not None or one.has("amount") or one.words[0] in ARTICLES
                      for one in lead)  # fmt: skip
        street = _is_street(sentence[whom])
        if not (street or sentence[whom].noun in _GREEN) or not counted:
            continue
        item.senses, item.words = (("verb", "ADD"),), ("put",)
        joint = ("along", "along") if street else ("in", "in")
        where = here(sentence[end - 1], joint[0], ("rel", joint[1]))
        return [*sentence[: at + 1], *sentence[whom + 1 : end], where,
                *sentence[at + 1 : whom + 1], *sentence[end:]]  # fmt: skip
    return sentence


_ENDS = ("bollard", "cone", "jersey_barrier", "barrier", "planter", "boulder", "gate", "fence")


def _bars(sentence: list[Item]) -> list[Item]:
    """Read "close the street with bollards" as "close it and put bollards at both ends of it"."""
    for at, item in enumerate(sentence):
        if item.get("verb") != "CLOSE" or item.state or not _begins(sentence, at):
            continue
        end = _end_of(sentence, at)
        link = next((k for k in range(at + 1, end) if sentence[k].get("rel") == "with"), 0)
        new = [one for one in sentence[link + 1 : end] if one.kind != "function"]
        if not link or not new or new[-1].noun not in _ENDS or any(one.has("rel") for one in new):
            continue
        tail = sentence[end - 1]
        sentence[link].state, sentence[link].senses = READ, ()
        return [*sentence[:link], here(tail, "and", ("rel", "and")),
                here(tail, "put", ("verb", "ADD")), *sentence[link + 1 : end],
                here(tail, "in", ("rel", "in")), here(tail, "both", (TERM, "BOTH")),
                here(tail, "ends", (TERM, "END")), here(tail, "of", ("rel", "of")),
                here(tail, "it", ("rel", "it")), *sentence[end:]]  # fmt: skip
    return sentence


def _thins(sentence: list[Item]) -> list[Item]:
    """Read "thin out the trees by half" as "remove half of the trees"."""
    for at, item in enumerate(sentence):
        if item.text not in ("thin out", "thin", "thin down") or not _begins(sentence, at):
            continue
        end = _end_of(sentence, at)
        by = next((k for k in range(at + 1, end) if sentence[k].get("rel") == "by"), 0)
        amount = sentence[by + 1] if by and by + 1 < end else item
        half = amount.text in ("half", "a half")
        if not half and not is_share(amount):
            continue
        item.kind, item.senses = "phrase", (("verb", "REMOVE"),)
        part = replace(amount, kind="quantity", senses=(), quantity=amount.quantity or
                       Quantity("part", 0.5, 0.5))  # fmt: skip
        sentence[by].state = READ
        return [*sentence[: at + 1], part, here(amount, "of", ("rel", "of")),
                *sentence[at + 1 : by], *sentence[by + 2 :]]  # fmt: skip
    return sentence


_UNITS = {"meter": ("length", 1.0), "foot": ("length", 0.3048), "story": ("floors", 1.0),
          "floor": ("floors", 1.0), "level": ("floors", 1.0), "lane": ("lanes", 1.0)}  # fmt: skip


def _one_more(sentence: list[Item]) -> list[Item]:
    """Read "a storey taller" and "by a metre" as one of the unit."""
    for lead, item in pairwise(sentence):
        unit = _UNITS.get(item.text)
        at = sentence.index(item)
        by = at > 1 and sentence[at - 2].get("rel") == "by"
        after = sentence[at + 1] if at + 1 < len(sentence) else item
        than = after.get("compared")
        if unit is None or lead.words[-1] not in ("a", "an") or not (by or than):
            continue
        item.kind, item.senses, item.state = "quantity", (), ""
        item.quantity = Quantity(unit[0], unit[1], unit[1])
        if than and not by:
            more = 1 if than.endswith("over") else -1
            about = "" if unit[0] != "length" else than.split()[0]
            item.quantity = replace(item.quantity, relative=more, attribute=about)
            after.state, after.senses = READ, ()
    return sentence


def _rows_of(sentence: list[Item]) -> list[Item]:
    """Read "a row of eight houses along Hay Road" as eight houses along it."""
    for at, item in enumerate(sentence[:-2]):
        of, count = sentence[at + 1], sentence[at + 2]
        along = any(one.get("rel") == "along" for one in sentence[at + 3 :])
        listed = item.text in ("row", "line", "string") and of.get("rel") == "of"
        if listed and along and _is_a_count(count):
            for one in (item, of, *sentence[max(at - 1, 0) : at]):
                one.state = READ if one.kind != "phrase" or one in (item, of) else one.state
    return sentence


def _fewer(sentence: list[Item]) -> list[Item]:
    """Ask about "fewer lamps on Hay Road", which adds none and tells no number that goes."""
    for item, after in pairwise(sentence):
        if item.text in ("fewer", "less") and after.noun_class in ("element", "plant"):
            asked([item])
    return sentence


def _most(sentence: list[Item]) -> list[Item]:
    """Ask about "remove most of the benches", which are not all of them, and no number."""
    for at, item in enumerate(sentence):
        if item.words[0] != "most" or item.senses or item.state:
            continue
        behind = [one for one in sentence[at + 1 : at + 5] if one.kind != "function"]
        noun = next((one for one in behind if one.get("rel") != "of"), item)
        if noun.noun or noun.get("rel") == "it":
            asked([item])
    return sentence


def _whether(sentence: list[Item]) -> list[Item]:
    """Ask about "should we remove the trees?", which orders nothing."""
    said = [one for one in sentence if one.get("rel") != "and"][:2]
    doubts = len(said) == 2 and said[0].text in _DOUBTS and said[1].text in ("i", "we", "one")
    if doubts and sentence[-1].is_mark("?"):
        asked(said)
    return sentence


_DOUBTS = ("should", "shall", "must", "may")


def _stops_for(sentence: list[Item]) -> list[Item]:
    """Read "a stop for buses" as a bus stop, and no order to stop."""
    for at, (article, item) in enumerate(pairwise(sentence), start=1):
        behind = [one.noun for one in sentence[at + 1 : at + 3]]
        new = article.words[-1] in (*ARTICLES, "another") or article.quantity is not None
        if item.text not in ("stop", "stops") or not new or not _is_put(sentence[:at]):
            continue
        kind = next((_STOPS[noun] for noun in behind if noun in _STOPS), "")
        if not kind:
            continue
        item.kind, item.senses, item.state = "phrase", (("noun", f"element:{kind}"),), ""
        for one in sentence[at + 1 : at + 3]:
            one.kind, one.senses, one.state = "function", (), READ
    return sentence


_STOPS = {"bus": "bus_stop", "tram": "tram_stop"}
_CROWDS = {"crowd": 20, "group": 6, "bunch": 6, "queue": 6, "family": 4}


def _crowd_of_no_number(sentence: list[Item]) -> list[Item]:
    """Read "a crowd in the park" as so many people as a crowd is where nobody counts it."""
    for at, item in enumerate(sentence):
        led = at > 0 and sentence[at - 1].words[-1] in ("a", "the")
        behind = sentence[at + 1] if at + 1 < len(sentence) else item
        counted = behind.get("rel") == "of" or behind.noun or behind.quantity is not None
        if item.text not in _CROWDS or not led or counted or not _is_put(sentence[:at]):
            continue
        people = _CROWDS[item.text]
        item.kind, item.senses, item.state = "quantity", (), ""
        item.quantity = Quantity("count", float(people), float(people))
        who = Item("phrase", item.span, ("people",), (("noun", "person:pedestrian"),))
        return [*sentence[: at + 1], who, *sentence[at + 1 :]]
    return sentence


def _is_put(before: Sequence[Item]) -> bool:
    """Return whether an order to add something stands before."""
    return any(one.get("verb") in ("ADD", "FILL") and one.state != READ for one in before)


def _parks(sentence: list[Item]) -> list[Item]:
    """Read "park two vans on Hay Road" as vans that are put there and stand."""
    for at, item in enumerate(sentence[:-1]):
        after = sentence[at + 1]
        new = after.words[0] in ARTICLES or after.quantity is not None
        if item.text != "park" or not new or not _begins(sentence, at):
            continue
        vehicles = (k for k in range(at + 1, min(at + 5, len(sentence)))
                    if sentence[k].noun_class == "vehicle")  # fmt: skip
        item.kind, item.senses, item.words = "phrase", (("verb", "ADD"),), ("put",)
        if noun := next(vehicles, 0):
            stands = here(sentence[noun], "parked", ("mode", "park"))
            return [*sentence[: noun + 1], stands, *sentence[noun + 1 :]]
    return sentence


_WALLED = ("roof", "facade", "window")


def _roofs_along(sentence: list[Item]) -> list[Item]:
    """Read "the roofs on Hay Road" as those of the buildings on it."""
    for at, (item, link) in enumerate(pairwise(sentence), start=1):
        after = next((one for one in sentence[at + 1 : at + 4] if one.kind != "function"), item)
        street = _is_street(after) or after.noun in ("river", "park", "square", "lake", "canal")
        whole = item.noun in _WALLED and item.words[-1].endswith("s") and not item.has("slot")
        if link.get("rel") in ("on", "along", "in", "near") and street and whole:
            of = here(link, "of", ("rel", "of"))
            houses = here(link, "buildings", ("noun", "building:building"))
            return [*sentence[:at], of, houses, *sentence[at:]]
    return sentence


def _at_random(sentence: list[Item]) -> list[Item]:
    """Read "ten random houses" and "half of them, picked at random" without the chance.

    Which of several are meant is drawn by a hash of their ids in any case.
    """
    some = any(is_share(one) or _is_a_count(one) for one in sentence)
    for at, item in enumerate(sentence):
        if item.text not in ("random", "randomly") or not some:
            continue
        before = sentence[max(at - 2, 0) : at]
        picked = [one for one in before if one.text in _PICKED or one.get("rel") == "on"]
        counted = bool(before) and before[-1].quantity is not None
        if counted or any(one.text in _PICKED for one in picked):
            for one in (item, *picked):
                one.kind, one.senses, one.state = "function", (), READ
    return sentence


def _tables_outside(sentence: list[Item]) -> list[Item]:
    """Read "put tables outside the cafes" as tables of a cafe."""
    for item, after in pairwise(sentence):
        plain = item.kind == "unknown" and item.text in ("tables", "table", "seating")
        if plain and (after.text == "outside" or "front" in after.words):
            item.kind, item.senses = "phrase", (("noun", "element:cafe_set"),)
    return sentence


_DONE = ("CLOSE", "OPEN", "WIDEN", "NARROW", "RAISE", "LOWER")


def _done_to(sentence: list[Item]) -> list[Item]:
    """Read "the bridge is closed" as "close the bridge"."""
    for at, item in enumerate(sentence[1:-1], start=1):
        verb = sentence[at + 1]
        done = verb.get("verb") in _DONE and verb.words[0].endswith(("ed", "shut"))
        if item.get("rel") != "be" or not done or item.state or verb.state:
            continue
        begin = at
        while begin and not (sentence[begin - 1].kind == "mark"
                             or sentence[begin - 1].get("rel") in _STARTS):  # fmt: skip
            begin -= 1
        subject = sentence[begin:at]
        if subject and all(one.kind in ("function", "id") or one.noun for one in subject):
            item.state = READ
            return [*sentence[:begin], verb, *subject, *sentence[at + 2 :]]
    return sentence


_FRONTS = ("on", "along", "in", "near", "around", "by")


def _fronted_new(sentence: list[Item]) -> list[Item]:
    """Read "on the quay a bench every 25 m" with the verb that goes without saying."""
    said = content(sentence)
    if not said or said[0].get("rel") not in _FRONTS or any(one.has("verb") for one in said):
        return sentence
    named = next((k for k, one in enumerate(sentence) if one.noun or one.kind == "id"), 0)
    for at in range(named + 1, len(sentence) - 1):
        lead, after = sentence[at], sentence[at + 1]
        if lead.kind == "mark" or lead.has("rel"):
            break
        new = lead.words[0] in ARTICLES or _is_a_count(lead)
        several = lead.noun_class in ("element", "plant") and lead.words[-1].endswith("s")
        if named and ((new and after.noun_class in ("element", "plant")) or several):
            return [*sentence[:at], here(lead, "add", ("verb", "ADD")), *sentence[at:]]
    return sentence


def _none_alike(sentence: list[Item]) -> list[Item]:
    """Read "in pastel colours, no two neighbours alike", as which those are given in any case."""
    range_ = any(one.get("color") in ("pastel", COLOURFUL) for one in sentence)
    for at in range(len(sentence)):
        tail = sentence[at:]
        words = [word for one in tail if one.kind != "mark" for word in one.words]
        if range_ and words[:2] == ["no", "two"] and words[-1] in ("alike", "same"):
            for one in tail:
                one.state = READ
            return [*sentence[: at - (at > 0 and sentence[at - 1].is_mark(","))], *(
                one for one in tail[-1:] if one.kind == "mark")]  # fmt: skip
    return sentence


def _all_over(sentence: list[Item]) -> list[Item]:
    """Read "half of the cars across the town" as half of all there are."""
    for at, item in enumerate(sentence):
        after = [one for one in sentence[at + 1 : at + 3] if one.kind != "function"]
        whole = item.text in ("across", "throughout", "all over", "all across", "all around")
        if whole and after and after[0].noun == "city" and not item.state:
            for one in (item, after[0]):
                one.state, one.senses = READ, ()
    return sentence


_PICKED = ("picked", "chosen", "selected", "drawn", "taken")
_FOLIAGE = ("leaves", "foliage", "colors", "colours", "leaf", "trees")


def _seasonal(sentence: list[Item]) -> list[Item]:
    """Read "autumn colours on the trees" as autumn, in which all trees have them."""
    season = next((one for one in sentence if one.get("slot").startswith("season=")), None)
    if season is None or not set(season.words) & set(_FOLIAGE):
        return sentence
    rest = [one for one in sentence[sentence.index(season) + 1 :] if one.kind != "mark"]
    trees = [one for one in rest if one.noun_class == "plant"]
    if trees and rest and rest[0].get("rel") in ("on", "in", "of") and all(
        one in trees or one.kind == "function" or one.get("rel") in ("all", "please", "on", "in")
        for one in rest
    ):  # fmt: skip
        for one in rest:
            one.state = READ
    return sentence


_LAND = (*LAND, "strip")
_EMPTY = ("empty", "vacant", "unused", "free", "open", "waste", "bare", "spare", "derelict")


def _fills_gaps(sentence: list[Item]) -> list[Item]:
    """Read "turn the empty plot by the church into a square" as "put a square by the church"."""
    for at, item in enumerate(sentence):
        if item.get("verb") not in ("REPLACE", "MAKE", "FILL") or not _begins(sentence, at):
            continue
        end = _end_of(sentence, at)
        lead = [k for k in range(at + 1, min(at + 5, end)) if sentence[k].kind != "function"
                and sentence[k].text not in _EMPTY]  # fmt: skip
        land = lead[0] if lead and sentence[lead[0]].text in _LAND else 0
        joints = ("with",) if item.get("verb") == "FILL" else ("to", "with")
        link = next((k for k in range(land + 1, end) if sentence[k].get("rel") in joints
                     and sentence[k + 1 : k + 2]
                     and sentence[k + 1].words[0] in (*ARTICLES, "two", "three")), 0)  # fmt: skip
        place = sentence[land + 1 : link]
        if not land or not link or not place or not place[0].has("rel", "side"):
            continue
        item.kind, item.senses, item.words = "phrase", (("verb", "ADD"),), ("put",)
        for one in (*sentence[at + 1 : land + 1], sentence[link]):
            one.state, one.senses = READ, ()
        return [*sentence[: at + 1], *sentence[link + 1 : end], *place, *sentence[end:]]
    return sentence


_OWN = ("its", "their", "the")


def _roofs_too(sentence: list[Item]) -> list[Item]:
    """Read "paint the towers white and their roofs blue" as two orders."""
    verb = next((one for one in sentence if one.has("verb")), None)
    if verb is None or verb.get("verb") not in ("PAINT", "MAKE"):
        return sentence
    for at in range(2, len(sentence) - 2):
        joined = sentence[at].get("rel") == "and" or sentence[at].is_mark(",")
        own, part, look = (
            sentence[at + 1 : at + 4] if at + 3 < len(sentence) else [sentence[at]] * 3
        )
        roof = part.text in ("roof", "roofs") and own.words[-1] in _OWN and look.has(*LOOKS)
        if joined and roof and any(one.has(*LOOKS) for one in sentence[:at]):
            again = replace(verb, span=(own.span[0],) * 2)
            it = here(look, "them", ("rel", "it"))
            own.state = READ
            of = here(look, "of", ("rel", "of"))
            return [*sentence[: at + 1], again, here(own, "the", kind="function"), part, of, it,
                    *sentence[at + 3 :]]  # fmt: skip
    return sentence


def _drops(sentence: list[Item]) -> list[Item]:
    """Read "drop their height to 9 m" as "lower their height to 9 m"."""
    for at, item in enumerate(sentence):
        after = next((one for one in sentence[at + 1 : at + 4] if one.kind != "function"), item)
        sized = after.get("attr") in ("height", "width", "speed")
        if item.text in ("drop", "cut", "bring down") and sized and _begins(sentence, at):
            item.kind, item.senses = "phrase", (("verb", "LOWER"),)
    return sentence


def _speeds(sentence: list[Item]) -> list[Item]:
    """Read "the speed limit ... to 20" as 20 km/h, in which limits are told without a unit."""
    told = False
    for at, item in enumerate(sentence):
        amount = item.quantity
        plain = amount is not None and amount.dimension == "count" and amount.exact is not None
        after = sentence[at + 1] if at + 1 < len(sentence) else item
        alone = after is item or after.kind == "mark" or after.has("rel", "verb")
        led = at > 0 and (sentence[at - 1].get("rel") in ("to", "of", "at", "be")
                          or sentence[at - 1].get("attr") == "speed")  # fmt: skip
        own = amount is not None and amount.attribute == "speed"
        if plain and amount is not None and (own or (told and alone and led)):
            metres = (amount.exact or 0.0) / KMH
            item.quantity = Quantity("speed", metres, metres)
        told |= item.get("attr") == "speed"
    return sentence


def _single_lanes(sentence: list[Item]) -> list[Item]:
    """Read "a single lane" as "one lane", and "two lanes wide" as two lanes."""
    for at, item in enumerate(sentence):
        after = sentence[at + 1] if at + 1 < len(sentence) else item
        if item.text == "more" and after.get("color") == COLOURFUL:
            item.state, item.senses = READ, ()
        if item.text == "single" and after.text in ("lane", "track"):
            item.state = READ
            after.kind, after.senses = "quantity", ()
            after.quantity = Quantity("lanes", 1.0, 1.0)
        lanes = item.quantity is not None and item.quantity.dimension == "lanes"
        if lanes and after is not item and after.get("attr") == "width" and after.text == "wide":
            after.state, after.senses = READ, ()
    return sentence


_MUCH = ("heavy", "dense", "high")
_LIFE = {"traffic": ("cars", "vehicle:vehicle"), "pedestrians": ("people", "person:pedestrian")}


def _in_one_place(sentence: list[Item]) -> list[Item]:
    """Read "heavy traffic on Hay Road" as "fill Hay Road with cars".

    Other life that is told of one place is asked about, as it would be that of the whole city.
    """
    place = next((one for one in sentence if one.kind == "id" or one.noun in _GREEN or (
        one.noun_class == "road" and not one.words[-1].endswith("s"))), None)  # fmt: skip
    life = next(
        (one for one in sentence if not one.state and one.get("slot").partition("=")[0] in _LIFE),
        None,
    )
    if place is None or life is None:
        return sentence
    kind, _, amount = life.get("slot").partition("=")
    others = [one for one in sentence if one not in (life, place) and not one.state
              and one.kind not in ("mark", "function") and not one.has("rel")
              and one.get("verb") not in ("ADD", "MAKE")]  # fmt: skip
    begun = any(one.get("verb") == "MAKE" or one.get("rel") in ("on", "in", "along")
                for one in sentence)  # fmt: skip
    if not begun:
        return sentence  # "gridlocked avenues" of a town
    if amount not in _MUCH or others:
        asked([life])
        return sentence
    for one in sentence:
        one.state = READ if one is not place and one.kind != "mark" else one.state
    who, noun = _LIFE[kind]
    return [here(life, "fill", ("verb", "FILL")), place, here(life, "with", ("rel", "with")),
            Item("phrase", life.span, (who,), (("noun", noun),)),
            *(one for one in sentence if one.kind == "mark")]  # fmt: skip


_MENDS: tuple[Callable[[list[Item]], list[Item]], ...] = (
    _whether, _most, _fewer, _stops_for, _clears, _surrounds, _gives, _bars, _roofs_too, _drops,
    _speeds, _single_lanes, _thins, _roofs_along, _at_random, _parks, _crowd_of_no_number,
    _one_more, _rows_of, _seasonal, _fills_gaps, _tables_outside, _done_to, _fronted_new,
    _none_alike, _all_over, _in_one_place,
)  # fmt: skip
