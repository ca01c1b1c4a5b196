"""Restrictions: what is said of some things alone is not said of all of their kind.

"Buildings without a height get four floors" tells nothing of the other buildings. A statement
about things that a place, a measure, a relative clause or a rank sets apart is left open as a
whole; that there are such things, and the places that set them apart, is still read.
"""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.here import AIR, DESCRIBING, SEVERAL, Findings, Here, is_of_a_town
from cityx.language.lexicon.phrases import PARTS_OF_SPEECH
from cityx.language.scan import ENDS, Item, begin_of
from cityx.language.scopes import KEPT, NEGATED, READ
from cityx.language.syntax import Phrase, Syntax, is_plural

ABOUT, OF_A_PART = "of some of them alone", "of a part of them"
IN_MANY_COLORS = "in colours of their own"
# Verbs that say how things are; those of "be" are known by their relation.
_TELLING = (
    "have", "has", "get", "carry", "carries", "need", "needs", "receive", "receives", "become",
    "becomes", "wear", "wears", "bear", "show", "stay", "stays", "remain", "remains",
)  # fmt: skip
_WISHING = ("want", "i want", "would like", "i would like", "i'd like", "to be", "could use")
_USERS = ("i", "we", "you", "it", "they", "there")
_RELATIVE = ("that", "which", "who", "whose", "where", "whom")
_OF_THE_SUBJECT = ("that", "which", "who")  # pronouns that may stand right before a verb
_PLACES = ("in", "on", "near", "along", "around", "by", "with")
_ADVERBS = ("all", "also", "each", "both", "only", "always", "usually", "mostly", "generally")
_BESIDE = (
    "behind", "between", "opposite", "facing", "beyond", "inside", "outside", "beside", "across",
    "towards", "above", "below",
)  # fmt: skip
_EACH = ("every", "each", "any", "all", "no")
_THOSE = ("those", "ones", "some", "others", "few", "several")
_OTHERS = ("else", "other", "others", "rest", "remaining", "the rest", "the others")
_SELECTING = ("rank", "ordinal", "size", "height", "width")
_WHICH = (("which",), ("that",), ("whose",), ("who",))
_LOOKS = ("building.roof=", "roof.", "style=", "building.material=")
_MOVING = ("vehicle", "person")
_WHOLE = ("city", "landscape", "everything", "sky", "light")


def leave_restricted(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Leave open what is said of some of the things of a kind alone."""
    for at, item in enumerate(items):
        if item.state == "" and _is_order_for_some(items, syntax, at):
            _leave_which(found, items, at + 1)
        if item.quantity is not None and (apart := _measured(items, syntax, at)) is not None:
            for one in items[apart]:
                one.state = READ
            found.leave_span((items[apart][0].span[0], items[apart][-1].span[1]), ABOUT)
        if not is_telling(item) or item.state not in ("", NEGATED):
            continue  # the reach of "without a garden" does not end at the verb
        if _tells_which(items, syntax, at):
            _leave_which(found, items, at)
        else:
            first = _begin(items, at)
            head = _subject(items, syntax, first, at)
            if head >= 0 and _are_some(items, syntax, first, head, at):
                _leave(found, items, syntax, (first, head, at), ABOUT)
            elif head >= 0 and _is_a_state(items, syntax, head, at):
                _leave(found, items, syntax, (first, head, at), "a state of them")


def _measured(items: Sequence[Item], syntax: Syntax, at: int) -> slice | None:
    """Return the items of things that a bound sets apart: "all towers | over 100 m in white".

    What is not followed by how they look is a limit: "all towers over 100 m".
    """
    bound, head = items[at].quantity, syntax.head_before(at)
    phrase = syntax.phrase(head) if head >= 0 else None
    if bound is None or bound.exact is not None or phrase is None or at + 1 == len(items):
        return None
    if bound.low is not None and bound.high is not None:
        return None  # "every building | 3 to 4 floors, with a flat roof" tells of each
    every = items[phrase.first].get("rel") in ("every", "all") or items[phrase.first].text in _EACH
    linked = items[at + 1].get("rel") in ("in", "of", "with")
    kind = items[head].noun_class in ("type", "building", "road", "plant")
    looks = [
        n for n in range(at + 2, min(at + 5, len(items)))
        if items[n].has("color", "material") or items[n].get("slot").startswith(_LOOKS)
    ]  # fmt: skip
    if not (every and linked and kind and looks and phrase.end in (at, at + 1)):
        return None
    return slice(phrase.first, looks[-1] + 1)


def _is_order_for_some(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether a clause begins to change some: "| make every street touching it narrow"."""
    begins = at == 0 or items[at - 1].kind == "mark" or items[at - 1].get("rel") in ("and", "but")
    if items[at].text not in ("make", "turn", "give") or not begins:
        return False
    head = syntax.object_of(at)
    phrase = syntax.phrase(head) if head >= 0 else None
    if phrase is None or phrase.end >= len(items) or items[phrase.end].is_mark(ENDS + ","):
        return False
    first = items[phrase.first]
    every = first.get("rel") in ("every", "all") or first.text in (*_EACH, "the")
    apart = _sets_apart(items, syntax, phrase.end) or items[phrase.end].text.endswith("ing")
    return every and apart and items[head].noun_class in ("type", "building", "road", "plant")


def _tells_which(items: Sequence[Item], syntax: Syntax, verb: int) -> bool:
    """Return whether a relative clause tells which of them: "the streets that | are wide"."""
    if verb < 2 or items[verb - 1].text not in _OF_THE_SUBJECT or items[verb - 2].is_mark(","):
        return False
    head = syntax.head_before(verb - 1)
    phrase = syntax.phrase(head) if head >= 0 else None
    if head != verb - 2 or phrase is None or not is_plural(items[head].text):
        return False
    return items[phrase.first].text in ("the", "those", "all", "any")


def _leave_which(found: Findings, items: Sequence[Item], verb: int) -> None:
    """Leave what tells which things are meant."""
    end = _end(items, verb)
    for item in items[verb - 1 : end]:
        if item.state in ("", NEGATED):
            item.state = READ
    found.leave_span((items[verb - 1].span[0], items[end - 1].span[1]), "which of them")


def is_telling(item: Item) -> bool:
    """Return whether an item is a verb that says how things are or what they have."""
    return (item.get("rel") == "be" and item.text not in _WISHING) or item.text in _TELLING


def _begin(items: Sequence[Item], verb: int) -> int:
    """Return where the clause of a verb begins."""
    told = False
    for at in range(verb - 1, -1, -1):
        item = items[at]
        if item.is_mark(ENDS + ":,()"):
            return at + 1
        if item.text in ("whose", "where", "while", "whereas", "whilst", "but"):
            if item.text == "whose" and told:
                continue  # "houses whose owners are away | have lamps"
            return at + 1
        if item.get("rel") == "and" and any(map(is_telling, items[_mark_before(items, at) : at])):
            return at + 1
        told = told or is_telling(item)
    return 0


def _mark_before(items: Sequence[Item], at: int) -> int:
    return next((n + 1 for n in range(at - 1, -1, -1) if items[n].is_mark(ENDS + ":,()")), 0)


def _subject(items: Sequence[Item], syntax: Syntax, first: int, verb: int) -> int:
    """Return the head of what a verb tells of, -1 where it is that of a relative clause."""
    if verb and (items[verb - 1].text in _OF_THE_SUBJECT or items[verb - 1].text in _USERS):
        return -1
    for at in range(first, verb):
        phrase = syntax.phrase(at)
        if _is_one_of_them(items, at):
            return at
        if phrase is not None and at <= phrase.head < verb and not _is_place(items, first, phrase):
            return phrase.head
        if items[at].get("rel") == "it":
            return -1
    return -1


def _is_one_of_them(items: Sequence[Item], at: int) -> bool:
    """Return whether a pronoun stands for some of what was told: "| those in the valley"."""
    if items[at].text not in _THOSE or at + 1 >= len(items):
        return False
    after = items[at + 1]
    placed = _is_placing(after) or after.words[0] in PARTS_OF_SPEECH["prepositions"] - {"of"}
    return placed or after.text in _RELATIVE or after.has("neg") or is_telling(after)


def _is_place(items: Sequence[Item], first: int, phrase: Phrase) -> bool:
    """Return whether a phrase of a clause is one behind a preposition of place."""
    at = phrase.first - 1
    article = at > 0 and items[at - 1].text in PARTS_OF_SPEECH["determiners"]
    return at >= first and _is_placing(items[at]) and not article  # "the | inside streets"


def _is_placing(item: Item) -> bool:
    """Return whether an item is a preposition of place."""
    return item.get("rel") in _PLACES or (
        item.words[0] in PARTS_OF_SPEECH["prepositions"] - {"of", "for", "as"}
        and not item.has("noun", "slot")
        and item.kind != "quantity"
    )


def _are_some(items: Sequence[Item], syntax: Syntax, first: int, head: int, verb: int) -> bool:
    """Return whether what a verb tells of is set apart from others of its kind."""
    thing = items[head]
    if thing.text in _THOSE:
        return True
    phrase = syntax.phrase(head)
    begin = head if phrase is None else phrase.first
    before = items[max(first, begin - 1) : head]
    every = any(one.get("rel") == "every" or one.text in _EACH for one in before)
    everything = thing.noun == "everything"
    if not (everything or every or is_plural(thing.text)) or thing.noun_class in _MOVING:
        return False
    if thing.has("slot") and not thing.noun:
        return False
    others = thing.noun_class != "road" and any(
        one.get("rel") == "rest" or not set(one.words).isdisjoint(_OTHERS)
        for one in items[first:verb]
    )
    if others or any(one.has(*_SELECTING) and not one.has("noun") for one in before):
        return True
    kind = before[-1] if before and before[-1].kind == "unknown" else None
    if kind is not None and not kind.text.endswith((*DESCRIBING, "y", "ing")):
        return thing.has("noun")  # "corner | buildings"
    if any(_is_some_of(items, at) for at in range(first, head)):
        return True
    start = _mark_before(items, first)
    if start < first and _is_definite(items, syntax, start):
        return True  # "in the north the streets are cobbled and the houses are low"
    fronted = items[first:begin]
    return any(
        _sets_apart(items, syntax, at)
        for at in (*range(first, first + len(fronted)), *range(head + 1, verb))
    )


def _is_some_of(items: Sequence[Item], at: int) -> bool:
    """Return whether a number is of things that were told: "| four of the ten villas"."""
    quantity, after = items[at].quantity, items[at + 1] if at + 1 < len(items) else None
    counted = quantity is not None and quantity.dimension == "count"
    return counted and after is not None and after.get("rel") == "of"


def _is_a_state(items: Sequence[Item], syntax: Syntax, head: int, verb: int) -> bool:
    """Return whether how things are doing is told, and not how they look: "shops are closed"."""
    thing, phrase = items[head], syntax.phrase(head)
    first = head if phrase is None else phrase.first
    plain = not any(one.quantity is not None for one in items[first:head])
    kind = thing.noun_class == "type" and is_plural(thing.text) and plain
    behind = items[verb + 1 : _end(items, verb)]
    stop = next((n for n, one in enumerate(behind) if one.get("rel") == "and"), len(behind))
    behind = behind[:stop]
    told = [one for one in behind if one.kind != "function"][:1]
    if items[verb].get("rel") != "be" or head != verb - 1 or not (kind and told):
        return False
    looks = any(
        one.has("material", "color", "height", "noun", "slot", "axis", "side")
        or one.quantity is not None
        for one in behind
    )
    doing = told[0].get("verb") in ("CLOSE", "OPEN") or (
        told[0].kind == "unknown" and told[0].text.endswith(("ing", "ed"))
    )
    return doing and not looks


def _sets_apart(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether an item begins what sets some things apart from others."""
    item = items[at]
    if item.text in _ADVERBS or is_telling(item) or item.text in PARTS_OF_SPEECH["determiners"]:
        return item.text in ("that", "which") and at > 0 and items[at - 1].kind != "function"
    if item.text in _RELATIVE:
        return True
    if item.quantity is not None:
        return item.quantity.dimension not in ("count", "part", "share", "hour")
    if item.has("neg") and item.text.startswith("with"):
        return True
    placed = item.get("rel") in _PLACES or item.has("bound")
    placed = placed or item.words[0] in PARTS_OF_SPEECH["prepositions"] - {"of", "for", "as"}
    if not placed or item.has("noun", "slot"):
        return item.kind == "unknown" and item.text.endswith("ing") and at + 1 < len(items)
    return not is_whole_place(items, syntax, at)


def is_whole_place(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether a preposition stands before all of the town, or before a time or weather."""
    head = syntax.object_of(at)
    place = items[head] if head >= 0 else None
    if place is None:
        return at + 1 >= len(items) or items[at + 1].kind == "mark"
    air = place.get("slot").startswith(AIR)
    town = place.noun in _WHOLE or (is_of_a_town(place) and place.noun_class == "")
    first_town = next((one for one in items if is_of_a_town(one) and one.noun_class == ""), place)
    return air or (town and (place.noun in _WHOLE or first_town is place))


def is_at_known_things(here: Here, item: Item) -> bool:
    """Return whether an item is of known things at which others are: "buses on the | wide roads".

    These are there, and how they look tells which are meant.
    """
    at = here.syntax.index(item)
    phrase = here.syntax.phrase(at)
    if phrase is None or phrase.head < 0 or phrase.first == 0:
        return False
    known = here.items[phrase.first].text in ("the", "its", "their")
    before = here.items[phrase.first - 1]
    placed = before.get("rel") in ("in", "on", "near", "along", "around")
    placed = placed or before.text in ("outside", "between", "behind", "opposite", "past")
    return known and placed and is_plural(here.items[phrase.head].text)


def is_set_apart(here: Here) -> bool:
    """Return whether a place or a relative clause sets apart what an item is said of.

    "Nothing above 9 m along the | river" and "in the north, white houses" tell nothing of the
    rest of the town; "white houses by a lake" does.
    """
    if is_at_known_things(here, here.item):
        return True
    phrase = here.syntax.phrase(here.at)
    own = None if phrase is None or phrase.head < 0 else here.items[phrase.head]
    town = any(is_of_a_town(one) for one in here.items if one is not own)
    if here.item.quantity is None and not town:
        return False  # "white houses above the sea" are the town
    end = here.at + 1 if phrase is None else max(phrase.end, here.at + 1)
    if end < len(here.items) and _is_definite(here.items, here.syntax, end):
        return True
    if here.item.quantity is not None and _is_at_an_unknown_place(here, end):
        return True
    first = here.at
    while first > 0 and not here.items[first - 1].is_mark(ENDS + ",:"):
        first -= 1
    if first > 0 and here.items[first - 1].is_mark(","):
        begin = first - 1
        while begin > 0 and not here.items[begin - 1].is_mark(ENDS + ",:"):
            begin -= 1
        behind = here.items[begin + 1 : first - 1]
        placed = here.syntax.object_of(begin) >= first - 2 or (
            len(behind) < 3 and any(one.has("side") for one in behind)
        )
        if placed and _is_definite(here.items, here.syntax, begin):
            return True
    head = here.syntax.object_of(first)
    side = any(one.has("side") for one in here.items[first + 1 : min(first + 3, here.at)])
    told = first < head < here.at or side
    return told and _is_definite(here.items, here.syntax, first)


def is_of_the_excepted(here: Here) -> bool:
    """Return whether a look is of what is excepted: "except the church, which has a | tin roof"."""
    begun = here.items[begin_of(here.items, here.at, ENDS) : here.at]
    first = next((at for at, one in enumerate(begun) if one.has("except")), -1)
    if first < 0:
        return False
    behind = begun[first + 1 :]
    relative = any(one.words[:1] in _WHICH for one in behind)
    named = [one for one in behind if one.has("noun")]
    return relative or (len(named) == 1 and any(one.text == "with" for one in behind))


def _is_at_an_unknown_place(here: Here, at: int) -> bool:
    """Return whether a number holds in a place that nobody knows: "two floors | at the edges"."""
    if at + 1 >= len(here.items) or here.items[at].get("rel") not in ("in", "on", "near", "along"):
        return False
    head = here.syntax.object_of(at)
    place = here.items[head] if head >= 0 else None
    known = any(one.text in ("the", "its", "each", "every") for one in here.items[at + 1 : head])
    return place is not None and known and place.kind == "unknown" and not place.has("source")


def _is_definite(items: Sequence[Item], syntax: Syntax, at: int) -> bool:
    """Return whether a place that is known, a distance or a relative clause begins at an item."""
    item = items[at]
    if item.words[:1] == ("within",) and item.quantity is not None:
        return True
    if item.text in _OF_THE_SUBJECT and at + 1 < len(items):
        return not is_telling(items[at + 1])
    placed = item.get("rel") in ("in", "on", "near", "along", "around", "by")
    placed = placed or item.words[0] in _BESIDE
    if not placed or item.has("noun", "slot") or is_whole_place(items, syntax, at):
        return False
    head = syntax.object_of(at)
    if head < 0:
        return any(one.has("side") for one in items[at + 1 : at + 3])  # "in the north"
    known = any(one.text in ("the", "its", "this", "each", "every") for one in items[at + 1 : head])
    told = any(one.has("side") for one in items[at + 1 : head])  # "in the northern part"
    return known and (told or bool(items[head].noun) or items[head].has("side", "slot"))


def _end(items: Sequence[Item], verb: int) -> int:
    """Return where what a verb tells ends: at a mark, or before another subject."""
    for at in range(verb + 1, len(items)):
        item = items[at]
        if item.is_mark(ENDS + ":("):
            return at
        if item.is_mark(","):
            after = items[at + 1] if at + 1 < len(items) else item
            looks = after.has("material", "color", "height", "width") or (
                after.quantity is not None and after.quantity.dimension not in ("count", "hour")
            )
            if not (looks or after.get("slot").startswith("building.")):
                return at
        if item.get("rel") in ("and", "but") or item.text in ("while", "whereas"):
            rest = items[at + 1 :]
            stop = next((n for n, one in enumerate(rest) if one.is_mark(ENDS + ",:")), len(rest))
            if any(map(is_telling, rest[1:stop])):
                return at
    return len(items)


def _leave(
    found: Findings,
    items: Sequence[Item],
    syntax: Syntax,
    where: tuple[int, int, int],
    about: str,
) -> None:
    """Leave a statement open, but for the places and the things that it takes for granted."""
    first, head, verb = where
    end = _end(items, verb)
    phrase = syntax.phrase(head)
    begin = first if phrase is None else min(phrase.first, head)
    begin = min(begin, first) if items[first].kind != "function" else begin
    for at in range(begin, end):
        item = items[at]
        there = at < verb and item.noun_class == "element" and item.state == ""
        if there and at != head and not _is_denied(items[first:at]):
            continue
        if item.state in ("", NEGATED, KEPT):
            item.state = READ
    thing = items[head]
    if thing.noun_class == "type" and is_plural(thing.text) and items[end - 1] is not thing:
        found.presume(f"{thing.noun}.count.min", SEVERAL, thing)
    found.leave_span((items[begin].span[0], items[end - 1].span[1]), about)


def _is_denied(before: Sequence[Item]) -> bool:
    return any(one.has("neg") for one in before[-3:])
