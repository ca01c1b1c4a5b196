import pytest

from cityx.agents.verdict import Finding, Seen, merge


def held(met, look):
    return merge({"goal": met}, {} if look is None else {"goal": look}).findings["goal"]


@pytest.mark.parametrize("look", [None, Seen("yes"), Seen("yes", 2), Seen("no", 2)])
def test_no_look_erases_what_was_measured_as_missing(look):
    found = held(False, look)
    assert (found.met, found.severity, found.origin) == (False, "block", "check")
    assert not merge({"goal": False}, {"goal": look} if look else {}).ok


def test_a_look_that_misses_what_was_measured_asks_for_another():
    once = merge({"goal": True}, {"goal": Seen("no")})
    assert once.unsettled == ("goal",)
    assert once.findings["goal"] == Finding(True, "check", 1.0, "", disagree=True)
    twice = merge({"goal": True}, {"goal": Seen("no", 2)})
    assert twice.findings["goal"].severity == "minor"
    assert twice.ok


def test_what_cannot_be_measured_is_looked_at():
    assert held(None, Seen("yes", 2)) == Finding(True, "seen", 0.8)
    assert held(None, Seen("no", 2)) == Finding(False, "seen", 0.8, "major")
    assert held(None, Seen("yes")).confidence == 0.5
    assert merge({}, {"style=modern": Seen("no", 2)}).ok


def test_what_nobody_can_tell_stays_open():
    verdict = merge({"a": None, "b": None, "c": True}, {"b": Seen("cannot tell", 2)})
    assert verdict.open == ("a", "b")
    assert verdict.findings["b"].origin == "nobody"


def test_a_verdict_is_plain_values():
    assert merge({"a": False}, {}).to_json() == {
        "ok": False,
        "findings": {
            "a": {
                "met": False, "origin": "check", "confidence": 1.0, "severity": "block",
                "disagree": False,
            }
        },
        "notes": [],
    }  # fmt: skip
