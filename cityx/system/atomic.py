"""Files that appear complete or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4


@contextmanager
def replaced(path: str | os.PathLike[str], *, aside: Path | None = None) -> Iterator[Path]:
    """Give a temporary name beside `path`; rename it to `path` when the block ends well.

    A reader sees the old file or the new one, never half of one, also when the process is killed
    or the power fails. If the block raises, or writes nothing, what was at `path` stays.

    Parameters
    ----------
    path
        The file to make; its folder is made if missing. The temporary name keeps the suffix, for
        writers that choose their format by it.
    aside
        Folder on the same disk for the temporary name, so that whoever takes over from a killed
        process finds all that is half written in one place; beside `path` when None.

    Examples
    --------
    >>> with replaced("report.json") as temporary:
    ...     temporary.write_text("{}")
    """
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = target.with_name(f".{target.stem}.{uuid4().hex[:12]}{target.suffix}")
    if aside is not None:
        temporary = aside / temporary.name
    try:
        yield temporary
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        temporary.replace(target)
    except BaseException:
        with suppress(FileNotFoundError):
            temporary.unlink()
        raise
