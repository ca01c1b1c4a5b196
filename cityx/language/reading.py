"""Reading: an instruction becomes a brief, without a language model."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from cityx.language import untrusted
from cityx.language.absent import clashes, questions_of
from cityx.language.brief import (
    Brief,
    Command,
    Conflict,
    Edit,
    GoalText,
    Left,
    Note,
    Question,
    Slot,
    Span,
    Value,
    Wish,
)
from cityx.language.clauses import settle_removals
from cityx.language.commands.rewording import reworded
from cityx.language.commands.roles import give_roles
from cityx.language.commands.sentences import read_edits
from cityx.language.commands.survivals import with_survivals
from cityx.language.commands.wishes import wishes_of
from cityx.language.conflicts import conflicts_of, reconcile
from cityx.language.coverage import lost, narrower
from cityx.language.denied_traits import settle_denied_traits
from cityx.language.describe import describe, unread
from cityx.language.goals import LAYOUTS, goals_of
from cityx.language.group_words import read_added_groups
from cityx.language.here import Findings
from cityx.language.homonyms import settle_cranes, settle_homonyms, settle_ones
from cityx.language.image_words import read_image_words
from cityx.language.implied_commands import proper_names, read_implied_commands
from cityx.language.inquiries import read_inquiries
from cityx.language.life_words import read_everybody
from cityx.language.measures import join_measures
from cityx.language.predicative import settle_predicates
from cityx.language.prohibitions import without_prohibitions
from cityx.language.scan import LONGEST_TEXT, Item, scan
from cityx.language.scopes import READ, settle_scopes
from cityx.language.states import settle_states
from cityx.system.tables import load

# Sources: which files an instruction builds on.

SOURCE_OF = {
    "osm": "osm", "semantic": "semantic_map", "height": "height_field", "satellite": "satellite",
    "drawn": "drawn", "text": "text_file",
}  # fmt: skip
_EMPTYING = tuple(load("language/spelling", frozenset[str], "emptying"))
_TEXT_FILES = (".txt", ".md")
# Words that mean a file only where one of its kind came along.
_VAGUE = ("terrain", "relief", "topography", "aerial", "drawing", "sketch", "satellite", "relief")


def read_sources(found: Findings, items: Sequence[Item], inputs: Sequence[tuple[str, str]]) -> None:
    """Add a slot for every file, at the words that name it; note words that name no file."""
    given = files_of(inputs)
    for item in items:
        source = item.get("source")
        if source and source in given:
            found.add("source", source, item)
        elif source and not (item.state or item.has("noun", "slot") or _is_vague(item)):
            item.state = READ
            said = f'"{item.text}" speaks of a file, but none of this kind was given.'
            found.notes.append(Note("no_such_input", said, item.span))
        elif (source or (item.has("any_source") and given)) and not item.state:
            item.state = READ
        elif item.kind == "file":
            _file(found, item, given)
        elif item.has("unchanged") and "osm" in given and _is_of_the_file(items, item):
            found.add("source", "osm", item)
    for source in given:
        if source == "text_file" or any(slot.value == source for slot in found.slots):
            continue
        found.slots.append(Slot("source", source))


def _read_countries(text: str, items: Sequence[Item]) -> None:
    """Read "US" in capitals as American, and "us" as people."""
    for item in items:
        if item.text in ("us", "u.s", "usa") and text[slice(*item.span)].isupper():
            item.kind, item.senses = "phrase", (("slot", "style=american"),)


def _is_vague(item: Item) -> bool:
    return item.text.endswith(_VAGUE)


def _is_of_the_file(items: Sequence[Item], item: Item) -> bool:
    """Return whether a whole map is to be as it is: "use the map as it is", "Soho | as mapped".

    A map is built as it is wherever nothing else is said.
    """
    at = next(n for n, one in enumerate(items) if one is item)
    before = items[at - 1] if at else None
    if before is None or before.kind == "mark":
        return True
    named = before.kind == "unknown" and at == 1
    return named or before.has("any_source", "source") or before.text in ("this", "it", "file")


def _file(found: Findings, item: Item, given: dict[str, str]) -> None:
    named = [source for source, name in given.items() if name.casefold() == item.text]
    if named or item.text.endswith(_TEXT_FILES):
        found.add("source", named[0] if named else "text_file", item)


def read_brief(
    text: str,
    *,
    inputs: Sequence[tuple[str, str]] = (),
    base: bool = False,
    options: Mapping[str, Any] | None = None,
    names: Iterable[str] = (),
) -> Brief:
    """Read an instruction.

    Parameters
    ----------
    text
        The instruction, in English.
    inputs
        Name and kind of the files that came with it: "osm", "semantic", "satellite", "height",
        "drawn" or "text".
    base
        Whether a city exists: sentences are commands to change it, and describe it otherwise.
    options
        Keys and values that hold whatever the text says, those of a command line; where the text
        says otherwise, that is a conflict.
    names
        What things of the city that is to be changed are called.

    Returns
    -------
    brief
        Slots, edits, goals, and the words that nobody understood. Every span lies inside the text.
    """
    items, notes = scan(text, names)
    items = join_measures(items)
    settle_homonyms(text, items)
    if not base or (items and items[0].text == "put"):  # those who are there are not others
        read_everybody(items)
    _read_countries(text, items)
    called = proper_names(text) if inputs else ()  # streets of a map that is not read yet
    told, items = read_inquiries(
        text,
        items,
        lambda said: read_brief(said, base=True, names=names if base else called),
        base=base,
    )
    if not base:
        settle_ones(items)
        settle_cranes(items)
        settle_states(items)
        settle_predicates(items)
        spoken_of, open_ = settle_denied_traits(items)
    if base or inputs:
        items = without_prohibitions(items)
    if base:
        items = with_survivals(items)
        give_roles(items)
    else:
        settle_removals(items)
    settle_scopes(items)
    if base:
        items = reworded(items)
    edits: list[Edit] = []
    questions: list[Question] = []
    then: list[Command] = []
    wishes: list[Wish] = []
    left_out: list[Left] = []
    if base:
        commands = read_edits(text, items)
        found, edits, questions = commands.found, commands.edits, commands.questions
        wishes, left_out = wishes_of(text, commands.clauses)
        if left_out:
            edits = [edit for wish in wishes for edit in wish.edits]
            questions = []
            _leave(found, items, left_out)
        edits = [*edits, *told.edits]
    else:
        files = files_of(inputs)
        found = describe(text, items, mapped=not set(LAYOUTS).isdisjoint(files))
        found.slots[:] = [one for one in found.slots if one.span not in spoken_of]
        for span in open_:
            found.leave_span(span, "denied of them")
        then = read_implied_commands(
            found,
            items,
            lambda said: read_brief(said, base=True, names=called),
            surveyed="osm" in files,
        )
        read_added_groups(found, items, then)
        then += told.commands
        found.notes += told.notes
    read_image_words(found, items, files_of(inputs))
    read_sources(found, items, inputs)
    found.negated = _but_for_counted(text, found.negated, found.slots)
    if not (base or inputs):
        questions += [Question(_NO_FILE.format(words)) for words in _files_meant(text)]
        questions += questions_of(text, items)
    if not (base or inputs or options or then or questions) and _says_nothing(found, items):
        questions.append(Question(_NOTHING))
    slots, against = _with_options(reconcile(found.slots), options or {})
    conflicts = (*against, *conflicts_of(slots, found.negated))
    if not base and not conflicts:
        conflicts = tuple(clashes(items, slots, found.negated))
    every = any(slot.every for slot in slots)
    left = [item.span for item in unread(items, described=not base, every=every)]
    if not base:
        found.notes += narrower(text, items)
        known = [one.span for one in then] + [one.span for one in (*notes, *found.notes)]
        known += [span for one in conflicts for span in one.spans]
        read = (*found.slots, *found.kept, *found.negated)
        left = sorted({*left, *(item.span for item in lost(items, read, (*left, *known)))})
    if len(text) > LONGEST_TEXT:
        left.append((LONGEST_TEXT, len(text)))
        said = f"Only the first {LONGEST_TEXT} characters were read."
        notes.append(Note("too_long", said, left[-1]))
    files = files_of(inputs)
    goals, open_notes = goals_of(slots, found.negated, found.kept, edits, files)
    goals = tuple(_with_added(goal, found.added) for goal in goals)
    return Brief(
        text,
        tuple(slots),
        tuple(edits),
        tuple(then),
        goals,
        tuple(left),
        conflicts,
        tuple(questions),
        tuple(found.kept),
        tuple(found.negated),
        (*notes, *found.notes, *open_notes),
        tuple(wishes),
        tuple(left_out),
    )


_NOTHING = (
    "What is to be built? The text tells of no town, street, building or weather, as in: a small "
    "town by a river."
)


_NO_FILE = (
    'Which file is "{}"? None came with the text; give it as well, or tell in words what it shows.'
)
_DOCUMENTS = (
    "(?:photo|photograph|picture|image|sketch|drawing|scan|survey|screenshot|pdf|spreadsheet|file|"
    "document|floor ?plan|site plan)s?(?![ -](?:postcard|book|perfect))"
)
# Words for a document that the writer has before him, and of which the city shall be made.
_MEANT = re.compile(
    r"\b(?:(?:the|this|my|our|an?) )?(?:attached|enclosed|uploaded|appended) (?:\w+ )??"
    rf"(?:{_DOCUMENTS}|plans?|maps?|data|list|table)\b|\b(?:the|this|my|our|an) attachment\b"
    rf"|\b(?:in|from|like|per|use|using|match|matching) (?:the|this|my|our) {_DOCUMENTS}\b",
    re.IGNORECASE,
)
_LINK = re.compile(r"^(?:in|from|like|per|use|using|match|matching) ", re.IGNORECASE)


def _files_meant(text: str) -> list[str]:
    """Return the words of a text for files that should have come with it."""
    return [_LINK.sub("", found.group()) for found in _MEANT.finditer(text)][:1]


def _says_nothing(found: Findings, items: Sequence[Item]) -> bool:
    """Return whether a description says something, but nothing of what could be built."""
    said = found.slots or found.kept or found.negated
    town = any(
        item.has("noun") and item.noun_class != "person" and before.text not in ("my", "our")
        for before, item in pairwise([Item("mark", (0, 0), (".",)), *items])
    )
    content = bool(found.notes or unread(items, described=True))
    content = content or any(item.kind == "unknown" for item in items)
    return content and not (said or town)


def _with_added(goal: GoalText, kinds: set[str]) -> GoalText:
    """Let a number of people or vehicles be of those besides whom commands add some."""
    kind = goal.predicate.removeprefix("n(").partition(")")[0].partition(",")[0]
    if goal.predicate.startswith("n(") and kind in kinds:
        return replace(goal, predicate=goal.predicate.replace(" == ", " >= "))
    return goal


def _leave(found: Findings, items: Sequence[Item], left: Sequence[Left]) -> None:
    """Take back what was read of wishes that are left out, but for what they protect.

    Of their words only those that nobody knows are not understood.
    """
    for slots in (found.slots, found.negated):
        slots[:] = [slot for slot in slots if not any(one.holds(slot.span) for one in left)]
    found.notes[:] = [note for note in found.notes
                      if not any(one.holds(note.span) for one in left)]  # fmt: skip
    for item in items:
        if item.kind != "unknown" and any(one.holds(item.span) for one in left):
            item.state = item.state or READ


def _but_for_counted(text: str, negated: Sequence[Slot], slots: Sequence[Slot]) -> list[Slot]:
    """Leave out what a word for an empty place denies, or "except" follows, and a number asks for.

    "A deserted town with two people" has two people.
    """
    counted = {slot.key.partition(".")[0] for slot in slots if ".count" in slot.key}
    return [
        slot for slot in negated
        if slot.value not in counted
        or not (slot.text.lower().startswith(_EMPTYING) or _EXCEPT.match(text[slot.span[1] :]))
    ]  # fmt: skip


# What follows a denial of which something is excepted: "nobody about | except: one jogger".
_EXCEPT = re.compile(r"\W*(?:\w+ ){0,2}(?:except|apart from|other than|but for|besides)\b")


def files_of(inputs: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return the names of files by their sources."""
    return {SOURCE_OF.get(kind, kind): name for name, kind in inputs}


def read_note(text: str, *, base: bool = True, names: Iterable[str] = ()) -> Brief:
    """Read the wishes of a text file; what it orders beyond them is noted and ignored.

    Returns
    -------
    brief
        Slots and edits of an allowed kind; its spans point into the file's text.
    """
    wishes, ignored = untrusted.split(text)
    brief = read_brief(wishes, base=base, names=names)
    edits: list[Edit] = []
    for edit, note in untrusted.allowed(brief.edits, text):
        if edit is not None:
            edits.append(replace(edit, wished=True))
        elif note is not None:
            ignored.append(note)
    goals, _ = goals_of(brief.slots, brief.negated, brief.kept, edits)
    return replace(
        brief,
        text=text,
        edits=tuple(edits),
        goals=goals,
        notes=(*brief.notes, *ignored),
        questions=brief.questions if base else (),  # the request itself may say what is built
        wishes=tuple(_allowed_wish(one, edits) for one in brief.wishes),
    )


def _allowed_wish(wish: Wish, edits: Sequence[Edit]) -> Wish:
    """Return a wish of a text file with those of its edits that are allowed."""
    own = (replace(edit, wished=True) for edit in wish.edits)
    return replace(wish, edits=tuple(edit for edit in own if edit in edits))


def _with_options(
    slots: Sequence[Slot], options: Mapping[str, Any]
) -> tuple[list[Slot], list[Conflict]]:
    """Put the values of a command line over those of the text."""
    found = list(slots)
    against = []
    for key, value in _pairs(options):
        others = [slot for slot in found if slot.key == key and slot.value != value]
        for other in others:
            against.append(
                Conflict(
                    f"option_against_text:{key}",
                    f'The text says "{other.text}" ({key} = {other.value}), the option {value}; '
                    "the option holds. Leave one of the two out.",
                    (other.span,),
                )
            )
        at = next((index for index, slot in enumerate(found) if slot.key == key), len(found))
        span: Span = found[at].span if at < len(found) and not others else (0, 0)
        found = [slot for slot in found if slot.key != key]
        found.insert(min(at, len(found)), Slot(key, value, span))
    return found, against


def _pairs(options: Mapping[str, Any]) -> list[tuple[str, Value]]:
    """Return options as slots; "size" may be "600x400" or two numbers."""
    found: list[tuple[str, Value]] = []
    for key, value in options.items():
        if value in (None, ""):
            continue
        if key == "size":
            sides = value.lower().split("x") if isinstance(value, str) else list(value)
            found += [(f"size.{axis}", float(one)) for axis, one in zip("xy", sides, strict=False)]
        else:
            found.append((key, value))
    return found
