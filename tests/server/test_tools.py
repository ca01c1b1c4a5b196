import asyncio
import threading
from dataclasses import replace

import pytest
from PIL import Image

from cityx.agents import step_runner as runs
from cityx.projects import edit, views
from cityx.server import app
from cityx.server.replies import SCHEMA, STATUSES

pytestmark = pytest.mark.anyio
SNOW = {"name": "background/weather-v1", "args": {"preset": "snow"}}


def occupied(owner):
    """Keep the owner busy until the event is set."""
    held = threading.Event()

    def work(_):
        held.wait(20)
        return owner.ok({})

    return owner.submit("test", work), held


async def test_every_tool_has_a_schema_hints_and_the_same_form_of_answer(client):
    tools = (await client.list_tools()).tools
    assert {tool.name for tool in tools} == {
        "actions_search", "action_doc", "action_call", "scene_query", "scene_diff", "undo",
        "revisions", "render", "check", "plan", "run_brief", "job_status", "job_wait",
        "job_cancel", "health",
    }  # fmt: skip
    for tool in tools:
        assert tool.description
        assert tool.input_schema["additionalProperties"] is False
        assert tool.output_schema == SCHEMA
        assert tool.annotations.open_world_hint is False
    hints = {tool.name: tool.annotations for tool in tools}
    assert hints["scene_query"].read_only_hint
    assert not hints["action_call"].read_only_hint
    assert hints["action_call"].destructive_hint
    assert not hints["render"].destructive_hint


async def test_actions_are_found_by_words_stage_and_format(call):
    found = await call("actions_search", query="snow and rain")
    assert found["data"]["rows"][0]["id"] == "background/weather-v1"
    roads = await call("actions_search", stage="road", formats=["line"])
    assert roads["data"]["total"] > 3
    assert {row["stage"] for row in roads["data"]["rows"]} == {"road"}
    refused = await call("actions_search", formats=["nonsense"])
    assert (refused["status"], refused["code"]) == ("rejected", "USAGE")


async def test_the_doc_of_an_action_has_its_schema_and_limits(call):
    told = (await call("action_doc", name="weather"))["data"]
    assert told["id"] == "background/weather-v1"
    assert told["schema"]["properties"]["strength"]["maximum"] == 1.0
    assert told["limitation"]
    assert (await call("action_doc", name="wether"))["code"] == "USAGE"


async def test_an_action_makes_a_revision_and_undo_takes_it_back(call, owner):
    first = owner.seen.revisions[-1].content
    done = await call("action_call", **SNOW, expected_rev=1)
    assert (done["status"], done["state_rev"]) == ("ok", 2)
    assert done["changed"] == ["environment"]
    assert (await call.read("city://scene/summary"))["weather"] == "snow"
    back = await call("undo", expected_rev=2)
    assert (back["state_rev"], back["changed"]) == (3, ["environment"])
    assert owner.seen.revisions[-1].content == first
    rows = (await call("revisions"))["data"]["rows"]
    assert [row["revision"] for row in rows] == [3, 2, 1]
    assert rows[1]["actions"] == ["background/weather-v1"]
    again = await call("undo", to_rev=2)
    assert (await call.read("city://scene/summary"))["weather"] == "snow"
    assert again["state_rev"] == 4


async def test_the_objects_that_an_edit_touches_are_named(call):
    house = (await call("scene_query", selector={"kind": "church"}))["data"]["objects"][0]["id"]
    args = {"scaled_obj_name": house, "scale_factor": [1.0, 1.0, 1.5]}
    done = await call("action_call", name="edit/scale_object-v1", args=args)
    assert house in done["changed"]
    told = await call("scene_diff", rev_a=1, rev_b=2)
    assert house in told["changed"]
    assert told["data"]["layers"]["meshes/buildings"]["modified"] == 1
    assert (await call("scene_diff", rev_a=2, rev_b=2))["data"]["same"] is True
    assert (await call("scene_diff", rev_a=1, rev_b=7))["code"] == "USAGE"


async def test_a_dry_run_changes_nothing_and_tells_every_fault(call):
    passed = await call("action_call", **SNOW, dry_run=True)
    assert passed["message"] == "background/weather-v1 may run."
    args = {"preset": 7, "strength": 4, "wrong": 1}
    refused = await call("action_call", name="weather", args=args, dry_run=True)
    assert (refused["status"], refused["code"]) == ("rejected", "BAD_ARGS")
    assert refused["message"].count("BAD_ARGS") == 3
    assert refused["state_rev"] == 1


async def test_a_call_that_the_gate_refuses_has_its_code(call):
    assert (await call("action_call", name="no_such_action"))["code"] == "UNKNOWN_ACTION"
    late = await call("action_call", name="layout/crop-v1")
    assert (late["status"], late["state_rev"]) == ("rejected", 1)
    args = {"scaled_obj_name": "nobody", "scale_factor": [1, 1, 1]}
    absent = await call("action_call", name="scale_object", args=args)
    assert absent["code"] == "NO_SUCH_OBJECT"


async def test_the_same_key_again_returns_the_first_answer(call):
    first = await call("action_call", **SNOW, idempotency_key="k1")
    assert await call("action_call", **SNOW, idempotency_key="k1") == first
    assert (await call("revisions"))["data"]["total"] == 2
    other = await call("action_call", name="weather", idempotency_key="k1")
    assert other["code"] == "KEY_TAKEN"


async def test_objects_are_found_by_layer_kind_name_and_place(call):
    roads = await call("scene_query", selector={"layer": "roads", "name": "high"})
    assert [row["name"] for row in roads["data"]["objects"]] == ["High Street"]
    near = {"x": 0, "y": 0, "radius": 1}
    assert (await call("scene_query", selector={"near": near, "kind": "residential"}))["data"][
        "total"
    ] == 1
    every = await call("scene_query", page_size=7)
    assert len(every["data"]["objects"]) == 7
    last = await call("scene_query", page_size=7, page=every["data"]["pages"])
    assert 0 < len(last["data"]["objects"]) <= 7
    ids = [row["id"] for row in every["data"]["objects"]]
    found = await call("scene_query", selector={"ids": ids})
    assert {row["id"] for row in found["data"]["objects"]} == set(ids)
    assert (await call("scene_query", selector={"layer": "nothing"}))["code"] == "USAGE"
    assert (await call("scene_query", page=10**6))["code"] == "USAGE"


async def test_a_query_that_asks_for_too_much_is_refused(call):
    for arguments in (
        {"page_size": 10**6},
        {"selector": {"ids": ["0" * 16] * 501}},
        {"selector": {"name": "x" * 10_000}},
        {"selector": {"ids": list(range(30_000))}},
    ):
        assert (await call("scene_query", **arguments))["code"] == "BAD_ARGS"
    assert (await call("run_brief", text="snow " * 1000))["code"] == "BAD_ARGS"


async def test_a_plan_runs_nothing(call):
    told = await call("plan", text="make it snow at dusk")
    (change,) = told["data"]["brief"]["edits"]
    assert change["change"] == [["weather", "snow"], ["time", "dusk"]]
    assert "background/weather-v1" in [item["action"] for item in told["data"]["workflow"]]
    assert told["data"]["builds"] is False
    assert told["state_rev"] == 1
    refused = await call("plan", text="a volcano")
    assert (refused["status"], refused["code"]) == ("rejected", "CLARIFY")
    assert refused["message"]


async def test_a_brief_is_a_job_that_can_be_waited_for(call):
    begun = await call("run_brief", text="snow at dusk", expected_rev=1)
    assert begun["status"] == "accepted"
    done = await call("job_wait", job_id=begun["job_id"], seconds=20)
    assert (done["status"], done["state_rev"]) == ("ok", 2)
    status = await call("job_status", job_id=begun["job_id"])
    assert status["data"]["state"] == "ended"
    assert status["data"]["reply"]["state_rev"] == 2
    stale = await call("run_brief", text="fog", expected_rev=1)
    assert (await call("job_wait", job_id=stale["job_id"]))["code"] == "CONFLICT"
    assert (await call("job_wait", job_id="job_none"))["code"] == "USAGE"


async def test_going_back_and_a_change_are_one_brief(call):
    for text in ("snow", "undo the last change and make it rain instead"):
        begun = await call("run_brief", text=text)
        done = await call("job_wait", job_id=begun["job_id"], seconds=20)
    assert (done["status"], done["state_rev"]) == ("ok", 3)
    assert (await call("undo"))["status"] in ("ok", "accepted")


async def test_a_job_that_was_called_off_leaves_the_city_as_it_was(call, owner):
    blocking, held = occupied(owner)
    begun = await call("run_brief", text="snow")
    assert (await call("job_cancel", job_id=begun["job_id"]))["status"] == "ok"
    held.set()
    done = await call("job_wait", job_id=begun["job_id"])
    assert (done["status"], done["code"], done["state_rev"]) == ("failed", "CANCELLED", 1)
    assert blocking.reply.result().status == "ok"


async def test_what_is_called_off_after_its_last_action_stays_and_says_so(call, owner, monkeypatch):
    plain = edit.renew

    def late(folder, city, request, revision, say, **kept):
        for job in owner.jobs.values():
            job.cancel()
        say("making the views anew")
        return plain(folder, city, request, revision, say, **kept)

    monkeypatch.setattr(edit, "renew", late)
    begun = await call("run_brief", text="snow")
    done = await call("job_wait", job_id=begun["job_id"], seconds=20)
    assert (done["status"], done["state_rev"]) == ("ok", 2)
    assert (await call.read("city://scene/summary"))["weather"] == "snow"


async def test_an_action_in_progress_ends_and_is_rolled_back(call, owner, monkeypatch):
    plain = runs.Run.do

    def slow(self, city, action):
        for job in owner.jobs.values():
            job.cancel()
        return plain(self, city, action)

    monkeypatch.setattr(runs.Run, "do", slow)
    done = await call("action_call", **SNOW)
    assert (done["status"], done["code"], done["state_rev"]) == ("failed", "CANCELLED", 1)
    assert (await call.read("city://journal/2"))["status"] == "rolled_back"
    assert (await call.read("city://scene/summary"))["weather"] == "clear"


async def test_a_call_that_takes_long_goes_on_as_a_job(call, owner, city_server):
    _, held = occupied(owner)
    tools = city_server.toolbox.tools
    tools["action_call"] = replace(tools["action_call"], patience=0.1)
    begun = await call("action_call", **SNOW)
    assert begun["status"] == "accepted"
    assert (await call("health"))["data"]["waiting"] == 1
    held.set()
    assert (await call("job_wait", job_id=begun["job_id"]))["state_rev"] == 2


async def test_progress_is_told_while_a_client_waits(client, owner, monkeypatch):

    monkeypatch.setattr(app, "PROGRESS_S", 0.05)
    held, heard = threading.Event(), []

    def work(job):
        job.say("halfway")
        held.wait(20)
        return owner.ok({})

    job = owner.submit("test", work)

    async def progress(_done, _total, message):
        heard.append(message)
        held.set()

    await client.call_tool("job_wait", {"job_id": job.id}, progress_callback=progress)
    assert heard[0] == "halfway"


async def test_work_beyond_the_queue_is_refused(call, owner):
    _, held = occupied(owner)
    answers = [await call("run_brief", text="snow") for _ in range(40)]
    held.set()
    assert {answer["code"] for answer in answers} == {"OK", "BUSY"}


async def test_a_picture_comes_as_an_image_and_as_a_resource(client, call, monkeypatch):
    def blender_views(_store, *, renders, views, size, **_):
        renders.mkdir(parents=True)
        Image.new("RGB", size, "red").save(renders / f"{views[0]}.png")

    monkeypatch.setattr(views, "blender_views", blender_views)
    found = await client.call_tool("render", {"view": "top", "size": [64, 32], "samples": 1})
    assert found.structured_content["artifacts"] == ["city://render/1/top"]
    assert [block.type for block in found.content] == ["text", "image", "resource_link"]
    (blob,) = (await client.read_resource("city://render/1/top")).contents
    assert blob.blob == found.content[1].data
    for arguments in ({"view": "/etc/passwd"}, {"size": [64, 100_000]}, {"samples": 0}):
        assert (await call("render", **arguments))["code"] == "BAD_ARGS"


async def test_the_checks_renew_the_report(call):
    told = await call("check")
    assert told["status"] == "ok"
    assert told["data"]["counts"]["buildings"] == 11
    report = await call.read("city://report")
    assert report["of_this_revision"] is True
    await call("action_call", **SNOW)
    assert (await call.read("city://report"))["of_this_revision"] is False


async def test_the_server_tells_that_it_works(call):
    told = (await call("health"))["data"]
    assert told["works"] is True
    assert told["actions"] > 90
    assert len(told["registry"]) == 32


async def test_a_tool_that_does_not_exist_is_answered_like_any_other(call):
    answer = await call("exec_python", source="1")
    assert (answer["status"], answer["code"]) == ("rejected", "USAGE")
    assert answer["status"] in STATUSES


async def test_two_calls_at_once_are_done_one_after_the_other(call):
    both = await asyncio.gather(
        call("action_call", **SNOW),
        call("action_call", name="sun", args={"time": "dusk"}),
    )
    assert sorted(answer["state_rev"] for answer in both) == [2, 3]
    assert all(answer["changed"] == ["environment"] for answer in both)
