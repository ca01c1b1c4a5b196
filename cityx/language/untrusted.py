"""Untrusted text files: wishes may be read from them, orders to the program may not."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from cityx.language.brief import Edit, Note, Span
from cityx.language.lexicon.words import fold, words_of

IGNORED = "ignored_untrusted_instruction"
_SENTENCE = re.compile(r"[^.!?;\n]+[.!?;\n]*")
# Words a wish about a city has no use for: they speak to the system, its tools or its files.
_ORDER_WORDS = """
    system assistant user developer admin administrator root prompt instruction instructions
    instruct rule rules ignore disregard forget override overrule bypass obey policy safety
    jailbreak python bash shell terminal script code exec execute eval import subprocess command
    commands curl wget http https url download upload fetch email mail send post password passwd
    secret secrets token tokens credential credentials api key keys env environment variable
    folder folders directory directories disk path paths home sudo chmod rm format database sql
    journal registry plugin plugins tool tools function functions call calls server mcp model llm
    gpt claude chatbot agent agents you your yourself pretend roleplay act reveal print output log
    logs upload exfiltrate previous above following everything
"""
_ORDERS = frozenset(_ORDER_WORDS.split())
# What a file may ask for. Removing and replacing are allowed for what is named one by one.
_ALLOWED = (
    "set_", "scale_", "raise_", "add", "plant", "move", "rotate", "scale", "replace", "remove",
)  # fmt: skip
_MOST_NAMED = 10  # objects one sentence of a file may remove or replace


def split(text: str) -> tuple[str, list[Note]]:
    """Blank out the sentences of a file that give orders.

    Returns
    -------
    wishes
        The text with spaces where an order stood, so that places stay.
    notes
        What was ignored.
    """
    notes = []
    wishes = list(text)
    for match in _SENTENCE.finditer(text):
        if _gives_orders(match.group()):
            first, last = match.span()
            wishes[first:last] = " " * (last - first)
            notes.append(_note(text, (first, last)))
    return "".join(wishes), notes


def allowed(edits: Sequence[Edit], text: str) -> Iterator[tuple[Edit | None, Note | None]]:
    """Yield each edit that a file may ask for, or the note that it was ignored."""
    for edit in edits:
        known = edit.verb.startswith(_ALLOWED)
        if known and not (edit.verb in ("remove", "replace") and _sweeping(edit)):
            yield edit, None
        else:
            yield None, _note(text, edit.span)


def _gives_orders(sentence: str) -> bool:
    return any(word.text in _ORDERS or fold(word.text) in _ORDERS for word in words_of(sentence))


def _sweeping(edit: Edit) -> bool:
    """Return whether an edit is about more than a few named objects."""
    target = edit.target
    if target is None:
        return True
    named = len(target.ids) or (target.k if target.rank else 0) or (1 if target.nth else 0)
    return not 0 < named <= _MOST_NAMED


def _note(text: str, span: Span) -> Note:
    said = " ".join(text[slice(*span)].split())[:80]
    return Note(
        IGNORED, f'A file asked: "{said}". Files may wish, not order; it was ignored.', span
    )
