import pytest

from cityx.language import read_brief


def edits(text, names=()):
    return read_brief(text, base=True, names=names).edits


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("Cut down every tree in the park and put five benches there.", ("in", "park")),
        ("Pave x1 with cobbles and plant ten trees there.", ("along", "x1")),
        ("Make b03 red and put a statue there.", ("near", "b03")),
        ("Add a pond in the park. Three women jog there.", ("path", "park")),
        ("Clear the plaza of benches and let 12 people walk there.", ("path", "plaza")),
    ],
)
def test_there_is_the_place_named_last(text, place):
    assert place in edits(text, names=("b03", "x1"))[-1].change


def test_there_narrows_what_is_changed():
    found = edits("Plant ten trees in the park and remove the benches there.")
    assert found[-1].target.kind == "bench"
    assert found[-1].target.inside == "park"


def test_there_without_a_place_is_asked_about():
    brief = read_brief("Put five benches there.", base=True)
    assert [question.text for question in brief.questions] == ['Where is "there"? Name the place.']


@pytest.mark.parametrize(
    "text",
    ["There should be ten benches in the park.", "Make sure there are ten benches in the park."],
)
def test_there_are_is_no_place(text):
    assert edits(text)[-1].change == (("element", "bench"), ("count", 10), ("in", "park"))


def test_make_sure_there_are_asks_for_no_place():
    assert read_brief("Make sure there are ten benches.", base=True).questions == ()


@pytest.mark.parametrize(
    ("text", "change"),
    [
        (
            "A jogging woman circles the park on loop1.",
            {"agent": "pedestrian", "gender": "female", "mode": "run", "path": "loop1"},
        ),
        ("A bus drives down the main street.", {"agent": "bus", "path": "main_street"}),
        ("A man walks along the river.", {"gender": "male", "mode": "walk", "path": "river"}),
    ],
)
def test_somebody_told_of_is_added(text, change):
    (edit,) = edits(text, names=("loop1",))
    assert edit.verb == "add_agent"
    assert change.items() <= dict(edit.change).items()


@pytest.mark.parametrize("text", ["The cars on x1 should be red.", "A car is parked on x1."])
def test_nobody_is_added_who_is_there_or_stands(text):
    assert all(edit.verb != "add_agent" for edit in edits(text, names=("x1",)))
