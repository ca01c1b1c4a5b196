"""Whatever a server does, a plan comes of it, within the budget, of registered actions alone."""

import time

import pytest
from scripted_server import call, failure, text
from talk import offline_planner, pool_in, records

from cityx.agents.models import Limits, Recording, asking, library, roles_for
from cityx.agents.models.asking import ModelFailed
from cityx.agents.planning.planner import Situation

SLOTS = {"size.x": (400.0,), "size.y": (400.0,)}
LIMITS = Limits(requests=12, tokens=100_000)
SCRIPTS = {
    "wrong_types": lambda turn: call(turn.tools[0], {"items": {"action": 7}}),
    "malformed": lambda turn: call(turn.tools[0], '{"items": [{"action": "layout/'),
    "unknown_tool": lambda _: call("delete_everything", {}),
    "refusal": lambda _: text("I cannot help with that."),
    "empty": lambda _: text(""),
    "html": lambda _: {"body": "<html>Welcome to nginx</html>"},
    "no_choices": lambda _: {"body": {"id": "1", "choices": []}},
    "null": lambda _: {"body": "null"},
    "forbidden": lambda _: failure(401, "no such key"),
    "not_found": lambda _: failure(404, "no such model"),
    "broken": lambda _: failure(500),
    "overloaded": lambda _: failure(503),
    "limited": lambda _: failure(429, retry_after="0"),
}


def roles(server, name, tmp_path, **more):
    found = roles_for(
        f"openai-chat:{name}", server.url, Recording(), records(), limits=LIMITS, **more
    )
    pool = pool_in(tmp_path / f"{name}.sqlite")
    found.attach(pool)
    return found, pool


@pytest.mark.parametrize("name", SCRIPTS)
def test_the_offline_planner_takes_over(server, tmp_path, name):
    server.scripts[name] = SCRIPTS[name]
    found, pool = roles(server, name, tmp_path)
    plans = [found.planner.workflow(SLOTS, Situation()) for _ in range(6)]
    found.close()
    assert plans == [offline_planner().workflow(SLOTS, Situation())] * 6
    assert found.notes
    assert all(note.endswith("Done offline instead.") for note in found.notes)
    assert len(pool.read("budget")) <= LIMITS.requests
    assert sum(pool.tokens()) <= LIMITS.tokens
    assert len(server.turns) <= 18
    pool.database.close()


def test_unknown_actions_are_never_planned(server, tmp_path):
    evil = [{"action": "convert/run_python-v1", "args": {"code": "import os"}}] * 30
    server.scripts["evil"] = lambda turn: call(turn.tools[0], {"items": evil})
    found, pool = roles(server, "evil", tmp_path)
    plan = found.planner.workflow(SLOTS, Situation())
    found.close()
    pool.database.close()
    assert plan == offline_planner().workflow(SLOTS, Situation())
    assert found.notes == [
        'planner: "convert/run_python-v1" was dropped: it is none of the actions to choose from.'
    ]


def test_a_server_that_hangs_is_left(server, tmp_path, monkeypatch):
    monkeypatch.setattr(asking, "QUESTION_S", 0.5)

    def hang(turn):
        time.sleep(2)
        return call(turn.tools[0], {"items": []})

    server.scripts["slow"] = hang
    found, pool = roles(server, "slow", tmp_path)
    begin = time.perf_counter()
    plan = found.planner.workflow(SLOTS, Situation())
    spent = time.perf_counter() - begin
    found.close()
    pool.database.close()
    assert plan == offline_planner().workflow(SLOTS, Situation())
    assert "longer than 0.5 seconds" in found.notes[0]
    assert spent < 10


def test_a_dead_server_is_left(server, tmp_path, monkeypatch):
    monkeypatch.setattr(library, "CLIENT_RETRIES", 0)
    server.close()
    found, pool = roles(server, "dead", tmp_path)
    plan = found.planner.workflow(SLOTS, Situation())
    found.close()
    pool.database.close()
    assert plan == offline_planner().workflow(SLOTS, Situation())
    assert "Done offline instead." in found.notes[0]


def test_a_model_on_its_own_is_not_helped(server, tmp_path):
    server.scripts["refusal"] = SCRIPTS["refusal"]
    found, pool = roles(server, "refusal", tmp_path, alone=True)
    with pytest.raises(ModelFailed):
        found.planner.workflow(SLOTS, Situation())
    found.close()
    pool.database.close()


def test_anthropics_wire_plays_the_planner(server, monkeypatch):
    monkeypatch.setenv("CITYX_API_KEY", "sk-own")
    server.scripts["claude"] = lambda turn: call(
        turn.tools[0], {"items": [{"action": "layout/highest-v1", "args": {"height": 30.0}}]}
    )
    found = roles_for("anthropic:claude", server.root, Recording(), records())
    plan = found.planner.workflow(SLOTS, Situation())
    found.close()
    assert "layout/highest-v1" in {item.action for item in plan.items}
    assert server.headers[0]["authorization"] == "Bearer sk-own"
