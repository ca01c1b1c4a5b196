"""Sources: which files an instruction builds on."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.brief import Note, Slot
from cityx.language.here import Findings
from cityx.language.scan import Item
from cityx.language.scopes import READ

SOURCE_OF = {
    "osm": "osm", "semantic": "semantic_map", "height": "height_field", "satellite": "satellite",
    "drawn": "drawn", "text": "text_file",
}  # fmt: skip
_TEXT_FILES = (".txt", ".md")
# Words that mean a file only where one of its kind came along.
_VAGUE = ("terrain", "relief", "topography", "aerial", "drawing", "sketch", "satellite", "relief")


def read_sources(found: Findings, items: Sequence[Item], inputs: Sequence[tuple[str, str]]) -> None:
    """Add a slot for every file, at the words that name it; note words that name no file."""
    given = {SOURCE_OF.get(kind, kind): name for name, kind in inputs}
    for item in items:
        source = item.get("source")
        if source and source in given:
            found.add("source", source, item)
        elif source and not item.has("noun", "slot") and not item.text.endswith(_VAGUE):
            found.add("source", source, item)
            said = f'"{item.text}" speaks of a file, but none of this kind was given.'
            found.notes.append(Note("no_such_input", said, item.span))
        elif (source or (item.has("any_source") and given)) and not item.state:
            item.state = READ
        elif item.kind == "file":
            _file(found, item, given)
    for source in given:
        if source == "text_file" or any(slot.value == source for slot in found.slots):
            continue
        found.slots.append(Slot("source", source))


def _file(found: Findings, item: Item, given: dict[str, str]) -> None:
    named = [source for source, name in given.items() if name.casefold() == item.text]
    if named or item.text.endswith(_TEXT_FILES):
        found.add("source", named[0] if named else "text_file", item)
