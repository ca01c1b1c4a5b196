"""What a text tells of the images that came with it: metres of a pixel, legend, range of heights.

"0.5 m per pixel", "one pixel is 30 cm", "1 m cells", "the Dubai colours", "black is 3 m and white
95 m": these say how a file is read, and nothing of the city.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from cityx.language.brief import Slot, Span
from cityx.language.here import Findings
from cityx.language.scan import Item
from cityx.language.scopes import READ
from cityx.system.tables import load

IMAGES = ("semantic_map", "satellite", "height_field")
_UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "km": 1000.0, "ft": 0.3048, "foot": 0.3048}
_UNITS |= {"feet": 0.3048, "in": 0.0254, "inch": 0.0254, "inches": 0.0254}
_UNITS |= dict.fromkeys(("metre", "metres", "meter", "meters"), 1.0)
_UNITS |= dict.fromkeys(("centimetre", "centimetres", "centimeter", "centimeters"), 0.01)
_NUMBERS = {"half a": 0.5, "a half": 0.5, "a": 1.0, "one": 1.0, "two": 2.0, "quarter of a": 0.25}
_NUMBERS |= {"a quarter of a": 0.25}
_LENGTH = (
    rf"(?P<number>\d+(?:[.,]\d+)?|{'|'.join(sorted(_NUMBERS, key=len, reverse=True))}) ?-?"
    rf"(?P<unit>{'|'.join(sorted(_UNITS, key=len, reverse=True))})\b"
)
_PIXEL = r"(?:pixels?|px|pix|(?:grid|raster) cells?)\b"
_CELL = r"cells?(?= ?(?:$|[.,;:)\n]|and\b|in size\b))"  # and no cell tower
_CLOSED = r"(?! ?-?(?:tall|high|wide|long|deep|\w+ing)\b)"
_ABOUT = r"(?:about|around|roughly|approximately|approx\.?|circa|ca\.?|~|nearly) ?"
_IS = r"(?:(?:is|are|=|:|stands for|covers|measures|equals|of|being) ?)*"
_RESOLUTION = r"(?:ground (?:sample|sampling) distance|gsd|resolution|pixel size|cell size)"
_SIZES = tuple(
    re.compile(one, re.IGNORECASE)
    for one in (
        rf"(?:{_ABOUT})?{_LENGTH} ?(?:/|a|per|to the|to a|for each|for every|for a) ?{_PIXEL}",
        rf"(?:one|a|each|every|the|1)? ?{_PIXEL} ?(?:sizes? )?{_IS}(?:{_ABOUT})?{_LENGTH}",
        rf"(?:{_ABOUT})?{_LENGTH} (?:{_PIXEL}|{_CELL})",
        rf"{_RESOLUTION} ?{_IS}(?:{_ABOUT})?{_LENGTH}{_CLOSED}",
        rf"(?:{_ABOUT})?{_LENGTH} (?:of )?(?:ground )?{_RESOLUTION}",
    )
)
_HEIGHT = r"(?:(?:at|is|=|as|for|stands for|means) ?)*(-?\d+(?:\.\d+)?) ?m(?:etres?|eters?)?\b"
_DARK, _LIGHT = r"(?:black|darkest|dark|lowest|minimum)", r"(?:white|brightest|lightest|highest)"
_LOW_HIGH = re.compile(rf"\b{_DARK} {_HEIGHT}\W+(?:and |to |, )?{_LIGHT} {_HEIGHT}", re.IGNORECASE)
_NAMED_LEGEND = (
    r"\b({names})(?: standard| style)? (?:legend|colou?rs?|palette|classes|coding|scheme)"
)
_OF_LEGEND = (
    r"\b(?:legend|colou?rs?|palette|classes|coding|scheme)(?: (?:is|are|of|from|as in|follows?|"
    r"like|the))*:? (?:the )?({names})(?: (?:standard|data ?set|legend|palette|set|ones|style))?\b"
)


def read_image_words(found: Findings, items: Sequence[Item], files: Mapping[str, str]) -> None:
    """Add slots for what a text tells of images; of images that did not come nothing is read.

    Parameters
    ----------
    found
        What has been read; slots and notes of these words are taken back.
    items
        All items; those of such words count as read.
    files
        Names of the files by their sources.
    """
    if not set(IMAGES) & set(files):
        return
    told: list[tuple[str, float | str, Span]] = []
    for pattern in _SIZES:
        match = pattern.search(found.text)
        if match is not None:
            told.append(("read.pixel", _metres(match), match.span()))
            break
    if "height_field" in files and (match := _LOW_HIGH.search(found.text)) is not None:
        told.append(("read.lowest", float(match.group(1)), match.span()))
        told.append(("read.highest", float(match.group(2)), match.span()))
    if "semantic_map" in files and (legend := _legend(found.text)) is not None:
        told.append(("read.legend", *legend))
    for span in dict.fromkeys(span for _, _, span in told):
        _take(found, items, span)
    found.slots += [Slot(key, value, span, found.text[slice(*span)]) for key, value, span in told]


def _metres(match: re.Match[str]) -> float:
    number, unit = match["number"].lower(), match["unit"].lower()
    value = _NUMBERS[number] if number in _NUMBERS else float(number.replace(",", "."))
    return round(value * _UNITS[unit], 6)


def _legend(text: str) -> tuple[str, Span] | None:
    """Return the legend of a text that names a known one, and where."""
    names = "|".join(load("sources/legends", dict[str, dict[str, str]], "colors"))
    for pattern in (_NAMED_LEGEND, _OF_LEGEND):
        match = re.search(pattern.format(names=names), text, re.IGNORECASE)
        if match is not None:
            return match.group(1).lower(), match.span()
    return None


def _take(found: Findings, items: Sequence[Item], span: Span) -> None:
    """Let words count as read, and take back what else was read of them."""
    for item in items:
        if span[0] <= item.span[0] < span[1]:
            item.state = READ
    for held in (found.slots, found.negated, found.kept):
        held[:] = [slot for slot in held if not span[0] <= slot.span[0] < span[1]]
    found.notes[:] = [one for one in found.notes if not span[0] <= one.span[0] < span[1]]
