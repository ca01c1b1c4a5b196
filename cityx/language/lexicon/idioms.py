"""Idioms: ways to put a command that are rewritten as plain ones before it is parsed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from cityx.language.brief import Edit, Span
from cityx.language.lexicon.phrases import part_named
from cityx.language.lexicon.words import forms_of
from cityx.language.scan import Item, Quantity
from cityx.language.scopes import NEGATED, READ

_TAKEN = (
    "take",
    "tear",
    "knock",
    "pull",
    "cut",
    "chop",
    "rip",
    "throw",
    "strip",
)  # "take the bench out"
_CLEARED = ("clear", "strip", "empty", "rid", "free", "relieve", "cleanse")  # "the park of trees"
_WANTS = ("i want", "i would like", "would like", "i'd like", "want", "like")
_WHOSE = ("i", "i'd", "we", "we'd", "i would", "we would")  # before "want" and "like"
DEGREES = 360.0  # of a whole turn
_ONE_STOREY = ("one story", "single story")  # folded; of a city that is described, low houses
_COPIES = frozenset(("copy", "duplicate", "replica", "clone", "twin"))  # "a copy of the church"
# Words after a share -> whether it is more or less than before.
_COMPARED = {
    "larger": 1, "bigger": 1, "taller": 1, "higher": 1, "smaller": -1, "shorter": -1, "lower": -1,
}  # fmt: skip
_BRINGS = ("take", "bring", "get", "carry", "push", "lift", "raise", "build", "extend", "cut",
           "chop", "reduce", "lower", "trim", "keep", "scale")  # fmt: skip
_KERBS, _LOWERS = ("kerb", "kerbs", "curb", "curbs"), ("lower", "drop", "flush")
_AWAY = ("out", "away", "off", "down", "out of")
_THINGS = ("element", "plant", "vehicle", "person", "building", "type")
# Word for weather -> what there can be more or less of.
_AMOUNTS = {"cloudy": "clouds", "overcast": "clouds"}


def plain(clause: list[Item]) -> None:
    """Rewrite the items of a command: verbs in two parts, and "no trees along the street"."""
    _street_of(clause)
    _parts_along(clause)
    _its_walks(clause)
    _to_a_height(clause)
    _lower_kerbs(clause)
    _must_be(clause)
    _top_floor(clause)
    live = [item for item in clause if item.kind != "mark"]
    _one_floor(live)
    _join_verb(live)
    _deny(live)
    _gain(clause)
    _clear(clause)
    _fronted(clause)
    _duplicate(clause)
    _turn(live)
    for part, link in pairwise(live):
        if part_named(part.text) and ("rel", "from") in link.senses:
            link.state = READ  # "the balconies from b03" are those of b03
    _want(live)
    _trees(live)
    _rows(live)
    _fraction(clause)
    for before, item in pairwise(live):
        if before.has("side") and item.quantity is not None and item.quantity.dimension == "part":
            item.state = READ  # "the western half of the city" is its west
    for at, item in enumerate(live):
        more = live[at + 1] if at + 1 < len(live) else None
        if item.text in _ONE_STOREY:
            way = _COMPARED.get(more.text, 0) if more is not None else 0
            item.quantity, item.senses = Quantity("floors", 1.0, 1.0, relative=way), ()
            if more is not None and way:
                more.senses, more.state = (), READ  # "one storey taller"


def _to_a_height(clause: list[Item]) -> None:
    """Read "take the church up to 52 m" as "raise the church to 52 m", and "down to" as lower."""
    verb = next((item for item in clause if item.kind not in ("function", "mark")), None)
    if verb is None or not verb.words or verb.words[0] not in _BRINGS or verb.state:
        return
    for at, item in enumerate(clause):
        size = item.quantity
        after = clause[at + 1 : at + 3]
        if item.text == "down" and [one.get("rel") for one in after[:1]] in (["to"], ["by"]):
            if any(_is_measured(one) for one in after):
                verb.senses, item.state, item.senses = (("verb", "LOWER"),), READ, ()
            return
        if size is None or size.dimension not in ("length", "floors") or item.words[:1] != ("up",):
            continue
        if size.high is not None and size.low is None:
            verb.senses = (("verb", "RAISE"),)
            item.quantity, item.words = replace(size, low=size.high), item.words[2:]
            clause.insert(at, Item("phrase", item.span, ("to",), (("rel", "to"),)))
        return


def _must_be(clause: list[Item]) -> None:
    """Read "the houses should be no taller than 9 m" as "make the houses no taller than 9 m"."""
    at = next((k for k, one in enumerate(clause) if one.get("rel") == "be"), 0)
    denied = clause[at - 1] if at > 1 and clause[at - 1].has("neg") else None
    first = clause[at] if denied is None else denied  # "must not be taller than 9 m"
    ought = at and first.words[0] in _OUGHT and clause[at].words[-1] in ("be", "have")
    before = clause[:at] if denied is None else clause[: at - 1]
    if clause[at].words[-1] == "have" and any(one.get("rel") in ("all", "every") for one in before):
        return  # a bound of all
    if not ought or any(one.has("verb", "neg") for one in before):
        return
    told = clause[at + 1 : at + 4]
    bound = any(one.has("bound", "compared") or _is_measured(one) for one in told)
    if not bound or not any(one.noun for one in clause[:at]):
        return
    lead = Item("phrase", clause[at].span, ("make",), (("verb", "MAKE"),))
    clause[at].state = READ
    if denied is not None:
        denied.state = READ  # it has turned the bound
    clause[:] = [lead, *before, *clause[at + 1 :]]


_OUGHT = ("should", "must", "shall", "ought", "need", "needs", "has", "have")


def _top_floor(clause: list[Item]) -> None:
    """Read "loses its top floor" as "loses a floor"."""
    for at, (own, top, floor) in enumerate(zip(clause, clause[1:], clause[2:], strict=False)):
        loses = at and clause[at - 1].text in _GAINS and own.text in ("its", "their")
        floors = floor.text in (*FLOOR, "floors", "storeys", "stories")
        if loses and floors and top.text in ("top", "upper"):
            own.words, own.kind = ("a",), "function"
            top.state = READ
            floor.words = (FLOOR[0],)
            clause[at + 1 : at + 2] = []
            return


def _lower_kerbs(clause: list[Item]) -> None:
    """Read "lower the kerbs at every crossing" as adding ramps there."""
    verb = next((item for item in clause if item.kind not in ("function", "mark")), None)
    kerbs = next((item for item in clause if item.words and item.words[-1] in _KERBS), None)
    if verb is None or kerbs is None or verb.words[0] not in _LOWERS or verb.state:
        return
    behind = clause[clause.index(kerbs) + 1 :][:1]
    if behind and behind[0].get("rel") in ("on", "in", "of", "near"):
        verb.senses = (("verb", "ADD"),)
        kerbs.kind, kerbs.senses = "phrase", (("noun", "element:curb_ramp"),)
        if behind[0].get("rel") == "of":
            behind[0].senses = (("rel", "on"),)


def _its_walks(clause: list[Item]) -> None:
    """Read "widen its pavements" as "widen the pavements of it"."""
    for at, (own, walks) in enumerate(pairwise(clause)):
        if own.text in ("its", "their") and walks.noun == "sidewalk":
            own.kind, own.senses, own.state = "function", (), READ
            of = Item("phrase", walks.span, ("of",), (("rel", "of"),))
            it = Item("phrase", walks.span, ("it",), (("rel", "it"),))
            clause[at + 2 : at + 2] = [of, it]
            return


def _parts_along(clause: list[Item]) -> None:
    """Read "the doors on Church Lane" as "the doors of the buildings on Church Lane"."""
    for at, (part, link) in enumerate(pairwise(clause)):
        placed = link.get("rel") in ("on", "along", "in") and not link.state
        if not placed:
            continue
        after = next((one for one in clause[at + 2 :] if one.kind != "function"), None)
        road = after is not None and (after.noun_class == "road" or after.kind == "id")
        named = any(word for word in (part_named(part.text), part_named(part.words[-1])))
        if named and road and not any(ch.isdigit() for ch in after.text):  # type: ignore[union-attr]
            noun = Item("phrase", link.span, ("buildings",), (("noun", "building:building"),))
            clause.insert(at + 1, noun)
            return


_STANDS = ("stands", "lies", "sits", "is", "stand", "are", "lie")


def _street_of(clause: list[Item]) -> None:
    """Read "the street (that) the church is on" as "the street in front of the church"."""
    for at, street in enumerate(clause):
        if street.noun_class != "road" or street.state:
            continue
        after = [one for one in clause[at + 1 :] if one.kind != "function"]
        after = after[1:] if after and after[0].text in ("that", "which", "where") else after
        named = [one for one in after[:3] if one.noun_class in ("building", "type")][:1]
        if not named:
            continue
        told = clause[clause.index(named[0]) + 1 :][:2]
        if len(told) < 2 or told[0].text not in _STANDS or told[1].text not in ("on", "at"):
            continue
        behind = clause[clause.index(told[1]) + 1 :][:1]
        if behind and (behind[0].noun or behind[0].kind in ("function", "id")):
            continue  # "the street the church is on | the corner of"
        begin = clause.index(after[0])
        ahead = Item("phrase", told[1].span, ("in", "front", "of"), (("rel", "near"),))
        for one in clause[at + 1 : begin]:
            one.state = one.state or READ
        for one in told:
            one.state, one.senses = READ, ()
        clause.insert(begin, ahead)
        return


def _clear(clause: list[Item]) -> None:
    """Read "clear the park of trees" as "remove trees from the park"."""
    first = next((k for k, one in enumerate(clause) if one.kind != "function"), len(clause))
    of = next((at for at, item in enumerate(clause) if item.get("rel") == "of"), 0)
    if of <= first or clause[first].words[0] not in _CLEARED or clause[first].state:
        return
    place, gone = clause[first + 1 : of], clause[of + 1 :]
    named = any(item.noun_class in _THINGS for item in gone)
    if any(item.quantity is not None or item.text in _AWAY for item in place):
        return  # "clear away every house within 70 m of the church"
    if not named or not any(item.noun or item.kind == "id" for item in place):
        return
    end = next((at for at, item in enumerate(gone) if item.kind == "mark"), len(gone))
    while end and gone[end - 1].get("rel") in ("and", "but"):
        end -= 1  # what follows is another command
    clause[first].senses, clause[of].senses = (("verb", "REMOVE"),), (("rel", "from"),)
    clause[first + 1 :] = [*gone[:end], clause[of], *place, *gone[end:]]


_FRONTS = ("in", "on", "near", "along", "around", "by")


def _fronted(clause: list[Item]) -> None:
    """Read "in front of the church add a bench" as "add a bench in front of the church"."""
    said = [item for item in clause if item.kind != "mark" and not item.state]
    if not said or said[0].has("verb"):
        return
    if said[0].get("rel") not in _FRONTS and said[0].words[0] not in ("between", "within"):
        return
    verb = next((item for item in said if item.get("verb") in ("ADD", "PLANT")), None)
    if verb is None or verb.has("noun") or not any(one.noun for one in said[: said.index(verb)]):
        return
    at = clause.index(verb)
    end = len(clause) - bool(clause[-1].kind == "mark")
    place = [item for item in clause[:at] if item.kind != "mark"]
    clause[:] = [*clause[at:end], *place, *clause[end:]]


def _turn(live: list[Item]) -> None:
    """Read "turn the tree by 45 degrees" as "rotate the tree by 45 degrees"."""
    if any(one.quantity is not None and one.quantity.dimension == "angle" for one in live):
        for item in live:
            if item.words[0] == "turn" and item.get("verb") == "MAKE":
                item.senses = (("verb", "ROTATE"),)


def _fraction(clause: list[Item]) -> None:
    """Read "a fifth larger" as "20 % larger", by which something is more or less than it was."""
    for at, (article, part) in enumerate(pairwise(clause)):
        number = "4" if part.text == "quarter" else part.get("ordinal")
        if article.text != "a" or not number.isdigit():
            continue
        after = clause[at + 2].text if at + 2 < len(clause) else ""
        by = at > 0 and clause[at - 1].get("rel") == "by"
        if after == "turn":
            angle = DEGREES / int(number)
            part.quantity, clause[at + 2].state = Quantity("angle", angle, angle), READ
        elif after in _COMPARED or by:
            part.quantity = Quantity("share", 1.0 / int(number), 1.0 / int(number), unit=0.01)
        else:
            continue
        part.senses, article.state = (), READ
    for part, more in pairwise(clause):
        if part.quantity is not None and part.quantity.dimension == "share":
            sign = _COMPARED.get(more.text, 0)
            if sign and not part.quantity.relative:
                part.quantity = replace(part.quantity, relative=sign)
                more.senses, more.state = (), READ


def _want(live: Sequence[Item]) -> None:
    """Read "I want a statue in the park" as "add a statue in the park"."""
    at = int(len(live) > 2 and live[0].text in _WHOSE)
    if len(live) <= at + 2 or live[at].text not in _WANTS:
        return
    first, noun = live[at + 1], next((item for item in live[at + 2 :] if item.noun), None)
    counted = first.quantity is not None and first.quantity.dimension == "count"
    new = counted or first.words[0] in ("a", "an", "some", "another", "more")
    if new and noun is not None and noun.noun_class in _NEW:
        live[at].kind, live[at].senses = "phrase", (("verb", "ADD"),)


_NEW = ("element", "type", "plant", "vehicle", "person")  # what is built when somebody wants it


def _trees(live: Sequence[Item]) -> None:
    """Read "plant rows of trees on both sides of it" as planting trees along it."""
    if not live or live[0].get("verb") not in ("PLANT", "ADD"):
        return
    for item, after in zip(live, [*live[1:], None], strict=True):
        if item.get("slot") == "nature.trees=many" and "trees" in item.words:
            item.senses = (("noun", "plant:tree"),)
            if "sides" in item.words and after is not None and after.get("rel") == "of":
                after.senses = (("rel", "along"),)


FLOOR = ("floor", "story", "storey", "level")
_GAINS = {
    "gain": "RAISE", "gains": "RAISE", "grow by": "RAISE", "grows by": "RAISE",
    "lose": "LOWER", "loses": "LOWER",
}  # fmt: skip


def _one_floor(live: Sequence[Item]) -> None:
    """Read "take a floor off", "add a storey" and "gains another storey" as one floor."""
    begun = [one for one in live if one.get("rel") != "please" and not one.state][:1]
    told = begun and (begun[0].words[0] in _TAKEN or begun[0].get("verb") in ("ADD", "REMOVE"))
    if not (told or any(one.text in _GAINS for one in live)):
        return
    for article, floor, after in zip(live, live[1:], [*live[2:], None], strict=False):
        said = article.text in ("a", "one", "another") and floor.text in FLOOR
        whole = after is None or not (after.noun or after.kind == "unknown")  # "a floor lamp"
        if said and whole:
            floor.kind, floor.senses = "quantity", ()
            floor.quantity, article.state = Quantity("floors", 1.0, 1.0), READ


def _gain(clause: list[Item]) -> None:
    """Read "every third house loses a floor" as "lower every third house by one floor"."""
    at = next((k for k, one in enumerate(clause) if one.text in _GAINS), 0)
    behind = next((k for k in range(at + 1, len(clause)) if not clause[k].state), at)
    if not at or any(one.has("verb") for one in clause[:at]) or not _is_measured(clause[behind]):
        return
    verb = clause[at]
    lead = Item("phrase", verb.span, verb.words, (("verb", _GAINS[verb.text]),))
    verb.kind, verb.senses = "phrase", (("rel", "by"),)
    clause.insert(0, lead)


_IN_ROWS = ("row", "rows", "line", "lines", "group", "groups", "set", "bunch", "cluster")
_LUMPS = ("couple", "pair")  # which are numbers


def _rows(live: Sequence[Item]) -> None:
    """Read "a row of oaks" as oaks, "a couple of oaks" as two."""
    for row, of, after in zip(live, live[1:], [*live[2:], None], strict=False):
        new = after is not None and after.noun_class in ("plant", "element", "vehicle", "person")
        if of.get("rel") != "of" or not new or row.state:
            continue
        if row.text in _IN_ROWS:
            row.state = of.state = READ
        elif row.words[-1] in _LUMPS and row.quantity is not None:
            of.state = READ


def _duplicate(clause: list[Item]) -> None:
    """Read "put a copy of the church beside it" as "copy the church beside it"."""
    for at, item in enumerate(clause[:-1]):
        twin = item.get("verb") == "COPY" or not _COPIES.isdisjoint(forms_of(item.words[-1]))
        if twin and clause[at + 1].get("rel") == "of" and not item.state:
            for other in [*clause[:at], clause[at + 1]]:
                other.state = other.state or READ
            said = next((one.quantity for one in clause[:at] if one.quantity is not None), None)
            count = int(said.exact or 1) if said is not None else 1
            item.senses = (("verb", "COPY"), ("copies", str(count)))
            return


def complaint(items: Sequence[Item]) -> tuple[int, str] | None:
    """Read "the street is too narrow": where the subject ends, and what is wrong with it."""
    for at, item in enumerate(items[1:-1], start=1):
        after = items[at + 1]
        said = next((kind for kind in ("width", "height", "size") if after.has(kind)), "")
        if item.text in ("too", "far too", "much too") and said:
            be = next((k for k in range(at) if _is_said_of(items[k])), 0)
            return (be, said.replace("size", "")) if be else None
    return None


_SEEMS = ("look", "looks", "seem", "seems", "feel", "feels", "appears", "sounds")


def _is_said_of(item: Item) -> bool:
    return item.get("rel") == "be" or item.text in _SEEMS


def remark(items: Sequence[Item]) -> int:
    """Return where the subject ends of what only says how something is: "the church looks dull".

    0 where more is said: a number, a look or another thing that it might be to become.
    """
    be = next((at for at, item in enumerate(items) if at and _is_said_of(item)), 0)
    told = [item for item in items[be + 1 :] if item.kind != "function"]
    thing = any(item.noun_class in _THINGS for item in items[:be])
    plain_words = bool(told) and all(
        item.kind == "unknown"
        or (thing and item.get("slot").startswith("weather="))  # not the sky is dull
        for item in told
    )
    return be if be and plain_words and not items[0].has("verb") else 0


def _join_verb(items: Sequence[Item]) -> None:
    """Read "take all benches out of the park" as "remove all benches from the park"."""
    first = next((item for item in items if item.senses or item.text in _TAKEN), None)
    if first is None or first.text not in _TAKEN or first.state:
        return
    at = items.index(first) + 1
    at += at < len(items) and items[at].state == READ  # "a | floor"
    if at < len(items) and _is_measured(items[at]):  # "take two floors off the tower"
        after = items[at + 1] if at + 1 < len(items) else None
        if after is not None and (after.get("rel") == "from" or after.text in _AWAY):
            first.senses, after.senses = (("verb", "REMOVE"),), (("rel", "from"),)
        return
    named = False
    for item, after in zip(items, [*items[1:], None], strict=True):
        named |= bool(item.noun) or item.kind == "id" or part_named(item.text) != ""
        away = item.text in _AWAY and (after is None or after.get("rel") != "to")
        if named and (away or item.text in ("from", "off of")):
            first.senses = (("verb", "REMOVE"),)
            leaves = after is not None and ("rel", "from") in item.senses  # "off the hotel"
            item.senses = (("rel", "from"),) if leaves or item.text.endswith("of") else ()
            item.state = "" if item.senses else READ
            return


def _is_measured(item: Item) -> bool:
    return item.quantity is not None and item.quantity.dimension in ("floors", "length")


def _deny(items: Sequence[Item]) -> None:
    """Read "no trees along the main street" as "remove the trees along the main street"."""
    said = [item for item in items if item.has("neg") or item.state == NEGATED or _tells(item)]
    if len(said) < 2 or not said[0].has("neg"):
        return
    denied = [item for item in said[1:] if item.state == NEGATED]
    if not denied or not any(item.noun_class in _THINGS or item.has("strip") for item in denied):
        return
    said[0].senses, said[0].state = (("verb", "REMOVE"),), ""
    for item in denied:
        item.state = ""


def _tells(item: Item) -> bool:
    return item.kind in ("id", "quantity") or item.has("noun", "slot", "verb", "material", "color")


def changed_air(items: Sequence[Item], span: Span) -> list[Edit]:
    """Read "thicker fog" and "one hour later"; what says so counts as read."""
    return [*_degrees(items, span), *_shifts(items, span)]


def _degrees(items: Sequence[Item], span: Span) -> Iterator[Edit]:
    """Read more or less of a kind of weather: "thicken the fog", "more rain"."""
    for at, item in enumerate(items):
        degree = item.get("degree") or _degree_of_amount(item)
        beside = [*items[at + 1 : at + 3], *reversed(items[:at])] if degree else []
        weather = next((one for one in beside if one.get("slot").startswith("weather=")), None)
        if weather is None:
            continue
        kind = weather.get("slot").partition(" ")[0].partition("=")[2]
        if kind == "clear":
            continue
        item.state = weather.state = READ
        what = _AMOUNTS.get(kind, kind)
        yield Edit(f"{degree}_weather", None, (("air", what),), span)


def _degree_of_amount(item: Item) -> str:
    if item.get("rel") == "more" or item.text == "more":
        return "more"
    return "less" if item.text in ("less", "fewer") else ""


def _shifts(items: Sequence[Item], span: Span) -> Iterator[Edit]:
    """Read "three hours earlier" and "move the clock forward by two hours"."""
    way = next((item for item in items if item.has("later")), None)
    for item in items:
        quantity = item.quantity
        if way is None or quantity is None or quantity.dimension != "duration":
            continue
        hours = (quantity.exact or 0.0) * int(way.get("later"))
        for one in items:
            one.state = one.state or (READ if _of_clock(one) else "")
        item.state = way.state = READ
        yield Edit("shift_time", None, (("hours", round(hours, 4)),), span)


def _of_clock(item: Item) -> bool:
    clock = item.text in ("clock", "time", "same weather", "same", "weather", "now", "it", "by")
    return clock or item.has("verb") or item.kind == "function"
