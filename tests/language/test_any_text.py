import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cityx.language import read_brief, read_note
from cityx.language.lexicon.phrases import FUNCTION_WORDS, entries

LONGEST = 0.5  # seconds of any text
PHRASES = sorted({one for *_, triggers in entries() for one in triggers.split(", ")})
WORDS = st.sampled_from(
    [*PHRASES, *sorted(FUNCTION_WORDS), "b07", "30 m", "12", "%", ",", ".", "and", "no", "€", "🏙"]
)
SENTENCES = st.lists(WORDS, max_size=25).map(" ".join)
QUICK = settings(
    max_examples=120, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True
)


def check(text, brief):
    spans = [slot.span for slot in (*brief.slots, *brief.negated, *brief.kept)]
    spans += [*brief.unread, *(edit.span for edit in brief.edits)]
    spans += [note.span for note in brief.notes]
    spans += [span for conflict in brief.conflicts for span in conflict.spans]
    assert all(0 <= first <= last <= len(text) for first, last in spans)
    brief.to_json()


@QUICK
@given(st.one_of(st.text(max_size=300), SENTENCES), st.booleans())
def test_any_text_is_read_without_a_traceback(text, base):
    brief = read_brief(text, base=base)
    check(text, brief)
    check(text, read_note(text))


@QUICK
@given(SENTENCES)
def test_spans_of_one_key_do_not_overlap(text):
    brief = read_brief(text)
    for slot in brief.slots:
        for other in brief.slots:
            if slot is not other and slot.key == other.key and slot.span != other.span:
                apart = slot.span[1] <= other.span[0] or other.span[1] <= slot.span[0]
                assert apart, (text, slot, other)


@QUICK
@given(
    st.sampled_from(["no", "without", "without any", "free of", "devoid of", "zero"]),
    st.sampled_from(["trees", "cars", "rivers", "towers", "parks", "bridges", "people", "fog"]),
)
def test_what_is_denied_is_never_asked_for(denial, noun):
    brief = read_brief(f"A modern city at night {denial} {noun}.")
    assert {slot.key for slot in brief.slots} == {"style", "time"}
    assert len(brief.negated) == 1


@QUICK
@given(SENTENCES)
def test_every_content_word_is_accounted_for(text):
    odd = f"{text} . frobnicate"
    assert read_brief(odd).words_unread[-1] == "frobnicate"


@pytest.mark.sweep(10)
@pytest.mark.parametrize(
    "text",
    [
        "a " * 50_000,
        "make b01 red and " * 6_000,
        "no " * 33_000,
        "\x00\x07\u202e مدينة حديثة ليلا \u2066" * 3_000,
        "🏙️🌃" * 20_000,
        "Remove the red cars near the park and " * 2_600,
        "9" * 100_000,
        "-" * 100_000,
        "b01, " * 20_000,
    ],
)
@pytest.mark.parametrize("base", [False, True])
def test_the_longest_text_ends_soon(text, base):
    read_brief("make b01 red", base=True)
    begin = time.process_time()
    brief = read_brief(text, base=base)
    assert time.process_time() - begin < 4 * LONGEST  # shared machines are slow
    check(text, brief)
    assert any(note.code == "too_long" for note in brief.notes)


@pytest.mark.parametrize("text", ["another", "A further", "one extra", "two additional"])
def test_a_text_may_end_with_a_word_for_more(text):
    read_brief(text)
