"""The page of a folder of tiles: its files for all on this machine, tiles for who has the token.

Files are looked up by the names that tiles have; nothing takes another path from the page.
"""

from __future__ import annotations

import hmac
import json
import re
import secrets
import webbrowser
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Route

from cityx.city import City
from cityx.city.content import HASHES, ContentHash, content_hash, read_hash
from cityx.city.store import read_city
from cityx.errors import CityxError, InputError, UsageError
from cityx.server.serve import GRACE_S, HOST, listening
from cityx.tiles.grid import Tile, tile_named
from cityx.tiles.names import called
from cityx.tiles.order import Order, read_order
from cityx.tiles.plane import box_in_frame
from cityx.tiles.run import INDEX, TILES, records
from cityx.tiles.tile import CITY, CONTENT
from cityx.tiles.tileset import NAME as TILESET
from cityx.viewer.details import details
from cityx.viewer.page import MEDIA, TILE_FILES, page_folder
from cityx.viewer.serving import POLICY

START = "start.json"
ADDRESS = "The tiles are at "  # what the line that tells the address begins with
LONGEST = 200  # letters of what is looked for
KEPT = 4  # stores of tiles that stay in memory while somebody asks about their objects
_FILE = re.compile(r"[\w-]{1,40}\.glb")


def view_tiles(folder: Path, *, port: int, browser: bool, say: Callable[[str], None]) -> None:
    """Serve the page of a folder of tiles until the process is stopped.

    Parameters
    ----------
    folder
        Of built tiles.
    port
        Of HTTP on this machine, 0 for any that is free.
    browser
        Whether to open the page in the browser of the user.
    say
        Called with what a user must know.

    Raises
    ------
    InputError
        If the folder holds no built tile.
    """
    import uvicorn

    with listening(port) as listener:
        number = listener.getsockname()[1]
        token = secrets.token_urlsafe(32)
        page = TilesPage(folder, number, token)
        address = f"http://{HOST}:{number}/#token={token}"
        say(f"{ADDRESS}{address}")
        if browser:
            webbrowser.open(address)
        config = uvicorn.Config(
            page.app(), log_level="warning", access_log=False, timeout_graceful_shutdown=GRACE_S
        )
        uvicorn.Server(config).run(sockets=[listener])


class TilesPage:
    """Serves a folder of tiles to pages.

    Parameters
    ----------
    folder
        Of built tiles.
    port
        That is listened to, by which requests for other hosts are told.
    token
        That requests for tiles must carry.

    Raises
    ------
    InputError
        If the folder holds no built tile.
    """

    def __init__(self, folder: Path, port: int, token: str) -> None:
        self.folder = folder
        self.start = start_of(folder)
        self.hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        self._token = token.encode()
        self._page = page_folder()
        self._order = read_order(folder)[0]
        self._city = lru_cache(maxsize=KEPT)(_read)
        self._records = lru_cache(maxsize=1)(self._read_records)

    def app(self) -> Starlette:
        """Return the web application."""
        inside = self._with_token
        routes = [
            Route("/", self._file),
            *(Route(f"/{name}", self._file) for name in TILE_FILES),
            Route(f"/{START}", inside(self._start)),
            Route(f"/run/{TILESET}", inside(self._tileset)),
            Route(f"/run/{TILES}/{{tile:str}}/{TILESET}", inside(self._tileset)),
            Route(f"/run/{TILES}/{{tile:str}}/{CONTENT}/{{file:str}}", inside(self._content)),
            Route("/search", inside(self._search)),
            Route("/objects/{tile:str}/{id:str}", inside(self._details)),
        ]
        app = Starlette(routes=routes)
        app.add_middleware(GZipMiddleware, minimum_size=2000, compresslevel=4)
        return app

    def _with_token(self, answer: Callable[[Request], Any]) -> Callable[[Request], Any]:
        """Let only requests of this machine with the token in; errors become answers."""

        async def guarded(request: Request) -> Response:
            if (refused := self._foreign(request)) is not None:
                return refused
            kind, _, given = request.headers.get("authorization", "").partition(" ")
            token = given.encode("utf-8", "replace")
            if kind != "Bearer" or not hmac.compare_digest(token, self._token):
                return _said(401, "The token is missing or wrong: open the address that cityx view "
                             "printed last.")  # fmt: skip
            try:
                found: Response = await answer(request)
            except CityxError as error:
                return _said(404, str(error))
            return found

        return guarded

    def _foreign(self, request: Request) -> Response | None:
        """Refuse requests that a page of another site had made."""
        if request.headers.get("host") not in self.hosts:
            return _said(421, "Only this machine is served.")
        origin = request.headers.get("origin")
        if origin is not None and origin.partition("://")[2] not in self.hosts:
            return _said(403, "Pages of other sites are not served.")
        return None

    async def _file(self, request: Request) -> Response:
        if (refused := self._foreign(request)) is not None:
            return refused
        path = self._page / (request.url.path.strip("/") or TILE_FILES[0])
        head = {"Content-Security-Policy": POLICY, "X-Content-Type-Options": "nosniff",
                "Cache-Control": "no-cache", "Referrer-Policy": "no-referrer"}  # fmt: skip
        return FileResponse(path, media_type=MEDIA[path.suffix], headers=head)

    async def _start(self, request: Request) -> Response:
        del request
        return JSONResponse(self.start, headers={"Cache-Control": "no-store"})

    async def _tileset(self, request: Request) -> Response:
        place = self.folder
        if "tile" in request.path_params:
            place = self._tile(request)
        return _sent(place / TILESET)

    async def _content(self, request: Request) -> Response:
        name = request.path_params["file"]
        if _FILE.fullmatch(name) is None:
            raise UsageError(f'"{name}" is no file of a tile.')
        return _sent(self._tile(request) / CONTENT / name)

    def _tile(self, request: Request) -> Path:
        return self.folder / TILES / tile_named(request.path_params["tile"]).name

    async def _search(self, request: Request) -> Response:
        text = request.query_params.get("text", "")[:LONGEST]

        def look() -> dict[str, Any]:
            index = (self.folder / INDEX).stat()
            found = called(self._records(index.st_ino, index.st_mtime_ns), text)
            return {
                "found": [
                    {"id": own[0], "name": own[1], "kind": own[2], "tile": tile.name,
                     "place": place_in_tileset(self.folder, self._order, tile, [own[3:]])[0]}
                    for tile, own in found
                ]
            }  # fmt: skip

        return JSONResponse(await run_in_threadpool(look), headers={"Cache-Control": "no-store"})

    def _read_records(self, *index: int) -> dict[Tile, Mapping[str, Any]]:
        """Read the records of all tiles; the file of the index tells whether they are others."""
        del index
        return records(self.folder)

    async def _details(self, request: Request) -> Response:
        store = self._tile(request) / CITY
        name = request.path_params["id"]

        def look() -> dict[str, Any]:
            if not store.is_dir():
                raise InputError(f"{store.parent.name} has no store that tells more of {name}.")
            city, content = self._city(store, store.stat().st_ino)
            return details(city, content, name, {})

        return JSONResponse(await run_in_threadpool(look))


def start_of(folder: Path) -> dict[str, Any]:
    """Return where a page of tiles begins: in the middle one of those that show anything.

    Raises
    ------
    InputError
        If there is none.
    """
    order, _ = read_order(folder)
    known = records(folder)
    shown = [tile for tile, record in known.items() if record["box"]]
    if not shown:
        raise InputError(f"{folder} holds no built tile; cityx tiles build makes them.")
    columns, rows = ([getattr(tile, key) for tile in shown] for key in ("column", "row"))
    middle = (min(columns) + max(columns)) / 2, (min(rows) + max(rows)) / 2
    tile = min(shown, key=lambda one: (abs(one.column - middle[0]) + abs(one.row - middle[1]), one))
    extent = [(max(some) - min(some) + 1) * order.size for some in (columns, rows)]
    credits_ = sorted({text for record in known.values() for text in record["attribution"]})
    return {
        "name": order.name, "credits": credits_, "tile": tile.name,
        "transform": _transform_of(folder, tile),
        "extent": [min(side, 3 * order.size) for side in extent],
    }  # fmt: skip


def place_in_tileset(
    folder: Path, order: Order, tile: Tile, places: Sequence[Sequence[float]]
) -> list[list[float]]:
    """Return where places of the frame of a tile are in the tileset of the run, metres."""
    west, south, east, north = box_in_frame(order, tile)
    matrix = np.reshape(_transform_of(folder, tile), (4, 4)).T
    middle = np.array([(west + east) / 2, (south + north) / 2, 0.0])
    there = (np.array(places).reshape(-1, 3) - middle) @ matrix[:3, :3].T + matrix[:3, 3]
    found: list[list[float]] = np.round(there, 2).tolist()
    return found


def _transform_of(folder: Path, tile: Tile) -> list[float]:
    """Return where the tileset of the run has a tile, as a matrix by columns."""
    root = json.loads((folder / TILES / tile.name / TILESET).read_text())["root"]
    return root.get("transform") or _on_the_plane(folder, tile)


def _on_the_plane(folder: Path, tile: Tile) -> list[float]:
    """Return where the tileset of the whole plane has a tile, as a matrix by columns."""
    root = json.loads((folder / TILESET).read_text())["root"]
    uri = f"{TILES}/{tile.name}/{TILESET}"
    own = next(one["transform"] for one in root["children"] if one["content"]["uri"] == uri)
    whole, place = (np.reshape(matrix, (4, 4)).T for matrix in (root["transform"], own))
    return [float(value) for value in (whole @ place).T.ravel()]


def _read(store: Path, number: int) -> tuple[City, ContentHash]:
    """Read the store of a tile; the number of its folder tells whether it was built anew."""
    del number
    city = read_city(store)
    return city, read_hash(store / HASHES) or content_hash(city)


def _sent(path: Path) -> Response:
    if not path.is_file():
        raise InputError(f"{path.name} is not built.")
    return FileResponse(path, media_type=MEDIA[path.suffix], headers={"Cache-Control": "no-cache"})


def _said(status: int, message: str) -> Response:
    return JSONResponse({"message": message}, status)
