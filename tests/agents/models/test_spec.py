import subprocess
import sys

import pytest

from cityx.agents.models import Recording, check_choice, roles_for, spec
from cityx.agents.models.library import make_model
from cityx.errors import MissingExtra, UsageError


@pytest.mark.parametrize(
    ("text", "variable"),
    [
        ("openai:some", "OPENAI_API_KEY"),
        ("openai-chat:some", "OPENAI_API_KEY"),
        ("anthropic:some", "ANTHROPIC_API_KEY"),
    ],
)
def test_a_missing_key_is_named(text, variable):
    with pytest.raises(UsageError, match=f"set the environment variable {variable}"):
        spec.read_spec(text)


def test_words_that_are_no_model_are_refused():
    with pytest.raises(UsageError, match='Did you mean "ollama"'):
        spec.read_spec("olama:llama3")
    with pytest.raises(UsageError, match="neither"):
        spec.read_spec("openai")


def test_a_vendors_key_is_never_sent_elsewhere(monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", "sk-vendor")
    monkeypatch.setenv("OPENAI_ORG_ID", "org-vendor")
    found = spec.read_spec("openai-chat:some", "http://localhost:8000/v1/")
    assert (found.key, found.secret(), found.url) == ("", "", "http://localhost:8000/v1")
    client = make_model(found).client
    assert client.api_key == "none"
    assert client.organization is None
    monkeypatch.setenv("CITYX_API_KEY", "sk-own")
    assert spec.read_spec("openai-chat:some", "http://localhost:8000/v1").secret() == "sk-own"
    assert spec.read_spec("openai-chat:some").secret() == "sk-vendor"


def test_a_spec_shows_no_key(monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", "sk-vendor")
    assert "sk-vendor" not in repr(spec.read_spec("openai:some"))


@pytest.mark.parametrize(
    "url", ["localhost:8000", "file:///etc", "http://me:pw@host/v1", "http://host/v1?key=1"]
)
def test_an_address_is_bare(url):
    with pytest.raises(UsageError, match="--base-url"):
        spec.read_spec("openai-chat:some", url)


@pytest.mark.parametrize("name", ["ollama", "vllm", "llamacpp", "lmstudio"])
def test_local_servers_need_no_key_and_have_profiles(name):
    found = spec.read_spec(f"{name}:some")
    profile = make_model(found).profile
    assert found.url.startswith("http://localhost:")
    assert profile["supports_json_schema_output"]
    assert profile["supports_forced_tool_choice"] is found.service.forced_tool


def test_an_unknown_server_is_trusted_with_nothing():
    profile = make_model(spec.read_spec("openai-chat:some", "http://localhost:1/v1")).profile
    assert not profile["supports_json_schema_output"]
    assert not profile["supports_forced_tool_choice"]


def test_the_extra_is_named_when_it_is_missing(monkeypatch):
    monkeypatch.setattr(spec, "find_spec", lambda _: None)
    with pytest.raises(MissingExtra, match=r'pip install "cityx\[llm\]"'):
        spec.read_spec("ollama:some")


def test_choices_that_do_not_go_together_are_refused(tmp_path):
    both = Recording(record=tmp_path / "a", replay=tmp_path / "b")
    with pytest.raises(UsageError, match="exclude each other"):
        check_choice("ollama:some", "", both)
    with pytest.raises(UsageError, match="add --replay"):
        check_choice("replay")
    with pytest.raises(UsageError, match="for a language model"):
        check_choice("offline", "http://localhost:1/v1")


PLAN = """
import socket, sys

def refuse(*args, **kwargs):
    raise AssertionError("a socket was asked for")

socket.socket.connect = socket.socket.connect_ex = refuse
socket.getaddrinfo = socket.create_connection = refuse

from cityx.projects.build import make_job
from cityx.agents.models import Recording, roles_for
from cityx.agents.briefs import slots_of
from cityx.options import BuildOptions
from cityx.agents.planning.planner import Situation
from cityx.protocol.catalogue import known_records

job = make_job([], BuildOptions(size=(300.0, 300.0), weather="rain"))
assert job.first_plan()
roles = roles_for("offline", "", Recording(), known_records(job.actions))
assert roles.planner.workflow(slots_of(job.options), Situation()).items
absent = {"pydantic_ai", "openai", "anthropic"} & set(sys.modules)
assert not absent, absent
"""


def test_planning_without_a_model_touches_no_network(tmp_path):
    environment = {"CITYX_CACHE": str(tmp_path), "OPENAI_API_KEY": "sk-fake", "PATH": ""}
    environment["PYTHONPATH"] = ":".join(sys.path)
    done = subprocess.run(
        [sys.executable, "-c", PLAN], env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr


def test_offline_roles_need_no_channel():
    roles = roles_for("offline", "", Recording(), ())
    assert type(roles.planner).__name__ == "OfflinePlanner"
    roles.close()
