"""What a user hands in: words that are files, and words that are an instruction."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike, fspath
from pathlib import Path


def files_and_text(words: Iterable[str | PathLike[str]]) -> tuple[list[Path], str]:
    """Part files from an instruction: what has a blank and is no file is in words.

    A path that is no text is a file, there or not.
    """
    paths, texts = [], []
    for word in words:
        path = Path(word)
        try:
            is_file = path.exists()
        except OSError:  # a text may be longer than any name
            is_file = False
        text = fspath(word)
        named = not any(map(str.isspace, text)) and (path.suffix or len(path.parts) > 1)
        if is_file or named or not isinstance(word, str):
            paths.append(path)
        else:
            texts.append(text)
    return paths, " ".join(texts)
