"""Lists in options of the command line: words with commas between them."""

from __future__ import annotations


def words_of(text: str) -> tuple[str, ...]:
    """Return the words of "osm, height": without spaces around them, empty ones left out."""
    return tuple(word for part in text.split(",") if (word := part.strip()))
