"""Numbers, directions, colours and yes or no as mappers write them. Nothing here ever raises."""

from __future__ import annotations

import re
from functools import lru_cache
from math import inf, isfinite, nan, radians

from cityx.system.tables import table

_NUMBER = re.compile(r"[-+]?(?:\d+(?:[.,]\d+)?|[.,]\d+)(?:[eE][-+]?\d{1,3})?")
_FEET = re.compile(r"^(\d+(?:[.,]\d+)?)\s*(?:'|′|’|ft|feet|foot)\s*(?:(\d+(?:[.,]\d+)?)\s*(?:\"|″|”|''|in|inch|inches)?)?$")  # fmt: skip  # noqa: E501
_INCHES = re.compile(r"^(\d+(?:[.,]\d+)?)\s*(?:\"|″|”|in|inch|inches)$")
# "RU:urban", "BE-VLG:zone30": what the law of a country says, of which no part is another's.
_LAW = re.compile(r"^([A-Za-z]{2})(?:-[A-Za-z]+)?:([a-z_]+(?::?\d+)?)$")
_ZONE = re.compile(r"^zone:?(\d{1,3})$")
_IN_MILES = ("GB", "UK", "US")
_ABOUT = re.compile(r"^(?:~|≈|<|>|=|ca\.?|c\.|approx\.?|about|circa|est\.?)+\s*", re.IGNORECASE)
_THOUSANDS = re.compile(r"^\d{1,3}(?:,\d{3})+(?:\.\d+)?$")
_UNITS = {
    "": 1.0, "m": 1.0, "mt": 1.0, "mtr": 1.0, "m.": 1.0, "meter": 1.0, "meters": 1.0,
    "metre": 1.0, "metres": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "mi": 1609.344,
    "ft": 0.3048, "feet": 0.3048, "foot": 0.3048, "'": 0.3048, "yd": 0.9144, "nmi": 1852.0,
}  # fmt: skip
_SPEEDS = {
    "": 1.0, "km/h": 1.0, "kmh": 1.0, "kph": 1.0, "kmph": 1.0, "mph": 1.609344, "knots": 1.852,
}  # fmt: skip
_POINTS = (
    "N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE",
    "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW",
)  # fmt: skip
_COMPASS = {name: radians(22.5 * index) for index, name in enumerate(_POINTS)} | {
    "NORTH": 0.0, "EAST": radians(90), "SOUTH": radians(180), "WEST": radians(270),
    "NORTHEAST": radians(45), "SOUTHEAST": radians(135), "SOUTHWEST": radians(225),
    "NORTHWEST": radians(315),
}  # fmt: skip
_IMPLICIT = table("sources/implicit_speeds", dict[str, float])
_LONGEST = 64  # characters; longer values are prose
YES = frozenset({"yes", "true", "1", "y", "on", "permanent", "designated"})
NO_COLOR = -1


def measure(text: str | None, low: float = -inf, high: float = inf) -> float | None:
    r"""Read a length in metres.

    "12", "12 m", "39'6\"", "3,5", "~20", "1,200", "25 ft" are understood; of several values
    ("3;4") the first counts.

    Parameters
    ----------
    text
        Value of a tag, or None.
    low, high
        Values outside are mistakes and give None.
    """
    if not text:
        return None
    value = _length(text)
    return value if value is not None and low <= value <= high else None


@lru_cache(maxsize=4096)
def _length(text: str) -> float | None:
    text = _first(text)
    feet = _FEET.match(text)
    if feet and ("'" in text or "′" in text or "’" in text or "f" in text.lower()):
        return _decimal(feet[1]) * 0.3048 + (_decimal(feet[2]) * 0.0254 if feet[2] else 0.0)
    inches = _INCHES.match(text)
    if inches:
        return _decimal(inches[1]) * 0.0254
    return _scaled(text, _UNITS)


def _first(text: str) -> str:
    text = text[:_LONGEST].split(";")[0].strip()
    return _ABOUT.sub("", text)


def _decimal(text: str) -> float:
    if _THOUSANDS.match(text) and not text.startswith("0"):
        text = text.replace(",", "")
    return float(text.replace(",", "."))


def _scaled(text: str, units: dict[str, float]) -> float | None:
    """Read a number with a unit; what follows another number (a range) is ignored."""
    if _THOUSANDS.match(text) and len(text) > 6:
        return _decimal(text)
    found = _NUMBER.match(text)
    if not found:
        return None
    rest = text[found.end() :].strip().lower()
    if rest[:1] in ("-", "–", "/", "x", ","):  # "3-4", "2.5x4"
        rest = ""
    unit = units.get(rest.rstrip("."), units.get(rest))
    value = float(found[0].replace(",", ".")) * unit if unit is not None else nan
    return value if isfinite(value) else None


def count(text: str | None, low: float, high: float) -> float | None:
    """Read a number without unit such as a count of levels or lanes; None outside [low, high]."""
    if not text:
        return None
    value = _plain(text)
    return value if value is not None and low <= value <= high else None


@lru_cache(maxsize=4096)
def _plain(text: str) -> float | None:
    return _scaled(_first(text), {"": 1.0})


def speed_kmh(text: str | None) -> float:
    """Read a speed limit in km/h, also that of a law ("RU:urban"); NaN when there is none."""
    if not text:
        return nan
    of_law = _LAW.match(text[:_LONGEST].strip())
    if of_law:
        country, word = of_law[1].upper(), of_law[2].lower()
        zone = _ZONE.match(word)
        if zone:
            return float(zone[1]) * (_SPEEDS["mph"] if country in _IN_MILES else 1.0)
        return _IMPLICIT.get(country, {}).get(word, nan)
    value = _scaled(_first(text), _SPEEDS)
    return value if value is not None and 0 < value <= 300 else nan


def direction(text: str | None) -> float:
    """Read a compass direction ("NNE", "225", "90°", "north") in radians; NaN when unknown."""
    if not text:
        return nan
    word = _first(text).upper().replace("-", "").replace(" ", "")
    if word in _COMPASS:
        return _COMPASS[word]
    value = _scaled(_first(text).lower(), {"": 1.0, "°": 1.0, "deg": 1.0, "degrees": 1.0})
    return radians(value % 360.0) if value is not None and abs(value) <= 3600 else nan


def angle_deg(text: str | None) -> float | None:
    """Read the pitch of a roof in degrees, between 1 and 85."""
    if not text:
        return None
    value = _scaled(_first(text).lower(), {"": 1.0, "°": 1.0, "deg": 1.0, "degrees": 1.0})
    return value if value is not None and 1 <= value <= 85 else None


def is_yes(text: str | None) -> bool:
    """Return whether a tag says yes; other words than yes and no count as no."""
    return text is not None and text.strip().lower() in YES


def word(text: str | None) -> str:
    """Return the first of the values as a plain word, "" when there is none."""
    return _word(text) if text else ""


@lru_cache(maxsize=4096)
def _word(text: str) -> str:
    return text[:_LONGEST].split(";")[0].strip().lower().replace(" ", "_")


# Words that mappers use beyond the CSS names, sRGB.
_ODD_COLORS = table("sources/osm_tags", int, "colors")
_TRANSPARENT = frozenset({"transparent", "none", "multicolored", "multi", "various", "no", "yes"})


def color(text: str | None) -> int:
    """Read a colour ("#a52", "#AA5522", "aa5522", "Dark Red", "light_grey"); -1 when unknown."""
    return _color(text[:_LONGEST]) if text else NO_COLOR


@lru_cache(maxsize=4096)
def _color(text: str) -> int:
    from PIL.ImageColor import colormap

    name = text.split(";")[0].split("/")[0].strip().lower()
    digits = name.lstrip("#")
    if re.fullmatch(r"[0-9a-f]{6}|[0-9a-f]{8}", digits):
        return int(digits[:6], 16)
    if name.startswith("#") and re.fullmatch(r"[0-9a-f]{3,4}", digits):
        return int("".join(digit * 2 for digit in digits[:3]), 16)
    if name in _ODD_COLORS:
        return _ODD_COLORS[name]
    plain = re.sub(r"[\s_-]", "", name)
    if plain in _TRANSPARENT:
        return NO_COLOR
    found = colormap.get(plain, colormap.get(plain.replace("gray", "grey")))
    if isinstance(found, tuple):  # Pillow keeps what it has read once as numbers
        red, green, blue = found[:3]
        return red << 16 | green << 8 | blue
    if isinstance(found, str):
        return int(found[1:7], 16)
    return _ODD_COLORS.get(plain, NO_COLOR)
