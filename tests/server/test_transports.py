import json
import os
import re
import signal
import socket
import subprocess
import sys
from contextlib import asynccontextmanager
from pathlib import Path

import httpx2
import psutil
import pytest
import requests
from mcp import Client, StdioServerParameters
from mcp.client.streamable_http import streamable_http_client

from cityx.city.content import content_hash
from cityx.cli.main import main
from cityx.projects.desk import Desk

pytestmark = pytest.mark.anyio
SERVE = [sys.executable, "-m", "cityx.cli", "serve"]
RAIN = {"name": "background/weather-v1", "args": {"preset": "rain"}}
SNOW = {"name": "background/weather-v1", "args": {"preset": "snow"}}
HELLO = {"jsonrpc": "2.0", "id": 1, "method": "ping"}
WAIT_S = 120  # a busy machine is slow to start a process

# A client of its own process: it begins a change, says so, and does nothing more.
CLIENT = """
import json, os, sys
import anyio, httpx2
from mcp import Client, StdioServerParameters
from mcp.client.streamable_http import streamable_http_client

async def main(kind, *words):
    if kind == "stdio":
        server = StdioServerParameters(command=words[0], args=list(words[1:]), env=dict(os.environ))
        await begin(server)
    else:
        headers = {"Authorization": f"Bearer {words[1]}"}
        async with httpx2.AsyncClient(headers=headers, timeout=60) as http:
            await begin(streamable_http_client(words[0], http_client=http))

async def begin(server):
    async with Client(server) as client:
        await client.call_tool("run_brief", {"text": "snow at dusk"})
        print("begun", flush=True)
        await anyio.sleep(600)

anyio.run(main, *sys.argv[1:])
"""


async def settled(client, tool, **arguments):
    """Call a tool and wait for the job where it becomes one."""
    answer = (await client.call_tool(tool, arguments)).structured_content
    while answer["status"] == "accepted":
        waited = {"job_id": answer["job_id"], "seconds": 20}
        answer = (await client.call_tool("job_wait", waited)).structured_content
    return answer


def over_streams(folder):
    words = [*SERVE[1:], str(folder)]
    server = StdioServerParameters(command=SERVE[0], args=words, env=dict(os.environ))
    return Client(server, cache=None)


async def test_a_client_over_streams_changes_a_city_and_takes_it_back(folder):
    with Desk(folder) as desk:
        first = content_hash(desk.city).total
    async with over_streams(folder) as client:
        done = await settled(client, "run_brief", text="snow at dusk", expected_rev=1)
        assert (done["status"], done["state_rev"]) == ("ok", 2)
        assert done["changed"] == ["environment"]
        house = (await settled(client, "scene_query", selector={"kind": "church"}))["data"]
        args = {"scaled_obj_name": house["objects"][0]["id"], "scale_factor": [1, 1, 2]}
        done = await settled(client, "action_call", name="scale_object", args=args, expected_rev=2)
        assert done["state_rev"] == 3
        stale = await settled(client, "undo", to_rev=1, expected_rev=2)
        assert stale["code"] == "CONFLICT"
        assert (await settled(client, "undo", to_rev=1, expected_rev=3))["state_rev"] == 4
    with Desk(folder) as desk:
        assert (desk.revision, content_hash(desk.city).total) == (4, first)


def test_lines_that_are_no_requests_leave_the_server_serving(folder):
    hello = {
        "protocolVersion": "2025-06-18", "capabilities": {},
        "clientInfo": {"name": "test", "version": "1"},
    }  # fmt: skip
    lines = [
        "not json", "{}", "[]", '{"jsonrpc": "2.0"', "\x00\xff",
        json.dumps(HELLO | {"id": 7, "method": "initialize", "params": hello}),
        json.dumps({"jsonrpc": "2.0", "method": "notifications/initialized"}),
        json.dumps(HELLO | {"id": 8, "method": "tools/call", "params": {"name": 5}}),
        json.dumps(HELLO | {"id": 9, "method": "no/such/method"}),
        json.dumps(HELLO | {"id": 10, "method": "tools/call", "params": {"name": "health"}}),
    ]  # fmt: skip
    done = subprocess.Popen(
        [*SERVE, str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    done.stdin.write("\n".join(lines) + "\n")
    done.stdin.flush()
    answers = {}
    while 10 not in answers:
        answer = json.loads(done.stdout.readline())
        answers[answer.get("id")] = answer
    done.stdin.close()
    assert done.wait(WAIT_S) == 0
    assert done.stdout.read() == ""
    done.stdout.close()
    assert "error" in answers[8]
    assert "error" in answers[9]
    assert answers[10]["result"]["structuredContent"]["status"] == "ok"
    assert not any("Traceback" in json.dumps(answer) for answer in answers.values())


@pytest.mark.slow
async def test_a_client_over_streams_builds_a_city_in_an_empty_folder(tmp_path):
    async with over_streams(tmp_path / "new") as client:
        done = await settled(client, "run_brief", text="build a small town in fog")
        assert (done["status"], done["state_rev"]) == ("ok", 1)
        found = await settled(client, "scene_query", selector={"layer": "layout/buildings"})
        assert found["data"]["total"] > 10
    with Desk(tmp_path / "new") as desk:
        assert desk.city.environment.weather == "fog"


@pytest.mark.blender
@pytest.mark.slow
async def test_a_client_over_streams_renders_the_city(folder):
    async with over_streams(folder) as client:
        done = await settled(client, "render", view="aerial", size=[64, 64], samples=1)
        assert (done["status"], done["artifacts"]) == ("ok", ["city://render/1/aerial"])
        (content,) = (await client.read_resource("city://render/1/aerial")).contents
    assert content.mime_type == "image/png"
    assert len(content.blob) > 1000


def begun(*words):
    """Start the client and return its process once its change is under way."""
    process = subprocess.Popen(
        [sys.executable, "-c", CLIENT, *map(str, words)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "begun\n"
    return process


async def test_a_killed_client_leaves_a_whole_city_and_no_server_behind(folder):
    client = begun("stdio", *SERVE, folder)
    servers = psutil.Process(client.pid).children()
    client.send_signal(signal.SIGKILL)
    client.wait()
    client.stdout.close()
    _, alive = psutil.wait_procs(servers, timeout=WAIT_S)
    assert servers
    assert not alive
    async with over_streams(folder) as again:
        done = await settled(again, "action_call", **SNOW)
    assert done["status"] == "ok"
    with Desk(folder) as desk:
        assert content_hash(desk.city).total == desk.revisions()[-1].content


class Served:
    """A server over HTTP in a process of its own."""

    def __init__(self, folder):
        self.process = subprocess.Popen(
            [*SERVE, str(folder), "--http", "0"], stderr=subprocess.PIPE, text=True
        )
        said = self.process.stderr.readline()
        self.address, self.token_path = re.search(r"on (\S+); the token is in (.+)", said).groups()
        self.token = Path(self.token_path).read_text()

    @asynccontextmanager
    async def client(self):
        headers = {"Authorization": f"Bearer {self.token}"}
        async with httpx2.AsyncClient(headers=headers, timeout=WAIT_S) as http:
            transport = streamable_http_client(self.address, http_client=http)
            async with Client(transport, cache=None) as client:
                yield client

    def post(self, **headers):
        accepted = {"Accept": "application/json, text/event-stream"}
        return requests.post(self.address, json=HELLO, headers=accepted | headers, timeout=WAIT_S)

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(WAIT_S)
        self.process.stderr.close()


@pytest.fixture
def served(folder):
    found = Served(folder)
    yield found
    found.end()


async def test_over_http_only_who_has_the_token_and_comes_from_here_gets_in(served):
    right = {"Authorization": f"Bearer {served.token}"}
    assert served.post().status_code == 401
    assert served.post(Authorization="Bearer wrong").status_code == 401
    assert served.post(Authorization=f"Bearer {served.token}x").status_code == 401
    assert served.post(Authorization=f"Basic {served.token}").status_code == 401
    assert served.post(**right, Origin="http://evil.example").status_code == 403
    assert served.post(**right, Origin="null").status_code == 403
    assert served.post(**right, Host="evil.example").status_code == 421
    assert requests.get(served.address, timeout=WAIT_S).status_code == 401
    async with served.client() as client:
        assert (await settled(client, "health"))["data"]["works"] is True
    assert Path(served.token_path).stat().st_mode & 0o777 == 0o600
    addresses = {c.laddr.ip for c in psutil.Process(served.process.pid).net_connections("inet")}
    assert addresses == {"127.0.0.1"}
    served.end()
    assert not Path(served.token_path).exists()


async def test_two_clients_conflict_cleanly_over_http(served):
    async with served.client() as one, served.client() as two:
        assert (await settled(one, "action_call", **SNOW, expected_rev=1))["state_rev"] == 2
        late = await settled(two, "action_call", name="sun", expected_rev=1)
        assert (late["status"], late["code"], late["state_rev"]) == ("rejected", "CONFLICT", 2)
        assert (await settled(two, "action_call", **RAIN, expected_rev=2))["state_rev"] == 3


async def test_a_killed_client_leaves_the_server_serving(served):
    process = begun("http", served.address, served.token)
    process.send_signal(signal.SIGKILL)
    process.wait()
    process.stdout.close()
    async with served.client() as client:
        answer = await settled(client, "revisions")
        while answer["data"]["total"] < 2:  # the job of the dead client goes on
            answer = await settled(client, "revisions")
        assert (await settled(client, "undo", to_rev=1))["state_rev"] == 3


async def test_a_change_by_another_process_is_seen_and_conflicts(folder):
    async with over_streams(folder) as client:
        assert (await settled(client, "health"))["state_rev"] == 1
        async with over_streams(folder) as other:
            assert (await settled(other, "action_call", **SNOW))["state_rev"] == 2
        assert (await settled(client, "revisions"))["state_rev"] == 2
        late = await settled(client, "action_call", name="sun", expected_rev=1)
        assert late["code"] == "CONFLICT"
        assert (await settled(client, "action_call", **RAIN))["state_rev"] == 3
    with Desk(folder) as desk:
        assert desk.city.environment.weather == "rain"


def test_what_cannot_be_served_is_said_at_once(tmp_path, monkeypatch, capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        for words, said in (
            (["--profile", "all"], 'There is no profile "all"; one of core, full.'),
            (["--http", str(port)], f"Port {port} cannot be used"),
        ):
            monkeypatch.setattr(sys, "argv", ["cityx", "serve", str(tmp_path), *words])
            with pytest.raises(SystemExit) as stop:
                main()
            assert stop.value.code == 2
            assert said in capsys.readouterr().err


def test_without_the_sdk_the_extra_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("cityx.server.serve.find_spec", lambda _: None)
    monkeypatch.setattr(sys, "argv", ["cityx", "serve", str(tmp_path)])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 2
    assert "pip install 'cityx[mcp]'" in capsys.readouterr().err
