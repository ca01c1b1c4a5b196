"""Driving with the keys of a terminal: what is pressed, and what lies round the agent in colours.

A terminal tells that a key is pressed and not that it is let go, so a key counts for a short while
after it was last told; terminals repeat the keys that are held.
"""

from __future__ import annotations

import os
import select
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cityx.errors import UsageError
from cityx.sim.engine import Engine
from cityx.sim.pictures import picture
from cityx.sim.state import DT

NO_TERMINAL = (
    "--keyboard needs a terminal with keys and colours, and there is none here; leave it out and "
    "the rule drives."
)
KEYS = "W or up: go, S or down: brake and back, A D or left right: steer, Q: end"
HELD = 0.35  # seconds for which a key counts after it was last told
# What a terminal sends -> key.
ARROWS = {b"\x1b[A": "w", b"\x1b[B": "s", b"\x1b[D": "a", b"\x1b[C": "d"}
STEER, GO = {"a": 1.0, "d": -1.0}, {"w": 1.0, "s": -1.0}  # left is positive
COLUMNS, ROWS = 72, 36  # letters of the picture; each holds two pixels, one above the other
HOME = "\x1b[H\x1b[J"  # writes over what was shown before
END, INTERRUPT = "q", b"\x03"


class Keyboard:
    """The keys of the terminal; a class since the terminal must be set back.

    Raises
    ------
    UsageError
        If the process has no terminal.
    """

    def __init__(self) -> None:
        try:
            import termios
        except ImportError as error:  # Windows
            raise UsageError(NO_TERMINAL) from error
        if not (sys.stdin.isatty() and sys.stdout.isatty()):
            raise UsageError(NO_TERMINAL)
        self._termios = termios
        self._handle = sys.stdin.fileno()
        self._told: dict[str, float] = {}

    @contextmanager
    def listening(self) -> Iterator[Self]:
        """Tell each key as it is pressed; the terminal is set back at the end."""
        import tty

        before = self._termios.tcgetattr(self._handle)
        tty.setcbreak(self._handle)
        try:
            yield self
        finally:
            self._termios.tcsetattr(self._handle, self._termios.TCSADRAIN, before)

    def wait(self, until: float) -> None:
        """Take what is pressed until a time of `time.monotonic`, what waits already at least."""
        while True:
            left = max(until - time.monotonic(), 0.0)
            if select.select([self._handle], [], [], left)[0]:
                self.take(os.read(self._handle, 64), time.monotonic())
            elif left == 0.0 or time.monotonic() >= until:
                return

    def take(self, told: bytes, now: float) -> None:
        """Take what the terminal sends at a time."""
        for arrow, key in ARROWS.items():
            told = told.replace(arrow, key.encode())
        if INTERRUPT in told or not told:
            raise KeyboardInterrupt
        for key in told.decode(errors="replace").lower():
            self._told[key] = now

    def holds(self, key: str, now: float) -> bool:
        """Return whether a key counts as pressed at a time."""
        return now - self._told.get(key, -np.inf) <= HELD

    @property
    def ended(self) -> bool:
        """Whether the key that ends it was pressed."""
        return END in self._told

    def action(self, now: float) -> NDArray[np.float64]:
        """Return (2,) steer and go, -1 to 1, by the keys that count at a time."""
        return np.array([
            sum(value for key, value in keys.items() if self.holds(key, now))
            for keys in (STEER, GO)
        ])  # fmt: skip


class Hand:
    """Whoever sits at the keys, as the driver of an engine, in real time.

    Parameters
    ----------
    keyboard
        Its keys.
    say
        Takes the picture and a line of every step, as text of a terminal.
    """

    def __init__(self, keyboard: Keyboard, say: Callable[[str], None]) -> None:
        self._keyboard, self._say = keyboard, say
        self._next = time.monotonic()

    def __call__(self, engine: Engine) -> NDArray[np.float64]:
        """Show where the agent is, wait a step, and return (1, 1, 2) what the keys say.

        Raises
        ------
        KeyboardInterrupt
            If the key that ends it was pressed.
        UsageError
            If two numbers do not say what the agent does.
        """
        on_foot = getattr(engine.options, "vehicle", "") == "person"
        if engine.action_size != 2 or on_foot:
            raise UsageError("--keyboard steers what has wheels: of drive, deliver or explore.")
        row = engine.state.row
        told = (
            f"{row('speed')[0, 0]:5.1f} m/s, {row('gone')[0, 0]:.0f} of {row('goal')[0, 0]:.0f} m"
        )
        self._say(f"{HOME}{blocks(picture(engine, 0, 0))}\n{told}  {KEYS}\n")
        self._next = max(self._next + DT, time.monotonic())
        self._keyboard.wait(self._next)
        if self._keyboard.ended:
            raise KeyboardInterrupt
        return self._keyboard.action(time.monotonic()).reshape(1, 1, 2)


def blocks(image: NDArray[np.uint8]) -> str:
    """Return a picture, (h, w, 3), as lines of half blocks in colours of the terminal."""
    rows = np.arange(2 * ROWS) * image.shape[0] // (2 * ROWS)
    columns = np.arange(COLUMNS) * image.shape[1] // COLUMNS
    small = image[rows][:, columns].astype(int)
    lines = []
    for top, bottom in zip(small[::2].tolist(), small[1::2].tolist(), strict=True):
        letters = (
            f"\x1b[38;2;{a};{b};{c}m\x1b[48;2;{d};{e};{f}m\u2580"
            for (a, b, c), (d, e, f) in zip(top, bottom, strict=True)
        )
        lines.append("".join(letters) + "\x1b[0m")
    return "\n".join(lines)
