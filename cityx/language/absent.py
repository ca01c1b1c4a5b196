"""What is not there: things that a text takes as known, and that nobody but its writer knows.

"My grandfather's street", "the same as last time" and the "it" of "move it to the left" can only be
asked about: a town that is built instead would be one that nobody wanted.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from cityx.language.brief import Conflict, Question, Slot
from cityx.language.conflicts import area_of
from cityx.language.scan import ENDS, Item, begin_of, end_of
from cityx.language.scopes import NEGATED
from cityx.town.quarter_kinds import DWELLINGS

_HOMES = (
    "street|road|lane|avenue|village|town|city|house|home|flat|farm|neighbou?rhood|district|block|"
    "quarter|estate|suburb|school|hometown|place|childhood \\w+"
)
_OWN = re.compile(
    rf"\b(?:my|our)(?: \w+(?:['’]s?)?){{0,2}}? (?:{_HOMES})\b(?! (?:of|for)\b|-)", re.IGNORECASE
)
# A place that only the life of the writer tells: "where I grew up".
_LIVED = re.compile(
    rf"\b(?:the )?(?:{_HOMES}) (?:where|that|in which)? ?(?:i|we|my \w+|our \w+) "
    r"(?:grew up|grew|live|lived|was|were|work|worked|used|met|married|visited|had|went)\b"
    r"|\bwhere (?:i|we) (?:grew up|live|lived|was born|were born)\b",
    re.IGNORECASE,
)
_BEFORE = re.compile(
    r"\b(?:(?:the )?same (?:one )?as (?:before|last time|yesterday|the (?:last|previous|other) one)"
    r"|(?:as|like) (?:last time|last week|yesterday|the (?:last|previous|other) one)"
    r"|(?:the )?(?:one|thing|town|city|street|picture|version|model)s? (?:that )?(?:i|we|you) "
    r"(?:showed|told|sent|talked|discussed|made|built|saw|had|did|got|ordered|used)"
    r"|the (?:last|previous) one|the other (?:thing|two|three|ones))\b",
    re.IGNORECASE,
)
_PRONOUNS = ("it", "them", "that", "those", "these", "this", "this one", "that one")
_POINTING = ("that", "those", "these", "that one", "this one", "them")  # "make it a village"
_MOVING = (
    "MOVE", "ROTATE", "COPY", "REMOVE", "REPLACE", "SCALE", "SWAP", "PAINT", "LOWER", "RAISE",
)  # fmt: skip
_PLACING = ("ADD",)
_FULL = ("traffic=heavy", "traffic=medium")
_EACH = ("each", "every", "own", "per", "apiece")
_PLOTS = ("plot", "plots", "footprint", "footprints", "garden", "gardens", "lot", "lots", "yard")
_APART = ("other", "another", "apart", "next", "nearest", "neighbour", "neighbor")
_NIGHTS = ("night", "midnight")
_SUN = ("sun", "sunshine", "sunlight")
SPREAD = 0.7  # of the square of a distance: ground that each takes, those at the border less
_HIGH = ("high", "overhead", "shining", "bright", "blazing", "zenith")


def questions_of(text: str, items: Sequence[Item]) -> Iterator[Question]:
    """Yield what has to be asked of a text that comes without a city and without a file."""
    own = _OWN.search(text) or _LIVED.search(text)
    if own is not None:
        said = own.group()
        yield Question(
            f'Which place is "{said}"? Give a map of it, as cityx fetch does, or tell in words how '
            "it looks."
        )
    past = _BEFORE.search(text)
    if past is not None and not _is_told(text[: past.start()], past.group()):
        yield Question(
            f'What is "{past.group()}"? Nothing of an earlier city is known here; give its folder '
            "to cityx edit, or say what it is."
        )
    elif (item := _pronoun(items)) is not None:
        said = text[slice(*item.span)]
        yield Question(
            f'What is "{said}"? No city came with the text, and it names nothing before; give a '
            "folder to cityx edit, or name what is meant."
        )


def _is_told(before: str, said: str) -> bool:
    """Return whether "the other two" are two of what was told: "four towers, ... the other two"."""
    counted = re.search(r"\b(?:two|three|four|five|six|\d+|several|both)\b", before, re.IGNORECASE)
    return "other" in said.lower() and counted is not None


def _pronoun(items: Sequence[Item]) -> Item | None:
    """Return the pronoun of an order that stands for nothing: "move | it to the left"."""
    for at, item in enumerate(items[:-1]):
        if item.has("noun") or item.is_mark(ENDS):
            return None
        after = items[at + 1]
        pointed = item.get("verb") == "MAKE" and after.text in _POINTING
        moved = item.get("verb") in (*_MOVING, *_PLACING) and after.text in _PRONOUNS
        if not (pointed or moved):
            continue
        rest = items[at + 2 :]
        ends = next((n for n, one in enumerate(rest) if one.kind == "mark"), len(rest))
        named = any(one.has("noun") for one in rest[:ends])
        return None if named and item.get("verb") in _PLACING else after
    return None


def clashes(
    items: Sequence[Item], slots: Sequence[Slot], negated: Sequence[Slot]
) -> Iterator[Conflict]:
    """Yield wishes that cannot both hold, one of which is said of one place or thing alone."""
    denial = next((one for one in negated if one.value == "vehicle" and one.span[1]), None)
    full = next((one for one in items if one.get("slot") in _FULL and one.state != NEGATED), None)
    if denial and full and not denial.span[0] <= full.span[0] < denial.span[1]:
        yield Conflict(
            "denied_and_wanted:vehicle",
            f'"{denial.text}" leaves no traffic, but "{full.text}" asks for it; leave one of the '
            "two out, or say where each of them holds.",
            (denial.span, full.span),
        )
    yield from _crowded(items, slots)
    night = next((one for one in slots if one.key == "time" and one.value in _NIGHTS), None)
    for at, item in enumerate(items if night is not None else ()):
        if item.text not in _SUN:
            continue
        near = {one.text for one in items[max(0, at - 2) : at + 4]}
        if night is not None and near.intersection(_HIGH):
            yield Conflict(
                "time_against_sun",
                f'"{night.text}" has no sun in the sky, but "{item.text}" is to stand there; name '
                "one of the two.",
                (night.span, item.span),
            )
            return


def _crowded(items: Sequence[Item], slots: Sequence[Slot]) -> Iterator[Conflict]:
    """Yield more buildings than have room where each has ground, or a distance, of its own."""
    area = area_of(slots)
    counts = [one for one in slots if one.key.endswith((".count", ".count.min"))
              and one.key.partition(".")[0] in ("building", *DWELLINGS)]  # fmt: skip
    if area is None or not counts:
        return
    count = max(counts, key=lambda one: float(one.value))
    for at, item in enumerate(items):
        low = None if item.quantity is None else item.quantity.low
        if item.quantity is None or not low or item.quantity.dimension not in ("area", "length"):
            continue
        told = items[begin_of(items, at, ENDS) : end_of(items, at, ENDS)]
        if not any(one.text in _EACH for one in told):
            continue
        near = {one.text for one in items[max(0, at - 4) : at + 5]}
        ground = 0.0
        if item.quantity.dimension == "area" and near.intersection(_PLOTS):
            ground = low
        elif item.quantity.dimension == "length" and near.intersection(_APART):
            ground = SPREAD * low**2
        most = int(area[0] / ground) if ground else 0
        if ground and float(count.value) > most:
            yield Conflict(
                "too_many:building",
                f'{count.value:g} buildings with "{item.text}" each do not fit on {area[0]:g} m2; '
                f"about {most} do. Change the number, the measure or the size of the city.",
                (count.span, item.span, area[1].span),
            )
            return
