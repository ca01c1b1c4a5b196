"""The page of a project in a notebook or a browser, served by a process of its own."""

from __future__ import annotations

import subprocess
import sys
import weakref
from html import escape
from pathlib import Path

from cityx.errors import EngineError
from cityx.viewer.view import ADDRESS, check_ready


class Page:
    """A page that shows a city while this object lives, or until `close`.

    Parameters
    ----------
    folder
        Of a built city.

    Raises
    ------
    InputError, MissingExtra
        As of `cityx.viewer.view.check_ready`.
    EngineError
        If the page cannot be served; with the server's last words.
    """

    def __init__(self, folder: Path) -> None:
        check_ready(folder)
        self._process = subprocess.Popen(
            [sys.executable, "-m", "cityx.cli", "view", str(folder), "--no-browser"],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line.startswith(ADDRESS):
            words = f"{line}{self._process.communicate()[0]}".strip()
            raise EngineError(f"The page cannot be served. The server's words: {words[-500:]}")
        self.url = line.removeprefix(ADDRESS).strip()
        self._end = weakref.finalize(self, _ended, self._process)

    def close(self) -> None:
        """Stop serving it."""
        self._end()

    def __repr__(self) -> str:
        """Return where the page is."""
        return f"Page({self.url})"

    def _repr_html_(self) -> str:
        address = escape(self.url)
        return (
            f'<iframe src="{address}" width="100%" height="600" style="border: 0"></iframe>'
            f'<a href="{address}" target="_blank">{address.partition("#")[0]}</a>'
        )


def _ended(process: subprocess.Popen[str]) -> None:
    process.terminate()
    process.communicate()
