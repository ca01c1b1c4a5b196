"""Addresses at which environments are served."""

from __future__ import annotations

import socket
from ipaddress import ip_address
from urllib.parse import urlsplit

from cityx.errors import UsageError


def checked_address(address: str, *, anywhere: bool = False) -> str:
    """Return the address of a socket: of this machine alone, unless any is asked for.

    Parameters
    ----------
    address
        ``tcp://HOST:PORT``, with * or 0 for any free port, or ``ipc://FILE``.
    anywhere
        Whether other machines may reach it.

    Raises
    ------
    UsageError
        If it is no such address, or one that other machines reach.
    """
    if address.startswith("ipc://") and len(address) > len("ipc://"):
        return address
    parts = urlsplit(address.replace(":*", ":0"))
    try:
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if parts.scheme != "tcp" or host is None or port is None or parts.path:
        raise UsageError(
            f'"{address}" is no address; it takes tcp://127.0.0.1:PORT, or ipc://FILE.'
        )
    if not (anywhere or _is_own(host)):
        raise UsageError(
            f"{address} can be reached by other machines, and whoever reaches it may run the "
            "simulator: take 127.0.0.1, or say --any-interface if that is what you want."
        )
    return address.replace(":0", ":*") if port == 0 else address


def _is_own(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return False  # a name, or * for all interfaces


def is_open(address: str, seconds: float) -> bool:
    """Return whether somebody listens at an address of TCP; of others it is not known, and true."""
    parts = urlsplit(address)
    if parts.scheme != "tcp" or parts.hostname is None or parts.port is None:
        return True
    try:
        socket.create_connection((parts.hostname, parts.port), seconds).close()
    except OSError:
        return False
    return True
