"""Numbers, directions, colours and lanes as mappers write them. Nothing here ever raises."""

from __future__ import annotations

import re
from functools import lru_cache
from math import inf, isfinite, nan, radians

from cityx.city.section import PARKING, TURN, Band
from cityx.sources.features.tagged import Tags
from cityx.system.tables import table

_NUMBER = re.compile(r"[-+]?(?:\d+(?:[.,]\d+)?|[.,]\d+)(?:[eE][-+]?\d{1,3})?")
_FEET = re.compile(r"^(\d+(?:[.,]\d+)?)\s*(?:'|′|’|ft|feet|foot)\s*(?:(\d+(?:[.,]\d+)?)\s*(?:\"|″|”|''|in|inch|inches)?)?$")  # fmt: skip  # noqa: E501
_INCHES = re.compile(r"^(\d+(?:[.,]\d+)?)\s*(?:\"|″|”|in|inch|inches)$")
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
_LONGEST = 64  # characters; longer values are prose
YES = frozenset({"yes", "true", "1", "y", "on", "permanent", "designated"})
NO_COLOR = -1
CYCLE_LANE = 1.6  # metres
SHOULDER = 2.5
MAX_LANES = 12
_LANED = frozenset({"lane", "track", "opposite_lane", "opposite_track", "exclusive"})
_FOR_BUSES = frozenset({"designated", "yes"})
_TURN_WORDS = {
    "left": "left", "slight_left": "left", "sharp_left": "left", "merge_to_left": "through",
    "through": "through", "merge_to_right": "through",
    "right": "right", "slight_right": "right", "sharp_right": "right", "reverse": "reverse",
}  # fmt: skip
_HINTS = ("turn:lanes", "cycleway", "busway", "lanes:bus", "lanes:psv", "bus:lanes", "psv:lanes",
          "shoulder")  # fmt: skip


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
    """Read a speed limit in km/h; NaN when there is none or it is a word."""
    if not text:
        return nan
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


def bands_of_tags(
    tags: Tags, kind: str, lanes: int, forward: int, lane_width: float,
    parking: tuple[bool, bool], *, oneway: bool, backward: bool, left_hand: bool,
) -> tuple[Band, ...]:  # fmt: skip
    """Return the bands between the kerbs from left to right, or none where tags add nothing.

    Parameters
    ----------
    kind, lanes, forward, lane_width, parking, oneway
        What is known of the road; `parking` is left and right of the way as it is drawn.
    backward
        Traffic runs against the way as it is drawn; the bands are those of the turned way.
    left_hand
        Whether traffic keeps to the left.
    """
    shoulders = _shoulders(tags, kind, left_hand=left_hand)
    if not any(shoulders) and not any(key.startswith(_HINTS) for key in tags):
        return ()
    ahead = "backward" if backward else "forward"
    against = "forward" if backward else "backward"
    onward = _lanes(tags, ahead, forward, lane_width, 1, oneway=oneway)
    count = 0 if oneway else lanes - forward
    if not oneway and lanes == 1:
        onward, count = [Band("drive", lane_width)], 0
    opposite = _lanes(tags, against, count, lane_width, -1, oneway=False)[::-1]
    middle = [*onward, *opposite] if left_hand else [*opposite, *onward]
    cycles = _cycle_lanes(tags, oneway=oneway, left_hand=left_hand)
    sides: list[list[Band]] = []
    for place in (0, 1):
        drawn = 1 - place if backward else place
        side = [Band("parking", PARKING)] if parking[drawn] else []
        if cycles[drawn]:
            sign = -cycles[drawn] if backward else cycles[drawn]
            track = _value(tags, "cycleway", drawn) in ("track", "opposite_track")
            lane = Band("cycle", CYCLE_LANE, sign)
            side = [lane, *side] if track else [*side, lane]
        if shoulders[drawn]:
            side = [Band("shoulder", shoulders[drawn]), *side]
        sides.append(side)
    bands = (*sides[0], *middle, *reversed(sides[1]))
    plain = all(band.kind in ("drive", "parking") and not band.turns for band in bands)
    return () if plain else bands


def _lanes(
    tags: Tags, way: str, count: int, width: float, direction: int, *, oneway: bool
) -> list[Band]:
    """Lanes of one direction from left to right as their drivers see them."""
    arrows = tags.get(f"turn:lanes:{way}") or (tags.get("turn:lanes") if oneway else None)
    turns = [_bits(word) for word in arrows.split("|")] if arrows else []
    turns = turns if len(turns) == count else [0] * count
    buses = _bus_lanes(tags, way, count, oneway=oneway)
    return [
        Band("bus" if bus else "drive", width, direction, turn)
        for bus, turn in zip(buses, turns, strict=True)
    ]


def _bits(word: str) -> int:
    found = 0
    for name in word.replace(",", ";").split(";"):
        if name.strip() in _TURN_WORDS:
            found |= TURN[_TURN_WORDS[name.strip()]]
    return found


def _bus_lanes(tags: Tags, way: str, count: int, *, oneway: bool) -> list[bool]:
    for key in ("bus:lanes", "psv:lanes"):
        text = tags.get(f"{key}:{way}") or (tags.get(key) if oneway else None)
        words = text.split("|") if text else []
        if len(words) == count and any(word in _FOR_BUSES for word in words):
            found = [word == "designated" for word in words]
            return found if any(found) and not all(found) else [False] * count
    number = 0
    for key in ("lanes:bus", "lanes:psv"):
        text = tags.get(f"{key}:{way}") or (tags.get(key) if oneway else None)
        number = max(number, int(count(text, 0, MAX_LANES) or 0))
    if tags.get("busway") == "lane" or tags.get("busway:both") == "lane":
        number = max(number, 1)
    if (tags.get("busway:right") or tags.get("busway:left")) == "lane" and way == "forward":
        number = max(number, 1)
    number = min(number, count - 1)  # one is left to cars
    return [place >= count - number for place in range(count)]


def _value(tags: Tags, key: str, place: int) -> str:
    side = ("left", "right")[place]
    return tags.get(f"{key}:{side}") or tags.get(f"{key}:both") or tags.get(key) or ""


def _cycle_lanes(tags: Tags, *, oneway: bool, left_hand: bool) -> tuple[int, int]:
    """Direction of the cycle lane left and right of the way as it is drawn, 0 for none."""
    found = []
    for place in (0, 1):
        value = _value(tags, "cycleway", place)
        own = f"cycleway:{('left', 'right')[place]}" in tags or "cycleway:both" in tags
        along = 1 if (place == 0) == left_hand else -1
        if value not in _LANED:
            found.append(0)
        elif oneway and not own:  # one lane beside a one-way street, on the side of its traffic
            opposite = value.startswith("opposite")
            found.append(along if (along > 0) != opposite else 0)
        elif oneway and not value.startswith("opposite"):
            found.append(1)
        else:
            found.append(along)
    return found[0], found[1]


def _shoulders(tags: Tags, kind: str, *, left_hand: bool) -> tuple[float, float]:
    value = tags.get("shoulder")
    outer = 0 if left_hand else 1
    if value is None and not any(key.startswith("shoulder:") for key in tags):
        usual = [0.0, 0.0]
        usual[outer] = SHOULDER if kind == "motorway" else 0.0
        return usual[0], usual[1]
    sizes = []
    for place, side in enumerate(("left", "right")):
        word = tags.get(f"shoulder:{side}") or tags.get("shoulder:both") or value or "no"
        has = word in (side, "both") or (word == "yes" and place == outer)
        if tags.get(f"shoulder:{side}") == "yes" or tags.get("shoulder:both") == "yes":
            has = True
        width = measure(tags.get(f"shoulder:{side}:width") or tags.get("shoulder:width"), 0.3, 6.0)
        sizes.append((width or SHOULDER) if has else 0.0)
    return sizes[0], sizes[1]
