"""Scopes: what a "no" denies, what "keep" protects and what "instead of" leaves out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import takewhile

from cityx.language.scan import ENDS, Item, begin_of

NEGATED, KEPT, DROPPED, READ = "negated", "kept", "dropped", "read"
_PRONOUNS = ("nothing", "none", "nobody", "nowhere")
_DESCRIBES = ("amount", "size", "height", "width", "strength", "material", "color", "compared")
# "leave" and "keep" also lead a street out of a square, or a street narrow.
_MILD_KEEPS = {
    "leave",
    "keep",
    "maintain",
    "retain",
    "leaves",
    "leaving",
    "keeping",
    "left",
    "spare",
}


_AWAY = ("away", "out", "off", "out of", "clear", "clear of", "back", "to", "apart")
_OF_ALL = ("all", "every", "of", "it")
_KEPT_BEFORE = ("kept", "retained", "preserved", "saved", "spared", "maintained")


def _moves(item: Item) -> bool:
    """Return whether a street may be closed to somebody."""
    return item.noun_class in ("vehicle", "person")


def settle_scopes(items: Sequence[Item]) -> None:
    """Give every item inside a scope its state; negation comes first."""
    for at, item in enumerate(items):
        if item.state:
            continue
        if item.text == "keep" and at and items[at - 1].text in ("a", "an"):
            item.senses, item.kind = (), "unknown"  # "a | keep in the middle"
        elif item.has("keep") and protects(items, at):
            item.state = READ
            _mark(_kept_scope(items, at + 1), KEPT)
        elif item.has("unchanged") and not item.has("noun"):
            _keep_before(items, at)
        elif item.text in _KEPT_BEFORE and _ends_clause(items, at):
            item.state = READ  # "every tree kept"
            _mark(_list_before(items, at), KEPT)
        elif item.has("nothing_but"):
            item.state = READ
        elif item.has("neither"):
            item.state = READ
            _mark(_of_one_kind(_scope(items, at + 1)), DROPPED)
        elif item.has("neg") and _tells_which(items, at):
            item.senses, item.kind = (), "unknown"
        elif item.has("after_neg"):
            item.state = READ
            said = [one for one in items[max(at - 1, 0) : at] if one.has("slot")]
            _mark(_list_before(items, at) or said, NEGATED)  # "long shadows not wanted"
        elif item.has("neg") and _ends_clause(items, at) and _list_before(items, at, ":"):
            item.state = READ  # "hills: none"
            _mark(_list_before(items, at, ":"), NEGATED)
        elif item.has("neg") and _denies_a_way(items, at):
            continue
        elif item.has("neg") and not item.has("after_neg"):
            placed = item.text in _PRONOUNS and _is_placed(items, at)
            denied = [] if placed else _scope(items, at + 1)  # "nobody on the pavements"
            if item.words[-1] == "to":  # "shut to | cars and lorries, and café tables outside"
                denied = list(takewhile(lambda one: not one.noun or _moves(one), denied))
            if item.text in _PRONOUNS and not any(
                one.has("noun", "slot", "compared", "height", "head") for one in denied
            ):
                denied = []  # "nothing moving"
            item.state = READ if denied or item.text not in _PRONOUNS else ""
            _mark(denied, NEGATED)
        elif item.has("except") and _is_a_thing(items, at):
            item.senses, item.kind = (), "unknown"  # "one neon-lit | bar"
        elif item.has("except") or is_exception(items, at):
            item.state, item.senses = READ, (("except", "but"),)
            _mark(_named_after(items, at + 1) or _scope(items, at + 1), KEPT)


def named_list(items: Sequence[Item], at: int) -> list[Item]:
    """Return the things listed from an item on: "all trees, benches and lamps"."""
    found: list[Item] = []
    begins, last = True, False  # whether a noun may come next, whether "and" came before it
    for item in items[at:]:
        joins = item.is_mark(",") or item.get("rel") in ("and", "or")
        if item.kind == "unknown" and begins:
            begins = False
        elif item.has("noun") and not item.has("keep") and begins:
            found.append(item)
            begins = False
        elif joins and not begins:
            if last and item.is_mark(","):
                break  # "car parks and buses, | sea all round"
            begins, last = True, item.get("rel") == "and"
        elif not begins or not (item.kind == "function" or item.get("rel") in _OF_ALL):
            break
    return found


def _denies_a_way(items: Sequence[Item], at: int) -> bool:
    """Return whether a "not" denies a way to somewhere: "the entrance not from the square"."""
    after = items[at + 1] if at + 1 < len(items) else None
    way = after is not None and (after.get("rel") in ("from", "to", "by") or after.text == "from")
    return way and items[at].text == "not"


def _is_a_thing(items: Sequence[Item], at: int) -> bool:
    """Return whether a word for an exception is a noun with an article, a number or a look."""
    before = items[at - 1] if at else items[at]
    counted = before.quantity is not None and before.quantity.dimension == "count"
    plain = items[at].words in (("bar",), ("bars",), ("save",))
    looks = before.has("slot", "material", "color", "size", "ordinal")
    return plain and (before.text in ("a", "an", "the", "every", "each") or counted or looks)


def is_exception(items: Sequence[Item], at: int) -> bool:
    """Return whether a "but" leaves something out of all: "everything but b01"."""
    if items[at].get("rel") != "but":
        return False
    before = [item for item in items[:at] if item.kind != "function"]
    after = next((item for item in items[at + 1 :] if item.kind != "function"), None)
    if not before or after is None:
        return False
    whole = any(item.get("rel") in ("all", "every") or item.noun == "everything" for item in before)
    thing = before[-1].noun or before[-1].get("rel") == "all"
    return bool(whole and thing) and (after.kind == "id" or bool(after.noun) or after.has("rank"))


def _tells_which(items: Sequence[Item], at: int) -> bool:
    """Return whether a "none" tells which are meant: "trees along every street that has | none"."""
    if not _ends_clause(items, at) or items[at].text not in _PRONOUNS:
        return False
    before = [one.text for one in items[max(begin_of(items, at, ENDS), at - 3) : at]]
    has = bool(before) and before[-1].split()[-1] in ("has", "have", "had", "with", "got")
    return has and any(one.split()[0] in ("that", "which", "who", "where") for one in before)


def _named_after(items: Sequence[Item], at: int) -> list[Item]:
    """Return the names in a row from an item on: "b02, b03 and b04"."""
    found: list[Item] = []
    for item in items[at:]:
        if item.kind == "id":
            found.append(item)
        elif item.kind != "function" and not item.is_mark(",") and item.get("rel") != "and":
            break
    for item in items[at : items.index(found[-1])] if found else ():
        if item not in found:
            item.state = item.state or READ
    return found


def _mark(items: Iterable[Item], state: str) -> None:
    for item in items:
        if not item.state and _may_be_denied(item):
            item.state = state


def _may_be_denied(item: Item) -> bool:
    """Return whether an item says something that a scope can be about."""
    return bool(item.senses) or item.kind in ("id", "quantity")


def _scope(items: Sequence[Item], at: int) -> list[Item]:
    """Return the items a "no" reaches: to a comma, a "but", or the end of the list."""
    reached: list[Item] = []
    while at < len(items):
        item = items[at]
        if item.is_mark(ENDS + ":()") or item.get("rel") == "but" or item.has("except", "keep"):
            break
        if reached and (item.has("neg") or item.get("rel") == "with"):
            break
        if item.is_mark(",") and not _list_goes_on(items, at):
            break
        if item.get("rel") == "and" and reached and not _noun_follows(items, at):
            break
        if item.quantity is not None and item.quantity.dimension == "length" and not reached:
            return [item]  # "none within 10 m of the road"
        if item.quantity is not None and item.words[:1] == ("within",):
            break  # "no cars | within 50 m of the water"
        placed = item.get("rel") in ("on", "along", "near", "around", "in", "to", "from")
        placed = placed or item.text in ("between", "behind", "within", "outside", "before")
        if item.has("axis") or ((item.has("exact") or placed) and reached):
            break
        if item.has("compared") and item.words[-1] == "than":
            return []  # "no house taller than the church"
        reached.append(item)
        at += 1
    return reached


def _behind_comma(items: Sequence[Item], at: int, named: list[Item]) -> list[Item]:
    """Return what stays: of "remove the benches, the bins | stay" the bins alone."""
    begin = begin_of(items, at, ENDS)
    comma = next((n for n in range(at - 1, begin, -1) if items[n].is_mark(",")), begin)
    ordered = any(one.state or one.has("verb", "neg") for one in items[begin:comma])
    return [one for one in named if not ordered or one.span > items[comma].span]


def _of_one_kind(items: Sequence[Item]) -> Sequence[Item]:
    """Return the items up to an "and" behind which things of another kind follow.

    Of "cobbles instead of asphalt and plane trees" the trees are wanted.
    """
    for at, item in enumerate(items):
        if item.get("rel") != "and":
            continue
        kinds = [
            {(kind, value.partition(":")[0]) for one in part for kind, value in one.senses
             if kind in ("noun", "surface", "material")}
            for part in (items[:at], items[at + 1 :])
        ]  # fmt: skip
        if kinds[0] and kinds[1] and kinds[0].isdisjoint(kinds[1]):
            return items[:at]
    return items


def _list_goes_on(items: Sequence[Item], at: int) -> bool:
    """Return whether a comma parts the nouns of a list that ends in "or": "no A, B or C"."""
    nouns = 0
    for item in items[at + 1 :]:
        if item.get("rel") == "or" or item.text == "nor":
            return True
        if item.is_mark(","):
            continue
        if not item.has("noun", "slot") or item.has("neg", "verb", "keep"):
            return False
        nouns += 1
    return False


def _all_stay(items: Sequence[Item], at: int) -> bool:
    """Return whether a comma parts what stays: "leave schools, churches and parks | alone"."""
    named = joined = False
    for item in items[at + 1 :]:
        if item.has("unchanged"):
            return joined
        if item.get("rel") == "and" and named:
            joined = True
            continue
        plain = item.kind == "function" or item.is_mark(",")
        if not plain and (not item.has("noun") or item.has("neg", "verb", "keep", "amount")):
            return False
        named = named or not plain
    return False


def _noun_follows(items: Sequence[Item], at: int) -> bool:
    """Return whether "and" is followed by a bare noun, so that the "no" before it reaches on."""
    if at + 1 >= len(items):
        return False
    item = items[at + 1]
    if not item.has("noun") or item.has("amount"):
        return False
    after = items[at + 2] if at + 2 < len(items) else None
    return after is None or after.kind != "quantity"


def _is_placed(items: Sequence[Item], at: int) -> bool:
    """Return whether a place follows."""
    after = items[at + 1] if at + 1 < len(items) else None
    if after is None:
        return False
    told = after.words[0] in ("to", "above", "over", "under", "below", "behind", "inside",
                              "outside")  # fmt: skip
    return told or after.get("rel") in ("in", "on", "along", "near", "around", "by")


def _ends_clause(items: Sequence[Item], at: int) -> bool:
    """Return whether nothing follows in a sentence or a line."""
    after = items[at + 1] if at + 1 < len(items) else None
    return after is None or after.is_mark(ENDS + ",")


def _list_before(items: Sequence[Item], at: int, past: str = "") -> list[Item]:
    """Return the nouns of "cars, buses and trams" before "are not allowed", past some marks."""
    reached: list[Item] = []
    for index in range(at - 1, -1, -1):
        item = items[index]
        if past and not reached and item.is_mark(past):
            continue
        between = item.is_mark(",") or item.get("rel") in ("and", "or")
        if item.has("noun") or item.kind == "id" or (past and item.has("slot")):
            reached.append(item)
        elif not (between and reached and index and items[index - 1].has("noun")):
            if item.kind == "function" or item.has("amount", "rel", "exact"):
                if reached and not between:
                    continue
                if not reached:
                    continue
            break
    return reached


_EMPTIED = ("empty", "blank", "vacant", "bare", "unbuilt", "undeveloped", "unpaved")


def protects(items: Sequence[Item], at: int) -> bool:
    """Return whether "keep" or "leave" protects something, here."""
    clause = _kept_scope(items, at + 1)
    if at and items[at - 1].is_mark("-"):
        return False  # "a lane-keeping system"
    if any(item.text in _AWAY or item.has("neg") for item in clause[:3]):
        return False  # "keep away from the pond", "keep it free of cars"
    placed = bool(clause) and clause[0].get("rel") in ("on", "in", "of", "along", "from", "near")
    if placed and items[at].text in ("leaves", "left"):
        return False  # "leaves on the ground"
    if any(item.has("unchanged") for item in clause):
        return True
    if items[at].text in ("leaves", "keeps"):
        return False  # "everyone leaves the offices" orders nothing
    if any(item.text == "as" for item in clause):
        return False  # "leave all above 600 m as forest"
    if any(item.text in _EMPTIED for item in clause):
        return False  # "leave the four blocks in the centre empty"
    named = [item for item in clause if item.has("noun") or item.kind == "id"]
    if not named or all(_is_new(items, item) for item in named):
        return False
    if items[at].text not in _MILD_KEEPS:
        return True
    begins = at == 0 or items[at - 1].kind in ("mark", "function") or items[at - 1].has("rel")
    last = clause.index(named[-1])
    told = any(item.senses and not item.has("rel", "noun") for item in clause[last + 1 :])
    shaped = any(item.has(*_DESCRIBES) for item in clause[last:])
    # "keep the street names readable" speaks of what the book does not know.
    shaped = shaped or any(item.kind == "unknown" for item in clause[last + 1 :])
    return begins and not told and not shaped


def _is_new(items: Sequence[Item], item: Item) -> bool:
    """Return whether a thing is told of for the first time: "leave | a strip of meadow"."""
    at = items.index(item)
    while (
        at > 0 and not items[at - 1].is_mark(ENDS + ",") and not items[at - 1].has("verb", "keep")
    ):
        at -= 1
        if items[at].text in ("a", "an"):
            return True
        if items[at].text in ("the", "all", "every", "each", "its", "this"):
            return False
    return False


def _kept_scope(items: Sequence[Item], at: int) -> list[Item]:
    reached: list[Item] = []
    for item in items[at:]:
        joined = bool(reached) and reached[-1].get("rel") == "and"
        stops = item.has("verb") and not item.has("noun")
        stops = stops and (item.get("verb") != "MAKE" or joined)
        if item.is_mark(",") and _all_stay(items, items.index(item)):
            continue
        if item.is_mark(ENDS + ",") or item.get("rel") == "but" or (stops and reached):
            break
        reached.append(item)
    return reached


def _keep_before(items: Sequence[Item], at: int) -> None:
    """Protect the nouns before "stay as they are"; a lone "the same" says nothing."""
    named = [one for one in _list_before(items, at) if not _is_new(items, one)]
    if named and named[0].noun == "everything":
        named = named[:1]  # "replace the tower, | everything else stays"
    alone = items[at].text in (
        "alone",
        "the same",
        "stay",
        "stays",
        "remain",
        "remains",
        "in place",
    )
    if items[at].text.startswith(("stay", "remain")) and _ends_clause(items, at):
        alone, named = False, _behind_comma(items, at, named)
    if named and not alone:
        items[at].state = READ
        _mark(named, KEPT)
