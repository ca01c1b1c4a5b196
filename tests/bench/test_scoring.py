"""Rates, intervals and the agreement of slots."""

import pytest
from cityx_bench.paper import ABLATION, MODELS
from cityx_bench.scoring import Rate, Sample, fault_codes, rates_of, slot_counts, slot_score
from cityx_bench.tasks import Task

# As the paper prints them: ER@1 and SR@1, percent.
PRINTED = {
    "DIL": (94.00, 82.98), "DL": (73.00, 61.64), "DI": (69.00, 60.87), "D": (44.00, 56.82),
    "IL": (37.00, 51.35), "L": (36.00, 41.67), "GPT-4": (91.00, 81.32),
    "GPT-3.5-turbo": (72.00, 75.00), "Mistral": (78.00, 61.54), "Gemma-7B": (39.00, 69.23),
    "Llama2-7B": (27.00, 59.26), "Gemma-2B": (9.00, 33.33),
}  # fmt: skip


def test_all_twelve_rows_of_the_paper_are_there_as_printed():
    rows = {**ABLATION, **MODELS}
    assert {name: (row.er, row.sr) for name, row in rows.items()} == PRINTED


@pytest.mark.parametrize("row", PRINTED)
def test_the_rows_of_the_paper_follow_from_its_counts(row):
    counts = {**ABLATION, **MODELS}[row]
    samples = [
        sample(task=str(k), executed=k < counts.executed, right=k < counts.right)
        for k in range(100)
    ]
    for rates in (counts.rates, rates_of(samples)):
        assert (rates.executed.percent, rates.right_of_executed.percent) == PRINTED[row]
        assert rates.right.percent == counts.right


@pytest.mark.parametrize(
    ("hits", "total", "low", "high"),
    [(78, 94, 74.12, 89.23), (0, 10, 0.0, 27.75), (10, 10, 72.25, 100.0), (0, 0, 0.0, 100.0)],
)
def test_intervals_are_those_of_wilson(hits, total, low, high):
    assert Rate(hits, total).interval == pytest.approx((low, high), abs=0.01)


def sample(**said):
    usual = {
        "task": "P01", "digest": "", "category": "generate", "driver": "offline", "seed": 0,
        "lod": 1, "registry": "", "scored": True, "executed": True, "right": True, "goals": [],
        "clean": [], "faults": [], "unsupported": [], "reply": {}, "slots": {}, "quality": {},
        "planning_s": 0.0, "seconds": 0.0,
    }  # fmt: skip
    return Sample(**{**usual, **said})


def test_what_no_action_serves_counts_as_neither():
    rates = rates_of([sample(), sample(right=False), sample(scored=False, executed=False)])
    assert (rates.executed.hits, rates.executed.total) == (2, 2)
    assert (rates.right.hits, rates.right.total) == (1, 2)


def test_codes_are_counted_the_most_frequent_first():
    bad = {"code": "BAD_ARGS", "action": "", "message": ""}
    late = {**bad, "code": "STAGE_ORDER"}
    found = fault_codes([sample(faults=[late]), sample(faults=[bad, bad])])
    assert list(found.items()) == [("BAD_ARGS", 2), ("STAGE_ORDER", 1)]


def test_slots_agree_by_value_and_each_counts_once():
    task = Task("P01", "x", slots=(("size.x", 1000.0), ("element", "park"), ("element", "lake")))
    said = [("size.x", 1000), ("element", "park"), ("element", "park"), ("weather", "rain")]
    counts = slot_counts(task, said)
    assert counts == {"meant": 3, "read": 4, "both": 2}
    score = slot_score([sample(slots=counts)])
    assert (score["precision"], score["recall"]) == (0.5, 0.6667)
    assert score["f1"] == pytest.approx(2 * 2 / 7, abs=1e-4)


def test_a_driver_that_reads_nothing_has_no_score_for_reading():
    assert slot_counts(Task("P01", "x"), None) == {}
    assert slot_score([sample()]) == {}
