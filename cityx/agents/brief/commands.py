"""Commands: the sentences of an instruction for a city that exists."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from cityx.agents.brief.brief import Edit, Question, Span, Value
from cityx.agents.brief.describe import describe
from cityx.agents.brief.edits import Unclear, edits_of
from cityx.agents.brief.grammar import Node, parse
from cityx.agents.brief.here import Findings
from cityx.agents.brief.scan import ENDS, Item
from cityx.agents.brief.scopes import READ
from cityx.agents.brief.terminals import Terminal, terminals_of

PARSES = 60  # attempts of the grammar for one instruction, so that time stays short
LONGEST_COMMAND = 32  # terminals; no command of a person is longer
# Slot -> the edit that sets it. What lies in one edit is said together.
ENVIRONMENT = {
    "weather": "set_weather", "rain.intensity": "set_weather", "snow.intensity": "set_weather",
    "fog.intensity": "set_weather", "wetness": "set_weather", "time": "set_time",
    "season": "set_season", "style": "set_style", "traffic": "set_traffic",
    "pedestrians": "set_pedestrians", "lights": "set_lights", "density": "set_density",
}  # fmt: skip
_WITH_WEATHER = ("set_time", "set_season")
_OF_THE_CITY = {
    "building.roof": "set_roof", "building.material": "set_material",
    "building.color": "set_color", "roads.width": "set_width",
}  # fmt: skip
_OBJECTS = ("building", "type", "element", "plant", "vehicle", "person", "road")


@dataclass
class Commands:
    """What the commands of an instruction came to."""

    edits: list[Edit] = field(default_factory=list)
    questions: list[Question] = field(default_factory=list)
    found: Findings = field(default_factory=lambda: Findings(""))
    parses: int = 0


def read_edits(text: str, items: Sequence[Item]) -> Commands:
    """Read every command of an instruction; what no command takes describes the city."""
    commands = Commands(found=Findings(text))
    for clause in commands_of(items):
        _read(commands, text, clause)
    return commands


def commands_of(items: Sequence[Item]) -> Iterator[list[Item]]:
    """Cut items into commands: at the ends of sentences, and before a verb after "and"."""
    clause: list[Item] = []
    for at, item in enumerate(items):
        if item.is_mark(ENDS):
            yield clause
            clause = []
            continue
        before = items[at - 1] if at else None
        joined = before is not None and (before.is_mark(",") or before.get("rel") in ("and", "but"))
        if joined and item.has("verb") and _is_command(items, at) and _has_object(clause):
            yield clause
            clause = []
        clause.append(item)
    yield clause


def _is_command(items: Sequence[Item], at: int) -> bool:
    """Tell whether a word that may be a verb is one here: "and | plant trees"."""
    if not items[at].has("noun", "material", "side"):
        return not items[at].state
    after = items[at + 1] if at + 1 < len(items) else None
    return after is not None and (after.kind in ("function", "quantity", "id") or after.has("noun"))


def _has_object(clause: Sequence[Item]) -> bool:
    return any(item.kind == "id" or item.has("noun", "slot", "rel") for item in clause)


def _read(commands: Commands, text: str, clause: list[Item]) -> None:
    live = [item for item in clause if not item.state and item.kind != "mark"]
    if not live:
        _settle(commands, text, clause)
        return
    verb = next((item.get("verb") for item in live if item.kind != "function"), "")
    if verb == "UNDO" or (live[0].has("verb") and live[0].get("verb") == "UNDO"):
        commands.edits.append(_undo(live))
        return
    if any(item.has("vague") for item in live) or (verb == "IMPROVE" and not _named(live)):
        _ask(commands, live)
        return
    changed = _amount_of_life(live)
    if changed is not None:
        commands.edits.append(changed)
        return
    if _named(live):
        edits = _parsed(commands, clause)
        if edits:
            commands.edits += edits
            _settle(commands, text, clause)
            return
    _describe(commands, text, clause, live)


def _settle(commands: Commands, text: str, clause: Sequence[Item]) -> None:
    """Take what a command protects or denies."""
    inner = describe(text, [item for item in clause if item.state and item.state != READ])
    commands.found.kept += inner.kept
    commands.found.negated += inner.negated


def _named(items: Iterable[Item]) -> bool:
    """Tell whether objects are named, rather than the city as a whole."""
    return any(
        item.kind == "id" or (item.noun_class in _OBJECTS and not item.has("slot"))
        for item in items
    ) or any(item.noun == "everything" for item in items)


def _span(items: Sequence[Item]) -> Span:
    return min(item.span[0] for item in items), max(item.span[1] for item in items)


def _undo(items: Sequence[Item]) -> Edit:
    count = next((item.quantity.low for item in items if item.quantity is not None), 1.0)
    every = any(item.get("rel") == "all" or item.noun == "everything" for item in items)
    for item in items:
        item.state = READ
    return Edit("undo", change=(("undo", "all" if every else int(count or 1)),), span=_span(items))


def _ask(commands: Commands, items: Sequence[Item]) -> None:
    for item in items:
        item.state = READ
    commands.edits.append(Edit("unspecified", span=_span(items)))
    commands.questions.append(
        Question(
            "What should change? The words do not say it.",
            ("the weather or the time", "the style of the buildings", "more trees", "the traffic"),
        )
    )


def _amount_of_life(items: Sequence[Item]) -> Edit | None:
    """Read "more traffic" and "reduce the number of pedestrians", which name no object."""
    more = {"more": "heavy", "many": "heavy", "few": "light"}
    verbs = {"RAISE": "heavy", "LOWER": "light"}
    for at, item in enumerate(items):
        crowd = item.noun == "pedestrian" and (
            item.words[-1].endswith("s") or item.text == "people"
        )
        if not (crowd or (item.noun == "vehicle" and item.text == "traffic")):
            continue
        words = items[max(0, at - 3) : at]
        how = next((more[w.get("amount")] for w in words if w.get("amount") in more), "")
        how = how or next((w.get("strength") for w in words if w.get("strength")), "")
        how = how or verbs.get(items[0].get("verb"), "")
        others = [w for w in items if w.noun_class in _OBJECTS and w is not item]
        if how and not others and all(w.quantity is None for w in items):
            for word in items:
                word.state = word.state or READ
            key = "traffic" if item.noun == "vehicle" else "pedestrians"
            return Edit(f"set_{key}", change=((key, how),), span=_span(items))
    return None


def _describe(commands: Commands, text: str, clause: list[Item], live: list[Item]) -> None:
    """Read a command that names no object: weather, time, style; or one nobody understands."""
    inner = describe(text, clause)
    found = commands.found
    found.kept += inner.kept
    found.negated += inner.negated
    found.notes += inner.notes
    grouped: dict[str, list[tuple[str, Value]]] = {}
    for slot in inner.slots:
        verb = ENVIRONMENT.get(slot.key) or _OF_THE_CITY.get(slot.key, "")
        if verb:
            grouped.setdefault(verb, []).append((slot.key, slot.value))
        else:
            found.slots.append(slot)
    if "set_weather" in grouped:
        for verb in _WITH_WEATHER:
            grouped["set_weather"] += grouped.pop(verb, [])
    commands.edits += [
        Edit(verb, change=tuple(change), span=_span(live)) for verb, change in grouped.items()
    ]
    if not inner.slots and not inner.kept and not inner.negated and live[0].get("verb") != "APPLY":
        words = text[slice(*_span(live))]
        if any(item.kind not in ("function",) for item in live):
            commands.questions.append(Question(f'What should "{words}" change, and how?'))


def _parsed(commands: Commands, clause: list[Item]) -> list[Edit]:
    """Parse a command; where it does not fit, leave out one word after the other."""
    for verb_first in (True, False):
        terminals = terminals_of(clause, verb_first=verb_first)
        if not terminals or len(terminals) > LONGEST_COMMAND:
            continue
        if terminals[0][0] in ("AMOUNT", "COUNT") and all(name != "BE" for name, _ in terminals):
            terminals.insert(0, ("ADD", -1))
        for attempt in _attempts(terminals):
            if commands.parses >= PARSES:
                return []
            commands.parses += 1
            command = parse(attempt, clause)
            if command is not None:
                for _, index in attempt:
                    if index >= 0:
                        clause[index].state = READ
                return _made(commands, command, _span(clause))
    return []


def _made(commands: Commands, command: Node, span: Span) -> list[Edit]:
    try:
        return [replace(edit, span=span) for edit in edits_of(command)]
    except Unclear:
        words = commands.found.text[slice(*span)]
        commands.questions.append(Question(f'By how much? "{words}" does not say it.'))
        return [Edit("unspecified", span=span)]


def _attempts(terminals: list[Terminal]) -> Iterator[list[Terminal]]:
    yield terminals
    soft = [at for at, (name, _) in enumerate(terminals) if name in _SOFT]
    for at in reversed(soft):
        yield terminals[:at] + terminals[at + 1 :]
    for end in range(len(terminals) - 1, 1, -1):
        yield terminals[:end]


_SOFT = ("ATTR", "SIDE", "MODE", "AMOUNT", "OF", "TO", "BY", "WITH", "ON", "IN", "AND", "BE", "IT",
         "WHOLE", "ALL", "REL", "STYLE", "ORDINAL")  # fmt: skip
