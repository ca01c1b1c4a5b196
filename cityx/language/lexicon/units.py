"""Units of measure: what a quantity measures, and how much of the SI unit it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from cityx.language.lexicon.words import Word

MILE, FOOT, YARD = 1609.344, 0.3048, 0.9144

_TABLE = {
    "length": {
        1.0: "m|meter|mtr", 1000.0: "km|kilometer|kms|klick", 0.01: "cm|centimeter",
        FOOT: "ft|foot|feet", YARD: "yd|yds|yard", MILE: "mi|mile", 0.0254: "inch|inches",
        100.0: "hm",
    },
    "area": {
        1.0: "m2|sqm|sq m|square m|square meter|sq meter|meter squared|m ²",
        1e6: "km2|sqkm|sq km|square km|square kilometer|sq kilometer|kilometer squared|km ²",
        1e4: "ha|hectare", 4046.8564224: "acre|ac",
        MILE**2: "square mile|sq mile|sq mi|square mi",
        FOOT**2: "sq ft|square foot|square feet|sqft",
        YARD**2: "square yard|sq yd",
    },
    "speed": {
        MILE / 3600: "mph|mile per hour|mile an hour", 1.0: "m / s|meter per second|mps",
        1 / 3.6: "km / h|kmh|kph|kilometer per hour|kilometer an hour|km h",
    },
    "floors": {1.0: "story|floor|level|stories|floored|storied|leveled"},
    "lanes": {1.0: "lane|laned|traffic lane|driving lane"},
    "share": {0.01: "%|percent|per cent|pct|percentage"},
    "temperature": {1.0: "° c|degree celsius|degree c|celsius|degree centigrade|℃"},
    "angle": {1.0: "degree|deg|°"},
    "half_day": {0.0: "am|a . m .", 12.0: "pm|p . m ."},
    "hour": {1.0: "o ' clock|o'clock|oclock|h"},
    "duration": {1.0: "hour|hr", 1 / 60: "minute|min", 24.0: "day"},
    "people": {1.0: "inhabitant|resident"},
}  # fmt: skip

UNITS: Mapping[tuple[str, ...], tuple[str, float]] = MappingProxyType(
    {
        tuple(name.split()): (dimension, factor)
        for dimension, table in _TABLE.items()
        for factor, names in table.items()
        for name in names.split("|")
    }
)
_NAMES = {("level", "crossing")}  # a unit and a word behind it that together name a thing
_LONGEST = max(map(len, UNITS))


def read_unit(words: Sequence[Word], at: int) -> tuple[str, float, int] | None:
    """Read the unit that begins at a word, also after a hyphen.

    Returns
    -------
    found
        What it measures ("length", "area", "floors"...), its size in SI units and the number of
        words it takes; None where no unit begins.
    """
    skip = int(at + 1 < len(words) and words[at].text == "-" and words[at + 1].kind == "word")
    begin = at + skip
    for length in range(min(_LONGEST, len(words) - begin), 0, -1):
        texts = [word.text for word in words[begin : begin + length]]
        found = UNITS.get(tuple(texts)) or UNITS.get(tuple(_single(text) for text in texts))
        after = words[begin + length].text if begin + length < len(words) else ""
        if found is not None and (texts[-1], _single(after)) not in _NAMES:
            return found[0], found[1], length + skip
    return None


def _single(text: str) -> str:
    """Return a unit in the singular."""
    plural = len(text) > 3 and text.endswith("s") and not text.endswith("us")
    return text[:-1] if plural else text
