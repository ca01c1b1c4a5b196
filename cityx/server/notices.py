"""Notices: subscribers of a resource are notified of a new revision of the city."""

from __future__ import annotations

import asyncio
import logging
from collections import OrderedDict
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

from mcp.server.session import ServerSession
from mcp.server.subscriptions import InMemorySubscriptionBus, ListenHandler, ResourceUpdated

from cityx.server.resources import CHANGING

MOST_WATCHERS = 200  # of clients that speak the older protocol, which never say that they leave
log = logging.getLogger(__name__)


@dataclass
class _Loop:
    """An event loop that serves clients: how many of its servers run, and what wakes it."""

    serving: int
    woken: asyncio.Event
    task: asyncio.Task[None]


class Notices:
    """Carries word of a change from the thread of the owner to the clients."""

    def __init__(self) -> None:
        self._bus = InMemorySubscriptionBus()
        self.listen = ListenHandler(self._bus)
        self._watchers: OrderedDict[tuple[str, str], ServerSession] = OrderedDict()
        self._loops: dict[asyncio.AbstractEventLoop, _Loop] = {}

    @asynccontextmanager
    async def serving(self, _: Any) -> AsyncIterator[dict[str, Any]]:
        """Pass notices on while the block runs; once for every loop, however often entered."""
        loop = asyncio.get_running_loop()
        if loop not in self._loops:
            woken = asyncio.Event()
            self._loops[loop] = _Loop(0, woken, loop.create_task(self._pass_on(woken)))
        held = self._loops[loop]
        held.serving += 1
        try:
            yield {}
        finally:
            held.serving -= 1
            if not held.serving:
                del self._loops[loop]
                held.task.cancel()

    def changed(self) -> None:
        """Notify that the city has changed; from any thread."""
        for loop, held in tuple(self._loops.items()):
            try:
                loop.call_soon_threadsafe(held.woken.set)
            except RuntimeError:  # the loop was closed meanwhile: nobody listens there
                log.debug("a loop was closed")

    def watch(self, client: str, session: ServerSession, address: str) -> None:
        """Notify a client of the older protocol of every change of a resource.

        Parameters
        ----------
        client
            Name of its session, "" where the transport carries only one.
        """
        self._watchers[(client, address)] = session
        while len(self._watchers) > MOST_WATCHERS:
            self._watchers.popitem(last=False)

    def unwatch(self, client: str, address: str) -> None:
        """Stop notifying a client of a resource."""
        self._watchers.pop((client, address), None)

    async def _pass_on(self, woken: asyncio.Event) -> None:
        while True:
            await woken.wait()
            woken.clear()
            for address in CHANGING:
                await self._bus.publish(ResourceUpdated(uri=address))
            for key, session in tuple(self._watchers.items()):
                try:
                    await session.send_resource_updated(key[1])
                except Exception:  # noqa: BLE001  the client left, in whatever way
                    self._watchers.pop(key, None)
