"""A key is in no file, no message, no note and no log."""

import io
import logging

from PIL import Image
from scripted_server import call, failure, text
from talk import pool_in, records

from cityx.agents.models import Recording, roles_for
from cityx.agents.planning.planner import Situation
from cityx.agents.verdict import Sight, View

KEY = "sk-fake-0123456789abcdef"
SLOTS = {"size.x": (400.0,), "size.y": (400.0,)}


def picture():
    out = io.BytesIO()
    Image.new("RGB", (64, 48), "red").save(out, "PNG")
    return out.getvalue()


def used(server, tmp_path):
    """Play every role once; return the roles and the texts of all that was written."""
    recording = Recording(record=tmp_path / "calls.jsonl")
    roles = roles_for("openai-chat:leaky", server.url, recording, records())
    pool = pool_in(tmp_path / "journal.sqlite")
    roles.attach(pool)
    roles.brief_maker.read("A rainy town.")
    roles.annotator.label(pool.database, "hash", records())
    roles.planner.workflow(SLOTS, Situation())
    sight = Sight("A rainy town.", {"a": "Is it there?"}, (), (View("top", "all", picture()),))
    roles.evaluator.look(sight, lambda _: [])
    roles.close()
    pool.database.close()
    return roles, b"".join(path.read_bytes() for path in sorted(tmp_path.iterdir()))


def test_a_key_that_a_server_tells_is_kept_nowhere(server, tmp_path, monkeypatch, caplog):
    monkeypatch.setenv("CITYX_API_KEY", KEY)

    def leaky(turn):
        if turn.tools:
            return call(turn.tools[0], {"items": [{"action": KEY, "args": {KEY: KEY}}]})
        if "Is it there" in turn.text:
            return failure(401, f"Incorrect API key provided: {KEY}")
        return text({"quarters": [{"style": KEY, "said": [KEY]}]})

    server.scripts["leaky"] = leaky
    with caplog.at_level(logging.DEBUG):
        roles, written = used(server, tmp_path)
    assert server.headers[0]["authorization"] == f"Bearer {KEY}"
    for word in ("brief: ", "was dropped", "look: "):
        assert any(word in note for note in roles.notes), word
    assert KEY.encode() not in written
    assert not any(KEY in note for note in roles.notes)
    assert KEY not in caplog.text
    assert KEY not in repr(roles)


def test_without_a_key_none_is_sent(server, tmp_path, monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    server.scripts["leaky"] = lambda _: text("no")
    used(server, tmp_path)
    assert not any(KEY in str(headers) for headers in server.headers)
