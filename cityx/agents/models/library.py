"""The library for language models: the one module that imports it.

Everything else speaks in questions and answers (`cityx.agents.models.asking`), so that a new
version of the library, or another one, changes this file alone.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from hashlib import sha256
from typing import Any

from pydantic import BaseModel
from pydantic_ai import Agent, BinaryContent, ModelRetry, NativeOutput, PromptedOutput, ToolOutput
from pydantic_ai.exceptions import AgentRunError, UserError
from pydantic_ai.messages import (
    ModelMessage,
    ModelResponse,
    ModelResponsePart,
    TextPart,
    ToolCallPart,
)
from pydantic_ai.models import Model, ModelRequestParameters
from pydantic_ai.models.function import AgentInfo, FunctionModel
from pydantic_ai.models.wrapper import WrapperModel
from pydantic_ai.profiles.openai import OpenAIModelProfile
from pydantic_ai.settings import ModelSettings
from pydantic_ai.usage import RequestUsage, UsageLimits

from cityx.agents.models.asking import ModelFailed, Question
from cityx.agents.models.budget import LETTERS_PER_TOKEN, BudgetSpent, Ledger
from cityx.agents.models.recording import Decision, Decisions, NotRecorded, model_of
from cityx.agents.models.spec import SERVICES, ModelSpec
from cityx.agents.pool import Role
from cityx.errors import CityxError

REQUEST_S = 60.0  # one request; the clients' own limit is ten minutes
CLIENT_RETRIES = 2  # of refusals that pass by: 429, 500, 503
_UNKEYED = frozenset({"max_tokens", "timeout"})  # settings that change no decision


def make_model(spec: ModelSpec) -> Model:
    """Return the model of a spec; nothing is contacted before it is asked."""
    service = spec.service
    secret = spec.secret() or "none"  # the clients refuse an empty key, servers ignore this one
    if service.wire == "anthropic":  # a client takes a second to import
        from anthropic import AsyncAnthropic
        from pydantic_ai.models.anthropic import AnthropicModel
        from pydantic_ai.providers.anthropic import AnthropicProvider

        anthropic = AsyncAnthropic(
            api_key=secret, base_url=spec.url, timeout=REQUEST_S, max_retries=CLIENT_RETRIES
        )
        return AnthropicModel(spec.model, provider=AnthropicProvider(anthropic_client=anthropic))
    from openai import AsyncOpenAI
    from pydantic_ai.models.openai import OpenAIChatModel, OpenAIResponsesModel
    from pydantic_ai.providers.openai import OpenAIProvider

    client = AsyncOpenAI(
        api_key=secret, base_url=spec.url, timeout=REQUEST_S, max_retries=CLIENT_RETRIES
    )
    if spec.key != SERVICES["openai"].key:  # of the environment, and no other server's business
        client.organization = client.project = None
    provider = OpenAIProvider(openai_client=client)
    if service.wire == "responses":
        return OpenAIResponsesModel(spec.model, provider=provider)
    profile = OpenAIModelProfile(
        supports_json_schema_output=service.json_schema,
        supports_forced_tool_choice=service.forced_tool,
        openai_chat_supports_multiple_system_messages=service.system_messages,
        openai_chat_supports_max_completion_tokens=service.max_completion_tokens,
    )
    settings = ModelSettings(**service.settings)  # type: ignore[typeddict-item]
    return OpenAIChatModel(spec.model, provider=provider, profile=profile, settings=settings)


def silent_model(decisions: Sequence[Decision], name: str = "") -> Model:
    """Return a stand-in for the model of a recording; it cannot be asked anything else.

    Parameters
    ----------
    decisions
        The recording; it may be empty where a name is given.
    name
        Of the model, that of the recording when "".

    Raises
    ------
    InputError
        If the recording is not of one model.
    """
    name = name or model_of(decisions)

    def refuse(messages: list[ModelMessage], info: AgentInfo) -> ModelResponse:
        del messages, info
        raise NotRecorded(f"{name} is replayed and cannot be asked.")

    native = any(one.request["output"]["mode"] == "native" for one in decisions)
    usual = decisions[0].request["settings"] if decisions else {}
    settings = ModelSettings(**usual)  # type: ignore[typeddict-item]
    return FunctionModel(
        refuse, model_name=name, settings=settings,
        profile=OpenAIModelProfile(supports_json_schema_output=native),
    )  # fmt: skip


class Metered(WrapperModel):
    """A model whose every request is held to the budget and recorded.

    Parameters
    ----------
    wrapped
        The model.
    ledger
        What may be spent.
    decisions
        What was decided already.
    """

    def __init__(self, wrapped: Model, ledger: Ledger, decisions: Decisions) -> None:
        super().__init__(wrapped)
        self.ledger = ledger
        self.decisions = decisions
        self.role: Role = "system"

    async def request(
        self,
        messages: list[ModelMessage],
        model_settings: ModelSettings | None,
        model_request_parameters: ModelRequestParameters,
    ) -> ModelResponse:
        """Answer from a recording, or ask within the budget."""
        asked = plain_request(messages, model_settings, model_request_parameters)
        held = self.decisions.find(self.model_name, asked, self.role)
        if held is not None:
            return response_from(held.response, held.usage, held.model)
        letters, images = size_of(asked)
        given, room = self.ledger.room(letters, images)
        settings = ModelSettings(**{**(model_settings or {}), "max_tokens": room})
        try:
            response = await super().request(messages, settings, model_request_parameters)
        except BaseException:
            # Whether a request that failed was counted by the server, nobody says.
            self.ledger.spend(self.role, self.model_name, given, 0, None)
            raise
        answered = plain_response(response)
        usage = {
            "in": response.usage.input_tokens or given,
            "out": response.usage.output_tokens or len(json.dumps(answered)) // LETTERS_PER_TOKEN,
        }  # many local servers count nothing
        self.ledger.spend(self.role, self.model_name, usage["in"], usage["out"], price_of(response))
        self.decisions.keep(self.model_name, asked, answered, usage)
        return response


class LibraryRespondent:
    """A metered model that answers questions."""

    def __init__(self, model: Model, ledger: Ledger, decisions: Decisions) -> None:
        self.model = Metered(model, ledger, decisions)

    async def answer(self, question: Question) -> BaseModel:
        """Return an answer of the type the question asks for; see `Respondent`."""
        self.model.role = question.role
        agent: Agent[None, Any] = Agent(
            self.model,
            output_type=self._output(question),
            instructions=question.task,
            retries={"tools": question.corrections, "output": question.corrections},
            end_strategy="early",  # one action per turn
        )

        wrong: list[Any] = []

        @agent.output_validator
        def correct(answer: Any) -> Any:
            faults = question.check(answer)
            if not faults:
                return answer
            wrong.append(answer)
            sound = question.sound(answer) if len(wrong) > question.corrections else None
            if sound is None:
                raise ModelRetry("\n".join(faults))
            return sound

        images = [BinaryContent(data, media_type="image/png") for data in question.images]
        try:
            result = await agent.run(
                [question.data, *images],
                usage_limits=UsageLimits(request_limit=question.corrections + 1),
            )
        except (BudgetSpent, NotRecorded):
            raise
        except (AgentRunError, UserError) as error:
            raise ModelFailed(f"{type(error).__name__}: {error}") from error
        except CityxError:
            raise
        except Exception as error:  # whatever a server sends, the run goes on
            raise ModelFailed(f"{type(error).__name__}: {error}") from error
        return result.output  # type: ignore[no-any-return]

    def _output(self, question: Question) -> Any:
        if question.mode == "tool":
            return ToolOutput(question.answer, name=question.name)
        # Never with tools beside it: servers that guide decoding then answer at once.
        if self.model.profile.get("supports_json_schema_output", False):
            return NativeOutput(question.answer, name=question.name)
        return PromptedOutput(question.answer, name=question.name)

    async def close(self) -> None:
        """Close the connections of the model's client."""
        client = getattr(self.model.wrapped, "client", None)
        if client is not None:
            await client.close()


def plain_request(
    messages: Sequence[ModelMessage],
    settings: ModelSettings | None,
    parameters: ModelRequestParameters,
) -> dict[str, Any]:
    """Return what decides an answer: no ids, no times, pictures by their digest."""
    tools = [*parameters.function_tools, *parameters.output_tools]
    wanted = parameters.output_object
    return {
        "messages": [_plain_message(message) for message in messages],
        "tools": [{"name": tool.name, "schema": tool.parameters_json_schema} for tool in tools],
        "output": {
            "mode": parameters.output_mode,
            "schema": None if wanted is None else wanted.json_schema,
        },
        "settings": {
            key: value for key, value in sorted((settings or {}).items()) if key not in _UNKEYED
        },
    }


def _plain_message(message: ModelMessage) -> dict[str, Any]:
    if isinstance(message, ModelResponse):
        return {"by": "model", **plain_response(message)}
    parts = []
    for part in message.parts:
        plain: dict[str, Any] = {"kind": part.part_kind, "content": _plain_content(part)}
        if getattr(part, "tool_name", None):
            plain["tool"] = part.tool_name  # type: ignore[union-attr]
        parts.append(plain)
    return {"by": "us", "task": message.instructions, "parts": parts}


def _plain_content(part: Any) -> Any:
    content = getattr(part, "content", None)
    if isinstance(content, list | tuple):
        return [_plain_item(item) for item in content]
    return _plain_item(content)


def _plain_item(item: Any) -> Any:
    if isinstance(item, BinaryContent):
        digest = sha256(item.data).hexdigest()
        return {"image": digest, "media_type": item.media_type}
    if isinstance(item, Mapping):
        # A validation error names its place and says what is wrong; links change with versions.
        return {key: item[key] for key in ("loc", "msg", "type", "input") if key in item}
    return item if isinstance(item, str) else str(item)


def plain_response(response: ModelResponse) -> dict[str, Any]:
    """Return the texts and calls of a response."""
    parts: list[dict[str, Any]] = []
    for part in response.parts:
        if isinstance(part, TextPart):
            parts.append({"text": part.content})
        elif isinstance(part, ToolCallPart):
            parts.append({"call": part.tool_name, "args": part.args})
    return {"parts": parts}


def response_from(plain: Mapping[str, Any], usage: Mapping[str, int], model: str) -> ModelResponse:
    """Rebuild a response from `plain_response`."""
    parts: list[ModelResponsePart] = [
        TextPart(part["text"]) if "text" in part else ToolCallPart(part["call"], part["args"])
        for part in plain["parts"]
    ]
    spent = RequestUsage(input_tokens=usage.get("in", 0), output_tokens=usage.get("out", 0))
    return ModelResponse(parts=parts, usage=spent, model_name=model)


def size_of(asked: Mapping[str, Any]) -> tuple[int, int]:
    """Return the letters of a request, as it is sent without blanks, and its pictures."""
    contents = [part["content"] for one in asked["messages"] for part in one["parts"]
                if isinstance(part.get("content"), list)]  # fmt: skip
    images = sum(isinstance(item, dict) and "image" in item for one in contents for item in one)
    return len(json.dumps(asked, ensure_ascii=False, separators=(",", ":"))), images


def price_of(response: ModelResponse) -> float | None:
    """Return the price of a response in dollars, None where it is not known."""
    if not response.provider_name or not response.model_name:
        return None
    try:
        return float(response.cost().total_price)
    except (LookupError, ValueError, AssertionError):
        return None
