"""Tasks: what is asked in words, what it starts from, and when it counts as done."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field, fields
from hashlib import blake2b
from pathlib import Path
from typing import Any

from cityx.errors import InputError, UsageError, nearest
from cityx_bench.inputs import SMALL_INPUTS
from cityx_bench.scenes import EMPTY, SCENES

PUBLIC = Path(__file__).with_name("tasks.json")
CATEGORIES = ("generate", "edit", "multimodal", "dynamic", "clarify")
# Slots that ask for what moves.
MOVING = ("traffic", "pedestrians", "agent")
MAX_BYTES = 4 << 20  # a thousand tasks take less than one megabyte
SlotPair = tuple[str, str | float]


@dataclass(frozen=True)
class Task:
    """One task.

    Attributes
    ----------
    id
        "P01".
    text
        All that a driver is told, besides the inputs and the base.
    inputs
        Names of files, see `cityx_bench.inputs`.
    base
        Scene that is there before, see `cityx_bench.scenes`.
    setup
        "ACTION NAME=VALUE ...", run on the base before the task.
    slots
        What the text says, as keys and values; it scores the reading alone.
    expect
        Predicates over the final city; a clean city is asked for besides.
    note
        What a reader of the task should know.
    group
        Under which it is counted, where that is none of `CATEGORIES`.
    """

    id: str
    text: str
    inputs: tuple[str, ...] = ()
    base: str = EMPTY
    setup: tuple[str, ...] = ()
    slots: tuple[SlotPair, ...] = ()
    expect: tuple[str, ...] = ()
    note: str = field(default="", compare=False)
    group: str = ""

    @property
    def category(self) -> str:
        """Its group, or one of `CATEGORIES`, by what the task holds."""
        if self.group:
            return self.group
        if "reply(clarify)" in self.expect:
            return "clarify"
        if any(key in MOVING or value == "add_traffic" for key, value in self.slots):
            return "dynamic"
        if self.inputs:
            return "multimodal"
        return "generate" if self.base == EMPTY else "edit"

    @property
    def digest(self) -> str:
        """Name of what the task asks, 16 hex digits: another one is another task."""
        text = json.dumps({**self.to_json(), "note": ""}, sort_keys=True)
        return blake2b(text.encode(), digest_size=8).hexdigest()

    def to_json(self) -> dict[str, Any]:
        """Return the task as a plain dictionary, less what it leaves out."""
        usual = {"base": EMPTY, "note": "", "group": ""}
        return {key: value for key, value in asdict(self).items() if value != usual.get(key, ())}


def read_tasks(path: Path = PUBLIC, only: Iterable[str] = ()) -> tuple[Task, ...]:
    """Read tasks from a file.

    Parameters
    ----------
    path
        A list in JSON, or a text (.md, .yaml) whose lines are ``- id: P01`` and ``key: value``, in
        a fence or alone.
    only
        Ids of those that are wanted; all when empty.

    Raises
    ------
    InputError
        If it cannot be read, with every fault by the id of its task.
    UsageError
        If an id is not among the tasks.
    """
    records, faults = _records(path)
    tasks = tuple(_task(record, faults) for record in records)
    names = [task.id for task in tasks]
    faults += [f"{name}: stands there twice." for name in sorted(_twice(names))]
    if not tasks and not faults:
        faults.append("it holds no task.")
    if faults:
        raise InputError("\n".join(f"{path}: {fault}" for fault in faults))
    wanted = list(only)
    unknown = [f'There is no task "{name}".{nearest(name, names)}' for name in wanted
               if name not in names]  # fmt: skip
    if unknown:
        raise UsageError("\n".join(unknown))
    return tuple(task for task in tasks if not wanted or task.id in wanted)


def write_tasks(tasks: Iterable[Task], path: Path) -> None:
    """Write tasks as JSON, one after the other, so that changes can be read."""
    blocks = []
    for task in tasks:
        record = {**task.to_json(), **({"slots": _slot_texts(task)} if task.slots else {})}
        lines = (f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}"
                 for key, value in record.items())  # fmt: skip
        blocks.append("{\n" + ",\n".join(lines) + "\n}")
    path.write_text(f"[\n{', '.join(blocks)}\n]\n", encoding="utf-8")


def _slot_texts(task: Task) -> list[str]:
    return [f"{key}={value:g}" if isinstance(value, float) else f"{key}={value}"
            for key, value in task.slots]  # fmt: skip


def _twice(names: list[str]) -> set[str]:
    return {name for name in names if names.count(name) > 1}


def _records(path: Path) -> tuple[list[dict[str, Any]], list[str]]:
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(f"{path} is larger than {MAX_BYTES >> 20} MB; tasks are short.")
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read as a text: {error}.") from error
    if path.suffix != ".json":
        return _of_lines(text)
    try:
        held = json.loads(text)
    except ValueError as error:
        raise InputError(f"{path} is not JSON ({error}).") from error
    if not isinstance(held, list):
        raise InputError(f"{path} is no list of tasks.")
    wrong = [f"entry {number} is no object." for number, item in enumerate(held, start=1)
             if not isinstance(item, dict)]  # fmt: skip
    return [item for item in held if isinstance(item, dict)], wrong


_FENCE = re.compile(r"^```\w*\n(.*?)^```", re.MULTILINE | re.DOTALL)
_LINE = re.compile(r"(- |  )(\w+):\s+(.*\S)\s*")
_ITEM = re.compile(r'\s*("(?:[^"\\]|\\.)*"|[^",\[\]]+)\s*(?:,|$)')


def _of_lines(text: str) -> tuple[list[dict[str, Any]], list[str]]:
    """Read ``- id: P01`` and the lines below it; blank lines and comments say nothing."""
    fence = next((m for m in _FENCE.finditer(text) if re.search(r"^- id:", m[1], re.M)), None)
    before = text[: fence.start(1)].count("\n") if fence else 0
    records: list[dict[str, Any]] = []
    faults: list[str] = []
    for number, line in enumerate((fence[1] if fence else text).splitlines(), start=before + 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        found = _LINE.fullmatch(line)
        name = records[-1].get("id", "") if records else ""
        if not found or (not records and found[1] != "- "):
            faults.append(f'line {number} ({name or "before any task"}): "{line.strip()[:60]}" is '
                          "not of the form key: value.")  # fmt: skip
            continue
        if found[1] == "- ":
            records.append({})
        try:
            records[-1][found[2]] = _value(found[3])
        except ValueError:
            faults.append(f"line {number} ({name}): {found[2]} has a value that cannot be read.")
    return records, faults


def _value(text: str) -> Any:
    """Read a text in quotes, a list, or a bare word."""
    if not text.startswith("["):
        return json.loads(text) if text.startswith('"') else text
    if not text.endswith("]"):
        raise ValueError(text)
    inner, place, items = text[1:-1].strip(), 0, []
    while place < len(inner):
        found = _ITEM.match(inner, place)
        if found is None:
            raise ValueError(text)
        word = found[1].strip()
        items.append(json.loads(word) if word.startswith('"') else word)
        place = found.end()
    return items


def _task(record: Mapping[str, Any], faults: list[str]) -> Task:
    """Make a task, adding what is wrong with it to the faults."""
    name = str(record.get("id", "a task without an id"))
    found = list(_faults(record))
    faults += [f"{name}: {fault}" for fault in found]
    if found:
        return Task(name, "")
    lists = {key: tuple(record.get(key, ())) for key in ("inputs", "setup", "expect")}
    slots = tuple(_slot(item) for item in record.get("slots", ()))
    return Task(name, record["text"], base=record.get("base", EMPTY), slots=slots,
                note=record.get("note", ""), group=record.get("group", ""), **lists)  # fmt: skip


def _slot(item: Any) -> SlotPair:
    """Read "key=value", or a pair; what looks like a number is one."""
    key, _, value = item.partition("=") if isinstance(item, str) else (item[0], "", item[1])
    try:
        return key, float(value)
    except ValueError:
        return key, value


def _faults(record: Mapping[str, Any]) -> Iterator[str]:
    known = [column.name for column in fields(Task)]
    yield from (f'has no meaning for "{key}".{nearest(key, known)}' for key in record
                if key not in known)  # fmt: skip
    for key in ("id", "text", "base", "note", "group"):
        value = record.get(key, "" if key in ("base", "note", "group") else None)
        if not isinstance(value, str) or (key in ("id", "text") and not value.strip()):
            yield f"its {key} is no text."
    for key in ("inputs", "setup", "expect"):
        value = record.get(key, [])
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            yield f"its {key} is no list of texts."
            return
    yield from _slot_faults(record.get("slots", []))
    if not record.get("expect"):
        yield "it expects nothing, so that nothing could fail."
    base = record.get("base", EMPTY)
    if base not in SCENES and base != EMPTY:
        hint = nearest(str(base), SCENES)
        yield f'there is no scene "{base}"; {", ".join((EMPTY, *SCENES))}.{hint}'
    yield from (f'there is no input "{name}"; {", ".join(SMALL_INPUTS)}.'
                for name in record.get("inputs", ()) if name not in SMALL_INPUTS)  # fmt: skip


def _slot_faults(slots: Any) -> Iterator[str]:
    if not isinstance(slots, list):
        yield "its slots are no list."
        return
    for item in slots:
        pair = isinstance(item, list) and len(item) == 2 and isinstance(item[0], str)
        if not pair and not (isinstance(item, str) and "=" in item.strip("=")):
            yield f'the slot {json.dumps(item)} is not of the form "key=value".'
        elif pair and not isinstance(item[1], str | int | float):
            yield f"the slot {json.dumps(item)} has a value that is no word and no number."
