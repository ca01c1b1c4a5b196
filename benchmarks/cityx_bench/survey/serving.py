"""Serve a study on this machine and keep the answers that its page sends."""

from __future__ import annotations

import json
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from cityx.errors import InputError
from cityx_bench.survey.answers import keep
from cityx_bench.survey.study import PAGE, PICTURES, Study, read_study

MOST = 1_000_000  # bytes of an answer


def server_of(folder: Path, port: int = 0, host: str = "127.0.0.1") -> ThreadingHTTPServer:
    """Return a server of the study in a folder; it begins with ``serve_forever``.

    It gives out the page and the pictures of the study alone, never the key or the answers.

    Raises
    ------
    InputError
        When the folder holds no study, or the port is taken.
    """
    study, _ = read_study(folder)
    try:
        return ThreadingHTTPServer((host, port), _handler(folder, study))
    except OSError as error:
        raise InputError(
            f"cannot serve on {host}:{port}: {error.strerror}. Choose another --port."
        ) from error


def _handler(folder: Path, study: Study) -> type[BaseHTTPRequestHandler]:
    files = {f"/{PICTURES}/{name}.png": (folder / PICTURES / f"{name}.png", "image/png")
             for name in study.items}  # fmt: skip
    files |= dict.fromkeys(("/", f"/{PAGE}"), (folder / PAGE, "text/html; charset=utf-8"))

    class Handler(BaseHTTPRequestHandler):
        """Answers to the page of one study."""

        def do_GET(self) -> None:
            if self.path not in files:
                self._reply(HTTPStatus.NOT_FOUND, b"not here", "text/plain")
                return
            path, kind = files[self.path]
            self._reply(HTTPStatus.OK, path.read_bytes(), kind)

        def do_POST(self) -> None:
            length = int(self.headers.get("Content-Length") or 0)
            if self.path != "/answers" or not 0 < length <= MOST:
                self._reply(HTTPStatus.BAD_REQUEST, b"no answer", "text/plain")
                return
            try:
                keep(json.loads(self.rfile.read(length)), study, folder)
            except (InputError, ValueError) as error:
                self._reply(HTTPStatus.BAD_REQUEST, str(error).encode(), "text/plain")
                return
            self._reply(HTTPStatus.OK, b'{"kept": true}', "application/json")

        def _reply(self, status: HTTPStatus, body: bytes, kind: str) -> None:
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:  # noqa: A002
            """Say nothing: answers are anonymous, so no address is written down."""

    return Handler
