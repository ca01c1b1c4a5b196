"""Which language model is asked, where it is served and what that server can do."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from types import MappingProxyType
from typing import Any, Literal
from urllib.parse import urlsplit

from cityx.errors import MissingExtra, UsageError, nearest
from cityx.system.tables import load, table

OFFLINE, REPLAY = "offline", "replay"
KEY_ELSEWHERE = "CITYX_API_KEY"  # a vendor's key is never sent to another server


def _no_settings() -> Mapping[str, Any]:
    return MappingProxyType({})


@dataclass(frozen=True)
class Service:
    """A kind of server.

    Attributes
    ----------
    wire
        How it is talked to: OpenAI's Responses, OpenAI's Chat Completions or Anthropic's Messages.
    url
        Where it is reached when nothing else is said.
    key
        Environment variable of the key, "" where none is needed.
    json_schema
        Whether it holds an answer to a JSON schema while it writes (guided decoding).
    forced_tool
        Whether it accepts `tool_choice="required"`.
    system_messages
        Whether it accepts more than one system message.
    max_completion_tokens
        Whether it knows the field of that name; older servers know `max_tokens`.
    settings
        Sampling; vendors' newest models refuse a temperature, local servers want one.
    """

    wire: Literal["responses", "chat", "anthropic"]
    url: str
    key: str = ""
    json_schema: bool = True
    forced_tool: bool = True
    system_messages: bool = True
    max_completion_tokens: bool = True
    settings: Mapping[str, Any] = field(default_factory=_no_settings)


SERVICES = table("agents/services", Service, "services")
# Any other server behind openai-chat: only what all of them can do is taken for granted.
ANY_CHAT = load("agents/services", Service, "any_chat")


@dataclass(frozen=True)
class ModelSpec:
    """A model that can be asked; its key stays in the environment.

    Attributes
    ----------
    model
        Its name on the server.
    service
        What the server can do.
    url
        Its address.
    key
        Environment variable of the key, "" where none is sent.
    """

    model: str
    service: Service
    url: str
    key: str = ""

    def secret(self) -> str:
        """Return the key, "" without one. Never store it."""
        return os.environ.get(self.key, "") if self.key else ""


def read_spec(text: str, base_url: str = "") -> ModelSpec:
    """Read "openai:MODEL" and the like; nothing is contacted.

    Parameters
    ----------
    text
        Service and model.
    base_url
        Address of a server other than the service's own. `CITYX_API_KEY` is sent there, when set.

    Raises
    ------
    UsageError
        If the service is unknown, the address none, or the key missing; says which to set.
    MissingExtra
        If the library for language models is not installed.
    """
    name, colon, model = text.partition(":")
    if name not in SERVICES or not colon or not model.strip():
        known = ", ".join(f"{service}:MODEL" for service in SERVICES)
        raise UsageError(
            f'Planner "{text}" is neither "{OFFLINE}" nor one of {known}.'
            + nearest(name, (OFFLINE, *SERVICES))
        )
    service, url = SERVICES[name], SERVICES[name].url
    key = service.key
    if base_url:
        url = _address(base_url)
        if service.key and url != service.url.rstrip("/"):
            key = KEY_ELSEWHERE if os.environ.get(KEY_ELSEWHERE) else ""
            service = ANY_CHAT if service.wire == "chat" else service
    if key and not os.environ.get(key, "").strip():
        raise UsageError(
            f"Planner {text} needs a key: set the environment variable {key}. Without one, "
            f'"--planner {OFFLINE}" needs none, and --base-url names a server of your own.'
        )
    require_library()
    return ModelSpec(model.strip(), service, url, key)


def require_library() -> None:
    """Make sure that the library for language models is installed.

    Raises
    ------
    MissingExtra
        If it is not.
    """
    absent = [name for name in ("pydantic_ai", "openai", "anthropic") if find_spec(name) is None]
    if absent:
        raise MissingExtra(
            f"Language models need {' and '.join(absent)}; install with: pip install "
            '"cityx[llm]". The planner "offline" needs nothing.'
        )


def _address(url: str) -> str:
    """Return an address without a slash at its end.

    Raises
    ------
    UsageError
        If it is none, or carries a secret, which journal and report would keep.
    """
    parts = urlsplit(url)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise UsageError(f'--base-url "{url}" is no address such as http://localhost:8000/v1.')
    if parts.username or parts.password or parts.query or parts.fragment:
        raise UsageError(
            "--base-url carries a name, a password or a query; give the bare address and put the "
            f"key into the environment variable {KEY_ELSEWHERE}."
        )
    return url.rstrip("/")
