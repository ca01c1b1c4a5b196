"""Transports: standard streams, or HTTP on this machine alone with a token."""

from __future__ import annotations

import hmac
import os
import secrets
import signal
import socket
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cityx.errors import MissingExtra, UsageError
from cityx.options import PlannerChoice
from cityx.system.cache import kept_folder

if TYPE_CHECKING:
    from mcp.server import Server
    from mcp.server.auth.provider import AccessToken
    from starlette.applications import Starlette

HOST = "127.0.0.1"  # never another: who reaches the port reaches the city
PROFILES = ("core", "full")
TOKEN_BYTES = 32
GRACE_S = 5  # for answers that are under way when the server ends

Say = Callable[[str], None]


def serve(
    folder: Path,
    *,
    port: int | None,
    profile: str,
    say: Say,
    choice: PlannerChoice | None = None,
) -> None:
    """Serve a city until the client leaves or the process is stopped.

    Parameters
    ----------
    folder
        Of a built city, or where one is to be built.
    port
        Of HTTP on this machine, 0 for any that is free; standard streams when None.
    profile
        "core", or "full" for a tool of every action's own.
    say
        Called with what a user must know; never the standard output.
    choice
        Who reads and plans what clients ask for in words; rules when None.

    Raises
    ------
    MissingExtra
        If the SDK is not installed.
    InputError, UsageError
        If the folder, the port or the profile cannot be used.
    """
    if find_spec("mcp") is None:
        raise MissingExtra("cityx serve needs the extra mcp: pip install 'cityx[mcp]'.")
    if profile not in PROFILES:
        raise UsageError(f'There is no profile "{profile}"; one of {", ".join(PROFILES)}.')
    import anyio

    from cityx.protocol.registry import registry
    from cityx.server.app import CityServer
    from cityx.server.owner import Owner

    if choice is not None:
        checked(choice)
    with Owner(folder, registry(), choice) as owner:
        server = CityServer(owner, full=profile == "full").sdk_server()
        if port is None:
            anyio.run(_over_streams, server)
        else:
            _over_http(server, port, say)


def checked(choice: PlannerChoice) -> None:
    """Refuse a planner that cannot be had before any client comes."""
    from cityx.agents.models import Recording, check_choice

    record, replay = (Path(path) if path else None for path in (choice.record, choice.replay))
    check_choice(choice.planner, choice.base_url, Recording(record, replay))


async def _over_streams(server: Server[Any]) -> None:
    from mcp.server.stdio import stdio_server

    async with stdio_server() as (read, write):
        await server.run(read, write, server.create_initialization_options())


def _over_http(server: Server[Any], port: int, say: Say) -> None:
    import uvicorn

    # Uvicorn ends in order and then lets the signal through: without this it would kill.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    with listening(port) as listener:
        port = listener.getsockname()[1]
        with token_file(port) as (path, token):
            app = http_app(server, port, token)
            say(f"CityX serves on http://{HOST}:{port}/mcp; the token is in {path}")
            config = uvicorn.Config(
                app, log_level="warning", access_log=False, timeout_graceful_shutdown=GRACE_S
            )
            uvicorn.Server(config).run(sockets=[listener])


def http_app(server: Server[Any], port: int, token: str) -> Starlette:
    """Return the web application; every request needs the token and a Host of this machine."""
    from mcp.server.auth.settings import AuthSettings
    from pydantic import AnyHttpUrl

    auth = AuthSettings(issuer_url=AnyHttpUrl(f"http://{HOST}:{port}"), resource_server_url=None)
    return server.streamable_http_app(host=HOST, auth=auth, token_verifier=Token(token))


class Token:
    """The one token that lets a client in.

    Parameters
    ----------
    token
        The token.
    """

    def __init__(self, token: str) -> None:
        self._token = token.encode()

    async def verify_token(self, token: str) -> AccessToken | None:
        """Return what a token allows, None for a wrong one."""
        from mcp.server.auth.provider import AccessToken

        if not hmac.compare_digest(token.encode("utf-8", "replace"), self._token):
            return None
        return AccessToken(token=token, client_id="owner of the token", scopes=[])


@contextmanager
def listening(port: int) -> Iterator[socket.socket]:
    """Open the port on this machine alone."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((HOST, port))
            listener.listen()  # who reads the address may call at once, and waits
        except (OSError, OverflowError) as error:
            raise UsageError(f"Port {port} cannot be used: {error}.") from error
        yield listener


@contextmanager
def token_file(port: int) -> Iterator[tuple[Path, str]]:
    """Write a new token to a file that this user alone can read; it goes when the server ends."""
    folder = kept_folder("serve")
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    path, token = folder / f"token-{port}", secrets.token_urlsafe(TOKEN_BYTES)
    path.unlink(missing_ok=True)
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(token)
    try:
        yield path, token
    finally:
        path.unlink(missing_ok=True)
