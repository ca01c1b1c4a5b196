"""The server of the page: files for everyone on this machine, the city for who has the token.

Changes go through the tools of `cityx serve`: the same owner, gate and journal. Nothing takes a
path or code from the page; files are looked up by their names in the scenery.
"""

from __future__ import annotations

import asyncio
import hmac
import json
import logging
import secrets
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from typing import TYPE_CHECKING, Any

import anyio.to_thread
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from cityx.errors import CityxError, UsageError
from cityx.projects.desk import STORE
from cityx.server.jobs import Job
from cityx.server.owner import Owner
from cityx.server.replies import Reply, reply_of_error, reply_of_fault
from cityx.server.tool import refusals
from cityx.server.toolbox import Toolbox
from cityx.viewer.details import details, find, places_of
from cityx.viewer.geojson import layout_geojson
from cityx.viewer.page import FILES, MEDIA, page_folder
from cityx.viewer.provenance import provenance
from cityx.viewer.resuming import BYTES, NONCE, Resuming
from cityx.viewer.scenery import Scenery, read_scenery

if TYPE_CHECKING:
    from cityx.viewer.simulation import Simulation

log = logging.getLogger(__name__)
TOOLS = (
    "run_brief",
    "undo",
    "plan",
    "action_call",
    "revisions",
    "scene_query",
    "scene_diff",
    "check",
    "job_status",
    "job_wait",
    "job_cancel",
    "health",
)  # fmt: skip  what the page may ask for
READING = ("scene_query", "job_status", "health")  # the same while a simulation runs
WRONG = "The token is missing or wrong: open the address that cityx view printed last."
LARGEST_BODY = 200_000  # bytes of a request
LOOK_S = 0.2  # between two looks whether the folder holds another city
ALIVE_S = 10.0  # between two signs of life to a page
SHOWING_S = 2.0  # that the judging of a change waits for pages to fetch it
PATIENCE_S = 2.0  # that a call waits for its job; the page asks again
FOREVER = "public, max-age=31536000, immutable"
POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' blob: data:; connect-src 'self' blob: data:; worker-src 'self' blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self' http://127.0.0.1:* http://localhost:*"
)


class CityPage:
    """Serves one city to pages.

    Parameters
    ----------
    owner
        Who holds the city and changes it.
    port
        That is listened to, by which requests for other hosts are told.
    token
        That requests for the city must carry.
    simulation
        That runs in the city; nothing can be changed then.
    secret
        By which pages of an earlier server of the folder are known; a new one when "".
    """

    def __init__(
        self, owner: Owner, port: int, token: str, simulation: Simulation | None = None,
        secret: str = "",
    ) -> None:  # fmt: skip
        self.owner, self.simulation = owner, simulation
        self._resuming = Resuming(secret or secrets.token_hex(BYTES))
        known = READING if simulation is not None else TOOLS
        self.tools = {name: tool for name, tool in Toolbox(owner).tools.items() if name in known}
        self.hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        self._token = token.encode()
        self._page = page_folder()
        self._scenery: Scenery | None = None
        self._places: tuple[int, dict[int, tuple[float, float]]] = (-1, {})
        self._seen: tuple[int, ...] | None = None
        self._lock = threading.Lock()
        self._waiting: set[asyncio.Event] = set()
        self._looking: set[asyncio.Event] = set()  # at the simulation
        self._wanted: set[str] = set()  # files of a change that no page asked for yet
        self._fetched = threading.Event()
        self._ending = False
        self._wake: Callable[[], None] = lambda: None

    def app(self) -> Starlette:
        """Return the web application."""
        inside = self._with_token
        routes = [
            Route("/", self._file),
            *(Route(f"/{name}", self._file) for name in FILES),
            Route("/scene.json", inside(self._scene)),
            Route("/report.json", inside(self._report)),
            Route("/provenance.json", inside(self._provenance)),
            Route("/layout.geojson", inside(self._layout)),
            Route("/{kind:str}/{name:str}.glb", inside(self._piece)),
            Route("/tracks/{name:str}.bin", inside(self._piece)),
            Route("/lamps/{name:str}.json", inside(self._piece)),
            Route("/objects/{id:str}", inside(self._details)),
            Route("/places", inside(self._place)),
            Route("/find", inside(self._find)),
            Route("/events", inside(self._events)),
            Route("/tools/{name:str}", inside(self._call), methods=["POST"]),
            Route("/prove", self._prove),
            Route("/resume", self._resume, methods=["POST"]),
            Route("/simulation", inside(self._simulated)),
            Route("/simulation", inside(self._steer), methods=["POST"]),
        ]
        # Nothing is compressed on its way: it stays on this machine, where that only costs time.
        return Starlette(routes=routes, lifespan=self._serving)

    @asynccontextmanager
    async def _serving(self, app: Starlette) -> AsyncIterator[None]:
        del app
        watch = asyncio.create_task(self._watch())
        self._wake = loop_call(self._tell)
        self.owner.listeners.append(self._wake)
        self.owner.early_listeners.append(self._show_first)
        if self.simulation is not None:
            self.simulation.listeners.append(loop_call(lambda: _set(self._looking)))
        try:
            yield
        finally:
            watch.cancel()
            self.owner.early_listeners.clear()
            if self.simulation is not None:
                self.simulation.listeners.clear()
            self._fetched.set()
            self._tell()

    def end(self) -> None:
        """Let pages go that listen for news: the server ends; from any thread."""
        self._ending = True
        self._wake()

    def _with_token(self, answer: Callable[[Request], Any]) -> Callable[[Request], Any]:
        """Let only requests of this machine with the token in; errors become answers."""

        async def guarded(request: Request) -> Response:
            if (refused := self._foreign(request)) is not None:
                return refused
            kind, _, given = request.headers.get("authorization", "").partition(" ")
            token = given.encode("utf-8", "replace")
            if kind != "Bearer" or not hmac.compare_digest(token, self._token):
                return _said(401, "TOKEN", WRONG)
            try:
                found: Response = await answer(request)
            except CityxError as error:
                reply = reply_of_error(error, self.owner.seen.revision)
                return JSONResponse(reply.to_json(), 404 if request.method == "GET" else 200)
            except Exception as error:
                log.exception("%s failed", request.url.path)
                reply = reply_of_fault(error, self.owner.seen.revision)
                return JSONResponse(reply.to_json(), 500)
            return found

        return guarded

    def _foreign(self, request: Request) -> Response | None:
        """Refuse requests that a page of another site had made."""
        if request.headers.get("host") not in self.hosts:
            return _said(421, "HOST", "Only this machine is served.")
        origin = request.headers.get("origin")
        if origin is not None and origin.partition("://")[2] not in self.hosts:
            return _said(403, "ORIGIN", "Pages of other sites are not served.")
        return None

    async def _file(self, request: Request) -> Response:
        if (refused := self._foreign(request)) is not None:
            return refused
        name = request.url.path.strip("/") or FILES[0]
        path = self._page / name
        kind = MEDIA[path.suffix]
        head = {"Content-Security-Policy": POLICY, "X-Content-Type-Options": "nosniff",
                "Cache-Control": "no-cache", "Referrer-Policy": "no-referrer"}  # fmt: skip
        return FileResponse(path, media_type=kind, headers=head)

    async def _prove(self, request: Request) -> Response:
        """Prove to a page that was open that this serves the same folder for the same user."""
        if (refused := self._foreign(request)) is not None:
            return refused
        nonce = request.query_params.get("nonce", "")
        if len(nonce) not in NONCE:
            return _said(400, "BAD_ARGS", "nonce takes 16 to 128 letters.")
        return JSONResponse(self._resuming.answer(nonce), headers={"Cache-Control": "no-store"})

    async def _resume(self, request: Request) -> Response:
        """Give the token to a page that proves the same."""
        if (refused := self._foreign(request)) is not None:
            return refused
        try:
            given = await _arguments(request)
        except UsageError as error:
            return _said(400, "BAD_ARGS", str(error))
        if not self._resuming.accepts(str(given.get("challenge")), str(given.get("proof"))):
            return _said(401, "TOKEN", WRONG)
        return JSONResponse({"token": self._token.decode()}, headers={"Cache-Control": "no-store"})

    async def _scene(self, request: Request) -> Response:
        del request
        scenery = await run_in_threadpool(self.scenery)
        told = {"live": True, "revision": self.owner.seen.revision,
                "simulated": self.simulation is not None,
                "secret": self._resuming.secret}  # fmt: skip
        return JSONResponse(scenery.to_json() | told, headers={"Cache-Control": "no-store"})

    async def _piece(self, request: Request) -> Response:
        scenery = await run_in_threadpool(self.scenery)
        name = request.url.path.removeprefix("/")
        data = await run_in_threadpool(scenery.file, name)
        self._wanted.discard(name)
        if not self._wanted:
            self._fetched.set()
        kind = MEDIA[name[name.rindex(".") :]]
        return Response(data, media_type=kind, headers={"Cache-Control": FOREVER})

    async def _report(self, request: Request) -> Response:
        del request
        return JSONResponse(await run_in_threadpool(self._read_report))

    async def _provenance(self, request: Request) -> Response:
        del request

        def look() -> dict[str, Any]:
            seen = self.owner.seen
            known = min((each.number for each in seen.revisions), default=seen.revision)
            first = self.owner.contents.of(seen, known) if known != seen.revision else None
            return provenance(seen.built, self.scenery().content, first)

        return JSONResponse(await run_in_threadpool(look))

    async def _layout(self, request: Request) -> Response:
        del request
        told = await run_in_threadpool(lambda: layout_geojson(self.owner.seen.built))
        return JSONResponse(told, media_type="application/geo+json")

    def _read_report(self) -> dict[str, Any]:
        path = self.owner.folder / "report.json"
        found: dict[str, Any] = json.loads(path.read_text()) if path.is_file() else {}
        return found

    async def _details(self, request: Request) -> Response:
        def look() -> dict[str, Any]:
            seen = self.owner.seen
            content = self.scenery().content
            found = details(seen.built, content, request.path_params["id"], self._read_report())
            return found | {
                "revision": seen.revision,
                "place": self.places().get(int(found["id"], 16)),
            }

        return JSONResponse(await run_in_threadpool(look))

    async def _place(self, request: Request) -> Response:
        """Tell where objects are, for links that fly to them."""
        names = request.query_params.get("ids", "").split(",")[:500]
        places = await run_in_threadpool(self.places)
        found = {name: places.get(_number(name)) for name in names}
        return JSONResponse({name: place for name, place in found.items() if place})

    async def _find(self, request: Request) -> Response:
        text = request.query_params.get("text", "")[:200]

        def look() -> dict[str, Any]:
            answer = find(self.owner.seen.built, text)
            places = self.places()
            for item in answer["objects"]:
                item["place"] = places.get(int(item["id"], 16))
            return answer

        return JSONResponse(await run_in_threadpool(look))

    async def _call(self, request: Request) -> Response:
        name = request.path_params["name"]
        if name not in self.tools:
            raise UsageError(f"The page has no tool of this name; it has {', '.join(self.tools)}.")
        arguments = await _arguments(request)
        tool = self.tools[name]
        if refused := refusals(tool, arguments):
            reply = Reply("rejected", "BAD_ARGS", " ".join(refused), self.owner.seen.revision)
            return JSONResponse(reply.to_json())
        found = await anyio.to_thread.run_sync(lambda: tool.run(arguments))
        return JSONResponse((await self._settled(found)).to_json())

    async def _settled(self, found: Reply | Job) -> Reply:
        if isinstance(found, Reply):
            return found
        if not found.reply.done():
            await asyncio.wait([asyncio.wrap_future(found.reply)], timeout=PATIENCE_S)
        if found.reply.done():
            return found.reply.result()
        last = found.said[-1] if found.said else "waits" if not found.running else "begins"
        return Reply("accepted", "OK", last, self.owner.seen.revision,
                     job_id=found.id, data=found.to_json())  # fmt: skip

    async def _events(self, request: Request) -> Response:
        del request

        def state() -> str:
            told = {"revision": self.owner.seen.revision, "folder": list(self._seen or ()),
                    "busy": self.owner.busy}  # fmt: skip
            return json.dumps(told)

        return _stream(self._news(self._waiting, state))

    async def _simulated(self, request: Request) -> Response:
        del request
        simulation = self._running()
        simulation.watch()
        return _stream(self._news(self._looking, lambda: simulation.news))

    async def _steer(self, request: Request) -> Response:
        simulation, given = self._running(), await _arguments(request)
        paused, speed = given.get("paused"), given.get("speed")
        if not (paused is None or isinstance(paused, bool)) or isinstance(speed, bool) or not (
            speed is None or isinstance(speed, int | float)
        ):  # fmt: skip
            raise UsageError("A simulation takes paused, true or false, and speed, a number.")
        simulation.steer(paused=paused, speed=speed)
        return JSONResponse(self.owner.ok({}, "Done.").to_json())

    def _running(self) -> Simulation:
        if self.simulation is None:
            raise UsageError("No simulation runs here; begin one with: cityx sim DIR --view.")
        return self.simulation

    async def _news(
        self, waiting: set[asyncio.Event], state: Callable[[], str]
    ) -> AsyncIterator[str]:
        """Yield what there is, and whatever comes, until the server ends."""
        woken = asyncio.Event()
        waiting.add(woken)
        try:
            told = ""
            while not self._ending:
                news = f"data: {state()}\n\n"
                yield ": alive\n\n" if news == told else news
                told = news
                with suppress(TimeoutError):
                    await asyncio.wait_for(woken.wait(), ALIVE_S)
                woken.clear()
        finally:
            waiting.discard(woken)

    def _show_first(self) -> None:
        """Let pages show a change before it is judged, in the thread that would judge it."""
        if not self._waiting:
            return
        known = set() if self._scenery is None else set(self._scenery.names())
        scenery = self.scenery()
        self._wanted = set(scenery.names()) - known
        self._fetched.clear()
        for name in sorted(self._wanted):
            scenery.file(name)
        self._seen = self._signature()
        self._wake()
        if self._wanted:
            self._fetched.wait(SHOWING_S)

    def _tell(self) -> None:
        _set(self._waiting)
        if self._ending:
            _set(self._looking)

    async def _watch(self) -> None:
        """Tell pages as soon as the folder holds another city, whoever put it there."""
        while True:
            now = self._signature()
            if now is not None and now != self._seen:
                self._seen = now
                self._tell()
            if self.owner.alive and self.owner.outdated() and not self.owner.busy:
                self.owner.submit("look", lambda job: Reply("ok", job_id=job.id))
            await asyncio.sleep(LOOK_S)

    def _signature(self) -> tuple[int, ...] | None:
        try:
            return ((self.owner.folder / STORE).stat().st_ino,)
        except OSError:
            return None

    def scenery(self) -> Scenery:
        """Return the scenery of the city that the folder holds now; from any thread."""
        with self._lock:
            now = self._signature()
            if self._scenery is None or now != self._held:
                self._scenery, self._held = (
                    read_scenery(self.owner.folder / STORE, self._scenery),
                    now,
                )
            return self._scenery

    def places(self) -> dict[int, tuple[float, float]]:
        """Return where objects are, by id; from any thread."""
        seen = self.owner.seen
        with self._lock:
            if self._places[0] != seen.revision:
                self._places = seen.revision, places_of(seen.built)
            return self._places[1]

    _held: tuple[int, ...] | None = None


def loop_call(work: Callable[[], None]) -> Callable[[], None]:
    """Return a function that has work done in the running loop, from any thread."""
    loop = asyncio.get_running_loop()

    def call() -> None:
        if not loop.is_closed():
            loop.call_soon_threadsafe(work)

    return call


async def _arguments(request: Request) -> dict[str, Any]:
    """Return the object that a request holds.

    Raises
    ------
    UsageError
        If it holds something else, or too much.
    """
    body = b""
    async for part in request.stream():
        body += part
        if len(body) > LARGEST_BODY:
            raise UsageError(f"A request holds at most {LARGEST_BODY} bytes.")
    try:
        arguments = json.loads(body or b"{}")
    except (ValueError, RecursionError) as error:
        raise UsageError("The request is not JSON.") from error
    if not isinstance(arguments, dict):
        raise UsageError("The arguments must be an object.")
    return arguments


def _stream(news: AsyncIterator[str]) -> Response:
    head = {"Cache-Control": "no-store"}
    return StreamingResponse(news, media_type="text/event-stream", headers=head)


def _set(waiting: set[asyncio.Event]) -> None:
    for woken in tuple(waiting):
        woken.set()


def _said(status: int, code: str, message: str) -> Response:
    return JSONResponse(Reply("rejected", code, message).to_json(), status)


def _number(name: str) -> int:
    try:
        return int(name, 16)
    except ValueError:
        return 0
