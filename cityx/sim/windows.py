"""A window that shows an environment to who looks on, in real time."""

from __future__ import annotations

import os
import sys
import time

import numpy as np
from numpy.typing import NDArray

from cityx.errors import UsageError

NO_SCREEN = (
    'render_mode "human" needs a screen and Tk, and there is none here. Take "rgb_array", or look '
    "on in a browser: cityx sim PLACE --view."
)
LARGER = 2  # pixels of the screen for one of a picture, across and down


def has_screen() -> bool:
    """Return whether there is a screen that windows can be on."""
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY"))


class Window:
    """A window of the screen; a class since it stays open from picture to picture.

    Parameters
    ----------
    title
        Of the window.
    seconds
        Between two pictures, which `show` waits for.

    Raises
    ------
    UsageError
        If there is no screen.
    """

    def __init__(self, title: str, seconds: float) -> None:
        try:
            import tkinter
        except ImportError as error:
            raise UsageError(NO_SCREEN) from error
        try:
            self._root = tkinter.Tk()
        except tkinter.TclError as error:
            raise UsageError(NO_SCREEN) from error
        self._root.title(title)
        self._label = tkinter.Label(self._root)
        self._label.pack()
        self._seconds, self._next = seconds, 0.0

    def show(self, image: NDArray[np.uint8]) -> None:
        """Show a picture, (h, w, 3), when its time has come."""
        import tkinter

        time.sleep(max(self._next - time.monotonic(), 0.0))
        self._next = time.monotonic() + self._seconds
        height, width = image.shape[:2]
        head = f"P6 {width} {height} 255 ".encode()
        picture = tkinter.PhotoImage(
            master=self._root, data=head + image.tobytes(), format="PPM"
        ).zoom(LARGER)
        self._label.configure(image=picture)
        self._shown = picture  # Tk shows nothing that nobody holds
        self._root.update()

    def close(self) -> None:
        """Close the window."""
        self._root.destroy()
