"""Windows: what of a map is to be built: "only the middle 400 x 400 m", "crop to 200 m"."""

from __future__ import annotations

from cityx.language.brief import Note
from cityx.language.clauses import is_an_order
from cityx.language.here import Here
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ

_CUTTING = (
    "crop", "cropped", "cut", "clip", "trim", "clipped", "trimmed", "limit", "limited", "only",
    "just", "take", "nothing but",
)  # fmt: skip
_MIDDLE = ("central", "middle", "center", "inner")
_WITHIN = ("around", "of", "from", "near")  # behind a length: it is a radius
_WHOLE = "Buildings that the border of the window cuts stay whole; the site is as much larger."
_FAR = 8  # items between a measure and the words that say what it is of


def read_window(here: Here) -> None:
    """Read to what a map is cut, by sides or by metres around its middle."""
    quantity = here.item.quantity
    if quantity is None or quantity.dimension not in ("length", "pair") or not here.found.mapped:
        return
    if quantity.attribute in ("height", "width", "spacing"):
        return
    before, behind = _near(here)
    cut = next((one for one in before if one.text in _CUTTING), None)
    cutting = cut is not None or here.item.words[0] in _CUTTING
    middle = next((one for one in (*reversed(before), *behind) if _is_middle(one)), None)
    size = quantity.high or 0.0
    sides = (quantity.low or 0.0, quantity.other or 0.0)
    if quantity.dimension == "length":
        link = behind[0].get("rel") if behind else ""
        round_ = middle in behind and (link in _WITHIN or here.item.words[0] == "within")
        round_ = round_ and "square" not in (*here.item.words, *(one.text for one in behind[:1]))
        sides = (2.0 * size, 2.0 * size) if round_ else (size, size)
    central = quantity.dimension == "pair" and middle is not None and middle in before[-2:]
    orders = range(here.at - len(before), here.at)
    if (
        central
        and not cutting
        and any(here.items[at].has("verb") and is_an_order(here.items, at) for at in orders)
    ):
        return  # "close the middle 300 x 300 m to traffic"
    if central and _removes(before[0]) and _names_a_thing(before[1:]):
        return  # "remove the trees in the middle 200 x 200 m"
    told_so = cutting and not _is_of_a_thing(here, behind, middle)
    if min(sides) <= 0.0 or not (told_so or central):
        return
    told = [one for one in (cut, middle) if one is not None]
    for key, side in zip(("size.x", "size.y"), sides, strict=True):
        here.found.add(key, side, here.item, *told)
    here.found.notes.append(Note("window", _WHOLE, here.item.span))
    first = min(one.span for one in (here.item, *told))
    last = max(one.span for one in (here.item, *told))
    for one in (*before, *behind):
        if first <= one.span <= last:
            one.state = one.state or READ


def _near(here: Here) -> tuple[list[Item], list[Item]]:
    """Return the items before and behind a measure in its sentence, some at most."""
    before: list[Item] = []
    for one in reversed(here.items[max(0, here.at - _FAR) : here.at]):
        if one.is_mark(ENDS + ",:"):
            break
        before.insert(0, one)
    behind: list[Item] = []
    for one in here.items[here.at + 1 : here.at + 1 + _FAR]:
        if one.is_mark(ENDS + ","):
            break
        behind.append(one)
    return before, behind


def _removes(item: Item) -> bool:
    return item.has("neg") or item.get("verb") == "REMOVE"


def _names_a_thing(items: list[Item]) -> bool:
    return any(one.noun and one.noun_class != "place" for one in items)


def _is_middle(item: Item) -> bool:
    return item.noun == "center" or not set(_MIDDLE).isdisjoint(item.words)


def _is_of_a_thing(here: Here, behind: list[Item], middle: Item | None) -> bool:
    """Return whether what is measured is a thing on the map: "take the trees within 20 m"."""
    owner = here.owner()
    known = owner is not None and owner.has("noun") and owner.noun_class not in ("place",)
    return known and owner is not middle and owner not in behind
