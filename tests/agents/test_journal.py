from cityx.agents.journal import Journal, derivation_key


def test_a_step_is_on_record_before_it_ends(tmp_path):
    with Journal(tmp_path / "journal.sqlite") as journal:
        run = journal.start_run([], {}, 0)
        journal.start_step(run, "road/network-v1", {"smooth": 0.3}, "s0")
    with Journal(tmp_path / "journal.sqlite") as journal:
        (step,) = journal.steps(run)
    assert (step.action, step.status, step.args) == ("road/network-v1", "started", {"smooth": 0.3})


def test_steps_are_numbered_in_order_and_keep_their_results(tmp_path):
    with Journal(tmp_path / "journal.sqlite") as journal:
        run = journal.start_run([], {}, 0)
        for name in ("a", "b"):
            index = journal.start_step(run, name, {}, "s")
            journal.end_step(run, index, "done", state="t", ms=5)
        assert [(s.index, s.action, s.status) for s in journal.steps(run)] == [
            (0, "a", "done"),
            (1, "b", "done"),
        ]


def test_a_derivation_key_ignores_the_order_of_arguments():
    assert derivation_key("s", "a", {"x": 1, "y": 2}) == derivation_key("s", "a", {"y": 2, "x": 1})
    assert derivation_key("s", "a", {"x": 1}) != derivation_key("s", "a", {"x": 2})
