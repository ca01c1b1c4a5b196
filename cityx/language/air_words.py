"""The air: how far one sees, clouds, wind, lit windows, where the sun stands, and dates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from cityx.language.brief import Note, Slot
from cityx.language.here import SIDES_OF_A_VIEW, Findings, Here
from cityx.language.scan import ENDS, Item
from cityx.language.scopes import NEGATED, READ
from cityx.system.tables import table

MONTHS: Mapping[str, int] = MappingProxyType({
    name: number for number, name in enumerate(
        ("january", "february", "march", "april", "may", "june", "july", "august", "september",
         "october", "november", "december"), 1)
})  # fmt: skip
LAST = 31  # day of a month
MIDDLE = 15  # day of a month that is named alone
# Early or late in a part of the day or of the year -> an hour or a word for it, a date.
PARTS_OF_DAY = table("language/things", str, "parts_of_day")
PARTS_OF_YEAR = table("language/things", str, "parts_of_year")
_SEEN, _CLOUDS = ("visibility", "see", "sight"), ("weather=cloudy", "weather=overcast")
_SKIES = ("weather=clear", *_CLOUDS, "weather=fog", "weather=haze")
_COVERED = 0.85  # of the sky, from which it is overcast
_LIES = ("roof", "landscape", "road", "everything")  # what snow lies on
_REACH, _FAR = 4, 7
_LIT, _DARK = "lights=on", "windows.lit=none"
FEW_LIT, MANY_LIT = 0.06, 0.75  # shares of windows of which "few" and "most" are lit


def read_air(here: Here) -> None:
    """Read what is said of the air beyond the kind of weather."""
    item = here.item
    if _early_or_late(here):
        return
    if item.quantity is not None:
        _measured(here)
    elif item.text in MONTHS:
        _date(here)
    elif item.has("side"):
        _from(here)
    elif item.get("slot").startswith("weather=snow"):
        _lying(here)
    elif item.get("amount") or item.text == "most":
        _some_windows(here)


def settle_lamps(found: Findings) -> None:
    """Let lamps that are off stand: "a power cut, no street lights" denies none of them."""
    if any((slot.key, slot.value) == ("lights", "off") for slot in found.slots):
        found.negated[:] = [one for one in found.negated if one.value not in _LAMPS]
    on = [one for one in found.slots if (one.key, one.value) == ("lights", "on")]
    lit = [one for one in on if "window" in one.text.lower()]
    for share in [one for one in found.slots if one.key.endswith(".share")]:
        said = next((one for one in lit if _in_a_sentence(found.text, one, share)), None)
        if said is None:
            continue
        span = (said.span[0], share.span[1])  # "lit windows in a tenth of the houses"
        told = replace(share, key="windows.lit", span=span, text=found.text[slice(*span)])
        found.slots[found.slots.index(share)] = told
        found.slots.remove(said)
        lit.remove(said)
        found.notes[:] = [note for note in found.notes
                          if not (span[0] <= note.span[0] and note.span[1] <= span[1] + FURTHER)
                          ]  # fmt: skip


FURTHER = 20  # letters behind a share, that say of what it is


def _in_a_sentence(text: str, one: Slot, other: Slot) -> bool:
    """Return whether a word stands before another in one sentence."""
    between = text[one.span[1] : other.span[0]]
    return bool(between) and not set(ENDS).intersection(between)


_LAMPS = ("streetlight", "light")


def _early_or_late(here: Here) -> bool:
    """Read "late afternoon", "early on a summer morning" and "late in the winter"."""
    first = here.item.words[0] if here.item.words else ""
    if first not in ("early", "late"):
        return False
    told = here.item if here.item.has("slot") else _part_behind(here)
    key, _, value = ("" if told is None else told.get("slot")).partition("=")
    if told is None or key not in ("time", "season") or told.state == NEGATED:
        return False
    if key == "time":
        part = PARTS_OF_DAY.get(f"{first} {value}")
        if part is None:
            here.found.add(key, value, told)
            said = f'"{first}" of "{here.found.said(told)}" is left open.'
            here.found.notes.append(Note("left_open", said, here.item.span))
        else:
            here.found.add(key, part, here.item, told)
    else:
        date = PARTS_OF_YEAR[f"{first} {value}"]
        if told.text in MONTHS:
            date = f"{MONTHS[told.text]:02d}-{PARTS_OF_YEAR[f'{first} month']}"
        here.found.add(key, value, told)
        here.found.add("date", date, here.item, told)
    here.item.state = here.item.state or READ
    return True


def _part_behind(here: Here) -> Item | None:
    """Return the part of the day or the year that "early" or "late" is in: "late in the | day"."""
    seen: Item | None = None
    for item in here.items[here.at + 1 : here.at + 2 + _REACH]:
        key = item.get("slot").partition("=")[0]
        if key == "time":
            return item
        seen = seen or (item if key == "season" else None)
        if item.kind not in ("function",) and not item.has("rel", "slot"):
            break
    return seen


def _measured(here: Here) -> None:
    """Read metres that one sees, the speed of the wind, and shares of the sky and of windows."""
    item, quantity = here.item, here.quantity
    if quantity.dimension == "length":
        seen = _beside(here, lambda one: one.get("attr") == "visibility")
        if quantity.attribute == "visibility" or seen is not None:
            here.found.add_bounded("visibility", quantity, item, *([seen] if seen else []))
    elif quantity.dimension == "speed":
        wind = _beside(here, lambda one: one.get("slot").startswith("wind="))
        if wind is not None:
            here.found.add_bounded("wind", quantity, item, wind)
    elif quantity.dimension in ("share", "part"):
        _share(here)
    elif quantity.dimension == "count":
        _one_in_ten(here)


def _beside(here: Here, is_it: object) -> Item | None:
    """Return what a measure is of: next to it, or a few items before or behind in its clause."""
    assert callable(is_it)
    for step in (-1, 1):
        for away in range(1, _REACH):
            at = here.at + step * away
            if not 0 <= at < len(here.items) or here.items[at].is_mark(ENDS + ","):
                break
            if is_it(here.items[at]):
                return here.items[at]
    return None


def _share(here: Here) -> None:
    """Read "half the sky covered with clouds" and "a quarter of the windows are lit"."""
    behind: list[Item] = []
    for one in here.items[here.at + 1 : here.at + 2 + _REACH]:
        if one.is_mark(ENDS + ",") or one.quantity is not None:
            break
        behind.append(one)
    nouns = [one for one in behind if one.has("noun")]
    clouds = next((one for one in behind if one.get("slot") in _CLOUDS), None)
    lit = next((one for one in behind if one.get("slot") in (_LIT, _DARK)), None)
    first = nouns[0].noun if nouns else "window" if lit in behind[:2] and _is_dark(lit) else ""
    value = here.quantity.exact
    if clouds is not None and first in ("", "sky"):
        here.found.add_bounded("cloud.share", here.quantity, here.item, clouds)
        covered = value is not None and value >= _COVERED
        here.found.add("weather", "overcast" if covered else "cloudy", clouds)
    elif lit is not None and first == "window":
        share = here.quantity
        if _is_dark(lit):
            share = replace(share, low=_rest(share.high), high=_rest(share.low))
        here.found.add_bounded("windows.lit", share, here.item, lit, *nouns[:1])
    else:
        return
    for one in behind:
        one.state = one.state or (READ if one.noun in ("sky", "window") or one.has("verb") else "")


def _is_dark(item: Item | None) -> bool:
    return item is not None and item.get("slot") == _DARK


def _rest(share: float | None) -> float | None:
    return None if share is None else round(1.0 - share, 4)


def _one_in_ten(here: Here) -> None:
    """Read "one window in ten is lit"."""
    behind = here.items[here.at + 1 : here.at + 6]
    if len(behind) < 4 or behind[0].noun != "window" or behind[1].get("rel") != "in":
        return
    of, lit = behind[2].quantity, next((x for x in behind if x.get("slot") == "lights=on"), None)
    own = here.quantity.exact
    if of is None or not of.exact or own is None or lit is None or own > of.exact:
        return
    here.found.add("windows.lit", round(own / of.exact, 4), here.item, behind[2], lit, behind[0])
    for one in behind[1:]:
        one.state = one.state or (READ if one.get("rel") in ("in", "be") else "")


def _some_windows(here: Here) -> None:
    """Read "only a few of the windows are lit", "many lit windows" and "most windows dark"."""
    behind = here.items[here.at + 1 : here.at + 2 + _REACH]
    window = next((one for one in behind if "window" in (one.noun, one.get("head")[6:])), None)
    lit = next((one for one in behind if one.get("slot") in (_LIT, _DARK)), None)
    between = [one for one in behind if one.has("noun") and one is not window]
    dark = _is_dark(lit)
    if lit is None or (window is None and not dark) or between:
        return
    few = here.item.get("amount") == "few"
    before = [here.before] if here.before is not None and here.before.has("exact") else []
    own = [lit] if window is None else [lit, window]
    share = (MANY_LIT if few else 1 - MANY_LIT) if dark else (FEW_LIT if few else MANY_LIT)
    here.found.add("windows.lit", share, here.item, *before, *own)
    for one in behind[: behind.index(lit)]:
        one.state = one.state or (READ if one.get("rel") in ("of", "be") else "")


def _date(here: Here) -> None:
    """Read the day beside a month: "21 December", "the 21st of June"; its middle for none."""
    near = [here.items[at] for at in (here.at - 1, here.at - 2, here.at + 1)
            if 0 <= at < len(here.items)]  # fmt: skip
    if len(near) > 1 and near[0].get("rel") != "of" and here.at > 1:
        near.pop(1)
    for one in near:
        day = _day(one)
        if day and one.state == "":
            date = f"{MONTHS[here.item.text]:02d}-{day:02d}"
            here.found.add("date", date, one)
            return
    season = here.item.get("slot").partition("season=")[2]
    if season:  # "an evening in | November" may be dark
        here.found.add("season", season, here.item)
        here.found.add("date", f"{MONTHS[here.item.text]:02d}-{MIDDLE:02d}", here.item)


def _day(item: Item) -> int:
    quantity = item.quantity
    if quantity is not None and quantity.dimension == "count" and quantity.exact is not None:
        day = quantity.exact
        return int(day) if day == int(day) and 1 <= day <= LAST else 0
    word = item.text.replace(" ", "")
    number = word.removesuffix("st").removesuffix("nd").removesuffix("rd").removesuffix("th")
    told = item.get("ordinal") or (number if number != word and number.isdigit() else "")
    return int(told) if told.isdigit() and 1 <= int(told) <= LAST else 0


def _from(here: Here) -> None:
    """Read where the sun stands and the wind comes from: "a low sun in the | west"."""
    if here.item.text in SIDES_OF_A_VIEW:
        return
    for back in range(1, _FAR):
        at = here.at - back
        if at < 0 or here.items[at].is_mark(ENDS + ",") or here.items[at].state == NEGATED:
            return
        item = here.items[at]
        slot, words = item.get("slot"), item.words
        if slot.startswith("wind="):
            here.found.add("wind.from", here.item.get("side"), here.item)
            return
        lamp = at > 0 and (here.items[at - 1].has("color") or here.items[at - 1].text == "traffic")
        if {"sun", "sunlight", "sunshine"} & set(words) or (item.text == "light" and not lamp):
            here.found.add("sun.side", here.item.get("side"), here.item)
            return
        if item.has("noun"):
            return


def _lying(here: Here) -> None:
    """Read snow that lies under another sky: "sunny, with snow on the roofs"."""
    others = [one for one in here.items if one.get("slot").startswith(_SKIES)]
    behind = here.items[here.at + 1 : here.at + 4]
    on = (bool(behind) and behind[0].get("rel") in ("on", "in")) or (
        here.item.words[0] == "snow"
        and (here.item.words[-1] in ("covered", "lies", "capped", "clad", "topped"))
    )
    under = [one for one in behind[:3] if one.noun in _LIES]
    lies = bool(under) and here.item.text == "snow" and on  # "winter, with snow on the roofs"
    if not (on and (others or lies)):
        return
    light = "snow.intensity=light" in here.item.get("slot")
    here.found.add("snow.cover", "low" if light else "high", here.item, *under)
