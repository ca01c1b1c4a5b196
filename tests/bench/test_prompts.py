"""Prompts go to a file, answers come back by hand, and the results are those of a model."""

import json
from dataclasses import replace

import pytest

pytest.importorskip("pydantic_ai")

from cityx_bench import runner
from cityx_bench.runner import Bench, export_prompts, run_bench
from cityx_bench.tasks import Task
from copies import copy_of
from pydantic_ai.messages import ModelResponse, TextPart, ToolCallPart
from pydantic_ai.models.function import FunctionModel

from cityx.agents.models.prompts import read_prompts
from cityx.errors import InputError

pytestmark = pytest.mark.slow

TASK = Task(
    "H1", "A small town of 200 m by 200 m with a Big Apple feel, in the rain.",
    expect=("env.weather == rain", "stat(building, height, max) in [20, 22]"),
)  # fmt: skip
CHANGE = replace(TASK, id="H2", base="grid_s", text="Make it soggy, as in a monsoon.")
ANSWERS = {
    "planner": {"items": [{"action": "layout/highest-v1", "args": {"height": 21.0}}]},
    "annotator": {"added": []},
    "user": {"wishes": [{"key": "style", "value": "american", "quote": "Big Apple feel"}]},
    "executor": {},
}


def quiet(_):
    """Say nothing."""


def answer(line):
    """Answer a prompt: a change of a scene is put into plain commands."""
    schema = line["request"]["output"]["schema"] or {}
    if "commands" in schema.get("properties", {}):
        return {"commands": ["Set the weather to rain."]}
    return ANSWERS[line["role"]]


def reply(messages, info):
    """Answer as `ANSWERS` do, told by what is asked."""
    if info.output_tools:
        name = info.output_tools[0].name
        role = "planner" if name == "workflow" else "executor"
        return ModelResponse(parts=[ToolCallPart(name, ANSWERS[role])])
    role = "annotator" if "You label" in str(messages[0].instructions) else "user"
    return ModelResponse(parts=[TextPart(json.dumps(ANSWERS[role]))])


@pytest.fixture(scope="module")
def asked(tmp_path_factory, scene_folder):
    """A file of prompts that were all answered, and how many waited in each round."""
    folder = tmp_path_factory.mktemp("prompts")
    copy_of(scene_folder("grid_s"), runner.scene_folder(folder, "grid_s"))
    path = folder / "prompts.jsonl"
    bench = Bench((TASK, CHANGE), f"export:{path}", folder, lod=0)
    rounds = []
    while (waiting := export_prompts(bench, quiet)) and len(rounds) < 9:
        rounds.append(waiting)
        lines = [json.loads(line) for line in path.read_text().splitlines()]
        for line in lines:
            line["answer"] = answer(line)
        path.write_text("".join(f"{json.dumps(line)}\n" for line in lines))
    return path, rounds


def test_answers_by_hand_give_the_results_of_the_model(asked, tmp_path, monkeypatch):
    path, rounds = asked
    assert sum(rounds) == len(read_prompts(path, answered=True)) >= 2
    by_hand = run_bench(Bench((TASK,), f"replay:{path}", tmp_path / "a", lod=0), quiet)[0]
    monkeypatch.setattr(
        "cityx.agents.models.library.make_model", lambda _: FunctionModel(reply, model_name="m")
    )
    driver = "llm:openai-chat:m@http://127.0.0.1:9"
    asked_itself = run_bench(Bench((TASK,), driver, tmp_path / "b", lod=0), quiet)[0]
    assert by_hand.right
    assert "layout/highest-v1" in by_hand.reply["actions"]
    for name in ("executed", "right", "goals", "clean", "faults", "reply"):
        assert getattr(by_hand, name) == getattr(asked_itself, name)


def test_a_change_of_a_scene_is_asked_of_the_model_too(asked):
    commands = [one for one in read_prompts(asked[0]) if "plain commands" in one.prompt]
    assert [one.role for one in commands] == ["user"]


def test_a_prompt_has_its_id_role_and_hash_and_can_be_handed_to_any_chat(asked):
    prompts = {one.role: one for one in read_prompts(asked[0])}
    assert {"planner", "user"} <= prompts.keys() <= ANSWERS.keys()
    one = prompts["planner"]
    assert one.id == f"planner-{one.key[:12]}-0"
    assert len(one.key) == 64
    assert one.prompt.startswith("You plan how a city is built")
    assert '- weather: ["rain"]' in one.prompt
    assert '"enum": [' in one.prompt
    assert "Answer with one JSON object of this schema" in one.prompt


def test_every_fault_of_a_file_is_told_at_once(asked, tmp_path):
    lines = [json.loads(line) for line in asked[0].read_text().splitlines()]
    plan = next(line for line in lines if line["role"] == "planner")
    faulty = [
        {**plan, "answer": {"items": "many"}}, {**plan, "answer": None},
        {**plan, "nth": 1, "request": {**plan["request"], "messages": []}}, {"id": "x"},
    ]  # fmt: skip
    path = tmp_path / "faulty.jsonl"
    path.write_text("".join(f"{json.dumps(line)}\n" for line in faulty) + "no json\n")
    with pytest.raises(InputError) as error:
        read_prompts(path, answered=True)
    said = str(error.value).splitlines()
    assert len(said) == 6
    assert f"line 1: {plan['id']}: the answer.items is wrong: 'many' is not of type" in said[0]
    assert said[1].endswith(f"line 2: {plan['id']} stands there twice.")
    assert said[2].endswith(f"line 2: {plan['id']} has no answer.")
    assert "line 3: planner-" in said[3]
    assert said[3].endswith("the key does not fit the question.")
    assert "line 4: no prompt: it has not exactly the fields answer, id" in said[4]
    assert "line 5: no JSON" in said[5]
    bench = Bench((TASK,), f"export:{path}", tmp_path)
    with pytest.raises(InputError, match="line 5: no JSON"):
        export_prompts(bench, quiet)
