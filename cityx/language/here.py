"""Here: one item of an instruction with its context, and what was read so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from cityx.language.brief import Note, Slot, Value
from cityx.language.lexicon.phrases import NOUNS
from cityx.language.scan import ENDS, Item, Quantity
from cityx.language.scopes import READ
from cityx.town.elements import ELEMENTS

BUILDINGS = ("building", "type")
COUNTED = {"plant": "tree", "person": "pedestrian"}  # class of a noun -> what is counted
ROADS = {
    "main_street": "roads.main", "avenue": "roads.main", "side_street": "roads.other",
    "road": "roads", "ring_road": "roads.ring", "motorway": "roads.motorway",
}  # fmt: skip
# Of these a singular is one thing in the city, and no type that most buildings have.
LANDMARKS = (
    *(name for name, element in ELEMENTS.items() if element.building and not element.common),
    "station", "monument",
)  # fmt: skip
_ADJECTIVES = (
    "material", "color", "size", "height", "width", "slot", "strength", "rank", "exact", "approx",
    "attr", "ordinal",
)  # fmt: skip
_LINKS = ("of", "more", "green", "all")  # between an adjective and its noun
_REACH, _AROUND = 5, 12  # items from "every" to its noun, and to a look that is of each
_FAR, _NEAR = 8, 5  # items between a quantity and the noun it measures: before it, behind it


@dataclass
class Findings:
    """What has been read so far; it grows while the items are walked over."""

    text: str
    slots: list[Slot] = field(default_factory=list)
    kept: list[Slot] = field(default_factory=list)
    negated: list[Slot] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)

    def add(self, key: str, value: Value, *items: Item, every: bool = False) -> None:
        """Take a slot that some items say; they count as read."""
        for item in items:
            item.state = item.state or READ
        first = min(item.span[0] for item in items)
        last = max(item.span[1] for item in items)
        if isinstance(value, float):
            value = int(value) if value == int(value) else round(value, 4)
        _add_once(self.slots, Slot(key, value, (first, last), self.text[first:last], every))

    def add_bounded(self, key: str, quantity: Quantity, *items: Item) -> None:
        """Take a slot for a value, or one for each bound."""
        if quantity.exact is not None:
            self.add(key, quantity.exact, *items)
            return
        for end, value in (("min", quantity.low), ("max", quantity.high)):
            if value is not None:
                self.add(f"{key}.{end}", value, *items)

    def deny(self, value: str, item: Item) -> None:
        """Take something that must not be there."""
        _add_once(self.negated, Slot("not", value, item.span, self.said(item)))

    def keep(self, value: str, item: Item) -> None:
        """Take something that must stay as it is."""
        _add_once(self.kept, Slot("keep", value, item.span, self.said(item)))

    def leave(self, item: Item, about: str) -> None:
        """Note a word that is understood but that nothing measures."""
        item.state = READ
        said = f'"{self.said(item)}" ({about}) has no measure and is left open.'
        self.notes.append(Note("left_open", said, item.span))

    def said(self, item: Item) -> str:
        """Return an item in the words of the text."""
        return self.text[slice(*item.span)]


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
    """

    found: Findings
    items: Sequence[Item]
    at: int

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

    def of_every_building(self) -> bool:
        """Return whether the context is about each building: "every house of brick"."""
        near = self.clause(_AROUND)
        for at, item in enumerate(near):
            if item.noun == "everything":
                return True
            if item.get("rel") not in ("all", "every") or item.state not in ("", READ):
                continue
            behind = (after for after in near[at + 1 : at + _REACH] if after.noun)
            if (noun := next(behind, None)) is not None and noun.noun_class in BUILDINGS:
                return True
        return False

    def noun(self) -> Item | None:
        """Return the noun that a measure belongs to: the one behind it, else the one before."""
        return self.noun_behind() or self.noun_before()

    def noun_behind(self) -> Item | None:
        """Return the noun that a word before it belongs to: "brick | three-storey houses"."""
        for item in self.items[self.at + 1 : self.at + 1 + _NEAR]:
            if item.is_mark(ENDS + ",():"):
                return None
            if item.noun and item.noun not in ("light", "center", "sky") and item.text != "flat":
                return item if item.state in ("", READ) else None
            passes = item.has(*_ADJECTIVES) or item.kind in ("function", "quantity", "unknown")
            passes = (passes and not item.has("rel")) or item.is_mark("-")
            if item.has("bound") or not (passes or item.get("rel") in _LINKS):
                return None
        return None

    def noun_before(self, far: int = _FAR) -> Item | None:
        """Return the noun a measure behind it belongs to: "towers | up to 300 m"."""
        for item in reversed(self.items[max(0, self.at - far) : self.at]):
            if item.is_mark(ENDS + ","):
                return None
            if item.noun and item.noun not in ("city", "center", "sky") and item.text != "flat":
                return item if item.state in ("", READ) else None
        return None

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
