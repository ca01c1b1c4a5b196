"""`cityx view`: serve the page of a city on this machine, or export it as a static site."""

from __future__ import annotations

import signal
import sys
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from pathlib import Path
from socket import socket
from types import FrameType
from typing import TYPE_CHECKING

from cityx.errors import InputError, MissingExtra, UsageError
from cityx.options import PlannerChoice
from cityx.projects.instructions import is_built

if TYPE_CHECKING:
    from cityx.viewer.simulation import Simulation

Say = Callable[[str], None]
ADDRESS = "The city is at "  # what the line that tells the address begins with


def check_ready(folder: Path) -> None:
    """Refuse a folder without a city, and a machine without what serves a page.

    Raises
    ------
    InputError
        If the folder holds no city.
    MissingExtra
        If the libraries of the extra are not installed.
    """
    if not is_built(folder):
        raise InputError(f"{folder} holds no city; build one with: cityx build ... -o {folder}")
    check_extra()


def check_extra() -> None:
    """Refuse a machine without what serves a page.

    Raises
    ------
    MissingExtra
        If the libraries of the extra are not installed.
    """
    if find_spec("starlette") is None or find_spec("uvicorn") is None:
        raise MissingExtra("cityx view needs the extra view: pip install 'cityx[view]'.")


def view(
    folder: Path, *, port: int, browser: bool, say: Say, choice: PlannerChoice | None = None,
    simulation: Simulation | None = None,
) -> None:  # fmt: skip
    """Serve the page of a city until the process is stopped.

    Parameters
    ----------
    folder
        Of a built city.
    port
        Of HTTP on this machine, 0 for any that is free.
    browser
        Whether to open the page in the browser of the user.
    say
        Called with what a user must know.
    choice
        Who reads sentences; rules when None.
    simulation
        That pages look on, instead of changing the city.
    """
    check_ready(folder)
    import uvicorn

    from cityx.protocol.registry import registry
    from cityx.server.owner import Owner
    from cityx.server.serve import GRACE_S, HOST, checked, token_file
    from cityx.viewer.resuming import keep_secret, kept_secret
    from cityx.viewer.serving import CityPage

    if choice is not None:
        checked(choice)
    # Uvicorn ends in order and then lets the signal through: without this it would kill.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    secret, last = kept_secret(folder)
    with Owner(folder, registry(), choice) as owner, _listening(port, last) as listener:
        number = listener.getsockname()[1]
        with token_file(number) as (_, token):
            keep_secret(folder, secret, number)
            page = CityPage(owner, number, token, simulation, secret)
            address = f"http://{HOST}:{number}/#token={token}"
            say(f"{ADDRESS}{address}")
            if browser:
                webbrowser.open(address)
            config = uvicorn.Config(
                page.app(), log_level="warning", access_log=False, timeout_graceful_shutdown=GRACE_S
            )
            server = uvicorn.Server(config)
            leave = server.handle_exit

            def end(sig: int, frame: FrameType | None) -> None:
                page.end()
                leave(sig, frame)

            server.handle_exit = end  # type: ignore[method-assign]
            server.run(sockets=[listener])


@contextmanager
def _listening(port: int, last: int) -> Iterator[socket]:
    """Open a port: that asked for, or that of the last server of the folder, or any that is free.

    Pages that are open look for the city where it was.
    """
    from cityx.server.serve import listening

    with ExitStack() as stack:
        try:
            held = stack.enter_context(listening(port or last))
        except UsageError:
            if port or not last:
                raise
            held = stack.enter_context(listening(0))
        yield held
