"""Roles: what small words do in a command, settled before "no" and "keep" are."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from cityx.language.scan import ENDS, Item
from cityx.language.scopes import READ, is_exception, protects

_MORE = ("extra", "additional", "further", "new")  # one besides those there are
NEAR = 16  # words to both sides that a role is told by
TERM = "term"  # kind of sense: what the grammar of edits takes a word for
_RELATIVE = ("that", "which", "who", "whose", "those that", "ones that")
_LOOKS = ("material", "color")
_TOLD = ("slot", *_LOOKS)  # what may be said of a thing behind "that is"
_ALIKE = {"as tall as": "height", "as high as": "height", "as low as": "height"}
_ONES = ("one", "ones", "those", "that")
_POINTS = ("near", "along", "around", "in", "on", "with", "by", "of", "from")
_PLACES = {
    "corner": "CORNER", "corners": "CORNER", "end": "END", "ends": "END", "edge": "EDGE",
    "middle": "MIDDLE", "center": "MIDDLE",
}  # fmt: skip
_ENTRANCES = ("entrance", "entrances", "gate", "gates", "opening", "openings", "gap", "gaps")
_BARRIERS = ("fence", "hedge", "wall", "city_wall")
_NEIGHBORS = ("neighbor", "neighbors", "neighbour", "neighbours")
_GONE = ("gone", "removed", "away")
# What a sentence may begin with that asks for something, and the verb that it stands for.
_ASKS = (
    ("could there be", "ADD"), ("can there be", "ADD"), ("can we have", "ADD"),
    ("could we have", "ADD"), ("can i have", "ADD"), ("could i have", "ADD"),
    ("there should be", "ADD"), ("there must be", "ADD"), ("there has to be", "ADD"),
    ("there needs to be", "ADD"), ("there ought to be", "ADD"), ("there could be", "ADD"),
    ("let there be", "ADD"), ("we need", "ADD"), ("we want", "ADD"), ("i need", "ADD"),
    ("we would like", "ADD"), ("we'd like", "ADD"), ("i'd like", "ADD"), ("i would like", "ADD"),
    ("i want", "ADD"), ("what about", "ADD"), ("how about", "ADD"),
    ("could you", ""), ("can you", ""), ("would you", ""), ("will you", ""), ("i want you to", ""),
    ("i would like you to", ""), ("i'd like you to", ""), ("go ahead and", ""), ("now", ""),
    ("would you mind", ""), ("i want to", ""), ("i would like to", ""), ("i'd like to", ""),
    ("can we", ""), ("could we", ""), ("shall we", ""),
    ("we want to", ""), ("we need to", ""), ("let us", ""), ("let's", ""),
)  # fmt: skip


def give_roles(items: Sequence[Item]) -> None:
    """Say of small words what they do: leave out, deny, compare, point at what was named.

    What is left out by name alone ("except the church") is settled with what is kept.
    """
    for at, item in enumerate(items):
        if item.state:
            continue
        before, after = items[max(at - NEAR, 0) : at], items[at + 1 : at + 1 + NEAR]
        if _begins(before) or item.text in ("there", "there should be", "let"):
            _asked(items, at)
        if item.text in _LISTS and _begins(before):
            _list(item, items[at + 1 :])
        elif item.text == "else" and before and before[-1].noun == "everything":
            item.state = READ  # "don't touch anything else"
        elif item.text == "else" and before and before[-1].text in ("somewhere", "anywhere"):
            item.words = ("elsewhere",)  # and no condition
        elif item.text in _SLANG and _begins(before) and after and after[0].words[0] in _NEW:
            item.kind, item.senses = "phrase", (("verb", "ADD"),)  # "pop a bench by the pond"
        elif item.noun == "bridge" and _is_for_walkers(after):
            item.words = ("footbridge",)
            if before and (before[-1].get("ordinal") == "2" or before[-1].text in _MORE):
                before[-1].kind, before[-1].senses, before[-1].state = "function", (), READ
            _join_form(after)
        elif item.text == "footbridge":
            _join_form(after)
        elif item.text == "nothing" and after and after[0].text == "else" and _stays_as(after):
            item.senses = (("keep", "keep"),)  # "nothing else may change"
            after[0].kind, after[0].senses = "phrase", (("noun", "place:everything"),)
        elif item.text in ("round", "around") and before and before[-1].text == "way":
            for one in [item, *before[-3:]]:  # "a fence | all the way round"
                one.state = one.state or (READ if one.get("rel") in ("around", "all") else "")
        elif item.text == "in all" and _are_all_spots(after):
            item.senses = (("rel", "in"),)  # "in all | four corners"
            after[0].quantity = None
            _term(after[0], "BOTH")
        elif item.words[0] == "fit" and any(one.get("rel") == "to" for one in after[:6]):
            item.senses = (("verb", "ADD"),)  # "fit balconies to the houses"
        elif item.text in ("wall", "walls") and _is_built(before, after):
            item.senses = (("noun", "element:wall"),)
        elif item.text in _HEADS and before and before[-1].has("direction") and after:
            item.state = READ
            if after[0].has("side"):
                after[0].senses = (("direction", after[0].get("side")),)
        elif item.text in _LAYOUTS and any(one.has("keep") for one in before[-2:]):
            item.kind, item.senses = "phrase", (("noun", "place:layout"),)
        elif (
            item.text in _JUST and after and (after[0].get("rel") in _TELLS or after[0].has("rank"))
        ):
            item.state = READ  # "right behind the church"
        elif item.text in ("single", "lone") and before and after and after[0].noun:
            item.state = READ  # "a single taxi"
        elif item.text == "march" and before and before[-1].noun_class == "person":
            item.senses = (("mode", "walk"),)
        elif item.text in _GO and (who := _who_goes(item, before, after)):
            item.kind, item.senses = "phrase", (("mode", _GAITS[who]),)
        elif _is_way_of_people(item, before, after):
            item.state = ""
        elif item.has("neg") and _spares(after):
            item.senses, after[0].state = (("keep", "keep"),), READ
        elif item.has("neg") and after and after[0].text in _CHANGES:
            _unchanged(item, after)
        elif item.text in _RELATIVE and after and after[0].text in _FACES and _noun(before):
            item.state = READ  # "houses that face the park"
            after[0].senses, after[0].words = (("rel", "near"),), ("facing",)
        elif item.text in _RELATIVE or item.words[0] in _RELATIVE:
            _relative(item, before, after)
        elif item.has("neg") and _noun(before) and _told(after):
            _term(item, "NOT")  # "houses without flat roofs"
        elif item.text == "non" and _told([one for one in after if one.kind != "mark"]):
            _term(item, "NOT")
        elif item.text == "any" and after and after[0].noun:
            item.kind, item.senses = "phrase", (("rel", "all"),)
        elif item.words[0] == "between" and _pair_follows(after):
            _term(item, "BETWEEN")
        elif item.text in _ALIKE and _object_follows(after):
            item.senses = ((TERM, "LIKE"), ("attr", _ALIKE[item.text]))
        elif item.text in ("the same", "same") and _same(after):
            _term(item, "LIKE")
        elif item.has("compared") and item.words[-1] == "than" and _object_follows(after):
            item.senses = ((TERM, "THAN"), *item.senses)
        elif item.text in _NEIGHBORS:
            item.kind, item.senses = "phrase", ((TERM, "NEIGHBORS"),)
        elif item.text in _PLACES and _is_spot(item, before, after):
            item.kind, item.senses = "phrase", ((TERM, _PLACES[item.text]),)
            every = [one for one in before[-3:] if one.get("rel") == "all"]
            for one in every:
                _term(one, "BOTH")  # "in each corner", "at both ends"
            if every and before[-1].quantity is not None:
                before[-1].state = READ  # "in all four corners"
        elif item.words[-1] in _TOWERS and len(item.words) > 1 and _is_resized(items) and not any(
            one.words[0] in ("a", "an") for one in before[-3:]
        ):  # fmt: skip
            item.kind, item.senses = "unknown", ()  # "the church tower" is a part of it
        elif item.noun == "tower" and _is_of_a_building(before, after):
            item.kind, item.senses = "unknown", ()  # a part, and no building of its own
        elif item.text == "corner" and after and after[0].noun_class in ("building", "type"):
            _term(item, "CORNER")  # "the corner houses"
        elif item.text == "outside" and _stands_by(after):
            _in_front_of(item)
        elif item.text in _ENTRANCES and _are_left_open(before):
            _term(item, "GATES")
            item.quantity, before[-1].state = before[-1].quantity, READ
        elif _is_rest(item, before, after):
            item.kind, item.senses = "phrase", ((TERM, "REST"),)
        elif item.noun == "crossing" and before and before[-1].words[0] in ("a", "another", "new"):
            item.senses = (("noun", "element:crosswalk"),)  # and no junction
        elif (
            item.text in ("its place", "their place", "place")
            and before
            and (before[-1].text in ("its", "their") and before[-2].get("rel") in ("in", "on"))
        ):
            before[-2].senses, before[-1].state = (("rel", "in"),), READ
            item.kind, item.senses = "phrase", (("rel", "it"),)
        elif item.text == "over" and after and after[0].get("rel") == "to":
            item.state = READ  # "move it over to the park"
        elif item.text == "drop" and any(one.get("attr") == "speed" for one in after[:3]):
            item.senses = (("verb", "LOWER"),)
        elif item.text in _BOUND:
            item.kind, item.senses = "phrase", (("direction", _BOUND[item.text]),)
        elif item.text in ("end", "ends") and after and after[0].text == "up":
            item.senses = (("rel", "be"),)  # "no house may end up under two floors"
        elif item.text in _GONE and before and before[-1].get("rel") == "be":
            _term(item, "REMOVE")
            before[-1].state = READ
    for at, item in enumerate(items):
        if item.text in _ONES and not (item.state or item.has(TERM)) and _is_one_of_them(items, at):
            item.kind, item.quantity, item.senses = "phrase", None, ((TERM, "ONES"),)
    for at in range(len(items)):
        _left_out(items, at)
        _stays(items, at)
        _needed(items, at)


_LISTS = ("list", "enumerate", "tell", "report", "show")
_LAYOUTS = (
    "layout", "the layout", "street layout", "street plan", "street pattern", "footprints",
    "footprint", "town plan", "ground plan",
)  # fmt: skip
# Words of a list that say no more than that it tells where things are.
_WHERE = (
    "me", "us", "where", "position", "positions", "location", "locations", "coordinate",
    "coordinates", "place", "places", "id", "ids", "ended", "end", "up", "went", "put", "placed",
    "stand", "stands", "standing", "now", "exactly", "list", "located", "sit", "sits", "were",
)  # fmt: skip


_TELLING = ("where", "which", "ids", "coordinates", "positions", "locations")


def _list(item: Item, after: Sequence[Item]) -> None:
    """Read "list where the benches ended up" as "list the benches"."""
    own: list[Item] = []
    for one in after:
        if one.is_mark(ENDS + ","):
            break
        own.append(one)
    tells = item.text in ("list", "enumerate") or any(one.text in _TELLING for one in own)
    if not tells or not any(
        one.noun or one.kind == "id" or one.get("rel") == "it" or one.text in ("its", "their")
        for one in own
    ):
        return
    item.kind, item.senses = "phrase", (("verb", "LIST"),)
    nouns = [at for at, one in enumerate(own) if one.noun]
    for at, one in enumerate(own):
        if one.text in ("its", "their"):
            one.kind, one.senses = "phrase", (("rel", "it"),)
        leads = not nouns or at < nouns[0] or one.text in ("ended up",)
        of = one.get("rel") == "of" and leads
        be = one.get("rel") == "be" and at in (len(own) - 1, len(own) - 2)
        if (all(word in _WHERE for word in one.words) and one.noun_class != "element") or (
            of or be
        ):
            one.state = READ
        if one.get("verb") and one.words[0] in ("end", "ended", "put", "place", "placed", "set"):
            one.state = READ


_BOUND = {f"{side}bound": side for side in ("north", "east", "south", "west")}
_FACES = ("face", "faces", "overlook", "overlooks")
_CHANGES = ("change", "alter", "modify")
_JUST = ("right", "just", "directly", "immediately", "straight", "somewhere", "anywhere")
# What is done to things that a "don't" before it protects them from.
_HARMS = (
    "REMOVE",
    "REPLACE",
    "MOVE",
    "PAINT",
    "CLAD",
    "LOWER",
    "RAISE",
    "SCALE",
    "CLOSE",
    "NARROW",
)


def _unchanged(item: Item, after: Sequence[Item]) -> None:
    """Pass over "don't change its colour": nothing changes that nobody asks for."""
    own = [one for one in after[1:4] if one.kind != "mark"]
    if own and own[0].text in ("its", "their", "the") and own[-1].has("attr"):
        for one in (item, after[0], *own):
            one.state = READ


def _spares(after: Sequence[Item]) -> bool:
    """Return whether a "don't" is followed by what is not to happen: "don't remove any house"."""
    verb = after[0] if after else None
    if verb is None or verb.state or verb.get("verb") not in _HARMS or verb.has("noun", "compared"):
        return False
    said = next((one for one in after[1:] if one.kind != "function" and not one.has("rel")), None)
    return said is not None and (bool(said.noun) or said.kind == "id" or said.has("rank", "color"))


def _is_rest(item: Item, before: Sequence[Item], after: Sequence[Item]) -> bool:
    """Return whether "the rest" or "the others" stands alone, for things of what was named."""
    if item.text in ("others", "the others"):
        return not (after and after[0].noun)
    return item.text == "rest" and bool(before) and before[-1].text == "the"


def _term(item: Item, name: str) -> None:
    item.kind, item.senses = "phrase", ((TERM, name),)


def _begins(before: Sequence[Item]) -> bool:
    """Return whether a clause begins here."""
    said = [item for item in before if not item.state and item.get("rel") != "please"]
    return not said or said[-1].is_mark(ENDS + ":,") or said[-1].get("rel") in ("and", "but")


def _asked(items: Sequence[Item], at: int) -> None:
    """Read "could there be a bench" as "add a bench", "would you paint it" as "paint it"."""
    for words, verb in sorted(_ASKS, key=lambda ask: -len(ask[0])):
        length, said = 0, ""
        while at + length < len(items) and len(said) < len(words):
            said = f"{said} {items[at + length].text}".strip()
            length += 1
        if said != words:
            continue
        rest = items[at + length] if at + length < len(items) else None
        new = rest is not None and (rest.kind == "quantity" or rest.words[0] in _NEW)
        if verb and not new:
            return  # "we need the street wider"
        for item in items[at : at + length]:
            item.state = READ
        if verb:
            last = items[at + length - 1]
            last.state, last.kind, last.senses = "", "phrase", (("verb", verb),)
        return


_NEW = ("a", "an", "some", "more", "another", "several", "few", "any", "lots", "plenty", "many")


def _noun(before: Sequence[Item]) -> bool:
    said = [item for item in before if item.kind != "function"]
    while len(said) > 1 and (said[-1].quantity is not None or said[-1].has(*_LOOKS)):
        said.pop()  # "a house taller than 8 m that is red"
    return bool(said) and (bool(said[-1].noun) or said[-1].text in _ONES)


def _told(after: Sequence[Item]) -> bool:
    """Return whether a look or a measure of a building follows."""
    said = next((item for item in after if item.kind != "function"), None)
    return said is not None and (
        said.has(*_LOOKS) or said.get("slot").startswith(("building.roof=", "style="))
    )


def _relative(item: Item, before: Sequence[Item], after: Sequence[Item]) -> None:
    """Read "that is not red" as what a thing is: nothing of it but "not red" counts."""
    if not _noun(before):
        return
    passed: list[Item] = [] if item.get("rel") == "with" else [item]
    for here, one in enumerate(after):
        denies = one.has("neg")
        if denies and _told(after[here + 1 :]):
            _term(one, "NOT")
        elif one.get("rel") == "be":
            passed.append(one)
            continue
        elif not (one.kind == "function" or one.has("compared")):
            if here and not (one.has(*_TOLD, "rel", "rank", TERM) or one.quantity is not None):
                return
        else:
            continue
        break
    for one in passed:
        if one is item:
            _term(one, "WHO")
        else:
            one.state = READ


def _pair_follows(after: Sequence[Item]) -> bool:
    """Return whether "A and B" follow, which are no numbers."""
    said = [item for item in after[:8] if item.kind != "function"]
    return len(said) > 2 and said[0].quantity is None and any(
        one.get("rel") == "and" for one in said[1:5]
    )  # fmt: skip


_LEAVES = ("leave", "leaves", "leaving", "exit", "exiting", "quitting")
_OUT = ("from", "out of", "away from")
_GO = (
    "go", "goes", "going", "come", "comes", "coming", "head", "heads", "heading", "headed",
    "travel", "travels", "travelling", "rush", "rushes", "rushing", "run", "runs", "running",
    "race", "races", "racing", "speed", "speeds", "speeding", "drive", "drives", "driving",
)  # fmt: skip
_GAITS = {"vehicle": "drive", "person": "walk"}
_MOVERS = ("person", "vehicle")
_PLACES_LEFT = ("element", "type", "building", "road")


def _in_front_of(item: Item) -> None:
    """Let "outside" be "in front of"."""
    item.kind, item.senses, item.words = "phrase", (("rel", "near"),), ("in", "front", "of")


def _is_way_of_people(item: Item, before: Sequence[Item], after: Sequence[Item]) -> bool:
    """Say of words for where people or vehicles come from or stand what they do in the grammar.

    "People leave | the square", "walking from | the station", "an ambulance outside | the school".
    """
    mover = next((one for one in reversed(before) if one.noun), None)
    if mover is None or mover.noun_class not in _MOVERS or not _object_follows(after[:3]):
        return False
    leaves = item.text in _LEAVES and (before[-1] is mover or before[-1].has("mode"))
    leaves = leaves and any(one.noun_class in _PLACES_LEFT for one in after[:3])
    drives = _sets_out(item, before, after)
    if drives or (mover.noun_class == "person" and (leaves or item.text in _OUT)):
        _term(item, "FROM")
    elif item.text == "outside":
        _in_front_of(item)
    else:
        return False
    return True


def _who_goes(item: Item, before: Sequence[Item], after: Sequence[Item]) -> str:
    """Return the class of who is on the way, "" for nobody: "buses that | run from the church"."""
    who = [one for one in before if one.text not in (*_RELATIVE, "and")]
    bound = bool(after) and (after[0].get("rel") == "to" or after[0].text == "from")
    if not (bound and who):
        return ""
    again = before[-1].get("rel") == "and" and any(one.noun_class == "person" for one in who)
    found = "person" if again else who[-1].noun_class
    if found not in _GAITS or (found == "person" and item.has("mode")):
        return ""
    for one in before[-1:]:
        one.state = READ if one.text in _RELATIVE else one.state
    return found


def _sets_out(item: Item, before: Sequence[Item], after: Sequence[Item]) -> bool:
    """Return whether vehicles come from a place: "a bus from | the church to the park"."""
    taken = any(one.get("verb") in ("REMOVE", "MOVE", "CLOSE") for one in before)
    under_way = any(one.get("mode") == "drive" or one.text in _GO for one in before)
    bound = any(one.get("rel") == "to" for one in after[:6])
    return item.text == "from" and not taken and (under_way or bound)


def _object_follows(after: Sequence[Item]) -> bool:
    said = next((item for item in after if item.kind != "function"), None)
    return said is not None and (
        bool(said.noun) or said.kind == "id" or said.text in _NEIGHBORS or said.has("rank", "side")
        or said.get("rel") in ("it", "all", "rest")
    )  # fmt: skip


def _same(after: Sequence[Item]) -> bool:
    """Read "the same colour as", of which "as" says nothing more."""
    if len(after) < 3 or (
        not after[0].has("attr", "rank", "color", "material")
        and (after[0].text not in ("style", "roof", "height", "color", "material"))
    ):
        return False
    if after[1].get("rel") not in ("to", "with") and after[1].text != "as":
        return False
    after[1].state = READ
    after[0].kind, after[0].senses = "phrase", (("attr", after[0].text),)
    return True


def _is_spot(item: Item, before: Sequence[Item], after: Sequence[Item]) -> bool:
    """Return whether an end or a corner is that of something: "at the western end of the park".

    What it is of may have been told before: "... and a pond in the middle".
    """
    of = bool(after) and after[0].get("rel") == "of"
    placed = any(one.get("rel") in ("on", "in", "to", "near", "by") for one in before[-3:])
    side = bool(before) and before[-1].has("side")
    said = [one for one in before[-4:] if one.kind != "function" and one.get("rel") != "all"]
    if (
        said
        and said[-1].quantity is not None
        and any(one.get("rel") == "all" for one in before[-3:])
    ):
        said.pop()  # "in all four corners"
    alone = bool(said) and said[-1].get("rel") in ("on", "in") and not (after and after[0].noun)
    if _PLACES[item.text] == "MIDDLE":
        return alone and not item.has("slot")
    return (placed and (of or side)) or alone


_TOWERS = ("tower", "spire", "steeple")
_SIZES_ANEW = ("DOUBLE", "TRIPLE", "QUADRUPLE", "HALVE", "RAISE", "LOWER", "SCALE")


def _is_resized(items: Sequence[Item]) -> bool:
    """Return whether a request makes anything higher or lower."""
    return any(
        one.get("rel") in ("twice", "thrice", "times", "half as")
        or one.get("verb") in _SIZES_ANEW
        or (one.quantity is not None and one.quantity.dimension in ("length", "floors"))
        for one in items
    )


_HEADS = ("heading", "going", "running", "leading")


def _stays_as(after: Sequence[Item]) -> bool:
    """Return whether what follows an "else" says no more than that it is not to change."""
    own: list[Item] = []
    for one in after[1:]:
        if one.kind == "mark":
            break
        own.append(one)
    words = [word for one in own for word in one.words]
    kept = all(word in _MAY_CHANGE for word in words)
    for one in own if kept else ():
        one.state = READ
    return kept


_MAY_CHANGE = ("may", "should", "must", "can", "is", "to", "be", "change", "changes", "changed",
               "touched", "altered", "please", "shall", "will", "gets", "get")  # fmt: skip


def _is_built(before: Sequence[Item], after: Sequence[Item]) -> bool:
    """Return whether a wall stands by itself: "build a | wall along the river"."""
    made = any(one.get("verb") in ("ADD", "MAKE") for one in before)
    said = [one for one in after if one.quantity is None or one.quantity.dimension != "length"]
    return made and bool(said) and said[0].get("rel") in ("along", "around")


_SLANG = ("pop", "plonk", "whack", "bung", "chuck", "slap", "drop")
_ON_FOOT = ("for", "pedestrians", "walkers", "and", "cyclists", "only", "people", "on", "foot",
            "bikes", "pedestrian")  # fmt: skip


def _is_for_walkers(after: Sequence[Item]) -> bool:
    """Return whether a bridge is told to be for those on foot, whose words count as read."""
    begins = (at for at, one in enumerate(after)
              if one.text == "for" or one.get("slot") == "not=vehicle")  # fmt: skip
    begin = next(begins, len(after))
    told: list[Item] = []
    for one in after[begin:]:
        if one.kind != "function" and not all(word in _ON_FOOT for word in one.words):
            break
        told.append(one)
    walkers = (one.noun == "pedestrian" or one.get("slot") == "not=vehicle" for one in told)
    if not any(walkers) and not any(one.text == "on foot" for one in told):
        return False
    while told[-1].get("rel") == "and":
        told.pop()
    for one in told:
        one.state, one.senses = READ, ()
    if begin and after[begin - 1].is_mark(","):
        after[begin - 1].state = READ
    return True


def _join_form(after: Sequence[Item]) -> None:
    """Let a footbridge have what commas part from it: "over the river, 3 m wide, by the church"."""
    for mark, one in pairwise(after):
        if mark.is_mark(ENDS):
            return
        formed = one.get("rel") in _TELLS or one.quantity is not None or one.has("material")
        if mark.is_mark(",") and (formed or one.text in _JUST):
            mark.state = READ


def _is_of_a_building(before: Sequence[Item], after: Sequence[Item]) -> bool:
    """Return whether a tower is that of a building: "its tower", "the tower of the church"."""
    of = len(after) > 1 and after[0].get("rel") == "of"
    named = next((one for one in after[1:] if one.kind != "function"), None)
    if of and named is not None and named.noun_class == "type":
        return True
    own = bool(before) and before[-1].text in ("its", "their")
    return own or (bool(before) and before[-1].noun_class == "type")


def _are_all_spots(after: Sequence[Item]) -> bool:
    """Return whether a number of corners or ends follows."""
    counted = len(after) > 1 and after[0].quantity is not None
    return counted and after[1].text in _PLACES


def _stands_by(after: Sequence[Item]) -> bool:
    """Return whether buildings follow, of which something may stand outside."""
    said = [one for one in after if one.kind != "function" and one.get("rel") not in ("all", "of")]
    while said and (said[0].quantity is not None or said[0].has("rank", "ordinal", *_LOOKS)):
        said = said[1:]
    return bool(said) and said[0].noun_class in ("building", "type")


def _are_left_open(before: Sequence[Item]) -> bool:
    """Return whether so many openings are told of a barrier: "a fence with two | entrances"."""
    counted = bool(before) and before[-1].quantity is not None
    counted = counted and before[-1].quantity.dimension == "count"  # type: ignore[union-attr]
    return counted and any(one.noun in _BARRIERS for one in before)


def _is_one_of_them(items: Sequence[Item], at: int) -> bool:
    """Return whether "the one" or "those" is told by what follows: "those along the river"."""
    nothing = Item("mark", (0, 0), ("",))
    after = next((item for item in items[at + 1 :] if item.kind != "function"), nothing)
    if not _said_before(items[max(at - NEAR, 0) : at]):
        return False
    before = items[at - 1] if at else None
    looking = before is not None and before.has("color", "material", "rank", "size", "side")
    if items[at].text in ("one", "ones") and looking:
        return True
    if items[at].text == "one" and not (before is not None and before.text == "the"):
        return False
    pointed = after.get("rel") in _POINTS or after.has("rank", "side", TERM)
    return pointed or (after.quantity is not None and after.quantity.exact is None)


def _said_before(before: Sequence[Item]) -> bool:
    return any(item.noun or item.kind == "id" or item.has("except") for item in before)


def _left_out(items: Sequence[Item], at: int) -> None:
    """Let the grammar read what is left out, where more than a name says what that is."""
    item = items[at]
    keeps = item.has("keep") and not item.state and protects(items, at)
    if not keeps and not item.has("except") and not is_exception(items, at):
        return
    if item.has("except") and not item.has("slot") and not items[at + 1 :]:
        return
    end = at + 1
    while end < min(len(items), at + NEAR) and not items[end].is_mark(ENDS + ",:"):
        end += 1
    inner = [one for one in items[at + 1 : end] if not one.state]
    nouns = [place for place, one in enumerate(inner) if one.noun or one.kind == "id"]
    told = any(one.has("rank", "side", TERM) or one.get("rel") in _TELLS for one in inner) or any(
        one.has("color", "material", "size") or one.quantity is not None
        for one in inner[: nouns[-1] if nouns else 0]
    )
    named = any(one.noun or one.kind == "id" or one.get(TERM) == "ONES" for one in inner)
    if not told or not named or (keeps and any(one.has("verb") for one in inner)):
        return
    item.senses, item.state = ((TERM, "EXCEPT"),), ""
    for one in inner:
        if one.has("unchanged") or one.text in ("alone", "as they are", "as it is"):
            one.state = READ


def _clause_before(items: Sequence[Item], at: int) -> int:
    """Return where the clause begins that ends at an item."""
    start = at
    while start and at - start < NEAR:
        before = items[start - 1]
        if before.is_mark(ENDS + ",:") or before.get("rel") in ("and", "but"):
            break
        start -= 1
    return start


_STAY = ("stay", "stays", "remain", "remains", "must stay", "stay put")


def _stays(items: Sequence[Item], at: int) -> None:
    """Read "the biggest one must stay" as "except the biggest one"."""
    item = items[at]
    if item.state or not (item.has("unchanged") or item.text in _STAY):
        return
    start = _clause_before(items, at)
    inner = [one for one in items[start:at] if not one.state]
    named = any(one.noun or one.kind == "id" or one.get(TERM) == "ONES" for one in inner)
    told = any(one.has("rank", "side", TERM) or one.get("rel") in _TELLS for one in inner)
    article = bool(inner) and inner[0].kind == "function"
    if not (named and told and article) or any(one.has("verb", "keep") for one in inner):
        return
    inner[0].kind, inner[0].senses = "phrase", ((TERM, "EXCEPT"),)
    for one in (*inner[1:], *items[at : at + 4]):
        if one is item or one.get("rel") in ("be", "to") or one.text in ("as it is", "as they are"):
            one.state = READ


_NEEDED = ("needed", "wanted", "required", "missing", "called for")


def _needed(items: Sequence[Item], at: int) -> None:
    """Read "a crossing is needed by the park" as "add a crossing by the park"."""
    start = _clause_before(items, at)
    item, before = items[at], items[at - 1] if at else None
    if item.text not in _NEEDED or before is None or before.get("rel") != "be":
        return
    first = items[start]
    if first.words[0] in ("a", "an", "some", "another", "more") and not first.has("verb"):
        first.kind, first.senses = "phrase", (("verb", "ADD"),)
        before.state = item.state = READ
        for one in items[start:at]:
            one.state = READ if one.text == "new" else one.state


_TELLS = ("near", "along", "around", "in", "on", "by", "from")
