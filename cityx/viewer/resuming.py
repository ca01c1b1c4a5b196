"""Resuming: a page that was open goes on when its city is served anew, under another token.

A secret of the folder is kept in the cache of the user, for this user alone, and told to pages that
have the token; a page holds it in memory only. When the server was gone, the page asks whoever
answers at the address to prove that it knows the secret, then proves the same and gets the token
of the new server. Neither side sends the secret: another program at that address learns nothing.
"""

from __future__ import annotations

import hmac
import json
import os
import secrets
from collections import OrderedDict
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

from cityx.system.cache import kept_folder

BYTES = 32  # of a secret
MOST = 64  # challenges that wait for an answer
NONCE = range(16, 129)  # letters of what a page asks to be answered
SERVER, PAGE = "server", "page"  # who proves


class Resuming:
    """Answers pages that were open; its secret is that of the folder.

    Attributes
    ----------
    secret
        Hexadecimal digits, for pages that have the token.
    """

    def __init__(self, secret: str) -> None:
        self.secret = secret
        self._open: OrderedDict[str, None] = OrderedDict()

    def proof(self, who: str, nonce: str) -> str:
        """Return the proof that one knows the secret, as hexadecimal digits."""
        return hmac.new(self.secret.encode(), f"{who} {nonce}".encode(), sha256).hexdigest()

    def answer(self, nonce: str) -> dict[str, str]:
        """Prove that this server knows the secret, and ask the page to do the same."""
        challenge = secrets.token_hex(BYTES)
        self._open[challenge] = None
        while len(self._open) > MOST:
            self._open.popitem(last=False)
        return {"proof": self.proof(SERVER, nonce), "challenge": challenge}

    def accepts(self, challenge: str, proof: str) -> bool:
        """Return whether a page knows the secret; a challenge is good for one answer."""
        if challenge not in self._open:
            return False
        del self._open[challenge]
        return hmac.compare_digest(self.proof(PAGE, challenge).encode(), proof.encode())


def kept_secret(folder: Path) -> tuple[str, int]:
    """Return the secret of a folder, a new one the first time, and its last port, 0 for none."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        path = _path(folder)
        held = path.stat()
        if held.st_mode & 0o077 == 0 and held.st_uid == os.getuid():
            told = json.loads(path.read_text())
            return str(told["secret"]), int(told["port"])
    return secrets.token_hex(BYTES), 0


def keep_secret(folder: Path, secret: str, port: int) -> None:
    """Keep the secret and the port of a folder for this user alone, if there is a cache."""
    with suppress(OSError):
        path = _path(folder)
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        path.unlink(missing_ok=True)
        with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
            json.dump({"secret": secret, "port": port}, file)


def _path(folder: Path) -> Path:
    return kept_folder("view") / sha256(str(folder.resolve()).encode()).hexdigest()[:32]
