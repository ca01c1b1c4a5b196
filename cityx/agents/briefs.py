"""Requests: a text, files and options become a brief, slots for the planner, goals to measure."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cityx.agents.models.quoting import plain, quoted
from cityx.agents.planning.planner import Told
from cityx.agents.roles import BriefMaker, OfflineBriefMaker
from cityx.city import City, Goal
from cityx.errors import InputError
from cityx.language import Brief
from cityx.language.brief import Clarify, Question
from cityx.options import BuildOptions
from cityx.protocol.serving import Slots

NOT_ENGLISH = (
    "Without a language model only English is read, and most of these words are none of it. Can "
    "you say it in English, or name a model with --planner?"
)
MOST_NAMES, LONGEST_NAME = 20, 40  # names of things that are told, and letters of one
LONGEST_NOTE = 20_000  # characters of a text file that are read
IN_PART, DONE = "partial", "done"  # replies to a request
# Codes of notes on what was asked for and is not brought about or cannot be told.
NOT_DONE = ("ignored_untrusted_instruction", "left_open", "not_checkable")


@dataclass(frozen=True)
class Request:
    """What a user wants.

    Attributes
    ----------
    brief
        The instruction as it was read.
    slots
        All that is asked for, by text and by options, as actions take it.
    """

    brief: Brief = field(default_factory=Brief)
    slots: Slots = field(default_factory=dict)

    @property
    def style(self) -> str:
        """The style of the buildings, "" for that of the region."""
        return str(next(iter(self.slots.get("style", ())), ""))

    @property
    def reply(self) -> str:
        """What to answer: "done", or "partial" where something was not understood or measured."""
        left = any(note.code in NOT_DONE for note in self.brief.notes)
        return IN_PART if self.brief.unread or self.brief.left or left else DONE

    @property
    def notes(self) -> tuple[str, ...]:
        """What the report says of the reading."""
        return self.brief.told

    @property
    def goals(self) -> tuple[Goal, ...]:
        """What the text asks for, as it is measured."""
        return tuple(Goal(goal.text, goal.predicate, goal.hard) for goal in self.brief.goals)

    @property
    def told(self) -> Told:
        """What a planner that can read is told; of texts in files nothing."""
        return Told(
            self.brief.text,
            self.brief.words_unread,
            tuple(str(slot.value) for slot in self.brief.negated),
            tuple(goal.predicate for goal in self.brief.goals),
        )

    def with_goals(self, city: City) -> City:
        """Keep with a city what was asked of it, each thing once."""
        known = {goal.predicate for goal in city.goals}
        goals = [goal for goal in self.goals if goal.predicate not in known]
        return replace(city, goals=(*city.goals, *goals), notes=(*city.notes, *self.notes))


def read_request(
    options: BuildOptions,
    files: Iterable[tuple[Path, str]] = (),
    *,
    base: bool = False,
    maker: BriefMaker | None = None,
    city: City | None = None,
) -> Request:
    """Read the instruction of a build or of a change.

    Parameters
    ----------
    options
        With the text, and options that go before it.
    files
        Path and kind of the input files; those of kind "text" are read for wishes alone.
    base
        Whether a city exists that is to be changed.
    maker
        Who reads the instruction; rules when None.
    city
        The one that is to be changed: the names of its things are known.

    Raises
    ------
    Clarify
        If the instruction contradicts itself or leaves open what is meant.
    InputError
        If a text file cannot be read.
    UsageError
        If a style is not known.
    """
    items = list(files)
    notes = [path for path, kind in items if kind == "text"]
    if not options.text and not notes:
        return Request(Brief(), _checked(slots_of(options)))
    # A build without a text does not wait for the words of English.
    from cityx.language import read_note
    from cityx.language.asked import slots_of_brief
    from cityx.language.lexicon.lexicon import is_foreign
    from cityx.language.references.dwellings import with_dwellings
    from cityx.language.references.naming import names_of

    wishes = [_text_of(path) for path in notes]
    names = names_of(city, " ".join([options.text, *wishes])) if city is not None else ()
    brief = (maker or OfflineBriefMaker()).read(
        options.text,
        inputs=[(path.name, kind) for path, kind in items],
        base=base,
        options=_said(options),
        names=names,
        stands=scene_told(city) if city is not None and maker is not None else (),
    )
    if city is not None and base:
        brief = with_dwellings(brief, city)
    for wish in wishes:
        brief = brief.joined(read_note(wish, base=base, names=names))
    if 2 * len(brief.words_unread) >= len(brief.text.split()) > 0 and is_foreign(brief.text):
        brief = replace(brief, questions=(Question(NOT_ENGLISH),))
    if brief.conflicts or brief.questions:
        heard = (brief.heard,) if brief.heard else ()
        raise Clarify(brief, () if base else (*heard, *brief.told))
    return Request(brief, _checked({**slots_of_brief(brief), **slots_of(options)}))


def slots_of(options: BuildOptions) -> dict[str, tuple[Any, ...]]:
    """Return what options ask for, by the keys of a brief; those left out are left out."""
    read = options.read
    size = options.size or (None, None)
    at = options.at or (None, None)
    heights = read.height_range or (None, None)
    found: dict[str, Any] = {
        "time": options.time,
        "weather": options.weather,
        "style": options.style or None,
        "size.x": size[0],
        "size.y": size[1],
        "town.width": size[0],
        "town.depth": size[1],
        "at.latitude": at[0],
        "at.longitude": at[1],
        "read.legend": None if Path(read.legend).is_file() else read.legend or None,
        "read.confirm_legend": read.confirm_legend or None,
        "read.pixel": read.pixel,
        "read.fidelity": read.fidelity,
        "read.segment": False if read.segmenter == "none" else None,
        "read.lowest": heights[0],
        "read.highest": heights[1],
        "read.height_crs": read.height_crs or None,
    }
    if options.window:
        x, y, width, depth = options.window
        found |= {
            "town.x": x + width / 2, "town.y": y + depth / 2, "town.bounded": False,
            "town.width": width, "town.depth": depth,
        }  # fmt: skip
    return {key: (value,) for key, value in found.items() if value is not None}


def scene_told(city: City) -> tuple[str, ...]:
    """Return what stands in a city in lines: how many of each kind, and names, as quoted data."""
    layout = city.layout
    env = city.environment
    lines = [
        f"There are {_counted(layout.buildings['use'])}.",
        f"Streets: {_counted(layout.roads['kind'])}.",
        f"Areas: {_counted(layout.areas['kind'])}.",
        f"Weather: rain {env.rain:g} mm/h, snow {env.snow:g} mm/h, wetness {env.wetness:g}.",
    ]
    for title, table in (("buildings", layout.buildings), ("streets", layout.roads),
                         ("areas", layout.areas)):  # fmt: skip
        names = [plain(str(name))[:LONGEST_NAME] for name in table["name"].unique() if name]
        if names:
            lines.append(f"Names of {title}: {quoted(sorted(names)[:MOST_NAMES])}")
    return tuple(lines)


def _counted(kinds: Iterable[Any]) -> str:
    """Return how many there are of each kind, the most frequent first."""
    found = Counter(map(str, kinds)).most_common(MOST_NAMES)
    return ", ".join(f"{number} {plain(kind)[:LONGEST_NAME]}" for kind, number in found) or "none"


def _said(options: BuildOptions) -> Mapping[str, Any]:
    """Return the options that a text might contradict."""
    given = slots_of(options)
    keys = ("style", "time", "weather", "size.x", "size.y")
    return {key: given[key][0] for key in keys if key in given}


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")[:LONGEST_NOTE]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read as a text: {error}.") from error


def _checked(slots: Slots) -> Slots:
    """Refuse a style that no building has."""
    from cityx.assets.styles.palettes import family_of

    for style in slots.get("style", ()):
        family_of(str(style))
    return slots
