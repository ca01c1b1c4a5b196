"""Quoting: text from files and models as data in a prompt, never as prose."""

from __future__ import annotations

import json
import unicodedata
from collections.abc import Iterable
from typing import Any

LONGEST = 80  # letters of a name or a word
SECRET = "[secret]"  # stands where one was


def plain(text: str) -> str:
    """Return a text without control characters, marks of direction and line breaks."""
    kept = (" " if unicodedata.category(one)[0] in "CZ" else one for one in text)
    return " ".join("".join(kept).split())


def quoted(value: Any, longest: int = LONGEST) -> str:
    """Return a value as JSON on one line; texts in it are plain and at most `longest` letters."""
    return json.dumps(_cut(value, longest), ensure_ascii=False, sort_keys=True)


def _cut(value: Any, longest: int) -> Any:
    if isinstance(value, str):
        text = plain(value)
        return text if len(text) <= longest else text[: longest - 1] + "…"
    if isinstance(value, dict):
        return {_cut(str(key), longest): _cut(one, longest) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_cut(one, longest) for one in value]
    return (
        value
        if value is None or isinstance(value, bool | int | float)
        else _cut(str(value), longest)
    )


def scrubbed(text: str, secrets: Iterable[str]) -> str:
    """Return a text without keys: what a server says of one must not reach a file."""
    for secret in secrets:
        if secret:
            text = text.replace(secret, SECRET)
    return text
