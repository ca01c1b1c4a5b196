"""Here: one item of an instruction with its context, and what was read so far."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from cityx.language.brief import Note, Slot, Span, Value
from cityx.language.lexicon.phrases import AMBIGUOUS, NOUNS
from cityx.language.lexicon.words import forms_of
from cityx.language.measurable import things
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import READ
from cityx.language.syntax import Syntax, is_plural
from cityx.town.elements import ATTRIBUTES, ELEMENTS, OTHER_THINGS, attributes_of, has_none
from cityx.town.quarter_kinds import KINDS

BUILDINGS = ("building", "type")
COUNTED = {"plant": "tree", "person": "pedestrian"}  # class of a noun -> what is counted
KINDS_OF_PEOPLE = ("child", "elder", "wheelchair", "pram", "runner")  # counted by themselves
ROLES = ("steward", "officer")  # people who are told by what they do and have on
ROADS = {
    "main_street": "roads.main", "avenue": "roads.main", "side_street": "roads.other",
    "road": "roads", "ring_road": "roads.ring", "motorway": "roads.motorway",
}  # fmt: skip
PLOTS = ("plot", "plots", "lot", "lots", "parcel", "parcels")
# Of these a singular is one thing in the city, and no type that most buildings have.
LANDMARKS = (
    *(name for name, element in ELEMENTS.items() if element.building and not element.common),
    "station", "monument",
)  # fmt: skip
_THINGS = ("element", "plant", "vehicle", "person", "road")
SIDES_OF_A_VIEW = ("right", "left", "top", "bottom")  # of a picture, not of a city
FEW, MANY = 4.0, 1e9  # barns, factories... so many stand among other houses, however it is said
AIR = ("weather=", "time=", "season=")  # slots of the sky, which is no place
SEVERAL = 2  # of what is told in the plural, without a number
DESCRIBING = ("ed", "ly", "al", "ful", "ous", "ic", "ive")  # ends of words for how things are
_HAVE = ("with", "has", "have", "having")
_REACH, _AROUND = 5, 12  # items from "every" to its noun, and to a look that is of each


def is_of_a_town(item: Item) -> bool:
    """Return whether an item speaks of a town or of buildings."""
    return item.noun == "city" or "district=" in item.get("slot") or item.noun_class in BUILDINGS


@dataclass
class Findings:
    """What has been read so far; it grows while the items are walked over."""

    text: str
    mapped: bool = False
    slots: list[Slot] = field(default_factory=list)
    kept: list[Slot] = field(default_factory=list)
    negated: list[Slot] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)
    presumed: list[Slot] = field(default_factory=list)
    added: set[str] = field(default_factory=set)  # kinds of which commands bring more

    def add(self, key: str, value: Value, *items: Item, every: bool = False) -> None:
        """Take a slot that some items say; they count as read."""
        for item in items:
            item.state = item.state or READ
        first = min(item.span[0] for item in items)
        last = max(item.span[1] for item in items)
        if isinstance(value, float):
            value = int(value) if value == int(value) else round(value, 4)
        mostly = not every and bool(_MOSTLY.search(self.text[max(first - _NEAR, 0) : first]))
        _add_once(self.slots, Slot(key, value, (first, last), self.text[first:last], every, mostly))

    def add_bounded(self, key: str, quantity: Quantity, *items: Item) -> None:
        """Take a slot for a value, or one for each bound."""
        if quantity.exact is not None:
            self.add(key, quantity.exact, *items)
            return
        for end, value in (("min", quantity.low), ("max", quantity.high)):
            if value is not None:
                self.add(f"{key}.{end}", value, *items)

    def presume(self, key: str, value: Value, item: Item) -> None:
        """Take a slot that a text takes for granted; it goes where the text says more."""
        self.presumed.append(Slot(key, value, item.span, self.said(item)))

    def settle_presumed(self) -> None:
        """Take what is taken for granted of kinds that nothing else tells of."""
        told = {kind for slot in self.slots for kind in (_told_kind(slot.key), str(slot.value))}
        for slot in self.presumed:
            if slot.key.partition(".")[0] not in told:
                _add_once(self.slots, slot)

    def has(self, key: str) -> bool:
        """Return whether a slot was taken."""
        return any(slot.key == key for slot in self.slots)

    def deny(self, value: str, item: Item) -> None:
        """Take something that must not be there."""
        _add_once(self.negated, Slot("not", value, item.span, self.said(item)))

    def keep(self, value: str, item: Item) -> None:
        """Take something that must stay as it is."""
        _add_once(self.kept, Slot("keep", value, item.span, self.said(item)))

    def leave(self, item: Item, about: str) -> None:
        """Note a word that is understood but that nothing measures."""
        item.state = READ
        self.leave_span(item.span, about)

    def leave_span(self, span: Span, about: str) -> None:
        """Note words that are understood but that nothing measures."""
        said = f'"{self.text[slice(*span)]}" ({about}) has no measure and is left open.'
        note = Note("left_open", said, span, about=about)
        if note not in self.notes:
            self.notes.append(note)

    def leave_look(self, item: Item, of: Item) -> None:
        """Note what a thing looks like that nothing measures."""
        self.leave(item, f"look of the {self.said(of)}")

    def refuse(self, item: Item, kind: str, attribute: str) -> None:
        """Note that something is said of a thing that it does not have."""
        item.state = READ
        note = Note("left_open", f'"{self.said(item)}": {has_none(kind, attribute)}', item.span)
        if note not in self.notes:
            self.notes.append(note)

    def said(self, item: Item) -> str:
        """Return an item in the words of the text."""
        return self.text[slice(*item.span)]


def _told_kind(key: str) -> str:
    """Return the kind of which a key says more than what an element looks like."""
    kind, _, rest = key.partition(".")
    looks = kind in ELEMENTS and rest.partition(".")[0] in ATTRIBUTES
    return "" if looks else kind


_NEAR = 40  # letters before a word that may say of how many it is told
_MOSTLY = re.compile(
    r"\b(?:mostly|mainly|largely|predominantly|chiefly|primarily|most|many|often|usually|generally|"
    r"typically|partly|some|several|few|a lot of|lots of|plenty of|majority of|mixture(?: of)?|"
    r"mix(?:ed)?(?: of)?|"
    r"sometimes|here and there|the odd|occasional)\b"
    r"(?:\W+(?!(?:and|but|or|with|over|while)\b)[^\W\d]+){0,2}\W*$",  # of the same things
    re.IGNORECASE,
)


def _add_once(slots: list[Slot], slot: Slot) -> None:
    if not any((one.key, one.value) == (slot.key, slot.value) for one in slots):
        slots.append(slot)


@dataclass(frozen=True)
class Here:
    """An item in its place.

    Attributes
    ----------
    found
        What has been read so far.
    items, at
        All items, and the index of this one.
    syntax
        The noun phrases of the items.
    """

    found: Findings
    items: Sequence[Item]
    at: int
    syntax: Syntax

    @property
    def item(self) -> Item:
        """The item itself."""
        return self.items[self.at]

    @property
    def quantity(self) -> Quantity:
        """The quantity of the item, which must have one."""
        assert self.item.quantity is not None
        return self.item.quantity

    @property
    def before(self) -> Item | None:
        """The item before."""
        return self.items[self.at - 1] if self.at else None

    @property
    def after(self) -> Item | None:
        """The item behind."""
        return self.items[self.at + 1] if self.at + 1 < len(self.items) else None

    def clause(self, far: int = 10_000) -> list[Item]:
        """Return the items between the commas around this one, so far at most."""
        first = last = self.at
        begin, end = max(0, self.at - far), min(len(self.items), self.at + far)
        while first > begin and not self.items[first - 1].is_mark(ENDS + ","):
            first -= 1
        while last < end and not self.items[last].is_mark(ENDS + ","):
            last += 1
        return list(self.items[first:last])

    def before_in_clause(self) -> list[Item]:
        """Return the items before this one in its clause."""
        return [one for one in self.clause() if one.span < self.item.span]

    def of_every_building(self) -> bool:
        """Return whether the context is about each building: "every house of brick"."""
        near = self.clause(_AROUND)
        for at, item in enumerate(near):
            if item.noun == "everything":
                return True
            if item.get("rel") not in ("all", "every") or item.state not in ("", READ):
                continue
            behind = (after for after in near[at + 1 : at + _REACH] if after.noun)
            noun = self._each_of(near, at) or next(behind, None)
            if noun is not None and noun.noun_class in BUILDINGS:
                return True
        return False

    def _each_of(self, near: Sequence[Item], at: int) -> Item | None:
        """Return what "every one", "each" and "all of them" are of, told before in its sentence."""
        after = near[at + 1].text if at + 1 < len(near) else ""
        if after not in ("", "one", "of", "has", "have", "with", "having"):
            return None
        before = self.items[: self.syntax.index(near[at])]
        ends = next((n for n, one in enumerate(reversed(before)) if one.is_mark(ENDS)), len(before))
        named = [one for one in before[len(before) - ends :] if one.noun_class in BUILDINGS]
        return named[-1] if named and is_plural(named[-1].words[-1]) else None

    def noun(self) -> Item | None:
        """Return the noun that a measure belongs to: the one behind it, else the one before."""
        return self.noun_behind() or self.noun_before()

    def noun_behind(self) -> Item | None:
        """Return the noun that a word before it belongs to: "brick | three-storey houses"."""
        return self._named(self.syntax.head_behind(self.at), ("light", "center", "sky"))

    def noun_before(self) -> Item | None:
        """Return the noun a measure behind it belongs to: "towers | up to 300 m"."""
        if (several := self._of_each()) is not None:
            return several
        return self._named(self.syntax.head_before(self.at), ("city", "center", "sky"))

    def _of_each(self) -> Item | None:
        """Return what was counted before ", each": "ten towers by a lake, each | 60 m high"."""
        first = self.at
        while first and self.items[first - 1].has("bound", "approx"):
            first -= 1
        if first < 2 or self.items[first - 1].text != "each" or not (
            self.items[first - 2].is_mark(",")
        ):  # fmt: skip
            return None
        for at in range(first - 2, -1, -1):
            if self.items[at].is_mark(ENDS):
                return None
            quantity, head = self.items[at].quantity, self.syntax.head_behind(at)
            if quantity is not None and quantity.dimension == "count" and head > at:
                return self._named(head, ())
        return None

    def _named(self, head: int, but: Sequence[str]) -> Item | None:
        item = self.items[head] if head >= 0 else None
        if item is None or not item.noun or item.noun in but or item.text == "flat":
            return None
        return item if item.state in ("", READ) else None

    def owner(self, *, past_comma: bool = False) -> Item | None:
        """Return the head that the item belongs to, whatever it is; None where it is alone."""
        head = self.syntax.owner(self.at, past_comma=past_comma)
        return self.items[head] if head >= 0 else None

    def phrase_of(self, head: Item) -> Sequence[Item]:
        """Return the items of the phrase that a head is the head of."""
        at = self.syntax.index(head)
        phrase = self.syntax.phrase(at)
        return (head,) if phrase is None else self.items[phrase.first : phrase.end]

    def is_another_kind(self, noun: Item) -> bool:
        """Return whether the word before makes another thing of a noun: "pumping station"."""
        if noun.noun_class == "road":
            return any(one.noun_class == "vehicle" for one in self.phrase_of(noun))
        forms = forms_of(noun.words[-1])
        many = noun.noun_class == "type" and is_plural(noun.words[-1])
        if AMBIGUOUS.isdisjoint(forms) or not noun.has("noun"):
            return False
        phrase = self.phrase_of(noun)
        at = phrase.index(noun)
        before = phrase[at - 1] if at else noun
        if before.is_mark("-"):
            before = phrase[at - 2]
        verb = before.has("verb", "mode") and not before.has("slot", "rel")
        unknown = before.kind == "unknown" and not before.words[-1].endswith(DESCRIBING)
        if many:  # "pile houses" are houses, "cooling towers" and "water stations" are none
            doing = unknown and before.words[-1].endswith("ing")
            return doing or (before is not noun and before.has("noun") and noun.noun in LANDMARKS)
        return before is not noun and (unknown or before.has("noun") or verb)

    def is_a_single(self, noun: Item) -> bool:
        """Return whether one of a kind is told of: "a town with a four-lane road"."""
        if is_plural(noun.words[-1]):
            return False
        at = self.syntax.index(noun)
        for one in reversed(self.items[max(at - _REACH, 0) : at]):
            if one.text in ("a", "an"):
                return True
            if one.kind == "mark" or one.has("rel", "noun", "neg"):
                return False
        return False

    def is_some_kind(self, noun: Item) -> bool:
        """Return whether an unknown noun says which buildings are meant: "six lecture halls"."""
        before = [one for one in self.phrase_of(noun) if one.span < noun.span]
        return bool(before) and before[-1].kind == "unknown" and (
            not before[-1].words[-1].endswith((*DESCRIBING, "y", "ing"))
        )  # fmt: skip

    def part_of_one(self, noun: Item) -> Item | None:
        """Return the one building that counted towers are part of: "a church with | two towers"."""
        if noun.noun_class != "type":
            return None
        phrase = self.syntax.phrase(self.syntax.index(noun))
        first = 0 if phrase is None else phrase.first
        if first > 1 and self.items[first - 1].get("rel") == "and":  # "four gates and | towers"
            listed = self.syntax.phrase(first - 2)
            first = first if listed is None else listed.first
        if not first or not self.items[first - 1].text.endswith(_HAVE):
            return None
        whole = self.syntax.head_before(first)
        owner = self.items[whole] if whole >= 0 else None
        if owner is not None and owner.noun in ("city_wall", "facade"):
            return owner if noun.noun == "tower" else None
        one = owner is not None and owner.noun_class == "type" and owner.noun in LANDMARKS
        one = one and owner is not None and noun.noun in ("tower", owner.noun)
        return owner if one and owner is not None and self.of_one_thing(owner) else None

    def of_one_thing(self, owner: Item) -> bool:
        """Return whether a head is one thing among others, and not what the buildings are."""
        if owner.noun_class not in ("type", *_THINGS):
            return False
        if owner.noun_class != "type":
            return True
        if owner.noun in LANDMARKS and not is_plural(owner.text):
            return True
        first = self.phrase_of(owner)[0]
        if first.text == "the" and not is_plural(owner.text):
            return True
        one = first.text in ("a", "an", "one") or "single" in first.words
        few = first.quantity is not None and (first.quantity.high or MANY) <= FEW
        others = any(item is not owner and is_of_a_town(item) for item in self.items)
        one = one and not is_plural(owner.text)
        return others and (one or (few and owner.noun in ELEMENTS))

    def of_a_kind(self, owner: Item) -> bool:
        """Return whether a head is a kind that stands among others: "twelve white | hotels"."""
        built = owner.noun in ELEMENTS and bool(ELEMENTS[owner.noun].building)
        return owner.noun_class == "type" and built and owner.noun not in KINDS

    def takes(self, owner: Item, attribute: str) -> bool:
        """Return whether something can be said of a thing: its colour, how long it is, ..."""
        known = owner.noun in ELEMENTS or owner.noun in OTHER_THINGS
        if not known:
            return self.has_looks(owner)
        own = owner.state in ("", READ) and owner.has("noun") and not self.is_another_kind(owner)
        return own and attribute in attributes_of(owner.noun)

    def has_looks(self, owner: Item) -> bool:
        """Return whether the looks and measures of a kind of building are measured by itself."""
        built = owner.noun in ELEMENTS or not self.of_one_thing(owner)
        measured = things(owner.noun).startswith("building, ")
        return built and measured and owner.state in ("", READ)

    def of_some(self, owner: Item) -> bool:
        """Return whether a head is one of several types of building, each with its own look."""
        if owner.noun_class != "type":
            return False
        if self.of_one_thing(owner):
            return True
        at = self.syntax.index(owner)
        return any(
            one.noun_class == "type" and one.noun != owner.noun and one.noun not in LANDMARKS
            and one.state in ("", READ) and one.has("noun") and not self.of_one_thing(one)
            and self.syntax.modifies(other) < 0 and not self.syntax.joined(at, other)
            for other, one in enumerate(self.items)
        )  # fmt: skip

    def noun_past_comma(self) -> Item | None:
        """Return the noun of "a canal instead of a river, | 12 m wide"."""
        if self.before is None or not self.before.is_mark(","):
            return None
        return self._last("element", "road", far=False)

    def buildings_before(self, *, past_end: bool) -> Item | None:
        """Return the buildings a count behind them is of: "warehouses, please; | ten of them"."""
        return self._last(*BUILDINGS, far=past_end)

    def element_before(self) -> Item | None:
        """Return the elements of "three parks, each | of 1 ha"."""
        return self._last("element", far=False)

    def last_noun(self) -> Item | None:
        """Return the noun before this item in its sentence, past commas."""
        return self._last(*NOUNS, far=False)

    def _last(self, *classes: str, far: bool) -> Item | None:
        for item in reversed(self.items[: self.at]):
            if item.is_mark(ENDS) and not far:
                return None
            if item.noun_class in classes and item.state in ("", READ):
                return item
        return None
