"""Files that appear complete or not at all."""

from __future__ import annotations

import errno
import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

_SAID = {
    errno.ENOSPC: "The disk is full",
    errno.EDQUOT: "The quota of the disk is used up",
    errno.EFBIG: "A file would be larger than may be written",
    errno.EROFS: "The disk can only be read",
    errno.EACCES: "There is no permission for it",
    errno.EPERM: "There is no permission for it",
}
_TEXTS = ("No space left", "disk is full", "quota exceeded", "File too large")
_OF_SQLITE = ("SQLITE_FULL", "SQLITE_IOERR", "SQLITE_READONLY", "SQLITE_CANTOPEN")


def disk_fault(error: BaseException | None, where: str | os.PathLike[str] = "") -> str | None:
    """Say what a disk refused if an error, or what led to it, comes of that; None otherwise.

    Parameters
    ----------
    error
        The error.
    where
        The place to name where the error names none.
    """
    seen: set[int] = set()  # an error that is raised from one that it led to closes the chain
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        said = None
        if isinstance(error, OSError) and error.errno in _SAID:
            said = _SAID[error.errno]
            where = error.filename if isinstance(error.filename, str) else where
        elif isinstance(error, sqlite3.Error):
            name = getattr(error, "sqlite_errorname", "")
            said = "The disk is full or fails" if name.startswith(_OF_SQLITE) else None
        elif any(text in str(error) for text in _TEXTS):
            said = "The disk is full"
        if said:
            return f"{said}: {where}" if where else said
        error = error.__cause__ or error.__context__
    return None


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
