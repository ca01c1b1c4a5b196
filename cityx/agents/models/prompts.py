"""Prompts: questions to a model written to a file, to be answered by any model, by hand.

A line of the file is one prompt: what is asked, in words that can be handed to any chat, and a
place for the answer. Whoever answers fills in "answer" and changes nothing else. What is asked
next often depends on an answer, so that prompts are written in rounds, until none is left open.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from cityx.agents.models.recording import Decision, NotRecorded, key_of
from cityx.errors import InputError

BY_HAND = "by_hand"  # name of the model that a file of prompts is for
_FIELDS = frozenset(("id", "role", "key", "nth", "prompt", "request", "answer"))
Known = dict[tuple[str, int], Decision]


@dataclass(frozen=True)
class Prompt:
    """One question that is answered by hand.

    Attributes
    ----------
    id
        Role, beginning of the key, count: "planner-46e6ba2b8cf1-0".
    role
        Who asks.
    key
        Digest of the question, 64 hex digits.
    nth
        How often the same was asked before it.
    prompt
        The question in words.
    request
        The question as plain values; the key is of it.
    answer
        A JSON object, None while there is none.
    """

    id: str
    role: str
    key: str
    nth: int
    prompt: str
    request: Mapping[str, Any]
    answer: Mapping[str, Any] | None = None


class PromptFile:
    """A file of prompts that grows by every question that has no answer in it.

    Parameters
    ----------
    path
        The file; it need not be there.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._known = {(one.key, one.nth) for one in read_prompts(path)} if path.exists() else set()

    def ask(self, role: str, request: Mapping[str, Any], nth: int) -> NotRecorded:
        """Add a question, once, and return the error that says so."""
        key = key_of(BY_HAND, request)
        if (key, nth) not in self._known:
            self._known.add((key, nth))
            words = words_of(request)
            one = Prompt(f"{role}-{key[:12]}-{nth}", role, key, nth, words, request)
            with self.path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(one), ensure_ascii=False) + "\n")
        return NotRecorded(f"{self.path} waits for an answer to {role}-{key[:12]}-{nth}.")


def words_of(request: Mapping[str, Any]) -> str:
    """Return a question in words: the task, the data, earlier answers with what was wrong."""
    parts: list[str] = []
    for message in request["messages"]:
        if message["by"] == "model":
            said = [part.get("text") or json.dumps(part["args"]) for part in message["parts"]]
            parts += ["You answered:", *said]
            continue
        if message["task"] and message["task"] not in parts:
            parts.append(message["task"])
        for part in message["parts"]:
            content = part["content"] if isinstance(part["content"], list) else [part["content"]]
            parts += [_told(item) for item in content]
    schema = json.dumps(_schema(request), indent=1)
    parts.append(f"Answer with one JSON object of this schema, and with nothing else:\n{schema}")
    return "\n\n".join(parts)


def _told(item: Any) -> str:
    if isinstance(item, str):
        return item
    return f"[picture {item['image']}]" if "image" in item else json.dumps(item)


def _schema(request: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return what an answer must look like."""
    found: Mapping[str, Any] | None = request["output"]["schema"]
    return found if found is not None else request["tools"][0]["schema"]


def read_prompts(path: Path, *, answered: bool = False) -> list[Prompt]:
    """Read a file of prompts.

    Parameters
    ----------
    answered
        Whether every one must have its answer.

    Raises
    ------
    InputError
        With every fault of every line: no prompt, a question that was changed, a second one of the
        same, an answer that is missing or not of the form that was asked for.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read: {error}.") from error
    found: list[Prompt] = []
    faults: list[str] = []
    seen: set[tuple[str, int]] = set()
    for number, line in enumerate(lines, start=1):
        prompt, wrong = _read(line)
        if prompt is not None:
            if (prompt.key, prompt.nth) in seen:
                wrong.append(f"{prompt.id} stands there twice.")
            if answered and prompt.answer is None:
                wrong.append(f"{prompt.id} has no answer.")
            seen.add((prompt.key, prompt.nth))
            found.append(prompt)
        faults += [f"{path}, line {number}: {fault}" for fault in wrong]
    if answered and not lines:
        faults.append(f"{path} holds no prompt.")
    if faults:
        raise InputError("\n".join(faults))
    return found


def _read(line: str) -> tuple[Prompt | None, list[str]]:
    """Return the prompt of a line, None where it is none, and what is wrong with it."""
    try:
        record = json.loads(line)
    except ValueError as error:
        return None, [f"no JSON ({error})."]
    if not isinstance(record, dict) or record.keys() != _FIELDS:
        return None, [f"no prompt: it has not exactly the fields {', '.join(sorted(_FIELDS))}."]
    prompt = Prompt(**record)
    try:
        honest = prompt.key == key_of(BY_HAND, prompt.request)
        wrong = [] if honest else [f"{prompt.id}: the key does not fit the question."]
        if honest and prompt.answer is not None:
            wrong += _answer_faults(prompt)
    except (KeyError, TypeError, IndexError, AttributeError) as error:
        return None, [f"no prompt: its question cannot be read ({error!r})."]
    return prompt, wrong


def _answer_faults(prompt: Prompt) -> Iterator[str]:
    from jsonschema import Draft202012Validator

    for error in Draft202012Validator(_schema(prompt.request)).iter_errors(prompt.answer):
        yield f"{prompt.id}: the answer{error.json_path[1:]} is wrong: {error.message}"


def decisions_of(prompts: Iterable[Prompt]) -> Known:
    """Return the answers to prompts as decisions, those without one left out."""
    return {
        (one.key, one.nth): Decision(one.key, one.nth, BY_HAND, one.request, _response(one))
        for one in prompts
        if one.answer is not None
    }


def _response(prompt: Prompt) -> Mapping[str, Any]:
    if prompt.request["output"]["schema"] is not None:
        return {"parts": [{"text": json.dumps(prompt.answer)}]}
    return {"parts": [{"call": prompt.request["tools"][0]["name"], "args": prompt.answer}]}


def is_prompts(path: Path) -> bool:
    """Return whether a file holds prompts with answers rather than a recording."""
    try:
        with path.open(encoding="utf-8") as file:
            first = json.loads(file.readline())
    except (OSError, ValueError):
        return False
    return isinstance(first, dict) and "prompt" in first
