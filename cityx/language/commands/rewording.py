"""Rewording: ways to say an edit that are put as plain ones before a request is cut into commands.

Each mend is about a kind of phrase, whatever the nouns in it are.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from cityx.language.commands.everyday_orders import in_everyday_words
from cityx.language.commands.measured_places import (
    far_from,
    fills,
    landings,
    off_bridges,
    strips,
    traits_behind,
)
from cityx.language.commands.pointing import (
    corners_of_two,
    facing_of,
    flanks_of,
    in_the_way,
    of_two,
    pieces_of,
    sides_of_things,
    where_streets_meet,
)
from cityx.language.commands.roles import TERM
from cityx.language.commands.roof_words import all_roofs, other_roofs, roofs_of_a_form
from cityx.language.commands.setting_out import set_out
from cityx.language.commands.short_forms import in_full
from cityx.language.commands.telling import asks_to_be_told
from cityx.language.commands.topics import both, place_first, that_land
from cityx.language.commands.words_put_in import LOOKS, ROOFS, asked, by_sentence, removes
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import KEPT, READ

LONGEST = 600  # items of a request that is put into plainer words


def reworded(items: Sequence[Item]) -> list[Item]:
    """Return the items of a request for a city that stands in plainer words.

    Requests longer than people write are taken as they stand: each look goes over all items.
    """
    if len(items) > LONGEST:
        return list(items)
    found = in_full(list(items))
    for mend in (
        of_two, in_the_way, where_streets_meet, corners_of_two, flanks_of, pieces_of,
        sides_of_things, in_everyday_words, place_first, facing_of, both, that_land, _which_is,
        _asked_apart, _zones, _present, _in_turn, _kept_looks, _what_is_left, _fronted_place,
        other_roofs, _both_sides, _sides_by_places, _entrances, _paved, _no_less, _cleared,
        landings, off_bridges, far_from, strips, fills, traits_behind, _crowds, all_roofs,
        roofs_of_a_form, set_out,
    ):  # fmt: skip
        found = mend(found)
    return found


def _which_is(items: list[Item]) -> list[Item]:
    """Read "which street is the busiest?" as "list the busiest street", of which "it" is told.

    "Which buildings are taller than 20 m?" lists those.
    """
    for at, item in enumerate(items):
        begins = not at or items[at - 1].is_mark(ENDS + ",:")
        said = [one for one in items[at + 1 : at + 6] if one.text != "the"]
        if item.text not in ("which", "what") or not begins or len(said) < 4:
            continue
        noun, be, rank, end = said[:4]
        if not noun.noun or not (be.get("rel") == "be" or be.text in ("have", "has")):
            continue
        last = next((one for one in items[at:] if one.is_mark(ENDS)), end)
        if be.get("rel") != "be":
            if last.is_mark("?"):
                asked(items[at : items.index(last)])  # "which have red roofs?" gives none any
            continue
        if rank.has("rank", *LOOKS) and end.is_mark(ENDS):
            place = items.index(noun)
            items.remove(rank)
            items.insert(place, rank)
        elif not last.is_mark("?"):
            continue
        elif not _is_a_bound(rank):
            asked([item, noun])  # "they" are not all of them
            continue
        item.kind, item.senses = "phrase", (("verb", "LIST"),)
        be.state, be.senses = READ, ()
    return items


def _is_a_bound(item: Item) -> bool:
    """Return whether a word begins what things are chosen by: "taller than 20 m", "near"."""
    bound = item.quantity is not None and item.quantity.exact is None
    return bound or item.get("rel") in ("near", "along", "around", "in", "on", "between")


_CROWDS = frozenset(("crowd", "group", "party", "family", "gathering"))


def _crowds(items: list[Item]) -> list[Item]:
    """Read "a crowd of 50 in the park" as "50 people in the park"."""
    found: list[Item] = []
    for at, item in enumerate(items):
        found.append(item)
        counted = item.quantity is not None and item.quantity.dimension == "count"
        if not counted or _CROWDS.isdisjoint(item.words):
            continue
        rest = items[at + 1 :]
        if rest and rest[0].is_mark(","):  # ", mostly | children" are some of them
            who = next((k for k, one in enumerate(rest) if one.noun or one.is_mark(ENDS)), 0)
            if who and rest[who].noun_class == "person":
                rest[0].state = READ
                asked(rest[1 : who + 1])
                for one in rest[who + 1 : who + 2]:
                    one.state = READ if one.is_mark(",") else one.state
        end = next((k for k, one in enumerate(rest)
                    if one.kind == "mark" or one.has("rel", "verb")), len(rest))  # fmt: skip
        if not any(one.noun or one.has("mode", "material", "color") for one in rest[:end]):
            found.append(Item("phrase", item.span, ("people",), (("noun", "person:pedestrian"),)))
    return found


_ZONES = ("pedestrian zone", "pedestrian street", "pedestrian area", "pedestrian precinct",
          "pedestrianised street", "pedestrianized street", "car free zone")  # fmt: skip


def _zones(items: list[Item]) -> list[Item]:
    """Read "turn the street into a pedestrian zone" as "make the street car free"."""
    begin = 0
    for at, item in enumerate(items):
        begin = at + 1 if item.is_mark(ENDS) else begin
        if " ".join(item.words) not in _ZONES or item.state:
            continue
        clause = items[begin:at]
        verb = next((one for one in clause if one.get("verb") in ("MAKE", "REPLACE")), None)
        if verb is None or not any(one.noun_class == "road" or one.kind == "id" for one in clause):
            continue
        verb.senses = (("verb", "MAKE"),)
        item.kind, item.senses, item.words = "phrase", (("slot", "not=vehicle"),), ("car", "free")
        for one in clause[-2:]:
            if one.get("rel") in ("to", "in", "with") or one.text == "into":
                one.state, one.senses = READ, ()
    return items


_SAYS = ("tell", "report", "say", "list", "show", "name", "let")


def _asked_apart(items: list[Item]) -> list[Item]:
    """Part "and tell me which ones you removed" from the change that it follows."""
    for at, item in enumerate(items):
        joined = at and (items[at - 1].is_mark(",") or items[at - 1].get("rel") in ("and", "but")
                         or items[at - 1].text == "then")  # fmt: skip
        if not joined or item.text not in _SAYS:
            continue
        end = next((k for k in range(at, len(items)) if items[k].is_mark(ENDS)), len(items))
        begin = next((k + 1 for k in range(at - 1, -1, -1) if items[k].is_mark(ENDS)), 0)
        if asks_to_be_told(items[begin:end]):
            continue  # all of the sentence does
        asked = items[at + 1].text in ("me", "us") if at + 1 < len(items) else False
        if asked or asks_to_be_told(items[at:end]):
            items[at - 1].kind, items[at - 1].senses = "mark", ()
            items[at - 1].words = (";",)
    return items


# -- words that say that something is there ------------------------------------------------------

_PRESENT = ("existing", "present", "current")
_PLAIN = ("new", "nice", "proper", "decent", "lovely", "brand new", "beautiful")  # of what is new
_ONE = ("a", "an", "some", "another")
_HALF_WAY = ("halfway", "midway", "half way")


def _present(items: list[Item]) -> list[Item]:
    """Pass over "existing" before a noun and "halfway" before "between"."""
    for at, (item, after) in enumerate(pairwise(items)):
        plain = item.kind in ("unknown", "function")
        before = items[at - 1] if at else None
        led = before is not None and (before.text in _ONE or before.quantity is not None)
        between = item.text in _HALF_WAY and after.get(TERM) == "BETWEEN"
        said = item.text in _PRESENT or (led and item.text in _PLAIN)
        if plain and (between or (said and after.noun)):
            item.state = READ
    return items


# -- colours ---------------------------------------------------------------------------------------

_MIXED = ("different", "various", "varied", "varying", "assorted", "mixed", "alternating",
          "alternate", "cheerful")  # fmt: skip
_HUES = ("color", "colors", "colour", "colours", "shade", "shades", "tone", "tones", "hue", "hues")
_RANGES = ("pastel", "colourful")
_TURNS = ("alternately", "alternating", "in turn", "each")


def _in_turn(items: list[Item]) -> list[Item]:
    """Read "in various colours" as a range, and "alternating red and white" as two in turn.

    "Pastel: pink, yellow, mint" names those of the range, and "or" joins colours as "and" does.
    """
    for at, item in enumerate(items):
        after = items[at + 1 : at + 3]
        if not after:
            break
        if item.text in _MIXED and not item.has("color"):
            if after[0].has("color"):
                item.kind, item.senses, item.state = "function", (), READ
            elif after[0].text in _HUES:
                item.kind, item.senses, item.state = "function", (), READ
                after[0].kind, after[0].senses = "phrase", (("color", "colourful"),)
        elif item.has("color") and after[0].text in _HUES and after[0].has("attr"):
            after[0].state = READ  # "in pastel | shades"
        elif item.has("color") and after[0].text in _HUES and after[0].kind == "unknown":
            after[0].state = READ
        elif item.text == "or" and at and items[at - 1].has("color") and after[0].has("color"):
            item.kind, item.senses = "phrase", (("rel", "and"),)
        elif item.get("color") in _RANGES and after[0].is_mark(":") and after[-1].has("color"):
            after[0].words = (",",)
        elif item.text in _TURNS and at and items[at - 1].has("color"):
            item.kind, item.senses, item.state = "function", (), READ
    return items


def _kept_looks(items: list[Item]) -> list[Item]:
    """Let a look that ends "paint all buildings except the church | yellow" be what is asked for.

    A look is of what is left out only where the request gives another one.
    """
    begin = 0
    for end, item in enumerate(items):
        if not (item.is_mark(ENDS) or end + 1 == len(items)):
            continue
        clause = items[begin : end + 1]
        begin = end + 1
        made = any(one.get("verb") in ("PAINT", "MAKE", "CLAD") for one in clause[:3])
        told = any(_is_look(one) and one.state != KEPT for one in clause)
        kept = [one for one in clause if one.state == KEPT]
        looks = [at for at, one in enumerate(kept) if at and _is_look(one) and kept[at - 1].noun]
        if made and not told and looks:
            kept[looks[-1]].state = ""
    return items


def _is_look(item: Item) -> bool:
    return item.has(*LOOKS) or item.get("slot").startswith(("building.roof=", "style="))


# -- what remains --------------------------------------------------------------------------------

_LEFT = ("left", "remains", "remain", "remaining", "stands", "standing", "survives")
_WHATEVER = ("whatever", "whatever's", "whatever is", "what", "what's", "what is", "everything",
             "all that", "all that is")  # fmt: skip


def _what_is_left(items: list[Item]) -> list[Item]:
    """Read "whatever's left", "what remains" and "the other half" as "the rest"."""
    for at, item in enumerate(items[:-1]):
        part = items[at + 1].quantity
        if item.text == "other" and part is not None and part.dimension == "part":
            item.kind, item.senses, item.words = "phrase", ((TERM, "REST"),), ("rest",)
            items[at + 1].state, items[at + 1].quantity = READ, None
        if item.text not in _WHATEVER or item.state:
            continue
        behind = at + 1
        while behind < len(items) - 1 and items[behind].text in ("is", "that", "that's", "s", "'s"):
            behind += 1
        after = items[behind + 1] if behind + 1 < len(items) else item
        placed = after.quantity is not None and after.quantity.dimension == "length"
        placed |= after.get("rel") in ("near", "in", "on", "along", "around")
        if items[behind].text in _LEFT and not placed:
            for one in items[at + 1 : behind + 1]:
                one.state, one.senses = READ, ()
            item.kind, item.senses, item.words = "phrase", ((TERM, "REST"),), ("rest",)
    return items


# -- places and roofs ----------------------------------------------------------------------------

_FRONTS = ("in", "on")
_CHANGES = ("REPLACE", "PAINT", "MAKE", "CLAD", "REMOVE", "RAISE", "LOWER")


def _fronted_place(items: list[Item]) -> list[Item]:
    """Read "in the south half of town paint all houses red" with the place at the houses."""
    return by_sentence(items, _placed_behind)


def _placed_behind(clause: list[Item]) -> list[Item]:
    verb = next((at for at, one in enumerate(clause)
                 if one.get("verb") in _CHANGES or one.text == "take"), 0)  # fmt: skip
    place = [one for one in clause[:verb] if one.kind != "mark"]
    side = any(one.has("side") for one in place)
    if not place or place[0].get("rel") not in _FRONTS or not side:
        return clause
    if any(one.has("verb") or one.state for one in place) or clause[verb].state:
        return clause
    noun = next((at for at in range(verb + 1, len(clause))
                 if clause[at].noun_class in ("building", "type", "plant", "element")
                 or clause[at].get("slot").startswith(ROOFS)), None)  # fmt: skip
    if noun is None:
        return clause
    return [*clause[verb : noun + 1], *place, *clause[noun + 1 :]]


# -- streets -------------------------------------------------------------------------------------


def _both_sides(items: list[Item]) -> list[Item]:
    """Read "a cycle lane on each side" as one on both sides, which is what it says anyway.

    "Without knocking any houses down" leaves houses alone; its "down" says no way.
    """
    strip = False
    for at, item in enumerate(items):
        strip |= item.noun == "cycleway"
        strip &= not item.is_mark(ENDS)
        if strip and item.text in ("on each side", "on both sides", "on either side"):
            follows = items[at + 1].get("rel") if at + 1 < len(items) else ""
            if follows != "of":
                item.kind, item.senses, item.state = "phrase", (), READ
        if item.get(TERM) == "EXCEPT" and item.words[0] in ("without", "don't", "do"):
            down = next((one for one in items[at + 1 : at + 7] if one.text == "down"), None)
            if down is not None:
                down.senses, down.state = (), READ
    return items


def _sides_by_places(items: list[Item]) -> list[Item]:
    """Leave "on the water side" open: which side of what is meant, a place alone does not tell."""
    for item, after in pairwise(items):
        if item.noun_class == "element" and after.text == "side" and not after.state:
            after.kind, after.senses = "unknown", ()
    return items


_GATES = ("entrance", "entrances", "gate", "gates", "entry", "entries")


def _entrances(items: list[Item]) -> list[Item]:
    """Read "the park entrance" as "the entrance of the park", a part of it as a corner is."""
    found = list(items)
    for at, item in enumerate(items):
        if item.text not in _GATES or item.state or item.has("noun", TERM):
            continue
        before, after = items[:at], items[at + 1 : at + 4]
        land = bool(before) and before[-1].noun_class == "element"
        of = bool(after) and after[0].get("rel") in ("of", "to")
        if not (land or of):
            continue
        item.kind, item.senses = "phrase", ((TERM, "ENTRANCE"),)
        for one in before[-3:]:
            if one.get("rel") == "all":
                one.kind, one.senses = "phrase", ((TERM, "BOTH"),)  # "at each entrance"
        if of:
            after[0].senses = (("rel", "of"),)
        else:
            place = found.index(item)
            noun = found[place - 1]
            link = Item("phrase", item.span, ("of",), (("rel", "of"),))
            found[place - 1 : place + 1] = [item, link, noun]
    return found


# -- surfaces, limits and cleared ground -----------------------------------------------------------

_PAVING = ("paving", "pavers", "setts", "surface", "surfacing")
_LAID = {"brick": "bricks", "stone": "paving_stones", "concrete": "concrete", "wood": "wood"}


def _paved(items: list[Item]) -> list[Item]:
    """Read "brick paving" as a surface of streets."""
    for item, after in pairwise(items):
        laid = _LAID.get(item.get("material"), "")
        if laid and after.text in _PAVING and not after.state:
            item.kind, item.senses = "phrase", (("surface", laid),)
            after.kind, after.senses, after.state = "function", (), READ
    return items


LEAST = "least"  # sense of a number: the key of a change that it bounds, and its value
_LOWERS = ("LOWER", "REMOVE", "HALVE")
_LOSES = ("loses", "lose", "losing", "take", "shave", "off")


def _no_less(items: list[Item]) -> list[Item]:
    """Read "..., but nothing goes below two floors" as a bound of what the sentence lowers."""
    begin = 0
    for end, item in enumerate(items):
        if not (item.is_mark(ENDS) or end + 1 == len(items)):
            continue
        clause = items[begin : end + 1]
        begin = end + 1
        but = next((k for k, one in enumerate(clause) if one.get("rel") == "but" and k), None)
        if but is None:
            continue
        lowers = any(one.get("verb") in _LOWERS or one.text in _LOSES for one in clause[:but])
        tail = [one for one in clause[but + 1 :] if one.kind != "mark"]
        bound = tail[-1].quantity if tail else None
        if not lowers or bound is None or bound.low is None or bound.high is not None:
            continue
        key = {"floors": "floors.min", "length": "height.min"}.get(bound.dimension)
        plain = all(one.kind == "function" or one.has("neg", "keep") or one.text in _GOES
                    or one.noun_class == "building" for one in tail[:-1])  # fmt: skip
        if key is None or not plain:
            continue
        for one in clause[but:-1]:
            one.state, one.senses = READ, ()
        tail[-1].state, tail[-1].senses = READ, ((LEAST, f"{key}={bound.low:g}"),)
    return items


_GOES = ("goes", "go", "falls", "fall", "drops", "drop", "gets", "get", "nothing", "none", "leave",
         "keep", "be", "end", "ends", "up", "with", "house", "houses")  # fmt: skip

_GAPS = ("gap", "gaps", "plot", "plots", "lot", "lots", "site", "sites", "space", "hole", "spot")
_FREED = ("cleared", "freed", "empty", "vacant", "resulting", "vacated", "of", "the")
CLEARED = "cleared"  # sense of "it": of several that went, the one of a rank


def _cleared(items: list[Item]) -> list[Item]:
    """Read "on the biggest gap" behind a removal as "in their place", of the largest of them."""
    for at, item in enumerate(items):
        if item.get("rel") == "it" and item.words[-1] == "place":
            item.senses = (*item.senses, (CLEARED, ""))  # "in their place"
        ends = at + 1 == len(items) or items[at + 1].kind == "mark"
        if item.text == "instead" and ends and removes(items[:at]) and not item.state:
            item.senses, item.state = ((CLEARED, ""),), READ
        if item.text not in _GAPS or item.state or item.noun_class not in ("", "place"):
            continue
        gone = removes(items[:at])
        back = at - 1
        while back > 0 and (items[back].text in _FREED or items[back].kind == "function"):
            back -= 1
        rank = items[back].get("rank") if items[back].has("rank") else ""
        link = next((k for k in range(back, max(back - 4, -1), -1)
                     if items[k].get("rel") in ("on", "in", "at")), None)  # fmt: skip
        freed = any(one.text in _FREED[:6] for one in items[back:at])
        if not gone or link is None or not (rank or freed):
            continue
        for one in items[link + 1 : at]:
            one.state, one.senses = READ, ()
        items[link].senses = (("rel", "in"),)
        item.kind, item.senses, item.words = "phrase", (("rel", "it"), (CLEARED, rank)), ("it",)
    return items
