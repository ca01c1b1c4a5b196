"""Predicates read back as they were written; whatever is none is refused with its reason."""

import json
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.checks.predicates import parse
from cityx.checks.predicates.parser import DEEPEST, LONGEST
from cityx.checks.predicates.syntax import (
    Arithmetic,
    Call,
    Comparison,
    Name,
    Negative,
    Number,
    Within,
)
from cityx.checks.predicates.vocabulary import FORMS, KINDS, QUANTITIES
from cityx.errors import UsageError

TASKS = Path(__file__).parents[4] / "shared" / "notes" / "bench_tasks.md"

numbers = st.floats(-1e9, 1e9, allow_nan=False).map(lambda v: Number(float(round(v, 6)) + 0.0))
kinds = st.sampled_from([kind for kind, of in KINDS.items() if of not in ("place", "surface")]).map(
    Name
)
odd = st.text(st.characters(codec="utf-8", exclude_characters="\n"), min_size=1, max_size=8)
ids = odd.map(lambda text: Name(f"7{text}"))
things = st.one_of(kinds, ids)
quantities = st.sampled_from([k for k in QUANTITIES if QUANTITIES[k] == "number"]).map(Name)
counts = st.builds(
    lambda head, more: Call("n", (head, *more)), things,
    st.lists(ids.map(lambda name: Comparison(Name("id"), "=", name)), max_size=2),
)  # fmt: skip
atoms = st.one_of(numbers.filter(lambda n: n.value >= 0), quantities, counts)


def deeper(inner):
    return st.one_of(
        st.builds(Arithmetic, inner, st.sampled_from("+-*/"), inner),
        st.builds(Negative, inner.filter(lambda node: not isinstance(node, Number))),
        st.builds(lambda a, b: Call("min", (a, b)), inner, inner),
    )


expressions = st.recursive(atoms, deeper, max_leaves=5)
predicates = st.one_of(
    st.builds(Comparison, expressions, st.sampled_from(["==", "!=", "<=", ">=", "<", ">", "~"]),
              st.one_of(numbers, expressions)),
    st.builds(Within, expressions, numbers, numbers),
    things.map(lambda name: Call("same", (name,))),
)  # fmt: skip


@given(predicates)
@settings(max_examples=300, deadline=None)
def test_what_is_written_reads_back_the_same(predicate):
    text = str(predicate)
    if len(text) <= LONGEST and text.count("(") <= DEEPEST and "--" not in text:
        assert parse(text) == predicate


@given(st.text(max_size=80))
@settings(max_examples=400, deadline=None)
def test_garbage_is_refused_and_never_crashes(text):
    try:
        found = parse(text)
    except UsageError:
        return
    assert parse(str(found)) == found


words = st.sampled_from([*FORMS, *list(KINDS)[:12], *QUANTITIES, "id", "height", "class", "b07",
                         "(", ")", "(", ")", ",", "=", "==", ">=", "in", "[", "]", "-", "*", "3",
                         "0.5", '"a b"', "~", "others", "center", "p90"])  # fmt: skip


@given(st.lists(words, max_size=14))
@settings(max_examples=600, deadline=None)
def test_words_of_the_language_in_any_order_never_crash(parts):
    text = " ".join(parts)
    try:
        found = parse(text)
    except UsageError:
        return
    assert parse(str(found)) == found


@pytest.mark.parametrize(("text", "said"), [
    ("n(bilding) == 3", 'There is no kind bilding. Did you mean "building"'),
    ("n(building, hieght=3) == 2", 'Did you mean "height" or'),
    ("stat(building, height, p95) >= 4", "statistic is never p95; one of min, max, mean"),
    ("env.weather == rainy", 'env.weather is never rainy; one of clear'),
    ("env.sunelev > 3", 'There is no quantity env.sunelev. Did you mean "env.sun_elev"'),
    ("foo(tree) == 3", "There is no form foo(...)."),
    ("n(tree)", "n(...) is a number; compare it, as in n(tree) >= 1."),
    ("n(tree) >=", 'sign 11: the end is not expected here; "("'),
    ("n(tree) = 3", 'sign 9: "=" is not expected here'),
    ("n(tree == 0", 'sign 12: the end is not expected here; ")" or "," would be right'),
    ("share(building, style=modrn) > 0.5", 'Did you mean "modern"'),
    ("same(others) == 1", "same(others) is a truth, not a number."),
    ("road.pattern >= grid", '">=" does not compare words; == or != would.'),
    ("dist(tree) >= 3", "dist(things, things) takes 2 arguments besides conditions"),
    ("n(tree) == 1e999", "the number 1e999 is too large"),
    ("(" * 40 + "1" + ")" * 40 + " == 1", "more than 16 brackets within brackets"),
    ("n(tree) == " + "1" * 2000, "A predicate has at most 1000 signs, this has 2011."),
    ("n(river, lanes=2) == 2", "lanes is not measured of a land; one of id, on, in, area,"),
    ("__import__(os) == 1", "There is no form __import__(...)."),
])  # fmt: skip
def test_errors_say_where_and_what_would_be_right(text, said):
    with pytest.raises(UsageError) as error:
        parse(text)
    assert said in str(error.value)


def test_every_fault_is_named_at_once():
    with pytest.raises(UsageError, match=r"hieght.*\n?.*no kind parc"):
        parse("dist(building, hieght=3, parc) >= 2")


def test_arithmetic_binds_as_it_is_written():
    assert parse("1 - 2 - 3 == 4") == parse("(1 - 2) - 3 == 4")
    assert parse("1 - (2 - 3) == 4") != parse("1 - 2 - 3 == 4")
    assert str(parse("0.15*min( size.x,size.y ) >= -2")) == "0.15 * min(size.x, size.y) >= -2"


def test_the_tasks_of_the_benchmark_can_be_read():
    if not TASKS.exists():
        pytest.skip(f"{TASKS} is not there; the copies in test_tasks.py are read in any case")
    found = re.findall(r"- id: (P\d+).*?expect: (\[.*?\])\n", TASKS.read_text(), re.S)
    assert len(found) == 30
    for _, expect in found:
        for text in json.loads(expect):
            assert parse(str(parse(text))) == parse(text)
