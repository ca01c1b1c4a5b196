from dataclasses import replace

import pytest
from cityx_bench.edits import CLASSES, REFUSE, class_of, run_edits, sentences, tables


def test_there_are_twenty_sentences_of_each_class_and_twenty_held_back():
    tasks = sentences(held=False)
    assert {name: sum(class_of(t) == name for t in tasks) for name in CLASSES} == dict.fromkeys(
        CLASSES, 20
    )
    held = sentences(held=True)
    assert len(held) == 20
    unseen = sentences(unseen=True)
    assert len(unseen) == 20
    assert len({task.text for task in (*tasks, *held, *unseen)}) == 120


def test_every_change_is_held_against_all_else():
    for task in sentences(held=False):
        if class_of(task) != REFUSE:
            assert any(text.startswith("same(") for text in task.expect), task.id


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    chosen = sentences(held=False, only=("asset11", "asset14", "weather06", "style19", "refuse18"))
    wrong = replace(chosen[0], id="asset99", expect=("n(tree) == 7", "same(others)"))
    open_ = replace(chosen[0], id="refuse99")
    return run_edits((*chosen, wrong, open_), tmp_path_factory.mktemp("bench"), lambda _: None)


def test_sentences_of_every_class_come_out_right(results):
    assert {r.task: r.causes for r in results if not r.task.endswith("99")} == dict.fromkeys(
        ("asset11", "asset14", "weather06", "style19", "refuse18"), ()
    )


def test_a_change_that_is_not_as_expected_is_wrong_and_says_why(results):
    (wrong,) = (r for r in results if r.task == "asset99")
    assert not wrong.right
    assert "n(tree) == 7" in wrong.causes[0]


def test_a_sentence_that_is_done_and_not_refused_is_wrong(results):
    (done,) = (r for r in results if r.task == "refuse99")
    assert done.causes[0].startswith("it was done: edit/streets-v1")
    assert "the city changed" in done.causes
    assert tables(results)["edits"].total == 5
