"""The server: tools, resources and prompts of one city as the SDK serves them.

The event loop does no work of its own: what changes the city waits for the thread of its owner,
what only looks runs in a few threads beside it, and no call takes longer than `LONGEST_CALL_S`.
"""

from __future__ import annotations

import asyncio
import base64
import json
import logging
from collections.abc import Callable
from typing import Any, TypeVar

import anyio
import anyio.to_thread
from mcp import types
from mcp.server import Server
from mcp.server.context import ServerRequestContext
from mcp.shared.exceptions import MCPError
from mcp.types import INTERNAL_ERROR, INVALID_PARAMS

from cityx.errors import CityxError, UsageError
from cityx.server.jobs import Job
from cityx.server.notices import Notices
from cityx.server.owner import Owner
from cityx.server.prompts import INSTRUCTIONS, PROMPTS, find_prompt
from cityx.server.replies import SCHEMA, Reply, reply_of_error, reply_of_fault
from cityx.server.resources import Resource, Resources
from cityx.server.tool import Arguments, Tool, refusals
from cityx.server.toolbox import Toolbox
from cityx.version import __version__

LONGEST_CALL_S = 20.0  # many clients give a call up after 60 s, some sooner
TOO_LONG = f"It takes longer than {LONGEST_CALL_S:g} s; ask for less at once."
PROGRESS_S = 2.0  # between two notes of progress, which keep a client waiting
READERS = 4  # threads that look at the city at once

Context = ServerRequestContext[Any, Any]
T = TypeVar("T")
log = logging.getLogger(__name__)


class CityServer:
    """Serves one city.

    Parameters
    ----------
    owner
        Who holds it.
    full
        Whether every action is a tool of its own too.
    """

    def __init__(self, owner: Owner, *, full: bool = False) -> None:
        self.owner = owner
        self.toolbox = Toolbox(owner, full=full)
        self.resources = Resources(owner)
        self.notices = Notices()
        owner.listeners.append(self.notices.changed)
        self._readers: anyio.CapacityLimiter | None = None

    def sdk_server(self) -> Server[Any]:
        """Return the server of the SDK, for any transport."""
        return Server(
            "cityx",
            version=__version__,
            title="CityX",
            instructions=INSTRUCTIONS,
            lifespan=self.notices.serving,
            on_list_tools=self._list_tools,
            on_call_tool=self._call_tool,
            on_list_resources=self._list_resources,
            on_list_resource_templates=self._list_templates,
            on_read_resource=self._read_resource,
            on_subscribe_resource=self._subscribe,
            on_unsubscribe_resource=self._unsubscribe,
            on_subscriptions_listen=self.notices.listen,
            on_list_prompts=self._list_prompts,
            on_get_prompt=self._get_prompt,
        )

    async def answer(self, name: str, arguments: Arguments, context: Context) -> Reply:
        """Return the reply to a call; whatever is wrong with it becomes a reply too."""
        try:
            tool = self.toolbox.find(name)
            refused = refusals(tool, arguments)
            if refused:
                return Reply("rejected", "BAD_ARGS", " ".join(refused), self.owner.seen.revision)
            await self._renew()
            found = await self._aside(lambda: tool.run(arguments))
            if isinstance(found, Job):
                return await self._settled(found, tool.patience_for(arguments), context)
        except CityxError as error:
            return reply_of_error(error, self.owner.seen.revision)
        except TimeoutError:
            return Reply("failed", "TIMEOUT", TOO_LONG, self.owner.seen.revision)
        except Exception as error:
            log.exception("%s failed", name)
            return reply_of_fault(error, self.owner.seen.revision)
        return found

    async def _renew(self) -> None:
        """Make the owner reload if another process changed the city."""
        if self.owner.alive and self.owner.outdated() and not self.owner.busy:
            job = self.owner.submit("look", lambda job: Reply("ok", job_id=job.id))
            await _ended(job, LONGEST_CALL_S / 2)

    async def _aside(self, work: Callable[[], T]) -> T:
        """Run work that only looks in a thread of its own."""
        if self._readers is None:
            self._readers = anyio.CapacityLimiter(READERS)
        with anyio.fail_after(LONGEST_CALL_S):
            return await anyio.to_thread.run_sync(
                work, limiter=self._readers, abandon_on_cancel=True
            )

    async def _settled(self, job: Job, patience: float, context: Context) -> Reply:
        """Wait for a job, telling its progress, and return its reply or that it goes on."""
        left = patience
        while not await _ended(job, min(left, PROGRESS_S)) and left > PROGRESS_S:
            left -= PROGRESS_S
            last = job.said[-1] if job.said else job.state
            await context.session.report_progress(job.steps, message=last)
        if job.state == "ended":
            return job.reply.result()
        return Reply(
            "accepted", "OK", f"{job.what} goes on; call job_wait.", self.owner.seen.revision,
            job_id=job.id, data=job.to_json(),
        )  # fmt: skip

    async def _list_tools(
        self, context: Context, params: types.PaginatedRequestParams | None
    ) -> types.ListToolsResult:
        del context, params
        return types.ListToolsResult(
            tools=[_shown_tool(tool) for tool in self.toolbox.tools.values()]
        )

    async def _call_tool(
        self, context: Context, params: types.CallToolRequestParams
    ) -> types.CallToolResult:
        reply = await self.answer(params.name, params.arguments or {}, context)
        record = reply.to_json()
        content: list[types.ContentBlock] = [types.TextContent(text=json.dumps(record))]
        content += [
            types.ImageContent(data=base64.b64encode(picture).decode(), mime_type="image/png")
            for picture in reply.pictures
        ]
        content += [types.ResourceLink(name=uri, uri=uri) for uri in reply.artifacts]
        return types.CallToolResult(
            content=content,
            structured_content=record,
            is_error=reply.status in ("rejected", "failed"),
        )

    async def _list_resources(
        self, context: Context, params: types.PaginatedRequestParams | None
    ) -> types.ListResourcesResult:
        del context, params
        found = [
            types.Resource(
                uri=item.address, name=item.name, description=item.description, mime_type=item.mime
            )
            for item in self._resources(families=False)
        ]
        return types.ListResourcesResult(resources=found)

    async def _list_templates(
        self, context: Context, params: types.PaginatedRequestParams | None
    ) -> types.ListResourceTemplatesResult:
        del context, params
        found = [
            types.ResourceTemplate(
                uri_template=item.address, name=item.name, description=item.description,
                mime_type=item.mime,
            )
            for item in self._resources(families=True)
        ]  # fmt: skip
        return types.ListResourceTemplatesResult(resource_templates=found)

    def _resources(self, *, families: bool) -> list[Resource]:
        return [item for item in self.resources.all if item.is_family == families]

    async def _read_resource(
        self, context: Context, params: types.ReadResourceRequestParams
    ) -> types.ReadResourceResult:
        del context
        uri = str(params.uri)
        await self._renew()
        mime, found = await self._spoken(lambda: self.resources.read(uri))
        content: types.BlobResourceContents | types.TextResourceContents
        if isinstance(found, bytes):
            blob = base64.b64encode(found).decode()
            content = types.BlobResourceContents(uri=uri, blob=blob, mime_type=mime)
        else:
            content = types.TextResourceContents(uri=uri, text=found, mime_type=mime)
        return types.ReadResourceResult(contents=[content])

    async def _spoken(self, work: Callable[[], T]) -> T:
        """Run work that only looks; errors are told as those of the protocol."""
        try:
            return await self._aside(work)
        except CityxError as error:
            raise MCPError(code=INVALID_PARAMS, message=str(error)) from error
        except TimeoutError as error:
            raise MCPError(code=INVALID_PARAMS, message=TOO_LONG) from error
        except Exception as error:
            log.exception("a resource failed")
            said = f"CityX itself failed ({type(error).__name__})."
            raise MCPError(code=INTERNAL_ERROR, message=said) from error

    async def _subscribe(
        self, context: Context, params: types.SubscribeRequestParams
    ) -> types.EmptyResult:
        self.notices.watch(_client(context), context.session, str(params.uri))
        return types.EmptyResult()

    async def _unsubscribe(
        self, context: Context, params: types.UnsubscribeRequestParams
    ) -> types.EmptyResult:
        self.notices.unwatch(_client(context), str(params.uri))
        return types.EmptyResult()

    async def _list_prompts(
        self, context: Context, params: types.PaginatedRequestParams | None
    ) -> types.ListPromptsResult:
        del context, params
        wish = types.PromptArgument(name="text", description="What is wanted.", required=True)
        found = [
            types.Prompt(
                name=item.name, title=item.title, description=item.description, arguments=[wish]
            )
            for item in PROMPTS.values()
        ]
        return types.ListPromptsResult(prompts=found)

    async def _get_prompt(
        self, context: Context, params: types.GetPromptRequestParams
    ) -> types.GetPromptResult:
        del context
        try:
            prompt = find_prompt(params.name)
            text = prompt.filled((params.arguments or {}).get("text", ""))
        except UsageError as error:
            raise MCPError(code=INVALID_PARAMS, message=str(error)) from error
        message = types.PromptMessage(role="user", content=types.TextContent(text=text))
        return types.GetPromptResult(description=prompt.description, messages=[message])


def _shown_tool(tool: Tool) -> types.Tool:
    return types.Tool(
        name=tool.name,
        description=tool.description,
        input_schema=tool.schema,
        output_schema=dict(SCHEMA),
        annotations=types.ToolAnnotations(
            read_only_hint=tool.read_only,
            destructive_hint=tool.destructive,
            idempotent_hint=tool.idempotent,
            open_world_hint=False,
        ),
    )


async def _ended(job: Job, seconds: float) -> bool:
    """Wait for a job and tell whether it has ended; a waiter that leaves does not disturb it."""
    if not job.reply.done():
        await asyncio.wait([asyncio.wrap_future(job.reply)], timeout=max(seconds, 0))
    return job.reply.done()


def _client(context: Context) -> str:
    """Return the name of a client's session, "" where the transport carries only one."""
    headers = getattr(context.request, "headers", None) or {}
    return str(headers.get("mcp-session-id", ""))
