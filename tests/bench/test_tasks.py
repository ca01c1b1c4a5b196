"""Reading of tasks."""

import json
from collections import Counter

import pytest
from cityx_bench.scoring import unmeasurable
from cityx_bench.tasks import PUBLIC, Task, read_tasks, write_tasks

from cityx.errors import InputError, UsageError

LINES = """
Some words.

```yaml
- id: A1
  text: "Put a \\"big\\" river, and two bridges."
  slots: [element=river, bridge.count=2, "not=tree"]
  expect: ["n(river) >= 1", "n(bridge) == 2"]   # no comment is read here
```
"""


def written(tmp_path, text, name="tasks.md"):
    path = tmp_path / name
    path.write_text(text)
    return path


def test_the_public_tasks_are_fifty_of_every_category():
    tasks = read_tasks()
    assert [task.id for task in tasks] == [f"P{number:02d}" for number in range(1, 51)]
    assert Counter(task.category for task in tasks) == {
        "generate": 15, "edit": 10, "multimodal": 9, "dynamic": 9, "clarify": 7,
    }  # fmt: skip


def test_lines_become_tasks(tmp_path):
    text = LINES.replace("   # no comment is read here", "")
    (task,) = read_tasks(written(tmp_path, text))
    assert task.text == 'Put a "big" river, and two bridges.'
    assert task.slots == (("element", "river"), ("bridge.count", 2.0), ("not", "tree"))
    assert task.expect == ("n(river) >= 1", "n(bridge) == 2")


def test_tasks_survive_being_written(tmp_path):
    path = tmp_path / "tasks.json"
    write_tasks(read_tasks(), path)
    assert path.read_text() == PUBLIC.read_text()


def test_what_a_task_asks_names_it_and_its_note_does_not():
    task = Task("A1", "x", expect=("n(tree) == 0",))
    assert task.digest == Task("A1", "x", expect=("n(tree) == 0",), note="y").digest
    assert task.digest != Task("A1", "z", expect=("n(tree) == 0",)).digest


def test_every_fault_is_told_by_its_task(tmp_path):
    records = [
        {"id": "A1", "text": "x", "expect": ["n(dragon) >= 1"], "base": "grid_x"},
        {"id": "A2", "text": "", "expect": []},
        {"id": "A3", "text": "x", "expect": ["n(tree) == 0"], "inputs": ["a.osm"], "slot": []},
        {"id": "A4", "text": "x", "expect": ["n(tree) == 0"], "slots": ["park"]},
        {"id": "A5", "text": "x", "expect": ["n(tree) == 0"]},
        {"id": "A5", "text": "x", "expect": ["n(tree) == 0"]},
        7,
    ]
    with pytest.raises(InputError) as caught:
        read_tasks(written(tmp_path, json.dumps(records), "tasks.json"))
    text = str(caught.value)
    for said in (
        'A1: there is no scene "grid_x"',
        "A2: its text is no text.", "A2: it expects nothing", 'A3: there is no input "a.osm"',
        'A3: has no meaning for "slot". Did you mean "slots"', 'A4: the slot "park" is not',
        "A5: stands there twice.", "entry 7 is no object.",
    ):  # fmt: skip
        assert said in text


def test_what_no_predicate_says_cannot_be_told_and_the_rest_is_measured():
    task = Task("A1", "x", expect=("n(dragon) >= 1", "n(tree) == 0", "about ten trees"))
    unknown = unmeasurable(task)
    assert list(unknown) == ["n(dragon) >= 1", "about ten trees"]
    assert all(found.met is None for found in unknown.values())
    assert "There is no kind dragon." in unknown["n(dragon) >= 1"].evidence


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("tasks.md", "", "it holds no task"),
        ("tasks.md", "- id: A1\n  text", 'line 2 (A1): "text" is not of the form key: value'),
        ("tasks.md", "  text: x\n", "line 1 (before any task)"),
        ("tasks.md", LINES, "line 8 (A1): expect has a value that cannot be read."),
        ("tasks.md", '- id: A1\n  text: "x\n', "line 2 (A1): text has a value"),
        ("tasks.json", "{", "is not JSON"),
        ("tasks.json", "{}", "is no list of tasks"),
    ],
)
def test_garbage_is_refused_with_its_place(tmp_path, name, text, said):
    with pytest.raises(InputError) as caught:
        read_tasks(written(tmp_path, text, name))
    assert said in str(caught.value)


def test_a_file_that_is_no_text_or_is_absent_is_refused(tmp_path):
    (tmp_path / "tasks.md").write_bytes(b"\xff\xfe\x00")
    for name in ("tasks.md", "absent.md"):
        with pytest.raises(InputError, match="cannot be read as a text"):
            read_tasks(tmp_path / name)


def test_unknown_ids_are_named_with_the_nearest():
    with pytest.raises(UsageError, match=r'There is no task "P51"\. Did you mean'):
        read_tasks(only=["P01", "P51"])
