"""Terminals: what each item of a command is to the grammar of edits."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.commands.roles import TERM
from cityx.language.lexicon.numbers import EVERY_SO_MANY
from cityx.language.lexicon.phrases import VERBS
from cityx.language.scan import Item

Terminal = tuple[str, int]  # its name, and the index of the item

# Parts of buildings that can be added to them.
ADDED = ("solar", "antenna", "chimney", "balcony", "awning", "flower_box", "dish")
_ROOFS = ("roof", "roofs")  # "flat roofs", on which parts are put
_ON_WALLS = ("roof", "window", "facade")  # on which parts are put
_DIMENSIONS = {
    "length": "LENGTH", "floors": "FLOORS", "share": "SHARE", "part": "SHARE", "count": "COUNT",
    "speed": "SPEED", "angle": "ANGLE", "lanes": "LANES",
}  # fmt: skip
_CLASSES = {
    "building": "BUILDING", "type": "KIND", "element": "THING", "plant": "PLANT",
    "vehicle": "AGENT", "person": "AGENT", "road": "ROAD",
}  # fmt: skip
_RELATIONS = {
    "near": "REL", "along": "REL", "around": "REL", "on": "ON", "in": "IN", "of": "OF",
    "to": "TO", "by": "BY", "with": "WITH", "be": "BE", "and": "AND", "all": "ALL", "every": "ALL",
    "rest": "REST", "it": "IT", "times": "SIGN", "twice": "TIMES", "thrice": "TIMES",
    "half as": "TIMES", "factor": "FACTOR", "clockwise": "CLOCKWISE",
    "counterclockwise": "CLOCKWISE", "every other": "SHARE", "every third": "SHARE",
    "every fourth": "SHARE", "more": "AMOUNT", "from": "FROM",
}  # fmt: skip
_STREETS = {"surface": "SURFACE", "direction": "ONEWAY", "strip": "STRIP"}
_AFTER_BE = ("REMOVE", "REPLACE", "PAINT", "CLAD")  # "should be removed"
# What stands between a rank and what is ranked, or is it.
_BETWEEN = ("MATERIAL", "COLOR", "STYLE", "ROOF", "FLOORS", "OF", "SIDE", "SIZE", "RANK",
            "NEAREST", "COUNT")  # fmt: skip
_RANKED = ("ONES", "BUILDING", "KIND", "THING", "AGENT", "PLANT", "ROAD", "WHOLE", "QUARTER")
_DISTANCES = ("nearest", "farthest")  # ranks by how far things are from something else
_WHOLE = ("city", "everything", "landscape")


def terminals_of(items: Sequence[Item], *, verb_first: bool) -> list[Terminal]:
    """Return the terminals of a command; items without content are left out.

    Parameters
    ----------
    items
        The command.
    verb_first
        Whether a first word that may be a verb or a noun ("plants") is the verb.
    """
    found: list[Terminal] = []
    for index, item in enumerate(items):
        if item.state:
            continue
        first = not found
        name = _verb(item, first and verb_first, found) or _name(item)
        from_ = ("rel", "from") in item.senses
        if from_ and any(before in ("REMOVE", "NEAREST") for before, _ in found):
            name = "FROM"  # "remove it from the park", where elsewhere it is "made from"
        if item.has("material") and item.has("noun") and _is_stuff(items, index):
            name = "MATERIAL"  # "clad in wood", which is no wood to walk in
        if not name and not first and item.get("verb") == "MAKE":
            name = "BE"  # "could b03 get a flat roof"
        if item.text == "another" and not name and _is_again(items, index, found):
            name = "AGAIN"  # "and another behind it"
        if not name and item.noun in _ON_WALLS and any(one == "PART" for one, _ in found):
            name = "ATTR"  # "flower boxes under the windows"
        if item.text in ("its", "their") and _is_of_it(items, index, found):
            name = "IT"  # "double its height"
        if name == "COUNT" and found and found[-1][0] == "AGAIN":
            continue  # "another one"
        if name == "ALL" and index + 1 < len(items) and _is_length(items[index + 1]):
            continue  # "every 10 m"; the length itself is the interval
        if name == "REMOVE" and item.text == "drop" and _is_another(items, index):
            name = "ADD"  # "drop a bench on the plaza", but "drop the bench"
        if name == "LENGTH" and _is_interval(items, index):
            name = "EVERY"
        if name == "LENGTH" and _is_away(items, index):
            name = "AWAY"
        if name in ("BE", "AND", "OF", "TO") and first:
            continue
        if name == "AND" and (found[-1][0] == "EXCEPT" or _leaves_out(items, index)):
            continue  # ", except", "but not"
        if item.is_mark("-–") and found and found[-1][0] == "ID":
            name = "TO"
        if name == "AND" and found[-1][0] == "AND":
            continue
        if name:
            found.append((name, index))
    return _with_ranked(_with_parts(found, items))


def _is_of_it(items: Sequence[Item], index: int, found: Sequence[Terminal]) -> bool:
    """Return whether a measure of what was named is to change: "double | its height"."""
    measured = any(item.has("attr") for item in items[index + 1 : index + 2])
    return measured and len(found) == 1 and found[0][0] in _RESIZES


_RESIZES = ("DOUBLE", "TRIPLE", "QUADRUPLE", "HALVE", "RAISE", "LOWER", "WIDEN", "NARROW")


def _with_parts(found: list[Terminal], items: Sequence[Item]) -> list[Terminal]:
    """Leave parts out where nothing is added, and say that roofs on which they go are buildings."""
    parts = any(name == "PART" for name, _ in found)
    if not parts:
        return found
    if found[0][0] not in ("ADD", "PLANTS", "MAKE"):
        return [one for one in found if one[0] != "PART"]
    found = [one for name, at in found for one in (
        ((name, at), ("BUILDING", at)) if name == "ROOF" and items[at].words[-1] in _ROOFS
        else ((name, at),)
    )]  # fmt: skip
    made = [("BUILDING" if name == "ATTR" and items[at].noun in _ON_WALLS else name, at)
            for name, at in found]  # fmt: skip
    of = next((k for k, (name, at) in enumerate(made) if name == "BUILDING"
               and items[at].noun in _ON_WALLS and made[k + 1 : k + 2]
               and made[k + 1][0] == "OF"), -1)  # fmt: skip
    return made if of < 0 else made[:of] + made[of + 2 :]  # "the roofs of the houses"


def _with_ranked(found: Sequence[Terminal]) -> list[Terminal]:
    """Say that buildings are ranked where nothing is said: "the five tallest"."""
    made: list[Terminal] = []
    for at, terminal in enumerate(found):
        made.append(terminal)
        if terminal[0] in ("RANK", "NEAREST"):
            behind = (name for name, _ in found[at + 1 :] if name not in _BETWEEN)
            if next(behind, "") not in (*_RANKED, "TO", "FROM"):  # "the houses closest to the lake"
                made.append(("BUILDING", -1))
    return made


def _is_again(items: Sequence[Item], index: int, found: Sequence[Terminal]) -> bool:
    """Return whether there is to be another of what was said: "and another (bench) behind it"."""
    after = (item for item in items[index + 1 :] if item.get("rel") or item.noun)
    noun = getattr(next(after, None), "noun", "")
    said = [items[at].noun for name, at in found if name == "THING"]
    return bool(found) and (not noun or noun in said)


def _is_another(items: Sequence[Item], index: int) -> bool:
    """Return whether something is spoken of that is not there yet: "a bench", "another one"."""
    after = items[index + 1] if index + 1 < len(items) else None
    return after is not None and after.words[0] in ("a", "an", "another", "some")


def _is_stuff(items: Sequence[Item], index: int) -> bool:
    """Return whether a word that is a material or a place is what something is made of."""
    before = items[index - 1] if index else None
    after = items[index + 1] if index + 1 < len(items) else None
    last = after is None or not after.noun
    return before is not None and before.get("rel") in ("in", "with", "to", "of") and last


def share_of(item: Item) -> float:
    """Return the share that "half of", "20 % of" or "every other" means."""
    if item.quantity is not None:
        return round(item.quantity.high or item.quantity.low or 0.0, 4)
    return round(EVERY_SO_MANY[item.get("rel")], 4)


def _verb(item: Item, first: bool, found: Sequence[Terminal]) -> str:
    verb = item.get("verb")
    if first and verb:
        return {"PLANT": "PLANTS"}.get(verb, verb)
    after_be = bool(found) and found[-1][0] == "BE"
    gone = bool(found) and verb == "REMOVE" and found[0][0] not in VERBS
    return verb if gone or (after_be and verb in _AFTER_BE) else ""


def _leaves_out(items: Sequence[Item], index: int) -> bool:
    """Return whether what is left out follows a comma or a "but"."""
    after = next((item for item in items[index + 1 :] if item.kind != "function"), None)
    return after is not None and after.get(TERM) == "EXCEPT"


def _name(item: Item) -> str:
    if item.has(TERM):
        return item.get(TERM)
    if item.kind == "id":
        return "ID"
    if item.quantity is not None:
        return _measure_name(item)
    if item.is_mark(","):
        return "AND"
    if item.has("noun") and item.noun == "roof":
        return "ATTR"
    for kind, name in _STREETS.items():
        if item.has(kind):
            return name
    slot = item.get("slot")
    if _is_a_part(item):
        return "PART"
    if slot.startswith("district="):
        return "QUARTER"
    if slot == "not=vehicle":
        return "CARFREE"
    if item.noun == "cycleway":
        return "STRIP"
    if item.has("noun") and not (slot and item.noun_class in ("road", "place")):
        name = "WHOLE" if item.noun in _WHOLE else _CLASSES.get(item.noun_class, "")
        if name:
            return name
    for kind, name in (("color", "COLOR"), ("material", "MATERIAL"), ("rank", "RANK")):
        if item.has(kind):
            return "NEAREST" if item.get("rank") in _DISTANCES else name
    if "roof=" in slot or "style=" in slot:
        return "ROOF" if "roof=" in slot else "STYLE"
    if item.get("rel") in _RELATIONS:
        return _RELATIONS[item.get("rel")]
    for kind in ("axis", "ordinal", "side", "mode", "attr", "amount", "size", "wears", "pace"):
        if item.has(kind):
            return kind.upper()
    return ""


def _is_a_part(item: Item) -> bool:
    """Return whether an item is a part of buildings."""
    value = item.get("slot").removeprefix("building.feature=")
    return item.get("slot").startswith("building.feature=") and bool(value)


def _measure_name(item: Item) -> str:
    quantity = item.quantity
    assert quantity is not None
    name = _DIMENSIONS.get(quantity.dimension, "")
    if quantity.attribute == "across" and name == "LENGTH":
        return "ACROSS"
    if quantity.exact is not None or name == "SPEED":
        return name
    if name == "COUNT":  # "at least five" are five
        return "AT_MOST" if quantity.low is None else "COUNT"
    return "LIMIT"


def _is_length(item: Item) -> bool:
    return item.quantity is not None and item.quantity.dimension == "length"


def _is_away(items: Sequence[Item], index: int) -> bool:
    """Return whether a length is how far off something is: "10 m | north of b05"."""
    quantity, after = items[index].quantity, items[index + 1 : index + 3]
    known = quantity is not None and not quantity.attribute and not quantity.relative
    return known and len(after) == 2 and after[0].has("side") and after[1].get("rel") == "of"


def _is_interval(items: Sequence[Item], index: int) -> bool:
    if index and items[index - 1].text in ("every", "each"):
        return True
    quantity = items[index].quantity
    return quantity is not None and quantity.attribute == "spacing"
