import pytest

models = pytest.importorskip("pydantic_ai.models", reason="needs the extra llm")

import talk  # noqa: E402
from scripted_server import ScriptedServer  # noqa: E402


@pytest.fixture(autouse=True)
def _no_requests(monkeypatch):
    """Refuse real models; tests with a server of their own allow them again."""
    monkeypatch.setattr(models, "ALLOW_MODEL_REQUESTS", False)
    for name in ("OPENAI_API_KEY", "ANTHROPIC_API_KEY", "CITYX_API_KEY", "OPENAI_BASE_URL"):
        monkeypatch.delenv(name, raising=False)
    yield
    while talk.OPEN:
        talk.OPEN.pop().close()


@pytest.fixture
def server(monkeypatch):
    """A scripted server on this machine, and leave to ask it."""
    monkeypatch.setattr(models, "ALLOW_MODEL_REQUESTS", True)
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    found = ScriptedServer()
    yield found
    found.close()
