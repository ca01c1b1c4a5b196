"""Somebody drives by the keys of a terminal, which is as it was afterwards."""

import os
import sys
import time

import numpy as np
import pytest
from typer.testing import CliRunner

from cityx.cli.main import app
from cityx.errors import UsageError
from cityx.sim.keyboard import ARROWS, COLUMNS, HELD, ROWS, Hand, Keyboard, blocks

pty = pytest.importorskip("pty", reason="terminals of this system are no files")


@pytest.fixture
def terminal(monkeypatch):
    """A terminal of which this process has the one end and the program the other."""
    ours, theirs = pty.openpty()
    with os.fdopen(theirs, "r+b", buffering=0) as file:

        class End:
            isatty = staticmethod(lambda: True)
            fileno = staticmethod(file.fileno)

        monkeypatch.setattr(sys, "stdin", End)
        monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
        yield ours
    os.close(ours)


def test_keys_are_actions_for_a_while(terminal):
    keys = Keyboard()
    with keys.listening():
        os.write(terminal, b"wa")
        begin = time.monotonic()
        keys.wait(begin + 0.05)
        assert keys.action(begin + 0.05).tolist() == [1.0, 1.0]
        assert keys.action(begin + 0.05 + HELD).tolist() == [0.0, 0.0]
        keys.take(b"\x1b[C", begin + 1.0)  # an arrow
        assert keys.action(begin + 1.0).tolist() == [-1.0, 0.0]
        keys.take(b"ws", begin + 2.0)  # both at once
        assert keys.action(begin + 2.0).tolist() == [0.0, 0.0]
        assert not keys.ended
        keys.take(b"Q", begin + 2.0)
        assert keys.ended


@pytest.mark.usefixtures("terminal")
def test_the_terminal_is_set_back():
    import termios

    before = termios.tcgetattr(sys.stdin.fileno())
    with Keyboard().listening() as keys:
        assert termios.tcgetattr(sys.stdin.fileno()) != before
        with pytest.raises(KeyboardInterrupt):
            keys.take(b"\x03", 0.0)
    assert termios.tcgetattr(sys.stdin.fileno()) == before


@pytest.mark.usefixtures("terminal")
def test_a_car_goes_where_the_keys_say(engine):
    one = engine(1, traffic=0)
    told = []
    keys = Keyboard()
    with keys.listening():
        hand = Hand(keys, told.append)
        for _ in range(8):
            keys.take(b"w", time.monotonic())
            one.step(hand(one))
        assert one.state.row("speed")[0, 0] > 1.0
        keys.take(b"q", time.monotonic())
        with pytest.raises(KeyboardInterrupt):
            hand(one)
    assert "m/s" in told[0]
    assert len(ARROWS) == 4


def test_a_picture_is_letters_in_colours():
    image = np.zeros((2 * ROWS, COLUMNS, 3), np.uint8)
    image[0, 0] = 255, 0, 0
    lines = blocks(image).split("\n")
    assert len(lines) == ROWS
    assert lines[0].startswith("\x1b[38;2;255;0;0m\x1b[48;2;0;0;0m")
    assert all(line.count("\u2580") == COLUMNS for line in lines)


def test_without_a_terminal_a_sentence_says_so(town):
    done = CliRunner().invoke(app, ["sim", str(town), "--keyboard"])
    assert isinstance(done.exception, UsageError)
    assert "needs a terminal" in str(done.exception)
    with pytest.raises(UsageError, match="needs a terminal"):
        Keyboard()
