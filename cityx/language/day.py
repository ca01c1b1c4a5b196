"""The day: which half of it an hour is in, by the part of the day that a text speaks of."""

from __future__ import annotations

from collections.abc import Sequence

from cityx.language.lexicon.lexicon import find
from cityx.language.lexicon.words import Word

HALF = 12.0  # hours
_ENDS = ".;!?\n"
_DAWN = 6.0  # hours from which "at night" is before midnight
_SPOKEN = 5.0  # "half past" hours up to this one are after noon where nothing is said
# Parts of the day -> hours of a clock of twelve from which they are after noon; 12 for never.
_LATER = {
    "afternoon": 0.0, "evening": 0.0, "sunset": 0.0, "dusk": 0.0, "golden_hour": 0.0,
    "blue_hour": 0.0, "night": _DAWN, "morning": HALF, "dawn": HALF, "sunrise": HALF,
    "first_light": HALF,
}  # fmt: skip


def hour_of_day(
    words: Sequence[Word], at: int, length: int, hour: float, *, spoken: bool = False
) -> float:
    """Return an hour of a clock of twelve as one of the day: 18.5 of "evening, half past six".

    Parameters
    ----------
    words
        Those of the whole text.
    at, length
        Where the hour stands.
    hour
        As it is told; from 12 on, and with a leading zero, it is that of the day already.
    spoken
        Whether it is one that nobody says of the night without saying so: "half past three".

    Returns
    -------
    hour
        Of the day; the part of the day that counts is the one said behind it in its clause, or
        the nearest in its sentence, or in the text.
    """
    if not 0 < hour < HALF or words[at].text.startswith("0"):
        return hour
    parts = {where: part for where in range(len(words)) if (part := _part(words, where))}
    if not parts:
        return hour + HALF if spoken and 1.0 <= hour < _SPOKEN + 1.0 else hour
    nearest = min(parts, key=lambda where: _distance(words, at, at + length, where))
    return hour + HALF if hour >= _LATER[parts[nearest]] else hour


def follows_part(words: Sequence[Word], at: int) -> bool:
    """Return whether "in the morning" or "at night" follows as the end of a phrase."""
    said = [word.text for word in words[at : at + 3]]
    length = 2 if said[:2] == ["at", "night"] else 3
    return length == 2 or (
        said[:2] == ["in", "the"] and said[2:] in (["morning"], ["afternoon"], ["evening"])
    )


def ends_phrase(words: Sequence[Word], at: int) -> bool:
    """Return whether a text, a clause or a mark ends where a part of the day has been told."""
    length = 2 if words[at].text == "at" else 3
    return at + length >= len(words) or words[at + length].kind == "mark"


def _part(words: Sequence[Word], at: int) -> str:
    """Return the part of the day that a word begins to say, "" for none."""
    if words[at].text in ("am", "pm"):
        return "morning" if words[at].text == "am" else "afternoon"
    found = find(words, at)
    slots = () if found is None else (value for kind, value in found[0] if kind == "slot")
    parts = (slot.removeprefix("time=") for slot in slots if slot.startswith("time="))
    return next((part for part in parts if part in _LATER), "")


def _distance(words: Sequence[Word], first: int, end: int, where: int) -> tuple[bool, bool, int]:
    """Return how far a word is: in another sentence, in another clause or before, and by words."""
    between = words[end:where] if where >= end else words[where:first]
    marks = [word.text for word in between if word.kind == "mark" and word.text != "-"]
    apart = bool(marks) or where < first
    return any(mark in _ENDS for mark in marks), apart, len(between)
