"""The files a user handed in: the only files that actions may read.

An action never takes a path. It takes this value from the runner, and a model may at most name one
of its entries by position.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cityx.errors import ActionFailed


@dataclass(frozen=True)
class InputFiles:
    """Files in the order they were given.

    Attributes
    ----------
    paths
        The files.
    kinds
        What each of them is, as `cityx.sources.input_kinds` tells it; () where nobody asked.
    """

    paths: tuple[Path, ...] = ()
    kinds: tuple[str, ...] = ()

    def of_kind(self, *kinds: str) -> tuple[Path, ...]:
        """Return the files of some kinds, in the order they were given."""
        pairs = zip(self.paths, self.kinds, strict=False)
        return tuple(path for path, kind in pairs if kind in kinds)

    def path(self, index: int, suffixes: tuple[str, ...] = ()) -> Path:
        """Return one file.

        Parameters
        ----------
        index
            Position, from 0.
        suffixes
            Endings one of which the name must have; () for any.

        Raises
        ------
        ActionFailed
            If there is no such file or it is of another kind.
        """
        if not 0 <= index < len(self.paths):
            count = len(self.paths)
            raise ActionFailed(f"There is no input {index}; {count} input files were given.")
        path = self.paths[index]
        if suffixes and not path.name.lower().endswith(suffixes):
            raise ActionFailed(
                f"Input {index} is {path.name}; this action reads {', '.join(suffixes)}."
            )
        return path
