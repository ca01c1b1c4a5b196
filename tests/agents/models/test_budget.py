import pytest
from talk import channel_of, offline_planner, pool_in

from cityx.agents.models.budget import BudgetSpent, Ledger, Limits
from cityx.agents.models.planner import ModelPlanner
from cityx.agents.planning.planner import Situation

SLOTS = {"size.x": (400.0,), "size.y": (400.0,)}


def planned(ledger, *answers, alone=False, seen=None, times=1):
    channel = channel_of(*answers, ledger=ledger, alone=alone, seen=seen)
    for _ in range(times):
        plan = ModelPlanner(channel, offline_planner()).workflow(SLOTS, Situation())
    return plan, channel


def test_every_request_is_written_down(tmp_path):
    pool = pool_in(tmp_path / "a.sqlite")
    ledger = Ledger()
    ledger.attach(pool)
    planned(ledger, {"steps": 1}, {"items": []})
    told = pool.read("budget")
    assert [(message.role, message.body["model"]) for message in told] == [
        ("planner", "scripted")
    ] * 2
    assert all(message.tokens_in > 0 and message.tokens_out > 0 for message in told)
    assert ledger.tokens == sum(pool.tokens())
    assert ledger.requests == 2


def test_a_run_taken_up_again_goes_on_counting(tmp_path):
    pool = pool_in(tmp_path / "a.sqlite")
    first = Ledger()
    planned(first, {"items": []})
    first.attach(pool)
    second = Ledger()
    second.attach(pool)
    assert (second.requests, second.tokens) == (first.requests, first.tokens) != (0, 0)
    assert first.requests == 1


def test_what_does_not_fit_is_not_sent():
    seen = []
    plan, channel = planned(Ledger(Limits(tokens=900)), {"items": []}, seen=seen)
    assert seen == []
    assert plan == offline_planner().workflow(SLOTS, Situation())
    assert "The budget of 900 tokens for models is spent" in channel.notes[0]


@pytest.mark.parametrize("limits", [Limits(requests=3), Limits(tokens=20_000)])
def test_a_model_that_is_asked_for_ever_stays_within_the_budget(limits):
    ledger, seen = Ledger(limits), []
    planned(ledger, {"items": []}, seen=seen, times=40)
    assert 0 < ledger.requests <= limits.requests
    assert ledger.tokens <= limits.tokens
    assert len(seen) == ledger.requests


def test_the_answer_may_be_as_long_as_the_budget_allows():
    seen = []
    ledger = Ledger(Limits(tokens=1_000_000))
    planned(ledger, {"items": []}, seen=seen)
    assert seen[0][1].model_settings["max_tokens"] == 4096
    given, room = Ledger(Limits(tokens=2000)).room(3000)
    assert (given, room) == (1000, 1000)


def test_money_counts_where_a_price_is_known():
    ledger = Ledger(Limits(usd=0.5))
    ledger.spend("planner", "known", 100, 10, 0.6)
    with pytest.raises(BudgetSpent, match=r"0\.5 dollars"):
        ledger.room(30)
    free = Ledger(Limits(usd=0.5))
    free.spend("planner", "local", 100, 10, None)
    free.room(30)
    assert free.unpriced


def test_a_model_on_its_own_ends_with_its_budget():
    with pytest.raises(BudgetSpent):
        planned(Ledger(Limits(requests=0)), {"items": []}, alone=True)


def test_a_request_that_failed_counts_too():
    ledger = Ledger()
    planned(ledger, ConnectionError("refused"))
    assert ledger.requests == 1
    assert ledger.tokens > 0
