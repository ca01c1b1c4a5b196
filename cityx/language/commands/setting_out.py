"""Setting out: vehicles that somebody drives to a place, or adds from one, are on their way."""

from __future__ import annotations

from cityx.language.commands.roles import TERM
from cityx.language.commands.words_put_in import here
from cityx.language.scan import ENDS, Item

_DRIVES, _KNOWN = ("drive", "send"), ("the", "that", "this", "those", "these")
_OFF_STREETS = ("tram", "boat", "train", "parked_vehicle")


def set_out(items: list[Item]) -> list[Item]:
    """Read "drive a car to the church" and "add a bus from the school" as of one that drives."""
    found = list(items)
    for at in reversed(range(len(items))):
        item, rest = items[at], items[at + 1 :]
        begins = not at or items[at - 1].is_mark(ENDS + ",:") or items[at - 1].get("rel") == "and"
        sent = item.text in _DRIVES
        if not begins or not (sent or item.get("verb") == "ADD"):
            continue
        end = next((k for k, one in enumerate(rest) if one.kind == "mark"), len(rest))
        who = next((k for k, one in enumerate(rest[:end]) if one.noun), None)
        if who is None or rest[who].noun_class != "vehicle" or rest[who].noun in _OFF_STREETS:
            continue
        known = any(one.text in _KNOWN or one.has("mode") for one in rest[:who])
        bound = rest[who + 1] if who + 1 < end else item
        more = any(one.get("rel") not in ("", "to", "and") for one in rest[who + 2 : end])
        if known or more or not (bound.text == "from" or (sent and bound.get("rel") == "to")):
            continue
        if bound.text == "from":
            bound.kind, bound.senses = "phrase", ((TERM, "FROM"),)
        found.insert(at + who + 2, here(bound, "driving", ("mode", "drive")))
        if sent:
            item.kind, item.senses = "phrase", (("verb", "ADD"),)
    return found
