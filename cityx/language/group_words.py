"""Group words: what is said of some buildings alone: "30 houses within 50 m of the river".

The buildings are those of a kind that are counted, or that stand in one place. Their number, their
storeys and their looks are read together with where they stand, and are of these alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from cityx.checks.predicates.words import BESIDE, SIDES
from cityx.language.brief import Command, Note
from cityx.language.here import FEW, Findings
from cityx.language.named_sides import is_of_another
from cityx.language.relations import AT_FRONTS, BESIDES, OUTSKIRTS
from cityx.language.scan import ENDS, Item, Quantity, begin_of, end_of
from cityx.language.scopes import READ
from cityx.language.syntax import Phrase, Syntax, is_plural
from cityx.system.tables import load
from cityx.town.building_groups import FARTHEST, BuildingGroup
from cityx.town.elements import ELEMENTS, PLACES
from cityx.town.quarter_kinds import DWELLINGS, KINDS

_LINKS = (
    "stand", "standing", "stands", "lie", "lying", "are", "is", "be", "have", "has", "having",
    "built", "with", "of", "all", "each", "every", "and", "there", "only", "nothing but", "just",
    "right", "directly", "placed", "set", "arranged", "high", "tall", "whose", "must", "should",
)  # fmt: skip
_LEADING = (*_LINKS, "you find", "come", "put", "we want", "i want", "want")
_ARTICLES = ("the", "a", "an", "its", "our", "this", "that", "very", "far")
_PIECES = ("half", "part", "side", "end", "third", "edge", "quarter")
_WATERS = ("river", "canal", "lake", "sea", "harbour", "pond")
_BANKS = ("bank", "banks", "riverbank", "shore", "shoreline", "water", "waterside", "waterfront")
_TOWNS = ("city", "landscape")
_STOREYS = ("storys", "story", "storeys", "storey", "floors", "floor")
_ADDING = ("add", "added", "adding", "build", "put", "place", "plus", "new", "additional", "extra")
_ROW_OF = ("row", "rows", "row of", "rows of", "line", "line of", "group", "group of", "another")
_AT = ("near", "in", "on", "at", "with", "by", "along", "around", "to", "from", "of")
_LOOKS = ("color", "material")
_OF_HOUSES = ("roof", "facade")  # nouns of what a look is of that is theirs
_THEM = ("them", "these", "those", "which")
# What something else has to do with buildings that are not asked for.
_ABOUT = (
    "for", "from", "to", "towards", "into", "through", "past", "behind", "between", "opposite",
    "in front of", "next to", "around", "beside", "near", "by", "in", "at", "on", "than",
)  # fmt: skip
_OWNED = ("my", "his", "her", "your", "their", "these", "those")
_USERS = ("i", "we", "they", "he", "she")
_WISHING = load("language/spelling", frozenset[str], "wishing")
_NOT_NOW = frozenset(("how", "once", "had", "used", "unless", "if"))
_HIGHEST_HOUSE = KINDS["house"].floors[1]
_PLACE_REACH = 5  # items from a preposition to what it is of
_ALL = ("all", "each", "every")
# Senses of what is said of buildings and is not read of some of them: "20 | tall houses".
_OTHER_LOOKS = (
    "noun", "slot", "rank", "ordinal", "height", "size", "width", "side", "use", "vague", "degree",
    "shade", "later",
)  # fmt: skip
# Words that say of the buildings before a mark where they stand: "40 houses, standing | there".
_SAYING = (
    *_ALL, "stand", "standing", "stands", "lie", "lying", "are", "is", "be", "built", "placed",
    "set", "arranged", "must", "should",
)  # fmt: skip


@dataclass(frozen=True)
class _Where:
    """Where buildings stand, and the items that say so, up to before `end`."""

    end: int
    part: str = ""
    near: str = ""
    within: float = BESIDE
    words: tuple[Item, ...] = ()
    told: bool = False  # whether metres or a half are told


@dataclass
class _Said:
    """What is said of some buildings."""

    head: Item
    first: int
    end: int
    number: Item | None = None
    where: _Where | None = None
    looks: list[tuple[str, str, Item]] = field(default_factory=list)
    floors: list[tuple[float | None, float | None, tuple[Item, ...]]] = field(default_factory=list)
    stated: bool = False  # "the houses along the river are of timber"
    every: bool = False  # "100 houses, all within 300 m of a school": there are no others

    @property
    def kind(self) -> str:
        """The kind; houses of more storeys than a house has are blocks of flats."""
        high = any((low or 0.0) > _HIGHEST_HOUSE for low, _, _ in self.floors)
        return "apartment" if high and self.head.noun == "house" else self.head.noun

    @property
    def has_looks(self) -> bool:
        return bool(self.looks or self.floors)


def read_groups(found: Findings, items: Sequence[Item], syntax: Syntax) -> None:
    """Read what is said of some buildings of a town that is no map's."""
    if found.mapped:
        return
    said = [
        one for at in range(len(items))
        if items[at].state == "" and (one := _said_of(items, syntax, at, ("",))) is not None
    ]  # fmt: skip
    for one in said:
        if one.head.state == "" and _is_of_these_alone(one, said):
            _add(found, one, added=False)
    taken = [one for one in said if one.head.state == READ]
    for at in range(len(items)):
        _read_some_of_them(found, items, at)
        before = [one for one in taken if one.end <= at]
        if before and before[-1].end + 2 >= at:
            _leave_some_of_them(found, items, syntax, at, before[-1])


def read_added_groups(found: Findings, items: Sequence[Item], then: Sequence[Command]) -> None:
    """Read buildings that are added to a map, where no command says all of it.

    What other rules have read of the same words is taken back.
    """
    if not found.mapped:
        return
    syntax, last = Syntax(items), -1
    for at in range(len(items)):
        one = _said_of(items, syntax, at, ("", READ))
        if one is None or one.number is None:
            continue
        phrase = syntax.phrase(at)
        listed = phrase is not None and last >= 0 and _is_listed(items[last : phrase.first])
        if phrase is None or not (listed or _is_added(items, phrase)):
            continue
        last = one.end
        span = items[one.first].span[0], items[one.end - 1].span[1]
        if any(span[0] < two.span[1] and two.span[0] < span[1] for two in then):
            continue
        sentence = items[begin_of(items, at, ENDS) : end_of(items, at, ENDS)]
        for slots in (found.slots, found.negated):
            slots[:] = [two for two in slots if not _holds(span, two.span) or _is_a_place(two)]
        found.notes[:] = [two for two in found.notes
                          if two.code != "left_open" or not _meets(span, two.span)]  # fmt: skip
        _add(found, one, added=True)
        for word in sentence:
            if word.text in _ADDING:
                word.state = word.state or READ


def _is_listed(between: Sequence[Item]) -> bool:
    """Return whether nothing but "and" or a comma stands between buildings that are added."""
    return bool(between) and all(
        item.is_mark(",") or item.get("rel") == "and" or item.kind == "function" for item in between
    )


def _is_added(items: Sequence[Item], phrase: Phrase) -> bool:
    """Return whether buildings are said to be added: "add | 25 houses", "25 houses | added"."""
    own = items[phrase.first : phrase.head]
    if any(item.text in ("the", "these", "those") for item in own):
        return False
    behind = items[phrase.head + 1 : phrase.head + 3]
    if any(item.text in _ADDING for item in own) or any(item.text == "added" for item in behind):
        return phrase.first == 0 or items[phrase.first - 1].get("rel") not in _AT
    k = phrase.first - 1
    while k >= 0 and (
        (items[k].kind == "function" and items[k].text != "the")
        or items[k].text in _ROW_OF
        or items[k].get("rel") in ("be", "of")
    ):
        k -= 1
    return k >= 0 and items[k].text in _ADDING and not (
        items[k].text == "place" and k and items[k - 1].text in _ARTICLES
    )  # fmt: skip


def _is_a_place(slot: object) -> bool:
    return getattr(slot, "key", "") == "element"


def _holds(span: tuple[int, int], other: tuple[int, int]) -> bool:
    return span[0] <= other[0] and other[1] <= span[1] and other[1] > 0


def _meets(span: tuple[int, int], other: tuple[int, int]) -> bool:
    return span[0] < other[1] and other[0] < span[1]


def _is_of_these_alone(one: _Said, said: Sequence[_Said]) -> bool:
    """Return whether what is said is of some buildings, and no other rule reads it as such."""
    if one.number is not None and one.where is not None:
        return True
    others = [two for two in said if two is not one and two.head.noun != one.head.noun]
    if one.where is None:
        quantity = one.number.quantity if one.number is not None else None
        if quantity is None or not one.has_looks:
            return False
        few = (quantity.high or quantity.low or 0.0) <= FEW
        return one.head.noun not in DWELLINGS or (few and one.head.noun == "apartment") or (
            bool(others) and one.head.noun != "house"
        )  # fmt: skip
    if one.where.told:
        return not one.stated and (one.has_looks or bool(one.where.part))
    alike = any(
        two.where is not None and two.head.noun == one.head.noun for two in said if two is not one
    )
    return one.has_looks and alike and not one.stated


def _add(found: Findings, one: _Said, *, added: bool) -> None:
    """Take what is said of some buildings."""
    where = one.where or _Where(one.end)
    group = BuildingGroup(one.kind, where.part, where.near, round(where.within), added)
    if group.is_some and not group.is_known:
        return
    about = group.text if group.is_some else group.kind
    own = (one.head, *where.words)
    if one.number is not None and one.number.quantity is not None:
        found.add_bounded(f"{about}.count", one.number.quantity, one.number, *own)
        if one.every and group.is_some and not added:
            found.add_bounded(f"{group.kind}.count", one.number.quantity, one.number, one.head)
    elif where.part:
        found.add(f"{group.kind}.part", where.part, *own)
    elif where.near and not where.told:
        found.add(f"{group.kind}.by", where.near, *own)
    for low, high, words in one.floors:
        exact = low if low == high else None
        found.add_bounded(
            f"{about}.floors", Quantity("floors", exact or low, exact or high), *words
        )
    placed = () if one.number is not None or not where.told else where.words
    for look, value, item in one.looks:
        found.add(f"{about}.{look}", value, item, *placed)
    for item in own:
        item.state = item.state or READ
    if one.kind != one.head.noun:
        told = f'Houses of "{found.said(one.floors[0][2][0])}" are read as blocks of flats.'
        found.notes.append(Note("kind", told, one.floors[0][2][0].span))


def _read_some_of_them(found: Findings, items: Sequence[Item], at: int) -> None:
    """Read "40 houses, | ten of them within 50 m of the river": of all of them, at least ten."""
    item, behind = items[at], items[at + 1 : at + 3]
    quantity = item.quantity
    if quantity is None or quantity.dimension != "count" or item.state or len(behind) < 2:
        return
    if behind[0].text not in ("of", "of them") or behind[1].text not in _THEM:
        return
    kinds = [one.noun for one in items[:at] if one.noun_class == "type" and one.has("noun")]
    where = _where_behind(items, at + 3)
    if not kinds or kinds[-1] not in KINDS or where is None or quantity.low is None:
        return
    group = BuildingGroup(kinds[-1], where.part, where.near, round(where.within))
    if group.is_known:
        found.add(f"{group.text}.count.min", quantity.low, item, *behind, *where.words)


def _leave_some_of_them(
    found: Findings, items: Sequence[Item], syntax: Syntax, at: int, one: _Said
) -> None:
    """Leave what is said of some of a group: "20 houses along the river, | five of them white".

    So are those elsewhere that have a number alone: "20 houses in the north, | 20 in the south".
    """
    item, behind = items[at], items[at + 1 : at + 3]
    quantity = item.quantity
    if item.state or not behind or (quantity is None and not item.has("amount", "some")):
        return
    if quantity is not None and quantity.dimension not in ("count", "part", "share"):
        return
    them = len(behind) > 1 and (behind[0].get("rel") == "of" and behind[1].text in _THEM)
    end, own = end_of(items, at, ENDS + ",:"), syntax.head_behind(at) >= 0
    if them or behind[0].text == "of them":
        told = items[at:end]
    elif quantity is not None and not own and (behind[0].text == "with" or behind[0].has(*_LOOKS)):
        told = items[at:end]  # "ten with red roofs", "ten white"
    elif _where(items, at + 1) is not None:
        told = [n for n in items[at:end] if not (n.has("noun") and _is_somewhere(n))]
    else:
        return
    for word in told:
        word.state = word.state or READ
    found.leave_span((item.span[0], items[end - 1].span[1]), f"some of the {one.head.noun}s alone")


def _said_of(items: Sequence[Item], syntax: Syntax, at: int, states: Sequence[str]) -> _Said | None:
    """Return what is said of the buildings of a head, None where it is none of a known kind."""
    head, phrase = items[at], syntax.phrase(at)
    if phrase is None or phrase.head != at or head.noun_class != "type" or not head.has("noun"):
        return None
    if head.noun not in KINDS or not is_plural(head.words[-1]) or head.state not in states:
        return None
    if _is_spoken_of(items, phrase.first):
        return None
    one = _Said(head, phrase.first, at + 1)
    for n in range(phrase.first, phrase.head):
        item = items[n]
        if item.text in _ADDING:
            continue
        if item.state not in states or item.has("neg") or item.kind == "unknown":
            return None
        if item.quantity is not None and item.quantity.dimension == "count":
            one.number = item
        elif not _look(items, syntax, n, one) and item.has(*_OTHER_LOOKS):
            return None
    one.stated = items[phrase.first].text == "the"
    before = _where_before(items, one, states)
    if not _read_behind(items, syntax, one, states, before):
        return None
    one.where = one.where or before
    if any(item.text in ("was", "were") for item in items[one.end : one.end + 1]):
        return None  # "20 houses near the lake | were flooded"
    if one.every and _is_last_of_a_list(items, syntax, phrase):
        return None
    return one


def _is_last_of_a_list(items: Sequence[Item], syntax: Syntax, phrase: Phrase) -> bool:
    """Return whether "all" are others too: "60 houses and | 20 villas, all near the lake"."""
    k = phrase.first - 1
    if k < 1 or not (items[k].is_mark(",") or items[k].get("rel") == "and"):
        return False
    if items[k].get("rel") == "and" and items[k - 1].is_mark(","):
        k -= 1
    listed = syntax.phrase(k - 1)
    head = items[listed.head] if listed is not None and listed.head >= 0 else None
    return head is not None and head.noun in KINDS and is_plural(head.words[-1])


def _is_spoken_of(items: Sequence[Item], first: int) -> bool:
    """Return whether buildings are only spoken of: "I live in one of | 20 houses", "my | houses".

    So are those that something else is for or leads to ("a bridge for | 20 houses"), and those
    that others did something to or that were once.
    """
    if items[first].text == "which":
        return False  # "a town in | which 30 houses stand at the river"
    last = items[first - 1] if first else None
    if last is not None and (last.text in _ABOUT or _is_one_of(items, first)):
        return True
    if items[first].text in _OWNED:
        return True
    begin, end = begin_of(items, first, ENDS + ","), end_of(items, first, ENDS + ",")
    clause = items[begin:first]
    words = [item.text for item in clause]
    done = any(
        one.text in _USERS and two.kind == "unknown" and two.text not in _WISHING
        for one, two in pairwise(clause)
    )
    stand = any(item.text in _SAYING or item.get("mode") == "stand" for item in items[first:end])
    return done or not _NOT_NOW.isdisjoint(words) or ("where" in words and not stand)


def _is_one_of(items: Sequence[Item], first: int) -> bool:
    """Return whether a number stands before buildings: "one of | 20 houses"."""
    if first < 2 or items[first - 1].get("rel") != "of":
        return False
    quantity = items[first - 2].quantity
    return quantity is not None and quantity.dimension in ("count", "part", "share")


def _one_place(first: _Where | None, then: _Where) -> _Where | None:
    """Return both places as one: "in the north | near the river"; None where it is none."""
    if first is None:
        return then
    if not first.part or first.near or not then.near:
        return None
    return replace(then, part=first.part, words=(*first.words, *then.words))


def _read_behind(
    items: Sequence[Item],
    syntax: Syntax,
    one: _Said,
    states: Sequence[str],
    before: _Where | None,
) -> bool:
    """Read where the buildings stand and how they look, behind their head.

    Returns
    -------
    bool
        Whether it is certain where they stand.
    """
    k, apart_at = one.end, -1  # the mark behind which something else may begin
    while k < len(items) and not items[k].is_mark(ENDS + ":"):
        item = items[k]
        if item.state not in states:
            return True
        after = items[k + 1].quantity if k + 1 < len(items) else None
        if item.has("neg") and after is not None and after.dimension == "floors":
            if after.low is not None:
                return True
            k += 1  # "no | higher than two floors"
            continue
        if item.text == "in" and (rows := _in_rows(items, k)):
            k = rows
            continue
        where = _where(items, k)
        new = where is not None and (apart_at >= 0 or _is_joined(items, k))
        if new and where is not None and not _ends(items, where.end):
            return True  # "40 houses, in the north | a park"
        if where is not None:
            if one.where is not None and one.where.near:
                return True  # "near the station | in the north": that is of the station
            both = _one_place(one.where or before, where)
            if both is None or _goes_on(items, syntax, where):
                return False
            one.where, k = both, where.end
            one.end = k
            continue
        owner = syntax.head_behind(k)
        apart = owner >= 0 and items[owner] is not one.head
        apart &= items[owner].noun not in _OF_HOUSES
        apart &= not (item.get("slot").startswith("building.roof") or _few_storeys(items, k))
        if item.text not in (*_LINKS, *_ADDING) and apart:
            return True
        if _look(items, syntax, k, one):
            one.end = max(one.end, k + 1)
        elif _few_storeys(items, k):
            low, _, high = item.get("some").partition("-")
            one.floors.append((float(low), float(high), (item, items[k + 1])))
            k += 1
            one.end = k + 1
        elif item.noun in _OF_HOUSES:
            one.end = k + 1
        elif not (
            item.is_mark(",()") or item.kind == "function" or item.text in (*_LINKS, "added")
        ):
            return True
        one.stated |= item.get("rel") == "be" or item.text in ("are", "have", "has")
        one.every |= item.text in _ALL and one.where is None
        if item.is_mark(",("):
            apart_at = k
        elif item.is_mark(")") or item.text in _SAYING:
            apart_at = -1
        k += 1
    return True


def _is_joined(items: Sequence[Item], k: int) -> bool:
    """Return whether "and" stands before an item."""
    return k > 0 and items[k - 1].get("rel") == "and"


def _ends(items: Sequence[Item], k: int) -> bool:
    """Return whether a sentence ends before an item."""
    return k >= len(items) or items[k].is_mark(ENDS)


def _goes_on(items: Sequence[Item], syntax: Syntax, where: _Where) -> bool:
    """Return whether a place is of another, or one of a list: "near the church | and the school".

    "Along the river and a church" is no list: what is new begins with another article.
    """
    k = where.end
    if k < len(items) and items[k].get("rel") == "of":
        return True
    if not where.near or k + 1 >= len(items) or items[k].get("rel") not in ("and", "or"):
        return False
    second = _where(items, k + 1)
    if second is not None:
        return second.end >= len(items) or items[second.end].kind == "mark"
    phrase = syntax.phrase(k + 1)
    if phrase is None or phrase.head < 0 or items[phrase.first].quantity is not None:
        return False
    if is_plural(items[phrase.head].words[-1]) or not _is_somewhere(items[phrase.head]):
        return False
    new = ("a", "an")
    before = next((one.text for one in reversed(items[: k - 1]) if one.kind == "function"), "")
    return items[phrase.first].text not in new or before in new


def _in_rows(items: Sequence[Item], k: int) -> int:
    """Return the item behind "in a | row", which is left open, 0 where there is none."""
    for n in range(k + 1, min(k + 3, len(items))):
        if items[n].text in ("row", "rows", "line", "lines"):
            return n + 1
    return 0


def _few_storeys(items: Sequence[Item], k: int) -> bool:
    """Return whether "one or | two storeys" begins at an item."""
    after = items[k + 1].text if k + 1 < len(items) else ""
    return "-" in items[k].get("some") and after in _STOREYS


def _look(items: Sequence[Item], syntax: Syntax, k: int, one: _Said) -> bool:
    """Take what an item says of how buildings look, or how many storeys they have."""
    item = items[k]
    roof = item.get("slot").removeprefix("building.roof=")
    owner = syntax.head_behind(k)
    of_roof = owner >= 0 and (
        items[owner].noun == "roof" or items[owner].get("slot").startswith("building.roof=")
    )
    if item.get("slot").startswith("building.roof=") and "=" not in roof and " " not in roof:
        one.looks.append(("roof", roof, item))
    elif item.has("noun") and not item.has("material"):
        return False
    elif item.has("color"):
        one.looks.append(("roof_color" if of_roof else "color", item.get("color"), item))
        if item.has("material"):
            one.looks.append(("material", item.get("material"), item))
    elif item.has("material") and not of_roof:
        one.looks.append(("material", item.get("material"), item))
    elif item.quantity is not None and item.quantity.dimension == "floors":
        if item.quantity.relative:
            return False
        one.floors.append((item.quantity.low, item.quantity.high, (item,)))
    else:
        return False
    return True


def _where_behind(items: Sequence[Item], first: int) -> _Where | None:
    """Return where something stands, past words that only link it."""
    for k in range(first, min(first + 3, len(items))):
        where = _where(items, k)
        if where is not None:
            return where
        if items[k].text not in _LINKS and items[k].kind != "function":
            return None
    return None


def _where_before(items: Sequence[Item], one: _Said, states: Sequence[str]) -> _Where | None:
    """Return the place that a clause begins with: "in the south there are | 14 cottages"."""
    starts = [begin_of(items, one.first, ENDS + marks) for marks in (",:", ",")]
    joints = [n for n in range(starts[0], one.first) if items[n].get("rel") == "and"]
    starts = [*(joint + 1 for joint in joints[-1:]), *starts]
    found = [(k, where) for k in starts if (where := _where(items, k) or _half(items, k))]
    if not found or found[0][1].end > one.first:
        return None
    first, where = found[0]
    between = items[where.end : one.first]
    plain = all(
        item.kind == "function"
        or item.text in (*_LEADING, *_ADDING)
        or item.get("mode") == "stand"
        or item.is_mark(":")
        for item in between
    )
    if not plain or any(item.state not in states for item in items[first : one.first]):
        return None
    one.first = first
    return replace(where, words=(*where.words, *(i for i in between if i.text in _LEADING)))


def _where(items: Sequence[Item], k: int) -> _Where | None:
    """Return the place whose words begin at an item."""
    item = items[k] if k < len(items) else None
    if item is None:
        return None
    quantity = item.quantity
    if quantity is not None:
        bound = quantity.dimension == "length" and quantity.low is None and not quantity.attribute
        if not bound or quantity.high is None or not 1.0 <= quantity.high <= FARTHEST:
            return None
        return _near(items, k + 1, quantity.high, (item,), told=True)
    middle = not {"middle", "center", "centre"}.isdisjoint(item.words)
    if item.words[-1] == "of" and (middle or not set(OUTSKIRTS).isdisjoint(item.words)):
        return _whole(items, k + 1, "center" if middle else "edge", (item,), of=True)
    if middle and item.get("rel") in ("in", "near") and not _is_of_another(items, k + 1):
        return _Where(k + 1, part="center", words=(item,))
    if item.get("rel") in ("near", "along", "around") or item.text in BESIDES:
        near = _near(items, k + 1, BESIDE, (item,))
        if near is not None and (item.text != "on" or near.near in AT_FRONTS):
            return near
    if item.get("rel") in ("in", "on", "to") or item.text in ("in", "at", "on", "to"):
        return _part(items, k)
    return None


def _near(
    items: Sequence[Item], k: int, within: float, words: tuple[Item, ...], *, told: bool = False
) -> _Where | None:
    """Return a place or an element that something stands near, by the next noun."""
    for n in range(k, min(k + _PLACE_REACH, len(items))):
        item = items[n]
        if item.kind == "mark" or item.quantity is not None:
            return None
        if item.text in ("it", *_BANKS) and not item.noun:
            place = _meant(items, item)
            if not place:
                return None
            return _Where(n + 1, near=place, within=within, words=(*words, item), told=told)
        if item.noun and item.has("noun"):
            if not _is_somewhere(item) or is_plural(item.words[-1]):
                return None
            own = (item,) if item.noun_class == "road" else ()
            return _Where(n + 1, near=item.noun, within=within, words=(*words, *own), told=told)
        link = item.kind == "function" or item.text in (*_ARTICLES, "both") or (
            item.get("rel") in ("of", "from", "to", "along", "near")
        )  # fmt: skip
        if not link:
            return None  # one of its own: "near St Mary's | church", "on the north | bank"
    return None


def _meant(items: Sequence[Item], item: Item) -> str:
    """Return the place that "it" is, or the one water of a text whose bank is meant."""
    if item.text == "it":
        before = [one.noun for one in items if one.span < item.span and _is_somewhere(one)]
        return before[-1] if before else ""
    waters = {one.noun for one in items if one.has("noun") and one.noun in _WATERS}
    river = any("terrain=valley" in one.get("slot") for one in items)
    return waters.pop() if len(waters) == 1 else "river" if river and not waters else ""


def _is_somewhere(item: Item) -> bool:
    known = item.noun in ELEMENTS or item.noun in PLACES
    return known and item.noun_class in ("element", "road", "place", "type") and (
        item.noun != "center" and item.has("noun")
    )  # fmt: skip


def _part(items: Sequence[Item], k: int) -> _Where | None:
    """Return the part of a town behind a preposition: "in the north", "at the edge"."""
    for n in range(k + 1, min(k + 5, len(items))):
        item = items[n]
        if item.has("side") and is_of_another(items, n):
            return None
        if item.has("side"):
            if n + 1 < len(items) and items[n + 1].text.removesuffix(" of") in _PIECES:
                return _half(items, k + 1)
            return _whole(items, n + 1, item.get("side"), items[k : n + 1])
        if item.noun == "center" or item.text in ("middle", "centre"):
            return _whole(items, n + 1, "center", items[k : n + 1])
        if item.text in OUTSKIRTS:
            return _whole(items, n + 1, "edge", items[k : n + 1])
        if item.text not in _ARTICLES and item.kind != "function":
            return None
    return None


def _half(items: Sequence[Item], k: int) -> _Where | None:
    """Return "the western half of the town"."""
    first = k
    while k < len(items) and items[k].text in _ARTICLES:
        k += 1
    if k + 1 >= len(items) or not items[k].has("side"):
        return None
    piece = items[k + 1]
    half = piece.text in _PIECES or piece.text.removesuffix(" of") in _PIECES
    if not half:
        return None
    whole = k + 2
    if piece.text.endswith(" of"):
        whole = k + 1  # "half of | the town"
    found = _whole(items, whole + (piece.text.endswith(" of")), items[k].get("side"),
                   items[first : k + 2], of=piece.text.endswith(" of"))  # fmt: skip
    if found is None:
        return None
    half = piece.words[0] == "half" and found.part in SIDES
    return replace(found, told=True, part=f"{found.part}_half" if half else found.part)


def _whole(
    items: Sequence[Item], k: int, part: str, words: Sequence[Item], *, of: bool = False
) -> _Where | None:
    """Return a part of the town, None where it is a part of something else."""
    if not of and (k >= len(items) or items[k].get("rel") != "of"):
        edge = items[k] if k < len(items) else None
        if (
            edge is not None
            and edge.text in (*_PIECES, *OUTSKIRTS)
            and part not in ("center", "edge")
        ):
            return _whole(items, k + 1, part, (*words, edge))
        if edge is not None and not _is_beside(edge):
            return None  # "the west | wing", "the south | coast"
        return _Where(k, part=part, words=_content(words))
    n = k if of else k + 1
    while n < len(items) and items[n].text in _ARTICLES:
        n += 1
    if n < len(items) and _is_a_town(items[n]):
        return _Where(n + 1, part=part, words=_content(words))
    return None


def _is_a_town(item: Item) -> bool:
    return item.noun in _TOWNS or item.get("slot") == "district=village"


def _is_beside(item: Item) -> bool:
    """Return whether an item stands behind a part of a town, and is no noun that it is of."""
    if item.kind in ("mark", "function") or item.quantity is not None or item.has("rel", "neg"):
        return True
    if item.has("mode", "verb", "color", "material", "amount") or item.text in _LEADING:
        return True
    return item.noun_class == "type" and is_plural(item.words[-1])


def _content(words: Sequence[Item]) -> tuple[Item, ...]:
    return tuple(item for item in words if item.kind != "function" or item.text in OUTSKIRTS)


def _is_of_another(items: Sequence[Item], k: int) -> bool:
    """Return whether "in the middle" is that of something: "in the middle | of the square"."""
    if k >= len(items) or items[k].get("rel") != "of":
        return False
    behind = items[k + 1 : k + 4]
    return not any(_is_a_town(one) for one in behind)
