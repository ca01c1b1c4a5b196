"""What a text tells of the images that came with it: metres of a pixel, legend, range of heights.

"0.5 m per pixel", "one pixel is 30 cm", "1 m cells", "the Dubai colours", "black is 3 m and white
95 m": these say how a file is read, and nothing of the city.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from cityx.language.brief import Slot, Span
from cityx.language.here import Findings
from cityx.language.scan import Item
from cityx.language.scopes import READ
from cityx.system.tables import load

IMAGES = ("semantic_map", "satellite", "height_field")
_PIXEL = r"(?:pixels?|px|pix|(?:grid|raster) cells?)\b"
_CELL = r"cells?(?= ?(?:$|[.,;:)\n]|and\b|in size\b))"  # and no cell tower
_CLOSED = r"(?! ?-?(?:tall|high|wide|long|deep|\w+ing)\b)"
_IS = r"(?:(?:is|are|=|:|stands for|covers|measures|equals|of|being) ?)*"
_RESOLUTION = r"(?:ground (?:sample|sampling) distance|gsd|resolution|pixel size|cell size)"
# What stands behind the metres of a pixel, and what before them with what may not be behind.
_BEHIND = re.compile(
    rf" ?(?:/|a|per|to the|to a|for each|for every|for a) ?{_PIXEL}| (?:{_PIXEL}|{_CELL})"
    rf"| (?:of )?(?:ground )?{_RESOLUTION}",
    re.IGNORECASE,
)
_BEFORE = re.compile(
    rf"(?:\b(?:one|a|each|every|the|1) )?\b(?:{_PIXEL} ?(?:sizes? )?|{_RESOLUTION} ?){_IS}$",
    re.IGNORECASE,
)
_OTHER = re.compile(_CLOSED, re.IGNORECASE)
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
    told += [("read.pixel", *size) for size in _sizes(found.text, items)][:1]
    if "height_field" in files and (match := _LOW_HIGH.search(found.text)) is not None:
        told.append(("read.lowest", float(match.group(1)), match.span()))
        told.append(("read.highest", float(match.group(2)), match.span()))
    if "semantic_map" in files and (legend := _legend(found.text)) is not None:
        told.append(("read.legend", *legend))
    for span in dict.fromkeys(span for _, _, span in told):
        _take(found, items, span)
    found.slots += [Slot(key, value, span, found.text[slice(*span)]) for key, value, span in told]


def _sizes(text: str, items: Sequence[Item]) -> Iterator[tuple[float, Span]]:
    """Yield the metres of a pixel that a text tells, and where."""
    for item in items:
        size = item.quantity
        if size is None or size.dimension != "length" or size.exact is None:
            continue
        if size.attribute not in ("", "width"):
            continue  # "12 m tall"
        begin, end = item.span
        before, behind = _BEFORE.search(text[:begin]), _BEHIND.match(text, end)
        if behind is not None:
            yield round(size.exact, 6), (begin, behind.end())
        elif before is not None and _OTHER.match(text, end):
            yield round(size.exact, 6), (before.start(), end)


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
