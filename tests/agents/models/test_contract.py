"""What CityX relies on of the library for language models; run it before a new version of it.

The rows are those of a table that was measured when the library was chosen.
"""

import asyncio
import io
import json
import logging

import pytest
from PIL import Image
from pydantic import BaseModel
from pydantic_ai import (
    Agent,
    BinaryContent,
    ModelRetry,
    NativeOutput,
    PromptedOutput,
    Tool,
    UsageLimits,
)
from pydantic_ai.exceptions import (
    ModelHTTPError,
    ModelServerError,
    UnexpectedModelBehavior,
    UsageLimitExceeded,
)
from pydantic_ai.messages import ModelMessagesTypeAdapter, ModelResponse, ToolCallPart
from pydantic_ai.models.anthropic import AnthropicModel
from pydantic_ai.models.fallback import FallbackModel
from pydantic_ai.models.function import FunctionModel
from pydantic_ai.models.openai import OpenAIChatModel
from pydantic_ai.models.test import TestModel
from pydantic_ai.profiles.openai import OpenAIModelProfile
from pydantic_ai.providers.anthropic import AnthropicProvider
from pydantic_ai.providers.openai import OpenAIProvider
from scripted_server import call, failure, text

from cityx.agents.models.budget import Ledger
from cityx.agents.models.library import Metered
from cityx.agents.models.recording import Decisions, NotRecorded, read_decisions


class Size(BaseModel):
    image_size: tuple[int, int]


def picture():
    out = io.BytesIO()
    Image.new("RGB", (64, 48), "red").save(out, "PNG")
    return BinaryContent(out.getvalue(), media_type="image/png")


def chat(server, name, **profile):
    provider = OpenAIProvider(base_url=server.url, api_key="none")
    return OpenAIChatModel(name, provider=provider, profile=OpenAIModelProfile(**profile))


def scaling(log):
    """A tool that scales an object which must exist."""

    def scale(name: str, factor: float) -> str:
        """Scale an object."""
        if name != "tower_1":
            raise ModelRetry(f"There is no object {name}; there is tower_1.")
        log.append((name, factor))
        return "scaled"

    return scale


def run(agent, prompt="scale the tower", **more):
    return asyncio.run(agent.run(prompt, **more))


def careless(turn):
    """A wrong type, then an object that is not there, then right, then the answer."""
    attempts = [
        call("scale", {"name": "tower_1", "factor": "big"}),
        call("scale", {"name": "tower_9", "factor": 2}),
        call("scale", {"name": "tower_1", "factor": 2}),
        call("final_result", {"image_size": turn.image_size}),
    ]
    return attempts[turn.answers]


def test_01_tool_picture_and_typed_answer_after_two_mistakes(server):
    server.scripts["careless"] = careless
    log = []
    agent = Agent(chat(server, "careless"), output_type=Size, tools=[scaling(log)], retries=3)
    found = run(agent, ["scale it", picture()])
    assert found.output.image_size == (64, 48)
    assert log == [("tower_1", 2.0)]
    assert len(server.turns) == 4
    assert "There is no object tower_9" in server.turns[2].text


def test_02_native_answer_with_a_picture(server):
    server.scripts["native"] = lambda turn: text({"image_size": turn.image_size})
    model = chat(server, "native", supports_json_schema_output=True)
    found = run(Agent(model, output_type=NativeOutput(Size)), ["look", picture()])
    assert found.output.image_size == (64, 48)
    assert len(server.turns) == 1
    assert server.turns[0].body["response_format"]["type"] == "json_schema"


def test_03_prompted_answer_in_a_fence(server):
    server.scripts["fence"] = lambda turn: text(
        f'```json\n{{"image_size": {turn.image_size}}}\n```'
    )
    found = run(Agent(chat(server, "fence"), output_type=PromptedOutput(Size)), ["look", picture()])
    assert found.output.image_size == (64, 48)


def test_04_guided_decoding_with_tools_never_calls_them(server):
    """The reason why no question of ours has a native answer and tools."""
    server.scripts["guided"] = lambda turn: (
        text({"image_size": [1, 1]}) if "response_format" in turn.body else call("scale", {})
    )
    log = []
    model = chat(server, "guided", supports_json_schema_output=True)
    found = run(Agent(model, output_type=NativeOutput(Size), tools=[scaling(log)]))
    assert found.output.image_size == (1, 1)
    assert log == []


def choosy(turn):
    if turn.body.get("tool_choice") == "required":
        return failure(400, "tool_choice required is not supported")
    return call("final_result", {"image_size": [1, 1]})


def test_05_a_server_without_forced_tools_needs_its_profile(server):
    server.scripts["choosy"] = choosy
    with pytest.raises(ModelHTTPError, match="400"):
        run(Agent(chat(server, "choosy"), output_type=Size))
    model = chat(server, "choosy", supports_forced_tool_choice=False)
    assert run(Agent(model, output_type=Size)).output.image_size == (1, 1)


def test_06_malformed_arguments_and_an_unknown_tool_are_repaired(server):
    replies = [
        call("scale", '{"name": "tower_1", "factor": '),
        call("delete_everything", {}),
        call("scale", {"name": "tower_1", "factor": 2}),
        call("final_result", {"image_size": [1, 1]}),
    ]
    server.scripts["sloppy"] = lambda turn: replies[turn.answers]
    log = []
    run(Agent(chat(server, "sloppy"), output_type=Size, tools=[scaling(log)], retries=3))
    assert log == [("tower_1", 2.0)]


def stubborn(turn):
    del turn
    return call("scale", {"name": "tower_9", "factor": 2})


def test_07_endless_bad_calls_stop_at_the_cap(server):
    server.scripts["stubborn"] = stubborn
    agent = Agent(chat(server, "stubborn"), output_type=Size, tools=[scaling([])], retries=2)
    with pytest.raises(UnexpectedModelBehavior):
        run(agent)
    assert len(server.turns) == 3


def test_08_endless_bad_calls_stop_at_the_limit_of_requests(server):
    server.scripts["stubborn"] = stubborn
    agent = Agent(chat(server, "stubborn"), output_type=Size, tools=[scaling([])], retries=99)
    with pytest.raises(UsageLimitExceeded):
        run(agent, usage_limits=UsageLimits(request_limit=4))
    assert len(server.turns) == 4


def test_09_the_librarys_token_limit_holds_only_afterwards(server):
    """The reason for a ledger that estimates before it sends."""
    server.scripts["stubborn"] = stubborn
    agent = Agent(chat(server, "stubborn"), output_type=Size, tools=[scaling([])], retries=99)
    with pytest.raises(UsageLimitExceeded):
        run(agent, usage_limits=UsageLimits(total_tokens_limit=250))
    assert len(server.turns) * 120 > 250


@pytest.mark.filterwarnings("ignore")
def test_10_the_librarys_cost_limit_lets_unpriced_models_pass(server):
    server.scripts["local"] = lambda _: call("final_result", {"image_size": [1, 1]})
    agent = Agent(chat(server, "local"), output_type=Size)
    found = run(agent, usage_limits=UsageLimits(cost_limit=0.000001))
    assert found.output.image_size == (1, 1)


def test_11_a_busy_server_is_asked_again(server):
    refusals = [failure(429, retry_after="0"), failure(503)]
    server.scripts["busy"] = lambda turn: (
        refusals[turn.hits] if turn.hits < 2 else call("final_result", {"image_size": [1, 1]})
    )
    assert run(Agent(chat(server, "busy"), output_type=Size)).output.image_size == (1, 1)
    assert len(server.turns) == 3


def test_12_a_broken_server_is_a_typed_error(server):
    server.scripts["broken"] = lambda _: failure(500)
    with pytest.raises(ModelServerError):
        run(Agent(chat(server, "broken"), output_type=Size))
    assert len(server.turns) == 3


def test_13_the_wire_format_of_anthropic(server):
    def reply(turn):
        if turn.answers == 0:
            return call("scale", {"name": "tower_1", "factor": 2})
        return call("final_result", {"image_size": turn.image_size})

    server.scripts["claude"] = reply
    log = []
    model = AnthropicModel(
        "claude", provider=AnthropicProvider(base_url=server.root, api_key="none")
    )
    found = run(Agent(model, output_type=Size, tools=[scaling(log)]), ["look", picture()])
    assert found.output.image_size == (64, 48)
    assert log == [("tower_1", 2.0)]
    assert len(server.turns) == 2


def test_14_forbidden_requests_reach_no_socket(server, monkeypatch):
    from pydantic_ai import models

    monkeypatch.setattr(models, "ALLOW_MODEL_REQUESTS", False)
    with pytest.raises(RuntimeError, match="not allowed"):
        run(Agent(chat(server, "any"), output_type=Size))
    assert server.turns == []


def test_15_random_arguments_meet_no_precondition():
    """The reason why our tests script their models."""
    with pytest.raises(UnexpectedModelBehavior):
        run(Agent(TestModel(), tools=[scaling([])]))


def offline(messages, info):
    del messages, info
    return ModelResponse(parts=[ToolCallPart("final_result", {"image_size": [2, 2]})])


def test_16_a_function_may_stand_in_for_a_model():
    assert run(Agent(FunctionModel(offline), output_type=Size)).output.image_size == (2, 2)


def test_17_a_dead_endpoint_falls_back(server):
    model = chat(server, "dead")
    server.close()
    model.client.max_retries = 0
    agent = Agent(FallbackModel(model, FunctionModel(offline)), output_type=Size)
    assert run(agent).output.image_size == (2, 2)


def test_18_a_history_goes_on_without_running_tools_again(server):
    server.scripts["careless"] = careless
    log = []
    agent = Agent(chat(server, "careless"), output_type=Size, tools=[scaling(log)], retries=3)
    history = run(agent, ["scale it", picture()]).all_messages()
    kept = json.loads(ModelMessagesTypeAdapter.dump_json(history))[:-2]
    again = ModelMessagesTypeAdapter.validate_python(kept)
    found = asyncio.run(agent.run(message_history=again))
    assert found.output.image_size == (64, 48)
    assert len(log) == 1
    assert len(server.turns) == 5


def test_19_a_tool_made_from_a_schema_is_not_validated(server):
    """The reason why every argument passes our own gate."""
    replies = [call("grow", {"factor": "big"}), call("final_result", {"image_size": [1, 1]})]
    server.scripts["grower"] = lambda turn: replies[turn.answers]
    seen = []
    schema = {"type": "object", "properties": {"factor": {"type": "number"}}}
    tool = Tool.from_schema(lambda **args: seen.append(args) or "", "grow", "Grow.", schema)
    run(Agent(chat(server, "grower"), output_type=Size, tools=[tool]))
    assert seen == [{"factor": "big"}]


def test_20_nothing_of_a_prompt_reaches_log_or_trace(server, caplog):
    server.scripts["plain"] = lambda _: call("final_result", {"image_size": [1, 1]})
    agent = Agent(chat(server, "plain"), output_type=Size)
    with caplog.at_level(logging.INFO):
        run(agent, "the secret plan")
    assert "secret plan" not in caplog.text
    assert not agent.instrument


def recorded(server, path):
    model = chat(server, "careless")
    return Metered(model, Ledger(), Decisions(record=path))


def test_21_a_recording_is_played_with_the_server_gone(server, tmp_path):
    server.scripts["careless"] = careless
    path = tmp_path / "calls.jsonl"
    log = []
    agent = Agent(recorded(server, path), output_type=Size, tools=[scaling(log)], retries=3)
    assert run(agent, ["scale it", picture()]).output.image_size == (64, 48)
    server.close()
    replayed = Metered(
        chat(server, "careless"), Ledger(), Decisions(read_decisions(path), replayed=True)
    )
    agent = Agent(replayed, output_type=Size, tools=[scaling(log)], retries=3)
    assert run(agent, ["scale it", picture()]).output.image_size == (64, 48)
    assert log == [("tower_1", 2.0)] * 2
    assert len(server.turns) == 4


def test_22_an_mcp_server_in_memory():
    mcp = pytest.importorskip("mcp", reason="needs the extra mcp")
    server = mcp.server.MCPServer("city")

    @server.tool()
    def height(name: str) -> float:
        """Return the height of an object."""
        return {"tower_1": 80.0}[name]

    async def ask():
        async with mcp.Client(server) as client:
            return await client.call_tool("height", {"name": "tower_1"})

    assert asyncio.run(ask()).structured_content == {"result": 80.0}


def test_23_the_same_script_gives_the_same_three_times(server):
    server.scripts["careless"] = careless
    found = []
    for _ in range(3):
        log = []
        agent = Agent(chat(server, "careless"), output_type=Size, tools=[scaling(log)], retries=3)
        found.append((run(agent, ["scale it", picture()]).output, tuple(log)))
    assert len(set(map(str, found))) == 1


def test_24_what_was_not_recorded_is_an_error(server, tmp_path):
    server.scripts["careless"] = careless
    path = tmp_path / "calls.jsonl"
    agent = Agent(recorded(server, path), output_type=Size, tools=[scaling([])], retries=3)
    run(agent, ["scale it", picture()])
    replay = Decisions(read_decisions(path), replayed=True)
    agent = Agent(Metered(chat(server, "careless"), Ledger(), replay), output_type=Size)
    with pytest.raises(NotRecorded, match="no answer number 1 of careless"):
        run(agent, "something else")
