"""Formats that a city is written in: one value each, of CityX or of an installed package.

A package registers a `Format` under the entry point group ``cityx.formats``; the table of all is
`cityx.projects.file_formats.formats`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cityx.errors import UsageError

if TYPE_CHECKING:
    from cityx.city.city import City


@dataclass(frozen=True)
class Format:
    """A format that a city is written in.

    Attributes
    ----------
    name
        As in ``--formats``.
    file
        Name of the file in the folder of results, by which an edit knows what to renew.
    write
        Writes a city to the path of that file; what it makes beside it stays in the same folder.
        None for what Blender writes.
    help
        In a few words.
    renew
        Writes a city as ``write`` does, given another city and the file that shows it besides, so
        that what both share need not be made again; None where all is written anew.
    ready
        Raises `cityx.errors.MissingExtra` where a library is missing; None where it needs none.
    """

    name: str
    file: str
    write: Callable[[City, Path], object] | None
    help: str = ""
    ready: Callable[[], None] | None = None
    renew: Callable[[City, Path, City, Path], object] | None = None


def admit_format(value: object) -> tuple[str, Format]:
    """Return the name of a format from outside, and the format.

    Raises
    ------
    UsageError
        If it is none, or writes outside its folder.
    """
    if not isinstance(value, Format) or not callable(value.write):
        raise UsageError("it is no cityx.outputs.format.Format with a function write(city, path).")
    if not value.name.isidentifier() or Path(value.file).name != value.file or not value.file:
        raise UsageError(
            f'format "{value.name}" needs a plain name and a file name, not "{value.file}".'
        )
    return value.name, value
