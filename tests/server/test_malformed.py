"""Whatever a client sends is answered in the one form, and nothing of it is run."""

import re

import anyio
import pytest
from copies import copy_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcp import Client

from cityx.protocol.parameters import _FORBIDDEN_NAMES
from cityx.protocol.registry import registry
from cityx.server.app import CityServer
from cityx.server.owner import Owner
from cityx.server.replies import STATUSES
from cityx.server.toolbox import Toolbox

LEAVES = (
    st.none()
    | st.booleans()
    | st.integers(-(2**70), 2**70)
    | st.floats()
    | st.text(max_size=40)
    | st.sampled_from(["../../etc/passwd", "file:///etc/passwd", "__import__('os')", "\ud800"])
)
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=12,
)
NAMES = st.sampled_from(
    ["background/weather-v1", "sun", "edit/scale_object-v1", "layout/crop-v1", "road/network-v1"]
)
KEYS = st.sampled_from(
    ["preset", "strength", "time", "date", "scale_factor", "scaled_obj_name", "window", "path"]
)
# Known names and keys, so that calls come through the gate, and anything at all.
CALLS = st.fixed_dictionaries(
    {},
    optional={
        "name": NAMES | VALUES,
        "args": st.dictionaries(KEYS | st.text(max_size=8), VALUES, max_size=4) | VALUES,
        "bind": VALUES,
        "expected_rev": st.integers(0, 9) | VALUES,
        "idempotency_key": VALUES,
        "dry_run": st.booleans() | VALUES,
        "other": VALUES,
    },
)


@pytest.fixture(scope="module")
def answers(built_town, tmp_path_factory):
    """Call a tool over the protocol's own server and return the answer."""
    folder = tmp_path_factory.mktemp("malformed") / "town"
    copy_of(built_town(lod=1), folder)
    with Owner(folder, registry()) as owner:
        server = CityServer(owner, full=True)

        def answer(tool, arguments):
            async def ask():
                async with Client(server.sdk_server()) as client:
                    return await client.call_tool(tool, arguments)

            return anyio.run(ask)

        yield answer


def holds(found):
    told = found.structured_content
    assert told["status"] in STATUSES
    assert re.fullmatch(r"[A-Z_]+", told["code"])
    assert told["code"] not in ("INTERNAL", "FAILED")
    assert "Traceback" not in found.content[0].text
    assert found.is_error == (told["status"] in ("rejected", "failed"))


@settings(max_examples=120, deadline=None, suppress_health_check=list(HealthCheck))
@given(arguments=CALLS)
def test_action_call_answers_every_argument_with_a_typed_status(answers, arguments):
    holds(answers("action_call", arguments))


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    tool=st.sampled_from(
        ["scene_query", "scene_diff", "actions_search", "action_doc", "job_wait", "undo",
         "background_weather_v1", "edit_scale_object_v1", "plan"]
    ),
    arguments=st.dictionaries(
        KEYS | st.sampled_from(["selector", "page", "rev_a", "rev_b", "query", "name", "text"]),
        VALUES, max_size=4,
    ),
)  # fmt: skip
def test_every_tool_answers_every_argument_with_a_typed_status(answers, tool, arguments):
    holds(answers(tool, arguments))


def test_deep_and_large_arguments_are_refused_before_they_are_looked_at(answers):
    deep = []
    for _ in range(100):
        deep = [deep]
    for args in ({"preset": deep}, {"preset": ["x"] * 50_000}):
        found = answers("action_call", {"name": "weather", "args": args})
        assert found.structured_content["code"] == "BAD_ARGS"
        holds(found)


# Their path is words for a way through the city, of `cityx.protocol.parameters.Way`.
WAY_TAKERS = ("character", "vehicle_on_path")


def test_no_tool_is_named_for_code_or_takes_it_or_a_path_or_an_address(tmp_path):
    with Owner(tmp_path / "none", registry()) as owner:
        tools = Toolbox(owner, full=True).tools
    bad = {*_FORBIDDEN_NAMES, "python", "exec", "eval", "command", "shell", "source", "directory",
           "folder", "filepath", "host", "address", "import", "module"}  # fmt: skip
    assert len(tools) > 100
    for tool in tools.values():
        words = set(re.split(r"[^a-z]+", tool.name.lower()))
        names = {name.lower() for name in properties(tool.schema)}
        assert not words & {"exec", "eval", "python", "code", "script", "command"}
        ways = {"path"} if any(word in tool.name for word in WAY_TAKERS) else set()
        assert not (names - ways) & bad, tool.name


def properties(schema):
    """Return the names of all properties of a schema, at any depth."""
    if isinstance(schema, list):
        return {name for item in schema for name in properties(item)}
    if not isinstance(schema, dict):
        return set()
    own = set(schema["properties"]) if isinstance(schema.get("properties"), dict) else set()
    return own | {name for item in schema.values() for name in properties(item)}


def test_every_action_is_a_tool_of_its_own_in_the_full_profile(answers, tmp_path):
    with Owner(tmp_path / "none", registry()) as owner:
        core, full = Toolbox(owner).tools, Toolbox(owner, full=True).tools
        assert len(full) == len(core) + len(owner.actions)
    assert all(re.fullmatch(r"[a-z0-9_]{1,64}", name) for name in full)
    weather = full["background_weather_v1"]
    assert weather.schema["properties"]["strength"]["maximum"] == 1.0
    assert {"expected_rev", "idempotency_key", "dry_run"} <= set(weather.schema["properties"])
    assert full["edit_scale_object_v1"].destructive
    assert not weather.destructive
    refused = answers("background_weather_v1", {"strength": 7, "dry_run": True})
    assert "strength = 7 is outside 0 to 1" in refused.structured_content["message"]
    done = answers("background_weather_v1", {"preset": "fog"})
    assert done.structured_content["status"] == "ok"
