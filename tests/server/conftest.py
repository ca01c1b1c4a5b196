import json

import pytest

pytest.importorskip("mcp", reason="cityx serve needs the extra mcp")

from copies import copy_of
from mcp import Client

from cityx.protocol.registry import registry
from cityx.server.app import CityServer
from cityx.server.owner import Owner


@pytest.fixture
def anyio_backend():
    return "asyncio"


@pytest.fixture
def folder(built_town, tmp_path):
    return copy_of(built_town(lod=1), tmp_path / "town")


@pytest.fixture
def owner(folder):
    with Owner(folder, registry()) as held:
        yield held


@pytest.fixture
def city_server(owner):
    return CityServer(owner)


@pytest.fixture
async def client(city_server, anyio_backend):  # noqa: ARG001  which the fixture runs on
    async with Client(city_server.sdk_server(), cache=None) as found:
        yield found


class Caller:
    """Calls tools and reads resources, and gives the JSON of the answers."""

    def __init__(self, client):
        self.client = client

    async def __call__(self, tool, /, **arguments):
        return (await self.client.call_tool(tool, arguments)).structured_content

    async def read(self, address):
        (content,) = (await self.client.read_resource(address)).contents
        return json.loads(content.text)


@pytest.fixture
def call(client):
    return Caller(client)
