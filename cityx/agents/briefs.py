"""Briefs: what a text asks of a city, and how it is carried out.

This version knows words for the weather and the time of day; everything else it names and refuses.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cityx.agents.build import build
from cityx.agents.desk import STORE, Cancelled, Desk
from cityx.agents.options import BuildOptions
from cityx.errors import UsageError
from cityx.plugins.background.sun import clock_of, day_of
from cityx.plugins.background.weather import weather_named
from cityx.protocol.gate import Call

Say = Callable[[str], None]

# Words that carry no wish of their own; any town is "a small town" to this version.
_EMPTY = frozenset(
    ("a", "an", "the", "it", "its", "in", "at", "on", "of", "to", "and", "with", "make", "build",
     "create", "let", "be", "is", "please", "now", "city", "town", "small", "weather", "time",
     "day", "sky", "light")
)  # fmt: skip
_EQUATOR = 0.0  # latitude at which every word for a time of day names one


@dataclass(frozen=True)
class _Wish:
    """The weather and the time that a text asks for, "" where it is silent."""

    weather: str = ""
    time: str = ""

    @property
    def calls(self) -> list[Call]:
        """The actions that bring it about."""
        found = []
        if self.weather:
            found.append(Call("background/weather-v1", {"preset": self.weather}))
        if self.time:
            found.append(Call("background/sun-v1", {"time": self.time}))
        return found


def plan_text(text: str, folder: Path) -> dict[str, Any]:
    """Return what a text asks for and the actions that would bring it about; nothing is run.

    Parameters
    ----------
    text
        In words.
    folder
        Of a built city, or where one is to be built.

    Returns
    -------
    plan
        "brief", slots to values; "workflow", actions with their arguments; "builds", whether a
        city is built first.

    Raises
    ------
    UsageError
        With every word that is not understood.
    """
    wish = _read(text)
    return {
        "brief": {key: value for key, value in vars(wish).items() if value},
        "workflow": [{"action": call.action, "args": dict(call.args)} for call in wish.calls],
        "builds": not _built(folder),
    }


def carry_out_text(
    text: str, folder: Path, say: Say, cancelled: Callable[[], bool]
) -> dict[str, Any]:
    """Build the city that a text asks for, or change the one that is there.

    Parameters
    ----------
    text, folder
        As of `plan_text`.
    say
        Called with one line of progress at a time.
    cancelled
        Asked between actions whether the work is called off.

    Returns
    -------
    told
        "revision", its number; "message", one sentence; "warnings", what a reader should know.

    Raises
    ------
    UsageError
        With every word that is not understood, or if nothing is asked for.
    Cancelled
        The folder is as it was.
    """
    wish = _read(text)
    if not _built(folder):
        return _build(wish, folder, say, cancelled)
    if not wish.calls:
        raise UsageError(f'"{text}" asks for no change; name a weather or a time of day.')
    with Desk(folder) as desk:
        say(f"{len(wish.calls)} actions")
        done = desk.change(wish.calls, text=text, cancelled=cancelled)
    return _told(done.number, done.actions)


def _build(wish: _Wish, folder: Path, say: Say, cancelled: Callable[[], bool]) -> dict[str, Any]:
    def heard(line: str) -> None:
        if cancelled():
            raise Cancelled("The build was called off; the folder stays as it was.")
        say(line)

    options = BuildOptions(
        weather=wish.weather or None, time=wish.time or None, formats=(), render=False
    )
    build([], folder, options, say=heard)
    with Desk(folder) as desk:
        return _told(desk.revision, ("build",))


def _told(revision: int, actions: Sequence[str]) -> dict[str, Any]:
    ran = ", ".join(actions)
    return {"revision": revision, "message": f"Revision {revision}: {ran}.", "warnings": []}


def _built(folder: Path) -> bool:
    return (folder / STORE / "city.json").exists()


def _read(text: str) -> _Wish:
    weather: list[str] = []
    time: list[str] = []
    unknown: list[str] = []
    for word in re.findall(r"[^\s,.;!?]+", text.lower()):
        if _means(word, lambda word: clock_of(word, _EQUATOR, day_of("", _EQUATOR))):
            time.append(word)
        elif _means(word, weather_named):
            weather.append(word)
        elif word not in _EMPTY:
            unknown.append(word)
    faults = [f'"{word}" is not understood.' for word in dict.fromkeys(unknown)]
    faults += [
        f"{' and '.join(words)} cannot hold at once."
        for words in (weather, time)
        if len(set(words)) > 1
    ]
    if faults:
        raise UsageError(" ".join(faults))
    return _Wish("".join(weather[:1]), "".join(time[:1]))


def _means(word: str, read: Callable[[str], object]) -> bool:
    try:
        read(word)
    except UsageError:
        return False
    return True
