"""The cache folder: reproducible results that are slow to make; deleting it loses nothing."""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from cityx.system.atomic import replaced

if TYPE_CHECKING:
    from numpy.typing import NDArray

VARIABLE = "CITYX_CACHE"  # another folder, or empty for none
Arrays: TypeAlias = "dict[str, NDArray[Any]]"


def cache_folder() -> Path | None:
    """Return the folder, which need not exist; None where the user wants none."""
    given = os.environ.get(VARIABLE)
    if given is not None:
        return Path(given) if given else None
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
    elif sys.platform == "darwin":
        base = str(Path.home() / "Library" / "Caches")
    else:
        base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "cityx"


def cached_arrays(key: str, make: Callable[[], Arrays]) -> Arrays:
    """Return what `make` returns, from the folder where an earlier run has left it there.

    Parameters
    ----------
    key
        File name below the folder; it must change with everything the arrays depend on.
    make
        Makes the arrays. A file that cannot be read is made anew; a folder that cannot be written
        is passed over.
    """
    from cityx.system.packed import read_arrays, write_arrays

    folder = cache_folder()
    if folder is None:
        return make()
    path = folder / f"{key}.npz"
    try:
        return read_arrays(path, checked=True)
    except Exception:  # noqa: BLE001  (zipfile, NumPy and the system each have their own)
        arrays = make()
    with suppress(OSError), replaced(path) as temporary:
        write_arrays(temporary, arrays)
    return arrays


def cached_json(key: str, make: Callable[[], Any]) -> Any:
    """Return what `make` returns, plain values, from the folder where an earlier run left it.

    Parameters
    ----------
    key
        File name below the folder; it must change with everything the values depend on.
    make
        Makes the values.
    """
    folder = cache_folder()
    if folder is None:
        return make()
    path = folder / f"{key}.json"
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError):
        made = make()
    with suppress(OSError), replaced(path) as temporary:
        temporary.write_text(json.dumps(made))
    return made


def kept_folder(name: str) -> Path:
    """Return a folder of the cache for files of a user's, one of this process without a cache."""
    folder = cache_folder()
    return folder / name if folder else Path(tempfile.gettempdir()) / f"cityx-{os.getpid()}" / name
